"""Curved, tapering strands: made at random, written as HAIR for dapple and as text for Mitsuba."""

import struct

import numpy as np

from geometry import Strands

SEGMENTS = 12
POINTS_BIT, THICKNESS_BIT = 2, 4
HEADER_BYTES = 128


def make_strands(count, opacity, seed=1):
    """Strands in a disk of radius 1 m, up to 1 m long, that bend over; 10 mm thick at the root."""
    rng = np.random.default_rng(seed)
    root = np.sqrt(rng.random(count)) * np.exp(2j * np.pi * rng.random(count))
    lean = rng.normal(size=count) + 1j * rng.normal(size=count)
    length = rng.uniform(0.6, 1.0, count)
    t = np.linspace(0, 1, SEGMENTS + 1)
    away = root[:, None] + 0.35 * lean[:, None] * t**2 * length[:, None]
    height = (t - 0.25 * np.abs(lean)[:, None] ** 2 * t**3) * length[:, None]
    points = np.stack([away.real, np.maximum(height, 0.02 * t), away.imag], axis=-1)
    radii = np.broadcast_to(0.010 * (1 - 0.7 * t**2), (count, SEGMENTS + 1))
    return Strands(points.astype(np.float32), radii.astype(np.float32), opacity)


def write_hair(path, strands):
    """docs/formats.md: a header, points and thicknesses. Thickness is a diameter."""
    count, points, _ = strands.points.shape
    header = struct.pack(
        "<4s4I2f",
        b"HAIR",
        count,
        count * points,
        POINTS_BIT | THICKNESS_BIT,
        points - 1,
        0.0,
        1 - strands.opacity,
    )
    thickness = (2 * strands.radii).astype("<f4")
    path.write_bytes(
        header.ljust(HEADER_BYTES, b"\0")
        + strands.points.astype("<f4").tobytes()
        + thickness.tobytes()
    )


def write_curves(path, strands):
    """Lines of X Y Z RADIUS, an empty line after each strand."""
    rows = np.concatenate([strands.points, strands.radii[:, :, None]], axis=2)
    blocks = ("\n".join("%.9g %.9g %.9g %.9g" % tuple(row) for row in strand) for strand in rows)
    path.write_text("\n\n".join(blocks) + "\n")

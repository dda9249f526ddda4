"""The lights of these tests, written for dapple (lights file) and for Mitsuba (emitters).

Each scene is lit by a rect, a disk, a sphere and a dome, placed relative to a centre and a size in
metres. Mitsuba's shapes are made from docs/formats.md, not from dapple's code.
"""

import json
from dataclasses import dataclass

import mitsuba as mi
import numpy as np

RADIANCE = 10.0
DOME_SIZE = (1024, 512)
DOME_RADIANCE = 1.5
DOME_ROTATION_DEGREES = 40.0
# A lobe of light for each colour: towards +X and the front, to the back on the left, and upwards; so
# that no turn, mirror image or exchange of axes leaves the three irradiances as they are.
DOME_LOBES = np.array([[0.8, 0.3, 0.52], [-0.7, 0.5, -0.51], [0.15, 0.98, -0.1]])
DOME_SHARPNESS = (3.0, 2.0, 4.0)
DOME_FLOOR = 0.05


@dataclass
class FlatLight:
    """A rect or a disk: centre, unit normal towards what it lights, half lengths of its axes over
    `size`."""

    kind: str
    position: np.ndarray
    normal: np.ndarray
    half: tuple
    size: float = 1.0

    def axes(self):
        """docs/formats.md: the first edge runs along cross(normal, +Y), the second along
        cross(normal, first)."""
        first = np.cross(self.normal, [0.0, 1.0, 0.0])
        first /= np.linalg.norm(first)
        return first, np.cross(self.normal, first)

    def for_dapple(self):
        light = {
            "name": self.kind,
            "type": self.kind,
            "position": self.position.tolist(),
            "normal": self.normal.tolist(),
            "radiance": RADIANCE,
        }
        if self.kind == "rect":
            return {**light, "size": [2 * self.size * half for half in self.half]}
        return {**light, "radius": self.size * self.half[0]}

    def for_mitsuba(self):
        first, second = self.axes()
        to_world = np.eye(4)
        to_world[:3, 0] = first * self.size * self.half[0]
        to_world[:3, 1] = second * self.size * self.half[1]
        to_world[:3, 2] = self.normal
        to_world[:3, 3] = self.position
        return emitting(
            {
                "type": "rectangle" if self.kind == "rect" else "disk",
                "to_world": mi.ScalarTransform4f(to_world),
            }
        )


@dataclass
class SphereLight:
    """`size` is the radius."""

    position: np.ndarray
    size: float
    kind: str = "sphere"

    def for_dapple(self):
        return {
            "name": self.kind,
            "type": self.kind,
            "position": self.position.tolist(),
            "radius": self.size,
            "radiance": RADIANCE,
        }

    def for_mitsuba(self):
        return emitting(
            {"type": "sphere", "center": self.position.tolist(), "radius": self.size}
        )


class DomeLight:
    """Each renderer gets an image of its own, with the same radiance in the same directions."""

    kind = "dome"

    def for_dapple(self):
        return {
            "name": self.kind,
            "type": self.kind,
            "image": "dome.exr",
            "radiance": DOME_RADIANCE,
            "rotation_degrees": DOME_ROTATION_DEGREES,
        }

    def for_mitsuba(self):
        return {
            "type": "envmap",
            "bitmap": mi.Bitmap(DOME_RADIANCE * dome_image(mitsuba_directions())),
        }


def emitting(shape):
    """A shape that emits from its front, hides nothing and is not seen, as dapple's lights."""
    emitter = {"type": "area", "radiance": {"type": "rgb", "value": RADIANCE}}
    return {**shape, "emitter": emitter, "bsdf": {"type": "null"}}


def make_lights(centre, size):
    """Lights of about `size` metres around `centre`."""
    centre = np.array(centre)

    def facing(kind, offset, half):
        position = centre + size * np.array(offset)
        towards = centre - position
        return FlatLight(kind, position, towards / np.linalg.norm(towards), half, size)

    return [
        facing("rect", [-1.1, 1.5, 0.7], (0.6, 0.2)),
        facing("disk", [1.2, 1.0, 0.9], (0.25, 0.25)),
        SphereLight(centre + size * np.array([0.5, 1.4, -1.0]), 0.3 * size),
        DomeLight(),
    ]


def lobes_towards(directions):
    """Radiance (..., 3) from unit directions (..., 3) of the dome's own frame."""
    axes = DOME_LOBES / np.linalg.norm(DOME_LOBES, axis=1, keepdims=True)
    return DOME_FLOOR + np.exp(np.array(DOME_SHARPNESS) * (directions @ axes.T - 1))


def unrotated(directions):
    """World directions in the dome's frame; the image is turned about +Y, from +Z towards +X."""
    angle = np.radians(DOME_ROTATION_DEGREES)
    x, y, z = np.moveaxis(directions, -1, 0)
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.stack([x * cosine - z * sine, y, x * sine + z * cosine], axis=-1)


def dome_image(directions):
    return lobes_towards(unrotated(directions)).astype(np.float32)


def dapple_dome_image():
    """docs/formats.md: the top row looks up +Y, the middle column along +Z, and the column a quarter
    from the left along +X."""
    width, height = DOME_SIZE
    around = 2 * np.pi * (0.5 - (np.arange(width) + 0.5) / width)
    down = np.pi * (np.arange(height) + 0.5) / height
    return lobes_towards(from_angles(around, down)).astype(np.float32)


def from_angles(around, down):
    """Directions (rows, columns, 3): `around` from +Z towards +X, `down` from +Y."""
    around, down = np.meshgrid(around, down)
    return np.stack(
        [np.sin(around) * np.sin(down), np.cos(down), np.cos(around) * np.sin(down)], axis=-1
    )


def mitsuba_directions():
    """Mitsuba interpolates between texels: its first and last row are the poles; column c is at
    c + 1/2 of `width`, from -Z towards +X. check_dome() tells whether that is so."""
    width, height = DOME_SIZE
    around = np.pi - 2 * np.pi * (np.arange(width) + 0.5) / width
    return from_angles(around, np.pi * np.arange(height) / (height - 1))


def write_lights(folder, lights):
    """Writes lights.json and dome.exr for dapple; returns the first."""
    mi.Bitmap(dapple_dome_image()).write(str(folder / "dome.exr"))
    path = folder / "lights.json"
    path.write_text(json.dumps({"lights": [light.for_dapple() for light in lights]}, indent=1))
    return path


def check_dome():
    """Mitsuba's map must have the radiance of the formula in directions at random."""
    emitter = mi.load_dict(DomeLight().for_mitsuba())
    rng = np.random.default_rng(1)
    worst = 0.0
    for _ in range(200):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        interaction = mi.SurfaceInteraction3f()
        interaction.wi = mi.Vector3f(*(-direction))
        found = np.array(emitter.eval(interaction)).ravel()
        wanted = DOME_RADIANCE * dome_image(direction[np.newaxis])[0]
        worst = max(worst, float(np.abs(found - wanted).max()))
    if worst > 1e-3 * DOME_RADIANCE:
        raise ValueError(f"Mitsuba's dome deviates from its formula by {worst:.4f}")

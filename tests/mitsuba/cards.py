"""Textured cards: leaves cut out of squares, and veils, over an opaque ground.

Three materials try three ways in which alpha becomes opacity: MASK with a bilinear texture, MASK
with the nearest texel, and BLEND, bilinear, repeated over the card and times a factor.
"""

import numpy as np

from geometry import Material, Mesh, Texture

GROUND_HALF = 4.0
SQUARE = np.array([[0, 1, 2], [0, 2, 3]])


def leaf_alpha(size):
    """A leaf with a soft edge of some texels and a hole, which no mirror image or turn leaves as it
    is. At the texture's border, where it is mixed with the other side, it is below the cutoffs."""
    v, u = (np.mgrid[:size, :size] + 0.5) / size
    along, across = u - 0.45, v - 0.55
    leaf = 1 - ((along + 0.8 * across) / 0.42) ** 2 - ((across - 0.3 * along) / 0.3) ** 2
    hole = ((u - 0.6) / 0.12) ** 2 + ((v - 0.45) / 0.12) ** 2 - 1
    alpha = np.clip(0.5 + size / 40 * np.minimum(leaf, hole), 0, 1)
    return np.round(255 * alpha).astype(np.float32) / 255


def veil_alpha(size):
    """Smooth, different along both axes, and periodic."""
    v, u = 2 * np.pi * (np.mgrid[:size, :size] + 0.5) / size
    alpha = 0.5 + 0.3 * np.sin(u) + 0.2 * np.cos(v + 0.5 * np.sin(2 * u))
    return np.round(255 * alpha).astype(np.float32) / 255


def make_materials():
    return [
        Material(cutoff=0.4, texture=Texture(leaf_alpha(32))),
        Material(cutoff=0.6, texture=Texture(leaf_alpha(48), nearest=True, wrap="clamp")),
        Material(factor=0.9, texture=Texture(veil_alpha(16))),
    ]


def make_cards(count=240, seed=1):
    """Cards at random in a ball 2 m above a ground; returns meshes for write_glb()."""
    rng = np.random.default_rng(seed)
    meshes = [card_mesh(rng, count // 3, material) for material in make_materials()]
    # The veil repeats along u, and begins inside its texture.
    meshes[2].uv = meshes[2].uv * [2.0, 1.0] + [0.3, 0.1]
    h = GROUND_HALF
    ground = np.array([[-h, 0, h], [h, 0, h], [h, 0, -h], [-h, 0, -h]], np.float32)
    return [*meshes, Mesh(ground, SQUARE, Material())]


def card_mesh(rng, count, material):
    positions, uv, triangles = [], [], []
    for card in range(count):
        offset = rng.normal(size=3)
        centre = [0, 2, 0] + 1.6 * offset / np.linalg.norm(offset) * rng.random() ** (1 / 3)
        axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        right, up = 0.3 * axes[0], 0.4 * axes[1]
        corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        positions += [centre + x * right + y * up for x, y in corners]
        uv += [[0, 1], [1, 1], [1, 0], [0, 0]]
        triangles.append(SQUARE + 4 * card)
    return Mesh(
        np.array(positions, np.float32),
        np.concatenate(triangles),
        material,
        np.array(uv, np.float32),
    )

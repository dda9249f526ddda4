"""The six scenes: a file for dapple, the same geometry for Mitsuba, a camera and lights."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cards import make_cards
from geometry import Material, Mesh
from glb import read_glb, write_glb
from lights import make_lights
from strands import make_strands, write_hair

WORLD_UP = [0.0, 1.0, 0.0]


@dataclass
class Camera:
    look_from: list
    look_at: list
    fov_degrees: float  # vertical


@dataclass
class Scene:
    """`content`: the meshes and strands of `file`. The lights are around `centre`. `options`: more
    words for dapple's command line."""

    name: str
    file: Path
    content: list
    camera: Camera
    centre: list
    lights: list
    options: tuple = ()


def procedural(name, parameters, camera, centre, size):
    """A scene of dapple's, written as GLB, which both renderers then read."""

    def make(folder, dapple):
        path = folder / f"{name}.glb"
        dapple.run("scene", name, *parameters, "-o", str(path))
        return Scene(name, path, read_glb(path), camera, centre, make_lights(centre, size))

    return make


def make_strand_scene(folder, _):
    """With dapple's own ground: a square under the lowest point, 20 times as wide as the strands."""
    strands = make_strands(600, opacity=0.4)
    path = folder / "strands.hair"
    write_hair(path, strands)
    camera = Camera([1.4, 1.5, 2.4], [0, 0.3, 0], 38)
    centre = [0, 0.4, 0]
    content = [strands, ground_under(strands)]
    lights = make_lights(centre, 1.5)
    return Scene("strands", path, content, camera, centre, lights, ("--ground",))


def ground_under(strands):
    """docs/guide.md: an opaque square under the lowest point, 20 times as wide as the scene."""
    low = (strands.points - strands.radii[:, :, None]).min(axis=(0, 1))
    high = (strands.points + strands.radii[:, :, None]).max(axis=(0, 1))
    half = 10 * max(high[0] - low[0], high[2] - low[2])
    x, z = (low[0] + high[0]) / 2, (low[2] + high[2]) / 2
    corners = [(-half, half), (half, half), (half, -half), (-half, -half)]
    positions = np.array([[x + dx, low[1], z + dz] for dx, dz in corners], np.float32)
    return Mesh(positions, np.array([[0, 1, 2], [0, 2, 3]]), Material())


def make_card_scene(folder, _):
    path = folder / "cards.glb"
    write_glb(path, make_cards())
    camera = Camera([2.5, 3.2, 6.0], [0, 1.6, 0], 38)
    centre = [0, 2, 0]
    return Scene("cards", path, read_glb(path), camera, centre, make_lights(centre, 3.0))


SCENES = {
    "tree": procedural(
        "tree", ["leaves=6000"], Camera([3, 3, 13], [0, 5.2, 0], 21), [0, 4.5, 0], 6.0
    ),
    "cloud": procedural(
        "cloud",
        ["leaves=5000", "leaf_size=0.2", "opacity=0.5"],
        Camera([-2, 3.5, 7], [0, 2.5, 0], 26),
        [0, 2.5, 0],
        3.0,
    ),
    "forest": procedural(
        "forest",
        ["trees=9", "leaves=1500", "species=2", "seed=3"],
        Camera([14, 12, 26], [0, 2, 0], 28),
        [0, 3, 0],
        12.0,
    ),
    "stack": procedural(
        "stack", ["layers=4", "gap=0.3"], Camera([1.5, 2.2, 3.5], [0, 0.5, 0], 38), [0, 0.6, 0], 1.5
    ),
    "strands": make_strand_scene,
    "cards": make_card_scene,
}

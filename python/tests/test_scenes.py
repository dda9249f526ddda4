"""Scenes as Python objects: copies, and what is said where they are far from the origin."""

import copy
import pickle
from pathlib import Path

import dapple
import numpy as np
import pytest
from conftest import plate_scene


def test_copies_are_changed_alone() -> None:
    scene = plate_scene(0.5)
    for other in (scene.copy(), copy.copy(scene), copy.deepcopy(scene)):
        other.add_sun([0, 1, 0])
        other.set_opacity("0", 1.0)
        assert other.lights == ["sun"]
        assert other.occlusion([[0, 0, 0]], [0, 1, 0])[0] < scene.occlusion([[0, 0, 0]], [0, 1, 0])[0]
    assert scene.lights == []


def test_scenes_and_pictures_say_that_they_cannot_be_pickled() -> None:
    scene = plate_scene(0.5)
    with pytest.raises(TypeError, match="load it in each process"):
        pickle.dumps(scene)
    with pytest.raises(TypeError, match="save"):
        pickle.dumps(scene.render(width=8, height=8, spp=1))


def test_map_coordinates_are_warned_of() -> None:
    corners = np.array([[-1, 1, -1], [1, 1, -1], [1, 1, 1]]) + [5e5, 0, 4.5e6]
    with pytest.warns(UserWarning, match="steps of 0.5"):
        dapple.Scene.from_arrays(corners, [[0, 1, 2]])


def test_lights_of_two_files_have_random_numbers_of_their_own(tmp_path: Path) -> None:
    path = tmp_path / "lamp.json"
    path.write_text(
        '{"lights": [{"name": "lamp", "type": "sphere", "position": [0, 3, 0], "radius": 1, '
        '"radiance": [9, 9, 9]}]}'
    )
    scene = plate_scene(0.5)
    scene.add_lights(path)
    scene.add_lights(path)
    lit = list(scene.irradiance([[0.3, 0, 0.4]], [0, 1, 0]).values())
    assert len(lit) == 2
    assert lit[0].unoccluded[0, 0] != lit[1].unoccluded[0, 0]

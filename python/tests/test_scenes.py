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


def test_materials_may_be_names_in_an_array_of_objects() -> None:
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    names = np.array(["leaf", "stem"], object)  # as columns of pandas are
    scene = dapple.Scene.from_arrays(vertices, [[0, 1, 2], [0, 2, 1]], 1.0, names)
    assert scene.materials == ["leaf", "stem"]
    with pytest.raises(dapple.UsageError, match="materials is masked"):
        dapple.Scene.from_arrays(
            vertices, [[0, 1, 2], [0, 2, 1]], 1.0, np.ma.array([1, 2], mask=[0, 1])
        )


def test_the_sky_that_is_added_has_its_name() -> None:
    scene = dapple.load("scene:demo")
    scene.add_sky("uniform", 100)
    columns = scene.measure([[0, 50, 0]], rays=64)
    assert columns["sky_r"][0] == pytest.approx(100, rel=0.1)
    assert any("called sky" in warning for warning in scene.warnings)


def test_a_picture_equals_itself_alone() -> None:
    scene = dapple.load("scene:cube")
    first, second = (scene.render(width=8, height=8, spp=1) for _ in range(2))
    assert first == first and first != second
    assert {first: 1}[first] == 1 and second not in [first]


def test_materials_of_arrays_are_called_as_asked_or_in_order_of_the_triangles() -> None:
    corners = [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]]
    faces = [[0, 1, 2], [0, 2, 3]]
    assert dapple.Scene.from_arrays(corners, faces, [0.8, 0.2]).materials == ["0", "1"]
    organs = dapple.Scene.from_arrays(corners, faces, 1, ["stem", "leaf"])
    assert organs.materials == ["stem", "leaf"]
    numbered = dapple.Scene.from_arrays(corners, faces, 1, np.array([7, 3]))
    assert numbered.materials == ["7", "3"]
    # Without the first triangle half of the sky above the square is open.
    first_gone = dapple.Scene.from_arrays(corners, faces, [0.8, 0.2])
    for scene, name in ((organs, "stem"), (numbered, "7"), (first_gone, "0")):
        scene.set_opacity(name, 0)
        of_first = scene.occlusion([[0.3, 0.99, -0.3]], [0, 1, 0], rays=64)[0]
        of_second = scene.occlusion([[-0.3, 0.99, 0.3]], [0, 1, 0], rays=64)[0]
        assert of_first > 0.9 > of_second


def test_flags_and_paths_of_other_libraries_are_taken(tmp_path: Path) -> None:
    tree = dapple.load("scene:tree?leaves=100")
    picture = tree.render(width=8, height=8, spp=1, albedo=np.bool_(False), cache=tmp_path)  # type: ignore[typeddict-item]
    assert "albedo" not in picture
    columns = tree.measure([[0, 0.01, 0.5]], rays=8)
    assert columns.copy().bias == columns.bias and list(columns.copy()) == list(columns)
    assert tree.meshes[0] != tree.meshes[0]  # arrays do not compare

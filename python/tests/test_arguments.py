"""Wrong arguments are exceptions of one line; odd layouts of arrays do not matter."""

from typing import Any, Callable

import dapple
import numpy as np
import pytest
from conftest import plate_scene

UP = [0, 1, 0]


def error_of(call: Callable[[], Any], kind: type[dapple.Error] = dapple.UsageError) -> str:
    with pytest.raises(kind) as caught:
        call()
    text = str(caught.value)
    assert "\n" not in text
    return text


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([1, 2, 3], "points has the shape (3,); it must be (n, 3)"),
        (np.zeros((4, 2)), "points has the shape (4, 2); it must be (n, 3)"),
        (np.zeros((2, 2, 3)), "points has the shape (2, 2, 3)"),
        ([[0, 0, np.nan]], "points[0] is not finite"),
        ([[0, 0, 0], [np.inf, 0, 0]], "points[1] is not finite"),
        ([[0, 0, 1e300]], "points[0] is not finite"),
        ("abc", "it must be of numbers"),
        ([[1, 2], [3]], "points is not an array of numbers"),
        (np.zeros((1, 3), complex), "it must be of numbers"),
        (None, "it must be of numbers"),
    ],
)
def test_wrong_points_are_named(plate: dapple.Scene, points: Any, message: str) -> None:
    for call in (plate.occlusion, plate.irradiance, plate.measure):
        assert message in error_of(lambda: call(points, UP))


def test_wrong_normals_are_named(plate: dapple.Scene) -> None:
    at = np.zeros((2, 3))
    assert "normals has 3 vectors, but there are 2" in error_of(
        lambda: plate.occlusion(at, [UP, UP, UP])
    )
    assert "normals[1] has the length 2, not 1" in error_of(
        lambda: plate.occlusion(at, [UP, [0, 2, 0]])
    )


def test_wrong_options_are_named(plate: dapple.Scene) -> None:
    at = [[0, 0, 0]]
    assert "did you mean rays?" in error_of(lambda: plate.occlusion(at, UP, ray=4))
    assert "did you mean progress?" in error_of(lambda: plate.occlusion(at, UP, progres=print))
    assert "did you mean progress?" in error_of(lambda: plate.render(progres=print))
    assert "did you mean device?" in error_of(lambda: plate.irradiance(at, UP, devic=""))
    assert "known are" in error_of(lambda: plate.occlusion(at, UP, zzz=4))
    assert "rays is 'x'; it must be int" in error_of(lambda: plate.occlusion(at, UP, rays="x"))
    assert "from 1 to" in error_of(lambda: plate.occlusion(at, UP, rays=0))
    assert "rays is " in error_of(lambda: plate.occlusion(at, UP, rays=1 << 40))
    assert "known are exact, prefiltered" in error_of(
        lambda: plate.occlusion(at, UP, estimator="e")
    )
    assert "three vectors" in error_of(lambda: plate.render(look=(1, 2)))
    assert "four integers" in error_of(lambda: plate.render(crop=(1, 2)))
    assert "--width" in error_of(lambda: plate.render(width=0))
    assert "numbers by the materials' names" in error_of(lambda: plate.render(opacity=3))
    assert "leaf" in error_of(lambda: plate.render(opacity={"leaf": 0.5}, width=8, height=8))
    assert "--rings" in error_of(lambda: plate.measure(at, rings=-1))
    assert "sun_irradiance" in error_of(lambda: plate.measure(at, suns=[UP], sun_irradiance=[1, 2]))


def test_wrong_scenes_are_named(tmp_path: Any) -> None:
    assert "no such file" in error_of(lambda: dapple.load("nothing.glb"), dapple.InputError)
    (tmp_path / "bad.gltf").write_text("{")
    assert "bad.gltf" in error_of(lambda: dapple.load(tmp_path / "bad.gltf"), dapple.InputError)
    corners = np.zeros((3, 3))
    assert "index 3, but there are 3" in error_of(
        lambda: dapple.Scene.from_arrays(corners, [[0, 1, 3]])
    )
    assert "index -1" in error_of(lambda: dapple.Scene.from_arrays(corners, [[0, 1, -1]]))
    assert "it must be (m, 3)" in error_of(lambda: dapple.Scene.from_arrays(corners, [0, 1, 2]))
    assert "of whole numbers" in error_of(
        lambda: dapple.Scene.from_arrays(corners, [[0.5, 1, 2]])
    )
    assert "outside of [0, 1]" in error_of(
        lambda: dapple.Scene.from_arrays(corners, [[0, 1, 2]], opacity=2)
    )
    assert "outside of [0, 1]" in error_of(
        lambda: dapple.Scene.from_arrays(corners, [[0, 1, 2]], opacity=float("nan"))
    )
    assert "one for each of 1 triangles" in error_of(
        lambda: dapple.Scene.from_arrays(corners, [[0, 1, 2]], opacity=[1, 1])
    )
    assert "there is no mesh" not in error_of(lambda: plate_scene().add_sun([0, 0, 0]))


def test_devices_are_named(plate: dapple.Scene) -> None:
    message = error_of(lambda: plate.occlusion([[0, 0, 0]], UP, device="zzz"), dapple.DeviceError)
    assert dapple.devices()[0] in message


def test_errors_have_usual_bases() -> None:
    assert issubclass(dapple.UsageError, ValueError)
    for kind in (dapple.UsageError, dapple.InputError, dapple.DeviceError):
        assert issubclass(kind, dapple.Error)


def test_no_points_give_no_values(plate: dapple.Scene) -> None:
    plate.add_sun([0, 1, 0])
    assert plate.occlusion([], UP).shape == (0,)
    assert plate.occlusion(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0,)
    assert plate.irradiance([], UP)["sun"].irradiance.shape == (0, 3)
    assert plate.measure([])["ao"].shape == (0,)


def test_scenes_without_triangles_are_refused() -> None:
    empty = dapple.Scene.from_arrays(np.zeros((0, 3)), np.zeros((0, 3), int))
    for call in (empty.occlusion, empty.irradiance, empty.measure):
        assert "no triangle or strand is left" in error_of(
            lambda: call([[0, 0, 0]], UP), dapple.InputError
        )


def test_layouts_do_not_matter(tree: dapple.Scene, ground: np.ndarray) -> None:
    expected = tree.occlusion(ground, UP)
    read_only = ground.copy()
    read_only.flags.writeable = False
    wide = np.zeros((len(ground), 6), np.float32)
    wide[:, ::2] = ground
    for points in (
        ground.astype(np.float64),
        np.asfortranarray(ground),
        wide[:, ::2],
        read_only,
        ground.astype(">f4"),
        ground.tolist(),
    ):
        np.testing.assert_array_equal(tree.occlusion(points, UP), expected)
    np.testing.assert_array_equal(
        tree.occlusion(ground[::-1], UP), tree.occlusion(np.ascontiguousarray(ground[::-1]), UP)
    )

"""Every argument with values of wrong types, shapes and ranges: one line that names it, no crash."""

from typing import Any, Callable

import dapple
import numpy as np
import pytest
from conftest import plate_scene
from test_arguments import error_of

UP = [0, 1, 0]
AT = [[0, 0, 0]]
CORNERS = [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]]
TRIANGLES = [[0, 1, 2], [0, 2, 3]]
NAN = float("nan")
SMALL = {"width": 8, "height": 8, "spp": 1}

from_arrays = dapple.Scene.from_arrays
Call = Callable[[dapple.Scene], Any]

WRONG: dict[str, Call] = {
    "normals[0] is not finite": lambda s: s.occlusion(AT, [[0, NAN, 0]]),
    "normals has the type": lambda s: s.occlusion(AT, "up"),
    "normals has the shape (1, 2)": lambda s: s.occlusion(AT, [[0, 1]]),
    "normals[0] has the length 0": lambda s: s.irradiance(AT, [0, 0, 0]),
    "points has the type object": lambda s: s.occlusion(np.array([[0, 0, object()]]), UP),
    "points has the type datetime64": lambda s: s.occlusion(np.zeros((1, 3), "M8[s]"), UP),
    "points has the type bool": lambda s: s.measure([[True, False, True]]),
    "points has the shape ()": lambda s: s.measure(0.5),
    "points has masked values": lambda s: s.measure(np.ma.masked_less([[0.0, -1.0, 0.0]], 0)),
    "points has masked values; leave": lambda s: s.measure([np.ma.masked_less([0.0, -9.0, 0.0], 0)]),
    "sun_irradiance and per_sun need suns": lambda s: s.measure(AT, sun_irradiance=900),
    "need suns": lambda s: s.measure(AT, per_sun=True),
    "suns has the type": lambda s: s.measure(AT, suns="noon"),
    "suns has the shape (3,)": lambda s: s.measure(AT, suns=UP),
    "suns[0] is not finite": lambda s: s.measure(AT, suns=[[0, NAN, 0]]),
    "suns[0] has the length 2": lambda s: s.measure(AT, suns=[[0, 2, 0]]),
    "sun_irradiance has the type": lambda s: s.measure(AT, suns=[UP], sun_irradiance="strong"),
    "sun_irradiance has a value": lambda s: s.measure(AT, suns=[UP], sun_irradiance=NAN),
    "sun_irradiance has a value ": lambda s: s.measure(AT, suns=[UP], sun_irradiance=-1),
    "sun_irradiance has the shape (2,)": lambda s: s.measure(AT, suns=[UP], sun_irradiance=[1, 2]),
    "periodic has the shape (1,)": lambda s: s.measure(AT, periodic=(1,)),  # type: ignore[arg-type]
    "periodic is 'ab'": lambda s: s.measure(AT, periodic="ab"),  # type: ignore[arg-type]
    "periodic is not finite": lambda s: s.measure(AT, periodic=(NAN, 1)),
    "periodic is (0, 0); it must be two": lambda s: s.measure(AT, periodic=(0, 0)),
    "periodic is (2, 1e-50); it must be two": lambda s: s.measure(AT, periodic=(2, 1e-50)),
    "--periodic is -1": lambda s: s.measure(AT, periodic=(-1, 1)),
    "value is 'x'": lambda s: s.set_opacity("0", "x"),  # type: ignore[arg-type]
    "outside [0, 1]": lambda s: s.set_opacity("0", NAN),
    'no material "zzz"': lambda s: s.set_opacity("zzz", 0.5),
    "material is 3": lambda s: s.set_opacity(3, 0.5),  # type: ignore[arg-type]
    "direction has the shape (2,)": lambda s: s.add_sun([0, 1]),
    "direction is 'abc'": lambda s: s.add_sun("abc"),  # type: ignore[arg-type]
    "direction is not finite": lambda s: s.add_sun([0, NAN, 0]),
    "direction has no length": lambda s: s.add_sun([0, 0, 0]),
    "irradiance must be 0 or more": lambda s: s.add_sun(UP, irradiance=NAN),
    "irradiance is too large for so": lambda s: s.add_sun(UP, angular_diameter=1e-20),
    "irradiance is too large: radi": lambda s: s.add_sky(irradiance=1e38),
    "angular_diameter must be above 0": lambda s: s.add_sun(UP, angular_diameter=-3),
    "name is 3": lambda s: s.add_sun(UP, name=3),  # type: ignore[arg-type]
    "kind is 3": lambda s: s.add_sky(3),  # type: ignore[arg-type]
    "irradiance is nan": lambda s: s.add_sky(irradiance=NAN),
    "irradiance is -1": lambda s: s.add_sky(irradiance=-1),
    "rotation is inf": lambda s: s.add_sky(rotation=float("inf")),
    "light-radius is 0": lambda s: dapple.load("scene:tree?leaves=9", light_radius=0),
    "line_radius is 'x'": lambda s: dapple.load("scene:tree?leaves=9", line_radius="x"),  # type: ignore[arg-type]
    "path is 3": lambda s: s.add_lights(3),  # type: ignore[arg-type]
    "vertices[0] is not finite": lambda s: from_arrays([[0, 0, NAN]] * 3, [[0, 1, 2]]),
    "vertices has the type object": lambda s: from_arrays(None, TRIANGLES),  # type: ignore[arg-type]
    "triangles has the type bool": lambda s: from_arrays(CORNERS, np.ones((1, 3), bool)),
    "triangles has the index 9223": lambda s: from_arrays(
        CORNERS, np.array([[0, 1, 1 << 63]], np.uint64)
    ),
    "triangles has the type float64; it must be of whole numbers": lambda s: from_arrays(
        CORNERS, [[0.0, 1.0, 2.0]]
    ),
    "triangles has the shape (1, 4)": lambda s: from_arrays(CORNERS, [[0, 1, 2, 3]]),
    "opacity has the shape (1, 2)": lambda s: from_arrays(CORNERS, TRIANGLES, [[1, 1]]),
    "opacity has the type": lambda s: from_arrays(CORNERS, TRIANGLES, "half"),
    "progress is 3": lambda s: s.occlusion(AT, UP, progress=3),  # type: ignore[arg-type]
    "device is 3": lambda s: s.irradiance(AT, UP, device=3),  # type: ignore[arg-type]
    "device is None": lambda s: s.render(device=None, **SMALL),  # type: ignore[typeddict-item]
    "path is None": lambda s: dapple.load(None),  # type: ignore[arg-type]
    "finite number of seconds": lambda s: dapple.load("scene:tree?leaves=9", time=NAN),
    "time is 'x'": lambda s: dapple.load("scene:tree?leaves=9", time="x"),  # type: ignore[arg-type]
    "animation is 3": lambda s: dapple.load("scene:tree?leaves=9", animation=3),  # type: ignore[arg-type]
    "scenes are made by": lambda s: dapple.Scene(3),  # type: ignore[arg-type]
    "occluders is 3": lambda s: s.bake(occluders=3),  # type: ignore[arg-type]
    "it must be a list of scenes": lambda s: s.bake(occluders=s),  # type: ignore[arg-type]
    "--rays is -1": lambda s: s.bake(rays=-1),
    "--size is 0": lambda s: s.bake(texture=True, texture_size=0),
    "texture_uvs[0] has the shape (4, 3); it must be (n, 2)": lambda s: s.bake(texture_uvs=[CORNERS]),
    "has 3 for 4 vertices": lambda s: s.bake(texture=True, texture_uvs=[[(0, 0)] * 3]),
    "has (0, 2) at vertex": lambda s: s.bake(texture=True, texture_uvs=[[(0, 2)] * 4]),
    'sides is "x"': lambda s: s.bake(sides="x"),  # type: ignore[typeddict-item]
    "--look-from has the coordinate nan": lambda s: s.render(
        look=[(0, NAN, 0), (0, 0, 0), (0, 1, 0)], **SMALL
    ),
    "--fov is nan": lambda s: s.render(fov_degrees=NAN, **SMALL),
    "--width is 1000000": lambda s: s.render(width=1_000_000),
    "width is 8.5": lambda s: s.render(width=8.5),  # type: ignore[typeddict-item]
    "--crop 4,4,99,99": lambda s: s.render(crop=(4, 4, 99, 99), **SMALL),
    "footprint is nan": lambda s: s.occlusion(AT, UP, footprint=NAN),
    "footprint is -1": lambda s: s.irradiance(AT, UP, footprint=-1),
    "distance is nan": lambda s: s.occlusion(AT, UP, distance=NAN),
    "falloff is nan": lambda s: s.occlusion(AT, UP, distance=1, falloff=NAN),
    "seed is 4294967296; it must be from 0 to 4294967295": lambda s: s.occlusion(
        AT, UP, seed=2**32
    ),
    "rays is 1099511627776; it must be from": lambda s: s.measure(AT, rays=2**40),
    "known are ao, bent, cache": lambda s: s.measure(AT, zzz=1),  # type: ignore[call-arg]
    "did you mean periodic?": lambda s: s.measure(AT, period_x=1),  # type: ignore[call-arg]
    "the scene has no lights": lambda s: s.bake(light=True),
    "seed is -1; it must be from 0": lambda s: s.occlusion(AT, UP, seed=-1),
    "rays is None": lambda s: s.occlusion([], UP, rays=None),  # type: ignore[typeddict-item]
    "there is no layer zzz": lambda s: s.render(**SMALL).save("/tmp/a.png", layer="zzz"),
    "compression is \"x\"; known are zip": lambda s: s.render(**SMALL).save("/tmp/a.exr", compression="x"),  # type: ignore[arg-type]
    "half is 'ao'; it must be a list": lambda s: s.render(**SMALL).save("/tmp/a.exr", half="ao"),
    "--half": lambda s: s.render(**SMALL).save("/tmp/a.exr", half=["Z"]),
    "exposure is nan": lambda s: s.render(**SMALL).save("/tmp/a.png", exposure=NAN),
    "colours are from 0 to 1": lambda s: s.render(**SMALL).save("/tmp/a.png", background=(2, 0, 0)),
    "background is 'x'": lambda s: s.render(**SMALL).save("/tmp/a.png", background="x"),  # type: ignore[arg-type]
    "render it with deep=True": lambda s: s.render(**SMALL).save_deep("/tmp/a.exr"),
    "half: there is no layer zzz": lambda s: s.render(**SMALL).save("/tmp/a.exr", half=["ao", "zzz"]),
    "layer is for .png": lambda s: s.render(**SMALL).save("/tmp/a.exr", layer="ao"),
    "scenes are saved as .glb": lambda s: s.save("/tmp/a.gltf"),
    "back_every needs back=True": lambda s: s.render(back_every=2, **SMALL),
    "max_spp needs target_rmse or target_error": lambda s: s.render(max_spp=2, **SMALL),
    "fov_degrees is 0; it must be from 0.01 to 179": lambda s: s.render(fov_degrees=0, **SMALL),
    "texture_size needs texture=True": lambda s: s.bake(texture_size=64),
    "margin needs texture=True": lambda s: s.bake(margin=1),
    "texture_uvs needs texture=True": lambda s: s.bake(texture_uvs=[np.zeros((4, 2))]),
    "light_rays needs light=True": lambda s: s.bake(light_rays=2),
    "--ground needs --instances together": lambda s: s.bake(placement="alone", ground=True),
    "nothing is baked": lambda s: s.bake(vertices=False),
    "bake(): max_bias is None; it must be a number": lambda s: s.bake(max_bias=None),  # type: ignore[typeddict-item]
    "materials has the shape (1,)": lambda s: from_arrays(CORNERS, [[0, 1, 2]] * 2, 1, ["leaf"]),
    "materials has the shape (1,) and the type float": lambda s: from_arrays(CORNERS, TRIANGLES, 1, [0.5]),
    "opacity differs between triangles of the material 'leaf'": lambda s: from_arrays(
        CORNERS, [[0, 1, 2]] * 2, [0.5, 1], ["leaf", "leaf"]
    ),
    "saved as .exr or .png": lambda s: s.render(**SMALL).save("/tmp/a.jpg"),
}


@pytest.mark.parametrize(("message", "call"), WRONG.items(), ids=list(WRONG))
def test_wrong_values_are_named(message: str, call: Call) -> None:
    scene = plate_scene()
    text = error_of(lambda: call(scene))
    assert message.strip() in text
    assert scene.occlusion(AT, UP).shape == (1,)  # and the scene still works


def test_files_that_cannot_be_written_are_named() -> None:
    scene = plate_scene()
    for call in (
        lambda: scene.save("/nowhere/a.glb"),
        lambda: scene.render(**SMALL).save("/nowhere/a.exr"),
    ):
        assert "there is no folder /nowhere" in error_of(call, dapple.Error)


def test_layouts_of_scenes_do_not_matter() -> None:
    expected = plate_scene(0.5).occlusion(AT, UP)
    corners = np.array(CORNERS, np.float64)
    wide = np.zeros((4, 6))
    wide[:, ::2] = corners
    frozen = corners.astype(np.float32)
    frozen.flags.writeable = False
    triangles = np.array(TRIANGLES)
    opacities = np.full(4, 0.5)
    for vertices in (np.asfortranarray(corners), wide[:, ::2], frozen, corners.astype(">f8")):
        for faces in (triangles.astype(np.uint8), np.asfortranarray(triangles), triangles.astype(">i8")):
            scene = from_arrays(vertices, faces, opacities[::2])
            np.testing.assert_array_equal(scene.occlusion(AT, UP), expected)


def test_layouts_of_normals_do_not_matter(ground: np.ndarray) -> None:
    scene = plate_scene()
    up = np.broadcast_to(np.array(UP, np.float64), ground.shape)  # strides of 0, read-only
    expected = scene.occlusion(ground, UP)
    for normals in (up, np.asfortranarray(up), up.astype(np.float16)):
        np.testing.assert_array_equal(scene.occlusion(ground, normals), expected)


def test_arguments_are_not_changed(ground: np.ndarray) -> None:
    points, normals = ground.copy(), np.tile(np.array(UP, np.float32), (len(ground), 1))
    plate_scene().measure(points, normals)
    np.testing.assert_array_equal(points, ground)
    assert (normals == UP).all()


def test_arrays_of_scenes_are_copies() -> None:
    corners = np.array(CORNERS, np.float32)
    scene = from_arrays(corners, TRIANGLES)
    corners[:] = NAN
    assert np.isfinite(scene.bounds).all() and np.isfinite(scene.occlusion(AT, UP)).all()


def test_pictures_have_no_layers_of_other_types() -> None:
    picture = plate_scene().render(**SMALL)
    assert 5 not in picture
    with pytest.raises(KeyError):
        picture[0]  # type: ignore[index]

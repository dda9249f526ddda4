"""What calls return: closed forms, and the program's numbers."""

import subprocess
from pathlib import Path

import dapple
import numpy as np
import pytest
from conftest import plate_scene


def cosine_form_factor(half: float, height: float) -> float:
    """Of a square of side 2 `half` from a point below its centre (Siegel and Howell, four corners)."""
    x = half / height
    r = np.sqrt(1 + x * x)
    return 4 * (x / r * np.arctan(x / r)) / np.pi


@pytest.mark.parametrize("estimator", ["exact", "prefiltered"])
@pytest.mark.parametrize("opacity", [1.0, 0.4])
def test_occlusion_below_a_square_is_its_form_factor(estimator: str, opacity: float) -> None:
    scene = plate_scene(opacity)
    ao = scene.occlusion([[0, 0, 0]], [0, 1, 0], rays=1 << 16, estimator=estimator)
    # 65,536 rays: a standard error of at most 0.002.
    assert ao[0] == pytest.approx(1 - opacity * cosine_form_factor(1, 1), abs=0.008)


def test_opacity_may_differ_from_triangle_to_triangle() -> None:
    corners = [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]]
    scene = dapple.Scene.from_arrays(corners, [[0, 1, 2], [0, 2, 3]], [0.2, 0.8])
    ao = scene.occlusion([[0, 0, 0]], [0, 1, 0], rays=1 << 16)
    assert ao[0] == pytest.approx(1 - 0.5 * cosine_form_factor(1, 1), abs=0.008)


def test_irradiance_of_a_sun_is_its_cosine(plate: dapple.Scene) -> None:
    plate.add_sun([0, 3e20, 4e20], irradiance=10)
    found = plate.irradiance([[0, 0, 0], [9, 0, 9]], [0, 1, 0], rays=256)["sun"]
    np.testing.assert_allclose(found.unoccluded, 6, rtol=1e-3)
    np.testing.assert_allclose(found.irradiance[1], 6, rtol=1e-3)
    overhead = plate_scene()
    overhead.add_sun([0, 1, 0], irradiance=10)
    assert overhead.irradiance([[0, 0, 0]], [0, 1, 0])["sun"].irradiance.max() == 0


def test_skies_have_their_irradiance_on_open_ground(plate: dapple.Scene) -> None:
    plate.add_sky("overcast", irradiance=120)
    found = plate.irradiance([[50, 0, 50]], [0, 1, 0], rays=4096)["sky"]
    assert found.unoccluded[0, 0] == pytest.approx(120, rel=0.01)


def test_skies_turn_as_those_of_the_program(
    program: str, tree: dapple.Scene, ground: np.ndarray, tmp_path: Path
) -> None:
    """Of an image that is white in one half, grey in the other."""
    sky, points, out = (tmp_path / name for name in ("half.hdr", "points.npy", "out.npy"))
    pixels = np.full((4, 8, 4), 128, np.uint8)  # red, green, blue, exponent
    pixels[:, 4:, 3] = 129
    sky.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n" + pixels.tobytes())
    np.save(points, ground)
    arguments = [program, "points", tree._native.source, "--at", points, "-o", out, "-q"]
    subprocess.run([*arguments, "--sky", sky, "--sky-rotation", "90"], check=True)
    table = np.load(out)
    straight, turned = (dapple.load(tree._native.source) for _ in range(2))
    straight.add_sky(sky)
    turned.add_sky(sky, rotation=90)
    columns = turned.measure(ground)
    names = [name for name in columns if name.startswith("sky")]
    assert names
    for name in names:
        np.testing.assert_array_equal(table[name], columns[name])
    before = straight.measure(ground)
    assert any((before[name] != columns[name]).any() for name in names)


def test_measure_has_the_columns_of_the_program(
    program: str, tree: dapple.Scene, ground: np.ndarray, tmp_path: Path
) -> None:
    points = tmp_path / "points.npy"
    out = tmp_path / "out.npy"
    np.save(points, ground)
    arguments = [program, "points", tree._native.source, "--at", points, "-o", out, "-q"]
    subprocess.run([*arguments, "--rings", "5"], check=True)
    table = np.load(out)
    columns = tree.measure(ground, rings=5)
    assert list(table.dtype.names or ()) == ["x", "y", "z", "nx", "ny", "nz", *columns]
    for name, values in columns.items():
        np.testing.assert_array_equal(table[name], values)


def test_the_same_call_gives_the_same_bits(tree: dapple.Scene, ground: np.ndarray) -> None:
    first = tree.occlusion(ground, [0, 1, 0])
    np.testing.assert_array_equal(first, tree.occlusion(ground, [0, 1, 0]))
    assert (first != tree.occlusion(ground, [0, 1, 0], seed=1)).any()


def test_pictures_are_arrays_and_files(tree: dapple.Scene, tmp_path: Path) -> None:
    fractions: list[float] = []
    picture = tree.render(width=32, height=18, spp=4, progress=fractions.append)
    assert picture["ao"].shape == (18, 32, 3)
    assert picture["ao.R"].shape == (18, 32)
    assert picture["Z"].shape == (18, 32)
    assert not picture["ao.R"].flags.writeable
    np.testing.assert_array_equal(picture["ao"][..., 0], picture["ao.R"])
    assert set(picture) >= {"ao", "N", "P", "Z", "RGBA"}
    assert fractions == sorted(fractions) and fractions[-1] <= 1
    with pytest.raises(KeyError):
        picture["nothing"]
    for name in ("a.exr", "a.png"):
        picture.save(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 100


def test_pictures_are_saved_as_asked(tmp_path: Path) -> None:
    picture = plate_scene(0.5).render(width=32, height=32, spp=4, deep=True)
    sizes = {}
    for name, options in {
        "plain": {}, "half": {"half": ["all"]}, "none": {"compression": "none"},
        "parts": {"compression": "dwaa", "multipart": True},
    }.items():
        picture.save(tmp_path / f"{name}.exr", **options)  # type: ignore[arg-type]
        sizes[name] = (tmp_path / f"{name}.exr").read_bytes()
    assert len(sizes["half"]) < len(sizes["plain"]) < len(sizes["none"])
    assert b"multiView" not in sizes["plain"] and b"scanlineimage" in sizes["parts"]
    for name, options in {"auto": {}, "dark": {"exposure": -20}, "red": {"background": (1, 0, 0)}}.items():
        picture.save(tmp_path / f"{name}.png", **options)  # type: ignore[arg-type]
        sizes[name] = (tmp_path / f"{name}.png").read_bytes()
    assert len({sizes["auto"], sizes["dark"], sizes["red"]}) == 3
    picture.save_deep(tmp_path / "deep.exr")
    assert b"deepscanline" in (tmp_path / "deep.exr").read_bytes()


def test_cameras_and_crops(plate: dapple.Scene) -> None:
    look = [(0, 3, 0), (0, 0, 0), (0, 0, -1)]
    whole = plate.render(width=16, height=16, spp=4, look=look, fov_degrees=40, light=False)
    part = plate.render(
        width=16, height=16, spp=4, look=look, fov_degrees=40, light=False, crop=(4, 4, 7, 7)
    )
    np.testing.assert_array_equal(part["ao.R"], whole["ao.R"][4:8, 4:8])


def test_pictures_become_xarray(plate: dapple.Scene) -> None:
    pytest.importorskip("xarray")
    data = plate.render(width=8, height=4, spp=4, light=False).to_xarray()
    assert data["ao"].dims == ("y", "x", "channel_ao")
    assert data["Z"].shape == (4, 8)


def test_bakes_have_a_value_for_each_vertex(tree: dapple.Scene) -> None:
    baked = tree.bake(bent=True, instances=True, rays=64, target_error=0)
    for mesh, arrays in zip(tree.meshes, baked.meshes):
        assert arrays["ao"].shape == (len(mesh.positions),)
        assert arrays["bent"].shape == (len(mesh.positions), 3)
        assert 0 <= arrays["ao"].min() and arrays["ao"].max() <= 1
    assert baked.instance_ao.shape == (1,)
    assert baked.instance_light == {}


def test_instances_have_the_light_of_their_surface() -> None:
    square = plate_scene(half=0.5, height=0)
    square.clear_lights()
    square.add_sun((0, 1, 0), irradiance=2, name="noon")
    baked = square.bake(vertices=False, instances=True, light=True, sides="max")
    np.testing.assert_allclose(baked.instance_light["noon"], [[2, 2, 2]], rtol=1e-3)


def test_textures_have_the_given_coordinates() -> None:
    square, roof = plate_scene(half=1, height=0), plate_scene(half=0.25, height=0.25)
    square.set_opacity(square.materials[0], 1)
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    baked = square.bake(
        vertices=False, texture=True, bent=True, texture_size=32, sides="mean", rays=256,
        occluders=[roof], texture_uvs=[uvs],
    )
    texture = baked.texture
    assert texture is not None and baked.meshes == []
    np.testing.assert_array_equal(texture.uvs[0], uvs[[[0, 1, 2], [0, 2, 3]]])
    assert texture.coverage == pytest.approx(1) and texture.overlap == 0
    ao = texture.layers["ao"]
    assert ao.shape == (32, 32) and texture.layers["bent"].shape == (32, 32, 3)
    assert ao[14:18, 14:18].mean() < 0.8 < 0.95 < ao[[0, 0, -1, -1], [0, -1, 0, -1]].mean()


def test_textures_tell_how_far_triangles_overlap() -> None:
    square = plate_scene(half=1, height=0)
    folded = np.array([[0, 0], [1, 0], [1, 1], [1, 0.5]], np.float32)  # half of one on the other
    baked = square.bake(
        vertices=False, texture=True, texture_size=32, rays=8, target_error=0, texture_uvs=[folded]
    )
    assert baked.texture is not None
    assert baked.texture.overlap == pytest.approx(0.5, abs=0.06)


def test_ambient_is_the_sky_of_the_picture(plate: dapple.Scene) -> None:
    def mean(ambient: float) -> float:
        picture = plate.render(width=8, height=8, spp=4, light=False, ambient=ambient)
        return float(picture["RGBA"][..., :3].mean())

    assert mean(0) == 0
    assert mean(2) == pytest.approx(2 * mean(1), rel=1e-5)


def test_a_ground_is_where_it_is_put(plate: dapple.Scene) -> None:
    look = ((0, 5, 0.01), (0, 0, 0), (0, 1, 0))
    picture = plate.render(width=8, height=8, spp=4, look=look, ground=True, ground_height=-7)
    assert picture["P"][0, 0, 1] == pytest.approx(-7, abs=1e-3)


def test_bakes_are_darker_below_an_occluder(plate: dapple.Scene) -> None:
    low = plate_scene(half=0.5, height=0)
    free = low.bake(sides="max", rays=256).meshes[0]["ao"]
    occluded = low.bake(sides="max", rays=256, occluders=[plate]).meshes[0]["ao"]
    assert free.min() == 1
    # The other side of the square is unoccluded, so the mean of both sides is compared.
    assert low.bake(sides="mean", rays=256, occluders=[plate]).meshes[0]["ao"].max() < 0.95
    assert occluded.shape == free.shape


def test_meshes_are_views_and_round_trip(tree: dapple.Scene, tmp_path: Path) -> None:
    mesh = tree.meshes[0]
    assert mesh.positions.shape[1] == 3 and mesh.triangles.max() < len(mesh.positions)
    assert not mesh.positions.flags.writeable
    np.testing.assert_array_equal(mesh.instances[0], np.eye(4))
    tree.save(tmp_path / "tree.glb")
    again = dapple.load(tmp_path / "tree.glb")
    np.testing.assert_allclose(again.bounds, tree.bounds, atol=1e-5)


def test_views_stay_valid_after_changes_and_without_their_scene() -> None:
    scene = plate_scene()
    positions = scene.meshes[0].positions
    scene.add_ground()
    del scene
    np.testing.assert_array_equal(positions[:, 1], 1)


def test_scenes_change_between_calls(plate: dapple.Scene) -> None:
    before = plate.occlusion([[0, 0, 0]], [0, 1, 0])[0]
    plate.set_opacity(plate.materials[0], 0.01)
    assert before < 0.7 and plate.occlusion([[0, 0, 0]], [0, 1, 0])[0] > 0.98

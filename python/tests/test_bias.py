"""What calls say of the bias of their values: the program's figures, and none of exact rays."""

import json
import pickle
import subprocess
from pathlib import Path

import dapple
import numpy as np
import pytest


def test_bakes_have_the_bias_of_the_program(program: str, tree: dapple.Scene, tmp_path: Path) -> None:
    model = tmp_path / "tree.glb"
    tree.save(model)
    arguments = [program, "bake", model, "-o", tmp_path / "out.glb", "-q"]
    options = ["--rays", "64", "--target-error", "0", "--report-bias", "100%"]
    subprocess.run([*arguments, *options, "--stats-json", tmp_path / "s.json"], check=True)
    figures = json.loads((tmp_path / "s.json").read_text())
    baked = dapple.load(model).bake(rays=64, target_error=0, report_bias=1)
    assert list(baked.bias) == list(figures["bias"]) == ["ao"]
    ao = baked.bias["ao"]
    found = (ao.mean, ao.error, ao.tile_rmse, ao.tile_rmse_limit, ao.share)
    assert found == pytest.approx(tuple(figures["bias"]["ao"].values()))
    assert ao.mean != 0 and ao.error > 0 and ao.share == pytest.approx(1)
    assert ao.tile_rmse <= ao.tile_rmse_limit
    assert baked.footprint == figures["footprint"] == 1.5


def test_pictures_have_the_bias_of_the_program(program: str, tree: dapple.Scene, tmp_path: Path) -> None:
    model = tmp_path / "tree.glb"
    tree.save(model)
    arguments = [program, "render", model, "-o", tmp_path / "out.exr", "-q", "--width", "64", "--height", "48"]
    options = ["--target-rmse", "0.05", "--report-bias", "100%"]
    subprocess.run([*arguments, *options, "--stats-json", tmp_path / "s.json"], check=True)
    figures = json.loads((tmp_path / "s.json").read_text())
    picture = dapple.load(model).render(width=64, height=48, spp=1, target_rmse=0.05, report_bias=1)
    assert list(picture.bias) == list(figures["bias"])
    assert len(picture.bias) > 1
    for layer, bias in picture.bias.items():
        assert bias.mean == pytest.approx(figures["bias"][layer]["mean"])
        assert bias.share == pytest.approx(figures["bias"][layer]["share_of_rays"])
    assert picture.largest_irradiance == pytest.approx(figures["largest_irradiance"])
    assert set(picture.largest_irradiance) == {l for l in picture.bias if l.startswith("light.")}
    assert min(picture.largest_irradiance.values()) > 0
    assert picture.footprint == pytest.approx(figures["footprint"])


def test_pictures_of_exact_rays_have_none(tree: dapple.Scene) -> None:
    picture = tree.render(width=16, height=16, spp=1, estimator="exact")
    assert picture.bias == {} and picture.largest_irradiance == {}


def test_bakes_of_exact_rays_have_none(tree: dapple.Scene) -> None:
    assert tree.bake(rays=8, estimator="exact").bias == {}
    limited = tree.bake(rays=8, max_bias=1e-7)
    assert limited.footprint == 0
    assert any("max-bias" in note for note in limited.notes)


def test_measure_has_the_bias_of_the_program(
    program: str, tree: dapple.Scene, ground: np.ndarray, tmp_path: Path
) -> None:
    np.save(tmp_path / "points.npy", ground)
    arguments = [program, "points", tree._native.source, "--at", tmp_path / "points.npy", "-q"]
    files = ["-o", tmp_path / "out.npy", "--stats-json", tmp_path / "s.json"]
    subprocess.run([*arguments, *files], check=True)
    figures = json.loads((tmp_path / "s.json").read_text())
    columns = tree.measure(ground)
    assert sorted(columns.bias) == sorted(figures["bias"]) == ["ao", "sky_view_factor"]
    for quantity, bias in columns.bias.items():
        assert bias.mean == pytest.approx(figures["bias"][quantity]["mean"])
        assert bias.share == pytest.approx(figures["bias"][quantity]["share_of_rays"])
    assert columns.notes == figures["notes"]
    assert columns.footprint == figures["footprint"] == 1


def test_measured_columns_are_a_dict(tree: dapple.Scene, ground: np.ndarray) -> None:
    columns = tree.measure(ground, rays=8, max_bias=1e-7, sky_view_factor=False)
    assert isinstance(columns, dict) and list(columns) == ["ao", "ao_error"]
    assert {**columns}.keys() == dict(columns).keys()
    assert columns.footprint == 0 and columns.bias == {}
    again = pickle.loads(pickle.dumps(columns))
    assert again.notes == columns.notes and again.footprint == 0
    np.testing.assert_array_equal(again["ao"], columns["ao"])
    assert tree.measure(ground, rays=8, report_bias=0).bias == {}

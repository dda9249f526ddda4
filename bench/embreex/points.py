"""Sky and suns at points, by dapple and by PyPI's embreex through trimesh: seconds to an error.

In: the path of dapple. Out: lines of figures, and JSON with --json. Points lie on a grid below
scene:tree. dapple measures AO and the sum of suns at all of them; embreex traces rays from a part,
and its seconds are scaled to all. AO: random directions, as many as give the error that dapple has
against a reference of many rays; also directions stratified in a square. Suns: a ray to each, or to a
random part of them with the error that dapple has.
All seconds are processor seconds, user and system, so other work on the machine hardly matters:
dapple divides them among all cores, embreex traces on one.

    python -m venv env && env/bin/pip install -r bench/embreex/requirements.txt
    env/bin/python bench/embreex/points.py build/release/dapple
"""

from __future__ import annotations

import argparse
import json
import pathlib
import resource
import subprocess
import tempfile
import time

import numpy as np
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

RAYS_AT_ONCE = 1 << 20


def write_suns(path: pathlib.Path, count: int) -> np.ndarray:
    """Suns of 1 W/m^2 at elevations of 10 to 65 degrees; returns the directions towards them."""
    random = np.random.default_rng(1)
    azimuth = random.uniform(60, 300, count)
    elevation = random.uniform(10, 65, count)
    path.write_text(
        "azimuth,elevation,irradiance\n"
        + "".join(f"{a:.9g},{e:.9g},1\n" for a, e in zip(azimuth, elevation))
    )
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.stack([np.sin(a) * np.cos(e), np.sin(e), -np.cos(a) * np.cos(e)], axis=1)


def run_dapple(program: str, scene: str, folder: pathlib.Path, suns: pathlib.Path | None) -> dict:
    """Seconds, peak memory and columns of `dapple points`, with or without suns."""
    out = folder / "points.npy"
    command = [program, "points", scene, "--grid=-5,-5,4.97,4.97,0.0316", "-o", out, "-q"]
    command += ["--stats-json", folder / "stats.json"]
    if suns:
        command += ["--suns", suns]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(c) for c in command], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {
        "seconds": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        "megabytes": after.ru_maxrss / 1e3,
        "stats": json.loads((folder / "stats.json").read_text()),
        "table": np.load(out),
    }


def load_mesh(program: str, scene: str, folder: pathlib.Path) -> trimesh.Trimesh:
    """The scene's triangles, by way of a GLB file."""
    glb = folder / "scene.glb"
    subprocess.run([program, "scene", scene, "-o", str(glb)], check=True, stdout=subprocess.DEVNULL)
    return trimesh.load(glb, force="mesh", process=False)


class Tracer:
    """Counts what embreex costs."""

    def __init__(self, mesh: trimesh.Trimesh) -> None:
        start = time.process_time()
        self.intersector = RayMeshIntersector(mesh)
        self.intersector.intersects_any(np.zeros((1, 3)), np.array([[0.0, 1.0, 0.0]]))
        self.build_seconds = time.process_time() - start
        self.seconds = 0.0
        self.rays = 0

    def visible(self, points: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """(n, k): whether nothing is hit from each point in directions (k, 3) or (n, k, 3)."""
        directions = np.broadcast_to(directions, (len(points), *directions.shape[-2:]))
        count = directions.shape[1]
        step = max(1, RAYS_AT_ONCE // count)
        found = []
        for i in range(0, len(points), step):
            rays = np.ascontiguousarray(directions[i : i + step].reshape(-1, 3))
            origins = np.repeat(points[i : i + step], count, axis=0)
            start = time.process_time()
            hit = self.intersector.intersects_any(origins, rays)
            self.seconds += time.process_time() - start
            self.rays += len(rays)
            found.append(~hit.reshape(-1, count))
        return np.concatenate(found)


def cosine_directions(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Cosine-weighted directions about +Y from uniform numbers."""
    r, phi = np.sqrt(u), 2 * np.pi * v
    return np.stack([r * np.cos(phi), np.sqrt(1 - u), r * np.sin(phi)], axis=-1)


def stratified_error(tracer: Tracer, points: np.ndarray, truth: np.ndarray, side: int) -> float:
    """RMSE of AO by side x side jittered directions."""
    random = np.random.default_rng(3)
    squared = []
    for _ in range(4):
        jitter = random.uniform(size=(2, len(points), side, side))
        u = (np.arange(side)[:, None] + jitter[0]) / side
        v = (np.arange(side)[None, :] + jitter[1]) / side
        ao = tracer.visible(points, cosine_directions(u, v).reshape(len(points), -1, 3)).mean(axis=1)
        squared.append((ao - truth) ** 2)
    return float(np.sqrt(np.mean(squared)))


def measure_ao(tracer: Tracer, table: np.ndarray, samples: int, reference_rays: int) -> dict:
    """dapple's RMSE of AO at some points, and the rays that embreex needs for the same."""
    chosen = np.linspace(0, len(table) - 1, samples).astype(int)
    points = np.stack([table[c][chosen] for c in "xyz"], axis=1).astype(float)
    random = np.random.default_rng(2)
    truth = np.mean(
        [
            tracer.visible(points, cosine_directions(*random.uniform(size=(2, samples, 1024)))).mean(axis=1)
            for _ in range(reference_rays // 1024)
        ],
        axis=0,
    )
    variance = float(np.mean(truth * (1 - truth)))
    difference = table["ao"][chosen] - truth
    error = float(np.sqrt(max(0.0, np.mean(difference**2) - variance / reference_rays)))
    side = next(s for s in range(8, 200, 2) if stratified_error(tracer, points, truth, s) <= error)
    return {
        "mean": float(table["ao"][chosen].mean()),
        "mean_exact": float(truth.mean()),
        "rmse": error,
        "error_said": float(np.sqrt(np.mean(table["ao_error"] ** 2))),
        "random_rays": variance / error**2,
        "stratified_rays": side * side,
    }


def measure_suns(tracer: Tracer, table: np.ndarray, suns: np.ndarray, samples: int) -> dict:
    """dapple's RMSE of the sum of suns at some points, relative to its mean, and the suns that
    embreex needs for the same if it chooses them at random.
    """
    chosen = np.linspace(0, len(table) - 1, samples).astype(int)
    points = np.stack([table[c][chosen] for c in "xyz"], axis=1).astype(float)
    values = tracer.visible(points, suns) * suns[:, 1]
    exact = values.sum(axis=1)
    found = table["sun"][chosen].astype(float)
    error = float(np.sqrt(np.mean((found - exact) ** 2)))
    random = np.random.default_rng(4)

    def error_of(count: int) -> float:
        """Of so many random suns, of which each counts as if there were no others."""
        squared = []
        for row, truth in zip(values, exact):
            picked = random.permutation(len(suns))[:count]
            squared.append((row[picked].mean() * len(suns) - truth) ** 2)
        return float(np.sqrt(np.mean(squared)))

    return {
        "random_suns": next(n for n in range(10, len(suns) + 1, 10) if error_of(n) <= error),
        "error_said": float(np.sqrt(np.mean(table["sun_error"][chosen] ** 2)) / exact.mean()),
        "mean": float(found.mean()),
        "mean_exact": float(exact.mean()),
        "relative_rmse": error / float(exact.mean()),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dapple")
    parser.add_argument("--leaves", type=int, default=1_000_000)
    parser.add_argument("--suns", type=int, default=1000)
    parser.add_argument("--ao-points", type=int, default=200)
    parser.add_argument("--sun-points", type=int, default=1000)
    parser.add_argument("--reference-rays", type=int, default=16384)
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    scene = f"scene:tree?leaves={arguments.leaves}&opacity=1"
    results: dict = {}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        suns = write_suns(folder / "suns.csv", arguments.suns)
        ao_run = run_dapple(arguments.dapple, scene, folder, None)
        run = run_dapple(arguments.dapple, scene, folder, folder / "suns.csv")
        table = run["table"]
        for label, one in (("dapple_ao", ao_run), ("dapple_ao_and_suns", run)):
            results[label] = {k: v for k, v in one.items() if k != "table"}
        tracer = Tracer(load_mesh(arguments.dapple, scene, folder))
        results["points"] = len(table)
        results["embreex_build_seconds"] = tracer.build_seconds
        results["ao"] = measure_ao(tracer, table, arguments.ao_points, arguments.reference_rays)
        per_ao_ray = tracer.seconds / tracer.rays
        tracer.seconds, tracer.rays = 0.0, 0
        results["suns"] = measure_suns(tracer, table, suns, arguments.sun_points)
        results["embreex_ao_seconds_random"] = per_ao_ray * results["ao"]["random_rays"] * len(table)
        results["embreex_ao_seconds_stratified"] = (
            per_ao_ray * results["ao"]["stratified_rays"] * len(table)
        )
        results["embreex_suns_seconds"] = tracer.seconds / tracer.rays * len(suns) * len(table)
    results["embreex_megabytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(json.dumps(results, indent=1))
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()

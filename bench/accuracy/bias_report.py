#!/usr/bin/env python3
"""Whether the bias that a render reports of itself is the real one.

Each scene is rendered once with the default report, which traces 2 % of the occlusion rays exactly too,
and with other seeds once for each of them with a report of all rays: their mean is the converged bias.
In: the program and scenes, by default ten procedural ones that no other measurement uses. Out: a Markdown
table of layers: both figures and how many standard errors lie between them.

    bench/accuracy/bias_report.py build/release/dapple
"""
import argparse
import json
import math
import pathlib
import subprocess
import tempfile

SCENES = [
    "scene:tree?leaves=60000&seed=21",
    "scene:tree?leaves=60000&seed=22&opacity=0.3",
    "scene:cloud?leaves=60000&seed=23&opacity=0.5",
    "scene:forest?trees=60&leaves=4000&seed=24",
    "scene:palm?seed=25",
    "scene:conifer?seed=26",
    "scene:willow?seed=27",
    "scene:grass?seed=28&length=40",
    "scene:hair?strands=8000&seed=29",
    "scene:demo",
]
REPORTED_SEED, CONVERGED_SEEDS = 0, (1, 2, 3, 4)


def bias(program, scene, seed, share, size, samples):
    """Of each layer: its mean and the standard error, as `--stats-json` gives them."""
    with tempfile.TemporaryDirectory() as folder:
        statistics = pathlib.Path(folder, "statistics.json")
        subprocess.run(
            [program, "render", scene, "-o", pathlib.Path(folder, "picture.exr"), "--width", str(size),
             "--height", str(size), "--spp", str(samples), "--seed", str(seed), "--report-bias", share,
             "--stats-json", statistics, "-q"],
            check=True)
        layers = json.loads(statistics.read_text())["bias"]
    return {name: (layer["mean"], layer["error"]) for name, layer in layers.items()}


def compare(program, scene, size, samples):
    """Rows of (layer, reported mean, its error, converged mean, their distance in standard errors)."""
    reported = bias(program, scene, REPORTED_SEED, "2%", size, samples)
    seeds = [bias(program, scene, seed, "100%", size, samples) for seed in CONVERGED_SEEDS]
    for layer, (mean, error) in reported.items():
        values = [found[layer][0] for found in seeds]
        converged = sum(values) / len(values)
        spread = math.sqrt(sum((value - converged) ** 2 for value in values) / (len(values) - 1) / len(values))
        total = math.hypot(error, spread)
        if total > 0:
            yield layer, mean, error, converged, (mean - converged) / total


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="path of the dapple program")
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--size", type=int, default=192, help="width and height of the pictures")
    parser.add_argument("--spp", type=int, default=16)
    arguments = parser.parse_args()
    distances = []
    print("| Scene | layer | by 2 % | converged | standard errors between |\n|---|---|---|---|---|")
    for scene in arguments.scenes:
        name = f"`{scene}`" if scene.startswith("scene:") else pathlib.Path(scene).name
        for layer, mean, error, converged, distance in compare(arguments.program, scene, arguments.size, arguments.spp):
            distances.append(abs(distance))
            print(f"| {name} | {layer} | {mean:+.4f} +- {error:.4f} | {converged:+.4f} | {distance:+.1f} |", flush=True)
            name = ""
    within = [sum(distance <= limit for distance in distances) for limit in (1, 2)]
    print(f"\n{within[0]} of {len(distances)} layers within one standard error, {within[1]} within two")


if __name__ == "__main__":
    main()

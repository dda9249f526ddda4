"""Ambient occlusion at vertices, baked by Blender and by dapple: seconds to an error.

In: a glTF file and the path of dapple. Out: a table, and JSON with --json. Blender bakes the front
side at the vertices themselves, dapple with its defaults: over the triangles around each vertex, and
the brighter side of leaves. Each is compared with its own reference of many rays, since they measure
different things; the means of both references are printed. The distance is unlimited. Seconds are
those of the whole bake, the building of the BVH included, files excluded. Blender's adaptive
sampling is on with --adaptive: it stops at an error that more samples do not lower.

    python -m venv blender && blender/bin/pip install -r bench/blender/requirements.txt
    blender/bin/python bench/blender/bake_ao.py tree.glb --dapple build/release/dapple
"""

import argparse
import json
import math
import os
import pathlib
import struct
import subprocess
import tempfile
import time

import bpy
import numpy

TARGETS = (0.05, 0.03, 0.02)
COLOURS = "baked"


def import_scene(path, threads, adaptive):
    """Imports the file into an empty scene and selects its meshes. Returns their objects."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.bake.target = "VERTEX_COLORS"
    scene.cycles.device = "CPU"
    scene.cycles.use_adaptive_sampling = adaptive
    if threads:
        scene.render.threads_mode = "FIXED"
        scene.render.threads = threads
    scene.world = bpy.data.worlds.new("world")
    scene.world.light_settings.distance = 1e6
    bpy.ops.object.select_all(action="DESELECT")
    objects = [o for o in bpy.data.objects if o.type == "MESH"]
    for o in objects:
        o.select_set(True)
        attribute = o.data.color_attributes.new(COLOURS, "FLOAT_COLOR", "POINT")
        o.data.color_attributes.active_color = attribute
    bpy.context.view_layer.objects.active = objects[0]
    return objects


def blender_bake(objects, samples, seed):
    """AO at all vertices, and the seconds that it took."""
    bpy.context.scene.cycles.samples = samples
    bpy.context.scene.cycles.seed = seed
    start = time.perf_counter()
    bpy.ops.object.bake(type="AO")
    seconds = time.perf_counter() - start
    values = []
    for o in objects:
        colours = numpy.empty(4 * len(o.data.vertices), numpy.float32)
        o.data.color_attributes[COLOURS].data.foreach_get("color", colours)
        values.append(colours[::4].copy())
    return numpy.concatenate(values), seconds


def attribute(path, name):
    """A float attribute of all primitives of a .glb file, one after the other."""
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    tree = json.loads(data[20 : 20 + size])
    binary = 20 + size + 8
    values = []
    for mesh in tree["meshes"]:
        for primitive in mesh["primitives"]:
            accessor = tree["accessors"][primitive["attributes"][name]]
            view = tree["bufferViews"][accessor["bufferView"]]
            offset = binary + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
            values.append(numpy.frombuffer(data, "<f4", accessor["count"], offset))
    return numpy.concatenate(values)


def dapple_bake(program, scene, folder, options):
    """AO at all vertices, and the seconds that it took."""
    out, stats = folder / "baked.glb", folder / "stats.json"
    subprocess.run([program, "bake", scene, "-o", out, "--stats-json", stats, "--channel", "_AO",
                    "-q", *options], check=True)
    seconds = json.loads(stats.read_text())["seconds"]
    return attribute(out, "_AO"), sum(seconds[s] for s in ("build", "upload", "trace"))


def rmse(values, reference):
    return math.sqrt(numpy.mean((values.astype(float) - reference) ** 2))


def median(values):
    return sorted(values)[len(values) // 2]


def seconds_to(rows, target):
    """Interpolated between the logarithms of neighbouring rows; None if the target is not reached."""
    before = None
    for row in rows:
        if row["rmse"] <= target:
            if before is None:
                return row["seconds"]
            part = math.log(before["rmse"] / target) / math.log(before["rmse"] / row["rmse"])
            return before["seconds"] * (row["seconds"] / before["seconds"]) ** part
        before = row
    return None


def measure(name, efforts, repeats, bake, reference):
    """Rows of effort, median seconds and median RMSE, until the last target is reached."""
    rows = []
    for effort in efforts:
        runs = [bake(effort, seed) for seed in range(1, repeats + 1)]
        rows.append({"effort": effort, "seconds": median([s for _, s in runs]),
                     "rmse": median([rmse(v, reference) for v, _ in runs])})
        print(f"{name:14} {effort:>8} {rows[-1]['seconds']:10.3f} s  RMSE {rows[-1]['rmse']:.4f}",
              flush=True)
        if rows[-1]["rmse"] < TARGETS[-1]:
            break
    return rows


def print_table(contest):
    """Seconds to each target, and Blender's divided by them."""
    for target in TARGETS:
        blender = seconds_to(contest["Blender"], target)
        for name, rows in contest.items():
            seconds = seconds_to(rows, target)
            text = f"{seconds:.3f} s" if seconds else "not reached"
            ratio = f", ratio {blender / seconds:.1f}" if blender and seconds else ""
            print(f"to RMSE {target}: {name} {text}{ratio}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--dapple", required=True, help="path of the program")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--reference", type=int, default=4096, help="rays a vertex of references")
    parser.add_argument("--threads", type=int, default=0, help="of Blender; 0: all")
    parser.add_argument("--adaptive", action="store_true", help="Blender's adaptive sampling")
    parser.add_argument("--json", type=pathlib.Path)
    a = parser.parse_args()

    objects = import_scene(a.scene, a.threads, a.adaptive)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)

        def dapple(sides, *options):
            return dapple_bake(a.dapple, a.scene, folder, ["--sides", sides, *options])

        exact = ["--estimator", "exact", "--rays", str(a.reference), "--seed", "99"]
        truth = {sides: dapple(sides, *exact)[0] for sides in ("front", "auto")}
        reference, _ = blender_bake(objects, a.reference, 99)
        print(f"{len(reference)} vertices; mean AO of the references: Blender "
              f"{reference.mean():.4f}, dapple {truth['front'].mean():.4f} (front), "
              f"{truth['auto'].mean():.4f} (brighter side of leaves)")
        contest = {
            "Blender": measure("Blender", [2**k for k in range(11)], a.repeats,
                               lambda n, seed: blender_bake(objects, n, seed), reference),
        }
        for sides in truth:
            contest["dapple " + sides] = measure(
                "dapple " + sides, [0.08, 0.06, 0.04, 0.03, 0.02, 0.015, 0.01], a.repeats,
                lambda target, seed, sides=sides: dapple(sides, "--target-error", str(target),
                                                         "--seed", str(seed)), truth[sides])
    print_table(contest)
    if a.json:
        a.json.write_text(json.dumps({"vertices": len(reference), "rows": contest}, indent=1))
    os._exit(0)  # bpy 4.2 crashes while Python ends


if __name__ == "__main__":
    main()

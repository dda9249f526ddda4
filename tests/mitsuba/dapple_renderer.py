"""Runs the program dapple: renders a scene exactly, and reads the layers of its EXR file."""

import subprocess

import mitsuba as mi
import numpy as np

from layers import SIZE, Layer, channels_of
from lights import write_lights

SPP = 256
AO_RAYS = 4
LIGHT_RAYS = 2


def read_layers(path):
    """Channel name -> image."""
    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    return dict(zip(names, np.moveaxis(np.array(bitmap, np.float64), -1, 0)))


class Dapple:
    """The program `dapple`."""

    def __init__(self, program):
        self.program = program

    def run(self, *words):
        done = subprocess.run([self.program, *words], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(
                f"mitsuba: dapple {' '.join(words)} ended with {done.returncode}:"
                f" {done.stderr.strip()}"
            )

    def render(self, scene, folder, seed):
        camera = scene.camera
        lights = write_lights(folder, scene.lights)
        output = folder / f"{scene.name}_{seed}.exr"

        def vector(values):
            return ",".join(f"{value:.9g}" for value in values)

        self.run(
            *("render", str(scene.file), "-o", str(output), "--estimator", "exact"),
            *("--normals", "geometric", "--passes", "ao,light", "--lights", str(lights)),
            *("--width", str(SIZE), "--height", str(SIZE), "--spp", str(SPP)),
            *("--ao-rays", str(AO_RAYS), "--light-rays", str(LIGHT_RAYS), "--seed", str(seed)),
            *(f"--look-from={vector(camera.look_from)}", f"--look-at={vector(camera.look_at)}"),
            *("--fov", str(camera.fov_degrees), *scene.options),
        )
        layers = read_layers(output)
        alpha = layers["A"]
        quantities = {"ao": Layer(layers["ao.R"] - 1 + alpha, alpha)}
        for light in scene.lights:
            for channel, name in channels_of(light.kind):
                values = layers[f"light.{light.kind}.{'RGB'[channel]}"]
                quantities[name] = Layer(values, alpha)
        return quantities

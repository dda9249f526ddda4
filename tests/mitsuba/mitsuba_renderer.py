"""Renders a scene with Mitsuba, without light that bounces.

AO is what a white surface reflects of a sky of radiance 1; irradiance is what it reflects, times pi.
"""

from dataclasses import dataclass, replace

import mitsuba as mi
import numpy as np

from geometry import Strands
from layers import SIZE, Layer, channels_of
from mitsuba_shapes import shape_of
from scenes import WORLD_UP

SPP = 384
DOME_SPP = 768
# `volpath` attenuates shadow rays by masks, and counts only scattering: camera, surface, light.
FIRST_ORDER = 2
# Mitsuba's random numbers depend on it, and by default it depends on the number of threads.
BLOCK_SIZE = 32
# Mitsuba's rays start 9e-5 (1 + largest coordinate) away from surfaces and pass over what is closer.
# That is least where a scene lies around the origin and is large; values do not depend on scale.
SCALE = 100.0


@dataclass
class Move:
    """Moves `centre` to the origin and enlarges everything."""

    centre: list
    scale: float

    def point(self, position):
        return self.scale * (np.asarray(position, np.float64) - self.centre)

    def camera(self, camera):
        return replace(
            camera, look_from=self.point(camera.look_from), look_at=self.point(camera.look_at)
        )

    def content(self, content):
        if isinstance(content, Strands):
            return replace(
                content, points=self.point(content.points), radii=self.scale * content.radii
            )
        return replace(content, positions=self.point(content.positions))

    def light(self, light):
        if light.kind == "dome":
            return light
        return replace(light, position=self.point(light.position), size=self.scale * light.size)


class Mitsuba:
    """A scene in Mitsuba; one render for each quantity."""

    def __init__(self, scene, folder):
        move = Move(scene.centre, SCALE)
        self.camera = move.camera(scene.camera)
        self.lights = [move.light(light) for light in scene.lights]
        self.shapes = {
            f"shape_{number}": shape_of(move.content(content), folder / f"{scene.name}_{number}")
            for number, content in enumerate(scene.content)
        }

    def render(self, seed):
        # A white surface under a sky of radiance 1 has the radiance AO.
        sky = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}
        pixels = self.render_with(sky, seed, SPP)
        quantities = {"ao": Layer(pixels[:, :, 1], pixels[:, :, 3])}
        for light in self.lights:
            spp = DOME_SPP if light.kind == "dome" else SPP
            pixels = self.render_with(light.for_mitsuba(), seed, spp)
            for channel, name in channels_of(light.kind):
                quantities[name] = Layer(np.pi * pixels[:, :, channel], pixels[:, :, 3])
        return quantities

    def render_with(self, light, seed, spp):
        """RGBA (height, width, 4)."""
        camera = self.camera
        to_world = mi.ScalarTransform4f().look_at(
            origin=list(camera.look_from), target=list(camera.look_at), up=WORLD_UP
        )
        film = {
            "type": "hdrfilm",
            "width": SIZE,
            "height": SIZE,
            "pixel_format": "rgba",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        }
        sensor = {
            "type": "perspective",
            "to_world": to_world,
            "fov": camera.fov_degrees,
            "fov_axis": "y",
            "film": film,
            "near_clip": 0.01 * SCALE,
            "far_clip": 1000 * SCALE,
        }
        integrator = {
            "type": "volpath",
            "max_depth": FIRST_ORDER,
            "hide_emitters": True,
            "block_size": BLOCK_SIZE,
        }
        scene = mi.load_dict(
            {
                "type": "scene",
                "integrator": integrator,
                "sensor": sensor,
                "light": light,
                **self.shapes,
            }
        )
        return np.array(mi.render(scene, seed=seed, spp=spp), np.float64)

"""Reads scenes from files."""

from __future__ import annotations

from os import PathLike

from . import _arguments, _native
from ._scene import Scene


def load(
    path: str | PathLike[str],
    *,
    time: float | None = None,
    animation: str = "",
    allow_outside: bool = False,
    light_radius: float = 0.1,
    line_radius: float = 0.0,
) -> Scene:
    """Reads a scene: glTF 2.0 (.gltf, .glb), strands (.hair), or "scene:tree?leaves=50000".

    time: seconds, of the pose; None: at rest. animation: by name, "*" for all, empty: the first.
    allow_outside: buffers and images may be outside of the file's folder. light_radius: metres, of
    the spheres that glTF's point and spot lights become. line_radius: metres, of the strands that
    its lines become; 0: they are skipped. Raises InputError.

    >>> dapple.load("scene:tree?leaves=100").materials
    ['leaf', 'bark']
    >>> dapple.load("missing.glb")
    Traceback (most recent call last):
    dapple.InputError: missing.glb: no such file
    """
    seconds = None if time is None else _arguments.number("time", time)
    name = _arguments.text("animation", animation)
    radii = _arguments.number("light_radius", light_radius), _arguments.number("line_radius", line_radius)
    spec = _arguments.path("path", path)
    return Scene(_native.load(spec, seconds, name, bool(allow_outside), *radii))

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
) -> Scene:
    """Reads a scene: glTF 2.0 (.gltf, .glb), strands (.hair), or "scene:tree?leaves=50000".

    time: seconds, of the pose; None: at rest. animation: by name, "*" for all, empty: the first.
    allow_outside: buffers and images may be outside of the file's folder. Raises InputError.

    >>> dapple.load("scene:tree?leaves=100").materials
    ['leaf', 'bark']
    >>> dapple.load("missing.glb")
    Traceback (most recent call last):
    dapple.InputError: missing.glb: no such file
    """
    seconds = None if time is None else _arguments.number("time", time)
    name = _arguments.text("animation", animation)
    return Scene(_native.load(_arguments.path("path", path), seconds, name, bool(allow_outside)))

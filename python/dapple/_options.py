"""Keyword arguments of the engine's calls, for type checkers, and how they are applied."""

from __future__ import annotations

import difflib
import numbers
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Sequence, Tuple, TypedDict, TypeVar

import numpy as np

from ._arguments import non_negative
from ._errors import UsageError

if TYPE_CHECKING:
    from typing import Literal

    Estimator = Literal["exact", "prefiltered"]


class QueryOptions(TypedDict, total=False):
    """Of occlusion() and irradiance()."""

    rays: int
    estimator: Estimator
    footprint: float
    seed: int


class OcclusionOptions(QueryOptions, total=False):
    """Of occlusion()."""

    distance: float
    falloff: float


class MeasureOptions(QueryOptions, total=False):
    """Of measure(), as the program's `dapple points`."""

    report_bias: float
    max_bias: float | None
    ao: bool
    sky_view_factor: bool
    bent: bool
    rings: int
    lights: bool
    per_sun: bool
    distance: float
    falloff: float
    opacity: Mapping[str, float]
    ground: bool
    device: str
    cache: str


class RenderOptions(TypedDict, total=False):
    """Of render(), as the program's `dapple render`."""

    width: int
    height: int
    spp: int
    target_error: float
    target_rmse: float
    max_spp: int
    camera_splitting: int
    ao_rays: int
    light_rays: int
    estimator: Estimator
    footprint: float
    roulette: float
    report_bias: float
    max_bias: float | None
    ao: bool
    light: bool
    albedo: bool
    beauty: bool
    back: bool
    back_every: int
    deep: bool
    visits: bool
    crypto_object: bool
    crypto_material: bool
    ao_distance: float
    ao_falloff: float
    camera: str
    look: Sequence[Sequence[float]]
    fov_degrees: float
    ambient: float | None
    aperture: float | None
    focus_distance: float | None
    crop: Tuple[int, int, int, int]
    seed: int
    normals: Literal["shading", "geometric"]
    device: str
    packets: Literal["auto", "none", "pixel", "point", "scalar"]
    cache: str
    ground: bool
    ground_height: float | None
    opacity: Mapping[str, float]


class BakeOptions(TypedDict, total=False):
    """Of bake(), as the program's `dapple bake`."""

    vertices: bool
    instances: bool
    texture: bool
    bent: bool
    light: bool
    light_rays: int
    target_error: float
    rays: int
    estimator: Estimator
    footprint: float
    normals: Literal["shading", "geometric"]
    report_bias: float
    max_bias: float
    distance: float
    falloff: float
    at_vertices: bool
    texture_size: int
    margin: int
    sides: Literal["auto", "front", "max", "mean"]
    placement: Literal["together", "alone"]
    seed: int
    ground: bool
    opacity: Mapping[str, float]
    device: str
    cache: str


Options = TypeVar("Options")

_NON_NEGATIVE = ("footprint", "distance", "falloff")
_OF_PERIODIC = ("period_x", "period_z")  # the argument periodic sets both
_EXPECTED = {
    "look": "three vectors: (from, at, up)",
    "crop": "four integers: (x0, y0, x1, y1)",
    "opacity": "numbers by the materials' names",
    "max_bias": "a number or None",
    "ambient": "a number or None",
    "aperture": "a number or None",
    "focus_distance": "a number or None",
    "ground_height": "a number or None",
}


#: Options that change nothing without one of others, by call, and what to say of these.
_NEEDS: dict[str, dict[str, tuple[tuple[str, ...], str]]] = {
    "render": {
        "back_every": (("back",), "back=True"),
        "ao_rays": (("ao",), "ao=True"),
        "ao_distance": (("ao",), "ao=True"),
        "light_rays": (("light",), "light=True"),
        "ground_height": (("ground",), "ground=True"),
        "max_spp": (("target_rmse", "target_error"), "target_rmse or target_error"),
    },
    "bake": {
        "texture_size": (("texture",), "texture=True"),
        "margin": (("texture",), "texture=True"),
        "light_rays": (("light",), "light=True"),
    },
}


def _check_needs(call: str, options: object, changed: Sequence[str]) -> None:
    for name in changed:
        others, text = _NEEDS.get(call, {}).get(name, ((), ""))
        if others and not any(getattr(options, other) for other in others):
            raise UsageError(f"{call}(): {name} needs {text}")


def _plain(name: str, value: object) -> object:
    """Values as the engine takes them: NumPy's flags, paths, mappings."""
    if isinstance(value, np.bool_):
        return bool(value)
    if name in ("cache", "kernel_dir") and isinstance(value, os.PathLike):
        return os.fsdecode(value)
    if name == "opacity" and isinstance(value, Mapping):
        return list(value.items())
    return value


def _wanted(name: str, current: object, value: object) -> str:
    """What a value of the wrong type, or beyond the range of the engine's integers, must be."""
    if type(current) is int and isinstance(value, numbers.Integral) and not isinstance(value, bool):
        low, high = (0, 2**32 - 1) if name in ("seed", "texture_size") else (-(2**31), 2**31 - 1)
        return f"from {low} to {high}"
    if type(current) is float:
        return "a number"
    return _EXPECTED.get(name) or type(current).__name__


def apply(
    call: str, options: Options, values: Mapping[str, Any], arguments: Sequence[str] = ()
) -> Options:
    """Sets the fields of `options`; raises UsageError for unknown names and wrong types.

    arguments: names that the call has beside the options.
    """
    if "footprint" in values and hasattr(options, "max_bias"):
        values = {"max_bias": 0, **values}  # as on the command line: it is taken as it is
    fields = [name.removeprefix("set_") for name in dir(options) if not name.startswith("_")]
    known = [name for name in fields if name not in _OF_PERIODIC]
    changed: list[str] = []
    for name, value in values.items():
        if name not in known:
            all_names = sorted([*known, *arguments])
            close = difflib.get_close_matches(name, all_names, 1)
            hint = f"; did you mean {close[0]}?" if close else f"; known are {', '.join(all_names)}"
            raise UsageError(f"{call}() has no argument {name}{hint}")
        if name in _NON_NEGATIVE and isinstance(value, (int, float)):
            non_negative(f"{call}(): {name}", value)
        if name == "fov_degrees" and value == 0:  # to the engine it means the camera's own
            raise UsageError(f"{call}(): fov_degrees is 0; it must be from 0.01 to 179")
        plain = _plain(name, value)
        try:
            if name in ("look", "crop"):
                getattr(options, "set_" + name)(*value)
            else:
                before = getattr(options, name)
                setattr(options, name, plain)
                changed += [name] if getattr(options, name) != before else []
        except TypeError:
            wanted = _wanted(name, getattr(options, name, None), value)
            raise UsageError(f"{call}(): {name} is {value!r}; it must be {wanted}") from None
    _check_needs(call, options, changed)
    return options

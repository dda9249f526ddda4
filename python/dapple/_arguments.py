"""Arguments that are no arrays: numbers, names, paths, functions. Wrong ones raise UsageError."""

from __future__ import annotations

import math
import numbers
import os
from typing import Callable, Iterable, Optional, Sequence, TypeVar

import numpy as np

from ._arrays import shape_text
from ._errors import UsageError

Progress = Optional[Callable[[float], object]]
Kind = TypeVar("Kind")


def number(name: str, value: float) -> float:
    """A finite or infinite number, NaN too; the engine checks ranges."""
    if not isinstance(value, (numbers.Real, np.number, np.bool_)) or isinstance(value, np.complexfloating):
        raise UsageError(f"{name} is {value!r}; it must be a number")
    return float(value)


def finite(name: str, value: float) -> float:
    result = number(name, value)
    if not math.isfinite(result):
        raise UsageError(f"{name} is {result:g}; it must be finite")
    return result


def non_negative(name: str, value: float) -> float:
    """A finite number of 0 or more."""
    result = number(name, value)
    if not (math.isfinite(result) and result >= 0):
        raise UsageError(f"{name} is {result:g}; it must be 0 or more, and finite")
    return result


def several(name: str, values: Sequence[float], count: int) -> tuple[float, ...]:
    """`count` finite numbers, such as a direction."""
    try:
        array = np.asarray(values)
    except ValueError:
        array = np.asarray(None)
    if array.dtype.kind not in "fiu":
        raise UsageError(f"{name} is {values!r}; it must be {count} numbers")
    if array.shape != (count,):
        raise UsageError(f"{name} has the shape {shape_text(array.shape)}; it must be ({count},)")
    if not np.isfinite(array).all():
        raise UsageError(f"{name} is not finite")
    return tuple(float(x) for x in array)


def text(name: str, value: str) -> str:
    if not isinstance(value, str):
        raise UsageError(f"{name} is {value!r}; it must be a string")
    return value


def texts(name: str, values: Iterable[str]) -> list[str]:
    """Several strings; one alone is refused, since it is a sequence of letters."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise UsageError(f"{name} is {values!r}; it must be a list of strings")
    return [text(name, value) for value in values]


def path(name: str, value: str | os.PathLike[str]) -> str:
    try:
        return os.fsdecode(value)
    except TypeError:
        raise UsageError(f"{name} is {value!r}; it must be a path") from None


def progress_function(value: Progress) -> Progress:
    if value is not None and not callable(value):
        raise UsageError(f"progress is {value!r}; it must be a function of one number, or None")
    return value


def list_of(name: str, values: Iterable[Kind], kind: type[Kind], plural: str) -> list[Kind]:
    """A list of `values`, which must be of one kind. A single value of it is no list."""
    found = list(values) if isinstance(values, Iterable) else [values]
    if isinstance(values, kind) or not all(isinstance(value, kind) for value in found):
        raise UsageError(f"{name} is {values!r}; it must be a list of {plural}")
    return found

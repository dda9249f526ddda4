"""Arguments as NumPy arrays of the engine's layout: float32 or uint32, C-contiguous.

An array that has this layout is passed on as it is; others are copied.
"""

from __future__ import annotations

import warnings
from typing import Any, Iterable, Sequence

import numpy as np
import numpy.typing as npt

from ._errors import UsageError

FloatArray = npt.NDArray[np.float32]
IndexArray = npt.NDArray[np.uint32]


def shape_text(shape: tuple[int, ...]) -> str:
    return "(" + ", ".join(str(n) for n in shape) + ("," if len(shape) == 1 else "") + ")"


def _numbers(name: str, values: npt.ArrayLike, kinds: str) -> npt.NDArray[Any]:
    rows = values if isinstance(values, (list, tuple)) else ()
    if np.ma.is_masked(values) or any(np.ma.is_masked(row) for row in rows):
        raise UsageError(f"{name} has masked values; leave them out, as np.ma.compress_rows() does")
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise UsageError(f"{name} is not an array of numbers: {error}") from None
    if array.size and array.dtype.kind not in kinds:
        wanted = "numbers" if "f" in kinds else "whole numbers"
        raise UsageError(f"{name} has the type {array.dtype}; it must be of {wanted}")
    return array


def vectors(name: str, values: npt.ArrayLike, width: int = 3) -> FloatArray:
    """`values` as (n, width) float32; an empty sequence becomes (0, width)."""
    array = _numbers(name, values, "fiu")
    if array.ndim == 1 and array.size == 0:
        array = array.reshape(0, width)
    if array.ndim != 2 or array.shape[1] != width:
        raise UsageError(f"{name} has the shape {shape_text(array.shape)}; it must be (n, {width})")
    with np.errstate(over="ignore"):
        result: FloatArray = np.ascontiguousarray(array, dtype=np.float32)
    if not np.isfinite(result).all():
        bad = int(np.flatnonzero(~np.isfinite(result).all(axis=1))[0])
        raise UsageError(f"{name}[{bad}] is not finite")
    return result


def warn_of_coarse_steps(name: str, positions: FloatArray) -> None:
    """As dapple notes when it builds: steps of 1 mm are coarse in 100 m."""
    if len(positions) == 0:
        return
    far = float(np.abs(positions).max())
    step = far * float(np.finfo(np.float32).eps)
    if step > 1e-5 * float(np.linalg.norm(np.ptp(positions, axis=0))):
        warnings.warn(
            f"{name} reaches {far:.3g} m from the origin, where coordinates have steps of {step:.2g} m: "
            "move the scene to the origin, or smaller details and distances are lost",
            stacklevel=3,
        )


def unit_vectors(name: str, values: npt.ArrayLike, count: int) -> FloatArray:
    """`values` as (count, 3) unit vectors; one vector (3,) stands for all of them."""
    array = _numbers(name, values, "fiu")
    if array.shape == (3,):
        array = np.broadcast_to(array, (count, 3))
    result = vectors(name, array)
    if len(result) != count:
        raise UsageError(f"{name} has {len(result)} vectors, but there are {count} points")
    lengths = np.linalg.norm(result, axis=1)
    wrong = np.flatnonzero(~(np.abs(lengths - 1) < 1e-3))
    if wrong.size:
        raise UsageError(f"{name}[{int(wrong[0])}] has the length {lengths[wrong[0]]:.6g}, not 1")
    return result


def indices(name: str, values: npt.ArrayLike, limit: int) -> IndexArray:
    """`values` as (m, 3) uint32 below `limit`."""
    array = _numbers(name, values, "iu")
    if array.size == 0:
        return np.zeros((0, 3), np.uint32)
    if array.ndim != 2 or array.shape[1] != 3:
        raise UsageError(f"{name} has the shape {shape_text(array.shape)}; it must be (m, 3)")
    if int(array.min()) < 0 or int(array.max()) >= limit:
        wrong = int(array.min()) if int(array.min()) < 0 else int(array.max())
        raise UsageError(f"{name} has the index {wrong}, but there are {limit} vertices")
    return np.ascontiguousarray(array, dtype=np.uint32)


def irradiances(name: str, values: float | npt.ArrayLike, count: int) -> FloatArray:
    """`values` as (count,) float32 of 0 or more; one number stands for all of them."""
    array = _numbers(name, values, "fiu")
    if array.shape not in ((), (count,)):
        raise UsageError(
            f"{name} has the shape {shape_text(array.shape)}; it must be a number or one for each "
            f"of {count} suns"
        )
    with np.errstate(over="ignore"):
        result: FloatArray = np.ascontiguousarray(np.broadcast_to(array, (count,)), np.float32)
    if not (np.isfinite(result) & (result >= 0)).all():
        raise UsageError(f"{name} has a value that is not finite or below 0")
    return result


def _distinct(values: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], npt.NDArray[np.int64]]:
    """The different values in the order of their first appearance, and which one each is."""
    sorted_values, first, which = np.unique(values, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    return sorted_values[order], place[which.reshape(len(values))]


def _opacities(values: float | npt.ArrayLike, count: int) -> npt.NDArray[np.float32]:
    """One for each of `count` triangles."""
    array = _numbers("opacity", values, "fiu").astype(np.float32)
    if array.ndim == 0:
        array = np.broadcast_to(array, (count,))
    if array.shape != (count,):
        raise UsageError(
            f"opacity has the shape {shape_text(array.shape)}; it must be a number or one for "
            f"each of {count} triangles"
        )
    if not ((array >= 0) & (array <= 1)).all():
        raise UsageError("opacity has a value outside of [0, 1]")
    return array


def materials(
    opacity: float | npt.ArrayLike, names: Sequence[str] | npt.ArrayLike | None, count: int
) -> tuple[list[tuple[str, float]], IndexArray]:
    """Materials as names and opacities, and for each of `count` triangles which of them it has.

    names: of each triangle's material; None: one for each opacity, "0", "1" and so on.
    """
    values = _opacities(opacity, count)
    if count == 0:
        return [("0", 1.0)], np.zeros(0, np.uint32)
    if names is None:
        distinct, which = _distinct(values)
        labels = [str(i) for i in range(len(distinct))]
    else:
        if np.ma.is_masked(names):
            raise UsageError("materials is masked; fill it, as with .filled()")
        array = np.asarray(names)
        # Columns of tables hold names as objects.
        if array.dtype.kind in "OT" and all(isinstance(name, str) for name in array.flat):
            array = array.astype(str)
        if array.shape != (count,) or array.dtype.kind not in "Uiu":
            raise UsageError(
                f"materials has the shape {shape_text(array.shape)} and the type {array.dtype}; it "
                f"must be a name or whole number for each of {count} triangles"
            )
        found, which = _distinct(array)
        labels = [str(label) for label in found]
        distinct = np.zeros(len(labels), np.float32)
        distinct[which] = values
        differing = np.flatnonzero(distinct[which] != values)
        if differing.size:
            of = labels[which[differing[0]]]
            raise UsageError(f"opacity differs between triangles of the material {of!r}")
    pairs = [(label, float(value)) for label, value in zip(labels, distinct)]
    return pairs, np.ascontiguousarray(which, np.uint32)


def points_with_normals(
    points: npt.ArrayLike, normals: npt.ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Points and a unit normal for each; one normal may stand for all of them."""
    at = vectors("points", points)
    return at, unit_vectors("normals", normals, len(at))


def texture_uvs(values: Iterable[npt.ArrayLike]) -> list[FloatArray]:
    """For each mesh its texture coordinates, (n, 2) each."""
    if not isinstance(values, Iterable):
        raise UsageError(f"texture_uvs is {values!r}; it must be a list of arrays")
    return [vectors(f"texture_uvs[{i}]", of, 2) for i, of in enumerate(values)]

"""Casting and checking of a mesh's arrays: the one place where they enter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from csgmesh.errors import InputError
from csgmesh.mesh.kinds import KINDS


def frozen(name: str, value: ArrayLike, dtype: type, shape: tuple[int | None, ...]) -> np.ndarray:
    """`value` as a read-only C-contiguous array; None in `shape` stands for any length."""
    if type(value) is np.ndarray and value.dtype == dtype and _is_frozen(value, shape):
        return value
    try:
        given = np.asarray(value)
    except ValueError as error:
        raise InputError(f"{name} must be an array of shape {_shape(shape)}: {error}") from error
    if given.size == 0 and given.ndim < len(shape):
        given = given.reshape([0 if n is None else n for n in shape])
    if dtype is np.int64 and given.size and given.dtype.kind not in "iu":
        raise InputError(f"{name} must hold integers; got {given.dtype}")
    if given.size and given.dtype.kind not in "iufb":
        raise InputError(f"{name} must hold numbers; got {given.dtype}")
    fits = len(given.shape) == len(shape) and all(
        want is None or want == have for want, have in zip(shape, given.shape, strict=True)
    )
    if not fits:
        raise InputError(f"{name} must have shape {_shape(shape)}; got {given.shape}")
    array: np.ndarray = np.ascontiguousarray(given, dtype=dtype)
    if array.flags.writeable:
        is_theirs = isinstance(value, np.ndarray) and np.may_share_memory(array, value)
        array = array.copy() if is_theirs else array
        array.flags.writeable = False
    return array


def _is_frozen(array: np.ndarray, shape: tuple[int | None, ...]) -> bool:
    """Whether nothing has to be done: a mesher's arrays, of which there may be thousands."""
    flags = array.flags
    if flags.writeable or not flags.c_contiguous or array.ndim != len(shape):
        return False
    return all(want is None or want == have for want, have in zip(shape, array.shape, strict=True))


def point_array(value: ArrayLike) -> np.ndarray:
    """Coordinates, (n, 2) or (n, 3)."""
    array = np.asarray(value)
    dim = array.shape[1] if array.ndim == 2 else 0
    if dim not in (2, 3):
        raise InputError(f"points must have shape (n, 2) or (n, 3); got {array.shape}")
    return frozen("points", value, np.float64, (None, dim))


def connectivity(
    name: str, value: Mapping[str, Any], dims: tuple[int, ...], n_points: int
) -> Mapping[str, np.ndarray]:
    """Rows of numbers of `n_points` points by kind, each kind of one of the dimensions `dims`."""
    if not isinstance(value, Mapping):
        raise InputError(f"{name} must map kinds to arrays; got {type(value).__name__}")
    arrays = {}
    for kind, rows in value.items():
        if kind not in KINDS or KINDS[kind].dim not in dims:
            known = ", ".join(k for k, data in KINDS.items() if data.dim in dims)
            raise InputError(f"{name} must be of kinds {known}; got {kind!r}")
        width = KINDS[kind].n_points
        array = frozen(f"{name}[{kind!r}]", rows, np.int64, (None, width))
        if array.size and (array.min() < 0 or array.max() >= n_points):
            row = int(((array < 0) | (array >= n_points)).any(axis=1).argmax())
            raise InputError(
                f"{name}[{kind!r}] must name points 0 to {n_points - 1}; "
                f"row {row} is {tuple(array[row].tolist())}"
            )
        arrays[kind] = array
    return MappingProxyType(arrays)


def by_kind(
    name: str,
    value: Mapping[str, Any],
    like: Mapping[str, np.ndarray],
    shape: tuple[int, ...],
    default: float,
) -> Mapping[str, np.ndarray]:
    """An array a kind, a row an entity of `like`; absent kinds are filled with `default`."""
    if not isinstance(value, Mapping):
        raise InputError(f"{name} must map kinds to arrays; got {type(value).__name__}")
    unknown = [kind for kind in value if kind not in like]
    if unknown:
        raise InputError(
            f"{name} must be of kinds {', '.join(like) or '(none)'}; got {unknown[0]!r}"
        )
    dtype = np.float64 if isinstance(default, float) else np.int64
    arrays = {}
    for kind, rows in like.items():
        full = (len(rows), *shape)
        given = value[kind] if kind in value else np.full(full, default, dtype)
        arrays[kind] = frozen(f"{name}[{kind!r}]", given, dtype, full)
    return MappingProxyType(arrays)


def lineage(
    given: Mapping[str, Mapping[str, Any]], cells: Mapping[str, np.ndarray]
) -> dict[str, Mapping[str, np.ndarray]]:
    """Fields that only refined meshes have: an integer a cell, or empty."""
    empty: Mapping[str, np.ndarray] = MappingProxyType({})
    return {n: by_kind(n, v, cells, (), -1) if v else empty for n, v in given.items()}


def marker_names(value: Iterable[Iterable[str]]) -> tuple[tuple[str, ...], ...]:
    """A tuple of names a marker."""
    entries = tuple(value)
    for i, entry in enumerate(entries):
        if isinstance(entry, str):
            raise InputError(
                f"boundary_names[{i}] must be a tuple of names, such as ({entry!r},); got {entry!r}"
            )
    return tuple(tuple(str(name) for name in entry) for entry in entries)


def _shape(shape: tuple[int | None, ...]) -> str:
    inside = ", ".join("n" if n is None else str(n) for n in shape)
    return f"({inside},)" if len(shape) == 1 else f"({inside})"

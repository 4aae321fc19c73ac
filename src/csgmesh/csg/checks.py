"""Checking the arguments of shapes: canonical values out, `ShapeError` for what breaks a rule.

Every function takes the value, what it is called, and where it stands (the leaf), because a message
states the rule, the value given and the place.
"""

from __future__ import annotations

import math
from numbers import Real
from typing import Any

import numpy as np

from csgmesh.domain.names import name_flaw
from csgmesh.errors import ShapeError
from csgmesh.tolerance import LARGEST, SMALLEST


def number(value: Any, what: str, where: str) -> float:
    """A finite float."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise ShapeError(f"{where}: {what} must be a number; got {value!r}")
    try:
        result = float(value)
    except OverflowError:  # a whole number beyond all floats
        result = math.inf
    if not math.isfinite(result):
        raise ShapeError(f"{where}: {what} must be finite; got {result!r}")
    if abs(result) > LARGEST:
        raise ShapeError(f"{where}: {what} must not exceed {LARGEST:g} in size; got {result!r}")
    return result + 0.0  # turns -0.0 into 0.0, so that equal values have equal bytes


def positive(value: Any, what: str, where: str) -> float:
    """A finite float above zero."""
    result = number(value, what, where)
    if result < SMALLEST:
        raise ShapeError(f"{where}: {what} must be positive; got {result!r}")
    return result


def whole(value: Any, what: str, where: str, least: int) -> int:
    """An integer, at least `least`."""
    result = number(value, what, where)
    if not result.is_integer() or result < least:
        raise ShapeError(f"{where}: {what} must be a whole number, at least {least}; got {value!r}")
    return int(result)


def vector(value: Any, what: str, where: str, dim: int | None = None) -> tuple[float, ...]:
    """A point or vector as a tuple of floats, of `dim` coordinates if given, else two or three."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, str | bytes | Real) or not hasattr(value, "__iter__"):
        raise ShapeError(f"{where}: {what} must be a point, such as (0, 0); got {value!r}")
    coordinates = tuple([number(v, f"each coordinate of {what}", where) for v in value])
    if dim is None:
        if len(coordinates) not in (2, 3):
            raise ShapeError(f"{where}: {what} must have 2 or 3 coordinates; got {value!r}")
    elif len(coordinates) != dim:
        raise ShapeError(f"{where}: {what} must have {dim} coordinates; got {value!r}")
    return coordinates


def direction(value: Any, what: str, where: str, dim: int | None = None) -> tuple[float, ...]:
    """A vector that is not zero."""
    result = vector(value, what, where, dim)
    if max(map(abs, result)) < SMALLEST:
        raise ShapeError(f"{where}: {what} must not be zero; got {result!r}")
    return result


def point_array(value: Any, what: str, where: str, dim: int = 2, least: int = 1) -> np.ndarray:
    """At least `least` points as a read-only ``(n, dim)`` array."""
    try:
        points = np.array(value, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        message = f"{where}: {what} must be an (n, {dim}) array of numbers; got {_shortened(value)}"
        raise ShapeError(message) from None
    if points.size == 0:
        points = points.reshape(0, dim)
    if points.ndim != 2 or points.shape[1] != dim:
        raise ShapeError(
            f"{where}: {what} must be an (n, {dim}) array; got one of shape {points.shape}"
        )
    if len(points) < least:
        wanted = f"at least {least} point{'s' * (least > 1)}"
        raise ShapeError(f"{where}: {what} must hold {wanted}; got {len(points)}")
    good = (np.abs(points) <= LARGEST).all(axis=1)  # NaN compares false
    if not good.all():
        first = int(np.argmin(good))
        raise ShapeError(
            f"{where}: {what} must be finite and at most {LARGEST:g}; "
            f"point {first} is {tuple(points[first].tolist())}"
        )
    points += 0.0
    points.flags.writeable = False
    return points


def query_points(value: Any, dim: int) -> np.ndarray:
    """Points asked about, as ``(n, dim)`` float64; a single point counts as one row."""
    try:
        points = np.ascontiguousarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ShapeError(
            f"contains: points must be an (n, {dim}) array of numbers; got {_shortened(value)}"
        ) from None
    if points.size == 0:
        return np.zeros((0, dim))
    if points.ndim == 1 and points.size == dim:
        points = points.reshape(1, dim)
    if points.ndim != 2 or points.shape[1] != dim:
        raise ShapeError(
            f"contains: points must be an (n, {dim}) array; got one of shape {points.shape}"
        )
    if not np.isfinite(points).all():
        first = int(np.argmin(np.isfinite(points).all(axis=1)))
        raise ShapeError(
            f"contains: points must be finite; point {first} is {tuple(points[first].tolist())}"
        )
    return points


def sequence(value: Any, what: str, where: str, rule: str) -> None:
    """Something that can be gone through, and no text."""
    if isinstance(value, str | bytes) or not hasattr(value, "__iter__"):
        raise ShapeError(f"{where}: {what} must be {rule}; got {_shortened(value)}")


def name(value: Any, where: str) -> str:
    """A usable name: dot-separated components, none empty, no glob characters, no quotes."""
    flaw = name_flaw(value)
    if flaw:
        raise ShapeError(f"{where}: {flaw}")
    return str(value)


def _shortened(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."

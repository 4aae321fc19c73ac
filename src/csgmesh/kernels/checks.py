"""Exact predicates over arrays, for those who check a mesh."""

from __future__ import annotations

import numpy as np
from numba import njit

from .pointers import ENTRY, pointer
from .predicates import incircle, orient2d


@njit(**ENTRY)
def _orientations(points, triangles, signs):
    xy = pointer(points)
    corner = pointer(triangles)
    sign = pointer(signs)
    for i in range(signs.shape[0]):
        a = 2 * corner[3 * i]
        b = 2 * corner[3 * i + 1]
        c = 2 * corner[3 * i + 2]
        o = orient2d(xy[a], xy[a + 1], xy[b], xy[b + 1], xy[c], xy[c + 1])
        sign[i] = 1 if o > 0.0 else (-1 if o < 0.0 else 0)


@njit(**ENTRY)
def _in_circles(points, triangles, others, signs):
    xy = pointer(points)
    corner = pointer(triangles)
    other = pointer(others)
    sign = pointer(signs)
    for i in range(signs.shape[0]):
        a = 2 * corner[3 * i]
        b = 2 * corner[3 * i + 1]
        c = 2 * corner[3 * i + 2]
        d = 2 * other[i]
        o = incircle(xy[a], xy[a + 1], xy[b], xy[b + 1], xy[c], xy[c + 1], xy[d], xy[d + 1])
        sign[i] = 1 if o > 0.0 else (-1 if o < 0.0 else 0)


def orientations(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Exact orientation of triangles: 1 counter-clockwise, -1 clockwise, 0 flat, (m,) int8.

    Parameters
    ----------
    points : (n, 2) float64
    triangles : (m, 3) int64
        Numbers of points; they are not checked.

    Examples
    --------
    >>> orientations(np.array([[0, 0], [1, 0], [0, 1.0]]), np.array([[0, 1, 2], [0, 2, 1]]))
    array([ 1, -1], dtype=int8)
    """
    signs = np.empty(len(triangles), np.int8)
    _orientations(_flat(points, np.float64), _flat(triangles, np.int64), signs)
    return signs


def in_circles(points: np.ndarray, triangles: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Where points lie to circumcircles, exactly: 1 inside, -1 outside, 0 on them, (m,) int8.

    Parameters
    ----------
    points : (n, 2) float64
    triangles : (m, 3) int64
        Counter-clockwise triangles.
    others : (m,) int64
        For each triangle the point to look at.

    Examples
    --------
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    >>> in_circles(square, np.array([[0, 1, 2]]), np.array([3]))
    array([0], dtype=int8)
    """
    signs = np.empty(len(triangles), np.int8)
    _in_circles(
        _flat(points, np.float64), _flat(triangles, np.int64), _flat(others, np.int64), signs
    )
    return signs


def _flat(array: np.ndarray, kind: type) -> np.ndarray:
    """A flat read-only view, whatever the array: the kernels are compiled for one type only."""
    flat: np.ndarray = np.ascontiguousarray(array, kind).reshape(-1).view()
    flat.flags.writeable = False
    return flat

"""Exact predicates of space over arrays, for those who check a mesh."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..pointers import ENTRY, pointer
from .net import in_sphere, orient_vertices


@njit(**ENTRY)
def _orientations(points, cells, signs):
    p = pointer(points)
    corner = pointer(cells)
    sign = pointer(signs)
    for i in range(signs.shape[0]):
        h = 4 * i
        o = orient_vertices(p, corner[h], corner[h + 1], corner[h + 2], corner[h + 3])
        sign[i] = 1 if o > 0.0 else (-1 if o < 0.0 else 0)


@njit(**ENTRY)
def _in_spheres(points, cells, others, signs):
    p = pointer(points)
    corner = pointer(cells)
    other = pointer(others)
    sign = pointer(signs)
    for i in range(signs.shape[0]):
        h = 4 * i
        e = 3 * other[i]
        a, b, c, d = corner[h], corner[h + 1], corner[h + 2], corner[h + 3]
        o = in_sphere(p, a, b, c, d, p[e], p[e + 1], p[e + 2])
        sign[i] = 1 if o > 0.0 else (-1 if o < 0.0 else 0)


def tetra_orientations(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Exact orientation of tetrahedra: 1 positive, -1 inverted, 0 flat, (m,) int8.

    Parameters
    ----------
    points : (n, 3) float64
    cells : (m, 4) int64
        Numbers of points; they are not checked.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> tetra_orientations(corners, np.array([[0, 1, 2, 3], [0, 2, 1, 3]]))
    array([ 1, -1], dtype=int8)
    """
    signs = np.empty(len(cells), np.int8)
    _orientations(_flat(points, np.float64), _flat(cells, np.int64), signs)
    return signs


def in_spheres(points: np.ndarray, cells: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Where points lie to circumspheres, exactly: 1 inside, -1 outside, 0 on them, (m,) int8.

    Parameters
    ----------
    points : (n, 3) float64
    cells : (m, 4) int64
        Tetrahedra of positive volume.
    others : (m,) int64
        For each the point to look at.

    Examples
    --------
    >>> cube = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0], [1, 1, 1]])
    >>> in_spheres(cube, np.array([[0, 1, 2, 3]]), np.array([4]))
    array([0], dtype=int8)
    """
    signs = np.empty(len(cells), np.int8)
    _in_spheres(_flat(points, np.float64), _flat(cells, np.int64), _flat(others, np.int64), signs)
    return signs


def _flat(array: np.ndarray, kind: type) -> np.ndarray:
    """A flat read-only view, whatever the array: the kernels are compiled for one type only."""
    flat: np.ndarray = np.ascontiguousarray(array, kind).reshape(-1).view()
    flat.flags.writeable = False
    return flat

"""Tetrahedra in flat arrays, and how to find one's way among them.

Corner h = 4 t + k, k = 0 … 3, of tetrahedron t, and the face opposite to it:

- ``vert[h]`` the vertex,
- ``nei[h]`` the same face seen from the other tetrahedron, as its corner there.

Ghost tetrahedra close the outside; their last vertex is -1, and the other three are a face of the
hull, ordered so that a point beyond it would make a positive volume. Slots that hold nothing have
-2 for their first vertex.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from ..pointers import HELPER
from .predicates import insphere, orient3d

#: Pointers to points, tetrahedra, stamps, empty slots and the buffers of one insertion.
Net = namedtuple("Net", "xyz vert nei mark free cavity rim")

# What a kernel says when it returns to its shell.
DONE = np.int64(0)
ROOM = np.int64(1)
SLICE = np.int64(2)
DUPLICATE = np.int64(4)
COPLANAR = np.int64(7)
TETS = np.int64(10)


@njit(**HELPER)
def orient_vertices(xyz, a, b, c, d):
    """Exact sign of the volume of four vertices."""
    a *= 3
    b *= 3
    c *= 3
    d *= 3
    return orient3d(
        xyz[a],
        xyz[a + 1],
        xyz[a + 2],
        xyz[b],
        xyz[b + 1],
        xyz[b + 2],
        xyz[c],
        xyz[c + 1],
        xyz[c + 2],
        xyz[d],
        xyz[d + 1],
        xyz[d + 2],
    )


@njit(**HELPER)
def orient_point(xyz, a, b, c, x, y, z):
    a *= 3
    b *= 3
    c *= 3
    return orient3d(
        xyz[a],
        xyz[a + 1],
        xyz[a + 2],
        xyz[b],
        xyz[b + 1],
        xyz[b + 2],
        xyz[c],
        xyz[c + 1],
        xyz[c + 2],
        x,
        y,
        z,
    )


@njit(**HELPER)
def in_sphere(xyz, a, b, c, d, x, y, z):
    a *= 3
    b *= 3
    c *= 3
    d *= 3
    return insphere(
        xyz[a],
        xyz[a + 1],
        xyz[a + 2],
        xyz[b],
        xyz[b + 1],
        xyz[b + 2],
        xyz[c],
        xyz[c + 1],
        xyz[c + 2],
        xyz[d],
        xyz[d + 1],
        xyz[d + 2],
        x,
        y,
        z,
    )


@njit(**HELPER)
def in_conflict(xyz, vert, nei, t, x, y, z):
    """Whether a point lies inside the circumsphere of t; for a ghost, beyond its face."""
    h = 4 * t
    d = vert[h + 3]
    if d < 0:
        o = orient_point(xyz, vert[h], vert[h + 1], vert[h + 2], x, y, z)
        if o != 0.0:
            return o > 0.0
        h = nei[h + 3] & ~3
        d = vert[h + 3]
    return in_sphere(xyz, vert[h], vert[h + 1], vert[h + 2], d, x, y, z) > 0.0


@njit(**HELPER)
def walk(xyz, vert, nei, t, x, y, z):
    """Visibility walk from t to the tetrahedron that holds a point, or to a ghost that sees it."""
    if vert[4 * t + 3] < 0:
        t = nei[4 * t + 3] >> 2
    entry = np.int64(0)
    tested = np.int64(4)
    while True:
        moved = False
        for turn in range(tested):
            i = (entry + 1 + turn) & 3
            o = orient_point(
                xyz,
                vert[4 * t + ((i + 1) & 3)],
                vert[4 * t + ((i + 2) & 3)],
                vert[4 * t + ((i + 3) & 3)],
                x,
                y,
                z,
            )
            if (o < 0.0) if i & 1 else (o > 0.0):
                h = nei[4 * t + i]
                t = h >> 2
                entry = h & 3
                tested = 3
                moved = True
                break
        if not moved or vert[4 * t + 3] < 0:
            return t


@njit(**HELPER)
def slot_of(vert, t, v):
    """Which corner of t vertex v is."""
    h = 4 * t
    if vert[h] == v:
        return np.int64(0)
    if vert[h + 1] == v:
        return np.int64(1)
    if vert[h + 2] == v:
        return np.int64(2)
    return np.int64(3)

"""Sizes between the vertices of a coarser mesh, for the refinement of a finer one."""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from .pointers import ENTRY, HELPER, pointer
from .triangulation import following

#: A triangulation and the sizes at its vertices.
Background = namedtuple("Background", "xy origin twin size")

#: The coarse mesh need not be Delaunay, so that a walk may go round in circles: it ends somewhere.
LONGEST_WALK = 10000


@njit(**HELPER)
def inner(origin, twin, t):
    """Triangle t, or the one inside the edge of ghost triangle t."""
    for e in range(3):
        if origin[t + e] < 0:
            return twin[following(t + e)] & ~3
    return t


@njit(**HELPER)
def stroll_to(ground, t, x, y):
    """The triangle that holds (x, y), or one near it, from triangle t.

    Rounding may choose the neighbour of the right one, which is as good; it never turns back.
    """
    xy = ground.xy
    t = inner(ground.origin, ground.twin, t)
    entry = t + 3
    for _ in range(LONGEST_WALK):
        here = t
        for e in range(3):
            h = t + e
            a = ground.origin[h]
            b = ground.origin[following(h)]
            left = (xy[2 * b] - xy[2 * a]) * (y - xy[2 * a + 1])
            if h != entry and left < (xy[2 * b + 1] - xy[2 * a + 1]) * (x - xy[2 * a]):
                h = ground.twin[h]
                o = h & ~3
                if ground.origin[o] | ground.origin[o + 1] | ground.origin[o + 2] >= 0:
                    here = o
                    entry = h
                    break
        if here == t:
            return t
        t = here
    return t


@njit(**HELPER)
def interpolated(xy, origin, size, t, x, y):
    """Size at (x, y), linear over triangle t; beside it, as at its edge."""
    a = origin[t]
    b = origin[t + 1]
    c = origin[t + 2]
    bx = xy[2 * b] - xy[2 * a]
    by = xy[2 * b + 1] - xy[2 * a + 1]
    cx = xy[2 * c] - xy[2 * a]
    cy = xy[2 * c + 1] - xy[2 * a + 1]
    px = x - xy[2 * a]
    py = y - xy[2 * a + 1]
    area = bx * cy - by * cx
    if area <= 0.0:
        # Between almost collinear points outside the domain.
        return min(size[a], size[b], size[c])
    v = min(max((px * cy - py * cx) / area, 0.0), 1.0)
    w = min(max((bx * py - by * px) / area, 0.0), 1.0 - v)
    return (1.0 - v - w) * size[a] + v * size[b] + w * size[c]


@njit(**HELPER)
def background_size(ground, t, x, y):
    """Size at (x, y), and the triangle it was found in; t is where to look first."""
    t = stroll_to(ground, t, x, y)
    return interpolated(ground.xy, ground.origin, ground.size, t, x, y), t


@njit(**ENTRY)
def look_up(points, origin, twin, sizes, places, found, homes):
    """Sizes found[i] at places[2 i], places[2 i + 1], best sorted along a curve, and triangles."""
    ground = Background(pointer(points), pointer(origin), pointer(twin), pointer(sizes))
    place = pointer(places)
    size = pointer(found)
    home = pointer(homes)
    t = np.int64(0)
    for i in range(found.shape[0]):
        h, t = background_size(ground, t, place[2 * i], place[2 * i + 1])
        size[i] = h
        home[i] = t

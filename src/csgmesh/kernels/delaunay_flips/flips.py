"""Lawson's algorithm: turn edges that are not locally Delaunay, by exact predicates."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from ..predicates import incircle

#: Edges turned, or looked at, between two returns to the caller.
SLICE = 400_000
#: Half-edges to look at again after turning one; those that do not fit wait for the next sweep.
STACK = 256


@njit(**HELPER)
def after(h):
    return h + 1 if h % 3 < 2 else h - 2


@njit(**HELPER)
def before(h):
    return h - 1 if h % 3 > 0 else h + 2


@njit(**HELPER)
def is_delaunay(xy, origin, twin, h):
    """Whether the vertex across half-edge h lies outside its triangle's circle, or on it."""
    a = 2 * origin[h]
    b = 2 * origin[after(h)]
    c = 2 * origin[before(h)]
    d = 2 * origin[before(twin[h])]
    return incircle(xy[a], xy[a + 1], xy[b], xy[b + 1], xy[c], xy[c + 1], xy[d], xy[d + 1]) <= 0.0


@njit(**HELPER)
def connect(twin, locked, h, g, is_locked):
    """Make h and g twins; g may be -1."""
    twin[h] = g
    locked[h] = is_locked
    if g >= 0:
        twin[g] = h


@njit(**HELPER)
def turn(origin, twin, locked, h):
    """Replace the edge of h by the other diagonal of its two triangles."""
    g = twin[h]
    t = h - h % 3
    s = g - g % 3
    a = origin[h]
    b = origin[g]
    c = origin[before(h)]
    d = origin[before(g)]
    ad = twin[after(g)]
    ad_lock = locked[after(g)]
    db = twin[before(g)]
    db_lock = locked[before(g)]
    bc = twin[after(h)]
    bc_lock = locked[after(h)]
    ca = twin[before(h)]
    ca_lock = locked[before(h)]
    origin[t] = a
    origin[t + 1] = d
    origin[t + 2] = c
    origin[s] = d
    origin[s + 1] = b
    origin[s + 2] = c
    connect(twin, locked, t, ad, ad_lock)
    connect(twin, locked, t + 2, ca, ca_lock)
    connect(twin, locked, s, db, db_lock)
    connect(twin, locked, s + 1, bc, bc_lock)
    connect(twin, locked, t + 1, s + 2, 0)
    locked[s + 2] = 0
    return t, s


@njit(**ENTRY)
def flip_edges(points, origins, twins, locks, stacks, counts):
    """Turn edges until none is left that may be turned; returns whether there is more to do.

    counts: the next half-edge of the sweep, edges turned in this sweep, edges turned so far. Locked
    half-edges stay; their triangles' twins are paired as others are.
    """
    xy = pointer(points)
    origin = pointer(origins)
    twin = pointer(twins)
    locked = pointer(locks)
    stack = pointer(stacks)
    work = 0
    while True:
        if counts[0] >= origins.shape[0]:
            if counts[1] == 0:
                return False
            counts[0] = 0
            counts[1] = 0
        if work > SLICE:
            return True
        top = 1
        stack[0] = counts[0]
        counts[0] += 1
        while top > 0:
            top -= 1
            h = stack[top]
            work += 1
            if twin[h] < 0 or locked[h] != 0 or is_delaunay(xy, origin, twin, h):
                continue
            t, s = turn(origin, twin, locked, h)
            counts[1] += 1
            counts[2] += 1
            if top + 4 <= STACK:
                stack[top] = t
                stack[top + 1] = t + 2
                stack[top + 2] = s
                stack[top + 3] = s + 1
                top += 4

"""Edges of the surface turned within a face."""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import HELPER
from .cells import C_EDGE, C_WALLS, ON_FACE

#: A turned triangle keeps this cosine to the exact normals at its corners: 60 degrees.
UPRIGHT = 0.5
#: Squared sine of the smallest angle that a turned triangle may have, 25 degrees, unless it had a
#: smaller one.
THIN = 0.1786


@njit(**HELPER)
def is_segment(view, a, b):
    """Whether a, b is a piece of a feature curve."""
    for k in range(view.segment_begin[a], view.segment_begin[a + 1]):
        if view.segment[k] == b:
            return True
    return False


@njit(**HELPER)
def corner_of(view, w, v):
    """Where vertex v stands in surface triangle w."""
    k = 3 * w
    while view.triangle[k] != v:
        k += 1
    return k


@njit(**HELPER)
def sag(view, g, h):
    """How far the chord between two corners of triangles is from the surface, at its middle.

    The exact normals at its ends turn by as much as it takes the surface to bend away.
    """
    p = 3 * view.triangle[g]
    q = 3 * view.triangle[h]
    total = 0.0
    for k in range(3):
        total += (view.normal[3 * g + k] - view.normal[3 * h + k]) * (
            view.xyz[p + k] - view.xyz[q + k]
        )
    return abs(total) / 8.0


@njit(**HELPER)
def upright(view, g, h, k):
    """Squared sine of the smallest angle of three corners of triangles; 0 if it leans too much."""
    a = 3 * view.triangle[g]
    b = 3 * view.triangle[h]
    c = 3 * view.triangle[k]
    ux = view.xyz[b] - view.xyz[a]
    uy = view.xyz[b + 1] - view.xyz[a + 1]
    uz = view.xyz[b + 2] - view.xyz[a + 2]
    vx = view.xyz[c] - view.xyz[a]
    vy = view.xyz[c + 1] - view.xyz[a + 1]
    vz = view.xyz[c + 2] - view.xyz[a + 2]
    nx = uy * vz - uz * vy
    ny = uz * vx - ux * vz
    nz = ux * vy - uy * vx
    area = nx * nx + ny * ny + nz * nz
    least = UPRIGHT * sqrt(area)
    for i in range(3):
        at = 3 * (g if i == 0 else (h if i == 1 else k))
        cosine = nx * view.normal[at] + ny * view.normal[at + 1] + nz * view.normal[at + 2]
        if cosine <= least:
            return 0.0
    u = ux * ux + uy * uy + uz * uz
    v = vx * vx + vy * vy + vz * vz
    wx = vx - ux
    wy = vy - uy
    wz = vz - uz
    w = wx * wx + wy * wy + wz * wz
    # The smallest angle is opposite the shortest edge.
    return area * min(u, min(v, w)) / (u * v * w)


@njit(**HELPER)
def may_turn(view, a, b, p, q):
    """Whether edge a, b of the surface may be turned to p, q."""
    w = view.count[C_WALLS]
    x = view.count[C_WALLS + 1]
    f = view.face[w]
    if f != view.face[x]:
        return False
    if view.kind[a] != ON_FACE and view.kind[b] != ON_FACE and is_segment(view, a, b):
        return False
    wa = corner_of(view, w, a)
    wb = corner_of(view, w, b)
    wp = corner_of(view, w, p)
    xa = corner_of(view, x, a)
    xb = corner_of(view, x, b)
    xq = corner_of(view, x, q)
    height = 0.0
    for k in range(2):
        value = sag(view, wa if k == 0 else wp, wb if k == 0 else xq)
        if k == 1 and value > max(view.limit[f], height):
            return False
        height = value
    forward = wb - 3 * w == (wa - 3 * w + 1) % 3
    old = 1.0
    new = 1.0
    for k in range(4):
        g = wa if k & 1 == 0 else xb
        if k < 2:
            h = wb if k == 0 else xa
            e = wp if k == 0 else xq
        else:
            h = xq if k == 2 else wp
            e = wp if k == 2 else xq
        if not forward:
            h, e = e, h
        value = upright(view, g, h, e)
        if k < 2:
            old = min(old, value)
        else:
            new = min(new, value)
    return new > 0.0 and new >= min(THIN, old)


@njit(**HELPER)
def write_corner(view, at, v, nx, ny, nz):
    """Make v, with the exact normal there, corner `at` of the surface's triangles."""
    view.triangle[at] = v
    view.normal[3 * at] = nx
    view.normal[3 * at + 1] = ny
    view.normal[3 * at + 2] = nz


@njit(**HELPER)
def turn(view):
    """Turn edge a, b of two surface triangles to p, q, as planned.

    The first was a, b, p in some order and gets q for b; the second was a, b, q and gets p for a.
    """
    b = view.count[C_EDGE + 1]
    a = view.count[C_EDGE]
    p = view.count[C_EDGE + 2]
    q = view.count[C_EDGE + 3]
    w = view.count[C_WALLS]
    x = view.count[C_WALLS + 1]
    wp = 3 * corner_of(view, w, p)
    xq = 3 * corner_of(view, x, q)
    wb = corner_of(view, w, b)
    xa = corner_of(view, x, a)
    px = view.normal[wp]
    py = view.normal[wp + 1]
    pz = view.normal[wp + 2]
    write_corner(view, wb, q, view.normal[xq], view.normal[xq + 1], view.normal[xq + 2])
    write_corner(view, xa, p, px, py, pz)

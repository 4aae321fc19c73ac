"""Flip edges until opposite angles add up to at most two right angles (Lawson 1977).

In space the criterion is the intrinsic one of the two triangles of an edge; the flipped pair must
look the same way as the old one.
"""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import ENTRY, HELPER
from .arrays import view_of
from .exact import CODES, PLANE
from .slopes import slope, steepest
from .topology import FACE, after, are_joined, before, flip, quality

#: Opposite angles must exceed two right angles by this much, as a sine, for a flip.
MARGIN = 1e-9
#: Least share of the pair's area that each flipped triangle has, against slivers from rounding.
CONVEX = 1e-6
#: Least cosine between the normals of the pair and of each flipped triangle.
FLATNESS = 0.5
#: Flips that one changed edge may cause: a bound against cycles, which curved faces may have.
CASCADE = 400


@njit(**HELPER)
def exact_quality(view, face, a, b, c):
    """Shape of the triangle of three vertices, seen along the exact normal."""
    p = view.xyz
    return quality(
        view,
        face,
        p[3 * a],
        p[3 * a + 1],
        p[3 * a + 2],
        p[3 * b],
        p[3 * b + 1],
        p[3 * b + 2],
        p[3 * c],
        p[3 * c + 1],
        p[3 * c + 2],
    )


@njit(**HELPER)
def wants_flip(view, h, exact):
    """Whether the edge of h is to be flipped; `exact` asks the exact normals, too."""
    g = view.twin[h]
    if g < 0:
        return False
    o = view.origin
    p = view.xyz
    va = o[h]
    vb = o[g]
    vc = o[before(h)]
    vd = o[before(g)]
    if vc == vd:
        return False
    ax = p[3 * va]
    ay = p[3 * va + 1]
    az = p[3 * va + 2]
    bx = p[3 * vb] - ax
    by = p[3 * vb + 1] - ay
    bz = p[3 * vb + 2] - az
    cx = p[3 * vc] - ax
    cy = p[3 * vc + 1] - ay
    cz = p[3 * vc + 2] - az
    dx = p[3 * vd] - ax
    dy = p[3 * vd + 1] - ay
    dz = p[3 * vd + 2] - az
    # Area vectors of abc, adb; of dca and cdb after a flip.
    ux = by * cz - bz * cy
    uy = bz * cx - bx * cz
    uz = bx * cy - by * cx
    vx = dy * bz - dz * by
    vy = dz * bx - dx * bz
    vz = dx * by - dy * bx
    nx = ux + vx
    ny = uy + vy
    nz = uz + vz
    sx = dy * cz - dz * cy
    sy = dz * cx - dx * cz
    sz = dx * cy - dy * cx
    tx = nx - sx
    ty = ny - sy
    tz = nz - sz
    nn = nx * nx + ny * ny + nz * nz
    s = nx * sx + ny * sy + nz * sz
    t = nx * tx + ny * ty + nz * tz
    if min(s, t) <= CONVEX * nn:
        return False
    u = nx * ux + ny * uy + nz * uz
    v = nx * vx + ny * vy + nz * vz
    if min(u, v) > CONVEX * nn:
        lu = sqrt(ux * ux + uy * uy + uz * uz)
        lv = sqrt(vx * vx + vy * vy + vz * vz)
        at_c = cx * (cx - bx) + cy * (cy - by) + cz * (cz - bz)
        at_d = dx * (dx - bx) + dy * (dy - by) + dz * (dz - bz)
        if at_c * lv + at_d * lu >= -MARGIN * (bx * bx + by * by + bz * bz) * (lu + lv):
            return False
    ls = sx * sx + sy * sy + sz * sz
    lt = tx * tx + ty * ty + tz * tz
    bend = FLATNESS * FLATNESS * nn
    if s * s < bend * ls or t * t < bend * lt:
        return False
    if are_joined(view, before(h), vd):
        return False
    f = o[h | 3]
    surface = view.face_surface[f]
    if view.code[CODES * surface] != PLANE:
        rise = slope(view, surface, vc, vd)
        if rise > steepest(view, vc, vd) and rise > slope(view, surface, va, vb):
            return False
    if exact:
        old = min(exact_quality(view, f, va, vb, vc), exact_quality(view, f, va, vd, vb))
        new = min(exact_quality(view, f, vd, vc, va), exact_quality(view, f, vc, vd, vb))
        return new > 0.0 if old > 0.0 else new > old
    return True


@njit(**HELPER)
def settle(view, n, exact):
    """Flip what is in ``todo[:n]``, and what flips disturb. The number of flips."""
    flips = 0
    bound = CASCADE + 4 * n
    while n > 0:
        n -= 1
        h = view.todo[n]
        if flips < bound and wants_flip(view, h, exact):
            g = view.twin[h]
            flip(view, h)
            flips += 1
            view.todo[n] = after(h)
            view.todo[n + 1] = before(h)
            view.todo[n + 2] = after(g)
            view.todo[n + 3] = before(g)
            n += 4
    return flips


@njit(**ENTRY)
def flip_surface(arrays, start, stop, exact):
    """Flip the edges of triangles from `start` to before `stop`. The number of flips."""
    view = view_of(arrays)
    flips = 0
    for t in range(start, stop):
        if view.origin[4 * t + FACE] < 0:
            continue
        for k in range(3):
            if view.twin[4 * t + k] > 4 * t + k:
                view.todo[0] = 4 * t + k
                flips += settle(view, 1, exact)
    return flips

"""Put vertices on curves, and take away vertices that the wanted sizes do not ask for."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER
from .arrays import view_of
from .exact import on_surface
from .slopes import slope, steepest
from .topology import (
    POINTS,
    after,
    are_joined,
    before,
    collapse_inside,
    collapse_sheet,
    distance,
    fan_from,
    far_end,
    quality,
    quality_with,
    split_segment,
)

#: Triangles may get this flat while vertices are taken away: flips mend them afterwards.
FLAT = 0.02
#: Best shape that is asked of the triangles left where a vertex inside a face was.
DECENT = 0.2
#: Shape at which no better neighbour is looked for.
ENOUGH = 0.5
#: Longest new edge of a curve and within a face, as a share of the wanted length.
LONGEST = 1.5
REACH = 1.9
#: Least cosine between a triangle's normal and the exact normals at its corners.
BENT = 0.6
#: Sheets of one segment, at most, and where in the buffer they are kept.
SHEETS = 60
RING = 64


@njit(**HELPER)
def sheets_of(view, s):
    """Half-edges of segment s into ``buffer[RING:]``, and their number; 0 if there are too many."""
    first = view.seg[4 * s + 3]
    n = 0
    h = first
    while True:
        view.buffer[RING + n] = h
        n += 1
        h = view.ring[h]
        if h == first:
            return n
        if n >= SHEETS:
            return 0


@njit(**HELPER)
def can_split(view, s, x, y, z):
    """Whether no triangle turns over if segment s is split at a place."""
    p = view.xyz
    o = view.origin
    n = sheets_of(view, s)
    if n == 0:
        return False
    for k in range(n):
        h = view.buffer[RING + k]
        f = o[h | 3]
        a = 3 * o[h]
        b = 3 * o[after(h)]
        c = 3 * o[before(h)]
        old = quality(
            view, f, p[a], p[a + 1], p[a + 2], p[b], p[b + 1], p[b + 2], p[c], p[c + 1], p[c + 2]
        )
        one = quality(view, f, p[a], p[a + 1], p[a + 2], x, y, z, p[c], p[c + 1], p[c + 2])
        two = quality(view, f, x, y, z, p[b], p[b + 1], p[b + 2], p[c], p[c + 1], p[c + 2])
        if min(one, two) <= min(0.0, 2.0 * old):
            return False
    return True


@njit(**HELPER)
def new_vertex(view, x, y, z, size, cap, dim, owner):
    """Number of a new vertex."""
    v = view.count[POINTS]
    view.count[POINTS] = v + 1
    view.xyz[3 * v] = x
    view.xyz[3 * v + 1] = y
    view.xyz[3 * v + 2] = z
    view.size[v] = size
    view.cap[v] = cap
    view.dim[v] = dim
    view.owner[v] = owner
    view.keep[v] = 1
    view.link[2 * v] = 0
    view.link[2 * v + 1] = 0
    return v


@njit(**ENTRY)
def insert_samples(arrays, segment, places, size, start, stop):
    """Split segments at places, of which those of one segment come from its end to its start.

    The number of places where a triangle would have turned over, which are left out.
    """
    view = view_of(arrays)
    refused = 0
    for k in range(start, stop):
        s = segment[k]
        x = places[k, 0]
        y = places[k, 1]
        z = places[k, 2]
        if not can_split(view, s, x, y, z):
            refused += 1
            continue
        a = view.seg[4 * s]
        b = view.seg[4 * s + 1]
        cap = max(view.cap[a], view.cap[b])
        split_segment(view, s, new_vertex(view, x, y, z, size[k], cap, 1, view.seg[4 * s + 2]))
    return refused


@njit(**HELPER)
def sheet_allows(view, e, v, b, a):
    """Least shapes in one sheet before and after v moves to b along half-edge e; (1, -2) if not.

    Their order: after, before.
    """
    o = view.origin
    from_v = o[e] == v
    side = before(e) if from_v else after(e)
    outer = after(e) if from_v else before(e)
    if view.twin[side] < 0 and view.twin[outer] < 0:
        return -2.0, 1.0
    apex = o[before(e)]
    n = fan_from(view, e if from_v else after(e), 0)
    if n < 0:
        return -2.0, 1.0
    at_b = after(e) if from_v else e
    s = view.face_surface[o[e | 3]]
    bent = view.code[4 * s] != 0
    p = view.xyz
    worst = 1.0
    now = 1.0
    for k in range(n):
        g = view.buffer[k]
        now = min(now, quality_with(view, g, p[3 * v], p[3 * v + 1], p[3 * v + 2]))
        for w in (o[after(g)], o[before(g)]):
            if w != b and w != apex and are_joined(view, at_b, w):
                return -2.0, 1.0
            if bent and w not in (a, b):
                rise = slope(view, s, b, w)
                if rise > steepest(view, b, w) and rise > slope(view, s, v, w):
                    return -2.0, 1.0
        if g >> 2 != e >> 2:
            worst = min(worst, quality_with(view, g, p[3 * b], p[3 * b + 1], p[3 * b + 2]))
    if apex != a and view.twin[side] >= 0 and n == 1:
        return -2.0, 1.0
    return worst, now


@njit(**HELPER)
def move_along(view, v, s, other):
    """Take a curve's vertex away by moving it along segment s, if all sheets allow it."""
    b = far_end(view, s, v)
    a = far_end(view, other, v)
    if a == b or distance(view, a, b) > LONGEST * max(view.size[a], view.size[b]):
        return False
    for w, u in ((a, b), (b, a)):
        if view.dim[w] == 1:
            for k in range(2):
                if far_end(view, view.link[2 * w + k], w) == u:
                    return False
    sheets = sheets_of(view, s)
    if sheets == 0:
        return False
    for k in range(sheets):
        worst, now = sheet_allows(view, view.buffer[RING + k], v, b, a)
        if worst <= -2.0 or worst <= min(0.0, now) or worst < min(FLAT, 0.3 * now):
            return False
    for k in range(sheets):
        e = view.buffer[RING + k]
        n = fan_from(view, e if view.origin[e] == v else after(e), 0)
        collapse_sheet(view, e, v, b, 0, n)
    if view.seg[4 * other] == v:
        view.seg[4 * other] = b
    else:
        view.seg[4 * other + 1] = b
    view.seg[4 * s] = -1
    if view.dim[b] == 1:
        if view.link[2 * b] == s:
            view.link[2 * b] = other
        else:
            view.link[2 * b + 1] = other
    view.dim[v] = -1
    return True


@njit(**HELPER)
def is_flat(view, f, ax, ay, az, bx, by, bz, cx, cy, cz):
    """Whether a triangle's normal is near the exact normals at its corners."""
    s = view.face_surface[f]
    if view.code[4 * s] == 0:
        return True
    ux = bx - ax
    uy = by - ay
    uz = bz - az
    vx = cx - ax
    vy = cy - ay
    vz = cz - az
    nx = uy * vz - uz * vy
    ny = uz * vx - ux * vz
    nz = ux * vy - uy * vx
    size = (nx * nx + ny * ny + nz * nz) ** 0.5
    sign = view.face_sign[f]
    mx = (ax + bx + cx) / 3.0
    my = (ay + by + cy) / 3.0
    mz = (az + bz + cz) / 3.0
    for x, y, z in ((ax, ay, az), (bx, by, bz), (cx, cy, cz)):
        # A little inwards, as the apex of a cone has no normal.
        _, _, _, ox, oy, oz = on_surface(
            view.code,
            view.number,
            s,
            x + 0.05 * (mx - x),
            y + 0.05 * (my - y),
            z + 0.05 * (mz - z),
        )
        if sign * (nx * ox + ny * oy + nz * oz) < BENT * size:
            return False
    return True


@njit(**HELPER)
def worth_of(view, h, n, reach, least):
    """Least shape around if the vertex of the fan moves along h; -2 if it may not.

    Also if that is `least` or less.
    """
    o = view.origin
    p = view.xyz
    b = o[after(h)]
    c = o[before(h)]
    d = o[before(view.twin[h])]
    worst = 1.0
    x = p[3 * b]
    y = p[3 * b + 1]
    z = p[3 * b + 2]
    for k in range(n):
        g = view.buffer[k]
        w = o[after(g)]
        if w == b:
            continue
        if w not in (c, d) and (distance(view, w, b) > reach or are_joined(view, after(h), w)):
            return -2.0
        if o[before(g)] == b:
            continue
        worst = min(worst, quality_with(view, g, x, y, z))
        if worst <= least:
            return -2.0
    for k in range(n):
        g = view.buffer[k]
        i = 3 * o[after(g)]
        j = 3 * o[before(g)]
        if b not in (o[after(g)], o[before(g)]) and not is_flat(
            view, o[g | 3], x, y, z, p[i], p[i + 1], p[i + 2], p[j], p[j + 1], p[j + 2]
        ):
            return -2.0
    return worst


@njit(**HELPER)
def take_inner(view, v):
    """Take a vertex inside a face away by moving it to the best neighbour, if there is one."""
    n = fan_from(view, view.link[2 * v], 0)
    if n < 3:
        return False
    p = view.xyz
    now = 1.0
    best = -2.0
    along = 0
    reach = REACH * view.size[v]
    for k in range(n):
        h = view.buffer[k]
        now = min(now, quality_with(view, h, p[3 * v], p[3 * v + 1], p[3 * v + 2]))
    for k in range(n):
        h = view.buffer[k]
        worth = worth_of(view, h, n, reach, max(best, 0.0))
        if worth > best:
            best = worth
            along = h
            if worth > ENOUGH:
                break
    if best <= 0.0 or best < min(DECENT, now):
        return False
    collapse_inside(view, along, 0, n)
    view.dim[v] = -1
    return True


@njit(**ENTRY)
def take_vertices(arrays, start, stop, dim):
    """Take away vertices of curves (`dim` 1) or faces (2) that need not be kept. Their number."""
    view = view_of(arrays)
    taken = 0
    for v in range(start, stop):
        if view.keep[v] or view.dim[v] != dim:
            continue
        if dim == 2:
            taken += take_inner(view, v)
            continue
        s = view.link[2 * v]
        other = view.link[2 * v + 1]
        taken += move_along(view, v, s, other) or move_along(view, v, other, s)
    return taken

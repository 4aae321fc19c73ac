"""Insert points into the triangles of a face, or onto its curves, and flip to Delaunay again."""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import HELPER
from .coarsening import can_split, new_vertex, sheets_of
from .flipping import exact_quality, settle
from .topology import (
    FACE,
    HEAD,
    MASK,
    QUEUED,
    SEGMENTS,
    after,
    before,
    distance,
    fan_from,
    put_back,
    quality,
    split_edge,
    split_segment,
    split_triangle,
)

#: Triangles walked through on the way to a point.
WALK = 80
#: A point this near to an edge, as a share of the edge, splits it.
NEAR_EDGE = 0.1
#: A point sees a segment under an angle whose cosine is below this: it would be too near.
LENS = -0.45
#: Least shape of new triangles, unless the old one is worse.
FLAT = 0.02
#: A new point keeps this share of the distance aimed at from other vertices.
APART = 0.6

#: Outcomes.
INSERTED = 0
REFUSED = 1
BLOCKED = 2


@njit(**HELPER)
def enqueue(view, t):
    """Put a triangle into the queue unless it waits there."""
    flag = view.twin[4 * t + 3]
    if flag & 1 == 0:
        view.twin[4 * t + 3] = flag | 1
        n = view.count[QUEUED]
        view.queue[(view.count[HEAD] + n) & view.count[MASK]] = t
        view.count[QUEUED] = n + 1


@njit(**HELPER)
def enqueue_around(view, h):
    """Put the triangles around the start of h, in its sheet, into the queue."""
    n = fan_from(view, h, 0)
    for k in range(n):
        enqueue(view, view.buffer[k] >> 2)


@njit(**HELPER)
def side_of(view, h, x, y, z, nx, ny, nz):
    """Distance of a point from the edge of h, inwards, and the edge's length."""
    p = view.xyz
    a = 3 * view.origin[h]
    b = 3 * view.origin[after(h)]
    ux = p[b] - p[a]
    uy = p[b + 1] - p[a + 1]
    uz = p[b + 2] - p[a + 2]
    vx = x - p[a]
    vy = y - p[a + 1]
    vz = z - p[a + 2]
    o = nx * (uy * vz - uz * vy) + ny * (uz * vx - ux * vz) + nz * (ux * vy - uy * vx)
    size = sqrt(ux * ux + uy * uy + uz * uz)
    return o / size, size


@njit(**HELPER)
def area_vector(view, t):
    """Cross product of two sides of a triangle."""
    p = view.xyz
    a = 3 * view.origin[4 * t]
    b = 3 * view.origin[4 * t + 1]
    c = 3 * view.origin[4 * t + 2]
    ux = p[b] - p[a]
    uy = p[b + 1] - p[a + 1]
    uz = p[b + 2] - p[a + 2]
    vx = p[c] - p[a]
    vy = p[c + 1] - p[a + 1]
    vz = p[c + 2] - p[a + 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@njit(**HELPER)
def walk(view, t, x, y, z):
    """Half-edge of the triangle at a point, nearest to it; or ``-1 - s`` at a segment on the way.

    Also the distance from that half-edge, as a share of its length.
    """
    last = -1
    for _ in range(WALK):
        nx, ny, nz = area_vector(view, t)
        size = sqrt(nx * nx + ny * ny + nz * nz)
        if size == 0.0:
            return 4 * t, -1.0
        least = 1e300
        at = 0
        share = 0.0
        for k in range(3):
            o, length = side_of(view, 4 * t + k, x, y, z, nx / size, ny / size, nz / size)
            if o < least and (view.twin[4 * t + k] < 0 or view.twin[4 * t + k] >> 2 != last):
                least = o
                at = 4 * t + k
                share = o / length
        if share >= -1e-9:
            return at, share
        g = view.twin[at]
        if g < 0:
            return g, share
        last = t
        t = g >> 2
    return 4 * t, -1.0


@njit(**HELPER)
def sees_closely(view, h, x, y, z):
    """Whether the edge of h is a segment that a point sees under a wide angle."""
    if view.twin[h] >= 0:
        return False
    p = view.xyz
    a = 3 * view.origin[h]
    b = 3 * view.origin[after(h)]
    ux = p[a] - x
    uy = p[a + 1] - y
    uz = p[a + 2] - z
    vx = p[b] - x
    vy = p[b + 1] - y
    vz = p[b + 2] - z
    dot = ux * vx + uy * vy + uz * vz
    if dot >= 0.0:
        return False
    uu = ux * ux + uy * uy + uz * uz
    vv = vx * vx + vy * vy + vz * vz
    return dot * dot > LENS * LENS * uu * vv


@njit(**HELPER)
def segment_near(view, t, x, y, z):
    """A segment of a triangle, or of its neighbours, that a point is too near to; or -1."""
    for k in range(3):
        h = 4 * t + k
        if sees_closely(view, h, x, y, z):
            return -1 - view.twin[h]
        g = view.twin[h]
        if g >= 0:
            for f in (after(g), before(g)):
                if sees_closely(view, f, x, y, z):
                    return -1 - view.twin[f]
    return -1


@njit(**HELPER)
def fits(view, h, x, y, z):
    """Whether the triangle of the edge of h and a point is well-shaped, or not much worse."""
    p = view.xyz
    o = view.origin
    f = o[h | 3]
    a = 3 * o[h]
    b = 3 * o[after(h)]
    q = quality(view, f, p[a], p[a + 1], p[a + 2], p[b], p[b + 1], p[b + 2], x, y, z)
    if q >= FLAT:
        return True
    if q <= 0.0:
        return False
    t = 4 * (h >> 2)
    return q >= 0.3 * exact_quality(view, f, o[t], o[t + 1], o[t + 2])


@njit(**HELPER)
def interpolated(view, t, x, y, z):
    """Size and bound at a point of a triangle: of its corners, the nearer the heavier."""
    p = view.xyz
    size = 0.0
    cap = 0.0
    total = 0.0
    for k in range(3):
        v = view.origin[4 * t + k]
        dx = p[3 * v] - x
        dy = p[3 * v + 1] - y
        dz = p[3 * v + 2] - z
        weight = 1.0 / (sqrt(dx * dx + dy * dy + dz * dz) + 1e-300)
        size += weight * view.size[v]
        cap += weight * view.cap[v]
        total += weight
    return size / total, cap / total


@njit(**HELPER)
def put_into(view, h, share, x, y, z):
    """Insert a point into the triangle of h, or onto the edge of h if it is near. An outcome."""
    o = view.origin
    t = h >> 2
    face = o[4 * t + FACE]
    on_edge = share < NEAR_EDGE
    g = view.twin[h]
    if on_edge:
        if g < 0:
            return REFUSED
        for f in (after(h), before(h), after(g), before(g)):
            if not fits(view, f, x, y, z):
                return REFUSED
    else:
        for k in range(3):
            if not fits(view, 4 * t + k, x, y, z):
                return REFUSED
    size, cap = interpolated(view, t, x, y, z)
    v = new_vertex(view, x, y, z, size, cap, 2, face)
    if on_edge:
        split_edge(view, h, v)
    else:
        split_triangle(view, t, v)
    n = fan_from(view, view.link[2 * v], 0)
    for k in range(n):
        view.todo[k] = after(view.buffer[k])
    settle(view, n, False)
    enqueue_around(view, view.link[2 * v])
    return INSERTED


@njit(**HELPER)
def halve(view, s):
    """Split segment s at the exact point near its middle. An outcome."""
    a = view.seg[4 * s]
    b = view.seg[4 * s + 1]
    p = view.xyz
    mx = 0.5 * (p[3 * a] + p[3 * b])
    my = 0.5 * (p[3 * a + 1] + p[3 * b + 1])
    mz = 0.5 * (p[3 * a + 2] + p[3 * b + 2])
    curve = view.seg[4 * s + 2]
    x, y, z = put_back(view, 1, curve, mx, my, mz)
    gap = sqrt((x - mx) * (x - mx) + (y - my) * (y - my) + (z - mz) * (z - mz))
    if not gap < 0.3 * distance(view, a, b) or not can_split(view, s, x, y, z):
        return REFUSED
    size = 0.5 * (view.size[a] + view.size[b])
    cap = 0.5 * (view.cap[a] + view.cap[b])
    n = view.count[SEGMENTS]
    v = new_vertex(view, x, y, z, size, cap, 1, curve)
    split_segment(view, s, v)
    sheets = sheets_of(view, s)
    first = 128
    for k in range(sheets):
        h = view.buffer[64 + k]
        view.buffer[first + k] = h if view.origin[h] == v else after(h)
    for k in range(sheets):
        h = view.buffer[first + k]
        fan = fan_from(view, h, 0)
        for i in range(fan):
            view.todo[i] = after(view.buffer[i])
        settle(view, fan, False)
    for s2 in (s, n):
        sheets = sheets_of(view, s2)
        for k in range(sheets):
            h = view.buffer[64 + k]
            enqueue_around(view, h if view.origin[h] == v else after(h))
    return INSERTED

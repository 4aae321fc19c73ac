"""Triangles of many faces joined along segments of curves: flips, splits and collapses.

Half-edge ``h = 4 t + k`` leads from corner k of triangle t to the next one. ``origin[4 t + 3]`` is
the triangle's face, -1 for a removed one. ``twin`` is the other half-edge of an edge within a face;
``-1 - s`` on segment s, whose half-edges form a cycle ``ring``: one, two or more sheets meet there.
Triangle 0 is no triangle: its first half-edge is room for a moment.
"""

from __future__ import annotations

from collections import namedtuple
from math import sqrt

from numba import njit

from ..pointers import HELPER
from .exact import on_curve, on_surface

#: Pointers to all that kernels of surfaces work on.
#: xyz, size, cap: place, wanted edge length and its bound by curvature of each vertex;
#: dim, owner, link: see `SurfaceMesh`; link holds a half-edge of a face's vertex, or the two
#: segments of a curve's. seg: ends, curve and one half-edge of each segment.
View = namedtuple(
    "View",
    "xyz size cap dim owner link keep origin twin ring seg face_surface face_sign pair "
    "curve_ends code number queue later todo buffer count",
)

FACE = 3
SPARE = 0
#: Where numbers are kept in ``count``.
POINTS, TRIANGLES, SEGMENTS, HEAD, QUEUED, LATER_HEAD, LATER, MASK = range(8)
#: Half-edges around a vertex, at most; others are left alone.
FAN = 60


@njit(**HELPER)
def after(h):
    """Next half-edge of the triangle."""
    return h + 1 if (h & 3) < 2 else h - 2


@njit(**HELPER)
def before(h):
    """Previous half-edge of the triangle."""
    return h - 1 if (h & 3) > 0 else h + 2


@njit(**HELPER)
def glue(view, h, g):
    """Make two half-edges one edge."""
    view.twin[h] = g
    view.twin[g] = h


@njit(**HELPER)
def move_side(view, old, new):
    """Let half-edge `new` have the neighbour, or the segment, that `old` has."""
    g = view.twin[old]
    view.twin[new] = g
    if g >= 0:
        view.twin[g] = new
        return
    s = -1 - g
    if view.ring[old] == old:
        view.ring[new] = new
    else:
        k = view.ring[old]
        view.ring[new] = k
        while view.ring[k] != old:
            k = view.ring[k]
        view.ring[k] = new
    if view.seg[4 * s + 3] == old:
        view.seg[4 * s + 3] = new


@njit(**HELPER)
def set_link(view, v, h):
    """Remember a half-edge of a vertex inside a face."""
    if view.dim[v] == 2:
        view.link[2 * v] = h


@njit(**HELPER)
def far_end(view, s, v):
    """The other end of a segment."""
    a = view.seg[4 * s]
    return view.seg[4 * s + 1] if a == v else a


@njit(**HELPER)
def flip(view, h):
    """Turn the edge of h within the quadrilateral of its two triangles."""
    g = view.twin[h]
    h1 = after(h)
    h2 = after(h1)
    g1 = after(g)
    g2 = after(g1)
    o = view.origin
    a = o[h]
    b = o[g]
    c = o[h2]
    d = o[g2]
    move_side(view, h1, SPARE)
    move_side(view, h2, h1)
    move_side(view, g1, h2)
    move_side(view, g2, g1)
    move_side(view, SPARE, g2)
    o[h] = d
    o[h1] = c
    o[h2] = a
    o[g] = c
    o[g1] = d
    o[g2] = b
    set_link(view, a, h2)
    set_link(view, b, g2)
    set_link(view, c, h1)
    set_link(view, d, g1)


@njit(**HELPER)
def new_triangle(view, a, b, c, face):
    """Number of a new triangle without neighbours."""
    t = view.count[TRIANGLES]
    view.count[TRIANGLES] = t + 1
    view.origin[4 * t] = a
    view.origin[4 * t + 1] = b
    view.origin[4 * t + 2] = c
    view.origin[4 * t + FACE] = face
    view.twin[4 * t + 3] = 0
    return t


@njit(**HELPER)
def split_triangle(view, t, p):
    """Join vertex p to the corners of a triangle."""
    o = view.origin
    h = 4 * t
    a = o[h]
    b = o[h + 1]
    c = o[h + 2]
    face = o[h + FACE]
    e = 4 * new_triangle(view, b, c, p, face)
    f = 4 * new_triangle(view, c, a, p, face)
    move_side(view, h + 1, e)
    move_side(view, h + 2, f)
    o[h + 2] = p
    glue(view, h + 1, e + 2)
    glue(view, e + 1, f + 2)
    glue(view, f + 1, h + 2)
    set_link(view, c, f)
    set_link(view, p, h + 2)


@njit(**HELPER)
def split_edge(view, h, p):
    """Put vertex p on an edge within a face."""
    o = view.origin
    g = view.twin[h]
    h1 = after(h)
    h2 = after(h1)
    g2 = before(g)
    b = o[h1]
    c = o[h2]
    d = o[g2]
    e = 4 * new_triangle(view, p, b, c, o[(h | 3)])
    f = 4 * new_triangle(view, b, p, d, o[(g | 3)])
    move_side(view, h1, e + 1)
    move_side(view, g2, f + 2)
    o[h1] = p
    o[g] = p
    glue(view, e, f)
    glue(view, h1, e + 2)
    glue(view, g2, f + 1)
    set_link(view, b, f)
    set_link(view, p, e)


@njit(**HELPER)
def split_segment(view, s, p):
    """Put vertex p on segment s, which keeps its first half; its other half gets a new number."""
    o = view.origin
    n = view.count[SEGMENTS]
    view.count[SEGMENTS] = n + 1
    b = view.seg[4 * s + 1]
    first = view.seg[4 * s + 3]
    a = view.seg[4 * s]
    view.seg[4 * n] = p
    view.seg[4 * n + 1] = b
    view.seg[4 * n + 2] = view.seg[4 * s + 2]
    view.seg[4 * s + 1] = p
    k = 0
    h = first
    while True:
        view.buffer[k] = h
        k += 1
        h = view.ring[h]
        if h == first:
            break
    mine = -1
    other = -1
    for i in range(k):
        h = view.buffer[i]
        h1 = after(h)
        e = 4 * new_triangle(view, p, o[h1], o[before(h)], o[h | 3])
        move_side(view, h1, e + 1)
        o[h1] = p
        glue(view, h1, e + 2)
        x = h if o[h] == a else e
        y = e if o[h] == a else h
        view.twin[x] = -1 - s
        view.twin[y] = -1 - n
        if i == 0:
            view.ring[x] = x
            view.ring[y] = y
        else:
            view.ring[x] = view.ring[mine]
            view.ring[mine] = x
            view.ring[y] = view.ring[other]
            view.ring[other] = y
        mine = x
        other = y
    view.seg[4 * s + 3] = mine
    view.seg[4 * n + 3] = other
    view.link[2 * p] = s
    view.link[2 * p + 1] = n
    if view.dim[b] == 1:
        if view.link[2 * b] == s:
            view.link[2 * b] = n
        else:
            view.link[2 * b + 1] = n


@njit(**HELPER)
def fan_from(view, h, room):
    """Half-edges that leave the start of h, in order within its sheet, into ``buffer[room:]``.

    Their number, or -1 if there are too many. The fan begins at a segment if there is one.
    """
    first = h
    while True:
        g = view.twin[first]
        if g < 0:
            break
        first = after(g)
        if first == h:
            break
    n = 0
    g = first
    while True:
        view.buffer[room + n] = g
        n += 1
        if n >= FAN:
            return -1
        g = view.twin[before(g)]
        if g < 0 or g == first:
            return n


@njit(**HELPER)
def are_joined(view, h, w):
    """Whether the start of h and w are joined by an edge of this sheet."""
    o = view.origin
    g = h
    while True:
        if o[after(g)] == w or o[before(g)] == w:
            return True
        g = view.twin[before(g)]
        if g < 0:
            break
        if g == h:
            return False
    g = view.twin[h]
    while g >= 0:
        g = after(g)
        if o[after(g)] == w:
            return True
        g = view.twin[g]
    return False


@njit(**HELPER)
def remove(view, t):
    """Take a triangle away."""
    view.origin[4 * t + FACE] = -1


@njit(**HELPER)
def collapse_inside(view, h, fan, n):
    """Move the start of h, inside a face, to its end; its fan is ``buffer[fan:fan + n]``."""
    o = view.origin
    g = view.twin[h]
    b = o[after(h)]
    c = o[before(h)]
    d = o[before(g)]
    x = view.twin[before(h)]
    y = view.twin[after(g)]
    for k in range(n):
        o[view.buffer[fan + k]] = b
    move_side(view, after(h), x)
    move_side(view, before(g), y)
    remove(view, h >> 2)
    remove(view, g >> 2)
    set_link(view, b, x)
    set_link(view, c, after(x))
    set_link(view, d, y)


@njit(**HELPER)
def collapse_sheet(view, e, v, b, fan, n):
    """In one sheet, move v to b along the segment of half-edge e, which goes from or to v."""
    o = view.origin
    from_v = o[e] == v
    side = before(e) if from_v else after(e)
    outer = after(e) if from_v else before(e)
    c = o[before(e)]
    x = view.twin[side]
    for k in range(n):
        o[view.buffer[fan + k]] = b
    if x >= 0:
        move_side(view, outer, x)
        set_link(view, c, after(x) if from_v else x)
    else:
        move_side(view, side, view.twin[outer])
    remove(view, e >> 2)


@njit(**HELPER)
def quality(view, face, ax, ay, az, bx, by, bz, cx, cy, cz):
    """Shape of a triangle seen along the exact normal at its centre: 1 equilateral, 0 flat."""
    ux = bx - ax
    uy = by - ay
    uz = bz - az
    vx = cx - ax
    vy = cy - ay
    vz = cz - az
    wx = cx - bx
    wy = cy - by
    wz = cz - bz
    s = view.face_surface[face]
    mx = (ax + bx + cx) / 3.0
    my = (ay + by + cy) / 3.0
    mz = (az + bz + cz) / 3.0
    _, _, _, nx, ny, nz = on_surface(view.code, view.number, s, mx, my, mz)
    area = nx * (uy * vz - uz * vy) + ny * (uz * vx - ux * vz) + nz * (ux * vy - uy * vx)
    total = ux * ux + uy * uy + uz * uz + vx * vx + vy * vy + vz * vz + wx * wx + wy * wy + wz * wz
    area *= 3.4641016151377544 * view.face_sign[face]
    return area / total if total > 0.0 else 0.0


@njit(**HELPER)
def quality_with(view, h, x, y, z):
    """Shape of the triangle of h if the start of h were at a place."""
    p = view.xyz
    b = 3 * view.origin[after(h)]
    c = 3 * view.origin[before(h)]
    f = view.origin[h | 3]
    return quality(view, f, x, y, z, p[b], p[b + 1], p[b + 2], p[c], p[c + 1], p[c + 2])


@njit(**HELPER)
def distance(view, a, b):
    """Distance of two vertices."""
    p = view.xyz
    x = p[3 * a] - p[3 * b]
    y = p[3 * a + 1] - p[3 * b + 1]
    z = p[3 * a + 2] - p[3 * b + 2]
    return sqrt(x * x + y * y + z * z)


@njit(**HELPER)
def put_back(view, dim, owner, x, y, z):
    """The exact place of a point of a face or of a curve near (x, y, z)."""
    if dim == 2:
        s = view.face_surface[owner]
        fx, fy, fz, _, _, _ = on_surface(view.code, view.number, s, x, y, z)
        return fx, fy, fz
    a = view.pair[2 * owner]
    b = view.pair[2 * owner + 1]
    return on_curve(view.code, view.number, a, b, x, y, z)

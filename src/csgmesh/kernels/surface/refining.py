"""Delaunay refinement of surfaces in space (Chew 1993), with the new points in fronts.

A triangle that is too large or too thin gets a new point on the ray from its shortest edge to its
circumcentre: where an equilateral triangle of the wanted size has its apex (Rebay 1993), or where
the triangle on the shortest edge is just good enough (Üngör 2004). The point is put on the exact
surface. If a curve lies in between, the segment that hides the point is halved.
"""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import ENTRY, HELPER
from .arrays import view_of
from .inserting import (
    APART,
    INSERTED,
    area_vector,
    enqueue,
    halve,
    put_into,
    segment_near,
    walk,
)
from .topology import (
    FACE,
    HEAD,
    LATER,
    LATER_HEAD,
    MASK,
    POINTS,
    QUEUED,
    SEGMENTS,
    TRIANGLES,
    after,
    distance,
    put_back,
)

#: Largest circumradius, as a share of the wanted edge length.
CIRCLE = 0.75
#: Triangles whose shortest edge is longer than this share wait until fronts arrive.
LONG = 1.6
#: The off-centre's angle is a little larger than asked for (Shewchuk's choice in Triangle).
OFF_CENTRE = 0.475
#: Half a segment must be as long as this share of the edge for whose sake it is halved.
HALF = 0.7
#: No half is shorter than this share of the wanted length.
LEAST = 2e-4
#: Segments that meet below 60 degrees excuse the triangles across: cosine.
SHARP = 0.5
#: Room that one step may need: triangles, and vertices or segments.
ROOM = 256
#: Reasons to return.
DONE = 0
FULL = 1
SLICE = 2


@njit(**HELPER)
def is_excused(view, a, b):
    """Whether an edge lies across two curves that meet at a sharp corner."""
    if view.dim[a] != 1 or view.dim[b] != 1 or view.owner[a] == view.owner[b]:
        return False
    p = view.xyz
    for i in range(2):
        v = view.curve_ends[2 * view.owner[a] + i]
        if v < 0:
            continue
        for j in range(2):
            if view.curve_ends[2 * view.owner[b] + j] != v:
                continue
            dot = 0.0
            for k in range(3):
                dot += (p[3 * a + k] - p[3 * v + k]) * (p[3 * b + k] - p[3 * v + k])
            if dot > SHARP * distance(view, a, v) * distance(view, b, v):
                return True
    return False


@njit(**HELPER)
def clear_segment(view, s, edge):
    """Halve the segment that hides a point, unless its halves would be too short."""
    a = view.seg[4 * s]
    b = view.seg[4 * s + 1]
    half = 0.5 * distance(view, a, b)
    if half < HALF * edge or half < LEAST * min(view.size[a], view.size[b]):
        return False
    return halve(view, s) == INSERTED


@njit(**HELPER)
def shortest(view, t):
    """Corner of t where its shortest edge begins, that edge's square, and the product of all."""
    o = view.origin
    p = view.xyz
    at = 0
    least = 1e300
    product = 1.0
    for k in range(3):
        a = 3 * o[4 * t + k]
        b = 3 * o[4 * t + (k + 1) % 3]
        x = p[a] - p[b]
        y = p[a + 1] - p[b + 1]
        z = p[a + 2] - p[b + 2]
        square = x * x + y * y + z * z
        product *= square
        if square < least:
            least = square
            at = k
    return at, least, product


@njit(**HELPER)
def treat(view, t, share, off, force):
    """Test a triangle and insert a point, or split a segment, if it is too large or too thin.

    Whether to look at it again; it waits in the second queue if no front has arrived.
    """
    o = view.origin
    p = view.xyz
    k, least, product = shortest(view, t)
    nx, ny, nz = area_vector(view, t)
    area = sqrt(nx * nx + ny * ny + nz * nz)
    if area <= 1e-12 * least or least == 0.0:
        return False
    edge = sqrt(least)
    radius = 0.5 * sqrt(product) / area
    i = o[4 * t + k]
    j = o[4 * t + (k + 1) % 3]
    w = o[4 * t + (k + 2) % 3]
    wanted = (view.size[i] + view.size[j] + view.size[w]) / 3.0
    large = radius > CIRCLE * wanted
    thin = radius > share * edge and not is_excused(view, i, j)
    if not large and not thin:
        return False
    if large and not thin and not force and edge > LONG * wanted:
        view.twin[4 * t + 3] |= 2
        n = view.count[LATER]
        view.later[(view.count[LATER_HEAD] + n) & view.count[MASK]] = t
        view.count[LATER] = n + 1
        return False
    d = sqrt(max(radius * radius - 0.25 * least, 0.0))
    if large:
        rho = max(0.5773502691896258 * wanted, 0.5 * edge)
        d = min(d, rho + sqrt(max(rho * rho - 0.25 * least, 0.0)))
    if thin:
        d = min(d, off * edge)
    # The unit vector across the shortest edge, within the triangle's plane: normal x edge.
    ex = p[3 * j] - p[3 * i]
    ey = p[3 * j + 1] - p[3 * i + 1]
    ez = p[3 * j + 2] - p[3 * i + 2]
    f = d / (area * edge)
    x = 0.5 * (p[3 * i] + p[3 * j]) + f * (ny * ez - nz * ey)
    y = 0.5 * (p[3 * i + 1] + p[3 * j + 1]) + f * (nz * ex - nx * ez)
    z = 0.5 * (p[3 * i + 2] + p[3 * j + 2]) + f * (nx * ey - ny * ex)
    face = o[4 * t + FACE]
    x, y, z = put_back(view, 2, face, x, y, z)
    h, near = walk(view, t, x, y, z)
    if h < 0:
        return clear_segment(view, -1 - h, edge)
    s = segment_near(view, h >> 2, x, y, z)
    if s >= 0:
        return clear_segment(view, s, edge)
    apart = APART * min(d, radius)
    u = h >> 2
    for q in range(3):
        v = o[4 * u + q]
        dx = p[3 * v] - x
        dy = p[3 * v + 1] - y
        dz = p[3 * v + 2] - z
        if dx * dx + dy * dy + dz * dz < apart * apart:
            return False
    return put_into(view, h, near, x, y, z) == INSERTED and o[4 * t + FACE] >= 0


@njit(**ENTRY)
def refine_surface(arrays, share, off, limit):
    """Treat the queues until they are empty, there is no room, or `limit` points are reached."""
    view = view_of(arrays)
    points = arrays.size.shape[0]
    triangles = arrays.origin.shape[0] // 4
    segments = arrays.seg.shape[0] // 4
    count = view.count
    while True:
        if (
            count[POINTS] + 2 > points
            or count[TRIANGLES] + ROOM > triangles
            or count[SEGMENTS] + 2 > segments
        ):
            return FULL
        if count[POINTS] >= limit:
            return SLICE
        force = count[QUEUED] == 0
        if not force:
            t = view.queue[count[HEAD]]
            count[HEAD] = (count[HEAD] + 1) & count[MASK]
            count[QUEUED] -= 1
            view.twin[4 * t + 3] &= 2
        elif count[LATER] > 0:
            t = view.later[count[LATER_HEAD]]
            count[LATER_HEAD] = (count[LATER_HEAD] + 1) & count[MASK]
            count[LATER] -= 1
            view.twin[4 * t + 3] &= 1
        else:
            return DONE
        if view.origin[4 * t + FACE] >= 0 and treat(view, t, share, off, force):
            enqueue(view, t)


@njit(**ENTRY)
def divide_edges(arrays, halves, is_segment):
    """Put a vertex on the middle of each edge, by a half-edge, or of each segment, by its number.

    The number of vertices.
    """
    view = view_of(arrays)
    p = view.xyz
    done = 0
    for k in range(halves.shape[0]):
        h = halves[k]
        if is_segment[k]:
            done += halve(view, h) == INSERTED
            continue
        a = 3 * view.origin[h]
        b = 3 * view.origin[after(h)]
        face = view.origin[h | 3]
        x, y, z = put_back(
            view,
            2,
            face,
            0.5 * (p[a] + p[b]),
            0.5 * (p[a + 1] + p[b + 1]),
            0.5 * (p[a + 2] + p[b + 2]),
        )
        done += put_into(view, h, 0.0, x, y, z) == INSERTED
    return done

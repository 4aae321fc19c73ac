"""Move vertices of quads so that the quads become squares.

The energy of a quad is the sum over its corners, with edges a and b, of the square of
(a² + b²) / (2 det), the inverse of the SICN: 1 for a square's corner, and infinite where a corner
is about to turn over, so that no descent ever turns one over (Knupp 2000).
"""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import ENTRY, HELPER, pointer

#: Below this mean energy a corner, vertices are left alone: squares are as good as they get.
GOOD = 1.0004
#: Probes of the energy, as a share of the distance to a neighbour.
PROBE = 1e-4
FAR = 1e300
#: Vertices moved between two returns to the caller: less than 0.2 s.
SLICE = 50_000


@njit(**HELPER)
def corner_energy(ax, ay, bx, by, cx, cy):
    """At b, between its neighbours c before and a behind; FAR where it does not turn left."""
    ux = ax - bx
    uy = ay - by
    vx = cx - bx
    vy = cy - by
    det = ux * vy - uy * vx
    if det <= 0.0:
        return FAR
    size = (ux * ux + uy * uy + vx * vx + vy * vy) / (2.0 * det)
    return size * size


@njit(**HELPER)
def star_energy(xy, ring, begin, end, x, y):
    """Energy of the three corners of each quad around a vertex at (x, y) that feel it move."""
    total = 0.0
    for k in range(begin, end):
        a = 2 * ring[3 * k]
        b = 2 * ring[3 * k + 1]
        c = 2 * ring[3 * k + 2]
        total += corner_energy(xy[a], xy[a + 1], x, y, xy[c], xy[c + 1])
        total += corner_energy(xy[b], xy[b + 1], xy[a], xy[a + 1], x, y)
        total += corner_energy(x, y, xy[c], xy[c + 1], xy[b], xy[b + 1])
        if total >= FAR:
            return FAR
    return total


@njit(**HELPER)
def worst_det(xy, ring, begin, end, x, y):
    """Smallest scaled Jacobian of those corners: what there is to raise while some turn right."""
    worst = 2.0
    for k in range(begin, end):
        a = 2 * ring[3 * k]
        b = 2 * ring[3 * k + 1]
        c = 2 * ring[3 * k + 2]
        ux = xy[a] - x
        uy = xy[a + 1] - y
        wx = xy[c] - x
        wy = xy[c + 1] - y
        px = xy[b] - xy[a]
        py = xy[b + 1] - xy[a + 1]
        qx = xy[b] - xy[c]
        qy = xy[b + 1] - xy[c + 1]
        u = sqrt(ux * ux + uy * uy)
        w = sqrt(wx * wx + wy * wy)
        p = sqrt(px * px + py * py)
        q = sqrt(qx * qx + qy * qy)
        if u * w * p * q == 0.0:
            return -2.0
        worst = min(worst, (ux * wy - uy * wx) / (u * w))
        worst = min(worst, (ux * py - uy * px) / (u * p))
        worst = min(worst, (qx * wy - qy * wx) / (q * w))
    return worst


@njit(**HELPER)
def mean_length(xy, ring, begin, end, x, y):
    """Mean distance to the neighbours along edges."""
    total = 0.0
    for k in range(begin, end):
        a = 2 * ring[3 * k]
        total += sqrt((xy[a] - x) ** 2 + (xy[a + 1] - y) ** 2)
    return total / (end - begin)


@njit(**HELPER)
def unfold(xy, ring, begin, end, v, reach):
    """Move v, beside a corner that does not turn left, to where the worst corner is best."""
    x = xy[2 * v]
    y = xy[2 * v + 1]
    best = worst_det(xy, ring, begin, end, x, y)
    step = 0.5 * reach
    dx = 1.0
    dy = 0.0
    for _ in range(12):
        found = False
        for _ in range(8):
            turned = 0.7071067811865476 * (dx - dy)
            dy = 0.7071067811865476 * (dx + dy)
            dx = turned
            value = worst_det(xy, ring, begin, end, x + step * dx, y + step * dy)
            if value > best:
                best = value
                x += step * dx
                y += step * dy
                found = True
                break
        # Where everything is thin, only steps as thin as the cells find a way.
        for k in range(2 * begin, 2 * end):
            a = 2 * ring[3 * (k // 2)]
            c = 2 * ring[3 * (k // 2) + 2]
            size = step / reach * (1.0 if k % 2 == 0 else -1.0)
            px = x + size * (xy[a] - xy[c])
            py = y + size * (xy[a + 1] - xy[c + 1])
            value = worst_det(xy, ring, begin, end, px, py)
            if value > best:
                best = value
                x = px
                y = py
                found = True
        if not found:
            step *= 0.5
    xy[2 * v] = x
    xy[2 * v + 1] = y


@njit(**HELPER)
def descend(xy, ring, begin, end, v):
    """One step of Newton's method, halved until the energy falls; whether v moved."""
    x = xy[2 * v]
    y = xy[2 * v + 1]
    now = star_energy(xy, ring, begin, end, x, y)
    if now < GOOD * 3 * (end - begin):
        return False
    reach = mean_length(xy, ring, begin, end, x, y)
    if now >= FAR:
        unfold(xy, ring, begin, end, v, reach)
        return True
    d = PROBE * reach
    east = star_energy(xy, ring, begin, end, x + d, y)
    west = star_energy(xy, ring, begin, end, x - d, y)
    north = star_energy(xy, ring, begin, end, x, y + d)
    south = star_energy(xy, ring, begin, end, x, y - d)
    both = star_energy(xy, ring, begin, end, x + d, y + d)
    gx = (east - west) / (2.0 * d)
    gy = (north - south) / (2.0 * d)
    xx = (east + west - 2.0 * now) / (d * d)
    yy = (north + south - 2.0 * now) / (d * d)
    cross = (both - east - north + now) / (d * d)
    det = xx * yy - cross * cross
    if xx > 0.0 and det > 0.0:
        sx = (cross * gy - yy * gx) / det
        sy = (cross * gx - xx * gy) / det
    else:
        size = sqrt(gx * gx + gy * gy)
        if size == 0.0:
            return False
        sx = -0.2 * reach * gx / size
        sy = -0.2 * reach * gy / size
    length = sqrt(sx * sx + sy * sy)
    if not length > 1e-3 * reach:
        return False
    if length > 0.5 * reach:
        sx *= 0.5 * reach / length
        sy *= 0.5 * reach / length
    for _ in range(5):
        if star_energy(xy, ring, begin, end, x + sx, y + sy) < now:
            xy[2 * v] = x + sx
            xy[2 * v + 1] = y + sy
            return True
        sx *= 0.5
        sy *= 0.5
    return False


@njit(**ENTRY)
def square_up(points, rings, begins, vertices, moves, begin):
    """Move the vertices of a list from a place on; where to go on, or -1.

    `rings` holds for each quad around each vertex its next three corners, counterclockwise, those
    of vertex v from begins[v] on. `moves` notes which moved.
    """
    xy = pointer(points)
    ring = pointer(rings)
    first = pointer(begins)
    todo = pointer(vertices)
    moved = pointer(moves)
    last = min(begin + SLICE, vertices.shape[0])
    for i in range(begin, last):
        v = todo[i]
        moved[i] = 1 if descend(xy, ring, first[v], first[v + 1], v) else 0
    return last if last < vertices.shape[0] else -1

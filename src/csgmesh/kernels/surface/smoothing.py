"""Move vertices of faces to better places on their exact surfaces."""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import ENTRY, HELPER
from .arrays import view_of
from .topology import after, before, fan_from, put_back, quality_with

#: Shape from which on a star need not get better by a move.
GOOD = 0.8
#: Directions and halvings of the search for a better place.
DIRECTIONS = 8
HALVINGS = 5


@njit(**HELPER)
def worst_at(view, n, x, y, z, bound):
    """Least shape of the fan's triangles with its vertex at a place; stops below `bound`."""
    worst = 1.0
    for k in range(n):
        q = quality_with(view, view.buffer[k], x, y, z)
        if q < worst:
            worst = q
            if worst < bound:
                break
    return worst


@njit(**HELPER)
def centre_of(view, v, n):
    """Mean of the centroids of the triangles around v, weighted by area and wanted density."""
    p = view.xyz
    o = view.origin
    x = p[3 * v]
    y = p[3 * v + 1]
    z = p[3 * v + 2]
    sx = 0.0
    sy = 0.0
    sz = 0.0
    total = 0.0
    for k in range(n):
        g = view.buffer[k]
        a = o[after(g)]
        b = o[before(g)]
        ux = p[3 * a] - x
        uy = p[3 * a + 1] - y
        uz = p[3 * a + 2] - z
        vx = p[3 * b] - x
        vy = p[3 * b + 1] - y
        vz = p[3 * b + 2] - z
        nx = uy * vz - uz * vy
        ny = uz * vx - ux * vz
        nz = ux * vy - uy * vx
        h = view.size[a] + view.size[b] + view.size[v]
        weight = sqrt(nx * nx + ny * ny + nz * nz) / (h * h * h * h)
        sx += weight * (ux + vx)
        sy += weight * (uy + vy)
        sz += weight * (uz + vz)
        total += weight
    if total <= 0.0:
        return x, y, z
    f = 1.0 / (3.0 * total)
    return x + f * sx, y + f * sy, z + f * sz


@njit(**HELPER)
def move(view, v, x, y, z):
    """Put vertex v at a place."""
    view.xyz[3 * v] = x
    view.xyz[3 * v + 1] = y
    view.xyz[3 * v + 2] = z


@njit(**ENTRY)
def smooth_surface(arrays, start, stop):
    """Move vertices of faces from `start` to before `stop` to their stars' centres.

    Only where the star's least shape grows or stays good. The number of moves.
    """
    view = view_of(arrays)
    moves = 0
    p = view.xyz
    for v in range(start, stop):
        if view.dim[v] != 2:
            continue
        n = fan_from(view, view.link[2 * v], 0)
        if n < 3:
            continue
        cx, cy, cz = centre_of(view, v, n)
        # What the star is now need not be known where it will be good.
        bound = GOOD
        for _ in range(2):
            x, y, z = put_back(view, 2, view.owner[v], cx, cy, cz)
            worst = worst_at(view, n, x, y, z, bound)
            if worst < bound and bound == GOOD:
                bound = min(worst_at(view, n, p[3 * v], p[3 * v + 1], p[3 * v + 2], -2.0), GOOD)
                worst = worst_at(view, n, x, y, z, bound)
            if worst >= bound:
                move(view, v, x, y, z)
                moves += 1
                break
            cx = 0.5 * (cx + p[3 * v])
            cy = 0.5 * (cy + p[3 * v + 1])
            cz = 0.5 * (cz + p[3 * v + 2])
    return moves

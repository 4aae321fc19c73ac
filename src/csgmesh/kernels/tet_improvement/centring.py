"""Move vertices of tetrahedra towards the centres of their stars."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .cells import C_CLOCK, C_DONE, C_NEXT, C_VERTICES, C_WISHES, FREE, gather_star, view_of
from .climbing import link_of, worst_at
from .vertices import move_to

__all__ = ["centre_vertices", "settle_moves"]

#: Vertices looked at between two returns to the caller: less than 0.2 s.
SLICE = 20_000
#: Shares of the way that are tried.
HALVINGS = 3


@njit(**HELPER)
def mean_of_neighbours(view, v, n, seen):
    """Write the mean of the neighbours of v to `place`; `seen` is a mark a vertex."""
    stamp = view.count[C_CLOCK] + 1
    view.count[C_CLOCK] = stamp
    seen[v] = stamp
    m = 0
    x = 0.0
    y = 0.0
    z = 0.0
    for k in range(n):
        t = view.star[k]
        for f in range(4 * t, 4 * t + 4):
            u = view.corner[f]
            if seen[u] != stamp:
                seen[u] = stamp
                m += 1
                x += view.xyz[3 * u]
                y += view.xyz[3 * u + 1]
                z += view.xyz[3 * u + 2]
    view.place[0] = x / m
    view.place[1] = y / m
    view.place[2] = z / m


@njit(**HELPER)
def mean_of_circumcentres(view, v, n):
    """Write the mean of the circumcentres around v, weighted by volume, to `place`.

    The circumcentre times the volume is a polynomial, so flat cells do no harm.
    """
    x = view.xyz[3 * v]
    y = view.xyz[3 * v + 1]
    z = view.xyz[3 * v + 2]
    total = 0.0
    for c in range(3):
        view.place[c] = 0.0
    for k in range(n):
        for e in range(3):
            p = 9 * k + 3 * e
            q = 9 * k + 3 * ((e + 1) % 3)
            r = 9 * k + 3 * ((e + 2) % 3)
            qx = view.link[q] - x
            qy = view.link[q + 1] - y
            qz = view.link[q + 2] - z
            rx = view.link[r] - x
            ry = view.link[r + 1] - y
            rz = view.link[r + 2] - z
            nx = qy * rz - qz * ry
            ny = qz * rx - qx * rz
            nz = qx * ry - qy * rx
            px = view.link[p] - x
            py = view.link[p + 1] - y
            pz = view.link[p + 2] - z
            square = px * px + py * py + pz * pz
            view.place[0] += square * nx
            view.place[1] += square * ny
            view.place[2] += square * nz
            if e == 0:
                total += 2.0 * (px * nx + py * ny + pz * nz)
    view.place[0] = x + view.place[0] / total
    view.place[1] = y + view.place[1] / total
    view.place[2] = z + view.place[2] / total


@njit(**HELPER)
def step_to(view, v, n, now):
    """Move v to `place` or part of the way, unless its worst cell gets worse; whether it moved."""
    dx = view.place[0] - view.xyz[3 * v]
    dy = view.place[1] - view.xyz[3 * v + 1]
    dz = view.place[2] - view.xyz[3 * v + 2]
    share = 1.0
    for _ in range(HALVINGS):
        x = view.xyz[3 * v] + share * dx
        y = view.xyz[3 * v + 1] + share * dy
        z = view.xyz[3 * v + 2] + share * dz
        value = worst_at(view, n, x, y, z, -2.0)
        if value >= now and value > 0.0:
            move_to(view, v, n, x, y, z)
            return True
        share *= 0.5
    return False


@njit(**ENTRY)
def centre_vertices(arrays, optimal, marks):
    """Move free vertices to the centres of their stars, from count[C_NEXT] on; whether more wait.

    `optimal` is 1 for the centre of ODT, 0 for the mean of the neighbours.
    """
    view = view_of(arrays)
    seen = pointer(marks)
    count = view.count
    pause = min(count[C_NEXT] + SLICE, count[C_VERTICES])
    while count[C_NEXT] < pause:
        v = count[C_NEXT]
        count[C_NEXT] += 1
        if view.kind[v] != FREE:
            continue
        n = gather_star(view, v)
        if n < 0:
            continue
        now = link_of(view, v, n)
        if optimal == 1:
            mean_of_circumcentres(view, v, n)
        else:
            mean_of_neighbours(view, v, n, seen)
        if step_to(view, v, n, now):
            count[C_DONE] += 1
    return count[C_NEXT] < count[C_VERTICES]


@njit(**ENTRY)
def settle_moves(arrays, granted):
    """Move vertices to their places in `moves`, unless their worst cells get worse; which moved."""
    view = view_of(arrays)
    moved = pointer(granted)
    for k in range(view.count[C_WISHES]):
        v = view.wish[k]
        if moved[k] == 0:
            continue
        moved[k] = 0
        n = gather_star(view, v)
        if n < 0:
            continue
        now = link_of(view, v, n)
        x = view.moves[3 * k]
        y = view.moves[3 * k + 1]
        z = view.moves[3 * k + 2]
        value = worst_at(view, n, x, y, z, -2.0)
        if value >= now and value > 0.0:
            move_to(view, v, n, x, y, z)
            moved[k] = 1

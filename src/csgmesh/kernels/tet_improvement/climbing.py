"""Find the place of a vertex where the worst of its cells is best.

Source: L. A. Freitag, C. Ollivier-Gooch, "Tetrahedral mesh improvement using swapping and
smoothing", Int. J. Numerical Methods in Engineering 40 (1997): steepest ascent of a minimum, whose
direction is the shortest vector in the convex hull of the gradients of the cells that are worst.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

from ..pointers import HELPER
from .cells import N_EASY, is_better, place_in
from .shapes import shape_over

#: Steps of a climb, and halvings of a step.
STEPS = 6
HALVINGS = 5
#: Gradients that count at most; how much better than the worst their cells may be.
STEEPEST = 12
NEARLY = 1.4
#: First step, as a share of the distance to the nearest neighbour; step of a difference quotient.
STRIDE = 0.25
NUDGE = 1e-6
#: Rounds in the search of the shortest vector.
HULL_ROUNDS = 10

ANYWHERE = np.int64(0)
IN_PLANE = np.int64(1)
ON_LINE = np.int64(2)


@njit(**HELPER)
def link_of(view, v, n):
    """Copy the corners opposite v of the n cells of its star; the lowest score among them."""
    worst = 2.0
    for k in range(n):
        t = view.star[k]
        worst = min(worst, view.score[t])
        i = place_in(view, t, v)
        for e in range(3):
            u = 3 * view.corner[4 * t + (i ^ (e + 1))]
            for c in range(3):
                view.link[9 * k + 3 * e + c] = view.xyz[u + c]
    return worst


@njit(**HELPER)
def reach_of(view, n, x, y, z):
    """Distance from a place to the nearest corner of the n triangles around it."""
    least = 1e300
    for k in range(0, 9 * n, 3):
        dx = view.link[k] - x
        dy = view.link[k + 1] - y
        dz = view.link[k + 2] - z
        least = min(least, dx * dx + dy * dy + dz * dz)
    return sqrt(least)


@njit(**HELPER)
def worst_at(view, n, x, y, z, floor):
    """Worst shape over n triangles from a place; something below the floor if it is below."""
    worst = 2.0
    for k in range(n):
        worst = min(worst, shape_over(view.link, k, x, y, z))
        if worst <= floor:
            break
    return worst


@njit(**HELPER)
def confine(view, k, mode):
    """Take from gradient k what leads off the plane or line of the climb."""
    if mode == ANYWHERE:
        return
    nx = view.place[3]
    ny = view.place[4]
    nz = view.place[5]
    along = view.slope[3 * k] * nx + view.slope[3 * k + 1] * ny + view.slope[3 * k + 2] * nz
    if mode == IN_PLANE:
        view.slope[3 * k] -= along * nx
        view.slope[3 * k + 1] -= along * ny
        view.slope[3 * k + 2] -= along * nz
    else:
        view.slope[3 * k] = along * nx
        view.slope[3 * k + 1] = along * ny
        view.slope[3 * k + 2] = along * nz


@njit(**HELPER)
def gather_slopes(view, n, now, nudge, mode):
    """Gradients of the cells that are nearly the worst, the worst first; how many."""
    x = view.place[0]
    y = view.place[1]
    z = view.place[2]
    bar = now * NEARLY + 1e-3
    m = 0
    least = 0
    for k in range(n):
        if view.value[k] > bar or m == STEEPEST:
            continue
        old = view.value[k]
        view.slope[3 * m] = (shape_over(view.link, k, x + nudge, y, z) - old) / nudge
        view.slope[3 * m + 1] = (shape_over(view.link, k, x, y + nudge, z) - old) / nudge
        view.slope[3 * m + 2] = (shape_over(view.link, k, x, y, z + nudge) - old) / nudge
        confine(view, m, mode)
        if old <= now:
            least = m
        m += 1
    for c in range(3):
        swap = view.slope[c]
        view.slope[c] = view.slope[3 * least + c]
        view.slope[3 * least + c] = swap
    return m


@njit(**HELPER)
def shortest_in_hull(view, m):
    """Nearly the shortest vector in the convex hull of m gradients (Gilbert 1966)."""
    gx = view.slope[0]
    gy = view.slope[1]
    gz = view.slope[2]
    for _ in range(HULL_ROUNDS):
        size = gx * gx + gy * gy + gz * gz
        least = size
        at = 0
        for k in range(m):
            along = gx * view.slope[3 * k] + gy * view.slope[3 * k + 1] + gz * view.slope[3 * k + 2]
            if along < least:
                least = along
                at = k
        if least >= 0.9 * size:
            break
        dx = view.slope[3 * at] - gx
        dy = view.slope[3 * at + 1] - gy
        dz = view.slope[3 * at + 2] - gz
        share = min((size - least) / (dx * dx + dy * dy + dz * dz), 1.0)
        gx += share * dx
        gy += share * dy
        gz += share * dz
    return gx, gy, gz


@njit(**HELPER)
def climb(view, n, now, mode):
    """Move `place` to where the worst shape over the n triangles in `link` is better; that shape.

    `mode` confines it to the plane normal to, or the line along, place[3:6].
    """
    reach = reach_of(view, n, view.place[0], view.place[1], view.place[2])
    step = STRIDE * reach
    for _ in range(STEPS):
        x = view.place[0]
        y = view.place[1]
        z = view.place[2]
        for k in range(n):
            view.value[k] = shape_over(view.link, k, x, y, z)
        m = gather_slopes(view, n, now, NUDGE * reach, mode)
        gx, gy, gz = shortest_in_hull(view, m)
        size = sqrt(gx * gx + gy * gy + gz * gz)
        if size * reach < 1e-4:
            break
        found = False
        for _ in range(HALVINGS):
            s = step / size
            value = worst_at(view, n, x + s * gx, y + s * gy, z + s * gz, now)
            if found and value <= now:
                break
            if is_better(value, now):
                found = True
                now = value
                view.place[0] = x + s * gx
                view.place[1] = y + s * gy
                view.place[2] = z + s * gz
            step *= 0.5
        if not found or now > view.number[N_EASY]:
            break
        step *= 3.0
    return now

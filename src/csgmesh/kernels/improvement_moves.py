"""Move a vertex to a better place: within its star, or along its exact curve."""

from __future__ import annotations

from math import hypot

import numpy as np
from numba import njit

from .curves import curve_point
from .improvement_stars import (
    C_EFFORT,
    C_LOG,
    C_ROUNDS,
    FIXED,
    FLAT,
    N_DEVIATION,
    N_EASY,
    SLIDING,
    centre_of_star,
    edge_bounds,
    gather_star,
    is_upright,
    rate,
)
from .pointers import HELPER

LINE = np.int64(0)
#: What an entry of the log says.
MOVED = np.int64(0)
TURNED = np.int64(1)
#: Entries the log holds; no treatment comes near.
LOG_ROOM = 4096
#: Cotangents that fall by less are not worth a move.
GAIN = 1e-3
#: The first step of a search, as a share of the distance to the nearest neighbour.
FIRST_STEP = 0.2
#: A sliding vertex keeps this share of the interval between its neighbours from each of them.
APART = 0.15


@njit(**HELPER)
def search(ring, n, x, y, best, low, high, rounds):
    """Pattern search for the place with the best quality; returns it and its quality."""
    reach = FLAT
    for i in range(n):
        reach = min(reach, hypot(ring[4 * i] - x, ring[4 * i + 1] - y))
    step = FIRST_STEP * reach
    dx = 1.0
    dy = 0.0
    for _ in range(rounds):
        found = False
        for _ in range(6):
            # Turn by 60 degrees, and after a failure by 23, so as not to be caught on a ridge.
            turned = 0.5 * dx - 0.8660254037844386 * dy
            dy = 0.8660254037844386 * dx + 0.5 * dy
            dx = turned
            value = rate(ring, n, x + step * dx, y + step * dy, low, high, best)
            if value < best:
                best = value
                x += step * dx
                y += step * dy
                found = True
                break
        if not found:
            step *= 0.5
            turned = 0.9205048534524404 * dx - 0.3907311284892738 * dy
            dy = 0.3907311284892738 * dx + 0.9205048534524404 * dy
            dx = turned
    return x, y, best


@njit(**HELPER)
def set_parameter(piece, v, t):
    """Where sliding vertex v is on its curve, in the intervals of its two facets."""
    piece.interval[2 * piece.around[2 * v] + 1] = t
    piece.interval[2 * piece.around[2 * v + 1]] = t


@njit(**HELPER)
def write_move(piece, v, x, y, t):
    """Log where v is, then move it; a sliding vertex takes its facets' intervals along."""
    n = piece.count[C_LOG]
    piece.log[2 * n] = MOVED
    piece.log[2 * n + 1] = v
    piece.past[3 * n] = piece.xy[2 * v]
    piece.past[3 * n + 1] = piece.xy[2 * v + 1]
    piece.xy[2 * v] = x
    piece.xy[2 * v + 1] = y
    if piece.kind[v] == SLIDING:
        piece.past[3 * n + 2] = piece.interval[2 * piece.around[2 * v + 1]]
        set_parameter(piece, v, t)
    piece.count[C_LOG] = n + 1


@njit(**HELPER)
def take_back_move(piece, n):
    """Undo entry n of the log."""
    v = piece.log[2 * n + 1]
    piece.xy[2 * v] = piece.past[3 * n]
    piece.xy[2 * v + 1] = piece.past[3 * n + 1]
    if piece.kind[v] == SLIDING:
        set_parameter(piece, v, piece.past[3 * n + 2])


@njit(**HELPER)
def relocate(piece, v):
    """Move a free vertex to a better place in its star, if there is one; whether it moved."""
    n = gather_star(piece, v)
    ring = piece.ring
    x = piece.xy[2 * v]
    y = piece.xy[2 * v + 1]
    low, high = edge_bounds(piece, v, n)
    now = rate(ring, n, x, y, low, high, FLAT)
    if n == 0 or now <= piece.number[N_EASY]:
        return False
    piece.count[C_EFFORT] += 1
    best = now
    for optimal in range(2):
        cx, cy = centre_of_star(ring, n, piece.xy[2 * v], piece.xy[2 * v + 1], optimal)
        value = rate(ring, n, cx, cy, low, high, best)
        if value < best:
            best = value
            x = cx
            y = cy
    x, y, best = search(ring, n, x, y, best, low, high, piece.count[C_ROUNDS])
    if best > now - GAIN or not is_upright(ring, n, x, y):
        return False
    write_move(piece, v, x, y, 0.0)
    return True


@njit(**HELPER)
def place_on(piece, c, t):
    """Point of curve c at parameter t."""
    d = piece.curve_data
    i = 8 * c
    if piece.curve_kind[c] != LINE:
        return curve_point(piece.curve_kind[c], d, i, t)
    # From the nearer end: exact at both, and axis-parallel lines keep their coordinate.
    if t < 0.5:
        return d[i] + t * (d[i + 2] - d[i]), d[i + 1] + t * (d[i + 3] - d[i + 1])
    u = 1.0 - t
    return d[i + 2] - u * (d[i + 2] - d[i]), d[i + 3] - u * (d[i + 3] - d[i + 1])


@njit(**HELPER)
def deviation(piece, c, t0, t1):
    """Largest distance of curve c from its chord, at three places between t0 and t1."""
    if piece.curve_kind[c] == LINE:
        return 0.0
    ax, ay = place_on(piece, c, t0)
    bx, by = place_on(piece, c, t1)
    length = hypot(bx - ax, by - ay)
    worst = 0.0
    for k in range(1, 4):
        x, y = place_on(piece, c, t0 + 0.25 * k * (t1 - t0))
        worst = max(worst, abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)))
    return worst / length if length > 0.0 else FLAT


@njit(**HELPER)
def keeps_to_curve(piece, f, g, t):
    """Whether facets f, g deviate no more with their common end at t than now, or than allowed."""
    c = piece.curve[f]
    t0 = piece.interval[2 * f]
    t1 = piece.interval[2 * g + 1]
    old = piece.interval[2 * g]
    allowed = max(deviation(piece, c, t0, old), deviation(piece, c, old, t1))
    allowed = max(allowed, piece.number[N_DEVIATION])
    return max(deviation(piece, c, t0, t), deviation(piece, c, t, t1)) <= allowed


@njit(**HELPER)
def slide(piece, v):
    """Move a sliding vertex along its curve, if that is better; whether it moved."""
    n = gather_star(piece, v)
    ring = piece.ring
    f = piece.around[2 * v]
    g = piece.around[2 * v + 1]
    t0 = piece.interval[2 * f]
    span = piece.interval[2 * g + 1] - t0
    low, high = edge_bounds(piece, v, n)
    now = rate(ring, n, piece.xy[2 * v], piece.xy[2 * v + 1], low, high, FLAT)
    if n == 0 or now <= piece.number[N_EASY]:
        return False
    piece.count[C_EFFORT] += 1
    best = now
    share = (piece.interval[2 * g] - t0) / span
    step = FIRST_STEP
    for _ in range(piece.count[C_ROUNDS]):
        found = False
        for sign in range(-1, 2, 2):
            s = share + sign * step
            if s < APART or s > 1.0 - APART:
                continue
            x, y = place_on(piece, piece.curve[f], t0 + s * span)
            value = rate(ring, n, x, y, low, high, best)
            if value < best and keeps_to_curve(piece, f, g, t0 + s * span):
                best = value
                share = s
                found = True
                break
        if not found:
            step *= 0.5
    x, y = place_on(piece, piece.curve[f], t0 + share * span)
    if best > now - GAIN or not is_upright(ring, n, x, y):
        return False
    write_move(piece, v, x, y, t0 + share * span)
    return True


@njit(**HELPER)
def better_place(piece, v):
    """Move v as its kind allows; whether it moved."""
    if piece.count[C_LOG] >= LOG_ROOM or piece.kind[v] == FIXED:
        return False
    if piece.kind[v] == SLIDING:
        return slide(piece, v)
    return relocate(piece, v)


@njit(**HELPER)
def towards_centre(piece, v, optimal):
    """Move v to the centre of its star, or half the way, unless that makes the star worse."""
    kind = piece.kind[v]
    n = 0 if kind == FIXED else gather_star(piece, v)
    if n == 0:
        return False
    ring = piece.ring
    x = piece.xy[2 * v]
    y = piece.xy[2 * v + 1]
    low, high = edge_bounds(piece, v, n)
    now = rate(ring, n, x, y, low, high, FLAT)
    f = piece.around[2 * v]
    g = piece.around[2 * v + 1]
    t = 0.0
    cx, cy = centre_of_star(ring, n, x, y, optimal)
    for k in range(1, 4):
        share = 0.5 ** (k - 1)
        px = x + share * (cx - x)
        py = y + share * (cy - y)
        if kind == SLIDING:
            old = piece.interval[2 * g]
            middle = 0.5 * (piece.interval[2 * f] + piece.interval[2 * g + 1])
            t = old + share * (middle - old)
            px, py = place_on(piece, piece.curve[f], t)
        if (
            rate(ring, n, px, py, low, high, now) <= now
            and is_upright(ring, n, px, py)
            and (kind != SLIDING or keeps_to_curve(piece, f, g, t))
        ):
            piece.count[C_LOG] = 0
            write_move(piece, v, px, py, t)
            return True
    return False

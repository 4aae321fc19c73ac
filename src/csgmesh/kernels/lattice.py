"""Which points of a hexagonal lattice lie inside a domain and keep their distance from it.

Points are (row, u): u counts half steps along the rows and is even in even rows, odd in odd ones.
A run is a maximal stretch of wanted points in a row, its u from ``first`` to ``last``. Everything
is found from the boundary alone: what it blocks and where it is crossed are events along the rows.
"""

from __future__ import annotations

from math import ceil, floor, sqrt

import numpy as np
from numba import njit

from .pointers import ENTRY, HELPER, pointer

#: Places in an event's key, from the highest bit: row, u, what happens there.
ROW_BITS = np.int64(32)
KIND_BITS = np.int64(2)
# What may happen to the points from u on.
BLOCKED = np.int64(0)
UNBLOCKED = np.int64(1)
ENTERED = np.int64(2)
LEFT = np.int64(3)

#: Lengths are counted in half steps.
ROW_HEIGHT = sqrt(3.0)
FAR = 1e300


@njit(**HELPER)
def first_from(s, row, width):
    """The first u of a row that is not below s; one at the end of the row if s lies beyond."""
    u = np.int64(ceil(min(max(s, 0.0), width)))
    return u + ((u ^ row) & 1)


@njit(**HELPER)
def put_event(key, n, row, u, kind):
    """Note an event."""
    key[n] = row << ROW_BITS | u << KIND_BITS | kind
    return n + 1


@njit(**HELPER)
def block(key, n, row, low, high, width):
    """Note that the points strictly between low and high are blocked."""
    u = first_from(low, row, width)
    end = first_from(high, row, width)
    if u < end:
        n = put_event(key, n, row, u, BLOCKED)
        n = put_event(key, n, row, end, UNBLOCKED)
    return n


@njit(**ENTRY)
def block_around_points(frame, points, reaches, rows, width, keys, n):
    """Events of the points nearer to point i than reaches[i] half steps; returns their number.

    frame: the lattice's origin, unit vectors along and across its rows over the length of a half
    step. n: events so far.
    """
    xy = pointer(points)
    far = pointer(reaches)
    key = pointer(keys)
    f = pointer(frame)
    for i in range(points.shape[0] // 2):
        x = xy[2 * i] - f[0]
        y = xy[2 * i + 1] - f[1]
        s = x * f[2] + y * f[3]
        t = x * f[4] + y * f[5]
        reach = far[i]
        row = max(np.int64(ceil((t - reach) / ROW_HEIGHT)), 0)
        until = min(np.int64(floor((t + reach) / ROW_HEIGHT)), rows - 1)
        while row <= until:
            away = t - ROW_HEIGHT * row
            half = sqrt(max(reach * reach - away * away, 0.0))
            n = block(key, n, row, s - half, s + half, width)
            row += 1
    return n


@njit(**HELPER)
def widen(t, s0, t0, s1, t1, low, high):
    """Let low and high reach to where the line at t crosses the edge from (s0, t0) to (s1, t1)."""
    if min(t0, t1) <= t <= max(t0, t1):
        s = s0 + (t - t0) / (t1 - t0) * (s1 - s0) if t1 != t0 else s0
        low = min(low, s)
        high = max(high, s)
    return low, high


@njit(**HELPER)
def block_strip(key, n, sa, ta, sb, tb, reach, rows, width):
    """Events of the rectangle that reaches to either side of the segment a–b."""
    share = reach / sqrt((sb - sa) * (sb - sa) + (tb - ta) * (tb - ta))
    ds = -(tb - ta) * share
    dt = (sb - sa) * share
    row = max(np.int64(ceil((min(ta, tb) - abs(dt)) / ROW_HEIGHT)), 0)
    until = min(np.int64(floor((max(ta, tb) + abs(dt)) / ROW_HEIGHT)), rows - 1)
    while row <= until:
        t = ROW_HEIGHT * row
        low = FAR
        high = -FAR
        low, high = widen(t, sa + ds, ta + dt, sb + ds, tb + dt, low, high)
        low, high = widen(t, sb + ds, tb + dt, sb - ds, tb - dt, low, high)
        low, high = widen(t, sb - ds, tb - dt, sa - ds, ta - dt, low, high)
        low, high = widen(t, sa - ds, ta - dt, sa + ds, ta + dt, low, high)
        if low < high:
            n = block(key, n, row, low, high, width)
        row += 1
    return n


@njit(**HELPER)
def cross(key, n, sa, ta, sb, tb, step, rows, width):
    """Events where rows enter (step 1, if the segment rises) or leave (-1) across a–b."""
    if tb < ta:
        sa, ta, sb, tb = sb, tb, sa, ta
        step = -step
    kind = ENTERED if step > 0 else LEFT
    row = max(np.int64(ceil(ta / ROW_HEIGHT)), 0)
    while row < rows and ROW_HEIGHT * row < tb:
        s = sa + (ROW_HEIGHT * row - ta) / (tb - ta) * (sb - sa)
        n = put_event(key, n, row, first_from(s, row, width), kind)
        row += 1
    return n


@njit(**ENTRY)
def block_around_segments(frame, segments, steps, reach, rows, width, keys, n):
    """Events of segments (x, y, x, y each): points beside them are blocked, rows enter or leave.

    steps: change of what is inside for rows that cross a rising segment from its left: -1, 0, 1.
    """
    end = pointer(segments)
    step = pointer(steps)
    key = pointer(keys)
    f = pointer(frame)
    for k in range(steps.shape[0]):
        xa = end[4 * k] - f[0]
        ya = end[4 * k + 1] - f[1]
        xb = end[4 * k + 2] - f[0]
        yb = end[4 * k + 3] - f[1]
        sa = xa * f[2] + ya * f[3]
        ta = xa * f[4] + ya * f[5]
        sb = xb * f[2] + yb * f[3]
        tb = xb * f[4] + yb * f[5]
        if reach > 0.0 and (sa != sb or ta != tb):
            n = block_strip(key, n, sa, ta, sb, tb, reach, rows, width)
        if step[k] != 0:
            n = cross(key, n, sa, ta, sb, tb, step[k], rows, width)
    return n


@njit(**ENTRY)
def find_runs(keys, n_keys, runs):
    """Runs out of sorted events: not blocked, and inside; returns their number.

    runs: rows (row, first u, last u), as many as there are events.
    """
    key = pointer(keys)
    row_of = pointer(runs[0])
    first = pointer(runs[1])
    last = pointer(runs[2])
    n = np.int64(0)
    blocked = np.int64(0)
    inside = np.int64(0)
    row = np.int64(-1)
    u_mask = (np.int64(1) << (ROW_BITS - KIND_BITS)) - 1
    for i in range(n_keys):
        here = key[i] >> ROW_BITS
        u = key[i] >> KIND_BITS & u_mask
        if here != row:
            row = here
            blocked = 0
            inside = 0
        elif blocked == 0 and inside > 0:
            before = key[i - 1] >> KIND_BITS & u_mask
            if before < u:
                if n > 0 and row_of[n - 1] == row and last[n - 1] == before - 2:
                    last[n - 1] = u - 2
                else:
                    row_of[n] = row
                    first[n] = before
                    last[n] = u - 2
                    n += 1
        kind = key[i] & 3
        if kind == BLOCKED:
            blocked += 1
        elif kind == UNBLOCKED:
            blocked -= 1
        elif kind == ENTERED:
            inside += 1
        else:
            inside -= 1
    return n

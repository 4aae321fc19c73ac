"""The order in which points are inserted: in rounds, along a Hilbert curve in each.

The rounds (BRIO: Amenta, Choi, Rote 2003) keep the cavities small whatever the input, the curve
keeps the walk from one point to the next short.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .pointers import ENTRY, HELPER, pointer

#: Bits of a coordinate's place on the grid of the curve.
GRID = np.int64(24)
#: Bits that the rounds take, of which there are at most eight.
ROUND_BITS = np.int64(3)
ZERO = np.int64(0)
#: Up to so many points are sorted by small digits, for which less has to be counted.
FEW = 2000


def _hilbert_table() -> np.ndarray:
    """Four levels of the curve at once: [state | 4 bits of x | 4 bits of y] -> state' | 8 bits.

    Bit 0 of a state says that x and y change places, bit 1 that both are counted from the end.
    """
    table = np.zeros(4 << 8, np.int64)
    for entry in range(4 << 8):
        state, distance = entry >> 8, 0
        for level in (3, 2, 1, 0):
            x, y = entry >> 4 + level & 1, entry >> level & 1
            if state & 2:
                x, y = 1 - x, 1 - y
            if state & 1:
                x, y = y, x
            distance = distance << 2 | (3 * x ^ y)
            if y == 0:
                state ^= 3 if x == 1 else 1
        table[entry] = state << 8 | distance
    return table


HILBERT = _hilbert_table()


@njit(**HELPER)
def hilbert(x, y):
    """Distance along the Hilbert curve of the cell (x, y) of a 2^24 by 2^24 grid."""
    d = ZERO
    state = ZERO
    for level in range(GRID - 4, -1, -4):
        entry = HILBERT[state | (x >> level & 15) << 4 | (y >> level & 15)]
        d = d << 8 | (entry & 255)
        state = entry & ~255
    return d


@njit(**HELPER)
def fill_keys(xy, n, rounds, bits, order, key):
    """key[i] = (round, place on the curve, i); each round has eight times as many as the last.

    Rounds are drawn by a fixed xorshift generator (Marsaglia 2003). The number i makes keys differ:
    their order, and with it every mesh, does not depend on how they are sorted.
    """
    x0 = xy[0]
    x1 = x0
    y0 = xy[1]
    y1 = y0
    for i in range(n):
        x = xy[2 * i]
        y = xy[2 * i + 1]
        x0 = min(x0, x)
        x1 = max(x1, x)
        y0 = min(y0, y)
        y1 = max(y1, y)
    width = max(x1 - x0, y1 - y0)
    scale = ((1 << GRID) - 1) / width if width > 0.0 else 0.0
    state = np.uint64(88172645463325252)
    for i in range(n):
        state ^= state << np.uint64(13)
        state ^= state >> np.uint64(7)
        state ^= state << np.uint64(17)
        level = rounds
        draw = state >> np.uint64(20)
        while level > 0 and draw & np.uint64(7) == 0:
            level -= 1
            draw >>= np.uint64(3)
        place = hilbert(np.int64((xy[2 * i] - x0) * scale), np.int64((xy[2 * i + 1] - y0) * scale))
        key[i] = (level << 2 * order | place >> 2 * (GRID - order)) << bits | i


@njit(**ENTRY)
def _insertion_order(points, rounds, digit, counts, keys, spare, order_out, rank_out, sorted_out):
    """Order points for insertion; order_out[r] = i, rank_out[i] = r, and the points in order.

    keys and spare (n,) int64 are scratch; counts holds 2^digit numbers. The sort is by digits of so
    many bits, lowest first, which keeps the order of equal ones (radix sort).
    """
    xy = pointer(points)
    source = pointer(keys)
    target = pointer(spare)
    count = pointer(counts)
    n = keys.shape[0]
    bits = ZERO
    while n > 1 << bits:
        bits += 1
    order = min((bits >> 1) + 10, (63 - ROUND_BITS - bits) >> 1)
    order = min(order, GRID)
    fill_keys(xy, n, rounds, bits, order, source)
    last = (1 << digit) - 1
    shift = bits
    while shift < bits + 2 * order + ROUND_BITS:
        for k in range(last + 1):
            count[k] = 0
        for i in range(n):
            k = source[i] >> shift & last
            count[k] = count[k] + 1
        if count[source[0] >> shift & last] < n:
            total = ZERO
            for k in range(last + 1):
                here = count[k]
                count[k] = total
                total += here
            for i in range(n):
                k = source[i] >> shift & last
                target[count[k]] = source[i]
                count[k] = count[k] + 1
            source, target = target, source
        shift += digit
    first = pointer(order_out)
    rank = pointer(rank_out)
    ordered = pointer(sorted_out)
    for r in range(n):
        i = source[r] & ((1 << bits) - 1)
        first[r] = i
        rank[i] = r
        ordered[2 * r] = xy[2 * i]
        ordered[2 * r + 1] = xy[2 * i + 1]


def insertion_order(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Order points for insertion.

    Parameters
    ----------
    points : (n, 2) float64
        At most 2^28 points.

    Returns
    -------
    order : (n,) int32
        Numbers of the points in their order.
    rank : (n,) int32
        Place of each point in it.
    ordered : (2 n,) float64
        Their coordinates in order.

    Examples
    --------
    >>> order, rank, ordered = insertion_order(np.array([[0, 0], [1, 0], [0, 1.0]]))
    >>> order[rank]
    array([0, 1, 2], dtype=int32)
    """
    n = len(points)
    order, rank, ordered = np.empty(n, np.int32), np.empty(n, np.int32), np.empty(2 * n)
    digit = 11 if n > FEW else 6
    counts, keys, spare = np.empty(2**digit, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
    # Few points need no more than one round.
    rounds = min(7, max(n.bit_length() // 3 - 2, 0))
    # A copy: read-only arrays are another type, for which the kernel would be compiled again.
    flat = np.array(points, np.float64).reshape(-1)
    _insertion_order(flat, rounds, digit, counts, keys, spare, order, rank, ordered)
    return order, rank, ordered

"""The order in which points of space are inserted: in rounds, along a Hilbert curve in each.

The rounds (BRIO: Amenta, Choi, Rote 2003) keep the cavities small whatever the input, the curve
keeps the walk from one point to the next short.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER, pointer

#: Bits that the rounds take, of which there are at most eight.
ROUND_BITS = 3


@njit(**HELPER)
def hilbert(x, y, z, levels):
    """Distance along the Hilbert curve of a cell of a grid of 2^levels cells along each axis.

    J. Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707 (2004).
    """
    bit = np.int64(1) << (levels - 1)
    while bit > 1:
        low = bit - 1
        if x & bit:
            x ^= low
        if y & bit:
            x ^= low
        else:
            t = (x ^ y) & low
            x ^= t
            y ^= t
        if z & bit:
            x ^= low
        else:
            t = (x ^ z) & low
            x ^= t
            z ^= t
        bit >>= 1
    y ^= x
    z ^= y
    t = np.int64(0)
    bit = np.int64(1) << (levels - 1)
    while bit > 1:
        if z & bit:
            t ^= bit - 1
        bit >>= 1
    x ^= t
    y ^= t
    z ^= t
    d = np.int64(0)
    for level in range(levels - 1, -1, -1):
        d = d << 3 | (x >> level & 1) << 2 | (y >> level & 1) << 1 | (z >> level & 1)
    return d


@njit(**ENTRY)
def _keys(points, low, scale, rounds, bits, levels, key):
    """key[i] = (round, place on the curve, i); each round has eight times as many as the last.

    Rounds are drawn by a fixed xorshift generator (Marsaglia 2003).
    """
    p = pointer(points)
    out = pointer(key)
    x0 = low[0]
    y0 = low[1]
    z0 = low[2]
    state = np.uint64(88172645463325252)
    for i in range(key.shape[0]):
        state ^= state << np.uint64(13)
        state ^= state >> np.uint64(7)
        state ^= state << np.uint64(17)
        level = rounds
        draw = state >> np.uint64(20)
        while level > 0 and draw & np.uint64(7) == 0:
            level -= 1
            draw >>= np.uint64(3)
        place = hilbert(
            np.int64((p[3 * i] - x0) * scale),
            np.int64((p[3 * i + 1] - y0) * scale),
            np.int64((p[3 * i + 2] - z0) * scale),
            levels,
        )
        out[i] = (level << 3 * levels | place) << bits | i


def space_order(points: np.ndarray) -> np.ndarray:
    """Numbers of points in the order of their insertion, (n,) int64.

    Parameters
    ----------
    points : (n, 3) float64
        At most 2^28 points.

    Examples
    --------
    >>> space_order(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])).tolist()
    [0, 2, 1]
    """
    n = len(points)
    if n == 0:
        return np.zeros(0, np.int64)
    bits = max(n.bit_length(), 1)
    levels = min((63 - ROUND_BITS - bits) // 3, bits // 3 + 6)
    low = points.min(axis=0)
    width = float((points.max(axis=0) - low).max())
    scale = (2**levels - 1) / width if width > 0.0 else 0.0
    key = np.empty(n, np.int64)
    # Few points need no more than one round.
    rounds = min(7, max(n.bit_length() // 3 - 2, 0))
    _keys(np.array(points, np.float64).reshape(-1), low, scale, rounds, bits, levels, key)
    key.sort()
    key &= (1 << bits) - 1
    return key

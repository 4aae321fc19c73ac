"""Morton keys, and the leaf that holds a place.

A place is a pair of whole numbers below 2**DEPTH; its key interleaves their bits. The leaves of a
tree stand in the order of the keys of their lower left corners, so that a leaf of level l holds the
keys from its own to 4**(DEPTH - l) further.
"""

from __future__ import annotations

from numba import njit

from ..pointers import HELPER

#: Levels below the root.
DEPTH = 30


@njit(**HELPER)
def spread(x):
    """Bits of x moved apart to every second place."""
    x = (x | (x << 16)) & 0x0000FFFF0000FFFF
    x = (x | (x << 8)) & 0x00FF00FF00FF00FF
    x = (x | (x << 4)) & 0x0F0F0F0F0F0F0F0F
    x = (x | (x << 2)) & 0x3333333333333333
    return (x | (x << 1)) & 0x5555555555555555


@njit(**HELPER)
def gathered(k):
    """Every second bit of k, moved together: undoes `spread`."""
    k &= 0x5555555555555555
    k = (k | (k >> 1)) & 0x3333333333333333
    k = (k | (k >> 2)) & 0x0F0F0F0F0F0F0F0F
    k = (k | (k >> 4)) & 0x00FF00FF00FF00FF
    k = (k | (k >> 8)) & 0x0000FFFF0000FFFF
    return (k | (k >> 16)) & 0x00000000FFFFFFFF


@njit(**HELPER)
def key_of(x, y):
    """Morton key of a place."""
    return spread(x) | (spread(y) << 1)


@njit(**HELPER)
def is_inside(x, y):
    """Whether a place lies in the root."""
    return ((x | y) >> DEPTH) == 0


@njit(**HELPER)
def holder(key, n, wanted, near):
    """Number of the leaf that holds a key, searched outwards from leaf `near`.

    Neighbours in the plane are near one another along the curve more often than not, so steps that
    double find most of them in two or three.
    """
    if key[near] <= wanted:
        low = near
        step = 1
        high = low + 1
        while high < n and key[high] <= wanted:
            low = high
            high += step
            step += step
        high = min(high, n)
    else:
        high = near
        step = 1
        low = high - 1
        while key[low] > wanted:
            high = low
            low = max(low - step, 0)
            step += step
    while high - low > 1:
        middle = (low + high) >> 1
        if key[middle] <= wanted:
            low = middle
        else:
            high = middle
    return low

"""Queue of bad triangles: buckets by shortest edge, shortest first.

Within a bucket first in, first out, which makes the fewest triangles where nothing but the angles
is asked for; or last in, first out, for gaps between lattices: what is near in the mesh is then
near in time, and still in the processor's cache.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from .pointers import HELPER, bits

#: head, tail: first and last entry of each bucket. items: (triangle, third vertex, next) each.
#: state: first free entry, entries ever used, no bucket below this one is filled, entries queued,
#: 1 for last in, first out.
Queue = namedtuple("Queue", "head tail items state")

N_BUCKETS = 1024
#: Bucket of an edge as long as the domain.
DIAGONAL_BUCKET = 900
#: Bits of the mantissa that are left out: two or four buckets to each factor of two in the square.
COARSE = np.int64(51)
FINE = np.int64(50)
LAST = np.int64(N_BUCKETS - 1)


@njit(**HELPER)
def bucket(square, left_out):
    """Bucket of a squared length, given as a share of the squared diagonal."""
    b = (bits(square) >> left_out) - ((1023 << (52 - left_out)) - DIAGONAL_BUCKET)
    return min(max(b, 0), LAST)


@njit(**HELPER)
def push(q, b, t, apex):
    """Queue triangle t in bucket b; its third vertex tells later whether it still is the same."""
    k = q.state[0]
    if k >= 0:
        q.state[0] = q.items[3 * k + 2]
    else:
        k = q.state[1]
        q.state[1] = k + 1
    q.items[3 * k] = t
    q.items[3 * k + 1] = apex
    if q.state[4] != 0:
        q.items[3 * k + 2] = q.head[b]
        q.head[b] = k
    else:
        q.items[3 * k + 2] = -1
        if q.head[b] < 0:
            q.head[b] = k
        else:
            q.items[3 * q.tail[b] + 2] = k
        q.tail[b] = k
    if b < q.state[2]:
        q.state[2] = b
    q.state[3] = q.state[3] + 1


@njit(**HELPER)
def pop(q):
    """Take the first entry; the queue must not be empty. Returns its bucket, triangle and stamp."""
    b = q.state[2]
    while q.head[b] < 0:
        b += 1
    q.state[2] = b
    k = q.head[b]
    t = q.items[3 * k]
    apex = q.items[3 * k + 1]
    q.head[b] = q.items[3 * k + 2]
    q.items[3 * k + 2] = q.state[0]
    q.state[0] = k
    q.state[3] = q.state[3] - 1
    return b, t, apex

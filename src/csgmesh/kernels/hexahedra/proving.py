"""Jacobians of hexahedra proved positive by Bernstein bounds, near-cubes by a cheaper one.

The determinant of a trilinear map has degree 2 along each direction. Its Bernstein coefficients
are means of determinants of one edge each along u, v and w (Johnen, Remacle, Geuzaine 2013).
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER

#: Cells looked at between two returns to the caller.
SLICE = 100_000

#: Edges along u by (v, w), along v by (u, w), along w by (u, v): tail and head.
EDGES = np.array(
    [
        [(0, 1), (4, 5), (3, 2), (7, 6)],
        [(0, 3), (4, 7), (1, 2), (5, 6)],
        [(0, 4), (3, 7), (1, 5), (2, 6)],
    ],
    np.int64,
)


@njit(**HELPER)
def triple(e, a, b, c):
    """Determinant of three edges."""
    a = 3 * a
    b = 12 + 3 * b
    c = 24 + 3 * c
    return (
        e[a] * (e[b + 1] * e[c + 2] - e[b + 2] * e[c + 1])
        + e[a + 1] * (e[b + 2] * e[c] - e[b] * e[c + 2])
        + e[a + 2] * (e[b] * e[c + 1] - e[b + 1] * e[c])
    )


@njit(**HELPER)
def is_near_cube(e, mean):
    """Whether the determinant of the mean edges exceeds what their differences can change."""
    whole = 1.0
    rest = 1.0
    for w in range(3):
        far = 0.0
        for d in range(3):
            mean[3 * w + d] = 0.25 * (
                e[12 * w + d] + e[12 * w + 3 + d] + e[12 * w + 6 + d] + e[12 * w + 9 + d]
            )
        for k in range(4):
            square = 0.0
            for d in range(3):
                square += (e[12 * w + 3 * k + d] - mean[3 * w + d]) ** 2
            far = max(far, square)
        size = sqrt(mean[3 * w] ** 2 + mean[3 * w + 1] ** 2 + mean[3 * w + 2] ** 2)
        rest *= size
        whole *= size + sqrt(far)
    det = (
        mean[0] * (mean[4] * mean[8] - mean[5] * mean[7])
        + mean[1] * (mean[5] * mean[6] - mean[3] * mean[8])
        + mean[2] * (mean[3] * mean[7] - mean[4] * mean[6])
    )
    return det > 1.000001 * whole - rest


@njit(**ENTRY)
def mark_unproved(points, hexes, unproved, scratch, start):
    """Whether the Bernstein bound of each cell from `start` on fails; the next cell."""
    e = scratch[0]
    mean = scratch[1]
    bound = scratch[2]
    last = min(start + SLICE, hexes.shape[0])
    for c in range(start, last):
        for w in range(3):
            for k in range(4):
                tail = hexes[c, EDGES[w, k, 0]]
                head = hexes[c, EDGES[w, k, 1]]
                for d in range(3):
                    e[12 * w + 3 * k + d] = points[head, d] - points[tail, d]
        if is_near_cube(e, mean):
            unproved[c] = False
            continue
        for n in range(27):
            bound[n] = 0.0
        for u in range(4):
            for v in range(4):
                for w in range(4):
                    i = (v >> 1) + (w >> 1)
                    j = (u >> 1) + (w & 1)
                    k = (u & 1) + (v & 1)
                    bound[9 * i + 3 * j + k] += triple(e, u, v, w)
        least = bound[0]
        for n in range(27):
            least = min(least, bound[n])
        unproved[c] = not least > 0.0
    return last

"""The sharpest corner of cells."""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import ENTRY, pointer


@njit(**ENTRY)
def corner_sines(points, cells, w, out):
    """Smallest sine of the angles of cells with w corners; negative where one is turned over."""
    xy = pointer(points)
    cell = pointer(cells)
    sine = pointer(out)
    for c in range(out.shape[0]):
        worst = 1.0
        a = 2 * cell[w * c + w - 2]
        b = 2 * cell[w * c + w - 1]
        ux = xy[b] - xy[a]
        uy = xy[b + 1] - xy[a + 1]
        u = ux * ux + uy * uy
        for k in range(w):
            d = 2 * cell[w * c + k]
            vx = xy[d] - xy[b]
            vy = xy[d + 1] - xy[b + 1]
            v = vx * vx + vy * vy
            size = u * v
            worst = min(worst, (ux * vy - uy * vx) / sqrt(size) if size > 0.0 else -1.0)
            b = d
            ux = vx
            uy = vy
            u = v
        sine[c] = worst

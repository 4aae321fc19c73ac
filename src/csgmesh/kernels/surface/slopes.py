"""How far edges leave the exact surfaces that they approximate."""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import HELPER
from .exact import on_surface
from .topology import distance

#: Largest sine between an edge and its surface: a sixth of a turn from end to end. It holds for
#: edges up to so many times as long as wanted.
STEEP = 0.5
SHORT = 1.5
#: Longer ones rise no more than those of the wanted length, and half as long again, or than this:
#: a vertex's bound by curvature is 0.8 radii, and an edge of length l rises by l / 2 radii.
SHARE = 0.6
GENTLE = 0.05
#: So far from the ends, as the apex of a cone has no normal.
INWARDS = 0.02


@njit(**HELPER)
def slope(view, s, a, b):
    """Sine of the larger angle between the chord of two vertices and surface s at its ends."""
    p = view.xyz
    x = p[3 * b] - p[3 * a]
    y = p[3 * b + 1] - p[3 * a + 1]
    z = p[3 * b + 2] - p[3 * a + 2]
    size = sqrt(x * x + y * y + z * z)
    worst = 0.0
    for t in (INWARDS, 1.0 - INWARDS):
        _, _, _, nx, ny, nz = on_surface(
            view.code, view.number, s, p[3 * a] + t * x, p[3 * a + 1] + t * y, p[3 * a + 2] + t * z
        )
        worst = max(worst, abs(nx * x + ny * y + nz * z))
    return worst / size if size > 0.0 else 0.0


@njit(**HELPER)
def steepest(view, a, b):
    """How steep an edge between two vertices may be: as one of the wanted length.

    Across a tube that has vertices at its ends only, long edges would else cut through.
    """
    if 2.0 * distance(view, a, b) <= SHORT * (view.size[a] + view.size[b]):
        return STEEP
    share = (view.size[a] + view.size[b]) / (view.cap[a] + view.cap[b])
    return min(max(SHARE * share, GENTLE), STEEP)

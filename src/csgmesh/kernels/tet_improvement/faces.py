"""Remove faces: two cells that share one become three."""

from __future__ import annotations

from numba import njit

from ..pointers import HELPER
from .cells import C_OLD, is_better
from .shapes import shape_of


@njit(**HELPER)
def face_gain(view, t, f):
    """Worst shape there would be without face f of cell t; 0 if it must stay or nothing gains."""
    g = view.mate[4 * t + f]
    if g < 0 or view.wall[4 * t + f] >= 0 or view.region[g >> 2] != view.region[t]:
        return 0.0
    a = view.corner[4 * t + f]
    b = view.corner[g]
    x = view.corner[4 * t + (f ^ 1)]
    y = view.corner[4 * t + (f ^ 2)]
    z = view.corner[4 * t + (f ^ 3)]
    old = min(view.score[t], view.score[g >> 2])
    new = 2.0
    for _ in range(3):
        new = min(new, shape_of(view.xyz, a, b, x, y))
        if not is_better(new, old):
            return 0.0
        x, y, z = y, z, x
    return new


@njit(**HELPER)
def plan_face(view, t, f):
    """Plan what `face_gain` found; how many cells there will be."""
    g = view.mate[4 * t + f]
    a = view.corner[4 * t + f]
    b = view.corner[g]
    for k in range(3):
        view.fresh[4 * k] = a
        view.fresh[4 * k + 1] = b
        view.fresh[4 * k + 2] = view.corner[4 * t + (f ^ (k + 1))]
        view.fresh[4 * k + 3] = view.corner[4 * t + (f ^ ((k + 1) % 3 + 1))]
        view.fresh_region[k] = view.region[t]
    view.slot[0] = t
    view.slot[1] = g >> 2
    view.count[C_OLD] = 2
    return 3

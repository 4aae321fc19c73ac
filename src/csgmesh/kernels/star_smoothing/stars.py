"""Stars of vertices among triangles and quads, and how good they are.

Cells stand one after the other in flat arrays, whatever their width. The quality of a cell is its
smallest scaled Jacobian, det / (|a| |b|) over the corners with edges a and b: the sine of the
smallest angle of a triangle, here over that of 60 degrees; 1 for a rectangle; negative where a
corner is turned over. The larger, the better.
"""

from __future__ import annotations

from collections import namedtuple
from math import sqrt

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from ..predicates import orient2d

#: corner, begin: the corners of all cells, and where each cell's begin; star, star_begin: the
#: places in `corner` where each vertex stands, and where each vertex's begin; kind: FREE, SLIDING
#: or FIXED; around: the facets before and behind each sliding vertex; interval, curve: of each
#: facet; number[0]: distance of a facet from its curve that is always allowed; count[0]: vertices
#: moved so far, count[1]: the next vertex of the list.
Cells = namedtuple(
    "Cells",
    "xy corner begin owner star star_begin kind around interval curve curve_kind curve_data "
    "number count",
)
View = namedtuple(
    "View",
    "xy corner begin owner star star_begin kind around interval curve curve_kind curve_data "
    "number count",
)

#: One over the sine of 60 degrees.
EQUILATERAL = 1.1547005383792517
#: Below any quality.
WORST = -4.0


@njit(**HELPER)
def view_of(cells):
    return View(
        pointer(cells.xy),
        pointer(cells.corner),
        pointer(cells.begin),
        pointer(cells.owner),
        pointer(cells.star),
        pointer(cells.star_begin),
        pointer(cells.kind),
        pointer(cells.around),
        pointer(cells.interval),
        pointer(cells.curve),
        pointer(cells.curve_kind),
        pointer(cells.curve_data),
        pointer(cells.number),
        pointer(cells.count),
    )


@njit(**HELPER)
def scaled_jacobian(ax, ay, bx, by, cx, cy):
    """At corner b, between its neighbours a and c."""
    ux = cx - bx
    uy = cy - by
    vx = ax - bx
    vy = ay - by
    size = (ux * ux + uy * uy) * (vx * vx + vy * vy)
    return (ux * vy - uy * vx) / sqrt(size) if size > 0.0 else WORST


@njit(**HELPER)
def cell_quality(view, c, v, x, y):
    """Quality of cell c with vertex v at (x, y)."""
    first = view.begin[c]
    w = view.begin[c + 1] - first
    p = view.corner[first + w - 2]
    q = view.corner[first + w - 1]
    px = x if p == v else view.xy[2 * p]
    py = y if p == v else view.xy[2 * p + 1]
    qx = x if q == v else view.xy[2 * q]
    qy = y if q == v else view.xy[2 * q + 1]
    worst = 4.0
    for k in range(w):
        r = view.corner[first + k]
        rx = x if r == v else view.xy[2 * r]
        ry = y if r == v else view.xy[2 * r + 1]
        worst = min(worst, scaled_jacobian(px, py, qx, qy, rx, ry))
        px = qx
        py = qy
        qx = rx
        qy = ry
    return EQUILATERAL * worst if w == 3 else worst


@njit(**HELPER)
def star_quality(view, v, x, y, limit):
    """Worst quality of the cells around v with v at (x, y); WORST below `limit`."""
    worst = 4.0
    for k in range(view.star_begin[v], view.star_begin[v + 1]):
        worst = min(worst, cell_quality(view, view.owner[view.star[k]], v, x, y))
        if worst < limit:
            return WORST
    return worst


@njit(**HELPER)
def is_convex_star(view, v, x, y):
    """Whether the cells around v, at (x, y), are counterclockwise and convex, exactly."""
    for k in range(view.star_begin[v], view.star_begin[v + 1]):
        first = view.begin[view.owner[view.star[k]]]
        w = view.begin[view.owner[view.star[k]] + 1] - first
        j = view.star[k] - first
        for i in range(w - 1 if w == 4 else 1):
            # The corners that move: that of v, and in a quad those beside it.
            m = (j + i + w - 1) % w if w == 4 else j
            a = view.corner[first + (m + w - 1) % w]
            b = view.corner[first + m]
            c = view.corner[first + (m + 1) % w]
            ax = x if a == v else view.xy[2 * a]
            ay = y if a == v else view.xy[2 * a + 1]
            bx = x if b == v else view.xy[2 * b]
            by = y if b == v else view.xy[2 * b + 1]
            cx = x if c == v else view.xy[2 * c]
            cy = y if c == v else view.xy[2 * c + 1]
            if orient2d(ax, ay, bx, by, cx, cy) <= 0.0:
                return False
    return True


@njit(**ENTRY)
def cell_qualities(cells, out):
    """Quality of every cell."""
    view = view_of(cells)
    quality = pointer(out)
    for c in range(out.shape[0]):
        quality[c] = cell_quality(view, c, np.int64(-1), 0.0, 0.0)


@njit(**ENTRY)
def gather_stars(corners, star_begins, stars):
    """Write where each vertex stands among the corners; star_begins, n + 1 numbers, is 0 before."""
    corner = pointer(corners)
    begin = pointer(star_begins)
    star = pointer(stars)
    n = star_begins.shape[0] - 1
    for h in range(corners.shape[0]):
        begin[corner[h] + 1] += 1
    for v in range(n):
        begin[v + 1] += begin[v]
    for h in range(corners.shape[0]):
        star[begin[corner[h]]] = h
        begin[corner[h]] += 1
    for v in range(n, 0, -1):
        begin[v] = begin[v - 1]
    begin[0] = 0

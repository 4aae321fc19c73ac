"""Move vertices to better places of their stars, or along their exact curves."""

from __future__ import annotations

from math import hypot

from numba import njit

from ..improvement_moves import keeps_to_curve, place_on, set_parameter
from ..pointers import ENTRY, HELPER, pointer
from .stars import (
    WORST,
    Cells,
    cell_qualities,
    gather_stars,
    is_convex_star,
    star_quality,
    view_of,
)

__all__ = ["Cells", "cell_qualities", "gather_stars", "move_vertices"]

SLIDING = 1
FIXED = 2
#: What a vertex is moved to.
NEIGHBOURS = 0
CENTROIDS = 1
#: Gains below this are not worth a move of the search.
GAIN = 1e-4
#: The first step of a search, as a share of the distance to the nearest neighbour.
FIRST_STEP = 0.25
#: A sliding vertex keeps this share of the interval between its neighbours from each of them.
APART = 0.15
#: Vertices looked at between two returns to the caller: less than 0.2 s.
SLICE = 20_000


@njit(**HELPER)
def centre(view, v, method):
    """Mean of the neighbours along edges; or mean of the cells' centroids, weighted by area."""
    sx = 0.0
    sy = 0.0
    total = 0.0
    x = view.xy[2 * v]
    y = view.xy[2 * v + 1]
    for k in range(view.star_begin[v], view.star_begin[v + 1]):
        h = view.star[k]
        first = view.begin[view.owner[h]]
        w = view.begin[view.owner[h] + 1] - first
        if method == NEIGHBOURS:
            a = view.corner[first + (h - first + 1) % w]
            b = view.corner[first + (h - first + w - 1) % w]
            sx += view.xy[2 * a] - x + view.xy[2 * b] - x
            sy += view.xy[2 * a + 1] - y + view.xy[2 * b + 1] - y
            total += 2.0
            continue
        for i in range(1, w - 1):
            a = view.corner[first + (h - first + i) % w]
            b = view.corner[first + (h - first + i + 1) % w]
            ux = view.xy[2 * a] - x
            uy = view.xy[2 * a + 1] - y
            vx = view.xy[2 * b] - x
            vy = view.xy[2 * b + 1] - y
            area = ux * vy - uy * vx
            sx += area * (ux + vx) / 3.0
            sy += area * (uy + vy) / 3.0
            total += area
    if total <= 0.0:
        return x, y
    return x + sx / total, y + sy / total


@njit(**HELPER)
def nearest_neighbour(view, v):
    """Distance from v to the nearest vertex of its cells."""
    reach = 1e300
    for k in range(view.star_begin[v], view.star_begin[v + 1]):
        c = view.owner[view.star[k]]
        for h in range(view.begin[c], view.begin[c + 1]):
            u = view.corner[h]
            if u != v:
                dx = view.xy[2 * u] - view.xy[2 * v]
                dy = view.xy[2 * u + 1] - view.xy[2 * v + 1]
                reach = min(reach, hypot(dx, dy))
    return reach


@njit(**HELPER)
def put(view, v, x, y, t):
    """Move v; a sliding vertex takes the intervals of its two facets along."""
    view.xy[2 * v] = x
    view.xy[2 * v + 1] = y
    if view.kind[v] == SLIDING:
        set_parameter(view, v, t)
    view.count[0] += 1


@njit(**HELPER)
def step_to(view, v, method):
    """Move v to the centre of its star, or half the way, unless that makes the star worse."""
    x = view.xy[2 * v]
    y = view.xy[2 * v + 1]
    now = star_quality(view, v, x, y, WORST)
    f = view.around[2 * v]
    g = view.around[2 * v + 1]
    cx, cy = centre(view, v, method)
    share = 1.0
    for _ in range(3):
        px = x + share * (cx - x)
        py = y + share * (cy - y)
        t = 0.0
        if view.kind[v] == SLIDING:
            old = view.interval[2 * g]
            t = old + share * (0.5 * (view.interval[2 * f] + view.interval[2 * g + 1]) - old)
            px, py = place_on(view, view.curve[f], t)
            if not keeps_to_curve(view, f, g, t):
                share *= 0.5
                continue
        if star_quality(view, v, px, py, now) >= now and is_convex_star(view, v, px, py):
            put(view, v, px, py, t)
            return
        share *= 0.5


@njit(**HELPER)
def search(view, v, rounds):
    """Pattern search for the best place of a free vertex."""
    sx = view.xy[2 * v]
    sy = view.xy[2 * v + 1]
    now = star_quality(view, v, sx, sy, WORST)
    x = sx
    y = sy
    best = now
    for method in range(2):
        cx, cy = centre(view, v, method)
        value = star_quality(view, v, cx, cy, best)
        if value > best:
            best = value
            x = cx
            y = cy
    step = FIRST_STEP * nearest_neighbour(view, v)
    dx = 1.0
    dy = 0.0
    for _ in range(rounds):
        found = False
        for _ in range(6):
            # Turn by 60 degrees, and after a failure by 23, so as not to be caught on a ridge.
            turned = 0.5 * dx - 0.8660254037844386 * dy
            dy = 0.8660254037844386 * dx + 0.5 * dy
            dx = turned
            value = star_quality(view, v, x + step * dx, y + step * dy, best)
            if value > best:
                best = value
                x += step * dx
                y += step * dy
                found = True
                break
        if not found:
            step *= 0.5
            turned = 0.9205048534524404 * dx - 0.3907311284892738 * dy
            dy = 0.3907311284892738 * dx + 0.9205048534524404 * dy
            dx = turned
    # Cells that are turned over to begin with may become better without becoming good.
    if best > now + GAIN and (now <= 0.0 or is_convex_star(view, v, x, y)):
        put(view, v, x, y, 0.0)


@njit(**HELPER)
def search_along(view, v, rounds):
    """Search for the best place of a sliding vertex on its curve."""
    f = view.around[2 * v]
    g = view.around[2 * v + 1]
    t0 = view.interval[2 * f]
    span = view.interval[2 * g + 1] - t0
    now = star_quality(view, v, view.xy[2 * v], view.xy[2 * v + 1], WORST)
    best = now
    share = (view.interval[2 * g] - t0) / span
    step = FIRST_STEP
    for _ in range(rounds):
        found = False
        for sign in range(-1, 2, 2):
            s = share + sign * step
            if s < APART or s > 1.0 - APART:
                continue
            x, y = place_on(view, view.curve[f], t0 + s * span)
            value = star_quality(view, v, x, y, best)
            if value > best and keeps_to_curve(view, f, g, t0 + s * span):
                best = value
                share = s
                found = True
                break
        if not found:
            step *= 0.5
    x, y = place_on(view, view.curve[f], t0 + share * span)
    if best > now + GAIN and (now <= 0.0 or is_convex_star(view, v, x, y)):
        put(view, v, x, y, t0 + share * span)


@njit(**ENTRY)
def move_vertices(cells, vertices, method, rounds):
    """Move the vertices of a list, from count[1] on; whether there are more.

    `method` is 0 for the mean of the neighbours, 1 for the mean of the cells' centroids, 2 for a
    search of so many rounds.
    """
    view = view_of(cells)
    listed = pointer(vertices)
    last = min(view.count[1] + SLICE, vertices.shape[0])
    while view.count[1] < last:
        v = listed[view.count[1]]
        view.count[1] += 1
        if view.kind[v] == FIXED or view.star_begin[v] == view.star_begin[v + 1]:
            continue
        if method < 2:
            step_to(view, v, method)
        elif view.kind[v] == SLIDING:
            search_along(view, v, rounds)
        else:
            search(view, v, rounds)
    return view.count[1] < vertices.shape[0]

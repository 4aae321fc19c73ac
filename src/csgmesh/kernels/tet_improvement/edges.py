"""Remove edges: triangulate the polygon around one in the best way.

Source: G. T. Klincsek, "Minimal triangulations of polygonal domains", Annals of Discrete
Mathematics 9 (1980); J. R. Shewchuk, "Two discrete optimization algorithms for the topological
improvement of tetrahedral meshes" (2002). An edge on the surface, inside a face, goes in the same
way: the polygon then ends at the two triangles of the surface, or they cut it in two.
"""

from __future__ import annotations

from numba import njit

from ..pointers import HELPER
from .cavity import set_new_wall
from .cells import (
    C_CHAIN,
    C_CLOSED,
    C_EDGE,
    C_NEW_WALL,
    C_OLD,
    C_RING,
    C_WALLS,
    FROZEN,
    GAIN,
    ROW,
    gather_ring,
    gather_star,
    place_in,
)
from .shapes import shape_of
from .surface import may_turn

#: Better than any shape.
BEST = 2.0


@njit(**HELPER)
def best_fan(view, a, b, first, last, floor):
    """Best triangulation of ring vertices first ... last: its worst shape, 0 if below the floor."""
    end = b
    for width in range(1, last - first + 1):
        for i in range(first, last - width + 1):
            j = i + width
            best = BEST if width == 1 else 0.0
            for k in range(i + 1, j):
                value = min(view.span[ROW * i + k], view.span[ROW * k + j])
                if value <= best or value <= floor:
                    continue
                p = view.ring[i]
                q = view.ring[k]
                r = view.ring[j]
                for _ in range(2):
                    if value > best and value > floor:
                        value = min(value, shape_of(view.xyz, p, q, r, end))
                    # The other side of the polygon, turned over.
                    p, q = q, p
                    end = a + b - end
                if value > best and value > floor:
                    best = value
                    view.split[ROW * i + j] = k
            view.span[ROW * i + j] = best
    return view.span[ROW * first + last]


@njit(**HELPER)
def rotate_ring(view, n, k):
    """Begin a closed ring of n at its vertex k."""
    for _ in range(k):
        v = view.ring[0]
        t = view.ring_cell[0]
        w = view.spoke[0]
        for i in range(n - 1):
            view.ring[i] = view.ring[i + 1]
            view.ring_cell[i] = view.ring_cell[i + 1]
            view.spoke[i] = view.spoke[i + 1]
        view.ring[n - 1] = v
        view.ring_cell[n - 1] = t
        view.spoke[n - 1] = w
    view.ring[n] = view.ring[0]
    view.spoke[n] = view.spoke[0]


@njit(**HELPER)
def find_chains(view, n):
    """Where the walls of a ring of n cells stand: 0 none, 1 at its ends, 2 within it, -1 other.

    A closed ring with two walls is turned to begin at one, and count[C_CHAIN] tells the other.
    """
    view.count[C_CHAIN] = 0
    view.count[C_WALLS] = -1
    view.count[C_WALLS + 1] = -1
    walls = 0
    for k in range(view.count[C_RING]):
        if view.spoke[k] >= 0:
            walls += 1
    if view.count[C_CLOSED] == 0:
        if walls != 2 or view.spoke[0] < 0 or view.spoke[n] < 0:
            return -1
        view.count[C_WALLS] = view.spoke[0]
        view.count[C_WALLS + 1] = view.spoke[n]
        return 1
    if walls == 0:
        return 0
    if walls != 2:
        return -1
    first = 0
    while view.spoke[first] < 0:
        first += 1
    rotate_ring(view, n, first)
    second = 1
    while view.spoke[second] < 0:
        second += 1
    view.count[C_CHAIN] = second
    view.count[C_WALLS] = view.spoke[0]
    view.count[C_WALLS + 1] = view.spoke[second]
    return 2


@njit(**HELPER)
def edge_gain(view, t, i, j):
    """Worst shape there would be without edge i, j of cell t; 0 if it cannot be removed or gains
    nothing. What is to be done stays in the tables."""
    a = view.corner[4 * t + i]
    b = view.corner[4 * t + j]
    if view.kind[a] == FROZEN and view.kind[b] == FROZEN:
        return 0.0
    n = gather_ring(view, t, a, b)
    if n < 0:
        return 0.0
    where = find_chains(view, n)
    if where < 0:
        return 0.0
    floor = BEST
    for k in range(n):
        floor = min(floor, view.score[view.ring_cell[k]])
    floor = max(floor * GAIN, 0.0)
    first = 0
    far = n - 1
    if where > 0:
        far = n if where == 1 else view.count[C_CHAIN]
        if not may_turn(view, a, b, view.ring[0], view.ring[far]):
            return 0.0
    value = BEST
    while first < n and value > 0.0:
        value = min(value, best_fan(view, a, b, first, far, floor))
        first = far if where == 2 else n
        far = n
    return value


@njit(**HELPER)
def write_fan(view, a, b, first, last, region, m):
    """Write the cells of the best triangulation of a chain from the m-th on; how many there are.

    The tables of intervals still to do stand at the end of `split`.
    """
    todo = ROW * ROW
    view.split[todo] = ROW * first + last
    n = 1
    while n > 0:
        n -= 1
        key = view.split[todo + n]
        i = key // ROW
        j = key - ROW * i
        if j - i < 2:
            continue
        k = view.split[key]
        p = view.ring[i]
        q = view.ring[k]
        r = view.ring[j]
        at = 4 * m
        view.fresh[at] = p
        view.fresh[at + 1] = q
        view.fresh[at + 2] = r
        view.fresh[at + 3] = b
        view.fresh[at + 4] = a
        view.fresh[at + 5] = p
        view.fresh[at + 6] = q
        view.fresh[at + 7] = r
        view.fresh_region[m] = region
        view.fresh_region[m + 1] = region
        m += 2
        view.split[todo + n] = ROW * i + k
        view.split[todo + n + 1] = ROW * k + j
        n += 2
    return m


@njit(**HELPER)
def is_inside(view, p, q):
    """Whether p, q is no edge yet, or one that no wall touches."""
    if view.kind[p] == FROZEN:
        if view.kind[q] == FROZEN:
            return False
        p, q = q, p
    n = gather_star(view, p)
    if n < 0:
        return False
    for k in range(n):
        t = view.star[k]
        if place_in(view, t, q) < 4:
            for f in range(4 * t, 4 * t + 4):
                v = view.corner[f]
                if v != p and v != q and (view.wall[f] >= 0 or view.mate[f] < 0):
                    return False
    return True


@njit(**HELPER)
def plan_edge(view, t, i, j):
    """Plan what `edge_gain` found for the same edge; how many cells there will be, or -1."""
    a = view.corner[4 * t + i]
    b = view.corner[4 * t + j]
    n = view.count[C_RING] - 1 + view.count[C_CLOSED]
    chain = view.count[C_CHAIN]
    w = view.count[C_WALLS]
    far = n - 1
    if w >= 0:
        far = chain if chain > 0 else n
        p = view.ring[0]
        q = view.ring[far]
        if not is_inside(view, p, q):
            return -1
        view.count[C_EDGE] = a
        view.count[C_EDGE + 1] = b
        view.count[C_EDGE + 2] = p
        view.count[C_EDGE + 3] = q
        set_new_wall(view, C_NEW_WALL, a, p, q, w)
        set_new_wall(view, C_NEW_WALL + 4, b, p, q, view.count[C_WALLS + 1])
    for k in range(n):
        view.slot[k] = view.ring_cell[k]
    view.count[C_OLD] = n
    m = 0
    first = 0
    while first < n:
        m = write_fan(view, a, b, first, far, view.region[view.ring_cell[first]], m)
        first = far if chain > first else n
        far = n
    return m

"""The lowest of many sizes in space that each grow with the distance from a triangle.

The triangles hang in a complete binary tree of boxes: node k has the children 2 k and 2 k + 1, leaf
j holds the triangles j * PER_LEAF and following. What a node cannot better is not entered.
"""

from __future__ import annotations

from collections import namedtuple
from math import sqrt

from numba import njit

from ..pointers import ENTRY, HELPER, pointer, scratch
from ..tree.triangle_distance import square_distance

PER_LEAF = 4

#: Triangles: corners, value there, distance up to which it holds; nodes: box, lowest value, widest
#: reach.
Facets = namedtuple("Facets", "corner value reach box low far")


@njit(**HELPER)
def facet_bound(tree, k, growth, x, y, z):
    """What no triangle below node k can undercut at (x, y, z)."""
    b = 6 * k
    dx = max(tree.box[b] - x, 0.0, x - tree.box[b + 3])
    dy = max(tree.box[b + 1] - y, 0.0, y - tree.box[b + 4])
    dz = max(tree.box[b + 2] - z, 0.0, z - tree.box[b + 5])
    away = sqrt(dx * dx + dy * dy + dz * dz) - tree.far[k]
    return tree.low[k] + growth * max(away, 0.0)


@njit(**ENTRY)
def lowest_facets(corners, values, reaches, boxes, lows, fars, growth, places, found):
    """Lowest value found[i] at places[3 i] to places[3 i + 2]."""
    tree = Facets(
        pointer(corners),
        pointer(values),
        pointer(reaches),
        pointer(boxes),
        pointer(lows),
        pointer(fars),
    )
    place = pointer(places)
    out = pointer(found)
    n_leaves = lows.shape[0] // 2
    stack = scratch(256)
    near = 0
    for i in range(found.shape[0]):
        x = place[3 * i]
        y = place[3 * i + 1]
        z = place[3 * i + 2]
        away = sqrt(square_distance(tree.corner, near, x, y, z)) - tree.reach[near]
        best = tree.value[near] + growth * max(away, 0.0)
        stack[0] = 1.0
        stack[1] = facet_bound(tree, 1, growth, x, y, z)
        height = 1
        while height > 0:
            height -= 1
            if stack[2 * height + 1] >= best:
                continue
            k = int(stack[2 * height])
            if k >= n_leaves:
                first = (k - n_leaves) * PER_LEAF
                for t in range(first, first + PER_LEAF):
                    away = sqrt(square_distance(tree.corner, t, x, y, z)) - tree.reach[t]
                    h = tree.value[t] + growth * max(away, 0.0)
                    if h < best:
                        best = h
                        near = t
                continue
            left = facet_bound(tree, 2 * k, growth, x, y, z)
            right = facet_bound(tree, 2 * k + 1, growth, x, y, z)
            # The more promising child is looked at first, so it goes on top.
            last = 2 * k + (1 if right < left else 0)
            for child in (4 * k + 1 - last, last):
                b = right if child == 2 * k + 1 else left
                if b < best:
                    stack[2 * height] = float(child)
                    stack[2 * height + 1] = b
                    height += 1
        out[i] = best

"""The lowest of many sizes that each grow with the distance from a piece of a boundary.

A search tree of boxes over the pieces, complete and binary: node k has the children 2 k and
2 k + 1, leaf j holds the pieces j * PER_LEAF and following. Each node knows its box, the lowest
value in it and the widest reach; what it cannot better is not entered.
"""

from __future__ import annotations

from collections import namedtuple
from math import sqrt

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER, pointer, scratch

PER_LEAF = 4

#: Pieces: both ends, value there, distance up to which the value holds; nodes: box, lowest value,
#: widest reach.
Tree = namedtuple("Tree", "piece value reach box low far")


@njit(**HELPER)
def graded(tree, k, growth, x, y):
    """What piece k asks for at (x, y)."""
    ax = tree.piece[4 * k]
    ay = tree.piece[4 * k + 1]
    ux = tree.piece[4 * k + 2] - ax
    uy = tree.piece[4 * k + 3] - ay
    px = x - ax
    py = y - ay
    along = px * ux + py * uy
    length2 = ux * ux + uy * uy
    if along >= length2:
        px -= ux
        py -= uy
        away = sqrt(px * px + py * py)
    elif along <= 0.0:
        away = sqrt(px * px + py * py)
    else:
        away = abs(px * uy - py * ux) / sqrt(length2)
    return tree.value[k] + growth * max(away - tree.reach[k], 0.0)


@njit(**HELPER)
def bound(tree, k, growth, x, y):
    """What no piece below node k can undercut at (x, y)."""
    dx = max(tree.box[4 * k] - x, 0.0, x - tree.box[4 * k + 2])
    dy = max(tree.box[4 * k + 1] - y, 0.0, y - tree.box[4 * k + 3])
    return tree.low[k] + growth * max(sqrt(dx * dx + dy * dy) - tree.far[k], 0.0)


@njit(**HELPER)
def lowest_at(tree, n_leaves, growth, x, y, start, stack):
    """The piece that asks for the least at (x, y), and how much; `start` is a good guess."""
    best = graded(tree, start, growth, x, y)
    which = start
    stack[0] = 1.0
    stack[1] = bound(tree, 1, growth, x, y)
    height = 1
    while height > 0:
        height -= 1
        if stack[2 * height + 1] >= best:
            continue
        k = np.int64(stack[2 * height])
        if k >= n_leaves:
            first = (k - n_leaves) * PER_LEAF
            for i in range(first, first + PER_LEAF):
                h = graded(tree, i, growth, x, y)
                if h < best:
                    best = h
                    which = i
            continue
        left = bound(tree, 2 * k, growth, x, y)
        right = bound(tree, 2 * k + 1, growth, x, y)
        # The more promising child is looked at first, so it goes on top.
        last = 2 * k + (1 if right < left else 0)
        for child in (4 * k + 1 - last, last):
            b = right if child == 2 * k + 1 else left
            if b < best:
                stack[2 * height] = np.float64(child)
                stack[2 * height + 1] = b
                height += 1
    return which, best


@njit(**ENTRY)
def lowest_sources(pieces, values, reaches, boxes, lows, fars, growth, places, found, which):
    """Lowest value found[i] at places[2 i], places[2 i + 1], and the piece that gives it."""
    tree = Tree(
        pointer(pieces),
        pointer(values),
        pointer(reaches),
        pointer(boxes),
        pointer(lows),
        pointer(fars),
    )
    place = pointer(places)
    value = pointer(found)
    piece = pointer(which)
    n_leaves = lows.shape[0] // 2
    stack = scratch(256)
    k = np.int64(0)
    for i in range(found.shape[0]):
        k, h = lowest_at(tree, n_leaves, growth, place[2 * i], place[2 * i + 1], k, stack)
        value[i] = h
        piece[i] = k

"""Number the edges of cells in linear time, and spread marks over them."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..pointers import ENTRY, pointer

#: Rules by which marks spread: divide a cell whole once too many of its edges are halved; or halve
#: a cell's reference edge along with any other.
WHOLE = np.int64(0)
REFERENCE = np.int64(1)


@njit(**ENTRY)
def number_edges(starts, ends, firsts, orders, wheres, stamps, edges, rows):
    """Number the undirected edges of half-edges, by their lower end, then by first appearance.

    `firsts` has room for n + 1 numbers, all 0; `orders` for one a half-edge; `wheres` and `stamps`
    for one a vertex, the stamps -1. Writes the edge of each half-edge and the ends of each edge,
    the lower first; returns how many edges there are.
    """
    start = pointer(starts)
    end = pointer(ends)
    first = pointer(firsts)
    order = pointer(orders)
    where = pointer(wheres)
    stamp = pointer(stamps)
    edge = pointer(edges)
    row = pointer(rows)
    n = firsts.shape[0] - 1
    for h in range(starts.shape[0]):
        first[min(start[h], end[h]) + 1] += 1
    for v in range(n):
        first[v + 1] += first[v]
    for h in range(starts.shape[0]):
        low = min(start[h], end[h])
        order[first[low]] = h
        first[low] += 1
    count = 0
    for i in range(starts.shape[0]):
        h = order[i]
        low = min(start[h], end[h])
        high = max(start[h], end[h])
        if stamp[high] != low:
            stamp[high] = low
            where[high] = count
            row[2 * count] = low
            row[2 * count + 1] = high
            count += 1
        edge[h] = where[high]
    return count


@njit(**ENTRY)
def spread_marks(begins, edges, sides, watches, references, limits, rule, marks, stacks, tops):
    """Mark more edges until every cell keeps the rule; returns whether there is more to do.

    Cell c has half-edges begins[c] to begins[c + 1]; `sides` holds two half-edges an edge, -1 for
    none; `watches` a cell to divide whole when its edge is marked; `references` a half-edge a cell;
    `limits` the number of marked edges that divides it whole. `stacks` holds the edges to look at,
    tops[0] of them; each edge comes there once, when it is marked.
    """
    begin = pointer(begins)
    edge = pointer(edges)
    side = pointer(sides)
    watch = pointer(watches)
    reference = pointer(references)
    limit = pointer(limits)
    mark = pointer(marks)
    stack = pointer(stacks)
    top = tops[0]
    for _ in range(2_000_000):
        if top == 0:
            break
        top -= 1
        e = stack[top]
        for k in range(3):
            c = side[2 * e + k] if k < 2 else watch[e]
            if c < 0:
                continue
            if rule == REFERENCE:
                f = edge[reference[c]]
                if mark[f] == 0:
                    mark[f] = 1
                    stack[top] = f
                    top += 1
                continue
            n = limit[c] if k == 2 else 0
            for h in range(begin[c], begin[c + 1]):
                n += mark[edge[h]]
            if n < limit[c]:
                continue
            for h in range(begin[c], begin[c + 1]):
                f = edge[h]
                if mark[f] == 0:
                    mark[f] = 1
                    stack[top] = f
                    top += 1
    tops[0] = top
    return top > 0


@njit(**ENTRY)
def cells_of_edges(begins, edges, sides):
    """Write the two cells of each edge, -1 before, in the order of the cells."""
    begin = pointer(begins)
    edge = pointer(edges)
    side = pointer(sides)
    for c in range(begins.shape[0] - 1):
        for h in range(begin[c], begin[c + 1]):
            e = edge[h]
            if side[2 * e] < 0:
                side[2 * e] = c
            else:
                side[2 * e + 1] = c

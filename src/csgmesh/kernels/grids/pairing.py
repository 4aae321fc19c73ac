"""Pair triangles into quads: greedily, then along alternating paths."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer

#: Pairs that a path may exchange: a longer one would spoil more than a triangle left over does.
DEEPEST = 5
#: Triangles that a search may look at.
WIDEST = 128


@njit(**HELPER)
def take(edge, degree, k, sign):
    """Note that edge k goes (sign -1), or stays after all (sign 1)."""
    degree[edge[2 * k]] += sign
    degree[edge[2 * k + 1]] += sign


@njit(**HELPER)
def is_spare(edge, degree, least, k):
    """Whether both ends of edge k have more cells than they need."""
    a = edge[2 * k]
    b = edge[2 * k + 1]
    return degree[a] > least[a] and degree[b] > least[b]


@njit(**ENTRY)
def pair_greedily(edges, sides, order, match, degrees, leasts):
    """Go through edges in an order; merge the triangles beside one unless either has a partner.

    `match` is the edge that each triangle lost, -1 before; `degrees` the cells at each vertex, of
    which it needs at least so many.
    """
    edge = pointer(edges)
    side = pointer(sides)
    lost = pointer(match)
    degree = pointer(degrees)
    least = pointer(leasts)
    todo = pointer(order)
    for i in range(order.shape[0]):
        k = todo[i]
        a = side[2 * k]
        b = side[2 * k + 1]
        if lost[a] < 0 and lost[b] < 0 and is_spare(edge, degree, least, k):
            lost[a] = k
            lost[b] = k
            take(edge, degree, k, -1)


@njit(**HELPER)
def exchange(edge, side, lost, degree, least, came, begin, t):
    """Exchange the pairs along the path that ends at free triangle t; False if a vertex needs one.

    came[u] is the edge by which the search came to u, always one that was not lost.
    """
    # Undo all old pairs, take all new ones, then look whether every vertex has enough cells.
    for step in range(3):
        u = t
        good = True
        while True:
            k = came[u]
            before = side[2 * k] if side[2 * k + 1] == u else side[2 * k + 1]
            if step == 0:
                take(edge, degree, k, -1)
            elif step == 1:
                if degree[edge[2 * k]] < least[edge[2 * k]]:
                    good = False
                if degree[edge[2 * k + 1]] < least[edge[2 * k + 1]]:
                    good = False
            else:
                take(edge, degree, k, 1)
            if before == begin:
                break
            old = lost[before]
            if step == 0:
                take(edge, degree, old, 1)
            elif step == 2:
                take(edge, degree, old, -1)
            u = side[2 * old] if side[2 * old + 1] == before else side[2 * old + 1]
        if step == 1 and good:
            break
        if step == 2:
            return False
    u = t
    while True:
        k = came[u]
        before = side[2 * k] if side[2 * k + 1] == u else side[2 * k + 1]
        old = lost[before]
        lost[u] = k
        lost[before] = k
        if before == begin:
            return True
        u = side[2 * old] if side[2 * old + 1] == before else side[2 * old + 1]


@njit(**HELPER)
def search(edge, side, way, lost, degree, least, stamp, came, queue, level, begin, i):
    """Breadth first from a free triangle to another one; True if they could be paired."""
    stamp[begin] = i
    queue[0] = begin
    level[0] = 0
    head = 0
    tail = 1
    while head < tail:
        u = queue[head]
        depth = level[head]
        head += 1
        for e in range(3):
            k = way[3 * u + e]
            if k < 0:
                continue
            w = side[2 * k] if side[2 * k + 1] == u else side[2 * k + 1]
            if stamp[w] == i:
                continue
            if lost[w] < 0:
                came[w] = k
                if exchange(edge, side, lost, degree, least, came, begin, w):
                    return True
                continue
            if depth == DEEPEST or tail == WIDEST:
                continue
            old = lost[w]
            partner = side[2 * old] if side[2 * old + 1] == w else side[2 * old + 1]
            if stamp[partner] == i:
                continue
            stamp[w] = i
            stamp[partner] = i
            came[w] = k
            queue[tail] = partner
            level[tail] = depth + 1
            tail += 1
    return False


@njit(**ENTRY)
def pair_along_paths(edges, sides, ways, match, degrees, leasts, stamps, comes, free, queues):
    """Pair the free triangles of a list with one another along alternating paths; how many paths.

    `ways` are the three edges of each triangle, -1 for those that must stay. `stamps` and `comes`
    are room for a number a triangle, the stamps -1; `queues` for two rows of `WIDEST`.
    """
    edge = pointer(edges)
    side = pointer(sides)
    way = pointer(ways)
    lost = pointer(match)
    degree = pointer(degrees)
    least = pointer(leasts)
    stamp = pointer(stamps)
    came = pointer(comes)
    todo = pointer(free)
    queue = pointer(queues[0])
    level = pointer(queues[1])
    found = 0
    for i in range(free.shape[0]):
        if lost[todo[i]] < 0 and search(
            edge, side, way, lost, degree, least, stamp, came, queue, level, todo[i], i
        ):
            found += 1
    return found

"""Improve a mesh of triangles: raise its smallest angles, or smooth it."""

from __future__ import annotations

from math import hypot

from numba import njit

from .improvement_moves import GAIN, better_place, towards_centre
from .improvement_stars import (
    C_CLOCK,
    C_DONE,
    C_EFFORT,
    C_LIMIT,
    C_LOG,
    C_NEXT,
    C_SWEEPS,
    N_GOAL,
    Arrays,
    after,
    before,
    cotangent,
    first_of_star,
    piece_of,
    triangle_quality,
    worst_of_star,
)
from .improvement_turns import can_turn, is_hopeless, stamp_changes, undo, write_turn
from .pointers import ENTRY, HELPER, pointer

__all__ = ["Arrays", "measure", "pair_half_edges", "smooth_vertices", "treat_triangles"]

#: Vertices moved together at most.
CROWD = 40
#: Vertices tried, or smoothed, between two returns to the caller: some 0.1 s.
SLICE = 50_000


@njit(**HELPER)
def enlist(piece, n, v):
    """Add v to the crowd of n, unless it is there or the crowd is full; its new number."""
    for i in range(n):
        if piece.crowd[i] == v:
            return n
    if n < CROWD:
        piece.crowd[n] = v
        n += 1
    return n


@njit(**HELPER)
def enlist_neighbours(piece, n):
    """Add all neighbours of the crowd of n to it; its new number."""
    m = n
    for i in range(n):
        start = first_of_star(piece, piece.crowd[i])
        h = start
        while True:
            m = enlist(piece, m, piece.origin[after(h)])
            m = enlist(piece, m, piece.origin[before(h)])
            h = piece.twin[before(h)]
            if h < 0 or h == start:
                break
    return m


@njit(**HELPER)
def worst_of_crowd(piece, n):
    """Worst quality of the triangles around the crowd of n."""
    worst = 0.0
    for i in range(n):
        worst = max(worst, worst_of_star(piece, piece.crowd[i]))
    return worst


@njit(**HELPER)
def settle(piece, n):
    """Move each of the crowd of n to a better place, a few times."""
    for _ in range(piece.count[C_SWEEPS]):
        moved = False
        for i in range(n):
            if better_place(piece, piece.crowd[i]):
                moved = True
        if not moved:
            return


@njit(**HELPER)
def try_turn(piece, h):
    """Turn the edge of h and settle its four vertices; undone, and False, unless that helps."""
    if h < 0 or not can_turn(piece, h):
        return False
    g = piece.twin[h]
    n = enlist(piece, 0, piece.origin[h])
    n = enlist(piece, n, piece.origin[g])
    n = enlist(piece, n, piece.origin[before(h)])
    n = enlist(piece, n, piece.origin[before(g)])
    now = worst_of_crowd(piece, n)
    height = piece.count[C_LOG]
    write_turn(piece, h)
    settle(piece, n)
    if worst_of_crowd(piece, n) > now - GAIN:
        undo(piece, height)
        return False
    return True


@njit(**HELPER)
def enlist_triangle(piece, t):
    """Make the corners of a triangle the crowd; their number."""
    piece.crowd[0] = piece.origin[t]
    piece.crowd[1] = piece.origin[t + 1]
    piece.crowd[2] = piece.origin[t + 2]
    return 3


@njit(**HELPER)
def try_crowd(piece, t):
    """Settle all vertices near a triangle; undone, and False, unless the triangle gains."""
    n = enlist_neighbours(piece, enlist_triangle(piece, t))
    now = triangle_quality(piece, t)
    height = piece.count[C_LOG]
    settle(piece, n)
    if triangle_quality(piece, t) > now - GAIN:
        undo(piece, height)
        return False
    return True


@njit(**HELPER)
def treat(piece, t):
    """Do what can be done for triangle t, the cheapest first; whether anything helped.

    No step worsens the worst triangle around the vertices that it moves.
    """
    start = triangle_quality(piece, t)
    settle(piece, enlist_triangle(piece, t))
    now = triangle_quality(piece, t)
    if now <= piece.number[N_GOAL]:
        return True
    for e in range(3):
        if try_turn(piece, t + e):
            return True
    if try_crowd(piece, t):
        return True
    for e in range(6):
        g = piece.twin[t + e % 3]
        if g >= 0 and try_turn(piece, after(g) if e < 3 else before(g)):
            return True
    return now < start


@njit(**ENTRY)
def treat_triangles(arrays, triangles):
    """Treat the triangles of a list in turn, from count[C_NEXT] on, until it or the effort ends.

    Returns whether there is more to do.
    """
    piece = piece_of(arrays)
    todo = pointer(triangles)
    count = piece.count
    pause = min(count[C_EFFORT] + SLICE, count[C_LIMIT])
    while count[C_NEXT] < triangles.shape[0] and count[C_EFFORT] < pause:
        t = 3 * todo[count[C_NEXT]]
        count[C_NEXT] += 1
        if triangle_quality(piece, t) <= piece.number[N_GOAL] or is_hopeless(piece, t):
            continue
        count[C_CLOCK] += 1
        if treat(piece, t):
            count[C_DONE] += 1
        stamp_changes(piece)
        if triangle_quality(piece, t) > piece.number[N_GOAL]:
            piece.failed[t // 3] = count[C_CLOCK]
    return count[C_NEXT] < triangles.shape[0] and count[C_EFFORT] < count[C_LIMIT]


@njit(**ENTRY)
def smooth_vertices(arrays, optimal):
    """Move vertices to the centres of their stars, from count[C_NEXT] on; whether there are more.

    `optimal` is 1 for the centre of ODT, 0 for the mean of the neighbours.
    """
    piece = piece_of(arrays)
    count = piece.count
    n = arrays.kind.shape[0]
    pause = min(count[C_NEXT] + SLICE, n)
    while count[C_NEXT] < pause:
        if piece.edge_of[count[C_NEXT]] >= 0 and towards_centre(piece, count[C_NEXT], optimal):
            count[C_DONE] += 1
        count[C_NEXT] += 1
    return count[C_NEXT] < n


@njit(**ENTRY)
def pair_half_edges(origins, twins, edges_of, links, facets, lines):
    """Fill twins, a half-edge from each vertex, and the facet of each half-edge; all -1 before.

    `links` is room for a link a half-edge.
    """
    origin = pointer(origins)
    twin = pointer(twins)
    edge_of = pointer(edges_of)
    link = pointer(links)
    facet = pointer(facets)
    line = pointer(lines)
    for h in range(origins.shape[0]):
        v = origin[h]
        link[h] = edge_of[v]
        edge_of[v] = h
    for h in range(origins.shape[0]):
        v = origin[h]
        g = edge_of[origin[after(h)]] if twin[h] < 0 else twin[h]
        while twin[h] < 0 and g >= 0:
            if origin[after(g)] == v:
                twin[h] = g
                twin[g] = h
            g = link[g]
    for k in range(facets.shape[0]):
        h = edge_of[facet[k]]
        while h >= 0:
            if origin[after(h)] == facet[k ^ 1]:
                line[h] = k // 2
            h = link[h]


@njit(**ENTRY)
def measure(points, origins, qualities, lengths, degrees):
    """Cotangent of each triangle's smallest angle; sum and number of edge lengths at each vertex.

    An edge counts once for each of its triangles.
    """
    xy = pointer(points)
    origin = pointer(origins)
    quality = pointer(qualities)
    length = pointer(lengths)
    degree = pointer(degrees)
    for h in range(0, origins.shape[0], 3):
        for e in range(3):
            a = origin[h + e]
            b = origin[after(h + e)]
            d = hypot(xy[2 * a] - xy[2 * b], xy[2 * a + 1] - xy[2 * b + 1])
            length[a] += d
            length[b] += d
            degree[a] += 1
            degree[b] += 1
        a = 2 * origin[h]
        b = 2 * origin[h + 1]
        c = 2 * origin[h + 2]
        quality[h // 3] = cotangent(xy[a], xy[a + 1], xy[b], xy[b + 1], xy[c], xy[c + 1])

"""Turn edges, and undo what did not help."""

from __future__ import annotations

from numba import njit

from .improvement_moves import MOVED, TURNED, take_back_move
from .improvement_stars import C_CLOCK, C_LOG, after, before
from .pointers import HELPER
from .predicates import orient2d


@njit(**HELPER)
def orient(piece, a, b, c):
    xy = piece.xy
    return orient2d(xy[2 * a], xy[2 * a + 1], xy[2 * b], xy[2 * b + 1], xy[2 * c], xy[2 * c + 1])


@njit(**HELPER)
def hook(piece, h, g, facet):
    """Make h and g, which may be none, the two sides of an edge that is this facet or none."""
    piece.twin[h] = g
    piece.line[h] = facet
    if g >= 0:
        piece.twin[g] = h


@njit(**HELPER)
def turn(piece, h):
    """Turn the edge of h between the corners opposite it; done twice, it is as before."""
    g = piece.twin[h]
    ha = after(h)
    hb = before(h)
    ga = after(g)
    gb = before(g)
    u = piece.origin[h]
    w = piece.origin[g]
    n = piece.origin[hb]
    o = piece.origin[gb]
    wn = piece.twin[ha]
    nu = piece.twin[hb]
    uo = piece.twin[ga]
    ow = piece.twin[gb]
    wn_line = piece.line[ha]
    nu_line = piece.line[hb]
    uo_line = piece.line[ga]
    ow_line = piece.line[gb]
    # The triangle of h becomes o n u, that of g becomes n o w.
    piece.origin[h] = o
    piece.origin[ha] = n
    piece.origin[hb] = u
    piece.origin[g] = n
    piece.origin[ga] = o
    piece.origin[gb] = w
    hook(piece, ha, nu, nu_line)
    hook(piece, hb, uo, uo_line)
    hook(piece, ga, ow, ow_line)
    hook(piece, gb, wn, wn_line)
    piece.edge_of[u] = hb
    piece.edge_of[w] = gb
    piece.edge_of[n] = ha
    piece.edge_of[o] = ga


@njit(**HELPER)
def can_turn(piece, h):
    """Whether the edge of h is no facet and its two triangles make a strictly convex quad."""
    g = piece.twin[h]
    if g < 0 or piece.line[h] >= 0 or piece.region[h // 3] != piece.region[g // 3]:
        return False
    u = piece.origin[h]
    w = piece.origin[g]
    n = piece.origin[before(h)]
    o = piece.origin[before(g)]
    return orient(piece, o, n, u) > 0.0 and orient(piece, n, o, w) > 0.0


@njit(**HELPER)
def write_turn(piece, h):
    """Log the turn of an edge, and do it."""
    n = piece.count[C_LOG]
    piece.log[2 * n] = TURNED
    piece.log[2 * n + 1] = h
    piece.count[C_LOG] = n + 1
    turn(piece, h)


@njit(**HELPER)
def undo(piece, height):
    """Undo what was logged beyond this height."""
    while piece.count[C_LOG] > height:
        n = piece.count[C_LOG] - 1
        piece.count[C_LOG] = n
        if piece.log[2 * n] == MOVED:
            take_back_move(piece, n)
        else:
            turn(piece, piece.log[2 * n + 1])


@njit(**HELPER)
def stamp_changes(piece):
    """Mark the vertices around what the log says was done, and close the log."""
    now = piece.count[C_CLOCK]
    for i in range(piece.count[C_LOG]):
        v = piece.log[2 * i + 1]
        if piece.log[2 * i] == MOVED:
            piece.stamp[v] = now
        else:
            piece.stamp[piece.origin[v]] = now
            piece.stamp[piece.origin[after(v)]] = now
            piece.stamp[piece.origin[before(v)]] = now
    piece.count[C_LOG] = 0


@njit(**HELPER)
def is_hopeless(piece, t):
    """Whether the triangle of half-edge t was treated in vain and nothing near changed since."""
    then = piece.failed[t // 3]
    if then < 0:
        return False
    for e in range(3):
        if piece.stamp[piece.origin[t + e]] > then:
            return False
        g = piece.twin[t + e]
        if g >= 0 and piece.stamp[piece.origin[before(g)]] > then:
            return False
    return True

"""Write the children of cells by templates."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, pointer


@njit(**ENTRY)
def write_children(cells, edges, mids, centres, codes, firsts, nodes, w, k, begins, out):
    """Children with k corners of cells with w, by the template of each cell's code.

    A template's rows are firsts[code] to firsts[code + 1] of `nodes`, k numbers each: j < w is the
    cell's corner j, w + j the middle of its edge j, 2 w its centre. The children of cell c stand
    from row begins[c] on.
    """
    cell = pointer(cells)
    edge = pointer(edges)
    mid = pointer(mids)
    centre = pointer(centres)
    code = pointer(codes)
    first = pointer(firsts)
    node = pointer(nodes)
    begin = pointer(begins)
    row = pointer(out)
    for c in range(codes.shape[0]):
        at = k * begin[c]
        for i in range(k * first[code[c]], k * first[code[c] + 1]):
            j = node[i]
            if j < w:
                row[at] = cell[w * c + j]
            elif j < 2 * w:
                row[at] = mid[edge[w * c + j - w]]
            else:
                row[at] = centre[c]
            at += 1


@njit(**ENTRY)
def halve(points, ends, out):
    """Middles of pairs of points."""
    xy = pointer(points)
    end = pointer(ends)
    middle = pointer(out)
    for e in range(out.shape[0] // 2):
        a = 2 * end[2 * e]
        b = 2 * end[2 * e + 1]
        middle[2 * e] = 0.5 * (xy[a] + xy[b])
        middle[2 * e + 1] = 0.5 * (xy[a + 1] + xy[b + 1])

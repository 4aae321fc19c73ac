"""Points and cells of one block of a structured grid."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, pointer


@njit(**ENTRY)
def fill_block(bottom, right, top, left, bottoms, rights, tops, lefts, points, begin, end):
    """Points of the columns begin to end - 1 inside a block, by transfinite interpolation.

    `bottoms` and so on are shares of the sides' arc lengths; where lines between equal shares of
    opposite sides cross, there a point is interpolated (Soni 1985).
    """
    b, r, t, f = pointer(bottom), pointer(right), pointer(top), pointer(left)
    sb, sr, st, sf = pointer(bottoms), pointer(rights), pointer(tops), pointer(lefts)
    xy = pointer(points)
    ni = bottoms.shape[0] - 1
    nj = lefts.shape[0] - 1
    for i in range(begin, end):
        at = 2 * (i - 1) * (nj - 1)
        slope = st[i] - sb[i]
        for j in range(1, nj):
            rise = sr[j] - sf[j]
            scale = 1.0 / (1.0 - slope * rise)
            u = (sb[i] + sf[j] * slope) * scale
            v = (sf[j] + sb[i] * rise) * scale
            for k in range(2):
                corners = (1.0 - u) * ((1.0 - v) * b[k] + v * t[k])
                corners += u * ((1.0 - v) * b[2 * ni + k] + v * t[2 * ni + k])
                across = (1.0 - u) * f[2 * j + k] + u * r[2 * j + k]
                xy[at + k] = across + (1.0 - v) * b[2 * i + k] + v * t[2 * i + k] - corners
            at += 2


@njit(**ENTRY)
def connect_block(numbers, points, cells, begin, end):
    """Corners of the cells of columns begin to end - 1; the first that is not convex, or -1."""
    number = pointer(numbers)
    xy = pointer(points)
    cell = pointer(cells)
    nj = numbers.shape[1] - 1
    folded = -1
    for i in range(begin, end):
        for j in range(nj):
            c = 4 * (i * nj + j)
            a = i * (nj + 1) + j
            cell[c] = number[a]
            cell[c + 1] = number[a + nj + 1]
            cell[c + 2] = number[a + nj + 2]
            cell[c + 3] = number[a + 1]
            for k in range(4):
                p = 2 * cell[c + k]
                q = 2 * cell[c + ((k + 1) & 3)]
                s = 2 * cell[c + ((k + 2) & 3)]
                ux = xy[q] - xy[p]
                uy = xy[q + 1] - xy[p + 1]
                if not ux * (xy[s + 1] - xy[q + 1]) - uy * (xy[s] - xy[q]) > 0.0 and folded < 0:
                    folded = c // 4
    return folded

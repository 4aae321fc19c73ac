"""How a cell is divided, for each set of its edges that are halved.

Local numbers of a cell with w corners: j < w is corner j, w + j the middle of the edge from corner
j to the next, 2 w the centre. Edges are a bit mask.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Rows = list[tuple[int, ...]]


@dataclass(frozen=True, eq=False)
class Template:
    """Children of cells with `width` corners, by code.

    Attributes
    ----------
    width : int
    triangles, quads : (first, nodes)
        The rows first[code] to first[code + 1] of nodes (r, 3 or 4) are the children.
    """

    width: int
    triangles: tuple[np.ndarray, np.ndarray]
    quads: tuple[np.ndarray, np.ndarray]

    def counts(self, kind: str) -> np.ndarray:
        """Number of children of a kind for each code."""
        return np.diff((self.triangles if kind == "triangle" else self.quads)[0])

    def rows(self, kind: str) -> tuple[np.ndarray, np.ndarray]:
        """First row of each code, and the rows."""
        return self.triangles if kind == "triangle" else self.quads


def _turned(rows: Rows, by: int, width: int) -> Rows:
    """Rows with every corner and every edge `by` further on."""
    return [
        tuple(n if n == 2 * width else (n + by) % width + width * (n // width) for n in row)
        for row in rows
    ]


def _table(rows_of_code: list[Rows], k: int) -> tuple[np.ndarray, np.ndarray]:
    first = np.cumsum([0, *(len(rows) for rows in rows_of_code)])
    nodes = [node for rows in rows_of_code for row in rows for node in row]
    return first, np.array(nodes, np.int64).reshape(-1, k)


def _template(width: int, rows_of_code: list[Rows]) -> Template:
    parts = {k: [[r for r in rows if len(r) == k] for rows in rows_of_code] for k in (3, 4)}
    return Template(width, _table(parts[3], 3), _table(parts[4], 4))


#: A triangle cut into two from corner 2; the new vertex comes last.
_HALVES: Rows = [(2, 0, 3), (1, 2, 3)]
_INSCRIBED: Rows = [(0, 3, 5), (3, 1, 4), (5, 4, 2), (4, 5, 3)]
_QUARTERS: Rows = [(0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)]
_ONE_SIDE: Rows = [(0, 4, 3), (4, 1, 2), (4, 2, 3)]
_OPPOSITE: Rows = [(0, 4, 6, 3), (4, 1, 2, 6)]
_ADJACENT: Rows = [(4, 1, 5), (0, 4, 3), (4, 5, 3), (5, 2, 3)]


def _red_green_triangle() -> Template:
    codes: list[Rows] = [[] for _ in range(8)]
    codes[0] = [(0, 1, 2)]
    for j in range(3):
        codes[1 << j] = _turned(_HALVES, j, 3)
    codes[7] = _INSCRIBED
    return _template(3, codes)


def _red_green_quad() -> Template:
    codes: list[Rows] = [[] for _ in range(16)]
    codes[0] = [(0, 1, 2, 3)]
    for j in range(4):
        codes[1 << j] = _turned(_ONE_SIDE, j, 4)
        codes[1 << j | 1 << (j + 1) % 4] = _turned(_ADJACENT, j, 4)
    for j in range(2):
        codes[5 << j] = _turned(_OPPOSITE, j, 4)
    codes[15] = _QUARTERS
    return _template(4, codes)


def _bisection() -> Template:
    """Code 8 r + mask: halved at the reference edge r first, then at the other two.

    Each child's first edge lies opposite its newest vertex.
    """
    codes: list[Rows] = [[] for _ in range(24)]
    for r in range(3):
        for mask in range(8):
            rows: Rows = [(0, 1, 2)]
            if mask >> r & 1:
                # As if r were edge 0: the others are edges 1 and 2 of the turned triangle.
                left, right = mask >> (r + 2) % 3 & 1, mask >> (r + 1) % 3 & 1
                rows = [(3, 2, 5), (0, 3, 5)] if left else [(2, 0, 3)]
                rows = rows + ([(3, 1, 4), (2, 3, 4)] if right else [(1, 2, 3)])
            elif mask:
                rows = []
            codes[8 * r + mask] = _turned(rows, r, 3)
    return _template(3, codes)


RED_GREEN = {"triangle": _red_green_triangle(), "quad": _red_green_quad()}
BISECTION = {"triangle": _bisection()}

"""How cells and facets of space are divided into eight and four.

The nodes of a cell that is divided: its corners, the middles of its edges, the centres of its
quadrilateral faces, both in the order of `Kind`, and the centre of a hexahedron.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

Children = Mapping[str, np.ndarray]

#: A tetrahedron's inner octahedron is cut along the diagonal between the middles of edges 0-2 and
#: 1-3. Children are numbered as by Bey, but for those that would be turned over: in them corners 0
#: and 2 change places, which leaves the pairs 0-2 and 1-3 what they are, and so all descendants.
_TETRA = np.array(
    [
        *((0, 4, 6, 7), (4, 1, 5, 8), (6, 5, 2, 9), (7, 8, 9, 3)),
        *((4, 6, 7, 8), (5, 6, 4, 8), (6, 7, 8, 9), (8, 5, 6, 9)),
    ]
)
_HEXAHEDRON = np.array(
    [
        *((0, 8, 20, 11, 16, 22, 26, 25), (8, 1, 9, 20, 22, 17, 23, 26)),
        *((20, 9, 2, 10, 26, 23, 18, 24), (11, 20, 10, 3, 25, 26, 24, 19)),
        *((16, 22, 26, 25, 4, 12, 21, 15), (22, 17, 23, 26, 12, 5, 13, 21)),
        *((26, 23, 18, 24, 21, 13, 6, 14), (25, 26, 24, 19, 15, 21, 14, 7)),
    ]
)
_WEDGE = np.array(
    [
        *((0, 6, 8, 12, 15, 17), (6, 1, 7, 15, 13, 16), (8, 7, 2, 17, 16, 14)),
        (6, 7, 8, 15, 16, 17),
        *((12, 15, 17, 3, 9, 11), (15, 13, 16, 9, 4, 10), (17, 16, 14, 11, 10, 5)),
        (15, 16, 17, 9, 10, 11),
    ]
)
_PYRAMID = np.array(
    [
        *((0, 5, 13, 8, 9), (1, 6, 13, 5, 10), (2, 7, 13, 6, 11), (3, 8, 13, 7, 12)),
        *((9, 10, 11, 12, 4), (12, 11, 10, 9, 13)),
    ]
)
#: Between a pyramid's children, one at each side of its base.
_BETWEEN = np.array([(5, 13, 9, 10), (6, 13, 10, 11), (7, 13, 11, 12), (8, 13, 12, 9)])

#: Children by kind of the cells of each kind.
CELLS: Mapping[str, Children] = {
    "tetra": {"tetra": _TETRA},
    "hexahedron": {"hexahedron": _HEXAHEDRON},
    "wedge": {"wedge": _WEDGE},
    "pyramid": {"pyramid": _PYRAMID, "tetra": _BETWEEN},
}

#: Nodes of a facet: corners, middles of its edges, and the centre of a quad.
FACETS: Mapping[str, np.ndarray] = {
    "triangle": np.array([(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)]),
    "quad": np.array([(0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)]),
}

#: Even permutations that bring each pair of opposite edges, 0-2 and 1-3, 0-1 and 2-3, 0-3 and 1-2,
#: to the first of these.
TURNS = np.array([(0, 1, 2, 3), (0, 3, 1, 2), (0, 2, 3, 1)])


def shortest_diagonals_first(points: np.ndarray, tetra: np.ndarray) -> np.ndarray:
    """Corners of tetrahedra (m, 4) turned so that each is cut along its shortest diagonal.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 3]])
    >>> shortest_diagonals_first(points, np.array([[0, 1, 2, 3]])).tolist()
    [[0, 2, 3, 1]]
    """
    p = points[tetra]
    # Twice the vector between the middles of opposite edges.
    diagonals = np.stack(
        [p[:, 0] + p[:, b] - p[:, c] - p[:, d] for b, c, d in ((2, 1, 3), (1, 2, 3), (3, 1, 2))],
        axis=1,
    )
    shortest = (diagonals**2).sum(axis=2).argmin(axis=1)
    return np.take_along_axis(tetra, TURNS[shortest], axis=1)

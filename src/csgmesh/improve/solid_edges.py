"""Edges and quadrilateral faces of cells in space, numbered in linear time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from csgmesh.improve.cell_edges import number_pairs
from csgmesh.mesh import KINDS

Arrays = Mapping[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class SolidEdges:
    """The edges and quadrilateral faces of straight cells and facets in space.

    Attributes
    ----------
    ends : (e, 2) int64
        End points of the edges, the lower number first.
    cell_edges, facet_edges : dict of str to (m, k) int64
        By kind the edges of each cell or facet, in the order of ``KINDS[kind].edges``.
    quads : (q, 4) int64
        Corners of the quadrilateral faces, in circular order.
    quad_edges : (q, 4) int64
        Their edges.
    cell_quads, facet_quads : dict of str to (m, k) int64
        By kind the quadrilateral faces of each cell, in the order of ``KINDS[kind].facets``; of
        each facet the one that it is. No columns where there are none.
    """

    ends: np.ndarray
    cell_edges: dict[str, np.ndarray]
    facet_edges: dict[str, np.ndarray]
    quads: np.ndarray
    quad_edges: np.ndarray
    cell_quads: dict[str, np.ndarray]
    facet_quads: dict[str, np.ndarray]

    @staticmethod
    def of(cells: Arrays, facets: Arrays, n_points: int) -> SolidEdges:
        """Number the edges and faces of cells and facets of first order.

        Examples
        --------
        >>> edges = SolidEdges.of({"tetra": np.array([[0, 1, 2, 3]])}, {}, 4)
        >>> edges.ends.tolist(), edges.cell_edges["tetra"].tolist()
        ([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]], [[0, 3, 1, 2, 4, 5]])
        """
        blocks = [*cells.items(), *facets.items()]
        pairs = [_table(rows, KINDS[kind].edges, 2) for kind, rows in blocks]
        start, end = np.concatenate([np.zeros((0, 2), np.int64), *pairs]).T
        number, ends = number_pairs(start, end, n_points)
        edge_of = _cut(number, [(len(rows), len(KINDS[kind].edges)) for kind, rows in blocks])
        rings = [_table(rows, quad_faces(kind), 4) for kind, rows in blocks]
        corners = np.concatenate([np.zeros((0, 4), np.int64), *rings])
        sides = [
            _table(own, _sides(kind), 4) for (kind, _), own in zip(blocks, edge_of, strict=True)
        ]
        number, first = _number_quads(corners, n_points)
        quad_of = _cut(number, [(len(rows), len(quad_faces(kind))) for kind, rows in blocks])
        n = len(cells)
        return SolidEdges(
            ends,
            dict(zip(cells, edge_of[:n], strict=True)),
            dict(zip(facets, edge_of[n:], strict=True)),
            corners[first],
            np.concatenate([np.zeros((0, 4), np.int64), *sides])[first],
            dict(zip(cells, quad_of[:n], strict=True)),
            dict(zip(facets, quad_of[n:], strict=True)),
        )

    @property
    def n_edges(self) -> int:
        """Number of edges."""
        return len(self.ends)

    @property
    def n_quads(self) -> int:
        """Number of quadrilateral faces."""
        return len(self.quads)


def quad_faces(kind: str) -> tuple[tuple[int, ...], ...]:
    """Corners of the quadrilateral faces of a cell, or of the facet itself.

    Examples
    --------
    >>> quad_faces("pyramid"), quad_faces("quad"), quad_faces("triangle")
    (((0, 3, 2, 1),), ((0, 1, 2, 3),), ())
    """
    data = KINDS[kind]
    if data.dim == 2:
        return ((0, 1, 2, 3),) if data.n_corners == 4 else ()
    return tuple(face for face in data.facets if len(face) == 4)


def _sides(kind: str) -> tuple[tuple[int, ...], ...]:
    """Edges of the quadrilateral faces of a cell, or of the facet itself."""
    number = {frozenset(edge): k for k, edge in enumerate(KINDS[kind].edges)}
    return tuple(
        tuple(number[frozenset((face[k - 1], face[k]))] for k in range(4))
        for face in quad_faces(kind)
    )


def _table(rows: np.ndarray, parts: tuple[tuple[int, ...], ...], width: int) -> np.ndarray:
    if not parts:
        return np.zeros((0, width), np.int64)
    return rows[:, np.array(parts)].reshape(-1, width)


def _cut(numbers: np.ndarray, shapes: list[tuple[int, int]]) -> list[np.ndarray]:
    out, first = [], 0
    for m, k in shapes:
        out.append(numbers[first : first + m * k].reshape(m, k))
        first += m * k
    return out


def _number_quads(corners: np.ndarray, n_points: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of quadrilaterals (k, 4), and the first of each number.

    A quadrilateral is the pair of its diagonals, however it is turned or mirrored.
    """
    k = len(corners)
    start, end = np.concatenate([corners[:, [0, 2]], corners[:, [1, 3]]]).T
    diagonal, _ = number_pairs(start, end, n_points)
    number, pairs = number_pairs(diagonal[:k], diagonal[k:], 2 * k)
    first = np.full(len(pairs), k)
    np.minimum.at(first, number, np.arange(k))
    return number, first

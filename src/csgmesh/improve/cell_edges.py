"""Cells of a plane mesh with their edges numbered, in linear time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from csgmesh import kernels


def number_pairs(start: np.ndarray, end: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Number unordered pairs of numbers below n, by their lower one, then by first appearance.

    Returns
    -------
    number : (k,) int64
        Of each pair.
    ends : (p, 2) int64
        The different pairs, the lower number first.

    Examples
    --------
    >>> number_pairs(np.array([1, 2, 0]), np.array([2, 1, 2]), 3)
    (array([1, 1, 0]), array([[0, 2],
           [1, 2]]))
    """
    number = np.empty(len(start), np.int64)
    ends = np.empty((len(start), 2), np.int64)
    found = kernels.number_edges(
        np.ascontiguousarray(start),
        np.ascontiguousarray(end),
        np.zeros(n + 1, np.int64),
        np.empty(len(start), np.int32),
        np.empty(n, np.int32),
        np.full(n, -1, np.int32),
        number,
        ends.reshape(-1),
    )
    return number, ends[:found]


@dataclass(frozen=True, eq=False)
class CellEdges:
    """The edges of blocks of cells and of facets.

    Attributes
    ----------
    begin : (c + 1,) int64
        First half-edge of each cell, counted through all blocks.
    edge : (h,) int64
        Edge of each half-edge of the cells.
    facet_edge : (f,) int64
        Edge of each facet.
    ends : (e, 2) int64
        End points, the lower number first.
    """

    begin: np.ndarray
    edge: np.ndarray
    facet_edge: np.ndarray
    ends: np.ndarray

    @staticmethod
    def of(blocks: Sequence[np.ndarray], facets: np.ndarray, n_points: int) -> CellEdges:
        """Number the edges of blocks of cells, (m, 3) or (m, 4), and of facets, (f, 2)."""
        start = np.concatenate([*(rows.ravel() for rows in blocks), facets[:, 0]])
        turned = [rows[:, [*range(1, rows.shape[1]), 0]].ravel() for rows in blocks]
        end = np.concatenate([*turned, facets[:, 1]])
        edge, ends = number_pairs(start, end, n_points)
        widths = [np.full(len(rows), rows.shape[1]) for rows in blocks]
        begin = np.cumsum(np.concatenate([[0], *widths]))
        return CellEdges(begin, edge[: begin[-1]], edge[begin[-1] :], ends)

    @property
    def n_edges(self) -> int:
        """Number of edges."""
        return len(self.ends)

    def of_block(self, first: int, rows: np.ndarray) -> np.ndarray:
        """Edge numbers of a block of cells, (m, w), whose first cell has number `first`."""
        at = self.begin[first]
        return self.edge[at : at + rows.size].reshape(rows.shape)

    def find(self, pairs: np.ndarray) -> np.ndarray:
        """Edge numbers of pairs of points in either order, (k,); each must be an edge."""
        low, high = pairs.min(axis=1), pairs.max(axis=1)
        # Edges are sorted by their lower ends.
        first = np.searchsorted(self.ends[:, 0], low, side="left")
        count = np.searchsorted(self.ends[:, 0], low, side="right") - first
        pair = np.repeat(np.arange(len(pairs)), count)
        edge = np.arange(len(pair)) + np.repeat(first - (np.cumsum(count) - count), count)
        hit = self.ends[edge, 1] == high[pair]
        out = np.full(len(pairs), -1)
        out[pair[hit]] = edge[hit]
        return out

    def spread(
        self,
        mark: np.ndarray,
        limit: np.ndarray,
        reference: np.ndarray | None = None,
        watch: np.ndarray | None = None,
    ) -> None:
        """Mark more edges until every cell keeps the rule of its method.

        Parameters
        ----------
        mark : (e,) int8
            Marked edges, completed in place.
        limit : (c,) int64
            As many marked edges have a cell divided whole.
        reference : (c,) int64, optional
            A half-edge a cell, which is halved along with any other; then nothing is divided whole.
        watch : (e,) int64, optional
            A cell that is divided whole once this edge is marked; -1 for none.
        """
        none = np.full(self.n_edges, -1)
        side = np.full(2 * self.n_edges, -1)
        kernels.cells_of_edges(self.begin, self.edge, side)
        stack = np.empty(self.n_edges, np.int64)
        marked = np.flatnonzero(mark)
        stack[: len(marked)] = marked
        rule = 0 if reference is None else 1
        reference = none[:1] if reference is None else reference
        watch = none if watch is None else watch
        arrays = (self.begin, self.edge, side, watch, reference, limit)
        top = np.array([len(marked)])
        while kernels.spread_marks(*arrays, rule, mark, stack, top):
            pass

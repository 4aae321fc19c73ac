"""Which cells lie on the two sides of an edge.

A cell that runs counterclockwise has itself on the left of each of its directed edges, so an edge
(a, b) is looked up as the key ``a * n + b``: the owner of the key is on its left, the owner of the
reversed key on its right. No coordinates are involved.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from csgmesh.mesh import KINDS


@dataclass(frozen=True)
class DirectedEdges:
    """All directed edges of plane cells, sorted by key.

    Attributes
    ----------
    n_points : int
        Factor of the keys.
    keys : (k,) int64
        Sorted.
    cell : (k,) int64
        The cell of each, counted through all kinds.
    region : (k,) int64
        The region of that cell.
    rows : dict of str to (k, 2 or 3) int64
        By kind of edge, all edges of cells in the order of the cells; mid-side points included.
    """

    n_points: int
    keys: np.ndarray
    cell: np.ndarray
    region: np.ndarray
    rows: Mapping[str, np.ndarray]

    def owner(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Positions in `keys` of the directed edges, -1 where no cell has them."""
        if not len(self.keys):
            return np.full(len(start), -1)
        wanted = start * self.n_points + end
        at = np.minimum(np.searchsorted(self.keys, wanted), len(self.keys) - 1)
        return np.where(self.keys[at] == wanted, at, -1)

    def cells_beside(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Cells on the left and on the right of edges, -1 where there is none."""
        left, right = self.owner(rows[:, 0], rows[:, 1]), self.owner(rows[:, 1], rows[:, 0])
        return _value(self.cell, left), _value(self.cell, right)

    def sides(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Edges turned as a mesh wants them, their two regions, and whether any cell has them.

        A mesh wants the domain on the left of an outer edge and the region of lower number on the
        left of an interface; an edge within one region keeps its direction.
        """
        left = _value(self.region, self.owner(rows[:, 0], rows[:, 1]))
        right = _value(self.region, self.owner(rows[:, 1], rows[:, 0]))
        turn = (left < 0) | ((right >= 0) & (right < left))
        rows = rows.copy()
        rows[turn, :2] = rows[turn, 1::-1]
        rows[turn, 2:] = rows[turn, 2:][:, ::-1]
        region = np.stack([np.where(turn, right, left), np.where(turn, left, right)], axis=1)
        return rows, region, region[:, 0] >= 0


def oriented_edges(
    cells: Mapping[str, np.ndarray], regions: Mapping[str, np.ndarray], n_points: int
) -> DirectedEdges:
    """The directed edges of plane cells."""
    rows: dict[str, list[np.ndarray]] = {}
    keys, owners, owner_regions, before = [], [], [], 0
    for kind, connectivity in cells.items():
        local = np.array(KINDS[kind].facets)
        edges = connectivity[:, local].reshape(-1, local.shape[1])
        rows.setdefault(KINDS[kind].facet_kinds[0], []).append(edges)
        keys.append(edges[:, 0] * n_points + edges[:, 1])
        owners.append(np.repeat(np.arange(before, before + len(connectivity)), len(local)))
        owner_regions.append(np.repeat(regions[kind], len(local)))
        before += len(connectivity)
    key = np.concatenate([np.zeros(0, np.int64), *keys])
    order = np.argsort(key, kind="stable")
    return DirectedEdges(
        n_points,
        key[order],
        np.concatenate([np.zeros(0, np.int64), *owners])[order],
        np.concatenate([np.zeros(0, np.int64), *owner_regions])[order],
        {kind: np.concatenate(parts) for kind, parts in rows.items()},
    )


def missing_edges(
    edges: DirectedEdges, facets: np.ndarray, kind: str
) -> tuple[np.ndarray, np.ndarray]:
    """Edges with different regions on their sides that are not among `facets`, and the regions."""
    rows = edges.rows.get(kind, np.zeros((0, facets.shape[1]), np.int64))
    n = edges.n_points
    order = np.argsort(rows[:, 0] * n + rows[:, 1], kind="stable")
    rows = rows[order]
    left = _value(edges.region, edges.owner(rows[:, 0], rows[:, 1]))
    right = _value(edges.region, edges.owner(rows[:, 1], rows[:, 0]))
    wanted = (right < 0) | ((left >= 0) & (left < right))
    known = np.sort(facets[:, :2], axis=1)
    ends = np.sort(rows[:, :2], axis=1)
    is_known = np.isin(ends[:, 0] * n + ends[:, 1], known[:, 0] * n + known[:, 1])
    chosen = wanted & ~is_known
    return rows[chosen], np.stack([left[chosen], right[chosen]], axis=1)


def _value(of: np.ndarray, at: np.ndarray) -> np.ndarray:
    return np.where(at < 0, -1, of[at]) if len(of) else np.full(len(at), -1)

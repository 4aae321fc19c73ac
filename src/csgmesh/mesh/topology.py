"""Edges, incidences and numbers of a plane complex. Coordinates are never looked at.

Cells are counted through all kinds in the order of the mapping; only their corners count. The
half-edges of a cell run counterclockwise around it, and stand cell by cell, kind by kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from csgmesh import graphs
from csgmesh.mesh.kinds import KINDS


@dataclass(frozen=True, eq=False)
class Edges:
    """The edges of a plane complex.

    Attributes
    ----------
    points : (e, 2) int64
        End points, the lower number first; rows sorted.
    left, right : (e,) int64
        A cell that runs along the edge forwards, and one that runs backwards; -1 for none.
    n_left, n_right : (e,) int64
        How many such cells there are; at most one in a conforming mesh.
    half_edges : (h, 2) int64
        Start and end of each half-edge.
    half_edge_cell : (h,) int64
    half_edge_edge : (h,) int64
    n_points, n_cells : int
    """

    points: np.ndarray
    left: np.ndarray
    right: np.ndarray
    n_left: np.ndarray
    n_right: np.ndarray
    half_edges: np.ndarray
    half_edge_cell: np.ndarray
    half_edge_edge: np.ndarray
    n_points: int
    n_cells: int

    @property
    def count(self) -> np.ndarray:
        """Number of cells at each edge, (e,)."""
        return self.n_left + self.n_right

    @property
    def sides(self) -> tuple[np.ndarray, np.ndarray]:
        """`left` and `right`."""
        return self.left, self.right

    @property
    def is_boundary(self) -> np.ndarray:
        """Which edges have one cell, (e,) bool."""
        return self.count == 1

    def find(self, rows: np.ndarray) -> np.ndarray:
        """Edge numbers of pairs of points in either order, (k,); -1 for pairs that are no edge."""
        if not len(self.points):
            return np.full(len(rows), -1)
        n = self.n_points
        keys = self.points[:, 0] * n + self.points[:, 1]
        wanted = np.minimum(rows[:, 0], rows[:, 1]) * n + np.maximum(rows[:, 0], rows[:, 1])
        at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        return np.where(keys[at] == wanted, at, -1)

    def boundary(self) -> np.ndarray:
        """Edges with one cell, directed with the cell on their left, (b, 2), sorted."""
        at = np.flatnonzero(self.is_boundary)
        rows = self.points[at]
        return np.where((self.n_left[at] == 1)[:, None], rows, rows[:, ::-1])


def edges_of(cells: Mapping[str, np.ndarray], n_points: int) -> Edges:
    """The edges of plane cells.

    Parameters
    ----------
    cells : mapping of str to (m, k) int64
        Point numbers within ``0 .. n_points - 1``.
    n_points : int

    Examples
    --------
    >>> edges = edges_of({"triangle": np.array([[0, 1, 2], [1, 3, 2]])}, 4)
    >>> edges.points[~edges.is_boundary]
    array([[1, 2]])
    >>> edges.left[~edges.is_boundary], edges.right[~edges.is_boundary]
    (array([0]), array([1]))
    """
    half_edges, owner, n_cells = _half_edges(cells)
    lo, hi = np.minimum(*half_edges.T), np.maximum(*half_edges.T)
    order = np.argsort(lo * n_points + hi)
    lo, hi = lo[order], hi[order]
    is_first = np.ones(len(order), bool)
    is_first[1:] = (lo[1:] != lo[:-1]) | (hi[1:] != hi[:-1])
    edge = np.cumsum(is_first) - 1
    of = np.empty(len(order), np.int64)
    of[order] = edge
    n_edges = int(edge[-1]) + 1 if len(edge) else 0
    forwards = half_edges[:, 0] < half_edges[:, 1]
    left, right = np.full(n_edges, -1), np.full(n_edges, -1)
    left[of[forwards]] = owner[forwards]
    right[of[~forwards]] = owner[~forwards]
    return Edges(
        np.stack([lo[is_first], hi[is_first]], axis=1),
        left,
        right,
        np.bincount(of[forwards], minlength=n_edges),
        np.bincount(of[~forwards], minlength=n_edges),
        half_edges,
        owner,
        of,
        n_points,
        n_cells,
    )


def edge_ends(cells: Mapping[str, np.ndarray], n_points: int) -> np.ndarray:
    """Ends of the edges of lines, plane cells or cells of space, each edge once, (e, 2), sorted.

    Examples
    --------
    >>> edge_ends({"line": np.array([[0, 1], [2, 1]])}, 3)
    array([[0, 1],
           [1, 2]])
    """
    keys = [np.zeros(0, np.int64)]
    for kind, rows in cells.items():
        for a, b in KINDS[kind].edges:
            low, high = np.minimum(rows[:, a], rows[:, b]), np.maximum(rows[:, a], rows[:, b])
            keys.append(low * n_points + high)
    return np.stack(np.divmod(np.unique(np.concatenate(keys)), n_points), axis=1)


def components(edges: Edges, is_open: np.ndarray | None = None) -> tuple[int, np.ndarray]:
    """Components of the interior: cells are neighbours across edges, not at vertices.

    Parameters
    ----------
    edges : Edges
    is_open : (e,) bool, optional
        Edges to pass through. Default: all.

    Returns
    -------
    count : int
    component : (n_cells,) int64
    """
    passes = (edges.left >= 0) & (edges.right >= 0)
    if is_open is not None:
        passes &= is_open
    return graphs.components(edges.n_cells, edges.left[passes], edges.right[passes])


def closure_counts(
    edges: Edges, component: np.ndarray, group: np.ndarray, n_groups: int
) -> tuple[np.ndarray, np.ndarray]:
    """Components and Euler characteristic of the closed set that each group of cells covers.

    Here cells that share a vertex are connected; components less Euler characteristic are the
    holes, and two holes that touch are two.

    Parameters
    ----------
    edges : Edges
    component : (n_cells,) int64
        From `components`; each within one group.
    group : (n_cells,) int64
    n_groups : int

    Returns
    -------
    components, euler : (n_groups,) int64
    """
    corner, n_corners = _corners(edges, group, n_groups)
    # Components of the interior that meet at a vertex are one component of the closed set.
    at = component[edges.half_edge_cell]
    seen = np.full(n_corners, -1)
    seen[corner] = at
    meets = np.flatnonzero(seen[corner] != at)
    n = int(component.max()) + 1 if len(component) else 0
    n_pieces, piece = graphs.components(n, seen[corner[meets]], at[meets])
    owner = np.zeros(n_pieces, np.int64)
    owner[piece[component]] = group
    vertex_group = np.full(n_corners, -1)
    vertex_group[corner] = group[edges.half_edge_cell]
    used = np.bincount(vertex_group[vertex_group >= 0], minlength=n_groups)
    left, right = (np.where(side >= 0, np.r_[group, -1][side], -1) for side in edges.sides)
    n_edges = np.bincount(left[left >= 0], minlength=n_groups)
    n_edges += np.bincount(right[(right >= 0) & (right != left)], minlength=n_groups)
    euler = used - n_edges + np.bincount(group, minlength=n_groups)
    return np.bincount(owner, minlength=n_groups), euler


def _corners(edges: Edges, group: np.ndarray, n_groups: int) -> tuple[np.ndarray, int]:
    """Number of the pair (group, start vertex) of each half-edge, and a bound on the numbers."""
    start = edges.half_edges[:, 0]
    if n_groups * edges.n_points <= 4 * len(start) + 4 * edges.n_points:
        return group[edges.half_edge_cell] * edges.n_points + start, n_groups * edges.n_points
    keys = group[edges.half_edge_cell] * edges.n_points + start
    found, compact = np.unique(keys, return_inverse=True)
    return compact, len(found)


def _half_edges(cells: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray, int]:
    rows, owners, before = [np.zeros((0, 2), np.int64)], [np.zeros(0, np.int64)], 0
    for kind, connectivity in cells.items():
        local = np.array(KINDS[kind].edges)
        rows.append(connectivity[:, local].reshape(-1, 2))
        owners.append(np.repeat(np.arange(before, before + len(connectivity)), len(local)))
        before += len(connectivity)
    return np.concatenate(rows), np.concatenate(owners), before

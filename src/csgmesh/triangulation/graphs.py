"""Subgraphs of the Delaunay triangulation: nearest neighbours, minimum spanning tree."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from csgmesh.errors import InputError
from csgmesh.improve.cell_edges import CellEdges
from csgmesh.triangulation.points import (
    CollinearError,
    DuplicateError,
    plane_points,
    triangulate,
)


def nearest_neighbours(points: ArrayLike) -> np.ndarray:
    """The nearest other point of each point, from the Delaunay triangulation.

    Parameters
    ----------
    points : (n, 2) array_like
        Two points at least. Repeated points are each other's nearest ones; points on one line are
        fine.

    Returns
    -------
    (n,) int64
        Of points equally near the one with the lowest number.

    Raises
    ------
    InputError
        If there is only one point.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.nearest_neighbours([[0, 0], [1, 0], [3, 0], [0, 5]])
    array([1, 0, 1, 0])
    """
    array = plane_points(points)
    if len(array) < 2:
        raise InputError(f"nearest neighbours need two points; got {len(array)}")
    edges, length = _neighbour_edges(array)
    start = np.concatenate([edges[:, 0], edges[:, 1]])
    end = np.concatenate([edges[:, 1], edges[:, 0]])
    order = np.lexsort((end, np.concatenate([length, length]), start))
    _, first = np.unique(start[order], return_index=True)
    nearest: np.ndarray = end[order][first]
    return nearest


def minimum_spanning_tree(points: ArrayLike) -> np.ndarray:
    """Edges of a shortest tree that connects all points, from the Delaunay triangulation.

    Parameters
    ----------
    points : (n, 2) array_like
        Repeated points are joined by edges of length 0; points on one line are fine.

    Returns
    -------
    (n - 1, 2) int64
        Numbers of points, the lower first; rows sorted.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.minimum_spanning_tree([[0, 0], [1, 0], [3, 0], [0, 5]]).tolist()
    [[0, 1], [0, 3], [1, 2]]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import minimum_spanning_tree as tree_of

    array = plane_points(points)
    n = len(array)
    if n < 2:
        return np.zeros((0, 2), np.int64)
    edges, length = _neighbour_edges(array)
    # Ranks instead of lengths: all different, and none zero, which would be no edge.
    rank = np.empty(len(edges))
    rank[np.lexsort((edges[:, 1], edges[:, 0], length))] = np.arange(1, len(edges) + 1)
    tree = tree_of(coo_array((rank, (edges[:, 0], edges[:, 1])), shape=(n, n)).tocsr()).tocoo()
    found = np.sort(np.stack([tree.row, tree.col], axis=1).astype(np.int64), axis=1)
    return found[np.lexsort((found[:, 1], found[:, 0]))]


def _neighbour_edges(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges (k, 2), the lower number first, that hold both graphs, and their squared lengths."""
    try:
        edges = _edges(points)
    except DuplicateError:
        edges = _edges_with_duplicates(points)
    gap = points[edges[:, 0]] - points[edges[:, 1]]
    return edges, (gap * gap).sum(axis=1)


def _edges(points: np.ndarray) -> np.ndarray:
    try:
        triangles, _ = triangulate(points)
    except CollinearError:
        # Along a line neighbours are those in its order.
        order = np.lexsort(points.T[::-1])
        return np.sort(np.stack([order[:-1], order[1:]], axis=1), axis=1)
    return CellEdges.of([triangles], np.zeros((0, 2), np.int64), len(points)).ends


def _edges_with_duplicates(points: np.ndarray) -> np.ndarray:
    order = np.lexsort((np.arange(len(points)), points[:, 1], points[:, 0]))
    same = (points[order[1:]] == points[order[:-1]]).all(axis=1)
    is_first = np.r_[True, ~same]
    kept = np.sort(order[is_first])
    first = order[np.maximum.accumulate(np.where(is_first, np.arange(len(order)), 0))]
    copies = np.stack([first[~is_first], order[~is_first]], axis=1)
    if len(kept) < 2:
        return copies
    found: np.ndarray = np.sort(np.concatenate([kept[_edges(points[kept])], copies]), axis=1)
    return found

"""The growth of sizes along the edges of any background structure."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.errors import SizeError
from csgmesh.size.field import positive

#: Vertices that one call of the kernel makes final, in about a tenth of a second.
_AT_ONCE = 200_000


def limit_gradation(
    points: np.ndarray, edges: np.ndarray, sizes: np.ndarray, gradation: float
) -> np.ndarray:
    """The largest sizes below those given that grow no faster than the gradation.

    Afterwards ``|h(a) - h(b)| <= gradation * |a - b|`` holds for every edge (a, b), to rounding;
    no size is lowered that need not be. Sizes are made final from the smallest on, as in Dijkstra's
    algorithm, in O(n log n) for n points and O(n) edges.

    Parameters
    ----------
    points : (n, 2) float64
        Vertices of a triangulation, corners or centres of a quadtree, ...
    edges : (m, 2) int64
        Pairs of neighbours, each once or more often, in any direction.
    sizes : (n,) float64
        What is wanted; infinite where nothing is.
    gradation : float
        Bound on the growth per unit of length.

    Returns
    -------
    (n,) float64

    Raises
    ------
    SizeError
        If the gradation is not positive and finite, or a size is not positive.

    References
    ----------
    .. [1] P.-O. Persson, "Mesh size functions for implicit geometries and PDE-based gradient
       limiting", Engineering with Computers 22 (2006).

    Examples
    --------
    >>> line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    >>> limit_gradation(line, np.array([[0, 1], [1, 2]]), np.array([0.1, 5.0, 0.2]), 0.3)
    array([0.1, 0.4, 0.2])
    """
    growth = positive(gradation, "gradation")
    out = np.array(sizes, float)
    if not (out > 0).all():
        raise SizeError(f"sizes must be positive; got {out.min():g}")
    n = len(points)
    both = np.concatenate([edges, np.asarray(edges)[:, ::-1]]).astype(np.int64)
    order = np.argsort(both[:, 0], kind="stable")
    first = np.searchsorted(both[order, 0], np.arange(n + 1))
    neighbours = np.ascontiguousarray(both[order, 1])
    flat = np.ascontiguousarray(points, float).reshape(-1)
    scratch = np.empty(n, np.int64), np.empty(n, np.int64)
    state = np.array([n, 0], np.int64)
    while state[0]:
        kernels.limit_growth(flat, first, neighbours, out, growth, *scratch, state, _AT_ONCE)
    return out


def steepest(points: np.ndarray, edges: np.ndarray, sizes: np.ndarray) -> float:
    """The largest growth of sizes per unit of length along any edge.

    Examples
    --------
    >>> steepest(np.array([[0.0, 0.0], [2.0, 0.0]]), np.array([[0, 1]]), np.array([0.1, 0.7]))
    0.3
    """
    if not len(edges):
        return 0.0
    a, b = np.asarray(edges).T
    length = np.hypot(*(points[a] - points[b]).T)
    return float((np.abs(sizes[a] - sizes[b]) / length).max())

"""What the boundary of a solid asks of sizes by itself: its curvature and its short edges."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.graphs import components
from csgmesh.size.bending import curvature_radii

#: Edges on a full circle where no size is given.
EDGES_A_CIRCLE = 24.0


def curvature_sizes(domain: Plc, is_asked: bool) -> np.ndarray:
    """Largest edge that each facet's curvature allows, (m,).

    The chord of an arc of radius R deviates from it by at most d if it is no longer than
    ``2 sqrt(2 R d)``. Where no size is asked for, a circle has some 24 edges as well.
    """
    radius = curvature_radii(domain)
    size = 2.0 * np.sqrt(2.0 * domain.deviation * radius)
    if not is_asked:
        size = np.minimum(size, 2.0 * np.pi * radius / EDGES_A_CIRCLE)
    return size


def short_edges(domain: Plc) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the feature curves between corners, (k, 3), and each curve's length, (k,)."""
    edges = domain.feature_edges()
    if not len(edges):
        return np.zeros((0, 3)), np.zeros(0)
    is_corner = np.zeros(domain.n_points, bool)
    is_corner[domain.corners()] = True
    # Edges that share a point that is no corner belong to one curve.
    order = np.argsort(edges.ravel(), kind="stable")
    point, edge = edges.ravel()[order], order // 2
    same = (point[1:] == point[:-1]) & ~is_corner[point[1:]]
    curve = components(len(edges), edge[:-1][same], edge[1:][same])[1]
    ends = domain.points[edges]
    length = np.bincount(curve, np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1)))
    at = np.flatnonzero(is_corner[edges].any(axis=1))
    which = np.repeat(at, 2)
    corner = edges[at].ravel()
    keep = is_corner[corner]
    return domain.points[corner[keep]], length[curve[which[keep]]]

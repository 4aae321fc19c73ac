"""What the boundary of a solid asks of sizes by itself: its curvature and its short edges."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surfaces import PLANE
from csgmesh.graphs import components

#: Edges on a full circle where no size is given.
EDGES_A_CIRCLE = 24.0
#: Steps along a surface over which its normal's turning is measured, as a share of the diagonal.
_STEP = 1e-5
#: No curvature counts whose radius is below this share of the diagonal: at a cone's apex it is
#: beyond all bounds, and the apex is a corner anyway.
_SHARPEST = 1e-3
#: Of a surface with many facets so many are looked at first; if their radii differ by no more than
#: the ratio, as on spheres and cylinders, they stand for all.
_SAMPLED = 64
_EVEN = 1.01


def curvature_radii(domain: Plc) -> np.ndarray:
    """Smallest radius of curvature of the exact surface at the middle of each facet, (m,)."""
    radius = np.full(domain.n_facets, np.inf)
    bent = np.flatnonzero(domain.surfaces.kind[domain.facet_surface] != PLANE)
    order = bent[np.argsort(domain.facet_surface[bent], kind="stable")]
    starts = np.flatnonzero(np.diff(domain.facet_surface[order], prepend=-1))
    for own in np.split(order, starts[1:]) if len(order) else ():
        some = own[:: max(len(own) // _SAMPLED, 1)]
        found = _radii(domain, some)
        if len(some) < len(own) and found.max() > _EVEN * found.min():
            radius[own] = _radii(domain, own)
        else:
            radius[own] = found.min()
            radius[some] = found
    return radius


def _radii(domain: Plc, facets: np.ndarray) -> np.ndarray:
    """The same of some facets, from how normals turn along two directions."""
    surface = domain.facet_surface[facets]
    centre = domain.points[domain.facets[facets]].mean(axis=1)
    centre = domain.surfaces.project(surface, centre)
    normal = domain.surfaces.normals(surface, centre)
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
    first /= np.sqrt((first**2).sum(axis=1))[:, None]
    frame = (first, np.cross(normal, first))
    step = _STEP * domain.diagonal
    turn = [domain.surfaces.normals(surface, centre + step * way) - normal for way in frame]
    shape = np.array([[(t * way).sum(axis=1) / step for way in frame] for t in turn])
    a, b, c = shape[0, 0], 0.5 * (shape[0, 1] + shape[1, 0]), shape[1, 1]
    largest = 0.5 * np.abs(a + c) + np.hypot(0.5 * (a - c), b)
    with np.errstate(divide="ignore"):
        return np.maximum(1.0 / largest, _SHARPEST * domain.diagonal)


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

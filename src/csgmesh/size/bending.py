"""How sharply the exact surfaces of a solid bend."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surfaces import PLANE

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

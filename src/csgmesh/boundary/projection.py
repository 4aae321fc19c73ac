"""Vertices onto the exact surfaces around them."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.surfaces import Surfaces

_STEPS = 12

#: Directions count as independent if the least singular value of the normals exceeds this share of
#: the largest: below it surfaces touch, and where they do is ill-defined along the touching.
_INDEPENDENT = 1e-4


def project_vertices(
    points: np.ndarray, triangles: np.ndarray, surface: np.ndarray, surfaces: Surfaces
) -> np.ndarray:
    """Move each vertex onto all surfaces of the facets around it (Newton's method).

    A vertex on one surface goes to its projection, one on two to a point of their common curve, one
    on three to the corner; each step solves the linearised equations with the smallest motion. On
    surfaces that touch, the motion along the touching stays out.
    """
    pairs = np.unique(np.column_stack([triangles.ravel(), np.repeat(surface, 3)]), axis=0)
    vertex, on = pairs.T
    first = np.searchsorted(vertex, np.arange(len(points) + 1))
    count = np.diff(first)
    out = points.copy()
    single = np.flatnonzero(count == 1)
    out[single] = surfaces.project(on[first[single]], points[single])
    for k in np.unique(count[count > 1]).tolist():
        at = np.flatnonzero(count == k)
        rows = on[first[at][:, None] + np.arange(k)]
        for _ in range(_STEPS):
            place = out[at]
            flat = np.repeat(place, k, axis=0)
            foot = surfaces.project(rows.ravel(), flat)
            normal = surfaces.normals(rows.ravel(), foot).reshape(-1, k, 3)
            gap = ((foot - flat).reshape(-1, k, 3) * normal).sum(axis=2)
            inverse = np.linalg.pinv(normal, rcond=_INDEPENDENT)
            move = np.einsum("vij,vj->vi", inverse, gap)
            out[at] = place + move
            going = np.abs(move).max(axis=1) > 4.0 * np.finfo(float).eps
            if not going.any():
                break
            at, rows = at[going], rows[going]
    return out

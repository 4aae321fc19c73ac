"""Where a triangulated surface passes through itself."""

from __future__ import annotations

import numpy as np

from csgmesh.spatial import Boxes

#: Signed volumes below this share of the product of lengths are rounding.
_ROUNDING = 1e-13
#: Pairs looked at together.
_PAIRS = 500_000


def first_crossing(points: np.ndarray, triangles: np.ndarray) -> np.ndarray | None:
    """A point where an edge of one triangle passes through the inside of another, or None.

    Surfaces that only touch, in a point, along an edge or in a plane, do not pass through.
    """
    corner = points[triangles]
    low, high = corner.min(axis=1), corner.max(axis=1)
    # The search is in the two directions in which triangles are spread furthest.
    axes = np.sort(np.argsort(np.ptp(points, axis=0))[1:])
    rest = 3 - axes.sum()
    pairs = Boxes(low[:, axes], high[:, axes]).pairs()
    i, j = pairs.T
    near = (low[i, rest] <= high[j, rest]) & (low[j, rest] <= high[i, rest])
    pairs = pairs[near]
    for start in range(0, len(pairs), _PAIRS):
        part = pairs[start : start + _PAIRS]
        for first, second in ((part[:, 0], part[:, 1]), (part[:, 1], part[:, 0])):
            for k in range(3):
                found = _pierced(points, triangles[first][:, [k, (k + 1) % 3]], triangles[second])
                if found is not None:
                    return found
    return None


def _pierced(points: np.ndarray, edges: np.ndarray, triangles: np.ndarray) -> np.ndarray | None:
    """A point where an edge (k, 2) goes through its triangle (k, 3)."""
    apart = (edges[:, :, None] != triangles[:, None, :]).all(axis=(1, 2))
    edges, triangles = edges[apart], triangles[apart]
    p, q = points[edges[:, 0]], points[edges[:, 1]]
    a, b, c = (points[triangles[:, k]] for k in range(3))
    above, below = _volumes(a, b, c, p), _volumes(a, b, c, q)
    through = np.stack([_volumes(p, q, a, b), _volumes(p, q, b, c), _volumes(p, q, c, a)])
    hit = (above * below < 0) & ((through > 0).all(axis=0) | (through < 0).all(axis=0))
    at = np.flatnonzero(hit)
    return 0.5 * (p[at[0]] + q[at[0]]) if len(at) else None


def _volumes(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Sign of the volume of tetrahedra, 0 where it is rounding."""
    u, v, w = b - a, c - a, d - a
    volume = (np.cross(u, v) * w).sum(axis=1)
    lengths = [np.sqrt((x**2).sum(axis=1)) for x in (u, v, w)]
    return np.sign(volume) * (np.abs(volume) > _ROUNDING * lengths[0] * lengths[1] * lengths[2])

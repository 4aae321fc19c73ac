"""The integral of 1 / lfs² over a domain, to which the size of an optimal mesh is proportional.

lfs is Ruppert's local feature size (1995): at x the radius of the smallest disk around x that meets
two vertices or segments which are not incident.
"""

from __future__ import annotations

import numpy as np

import csgmesh as cm
from csgmesh.domain import Pslg

#: Nearest segments and vertices among which the two are looked for.
NEAREST = 6
#: Points for which distances to all features are held at a time, times features.
BATCH = 2_000_000


def integral(domain: Pslg, mesh: cm.Mesh) -> float:
    """By the middles of a mesh's triangles."""
    corners = mesh.points[mesh.cells["triangle"]]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    return float((area / local_feature_size(domain, corners.mean(axis=1)) ** 2).sum())


def local_feature_size(domain: Pslg, points: np.ndarray) -> np.ndarray:
    """lfs at points, (n,)."""
    step = max(BATCH // max(len(domain.segments), 1), 1)
    parts = [_batch(domain, points[i : i + step]) for i in range(0, len(points), step)]
    return np.concatenate(parts)


def _batch(domain: Pslg, points: np.ndarray) -> np.ndarray:
    segments = domain.segments
    a, b = domain.points[segments[:, 0]], domain.points[segments[:, 1]]
    along = b - a
    t = ((points[:, None] - a) * along).sum(2) / (along * along).sum(1)
    foot = a + np.clip(t, 0.0, 1.0)[..., None] * along
    to_segment = np.hypot(*np.moveaxis(points[:, None] - foot, 2, 0))
    to_vertex = np.hypot(*np.moveaxis(points[:, None] - domain.points, 2, 0))
    out = np.sort(to_vertex, axis=1)[:, 1]
    near = np.argsort(to_segment, axis=1)[:, :NEAREST]
    away = np.take_along_axis(to_segment, near, axis=1)
    ends = segments[near]
    for i in range(near.shape[1]):
        for j in range(i):
            apart = (ends[:, i, :, None] != ends[:, j, None, :]).all(axis=(1, 2))
            out = np.where(apart, np.minimum(out, away[:, i]), out)
    near_vertex = np.argsort(to_vertex, axis=1)[:, :NEAREST]
    vertex_away = np.take_along_axis(to_vertex, near_vertex, axis=1)
    for i in range(near.shape[1]):
        for j in range(near_vertex.shape[1]):
            apart = (ends[:, i] != near_vertex[:, j, None]).all(axis=1)
            both = np.maximum(away[:, i], vertex_away[:, j])
            out = np.where(apart, np.minimum(out, both), out)
    return out

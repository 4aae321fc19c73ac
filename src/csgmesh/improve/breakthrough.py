"""Whether a boundary that slid along its curve runs into another boundary."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.improve.stars import Stars
from csgmesh.improve.workpiece import Workpiece
from csgmesh.spatial import Boxes


def broken_through(work: Workpiece | Stars) -> np.ndarray:
    """Vertices that slid such that their facets, or what they swept over, meet other facets.

    Only the outside needs a look: inside the domain triangles lie between a facet and the next, and
    all are counterclockwise. Outside nothing does, and the gap between two curves may be narrower
    than their chords' deviation.

    Returns
    -------
    (k,) int64
        Sorted numbers of vertices; empty as a rule.
    """
    mesh, arrays = work.mesh, work.arrays
    slid = work.slid()
    if not len(slid):
        return slid
    f, g = arrays.around.reshape(-1, 2)[slid].T
    bent = arrays.curve_kind[arrays.curve[f]] > 0
    outer = (mesh.facet_region["line"][f] < 0).any(axis=1)
    slid, f, g = slid[bent & outer], f[bent & outer], g[bent & outer]
    if not len(slid):
        return slid
    facets = mesh.facets["line"]
    # Points now, and behind them where the vertices that slid came from.
    points = np.concatenate([arrays.xy.reshape(-1, 2), mesh.points[slid]])
    origin = mesh.n_points + np.arange(len(slid))
    quads = np.stack([facets[f, 0], slid, facets[g, 1], origin], axis=1)
    corners = points[quads]
    others = points[facets]
    pairs = Boxes(others.min(axis=1), others.max(axis=1)).overlapping(
        corners.min(axis=1), corners.max(axis=1)
    )
    pairs = pairs[share_no_end(facets[pairs[:, 1]], quads[pairs[:, 0], :3])]
    if not len(pairs):
        return np.zeros(0, np.int64)
    quad, ends = quads[pairs[:, 0]], facets[pairs[:, 1]]
    hit = np.zeros(len(pairs), bool)
    for side in ((0, 1), (1, 2)):
        hit |= segments_meet(points, quad[:, side], ends)
        for end in (0, 1):
            hit |= _within(points, quad[:, (*side, 3)], ends[:, end])
    return np.unique(slid[pairs[hit, 0]])


def share_no_end(ends: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Whether facets (k, 2) have no vertex among (k, 3)."""
    return np.asarray((ends[:, :, None] != near[:, None, :]).all(axis=(1, 2)))


def segments_meet(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Whether segments a (k, 2) and b (k, 2) without common ends meet, exactly."""
    sides = [
        kernels.orientations(points, np.column_stack([p, q[:, k]]))
        for p, q in ((a, b), (b, a))
        for k in (0, 1)
    ]
    return (sides[0] * sides[1] <= 0) & (sides[2] * sides[3] <= 0)


def _within(points: np.ndarray, triangle: np.ndarray, vertex: np.ndarray) -> np.ndarray:
    """Whether vertices (k,) lie in triangles (k, 3) of either orientation, exactly."""
    signs = np.stack(
        [
            kernels.orientations(
                points, np.column_stack([triangle[:, k], triangle[:, (k + 1) % 3], vertex])
            )
            for k in range(3)
        ]
    )
    return np.abs(signs.sum(axis=0)) == 3

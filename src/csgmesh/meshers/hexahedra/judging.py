"""Whether a finished set of hexahedra is what the domain asks for."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.measures.space.jacobians import least_jacobians
from csgmesh.meshers.hexahedra.blocks import Blocks, paired_edges
from csgmesh.meshers.hexahedra.labels import unresolved
from csgmesh.meshers.hexahedra.strata import Strata

#: Faces and curves of a mesh whose area or length differs by more than this share, and by more
#: than a piece of the size of a cell, are other ones than the domain's.
_OFF = 0.2


def require_likeness(blocks: Blocks, strata: Strata, size: float) -> None:
    """Raise unless each curve and face of the domain is there in about its length and area."""
    pairs, wanted = strata.lengths()
    quads, points = blocks.quads, blocks.points
    edge = np.column_stack([quads.ravel(), quads[:, [1, 2, 3, 0]].ravel()])
    label = np.repeat(blocks.label, 4)
    one, two = paired_edges(quads)
    at = np.flatnonzero(label[one] != label[two])
    found = np.sort(np.column_stack([label[one[at]], label[two[at]]]), axis=1)
    ends = points[edge[one[at]]]
    long = np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1))
    for (a, b), length in zip(pairs.tolist(), wanted.tolist(), strict=True):
        own = (found[:, 0] == a) & (found[:, 1] == b)
        if abs(float(long[own].sum()) - length) > _OFF * length + size:
            here = (strata.pair[:, 0] == a) & (strata.pair[:, 1] == b)
            raise unresolved("a sharp edge is lost", strata.segments[here].mean(axis=1)[0])
    half = np.cross(
        points[quads[:, 2]] - points[quads[:, 0]], points[quads[:, 3]] - points[quads[:, 1]]
    )
    area = np.bincount(blocks.label, 0.5 * np.sqrt((half**2).sum(axis=1)), strata.n_faces)
    off = np.abs(area - strata.areas()) - _OFF * strata.areas() - size**2
    if (off > 0.0).any():
        face = int(np.argmax(off))
        at = np.flatnonzero(strata.face == face)[0]
        raise unresolved("a face is lost", strata.domain.points[strata.domain.facets[at]].mean(0))


def require_positive(blocks: Blocks) -> None:
    """Raise unless each Jacobian is positive all over its cell."""
    points, hexes = np.ascontiguousarray(blocks.points), np.ascontiguousarray(blocks.hexes)
    unproved = np.zeros(len(hexes), bool)
    start = 0
    while start < len(hexes):
        start = kernels.mark_unproved(points, hexes, unproved, np.zeros((3, 36)), start)
    doubtful = np.flatnonzero(unproved)
    if not len(doubtful):
        return
    least = least_jacobians(points, "hexahedron", hexes[doubtful])
    bad = doubtful[~(least > 0.0)]
    if len(bad):
        raise unresolved(
            f"{len(bad)} hexahedra stay turned over, the first",
            points[hexes[bad[0]]].mean(axis=0),
        )


def lost_corners(corner: np.ndarray, strata: Strata) -> int:
    """Corners of the domain without a vertex of their own."""
    return len(strata.corners) - len(np.unique(corner))

"""Boundaries whose new vertices would run into other boundaries across a narrow gap."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.curves import LINE
from csgmesh.errors import MeshingError
from csgmesh.improve.breakthrough import segments_meet, share_no_end
from csgmesh.improve.refinement.boundary import halfway
from csgmesh.mesh import Mesh
from csgmesh.spatial import Boxes


def crossed_facets(mesh: Mesh, halved: np.ndarray) -> np.ndarray:
    """Facets that halves of others would cross on their way to an exact curve.

    Only the outside needs a look, where no cells lie between: a gap between two curves may be
    narrower than their chords' deviation, and then both must be halved or none.

    Parameters
    ----------
    mesh : Mesh
    halved : (f,) bool
        Which facets are to be halved.

    Returns
    -------
    (k,) int64
        Facets not to be halved yet.

    Raises
    ------
    MeshingError
        If two halved facets cross; with the place.
    """
    facets, curve = mesh.facets["line"], mesh.facet_curve["line"]
    if mesh.curves is None:
        return np.zeros(0, np.int64)
    is_bent = np.where(curve >= 0, mesh.curves.kind[curve] != LINE, False)
    outer = (mesh.facet_region["line"] < 0).any(axis=1)
    moved = np.flatnonzero(halved & is_bent & outer)
    if not len(moved):
        return moved
    t = halfway(mesh.curves, curve[moved], mesh.facet_interval["line"][moved])
    points = np.concatenate([mesh.points, mesh.curves.points(curve[moved], t)])
    middle = mesh.n_points + np.arange(len(moved))
    halves = np.concatenate(
        [np.column_stack([facets[moved, 0], middle]), np.column_stack([middle, facets[moved, 1]])]
    )
    rest = np.setdiff1d(np.flatnonzero(outer), moved)
    pieces = np.concatenate([halves, facets[rest]])
    owner = np.concatenate([moved, moved, rest])
    ends = points[pieces]
    lo, hi = ends.min(axis=1), ends.max(axis=1)
    pairs = Boxes(lo, hi).overlapping(lo[: len(halves)], hi[: len(halves)])
    first, second = pieces[pairs[:, 0]], pieces[pairs[:, 1]]
    pairs = pairs[share_no_end(first, second)]
    hit = pairs[segments_meet(points, pieces[pairs[:, 0]], pieces[pairs[:, 1]])]
    both = hit[halved[owner[hit[:, 1]]]]
    if len(both):
        x, y = points[middle[both[0, 0] % len(moved)]]
        raise MeshingError(
            f"refined boundaries would cross at ({x:.6g}, {y:.6g}), where two curves are nearer to "
            "one another than their chords; mesh with a smaller deviation or size there"
        )
    return np.unique(owner[hit[:, 1]])

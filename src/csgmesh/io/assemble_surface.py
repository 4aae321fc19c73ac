"""From what a file lists to the mesh of a surface in space."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from csgmesh.errors import FileFormatError
from csgmesh.io.assemble_space import OUTER, dimension
from csgmesh.mesh import KINDS, Mesh

if TYPE_CHECKING:
    from csgmesh.io.assemble import Listing


def lists_surface(kinds: Iterable[str], points: np.ndarray) -> bool:
    """Whether these are triangles or quads in space, not all at one height.

    Examples
    --------
    >>> lists_surface(["triangle"], np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1]]))
    True
    """
    names = list(kinds)
    if dimension(names) == 3 or not any(k in KINDS and KINDS[k].dim == 2 for k in names):
        return False
    return points.ndim == 2 and points.shape[1] == 3 and bool(np.ptp(points[:, 2]) > 0.0)


def surface_mesh(listing: Listing) -> Mesh:
    """The mesh of a listing whose cells are surfaces in space: its cells are its facets."""
    points = np.asarray(listing.points, np.float64)
    if not np.isfinite(points).all():
        raise FileFormatError(f"{listing.path}: a mesh of space needs finite points (n, 3)")
    facets, markers = listing.of_dim(2)
    sides = {kind: np.concatenate(listing.beside[kind]) for kind in facets}
    cell_region = {}
    used = np.zeros(len(points), bool)
    for kind, rows in facets.items():
        used[rows] = True
        side = sides[kind]
        nowhere = (side < 0).all(axis=1)
        if nowhere.any():
            side[nowhere, 0] = listing.regions.of("domain")
        cell_region[kind] = np.where(side[:, 0] >= 0, side[:, 0], side[:, 1])
        unnamed = markers[kind] < 0
        if unnamed.any():
            markers[kind][unnamed] = listing.markers.of((OUTER,))
    new = np.cumsum(used) - 1
    listing.number = np.where(used, new, -1)
    loose = int((~used).sum())
    rows_of = {kind: new[rows] for kind, rows in facets.items()}
    return Mesh(
        points[used],
        rows_of,
        cell_region,
        tuple(listing.regions.names),
        facets=rows_of,
        facet_marker=markers,
        boundary_names=tuple(listing.markers.names),
        facet_region=sides,
        info={"skipped": {"points": loose}} if loose else {},
    )

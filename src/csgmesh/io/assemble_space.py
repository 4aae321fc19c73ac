"""From what a file lists to a `Mesh` of space: facets turned outward, missing ones added."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from csgmesh.errors import FileFormatError
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.faces import Faces, canonical_faces, faces_of

if TYPE_CHECKING:
    from csgmesh.io.assemble import Listing

#: Names of sides that the file does not name: outer ones, and those between two regions.
OUTER, INNER = "boundary", "interface"

Tables = dict[str, np.ndarray]


def space_mesh(listing: Listing) -> Mesh:
    """The mesh of a listing with cells in space."""
    points = np.asarray(listing.points, np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise FileFormatError(f"{listing.path}: a mesh of space needs finite points (n, 3)")
    cells, regions = listing.of_dim(3)
    for kind, region in regions.items():
        regions[kind] = np.where(region < 0, _default_region(listing, region), region)
    faces = faces_of(cells)
    region_of = np.concatenate([*regions.values(), [-1]])
    facets, markers, sides, loose = _facets(listing, faces, region_of)
    used = np.zeros(len(points), bool)
    for rows in cells.values():
        used[rows] = True
    new = np.cumsum(used) - 1
    counts = {"points": int((~used).sum()), "faces": loose}
    skipped = {what: n for what, n in counts.items() if n}
    return Mesh(
        points[used],
        {kind: new[rows] for kind, rows in cells.items()},
        regions,
        tuple(listing.regions.names),
        facets={kind: new[rows] for kind, rows in facets.items()},
        facet_marker=markers,
        boundary_names=tuple(listing.markers.names),
        facet_region=sides,
        info={"skipped": skipped} if skipped else {},
    )


def _default_region(listing: Listing, region: np.ndarray) -> int:
    return listing.regions.of("domain") if (region < 0).any() else -1


def _facets(
    listing: Listing, faces: Faces, region_of: np.ndarray
) -> tuple[Tables, Tables, Tables, int]:
    behind, ahead = region_of[faces.behind], region_of[faces.ahead]
    listed = np.zeros(len(faces.points), bool)
    given, tags = listing.of_dim(2)
    found: dict[str, list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = {}
    loose = 0
    for kind, rows in given.items():
        ordered, forwards = canonical_faces(rows[:, : KINDS[kind].n_corners])
        face = faces.find(ordered)
        first = np.zeros(len(face), bool)
        first[np.unique(face, return_index=True)[1]] = True
        kept = np.flatnonzero((face >= 0) & first)
        loose += int((face < 0).sum())
        own, way = face[kept], forwards[kept]
        listed[own] = True
        side = np.column_stack([behind[own], ahead[own]])
        side[~way] = side[~way, ::-1]
        rows = rows[kept]
        turn = (side[:, 0] < 0) | ((side[:, 1] >= 0) & (side[:, 1] < side[:, 0]))
        side[turn] = side[turn, ::-1]
        rows[turn] = rows[turn][:, _mirrored(kind)]
        found.setdefault(kind, []).append((rows, tags[kind][kept], side))
    rest = np.flatnonzero((behind != ahead) & ~listed)
    for kind, at in (
        ("triangle", rest[faces.points[rest, 3] < 0]),
        ("quad", rest[faces.points[rest, 3] >= 0]),
    ):
        if len(at):
            found.setdefault(kind, []).append(_missing(kind, faces, at, behind, ahead))
    facets = {k: np.concatenate([f[0] for f in parts]) for k, parts in found.items()}
    markers = {k: np.concatenate([f[1] for f in parts]) for k, parts in found.items()}
    sides = {k: np.concatenate([f[2] for f in parts]) for k, parts in found.items()}
    for kind, marker in markers.items():
        outer = sides[kind][:, 1] < 0
        for where, name in ((marker < 0) & outer, OUTER), ((marker < 0) & ~outer, INNER):
            if where.any():
                marker[where] = listing.markers.of((name,))
    return facets, markers, sides, loose


def _missing(
    kind: str, faces: Faces, at: np.ndarray, behind: np.ndarray, ahead: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rows = faces.points[at][:, : KINDS[kind].n_corners].copy()
    side = np.column_stack([behind[at], ahead[at]])
    turn = (side[:, 0] < 0) | ((side[:, 1] >= 0) & (side[:, 1] < side[:, 0]))
    side[turn] = side[turn, ::-1]
    rows[turn] = rows[turn][:, _mirrored(kind)]
    return rows, np.full(len(at), -1), side


def _mirrored(kind: str) -> list[int]:
    """The order of a facet's points seen from its other side."""
    n = KINDS[kind].n_corners
    middles = list(range(2 * n - 1, n - 1, -1)) if KINDS[kind].n_points > n else []
    return [0, *range(n - 1, 0, -1), *middles, *range(2 * n, KINDS[kind].n_points)]


def dimension(kinds: Mapping[str, object] | list[str]) -> int:
    """3 if any kind is a solid cell, else 2."""
    return 3 if any(k in KINDS and KINDS[k].dim == 3 for k in kinds) else 2

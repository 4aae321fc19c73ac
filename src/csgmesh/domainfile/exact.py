"""Lengths and areas of a mesh, over its chords and over the exact curves these stand for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.curves import cross
from csgmesh.domain.names import find_names
from csgmesh.errors import InputError
from csgmesh.mesh import KINDS, Mesh


@dataclass(frozen=True)
class Measured:
    """A length or area of a mesh.

    Attributes
    ----------
    chords : float
        Over the mesh's straight facets.
    exact : float or None
        Over the exact curves; None for a mesh without curves.
    bound : float
        Sum of what each curve and its chord differ by; 0 for a mesh without curves.
    """

    chords: float
    exact: float | None
    bound: float


def boundary_length(mesh: Mesh, name: str) -> Measured:
    """Length of the facets that carry a name.

    Raises
    ------
    NameLookupError
        Nothing has that name.

    Examples
    --------
    >>> mesh = Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]},
    ...             facets={"line": [[0, 1], [1, 2], [2, 0]]},
    ...             facet_marker={"line": [0, 1, 0]}, boundary_names=[["wall"], ["door"]])
    >>> boundary_length(mesh, "wall")
    Measured(chords=2.0, exact=None, bound=0.0)
    """
    _require_plane(mesh)
    rows = mesh.boundary(name).get("line", np.zeros(0, np.int64))
    if not len(rows):
        return Measured(0.0, 0.0, 0.0)
    a, b = mesh.points[mesh.facets["line"][rows]].transpose(1, 0, 2)
    chords = np.hypot(*(b - a).T)
    total = float(chords.sum())
    if mesh.curves is None:
        return Measured(total, None, 0.0)
    rows = rows[is_curved := mesh.facet_curve["line"][rows] >= 0]
    interval = mesh.facet_interval["line"][rows]
    lengths = mesh.curves.lengths(mesh.facet_curve["line"][rows], interval[:, 0], interval[:, 1])
    gained = lengths - chords[is_curved]
    return Measured(total, total + float(gained.sum()), float(np.abs(gained).sum()))


def covered_area(mesh: Mesh, region: str | None = None) -> Measured:
    """Area of all cells, or of those of a region.

    Raises
    ------
    NameLookupError
        No region has that name.

    Examples
    --------
    >>> covered_area(Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})).chords
    0.5
    """
    _require_plane(mesh)
    cells = None if region is None else mesh.region(region)
    # About a point of the mesh, so that an offset of the coordinates costs no digits.
    points = mesh.points - mesh.points[0] if mesh.n_points else mesh.points
    total = 0.0
    for kind, corners in mesh.cells.items():
        chosen = corners if cells is None else corners[cells[kind]]
        at = points[chosen[:, : KINDS[kind].n_corners]]
        following = np.roll(at, -1, axis=1)
        total += 0.5 * float(cross(at.reshape(-1, 2), following.reshape(-1, 2)).sum())
    if mesh.curves is None:
        return Measured(total, None, 0.0)
    bulges = _bulges(mesh, region)
    return Measured(total, total + float(bulges.sum()), float(np.abs(bulges).sum()))


def _bulges(mesh: Mesh, region: str | None) -> np.ndarray:
    """Area between each facet's curve and its chord, as it adds to the region on its left."""
    facets = mesh.facets.get("line")
    if mesh.curves is None or facets is None:
        return np.zeros(0)
    names = mesh.region_names if region is None else find_names(region, mesh.region_names)
    wanted = [i for i, name in enumerate(mesh.region_names) if name in names]
    inside = np.isin(mesh.facet_region["line"], wanted).astype(np.int64)
    side = inside[:, 0] - inside[:, 1]
    rows = np.flatnonzero((mesh.facet_curve["line"] >= 0) & (side != 0))
    origin = mesh.points[0]
    interval = mesh.facet_interval["line"][rows]
    curved = mesh.curves.area_terms(
        mesh.facet_curve["line"][rows], interval[:, 0], interval[:, 1], origin
    )
    a, b = (mesh.points[facets[rows]] - origin).transpose(1, 0, 2)
    return side[rows] * (curved - 0.5 * cross(a, b))


def _require_plane(mesh: Mesh) -> None:
    if mesh.dim != 2:
        raise InputError(f"lengths and areas need a plane mesh; this one has dim {mesh.dim}")

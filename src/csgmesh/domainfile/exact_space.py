"""Areas and volumes over flat facets of a mesh of space, and what surfaces differ from those."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from csgmesh.domain.names import find_names
from csgmesh.domainfile.exact import Measured
from csgmesh.errors import InputError
from csgmesh.mesh import Mesh

if TYPE_CHECKING:
    from csgmesh.measures.space.case import SpaceCase


def boundary_area(mesh: Mesh, name: str) -> Measured:
    """Area of the facets that carry a name.

    Raises
    ------
    NameLookupError
        Nothing has that name.
    InputError
        The mesh is plane.
    """
    from csgmesh.measures.space.sags import area_bounds, triangle_areas

    case = _case(mesh, "areas of boundaries")
    found = mesh.boundary(name)
    wanted = np.zeros(len(case.facets[0]), bool)
    before = 0
    for kind, rows in mesh.facets.items():
        wanted[before + found.get(kind, np.zeros(0, np.int64))] = True
        before += len(rows)
    own = wanted[case.triangles[:, 3]]
    total = float(triangle_areas(case)[own].sum())
    if case.domain is None:
        return Measured(total, None, 0.0)
    # Facets that are cut in two bend along the cut as well: their parts are bounded one by one.
    return Measured(total, total, float(area_bounds(case)[own].sum()))


def filled_volume(mesh: Mesh, region: str | None = None) -> Measured:
    """Volume of all cells, or of those of a region.

    Raises
    ------
    NameLookupError
        No region has that name.
    InputError
        The mesh is plane.
    """
    from csgmesh.measures.space.sags import facet_sags, triangle_areas
    from csgmesh.measures.space.surface import enclosed_volumes
    from csgmesh.mesh.surfaces import is_surface

    case = _case(mesh, "volumes")
    names = mesh.region_names if region is None else find_names(region, mesh.region_names)
    wanted = [i for i, name in enumerate(mesh.region_names) if name in names]
    if is_surface(mesh):
        total = float(enclosed_volumes(case)[wanted].sum())
    else:
        total = float(case.quality.volume[np.isin(case.cell_region[:-1], wanted)].sum())
    if case.domain is None:
        return Measured(total, None, 0.0)
    side = np.isin(case.facet_region, wanted)
    bounds = (side[:, 0] != side[:, 1])[case.triangles[:, 3]]
    slack = facet_sags(case, curved=True)[case.triangles[:, 3]] * triangle_areas(case)
    return Measured(total, total, float(slack[bounds].sum()))


def _case(mesh: Mesh, what: str) -> SpaceCase:
    from csgmesh.measures.space.case import SpaceCase

    if mesh.dim != 3:
        raise InputError(f"{what} need a mesh of space; this one has dim {mesh.dim}")
    return SpaceCase(mesh, mesh.domain, None)  # type: ignore[arg-type]

"""Any mesher with boundary layers: columns, the domain within, gluing."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from csgmesh.domain.pslg import Pslg
from csgmesh.errors import InputError
from csgmesh.mesh import Mesh
from csgmesh.meshers.layers.columns import raise_columns
from csgmesh.meshers.layers.gluing import Gluing
from csgmesh.meshers.layers.heights import settle_heights
from csgmesh.meshers.layers.inner import inner_domain
from csgmesh.meshers.layers.options import Layers
from csgmesh.size.resolve import ResolvedSize


def with_layers(
    domain: Pslg,
    layers: Mapping[str, Layers],
    size: ResolvedSize | None,
    mesh_inside: Callable[[Pslg], Mesh],
    info: Mapping[str, object],
) -> Mesh:
    """Mesh a domain with layers along its walls.

    Walls are cut into edges of the wanted size; over each end stands a column, along the normal,
    several in a fan where the wall turns away, on the boundary beside it where the wall ends there.
    Columns are lowered where there is no room. Another mesher does what lies within the tips; where
    it splits an edge between two tips, a column is added below (after Pirzadeh's advancing layers,
    1996).

    Parameters
    ----------
    domain : Pslg
    layers : mapping of str to Layers
        By names of outer boundaries.
    size : ResolvedSize or None
        Wanted edge length along the walls.
    mesh_inside : callable
        Meshes a domain; its facets keep the markers of their segments.
    info : mapping
        Facts for the mesh.
    """
    if domain.periodic:
        raise InputError("a domain with periodic sides can have no boundary layers")
    walls = raise_columns(domain, layers, size)
    settle_heights(walls)
    inner = inner_domain(walls)
    mesh = mesh_inside(inner.domain)
    cells = next(iter(layers.values())).cells
    return Gluing(walls, inner, mesh).finished(cells, info)

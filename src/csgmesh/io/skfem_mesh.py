"""Meshes of the library scikit-fem."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.errors import InputError
from csgmesh.io.members import members
from csgmesh.io.sides import oriented_edges
from csgmesh.mesh import KINDS, Mesh

if TYPE_CHECKING:
    import skfem

_CLASSES = {
    "triangle": "MeshTri1",
    "quad": "MeshQuad1",
    "triangle6": "MeshTri2",
    "quad9": "MeshQuad2",
}


def to_skfem(mesh: Mesh) -> skfem.Mesh:
    """A scikit-fem mesh with named boundaries and subdomains.

    Parameters
    ----------
    mesh : Mesh
        A plane mesh with cells of one kind.

    Returns
    -------
    skfem.Mesh
        `MeshTri` or `MeshQuad` (of second order where the cells are). ``boundaries`` has an entry a
        name with all facets of that name, interfaces and embedded paths included; where some of
        them lie inside, they are an `OrientedBoundary` whose normals point out of the region on the
        facet's left. ``subdomains`` has an entry a region. Points and cells keep their numbers.

    Raises
    ------
    InputError
        If the cells are of several kinds, or not plane.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]},
    ...                facets={"line": [[0, 1]]}, facet_marker={"line": [0]},
    ...                boundary_names=[["wall"]])
    >>> cm.to_skfem(mesh).boundaries
    {'wall': array([0], dtype=int32)}
    """
    if not isinstance(mesh, Mesh):
        raise InputError(f"to_skfem needs a Mesh, as generate returns; got {type(mesh).__name__}")
    kinds = [kind for kind, rows in mesh.cells.items() if len(rows)]
    if len(kinds) != 1 or kinds[0] not in _CLASSES:
        raise InputError(f"to_skfem needs cells of one kind of {list(_CLASSES)}; got {kinds}")
    import skfem

    kind = kinds[0]
    rows = np.ascontiguousarray(mesh.cells[kind].T, np.int32)
    bare = getattr(skfem, _CLASSES[kind])(np.ascontiguousarray(mesh.points.T), rows)
    region = mesh.cell_region[kind]
    subdomains = {
        name: cells.astype(np.int32)
        for name, cells in members(region, [(n,) for n in mesh.region_names]).items()
    }
    return bare.with_boundaries(_boundaries(mesh, kind, bare)).with_subdomains(subdomains)


def _boundaries(mesh: Mesh, kind: str, bare: Any) -> dict[str, Any]:
    """Facets of scikit-fem's numbering by name, oriented where some have cells on both sides."""
    from skfem.generic_utils import OrientedBoundary

    edges = oriented_edges({kind: mesh.cells[kind]}, mesh.cell_region, mesh.n_points)
    # With second-order cells, scikit-fem keeps the corners' order but numbers them first.
    corners = np.unique(mesh.cells[kind][:, : KINDS[kind].n_corners])
    number = np.searchsorted(corners, np.arange(mesh.n_points))
    keys = bare.facets[0].astype(np.int64) * mesh.n_points + bare.facets[1]
    order = np.argsort(keys)
    parts: dict[str, list[np.ndarray]] = {}
    for facet_kind, rows in mesh.facets.items():
        left, right = edges.cells_beside(rows)
        ends = np.sort(number[rows[:, :2]], axis=1)
        facet = order[np.searchsorted(keys, ends[:, 0] * mesh.n_points + ends[:, 1], sorter=order)]
        side = np.where(bare.f2t[0, facet] == left, 0, 1)
        table = np.stack([facet, side, right >= 0], axis=1)
        for name, which in members(mesh.facet_marker[facet_kind], mesh.boundary_names).items():
            parts.setdefault(name, []).append(table[which])
    boundaries = {}
    for name in mesh.names:
        facet, side, inner = np.concatenate([np.zeros((0, 3), np.int64), *parts.get(name, [])]).T
        index = facet.astype(np.int32)
        boundaries[name] = OrientedBoundary(index, side) if inner.any() else index
    return {name: facets for name, facets in boundaries.items() if len(facets)}

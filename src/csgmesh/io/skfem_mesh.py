"""Meshes of the library scikit-fem."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.errors import InputError
from csgmesh.io.members import members
from csgmesh.io.sides import oriented_edges
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.faces import canonical_faces, faces_of

if TYPE_CHECKING:
    import skfem

_CLASSES = {
    "triangle": "MeshTri1",
    "quad": "MeshQuad1",
    "triangle6": "MeshTri2",
    "quad9": "MeshQuad2",
    "tetra": "MeshTet1",
    "tetra10": "MeshTet2",
    "hexahedron": "MeshHex1",
}

#: For each corner of scikit-fem's hexahedra the number of ours.
_HEXAHEDRON = [0, 4, 3, 1, 7, 5, 2, 6]


def to_skfem(mesh: Mesh) -> skfem.Mesh:
    """A scikit-fem mesh with named boundaries and subdomains.

    Parameters
    ----------
    mesh : Mesh
        With cells of one kind: triangles, quads, tetrahedra or hexahedra.

    Returns
    -------
    skfem.Mesh
        `MeshTri`, `MeshQuad`, `MeshTet` or `MeshHex` (of second order where the cells are).
        ``boundaries`` has an entry a name with all facets of that name, interfaces and embedded
        paths included; where some of them lie inside, they are an `OrientedBoundary` whose normals
        point out of the facet's first region. ``subdomains`` has an entry a region. Points of
        straight cells, and cells, keep their numbers.

    Raises
    ------
    InputError
        If the cells are of several kinds, or of one that scikit-fem does not have; its wedges do
        not tell triangles from quads among their facets.

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
    cells = mesh.cells[kind]
    if kind == "hexahedron":
        cells = cells[:, _HEXAHEDRON]
    rows = np.ascontiguousarray(cells.T, np.int32)
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

    table = _plane_facets if mesh.dim == 2 else _space_facets
    parts: dict[str, list[np.ndarray]] = {}
    for facet_kind, rows in table(mesh, kind, bare).items():
        for name, which in members(mesh.facet_marker[facet_kind], mesh.boundary_names).items():
            parts.setdefault(name, []).append(rows[which])
    boundaries = {}
    for name in mesh.names:
        facet, side, inner = np.concatenate([np.zeros((0, 3), np.int64), *parts.get(name, [])]).T
        index = facet.astype(np.int32)
        boundaries[name] = OrientedBoundary(index, side) if inner.any() else index
    return {name: facets for name, facets in boundaries.items() if len(facets)}


def _corner_numbers(mesh: Mesh, kind: str) -> np.ndarray:
    """Numbers of points in scikit-fem, which counts corners of second-order cells first."""
    corners = np.unique(mesh.cells[kind][:, : KINDS[kind].n_corners])
    return np.searchsorted(corners, np.arange(mesh.n_points))


def _plane_facets(mesh: Mesh, kind: str, bare: Any) -> dict[str, np.ndarray]:
    """For each facet of a plane mesh its number in scikit-fem, its side, and whether it is inside.

    The side is 0 if the cell on the facet's left comes first there, else 1.
    """
    edges = oriented_edges({kind: mesh.cells[kind]}, mesh.cell_region, mesh.n_points)
    number = _corner_numbers(mesh, kind)
    keys = bare.facets[0].astype(np.int64) * mesh.n_points + bare.facets[1]
    order = np.argsort(keys)
    tables = {}
    for facet_kind, rows in mesh.facets.items():
        left, right = edges.cells_beside(rows)
        ends = np.sort(number[rows[:, :2]], axis=1)
        facet = order[np.searchsorted(keys, ends[:, 0] * mesh.n_points + ends[:, 1], sorter=order)]
        tables[facet_kind] = np.stack([facet, bare.f2t[0, facet] != left, right >= 0], axis=1)
    return tables


def _space_facets(mesh: Mesh, kind: str, bare: Any) -> dict[str, np.ndarray]:
    """The same in space, where a facet's normal points out of the cell on its first side."""
    number = _corner_numbers(mesh, kind)
    faces = faces_of({kind: mesh.cells[kind]})
    theirs = np.sort(bare.facets.T.astype(np.int64), axis=1)
    tables = {}
    for facet_kind, rows in mesh.facets.items():
        corners = rows[:, : KINDS[facet_kind].n_corners]
        ordered, forwards = canonical_faces(corners)
        face = faces.find(ordered)
        first = np.where(forwards, faces.behind[face], faces.ahead[face])
        other = np.where(forwards, faces.ahead[face], faces.behind[face])
        both = np.concatenate([theirs, np.sort(number[corners], axis=1)])
        _, key = np.unique(both, axis=0, return_inverse=True)
        place = np.empty(len(both), np.int64)
        place[key.reshape(-1)[: len(theirs)]] = np.arange(len(theirs))
        facet = place[key.reshape(-1)[len(theirs) :]]
        tables[facet_kind] = np.stack([facet, bare.f2t[0, facet] != first, other >= 0], axis=1)
    return tables

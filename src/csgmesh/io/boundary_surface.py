"""The boundary of a mesh of space as triangles, and trimesh's and PyVista's meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.errors import InputError
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.faces import canonical_faces, faces_of
from csgmesh.mesh.surfaces import is_surface, with_facets

if TYPE_CHECKING:
    import trimesh

_NONE = np.zeros(0, np.int64)


@dataclass(frozen=True, eq=False)
class BoundarySurface:
    """Triangles on the boundary of a mesh, and between its regions.

    Attributes
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int64
        Counterclockwise seen from outside their first region.
    marker : (m,) int64
        Into the mesh's `boundary_names`, -1 for faces without a name.
    region : (m, 2) int64
        Regions behind and in front, -1 outside.
    """

    points: np.ndarray
    triangles: np.ndarray
    marker: np.ndarray
    region: np.ndarray

    def of(self, rows: np.ndarray, turned: np.ndarray | None = None) -> BoundarySurface:
        """Some of the triangles, over the points that they use; `turned` ones the other way."""
        triangles = self.triangles[rows]
        if turned is not None:
            triangles[turned] = triangles[turned][:, ::-1]
        used, number = np.unique(triangles, return_inverse=True)
        return BoundarySurface(
            self.points[used], number.reshape(-1, 3), self.marker[rows], self.region[rows]
        )


def boundary_surface(mesh: Mesh, *, interfaces: bool = False) -> BoundarySurface:
    """The outer boundary of a mesh of space, with or without the interfaces of its regions.

    Quads are cut along their shorter diagonals; curved faces count as straight ones. Of a mesh
    whose cells are triangles and quads in space, the surface is its facets, or the cells if it has
    none.

    Raises
    ------
    InputError
        If the mesh lies in the plane or has no cells.
    """
    if mesh.dim != 3:
        raise InputError("a surface needs a mesh of space; this one lies in the plane")
    solid = {k: v[:, : KINDS[k].n_corners] for k, v in mesh.cells.items() if KINDS[k].dim == 3}
    if not solid:
        rows, marker, region = _own_facets(mesh, interfaces)
    else:
        rows, marker, region = _faces(mesh, solid, interfaces)
    if not len(rows):
        raise InputError("a surface needs cells; this mesh has none")
    triangles, face = _triangulated(mesh.points, rows)
    whole = BoundarySurface(mesh.points, triangles, marker[face], region[face])
    return whole.of(np.arange(len(triangles)))


def _faces(
    mesh: Mesh, cells: dict[str, np.ndarray], interfaces: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Faces (f, 4), -1 last for triangles, out of their first region; markers and regions."""
    faces = faces_of(cells)
    of_cell = np.concatenate([*(mesh.cell_region[kind] for kind in cells), [-1]])
    behind, ahead = of_cell[faces.behind], of_cell[faces.ahead]
    marker = np.full(len(faces.points), -1)
    for kind, facet in mesh.facets.items():
        number = faces.find(canonical_faces(facet[:, : KINDS[kind].n_corners])[0])
        marker[number[number >= 0]] = mesh.facet_marker[kind][number >= 0]
    shown = faces.count == 1
    if interfaces:
        shown |= behind != ahead
    # Out of the region of lower number, and out of the solid.
    turned = (behind < 0) | ((ahead >= 0) & (ahead < behind))
    rows = faces.points.copy()
    quad = rows[:, 3] >= 0
    rows[turned & ~quad] = rows[turned & ~quad][:, [0, 2, 1, 3]]
    rows[turned & quad] = rows[turned & quad][:, [0, 3, 2, 1]]
    region = np.where(turned[:, None], np.column_stack([ahead, behind]),
                      np.column_stack([behind, ahead]))  # fmt: skip
    return rows[shown], marker[shown], region[shown]


def _own_facets(mesh: Mesh, interfaces: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Facets of a surface (f, 4), -1 last for triangles; markers and regions."""
    mesh = with_facets(mesh)
    rows, markers, regions = [np.zeros((0, 4), np.int64)], [_NONE], [np.zeros((0, 2), np.int64)]
    for kind, facets in mesh.facets.items():
        corners = facets[:, : KINDS[kind].n_corners]
        rows.append(np.column_stack([corners, np.full((len(corners), 4 - corners.shape[1]), -1)]))
        markers.append(mesh.facet_marker[kind])
        regions.append(mesh.facet_region[kind])
    table, marker, region = (np.concatenate(part) for part in (rows, markers, regions))
    shown = np.full(len(table), True) if interfaces else (region < 0).any(axis=1)
    return table[shown], marker[shown], region[shown]


def _triangulated(points: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles, and the face of each."""
    quad = np.flatnonzero(rows[:, 3] >= 0)
    a, b, c, d = (points[rows[quad, k]] for k in range(4))
    other = ((b - d) ** 2).sum(axis=1) < ((a - c) ** 2).sum(axis=1)
    first, second = rows[quad][:, [0, 1, 2]], rows[quad][:, [0, 2, 3]]
    first[other], second[other] = rows[quad[other]][:, [0, 1, 3]], rows[quad[other]][:, [1, 2, 3]]
    triangles = rows[:, :3].copy()
    triangles[quad] = first
    face = np.r_[np.arange(len(rows)), quad]
    order = np.argsort(face, kind="stable")
    return np.concatenate([triangles, second])[order], face[order]


def to_trimesh(mesh: Mesh, *, interfaces: bool = False) -> trimesh.Trimesh:
    """The boundary of a mesh of space as a `trimesh.Trimesh`.

    Parameters
    ----------
    mesh : Mesh
        Of space; quads are cut in two, curved faces count as straight.
    interfaces : bool
        Whether faces between two regions come along; the surface is closed without them.

    Returns
    -------
    trimesh.Trimesh
        Normals point outward, on interfaces out of the region of lower number.
        ``face_attributes["marker"]`` numbers ``metadata["boundary_names"]``, a list of lists of
        names (-1: none), ``face_attributes["region"]`` (m, 2) ``metadata["region_names"]``.

    Raises
    ------
    InputError
        If the mesh lies in the plane.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Box((0, 0, 0), (1, 2, 3)), cm.Sweep(cm.Structured()), size=1)
    >>> surface = cm.to_trimesh(mesh)
    >>> surface.is_watertight, float(surface.volume)
    (True, 6.0)
    >>> surface.metadata["boundary_names"][surface.face_attributes["marker"][0]]
    ['box.bottom']
    """
    if not isinstance(mesh, Mesh):
        raise InputError(f"to_trimesh needs a Mesh, as generate returns; got {type(mesh).__name__}")
    surface = boundary_surface(mesh, interfaces=interfaces)
    import trimesh

    return trimesh.Trimesh(
        surface.points,
        surface.triangles,
        process=False,
        face_attributes={"marker": surface.marker, "region": surface.region},
        metadata={
            "boundary_names": [list(names) for names in mesh.boundary_names],
            "region_names": list(mesh.region_names),
        },
    )


def to_pyvista(mesh: Mesh) -> Any:
    """A `pyvista.UnstructuredGrid` of the cells and named facets of a mesh.

    Parameters
    ----------
    mesh : Mesh
        Of the plane or of space, with cells of any kind.

    Returns
    -------
    pyvista.UnstructuredGrid
        Cells, then facets. Cell arrays ``region`` (-1 on facets) and ``marker`` (-1 on cells)
        number the field arrays ``region_names`` and ``boundary_names`` (names of one facet joined
        by commas); ``name`` is a text a cell: its region, or the names of a facet.

    Raises
    ------
    InputError
        If PyVista is not installed.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Box((0, 0, 0), (1, 1, 1)), cm.Sweep(cm.Structured()), size=0.5)
    >>> cm.to_pyvista(mesh).plot(scalars="region")                          # doctest: +SKIP
    """
    if not isinstance(mesh, Mesh):
        raise InputError(f"to_pyvista needs a Mesh, as generate returns; got {type(mesh).__name__}")
    try:
        import pyvista
    except ImportError:
        raise InputError(
            "to_pyvista needs the library PyVista, which is not installed: pip install pyvista"
        ) from None
    from csgmesh.mesh.lagrange import EQUISPACED
    from csgmesh.mesh.nodes import with_nodes

    mesh = with_nodes(mesh, EQUISPACED)
    is_skin = is_surface(mesh)
    mesh = with_facets(mesh) if is_skin else mesh
    grid = pyvista.UnstructuredGrid(*_vtk_cells(mesh, {} if is_skin else dict(mesh.cells)))
    if is_skin:
        region = np.concatenate([sides[:, 0] for sides in mesh.facet_region.values()])
        marker = np.concatenate([*mesh.facet_marker.values()])
    else:
        region = np.concatenate([*mesh.cell_region.values(), np.full(mesh.n_facets, -1)])
        marker = np.concatenate([np.full(mesh.n_cells, -1), *mesh.facet_marker.values()])
    joined = np.array([",".join(names) for names in mesh.boundary_names] + [""])
    regions = np.array([*mesh.region_names, ""])
    grid.cell_data["region"] = region
    grid.cell_data["marker"] = marker
    grid.cell_data["name"] = np.where(marker < 0, regions[region], joined[marker])
    grid.field_data["region_names"] = regions[:-1]
    grid.field_data["boundary_names"] = joined[:-1]
    return grid


def _vtk_cells(
    mesh: Mesh, cells: dict[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells, then facets, as VTK wants them: connectivity, types and points in space."""
    from csgmesh.io.vtk_kinds import VTK_TYPE, vtk_order

    connectivity, types = [], []
    for kind, rows in (*cells.items(), *mesh.facets.items()):
        order = vtk_order(kind)
        rows = rows if order is None else rows[:, order]
        connectivity.append(np.column_stack([np.full(len(rows), rows.shape[1]), rows]).ravel())
        types.append(np.full(len(rows), VTK_TYPE[kind], np.uint8))
    points = np.zeros((mesh.n_points, 3))
    points[:, : mesh.dim] = mesh.points
    return np.concatenate(connectivity), np.concatenate(types), points

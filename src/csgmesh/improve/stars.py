"""Stars of triangles and quads, whose vertices move to better places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh import kernels
from csgmesh.errors import InputError
from csgmesh.improve.boundary_vertices import FIXED, SLIDING, vertex_kinds
from csgmesh.mesh import Mesh

#: What the kernels move a vertex to.
NEIGHBOURS, CENTROIDS, BEST = 0, 1, 2
#: Rounds of the search for a vertex's best place.
ROUNDS = 12


class Stars:
    """A plane mesh of triangles, quads or both taken apart so that its vertices can move.

    The quality of a cell is its smallest scaled Jacobian, det / (|a| |b|) over the corners with
    edges a and b; of a triangle the sine of its smallest angle, over that of 60 degrees. No move
    lowers the worst quality of the cells around a vertex, none turns a cell over, and vertices of
    the boundary slide on their exact curves, or stay.

    Parameters
    ----------
    mesh : Mesh
    pinned : (k,) int64, optional
        Vertices that must not move.

    Examples
    --------
    Smooth a mesh of quads that a mesher has at hand, twice over all vertices:

    >>> from csgmesh.mesh import Mesh
    >>> points = [[0, 0], [1, 0], [2, 0], [0, 1], [1.6, 1.3], [2, 1], [0, 2], [1, 2], [2, 2]]
    >>> quads = [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]]
    >>> stars = Stars(Mesh(points, {"quad": quads}))
    >>> round(float(stars.qualities().min()), 2)
    0.22
    >>> _ = stars.move(BEST), stars.move(NEIGHBOURS)
    >>> stars.finished().points[4].round(2)
    array([1., 1.])
    """

    def __init__(self, mesh: Mesh, pinned: np.ndarray | None = None) -> None:
        if mesh.dim != 2 or set(mesh.cells) - {"triangle", "quad"} or set(mesh.facets) - {"line"}:
            held = ", ".join((*mesh.cells, *mesh.facets))
            raise InputError(
                "only plane meshes of straight triangles and quads can be smoothed; this one has "
                f"dim {mesh.dim} and holds {held}"
            )
        self.mesh = mesh
        blocks = list(mesh.cells.values())
        widths = np.concatenate([np.zeros(0, int), *(np.full(len(b), b.shape[1]) for b in blocks)])
        corner = np.concatenate([np.zeros(0, int), *(b.ravel() for b in blocks)]).astype(np.int32)
        begin = np.concatenate([[0], np.cumsum(widths)]).astype(np.int32)
        star, star_begin = np.empty(len(corner), np.int32), np.zeros(mesh.n_points + 1, np.int32)
        kernels.gather_stars(corner, star_begin, star)
        kind, around = vertex_kinds(mesh)
        if pinned is not None:
            kind[pinned] = FIXED
        curves = mesh.curves
        deviation = mesh.domain.deviation if mesh.domain is not None else 0.0
        self.arrays = kernels.Cells(
            xy=np.array(mesh.points).reshape(-1),
            corner=corner,
            begin=begin,
            owner=np.repeat(np.arange(len(widths), dtype=np.int32), widths),
            star=star,
            star_begin=star_begin,
            kind=kind,
            around=around.reshape(-1),
            interval=np.array(mesh.facet_interval.get("line", np.zeros((0, 2)))).reshape(-1),
            curve=mesh.facet_curve.get("line", np.zeros(0, np.int64)).astype(np.int32),
            curve_kind=np.zeros(0, np.int8) if curves is None else np.array(curves.kind),
            curve_data=np.zeros(0) if curves is None else np.array(curves.data).reshape(-1),
            number=np.array([deviation]),
            count=np.zeros(2, np.int64),
        )

    def qualities(self) -> np.ndarray:
        """Quality of each cell, counted through all kinds, (n_cells,)."""
        out = np.empty(len(self.arrays.begin) - 1)
        kernels.cell_qualities(self.arrays, out)
        return out

    def move(self, method: int, vertices: np.ndarray | None = None, rounds: int = ROUNDS) -> int:
        """Move vertices (default: all) once, in their order; how many moved.

        `method` is `NEIGHBOURS` (their mean), `CENTROIDS` (of the cells, weighted by area) or
        `BEST` (a search for the best worst quality).
        """
        count = self.arrays.count
        listed = np.arange(self.mesh.n_points) if vertices is None else vertices
        count[:] = 0
        while kernels.move_vertices(self.arrays, listed.astype(np.int32), method, rounds):
            pass
        return int(count[0])

    def vertices_of(self, cells: np.ndarray) -> np.ndarray:
        """Vertices of cells, sorted."""
        is_in = np.zeros(len(self.arrays.begin) - 1, bool)
        is_in[cells] = True
        found: np.ndarray = np.unique(self.arrays.corner[is_in[self.arrays.owner]])
        return found

    def cells_of(self, vertices: np.ndarray) -> np.ndarray:
        """Cells around vertices, sorted."""
        is_in = np.zeros(self.mesh.n_points, bool)
        is_in[vertices] = True
        found: np.ndarray = np.unique(self.arrays.owner[is_in[self.arrays.corner]])
        return found

    def slid(self) -> np.ndarray:
        """Sliding vertices that have moved."""
        moved = (self.arrays.xy.reshape(-1, 2) != self.mesh.points).any(axis=1)
        return np.flatnonzero(moved & (self.arrays.kind == SLIDING))

    def finished(self) -> Mesh:
        """The mesh as it is now."""
        intervals = {}
        if "line" in self.mesh.facets:
            intervals = {"line": self.arrays.interval.reshape(-1, 2)}
        points = self.arrays.xy.reshape(-1, 2)
        info = {**self.mesh.info, "delaunay": False}
        return replace(self.mesh, points=points, facet_interval=intervals, info=info)

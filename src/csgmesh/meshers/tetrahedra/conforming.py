"""Tetrahedra between a surface mesh and points inside it."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.errors import MeshingError
from csgmesh.meshers.tetrahedra.kept import Kept
from csgmesh.meshers.tetrahedra.net import MOST_POINTS, Net
from csgmesh.meshers.tetrahedra.result import Tetrahedra
from csgmesh.meshers.tetrahedra.slivers import peel
from csgmesh.meshers.tetrahedra.swaps import swap_missing

#: Triangles recovered late can make way for others that could not be recovered before them.
_PASSES = 4


def tetrahedralize(
    surface: SurfaceMesh, inner: np.ndarray, kept: np.ndarray | None = None
) -> Tetrahedra:
    """Tetrahedra of which every triangle of a surface mesh is a face.

    The Delaunay tetrahedra of all points, by insertion along a Hilbert curve in rounds (Amenta,
    Choi, Rote 2003; Bowyer and Watson 1981). Where they have the other diagonal of two triangles
    of a face that is nearly flat there, the surface gets it, too; what is missing then is recovered
    by flips.

    Parameters
    ----------
    surface : SurfaceMesh
    inner : (k, 3) float64
        Points inside the domain.
    kept : (t, 4) int64, optional
        Tetrahedra of the body-centred cubic lattice, in numbers of the inner points, of positive
        volume. Those that the surface leaves Delaunay go into the mesh as they are.

    Returns
    -------
    Tetrahedra
        Its `missing` triangles are none, or there are no tetrahedra, and the surface has to be
        finer at their `places`.

    Raises
    ------
    MeshingError
        If two points are the same, or the surface does not bound its regions.
    """
    inner = np.asarray(inner, float).reshape(-1, 3)
    points = np.vstack([surface.points, inner])
    if len(points) > MOST_POINTS:
        raise MeshingError(f"at most {MOST_POINTS} points fit into a mesh; there are {len(points)}")
    lattice = np.zeros((0, 4), np.int64) if kept is None else np.asarray(kept, np.int64)
    ready = Kept.of(lattice, len(inner))
    while True:
        filling = _Filling(surface, points, ready)
        bad = filling.not_delaunay()
        if not len(bad):
            return filling.result()
        ready = ready.without(bad)


class _Filling:
    """Delaunay tetrahedra of a surface's points and of those inside that kept ones leave over."""

    def __init__(self, surface: SurfaceMesh, points: np.ndarray, kept: Kept) -> None:
        self.surface, self.points, self.kept = surface, points, kept
        n = surface.n_points
        self.used = np.append(np.arange(n), n + np.flatnonzero(kept.is_inserted))
        number = np.zeros(len(points), np.int64)
        number[self.used] = np.arange(len(self.used))
        self.walls = number[kept.walls + n]
        self.net = Net(points[self.used], has_box=True)
        if not self.net.insert():
            raise MeshingError(self._twins())

    def not_delaunay(self) -> np.ndarray:
        """Kept tetrahedra that are not Delaunay beside what was found around them.

        A tetrahedralisation is Delaunay if each two neighbours are: only walls need a look.
        """
        self.stops = faces = self.net.faces(self.walls)
        is_there = faces >= 0
        walls, owner = self.walls[is_there], self.kept.owner[is_there]
        apex = self.net.vert[self.net.across(walls, faces[is_there])]
        n_used = len(self.used)
        vertex = self.net.order[apex]
        vertex = self.used[np.minimum(vertex, n_used - 1)]
        signs = kernels.in_spheres(
            self.points, self.kept.tets[owner] + self.surface.n_points, vertex
        )
        is_bad = (signs > 0) & (apex >= 0) & (self.net.order[apex] < n_used)
        return np.concatenate([self.kept.owner[~is_there], owner[is_bad]])

    def result(self) -> Tetrahedra:
        """The tetrahedra inside the surface, or what of the surface is missing."""
        surface, net = self.surface, self.net
        triangles, found = swap_missing(
            net, self.points, surface.triangles, surface.face, surface.segments
        )
        missing = np.flatnonzero(found < 0)
        for _ in range(_PASSES):
            if not len(missing) or not net.recover(np.vstack([triangles, self.walls]), missing):
                break
            found, self.stops = net.faces(triangles), net.faces(self.walls)
            missing = np.flatnonzero(found < 0)
        if len(missing):
            return Tetrahedra(
                self.points,
                np.zeros((0, 4), np.int64),
                np.zeros(0, np.int64),
                triangles,
                surface.face,
                missing,
                self.points[triangles[missing]].mean(axis=1),
            )
        return self._inside(triangles, found)

    def _inside(self, triangles: np.ndarray, found: np.ndarray) -> Tetrahedra:
        """Tetrahedra of all regions."""
        net, kept, surface = self.net, self.kept, self.surface
        label, status = self._flooded(triangles, found)
        rows, is_cell = net.cells()
        if status != -1:
            if status >= 0:
                place = self.points[triangles[status]].mean(axis=0)
            else:
                corners = net.order[rows[-2 - status, :3]]
                place = self.points[self.used[corners[corners < len(self.used)]]].mean(axis=0)
            raise MeshingError(f"the surface does not part its regions near {_text(place)}")
        triangles = self.used[peel(net, triangles, found, surface.face, surface.region, label)]
        keep = np.flatnonzero(is_cell & (label >= 0))
        outside = label[net.across(self.walls, self.stops) >> 2].astype(np.int64)
        tets = np.empty((len(keep) + len(kept.tets), 4), np.int64)
        tets[: len(keep)] = self.used[net.order[rows[keep]]]
        tets[len(keep) :] = kept.tets
        tets[len(keep) :] += surface.n_points
        region = np.empty(len(tets), np.int64)
        region[: len(keep)] = label[keep]
        region[len(keep) :] = kept.regions(outside)
        return Tetrahedra(self.points, tets, region, triangles, surface.face)

    def _flooded(self, triangles: np.ndarray, found: np.ndarray) -> tuple[np.ndarray, int]:
        """Region of each tetrahedron found, -2 where none leads, and what the kernel says.

        No triangle of the surface leads into pockets among kept tetrahedra: what lies around them
        does, once that is known from elsewhere.
        """
        net, kept, stops = self.net, self.kept, self.stops
        sides = self.surface.region
        label, status = net.flood(triangles, found, sides, stops)
        while status == -1 and len(stops):
            beyond = label[net.across(self.walls, stops) >> 2].astype(np.int64)
            if (beyond >= 0).all():
                break
            part = kept.parts()[kept.walls[:, 0]]
            around = np.full(len(kept.is_inserted), -1)
            around[part[beyond >= 0]] = beyond[beyond >= 0]
            known = (beyond < -1) & (around[part] >= 0)
            if not known.any():
                break
            triangles = np.vstack([triangles, self.walls[known]])
            here = np.stack([np.full(int(known.sum()), -1), around[part[known]]], axis=1)
            sides, found = np.vstack([sides, here]), np.append(found, stops[known])
            label, status = net.flood(triangles, found, sides, stops)
        return label, status

    def _twins(self) -> str:
        if self.net.twins is None:
            return f"all {len(self.points)} points of the surface lie in one plane"
        i, j = self.used[list(self.net.twins)]
        place = _text(self.points[i])
        return f"points of a surface mesh must differ; points {i} and {j} are both {place}"


def _text(point: np.ndarray) -> str:
    return "({:.12g}, {:.12g}, {:.12g})".format(*point)

"""Tetrahedra between a surface mesh and points inside it."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.errors import MeshingError
from csgmesh.meshers.tetrahedra.net import MOST_POINTS, Net
from csgmesh.meshers.tetrahedra.result import Tetrahedra
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
        Delaunay tetrahedra among the inner points, numbered after the surface's points.

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
    points = np.vstack([surface.points, np.asarray(inner, float).reshape(-1, 3)])
    if len(points) > MOST_POINTS:
        raise MeshingError(f"at most {MOST_POINTS} points fit into a mesh; there are {len(points)}")
    net = Net(points, has_box=True)
    if not net.insert():
        raise MeshingError(_twins(net, points))
    triangles, found = swap_missing(net, points, surface.triangles, surface.face, surface.segments)
    missing = np.flatnonzero(found < 0)
    for _ in range(_PASSES):
        if not len(missing) or not net.recover(triangles, missing):
            break
        missing = np.flatnonzero(net.faces(triangles) < 0)
    if len(missing):
        return Tetrahedra(
            points,
            np.zeros((0, 4), np.int64),
            np.zeros(0, np.int64),
            triangles,
            surface.face,
            missing,
            points[triangles[missing]].mean(axis=1),
        )
    tets, region = _inside(net, points, triangles, surface.region)
    return Tetrahedra(points, tets, region, triangles, surface.face)


def _inside(
    net: Net, points: np.ndarray, triangles: np.ndarray, sides: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Tetrahedra of all regions (m, 4) and their regions (m,)."""
    label, status = net.flood(triangles, sides)
    rows, is_cell = net.cells()
    if status != -1:
        if status >= 0:
            place = points[triangles[status]].mean(axis=0)
        else:
            corners = net.order[rows[-2 - status, :3]]
            place = points[corners[corners < len(points)]].mean(axis=0)
        raise MeshingError(f"the surface does not part its regions near {_text(place)}")
    keep = is_cell & (label >= 0)
    return net.order[rows[keep]], label[keep].astype(np.int64)


def _twins(net: Net, points: np.ndarray) -> str:
    if net.twins is None:
        return f"all {len(points)} points of the surface lie in one plane"
    i, j = net.twins
    return f"points of a surface mesh must differ; points {i} and {j} are both {_text(points[i])}"


def _text(point: np.ndarray) -> str:
    return "({:.12g}, {:.12g}, {:.12g})".format(*point)

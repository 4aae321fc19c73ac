"""The Delaunay mesh of points of the plane or of space."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from csgmesh.errors import InputError
from csgmesh.mesh import Mesh
from csgmesh.meshers.tetrahedra.net import MOST_POINTS, Net
from csgmesh.triangulation.points import CollinearError, DuplicateError, checked, triangulate


class CoplanarError(CollinearError):
    """All points lie in one plane."""


def delaunay(points: ArrayLike) -> Mesh:
    """The Delaunay mesh of points: no point lies inside the circle, or sphere, of a cell.

    Among all triangulations of the plane it has the largest smallest angle. Where more points lie
    on a circle or sphere than a cell has, it is one of several. Inserted along a Hilbert curve in
    rounds (Amenta, Choi, Rote 2003) by Bowyer and Watson (1981), with exact predicates (Shewchuk
    1997).

    Parameters
    ----------
    points : (n, 2) or (n, 3) array_like
        Points, all different.

    Returns
    -------
    Mesh
        With `points` as they were given, triangles or tetrahedra, and the facets of the convex
        hull, named ``hull``.

    Raises
    ------
    InputError
        If two points are the same, or all lie on one line, or in one plane of space.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.delaunay([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
    >>> mesh.n_cells, len(mesh.boundary("hull")["line"])
    (4, 4)
    >>> cm.delaunay([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 2, 2]])
    <Mesh 3D: 5 points, 2 tetras, 6 facets, regions: domain, boundaries: hull>
    """
    array = np.array(points, np.float64)
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise InputError(f"points must have shape (n, 2) or (n, 3); got {array.shape}")
    if array.shape[1] == 2:
        cells, hull = triangulate(checked(array))
        kind, facet = "triangle", "line"
    else:
        cells, hull = tetrahedra(checked(array))
        kind, facet = "tetra", "triangle"
    return Mesh(
        array,
        {kind: cells},
        facets={facet: hull},
        facet_marker={facet: np.zeros(len(hull), np.int64)},
        facet_region={facet: np.tile([0, -1], (len(hull), 1))},
        boundary_names=(("hull",),),
        info={"method": "delaunay", "delaunay": True},
    )


def tetrahedra(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Delaunay tetrahedra (m, 4) of points and the triangles (k, 3) of their hull."""
    n = len(points)
    if n < 4:
        raise CoplanarError(f"tetrahedra need four points; got {n}")
    if n > MOST_POINTS:
        raise InputError(f"at most {MOST_POINTS} points of space can be connected; got {n}")
    net = Net(points, has_box=False)
    if not net.insert():
        pair = _equal(points) if net.twins is None else net.twins
        if pair is None:
            raise CoplanarError(f"all {n} points lie in one plane, so there are no tetrahedra")
        place = ", ".join(f"{x:.12g}" for x in points[pair[0]])
        raise DuplicateError(
            f"points must differ; points {pair[0]} and {pair[1]} are both ({place})", pair
        )
    rows, is_cell = net.cells()
    ghosts = rows[(rows[:, 0] >= 0) & ~is_cell]
    return net.order[rows[is_cell]], net.order[ghosts[:, :3]]


def _equal(points: np.ndarray) -> tuple[int, int] | None:
    """Two points that are the same, if there are any."""
    order = np.lexsort(points.T)
    twins = np.flatnonzero((points[order[1:]] == points[order[:-1]]).all(axis=1))
    if not len(twins):
        return None
    i, j = sorted(order[twins[0] : twins[0] + 2].tolist())
    return i, j

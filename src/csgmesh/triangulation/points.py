"""The Delaunay triangulation of points, and its balls."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from csgmesh import kernels
from csgmesh.errors import InputError
from csgmesh.mesh import KINDS, Mesh
from csgmesh.tolerance import LARGEST

# What the kernel returns.
_ROOM, _SLICE, _DUPLICATE, _COLLINEAR = 1, 2, 4, 7
#: Triangles that a cavity may hold before its buffers have to grow.
_CAVITY = 512
#: Numbers of points share a 64-bit key with their place on a curve.
_MOST_POINTS = 2**28


class DuplicateError(InputError):
    """Two points are the same.

    Attributes
    ----------
    pair : tuple of int
        Numbers of the two.
    """

    def __init__(self, message: str, pair: tuple[int, int]) -> None:
        super().__init__(message)
        self.pair = pair


class CollinearError(InputError):
    """All points lie on one line."""


def plane_points(points: ArrayLike) -> np.ndarray:
    """Points as an array (n, 2) of finite numbers within the range of the predicates."""
    array = np.array(points, np.float64)
    if array.ndim != 2 or array.shape[1] != 2:
        raise InputError(f"points must have shape (n, 2); got {array.shape}")
    return checked(array)


def checked(array: np.ndarray) -> np.ndarray:
    """The same points (n, dim), if they are finite and within the range of the predicates."""
    bad = ~(np.abs(array) <= LARGEST).all(axis=1)
    if bad.any():
        at = int(bad.argmax())
        raise InputError(
            f"coordinates must be finite and at most {LARGEST:g} in magnitude; point {at} is "
            f"({', '.join(f'{x:g}' for x in array[at])})"
        )
    if len(array) > _MOST_POINTS:
        raise InputError(f"at most {_MOST_POINTS} points can be triangulated; got {len(array)}")
    return array


def triangulate(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Delaunay triangles (m, 3) of points and the edges (k, 2) of their hull, both to the left."""
    n = len(points)
    if n < 3:
        raise CollinearError(f"a triangulation needs three points; got {n}")
    order, _, xy = kernels.insertion_order(points)
    order = order.astype(np.int64)
    origin, twin, sub = (np.empty(4 * (2 * n + 8), np.int32) for _ in range(3))
    work, counts = np.empty((5, _CAVITY), np.int32), np.zeros(8, np.int64)
    while True:
        status = kernels.insert_points(xy, origin, twin, sub, work, counts, n)
        if status == _ROOM:
            wide = np.empty((5, 2 * work.shape[1]), np.int32)
            wide[:, : work.shape[1]] = work
            work = wide
        elif status != _SLICE:
            break
    if status == _DUPLICATE:
        i, j = sorted((int(order[counts[5]]), int(order[counts[0]])))
        x, y = points[i]
        raise DuplicateError(
            f"points must differ; points {i} and {j} are both ({x:.12g}, {y:.12g})", (i, j)
        )
    if status == _COLLINEAR:
        raise CollinearError(f"all {n} points lie on one line, so there are no triangles")
    rows = origin[: 4 * int(counts[1])].reshape(-1, 4)[:, :3]
    is_ghost = (rows < 0).any(axis=1)
    ghosts = rows[is_ghost]
    apex = (ghosts < 0).argmax(axis=1)
    number = np.arange(len(ghosts))
    # A ghost's edge runs with the outside on its left.
    hull = [ghosts[number, (apex + 2) % 3], ghosts[number, (apex + 1) % 3]]
    return order[rows[~is_ghost]], order[np.stack(hull, axis=1)]


def delaunay_balls(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Centres and radii of the circles through the corners of triangles.

    Of a Delaunay triangulation these are its Delaunay balls: no vertex lies inside one, and their
    centres are the vertices of the Voronoi diagram.

    Parameters
    ----------
    mesh : Mesh
        Plane, of triangles.

    Returns
    -------
    centres : (m, 2) float64
    radii : (m,) float64

    Raises
    ------
    InputError
        If the mesh holds anything but triangles.

    Examples
    --------
    >>> import csgmesh as cm
    >>> centres, radii = cm.delaunay_balls(cm.delaunay([[0, 0], [6, 0], [0, 8]]))
    >>> centres, radii
    (array([[3., 4.]]), array([5.]))
    """
    parts = [np.zeros((0, 3), np.int64)]
    for kind, rows in mesh.cells.items():
        if mesh.dim != 2 or KINDS[kind].n_corners != 3:
            raise InputError(f"only plane triangles have Delaunay balls; the mesh holds {kind}")
        parts.append(rows[:, :3])
    return circles(mesh.points, np.concatenate(parts))


def circles(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Circumcentres (m, 2) and circumradii (m,)."""
    a = points[triangles[:, 0]]
    u, v = points[triangles[:, 1]] - a, points[triangles[:, 2]] - a
    uu, vv = (u * u).sum(axis=1), (v * v).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 0.5 / (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        arm = np.stack([v[:, 1] * uu - u[:, 1] * vv, u[:, 0] * vv - v[:, 0] * uu], axis=1)
        arm *= scale[:, None]
    return a + arm, np.hypot(*arm.T)

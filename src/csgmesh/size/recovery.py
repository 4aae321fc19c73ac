"""Second derivatives of a solution known at vertices, and what linear interpolation misses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from csgmesh.mesh import Mesh

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

#: Neighbours that a quadratic is fitted to; fewer, as at a boundary, are joined by theirs.
ENOUGH = 6
#: Fits are steadied by this share of their largest moment, where neighbours are on one conic.
_RIDGE = 1e-12
#: Vertices fitted at a time, to bound the memory.
_BATCH = 50_000


def recovered_hessians(mesh: Mesh, values: np.ndarray) -> np.ndarray:
    """Second derivatives at the vertices of a mesh of triangles, by polynomial fits to patches.

    Around each vertex a quadratic through its value is fitted to those of its neighbours by least
    squares, and of their neighbours where the first are few. Quadratics are recovered exactly, at
    the boundary too.

    Parameters
    ----------
    mesh : Mesh
        Of triangles.
    values : (n_points,) float64
        Of a continuous function that is linear in the triangles.

    Returns
    -------
    (n_points, 3) float64
        ``u_xx, u_xy, u_yy``; 0 at points of no triangle.

    References
    ----------
    .. [1] Z. Zhang, A. Naga, "A new finite element gradient recovery method: superconvergence
       property", SIAM J. Scientific Computing 26 (2005).

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Box((0, 0), (1, 1)), size=0.2)
    >>> x, y = mesh.points.T
    >>> recovered_hessians(mesh, x**2 - 3 * x * y)[7].round(6) + 0.0
    array([ 2., -3.,  0.])
    """
    patches = _patches(mesh)
    out = np.zeros((mesh.n_points, 3))
    for start in range(0, mesh.n_points, _BATCH):
        rows = patches[start : start + _BATCH]
        out[start : start + _BATCH] = _fits(mesh.points, values, start, rows)
    return out


def _patches(mesh: Mesh) -> csr_matrix:
    """For each vertex the vertices that its quadratic is fitted to."""
    from scipy.sparse import coo_matrix, csr_matrix, diags

    corners = mesh.cells["triangle"]
    i = corners.T.ravel()
    j = np.roll(corners, -1, axis=1).T.ravel()
    n = mesh.n_points
    near = coo_matrix((np.ones(len(i)), (i, j)), shape=(n, n)).tocsr()
    near = near + near.T
    near.data[:] = 1.0
    few = np.diff(near.indptr) < ENOUGH
    # On a boundary all neighbours lie on one side, however many they are.
    few[_boundary(mesh)] = True
    wide = diags(few.astype(float)) @ near
    both = csr_matrix(near + wide @ near)
    both.setdiag(0.0)
    both.eliminate_zeros()
    return both


def _boundary(mesh: Mesh) -> np.ndarray:
    from csgmesh.size.background import outer_edges

    return np.unique(outer_edges(mesh))


def _fits(points: np.ndarray, values: np.ndarray, start: int, rows: csr_matrix) -> np.ndarray:
    """Second derivatives of the quadratics fitted around the vertices from `start` on."""
    n = rows.shape[0]
    centre = np.repeat(np.arange(n), np.diff(rows.indptr))
    other = rows.indices
    away = points[other] - points[start + centre]
    count = np.maximum(np.bincount(centre, minlength=n), 1)
    scale = np.sqrt(np.bincount(centre, (away**2).sum(axis=1), n) / count)
    scale[scale == 0] = 1.0
    x, y = (away / scale[centre, None]).T
    terms = (x, y, 0.5 * x * x, x * y, 0.5 * y * y)
    rise = values[other] - values[start + centre]
    normal = np.empty((n, 5, 5))
    right = np.empty((n, 5, 1))
    for a, term in enumerate(terms):
        right[:, a, 0] = np.bincount(centre, term * rise, n)
        for b in range(a, 5):
            normal[:, a, b] = normal[:, b, a] = np.bincount(centre, term * terms[b], n)
    normal += (
        _RIDGE * np.maximum(np.trace(normal, axis1=1, axis2=2), 1e-30)[:, None, None] * (np.eye(5))
    )
    return np.linalg.solve(normal, right)[:, 2:, 0] / scale[:, None] ** 2


def largest_modulus(hessians: np.ndarray) -> np.ndarray:
    """Largest modulus of the eigenvalues of symmetric matrices (n, 3), as (n,).

    Examples
    --------
    >>> largest_modulus(np.array([[1.0, 0.0, -3.0]]))
    array([3.])
    """
    xx, xy, yy = hessians.T
    return np.abs(0.5 * (xx + yy)) + np.hypot(0.5 * (xx - yy), xy)


def cell_errors(mesh: Mesh, hessians: np.ndarray, norm: str) -> np.ndarray:
    """What linear interpolation misses in each triangle, (n_cells,), in the norm given.

    Exact for a quadratic with the mean second derivatives of the triangle's corners: in ``"L2"``
    and ``"H1"`` the root of the integrals over the triangle, in ``"max"`` an upper bound.
    """
    corners = mesh.cells["triangle"]
    mean = hessians[corners].mean(axis=1)
    p = mesh.points[corners]
    edge = np.roll(p, -1, axis=1) - p
    x, y = edge[..., 0], edge[..., 1]
    # Second differences along the edges; the error is -1/2 of the sum of s_ij phi_i phi_j.
    s = mean[:, :1] * x * x + 2 * mean[:, 1:2] * x * y + mean[:, 2:] * y * y
    area = 0.5 * np.abs(x[:, 0] * y[:, 1] - y[:, 0] * x[:, 1])
    if norm == "L2":
        return np.sqrt(area * ((s * s).sum(axis=1) + s.sum(axis=1) ** 2) / 720)
    if norm == "max":
        return np.maximum(np.abs(s).max(axis=1) / 8, np.abs(s.sum(axis=1)) / 18)
    # Gradient of phi_k: a quarter turn of the opposite edge, over twice the area.
    turned = np.stack([-np.roll(y, -1, axis=1), np.roll(x, -1, axis=1)], axis=2)
    turned /= 2 * area[:, None, None]
    total = np.zeros(len(corners))
    for k in range(3):
        # In the middle of edge k, between corners k and k + 1: phi = (1/2, 1/2, 0) there.
        a, b, c = k, (k + 1) % 3, (k + 2) % 3
        slope = s[:, k, None] * 0.5 * (turned[:, a] + turned[:, b])
        slope += 0.5 * s[:, b, None] * turned[:, c] + 0.5 * s[:, c, None] * turned[:, c]
        total += 0.25 * (slope * slope).sum(axis=1)
    return np.sqrt(area / 3 * total)


def total_error(errors: np.ndarray, norm: str) -> float:
    """The error of all cells together."""
    if not len(errors):
        return 0.0
    return float(errors.max()) if norm == "max" else float(np.sqrt((errors**2).sum()))

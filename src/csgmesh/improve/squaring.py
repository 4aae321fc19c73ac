"""Make quads squares: vertices descend the energy of the corners around them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from csgmesh import kernels
from csgmesh.mesh import Mesh

#: Sweeps end when fewer than this share of the vertices still move.
FEW = 0.01


def square_up(
    mesh: Mesh, sweeps: int = 10, progress: Callable[[str, int, int], None] | None = None
) -> Mesh:
    """Move inner vertices of a mesh of quads so that the quads become squares.

    Each vertex descends the sum over the corners around it of SICN⁻², which is infinite where a
    corner is about to turn over: none ever does, and some that were turned over are put right.

    Parameters
    ----------
    mesh : Mesh
        Of quads.
    sweeps : int, default 10
        How often to go through all vertices that are not in place yet.
    progress : callable, optional
        Called as ``progress(stage, done, total)``.

    References
    ----------
    .. [1] P. M. Knupp, "Achieving finite element mesh quality via optimization of the Jacobian
       matrix norm and associated quantities", Int. J. Numerical Methods in Engineering 48 (2000).

    Examples
    --------
    >>> from csgmesh.mesh import Mesh
    >>> points = [[0, 0], [1, 0], [2, 0], [0, 1], [1.6, 1.3], [2, 1], [0, 2], [1, 2], [2, 2]]
    >>> quads = [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]]
    >>> facets = {"line": [[0, 1], [1, 2], [2, 5], [5, 8], [8, 7], [7, 6], [6, 3], [3, 0]]}
    >>> square_up(Mesh(points, {"quad": quads}, facets=facets)).points[4].round(2)
    array([1., 1.])
    """
    quads = mesh.cells["quad"]
    n = mesh.n_points
    corner = quads.ravel()
    begins = np.concatenate([[0], np.cumsum(np.bincount(corner, minlength=n))]).astype(np.int32)
    order = np.argsort(corner, kind="stable")
    cell, k = order // 4, order % 4
    rings = np.stack([quads[cell, (k + j) % 4] for j in (1, 2, 3)], axis=1).astype(np.int32)
    is_free = np.diff(begins) > 0
    for rows in mesh.facets.values():
        is_free[rows.ravel()] = False
    is_free[mesh.point_marker >= 0] = False
    todo = np.flatnonzero(is_free).astype(np.int32)
    points, flat = np.array(mesh.points).reshape(-1), rings.reshape(-1)
    near = np.zeros(n, bool)
    total = len(todo)
    for sweep in range(sweeps):
        if progress is not None:
            progress("square up", sweep, sweeps)
        moved = np.zeros(len(todo), np.int8)
        at = 0
        while at >= 0 and len(todo):
            at = kernels.square_up(points, flat, begins, todo, moved, at)
        changed = todo[moved > 0]
        if len(changed) <= FEW * total:
            break
        # Only what moved, and its neighbours, can still be out of place.
        near[:] = False
        near[changed] = True
        near[quads[near[quads].any(axis=1)]] = True
        todo = np.flatnonzero(near & is_free).astype(np.int32)
    return replace(mesh, points=points.reshape(-1, 2))

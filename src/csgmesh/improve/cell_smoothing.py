"""Smooth the inner vertices of hexahedra, wedges, pyramids, and what they are mixed with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh.errors import InputError
from csgmesh.measures.space.quality import space_quality
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.faces import faces_of

#: How often a step is halved, and how often vertices are taken back, before all stay.
HALVINGS = 3
ROUNDS = 12


def smooth_cells(mesh: Mesh, method: str, sweeps: int) -> Mesh:
    """Move the inner vertices of a mesh of space of any straight cells; see `csgmesh.smooth`.

    All move at once; those whose worst cell gets worse go half the way, a quarter, or back.
    """
    if method == "optimize" or any(
        rows.shape[1] > KINDS[kind].n_corners for kind, rows in mesh.cells.items()
    ):
        raise InputError(
            f"in space {method!r} is for straight tetrahedra, laplace and odt for straight cells; "
            f"this mesh holds {', '.join(mesh.cells) or 'no cells'}"
        )
    free = _inner_vertices(mesh)
    points = np.array(mesh.points)
    worth = _worst_around(mesh, points)
    for _ in range(sweeps):
        aim = _neighbour_means(mesh, points) if method == "laplace" else _centroids(mesh, points)
        step = np.where(free[:, None], aim - points, 0.0)
        share = np.where(free, 1.0, 0.0)
        for turn in range(ROUNDS):
            new = points + share[:, None] * step
            after = _worst_around(mesh, new)
            worse = (after < worth) & _near_moved(mesh, share > 0.0)
            if not worse.any():
                points, worth = new, after
                break
            share[_near_moved(mesh, worse)] *= 0.5 if turn < HALVINGS else 0.0
    return replace(mesh, points=points)


def _some(mesh: Mesh) -> list[tuple[str, np.ndarray]]:
    return [(kind, rows) for kind, rows in mesh.cells.items() if len(rows)]


def _inner_vertices(mesh: Mesh) -> np.ndarray:
    """Vertices on no facet, no outer face and no face between regions, (n,) bool."""
    free = mesh.point_marker < 0
    for rows in mesh.facets.values():
        free[rows] = False
    faces = faces_of(mesh.cells)
    region = np.concatenate([*mesh.cell_region.values(), [-1]])
    corners = faces.points[region[faces.behind] != region[faces.ahead]]
    free[corners[corners >= 0]] = False
    return free


def _worst_around(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """For each vertex how far the dihedral angles around it keep from 0 and 180 degrees, (n,).

    Negative beside a cell whose Jacobian is not positive all over.
    """
    measured = space_quality(replace(mesh, points=points, domain=None))
    worth = np.minimum(measured.min_dihedral, 180.0 - measured.max_dihedral)
    worth = np.where(measured.min_jacobian > 0.0, worth, -1.0)
    out, before = np.full(mesh.n_points, np.inf), 0
    for _, rows in _some(mesh):
        own = worth[before : before + len(rows)]
        for corner in rows.T:
            np.minimum.at(out, corner, own)
        before += len(rows)
    return out


def _near_moved(mesh: Mesh, marked: np.ndarray) -> np.ndarray:
    """Vertices of cells with a marked one, (n,) bool."""
    out = np.zeros(mesh.n_points, bool)
    for _, rows in _some(mesh):
        out[rows[marked[rows].any(axis=1)]] = True
    return out


def _neighbour_means(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """The mean of the neighbours along edges of each vertex, (n, 3)."""
    pairs = [rows[:, list(edge)] for kind, rows in _some(mesh) for edge in KINDS[kind].edges]
    ends = np.concatenate([np.concatenate(pairs), np.concatenate(pairs)[:, ::-1]])
    ends = np.unique(ends, axis=0)
    return _means(mesh.n_points, ends[:, 0], points[ends[:, 1]], np.ones(len(ends)))


def _centroids(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """The mean of the centres of the cells around each vertex, weighted by volume, (n, 3)."""
    volume = space_quality(replace(mesh, points=points, domain=None)).volume
    vertex, place, weight, before = [], [], [], 0
    for _, rows in _some(mesh):
        own = volume[before : before + len(rows)]
        vertex.append(rows.ravel())
        place.append(np.repeat(points[rows].mean(axis=1), rows.shape[1], axis=0))
        weight.append(np.repeat(own, rows.shape[1]))
        before += len(rows)
    return _means(mesh.n_points, *(np.concatenate(part) for part in (vertex, place, weight)))


def _means(n: int, at: np.ndarray, places: np.ndarray, weights: np.ndarray) -> np.ndarray:
    total = np.maximum(np.bincount(at, weights, n), 1e-300)
    sums = [np.bincount(at, weights * places[:, k], n) for k in range(3)]
    return np.asarray(np.column_stack(sums) / total[:, None])

"""Smooth a mesh of tetrahedra."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh import kernels
from csgmesh.domain.surface_mesh import ON_CURVE, ON_FACE, SurfaceMesh
from csgmesh.improve.strata import strata_of
from csgmesh.improve.tetrahedra.chords import Chords
from csgmesh.improve.tetrahedra.improving import FAST_PASSES, Progress, improve_tetrahedra, shapes
from csgmesh.improve.tetrahedra.piece import DONE, NEXT, WISHES, Piece
from csgmesh.mesh import Mesh

#: Better than any shape: all cells are taken.
_ALL = 2.0


def smooth_tetrahedra(mesh: Mesh, method: str, sweeps: int, progress: Progress | None) -> Mesh:
    """Move the vertices of a mesh of tetrahedra; see `csgmesh.smooth`."""
    surface, number = strata_of(mesh)
    order = np.argsort(number)
    points, tets = mesh.points[order], number[mesh.cells["tetra"]]
    region = np.array(mesh.cell_region["tetra"])
    triangles, face = np.array(surface.triangles), np.array(surface.face)
    if method == "optimize":
        points, tets, region, triangles, face = improve_tetrahedra(
            *(points, tets, region, triangles, face, surface),
            passes=FAST_PASSES,
            progress=progress,
        )
    else:
        chords = Chords(triangles, face, surface)
        scores = shapes(points, tets)
        piece = Piece(points, tets, region, scores, chords, True, np.full(3, _ALL))
        _sweep(piece, surface, method == "odt", sweeps, progress)
        points = piece.put_back(points, tets, region, scores)[0]
    facets = {"triangle": order[triangles]} if "triangle" in mesh.facets else {}
    lineage = {} if method == "optimize" else {"tetra": mesh.cell_parent.get("tetra")}
    return replace(
        mesh,
        points=points[number],
        cells={"tetra": order[tets]},
        cell_region={"tetra": region},
        cell_parent={kind: rows for kind, rows in lineage.items() if rows is not None},
        facets=facets,
    )


def _sweep(
    piece: Piece, surface: SurfaceMesh, optimal: bool, sweeps: int, progress: Progress | None
) -> None:
    a = piece.arrays
    marks = np.full(len(a.kind), -1, np.int32)
    sets = _independent_sets(surface)
    local = np.searchsorted(piece.vertices, np.arange(surface.n_points))
    for sweep in range(sweeps):
        if progress is not None:
            progress("smooth", sweep, sweeps)
        a.count[[NEXT, DONE]] = 0
        while kernels.centre_vertices(a, int(optimal), marks):
            pass
        moved = int(a.count[DONE])
        for vertices in sets:
            n = len(vertices)
            points = a.xyz.reshape(-1, 3)[local]
            a.count[WISHES] = n
            a.wish[:n] = local[vertices]
            a.moves.reshape(-1, 3)[:n] = _surface_means(surface, points)[vertices]
            moved += piece.settle(kernels.settle_moves)
        if not moved:
            return


def _independent_sets(surface: SurfaceMesh) -> list[np.ndarray]:
    """The points that slide in sets, none with two of one triangle."""
    n, triangles = surface.n_points, surface.triangles
    rank = np.random.default_rng(0).permutation(n)
    waiting = (surface.point_dim == ON_FACE) | (surface.point_dim == ON_CURVE)
    sets = []
    while waiting.any():
        seen = np.where(waiting, rank, n)
        least = np.full(n, n)
        for corners in triangles.T:
            np.minimum.at(least, corners, seen[triangles].min(axis=1))
        chosen = np.flatnonzero(waiting & (least == rank))
        waiting[chosen] = False
        sets.append(chosen)
    return sets


def _surface_means(surface: SurfaceMesh, points: np.ndarray) -> np.ndarray:
    """Means of the neighbours of each point in its face, or of both neighbours on its curve."""
    n = surface.n_points
    total, count = np.zeros((n, 3)), np.zeros(n)
    edges = surface.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges = edges[surface.point_dim[edges[:, 0]] == ON_FACE]
    ends = surface.segments
    along = np.concatenate([ends, ends[:, ::-1]])
    along = along[surface.point_dim[along[:, 0]] == ON_CURVE]
    edges = np.concatenate([edges, along])
    np.add.at(total, edges[:, 0], points[edges[:, 1]])
    np.add.at(count, edges[:, 0], 1.0)
    return np.asarray(total / np.maximum(count, 1.0)[:, None])

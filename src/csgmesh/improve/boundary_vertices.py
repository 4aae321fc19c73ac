"""Which vertices of a mesh may move: freely, along a curve, or not at all."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.improve.cell_edges import CellEdges
from csgmesh.mesh import Mesh

# Kinds of vertices, as the kernels number them.
FREE, SLIDING, FIXED = 0, 1, 2


def vertex_kinds(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Kind of each vertex, and the facets before and behind each sliding one.

    Returns
    -------
    kind : (n,) int8
    around : (n, 2) int32
    """
    facets = mesh.facets.get("line", np.zeros((0, 2), np.int64))
    kind = np.full(mesh.n_points, FREE, np.int8)
    around = np.full((mesh.n_points, 2), -1, np.int32)
    if len(facets):
        classify_boundary(mesh, facets, kind, around)
    edges = CellEdges.of(list(mesh.cells.values()), facets, mesh.n_points)
    side = np.full(2 * edges.n_edges, -1)
    kernels.cells_of_edges(edges.begin, edges.edge, side)
    region = np.concatenate([*mesh.cell_region.values(), [-1]])[side.reshape(-1, 2)]
    bare = region[:, 0] != region[:, 1]
    bare[edges.facet_edge] = False
    kind[edges.ends[bare]] = FIXED
    return kind, around


def classify_boundary(mesh: Mesh, facets: np.ndarray, kind: np.ndarray, around: np.ndarray) -> None:
    """Fix what is on facets, but for vertices between two facets of one curve and one marker."""
    n = mesh.n_points
    n_facets = np.bincount(facets.ravel(), minlength=n)
    kind[n_facets > 0] = FIXED
    stays = mesh.point_marker >= 0
    # Matching points could only move together.
    for pair in mesh.periodic:
        stays[pair.points] = True
    kind[stays] = FIXED
    number = np.arange(len(facets), dtype=np.int32)
    around[facets[:, 1], 0] = number
    around[facets[:, 0], 1] = number
    if mesh.curves is None:
        return
    at = np.flatnonzero((n_facets == 2) & (around >= 0).all(axis=1) & ~stays)
    f, g = around[at].T
    curve, t = mesh.facet_curve["line"], mesh.facet_interval["line"]
    sides, marker = mesh.facet_region["line"], mesh.facet_marker["line"]
    same = (curve[f] == curve[g]) & (curve[f] >= 0) & (marker[f] == marker[g])
    same &= (sides[f] == sides[g]).all(axis=1) & (t[f, 1] == t[g, 0])
    same &= (t[f, 1] - t[f, 0]) * (t[g, 1] - t[g, 0]) > 0
    kind[at[same]] = SLIDING

"""The worst cells of a mesh of space."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from csgmesh.errors import InputError
from csgmesh.measures import quality
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.faces import canonical_faces, faces_of
from csgmesh.mesh.surfaces import is_surface
from csgmesh.mesh.topology import edge_ends
from csgmesh.meshers.worst.lowest import JUMP, lowest, mean_edges

#: Facets that meet at less than this in one cell leave it no better angle, degrees.
SHARP = 40.0


def worst_solids(mesh: Mesh, count: int) -> list[dict[str, object]]:
    """See `worst_cells`."""
    if is_surface(mesh) or not mesh.n_cells:
        raise InputError("worst_cells needs cells that fill space; this mesh has none")
    angle = quality(mesh).min_dihedral
    worst = lowest(angle, count)
    cells = {kind: rows[:, : KINDS[kind].n_corners] for kind, rows in mesh.cells.items()}
    mean = mean_edges(mesh.points, *edge_ends(cells, mesh.n_points).T)
    on_boundary = np.zeros(mesh.n_points, bool)
    for rows in mesh.facets.values():
        on_boundary[rows] = True
    reasons = np.full(mesh.n_cells, "lattice", object)
    places = np.empty((mesh.n_cells, 3))
    first = 0
    for kind, rows in cells.items():
        own = worst[(worst >= first) & (worst < first + len(rows))]
        some = rows[own - first]
        first += len(rows)
        places[own] = mesh.points[some].mean(axis=1)
        jump = mean[some].max(axis=1) > JUMP * mean[some].min(axis=1)
        reasons[own[jump]] = "size jump"
        reasons[own[on_boundary[some].all(axis=1)]] = "thin wall"
        reasons[own[_fills_an_edge(mesh, kind, some)]] = "sharp edge"
    return [
        {"place": places[cell].tolist(), "angle": float(angle[cell]), "reason": reasons[cell]}
        for cell in worst.tolist()
    ]


def _fills_an_edge(mesh: Mesh, kind: str, rows: np.ndarray) -> np.ndarray:
    """Which cells have two facets of the boundary for faces that meet sharply, (k,) bool."""
    base = KINDS[kind].straight
    faces = faces_of({base: rows})
    bounds = np.zeros(len(faces.points) + 1, bool)
    for facet_kind, facets in mesh.facets.items():
        bounds[faces.find(canonical_faces(facets[:, : KINDS[facet_kind].n_corners])[0])] = True
    # What is no face of these cells was written there.
    bounds[-1] = False
    kinds = KINDS[base].facet_kinds
    sides = [list(f[: KINDS[k].n_corners]) for f, k in zip(KINDS[base].facets, kinds, strict=True)]
    is_facet = [bounds[faces.find(canonical_faces(rows[:, side])[0])] for side in sides]
    normals = [_normals(mesh.points[rows[:, side]]) for side in sides]
    found = np.zeros(len(rows), bool)
    for i, j in combinations(range(len(sides)), 2):
        if len({*sides[i]} & {*sides[j]}) == 2:
            is_sharp = (normals[i] * normals[j]).sum(axis=1) < -np.cos(np.radians(SHARP))
            found |= is_facet[i] & is_facet[j] & is_sharp
    return found


def _normals(corners: np.ndarray) -> np.ndarray:
    """Unit normals of triangles and quads by their diagonals or sides, (k, 3)."""
    far = corners[:, 3] if corners.shape[1] == 4 else corners[:, 0]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 1] - far)
    return normal / np.maximum(np.sqrt((normal**2).sum(axis=1)), 1e-300)[:, None]

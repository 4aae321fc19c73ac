"""Triangles, mixed cells and quads of what a run of the quadtree mesher has made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh.improve.squaring import square_up
from csgmesh.mesh import Mesh
from csgmesh.mesh.topology import edges_of
from csgmesh.meshers.quad_pairing.matching import Pairing, pair
from csgmesh.meshers.quad_pairing.splitting import split
from csgmesh.meshers.quadtree_run import Run
from csgmesh.meshers.workspace import Progress

#: Quads at an input angle below this many degrees may be as sharp.
EXCUSED = 30.0
SWEEPS = 10


def triangle_mesh(run: Run, info: dict[str, object]) -> Mesh:
    """Triangles only."""
    _, _, cells, regions = run.cells(quads=False)
    return run.mesh({"triangle": cells}, {"triangle": regions}, info)


def mixed_mesh(run: Run, info: dict[str, object]) -> Mesh:
    """Squares inside, and pairs of triangles of the strip and of fans where they fit together."""
    corners, regions = _paired(run)
    is_quad = corners[:, 3] >= 0
    cells = {"quad": corners[is_quad], "triangle": np.ascontiguousarray(corners[~is_quad, :3])}
    of = {"quad": regions[is_quad], "triangle": regions[~is_quad]}
    kept = [kind for kind, rows in cells.items() if len(rows)]
    return run.mesh({k: cells[k] for k in kept}, {k: of[k] for k in kept}, info)


def quad_mesh(run: Run, info: dict[str, object], progress: Progress | None) -> Mesh:
    """Quads only: mixed cells of twice the size, each halved along both directions."""
    corners, regions = _paired(run)
    coarse = run.mesh({}, {}, info)
    n = len(run.points)
    is_quad = corners[:, 3] >= 0
    edges = edges_of({"quad": corners[is_quad], "triangle": corners[~is_quad, :3]}, n)
    of_cell = np.full((len(corners), 4), -1)
    m = 4 * int(is_quad.sum())
    of_cell[is_quad] = edges.half_edge_edge[:m].reshape(-1, 4)
    of_cell[~is_quad, :3] = edges.half_edge_edge[m:].reshape(-1, 3)
    facet = np.full(len(edges.points), -1)
    lines = coarse.facets["line"]
    facet[edges.find(lines)] = np.arange(len(lines))
    pairing = Pairing(corners, of_cell, regions, edges.points, facet)
    info = {**info, "n_left_over": int((~is_quad).sum())}
    mesh = square_up(split(coarse, pairing, run.domain, info), SWEEPS, progress)
    return replace(mesh, info={**mesh.info, "excused": _excused(run, mesh)})


def _paired(run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Corners (c, 4) of quads and triangles, -1 behind those of triangles, and their regions."""
    squares, square_of, cells, regions = run.cells(quads=True)
    part = run.mesh({"triangle": cells}, {"triangle": regions}, {})
    pairing = pair(part)
    return np.concatenate([squares, pairing.corners]), np.concatenate([square_of, pairing.region])


def _excused(run: Run, mesh: Mesh) -> int:
    """How many quads have a corner at an input angle below 30 degrees."""
    sharp = run.corners.vertex[run.corners.angle < EXCUSED]
    at = np.flatnonzero(np.isin(run.samples.kept, sharp))
    return int(np.isin(mesh.cells["quad"], at).any(axis=1).sum())

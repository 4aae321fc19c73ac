"""Make room where new boundary vertices have moved from their chords onto exact curves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh.errors import MeshingError
from csgmesh.improve.stars import BEST, Stars
from csgmesh.mesh import Mesh

#: Sweeps over the vertices near cells that were bent too much.
SWEEPS = 6


def make_room(
    mesh: Mesh, bent: np.ndarray, first_new: int, cells: np.ndarray, wanted: np.ndarray
) -> Mesh:
    """Move vertices near bent facets until the cells there are as good as they should be.

    Parameters
    ----------
    mesh : Mesh
    bent : (k,) int64
        Vertices that have moved onto curves.
    first_new : int
        Vertices from this one on are new: these move first.
    cells : (m,) int64
        Where to look: all cells around the neighbours of `bent`, and perhaps more; sorted.
    wanted : (m,) float64
        Sine of the angle that each of these should have no corner below.

    Raises
    ------
    MeshingError
        If a cell stays turned over; with its place.
    """
    patch, number, width = _patch(mesh, cells)
    stars = Stars(patch)
    goal = np.where(width == 3, wanted / np.sin(np.pi / 3), wanted) - 1e-9
    is_bent = np.isin(number, bent)
    beside = stars.vertices_of(stars.cells_of(np.flatnonzero(is_bent)))
    may_move = np.zeros(len(number), bool)
    may_move[beside] = True
    may_move[stars.arrays.kind > 0] = False
    for sweep in range(SWEEPS):
        bad = np.flatnonzero(stars.qualities() < goal)
        if not len(bad):
            break
        vertices = stars.vertices_of(bad)
        only_new = sweep < SWEEPS // 2
        movable = may_move[vertices] & ((number[vertices] >= first_new) | (not only_new))
        if not stars.move(BEST, vertices[movable]) and not only_new:
            break
    worst = stars.qualities()
    if len(worst) and worst.min() <= 0.0:
        x, y = _middle(mesh, int(cells[worst.argmin()]))
        raise MeshingError(
            "refinement cannot follow the exact boundary: its curve runs through the cell at "
            f"({x:.6g}, {y:.6g}), and moving the vertices around does not help; mesh with a "
            "smaller deviation or size there"
        )
    moved = stars.arrays.xy.reshape(-1, 2)
    if (moved == patch.points).all():
        return mesh
    points = np.array(mesh.points)
    points[number] = moved
    points.flags.writeable = False
    return replace(mesh, points=points)


def _patch(mesh: Mesh, cells: np.ndarray) -> tuple[Mesh, np.ndarray, np.ndarray]:
    """Some cells as a mesh of their own; the numbers of its points, the widths of its cells."""
    rows_of, first = {}, 0
    used = np.zeros(mesh.n_points, bool)
    region, width = [], []
    for kind, rows in mesh.cells.items():
        at = cells[(cells >= first) & (cells < first + len(rows))] - first
        rows_of[kind] = rows[at]
        used[rows_of[kind]] = True
        region.append(mesh.cell_region[kind][at])
        width.append(np.full(len(at), rows.shape[1]))
        first += len(rows)
    number = np.flatnonzero(used)
    new = np.empty(mesh.n_points, np.int64)
    new[number] = np.arange(len(number))
    facets = mesh.facets["line"]
    facets = facets[used[facets].all(axis=1)]
    patch = Mesh(
        mesh.points[number],
        {kind: new[rows] for kind, rows in rows_of.items()},
        dict(zip(rows_of, region, strict=True)),
        facets={"line": new[facets]},
    )
    return patch, number, np.concatenate(width)


def _middle(mesh: Mesh, cell: int) -> np.ndarray:
    for rows in mesh.cells.values():
        if cell < len(rows):
            break
        cell -= len(rows)
    middle: np.ndarray = mesh.points[rows[cell]].mean(axis=0)
    return middle

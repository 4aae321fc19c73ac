"""Make room where new boundary vertices have moved from their chords onto exact curves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh.errors import MeshingError
from csgmesh.improve.stars import BEST, Stars
from csgmesh.mesh import Mesh

#: Sweeps over the vertices near cells that were bent too much.
SWEEPS = 6


def make_room(mesh: Mesh, bent: np.ndarray, first_new: int, wanted: np.ndarray) -> Mesh:
    """Move vertices near bent facets until the cells there are as good as they should be.

    Parameters
    ----------
    mesh : Mesh
    bent : (k,) int64
        Vertices that have moved onto curves.
    first_new : int
        Vertices from this one on are new: these move first.
    wanted : (n_cells,) float64
        Sine of the angle that each cell should have no corner below.

    Raises
    ------
    MeshingError
        If a cell stays turned over; with its place.
    """
    near = _touching(mesh, _mask(mesh, bent))
    patch, number, cell = _patch(mesh, near)
    stars = Stars(patch)
    scale = np.where(_widths(mesh)[cell] == 3, 1.0 / np.sin(np.pi / 3), 1.0)
    goal = np.minimum(scale * wanted[cell], 1.0)
    for sweep in range(SWEEPS):
        bad = np.flatnonzero(stars.qualities() < goal - 1e-9)
        if not len(bad):
            break
        vertices = stars.vertices_of(bad)
        is_boundary = stars.arrays.kind[vertices] > 0
        only_new = sweep < SWEEPS // 2
        movable = ~is_boundary & ((number[vertices] >= first_new) | (not only_new))
        if not stars.move(BEST, vertices[movable]) and not only_new:
            break
    worst = stars.qualities()
    if (worst <= 0.0).any():
        rows = cell[int(worst.argmin())]
        x, y = _middle(mesh, rows)
        raise MeshingError(
            "refinement cannot follow the exact boundary: its curve runs through the cell at "
            f"({x:.6g}, {y:.6g}), and moving the vertices around does not help; mesh with a "
            "smaller deviation or size there"
        )
    points = np.array(mesh.points)
    points[number] = stars.arrays.xy.reshape(-1, 2)
    return replace(mesh, points=points)


def _mask(mesh: Mesh, vertices: np.ndarray) -> np.ndarray:
    mask = np.zeros(mesh.n_points, bool)
    mask[vertices] = True
    return mask


def _touching(mesh: Mesh, mask: np.ndarray) -> np.ndarray:
    """Vertices of the cells with a vertex in a mask, as a mask."""
    out = np.zeros(mesh.n_points, bool)
    for rows in mesh.cells.values():
        out[rows[mask[rows].any(axis=1)]] = True
    return out


def _patch(mesh: Mesh, mask: np.ndarray) -> tuple[Mesh, np.ndarray, np.ndarray]:
    """The cells with a vertex in a mask; the numbers of its points and cells in the mesh."""
    cells, numbers, before = {}, [], 0
    for kind, rows in mesh.cells.items():
        at = np.flatnonzero(mask[rows].any(axis=1))
        cells[kind] = rows[at]
        numbers.append(before + at)
        before += len(rows)
    used = np.zeros(mesh.n_points, bool)
    for rows in cells.values():
        used[rows] = True
    number = np.flatnonzero(used)
    new = np.cumsum(used) - 1
    cell = np.concatenate(numbers)
    region = np.concatenate(list(mesh.cell_region.values()))[cell]
    ends = np.cumsum([0, *(len(rows) for rows in cells.values())])
    facets = mesh.facets["line"]
    facets = facets[used[facets].all(axis=1)]
    patch = Mesh(
        mesh.points[number],
        {kind: new[rows] for kind, rows in cells.items()},
        {kind: region[ends[i] : ends[i + 1]] for i, kind in enumerate(cells)},
        facets={"line": new[facets]},
    )
    return patch, number, cell


def _widths(mesh: Mesh) -> np.ndarray:
    return np.concatenate([np.full(len(rows), rows.shape[1]) for rows in mesh.cells.values()])


def _middle(mesh: Mesh, cell: int) -> np.ndarray:
    for rows in mesh.cells.values():
        if cell < len(rows):
            break
        cell -= len(rows)
    middle: np.ndarray = mesh.points[rows[cell]].mean(axis=0)
    return middle

"""Hexahedra in the making: cells, their outer quads and the face each quad belongs to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.meshers.hexahedra.grid import Grid

#: For each direction (axis, up or down) the corners of a hexahedron's side, seen from outside.
SIDES = {
    (0, 0): (3, 0, 4, 7),
    (0, 1): (1, 2, 6, 5),
    (1, 0): (0, 1, 5, 4),
    (1, 1): (2, 3, 7, 6),
    (2, 0): (0, 3, 2, 1),
    (2, 1): (4, 5, 6, 7),
}


@dataclass(frozen=True, eq=False)
class Blocks:
    """Cells and boundary of an unfinished mesh.

    Attributes
    ----------
    points : (n, 3) float64
    hexes : (m, 8) int64
    quads : (b, 4) int64
        The boundary, seen from outside.
    label : (b,) int64
        Face of the domain that each quad belongs to.
    """

    points: np.ndarray
    hexes: np.ndarray
    quads: np.ndarray
    label: np.ndarray


def core_blocks(
    cells: np.ndarray, grid: Grid
) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """Points, hexahedra and boundary quads of cells of a grid; sides (b, 2): axis, up or down."""
    number = np.flatnonzero(cells.ravel())
    corners = grid.corners(number)
    place = np.full(cells.size, -1)
    place[number] = np.arange(len(number))
    padded = np.pad(cells, 1)
    quads, ways = [], []
    inner = (slice(1, -1),) * 3
    for (axis, up), side in SIDES.items():
        beside = np.roll(padded, -1 if up else 1, axis)[inner]
        at = place[np.flatnonzero((cells & ~beside).ravel())]
        quads.append(corners[at][:, side])
        ways.append(np.tile([axis, up], (len(at), 1)))
    used = np.zeros(len(grid.x) * len(grid.y) * len(grid.z), bool)
    used[corners.ravel()] = True
    kept = np.flatnonzero(used)
    renumbered = np.full(len(used), -1)
    renumbered[kept] = np.arange(len(kept))
    i, j, k = np.unravel_index(kept, (len(grid.x), len(grid.y), len(grid.z)))
    points = np.column_stack([grid.x[i], grid.y[j], grid.z[k]])
    outer = renumbered[np.concatenate(quads)]
    return points, renumbered[corners], (outer, np.concatenate(ways))


def beside(quads: np.ndarray) -> np.ndarray:
    """Quad across each side of each quad of a closed manifold, (b, 4)."""
    tail, head = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    order = np.lexsort((high, low))
    across = np.empty(len(order), np.int64)
    across[order[0::2]], across[order[1::2]] = order[1::2], order[0::2]
    return (across // 4).reshape(-1, 4)


def with_sheet(blocks: Blocks, chosen: np.ndarray) -> Blocks:
    """A sheet of cells put in behind chosen quads (b,) bool, which become its outer sides.

    Vertices of the chosen quads get a copy, which the new outer sides have; the cells keep the old
    ones. Where the chosen quads end, the sheet shows a side of its own, which belongs to the face
    on which it stands.
    """
    quads, n = blocks.quads, len(blocks.points)
    own = quads[chosen]
    doubled = np.unique(own)
    copy = np.arange(n)
    copy[doubled] = n + np.arange(len(doubled))
    across = beside(quads)[chosen]
    at, side = np.nonzero(~chosen[across])
    tail, head = own[at, side], own[at, (side + 1) % 4]
    strip = np.column_stack([tail, head, copy[head], copy[tail]])
    outer = quads.copy()
    outer[chosen] = copy[own]
    return Blocks(
        np.concatenate([blocks.points, blocks.points[doubled]]),
        np.concatenate([blocks.hexes, np.column_stack([own, copy[own]])]),
        np.concatenate([outer, strip]),
        np.concatenate([blocks.label, blocks.label[across[at, side]]]),
    )

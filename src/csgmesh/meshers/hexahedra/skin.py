"""The part of a core near its boundary, where all the work is done, and the rest put back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.meshers.hexahedra.blocks import SIDES, Blocks, used_points
from csgmesh.meshers.hexahedra.core import Core

#: Layers of cells behind the boundary whose vertices may move.
_LAYERS = 4


@dataclass(frozen=True, eq=False)
class Skin:
    """Cells within some layers of the sides that move, in numbers of their own.

    Attributes
    ----------
    core : Core
    level : (n,) int8
        Layer of each cell of the grid, 0 for those below, which are left as they are.
    place : (p,) int64
        Number of each point of the grid, -1 for those that the skin does not have.
    blocks : Blocks
    held : (k,) bool
        Points that cells below the skin share.
    """

    core: Core
    level: np.ndarray
    place: np.ndarray
    blocks: Blocks
    held: np.ndarray

    @classmethod
    def of(cls, core: Core, label: np.ndarray, moves: np.ndarray) -> Skin:
        """The skin below sides (b,) that move; their faces are known by now."""
        grid, shape = core.grid, np.array(core.grid.shape) + 2
        sx, sy = int(shape[1] * shape[2]), int(shape[2])
        level = np.zeros(len(core.cells), np.int8)
        seeds = used_points(core.owner[moves], len(core.cells))
        level[seeds] = 1
        facing = core.owner[moves & (core.front >= 0)]
        if len(facing):
            ahead = np.setdiff1d(facing[:, None] + np.array([1, -1, sy, -sy, sx, -sx]), seeds)
            ahead = ahead[core.cells[ahead] > 0]
            level[ahead] = 1
            seeds = np.concatenate([seeds, ahead])
        queue = np.empty(np.count_nonzero(core.cells), np.int64)
        queue[: len(seeds)] = seeds
        n = kernels.spread_levels(core.cells, level, queue, len(seeds), sx, sy, _LAYERS)
        near = np.sort(queue[:n])
        corners = grid.corners(near)
        outer = side_points(core)
        place = np.full(np.prod([len(line) for line in grid.axes]), -1)
        place[corners] = 0
        place[outer] = 0
        used = np.flatnonzero(place == 0)
        place[used] = np.arange(len(used))
        blocks = Blocks(
            grid.points(used),
            place[corners],
            core.cells[near].astype(np.int64) - 1,
            place[outer],
            label,
            core.behind,
            core.front,
        )
        return cls(core, level, place, blocks, _touch_deep(core, level, used))

    def joined(self, blocks: Blocks) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points, hexahedra and their regions, of changed blocks and of the cells below."""
        core, n = self.core, len(blocks.hexes)
        deep = int(np.count_nonzero((core.cells > 0) & (self.level == 0)))
        hexes = np.empty((n + deep, 8), np.int64)
        region = np.empty(n + deep, np.int64)
        place = self.place.copy()
        room = len(blocks.points) + min(8 * deep, int((place < 0).sum()))
        points = np.empty((room, 3))
        points[: len(blocks.points)] = blocks.points
        hexes[:n], region[:n] = blocks.hexes, blocks.region
        state = np.array([len(blocks.points), n])
        start, last = 0, core.grid.shape[0]
        while start < last:
            start = kernels.fill_deep(
                core.cells, self.level, *core.grid.axes, place, state, points, hexes, region, start
            )
        return points[: state[0]], hexes, region


def side_points(core: Core) -> np.ndarray:
    """Points of the grid of each side of a core, seen from outside, (b, 4)."""
    corners = core.grid.corners(core.owner)
    return np.take_along_axis(corners, SIDES[core.way], axis=1)


def _touch_deep(core: Core, level: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Whether a cell below the skin is at each point of the grid, (k,) bool."""
    lines = tuple(len(line) for line in core.grid.axes)
    shape = np.array(core.grid.shape) + 2
    i, j, k = np.unravel_index(points, lines)
    first = (i * shape[1] + j) * shape[2] + k
    deep = (core.cells > 0) & (level == 0)
    out = np.zeros(len(points), bool)
    for a in (0, 1):
        for b in (0, 1):
            for c in (0, 1):
                out |= deep[first + (a * shape[1] + b) * shape[2] + c]
    return out

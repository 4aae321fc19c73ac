"""Points and cells of blocks: Gordon and Hall's interpolation between their sides."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from csgmesh import kernels
from csgmesh.errors import MeshingError
from csgmesh.mesh.blocks import Block as MeshBlock
from csgmesh.meshers.structured.counts import Counts
from csgmesh.meshers.structured.layout import Layout, Side

Progress = Callable[[str, int, int], None]

#: Cells filled between two returns to the caller.
SLICE = 1_000_000


class Filling:
    """Numbers points block by block: corners first, then edges, then the insides of blocks."""

    def __init__(self, layout: Layout, counts: Counts, progress: Progress) -> None:
        self.layout, self.counts, self.progress = layout, counts, progress
        n = [counts[k] for k in range(len(layout.edges))]
        first = len(layout.corners) + np.concatenate([[0], np.cumsum([m - 1 for m in n])])
        self.first_of_edge = first.tolist()
        inside = [(n[b.bottom[0]] - 1) * (n[b.left[0]] - 1) for b in layout.blocks]
        self.first_of_block = (
            self.first_of_edge[-1] + np.concatenate([[0], np.cumsum(inside)])
        ).tolist()
        self.points = np.empty((self.first_of_block[-1], 2))
        self.points[: len(layout.corners)] = layout.corners
        for k, edge in enumerate(counts.edges):
            self.points[self.first_of_edge[k] : self.first_of_edge[k + 1]] = edge.points[1:-1]
        cells = [n[b.bottom[0]] * n[b.left[0]] for b in layout.blocks]
        self.first_cell = np.concatenate([[0], np.cumsum(cells)]).tolist()
        self.cells = np.empty((self.first_cell[-1], 4), np.int64)
        self.blocks = [self._fill(k) for k in range(len(layout.blocks))]

    def row(self, side: Side) -> np.ndarray:
        """Point numbers along a side."""
        k, is_reversed = side
        a, b = self.layout.edges[k].ends
        inner = np.arange(self.first_of_edge[k], self.first_of_edge[k + 1])
        row = np.concatenate([[a], inner, [b]])
        return row[::-1] if is_reversed else row

    def shares(self, side: Side) -> np.ndarray:
        """Shares of the arc length along a side."""
        shares = self.counts.edges[side[0]].shares
        return np.ascontiguousarray(1.0 - shares[::-1] if side[1] else shares)

    def _fill(self, k: int) -> MeshBlock:
        block = self.layout.blocks[k]
        sides = (block.bottom, block.right, block.top, block.left)
        bottom, right, top, left = (self.row(side) for side in sides)
        number = np.empty((len(bottom), len(left)), np.int64)
        number[:, 0], number[:, -1], number[0], number[-1] = bottom, top, left, right
        ni, nj = len(bottom) - 1, len(left) - 1
        begin = self.first_of_block[k]
        inside = np.arange(begin, self.first_of_block[k + 1]).reshape(ni - 1, nj - 1)
        number[1:-1, 1:-1] = inside
        rows = [np.ascontiguousarray(self.points[row]) for row in (bottom, right, top, left)]
        shares = [self.shares(side) for side in sides]
        flat = self.points.reshape(-1)
        mine = flat[2 * begin : 2 * self.first_of_block[k + 1]]
        cell = np.arange(self.first_cell[k], self.first_cell[k + 1]).reshape(ni, nj)
        own = self.cells.reshape(-1)[4 * cell[0, 0] : 4 * cell[-1, -1] + 4]
        step = max(1, SLICE // nj)
        for i in range(1, ni, step):
            kernels.fill_block(*rows, *shares, mine, i, min(i + step, ni))
        worst = -1
        for i in range(0, ni, step):
            if worst < 0:
                worst = int(kernels.connect_block(number, flat, own, i, min(i + step, ni)))
            self.progress("fill blocks", self.first_cell[k] + i * nj, len(self.cells))
        if worst >= 0:
            x, y = self.points[self.cells[cell[0, 0] + worst]].mean(axis=0)
            raise MeshingError(
                f"the grid lines of a four-sided block fold over each other near ({x:.6g}, "
                f"{y:.6g}): its sides bend too far for interpolation between them; give other "
                "corners, or use QuadPairing"
            )
        return MeshBlock(cell, number)

    def named_blocks(self) -> dict[str, MeshBlock]:
        """Blocks by the name of their region, numbered from the second one on."""
        names = self.layout.outline.domain.region_names
        seen: dict[int, int] = {}
        out = {}
        for block, filled in zip(self.layout.blocks, self.blocks, strict=True):
            k = seen[block.region] = seen.get(block.region, 0) + 1
            out[names[block.region] + (f".{k}" if k > 1 else "")] = filled
        return out

    def facets(self) -> dict[str, Any]:
        """Pieces of the domain's boundary, each with its first region on the left."""
        n_curves = self.layout.outline.n_curves
        rows, markers, sides, curves, intervals = [], [], [], [], []
        for k, edge in enumerate(self.layout.edges):
            if edge.parts[0].marker < 0:
                continue
            placed = self.counts.edges[k]
            row = self.row((k, False))
            rows.append(np.stack([row[:-1], row[1:]], axis=1))
            markers.append(np.array([p.marker for p in edge.parts])[placed.part])
            sides.append(np.array([p.sides for p in edge.parts])[placed.part])
            curve = np.array([p.curve for p in edge.parts])[placed.part]
            is_own = curve < n_curves
            curves.append(np.where(is_own, curve, -1))
            intervals.append(placed.interval * is_own[:, None])
        side = np.concatenate(sides)
        is_turned = (side[:, 0] < 0) | ((side[:, 1] >= 0) & (side[:, 1] < side[:, 0]))

        def oriented(pairs: np.ndarray) -> np.ndarray:
            return np.where(is_turned[:, None], pairs[:, ::-1], pairs)

        return {
            "facets": {"line": oriented(np.concatenate(rows))},
            "facet_marker": {"line": np.concatenate(markers)},
            "facet_region": {"line": oriented(side)},
            "facet_curve": {"line": np.concatenate(curves)},
            "facet_interval": {"line": oriented(np.concatenate(intervals))},
        }

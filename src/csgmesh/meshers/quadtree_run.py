"""One run of the quadtree mesher: tree, boundary, strip, and again where angles come out low."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from csgmesh import kernels
from csgmesh.domain.input_angles import sharp_corners
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import MeshingError
from csgmesh.improve import optimise
from csgmesh.measures.shapes import measure_cells
from csgmesh.mesh import Mesh
from csgmesh.meshers.quadtree_band import (
    OF_BAND,
    SLICE,
    Crossed,
    sorted_grid,
    triangulated_strip,
)
from csgmesh.meshers.quadtree_growth import Grower
from csgmesh.meshers.quadtree_sampling import Strands, folded
from csgmesh.meshers.workspace import Progress
from csgmesh.size.resolve import ResolvedSize
from csgmesh.spatial import Boxes

#: Times that a tree is refined where boundaries cross, or cells come out badly.
ROUNDS = 10
#: Angle to which the strip's triangles are improved, degrees.
STRIP_GOAL = 33.0


class Run:
    """Makes the parts of a mesh.

    Attributes
    ----------
    grid : Grid
    samples : Samples
    strip : Strip
    points : (n, 2) float64
        The samples', then the grid's.
    number : (4 n,) int32
        Of each code of the grid, counted after the samples.
    """

    def __init__(
        self,
        domain: Pslg,
        size: ResolvedSize | None,
        scale: float,
        width: int,
        max_points: int,
        bound: float,
        progress: Progress | None,
        parts: int = 1,
    ) -> None:
        self.domain, self.size, self.width = domain, size, width
        self.max_points, self.bound, self.progress = max_points, bound, progress
        self.parts = parts
        self.grower = Grower(domain, size, scale, max_points, parts)
        self.corners = sharp_corners(domain)
        self.rigid = np.zeros(domain.n_segments, bool)

    def run(self, promised: float) -> np.ndarray | None:
        """Tree, boundary and strip, again where angles come out low.

        Returns None, or the place of a cell that stays below what is promised.
        """
        for _ in range(ROUNDS):
            self.attempt()
            low = self.low_cells(self.bound)
            if not len(low):
                return None
            corners = self.strip.points[self.strip.cells[low]]
            self.refine(corners)
        low = self.low_cells(promised)
        return self.strip.points[self.strip.cells[low[0]]].mean(axis=0) if len(low) else None

    def refine(self, corners: np.ndarray) -> None:
        """Ask for leaves half as large as cells (k, j, 2) around these cells."""
        edges = corners - np.roll(corners, 1, axis=1)
        length = np.hypot(edges[..., 0], edges[..., 1]).max(axis=1)
        self.grower.refine_at(corners.mean(axis=1), 0.5 * length)

    def attempt(self) -> None:
        """Tree, boundary and strip, finer where edges of the boundary are in each other's way."""
        for _ in range(ROUNDS):
            growth = self.grower.grown(self.width)
            strands = Strands(self.domain, self.rigid, self.parts)
            self.samples = strands.sampled(growth.tree, self.corners)
            hidden = folded(self.domain, self.samples)
            if (hidden & ~self.rigid).any():
                # On a hairpin only the domain's own vertices tell one side from the other.
                self.rigid |= hidden
                self.samples = Strands(self.domain, self.rigid, self.parts).sampled(
                    growth.tree, self.corners
                )
            self.grid = sorted_grid(growth.tree, growth.region, self.samples, growth.region_of)
            try:
                self.strip = triangulated_strip(self.domain, self.grid, self.samples, self.progress)
            except Crossed as conflict:
                self._resolve(conflict.edges)
                continue
            self._forget_idle()
            self._improve()
            return
        ends = self.samples.points[self.samples.ends[self.crossed[0]]]
        (x, y) = ends.mean(axis=0)
        raise MeshingError(
            f"segments must meet at common points only; two come too near near ({x:.12g}, {y:.12g})"
        )

    def low_cells(self, bound: float) -> np.ndarray:
        """Triangles of the strip below the bound that no input angle excuses."""
        strip = self.strip
        angle = measure_cells(strip.points, strip.cells).min_angle
        low = np.flatnonzero(angle < bound)
        if not len(low) or not len(self.corners.vertex):
            return low
        apex, radius = self.domain.points[self.corners.vertex], self.corners.radius
        corner = strip.points[strip.cells[low]]
        boxes = Boxes(apex - radius[:, None], apex + radius[:, None])
        pairs = boxes.overlapping(corner.min(axis=1), corner.max(axis=1))
        away = corner[pairs[:, 0]] - apex[pairs[:, 1], None]
        near = np.hypot(away[..., 0], away[..., 1]).min(axis=1) <= radius[pairs[:, 1]]
        return np.delete(low, pairs[near, 0])

    def _improve(self) -> None:
        """Raise the smallest angles of the strip; vertices that the core shares stay."""
        strip = self.strip
        part = Mesh(
            points=strip.points,
            cells={"triangle": strip.cells},
            cell_region={"triangle": strip.regions},
            region_names=self.domain.region_names,
            boundary_names=self.domain.boundary_names,
            point_marker=self._point_marker(len(strip.points)),
            curves=self.domain.curves,
            domain=self.domain,
            **self.facets(),
        )
        better = optimise(part, goal=STRIP_GOAL, progress=self.progress)
        interval = self._unturned(better.facet_interval["line"])
        n = len(self.samples.points)
        self.samples = replace(self.samples, points=better.points[:n], interval=interval)
        self.strip = replace(strip, points=better.points, cells=better.cells["triangle"])

    def _point_marker(self, n: int) -> np.ndarray:
        marker = np.full(n, -1)
        kept = self.samples.kept
        marker[: len(kept)] = self.domain.point_marker[kept]
        return marker

    def _resolve(self, edges: list[int]) -> None:
        self.crossed = edges
        samples = self.samples
        ends = samples.points[samples.ends[edges]]
        self.rigid[samples.segment[edges]] = True
        length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
        self.grower.refine_at(ends.mean(axis=1), 0.5 * length)

    def _forget_idle(self) -> None:
        """Drop the grid's vertices that no cell uses."""
        strip, n = self.strip, len(self.samples.points)
        used = np.zeros(len(strip.points), bool)
        used[strip.cells] = True
        idle = strip.codes[~used[n:]]
        self.grid.status[idle[self.grid.status[idle] == OF_BAND]] = 0

    def cells(self, quads: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Quads (none unless wanted) and triangles, each with their regions; sets `points`."""
        tree, grid = self.grid.tree, self.grid
        total, fan = np.zeros(3, np.int64), np.zeros(tree.n_leaves, np.uint8)
        room = np.empty(12, np.int64)
        spans = [(b, min(b + SLICE, tree.n_leaves)) for b in range(0, tree.n_leaves, SLICE)]
        shape = tree.key, tree.level, grid.kind
        used = grid.corner, grid.status
        for begin, end in spans:
            kernels.count_cells(*shape, *used, begin, end, 1, fan, total, room)
        number = self._numbered(spans)
        plain, _, fanned = total.tolist()
        m = fanned + (0 if quads else 2 * plain)
        n = m + len(self.strip.cells)
        squares = np.empty((plain if quads else 0, 4), np.int64)
        square_of = np.empty(len(squares), np.int64)
        cells, regions = np.empty((n, 3), np.int64), np.empty(n, np.int64)
        done, square = np.zeros(1, np.int64), np.zeros(1, np.int64)
        for begin, end in spans:
            kernels.write_triangles(
                *shape,
                *used,
                fan,
                number,
                grid.region,
                begin,
                end,
                cells.reshape(-1),
                regions,
                done,
                room,
                int(not quads),
            )
            if quads:
                kernels.write_quads(
                    grid.kind,
                    grid.corner,
                    fan,
                    number,
                    grid.region,
                    begin,
                    end,
                    squares.reshape(-1),
                    square_of,
                    square,
                )
        to = self._strip_numbers(number)
        cells[m:], regions[m:] = to[self.strip.cells], self.strip.regions
        return squares, square_of, cells, regions

    def _numbered(self, spans: list[tuple[int, int]]) -> np.ndarray:
        """Number of each code; the samples come first."""
        grid, tree = self.grid, self.grid.tree
        n = len(self.samples.points)
        self.points = np.empty((n + int(np.count_nonzero(grid.status)), 2))
        self.points[:n] = self.samples.points
        number = np.empty(4 * tree.n_leaves, np.int32)
        counts = np.array([n], np.int64)
        for begin, end in spans:
            kernels.number_vertices(
                tree.key,
                tree.level,
                tree.unit,
                grid.status,
                begin,
                end,
                number,
                self.points.reshape(-1),
                counts,
            )
        return number

    def _strip_numbers(self, number: np.ndarray) -> np.ndarray:
        """Numbers of the strip's vertices in the mesh; puts those that moved where they are."""
        n = len(self.samples.points)
        to = np.concatenate([np.arange(n), number[self.strip.codes]])
        here = to[n:] >= 0
        self.points[to[n:][here]] = self.strip.points[n:][here]
        return to

    def facets(self) -> dict[str, Any]:
        """Edges of the boundary as facets, each with its first region on the left."""
        domain, samples = self.domain, self.samples
        segment = samples.segment
        sides = domain.segment_region[segment]
        turned = self._turned()
        curve = domain.segment_curve[segment]
        interval = samples.interval * (curve >= 0)[:, None]
        return {
            "facets": {"line": np.where(turned, samples.ends[:, ::-1], samples.ends)},
            "facet_marker": {"line": domain.segment_marker[segment]},
            "facet_region": {"line": np.where(turned, sides[:, ::-1], sides)},
            "facet_curve": {"line": curve},
            "facet_interval": {"line": np.where(turned, interval[:, ::-1], interval)},
        }

    def _turned(self) -> np.ndarray:
        """Which edges run against their facets, (m, 1) bool."""
        left, right = self.domain.segment_region[self.samples.segment].T
        return ((right >= 0) & ((left < 0) | (right < left)))[:, None]

    def _unturned(self, interval: np.ndarray) -> np.ndarray:
        """Intervals of facets as those of the edges they came from."""
        curved = self.domain.segment_curve[self.samples.segment] >= 0
        there = np.where(self._turned(), interval[:, ::-1], interval)
        return np.where(curved[:, None], there, self.samples.interval)

    def mesh(
        self, cells: dict[str, np.ndarray], regions: dict[str, np.ndarray], info: dict[str, object]
    ) -> Mesh:
        """A mesh of cells on the points."""
        domain = self.domain
        # What will not be written to again needs no copy.
        for array in (self.points, *cells.values(), *regions.values()):
            array.flags.writeable = False
        return Mesh(
            points=self.points,
            cells=cells,
            cell_region=regions,
            region_names=domain.region_names,
            boundary_names=domain.boundary_names,
            point_marker=self._point_marker(len(self.points)),
            curves=domain.curves,
            domain=domain,
            info={
                **info,
                "n_points": len(self.points),
                "n_cells": sum(len(rows) for rows in cells.values()),
                "n_leaves": self.grid.tree.n_leaves,
            },
            **self.facets(),
        )

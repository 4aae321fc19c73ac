"""Layers under the mesh of the domain within them, glued along the fronts."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from csgmesh.mesh import Mesh
from csgmesh.meshers.layers.columns import Walls
from csgmesh.meshers.layers.heights import column_points, sliding_parameters
from csgmesh.meshers.layers.inner import Inner


class Gluing:
    """Layers of cells between columns; where the mesh split a front, a column is added."""

    def __init__(self, walls: Walls, inner: Inner, mesh: Mesh) -> None:
        self.walls, self.inner, self.mesh = walls, inner, mesh
        self.points: list[np.ndarray] = []
        self.n = mesh.n_points
        self.foot: dict[int, int] = {}
        self.columns: list[np.ndarray] = []
        self.cells: list[np.ndarray] = []
        self.regions: list[int] = []
        self.facets: list[tuple[int, int, int, float, float]] = []
        self.fronts = self._fronts()
        self._raise()
        for k in range(len(walls.strips)):
            self._fill(k)
        for k, column in enumerate(walls.columns):
            if column.beside >= 0 and column.height > 0:
                self._slide(k)

    def _new(self, points: np.ndarray) -> np.ndarray:
        self.points.append(np.atleast_2d(points))
        self.n += len(self.points[-1])
        return np.arange(self.n - len(self.points[-1]), self.n)

    def _fronts(self) -> dict[int, np.ndarray]:
        """Points of the mesh along the front of each strip."""
        line, marker = self.mesh.facets["line"], self.mesh.facet_marker["line"]
        order = np.argsort(marker, kind="stable")
        bounds = np.searchsorted(marker[order], np.arange(len(self.inner.strip) + 1))
        domain = self.inner.domain
        found = {}
        for s in np.flatnonzero(self.inner.strip >= 0).tolist():
            rows = line[order[bounds[s] : bounds[s + 1]]]
            a, b = domain.points[domain.segments[s]]
            share = (self.mesh.points[rows[:, 0]] - a) @ (b - a)
            rows = rows[np.argsort(share, kind="stable")]
            found[int(self.inner.strip[s])] = np.append(rows[:, 0], rows[-1, 1])
        return found

    def _raise(self) -> None:
        """Number the vertices of all columns."""
        walls = self.walls
        tip = {}
        for k, front in self.fronts.items():
            a, b, _ = walls.strips[k]
            tip[a], tip[b] = int(front[0]), int(front[-1])
        for k, column in enumerate(walls.columns):
            if column.height == 0.0:
                self.foot[column.vertex] = tip[k]
        for k, column in enumerate(walls.columns):
            if column.vertex not in self.foot:
                self.foot[column.vertex] = int(self._new(walls.pieces.points[column.vertex])[0])
            foot = self.foot[column.vertex]
            if column.height == 0.0:
                self.columns.append(np.full(len(column.shares), foot))
                continue
            inside = self._new(column_points(walls, k, column.shares[1:-1]))
            self.columns.append(np.concatenate([[foot], inside, [tip[k]]]))

    def _fill(self, k: int) -> None:
        """Cells of a strip, and the facets at its bottom."""
        walls = self.walls
        first, last, piece = walls.strips[k]
        front = self.fronts.get(k)
        below = piece if piece >= 0 else -1 - piece
        segment = int(walls.pieces.segment[below])
        region = int(walls.domain.segment_region[segment, 0])
        row, t = [self.columns[first]], [0.0]
        if front is not None and len(front) > 2:
            tips = self.mesh.points[front]
            share = np.hypot(*(tips - tips[0]).T)
            for number, s in zip(
                front[1:-1].tolist(), (share / share[-1])[1:-1].tolist(), strict=True
            ):
                row.append(self._between(first, last, piece, number, s))
                t.append(s)
        row.append(self.columns[last])
        t.append(1.0)
        for left, right in pairwise(row):
            cell = np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=1)
            self.cells.append(cell)
            self.regions += [region] * len(cell)
        if piece >= 0:
            t0, t1 = walls.pieces.interval[piece]
            at = t0 + np.array(t) * (t1 - t0)
            at[-1] = t1
            self.facets += [(int(row[j][0]), int(row[j + 1][0]), segment, float(at[j]),
                             float(at[j + 1])) for j in range(len(row) - 1)]  # fmt: skip

    def _between(self, first: int, last: int, piece: int, number: int, s: float) -> np.ndarray:
        """A column between two others, below a vertex that the mesh put on the front."""
        walls = self.walls
        columns = walls.columns
        shares = (1 - s) * columns[first].shares + s * columns[last].shares
        if piece < 0:
            foot = self.columns[first][0]
            base = walls.pieces.points[columns[first].vertex]
        else:
            a, b = walls.pieces.points[walls.pieces.ends[piece]]
            base = (1 - s) * a + s * b
            curve = int(walls.domain.segment_curve[walls.pieces.segment[piece]])
            if curve >= 0:
                t0, t1 = walls.pieces.interval[piece]
                at = np.array([t0 + s * (t1 - t0)])
                base = walls.domain.curves.points(np.array([curve]), at)[0]
            foot = self._new(base)[0]
        tip = self.mesh.points[number]
        inside = self._new(base + shares[1:-1, None] * (tip - base))
        return np.concatenate([[foot], inside, [number]])

    def _slide(self, k: int) -> None:
        """Facets along a column on the boundary."""
        column, row = self.walls.columns[k], self.columns[k]
        segment = int(self.walls.pieces.segment[column.beside])
        t = np.zeros(len(row))
        if self.walls.domain.segment_curve[segment] >= 0:
            t = sliding_parameters(self.walls, k, column.shares)
            t[0] = self.walls.pieces.interval[column.beside, 0 if column.is_away else 1]
        if not column.is_away:
            row, t = row[::-1], t[::-1]
        for (a, b), (u, v) in zip(pairwise(row.tolist()), pairwise(t.tolist()), strict=True):
            self.facets.append((a, b, segment, u, v))

    def finished(self, cells: str, info: Mapping[str, object]) -> Mesh:
        """Layers and mesh as one, of the given domain."""
        mesh, domain = self.mesh, self.walls.domain
        points = np.concatenate([mesh.points, *self.points])
        quads = np.concatenate(self.cells)
        by_kind, regions = _sorted_out(points, quads, np.array(self.regions), cells)
        for kind in mesh.cells:
            by_kind[kind] = [mesh.cells[kind], *by_kind.get(kind, [])]
            regions[kind] = [mesh.cell_region[kind], *regions.get(kind, [])]
        marker = np.full(len(points), -1)
        probes = np.flatnonzero(mesh.point_marker >= 0)
        marker[probes] = mesh.point_marker[probes] - len(self.inner.segment)
        return Mesh(
            points=points,
            cells={kind: np.concatenate(by_kind[kind]) for kind in by_kind},
            cell_region={kind: np.concatenate(regions[kind]) for kind in by_kind},
            region_names=domain.region_names,
            boundary_names=domain.boundary_names,
            point_marker=marker,
            curves=domain.curves,
            domain=domain,
            info={**info, "n_layer_cells": len(quads)},
            **self._all_facets(),
        )

    def _all_facets(self) -> dict[str, Any]:
        mesh, domain, inner = self.mesh, self.walls.domain, self.inner
        own = mesh.facet_marker["line"]
        kept = np.flatnonzero(inner.strip[own] < 0)
        segment = inner.segment[own[kept]]
        line = np.array([f[:2] for f in self.facets])
        new = np.array([f[2] for f in self.facets])
        interval = np.array([f[3:] for f in self.facets])
        curve = domain.segment_curve[new]
        sides = domain.segment_region[new]
        turned = (sides[:, 0] < 0) | ((sides[:, 1] >= 0) & (sides[:, 1] < sides[:, 0]))

        def oriented(pairs: np.ndarray) -> np.ndarray:
            return np.where(turned[:, None], pairs[:, ::-1], pairs)

        def joined(name: str, other: np.ndarray) -> dict[str, np.ndarray]:
            return {"line": np.concatenate([getattr(mesh, name)["line"][kept], other])}

        return {
            "facets": joined("facets", oriented(line)),
            "facet_marker": {
                "line": np.concatenate([domain.segment_marker[segment], domain.segment_marker[new]])
            },
            "facet_region": joined("facet_region", oriented(sides)),
            "facet_curve": joined("facet_curve", curve),
            "facet_interval": joined("facet_interval", oriented(interval * (curve >= 0)[:, None])),
        }


def _sorted_out(
    points: np.ndarray, quads: np.ndarray, region: np.ndarray, cells: str
) -> tuple[dict[str, list[np.ndarray]], dict[str, list[np.ndarray]]]:
    """Quads, those with two corners at one point as triangles, or all of them as triangles."""
    same = quads == np.roll(quads, -1, axis=1)
    thin = same.any(axis=1)
    is_gone = same.sum(axis=1) > 1
    triangles, of = [], []
    for k in range(4):
        at = np.flatnonzero(same[:, k] & thin & ~is_gone)
        triangles.append(quads[at][:, [j for j in range(4) if j != k]])
        of.append(region[at])
    rest, rest_region = quads[~thin], region[~thin]
    if cells == "triangle":
        a, b, c, d = (points[rest[:, k]] for k in range(4))
        first = ((c - a) ** 2).sum(axis=1) <= ((d - b) ** 2).sum(axis=1)
        way = np.where(first[:, None], [0, 1, 2, 0, 2, 3], [0, 1, 3, 1, 2, 3])
        triangles.append(np.take_along_axis(rest, way, axis=1).reshape(-1, 3))
        of.append(np.repeat(rest_region, 2))
        rest = rest[:0]
    kinds: dict[str, list[np.ndarray]] = {}
    regions: dict[str, list[np.ndarray]] = {}
    if len(rest):
        kinds["quad"], regions["quad"] = [rest], [rest_region]
    found = np.concatenate(triangles)
    if len(found):
        kinds["triangle"], regions["triangle"] = [found], [np.concatenate(of)]
    return kinds, regions

"""Finding the cell at a point, exactly.

Triangles are sorted into grids of squares, a grid for each power of two of their extent, so that
each lies in four squares at most however strongly the mesh is graded. A needle, which fills little
of its box, is drawn into finer squares. A point looks into one square of each grid, and an exact
predicate decides.
"""

from __future__ import annotations

import reprlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from csgmesh.errors import InputError
from csgmesh.mesh.kinds import KINDS
from csgmesh.mesh.orientation import orientations
from csgmesh.mesh.squares import box_squares, needle_squares

#: Points are looked up in batches of this many, which bounds the memory.
_BATCH = 200_000

#: No grid has more squares along a side: keys must fit into 64 bits.
_FINEST = 30

#: Candidates of a part of a batch, at most about so many.
_CANDIDATES = 4_000_000

#: Needles are drawn into squares of their extent divided by a power of two up to this.
_DIVISIONS = 16

_NEWTON_STEPS = 20


@dataclass(frozen=True, eq=False)
class _Grid:
    """Triangles of one size class, sorted by the square they overlap."""

    square: float
    n_rows: int
    keys: np.ndarray
    triangle: np.ndarray


@dataclass(frozen=True, eq=False)
class Locator:
    """Search structure over plane cells.

    Attributes
    ----------
    points : (n, 2) float64
    cells : mapping of str to (m, k) int64
    triangles : (t, 3) int64
        All cells cut into counterclockwise triangles.
    triangle_cell : (t,) int64
        The cell of each, counted through all kinds.
    lo : (2,) float64
        Origin of the grids.
    grids : tuple
    """

    points: np.ndarray
    cells: Mapping[str, np.ndarray]
    triangles: np.ndarray
    triangle_cell: np.ndarray
    lo: np.ndarray
    grids: tuple[_Grid, ...]

    @staticmethod
    def of(points: np.ndarray, cells: Mapping[str, np.ndarray]) -> Locator:
        """Build the structure."""
        triangles, owner = _triangulated(points, cells)
        finite = np.isfinite(points).all(axis=1)[triangles].all(axis=1)
        triangles, owner = triangles[finite], owner[finite]
        if not len(triangles):
            return Locator(points, cells, triangles, owner, np.zeros(2), ())
        origin = points[triangles].min(axis=(0, 1))
        grids = _grids(points - origin, triangles)
        return Locator(points, cells, triangles, owner, origin, grids)

    def cells_of(self, points: ArrayLike) -> np.ndarray:
        """Lowest number of a cell that contains each point, -1 for none."""
        queries = query_points(points, 2)
        none = np.iinfo(np.int64).max
        cell = np.full(len(queries), none)
        for query, triangle in self._hits(queries):
            np.minimum.at(cell, query, self.triangle_cell[triangle])
        return np.where(cell < none, cell, -1)

    def all_cells_of(self, points: ArrayLike) -> np.ndarray:
        """All pairs (point, cell) where the closed cell contains the point, (k, 2), sorted."""
        pairs = [
            np.stack([query, self.triangle_cell[triangle]], axis=1)
            for query, triangle in self._hits(query_points(points, 2))
        ]
        return np.unique(np.concatenate([np.zeros((0, 2), np.int64), *pairs]), axis=0)

    def interpolate(self, values: ArrayLike, points: ArrayLike) -> np.ndarray:
        """Values at points from values at the corners; NaN outside."""
        given = checked_values(values, len(self.points))
        queries = query_points(points, 2)
        cell = self.cells_of(queries)
        columns = given.reshape(len(given), -1)
        out = np.full((len(queries), columns.shape[1]), np.nan, given.dtype)
        before = 0
        for kind, rows in self.cells.items():
            at = np.flatnonzero((cell >= before) & (cell < before + len(rows)))
            corners = rows[cell[at] - before, : KINDS[kind].n_corners]
            weight = _weights(self.points[corners], queries[at])
            out[at] = np.einsum("ij,ijk->ik", weight, columns[corners])
            before += len(rows)
        return out.reshape(len(queries), *given.shape[1:])

    def _hits(self, queries: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Pairs of a point and a triangle that contains it, some at a time."""
        for start in range(0, len(queries), _BATCH):
            batch = np.arange(start, min(start + _BATCH, len(queries)))
            looks = [self._look(grid, queries[batch]) for grid in self.grids]
            total = np.sum([count for _, count in looks], axis=0) if looks else np.zeros(len(batch))
            part = (np.cumsum(total) // _CANDIDATES).astype(np.int64)
            for one in np.unique(part).tolist():
                inside = np.flatnonzero(part == one)
                pairs = [
                    _expand(grid, batch[inside], first[inside], count[inside])
                    for grid, (first, count) in zip(self.grids, looks, strict=True)
                ]
                query = np.concatenate([np.zeros(0, np.int64), *(q for q, _ in pairs)])
                triangle = np.concatenate([np.zeros(0, np.int64), *(t for _, t in pairs)])
                yield self._containing(queries, query, triangle)

    def _look(self, grid: _Grid, queries: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First triangle in each point's square of a grid, and how many there are."""
        with np.errstate(invalid="ignore"):
            square = np.floor((queries - self.lo) / grid.square)
            near = ((square >= 0) & (square < grid.n_rows)).all(axis=1)
        square = np.where(near[:, None], square, -1).astype(np.int64)
        key = square[:, 0] * grid.n_rows + square[:, 1]
        first = np.searchsorted(grid.keys, key, side="left")
        return first, np.searchsorted(grid.keys, key, side="right") - first

    def _containing(
        self, queries: np.ndarray, query: np.ndarray, triangle: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Those of the pairs where the triangle contains the point."""
        for axis in (0, 1):
            # Half of the candidates fall to their boxes, which are cheaper than the predicate.
            low, high = _range(self.points[:, axis], self.triangles[triangle])
            at = queries[query, axis]
            keep = (at >= low) & (at <= high)
            query, triangle = query[keep], triangle[keep]
        stacked = np.concatenate([self.points, queries])
        for a, b in ((0, 1), (1, 2), (2, 0)):
            rows = self.triangles[triangle]
            triples = np.stack([rows[:, a], rows[:, b], query + len(self.points)], axis=1)
            keep = orientations(stacked, triples) >= 0
            query, triangle = query[keep], triangle[keep]
        return query, triangle


def _expand(
    grid: _Grid, query: np.ndarray, first: np.ndarray, count: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    within = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    return np.repeat(query, count), grid.triangle[np.repeat(first, count) + within]


def _divisions(points: np.ndarray, triangles: np.ndarray, extent: np.ndarray) -> np.ndarray:
    """Powers of two by which the squares of needles are finer than their extent, 0 for others."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    width = np.abs(_cross(b - a, c - a)) / np.maximum(extent.max(axis=1), np.finfo(float).tiny)
    with np.errstate(divide="ignore", over="ignore"):
        slenderness = extent.max(axis=1) / width / 4
    finest = np.log2(_DIVISIONS)
    return np.floor(np.log2(np.clip(slenderness, 1.0, _DIVISIONS))).clip(0, finest).astype(np.int64)


def _range(x: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    a, b, c = (x[triangles[:, k]] for k in range(3))
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def checked_values(values: ArrayLike, n_points: int) -> np.ndarray:
    """Values at the points of a mesh as float64 or complex128, a row a point."""
    given = np.asarray(values)
    if given.dtype.kind not in "biufc":
        raise InputError(f"values must be numbers; got {reprlib.repr(values)}")
    given = given.astype(np.complex128 if given.dtype.kind == "c" else np.float64)
    if given.ndim not in (1, 2) or len(given) != n_points:
        raise InputError(
            f"values must have shape ({n_points},) or ({n_points}, k), "
            f"one row a point of the mesh; got {given.shape}"
        )
    return given


def query_points(points: ArrayLike, dim: int) -> np.ndarray:
    """Places to look at as (n, dim) float64; a single one counts as one row."""
    try:
        queries = np.asarray(points, float)
    except (TypeError, ValueError):
        raise InputError(
            f"points must be an (n, {dim}) array of numbers; got {reprlib.repr(points)}"
        ) from None
    if queries.size == 0:
        return np.zeros((0, dim))
    if queries.shape == (dim,):
        queries = queries.reshape(1, dim)
    if queries.ndim != 2 or queries.shape[1] != dim:
        raise InputError(f"points must have shape (n, {dim}); got {queries.shape}")
    return queries


def _triangulated(
    points: np.ndarray, cells: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    parts, owners, before = [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int64)], 0
    for kind, rows in cells.items():
        number = np.arange(before, before + len(rows))
        if KINDS[kind].n_corners == 3:
            parts.append(rows[:, :3])
            owners.append(number)
        else:
            cut = _cut_quads(points, rows[:, :4])
            parts.append(cut.reshape(-1, 3))
            owners.append(np.repeat(number, 2))
        before += len(rows)
    return np.concatenate(parts), np.concatenate(owners)


def _cut_quads(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Two triangles a quad, (m, 2, 3), by the diagonal that keeps them counterclockwise."""
    first = np.stack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], axis=1)
    second = np.stack([quads[:, [1, 2, 3]], quads[:, [1, 3, 0]]], axis=1)
    signs = orientations(points, first.reshape(-1, 3)).reshape(-1, 2)
    fits = (signs > 0).all(axis=1).reshape(-1, 1, 1)
    return np.where(fits, first, second)


def _grids(points: np.ndarray, triangles: np.ndarray) -> tuple[_Grid, ...]:
    """The grids of triangles, of which the smallest coordinates are 0."""
    low, high = (
        np.stack(ends, axis=1)
        for ends in zip(*(_range(points[:, axis], triangles) for axis in (0, 1)), strict=True)
    )
    extent = float(high.max())
    division = _divisions(points, triangles, high - low)
    # frexp gives the power of two just above the triangle's extent.
    level = np.frexp((high - low).max(axis=1))[1] - division
    level = np.maximum(level, np.frexp(extent)[1] - _FINEST)
    grids = []
    for one in np.unique(level)[::-1].tolist():
        square = float(2.0**one)
        for is_needle in (False, True):
            chosen = np.flatnonzero((level == one) & ((division > 0) == is_needle))
            if not len(chosen):
                continue
            if is_needle:
                which, x, y = needle_squares(points[triangles[chosen]] / square)
            else:
                which, x, y = box_squares(low[chosen] / square, high[chosen] / square)
            n_rows = int(extent / square) + 1
            key = x * n_rows + y
            order = np.argsort(key, kind="stable")
            grids.append(_Grid(square, n_rows, key[order], chosen[which[order]]))
    return tuple(grids)


def _weights(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Shape functions of the corners at points inside, (m, 3 or 4)."""
    if corners.shape[1] == 4:
        u, v = _bilinear_parameters(corners, points)
        return np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
    a, b, c = (corners[:, k] - points for k in range(3))
    parts = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=1)
    return parts / parts.sum(axis=1, keepdims=True)


def _bilinear_parameters(corners: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inverse of the bilinear map by Newton's method from the middle of the quad."""
    a, b, c, d = (corners[:, k] for k in range(4))
    u, v = np.full(len(points), 0.5), np.full(len(points), 0.5)
    twist = a - b + c - d
    for _ in range(_NEWTON_STEPS):
        rest = a + u[:, None] * (b - a) + v[:, None] * (d - a) + (u * v)[:, None] * twist - points
        along_u = b - a + v[:, None] * twist
        along_v = d - a + u[:, None] * twist
        det = _cross(along_u, along_v)
        u = np.clip(u - _cross(rest, along_v) / det, 0.0, 1.0)
        v = np.clip(v - _cross(along_u, rest) / det, 0.0, 1.0)
    return u, v


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]

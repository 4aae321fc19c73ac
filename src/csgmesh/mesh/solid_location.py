"""Finding the cell of a mesh of space at a point, exactly.

Cells that are no tetrahedra are cut into some, quadrilateral faces along the diagonal through their
corner of lowest number, so that both cells at a face agree; a warped face is those two triangles.
The tetrahedra are sorted into grids of cubes, a grid for each power of two of their extent, so that
each lies in eight cubes at most however strongly the mesh is graded. A point looks into one cube of
each grid, and an exact predicate decides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from csgmesh import kernels
from csgmesh.mesh.kinds import KINDS
from csgmesh.mesh.locate import checked_values, query_points
from csgmesh.mesh.shape_functions import weights_in_cells, weights_in_tetrahedra
from csgmesh.mesh.surfaces import require_solid_cells

#: Points are looked up in batches of this many.
_BATCH = 20_000

#: No grid has more cubes along a side: keys must fit into 64 bits.
_FINEST = 20


@dataclass(frozen=True, eq=False)
class _Grid:
    """Tetrahedra of one size class, sorted by the cube they overlap."""

    cube: float
    shape: np.ndarray
    keys: np.ndarray
    tetrahedra: np.ndarray


@dataclass(frozen=True, eq=False)
class SolidLocator:
    """Search structure over cells in space.

    Attributes
    ----------
    points : (n, 3) float64
    cells : mapping of str to (m, k) int64
    tetrahedra : (t, 4) int64
        All cells cut into tetrahedra, in the order of the cells.
    owner : (t,) int64
        The cell of each, counted through all kinds.
    boxes : (t, 6) float64
        Least and greatest coordinates of each.
    lo : (3,) float64
        Origin of the grids.
    grids : tuple
    """

    points: np.ndarray
    cells: Mapping[str, np.ndarray]
    tetrahedra: np.ndarray
    owner: np.ndarray
    boxes: np.ndarray
    lo: np.ndarray
    grids: tuple[_Grid, ...]

    @staticmethod
    def of(points: np.ndarray, cells: Mapping[str, np.ndarray]) -> SolidLocator:
        """Build the structure."""
        require_solid_cells(cells, "locate")
        tetrahedra, owner = tetrahedra_of(cells)
        finite = np.isfinite(points).all(axis=1)[tetrahedra].all(axis=1)
        tetrahedra, owner = tetrahedra[finite], owner[finite]
        corners = points[tetrahedra]
        boxes = np.hstack([corners.min(axis=1), corners.max(axis=1)])
        lo = boxes[:, :3].min(axis=0) if len(boxes) else np.zeros(3)
        return SolidLocator(points, cells, tetrahedra, owner, boxes, lo, _grids(boxes, lo))

    def cells_of(self, points: ArrayLike) -> np.ndarray:
        """Lowest number of a cell that contains each point, -1 for none."""
        found = self._tetrahedra_at(query_points(points, 3))
        return np.append(self.owner, -1)[found]

    def interpolate(self, values: ArrayLike, points: ArrayLike) -> np.ndarray:
        """Values at points from values at the corners; NaN outside."""
        given = checked_values(values, len(self.points))
        queries = query_points(points, 3)
        found = self._tetrahedra_at(queries)
        cell = np.append(self.owner, -1)[found]
        columns = given.reshape(len(given), -1)
        out = np.full((len(queries), columns.shape[1]), np.nan, given.dtype)
        before = 0
        for kind, rows in self.cells.items():
            at = np.flatnonzero((cell >= before) & (cell < before + len(rows)))
            tets = self.tetrahedra[found[at]]
            weight = weights_in_tetrahedra(self.points[tets], queries[at])
            out[at] = np.einsum("ij,ijk->ik", weight, columns[tets])
            if KINDS[kind].n_corners > 4:
                corners = rows[cell[at] - before]
                weight, fits = weights_in_cells(kind, self.points[corners], queries[at])
                own = np.einsum("ij,ijk->ik", weight[fits], columns[corners[fits]])
                out[at[fits]] = own
            before += len(rows)
        return out.reshape(len(queries), *given.shape[1:])

    def _tetrahedra_at(self, queries: np.ndarray) -> np.ndarray:
        """Lowest number of a tetrahedron that contains each point, -1 for none."""
        none = len(self.tetrahedra)
        out = np.full(len(queries), none)
        for start in range(0, len(queries), _BATCH):
            batch = np.ascontiguousarray(queries[start : start + _BATCH])
            found = out[start : start + _BATCH]
            for grid in self.grids:
                first, count = self._look(grid, batch)
                kernels.find_containing(
                    _flat(self.points),
                    _flat(self.tetrahedra),
                    _flat(self.boxes),
                    _flat(grid.tetrahedra),
                    _flat(first),
                    _flat(count),
                    _flat(batch),
                    found,
                )
        return np.where(out < none, out, -1)

    def _look(self, grid: _Grid, queries: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First tetrahedron in each point's cube of a grid, and how many there are."""
        with np.errstate(invalid="ignore"):
            cube = np.floor((queries - self.lo) / grid.cube)
            near = ((cube >= 0) & (cube < grid.shape)).all(axis=1)
        cube = np.where(near[:, None], cube, 0).astype(np.int64)
        key = np.where(near, _keys(cube, grid.shape), -1)
        first = np.searchsorted(grid.keys, key, side="left")
        return first, np.searchsorted(grid.keys, key, side="right") - first


def tetrahedra_of(cells: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Cells cut into tetrahedra, (t, 4), in the order of the cells, and the cell of each, (t,).

    Examples
    --------
    >>> pyramid = {"pyramid": np.array([[1, 2, 3, 0, 4]])}
    >>> tetrahedra_of(pyramid)[0].tolist()
    [[0, 1, 2, 4], [0, 2, 3, 4]]
    """
    parts, owners, before = [np.zeros((0, 4), np.int64)], [np.zeros(0, np.int64)], 0
    for kind, rows in cells.items():
        n = KINDS[kind].n_corners
        own = before + np.arange(len(rows))
        before += len(rows)
        if n == 4:
            parts.append(rows[:, :4])
            owners.append(own)
            continue
        lowest = rows[:, :n].argmin(axis=1)
        for k in range(n):
            at = np.flatnonzero(lowest == k)
            for ring in _rings(kind, k):
                for triangle in _triangles(rows[at][:, ring]):
                    parts.append(np.column_stack([rows[at, k], triangle]))
                    owners.append(own[at])
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.ascontiguousarray(np.concatenate(parts)[order]), owner[order]


def _rings(kind: str, corner: int) -> list[list[int]]:
    """Corners of the faces of a cell that one of its corners does not lie on."""
    data = KINDS[kind]
    faces = [
        list(face[: KINDS[face_kind].n_corners])
        for face, face_kind in zip(data.facets, data.facet_kinds, strict=True)
    ]
    return [face for face in faces if corner not in face]


def _triangles(rows: np.ndarray) -> list[np.ndarray]:
    """Faces cut along the diagonal through their lowest corner."""
    if rows.shape[1] == 3:
        return [rows]
    start = rows.argmin(axis=1)
    turned = np.take_along_axis(rows, (start[:, None] + np.arange(4)) % 4, axis=1)
    return [turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]]


def _grids(boxes: np.ndarray, lo: np.ndarray) -> tuple[_Grid, ...]:
    if not len(boxes):
        return ()
    extent = (boxes[:, 3:] - boxes[:, :3]).max(axis=1)
    whole = boxes[:, 3:].max(axis=0) - lo
    # frexp gives the power of two just above the tetrahedron's extent.
    level = np.maximum(np.frexp(extent)[1], np.frexp(whole.max())[1] - _FINEST)
    grids = []
    for one in np.unique(level)[::-1].tolist():
        chosen = np.flatnonzero(level == one)
        cube = float(2.0**one)
        shape = np.floor(whole / cube).astype(np.int64) + 1
        low = np.floor((boxes[chosen, :3] - lo) / cube).astype(np.int64)
        high = np.floor((boxes[chosen, 3:] - lo) / cube).astype(np.int64)
        keys, which = [], []
        for step in np.indices((2, 2, 2)).reshape(3, 8).T:
            fits = np.flatnonzero((low + step <= high).all(axis=1))
            keys.append(_keys(low[fits] + step, shape))
            which.append(chosen[fits])
        key = np.concatenate(keys)
        order = np.argsort(key, kind="stable")
        grids.append(_Grid(cube, shape, key[order], np.concatenate(which)[order]))
    return tuple(grids)


def _keys(cube: np.ndarray, shape: np.ndarray) -> np.ndarray:
    return np.asarray((cube[:, 0] * shape[1] + cube[:, 1]) * shape[2] + cube[:, 2])


def _flat(array: np.ndarray) -> np.ndarray:
    """A flat read-only view: the kernels are compiled for one type only."""
    flat: np.ndarray = np.ascontiguousarray(array).reshape(-1).view()
    flat.flags.writeable = False
    return flat

"""Cells of a grid that lie inside a domain, thinned until they make a manifold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.domain.windings import winding_numbers
from csgmesh.errors import BudgetError, MeshingError
from csgmesh.meshers.hexahedra.blocks import used_points
from csgmesh.meshers.hexahedra.grid import Grid
from csgmesh.meshers.hexahedra.strata import Strata

#: Rounds of cleaning; each changes fewer cells, and more than a few mean cells that swing.
_ROUNDS = 40

#: Cells of a grid for each point that a mesh may have: thin solids fill little of their box.
_ROOM = 10

#: Cells with their middle within this many cells from a face may be changed.
_LOOSE = 1.2


#: Where middles are looked up, in cells from them: no axis of a revolved solid runs there.
_ASIDE = np.array([3e-7, 2e-7, 1e-7])


@dataclass(frozen=True, eq=False)
class Core:
    """Cells of a grid, padded with one layer outside, as one flat array with z fastest.

    Attributes
    ----------
    grid : Grid
    cells : (n,) int8
        One more than the region of each cell, 0 outside.
    owner, way : (b,) int64
        Outer sides and those between regions: the cell they belong to, and 2 axis + up.
    front : (b,) int64
        Region in front of each, -1 outside.
    """

    grid: Grid
    cells: np.ndarray
    owner: np.ndarray
    way: np.ndarray
    front: np.ndarray

    @property
    def behind(self) -> np.ndarray:
        """Region behind each side, (b,)."""
        return self.cells[self.owner].astype(np.int64) - 1


def core_of(strata: Strata, grid: Grid, size: float, inset: float, max_points: int) -> Core:
    """The cells of a grid that make the core.

    Cells with their middle inside, further than `inset` cells from all outer faces that are not
    flat in the grid, then cleaned until no two of a region touch along an edge or at a point only.
    """
    n = int(np.prod(grid.shape))
    if n > _ROOM * max_points:
        raise BudgetError(
            f"a grid of {n:,} cells of size {size:.6g} over the domain's box is more than "
            f"{_ROOM} times max_points, {max_points:,}"
        )
    shape = np.array(grid.shape) + 2
    near, depth, between = _depths(strata, grid, size)
    cells = np.zeros(int(shape.prod()), np.int8)
    asked = np.flatnonzero(near)
    cells[asked] = _regions(strata, grid.middles(asked) + size * _ASIDE) + 1
    kernels.spread_regions(*grid.shape, near, cells)
    loose = asked[depth[asked] <= _LOOSE]
    signed = np.where(cells[loose] > 0, depth[loose], -depth[loose])
    cells[loose[(signed > 0.0) & (signed <= inset)]] = 0
    _clean(cells, 0, loose, signed, shape)
    if len(strata.domain.region_names) > 1:
        loose = asked[between[asked] <= _LOOSE]
        for region in range(1, len(strata.domain.region_names) + 1):
            own = np.where(cells[loose] == region, between[loose], -between[loose])
            _clean(cells, region, loose, own, shape)
    owns = _owners(strata)
    owner, way = (np.zeros(0, np.int64) for _ in range(2))
    count = kernels.list_sides(cells, owns, *grid.shape, owner, way, False)
    owner, way = (np.empty(count, np.int64) for _ in range(2))
    kernels.list_sides(cells, owns, *grid.shape, owner, way, True)
    step = np.array([shape[1] * shape[2], shape[2], 1])[way // 2] * np.where(way % 2, 1, -1)
    front = cells[owner + step].astype(np.int64) - 1
    return Core(grid, cells, owner, way, front)


def _depths(strata: Strata, grid: Grid, size: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells near any face, and distances, in cells, from bent outer faces and from interfaces."""
    domain = strata.domain
    middles = [0.5 * (line[1:] + line[:-1]) for line in grid.axes]
    widest = max(float(np.diff(line).max()) for line in grid.axes)
    reach = 1.01 * max(_LOOSE * size, widest)
    n = int((np.array(grid.shape) + 2).prod())
    near = np.zeros(n, np.int8)
    depth, between = np.full(n, np.inf), np.full(n, np.inf)
    triangles = np.ascontiguousarray(domain.points[domain.facets].reshape(-1, 9))
    normal = np.cross(triangles[:, 3:6] - triangles[:, :3], triangles[:, 6:] - triangles[:, :3])
    length = np.sqrt((normal**2).sum(axis=1))
    normal /= np.where(length > 0.0, length, 1.0)[:, None]
    is_bent = strata.face_axis[strata.face] < 0
    is_outer = (domain.facet_region < 0).any(axis=1)
    start = 0
    while start < len(triangles):
        start = kernels.measure_depths(
            triangles,
            normal,
            is_bent,
            is_outer,
            *middles,
            reach,
            near,
            depth,
            between,
            start,
        )
    return near, np.sqrt(depth) / size, np.sqrt(between) / size


def _regions(strata: Strata, points: np.ndarray) -> np.ndarray:
    domain = strata.domain
    if domain.oracle is not None:
        return np.asarray(domain.oracle.region(points))
    out = np.full(len(points), -1)
    for region in range(len(domain.region_names)):
        behind, front = (domain.facet_region == region).T
        own = np.concatenate([domain.facets[behind], domain.facets[front][:, ::-1]])
        out[winding_numbers(points, domain.points, own) != 0] = region
    return out


def _owners(strata: Strata) -> np.ndarray:
    """Whether sides of a region, plus one, towards another one belong to it, (r, r)."""
    n = len(strata.domain.region_names)
    owns = np.zeros((n + 1, n + 1), bool)
    behind, front = strata.domain.facet_region.T
    owns[behind + 1, front + 1] = True
    owns |= np.triu(np.ones_like(owns), 1) & ~owns.T
    owns[1:, 0] = True
    owns[0] = False
    return owns & ~(owns.T & np.tri(n + 1, dtype=bool))


def _clean(
    cells: np.ndarray, region: int, loose: np.ndarray, signed: np.ndarray, shape: np.ndarray
) -> None:
    """Cells of a region changed until their boundary is a manifold without spikes and pits."""
    is_loose = np.full(len(cells), -1, np.int32)
    is_loose[loose] = np.arange(len(loose), dtype=np.int32)
    around = np.zeros(len(loose), np.int8)
    for turn in range(_ROUNDS):
        fill = int(turn < _ROUNDS // 2)
        if not kernels.clean_cells(
            cells, region, loose, is_loose, signed, _BROKEN, shape, around, fill
        ):
            break


_OCTANTS = [(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)]


def _is_connected(bits: list[int]) -> bool:
    if not bits:
        return True
    reached, queue = {bits[0]}, [bits[0]]
    for bit in queue:
        for flip in (1, 2, 4):
            if bit ^ flip in bits and bit ^ flip not in reached:
                reached.add(bit ^ flip)
                queue.append(bit ^ flip)
    return len(reached) == len(bits)


#: By the pattern of the eight cells around a point: whether their boundary is no disk there.
_BROKEN = np.array(
    [
        not _is_connected([b for b in range(8) if code >> b & 1])
        or not _is_connected([b for b in range(8) if not code >> b & 1])
        for code in range(256)
    ]
)


def require_manifold(core: Core) -> None:
    """Raise if the sides of cells touch along an edge or at a point only."""
    shape = np.array(core.grid.shape) + 2
    _, sx, sy = int(shape[0]), int(shape[1] * shape[2]), int(shape[2])
    steps = np.array([a * sx + b * sy + c for a, b, c in _OCTANTS])
    near = used_points(core.owner[:, None] - steps, len(core.cells))
    around = core.cells[near[:, None] + steps]
    bits = 1 << np.arange(8)
    bad = _BROKEN[(around > 0) @ bits]
    for region in range(2, int(core.cells.max(initial=0)) + 1):
        bad |= _BROKEN[(around == region) @ bits]
    if bad.any():
        i, j, k = np.unravel_index(near[np.argmax(bad)], shape)
        x, y, z = (line[n] for line, n in zip(core.grid.axes, (i, j, k), strict=True))
        raise MeshingError(
            f"cells of the core touch only along an edge or at a point, at "
            f"({x:.6g}, {y:.6g}, {z:.6g}); a smaller size may resolve the domain there"
        )

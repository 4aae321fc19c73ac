"""Cells of a grid that lie inside a domain, thinned until they make a manifold."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.windings import winding_numbers
from csgmesh.errors import BudgetError, MeshingError
from csgmesh.meshers.hexahedra.grid import Grid
from csgmesh.meshers.hexahedra.strata import Finder, Strata

#: Rounds of cleaning; each changes fewer cells, and more than a few mean cells that swing.
_ROUNDS = 40

#: Cells of a grid for each point that a mesh may have: thin solids fill little of their box.
_ROOM = 10


def core_cells(
    strata: Strata, grid: Grid, size: float, inset: float, max_points: int
) -> np.ndarray:
    """Which cells of the grid belong to the core, (nx, ny, nz) bool.

    Cells with their middle inside, further than `inset` cells from all faces that are not flat in
    the grid, then cleaned until no two touch along an edge or at a point only.
    """
    n = int(np.prod(grid.shape))
    if n > _ROOM * max_points:
        raise BudgetError(
            f"a grid of {n:,} cells of size {size:.6g} over the domain's box is more than "
            f"{_ROOM} times max_points, {max_points:,}"
        )
    centres = grid.centres()
    inside = _contains(strata, centres)
    bent = np.flatnonzero(strata.face_axis[strata.face] < 0)
    depth = np.full(len(centres), np.inf)
    if len(bent):
        finder = Finder.of(strata, size, 1.5 * size, bent)
        _, distance, _ = finder.nearest(centres)
        depth = distance[:, 0] / size
    is_loose = (depth < 1.5).reshape(grid.shape)
    signed = np.where(inside, depth, -depth).reshape(grid.shape)
    chosen = (inside & (depth > inset)).reshape(grid.shape)
    return cleaned(chosen, is_loose, signed)


def _contains(strata: Strata, points: np.ndarray) -> np.ndarray:
    domain = strata.domain
    if domain.oracle is not None:
        return np.asarray(domain.oracle.region(points)) >= 0
    return winding_numbers(points, domain.points, domain.facets) != 0


def cleaned(chosen: np.ndarray, is_loose: np.ndarray, signed: np.ndarray) -> np.ndarray:
    """Cells taken away, and added, until the boundary is a manifold without spikes and pits.

    Only loose cells change, those near faces that are not flat in the grid.
    """
    cells = np.pad(chosen, 2)
    loose = np.pad(is_loose, 2)
    depth = np.pad(signed, 2, constant_values=-np.inf)
    for turn in range(_ROUNDS):
        before = cells.copy()
        _smooth(cells, loose, depth)
        _untouch(cells, loose, depth, fill=turn < _ROUNDS // 2)
        if (cells == before).all():
            break
    return cells[2:-2, 2:-2, 2:-2]


def _smooth(cells: np.ndarray, loose: np.ndarray, depth: np.ndarray) -> None:
    """Take away cells with at most two neighbours, but not if these lie opposite."""
    around = np.zeros(cells.shape, np.int8)
    for axis in range(3):
        for way in (1, -1):
            around += np.roll(cells, way, axis)
    cells[cells & loose & (around <= 2)] = False
    cells[~cells & loose & (around >= 5) & (depth > -0.25)] = True


def _untouch(cells: np.ndarray, loose: np.ndarray, depth: np.ndarray, fill: bool) -> None:
    """Fill, or later remove, where the eight cells at a point are not connected by faces."""
    shape = tuple(s - 1 for s in cells.shape)
    corner = [
        tuple(slice(o, o + s) for o, s in zip(offset, shape, strict=True)) for offset in _OCTANTS
    ]
    code = np.zeros(shape, np.int64)
    for bit, at in enumerate(corner):
        code |= cells[at].astype(np.int64) << bit
    for i, j, k in np.argwhere(_BROKEN[code]).tolist():
        places = [(i + a, j + b, k + c) for a, b, c in _OCTANTS]
        now = sum(int(cells[p]) << bit for bit, p in enumerate(places))
        if not _BROKEN[now]:
            continue
        choice = [(abs(depth[p]), bit) for bit, p in enumerate(places) if loose[p]]
        wanted = [bit for _, bit in sorted(choice) if bool(cells[places[bit]]) != fill]
        for bit in wanted:
            if not _BROKEN[now ^ (1 << bit)]:
                break
        else:
            if not wanted:
                continue
            bit = wanted[0]
        cells[places[bit]] = fill


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


def require_manifold(cells: np.ndarray, grid: Grid) -> None:
    """Raise if cells touch along an edge or at a point only."""
    padded = np.pad(cells, 1)
    shape = tuple(s - 1 for s in padded.shape)
    code = np.zeros(shape, np.int64)
    for bit, offset in enumerate(_OCTANTS):
        at = tuple(slice(o, o + s) for o, s in zip(offset, shape, strict=True))
        code |= padded[at].astype(np.int64) << bit
    bad = np.argwhere(_BROKEN[code])
    if len(bad):
        x, y, z = (line[i] for line, i in zip(grid.axes, bad[0].tolist(), strict=True))
        raise MeshingError(
            f"cells of the core touch only along an edge or at a point, at "
            f"({x:.6g}, {y:.6g}, {z:.6g}); a smaller size may resolve the domain there"
        )

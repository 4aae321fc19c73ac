"""Rule about structured grids: rows and columns say the same as the cells."""

from __future__ import annotations

import numpy as np

from csgmesh.measures.results import Check, Failure, offenders
from csgmesh.measures.rules.case import Case
from csgmesh.mesh.blocks import Block


def check_blocks(case: Case) -> Check:
    """The corners of each cell of a block are the points of its row and column, no cell twice."""
    rule, mesh = "blocks", case.mesh
    if not mesh.blocks:
        return Check.skipped(rule, "the mesh has no blocks")
    failures: list[Failure] = []
    n_seen = np.zeros(mesh.n_cells, np.int64)
    # Cells of all kinds in rows of four, those of triangles with their first corner twice.
    rows = np.concatenate(
        [r if r.shape[1] == 4 else r[:, [0, 1, 2, 0]] for r in case.corners.values()]
    )
    for name, block in mesh.blocks.items():
        number = block.cells
        if number.min() < 0 or number.max() >= len(rows) or not _in_range(block, mesh.n_points):
            failures.append(Failure(rule, f"block {name!r} has numbers that are out of range"))
            continue
        np.add.at(n_seen, number.ravel(), 1)
        wrong = number[~_agrees(block, rows)].ravel()
        failures += offenders(
            rule,
            "cell",
            wrong,
            case.cell_places(wrong),
            f"has|have other corners in block {name!r}",
        )
    odd = np.flatnonzero(n_seen > 1)
    complaint = "is|are in more than one place of the blocks"
    failures += offenders(rule, "cell", odd, case.cell_places(odd), complaint)
    return Check.of(rule, int((n_seen > 0).sum()), failures)


def _in_range(block: Block, n_points: int) -> bool:
    return bool(block.points.min() >= 0 and block.points.max() < n_points)


def _agrees(block: Block, rows: np.ndarray) -> np.ndarray:
    """Which cells, or pairs of triangles, have the corners of their row and column, (ni, nj)."""
    p = block.points
    wanted = np.sort(np.stack([p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]], axis=-1), axis=-1)
    given = rows[block.cells]
    if block.cells.ndim == 2:
        return np.asarray((np.sort(given, axis=-1) == wanted).all(axis=-1))
    both = np.sort(given.reshape(*block.cells.shape[:2], 8), axis=-1)
    # Two corners are in both triangles.
    is_new = np.concatenate(
        [np.ones((*both.shape[:2], 1), bool), np.diff(both, axis=-1) > 0], axis=-1
    )
    four = is_new.sum(axis=-1) == 4
    out = np.zeros(four.shape, bool)
    out[four] = (both[four][is_new[four]].reshape(-1, 4) == wanted[four]).all(axis=-1)
    return out

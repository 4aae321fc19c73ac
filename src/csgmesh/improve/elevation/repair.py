"""Help for cells that turn over when edges bend: bend the others along, or divide the cell."""

from __future__ import annotations

import numpy as np

from csgmesh.improve.elevation.curving import Curving
from csgmesh.improve.refinement import halve_edges, refine
from csgmesh.mesh import Mesh
from csgmesh.mesh.lagrange import edge_nodes

#: Cells whose Jacobian may sink below this share of its largest value get help.
FLAT = 0.1
#: Those that still do so below this one are divided.
FLATTEST = 0.02
#: How much of a curved edge's largest displacement the edges beside it take over, step by step.
SHARES = (0.25, 0.4, 0.55)


def bend_neighbours(curving: Curving) -> np.ndarray:
    """Bend inner edges of flat cells along with the curved ones; the cells that stay too flat.

    Returns
    -------
    (k,) int64
        Numbers of cells, counted through all kinds.
    """
    bad = curving.flat_cells(FLAT)
    fixed = curving.is_curve.copy()
    fixed[curving.edges.facet_edge] = True
    for share in SHARES:
        if not len(bad):
            return bad
        before = curving.bend.copy()
        _bend(curving, bad, fixed, share)
        after = curving.flat_cells(FLAT)
        if len(after) > len(bad):
            # More harm than help among the neighbours: leave these cells to refinement.
            curving.bend[:] = before
            break
        bad = after
    return curving.flat_cells(FLATTEST) if len(bad) else bad


def _bend(curving: Curving, cells: np.ndarray, fixed: np.ndarray, share: float) -> None:
    """Give the free edges of cells a parabola, as far as the curved edges bend on average."""
    inner = edge_nodes(curving.order, curving.family)[1:-1]
    bump = 4.0 * inner * (1.0 - inner)
    total = np.zeros((curving.edges.n_edges, 2))
    count = np.zeros(curving.edges.n_edges)
    first = 0
    middle = (curving.order - 2) // 2
    for _, rows, edge in curving.blocks():
        at = cells[(cells >= first) & (cells < first + len(rows))] - first
        first += len(rows)
        is_curve = curving.is_curve[edge[at]]
        depth = np.where(is_curve[:, :, None], curving.bend[edge[at]][:, :, middle], 0.0)
        pull = depth.sum(axis=1) / np.maximum(is_curve.sum(axis=1), 1)[:, None]
        for k in range(rows.shape[1]):
            free = ~fixed[edge[at, k]]
            np.add.at(total, edge[at[free], k], pull[free])
            np.add.at(count, edge[at[free], k], 1.0)
    hit = np.flatnonzero(count)
    pull = share * total[hit] / count[hit, None]
    curving.bend[hit] = bump[:, None] * pull[:, None, :]


def divide(curving: Curving, cells: np.ndarray) -> Mesh:
    """Divide cells of the straight mesh.

    A cell with two edges on a smooth curve has a corner of 180 degrees there, and so would a child:
    it is cut from that corner to the edges that do not touch it. All others become four.
    """
    mesh, first = curving.mesh, 0
    pairs, rest = [np.zeros((0, 2), np.int64)], []
    for _, rows, edge in curving.blocks():
        at = cells[(cells >= first) & (cells < first + len(rows))] - first
        bent = curving.is_curve[edge[at]]
        width = rows.shape[1]
        # Corner k lies between the edges k - 1 and k.
        ear = bent & np.roll(bent, 1, axis=1) & (bent.sum(axis=1) == 2)[:, None]
        cell, corner = np.nonzero(ear)
        for step in range(1, width - 1):
            ends = [(corner + step) % width, (corner + step + 1) % width]
            pairs.append(np.stack([rows[at[cell], end] for end in ends], axis=1))
        rest.append(first + at[~ear.any(axis=1)])
        first += len(rows)
    others = np.concatenate(rest)
    ears = np.concatenate(pairs)
    return halve_edges(mesh, ears) if len(ears) else refine(mesh, others)

"""Straight strips of quads along edges that the solid surrounds.

Where a flat face meets another one at a reentrant edge, the edge runs in steps over the quads of
the grid on the flat face, and a quad in a step's nook would get a straight angle. A sheet of cells
that comes up along the edge and turns away some cells below the face puts a strip of quads there,
each with one side on the edge.
"""

from __future__ import annotations

import numpy as np

from csgmesh.meshers.hexahedra.blocks import SIDES, Blocks, beside
from csgmesh.meshers.hexahedra.labels import unresolved
from csgmesh.meshers.hexahedra.strata import Strata

#: Edges with more than this many degrees inside the solid are reentrant.
_REENTRANT = 200.0

#: How many cells below the flat face the sheet turns away.
_DEPTH = 2

#: How far the vertices behind a new sheet draw back, in shares of a cell.
_BACK = 0.3


def with_strips(blocks: Blocks, strata: Strata, bent: np.ndarray) -> Blocks:
    """Blocks of a grid with a strip on each flat face along its reentrant edges with bent ones."""
    core, origin = blocks, np.arange(len(blocks.hexes))
    pairs = np.unique(strata.pair[strata.turn > _REENTRANT], axis=0)
    for flat in np.flatnonzero(~bent).tolist():
        others = pairs[(pairs == flat).any(axis=1)].ravel()
        if not bent[others].any():
            continue
        others = others[bent[others]]
        own = core.label == flat
        if np.isin(core.label[beside(core.quads)[own]], others).any():
            backs = _below(core, own, int(strata.face_axis[flat]))
            blocks, behind = _split(blocks, backs[origin])
            origin = np.concatenate([origin, origin[behind]])
    return blocks


def _below(core: Blocks, own: np.ndarray, axis: int) -> np.ndarray:
    """Which cells of the grid draw back: those below the quads of a face and all deeper ones."""
    corner = core.points[core.hexes]
    low, high = corner.min(axis=1), corner.max(axis=1)
    quads = core.quads[own]
    place = core.points[quads[0, 0], axis]
    a, b = core.points[quads[0, 1]] - core.points[quads[0, 0]], core.points[quads[0, 2]]
    up = np.cross(a, b - core.points[quads[0, 1]])[axis] > 0.0
    gap = place - high[:, axis] if up else low[:, axis] - place
    behind = gap >= -1e-9 * np.abs(gap).max()
    levels = np.unique(np.round(gap[behind], 12))
    deepest = levels[min(_DEPTH, len(levels)) - 1]
    sides = [k for k in range(3) if k != axis]
    column = core.points[quads].min(axis=1)[:, sides]
    table, key = np.unique(np.concatenate([column, low[:, sides]]), axis=0, return_inverse=True)
    under = np.zeros(len(table), bool)
    under[key.reshape(-1)[: len(column)]] = True
    is_under = under[key.reshape(-1)[len(column) :]]
    return np.asarray(behind & (is_under | (gap > deepest * (1 + 1e-9) + 1e-12)))


def _split(blocks: Blocks, backs: np.ndarray) -> tuple[Blocks, np.ndarray]:
    """A sheet of cells between those that draw back (m,) bool and the others.

    Also the cell behind each cell of the sheet.
    """
    hexes, points = blocks.hexes, blocks.points
    face = np.concatenate([hexes[:, list(side)] for side in SIDES.values()])
    owner = np.tile(np.arange(len(hexes)), len(SIDES))
    rows = np.sort(face, axis=1)
    order = np.lexsort(rows.T[::-1])
    same = (rows[order[1:]] == rows[order[:-1]]).all(axis=1)
    one, two = order[:-1][same], order[1:][same]
    outer = np.ones(len(rows), bool)
    outer[one], outer[two] = False, False
    crossing = backs[owner[one]] != backs[owner[two]]
    chosen = np.where(backs[owner[one]], one, two)[crossing]
    if not len(chosen):
        return blocks, chosen
    sheet = face[chosen]
    doubled = np.unique(sheet)
    copy = np.arange(len(points))
    copy[doubled] = len(points) + np.arange(len(doubled))
    at = np.flatnonzero(outer)
    cell = {tuple(r): k for r, k in zip(rows[at].tolist(), owner[at].tolist(), strict=True)}
    found = np.array([cell[tuple(r)] for r in np.sort(blocks.quads, axis=1).tolist()])
    keeps = backs[found]
    strip, label = _open_sides(blocks, sheet, keeps, copy)
    quads = np.where(keeps[:, None], blocks.quads, copy[blocks.quads])
    moved = points.copy()
    moved[doubled] += _BACK * _towards(points, hexes[backs])[doubled]
    out = Blocks(
        np.concatenate([moved, points[doubled]]),
        np.concatenate(
            [np.where(backs[:, None], hexes, copy[hexes]), np.column_stack([sheet, copy[sheet]])]
        ),
        np.concatenate([quads, strip]),
        np.concatenate([blocks.label, label]),
    )
    return out, owner[chosen]


def _towards(points: np.ndarray, hexes: np.ndarray) -> np.ndarray:
    """From each point to the mean of the middles of its cells, (n, 3)."""
    centre = np.repeat(points[hexes].mean(axis=1), 8, axis=0)
    at, n = hexes.ravel(), len(points)
    count = np.maximum(np.bincount(at, minlength=n), 1)
    mean = [np.bincount(at, centre[:, k], n) / count for k in range(3)]
    return np.column_stack(mean) - points


def _open_sides(
    blocks: Blocks, sheet: np.ndarray, keeps: np.ndarray, copy: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Quads where a sheet comes to the boundary, and their labels: those of what draws back."""
    tail, head = sheet.ravel(), np.roll(sheet, -1, axis=1).ravel()
    low = np.sort(np.column_stack([tail, head]), axis=1)
    _, which, count = np.unique(low, axis=0, return_inverse=True, return_counts=True)
    times = count[which.reshape(-1)]
    if (times > 2).any():
        raise unresolved("the grid is tangled", blocks.points[tail[np.argmax(times)]])
    at = np.flatnonzero(times == 1)
    quads = blocks.quads[keeps]
    begin, end = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
    labels = np.repeat(blocks.label[keeps], 4)
    edges = {(a, b): k for k, (a, b) in enumerate(zip(begin.tolist(), end.tolist(), strict=True))}
    label = []
    for a, b in zip(tail[at].tolist(), head[at].tolist(), strict=True):
        k = edges.get((b, a))
        if k is None:
            raise unresolved("the grid is tangled", blocks.points[a])
        label.append(int(labels[k]))
    strip = np.column_stack([tail[at], head[at], copy[head[at]], copy[tail[at]]])
    return strip, np.array(label, np.int64)

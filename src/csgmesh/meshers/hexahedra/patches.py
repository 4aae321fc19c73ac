"""Rows of cells along curves that run in steps within a sheet.

Where two faces share a sheet, the curve between them follows edges of the grid in steps, and a quad
in a step's nook would get a straight angle. So the cells of the sheet below one face draw back from
all others: a layer of cells comes in below them and along the curve, where it shows a row of quads
with one side each on the curve (a pillow around a patch: Mitchell and Tautges 1995).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh.meshers.hexahedra.blocks import Blocks, beside, used_points
from csgmesh.meshers.hexahedra.labels import unresolved


def stepped_faces(blocks: Blocks, chosen: np.ndarray) -> np.ndarray:
    """Faces with a quad among the chosen (b,) bool that has two sides on one curve among them."""
    quads, label = blocks.quads, blocks.label
    across = beside(quads)
    is_curve = (label[across] != label[:, None]) & chosen[across] & chosen[:, None]
    other = np.where(is_curve, label[across], -1)
    is_nook = is_curve & (other == np.roll(other, 1, axis=1))
    key = np.unique(quads.ravel() * (int(label.max()) + 1) + np.repeat(label, 4))
    several = np.bincount(key // (int(label.max()) + 1), minlength=len(blocks.points)) > 2
    is_nook &= ~several[quads]
    return np.unique(label[is_nook.any(axis=1)])


def with_pillow(blocks: Blocks, cells: np.ndarray, outer: np.ndarray) -> Blocks:
    """Cells of a sheet (s,), each below its outer quad (s,), drawn back from all other cells."""
    low, high = blocks.hexes[cells, :4], blocks.hexes[cells, 4:]
    row, side, beyond = _border(blocks, high, outer)
    following = (side + 1) % 4
    a, b = low[row, side], low[row, following]
    d, c = high[row, side], high[row, following]
    across = np.sort(blocks.quads[beyond], axis=1)
    is_open = (across == np.sort(np.column_stack([a, b, c, d]), axis=1)).all(axis=1)
    copy, points = _copies(blocks, low, high, np.unique(np.concatenate([c[~is_open], d[~is_open]])))
    hexes = blocks.hexes.copy()
    hexes[cells] = copy[hexes[cells]]
    wall = np.column_stack([a, b, c, d])[~is_open]
    quads = blocks.quads.copy()
    quads[outer] = copy[quads[outer]]
    quads[beyond[is_open]] = copy[quads[beyond[is_open]]]
    strips = np.column_stack([d, c, copy[c], copy[d]])[~is_open]
    sills = np.column_stack([a, b, copy[b], copy[a]])[is_open]
    ends, beside_end = _ends(a, b, c, d, is_open, copy, beyond, blocks)
    new = np.concatenate([strips, sills, ends])
    like = np.concatenate([outer[row[~is_open]], beyond[is_open], beside_end])
    layers = np.concatenate(
        [np.column_stack([low, copy[low]]), np.column_stack([copy[wall], wall])]
    )
    region = blocks.region[cells[0]]
    return replace(
        blocks,
        points=points,
        hexes=np.concatenate([hexes, layers]),
        region=np.concatenate([blocks.region, np.full(len(layers), region)]),
        quads=np.concatenate([quads, new]),
        label=np.concatenate([blocks.label, blocks.label[like]]),
        behind=np.concatenate([blocks.behind, blocks.behind[like]]),
        front=np.concatenate([blocks.front, blocks.front[like]]),
    )


def _border(
    blocks: Blocks, high: np.ndarray, outer: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sides of the cells' outer quads towards others: row, side, and the quad beyond."""
    among = np.zeros(len(blocks.quads), bool)
    among[outer] = True
    beyond = beside(blocks.quads)[outer]
    row, side = np.nonzero(~among[beyond])
    tail = high[row, side]
    count = np.bincount(tail, minlength=1)
    if (count > 1).any():
        raise unresolved("a face is pinched", blocks.points[np.argmax(count)])
    return row, side, beyond[row, side]


def _copies(
    blocks: Blocks, low: np.ndarray, high: np.ndarray, rim: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The copy of each point, itself where it has none, and the points with copies, in a bit."""
    n = len(blocks.points)
    doubled = np.concatenate([used_points(low, n), rim])
    copy = np.arange(n)
    copy[doubled] = n + np.arange(len(doubled))
    centre = np.repeat(0.5 * (blocks.points[low].mean(1) + blocks.points[high].mean(1)), 8, axis=0)
    at = np.column_stack([low, high]).ravel()
    count = np.maximum(np.bincount(at, minlength=n), 1)
    mean = np.column_stack([np.bincount(at, centre[:, k], n) / count for k in range(3)])
    fresh = blocks.points[doubled] + _BACK * (mean - blocks.points)[doubled]
    return copy, np.concatenate([blocks.points, fresh])


#: How far copies draw back, as a share of the way to the middle of their cells.
_BACK = 0.4


def _ends(
    a: np.ndarray,
    b: np.ndarray,
    c: np.ndarray,
    d: np.ndarray,
    is_open: np.ndarray,
    copy: np.ndarray,
    beyond: np.ndarray,
    blocks: Blocks,
) -> tuple[np.ndarray, np.ndarray]:
    """Sides of the layer where a wall ends at an open side, and the open sides' quads."""
    n = len(blocks.points)
    starts, stops = np.full(n, -1), np.full(n, -1)
    opened = np.flatnonzero(is_open)
    starts[d[opened]], stops[c[opened]] = beyond[opened], beyond[opened]
    wall = np.flatnonzero(~is_open)
    first, last = wall[stops[d[wall]] >= 0], wall[starts[c[wall]] >= 0]
    head = np.column_stack([copy[d[first]], copy[a[first]], a[first], d[first]])
    tail = np.column_stack([copy[b[last]], copy[c[last]], c[last], b[last]])
    return np.concatenate([head, tail]), np.concatenate([stops[d[first]], starts[c[last]]])

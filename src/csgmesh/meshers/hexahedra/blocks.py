"""Hexahedra in the making: cells, their outer quads and the face each quad belongs to."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

#: The corners of a hexahedron's sides, seen from outside, by 2 axis + up.
SIDES = np.array(
    [(3, 0, 4, 7), (1, 2, 6, 5), (0, 1, 5, 4), (2, 3, 7, 6), (0, 3, 2, 1), (4, 5, 6, 7)]
)


@dataclass(frozen=True, eq=False)
class Blocks:
    """Cells and boundary of an unfinished mesh.

    Attributes
    ----------
    points : (n, 3) float64
    hexes : (m, 8) int64
    region : (m,) int64
    quads : (b, 4) int64
        The boundary, seen from outside the region behind it.
    label : (b,) int64
        Face of the domain that each quad belongs to.
    behind, front : (b,) int64
        Regions on both sides of each quad, -1 outside.
    """

    points: np.ndarray
    hexes: np.ndarray
    region: np.ndarray
    quads: np.ndarray
    label: np.ndarray
    behind: np.ndarray
    front: np.ndarray

    def with_points(self, points: np.ndarray) -> Blocks:
        """The same cells elsewhere."""
        return replace(self, points=points)


def used_points(rows: np.ndarray, n: int) -> np.ndarray:
    """Points out of n that rows name, ascending."""
    used = np.zeros(n, bool)
    used[rows] = True
    return np.flatnonzero(used)


def paired_edges(quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges of a closed manifold, 4 quad + side, once from either side, (e,) each."""
    tail, head = quads.ravel(), quads[:, [1, 2, 3, 0]].ravel()
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    order = np.argsort(low * (int(high.max(initial=0)) + 1) + high, kind="stable")
    return order[0::2], order[1::2]


def beside(quads: np.ndarray) -> np.ndarray:
    """Quad across each side of each quad of a closed manifold, (b, 4)."""
    one, two = paired_edges(quads)
    across = np.empty(4 * len(quads), np.int64)
    across[one], across[two] = two, one
    return (across // 4).reshape(-1, 4)


def with_sheet(blocks: Blocks, chosen: np.ndarray, in_front: bool = False) -> Blocks:
    """A sheet of cells put in behind chosen quads (b,) bool, which become its outer sides.

    Vertices of the chosen quads get a copy, which the new outer sides have; the cells behind keep
    the old ones. Where the chosen quads end, the sheet shows a side of its own, which belongs to
    the face on which it stands. A sheet in front of quads between regions lies on their other side.
    """
    quads, n = blocks.quads, len(blocks.points)
    own = quads[chosen][:, ::-1] if in_front else quads[chosen]
    copy = np.arange(n)
    doubled = used_points(own, n)
    copy[doubled] = n + np.arange(len(doubled))
    across = beside(quads)[chosen]
    at, side = np.nonzero(~chosen[across])
    tail, head = quads[chosen][at, side], quads[chosen][at, (side + 1) % 4]
    strip = np.column_stack([tail, head, copy[head], copy[tail]])
    outer = quads.copy()
    outer[chosen] = copy[quads[chosen]]
    region = (blocks.front if in_front else blocks.behind)[chosen]
    hexes = blocks.hexes
    if (blocks.front[chosen] >= 0).any():
        beyond = (blocks.behind if in_front else blocks.front)[chosen]
        hexes = np.where(np.isin(blocks.region, beyond)[:, None], copy[hexes], hexes)
    neighbour = across[at, side]
    return Blocks(
        np.concatenate([blocks.points, blocks.points[doubled]]),
        np.concatenate([hexes, np.column_stack([own, copy[own]])]),
        np.concatenate([blocks.region, region]),
        np.concatenate([outer, strip]),
        np.concatenate([blocks.label, blocks.label[neighbour]]),
        np.concatenate([blocks.behind, blocks.behind[neighbour]]),
        np.concatenate([blocks.front, blocks.front[neighbour]]),
    )

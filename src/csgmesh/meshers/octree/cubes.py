"""Hexahedra and pyramids in place of lattice tetrahedra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.meshers.octree.lattice import Lattice

#: Corners of each side of a leaf, counterclockwise seen from beyond it: -x, +x, -y, ...
_SIDES = np.array(
    [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
)
#: A leaf's corners in the order of a hexahedron.
_HEXAHEDRON = np.array([0, 1, 3, 2, 4, 5, 7, 6])


@dataclass(frozen=True, eq=False)
class MixedCells:
    """Cells of all kinds, and their regions.

    Attributes
    ----------
    points : (n, 3) float64
        Those that a cell has; the rest of the given ones, in their order.
    number : (n_given,) int64
        Where each given point is now, -1 for those that are gone.
    cells, region : dict of str to array
        ``hexahedron``, ``pyramid`` and ``tetra``, those of them that there are.
    """

    points: np.ndarray
    number: np.ndarray
    cells: dict[str, np.ndarray]
    region: dict[str, np.ndarray]


def mixed_cells(
    points: np.ndarray, tets: np.ndarray, region: np.ndarray, grid: Lattice
) -> MixedCells:
    """Hexahedra for the leaves of a lattice that tetrahedra fill as they fill the whole lattice.

    Across each side of a leaf that has an equal one beyond, the lattice has an octahedron: four
    tetrahedra around the edge between both centres. A leaf becomes a hexahedron if all its six
    octahedra are there. Of an octahedron between two hexahedra nothing is left, of one with a
    hexahedron on one side the pyramid between the side and the other centre; so any choice of
    leaves conforms.

    Parameters
    ----------
    points : (n, 3) float64
    tets : (m, 4) int64
        Positively oriented, some of them between the lattice's points.
    region : (m,) int64
        Region of each; the same on both sides of a face that has a point of the lattice.
    grid : Lattice
    """
    # One more, so that -1 leads to -1.
    lattice_point = np.append(matched(points, grid.points), -1)
    centre, corner = lattice_point[grid.centre_point], lattice_point[grid.corner_point]
    row, leaf, axis = _octahedron_parts(len(points), tets, centre, corner, grid)
    n = len(grid.leaf_corner)
    place = 3 * leaf + axis
    whole = (np.bincount(place, minlength=3 * n) == 4).reshape(n, 3)
    before, after = grid.next_to[:, 0::2], grid.next_to[:, 1::2]
    whole_before = (before >= 0) & whole[np.maximum(before, 0), np.arange(3)]
    is_hexahedron = (whole & whole_before).all(axis=1)

    beyond = after[leaf, axis]
    goes = is_hexahedron[leaf] | is_hexahedron[beyond]
    region_of = np.empty(n, np.int64)
    for side in (leaf, beyond):
        region_of[side] = region[row]
    leaves = np.flatnonzero(is_hexahedron)
    base, apex_leaf = _pyramids(leaves, is_hexahedron, grid)
    stay = np.ones(len(tets), bool)
    stay[row[goes]] = False
    cells = {
        "hexahedron": corner[grid.leaf_corner[leaves][:, _HEXAHEDRON]],
        "pyramid": np.column_stack([corner[base], centre[apex_leaf]]),
        "tetra": tets[stay],
    }
    regions = {
        "hexahedron": region_of[leaves],
        "pyramid": region_of[apex_leaf],
        "tetra": region[stay],
    }
    kinds = [kind for kind, rows in cells.items() if len(rows)]
    used = np.ones(len(points), bool)
    used[centre[leaves]] = False
    number = np.where(used, np.cumsum(used) - 1, -1)
    return MixedCells(
        points[used],
        number,
        {kind: number[cells[kind]] for kind in kinds},
        {kind: regions[kind] for kind in kinds},
    )


def matched(points: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Number of the point that is exactly each of the wanted ones, -1 where there is none.

    Both lists have each place once.
    """
    both = np.concatenate([points, wanted])
    # Stable, so that of two at one place the point comes before the wanted one.
    order = np.lexsort(both.T)
    first, second = order[:-1], order[1:]
    same = (both[first] == both[second]).all(axis=1)
    out = np.full(len(wanted), -1)
    out[second[same] - len(points)] = first[same]
    return out


def _octahedron_parts(
    n_points: int, tets: np.ndarray, centre: np.ndarray, corner: np.ndarray, grid: Lattice
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tetrahedra that are quarters of octahedra, and which: the leaf before its side, and the axis.

    A tetrahedron is one if it has the centres of two leaves side by side and two corners of the
    side between them; these are neighbours, for with opposite corners it would be flat.
    """
    leaf_of, corner_of = np.full(n_points, -1, np.int32), np.full(n_points, -1, np.int32)
    for of, number in ((leaf_of, centre), (corner_of, corner)):
        known = np.flatnonzero(number >= 0)
        of[number[known]] = known
    leaf = leaf_of[tets]
    row = np.flatnonzero((leaf >= 0).sum(axis=1) == 2)
    vertex, leaf = corner_of[tets[row]], leaf[row]
    # Of the other two there is -1 in each row.
    one, two = leaf.max(axis=1), vertex.max(axis=1)
    other, three = leaf.sum(axis=1) + 2 - one, vertex.sum(axis=1) + 2 - two
    ways = grid.next_to[one] == other[:, None]
    way = np.argmax(ways, axis=1)
    sides = grid.leaf_corner.astype(np.int32)[:, _SIDES].reshape(-1, 4)[6 * one + way]
    is_on = [(sides == corner[:, None]).any(axis=1) for corner in (two, three)]
    at = np.flatnonzero(ways.any(axis=1) & is_on[0] & is_on[1])
    low = np.where(way & 1, one, other)
    return row[at], low[at], way[at] >> 1


def _pyramids(
    leaves: np.ndarray, is_hexahedron: np.ndarray, grid: Lattice
) -> tuple[np.ndarray, np.ndarray]:
    """Sides of hexahedra with none beyond: their corners, and the leaf whose centre is the apex."""
    beyond = grid.next_to[leaves]
    at, way = np.nonzero(~is_hexahedron[beyond])
    return grid.leaf_corner[leaves[at][:, None], _SIDES[way]], beyond[at, way]

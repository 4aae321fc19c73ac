"""The lattice inside a solid: points on a balanced octree, and tetrahedra that are kept."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.meshers.octree.sizes import CUBE, SpaceSizes
from csgmesh.tree import LinearTree

#: Largest leaf as a share of the size. Leaves are powers of two of the root, so that edges come
#: out between 0.6 and 1.4 times the size; where it is uniform, the leaves fit it.
LEAF = 1.4
#: Share of a leaf's side within which its centre and corners are too near the surface: 0.6 of the
#: size. Above 0.559, spheres around regular tetrahedra of points that are not too near are empty.
NEAR = 0.5625
#: Triangles, or leaves, between two returns from a kernel.
_SLICE = 20_000


@dataclass(frozen=True, eq=False)
class Lattice:
    """Points inside a solid, and the regular tetrahedra among them.

    Attributes
    ----------
    points : (n, 3) float64
        Centres and corners of leaves, no nearer to the surface than 0.56 of a leaf's side.
    kept : (t, 4) int64
        Strictly Delaunay tetrahedra of the body-centred lattice, positively oriented.
    tree : LinearTree
    leaf_corner : (n_leaves, 8) int64
        Corners of each leaf, x fastest.
    next_to : (n_leaves, 6) int64
        Leaf of the same size across each side, -1 for none, -2 where there are smaller ones.
    centre_point, corner_point : (n_leaves,), (n_corners,) int64
        Point of each centre and corner, -1 for those that are not in the lattice.
    """

    points: np.ndarray
    kept: np.ndarray
    tree: LinearTree
    leaf_corner: np.ndarray
    next_to: np.ndarray
    centre_point: np.ndarray
    corner_point: np.ndarray


def lattice(sizes: SpaceSizes, surface: SurfaceMesh, max_points: int = 10**7) -> Lattice:
    """The lattice of the sizes inside a surface mesh.

    Raises
    ------
    BudgetError
        If it takes more leaves than `max_points`; with the place of the smallest.
    """
    tree = lattice_tree(sizes, surface, max_points)
    leaf_corner, corner = numbered_corners(tree)
    shape = np.ascontiguousarray(surface.points[surface.triangles]).reshape(-1)
    flat_corner, place = leaf_corner.reshape(-1), corner.reshape(-1)
    near_centre, near_corner = _near(tree, flat_corner, len(corner), shape)
    inside = _inside(tree, corner, flat_corner, near_centre, near_corner, surface, shape)
    points = np.empty((int(np.count_nonzero(inside)), 3))
    centre_point = np.empty(tree.n_leaves, np.int64)
    corner_point = np.empty(len(corner), np.int64)
    kernels.list_lattice(
        tree.key,
        tree.level,
        tree.unit,
        flat_corner,
        place,
        inside,
        centre_point,
        corner_point,
        points.reshape(-1),
    )
    next_to = np.empty((tree.n_leaves, 6), np.int64)
    kept = np.empty((12 * int(np.count_nonzero(centre_point >= 0)), 4), np.int64)
    n = 0
    for begin in range(0, tree.n_leaves, 10 * _SLICE):
        end = min(begin + 10 * _SLICE, tree.n_leaves)
        kernels.beside(tree.key, tree.level, begin, end, next_to.reshape(-1))
    for begin in range(0, tree.n_leaves, 10 * _SLICE):
        end = min(begin + 10 * _SLICE, tree.n_leaves)
        n = kernels.keep_tetrahedra(
            next_to.reshape(-1),
            flat_corner,
            centre_point,
            corner_point,
            begin,
            end,
            n,
            kept.reshape(-1),
        )
    return Lattice(points, kept[:n], tree, leaf_corner, next_to, centre_point, corner_point)


def lattice_tree(sizes: SpaceSizes, surface: SurfaceMesh, max_points: int) -> LinearTree:
    """The balanced tree whose leaves in the domain's box are as small as the sizes ask for."""
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    if sizes.uniform is not None:
        side = CUBE * sizes.uniform

        def is_large(lo: np.ndarray, extent: np.ndarray) -> np.ndarray:
            away = (lo > high).any(axis=1) | (lo + extent < low).any(axis=1)
            return ~away & (extent[:, 0] > 1.5 * side)

        return sizes.tree.refined_where(is_large, 4 * max_points)

    def is_coarse(lo: np.ndarray, extent: np.ndarray) -> np.ndarray:
        out = ~((lo > high).any(axis=1) | (lo + extent < low).any(axis=1))
        out[out] = extent[out, 0] > LEAF * sizes(lo[out] + 0.5 * extent[out])
        if sizes.wanted is not None:
            out[out] = sizes.given.meets(lo[out], extent[out])
        return out

    return sizes.tree.refined_where(is_coarse, 4 * max_points).balanced()


def numbered_corners(tree: LinearTree) -> tuple[np.ndarray, np.ndarray]:
    """Corners of each leaf, (n, 8), and their places, (k, 3)."""
    # A split adds at most 19 corners and 7 leaves.
    corner = np.empty((3 * tree.n_leaves + 8, 3), np.int64)
    entries = 1 << int(np.ceil(np.log2(4 * tree.n_leaves + 16)))
    table, number = np.full(entries, -1), np.empty(entries, np.int64)
    leaf_corner = np.empty((tree.n_leaves, 8), np.int64)
    n = kernels.number_corners(
        tree.key, tree.level, table, number, leaf_corner.reshape(-1), corner.reshape(-1)
    )
    return leaf_corner, corner[:n]


def _near(
    tree: LinearTree, leaf_corner: np.ndarray, n_corners: int, shape: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Which centres and which corners are too near to triangles (m * 9,), uint8."""
    near_centre = np.zeros(tree.n_leaves, np.uint8)
    near_corner = np.zeros(n_corners, np.uint8)
    largest = np.empty(n_corners, np.int64)
    kernels.largest_leaves(tree.level, leaf_corner, largest)
    n = len(shape) // 9
    at_once = min(n, _SLICE)
    frames = np.empty(4 * (tree.deepest + 1), np.int64)
    bounds = np.empty(6 * at_once)
    lists = np.empty((tree.deepest + 2) * at_once + 1, np.int32)
    for begin in range(0, n, _SLICE):
        kernels.mark_near_triangles(
            tree.key,
            tree.level,
            tree.unit,
            shape,
            begin,
            min(begin + _SLICE, n),
            NEAR,
            leaf_corner,
            largest,
            frames,
            bounds,
            lists,
            near_centre,
            near_corner,
        )
    return near_centre, near_corner


def _inside(
    tree: LinearTree,
    corner: np.ndarray,
    leaf_corner: np.ndarray,
    near_centre: np.ndarray,
    near_corner: np.ndarray,
    surface: SurfaceMesh,
    shape: np.ndarray,
) -> np.ndarray:
    """Which centres and corners are inside and not near, (n_leaves + n_corners,) uint8.

    What is joined lies on one side; one winding number tells for all of it.
    """
    parent = np.empty(tree.n_leaves + len(corner), np.int64)
    kernels.join_leaves(leaf_corner, near_centre, near_corner, parent)
    far = np.concatenate([near_centre, near_corner]) == 0
    lead = np.zeros(len(parent), bool)
    lead[parent[far]] = True
    leads = np.flatnonzero(lead)
    leaves = leads[leads < tree.n_leaves]
    lo, extent = tree[leaves].boxes()
    places = np.concatenate(
        [lo + 0.5 * extent, tree.lo + corner[leads[len(leaves) :] - tree.n_leaves] * tree.unit[3:]]
    )
    is_in = np.zeros(len(parent), bool)
    is_in[leads] = _turns(surface, shape, places) != 0
    return (far & is_in[parent]).astype(np.uint8)


def _turns(surface: SurfaceMesh, shape: np.ndarray, places: np.ndarray) -> np.ndarray:
    """How often the outer surface winds around places (k, 3), (k,) int64."""
    region = surface.region
    outer = np.flatnonzero((region[:, 0] < 0) | (region[:, 1] < 0))
    a, b, c = shape.reshape(-1, 9)[outer, ::3].T
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    width = (high - low).max(initial=0.0)
    order = np.argsort(low, kind="stable")
    outer, low = outer[order], low[order]
    shape, number = shape.reshape(-1, 9)[outer].reshape(-1), surface.triangles[outer].reshape(-1)
    # Triangles above or below a place begin no further left of it than the widest is wide.
    first = np.searchsorted(low, places[:, 0] - 1.01 * width)
    last = np.searchsorted(low, places[:, 0], "right")
    turns = np.zeros(len(places), np.int64)
    at_once = max(10**8 // max(len(outer), 1), 1)
    for begin in range(0, len(places), at_once):
        end = min(begin + at_once, len(places))
        kernels.wind_around(
            shape,
            number,
            first,
            last,
            begin,
            end,
            places.reshape(-1),
            turns,
        )
    return turns

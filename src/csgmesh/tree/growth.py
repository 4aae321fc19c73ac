"""A tree that grows around the features of a domain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.tree.linear import LinearTree

#: Region of a leaf that has features near it.
MIXED = -2
#: Features are near a leaf if they meet its box grown by this share on all sides.
NEAR = 0.5
#: Largest leaf beside a gap between two features, as the gap's share of it.
GAP = 0.6


@dataclass(frozen=True, eq=False)
class Features:
    """Pieces of boundaries, and points, around which a tree grows.

    Attributes
    ----------
    ends : (m, 2, 2) float64
        Straight pieces; both ends of a point are the same.
    slack : (m,) float64
        How far the exact curve may be from each.
    vertex : (m, 2) int64
        Vertices of the domain at the ends of the segment that each is a piece of.
    points : (n, 2) float64
        Coordinates of the domain's vertices.
    sides : (m, 2) int64
        Regions on the left and the right, -1 outside.
    wanted : (m,) float64
        Largest leaf that each allows near it.
    """

    ends: np.ndarray
    slack: np.ndarray
    vertex: np.ndarray
    points: np.ndarray
    sides: np.ndarray
    wanted: np.ndarray


#: Region of points (k, 2) away from all features, -1 outside.
RegionOf = Callable[[np.ndarray], np.ndarray]
#: Which leaves to split by size: (leaves, regions of them, lists of features) to (k,) bool.
IsCoarse = Callable[["Growth", np.ndarray], np.ndarray]


class Growth:
    """Grows a tree level by level; knows the region of each leaf and the features near it.

    Parameters
    ----------
    root : LinearTree
    features : Features
    region_of : callable
        Region of points (k, 2) that are far from all features, -1 outside.
    """

    def __init__(self, root: LinearTree, features: Features, region_of: RegionOf) -> None:
        self.tree = root
        self.features = features
        self.region_of = region_of
        m = len(features.ends)
        self.region = np.full(root.n_leaves, MIXED, np.int32)
        self.active = np.zeros(1, np.int64)
        self.offset = np.array([0, m])
        self.item = np.arange(m)
        self.is_new = np.ones(1, np.uint8)

    def grow(self, is_coarse: IsCoarse, max_leaves: int) -> None:
        """Split leaves until neither the size nor the features ask for it.

        Raises
        ------
        BudgetError
            If that takes more leaves, or levels, than there may be; with the place.
        """
        while True:
            marked = np.zeros(self.tree.n_leaves, np.uint8)
            self._mark_features(marked)
            candidates = np.flatnonzero((self.is_new == 1) & (marked == 0) & (self.region != -1))
            if len(candidates):
                marked[candidates] = is_coarse(self, candidates)
            if not marked.any():
                return
            self.tree.check_budget(marked, max_leaves)
            self._split(marked)

    def features_of(self, leaves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs (position in `leaves`, feature) of the features near some leaves (sorted)."""
        at = np.minimum(np.searchsorted(leaves, self.active), len(leaves) - 1)
        listed = np.flatnonzero(leaves[at] == self.active)
        count = np.diff(self.offset)[listed]
        row = np.repeat(at[listed], count)
        before = np.cumsum(count) - count
        step = np.arange(len(row)) - np.repeat(before, count)
        return row, self.item[np.repeat(self.offset[:-1][listed], count) + step]

    def _mark_features(self, marked: np.ndarray) -> None:
        tree, f = self.tree, self.features
        kernels.mark_features(
            tree.key,
            tree.level,
            tree.unit,
            self.active,
            self.offset,
            self.item,
            self.is_new,
            f.ends.reshape(-1),
            f.vertex.reshape(-1),
            f.points.reshape(-1),
            f.sides.reshape(-1),
            f.wanted,
            GAP,
            np.empty(10),
            marked,
        )

    def _split(self, marked: np.ndarray) -> None:
        old = self.tree
        self.tree, self.is_new, first = old.split(marked)
        new = np.zeros(3, np.int64)
        leaf = np.empty(4 * len(self.active) + 1, np.int64)
        place = np.empty(4 * len(self.active) + 1, np.int64)
        item = np.empty(4 * len(self.item), np.int64)
        kernels.hand_down(
            self.tree.key,
            self.tree.level,
            self.tree.unit,
            self.active,
            self.offset,
            self.item,
            first,
            marked,
            self.features.ends.reshape(-1),
            self.features.slack,
            NEAR,
            new,
            leaf,
            place,
            item,
        )
        n, m, bare = new.tolist()
        self.region = np.repeat(self.region, 1 + 3 * marked.astype(np.int64))
        free = leaf[bare:]
        self.active, self.offset, self.item = leaf[:n], place[: n + 1], item[:m]
        if len(free):
            lo, size = self.tree[free].boxes()
            self.region[free] = self.region_of(lo + 0.5 * size)

"""What is asked of sizes in space, and the octree fine enough to know it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from csgmesh import kernels
from csgmesh.domain.plc import Plc
from csgmesh.meshers.octree.limits import curvature_sizes, short_edges
from csgmesh.size.field import Source, UniformSize
from csgmesh.size.resolve import ResolvedSize, evaluate
from csgmesh.tree import LinearTree

#: Where nothing is asked for, no edge is longer than this share of the diagonal.
LARGEST_SHARE = 0.15
#: Largest leaf of the tree of sizes as a share of what the boundary wants there, or of the
#: smallest of sizes in it that differ by more than the ratio.
LEAF = 1.4
RATIO = 1.3
#: No shorter edge counts than this share of the diagonal: a tree has 20 levels only.
SHORTEST = 1e-5
#: Leaves wherever a given size is looked at first: 16 along each side of the root.
FIRST_LEVEL = 4
#: Places within a leaf, as shares of its side, at which a given size is looked at.
_PLACES = np.array(
    [(0.5, 0.5, 0.5)]
    + [(x, y, z) for x in (0.05, 0.95) for y in (0.05, 0.95) for z in (0.05, 0.95)]
)
#: Triangles looked at between two returns from a kernel.
_SLICE = 20_000


@dataclass(frozen=True, eq=False)
class SizeDemands:
    """What is asked of sizes: in the volume by a function, on the boundary by triangles.

    Attributes
    ----------
    domain : Plc
    base : callable or None
        In the volume.
    triangles : (m, 3, 3) float64
        Pieces of the boundary, which may be points.
    size : (m,) float64
        The largest size on each.
    named : tuple of (triangle numbers, callable)
        Sizes that vary along parts of the boundary.
    """

    domain: Plc
    base: Source | None
    triangles: np.ndarray
    size: np.ndarray
    named: tuple[tuple[np.ndarray, Source], ...]

    @classmethod
    def of(cls, domain: Plc, asked: ResolvedSize | None) -> SizeDemands:
        """Demands of a resolved size, of the boundary's curvature and of short edges."""
        corners = domain.points[domain.facets]
        size = curvature_sizes(domain, asked is not None)
        named: list[tuple[np.ndarray, Source]] = []
        for markers, source in () if asked is None else asked.boundary:
            on = np.flatnonzero(np.isin(domain.facet_marker, markers))
            if isinstance(source, UniformSize):
                size[on] = np.minimum(size[on], source.value)
            else:
                named.append((on, source))
        points, lengths = short_edges(domain)
        lengths = np.maximum(lengths, SHORTEST * domain.diagonal)
        base = None
        if asked is not None:
            base = _Base(domain, asked) if asked.region else asked.default
        return cls(
            domain,
            base,
            np.concatenate([corners, np.repeat(points[:, None], 3, axis=1)]),
            np.concatenate([size, lengths]),
            tuple(named),
        )

    @property
    def least(self) -> float:
        """A bound below which the boundary asks for nothing."""
        return 0.0 if self.named else float(self.size.min(initial=np.inf))

    def joined(self, triangles: np.ndarray, size: np.ndarray) -> SizeDemands:
        """These demands and those of more triangles (k, 3, 3)."""
        return replace(
            self,
            triangles=np.concatenate([self.triangles, triangles]),
            size=np.concatenate([self.size, size]),
        )

    def ask(self, points: np.ndarray) -> np.ndarray:
        """What is asked for in the volume, infinite outside the domain where it makes no sense.

        Raises
        ------
        SizeError
            If it is not positive and finite at a point of the domain.
        """
        assert self.base is not None
        with np.errstate(all="ignore"):
            value = np.asarray(self.base(points.copy()))
        if value.dtype.kind not in "fiu" or value.shape not in ((len(points),), ()):
            return evaluate(lambda _: value, points)
        value = np.broadcast_to(value, len(points)).astype(float)
        wrong = np.flatnonzero(~(np.isfinite(value) & (value > 0)))
        if len(wrong):
            oracle = self.domain.oracle
            inside = wrong if oracle is None else wrong[oracle.region(points[wrong]) >= 0]
            if len(inside):
                evaluate(lambda _: value[inside], points[inside])
            value[wrong] = np.inf
        return value

    def grown(self, root: LinearTree, largest: float, max_leaves: int) -> LinearTree:
        """A balanced tree, fine where the boundary or a varying size asks for it."""
        tree = root
        is_new = np.ones(1, np.uint8)
        shape = np.ascontiguousarray(self.triangles).reshape(-1)
        done = (self.size >= largest).astype(np.uint8)
        places = self._places(root)
        while True:
            marked = np.zeros(tree.n_leaves, np.uint8)
            self._demand(tree, shape, places, self.size, done, LEAF, marked, np.zeros(1))
            for on, source in self.named:
                self._mark_named(tree, places, on, source, marked)
            new = np.flatnonzero((is_new != 0) & (marked == 0))
            marked[new[self._varies(tree[new])]] = 1
            if not marked.any():
                return tree.balance(True, 1, None, max_leaves)[0]
            tree.check_budget(marked, max_leaves)
            tree, is_new, _ = tree.split(marked)

    def at_leaves(self, tree: LinearTree, largest: float) -> tuple[np.ndarray, np.ndarray]:
        """Size at the centre of each leaf by itself, and where only the volume's size counts."""
        lo, extent = tree.boxes()
        value = np.full(tree.n_leaves, largest)
        if self.base is not None:
            value = self.ask(lo + 0.5 * extent)
        asked = value.copy()
        places = self._places(tree)
        shape = np.ascontiguousarray(self.triangles).reshape(-1)
        done = np.zeros(len(self.size), np.uint8)
        unmarked = np.zeros(1, np.uint8)
        self._demand(tree, shape, places, self.size, done, 0.0, unmarked, value)
        for on, source in self.named:
            met = self._met(tree, places, on)
            here = self.ask_named(on, source, (lo + 0.5 * extent)[met])
            value[met] = np.minimum(value[met], here)
        return value, (value >= asked).astype(np.uint8)

    def _varies(self, leaves: LinearTree) -> np.ndarray:
        """Leaves in which the size in the volume differs much, or which are not fine enough yet."""
        if self.base is None or isinstance(self.base, UniformSize):
            return np.zeros(leaves.n_leaves, bool)
        lo, extent = leaves.boxes()
        places = lo[:, None] + _PLACES * extent[:, None]
        value = self.ask(places.reshape(-1, 3)).reshape(-1, len(_PLACES))
        value = np.where(np.isfinite(value), value, value.max(axis=1, initial=0.0)[:, None])
        least, most = value.min(axis=1), value.max(axis=1)
        finite = np.isfinite(least)
        fine = (extent[:, 0] > LEAF * least) & ~(most <= RATIO * least)
        out = finite & ((leaves.level < FIRST_LEVEL) | fine)
        out[out] = self.meets(lo[out], extent[out])
        return out

    def meets(self, lo: np.ndarray, extent: np.ndarray) -> np.ndarray:
        """Boxes that have a part of the domain in them, as far as some places in each tell."""
        oracle = self.domain.oracle
        if oracle is None or not len(lo):
            return np.ones(len(lo), bool)
        large = extent[:, 0] > 0.1 * self.domain.diagonal
        places = lo[:, None] + _PLACES * extent[:, None]
        inside = oracle.region(places.reshape(-1, 3)).reshape(-1, len(_PLACES)) >= 0
        return np.asarray(large | inside.any(axis=1))

    def _mark_named(
        self,
        tree: LinearTree,
        places: np.ndarray,
        on: np.ndarray,
        source: Source,
        marked: np.ndarray,
    ) -> None:
        met = self._met(tree, places, on)
        lo, extent = (a[met] for a in tree.boxes())
        where = lo[:, None] + _PLACES * extent[:, None]
        value = self.ask_named(on, source, where.reshape(-1, 3)).reshape(len(met), -1)
        marked[met[extent[:, 0] > LEAF * value.min(axis=1)]] = 1

    def ask_named(self, on: np.ndarray, source: Source, points: np.ndarray) -> np.ndarray:
        """A size on a part of the boundary, checked.

        Leaves reach beyond the part, where its size need not be one: such points are moved into the
        part's box first.
        """
        corners = self.triangles[on].reshape(-1, 3)
        return evaluate(source, np.clip(points, corners.min(axis=0), corners.max(axis=0)))

    def _met(self, tree: LinearTree, places: np.ndarray, on: np.ndarray) -> np.ndarray:
        """Leaves that some of the triangles meet."""
        marked, done = np.zeros(tree.n_leaves, np.uint8), np.zeros(len(on), np.uint8)
        shape = np.ascontiguousarray(self.triangles[on]).reshape(-1)
        # Nothing is content with a size of zero: every leaf that a triangle meets is marked.
        self._demand(tree, shape, places[on], np.zeros(len(on)), done, 1.0, marked, np.zeros(1))
        return np.flatnonzero(marked)

    def _places(self, tree: LinearTree) -> np.ndarray:
        """Boxes of the triangles in units of places of a tree, (m, 6)."""
        corners = (self.triangles - tree.lo) / tree.unit[3:]
        low, high = corners.min(axis=1), corners.max(axis=1)
        return np.concatenate([np.floor(low), np.ceil(high)], axis=1).astype(np.int64)

    def _demand(
        self,
        tree: LinearTree,
        shape: np.ndarray,
        places: np.ndarray,
        size: np.ndarray,
        done: np.ndarray,
        share: float,
        marked: np.ndarray,
        value: np.ndarray,
    ) -> None:
        stack = np.empty(16 * tree.deepest, np.int64)
        flat = np.ascontiguousarray(places).reshape(-1)
        for begin in range(0, len(size), _SLICE):
            end = min(begin + _SLICE, len(size))
            kernels.demand_sizes(
                tree.key,
                tree.level,
                tree.unit,
                shape,
                flat,
                size,
                done,
                begin,
                end,
                share,
                stack,
                marked,
                value,
            )


@dataclass(frozen=True, eq=False)
class _Base:
    """The default, and in some regions other sizes."""

    domain: Plc
    asked: ResolvedSize

    def __call__(self, points: np.ndarray) -> np.ndarray:
        default, oracle = self.asked.default, self.domain.oracle
        largest = LARGEST_SHARE * self.domain.diagonal
        value = np.full(len(points), largest) if default is None else default(points)
        if oracle is None:
            return np.asarray(value)
        region = oracle.region(points)
        said = np.full(len(points), np.inf)
        for numbers, source in self.asked.region:
            at = np.flatnonzero(np.isin(region, numbers))
            said[at] = np.minimum(said[at], source(points[at]))
        return np.where(np.isfinite(said), said, value)

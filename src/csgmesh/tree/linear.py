"""Linear quadtrees and octrees: leaves without pointers, in the order of a space-filling curve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from csgmesh import kernels
from csgmesh.errors import BudgetError, InputError

#: Levels below the root that keys have bits for, by dimension; a leaf of the last one is 1e-9 of
#: the root in the plane, 1e-6 in space.
DEEPEST = {2: 30, 3: 20}
#: Leaves looked at between two returns from a kernel.
SLICE = 1_000_000
#: Most leaves around a leaf of a tree in balance; more are listed in further calls.
_ROOM = 64


@dataclass(frozen=True, eq=False)
class LinearTree:
    """A quadtree or octree as two arrays: Morton keys in increasing order, and levels.

    A leaf of level l is the root halved l times in each direction. Its key interleaves the bits of
    its lowest corner, counted in units of ``2**-30`` of the root (in space ``2**-20``), so that the
    leaves within any square or cube of the hierarchy are a run of the arrays, and the leaf that
    holds a place is found by bisection. Trees are immutable: `refined` and `balanced` return new
    ones.

    Parameters
    ----------
    lo, extent : (dim,) float64
        Lowest corner and size of the root.
    key : (n,) int64
    level : (n,) int8

    Attributes
    ----------
    dim : int
        2 or 3.

    References
    ----------
    .. [1] I. Gargantini, "An effective way to represent quadtrees", Comm. ACM 25 (1982).
    .. [2] M. Bern, D. Eppstein, J. Gilbert, "Provably good mesh generation", J. Computer and System
       Sciences 48 (1994).
    .. [3] H. Sundar, R. Sampath, G. Biros, "Bottom-up construction and 2:1 balance refinement of
       linear octrees in parallel", SIAM J. Scientific Computing 30 (2008).

    Examples
    --------
    >>> tree = LinearTree.root((0, 0), (1, 1)).refined([True])
    >>> tree.n_leaves, tree.leaf_of([[0.7, 0.2], [0.1, 0.9], [3, 3]])
    (4, array([ 1,  2, -1]))
    """

    lo: np.ndarray
    extent: np.ndarray
    key: np.ndarray
    level: np.ndarray

    @property
    def dim(self) -> int:
        """2 for a quadtree, 3 for an octree."""
        return len(self.lo)

    @property
    def deepest(self) -> int:
        """Levels below the root that keys have bits for."""
        return DEEPEST[self.dim]

    @classmethod
    def root(cls, lo: ArrayLike, extent: ArrayLike) -> LinearTree:
        """A tree of one leaf.

        Parameters
        ----------
        lo, extent : (2,) or (3,) array_like
            Lowest corner and size.

        Raises
        ------
        InputError
            If the size is not positive and finite.

        Examples
        --------
        >>> LinearTree.root((0, 0), (2, 1)).boxes()[1]
        array([[2., 1.]])
        >>> LinearTree.root((0, 0, 0), (1, 1, 1)).refined([True]).n_leaves
        8
        """
        corner, size = np.array(lo, float), np.array(extent, float)
        if corner.shape not in ((2,), (3,)) or size.shape != corner.shape:
            raise InputError(
                f"a tree needs a corner and a size of 2 or 3 numbers; got {lo!r}, {extent!r}"
            )
        if not (np.isfinite(corner).all() and np.isfinite(size).all() and (size > 0).all()):
            raise InputError(f"the size of a tree must be positive and finite; got {extent!r}")
        return cls(corner, size, np.zeros(1, np.int64), np.zeros(1, np.int8))

    @property
    def n_leaves(self) -> int:
        """Number of leaves."""
        return len(self.key)

    @property
    def unit(self) -> np.ndarray:
        """Lowest corner of the root and size of a unit of places, (2 dim,)."""
        return np.concatenate([self.lo, self.extent / 2**self.deepest])

    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest corner and size of each leaf, both (n, dim).

        Examples
        --------
        >>> lo, size = LinearTree.root((0, 0), (1, 1)).refined([True]).boxes()
        >>> lo.tolist()
        [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]]
        """
        out = np.empty((self.n_leaves, 2 * self.dim))
        places = kernels.places if self.dim == 2 else kernels.octant_places
        places(self.key, self.level, self.unit, out.reshape(-1))
        return out[:, : self.dim], out[:, self.dim :]

    def leaf_of(self, points: ArrayLike) -> np.ndarray:
        """Number of the leaf that holds each point, -1 outside the root.

        Parameters
        ----------
        points : (k, dim) array_like
            A point on a common side belongs to the leaf on its right or above it.

        Returns
        -------
        (k,) int64
        """
        xy = np.ascontiguousarray(points, np.float64).reshape(-1, self.dim)
        out = np.empty(len(xy), np.int64)
        find = kernels.find_leaves if self.dim == 2 else kernels.find_octants
        find(self.key, _own(xy.reshape(-1)), self.unit, out)
        return out

    def neighbours(self, leaf: int) -> np.ndarray:
        """Leaves that share a side, an edge or a corner with a leaf, sorted, (k,) int64.

        Raises
        ------
        InputError
            If there is no such leaf.

        Examples
        --------
        >>> tree = LinearTree.root((0, 0), (1, 1)).refined([True]).refined([1, 0, 0, 0])
        >>> tree.neighbours(4)
        array([1, 3, 5, 6])
        """
        if not 0 <= leaf < self.n_leaves:
            raise InputError(f"leaves are numbered 0 to {self.n_leaves - 1}; got {leaf!r}")
        if self.dim == 3:
            return self._around(leaf)
        room = _ROOM
        while True:
            out = np.empty(room, np.int64)
            n = kernels.adjoining(self.key, self.level, leaf, out)
            if n < room:
                return np.sort(out[:n])
            room *= 2

    def _around(self, leaf: int) -> np.ndarray:
        """Neighbours in space: what meets the leaf of the 26 cubes of its size around it."""
        lo, size = (a[0] for a in self[np.array([leaf])].boxes())
        steps = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3, indexing="ij"), axis=-1)
        cubes = lo + (steps.reshape(-1, 3) + 0.5) * size
        held = np.unique(self.leaf_of(cubes[(cubes > self.lo).all(axis=1)]))
        held = held[held >= 0]
        span = np.int64(1) << (3 * (self.deepest - int(self.level[leaf])))
        first = self.key[held] // span * span
        begin, end = np.searchsorted(self.key, first), np.searchsorted(self.key, first + span)
        counts = np.maximum(end - begin, 1)
        near = np.repeat(np.where(end > begin, begin, held) - np.cumsum(counts) + counts, counts)
        near = np.unique(np.concatenate([near + np.arange(len(near)), held]))
        low, extent = self[near].boxes()
        unit = 0.5 * self.unit[3:]
        meets = ((low <= lo + size + unit) & (low + extent >= lo - unit)).all(axis=1)
        return near[meets & (near != leaf)]

    def refined(self, marked: ArrayLike) -> LinearTree:
        """The tree with marked leaves replaced by their four or eight children.

        Parameters
        ----------
        marked : (n,) array_like of bool

        Raises
        ------
        InputError
            If there is not one mark a leaf, or a leaf of the deepest level is marked.
        """
        flags = np.ascontiguousarray(np.asarray(marked).astype(bool)).view(np.uint8)
        if flags.shape != (self.n_leaves,):
            raise InputError(f"refined needs a mark a leaf, ({self.n_leaves},); got {flags.shape}")
        return self.split(flags)[0]

    def refined_where(
        self, is_coarse: Callable[[np.ndarray, np.ndarray], np.ndarray], max_leaves: int = 10**7
    ) -> LinearTree:
        """Refine until nothing asks for more.

        Parameters
        ----------
        is_coarse : callable
            Of lowest corners (k, dim) and sizes (k, dim) of new leaves: which must be split,
            (k,) bool. Called once a level.
        max_leaves : int
            Bound on the number of leaves.

        Raises
        ------
        BudgetError
            If the bound or the deepest level is reached; with the place.

        Examples
        --------
        >>> root = LinearTree.root((0, 0), (1, 1))
        >>> root.refined_where(lambda lo, size: size[:, 0] > 0.1 + lo[:, 0]).n_leaves
        46
        """
        tree, new = self, np.arange(self.n_leaves)
        while True:
            lo, size = tree[new].boxes()
            marked = np.zeros(tree.n_leaves, np.uint8)
            marked[new] = np.asarray(is_coarse(lo, size), bool)
            if not marked.any():
                return tree
            tree.check_budget(marked, max_leaves)
            tree, is_new, _ = tree.split(marked)
            new = np.flatnonzero(is_new)

    def balanced(self, *, corners: bool = True, width: int = 1) -> LinearTree:
        """The tree refined until neighbours differ by at most one level.

        Parameters
        ----------
        corners : bool, default True
            Whether leaves that share only a corner, or in space an edge, count as neighbours.
        width : int, default 1
            Leaves of one size, at least, between the next smaller and the next larger ones.

        Examples
        --------
        >>> root = LinearTree.root((0, 0), (1, 1))
        >>> tree = root.refined([1]).refined([1, 0, 0, 0]).refined([0, 0, 0, 1, 0, 0, 0])
        >>> tree.n_leaves, tree.balanced().n_leaves
        (10, 19)
        """
        if width < 1:
            raise InputError(f"width must be at least 1; got {width!r}")
        return self.balance(corners, width, None)[0]

    def balance(
        self, corners: bool, width: int, source: np.ndarray | None, max_leaves: int | None = None
    ) -> tuple[LinearTree, np.ndarray | None]:
        """`balanced`, with for each leaf the entry of `source` of the leaf it came from."""
        tree, is_new = self, np.ones(self.n_leaves, np.uint8)
        mark = kernels.mark_unbalanced if self.dim == 2 else kernels.mark_unbalanced_octants
        while True:
            marked = np.zeros(tree.n_leaves, np.uint8)
            found = 0
            for begin in range(0, tree.n_leaves, SLICE):
                end = min(begin + SLICE, tree.n_leaves)
                found += mark(tree.key, tree.level, is_new, marked, begin, end, width, int(corners))
            if not found:
                return tree, source
            if max_leaves is not None:
                tree.check_budget(marked, max_leaves)
            tree, is_new, _ = tree.split(marked)
            if source is not None:
                source = np.repeat(source, 1 + self._more * (marked & 1).astype(np.int64))

    def split(self, marked: np.ndarray) -> tuple[LinearTree, np.ndarray, np.ndarray]:
        """The refined tree, which of its leaves are new, and each old leaf's first new number."""
        deepest = self.deepest
        if self.level.max() >= deepest and self.level[(marked & 1) == 1].max(initial=0) >= deepest:
            raise BudgetError(f"a tree has at most {deepest} levels; {self.place_of(marked)}")
        n = self.n_leaves + self._more * int(np.count_nonzero(marked & 1))
        key, level = np.empty(n, np.int64), np.empty(n, np.int8)
        is_new, first = np.empty(n, np.uint8), np.empty(self.n_leaves, np.int64)
        old = (self.key, self.level, marked)
        kernels.split_leaves(*old, key, level, is_new, first, self.dim, deepest)
        return LinearTree(self.lo, self.extent, key, level), is_new, first

    def check_budget(self, marked: np.ndarray, max_leaves: int) -> None:
        """Refuse a refinement to more leaves than allowed, with the place of the smallest."""
        n = self.n_leaves + self._more * int(np.count_nonzero(marked & 1))
        if n > max_leaves:
            raise BudgetError(
                f"the size and the features ask for more than {max_leaves:,} leaves of the tree; "
                + self.place_of(marked)
            )

    def place_of(self, marked: np.ndarray) -> str:
        """Where the smallest of some leaves is, for messages."""
        at = np.flatnonzero(marked & 1)
        at = at[[int(np.argmax(self.level[at]))]]
        place, size = (a[0] for a in self[at].boxes())
        where = ", ".join(f"{c:.6g}" for c in place)
        return f"the smallest, {size[0]:.3g} wide, is at ({where})"

    @property
    def _more(self) -> int:
        """Leaves that a split adds."""
        return 2**self.dim - 1

    def __getitem__(self, leaves: np.ndarray) -> LinearTree:
        """Some of the leaves: their boxes can be asked for, nothing else."""
        return LinearTree(self.lo, self.extent, self.key[leaves], self.level[leaves])

    def __repr__(self) -> str:
        deepest = int(self.level.max(initial=0))
        return f"<LinearTree: {self.n_leaves:,} leaves, {deepest} levels>"


def _own(flat: np.ndarray) -> np.ndarray:
    """A writeable array: read-only ones are another type, compiled for again."""
    return flat if flat.flags.writeable else flat.copy()

"""The linear quadtree: leaves without pointers, in the order of a space-filling curve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from csgmesh import kernels
from csgmesh.errors import BudgetError, InputError

#: Levels below the root that keys have bits for; a leaf of the last one is 1e-9 of the root.
DEEPEST = 30
#: Leaves looked at between two returns from a kernel.
SLICE = 1_000_000
#: Most leaves around a leaf of a tree in balance; more are listed in further calls.
_ROOM = 64


@dataclass(frozen=True, eq=False)
class LinearTree:
    """A quadtree as two arrays: Morton keys in increasing order, and levels.

    A leaf of level l is the root halved l times in each direction. Its key interleaves the bits of
    its lower left corner, counted in units of ``2**-30`` of the root, so that the leaves within any
    square of the hierarchy are a run of the arrays, and the leaf that holds a place is found by
    bisection. Trees are immutable: `refined` and `balanced` return new ones.

    Parameters
    ----------
    lo, extent : (2,) float64
        Lower left corner and size of the root.
    key : (n,) int64
    level : (n,) int8

    Attributes
    ----------
    dim : int
        2.

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

    dim = 2

    @classmethod
    def root(cls, lo: ArrayLike, extent: ArrayLike) -> LinearTree:
        """A tree of one leaf.

        Parameters
        ----------
        lo, extent : (2,) array_like
            Lower left corner and size.

        Raises
        ------
        InputError
            If the size is not positive and finite.

        Examples
        --------
        >>> LinearTree.root((0, 0), (2, 1)).boxes()[1]
        array([[2., 1.]])
        """
        corner, size = np.array(lo, float), np.array(extent, float)
        if corner.shape != (2,) or size.shape != (2,):
            raise InputError(
                f"a tree needs a corner and a size of 2 numbers; got {lo!r}, {extent!r}"
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
        """Lower left corner of the root and size of a unit of places, (4,)."""
        return np.concatenate([self.lo, self.extent / 2**DEEPEST])

    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower left corner and size of each leaf, both (n, 2).

        Examples
        --------
        >>> lo, size = LinearTree.root((0, 0), (1, 1)).refined([True]).boxes()
        >>> lo.tolist()
        [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]]
        """
        out = np.empty((self.n_leaves, 4))
        kernels.places(self.key, self.level, self.unit, out.reshape(-1))
        return out[:, :2], out[:, 2:]

    def leaf_of(self, points: ArrayLike) -> np.ndarray:
        """Number of the leaf that holds each point, -1 outside the root.

        Parameters
        ----------
        points : (k, 2) array_like
            A point on a common side belongs to the leaf on its right or above it.

        Returns
        -------
        (k,) int64
        """
        xy = np.ascontiguousarray(points, np.float64).reshape(-1, 2)
        out = np.empty(len(xy), np.int64)
        kernels.find_leaves(self.key, _own(xy.reshape(-1)), self.unit, out)
        return out

    def neighbours(self, leaf: int) -> np.ndarray:
        """Leaves that share a side or a corner with a leaf, sorted, (k,) int64.

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
        room = _ROOM
        while True:
            out = np.empty(room, np.int64)
            n = kernels.adjoining(self.key, self.level, leaf, out)
            if n < room:
                return np.sort(out[:n])
            room *= 2

    def refined(self, marked: ArrayLike) -> LinearTree:
        """The tree with marked leaves replaced by their four children.

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
            Of lower left corners (k, 2) and sizes (k, 2) of new leaves: which must be split,
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
            Whether leaves that share only a corner count as neighbours.
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
        while True:
            marked = np.zeros(tree.n_leaves, np.uint8)
            found = 0
            for begin in range(0, tree.n_leaves, SLICE):
                end = min(begin + SLICE, tree.n_leaves)
                found += kernels.mark_unbalanced(
                    tree.key, tree.level, is_new, marked, begin, end, width, int(corners)
                )
            if not found:
                return tree, source
            if max_leaves is not None:
                tree.check_budget(marked, max_leaves)
            tree, is_new, _ = tree.split(marked)
            if source is not None:
                source = np.repeat(source, 1 + 3 * (marked & 1).astype(np.int64))

    def split(self, marked: np.ndarray) -> tuple[LinearTree, np.ndarray, np.ndarray]:
        """The refined tree, which of its leaves are new, and each old leaf's first new number."""
        if self.level.max() >= DEEPEST and self.level[(marked & 1) == 1].max(initial=0) >= DEEPEST:
            raise BudgetError(f"a tree has at most {DEEPEST} levels; {self.place_of(marked)}")
        n = self.n_leaves + 3 * int(np.count_nonzero(marked & 1))
        key, level = np.empty(n, np.int64), np.empty(n, np.int8)
        is_new, first = np.empty(n, np.uint8), np.empty(self.n_leaves, np.int64)
        kernels.split_leaves(self.key, self.level, marked, key, level, is_new, first)
        return LinearTree(self.lo, self.extent, key, level), is_new, first

    def check_budget(self, marked: np.ndarray, max_leaves: int) -> None:
        """Refuse a refinement to more leaves than allowed, with the place of the smallest."""
        n = self.n_leaves + 3 * int(np.count_nonzero(marked & 1))
        if n > max_leaves:
            raise BudgetError(
                f"the size and the features ask for more than {max_leaves:,} leaves of the tree; "
                + self.place_of(marked)
            )

    def place_of(self, marked: np.ndarray) -> str:
        """Where the smallest of some leaves is, for messages."""
        at = np.flatnonzero(marked & 1)
        at = at[[int(np.argmax(self.level[at]))]]
        (x, y), (width, _) = (a[0] for a in self[at].boxes())
        return f"the smallest, {width:.3g} wide, is at ({x:.6g}, {y:.6g})"

    def __getitem__(self, leaves: np.ndarray) -> LinearTree:
        """Some of the leaves: their boxes can be asked for, nothing else."""
        return LinearTree(self.lo, self.extent, self.key[leaves], self.level[leaves])

    def __repr__(self) -> str:
        deepest = int(self.level.max(initial=0))
        return f"<LinearTree: {self.n_leaves:,} leaves, {deepest} levels>"


def _own(flat: np.ndarray) -> np.ndarray:
    """A writeable array: read-only ones are another type, compiled for again."""
    return flat if flat.flags.writeable else flat.copy()

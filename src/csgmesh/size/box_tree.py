"""Pieces of a boundary in a complete binary tree of boxes, for kernels to search."""

from __future__ import annotations

from functools import reduce

import numpy as np

PER_LEAF = 4
#: Bits of each coordinate in the order of the pieces along a curve.
_BITS = 16


class BoxTree:
    """Segments or triangles in the leaves of a tree, in the order of a space-filling curve.

    Node k has the children 2 k and 2 k + 1, leaf j the pieces j * PER_LEAF and following.

    Parameters
    ----------
    pieces : (m, k, dim) float64
        Their k corners, some of which may be the same.

    Attributes
    ----------
    order : (m,) int64
        The piece at each place of the tree.
    corners : (room, k dim) float64
    boxes : (2 n_leaves, 2 dim) float64
        Lower and upper corner of each node, of which number 0 is none.

    Examples
    --------
    >>> tree = BoxTree(np.array([[[4.0, 0], [5, 0]], [[0, 0], [1, 2]]]))
    >>> tree.order, tree.boxes[1]
    (array([1, 0]), array([0., 0., 5., 2.]))
    """

    def __init__(self, pieces: np.ndarray) -> None:
        m, k, dim = pieces.shape
        # Corner by corner: reductions along a short axis in the middle take their time.
        ends = [pieces[:, i] for i in range(k)]
        self.order = along_a_curve(reduce(np.add, ends) / k)
        n_leaves = 1
        while n_leaves * PER_LEAF < m:
            n_leaves *= 2
        self.room = n_leaves * PER_LEAF
        self.corners = self.places(pieces.reshape(m, k * dim), 0.0)
        self.boxes = np.concatenate(
            [
                self.nodes(self.places(reduce(np.minimum, ends), np.inf), np.minimum, np.inf),
                self.nodes(self.places(reduce(np.maximum, ends), -np.inf), np.maximum, -np.inf),
            ],
            axis=1,
        )
        # No ray meets a box at infinity, while one from infinity to minus infinity is everywhere.
        self.boxes[self.boxes[:, 0] > self.boxes[:, dim]] = np.inf

    def places(self, values: np.ndarray, empty: float) -> np.ndarray:
        """Values of the pieces (m, k) at their places, with those of places that nothing takes."""
        out = np.full((self.room, values.shape[1]), empty)
        out[: len(values)] = values[self.order]
        return out

    def nodes(self, places: np.ndarray, best: np.ufunc, empty: float) -> np.ndarray:
        """Values of all nodes of the tree, from those of its places; node 0 is none."""
        level = best.reduce(places.reshape(-1, PER_LEAF, places.shape[1]), axis=1)
        levels = [level]
        while len(level) > 1:
            level = best(level[0::2], level[1::2])
            levels.append(level)
        none = np.full((1, places.shape[1]), empty)
        return np.ascontiguousarray(np.concatenate([none, *levels[::-1]]))


class GradedTree(BoxTree):
    """Pieces with a value each, which holds up to a reach and grows beyond.

    Parameters
    ----------
    pieces : (m, k, dim) float64
    value : (m,) float64
    reach : (m,) float64 or float

    Attributes
    ----------
    value, reach : (room,) float64
        Of the pieces at their places.
    low, far : (2 n_leaves,) float64
        Lowest value and widest reach below each node.
    """

    def __init__(self, pieces: np.ndarray, value: np.ndarray, reach: np.ndarray | float) -> None:
        super().__init__(pieces)
        reaches = np.broadcast_to(np.asarray(reach, float), len(pieces))
        values, far = self.places(value[:, None], np.inf), self.places(reaches[:, None], 0.0)
        self.value, self.reach = values[:, 0], far[:, 0]
        self.low = self.nodes(values, np.minimum, np.inf)[:, 0]
        self.far = self.nodes(far, np.maximum, 0.0)[:, 0]


def along_a_curve(points: np.ndarray) -> np.ndarray:
    """The order of points along Morton's curve."""
    if not len(points):
        return np.zeros(0, np.int64)
    dim = points.shape[1]
    low = points.min(axis=0)
    extent = float((points.max(axis=0) - low).max())
    scale = ((1 << _BITS) - 1) / extent if extent > 0 else 0.0
    square = ((points - low) * scale).astype(np.int64)
    key = np.zeros(len(points), np.int64)
    for bit in range(_BITS):
        for axis in range(dim):
            key |= ((square[:, axis] >> bit) & 1) << (dim * bit + axis)
    return np.argsort(key, kind="stable")

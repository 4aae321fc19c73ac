"""Which leaves a box lies wholly inside or outside of, for all leaves at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from csgmesh.csg.program import Leaf

#: What is known of a leaf in a box: the box lies outside, inside, or neither is sure.
OUT, IN, OPEN = 0, 1, 2

_BODIES = {"ball": 1, "cube": 2, "half_space": 3}


@dataclass(frozen=True, eq=False)
class Screen:
    """The boxes of all leaves, and the affine maps that take them to unit bodies."""

    leaves: Sequence[Leaf]
    low: np.ndarray
    high: np.ndarray
    convex: np.ndarray
    body: np.ndarray  # as in _BODIES, 0 for leaves that are no affine image of a unit body
    center: np.ndarray
    matrix: np.ndarray

    @staticmethod
    def of(leaves: Sequence[Leaf]) -> Screen:
        """Gather the boxes and maps of the leaves."""
        boxes = [leaf.box for leaf in leaves]
        frames = [leaf.unit_frame() for leaf in leaves]
        dim = len(boxes[0][0])
        empty = np.zeros((dim, dim))
        return Screen(
            leaves,
            np.array([low for low, _ in boxes]),
            np.array([high for _, high in boxes]),
            np.array([leaf.primitive.convex for leaf in leaves]),
            np.array([0 if frame is None else _BODIES[frame.body] for frame in frames]),
            np.array([empty[0] if frame is None else frame.center for frame in frames]),
            np.array([empty if frame is None else frame.matrix for frame in frames]),
        )

    def judge(
        self, leaves: np.ndarray, low: np.ndarray, high: np.ndarray, state: np.ndarray
    ) -> None:
        """Write into `state` what is known of `leaves` in the box from `low` to `high`."""
        own_low, own_high = self.low[leaves], self.high[leaves]
        apart = ((own_low > high) | (own_high < low)).any(axis=1)
        state[leaves] = np.where(apart, OUT, OPEN)
        near = leaves[~apart]
        body = self.body[near]
        self._judge_bodies(near, body, low, high, state)
        around = ((self.low[near] <= low) & (self.high[near] >= high)).all(axis=1)
        for leaf in near[around & (body == 0) & self.convex[near]].tolist():
            if self.leaves[leaf].covers(low, high):
                state[leaf] = IN

    def _judge_bodies(
        self,
        leaves: np.ndarray,
        body: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        state: np.ndarray,
    ) -> None:
        # The box becomes a parallelepiped about q with these half edges.
        middle, half = 0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low
        matrix = self.matrix[leaves]
        q = np.einsum("kij,kj->ki", matrix, middle - self.center[leaves])
        edges = matrix * half
        reach = np.abs(edges).sum(axis=2)
        at = body == 1
        if at.any():
            signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * len(low))).reshape(len(low), -1)
            corners = q[at][:, :, None] + edges[at] @ signs
            farthest = (corners**2).sum(axis=1).max(axis=1)
            spread = np.sqrt((edges[at] ** 2).sum(axis=1)).sum(axis=1)
            state[leaves[at][farthest <= 1.0]] = IN
            state[leaves[at][np.sqrt((q[at] ** 2).sum(axis=1)) > 1.0 + spread]] = OUT
        at = body == 2
        if at.any():
            state[leaves[at][(np.abs(q[at]) + reach[at] <= 1.0).all(axis=1)]] = IN
            state[leaves[at][(np.abs(q[at]) - reach[at] > 1.0).any(axis=1)]] = OUT
        at = body == 3
        if at.any():
            state[leaves[at][q[at, 0] + reach[at, 0] <= 0.0]] = IN
            state[leaves[at][q[at, 0] - reach[at, 0] > 0.0]] = OUT

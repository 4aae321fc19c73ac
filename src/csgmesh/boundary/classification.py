"""Which region each face of the map belongs to, from winding numbers alone.

Crossing an edge changes the winding number of the leaves on it by what their orientation says.
Along a preorder of a spanning tree of the faces everything behind a crossing is one interval, so
each leaf's membership is a few intervals, and the booleans of the tree act on those. No point is
ever tested, so a face may be as thin as it likes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from csgmesh.boundary.arrangement import Arrangement
from csgmesh.csg.program import Program
from csgmesh.domain.planar_map import Dual, subtree_order
from csgmesh.errors import ShapeError

Code = Sequence[tuple[str, int]]


def face_regions(program: Program, arrangement: Arrangement, face: np.ndarray) -> np.ndarray:
    """Region of each face, (n_faces,), -1 outside.

    Parameters
    ----------
    program : Program
    arrangement : Arrangement
    face : (2m,) int64
        Face on the left of each half-edge; 0 is the unbounded one.
    """
    n_faces = int(face.max(initial=0)) + 1
    left, right = face[0::2], face[1::2]
    dual = subtree_order(n_faces, left, right)
    membership = _Membership(program, arrangement, dual, left, n_faces)
    region = np.full(n_faces, -1)
    for number, (_, code) in enumerate(program.regions):
        region[membership.evaluate(code)] = number
    region[~membership.in_frame()] = -1
    return region[dual.position]


class _Membership:
    """Which faces, numbered in preorder, each leaf and each boolean covers."""

    def __init__(
        self,
        program: Program,
        arrangement: Arrangement,
        dual: Dual,
        left: np.ndarray,
        n_faces: int,
    ) -> None:
        self.n_faces = n_faces
        self.frame_leaf = len(program.leaves)
        leaf, place, winding = self._windings(arrangement, dual, left)
        self._refuse_crossing(program, arrangement, dual, leaf, place, winding, left)
        odd = np.array([leaf.primitive.fill == "evenodd" for leaf in program.leaves] + [False])
        inside = np.where(odd[leaf], winding % 2 != 0, winding != 0) if len(leaf) else winding != 0
        new = np.r_[True, leaf[1:] != leaf[:-1]] if len(leaf) else np.zeros(0, bool)
        before = np.r_[False, inside[:-1]] if len(leaf) else inside
        flips = inside != np.where(new, False, before)
        self.flip_place = place[flips]
        self.flip_start = np.searchsorted(leaf[flips], np.arange(self.frame_leaf + 2))

    def _windings(
        self, arrangement: Arrangement, dual: Dual, left: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Leaf, preorder place and winding number from there on, sorted by leaf and place."""
        parent_leaf = arrangement.pieces.leaf[arrangement.parent_piece]
        start = np.searchsorted(arrangement.parent_edge, np.arange(len(left) + 1))
        count = (start[1:] - start[:-1])[dual.edge]
        row = np.repeat(np.arange(len(dual.edge)), count)
        offset = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
        parent = start[dual.edge[row]] + offset
        keep = parent_leaf[parent] <= self.frame_leaf
        row, parent = row[keep], parent[keep]
        child = dual.child[row]
        entering = np.where(left[dual.edge[row]] == child, 1, -1)
        change = entering * arrangement.parent_sign[parent]
        leaf = np.tile(parent_leaf[parent], 2)
        place = np.concatenate([dual.position[child], dual.position[child] + dual.size[child]])
        change = np.concatenate([change, -change])
        order = np.lexsort((place, leaf))
        leaf, place, change = leaf[order], place[order], change[order]
        # A closed curve changes by zero in all, so one running sum serves every leaf.
        winding = np.cumsum(change)
        last = np.r_[(leaf[1:] != leaf[:-1]) | (place[1:] != place[:-1]), True]
        last = last[: len(leaf)]
        return leaf[last], place[last], winding[last]

    def _refuse_crossing(
        self,
        program: Program,
        arrangement: Arrangement,
        dual: Dual,
        leaf: np.ndarray,
        place: np.ndarray,
        winding: np.ndarray,
        left: np.ndarray,
    ) -> None:
        simple = np.array([leaf.primitive.simple for leaf in program.leaves] + [False])
        if not len(leaf) or not simple.any():
            return
        wrong = np.flatnonzero(simple[leaf] & ((winding < 0) | (winding > 1)))
        if not len(wrong):
            return
        bad = int(leaf[wrong[0]])
        order = np.argsort(dual.position)
        face = order[place[wrong[0]]]
        own = arrangement.pieces.leaf[arrangement.parent_piece] == bad
        edges = arrangement.parent_edge[own]
        where = arrangement.points[_crossing(arrangement, edges, edges[left[edges] == face])]
        raise ShapeError(
            f"{program.leaves[bad].label} crosses or overlaps itself near "
            f"({where[0]:.6g}, {where[1]:.6g}): the boundary of a polygon must not; use Outline, "
            "whose contours may cross"
        )

    def in_frame(self) -> np.ndarray:
        """Faces within the working frame; all of them where no frame was needed."""
        if self.flip_start[-1] == self.flip_start[-2]:
            return np.ones(self.n_faces, bool)
        return self._operand(self.frame_leaf)

    def evaluate(self, code: Code) -> np.ndarray:
        """Faces that a boolean expression covers, (n_faces,) bool in preorder."""
        stack: list[int | np.ndarray] = []
        for op, k in code:
            if op == "leaf":
                stack.append(k)
                continue
            operands = stack[len(stack) - k :]
            del stack[len(stack) - k :]
            stack.append(self._apply(op, operands))
        (result,) = stack
        return self._operand(result)

    def _apply(self, op: str, operands: list[int | np.ndarray]) -> np.ndarray:
        if op == "complement":
            return ~self._operand(operands[0])
        if op == "difference":
            minuend = self._operand(operands[0])
            if len(operands) == 1:
                return minuend
            return minuend & ~self._apply("union", operands[1:])
        leaves = [x for x in operands if isinstance(x, int)]
        arrays = [x for x in operands if not isinstance(x, int)]
        # Many leaves at once cost no more than their intervals and one pass over the faces.
        count = self._dense_count(leaves)
        if op == "union":
            out = count > 0
            for x in arrays:
                out |= x
        elif op == "intersection":
            out = count == len(leaves)
            for x in arrays:
                out &= x
        else:
            out = count % 2 != 0
            for x in arrays:
                out ^= x
        return out

    def _operand(self, operand: int | np.ndarray) -> np.ndarray:
        """The faces of a leaf number or of a ready result."""
        return self._dense_count([operand]) > 0 if isinstance(operand, int) else operand

    def _dense_count(self, leaves: list[int]) -> np.ndarray:
        """How many of the leaves cover each face."""
        change = np.zeros(self.n_faces + 1, np.int32)
        if leaves:
            number = np.array(leaves)
            start, stop = self.flip_start[number], self.flip_start[number + 1]
            count = stop - start
            offset = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
            place = self.flip_place[np.repeat(start, count) + offset]
            # Flips of a leaf alternate: in, out, in, out.
            np.add.at(change, place, 1 - 2 * (offset % 2))
        return np.cumsum(change[:-1])


def _crossing(arrangement: Arrangement, edges: np.ndarray, around: np.ndarray) -> int:
    """A vertex of the given edges around a face, if possible one where the leaf meets itself."""
    ends = np.concatenate([arrangement.tail[edges], arrangement.head[edges]])
    busy = np.bincount(ends, minlength=len(arrangement.vertices)) > 2
    near = np.concatenate([arrangement.tail[around], arrangement.head[around], ends])
    return int(near[np.argmax(busy[near])])

"""Which region of a compiled tree contains each of many points.

Points are split into boxes, smaller and smaller, and on the way down each region's program is cut
to the leaves that the box does not lie wholly inside or outside of (Duff 1992, interval pruning of
CSG). At the bottom a few leaves and a cache-sized bunch of points are left, whatever the size of
the tree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from csgmesh.csg.extent import code_bounds
from csgmesh.csg.screen import OPEN, Screen

if TYPE_CHECKING:
    from csgmesh.csg.program import Code, Leaf

AND, OR, XOR = 0, 1, 2

#: A box is split while its points times its program's leaves exceed this: about where testing them
#: all costs as much as cutting the program.
_SPLIT_WORK = 16_384

#: Most points tested at once: their coordinates stay in the second-level cache.
_CHUNK = 32_768

#: An operation on leaves and earlier results: the operation, literals 2·leaf + negated, and for
#: each earlier result it takes off the stack whether to negate it.
Instruction = tuple[int, np.ndarray, tuple[bool, ...]]


#: Programs of so few leaves are tested rather than cut.
_SIMPLE = 4


@dataclass(frozen=True, eq=False)
class _Function:
    """A region as instructions in postfix order; `negated` applies to the last result."""

    instructions: list[Instruction]
    negated: bool
    leaves: np.ndarray
    n_literals: int


#: Region numbers, increasing, and their functions.
_Candidates = tuple[np.ndarray, list[_Function]]


def _function(code: Code) -> _Function:
    """Negations move into literals and operands, so that three operations are left."""
    stack: list[tuple[int, bool]] = []  # (leaf or −1 for an earlier result, negated)
    out: list[Instruction] = []
    for word, count in code:
        if word == "leaf":
            stack.append((count, False))
        elif word == "complement":
            leaf, negated = stack[-1]
            stack[-1] = (leaf, not negated)
        else:
            operands = stack[-count:]
            del stack[-count:]
            if word == "difference":
                operands = operands[:1] + [(leaf, not negated) for leaf, negated in operands[1:]]
            operation = {"union": OR, "symmetric_difference": XOR}.get(word, AND)
            out.append(
                (
                    operation,
                    np.array([2 * leaf + neg for leaf, neg in operands if leaf >= 0], np.int64),
                    tuple([neg for leaf, neg in operands if leaf < 0]),
                )
            )
            stack.append((-1, False))
    ((leaf, negated),) = stack
    if leaf >= 0:
        out, negated = [(OR, np.array([2 * leaf + negated]), ())], False
    return _gathered(out, negated)


def _gathered(instructions: list[Instruction], negated: bool) -> _Function:
    literals = np.concatenate([literals for _, literals, _ in instructions])
    return _Function(instructions, negated, np.unique(literals >> 1), len(literals))


def _pruned(function: _Function, state: np.ndarray) -> _Function | bool:
    """The function where leaves have a `state` of `IN`, `OUT` or `OPEN`."""
    out: list[Instruction] = []
    # Values: True, False, or None for what is still open; where its instructions begin; negated.
    stack: list[tuple[bool | None, int, bool]] = []
    for operation, literals, flags in function.instructions:
        taken = stack[len(stack) - len(flags) :]
        del stack[len(stack) - len(flags) :]
        start = taken[0][1] if taken else len(out)
        values = state[literals >> 1]
        open_literals = literals[values == OPEN]
        known = values[values != OPEN] ^ (literals[values != OPEN] & 1)
        flagged = list(zip(taken, flags, strict=True))
        constants = [value ^ flag for (value, _, _), flag in flagged if value is not None]
        kept = tuple([negated ^ flag for (value, _, negated), flag in flagged if value is None])
        if operation == XOR:
            odd = bool((int(known.sum()) + sum(constants)) % 2)
        else:
            odd = False
            absorbing = operation == OR
            if absorbing in constants or bool((known == absorbing).any()):
                del out[start:]
                stack.append((absorbing, start, False))
                continue
        if len(open_literals) == 0 and len(kept) < 2:
            value = None if kept else (odd if operation == XOR else operation == AND)
            stack.append((value, start, kept[0] ^ odd if kept else False))
        else:
            out.append((operation, open_literals, kept))
            stack.append((None, start, odd))
    ((value, _, negated),) = stack
    if value is not None:
        return value ^ function.negated
    return _gathered(out, negated ^ function.negated)


def _evaluated(function: _Function, leaves: Sequence[Leaf], points: np.ndarray) -> np.ndarray:
    stack: list[np.ndarray] = []
    for operation, literals, flags in function.instructions:
        operands = stack[len(stack) - len(flags) :]
        del stack[len(stack) - len(flags) :]
        result = np.full(len(points), operation == AND)
        for value, flag in zip(operands, flags, strict=True):
            _combine(operation, result, ~value if flag else value)
        for literal in literals.tolist():
            if operation != XOR and (result.all() if operation == OR else not result.any()):
                break
            value = leaves[literal >> 1].inside(points)
            _combine(operation, result, ~value if literal & 1 else value)
        stack.append(result)
    return ~stack[0] if function.negated else stack[0]


def _combine(operation: int, result: np.ndarray, value: np.ndarray) -> None:
    if operation == AND:
        result &= value
    elif operation == OR:
        result |= value
    else:
        result ^= value


@dataclass(frozen=True, eq=False)
class Classifier:
    """All regions of a program, ready to classify points."""

    leaves: Sequence[Leaf]
    screen: Screen
    functions: list[_Function]
    low: np.ndarray  # of the regions' boxes
    high: np.ndarray

    @staticmethod
    def of(leaves: Sequence[Leaf], codes: Sequence[Code], dim: int) -> Classifier:
        """Prepare the regions `codes` over the leaves."""
        boxes = [code_bounds(leaves, code, dim) for code in codes]
        return Classifier(
            leaves,
            Screen.of(leaves),
            [_function(code) for code in codes],
            np.array([low for low, _ in boxes]),
            np.array([high for _, high in boxes]),
        )

    def last(self, points: np.ndarray) -> np.ndarray:
        """The last region that contains each point, −1 for none."""
        result = np.full(len(points), -1, np.int64)
        state = np.full(len(self.leaves), OPEN, np.int64)
        start = (np.arange(len(self.functions)), self.functions)
        stack = [(np.arange(len(points)), points, -1, start)] if len(points) else []
        while stack:
            which, here, sure, candidates = stack.pop()
            low, high = here.min(axis=0), here.max(axis=0)
            sure, candidates = self._narrowed(low, high, sure, candidates, state)
            functions = candidates[1]
            n_literals = sum(f.n_literals for f in functions)
            few = n_literals * len(here) <= _SPLIT_WORK or len(here) <= 64
            simple = n_literals <= _SIMPLE and len(here) <= _CHUNK
            if few or simple or (high == low).all():
                result[which] = self._tested(here, sure, candidates)
                continue
            axis = int(np.argmax(high - low))
            left = here[:, axis] <= 0.5 * low[axis] + 0.5 * high[axis]
            for side in (left, ~left):
                if side.any():
                    stack.append((which[side], here[side], sure, candidates))
        return result

    def _narrowed(
        self,
        low: np.ndarray,
        high: np.ndarray,
        sure: int,
        candidates: _Candidates,
        state: np.ndarray,
    ) -> tuple[int, _Candidates]:
        """The functions still open in a box, all above the last region that surely covers it."""
        regions, functions = candidates
        met = ~((self.low[regions] > high) | (self.high[regions] < low)).any(axis=1)
        kept: list[int] = []
        left: list[_Function] = []
        for k in np.flatnonzero(met)[::-1].tolist():
            pruned: _Function | bool = functions[k]
            if functions[k].n_literals > _SIMPLE or len(functions) <= _SIMPLE:
                leaves = functions[k].leaves
                self.screen.judge(leaves, low, high, state)
                if (state[leaves] != OPEN).any():
                    pruned = _pruned(functions[k], state)
            if pruned is True:
                sure = int(regions[k])
                break
            if pruned is not False:
                kept.append(k)
                left.append(pruned)
        return sure, (regions[kept[::-1]], left[::-1])

    def _tested(self, points: np.ndarray, sure: int, candidates: _Candidates) -> np.ndarray:
        result = np.full(len(points), sure, np.int64)
        for region, function in zip(candidates[0].tolist(), candidates[1], strict=True):
            result[_evaluated(function, self.leaves, points)] = region
        return result

"""Boxes around whole trees."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from csgmesh.csg.primitives.half_space import HalfSpace

if TYPE_CHECKING:
    from csgmesh.csg.program import Code, Leaf

#: A corner farther away than this multiple of the lines' extent counts as at infinity: the angle
#: between its two lines is then lost in the rounding of their normals.
_FAR = 1e12

#: A unit normal's component below this counts as zero: the line is parallel to the axis.
_PARALLEL = 1e-9


@dataclass(eq=False)
class _Hull:
    """A box cut by half-spaces, around a set or around its complement."""

    low: np.ndarray
    high: np.ndarray
    cuts: list[tuple[np.ndarray, np.ndarray]]  # (point, outward normal)

    def box(self) -> tuple[np.ndarray, np.ndarray]:
        if self.cuts and len(self.low) == 2 and (self.low <= self.high).all():
            self.low, self.high = cut_box(self.low, self.high, self.cuts)
            self.cuts = []
        return self.low, self.high


#: What is known of a set and of its complement.
_Pair = tuple[_Hull, _Hull]


def code_bounds(leaves: Sequence[Leaf], code: Code, dim: int) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner of a box around a region."""
    stack: list[_Pair] = []
    for word, count in code:
        if word == "leaf":
            stack.append(_leaf_pair(leaves[count], dim))
            continue
        operands = stack[-count:]
        del stack[-count:]
        if word == "complement":
            ((inner, outer),) = operands
            stack.append((outer, inner))
        elif word == "union":
            stack.append((_around([a for a, _ in operands]), _common([b for _, b in operands])))
        elif word == "symmetric_difference":
            hulls = _around([a for a, _ in operands])
            stack.append((hulls, _Hull(*_everything(dim), [])))
        else:
            if word == "difference":
                operands = operands[:1] + [(b, a) for a, b in operands[1:]]
            stack.append((_common([a for a, _ in operands]), _around([b for _, b in operands])))
    ((hull, _),) = stack
    low, high = hull.box()
    if (low > high).any():
        return np.full(dim, np.inf), np.full(dim, -np.inf)
    return low.copy(), high.copy()


def _everything(dim: int) -> tuple[np.ndarray, np.ndarray]:
    return np.full(dim, -np.inf), np.full(dim, np.inf)


def _leaf_pair(leaf: Leaf, dim: int) -> _Pair:
    low, high = leaf.box
    if not isinstance(leaf.primitive, HalfSpace):
        return _Hull(low, high, []), _Hull(*_everything(dim), [])
    if np.isfinite(low).any() or np.isfinite(high).any():  # parallel to an axis
        free = ~np.isfinite(low) & ~np.isfinite(high)
        other_low = np.where(free | np.isfinite(low), -np.inf, high)
        other_high = np.where(free | np.isfinite(high), np.inf, low)
        return _Hull(low, high, []), _Hull(other_low, other_high, [])
    point, normal = leaf.half_space()
    return (
        _Hull(*_everything(dim), [(point, normal)]),
        _Hull(*_everything(dim), [(point, -normal)]),
    )


def _around(hulls: list[_Hull]) -> _Hull:
    """The box around a union."""
    boxes = [hull.box() for hull in hulls]
    return _Hull(np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0), [])


def _common(hulls: list[_Hull]) -> _Hull:
    """What is left of boxes and cuts in an intersection; the longest list of cuts is reused."""
    hulls = sorted(hulls, key=lambda hull: -len(hull.cuts))
    cuts = hulls[0].cuts
    for hull in hulls[1:]:
        cuts.extend(hull.cuts)
    low = np.max([hull.low for hull in hulls], axis=0)
    return _Hull(low, np.min([hull.high for hull in hulls], axis=0), cuts)


def cut_box(
    low: np.ndarray, high: np.ndarray, cuts: Sequence[tuple[np.ndarray, np.ndarray]]
) -> tuple[np.ndarray, np.ndarray]:
    """The box around a box cut by half-planes; ±inf where it stays unbounded.

    The convex polygon is clipped by one half-plane after the other. Each corner is the intersection
    of the two lines it lies on, solved afresh, so no error builds up.

    Examples
    --------
    >>> low, high = np.array([0.0, 0.0]), np.array([np.inf, np.inf])
    >>> cut_box(low, high, [(np.array([1.0, 0.0]), np.array([1.0, 1.0]))])
    (array([0., 0.]), array([1., 1.]))
    """
    anchors = np.array([point for point, _ in cuts])
    origin = anchors.mean(axis=0)
    sides = np.concatenate([origin - low, high - origin])
    bounded = np.isfinite(sides)
    reach = np.concatenate([(anchors - origin).ravel(), sides[bounded]])
    size = float(np.abs(reach).max()) or 1.0
    # Lines n·x = c about the origin, in units of the size; the box's four sides come first.
    normals = [np.array(n) for n in ((-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0))]
    offsets = np.where(bounded, sides / size, _FAR).tolist()
    for point, normal in cuts:
        unit = normal / np.abs(normal).max()
        unit /= np.hypot(*unit)
        normals.append(unit)
        offsets.append(float(unit @ ((point - origin) / size)))
    table = np.array(normals)
    corners, lines = _clipped(table, np.array(offsets))
    if len(corners) == 0:
        return np.full(2, np.inf), np.full(2, -np.inf)
    corners = _sent_to_infinity(corners, lines, table, ~bounded)
    touched = np.isin([0, 1, 2, 3], lines) & bounded
    reached = origin + size * corners
    return (
        np.where(touched[:2], low, reached.min(axis=0)),
        np.where(touched[2:], high, reached.max(axis=0)),
    )


def _sent_to_infinity(
    corners: np.ndarray, lines: np.ndarray, normals: np.ndarray, open_sides: np.ndarray
) -> np.ndarray:
    """Corners on a side that stands for infinity, moved there along the other line they lie on."""
    at_infinity = np.zeros(len(normals), bool)
    at_infinity[:4] = open_sides
    before = np.roll(lines, 1)
    result = corners.copy()
    for k in np.flatnonzero(at_infinity[lines] | at_infinity[before]):
        ends = [line for line in (before[k], lines[k]) if not at_infinity[line]]
        # Along n·x = c, x changes where n_y is not zero and y where n_x is not.
        moves = np.abs(normals[ends[0], ::-1]) > _PARALLEL if ends else np.ones(2, bool)
        result[k] = np.where(moves, np.copysign(np.inf, corners[k]), corners[k])
    return result


def _clipped(normals: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the polygon n·x ≤ c (the first four lines a box), and the line of each side.

    Side i runs from corner i to corner i + 1.
    """
    west, south, east, north = offsets[:4]
    corners = np.array([(-west, -south), (east, -south), (east, north), (-west, north)])
    lines = np.array([1, 2, 3, 0])
    if (corners[2] < corners[0]).any():
        return np.zeros((0, 2)), lines[:0]
    for k in range(4, len(normals)):
        height = corners @ normals[k] - offsets[k]
        out = height > 0.0
        if not out.any():
            continue
        if out.all():
            return np.zeros((0, 2)), lines[:0]
        # The kept corners are one run of the cycle: turn it to the front.
        (first,) = np.nonzero(~out & np.roll(out, 1))
        turn = -int(first[0])
        corners, lines, height = (np.roll(a, turn, axis=0) for a in (corners, lines, height))
        kept = int((~out).sum())
        ends = []
        for inner, outer, line in ((kept - 1, kept, lines[kept - 1]), (0, -1, lines[-1])):
            share = height[inner] / (height[inner] - height[outer])
            between = corners[inner] + share * (corners[outer] - corners[inner])
            ends.append(_meeting(normals[[line, k]], offsets[[line, k]], between))
        corners = np.concatenate([corners[:kept], ends])
        lines = np.concatenate([lines[:kept], [k, lines[-1]]])
    return corners, lines


def _meeting(normals: np.ndarray, offsets: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Where two lines meet; the point `near` it if they are too parallel to say better."""
    (a, b), (c, d) = normals
    p, q = offsets
    det = a * d - b * c
    if abs(det) < _PARALLEL:
        return near
    return np.array((p * d - b * q, a * q - p * c)) / det

"""One division into chords for two congruent stretches of a boundary."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.congruence import RigidMap, Stretch, agreement, place
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import EvaluationError

#: Lengths along curves are integrated; they agree to this share.
LENGTH_SHARE = 1e-10
#: Chords are of equal length in the parameter if they differ by less than this share.
EVEN = 1e-6


@dataclass(frozen=True, eq=False)
class Division:
    """Nodes and chords of two stretches, along the first.

    Attributes
    ----------
    first_node, second_node : (k + 1,) int64
        Points of the domain, -1 for new ones.
    first_segment, second_segment : (k,) int64
        The old segment under each new one, of which it has the names and regions.
    interval : (k, 2) float64
        Parameters on the first side's exact curve.
    """

    first_node: np.ndarray
    second_node: np.ndarray
    first_segment: np.ndarray
    second_segment: np.ndarray
    interval: np.ndarray


def common_division(domain: Pslg, rigid: RigidMap, first: Stretch, second: Stretch) -> Division:
    """Nodes for both: all corners of either, and chords as fine as the finer ones of the two.

    Where only one side has a corner (an interface ends there, or a point is embedded), the other
    gets a vertex at its image.
    """
    length = first.position[-1]
    position = second.position[-1] - second.position[::-1]
    close = 4.0 * agreement(domain) + LENGTH_SHARE * length
    if abs(position[-1] - length) > close:
        raise EvaluationError(
            f"periodic sides must be congruent; the stretch from "
            f"{place(domain.points[first.nodes[0]])} to {place(domain.points[first.nodes[-1]])} is "
            f"{length:.9g} long, its partner from {place(domain.points[second.nodes[-1]])} "
            f"{position[-1]:.9g}"
        )
    position = np.clip(position * (length / position[-1]), 0.0, length)
    match = _matches(first.position, position, close)
    nodes = _merged(domain, first, second, position, match)
    nodes = _with_parameters(domain, rigid, first, nodes)
    return _divided(domain, first, second, position, nodes)


@dataclass(frozen=True, eq=False)
class _Nodes:
    """Nodes of both stretches in order: numbers or -1, positions, which are corners.

    `leaving` is the parameter on the curve of the segment behind each node, `arriving` on that
    of the one before.
    """

    first: np.ndarray
    second: np.ndarray
    position: np.ndarray
    corner: np.ndarray
    leaving: np.ndarray
    arriving: np.ndarray


def _matches(mine: np.ndarray, theirs: np.ndarray, close: float) -> np.ndarray:
    """For each position in `theirs` the number of the same one in `mine`, or -1."""
    after = np.clip(np.searchsorted(mine, theirs), 1, len(mine) - 1)
    nearest = np.where(theirs - mine[after - 1] < mine[after] - theirs, after - 1, after)
    nearest[0], nearest[-1] = 0, len(mine) - 1
    return np.where(np.abs(mine[nearest] - theirs) <= close, nearest, -1)


def _merged(
    domain: Pslg, first: Stretch, second: Stretch, position: np.ndarray, match: np.ndarray
) -> _Nodes:
    corner, there = _corners(domain, first), _corners(domain, second)[::-1]
    other = np.full(len(first.nodes), -1)
    backwards = second.nodes[::-1]
    both = match >= 0
    other[match[both]] = backwards[both]
    corner = corner.copy()
    corner[match[both]] |= there[both]
    lone = np.flatnonzero(~both)
    at = np.concatenate([first.position, position[lone]])
    order = np.argsort(at, kind="stable")
    nothing = np.full(len(order), np.nan)
    return _Nodes(
        np.concatenate([first.nodes, np.full(len(lone), -1)])[order],
        np.concatenate([other, backwards[lone]])[order],
        at[order],
        np.concatenate([corner, there[lone]])[order],
        nothing,
        nothing.copy(),
    )


def _corners(domain: Pslg, stretch: Stretch) -> np.ndarray:
    """Which nodes are more than ends of chords: where anything changes or something meets."""
    before, after = stretch.segments[:-1], stretch.segments[1:]
    same = domain.segment_curve[before] == domain.segment_curve[after]
    same &= domain.segment_marker[before] == domain.segment_marker[after]
    same &= domain.segment_region[before, 0] == domain.segment_region[after, 0]
    same &= domain.segment_interval[before, 1] == domain.segment_interval[after, 0]
    degree = np.bincount(domain.segments.ravel(), minlength=domain.n_points)
    inner = stretch.nodes[1:-1]
    same &= (degree[inner] == 2) & (domain.point_marker[inner] < 0)
    return np.concatenate([[True], ~same, [True]])


def _with_parameters(domain: Pslg, rigid: RigidMap, first: Stretch, nodes: _Nodes) -> _Nodes:
    """Find each node's parameter on the first side's curve."""
    own = np.flatnonzero(nodes.first >= 0)
    interval = domain.segment_interval[first.segments]
    leaving, arriving = nodes.leaving, nodes.arriving
    leaving[own[:-1]], arriving[own[1:]] = interval[:, 0], interval[:, 1]
    new = np.flatnonzero(nodes.first < 0)
    if len(new):
        under = np.searchsorted(first.position, nodes.position[new], side="right") - 1
        segment = first.segments[under]
        wanted = rigid.back(domain.points[nodes.second[new]])
        t = domain.curves.project(
            domain.segment_curve[segment], wanted, *domain.segment_interval[segment].T
        )
        leaving[new] = arriving[new] = t
        found = domain.curves.points(domain.segment_curve[segment], t)
        off = np.hypot(*(found - wanted).T)
        worst = int(np.argmax(off))
        if off[worst] > agreement(domain):
            raise EvaluationError(
                f"periodic sides must be congruent; the vertex "
                f"{place(domain.points[nodes.second[new[worst]]])} lies at {place(wanted[worst])} "
                f"of the other side, {off[worst]:.3g} away from it"
            )
    return nodes


def _divided(
    domain: Pslg, first: Stretch, second: Stretch, position: np.ndarray, nodes: _Nodes
) -> Division:
    corners = np.flatnonzero(nodes.corner)
    rows: list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]] = []
    for i, j in zip(corners[:-1].tolist(), corners[1:].tolist(), strict=True):
        inner = np.arange(i + 1, j)
        t0, t1 = nodes.leaving[i], nodes.arriving[j]
        t = nodes.arriving[inner]
        here, there = nodes.first[inner] >= 0, nodes.second[inner] >= 0
        one, two = nodes.first[inner], nodes.second[inner]
        at = nodes.position[inner]
        if not (here & there).all():
            count = _count(t0, t, t1, here, there)
            if count:
                share = np.arange(1, count) / count
                t = (1.0 - share) * t0 + share * t1
                at = (1.0 - share) * nodes.position[i] + share * nodes.position[j]
                one = two = np.full(count - 1, -1)
        ends = np.concatenate([[t0], t, [t1]])
        along = np.concatenate([[nodes.position[i]], at, [nodes.position[j]]])
        rows.append((
            np.append(nodes.first[i], one),
            np.append(nodes.second[i], two),
            np.column_stack([ends[:-1], ends[1:]]),
            0.5 * (along[:-1] + along[1:]),
        ))  # fmt: skip
    one, two, interval, middle = (np.concatenate(c) for c in zip(*rows, strict=True))
    under = np.searchsorted(first.position, middle, side="right") - 1
    under_there = np.searchsorted(position, middle, side="right") - 1
    return Division(
        np.append(one, nodes.first[-1]),
        np.append(two, nodes.second[-1]),
        first.segments[under],
        second.segments[::-1][under_there],
        interval,
    )


def _count(t0: float, t: np.ndarray, t1: float, here: np.ndarray, there: np.ndarray) -> int:
    """Chords of equal parameter length between two corners, if both sides have such; else 0.

    A corner that only the other side has may lie next to the end of a chord: dividing anew keeps
    chords from becoming short there.
    """
    longest = []
    for which in (here, there):
        steps = np.abs(np.diff(np.concatenate([[t0], t[which], [t1]])))
        inner = steps[1:-1]
        if len(inner) and inner.min() < (1.0 - EVEN) * steps.max():
            return 0
        longest.append(steps.max())
    return int(np.ceil(abs(t1 - t0) / min(longest) - EVEN))

"""Components and holes of a domain's regions, counted on its boundary loops alone."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cmp_to_key

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.graphs import components

#: Directions nearer than this many radians are compared in rational arithmetic.
_NEAR = 1e-9

#: A loop's area is rounding noise below this share of its terms, and then summed exactly.
_NOISE = 1e-12


@dataclass(frozen=True)
class Counts:
    """Topology of plane sets, an entry a set.

    Attributes
    ----------
    components : (n,) int64
        Components of the interior: what touches at a vertex only is apart.
    holes : (n,) int64
        Bounded components of the complement of the closed set: two holes that touch are two.
    euler : (n,) int64
        Euler characteristic of the closed set.
    """

    components: np.ndarray
    holes: np.ndarray
    euler: np.ndarray


def count_loops(
    points: np.ndarray, segments: np.ndarray, sides: np.ndarray, n_regions: int
) -> Counts:
    """Count components and holes of regions by walking along their boundaries.

    With the interior on the left, and turning at each vertex as the interior does, there is one
    counterclockwise loop a component. With the outside on the left there is one a hole, and one
    clockwise loop for each component of the closed set.

    Parameters
    ----------
    points : (n, 2) float64
    segments : (m, 2) int64
    sides : (m, 2) int64
        Regions on the left and right, -1 outside; equal ones do not bound anything.
    n_regions : int

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> count_loops(square, np.array([[0, 1], [1, 2], [2, 3], [3, 0]]), np.tile([0, -1], (4, 1)), 1)
    Counts(components=array([1]), holes=array([0]), euler=array([1]))
    """
    bounds = sides[:, 0] != sides[:, 1]
    walks, regions = [], []
    for side in (0, 1):
        at = np.flatnonzero(bounds & (sides[:, side] >= 0))
        walks.append(segments[at] if side == 0 else segments[at][:, ::-1])
        regions.append(sides[at, side])
    walk, region = np.concatenate(walks), np.concatenate(regions)
    components, _ = _loops(points, walk, region, n_regions)
    holes, pieces = _loops(points, walk[:, ::-1], region, n_regions)
    return Counts(components, holes, pieces - holes)


def region_counts(domain: Pslg) -> tuple[Counts, Counts]:
    """Counts of each region of a domain, and of all of it."""
    each = count_loops(
        domain.points, domain.segments, domain.segment_region, len(domain.region_names)
    )
    whole = np.where(domain.segment_region >= 0, 0, -1)
    return each, count_loops(domain.points, domain.segments, whole, 1)


def _loops(
    points: np.ndarray, walk: np.ndarray, region: np.ndarray, n: int
) -> tuple[np.ndarray, np.ndarray]:
    """Number of counterclockwise and of clockwise loops of each region."""
    n_loops, loop = components(len(walk), np.arange(len(walk)), _next(points, walk, region))
    sign = _signs(points, walk, loop, n_loops)
    owner = np.zeros(n_loops, np.int64)
    owner[loop] = region
    return np.bincount(owner[sign > 0], minlength=n), np.bincount(owner[sign < 0], minlength=n)


def _next(points: np.ndarray, walk: np.ndarray, region: np.ndarray) -> np.ndarray:
    """The half-segment after each that keeps the same set on its left, (h,)."""
    h = len(walk)
    vertex = np.r_[walk[:, 1], walk[:, 0]]
    away = np.r_[walk[:, 0], walk[:, 1]]
    owner = np.r_[region, region]
    arm = points[away] - points[vertex]
    angle = np.arctan2(arm[:, 1], arm[:, 0])
    order = np.lexsort((angle, owner, vertex))
    start = np.ones(2 * h, bool)
    start[1:] = (vertex[order][1:] != vertex[order][:-1]) | (owner[order][1:] != owner[order][:-1])
    first = np.flatnonzero(start)
    last = np.r_[first[1:], 2 * h][: len(first)] - 1
    _sort_exactly(points, vertex, away, order, angle, first, last)
    # Around a vertex what is on the left lies clockwise of an arriving half-segment.
    clockwise = np.empty(2 * h, np.int64)
    clockwise[order[1:]] = order[:-1]
    clockwise[order[first]] = order[last]
    return np.maximum(clockwise[:h] - h, 0)


def _sort_exactly(
    points: np.ndarray,
    vertex: np.ndarray,
    away: np.ndarray,
    order: np.ndarray,
    angle: np.ndarray,
    first: np.ndarray,
    last: np.ndarray,
) -> None:
    """Put right, in place, the order of arms whose angles rounding cannot tell apart."""
    gap = np.full(len(order), np.inf)
    gap[1:] = np.diff(angle[order])
    gap[first] = np.inf
    group = np.searchsorted(first, np.flatnonzero(gap < _NEAR), side="right") - 1
    for g in np.unique(group[last[group] - first[group] > 1]).tolist():
        inside = slice(first[g], last[g] + 1)

        def turn(i: int, j: int) -> int:
            if abs(angle[i] - angle[j]) >= _NEAR:
                return -1 if angle[i] < angle[j] else 1
            o, p, q = (
                [Fraction(x) for x in points[v].tolist()] for v in (vertex[i], away[i], away[j])
            )
            det = (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
            return (det < 0) - (det > 0)

        order[inside] = sorted(order[inside].tolist(), key=cmp_to_key(turn))


def _signs(points: np.ndarray, walk: np.ndarray, loop: np.ndarray, n_loops: int) -> np.ndarray:
    """1 for loops that run counterclockwise, -1 for those that run clockwise."""
    origin = np.zeros((n_loops, 2))
    origin[loop] = points[walk[:, 0]]
    a, b = points[walk[:, 0]] - origin[loop], points[walk[:, 1]] - origin[loop]
    terms = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    area = np.bincount(loop, terms, n_loops)
    size = np.bincount(loop, np.abs(terms), n_loops)
    sign = np.sign(area).astype(np.int64)
    for one in np.flatnonzero(np.abs(area) <= _NOISE * size).tolist():
        total = Fraction(0)
        for row in walk[loop == one]:
            (ax, ay), (bx, by) = ([Fraction(x) for x in p] for p in points[row].tolist())
            total += ax * by - ay * bx
        sign[one] = (total > 0) - (total < 0)
    return sign

"""Components and holes of a domain's regions, counted on its boundary loops alone."""

from __future__ import annotations

from fractions import Fraction
from functools import cmp_to_key

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.mesh.topology import connected

#: Directions nearer than this many radians are compared in rational arithmetic.
_NEAR = 1e-9

#: A loop's area is rounding noise below this share of its terms, and then summed exactly.
_NOISE = 1e-12


def count_loops(
    points: np.ndarray, segments: np.ndarray, sides: np.ndarray, n_regions: int
) -> tuple[np.ndarray, np.ndarray]:
    """Components and holes of the interior of each region.

    Each component of an open plane region has one boundary loop with the interior on its left that
    runs counterclockwise, and one clockwise for each hole. Where a boundary touches itself, the
    loops are parted as the interior sees them, so holes that touch stay two.

    Parameters
    ----------
    points : (n, 2) float64
    segments : (m, 2) int64
    sides : (m, 2) int64
        Regions on the left and right, -1 outside; equal ones do not bound anything.
    n_regions : int

    Returns
    -------
    components, holes : (n_regions,) int64

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> count_loops(square, np.array([[0, 1], [1, 2], [2, 3], [3, 0]]), np.tile([0, -1], (4, 1)), 1)
    (array([1]), array([0]))
    """
    bounds = sides[:, 0] != sides[:, 1]
    walks, regions = [], []
    for side in (0, 1):
        at = np.flatnonzero(bounds & (sides[:, side] >= 0))
        walks.append(segments[at] if side == 0 else segments[at][:, ::-1])
        regions.append(sides[at, side])
    walk, region = np.concatenate(walks), np.concatenate(regions)
    n_loops, loop = connected(len(walk), np.arange(len(walk)), _next(points, walk, region))
    sign = _signs(points, walk, loop, n_loops)
    owner = np.zeros(n_loops, np.int64)
    owner[loop] = region
    return (
        np.bincount(owner[sign > 0], minlength=n_regions),
        np.bincount(owner[sign < 0], minlength=n_regions),
    )


def region_counts(domain: Pslg) -> tuple[np.ndarray, np.ndarray]:
    """Components and holes of each region of a domain, and of all of it as the last entry."""
    n = len(domain.region_names)
    each = count_loops(domain.points, domain.segments, domain.segment_region, n)
    whole = np.where(domain.segment_region >= 0, 0, -1)
    total = count_loops(domain.points, domain.segments, whole, 1)
    return np.r_[each[0], total[0]], np.r_[each[1], total[1]]


def _next(points: np.ndarray, walk: np.ndarray, region: np.ndarray) -> np.ndarray:
    """The half-segment after each along the boundary of its region, (h,)."""
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
    # Around a vertex the interior lies clockwise of an arriving half-segment, up to a leaving one.
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

"""Sharp corners of a domain: where no mesher can keep an angle bound, and how far that reaches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.curves import LINE
from csgmesh.domain.periodic import partners
from csgmesh.domain.pslg import Pslg
from csgmesh.tolerance import EXCUSED_ANGLE

#: An angle of exactly 60 degrees must not count as smaller for the rounding of its coordinates.
ANGLE_ROUNDING = 1e-9

#: Fixed-point steps to a point at a given distance along a curve.
_RADIUS_STEPS = 4


@dataclass(frozen=True, eq=False)
class SharpCorners:
    """Vertices at which segments enclose a piece of the domain at less than 60 degrees.

    Attributes
    ----------
    vertex : (k,) int64
        Point numbers of the apexes.
    angle : (k,) float64
        The smallest such angle at each, degrees, between the exact curves' tangents.
    radius : (k,) float64
        Radius of the protected shell: of all pairs of segments that enclose such an angle, the
        largest length that both have.
    is_sharp_end : (m, 2) bool
        For each segment whether such an angle lies beside it at its start, at its end.
    """

    vertex: np.ndarray
    angle: np.ndarray
    radius: np.ndarray
    is_sharp_end: np.ndarray


def input_angles(pslg: Pslg) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Apexes of input angles below 60 degrees, and their protected shells.

    A cell is excused from an angle bound if one of its vertices is an apex, or lies no further
    from an apex than the radius of its shell: the distance along which two segments that leave the
    apex at a small angle run beside each other.

    Returns
    -------
    points : (k, 2) float64
        The apexes.
    angles : (k,) float64
        Smallest angle at each, in degrees, between tangents of the exact curves, inside the domain.
    radii : (k,) float64
        Radius of the protected shell around each.

    Examples
    --------
    >>> wedge = Pslg([[0, 0], [4, 0], [3, 1]], [[0, 1], [1, 2], [2, 0]])
    >>> points, angles, radii = input_angles(wedge)
    >>> points[0], round(float(angles[0]), 2), round(float(radii[0]), 2)
    (array([0., 0.]), 18.43, 3.16)
    """
    corners = sharp_corners(pslg)
    return pslg.points[corners.vertex], corners.angle, corners.radius


def sharp_corners(pslg: Pslg) -> SharpCorners:
    """The sharp corners of a domain and the segments that make them."""
    m = len(pslg.segments)
    vertex = pslg.segments.T.ravel()
    chord = _chords(pslg)
    tangent = _tangents(pslg, chord)
    limit = np.radians(EXCUSED_ANGLE - ANGLE_ROUNDING)
    # Half-edges, numbered by segment at its start, then by segment at its end.
    half = np.flatnonzero(_may_be_sharp(pslg.n_points, vertex, tangent)[vertex])
    if not len(half):
        nothing = np.zeros(0)
        return SharpCorners(np.zeros(0, np.int64), nothing, nothing, np.zeros((m, 2), bool))
    at = vertex[half]
    length = np.hypot(chord[half, 0], chord[half, 1])
    heading = _headings(pslg, chord, length, half, at)
    order = np.lexsort((heading, at))
    half, at, length = half[order], at[order], length[order]
    after = _next_around(at)
    opening = _openings(heading[order], tangent[half], after)
    left = pslg.segment_region.T.ravel()[half]
    sharp = (left >= 0) & (after != np.arange(len(half))) & (opening < limit)
    is_sharp = np.zeros(2 * m, bool)
    is_sharp[half[sharp]] = is_sharp[half[after[sharp]]] = True
    apexes, number = np.unique(at[sharp], return_inverse=True)
    angle = np.full(len(apexes), np.inf)
    np.minimum.at(angle, number, np.degrees(opening[sharp]))
    radius = np.zeros(len(apexes))
    here = np.flatnonzero(sharp)
    there, turned = after[here], opening[here]
    while len(here):
        reach = np.minimum(length[here], length[there])
        np.maximum.at(radius, np.searchsorted(apexes, at[here]), reach)
        # Past a shorter segment, its two neighbours run beside each other.
        onward = turned + opening[there]
        near = sharp[there] & (onward < limit) & (after[there] != here)
        here, turned, there = here[near], onward[near], after[there[near]]
    corners = SharpCorners(apexes, angle, radius, is_sharp.reshape(2, m).T)
    return _repeated(pslg, corners) if pslg.periodic and len(apexes) else corners


def _repeated(pslg: Pslg, corners: SharpCorners) -> SharpCorners:
    """The same shells on both sides of periodic pairs, so that both are split alike.

    An image of an apex need not be one itself: it becomes one.
    """
    other = partners(len(pslg.segments), pslg.periodic)
    here = np.flatnonzero(other >= 0)
    angle, radius = np.full(pslg.n_points, np.inf), np.zeros(pslg.n_points)
    angle[corners.vertex], radius[corners.vertex] = corners.angle, corners.radius
    ends, images = pslg.segments[here], pslg.segments[other[here], ::-1]
    before = -1.0
    while radius.sum() != before:
        before = radius.sum()
        np.minimum.at(angle, images, angle[ends])
        np.maximum.at(radius, images, radius[ends])
    sharp = corners.is_sharp_end.copy()
    sharp[here] |= corners.is_sharp_end[other[here], ::-1]
    vertex = np.flatnonzero(np.isfinite(angle))
    return SharpCorners(vertex, angle[vertex], radius[vertex], sharp)


def _may_be_sharp(n_points: int, vertex: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Vertices at which segments may enclose an angle below 60 degrees, (n_points,) bool.

    Most vertices of most domains are met by two segments with tangents far apart: there nothing has
    to be sorted.
    """
    degree = np.bincount(vertex, minlength=n_points)
    out = degree > 2
    first = np.full(n_points, -1)
    first[vertex[::-1]] = np.arange(len(vertex))[::-1]
    last = np.full(n_points, -1)
    last[vertex] = np.arange(len(vertex))
    two = np.flatnonzero(degree == 2)
    between = np.abs(tangent[first[two]] - tangent[last[two]])
    out[two] = np.minimum(between, 2 * np.pi - between) < np.radians(EXCUSED_ANGLE)
    return out


def _chords(pslg: Pslg) -> np.ndarray:
    """Vectors from each segment's start to its end, then the other way, (2 m, 2)."""
    chord = pslg.points[pslg.segments[:, 1]] - pslg.points[pslg.segments[:, 0]]
    return np.concatenate([chord, -chord])


def _headings(
    pslg: Pslg, chord: np.ndarray, length: np.ndarray, half: np.ndarray, vertex: np.ndarray
) -> np.ndarray:
    """Headings of segments' exact curves at one distance from each vertex, (k,).

    They sort the segments around a vertex. Chords do not where curves share a tangent: the longer
    chord of the flatter curve may pass beyond the shorter chord of the sharper one.

    Parameters
    ----------
    pslg : Pslg
    chord : (2 m, 2) float64
    length : (k,) float64
        Of the chords of these half-edges.
    half, vertex : (k,) int64
        Half-edges, and the vertices that they leave.
    """
    heading = np.arctan2(chord[half, 1], chord[half, 0])
    m = len(pslg.segments)
    segment = half % m
    curve = pslg.segment_curve[segment]
    bent = np.flatnonzero(curve >= 0)
    bent = bent[pslg.curves.kind[curve[bent]] != LINE]
    if not len(bent):
        return heading
    reach = np.full(pslg.n_points, np.inf)
    np.minimum.at(reach, vertex, 0.5 * length)
    wanted = reach[vertex[bent]]
    segment, curve = segment[bent], curve[bent]
    start, end = np.where((half[bent] < m)[:, None], pslg.segment_interval[segment],
                          pslg.segment_interval[segment, ::-1]).T  # fmt: skip
    share = wanted / length[bent]
    for _ in range(_RADIUS_STEPS):
        p = pslg.curves.points(curve, start + share * (end - start))
        p -= pslg.points[vertex[bent]]
        away = np.hypot(p[:, 0], p[:, 1])
        share *= np.where(away > 0, wanted / np.where(away > 0, away, 1.0), 1.0)
        share = np.minimum(share, 1.0)
    heading[bent] = np.arctan2(p[:, 1], p[:, 0])
    return heading


def _tangents(pslg: Pslg, chord: np.ndarray) -> np.ndarray:
    """Heading of the exact curves where they leave their vertices, (2 m,)."""
    direction = chord.copy()
    bent = np.flatnonzero(pslg.segment_curve >= 0)
    if len(bent):
        interval = pslg.segment_interval[bent]
        travel = np.sign(interval[:, 1] - interval[:, 0])
        sign = np.concatenate([travel, -travel])
        curve = np.tile(pslg.segment_curve[bent], 2)
        tangent = pslg.curves.derivatives(curve, interval.T.ravel()) * sign[:, None]
        moves = (tangent != 0).any(axis=1)
        half = np.concatenate([bent, bent + len(pslg.segments)])
        direction[half[moves]] = tangent[moves]
    return np.arctan2(direction[:, 1], direction[:, 0])


def _next_around(vertex: np.ndarray) -> np.ndarray:
    """Position of the next entry of the same vertex, cyclically; `vertex` is sorted."""
    n = len(vertex)
    after = np.arange(1, n + 1)
    starts = np.flatnonzero(np.concatenate([[True], vertex[1:] != vertex[:-1]]))
    after[starts[1:] - 1] = starts[:-1]
    after[-1] = starts[-1]
    return after


def _openings(heading: np.ndarray, tangent: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Counter-clockwise angle from each half-edge to the next between tangents, in radians.

    Tangents may agree where chords do not (a cusp), so that of all turns the one next to the
    chords' is meant.
    """
    chords = np.mod(heading[after] - heading, 2 * np.pi)
    excess = np.mod(tangent[after] - tangent - chords + np.pi, 2 * np.pi) - np.pi
    return np.maximum(chords + excess, 0.0)

"""Sharp corners of a domain: where no mesher can keep an angle bound, and how far that reaches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    length = np.hypot(chord[:, 0], chord[:, 1])
    left = pslg.segment_region.T.ravel()
    heading = _headings(pslg, chord, length, vertex)
    order = np.lexsort((heading, vertex))
    after = _next_around(vertex[order])
    opening = _openings(heading, _tangents(pslg, chord), order, order[after])
    limit = np.radians(EXCUSED_ANGLE - ANGLE_ROUNDING)
    inside = (left[order] >= 0) & (order != order[after])
    sharp = inside & (opening < limit)
    is_sharp = np.zeros(2 * m, bool)
    is_sharp[order[sharp]] = is_sharp[order[after[sharp]]] = True
    apexes, number = np.unique(vertex[order[sharp]], return_inverse=True)
    angle = np.full(len(apexes), np.inf)
    np.minimum.at(angle, number, np.degrees(opening[sharp]))
    radius = np.zeros(len(apexes))
    here = np.flatnonzero(sharp)
    there, turned = after[here], opening[here]
    while len(here):
        reach = np.minimum(length[order[here]], length[order[there]])
        np.maximum.at(radius, np.searchsorted(apexes, vertex[order[here]]), reach)
        # Past a shorter segment, its two neighbours run beside each other.
        onward = turned + opening[there]
        near = sharp[there] & (onward < limit) & (after[there] != here)
        here, turned, there = here[near], onward[near], after[there[near]]
    return SharpCorners(apexes, angle, radius, is_sharp.reshape(2, m).T)


def _chords(pslg: Pslg) -> np.ndarray:
    """Vectors from each segment's start to its end, then the other way, (2 m, 2)."""
    chord = pslg.points[pslg.segments[:, 1]] - pslg.points[pslg.segments[:, 0]]
    return np.concatenate([chord, -chord])


def _headings(pslg: Pslg, chord: np.ndarray, length: np.ndarray, vertex: np.ndarray) -> np.ndarray:
    """Headings of the segments' exact curves at one distance from each vertex, (2 m,).

    They sort the segments around a vertex. Chords do not where curves share a tangent: the longer
    chord of the flatter curve may pass beyond the shorter chord of the sharper one.
    """
    heading = np.arctan2(chord[:, 1], chord[:, 0])
    m = len(pslg.segments)
    bent = np.flatnonzero(np.tile(pslg.segment_curve >= 0, 2))
    if not len(bent):
        return heading
    reach = np.full(pslg.n_points, np.inf)
    np.minimum.at(reach, vertex, 0.5 * length)
    wanted = reach[vertex[bent]]
    segment = bent % m
    start, end = np.where((bent < m)[:, None], pslg.segment_interval[segment],
                          pslg.segment_interval[segment, ::-1]).T  # fmt: skip
    share = wanted / length[bent]
    for _ in range(_RADIUS_STEPS):
        p = pslg.curves.points(pslg.segment_curve[segment], start + share * (end - start))
        p -= pslg.points[vertex[bent]]
        away = np.hypot(p[:, 0], p[:, 1])
        share *= np.where(away > 0, wanted / np.where(away > 0, away, 1.0), 1.0)
        share = np.minimum(share, 1.0)
    heading[bent] = np.arctan2(p[:, 1], p[:, 0])
    return heading


def _tangents(pslg: Pslg, chord: np.ndarray) -> np.ndarray:
    """Heading of the exact curves where they leave their vertices, (2 m,)."""
    direction = chord.copy()
    m = len(pslg.segments)
    bent = np.flatnonzero(pslg.segment_curve >= 0)
    curve = pslg.segment_curve[bent]
    interval = pslg.segment_interval[bent]
    travel = np.sign(interval[:, 1] - interval[:, 0])
    for end, sign in ((0, travel), (1, -travel)):
        tangent = pslg.curves.derivatives(curve, interval[:, end]) * sign[:, None]
        moves = np.hypot(tangent[:, 0], tangent[:, 1]) > 0
        direction[end * m + bent[moves]] = tangent[moves]
    return np.arctan2(direction[:, 1], direction[:, 0])


def _next_around(vertex: np.ndarray) -> np.ndarray:
    """Position of the next entry of the same vertex, cyclically; `vertex` is sorted."""
    n = len(vertex)
    after = np.arange(1, n + 1)
    starts = np.flatnonzero(np.r_[True, vertex[1:] != vertex[:-1]]) if n else np.zeros(0, int)
    ends = np.r_[starts[1:], n] - 1 if n else starts
    after[ends] = starts
    return after


def _openings(heading: np.ndarray, tangent: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Counter-clockwise angle from i to j between tangents, in radians.

    Tangents may agree where chords do not (a cusp), so that of all turns the one next to the
    chords' is meant.
    """
    chords = np.mod(heading[j] - heading[i], 2 * np.pi)
    excess = np.mod(tangent[j] - tangent[i] - chords + np.pi, 2 * np.pi) - np.pi
    return np.maximum(chords + excess, 0.0)

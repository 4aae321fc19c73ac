"""Sharp corners of a domain: where no mesher can keep an angle bound, and how far that reaches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.tolerance import EXCUSED_ANGLE

#: An angle of exactly 60 degrees must not count as smaller for the rounding of its coordinates.
ANGLE_ROUNDING = 1e-9


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
        Radius of the protected shell: of all pairs of neighbouring segments that enclose such an
        angle, the largest length that both have.
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
    heading = np.arctan2(chord[:, 1], chord[:, 0])
    order = np.lexsort((heading, vertex))
    after = _next_around(vertex[order])
    i, j = order, order[after]
    opening = _openings(heading, _tangents(pslg, chord), i, j)
    sharp = (left[i] >= 0) & (opening < np.radians(EXCUSED_ANGLE - ANGLE_ROUNDING)) & (i != j)
    i, j, opening = i[sharp], j[sharp], np.degrees(opening[sharp])
    is_sharp = np.zeros(2 * m, bool)
    is_sharp[i] = is_sharp[j] = True
    apexes, pair_apex = np.unique(vertex[i], return_inverse=True)
    angle = np.full(len(apexes), np.inf)
    radius = np.zeros(len(apexes))
    np.minimum.at(angle, pair_apex, opening)
    np.maximum.at(radius, pair_apex, np.minimum(length[i], length[j]))
    return SharpCorners(apexes, angle, radius, is_sharp.reshape(2, m).T)


def _chords(pslg: Pslg) -> np.ndarray:
    """Vectors from each segment's start to its end, then the other way, (2 m, 2)."""
    chord = pslg.points[pslg.segments[:, 1]] - pslg.points[pslg.segments[:, 0]]
    return np.concatenate([chord, -chord])


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


def _openings(
    heading: np.ndarray, tangent: np.ndarray, i: np.ndarray, j: np.ndarray
) -> np.ndarray:
    """Counter-clockwise angle from i to j between tangents, in radians.

    Tangents may agree where chords do not (a cusp), so that of all turns the one next to the
    chords' is meant.
    """
    chords = np.mod(heading[j] - heading[i], 2 * np.pi)
    excess = np.mod(tangent[j] - tangent[i] - chords + np.pi, 2 * np.pi) - np.pi
    return np.maximum(chords + excess, 0.0)

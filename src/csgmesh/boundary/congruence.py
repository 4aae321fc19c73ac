"""Which rigid map takes one side of a domain to another, and which stretches it joins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.errors import EvaluationError
from csgmesh.spatial import Boxes
from csgmesh.tolerance import coordinate_ulp

#: Sides turned by less, in radians, were meant to be parallel: no sector is so narrow.
SMALLEST_TURN = 1e-4


@dataclass(frozen=True, eq=False)
class Side:
    """The segments of one side of a pair.

    Attributes
    ----------
    name : str
        As asked for.
    segments : (k,) int64
    """

    name: str
    segments: np.ndarray


@dataclass(frozen=True, eq=False)
class Stretch:
    """Segments one after the other, the domain on their left.

    Attributes
    ----------
    segments : (k,) int64
    nodes : (k + 1,) int64
        Points from start to end.
    position : (k + 1,) float64
        Length along the exact curves from the start to each node.
    """

    segments: np.ndarray
    nodes: np.ndarray
    position: np.ndarray


@dataclass(frozen=True, eq=False)
class RigidMap:
    """A rotation and a translation, ``matrix @ x + offset``."""

    matrix: np.ndarray
    offset: np.ndarray

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Images of (n, 2) points."""
        return points @ self.matrix.T + self.offset

    def back(self, points: np.ndarray) -> np.ndarray:
        """Points of which (n, 2) points are the images."""
        return (points - self.offset) @ self.matrix


def agreement(domain: Pslg) -> float:
    """How far congruent sides may be apart: what evaluation does not tell apart either."""
    return max(domain.snap, 2.0 * coordinate_ulp(domain.points))


def place(point: np.ndarray) -> str:
    """Coordinates for messages."""
    return f"({point[0]:.9g}, {point[1]:.9g})"


def stretches(domain: Pslg, side: Side) -> list[Stretch]:
    """The connected parts of a side, each from its start to its end."""
    ends = domain.segments[side.segments]
    n = domain.n_points
    n_in, n_out = np.bincount(ends[:, 1], minlength=n), np.bincount(ends[:, 0], minlength=n)
    through = (n_in == 1) & (n_out == 1)
    leaving = np.full(n, -1)
    leaving[ends[:, 0]] = np.arange(len(ends))
    follower = np.where(through[ends[:, 1]], leaving[ends[:, 1]], -1).tolist()
    length = domain.lengths()[side.segments]
    found, covered = [], 0
    for first in np.flatnonzero(~through[ends[:, 0]]).tolist():
        chain = [first]
        while (onward := follower[chain[-1]]) >= 0:
            chain.append(onward)
        covered += len(chain)
        at = np.array(chain)
        found.append(
            Stretch(
                side.segments[at],
                np.append(ends[at, 0], ends[at[-1], 1]),
                np.concatenate([[0.0], np.cumsum(length[at])]),
            )
        )
    if covered < len(ends):
        raise EvaluationError(
            f"a periodic side must have two ends; {side.name!r} is closed, near "
            + place(domain.points[ends[0, 0]])
        )
    return found


def joined(
    domain: Pslg, sides: tuple[Side, Side]
) -> tuple[RigidMap, list[tuple[Stretch, Stretch]]]:
    """The map from the first side to the second, and the stretches that it takes to one another.

    Raises
    ------
    EvaluationError
        If the ends of the sides' stretches are not congruent; with the place and the mismatch.
    """
    first, second = (stretches(domain, side) for side in sides)
    start, end = _end_points(domain, first)
    there_start, there_end = _end_points(domain, second)
    rigid = _rigid_map(start, end, there_start, there_end)
    nearest = _nearest(rigid(start), there_end)
    # Exact for sides with exact coordinates, and indifferent to a few that do not fit.
    offset = np.median(there_end[nearest] - start @ rigid.matrix.T, axis=0)
    offset[np.abs(offset) <= coordinate_ulp(domain.points)] = 0.0
    rigid = RigidMap(rigid.matrix, offset)
    off = np.hypot(*(there_end[nearest] - rigid(start)).T)
    far = np.hypot(*(there_start[nearest] - rigid(end)).T)
    for points, distance, whole in ((start, off, there_end), (end, far, there_start)):
        worst = int(np.argmax(distance))
        if distance[worst] > agreement(domain):
            _refuse(sides, points[worst], rigid, whole)
    lonely = np.setdiff1d(np.arange(len(second)), nearest)
    if len(lonely):
        inverse = RigidMap(rigid.matrix.T, -rigid.matrix.T @ rigid.offset)
        _refuse(sides[::-1], there_end[lonely[0]], inverse, start)
    return rigid, [(a, second[k]) for a, k in zip(first, nearest.tolist(), strict=True)]


def _end_points(domain: Pslg, parts: list[Stretch]) -> tuple[np.ndarray, np.ndarray]:
    at = np.array([[s.nodes[0], s.nodes[-1]] for s in parts]).reshape(-1, 2)
    return domain.points[at[:, 0]], domain.points[at[:, 1]]


def _rigid_map(
    start: np.ndarray,
    end: np.ndarray,
    there_start: np.ndarray,
    there_end: np.ndarray,
) -> RigidMap:
    """From the ends alone, which do not depend on how curves were cut into chords.

    The second side runs against the first, so that its ends are images of the first's starts.
    """
    along, there = (end - start).sum(axis=0), (there_start - there_end).sum(axis=0)
    cosine = along @ there
    sine = along[0] * there[1] - along[1] * there[0]
    size = np.hypot(cosine, sine)
    matrix = np.eye(2)
    if size > 0 and (cosine < 0 or abs(sine) > SMALLEST_TURN * size):
        c, s = cosine / size, sine / size
        matrix = np.array([[c, -s], [s, c]])
    middle = 0.5 * (start.mean(axis=0) + end.mean(axis=0))
    there_middle = 0.5 * (there_start.mean(axis=0) + there_end.mean(axis=0))
    return RigidMap(matrix, there_middle - matrix @ middle)


def _nearest(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Number of the point in `others` that is nearest to each."""
    pad = np.full((1, 2), 1e-6 * np.ptp(others, axis=0).max(initial=1.0))
    pairs = Boxes(others - pad, others + pad).overlapping(points, points)
    distance = np.hypot(*(points[pairs[:, 0]] - others[pairs[:, 1]]).T)
    order = np.lexsort((distance, pairs[:, 0]))
    out = np.full(len(points), -1)
    # Written from the farthest to the nearest, so that the nearest stays.
    out[pairs[order[::-1], 0]] = pairs[order[::-1], 1]
    for k in np.flatnonzero(out < 0).tolist():
        out[k] = int(np.argmin(np.hypot(*(others - points[k]).T)))
    return out


def _refuse(
    sides: tuple[Side, Side], point: np.ndarray, rigid: RigidMap, others: np.ndarray
) -> None:
    image = rigid(point[None])[0]
    away = np.hypot(*(others - image).T)
    raise EvaluationError(
        f"periodic sides must be congruent; {sides[0].name!r} ends at {place(point)}, which "
        f"{_described(rigid)} takes to {place(image)}, but the nearest such end of "
        f"{sides[1].name!r} is {place(others[np.argmin(away)])}, {away.min():.3g} away"
    )


def _described(rigid: RigidMap) -> str:
    turn = np.degrees(np.arctan2(rigid.matrix[1, 0], rigid.matrix[0, 0]))
    if turn == 0.0:
        return f"the translation by {place(rigid.offset)}"
    return f"the rotation by {turn:.6g} degrees"

"""Closed rings of points: area, degeneracy, and their sides as curves."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError

#: Rounding of the cross product of two differences of coordinates, relative to their size.
_ROUNDING = 4.0 * float(np.finfo(float).eps)


def ring_area(points: np.ndarray) -> float:
    """Signed area, positive for counterclockwise."""
    shifted = points - points[0]
    x, y = shifted[:, 0], shifted[:, 1]
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def without_repeats(points: np.ndarray) -> np.ndarray:
    """The ring without points equal to the one before, cyclically."""
    return points[(points != np.roll(points, 1, axis=0)).any(axis=1)]


def check_ring(points: np.ndarray, what: str, where: str) -> None:
    """Raise if the points all lie on one line, so that no ring through them encloses anything."""
    shifted = points - points[0]
    farthest = shifted[int(np.argmax(np.abs(shifted).max(axis=1)))]
    size = float(np.abs(farthest).max())
    along = farthest / (size or 1.0)
    off = np.abs(along[0] * shifted[:, 1] - along[1] * shifted[:, 0])
    if float(off.max()) <= _ROUNDING * size:
        first, last = tuple(points[0].tolist()), tuple((points[0] + farthest).tolist())
        raise ShapeError(
            f"{where}: {what} must enclose an area; all {len(points)} points lie on the line "
            f"through {first} and {last}"
        )


def closed_lines(points: np.ndarray) -> Curves:
    """The sides of a ring."""
    return Curves.lines(points, np.roll(points, -1, axis=0))


def point_within(points: np.ndarray) -> np.ndarray:
    """A point inside a ring that does not cross itself, well away from its corners' heights."""
    heights = np.unique(points[:, 1])
    gap = int(np.argmax(np.diff(heights)))
    y = 0.5 * (heights[gap] + heights[gap + 1])
    following = np.roll(points, -1, axis=0)
    (at,) = np.nonzero((points[:, 1] <= y) != (following[:, 1] <= y))
    a, b = points[at], following[at]
    crossings = np.sort(a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))
    return np.array((0.5 * (crossings[0] + crossings[1]), y))

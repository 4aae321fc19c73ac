"""Sides of a domain that a rigid map takes to one another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class PeriodicSides:
    """Two sides of a domain, segment by segment.

    Attributes
    ----------
    names : (str, str)
        As asked for.
    matrix, offset : (2, 2), (2,) float64
        The map ``matrix @ x + offset`` from the first side to the second.
    segments : (k, 2) int64
        Segments that belong together. They run against each other, since the domain lies on the
        left of both; their exact curves are images of one another with the same parameters.
    """

    names: tuple[str, str]
    matrix: np.ndarray
    offset: np.ndarray
    segments: np.ndarray


def partners(n_segments: int, periodic: tuple[PeriodicSides, ...]) -> np.ndarray:
    """The segment on the other side that belongs to each, (m,) int64, -1 without one."""
    other = np.full(n_segments, -1)
    for sides in periodic:
        first, second = sides.segments.T
        other[first], other[second] = second, first
    return other

"""Convex cells clipped to a domain with holes and corners of any kind."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np


class Clip:
    """What cells are clipped to.

    Parameters
    ----------
    points : (n, 2) float64
    segments : (m, 2) int64
        With the domain on one side and nothing on the other.
    """

    def __init__(self, points: np.ndarray, segments: np.ndarray) -> None:
        import shapely

        self.points = points[np.unique(segments)]
        # Across each segment the domain begins or ends: nested rings are holes and islands in turn.
        lines = shapely.multilinestrings(shapely.linestrings(points[segments]))
        self._domain: Any = shapely.build_area(lines)
        shapely.prepare(self._domain)

    def cells(
        self, corners: np.ndarray, begin: np.ndarray
    ) -> tuple[tuple[tuple[np.ndarray, ...], ...], np.ndarray]:
        """Clipped cells as rings, and their areas.

        Parameters
        ----------
        corners : (k, 2) float64
            Of all cells, counterclockwise, one after the other.
        begin : (n + 1,) int64
        """
        import shapely

        count = np.diff(begin)
        # Rings of shapely repeat their first corner.
        ring = np.repeat(np.arange(len(count)), count + 1)
        within = np.arange(len(ring)) - np.repeat(begin[:-1] + np.arange(len(count)), count + 1)
        at = begin[ring] + within % count[ring]
        polygons = shapely.polygons(shapely.linearrings(corners[at], indices=ring))
        crossing = ~shapely.contains_properly(self._domain, polygons)
        clipped = polygons.copy()
        clipped[crossing] = shapely.intersection(polygons[crossing], self._domain)
        areas = shapely.area(clipped)
        bounds = begin.tolist()
        rings: list[tuple[np.ndarray, ...]] = [(corners[i:j],) for i, j in pairwise(bounds)]
        for k in np.flatnonzero(crossing).tolist():
            rings[k] = tuple(_rings(clipped[k]))
        return tuple(rings), areas


def _rings(shape: Any) -> list[np.ndarray]:
    import shapely

    found = []
    for part in shapely.get_parts(shape):
        if part.geom_type != "Polygon" or part.is_empty:
            continue
        for is_hole, ring in enumerate([part.exterior, *part.interiors]):
            corners = shapely.get_coordinates(ring)[:-1]
            found.append(corners if ring.is_ccw != bool(is_hole) else corners[::-1])
    return found

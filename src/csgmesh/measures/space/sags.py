"""How far flat facets are from the exact surfaces they stand for."""

from __future__ import annotations

import numpy as np

from csgmesh.measures.space.case import SpaceCase
from csgmesh.measures.space.curved import facet_middles


def triangle_areas(case: SpaceCase) -> np.ndarray:
    """Areas of the triangles that facets are cut into, (t,)."""
    a, b, c = (case.mesh.points[case.triangles[:, k]] for k in range(3))
    return 0.5 * np.asarray(np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1)))


def facet_sags(case: SpaceCase, *, curved: bool = False) -> np.ndarray:
    """A bound of the distance of each facet, flat or as curved as it is, from its surface, (f,)."""
    middles = case.facet_places(np.arange(len(case.facets[0])))
    if curved and "triangle6" in case.mesh.facets:
        own = case.facet_kind == "triangle6"
        middles[own] = facet_middles(case.mesh.points[case.mesh.facets["triangle6"]])
    off = case.off_surfaces(middles[:, None])
    # The middle of a facet is where it is furthest off, but for thin ones. A facet that has corners
    # elsewhere fails for that, and must not excuse a wrong volume as well.
    return np.where(case.corners_off <= case.tolerance, 2.0 * off, 0.0)


def area_bounds(case: SpaceCase) -> np.ndarray:
    """A bound of how much each triangle's area differs from that of its exact surface, (t,).

    An arc over a chord L that is s away in the middle is longer by the share 8/3 (s/L)²; an area
    grows by no more than its three sides do together.
    """
    rows = case.triangles[:, :3]
    corner = case.mesh.points[rows]
    share = np.zeros(len(rows))
    for k in range(3):
        a, b = corner[:, k], corner[:, (k + 1) % 3]
        middle = np.zeros((len(case.facets[0]), 3))
        middle[case.triangles[:, 3]] = 0.5 * (a + b)
        off = case.off_surfaces(middle[:, None])[case.triangles[:, 3]]
        share += 16.0 / 3.0 * off**2 / ((b - a) ** 2).sum(axis=1)
    return share * triangle_areas(case)

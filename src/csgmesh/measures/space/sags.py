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


def rim_bounds(case: SpaceCase) -> np.ndarray:
    """A bound of each triangle's gain or loss at edges that stand for curved rims, (t,).

    The middle of a chord is off one of the two surfaces by its distance from their curve times the
    sine of their angle, or more; the segment of a chord has 2/3 of chord times height.
    """
    rows, owner = case.triangles[:, :3], case.triangles[:, 3]
    corner = case.mesh.points[rows]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.maximum(np.sqrt((normal**2).sum(axis=1)), 1e-300)[:, None]
    label = np.full(len(case.facets[0]), -1)
    for number, (_, facets) in enumerate(case.labels):
        label[facets] = number
    off, length = np.zeros((len(rows), 3)), np.zeros((len(rows), 3))
    for k in range(3):
        a, b = corner[:, k], corner[:, (k + 1) % 3]
        middle = np.zeros((len(label), 3))
        middle[owner] = 0.5 * (a + b)
        off[:, k] = case.off_surfaces(middle[:, None])[owner]
        length[:, k] = np.sqrt(((b - a) ** 2).sum(axis=1))
    ends = np.sort(rows[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort(ends.T[::-1])
    out = np.zeros(len(rows))
    # No more than four faces meet along an edge, but at a few.
    for step in (1, 2, 3):
        one, two = order[:-step], order[step:]
        rim = (ends[one] == ends[two]).all(axis=1)
        rim &= label[owner[one // 3]] != label[owner[two // 3]]
        one, two = one[rim], two[rim]
        sine = np.cross(normal[one // 3], normal[two // 3])
        height = (off.flat[one] + off.flat[two]) / np.maximum(np.sqrt((sine**2).sum(axis=1)), 1e-3)
        for side in (one, two):
            out += np.bincount(side // 3, 4.0 / 3.0 * height * length.flat[side], len(rows))
    return out

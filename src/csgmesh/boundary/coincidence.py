"""Surfaces of different leaves that coincide, and the names their facets get from all of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.domain.surfaces import PLANE, Surfaces
from csgmesh.spatial import near_pairs

if TYPE_CHECKING:
    from csgmesh.csg.program import Program

#: Curved surfaces are the same if their tables agree to so many digits: they come from the same
#: arguments by the same arithmetic, or from a transformation that is exact but for rounding.
_DIGITS = 9

#: How far to the sides of a facet a leaf is asked whether its boundary runs there, as a share of
#: the facet's size.
_ASIDE = 1e-3


def classes(surfaces: Surfaces, snap: float) -> tuple[np.ndarray, list[np.ndarray]]:
    """Number coincident surfaces alike, by the lowest of each class.

    Parameters
    ----------
    surfaces : Surfaces
        In local coordinates of order one.
    snap : float
        Distance below which planes are one.

    Returns
    -------
    lowest : (n,) int64
        The lowest surface of each one's class.
    members : list of (k,) int64
        Surfaces of the class of each surface that is the lowest of its own; empty for others.
    """
    lowest = np.arange(len(surfaces))
    planes = np.flatnonzero(surfaces.kind == PLANE)
    if len(planes) > 1:
        normal = surfaces.plane_normals[planes]
        height = (normal * surfaces.offset[planes]).sum(axis=1)
        lead = np.argmax(np.abs(normal) > 0.5, axis=1)
        sign = np.sign(normal[np.arange(len(planes)), lead])
        key = np.column_stack([normal, height]) * sign[:, None]
        for a, b in near_pairs(key, max(2.0 * snap, 1e-12)).tolist():
            i, j = sorted((int(lowest[planes[a]]), int(lowest[planes[b]])))
            lowest[lowest == j] = i
    bent = np.flatnonzero(surfaces.kind != PLANE)
    table: dict[tuple, int] = {}
    for k in bent.tolist():
        parts = (surfaces.matrix[k], surfaces.offset[k], surfaces.profile.data[k])
        rounded = tuple(tuple((np.round(p, _DIGITS) + 0.0).ravel().tolist()) for p in parts)
        key_k = (int(surfaces.kind[k]), int(surfaces.profile.kind[k]), *rounded)
        lowest[k] = table.setdefault(key_k, k)
    members = [np.flatnonzero(lowest == k) if lowest[k] == k else lowest[:0] for k in lowest]
    return lowest, members


def names_of_facets(
    points: np.ndarray,
    triangles: np.ndarray,
    surface: np.ndarray,
    of_class: np.ndarray,
    members: list[np.ndarray],
    leaf_of: np.ndarray,
    parts: tuple[tuple[int, ...], ...],
    program: Program,
    frame: Any,
) -> list[tuple[str, ...]]:
    """All names of each facet, the leaves in tree order."""
    own: dict[int, tuple[str, ...]] = {}
    for s in np.unique(surface).tolist():
        own[s] = tuple(program.leaves[leaf_of[s]].names[p] for p in parts[s])
    out = [own[s] for s in surface.tolist()]
    corners = points[triangles]
    for lowest in np.unique(of_class[surface]).tolist():
        rivals = members[lowest]
        if len(np.unique(leaf_of[rivals])) < 2:
            continue
        rows = np.flatnonzero(of_class[surface] == lowest)
        centre = corners[rows].mean(axis=1)
        normal = np.cross(corners[rows, 1] - corners[rows, 0], corners[rows, 2] - corners[rows, 0])
        area = np.sqrt((normal**2).sum(axis=1))
        step = _ASIDE * normal / np.sqrt(np.where(area > 0, area, 1.0))[:, None]
        sides = [(centre + sign * step) * frame.scale + frame.centre for sign in (-1, 1)]
        lies = {s: surface[rows] == s for s in rivals.tolist()}
        for s in rivals.tolist():
            leaf = program.leaves[leaf_of[s]]
            lies[s] = lies[s] | (leaf.inside(sides[0]) != leaf.inside(sides[1]))
        for position, row in enumerate(rows.tolist()):
            found = [
                program.leaves[leaf_of[s]].names[p]
                for s in rivals.tolist()
                if lies[s][position]
                for p in parts[s]
            ]
            out[row] = tuple(dict.fromkeys(found)) or out[row]
    return out

"""Where triangulated sheets touch: one vertex instead of two, no vertex or edge across a facet.

A boolean engine returns closed manifolds. Pieces that touch come as separate vertices at the same
place, as vertices inside another piece's edge or facet, and as flaps without thickness; bodies that
share a face come with two triangulations of it. None of these is a piecewise linear complex.
Afterwards no vertex lies on a foreign edge or facet, no two edges cross, and facets that overlap
are equal: they have the same three vertices.
"""

from __future__ import annotations

import numpy as np

from csgmesh.boundary.neighbours import overlapping_pairs
from csgmesh.boundary.overlay import coplanar_overlaps, overlaid
from csgmesh.boundary.separation import Sides, contacts
from csgmesh.boundary.sheet_table import Sheets
from csgmesh.boundary.shells import Shells
from csgmesh.boundary.splitting import halved
from csgmesh.boundary.touches import Events, touched
from csgmesh.errors import EvaluationError
from csgmesh.graphs import components
from csgmesh.spatial import near_pairs

#: Rounds of splitting after which touchings must be settled: each edge is split once a round, near
#: its middle if there is a choice.
_ROUNDS = 60


def settle(sheets: Sheets, known: Shells, snap: float) -> Sheets:
    """Merge what is closer than `snap`, split what is touched or crossed.

    Raises
    ------
    EvaluationError
        If it does not come to an end; with the place.
    """
    _merge_points(sheets, snap)
    active, suspect = np.ones((2, len(sheets.triangles)), bool)
    is_whole = is_first = True
    for _ in range(_ROUNDS):
        facet = np.flatnonzero(active)
        pairs = _near(sheets, facet, known if is_first else None, snap)
        is_first = False
        events, involved = touched(sheets, facet, pairs, snap)
        suspect = involved if is_whole else suspect | involved
        if not events and is_whole:
            _overlay(sheets, facet, pairs, snap)
            return sheets
        is_whole = not events
        if not events:
            active = suspect
            continue
        vertex, merged = _with_new_points(sheets, events, involved, snap)
        triangles, parent = halved(
            sheets.points, sheets.triangles, events.edge, vertex, events.facet, events.inner
        )
        active, suspect = _changed(len(sheets.triangles), facet[pairs], parent, involved, suspect)
        sheets.triangles = merged[triangles] if merged is not None else triangles
        sheets.surface, sheets.layer = sheets.surface[parent], sheets.layer[parent]
        real = (sheets.triangles != np.roll(sheets.triangles, 1, axis=1)).all(axis=1)
        _keep(sheets, real)
        active, suspect = active[real], suspect[real]
    x, y, z = sheets.points[vertex[0]] if len(vertex) else sheets.points[events.inner[0]]
    raise EvaluationError(f"pieces of the boundary touch without end near ({x}, {y}, {z})")


def _changed(
    n: int, pairs: np.ndarray, parent: np.ndarray, involved: np.ndarray, suspect: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Which new facets to look at next, and which again at the end.

    Where neither facet of a pair was split, they meet as they did before.
    """
    split = np.bincount(parent, minlength=n) > 1
    active = split & involved
    active[pairs[split[pairs].any(axis=1)].ravel()] = True
    return active[parent], suspect[parent]


def _overlay(sheets: Sheets, facet: np.ndarray, pairs: np.ndarray, snap: float) -> None:
    """Divide facets that overlap alike; their vertices are settled."""
    corner = sheets.points[sheets.triangles[facet]]
    pairs = coplanar_overlaps(corner, pairs, snap)
    if not len(pairs):
        return
    new = overlaid(sheets.points, sheets.triangles[facet], sheets.sheet()[facet], pairs, snap)
    kept = np.ones(len(sheets.triangles), bool)
    kept[facet[new.gone]] = False
    parent = np.concatenate([np.flatnonzero(kept), facet[new.parent]])
    sheets.triangles = np.concatenate([sheets.triangles[kept], new.triangles])
    sheets.surface, sheets.layer = sheets.surface[parent], sheets.layer[parent]


def _keep(sheets: Sheets, kept: np.ndarray) -> None:
    if not kept.all():
        sheets.triangles, sheets.surface = sheets.triangles[kept], sheets.surface[kept]
        sheets.layer = sheets.layer[kept]


def _merge_points(sheets: Sheets, snap: float) -> None:
    pairs = near_pairs(sheets.points, snap)
    if not len(pairs):
        return
    n = len(sheets.points)
    to = _lowest(n, pairs)
    body = np.full(n, -1)
    body[sheets.triangles] = sheets.layer[:, None]
    # Bodies that share a face have all its points twice: that is no news.
    group = to * (int(body.max()) + 2) + body + 1
    _, first, back = np.unique(group, return_index=True, return_inverse=True)
    gone = np.flatnonzero((first[back.reshape(-1)] != np.arange(n)) & (body >= 0))
    apart = np.sqrt(((sheets.points[gone] - sheets.points[to[gone]]) ** 2).sum(axis=1))
    sheets.moved += zip(to[gone].tolist(), apart.tolist(), strict=True)
    sheets.triangles = to[sheets.triangles]
    _keep(sheets, (sheets.triangles != np.roll(sheets.triangles, 1, axis=1)).all(axis=1))


def _lowest(n: int, pairs: np.ndarray) -> np.ndarray:
    """For each of n points the lowest one it is connected with."""
    _, label = components(n, pairs[:, 0], pairs[:, 1])
    _, first = np.unique(label, return_index=True)
    return first[label]


def _with_new_points(
    sheets: Sheets, events: Events, active: np.ndarray, snap: float
) -> tuple[np.ndarray, np.ndarray | None]:
    """Append the points where edges cross, merged with what is there; the events' vertices."""
    n, k = len(sheets.points), len(events.new_points)
    if not k:
        return events.vertex, None
    sheets.points = np.concatenate([sheets.points, events.new_points])
    near = np.append(np.unique(sheets.triangles[active]), n + np.arange(k))
    pairs = near_pairs(sheets.points[near], snap)
    if not len(pairs):
        return events.vertex, None
    to = _lowest(n + k, near[pairs])
    return to[events.vertex], to


def _near(sheets: Sheets, facet: np.ndarray, known: Shells | None, snap: float) -> np.ndarray:
    """Pairs of facets of different sheets that no plane of either keeps apart, (k, 2).

    Leaves are `known` as long as their facets are what they were.
    """
    corner = sheets.points[sheets.triangles[facet]]
    lo, hi = corner.min(axis=1) - snap, corner.max(axis=1) + snap
    sheet = sheets.sheet()[facet]
    if known is not None:
        open_to = contacts(
            Sides(
                sheets.points,
                sheets.triangles[facet],
                sheets.surface[facet],
                sheets.layer[facet],
                known.leaf[sheets.surface[facet]],
            ),
            known,
            snap,
        )
        some = open_to.facets
        pairs = open_to.among(some[overlapping_pairs(lo[some], hi[some], sheet[some])])
    else:
        pairs = overlapping_pairs(lo, hi, sheet)
    for a, b in ((0, 1), (1, 0)):
        p, q = corner[pairs[:, a]], corner[pairs[:, b]]
        normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        height = np.einsum("kij,kj->ki", q - p[:, :1], normal)
        reach = snap * np.sqrt((normal * normal).sum(axis=1))[:, None]
        # What lies on one side but for corners in common meets the other facet in these only.
        own, other = sheets.triangles[facet[pairs[:, a]]], sheets.triangles[facet[pairs[:, b]]]
        shared = (own[:, :, None] == other[:, None, :]).any(axis=1)
        above, below = (height > reach) | shared, (height < -reach) | shared
        clear = ~shared.all(axis=1) & (above.all(axis=1) | below.all(axis=1))
        pairs = pairs[~clear]
    return pairs

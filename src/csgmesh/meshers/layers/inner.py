"""The domain within the layers: walls replaced by the fronts of the layers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.meshers.layers.columns import Walls
from csgmesh.meshers.layers.heights import sliding_parameters, tips


@dataclass(frozen=True, eq=False)
class Inner:
    """A domain, and what its segments are.

    Attributes
    ----------
    domain : Pslg
        Each of its segments has a marker of its own: its number.
    segment : (m,) int64
        The given domain's segment that each is part of; of fronts, that of the wall.
    strip : (m,) int64
        Of fronts: the strip below; -1 of others.
    """

    domain: Pslg
    segment: np.ndarray
    strip: np.ndarray


def inner_domain(walls: Walls) -> Inner:
    """What is left for another mesher."""
    given, pieces = walls.domain, walls.pieces
    n = len(pieces.points)
    points = np.concatenate([pieces.points, tips(walls)])
    vertices = np.array([c.vertex for c in walls.columns])
    is_flat = np.array([c.height == 0.0 for c in walls.columns])
    tip = np.where(is_flat, vertices, n + np.arange(len(vertices)))
    ends, interval = pieces.ends.copy(), pieces.interval.copy()
    is_kept = np.ones(len(ends), bool)
    is_kept[walls.wall] = False
    for k, column in enumerate(walls.columns):
        if column.beside >= 0:
            _shorten(walls, k, int(tip[k]), ends, interval, is_kept)
    kept = np.flatnonzero(is_kept)
    strips = np.array(walls.strips)
    below = np.where(strips[:, 2] >= 0, strips[:, 2], -1 - strips[:, 2])
    front = tip[strips[:, :2]]
    at = np.flatnonzero(front[:, 0] != front[:, 1])
    segment = pieces.segment[np.concatenate([kept, below[at]])]
    rows = np.concatenate([ends[kept], front[at]])
    curve = given.segment_curve[segment].copy()
    curve[len(kept) :] = -1
    intervals = np.concatenate([interval[kept], np.tile([0.0, 1.0], (len(at), 1))])
    used = np.zeros(len(points), bool)
    used[rows] = True
    used[: given.n_points] |= given.point_marker >= 0
    number = np.cumsum(used) - 1
    marker = np.full(len(points), -1)
    embedded = np.flatnonzero(given.point_marker >= 0)
    marker[embedded] = len(rows) + given.point_marker[embedded]
    names = [(*given.boundary_names[given.segment_marker[s]], f"segment {k}")
             for k, s in enumerate(segment.tolist())]  # fmt: skip
    domain = Pslg.build(
        points=points[used],
        segments=number[rows],
        segment_curve=curve,
        segment_interval=np.where(curve[:, None] >= 0, intervals, np.array([0.0, 1.0])),
        segment_marker=np.arange(len(rows)),
        segment_region=given.segment_region[segment],
        point_marker=marker[used],
        boundary_names=(*names, *given.boundary_names),
        region_names=given.region_names,
        curves=given.curves,
        deviation=given.deviation,
        snap=given.snap,
        report=given.report,
    )
    strip = np.concatenate([np.full(len(kept), -1), at])
    return Inner(domain, segment, strip)


def _shorten(
    walls: Walls, k: int, tip: int, ends: np.ndarray, interval: np.ndarray, is_kept: np.ndarray
) -> None:
    """Let the boundary that a column slides on begin at its tip."""
    column, pieces = walls.columns[k], walls.pieces
    if column.height == 0.0:
        return
    near, far = (0, 1) if column.is_away else (1, 0)
    segment = walls.domain.segment_curve[pieces.segment]
    piece = column.beside
    if segment[piece] < 0:
        ends[piece, near] = tip
        return
    t = float(sliding_parameters(walls, k, np.array([1.0]))[0])
    sign = 1.0 if interval[piece, far] > interval[piece, near] else -1.0
    while sign * (interval[piece, far] - t) <= 0:
        is_kept[piece] = False
        v = ends[piece, far]
        piece = int(np.flatnonzero(is_kept & (ends[:, near] == v) & (segment == segment[piece]))[0])
    ends[piece, near] = tip
    interval[piece, near] = t

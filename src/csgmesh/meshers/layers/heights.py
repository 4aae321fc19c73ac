"""How high columns may be: no layer crosses another one, or the boundary."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.errors import MeshingError
from csgmesh.meshers.layers.columns import Walls, first_met
from csgmesh.spatial import Boxes

#: Columns reach over this share of the way to whatever is in front of them at most: what comes
#: from the other side finds room too, and cells between.
CLEAR = 0.35
#: Heights change by this share of the distance between two columns at most.
SLOPE = 0.5
#: What a column loses where cells fold or fronts meet, and how often at most.
LESS, ROUNDS = 0.7, 60
#: Sharpest angle between a column and the front of the layers, as a sine.
SHARPEST = 0.1


def settle_heights(walls: Walls) -> None:
    """Lower columns until layers neither fold nor cross anything."""
    columns = walls.columns
    height = np.array([min(c.height, c.room) for c in columns])
    foot = walls.pieces.points[[c.vertex for c in columns]]
    direction = np.array([c.direction for c in columns])
    rays = np.stack([foot, foot + direction * (height / CLEAR)[:, None]], axis=1)
    share = first_met(walls.pieces.points, walls.pieces.ends, rays)
    is_free = np.array([c.beside < 0 for c in columns])
    height[is_free] *= np.minimum(1.0, share[is_free])
    strips = np.array([(a, b) for a, b, _ in walls.strips])
    for _ in range(ROUNDS):
        _limit_slopes(height, foot, strips)
        for column, h in zip(columns, height.tolist(), strict=True):
            column.height = h
        tip = tips(walls)
        bad = _folded(foot, tip, strips) | _crossed(walls, foot, tip, strips)
        if not bad.any():
            return
        height[np.unique(strips[bad])] *= LESS
    x, y = foot[strips[bad][0, 0]]
    raise MeshingError(f"boundary layers find no room at ({x:.6g}, {y:.6g})")


def tips(walls: Walls) -> np.ndarray:
    """Upper ends of all columns, (c, 2)."""
    return np.array(
        [column_points(walls, k, np.array([1.0]))[0] for k in range(len(walls.columns))]
    )


def column_points(walls: Walls, k: int, shares: np.ndarray) -> np.ndarray:
    """Points at shares of a column's height, on the exact curve of the boundary it slides on."""
    column, pieces = walls.columns[k], walls.pieces
    foot = pieces.points[column.vertex]
    curves = walls.domain.curves
    if column.beside >= 0:
        curve = int(walls.domain.segment_curve[pieces.segment[column.beside]])
        if curve >= 0:
            t = sliding_parameters(walls, k, shares)
            return curves.points(np.full(len(t), curve), t)
    return foot + np.outer(shares * column.height, column.direction)


def sliding_parameters(walls: Walls, k: int, shares: np.ndarray) -> np.ndarray:
    """Parameters on the curve that a column slides on, by arc length from its foot."""
    column, pieces = walls.columns[k], walls.pieces
    t0, t1 = pieces.interval[column.beside]
    start = t0 if column.is_away else t1
    sign = np.sign(t1 - t0) * (1 if column.is_away else -1)
    curve = np.array([walls.domain.segment_curve[pieces.segment[column.beside]]])
    speed = float(np.hypot(*walls.domain.curves.derivatives(curve, np.array([start]))[0]))
    reach = column.height / speed
    length = walls.domain.curves.lengths(curve, np.array([start]), np.array([start + sign * reach]))
    # One correction by the true length is enough for points that need only be in order.
    reach *= column.height / float(length[0]) if length[0] > 0 else 1.0
    return np.asarray(start + sign * reach * shares)


def _limit_slopes(height: np.ndarray, foot: np.ndarray, strips: np.ndarray) -> None:
    """Let heights grow no faster than `SLOPE`, and be alike within a fan."""
    a, b = strips.T
    reach = SLOPE * np.hypot(*(foot[b] - foot[a]).T)
    while True:
        before = height.copy()
        np.minimum.at(height, b, height[a] + reach)
        np.minimum.at(height, a, height[b] + reach)
        if (before - height <= 1e-9 * before).all():
            return


def _folded(foot: np.ndarray, tip: np.ndarray, strips: np.ndarray) -> np.ndarray:
    """Strips whose two columns come too close or cross."""
    a, b = strips.T
    corners = [foot[a], foot[b], tip[b], tip[a]]
    bad = np.zeros(len(strips), bool)
    for k in range(4):
        u = corners[(k + 1) % 4] - corners[k]
        v = corners[k - 1] - corners[k]
        det = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        size = np.hypot(*u.T) * np.hypot(*v.T)
        bad |= (det <= SHARPEST * size) & (size > 0)
    return bad


def _crossed(walls: Walls, foot: np.ndarray, tip: np.ndarray, strips: np.ndarray) -> np.ndarray:
    """Strips whose front or columns meet other fronts, or segments that are no walls."""
    n = len(foot)
    points = np.concatenate([tip, walls.pieces.points])
    others = np.ones(len(walls.pieces.ends), bool)
    others[walls.wall] = False
    # Columns without height have their tip on the boundary, which is no crossing.
    number = np.arange(n)
    flat = np.array([c.height == 0.0 for c in walls.columns])
    number[flat] = n + np.array([c.vertex for c in walls.columns])[flat]
    beside = {c.beside for c in walls.columns if c.beside >= 0}
    others[sorted(beside)] = False
    segments = np.concatenate([number[strips], n + walls.pieces.ends[others]])
    chord = points[segments]
    pairs = Boxes(chord.min(axis=1), chord.max(axis=1)).pairs()
    pairs = pairs[(pairs < len(strips)).any(axis=1)]
    p, q = segments[pairs[:, 0]], segments[pairs[:, 1]]
    apart = (p[:, :, None] != q[:, None, :]).all(axis=(1, 2))
    pairs, p, q = pairs[apart], p[apart], q[apart]
    side = [
        kernels.orientations(points, np.column_stack([one, other[:, k]]))
        for one, other in ((p, q), (q, p))
        for k in (0, 1)
    ]
    hit = (side[0] * side[1] <= 0) & (side[2] * side[3] <= 0)
    bad = np.zeros(len(strips), bool)
    found = pairs[hit].ravel()
    bad[found[found < len(strips)]] = True
    return bad

"""Where monotone curve pieces meet: closed forms for lines and circles, subdivision for the rest.

Everything is in local coordinates of order one, see `csgmesh.boundary.pieces.Frame`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.approach import approaches
from csgmesh.boundary.pieces import Pieces
from csgmesh.domain.curves import ARC, LINE, cross
from csgmesh.spatial import Boxes

#: Lines and rays that turn less than this against each other have no crossing of their own: where
#: they come near, the ends of one lie on the other.
_PARALLEL = 1e-15


@dataclass(frozen=True, eq=False)
class Meetings:
    """Points that lie on two pieces.

    Attributes
    ----------
    first, second : (k,) int64
        Piece numbers.
    t_first, t_second : (k,) float64
        Parameters on each.
    """

    first: np.ndarray
    second: np.ndarray
    t_first: np.ndarray
    t_second: np.ndarray


def candidate_pairs(pieces: Pieces, snap: float) -> np.ndarray:
    """Pairs of pieces whose boxes come within the snap distance, (k, 2)."""
    a, b = ends_of(pieces)
    return Boxes(np.minimum(a, b) - snap, np.maximum(a, b) + snap).pairs()


def ends_of(pieces: Pieces) -> tuple[np.ndarray, np.ndarray]:
    """Points at the lower and at the upper parameter of each piece, in local coordinates."""
    local = pieces.local
    return local.points(pieces.source, pieces.lo), local.points(pieces.source, pieces.hi)


def _beyond_their_corner(pieces: Pieces, pairs: np.ndarray) -> np.ndarray:
    """The pairs that may meet elsewhere than in a common corner of their boxes.

    Monotone pieces that follow one another have boxes that share a corner, which both know.
    """
    a, b = ends_of(pieces)
    lo, hi = np.minimum(a, b), np.maximum(a, b)
    i, j = pairs.T
    corner = (np.minimum(hi[i], hi[j]) <= np.maximum(lo[i], lo[j])).all(1)
    k = np.flatnonzero(corner)
    common = np.zeros(len(k), bool)
    for p in (a, b):
        for q in (a, b):
            common |= (p[i[k]] == q[j[k]]).all(1)
    out = np.ones(len(pairs), bool)
    out[k[common]] = False
    return pairs[out]


def meetings(pieces: Pieces, pairs: np.ndarray, snap: float) -> Meetings:
    """All points in which pairs of pieces cross, touch, or end on one another."""
    pairs = _beyond_their_corner(pieces, pairs)
    kind = pieces.local.kind[pieces.source]
    circle = pieces.local.is_circular()[pieces.source]
    # Lines come first in a pair, circles before other arcs, so that each case has one form.
    rank = np.where(kind == LINE, 0, np.where(circle, 1, 2))
    swap = rank[pairs[:, 0]] > rank[pairs[:, 1]]
    pairs = np.where(swap[:, None], pairs[:, ::-1], pairs)
    i, j = pairs.T
    lines = (rank[i] == 0) & (rank[j] == 0)
    arcs = (rank[i] == 0) & (kind[j] == ARC)
    circles = (rank[i] == 1) & (rank[j] == 1)
    other = ~(lines | arcs | circles)
    found = [
        _line_line(pieces, pairs[lines]),
        _line_arc(pieces, pairs[arcs], snap),
        _circle_circle(pieces, pairs[circles], snap),
        approaches(pieces, pairs[other], snap),
        _ends_on(pieces, pairs, snap),
        _ends_on(pieces, pairs[:, ::-1], snap),
    ]
    row = np.concatenate([f[0] for f in found], axis=0)
    t = np.concatenate([f[1] for f in found], axis=0)
    return _accepted(pieces, row, t, snap)


def _accepted(pieces: Pieces, row: np.ndarray, t: np.ndarray, snap: float) -> Meetings:
    """The candidates whose points on both pieces really come within the snap distance."""
    source = pieces.source[row]
    t = np.clip(t, pieces.lo[row], pieces.hi[row])
    a = pieces.local.points(source[:, 0], t[:, 0])
    b = pieces.local.points(source[:, 1], t[:, 1])
    near = np.hypot(*(a - b).T) <= snap
    row, t = row[near], t[near]
    order = np.lexsort((t[:, 0], row[:, 1], row[:, 0]))
    row, t = row[order], t[order]
    return Meetings(row[:, 0], row[:, 1], t[:, 0], t[:, 1])


def _line_line(pieces: Pieces, pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    a, b = (ends[pairs] for ends in ends_of(pieces))
    # Two lines with a common end meet nowhere else, unless the end of one lies on the other.
    common = (a[:, 0] == a[:, 1]).all(1) | (b[:, 0] == b[:, 1]).all(1)
    common |= (a[:, 0] == b[:, 1]).all(1) | (b[:, 0] == a[:, 1]).all(1)
    pairs = pairs[~common]
    data = pieces.local.data[pieces.source[pairs]]
    p, q = data[:, 0, :2], data[:, 1, :2]
    r, s = data[:, 0, 2:4] - p, data[:, 1, 2:4] - q
    turn = cross(r, s)
    size = np.hypot(*r.T) * np.hypot(*s.T)
    crossing = np.abs(turn) > _PARALLEL * size
    pairs, turn, p, q, r, s = (x[crossing] for x in (pairs, turn, p, q, r, s))
    t = np.column_stack([cross(q - p, s), cross(q - p, r)]) / turn[:, None]
    near = ((t > -1e-6) & (t < 1 + 1e-6)).all(1)
    return pairs[near], t[near]


def _line_arc(pieces: Pieces, pairs: np.ndarray, snap: float) -> tuple[np.ndarray, np.ndarray]:
    source = pieces.source[pairs]
    line, arc = pieces.local.data[source[:, 0]], pieces.local.data[source[:, 1]]
    u, v = arc[:, 2:4], arc[:, 4:6]
    area = cross(u, v)

    def to_circle(x: np.ndarray) -> np.ndarray:
        return np.column_stack([cross(x, v), cross(u, x)]) / area[:, None]

    p = to_circle(line[:, :2] - arc[:, :2])
    r = to_circle(line[:, 2:4] - line[:, :2])
    length = np.hypot(*r.T)
    foot = -(p * r).sum(1) / length**2
    distance = np.abs(cross(p, r)) / length
    height = np.sqrt(np.maximum((1 - distance) * (1 + distance), 0.0))
    # Where the line misses, or cuts off, less than the snap distance, the foot is the one vertex:
    # two would lie apart by the root of a rounding error.
    axes = np.linalg.norm(arc[:, 2:6].reshape(-1, 2, 2), axis=2).max(axis=1)
    touching = np.abs(distance - 1) * axes <= snap
    height[touching] = 0.0
    rows, ts = [], []
    for sign in (-1.0, 1.0):
        at = np.flatnonzero((height > 0) | (touching & (sign < 0)))
        t = foot[at] + sign * height[at] / length[at]
        on_circle = p[at] + t[:, None] * r[at]
        theta = np.arctan2(on_circle[:, 1], on_circle[:, 0])
        rows.append(pairs[at])
        ts.append(np.column_stack([t, _turned_into(theta, pieces, pairs[at, 1])]))
    return np.concatenate(rows), np.concatenate(ts)


def _circle_circle(pieces: Pieces, pairs: np.ndarray, snap: float) -> tuple[np.ndarray, np.ndarray]:
    source = pieces.source[pairs]
    first, second = pieces.local.data[source[:, 0]], pieces.local.data[source[:, 1]]
    r1, r2 = np.hypot(*first[:, 2:4].T), np.hypot(*second[:, 2:4].T)
    offset = second[:, :2] - first[:, :2]
    d = np.hypot(*offset.T)
    apart = np.maximum(d - (r1 + r2), np.abs(r1 - r2) - d)
    concentric = d <= np.finfo(float).eps * (r1 + r2)
    at = np.flatnonzero((apart <= snap) & ~concentric)
    if len(at) == 0:
        return pairs[:0], np.zeros((0, 2))
    first, second, offset = first[at], second[at], offset[at]
    r1, r2, d, apart, pairs = r1[at], r2[at], d[at], apart[at], pairs[at]
    axis = offset / d[:, None]
    normal = np.column_stack([-axis[:, 1], axis[:, 0]])
    foot = 0.5 * (d + (r1 - r2) * (r1 + r2) / d)
    # Heron's product keeps the digits where two circles nearly touch.
    product = (d + r1 + r2) * (r1 + r2 - d) * (d + r1 - r2) * (d - r1 + r2)
    height = np.sqrt(np.maximum(product, 0.0)) / (2 * d)
    # Where the circles miss, or overlap by, less than the snap distance, they touch in one vertex.
    touching = apart >= -snap
    foot = np.where(touching, np.where(d >= np.maximum(r1, r2), r1, np.sign(r1 - r2) * r1), foot)
    height = np.where(touching, 0.0, height)
    rows, ts = [], []
    for sign in (-1.0, 1.0):
        k = np.flatnonzero((height > 0) | (sign < 0))
        from_first = foot[k, None] * axis[k] + sign * height[k, None] * normal[k]
        from_second = from_first - offset[k]
        t1 = _turned_into(_angle_on(first[k], from_first), pieces, pairs[k, 0])
        t2 = _turned_into(_angle_on(second[k], from_second), pieces, pairs[k, 1])
        rows.append(pairs[k])
        ts.append(np.column_stack([t1, t2]))
    return np.concatenate(rows), np.concatenate(ts)


def _angle_on(arc: np.ndarray, direction: np.ndarray) -> np.ndarray:
    u, v = arc[:, 2:4], arc[:, 4:6]
    return np.arctan2((direction * v).sum(1), (direction * u).sum(1))


def _turned_into(theta: np.ndarray, pieces: Pieces, piece: np.ndarray) -> np.ndarray:
    """The representative of an angle that lies in, or nearest to, a piece's interval."""
    middle = 0.5 * (pieces.lo[piece] + pieces.hi[piece])
    return theta + 2 * np.pi * np.round((middle - theta) / (2 * np.pi))


def _ends_on(pieces: Pieces, pairs: np.ndarray, snap: float) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the first of each pair that lie on the second, if not at one of its own ends."""
    local = pieces.local
    i, j = pairs.T
    a, b = local.points(pieces.source, pieces.lo), local.points(pieces.source, pieces.hi)
    lo, hi = np.minimum(a, b) - snap, np.maximum(a, b) + snap
    rows, ts = [], []
    for end, t_end in ((a, pieces.lo), (b, pieces.hi)):
        p = end[i]
        inside = ((p >= lo[j]) & (p <= hi[j])).all(1)
        at_end = (p == a[j]).all(1) | (p == b[j]).all(1)
        at = np.flatnonzero(inside & ~at_end)
        t = project_pieces(pieces, j[at], p[at])
        rows.append(pairs[at])
        ts.append(np.column_stack([t_end[i[at]], t]))
    return np.concatenate(rows), np.concatenate(ts)


def project_pieces(pieces: Pieces, piece: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Parameters of the nearest points on pieces, in closed form for lines and circles."""
    source = pieces.source[piece]
    circle = pieces.local.is_circular()[source]
    t = np.empty(len(piece))
    at = np.flatnonzero(circle)
    arc = pieces.local.data[source[at]]
    t[at] = np.clip(
        _turned_into(_angle_on(arc, points[at] - arc[:, :2]), pieces, piece[at]),
        pieces.lo[piece[at]],
        pieces.hi[piece[at]],
    )
    at = np.flatnonzero(~circle)
    t[at] = pieces.local.project(source[at], points[at], pieces.lo[piece[at]], pieces.hi[piece[at]])
    return t

"""Convex hulls in the plane of lines and elliptic arcs, joined by exact common tangents."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from csgmesh.domain.curves import ARC, Curves

#: An arc is followed by so many samples a radian of its parameter: where two arcs compete for the
#: hull, what no sample sees stands out by less than 1e-7 of their size.
_SAMPLES = 400
#: Halvings of an interval of normals: down to the last digit.
_HALVINGS = 80
#: A corner this near to an ellipse, as a share of its size, lies on it.
_ON_ARC = 1e-11
#: How far, in radians, a tangent's normal may lie from that of the sampled hull.
_REACH = 0.05


@dataclass(frozen=True)
class _Item:
    """A stretch of the hull: a corner, or an ellipse seen between two normals (radians)."""

    point: tuple[float, float] | None
    curve: int = -1
    first: float = 0.0
    last: float = 0.0


def hull_of_curves(curves: Curves) -> Curves:
    """The convex hull's boundary, counterclockwise, as lines and arcs.

    Bézier curves count as the points where their pieces begin and end.
    """
    same = _ellipses(curves)
    points, owner = _samples(curves, same)
    order = _chain(points)
    if len(order) < 3:
        return Curves.empty()
    items = _items(curves, points[order], owner[order])
    while True:
        normals = [
            _tangent(curves, a, b) for a, b in zip(items, [*items[1:], items[0]], strict=True)
        ]
        stretched = _between(items, normals)
        hidden = [
            k for k, item in enumerate(stretched) if item.curve >= 0 and item.last < item.first
        ]
        if not hidden or len(items) < 2:
            return _outline(curves, stretched)
        # An arc that only a sample's rounding brought to the surface.
        items = [item for k, item in enumerate(items) if k != hidden[0]]


def _ellipses(curves: Curves) -> np.ndarray:
    """The first row with the same ellipse, -1 for what is no arc."""
    out = np.full(len(curves), -1)
    arcs = np.flatnonzero(curves.kind == ARC)
    if len(arcs):
        _, first, which = np.unique(
            curves.data[arcs, :6], axis=0, return_index=True, return_inverse=True
        )
        out[arcs] = arcs[first[which.reshape(-1)]]
    return out


def _samples(curves: Curves, same: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points of all curves; the ellipse that a point lies within, -1 for ends of curves."""
    ends = [curves.starts(), curves.ends()]
    owner = [np.full(2 * len(curves), -1)]
    inner = []
    for row in np.flatnonzero(curves.kind == ARC).tolist():
        t0, t1 = curves.interval[row]
        n = max(int(np.ceil(abs(t1 - t0) * _SAMPLES)), 2)
        t = t0 + (t1 - t0) * np.arange(1, n) / n
        inner.append(curves.points(np.full(n - 1, row), t))
        owner.append(np.full(n - 1, same[row]))
    points = np.concatenate([*ends, *inner])
    return points, np.concatenate(owner)


def _chain(points: np.ndarray) -> np.ndarray:
    """Numbers of the hull's corners, counterclockwise (Andrew 1979)."""
    # Of points at one place the sample of an arc goes first: an arc's own ends are no corners.
    order = np.lexsort((points[:, 1], points[:, 0]))
    extent = float(np.ptp(points, axis=0).max())
    flat = 1e-15 * extent * extent
    rows = points[order].tolist()

    def half(numbers: range) -> list[int]:
        kept: list[int] = []
        for k in numbers:
            x, y = rows[k]
            while len(kept) > 1:
                (ax, ay), (bx, by) = rows[kept[-2]], rows[kept[-1]]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > flat:
                    break
                kept.pop()
            kept.append(k)
        return kept[:-1]

    n = len(rows)
    return order[half(range(n)) + half(range(n - 1, -1, -1))]


def _items(curves: Curves, points: np.ndarray, owner: np.ndarray) -> list[_Item]:
    """Runs of samples of one ellipse become one item."""
    n = len(points)
    before, after = np.roll(owner, 1), np.roll(owner, -1)
    owner = owner.copy()
    for k in np.flatnonzero((owner < 0) & (before == after) & (before >= 0)).tolist():
        # A seam between two pieces of the ellipse, and no other shape's corner.
        if _normal_at(curves.data[before[k]], points[k]) is not None:
            owner[k] = before[k]
    starts = np.flatnonzero((owner != np.roll(owner, 1)) | (owner < 0))
    out = []
    for start, end in zip(starts, np.r_[starts[1:], starts[:1] + n], strict=True):
        if owner[start] < 0:
            out.append(_Item(tuple(points[start].tolist())))
            continue
        here, last = points[start], points[(end - 1) % n]
        ahead, behind = points[end % n] - last, here - points[start - 1]
        out.append(_Item(None, int(owner[start]), _normal(behind), _normal(ahead)))
    if not out:  # a single closed ellipse
        out.append(_Item(None, int(owner[0]), 0.0, 2.0 * np.pi))
    return out


def _normal(along: np.ndarray) -> float:
    return float(np.arctan2(-along[0], along[1]))


def _tangent(curves: Curves, a: _Item, b: _Item) -> float:
    """The normal, an angle, of the line that touches both items with everything on its left."""
    if a is b:
        return 2.0 * np.pi
    if a.point is not None and b.point is not None:
        return _normal(np.subtract(b.point, a.point))
    if a.point is None and a.curve == b.curve:
        return a.last
    for corner, arc in ((a, b), (b, a)):
        if corner.point is not None and arc.point is None:
            normal = _normal_at(curves.data[arc.curve], np.array(corner.point))
            if normal is not None:
                return normal
    middle = a.last if a.point is None else b.first
    low, high = middle - _REACH, middle + _REACH
    for _ in range(_HALVINGS):
        half = 0.5 * (low + high)
        if _support(curves, a, half) > _support(curves, b, half):
            low = half
        else:
            high = half
    return 0.5 * (low + high)


def _normal_at(ellipse: np.ndarray, point: np.ndarray) -> float | None:
    """The outward normal of an ellipse at a point on it, such as an arc's end; else None.

    There the supports of arc and corner touch and do not cross, so that no halving finds it.
    """
    axes = ellipse[2:6].reshape(2, 2).T
    q = np.linalg.solve(axes, point - ellipse[:2])
    if abs(np.hypot(*q) - 1.0) > _ON_ARC:
        return None
    x, y = np.linalg.solve(axes.T, q)
    return float(np.arctan2(y, x))


def _support(curves: Curves, item: _Item, angle: float) -> float:
    x, y = np.cos(angle), np.sin(angle)
    if item.point is not None:
        return float(item.point[0] * x + item.point[1] * y)
    cx, cy, ux, uy, vx, vy = curves.data[item.curve, :6].tolist()
    return float(cx * x + cy * y + np.hypot(ux * x + uy * y, vx * x + vy * y))


def _between(items: list[_Item], normals: list[float]) -> list[_Item]:
    """Each arc between the normals of the tangents before and after it."""
    if len(items) == 1:
        return items
    out = []
    for k, item in enumerate(items):
        first, last = normals[k - 1], normals[k]
        # An arc that is not really seen turns back a little.
        last = first + (last - first + 2.0 * _REACH) % (2.0 * np.pi) - 2.0 * _REACH
        out.append(replace(item, first=first, last=last))
    return out


def _outline(curves: Curves, items: list[_Item]) -> Curves:
    """Arcs and the lines between them."""
    pieces: list[tuple[int, np.ndarray, tuple[float, float]]] = []
    ends: list[tuple[np.ndarray, np.ndarray]] = []
    for item in items:
        if item.point is not None:
            ends.append((np.array(item.point), np.array(item.point)))
            continue
        data = curves.data[item.curve]
        u, v = data[2:4], data[4:6]
        left = u[0] * v[1] - u[1] * v[0] > 0.0
        angles = np.array([item.first, item.last])
        normal = np.column_stack([np.cos(angles), np.sin(angles)])
        t0, t1 = np.arctan2(normal @ v, normal @ u).tolist()
        turn = (t1 - t0) % (2.0 * np.pi) if left else -((t0 - t1) % (2.0 * np.pi))
        if item.last - item.first >= 2.0 * np.pi:
            turn = 2.0 * np.pi if left else -2.0 * np.pi
        pieces.append((len(ends), data, (t0, t0 + turn)))
        arc = Curves.arcs(data[None, :2], u[None], v[None], np.array([t0]), np.array([t0 + turn]))
        ends.append((arc.starts()[0], arc.ends()[0]))
    rows = {k: (data, interval) for k, data, interval in pieces}
    tables = []
    size = max(float(np.abs(e).max()) for pair in ends for e in pair)
    for k, (_, end) in enumerate(ends):
        if k in rows:
            tables.append(_quarters(*rows[k]))
        start = ends[(k + 1) % len(ends)][0]
        if len(ends) > 1 and np.abs(start - end).max() > 1e-13 * size:
            tables.append(Curves.lines(end[None], start[None]))
    return Curves.concatenate(tables)


def _quarters(data: np.ndarray, interval: tuple[float, float]) -> Curves:
    """An arc in pieces of at most a quarter turn, as those of disks are, from below π on."""
    t0, t1 = interval
    turns = 2.0 * np.pi * np.floor((min(t0, t1) + np.pi) / (2.0 * np.pi))
    n = max(int(np.ceil(abs(t1 - t0) / (0.5 * np.pi) - 1e-9)), 1)
    t = np.linspace(t0 - turns, t1 - turns, n + 1)
    row = np.zeros((n, 8))
    row[:, :6] = data[:6]
    return Curves(np.full(n, ARC, np.int8), row, np.column_stack([t[:-1], t[1:]]))

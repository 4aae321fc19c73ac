"""Where pieces of a triangulated boundary touch: one vertex instead of two, no vertex on a facet.

A boolean engine returns closed manifolds. Pieces that touch come as separate vertices at the same
place, as vertices inside another piece's edge or facet, and as flaps without thickness; none of
these is a piecewise linear complex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.errors import EvaluationError
from csgmesh.spatial import Boxes, near_pairs

#: Rounds of splitting after which touchings must be settled: each facet is split once a round.
_ROUNDS = 50


@dataclass(eq=False)
class Surface:
    """Points, triangles, what each triangle belongs to, and which points were moved how far."""

    points: np.ndarray
    triangles: np.ndarray
    surface: np.ndarray
    moved: list[tuple[int, float]]


def settle(points: np.ndarray, triangles: np.ndarray, surface: np.ndarray, snap: float) -> Surface:
    """Merge what is closer than `snap`, split what is touched, remove what has no thickness.

    Raises
    ------
    EvaluationError
        If it does not come to an end; with the place.
    """
    own = Surface(points, triangles, surface, [])
    _merge_points(own, snap)
    for _ in range(_ROUNDS):
        events = _touched(own, snap)
        _split(own, events)
        _cancel_flaps(own)
        if not events and not _unfold(own, snap):
            return own
    x, y, z = own.points[own.triangles[0, 0]] if not events else own.points[events[0][1]]
    raise EvaluationError(f"pieces of the boundary touch without end near ({x}, {y}, {z})")


def _merge_points(own: Surface, snap: float) -> None:
    pairs = near_pairs(own.points, snap)
    if not len(pairs):
        return
    root = list(range(len(own.points)))

    def find(v: int) -> int:
        while root[v] != v:
            root[v] = root[root[v]]
            v = root[v]
        return v

    for a, b in pairs.tolist():
        a, b = find(a), find(b)
        root[max(a, b)] = min(a, b)
    to = np.array([find(v) for v in range(len(root))])
    for v in np.flatnonzero(to != np.arange(len(to))).tolist():
        distance = float(np.sqrt(((own.points[v] - own.points[to[v]]) ** 2).sum()))
        own.moved.append((int(to[v]), distance))
    own.triangles = to[own.triangles]
    _cancel_flaps(own)


def _cancel_flaps(own: Surface) -> None:
    """Drop triangles with a point twice, and pairs that lie back to back."""
    t = own.triangles
    real = (t != np.roll(t, 1, axis=1)).all(axis=1)
    t, surface = t[real], own.surface[real]
    rank = np.sort(t, axis=1)
    # +1 for an even permutation of the sorted corners.
    turn = np.where(
        (t == rank).all(axis=1)
        | (t == rank[:, [1, 2, 0]]).all(axis=1)
        | (t == rank[:, [2, 0, 1]]).all(axis=1),
        1,
        -1,
    )
    order = np.lexsort((turn, *rank.T[::-1]))
    r, s = rank[order], turn[order]
    back = np.flatnonzero((r[1:] == r[:-1]).all(axis=1) & (s[1:] != s[:-1]))
    gone = np.zeros(len(t), bool)
    for k in back.tolist():
        if not gone[order[k]]:
            gone[order[k]] = gone[order[k + 1]] = True
    own.triangles, own.surface = t[~gone], surface[~gone]


def _touched(own: Surface, snap: float) -> list[tuple[int, int, int, float]]:
    """Facets with a point on them that is none of their corners: (facet, point, edge or -1, share).

    A facet is listed once, an edge by the lowest of its points for all facets around it.
    """
    corner = own.points[own.triangles]
    low, high = corner.min(axis=1) - snap, corner.max(axis=1) + snap
    used = np.unique(own.triangles)
    place = own.points[used]
    found = Boxes(low[:, :2], high[:, :2]).overlapping(place[:, :2], place[:, :2])
    at, facet = found.T
    height = place[at, 2]
    near = (height >= low[facet, 2]) & (height <= high[facet, 2])
    at, facet = at[near], facet[near]
    vertex = used[at]
    foreign = (own.triangles[facet] != vertex[:, None]).all(axis=1)
    at, facet, vertex = at[foreign], facet[foreign], vertex[foreign]
    p, c = own.points[vertex], corner[facet]
    on_edge = np.full(len(facet), -1)
    share = np.zeros(len(facet))
    for k in range(3):
        a, d = c[:, k], c[:, (k + 1) % 3] - c[:, k]
        along = ((p - a) * d).sum(axis=1) / (d * d).sum(axis=1)
        off = p - a - along[:, None] * d
        hit = ((off * off).sum(axis=1) <= snap * snap) & (along > 0.0) & (along < 1.0)
        on_edge = np.where(hit & (on_edge < 0), k, on_edge)
        share = np.where(hit & (on_edge == k), along, share)
    inside = (on_edge < 0) & _is_inside(p, c, snap)
    kept = np.flatnonzero((on_edge >= 0) | inside)
    rows = zip(
        facet[kept].tolist(), vertex[kept].tolist(), on_edge[kept].tolist(), share[kept].tolist(),
        strict=True,
    )  # fmt: skip
    return _one_an_edge(own.triangles, sorted(rows))


def _is_inside(p: np.ndarray, c: np.ndarray, snap: float) -> np.ndarray:
    """Which points lie on the plane of a triangle, within it."""
    normal = np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
    size = np.sqrt((normal * normal).sum(axis=1))
    result = np.abs(((p - c[:, 0]) * normal).sum(axis=1)) <= snap * size
    for k in range(3):
        d = c[:, (k + 1) % 3] - c[:, k]
        result &= (np.cross(d, p - c[:, k]) * normal).sum(axis=1) > 0.0
    return result & (size > 0.0)


def _one_an_edge(
    triangles: np.ndarray, rows: list[tuple[int, int, int, float]]
) -> list[tuple[int, int, int, float]]:
    """Choose points to split by so that all facets around an edge are split by the same one."""
    chosen: dict[tuple[int, int], int] = {}
    for facet, vertex, edge, _ in rows:
        if edge >= 0:
            chosen.setdefault(_edge(triangles, facet, edge), vertex)
    busy: set[int] = set()
    out = []
    for row in sorted(rows, key=lambda r: r[2] < 0):
        facet, vertex, edge, _ = row
        if facet in busy or (edge >= 0 and chosen[_edge(triangles, facet, edge)] != vertex):
            continue
        busy.add(facet)
        out.append(row)
    return out


def _edge(triangles: np.ndarray, facet: int, edge: int) -> tuple[int, int]:
    a, b = int(triangles[facet, edge]), int(triangles[facet, (edge + 1) % 3])
    return min(a, b), max(a, b)


def _unfold(own: Surface, snap: float) -> int:
    """Turn edges at which two facets lie back to back, and drop what then cancels; their number.

    Two facets folded onto each other are half of a tetrahedron without volume. Its other half takes
    their place, with less area, and at last lies back to back with its neighbours.
    """
    t = own.triangles
    edges = t[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    key = edges.min(axis=1) * len(own.points) + edges.max(axis=1)
    order = np.argsort(key, kind="stable")
    same = np.r_[False, np.diff(key[order]) == 0, False]
    pair = np.flatnonzero(same[1:-1] & ~same[:-2] & ~same[2:])
    one, two = order[pair], order[pair + 1]
    a, b = edges[one].T
    c, d = t.ravel()[_opposite(one)], t.ravel()[_opposite(two)]
    x, y, z = (own.points[v] - own.points[a] for v in (b, c, d))
    normal = np.cross(x, y)
    size = np.sqrt((normal * normal).sum(axis=1))
    flat = (np.abs((z * normal).sum(axis=1)) <= snap * size) & (size > 0.0)
    folded = np.flatnonzero(flat & ((np.cross(x, z) * normal).sum(axis=1) > 0.0) & (c != d))
    busy = np.zeros(len(t), bool)
    n_turned = 0
    for k in folded.tolist():
        first, second = int(one[k]) // 3, int(two[k]) // 3
        if busy[first] or busy[second]:
            continue
        busy[first] = busy[second] = True
        t[first], t[second] = (a[k], d[k], c[k]), (d[k], b[k], c[k])
        n_turned += 1
    _cancel_flaps(own)
    return n_turned


def _opposite(half_edge: np.ndarray) -> np.ndarray:
    """Where the corner opposite each of a triangle's edges stands."""
    return half_edge - half_edge % 3 + (half_edge + 2) % 3


def _split(own: Surface, events: list[tuple[int, int, int, float]]) -> None:
    if not events:
        return
    new, surface = [], []
    gone = np.zeros(len(own.triangles), bool)
    for facet, vertex, edge, _ in events:
        gone[facet] = True
        corners = own.triangles[facet].tolist()
        for k in range(3):
            if k != edge:
                new.append((corners[k], corners[(k + 1) % 3], vertex))
                surface.append(own.surface[facet])
    own.triangles = np.concatenate([own.triangles[~gone], np.array(new, np.int64).reshape(-1, 3)])
    own.surface = np.concatenate([own.surface[~gone], np.array(surface, np.int64)])

"""Where triangles touch: vertices on foreign edges and facets, edges that cross."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.neighbours import distinct
from csgmesh.boundary.sheet_table import Sheets


@dataclass(frozen=True, eq=False)
class Events:
    """Edges (k, 2) with the vertices to split them at, facets with vertices inside them."""

    edge: np.ndarray
    vertex: np.ndarray
    facet: np.ndarray
    inner: np.ndarray
    new_points: np.ndarray

    def __bool__(self) -> bool:
        return bool(len(self.edge) or len(self.facet))


def touched(
    sheets: Sheets, facet: np.ndarray, pairs: np.ndarray, snap: float
) -> tuple[Events, np.ndarray]:
    """Touchings among pairs of the given facets, and the facets that are involved in any."""
    points, n = sheets.points, len(sheets.points)
    triangles = sheets.triangles[facet]
    involved = np.zeros(len(sheets.triangles), bool)
    involved[facet[pairs.ravel()]] = True
    at, vertex = _meetings(triangles, pairs, n)
    edge, share, on, inside = _points_on(points, triangles, at, vertex, snap)
    caps = _caps(points, triangles, n, snap)
    involved[facet[caps[3]]] = True
    one, two, share_one, share_two, places = _crossings(sheets, triangles, pairs, snap)
    new = n + np.arange(len(places))
    edges = np.concatenate([edge, caps[0], one, two])
    shares = np.concatenate([share, caps[1], share_one, share_two])
    vertices = np.concatenate([vertex[on], caps[2], new, new])
    order = np.lexsort((vertices, np.abs(shares - 0.5).round(6), edges))
    first = order[np.r_[True, edges[order][1:] != edges[order][:-1]][: len(order)]]
    chosen = np.unique(vertices[first])
    used = chosen[chosen >= n]
    renumbered = np.arange(n + len(places))
    renumbered[used] = n + np.arange(len(used))
    inner_facet, inner = facet[at[inside]], vertex[inside]
    middle = points[sheets.triangles[inner_facet]].mean(axis=1)
    off = ((points[inner] - middle) ** 2).sum(axis=1)
    order = np.lexsort((inner, off, inner_facet))
    lone = order[np.r_[True, np.diff(inner_facet[order]) != 0][: len(order)]]
    events = Events(
        np.column_stack([edges[first] // n, edges[first] % n]),
        renumbered[vertices[first]],
        inner_facet[lone],
        inner[lone],
        places[used - n],
    )
    return events, involved


def _meetings(triangles: np.ndarray, pairs: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Facets and corners of the other facets of their pairs, each once."""
    key = distinct(
        np.concatenate([pairs[:, a, None] * n + triangles[pairs[:, 1 - a]] for a in (0, 1)]).ravel()
    )
    facet, vertex = key // n, key % n
    foreign = (triangles[facet] != vertex[:, None]).all(axis=1)
    return facet[foreign], vertex[foreign]


def _points_on(
    points: np.ndarray, triangles: np.ndarray, facet: np.ndarray, vertex: np.ndarray, snap: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Edges that vertices lie on, where, which rows these are; and which lie inside facets."""
    n, p, c = len(points), points[vertex], points[triangles[facet]]
    edge, share = np.full(len(facet), -1), np.zeros(len(facet))
    for k in range(3):
        tail, head = triangles[facet, k], triangles[facet, (k + 1) % 3]
        low, high = np.minimum(tail, head), np.maximum(tail, head)
        along, off = _along(p, points[low], points[high])
        hit = (edge < 0) & (off <= snap) & (along > 0.0) & (along < 1.0)
        edge = np.where(hit, low * n + high, edge)
        share = np.where(hit, along, share)
    normal = np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
    size = np.sqrt((normal * normal).sum(axis=1))
    inside = (edge < 0) & (np.abs(((p - c[:, 0]) * normal).sum(axis=1)) <= snap * size)
    for k in range(3):
        d = c[:, (k + 1) % 3] - c[:, k]
        inside &= (np.cross(d, p - c[:, k]) * normal).sum(axis=1) > 0.0
    on = np.flatnonzero(edge >= 0)
    return edge[on], share[on], on, np.flatnonzero(inside & (size > 0.0))


def _along(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where along the line from a to b the point nearest to p is, and its distance."""
    d = b - a
    along = ((p - a) * d).sum(axis=1) / np.maximum((d * d).sum(axis=1), 1e-300)
    off = p - a - along[:, None] * d
    return along, np.sqrt((off * off).sum(axis=1))


def _caps(
    points: np.ndarray, triangles: np.ndarray, n: int, snap: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Facets with a corner on the opposite edge: edge, share, corner, facet."""
    found = []
    for k in range(3):
        tail, head = triangles[:, k], triangles[:, (k + 1) % 3]
        low, high, tip = np.minimum(tail, head), np.maximum(tail, head), triangles[:, (k + 2) % 3]
        along, off = _along(points[tip], points[low], points[high])
        at = np.flatnonzero((off <= snap) & (along > 0.0) & (along < 1.0))
        found.append((low[at] * n + high[at], along[at], tip[at], at))
    edge, share, vertex, facet = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return edge, share, vertex, facet


def _diagonals(
    points: np.ndarray, triangles: np.ndarray, sheet: np.ndarray, wanted: np.ndarray, snap: float
) -> np.ndarray:
    """Those of the wanted edges, ``low * n + high``, that all sheets have inside flat parts.

    What is a diagonal of one sheet may be on the outline of another.
    """
    n = len(points)
    head = np.roll(triangles, -1, axis=1)
    key = np.minimum(triangles, head) * n + np.maximum(triangles, head)
    around = np.flatnonzero(np.isin(key, wanted).any(axis=1))
    triangles, key, sheet = triangles[around], key[around].ravel(), sheet[around]
    of_sheet = np.repeat(sheet, 3)
    order = np.lexsort((of_sheet, key))
    k, s = key[order], of_sheet[order]
    same = np.r_[False, (k[1:] == k[:-1]) & (s[1:] == s[:-1]), False]
    pair = np.flatnonzero(same[1:-1] & ~same[:-2] & ~same[2:])
    one, two = order[pair], order[pair + 1]
    corner = points[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    size = np.sqrt((normal * normal).sum(axis=1))
    # Facets folded onto each other are in one plane, too.
    level = (normal[one // 3] * normal[two // 3]).sum(axis=1) > 0.0
    for a, b in ((one, two), (two, one)):
        tip = points[triangles.ravel()[b - b % 3 + (b + 2) % 3]]
        height = ((tip - corner[a // 3, 0]) * normal[a // 3]).sum(axis=1)
        level &= np.abs(height) <= 2.0 * snap * size[a // 3]
    inside = np.concatenate([one[level], two[level]])
    outline = np.ones(len(key), bool)
    outline[inside] = False
    return np.setdiff1d(key[inside], key[outline])


def _crossings(
    sheets: Sheets, triangles: np.ndarray, pairs: np.ndarray, snap: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of edges, no diagonals, that cross: both edges, where along each, and the place."""
    points, n = sheets.points, len(sheets.points)
    met, number = np.unique(pairs, return_inverse=True)
    pairs, tail = number.reshape(-1, 2), triangles[met]
    head = np.roll(tail, -1, axis=1)
    edge = np.minimum(tail, head) * n + np.maximum(tail, head)
    names, number = np.unique(edge, return_inverse=True)
    number = number.reshape(-1, 3)
    one = np.repeat(number[pairs[:, 0]], 3, axis=1).ravel()
    two = np.tile(number[pairs[:, 1]], (1, 3)).ravel()
    k = len(names)
    key = distinct(np.minimum(one, two) * k + np.maximum(one, two))
    one, two = key // k, key % k
    ends = np.stack([names // n, names % n], axis=1)
    a, b = ends[one], ends[two]
    apart = (a[:, :, None] != b[:, None, :]).all(axis=(1, 2))
    one, two, a, b = one[apart], two[apart], a[apart], b[apart]
    p, q = points[a[:, 0]], points[b[:, 0]]
    u, v = points[a[:, 1]] - p, points[b[:, 1]] - q
    normal = np.cross(u, v)
    square = (normal * normal).sum(axis=1)
    close = np.abs(((q - p) * normal).sum(axis=1)) <= snap * np.sqrt(square)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (np.cross(q - p, v) * normal).sum(axis=1) / square
        t = (np.cross(q - p, u) * normal).sum(axis=1) / square
    hit = close & (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0)
    one, two, a, b, s, t = one[hit], two[hit], a[hit], b[hit], s[hit], t[hit]
    # Where an end lies on the other edge, that end is the place to split at.
    clear = np.ones(len(one), bool)
    for x, y in ((a, b), (b, a)):
        for end in (0, 1):
            along, off = _along(points[x[:, end]], points[y[:, 0]], points[y[:, 1]])
            clear &= (off > snap) | (along <= 0.0) | (along >= 1.0)
            for other in (0, 1):
                gap = points[x[:, end]] - points[y[:, other]]
                clear &= (gap * gap).sum(axis=1) > snap * snap
    found = np.unique(names[np.append(one[clear], two[clear])])
    diagonal = _diagonals(points, sheets.triangles, sheets.sheet(), found, snap)
    clear &= ~np.isin(names[one], diagonal) & ~np.isin(names[two], diagonal)
    one, two, a, b, s, t = one[clear], two[clear], a[clear], b[clear], s[clear], t[clear]
    place = 0.5 * (
        points[a[:, 0]] + s[:, None] * (points[a[:, 1]] - points[a[:, 0]])
        + points[b[:, 0]] + t[:, None] * (points[b[:, 1]] - points[b[:, 0]])
    )  # fmt: skip
    return names[one], names[two], s, t, place

"""Triangles from a file → a closed, oriented surface, repaired where that is safe, or refused."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.csg.flat_faces import neighbours
from csgmesh.domain.windings import winding_numbers
from csgmesh.errors import FileFormatError
from csgmesh.graphs import components
from csgmesh.spatial import near_pairs

#: Vertices this near, as a share of the extent, are one where edges would stay open otherwise:
#: files carry coordinates of seven digits.
_MERGED = 1e-6
#: A missing triangle or quad is filled if its edges together are no longer than this share of the
#: extent; a larger one may be meant.
_HOLE = 0.15


@dataclass(frozen=True)
class Soup:
    """Triangles as a file has them.

    Attributes
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int64
    group : (m,) int64
        The group, object or solid of the file that each triangle is in.
    """

    points: np.ndarray
    triangles: np.ndarray
    group: np.ndarray

    def of(self, rows: np.ndarray) -> Soup:
        """Some of the triangles, over the same points."""
        return Soup(self.points, self.triangles[rows], self.group[rows])


def repaired(soup: Soup, where: str) -> Soup:
    """A closed surface of the triangles, oriented outward.

    Vertices at one place are merged, triangles without three corners and repeated ones dropped,
    windings made consistent, small holes of three or four edges filled.

    Raises
    ------
    FileFormatError
        If edges stay open, more than two triangles share one, or nothing is enclosed.
    """
    if not np.isfinite(soup.points).all():
        raise FileFormatError(f"{where}: coordinates must be finite")
    soup = _clean(soup, *_merged(soup.points))
    _refuse_few(soup, where)
    if (_edge_counts(soup.triangles)[1] == 1).any():
        soup = _clean(soup, *_merged_near(soup.points))
        _refuse_few(soup, where)
        soup = _filled(soup)
    _refuse_open(soup, where)
    return _outward(_consistent(soup, where), where)


def _merged(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Different points in order of appearance, and the number of each given one."""
    _, first, number = np.unique(points + 0.0, axis=0, return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return points[np.sort(first)], rank[number.reshape(-1)]


def _merged_near(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    pairs = near_pairs(points, _MERGED * float(np.ptp(points, axis=0).max()))
    n, number = components(len(points), pairs[:, 0], pairs[:, 1])
    kept = np.empty((n, 3))
    kept[number[::-1]] = points[::-1]
    return kept, number


def _clean(soup: Soup, points: np.ndarray, number: np.ndarray) -> Soup:
    """Without triangles that have lost a corner, and with one of those that are repeated."""
    triangles = number[soup.triangles]
    real = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    triangles, group = triangles[real], soup.group[real]
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    first = np.sort(first)
    return Soup(points, triangles[first], group[first])


def _edge_counts(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.unique(edges, axis=0, return_counts=True)


def _filled(soup: Soup) -> Soup:
    """Holes of three or four edges closed, where they are small."""
    edges, count = _edge_counts(soup.triangles)
    around: dict[int, list[int]] = {}
    for a, b in edges[count == 1].tolist():
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    longest = _HOLE * float(np.ptp(soup.points, axis=0).max())
    added: list[list[int]] = []
    done: set[int] = set()
    for start in sorted(around):
        ring = _ring(start, around)
        if ring is None or start in done:
            continue
        done |= set(ring)
        corners = soup.points[ring]
        if np.sqrt(((corners - np.roll(corners, 1, axis=0)) ** 2).sum(axis=1)).sum() <= longest:
            added += [[ring[0], ring[k], ring[k + 1]] for k in range(1, len(ring) - 1)]
    if not added:
        return soup
    return Soup(
        soup.points,
        np.concatenate([soup.triangles, added]),
        np.r_[soup.group, np.full(len(added), soup.group[0])],
    )


def _ring(start: int, around: dict[int, list[int]]) -> list[int] | None:
    """The three or four points of a closed ring of open edges, None if it is longer or branches."""
    ring = [start]
    while len(ring) <= 4 and len(around[ring[-1]]) == 2:
        following = [v for v in around[ring[-1]] if v not in ring]
        if not following:
            return ring if len(ring) > 2 and start in around[ring[-1]] else None
        ring.append(following[0])
    return None


def _refuse_few(soup: Soup, where: str) -> None:
    if len(soup.triangles) < 4:
        raise FileFormatError(f"{where}: a solid needs four triangles; {len(soup.triangles)} found")


def _refuse_open(soup: Soup, where: str) -> None:
    edges, count = _edge_counts(soup.triangles)
    for wrong, what in (
        (count == 1, "belong to one triangle only"),
        (count > 2, "to three or more"),
    ):
        if wrong.any():
            a, b = soup.points[edges[wrong][0]]
            raise FileFormatError(
                f"{where}: each edge must belong to two triangles; {int(wrong.sum())} {what}, the "
                f"first from {_place(a)} to {_place(b)}"
            )


def _consistent(soup: Soup, where: str) -> Soup:
    """Triangles turned so that neighbours run along their common edge in opposite directions."""
    a, b, clash = _clashes(soup.triangles)
    if not clash.any():
        return soup
    # Twice the triangles: one copy as it is, one turned. Neighbours that agree join like copies,
    # those that clash join unlike ones; a surface that can be oriented falls into two halves.
    m = len(soup.triangles)
    same = np.where(clash, m, 0)
    left, right = np.r_[a, a + m], np.r_[b + same, b + m - same]
    _, half = components(2 * m, left, right)
    if (half[:m] == half[m:]).any():
        at = soup.points[soup.triangles[int(np.argmax(half[:m] == half[m:]))]].mean(axis=0)
        raise FileFormatError(f"{where}: the surface has one side only, near {_place(at)}")
    # Of each component's two halves the one that turns its first triangle is dropped.
    turned = half[:m] > half[m:]
    triangles = soup.triangles.copy()
    triangles[turned] = triangles[turned][:, ::-1]
    return _nested(Soup(soup.points, triangles, soup.group))


def _clashes(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of neighbours, and whether both run along their edge in the same direction."""
    directed = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges = np.sort(directed, axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    first, second = order[0::2], order[1::2]
    return first // 3, second // 3, directed[first, 0] == directed[second, 0]


def _nested(soup: Soup) -> Soup:
    """Shells outward, shells within them inward, and so on."""
    a, b = neighbours(soup.triangles)
    n_shells, shell = components(len(soup.triangles), a, b)
    triangles = soup.triangles.copy()
    depth = np.zeros(n_shells, np.int64)
    _, first = np.unique(shell, return_index=True)
    probes = soup.points[triangles[first, 0]]
    for k in range(n_shells) if n_shells > 1 else ():
        around = np.abs(winding_numbers(probes, soup.points, triangles[shell == k]))
        around[k] = 0
        depth += around
    for k in range(n_shells):
        own = np.flatnonzero(shell == k)
        if (_volume(soup.points, triangles[own]) > 0.0) != (depth[k] % 2 == 0):
            triangles[own] = triangles[own][:, ::-1]
    return Soup(soup.points, triangles, soup.group)


def _outward(soup: Soup, where: str) -> Soup:
    extent = float(np.ptp(soup.points, axis=0).max())
    volume = _volume(soup.points, soup.triangles)
    if abs(volume) <= 1e-12 * extent**3:
        raise FileFormatError(f"{where}: the surface must enclose a volume; it encloses none")
    if volume < 0.0:
        return Soup(soup.points, soup.triangles[:, ::-1].copy(), soup.group)
    return soup


def _volume(points: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (points[triangles[:, k]] - points[triangles[0, 0]] for k in range(3))
    return float((a * np.cross(b, c)).sum()) / 6.0


def _place(point: np.ndarray) -> str:
    return f"({', '.join(f'{x:.6g}' for x in point)})"

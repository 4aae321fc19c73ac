"""Facets that have turned over on the way to the exact surfaces are put right.

Facets meet one another a little beside the curve in which their exact surfaces do. A vertex of
theirs between the two is on the wrong side of the curve once vertices lie on the exact surfaces:
facets around it have turned over, and cross their neighbours. Such a vertex slides on its own
surface to where all facets around it look outwards; where none of that helps, edges of the facet
are contracted or flipped.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.patchwork import Patchwork, Row
from csgmesh.domain.surfaces import Surfaces
from csgmesh.graphs import components

#: Facets around those that have turned over that may change, or tell which side is outside.
_RINGS = 4
#: How often what is left is gone through.
_ROUNDS = 8
#: Cosine of the angle with the exact normal below which a facet counts as turned over: chords
#: as fine as the deviation asks for stay far above it.
_UPRIGHT = 0.6
#: A change has to make the heights of what is turned over together less by this factor; but a
#: contraction, of which there can only be so many, may make them more by the other one.
_BETTER, _NO_WORSE = 0.9, 2.0


@dataclass(frozen=True)
class _Change:
    """What to try: facets that go, facets that change, or a vertex and its new place."""

    around: list[int]
    gone: list[int]
    new: list[tuple[int, Row]]
    vertex: int = -1
    place: np.ndarray | None = None
    way: float = 0.0


@dataclass(frozen=True)
class Untangled:
    """Points, and triangles with the rows of those that they were."""

    points: np.ndarray
    triangles: np.ndarray
    parent: np.ndarray


def untangled(
    before: np.ndarray,
    after: np.ndarray,
    triangles: np.ndarray,
    surface: np.ndarray,
    belongings: np.ndarray,
    surfaces: Surfaces,
) -> Untangled:
    """Mend the triangles that motions of their vertices have turned over.

    Parameters
    ----------
    before, after : (n, 3) float64
        `after` on the exact surfaces.
    triangles : (m, 3) int64
    surface : (m,) int64
        Into `surfaces`.
    belongings : (m, k) int64
        Triangles beside an edge are of one patch where surface and belongings are the same.
    surfaces : Surfaces

    What cannot be mended stays as it is.
    """
    whole = Untangled(after, triangles, np.arange(len(triangles)))
    one, two = (_areas(points[triangles]) for points in (before, after))
    turned = np.flatnonzero((one * two).sum(axis=1) <= 0.0)
    if not len(turned):
        return whole
    near = np.zeros(len(after), bool)
    near[triangles[turned]] = True
    for _ in range(_RINGS - 1):
        near[triangles[near[triangles].any(axis=1)]] = True
    here = np.flatnonzero(near[triangles].any(axis=1))
    used, local = np.unique(triangles[here], return_inverse=True)
    key = np.column_stack([surface, belongings])[here]
    _, patch = np.unique(key, axis=0, return_inverse=True)
    work = _Untangling(
        after[used], local.reshape(-1, 3), surface[here], patch.reshape(-1), near[used], surfaces
    )
    work.run()
    rows = work.patches.rows
    kept = np.ones(len(triangles), bool)
    kept[here] = [t in rows for t in range(len(here))]
    points, out = after.copy(), triangles.copy()
    points[used] = work.points
    numbers = sorted(rows)
    out[here[numbers]] = used[np.array([rows[t] for t in numbers])]
    return Untangled(points, out[kept], np.flatnonzero(kept))


def _areas(corner: np.ndarray) -> np.ndarray:
    # By components: few triangles are asked for at a time, and `numpy.cross` takes its time.
    (a, b, c), (d, e, f) = ((corner[:, k] - corner[:, 0]).T for k in (1, 2))
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d], axis=1)


class _Untangling:
    """Facets around those that have turned over, as they change."""

    def __init__(
        self,
        points: np.ndarray,
        triangles: np.ndarray,
        surface: np.ndarray,
        patch: np.ndarray,
        is_whole: np.ndarray,
        surfaces: Surfaces,
    ) -> None:
        self.points, self.surface, self.surfaces = points, surface, surfaces
        self.patches = Patchwork(triangles, patch, is_whole)
        # Changes are small beside the surfaces' radii: a facet keeps its normal as it changes.
        corner = points[triangles]
        normal = surfaces.normals(surface, corner.mean(axis=1))
        self.outward = _sides(triangles, patch, is_whole, _areas(corner), normal)[:, None] * normal

    def run(self) -> None:
        """Mend what can be, one facet after the other."""
        for _ in range(_ROUNDS):
            rows = self.patches.rows
            facet = np.array(sorted(rows))
            corner = self.points[np.array([rows[t] for t in facet.tolist()])]
            todo = facet[self._ill(facet, corner) > 0.0].tolist()
            done = [self._mend(t) for t in todo if t in rows and self._total([t]) > 0.0]
            if not any(done):
                break

    def _mend(self, t: int) -> bool:
        """Do what helps most to a facet, with the least motion; whether anything does."""
        # What leaves something to do comes last; otherwise the least motion is best.
        judged: list[tuple[bool, float, int, _Change]] = []
        for changes in (self._slides(t), self._contractions(t), self._flips(t)):
            for change in changes:
                worth = self._judged(change)
                if worth is not None:
                    judged.append((worth > 0.0, change.way, len(judged), change))
            if any(not is_half_done for is_half_done, *_ in judged):
                break
        if not judged:
            return False
        change = min(judged, key=lambda entry: entry[:3])[3]
        self.patches.replace(change.gone, change.new)
        if change.place is not None:
            self.points[change.vertex] = change.place
        return True

    def _judged(self, change: _Change) -> float | None:
        """Heights of the facets that are turned over then; None where that is no progress."""
        old = self._total(change.around)
        rows = change.new or [(t, self.patches.rows[t]) for t in change.around]
        facet, row = np.array([t for t, _ in rows]), np.array([row for _, row in rows])
        corner = self.points[row]
        if change.place is not None:
            corner[row == change.vertex] = change.place
        new = float(self._ill(facet, corner).sum())
        is_less = new < _BETTER * old or (bool(change.gone) and new < _NO_WORSE * old)
        return new if is_less else None

    def _total(self, facets: list[int]) -> float:
        rows = np.array([self.patches.rows[t] for t in facets])
        return float(self._ill(np.array(facets), self.points[rows]).sum())

    def _ill(self, facet: np.ndarray, corner: np.ndarray) -> np.ndarray:
        """Heights of facets that are turned over, 0 for the others, (k,)."""
        area = _areas(corner)
        upright = (area * self.outward[facet]).sum(axis=1)
        size = np.sqrt((area**2).sum(axis=1))
        side = np.sqrt(((corner - corner[:, [1, 2, 0]]) ** 2).sum(axis=2)).max(axis=1)
        least = np.finfo(float).tiny
        height = np.maximum(np.abs(upright) / np.maximum(side, least), least)
        return np.where(upright > _UPRIGHT * size, 0.0, height)

    def _slides(self, t: int) -> Iterator[_Change]:
        for v in self.patches.rows[t]:
            if not self.patches.is_inside(v):
                continue
            star = self.patches.star(v)
            for place in self._places(v, star):
                way = float(np.sqrt(((place - self.points[v]) ** 2).sum()))
                yield _Change(star, [], [], v, place, way)

    def _contractions(self, t: int) -> Iterator[_Change]:
        for v in self.patches.rows[t]:
            for w in self.patches.neighbours(v):
                new = self.patches.contracted(v, w)
                if new is not None:
                    way = float(np.sqrt(((self.points[v] - self.points[w]) ** 2).sum()))
                    gone = self.patches.beside(v, w)
                    yield _Change(self.patches.star(v), gone, new, way=way)

    def _flips(self, t: int) -> Iterator[_Change]:
        row = self.patches.rows[t]
        for k in range(3):
            new = self.patches.flipped(row[k], row[(k + 1) % 3])
            if new is not None:
                yield _Change([number for number, _ in new], [], new)

    def _places(self, v: int, star: list[int]) -> np.ndarray:
        """Places on the surface where a vertex might see its star's rim from inside, (k, 3)."""
        rows = np.array([self.patches.rows[t] for t in star])
        at = np.argmax(rows == v, axis=1)[:, None]
        place = self.points[v]
        frame = _frame(self.outward[star[0]])
        tail, head = (
            (self.points[np.take_along_axis(rows, (at + k) % 3, axis=1)[:, 0]] - place) @ frame.T
            for k in (1, 2)
        )
        found = [tail.mean(axis=0)]
        kernel = _kernel(tail, head)
        if len(kernel):
            found.append(kernel.mean(axis=0))
        flat = place + np.array(found) @ frame
        return self.surfaces.project(np.full(len(flat), self.surface[star[0]]), flat)


def _sides(
    triangles: np.ndarray,
    patch: np.ndarray,
    is_whole: np.ndarray,
    area: np.ndarray,
    normal: np.ndarray,
) -> np.ndarray:
    """1 where facets look along the normals of their surfaces, -1 against them, (m,).

    Most of the area of a face says it for all of the face.
    """
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    edge = np.minimum(start, end) * (int(triangles.max()) + 1) + np.maximum(start, end)
    order = np.argsort(edge, kind="stable")
    first = np.flatnonzero(np.diff(edge[order], prepend=-1))
    first = first[np.diff(first, append=len(edge)) == 2]
    one, two = order[first] // 3, order[first + 1] // 3
    # Of edges between vertices that are not whole there may be more facets elsewhere.
    start, end = start[order[first]], end[order[first]]
    inner = (patch[one] == patch[two]) & (is_whole[start] | is_whole[end])
    _, face = components(len(triangles), one[inner], two[inner])
    total = np.bincount(face, (area * normal).sum(axis=1))
    return np.where(total < 0.0, -1.0, 1.0)[face]


def _frame(normal: np.ndarray) -> np.ndarray:
    """Two unit vectors at right angles with a normal and each other, counterclockwise, (2, 3)."""
    first = np.eye(3)[np.argmin(np.abs(normal))]
    first = first - (first @ normal) * normal
    first /= np.sqrt(first @ first)
    return np.array([first, np.cross(normal, first)])


def _kernel(tail: np.ndarray, head: np.ndarray) -> np.ndarray:
    """Corners of the part of the plane to the left of all edges, (k, 2)."""
    along = head - tail
    length = np.sqrt((along**2).sum(axis=1))
    kept = length > 0.0
    inward = np.column_stack([-along[kept, 1], along[kept, 0]]) / length[kept, None]
    least = (inward * tail[kept]).sum(axis=1)
    i, j = np.triu_indices(len(inward), 1)
    turn = inward[i, 0] * inward[j, 1] - inward[i, 1] * inward[j, 0]
    crossing = np.abs(turn) > 1e-9
    i, j, turn = i[crossing], j[crossing], turn[crossing]
    x = (least[i] * inward[j, 1] - least[j] * inward[i, 1]) / turn
    y = (inward[i, 0] * least[j] - inward[j, 0] * least[i]) / turn
    corner = np.column_stack([x, y])
    slack = 1e-12 * length.max(initial=0.0)
    return corner[(corner @ inward.T >= least - slack).all(axis=1)]

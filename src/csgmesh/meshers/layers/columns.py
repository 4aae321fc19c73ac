"""Columns of layer vertices over the vertices of a wall: where they stand and where they point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from csgmesh.domain.curves import cross
from csgmesh.domain.names import find_markers
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import InputError, MeshingError
from csgmesh.meshers.layers.options import Layers
from csgmesh.meshers.subdivision import Subdivision, subdivide
from csgmesh.size.resolve import ResolvedSize, evaluate

#: A wall that turns away from the domain by more than this many degrees gets a fan of columns,
#: turned by about so much from one to the next.
FAN = 50.0
FAN_STEP = 35.0
#: Angles between the end of a wall and the boundary beside it up to which a column slides on that
#: boundary, degrees; beyond, layers shrink to nothing.
SLIDING = 135.0
#: Edges along a wall across the domain's diagonal, where no size says how many.
BY_DEFAULT = 40
#: Largest lengthening of a column at a corner, over the height of the layers.
LONGEST = 1.5


@dataclass(eq=False)
class Column:
    """Vertices over one vertex of a wall.

    Attributes
    ----------
    vertex : int
        Point of the subdivision at its foot.
    direction : (2,)
        From the foot to the tip, unit length.
    height : float
    beside : int
        Segment of the subdivision on which it slides, -1 for none.
    is_away : bool
        Whether that segment leaves the foot, or ends there.
    room : float
        Length that there is for it, at most.
    shares : (n + 1,)
        Heights of its vertices as shares of its own.
    """

    vertex: int
    direction: np.ndarray
    height: float
    beside: int = -1
    is_away: bool = True
    room: float = np.inf
    shares: np.ndarray = field(default_factory=lambda: np.zeros(0))


@dataclass(eq=False)
class Walls:
    """Columns in rows along the walls.

    Attributes
    ----------
    pieces : Subdivision
        The domain's segments, those of walls cut into pieces of the wanted size.
    wall : (w,) int64
        Wall pieces, as numbers of the subdivision.
    columns : list of Column
    strips : list of (first column, second column, wall piece)
        Neighbours; within a fan -1 less the wall piece before it.
    """

    domain: Pslg
    pieces: Subdivision
    wall: np.ndarray
    columns: list[Column]
    strips: list[tuple[int, int, int]]


def raise_columns(domain: Pslg, layers: Mapping[str, Layers], size: ResolvedSize | None) -> Walls:
    """Columns over all walls."""
    spec = np.full(domain.n_segments, -1)
    listed = list(layers.values())
    for k, name in enumerate(layers):
        spec[np.isin(domain.segment_marker, find_markers(name, domain.boundary_names))] = k
    inner = np.flatnonzero((spec >= 0) & (domain.segment_region[:, 1] >= 0))
    if len(inner):
        x, y = domain.points[domain.segments[inner[0]]].mean(axis=0)
        raise InputError(
            "layers grow along outer boundaries; "
            f"{domain.boundary_names[domain.segment_marker[inner[0]]][0]!r} at ({x:.6g}, {y:.6g}) "
            "lies between two regions"
        )
    pieces = subdivide(domain, np.where(spec >= 0, _counts(domain, size), 1))
    builder = _Builder(domain, pieces, spec, listed)
    builder.build()
    return Walls(domain, pieces, builder.wall, builder.columns, builder.strips)


def _counts(domain: Pslg, size: ResolvedSize | None) -> np.ndarray:
    """Pieces of each segment along walls."""
    length = domain.lengths()
    wanted = np.full(domain.n_segments, domain.diagonal / BY_DEFAULT)
    if size is not None:
        middle = domain.points[domain.segments].mean(axis=1)
        found = np.full(domain.n_segments, np.inf)
        if size.default is not None:
            found = np.minimum(found, evaluate(size.default, middle))
        for markers, source in size.boundary:
            on = np.isin(domain.segment_marker, markers)
            found[on] = np.minimum(found[on], evaluate(source, middle[on]))
        wanted = np.where(np.isfinite(found), found, wanted)
    return np.maximum(np.ceil(length / wanted - 0.2), 1).astype(np.int64)


class _Builder:
    def __init__(
        self, domain: Pslg, pieces: Subdivision, spec: np.ndarray, layers: list[Layers]
    ) -> None:
        self.domain, self.pieces, self.layers = domain, pieces, layers
        self.points = pieces.points
        self.ends = pieces.ends
        own = spec[pieces.segment]
        self.spec = own
        self.wall = np.flatnonzero(own >= 0)
        self.columns: list[Column] = []
        self.strips: list[tuple[int, int, int]] = []
        self.slides: dict[tuple[int, int], int] = {}
        self.leaving, self.arriving = _tangents(domain, pieces)
        at = np.concatenate([self.ends[:, 0], self.ends[:, 1]])
        order = np.argsort(at, kind="stable")
        self.around = order % len(self.ends)
        self.starts_here = order < len(self.ends)
        self.first = np.searchsorted(at[order], np.arange(len(self.points) + 1))

    def build(self) -> None:
        """Columns at the ends of each wall piece, and the strips between them."""
        after: dict[int, int] = {}
        before: dict[int, int] = {}
        is_wall = self.spec >= 0
        starts = {int(self.ends[k, 0]): int(k) for k in self.wall}
        for k in self.wall.tolist():
            v = int(self.ends[k, 1])
            n = starts.get(v, -1)
            if n >= 0 and self.first[v + 1] - self.first[v] == 2 and is_wall[n]:
                after[k], before[n] = n, k
        first: dict[int, int] = {}
        last: dict[int, int] = {}
        for k in self.wall.tolist():
            if k not in before:
                first[k] = self._end(k, at_start=True)
            if k in after:
                row = self._between(k, after[k])
                last[k], first[after[k]] = row[0], row[-1]
                self.strips += [(a, b, -1 - k) for a, b in pairwise(row)]
            else:
                last[k] = self._end(k, at_start=False)
        self.strips += [(first[k], last[k], k) for k in self.wall.tolist()]

    def _height(self, *pieces: int) -> float:
        return float(np.mean([self.layers[self.spec[k]].heights()[-1] for k in pieces]))

    def _add(self, column: Column, *pieces: int) -> int:
        heights = [self.layers[self.spec[k]].heights() for k in pieces]
        column.shares = np.mean([h / h[-1] for h in heights], axis=0)
        self.columns.append(column)
        return len(self.columns) - 1

    def _stretch(self, piece: int, is_away: bool) -> float:
        """Length of the boundary from a piece on, as far as it is the same curve by name."""
        segment, total, k = self.pieces.segment, 0.0, piece
        what = self.domain.segment_curve, self.domain.segment_marker
        while True:
            total += self._length(k)
            v = int(self.ends[k, 1 if is_away else 0])
            near = self.around[self.first[v] : self.first[v + 1]]
            if len(near) != 2 or what[0][segment[k]] < 0:
                return total
            other = int(near[0] if near[1] == k else near[1])
            if other == piece or any(w[segment[k]] != w[segment[other]] for w in what):
                return total
            k = other

    def _between(self, k: int, n: int) -> list[int]:
        """Columns at a vertex between two wall pieces: one, or a fan."""
        u, v = self.arriving[k], self.leaving[n]
        turn = float(np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v))
        height, vertex = self._height(k, n), int(self.ends[k, 1])
        normal = np.array([-u[1], u[0]])
        if turn < -np.radians(FAN):
            steps = int(np.ceil(-turn / np.radians(FAN_STEP)))
            return [self._add(Column(vertex, _rotated(normal, turn * i / steps), height), k, n)
                    for i in range(steps + 1)]  # fmt: skip
        stretch = min(1.0 / max(np.cos(0.5 * turn), 0.1), LONGEST)
        room = np.inf
        if turn > 0:
            # The tip stays over the nearer half of the shorter of the two pieces.
            room = 0.45 * min(self._length(k), self._length(n)) / max(np.sin(0.5 * turn), 1e-9)
        column = Column(vertex, _rotated(normal, 0.5 * turn), height * stretch, room=room)
        return [self._add(column, k, n)]

    def _length(self, k: int) -> float:
        return float(np.hypot(*(self.points[self.ends[k, 1]] - self.points[self.ends[k, 0]])))

    def _end(self, k: int, at_start: bool) -> int:
        """The column at an end of a wall: on the boundary beside it, or without height."""
        vertex = int(self.ends[k, 0 if at_start else 1])
        along = self.leaving[k] if at_start else -self.arriving[k]
        best, angle, is_away = -1, 2 * np.pi, True
        for i in range(self.first[vertex], self.first[vertex + 1]):
            other, away = int(self.around[i]), bool(self.starts_here[i])
            if other == k:
                continue
            d = self.leaving[other] if away else -self.arriving[other]
            opening = float(np.arctan2(along[0] * d[1] - along[1] * d[0], along @ d))
            opening = (opening if at_start else -opening) % (2 * np.pi)
            if opening < angle:
                best, angle, is_away = other, opening, away
        if best < 0:
            raise MeshingError("a wall must be part of a closed boundary")
        if self.spec[best] >= 0 or angle > np.radians(SLIDING):
            normal = np.array([-along[1], along[0]]) * (1 if at_start else -1)
            return self._add(Column(vertex, normal, 0.0, room=0.0), k)
        if (vertex, best) in self.slides:
            return self.slides[vertex, best]
        height = self._height(k) / max(np.sin(angle), 1.0 / LONGEST)
        room = 0.45 * self._stretch(best, is_away)
        if angle < np.pi / 2:
            room = min(room, 0.45 * self._length(k) / max(np.cos(angle), 1e-9))
        d = self.leaving[best] if is_away else -self.arriving[best]
        number = self._add(Column(vertex, d, height, best, is_away, room), k)
        self.slides[vertex, best] = number
        return number


def _rotated(v: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * v[0] - s * v[1], s * v[0] + c * v[1]])


def _tangents(domain: Pslg, pieces: Subdivision) -> tuple[np.ndarray, np.ndarray]:
    """Unit tangents of the exact curves at the start and the end of each piece."""
    chord = pieces.points[pieces.ends[:, 1]] - pieces.points[pieces.ends[:, 0]]
    out = []
    curve = domain.segment_curve[pieces.segment]
    bent = np.flatnonzero(curve >= 0)
    sign = np.sign(pieces.interval[bent, 1] - pieces.interval[bent, 0])
    for end in (0, 1):
        d = chord.copy()
        if len(bent):
            d[bent] = domain.curves.derivatives(curve[bent], pieces.interval[bent, end])
            d[bent] *= sign[:, None]
            still = bent[~d[bent].any(axis=1)]
            d[still] = chord[still]
        out.append(d / np.hypot(*d.T)[:, None])
    return out[0], out[1]


def first_met(points: np.ndarray, ends: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """How far along each ray (k, 2, 2) the first segment is, as a share; infinite for none.

    Segments with an end at the ray's start do not count.
    """
    from csgmesh.spatial import Boxes

    out = np.full(len(rays), np.inf)
    chord = points[ends]
    pairs = Boxes(chord.min(axis=1), chord.max(axis=1)).overlapping(
        rays.min(axis=1), rays.max(axis=1)
    )
    ray, k = pairs.T
    p, r = rays[ray, 0], rays[ray, 1] - rays[ray, 0]
    a, s = chord[k, 0], chord[k, 1] - chord[k, 0]
    det = cross(r, s)
    with np.errstate(divide="ignore", invalid="ignore"):
        t, u = cross(a - p, s) / det, cross(a - p, r) / det
    apart = (chord[k] != p[:, None]).any(axis=2).all(axis=1)
    hit = apart & (det != 0) & (t > 0) & (u >= -1e-9) & (u <= 1 + 1e-9)
    np.minimum.at(out, ray[hit], t[hit])
    return out

"""The boundary of a domain as loops of exact curve pieces, and the faces that they bound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from csgmesh.domain.curves import Curves
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import MeshingError

#: Where a boundary turns by more than this many degrees it has a corner.
CORNER = 30.0
#: Samples a curve piece for the inverse of its arc length.
SAMPLES = 129


@dataclass(frozen=True)
class Part:
    """A stretch of one exact curve, directed.

    Attributes
    ----------
    curve : int
        In the table of the outline.
    t0, t1 : float
        Parameters at its start and end.
    marker : int
        Of the domain's boundary names; -1 inside the domain.
    sides : tuple of int
        Regions on the left and the right, as the part runs.
    """

    curve: int
    t0: float
    t1: float
    marker: int = -1
    sides: tuple[int, int] = (-1, -1)

    def reversed(self) -> Part:
        """The same, run the other way."""
        return Part(self.curve, self.t1, self.t0, self.marker, self.sides[::-1])

    def cut(self, t0: float, t1: float) -> Part:
        """What lies between two parameters."""
        return Part(self.curve, t0, t1, self.marker, self.sides)


def turned(parts: Sequence[Part]) -> tuple[Part, ...]:
    """Parts in a row, run the other way."""
    return tuple(part.reversed() for part in reversed(parts))


class Outline:
    """Curves of a domain, joined to the longest stretches of one curve, name and pair of regions.

    Attributes
    ----------
    domain : Pslg
    curves : Curves
        The domain's, then lines for segments without a curve; meshers append to them.
    n_curves : int
        How many of them are the domain's.
    faces : list of Face
    """

    def __init__(self, domain: Pslg) -> None:
        self.domain = domain
        self.n_curves = len(domain.curves)
        _refuse_embedded(domain)
        straight = np.flatnonzero(domain.segment_curve < 0)
        ends = domain.points[domain.segments[straight]]
        self.curves = Curves.concatenate([domain.curves, Curves.lines(ends[:, 0], ends[:, 1])])
        self.curve = domain.segment_curve.copy()
        self.interval = domain.segment_interval.copy()
        self.curve[straight] = self.n_curves + np.arange(len(straight))
        self.interval[straight] = [0.0, 1.0]
        self.vertex: dict[tuple[int, float], int] = {}
        for (curve, (t0, t1)), (a, b) in zip(
            zip(self.curve.tolist(), self.interval.tolist(), strict=True),
            domain.segments.tolist(),
            strict=True,
        ):
            self.vertex[curve, t0] = a
            self.vertex[curve, t1] = b
        self.faces = _faces(self, _stretches(self))

    def add(self, curves: Curves) -> int:
        """Append a curve; its number."""
        self.curves = Curves.concatenate([self.curves, curves])
        return len(self.curves) - 1

    def line(self, p: np.ndarray, q: np.ndarray) -> Part:
        """A straight part inside the domain."""
        return Part(self.add(Curves.lines(p[None], q[None])), 0.0, 1.0)

    def point(self, curve: int, t: float) -> np.ndarray:
        """A point of a curve: the domain's own, to the last bit, where it has one there."""
        number = self.vertex.get((curve, t), -1)
        if number >= 0:
            return self.domain.points[number]
        return self.curves.points(np.array([curve]), np.array([t]))[0]

    def heading(self, part: Part, at_end: bool) -> np.ndarray:
        """Unit tangent at the start or the end of a part, in its direction."""
        t = part.t1 if at_end else part.t0
        d = self.curves.derivatives(np.array([part.curve]), np.array([t]))[0]
        if not d.any():
            d = (self.point(part.curve, part.t1) - self.point(part.curve, part.t0)) * np.sign(
                part.t1 - part.t0
            )
        return d * np.sign(part.t1 - part.t0) / max(np.hypot(*d), np.finfo(float).tiny)

    def sampled(self, part: Part, n: int = SAMPLES) -> tuple[np.ndarray, np.ndarray]:
        """Parameters of a part, and the arc length up to each, (n,)."""
        t = np.linspace(part.t0, part.t1, n)
        curve = np.full(n - 1, part.curve)
        return t, np.concatenate([[0.0], np.cumsum(self.curves.lengths(curve, t[:-1], t[1:]))])


class Loop:
    """A closed row of parts, with the face it bounds on the left."""

    def __init__(self, outline: Outline, parts: Sequence[Part]) -> None:
        self.outline = outline
        self.parts = tuple(parts)
        samples = [outline.sampled(part) for part in parts]
        self.t = [t for t, _ in samples]
        self.s = [s for _, s in samples]
        self.start = np.concatenate([[0.0], np.cumsum([s[-1] for s in self.s])])
        self.key = frozenset(part.curve for part in parts), round(self.length, 12)
        points = [
            outline.curves.points(np.full(SAMPLES, part.curve), t)[:-1]
            for part, t in zip(parts, self.t, strict=True)
        ]
        self.polygon = np.concatenate(points)

    @property
    def length(self) -> float:
        """Arc length all the way round."""
        return float(self.start[-1])

    @property
    def area(self) -> float:
        """Area inside, positive when the loop runs counterclockwise."""
        p = self.polygon - self.polygon.mean(axis=0)
        q = np.roll(p, -1, axis=0)
        return float(0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())

    def turns(self) -> np.ndarray:
        """Turn at the start of each part in degrees, positive to the left."""
        out = []
        for before, after in zip((self.parts[-1], *self.parts[:-1]), self.parts, strict=True):
            u, v = self.outline.heading(before, True), self.outline.heading(after, False)
            out.append(np.degrees(np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v)))
        return np.array(out)

    def corners(self) -> list[float]:
        """Places of the corners, as arc lengths."""
        return [float(s) for s, turn in zip(self.start, self.turns(), strict=False)
                if abs(turn) > CORNER]  # fmt: skip

    def nearest(self, point: np.ndarray) -> tuple[float, float]:
        """Place of the nearest point, as arc length, and its distance."""
        best = (0.0, np.inf)
        for k, part in enumerate(self.parts):
            lo, hi = sorted((part.t0, part.t1))
            t = self.outline.curves.project(
                np.array([part.curve]), point[None], np.array([lo]), np.array([hi])
            )
            found = self.outline.curves.points(np.array([part.curve]), t)[0]
            away = float(np.hypot(*(found - point)))
            if away < best[1]:
                sign = 1.0 if part.t1 > part.t0 else -1.0
                s = float(np.interp(sign * t[0], sign * self.t[k], self.s[k]))
                best = (float(self.start[k] + s) % self.length, away)
        return best

    def place_of(self, s: float) -> tuple[int, float]:
        """Part and parameter at an arc length."""
        s = s % self.length
        k = int(np.searchsorted(self.start, s, side="right")) - 1
        k = min(k, len(self.parts) - 1)
        return k, float(np.interp(s - self.start[k], self.s[k], self.t[k]))

    def between(self, s0: float, s1: float) -> tuple[Part, ...]:
        """Parts from one arc length to another, all the way round if they are the same."""
        (i, t), (j, u) = self.place_of(s0), self.place_of(s1)
        if i == j and (self.parts[i].t1 - self.parts[i].t0) * (u - t) > 0:
            return (self.parts[i].cut(t, u),)
        out = [self.parts[i].cut(t, self.parts[i].t1)]
        k = (i + 1) % len(self.parts)
        while k != j:
            out.append(self.parts[k])
            k = (k + 1) % len(self.parts)
        out.append(self.parts[j].cut(self.parts[j].t0, u))
        return tuple(part for part in out if part.t0 != part.t1)

    def snapped(self, s: float, reach: float) -> float:
        """The start of a part where one is within reach, else s."""
        gap = np.abs(np.mod(self.start - s + 0.5 * self.length, self.length) - 0.5 * self.length)
        k = int(np.argmin(gap))
        return float(self.start[k] % self.length) if gap[k] <= reach else s % self.length

    def holds(self, point: np.ndarray) -> bool:
        """Whether a point lies inside."""
        a, b = self.polygon, np.roll(self.polygon, -1, axis=0)
        spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
        a, b = a[spans], b[spans]
        x = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
        return bool((x > point[0]).sum() % 2)


@dataclass(frozen=True, eq=False)
class Face:
    """A connected piece of one region: its outer loop, and the loops of its holes."""

    region: int
    outer: Loop
    holes: tuple[Loop, ...]


def _refuse_embedded(domain: Pslg) -> None:
    inside = np.flatnonzero(domain.segment_region[:, 0] == domain.segment_region[:, 1])
    probes = np.flatnonzero(domain.point_marker >= 0)
    if len(inside) or len(probes):
        marker = domain.segment_marker[inside[0]] if len(inside) else domain.point_marker[probes[0]]
        at = domain.points[domain.segments[inside[0], 0] if len(inside) else probes[0]]
        raise MeshingError(
            "a structured grid has no room for embedded paths and points; there is "
            f"{' = '.join(domain.boundary_names[marker])} at ({at[0]:.6g}, {at[1]:.6g}); "
            "use DelaunayRefinement"
        )


def _stretches(outline: Outline) -> list[tuple[Part, int, int]]:
    """Parts with their start and end vertices."""
    domain = outline.domain
    segments = domain.segments.tolist()
    degree = np.bincount(domain.segments.ravel(), minlength=domain.n_points).tolist()
    leaving = {a: k for k, (a, _) in enumerate(segments)}
    what = list(
        zip(
            outline.curve.tolist(),
            domain.segment_marker.tolist(),
            map(tuple, domain.segment_region.tolist()),
            strict=True,
        )
    )
    interval = outline.interval.tolist()

    def follows(k: int) -> int:
        v = segments[k][1]
        n = leaving.get(v, -1)
        joined = n >= 0 and degree[v] == 2 and what[k] == what[n]
        return n if joined and interval[k][1] == interval[n][0] and n != k else -1

    after = [follows(k) for k in range(len(segments))]
    has_before = {n for n in after if n >= 0}
    found = []
    for k in range(len(segments)):
        if k in has_before:
            continue
        last = k
        while after[last] >= 0:
            last = after[last]
        curve, marker, sides = what[k]
        part = Part(curve, interval[k][0], interval[last][1], marker, sides)
        found.append((part, segments[k][0], segments[last][1]))
    return found


def _faces(outline: Outline, stretches: list[tuple[Part, int, int]]) -> list[Face]:
    loops: dict[int, list[Loop]] = {}
    halves: dict[tuple[int, int], list[tuple[Part, int]]] = {}
    for part, a, b in stretches:
        for way, start, end in ((part, a, b), (part.reversed(), b, a)):
            if way.sides[0] >= 0:
                halves.setdefault((way.sides[0], start), []).append((way, end))
    for region, start in list(halves):
        while halves[region, start]:
            way, at = halves[region, start].pop(0)
            row = [way]
            while at != start:
                choice = halves.get((region, at), [])
                if not choice:
                    raise MeshingError("each region must be closed; a structured grid found a gap")
                row_end = outline.heading(row[-1], True)
                pick = max(range(len(choice)), key=lambda i: _left(outline, row_end, choice[i][0]))
                way, at = choice.pop(pick)
                row.append(way)
            loops.setdefault(region, []).append(Loop(outline, row))
    faces = []
    for region in sorted(loops):
        outer = [loop for loop in loops[region] if loop.area > 0]
        holes: list[list[Loop]] = [[] for _ in outer]
        for loop in loops[region]:
            if loop.area <= 0:
                around = [k for k, o in enumerate(outer) if o.holds(loop.polygon[0])]
                if not around:
                    raise MeshingError(
                        "a structured grid found a hole that touches its own outer boundary"
                    )
                holes[min(around, key=lambda k: outer[k].area)].append(loop)
        faces += [Face(region, o, tuple(h)) for o, h in zip(outer, holes, strict=True)]
    return faces


def _left(outline: Outline, heading: np.ndarray, part: Part) -> float:
    """How far to the left a part leaves: the leftmost keeps one face."""
    v = outline.heading(part, False)
    return float(np.arctan2(heading[0] * v[1] - heading[1] * v[0], heading @ v))

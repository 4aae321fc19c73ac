"""Periodic sides: the same points on both, and on the second the images of the first's curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from csgmesh.boundary.congruence import RigidMap, Side, Stretch, agreement, joined, place
from csgmesh.boundary.division import Division, common_division
from csgmesh.domain.curves import Curves
from csgmesh.domain.names import find_markers
from csgmesh.domain.periodic import PeriodicSides
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import EvaluationError

#: Where between its ends a segment is compared with its image.
_PROBES = (0.0, 0.25, 0.5, 0.75, 1.0)


def pair_sides(domain: Pslg, pairs: Sequence[tuple[str, str]]) -> Pslg:
    """The domain with the sides of each pair divided alike.

    Raises
    ------
    NameLookupError
        If a name matches nothing.
    EvaluationError
        If sides are not congruent, overlap, or do not bound the domain; with the place.
    """
    sides = [_sides(domain, pair) for pair in pairs]
    _refuse_overlap(domain, [side for pair in sides for side in pair])
    draft = _Draft(domain)
    for pair in sides:
        rigid, parts = joined(domain, pair)
        draft.begin(rigid)
        for first, second in parts:
            draft.add(first, second, common_division(domain, rigid, first, second))
        _compare(draft, pair)
    return draft.finished(pairs)


def _sides(domain: Pslg, pair: tuple[str, str]) -> tuple[Side, Side]:
    first, second = (
        Side(
            n,
            np.flatnonzero(np.isin(domain.segment_marker, find_markers(n, domain.boundary_names))),
        )
        for n in pair
    )
    for side in (first, second):
        regions = domain.segment_region[side.segments]
        inner = side.segments[(regions[:, 0] < 0) | (regions[:, 1] >= 0)]
        if not len(side.segments):
            raise EvaluationError(f"a periodic side must have segments; {side.name!r} is a point")
        if len(inner):
            raise EvaluationError(
                f"a periodic side must bound the domain; {side.name!r} has the domain on both "
                f"sides at {place(_middle(domain, inner[0]))}"
            )
    return first, second


def _middle(domain: Pslg, segment: int) -> np.ndarray:
    middle: np.ndarray = domain.points[domain.segments[segment]].mean(axis=0)
    return middle


def _refuse_overlap(domain: Pslg, sides: list[Side]) -> None:
    owner = np.full(len(domain.segments), -1)
    for k, side in enumerate(sides):
        again = side.segments[owner[side.segments] >= 0]
        if len(again):
            raise EvaluationError(
                f"a segment may belong to one periodic side only; at "
                f"{place(_middle(domain, again[0]))} it belongs to {sides[owner[again[0]]].name!r} "
                f"and {side.name!r}"
            )
        owner[side.segments] = k


@dataclass
class _Half:
    """Segments of one side, run along the first side of their pair."""

    tail: list[np.ndarray]
    head: list[np.ndarray]
    origin: list[np.ndarray]


class _Draft:
    """A domain whose paired sides are being replaced."""

    def __init__(self, domain: Pslg) -> None:
        self.domain = domain
        self.points = [domain.points]
        self.n_points = domain.n_points
        self.curves = [domain.curves]
        self.n_curves = len(domain.curves)
        self.rigid = RigidMap(np.eye(2), np.zeros(2))
        self.maps: list[RigidMap] = []
        #: Of each new segment: ends, the segment whose names and regions it has, curve, interval.
        self.rows: list[list[np.ndarray]] = []
        self.pair: list[int] = []

    def begin(self, rigid: RigidMap) -> None:
        """Go on with the next pair."""
        self.rigid = rigid
        self.maps.append(rigid)

    def add(self, first: Stretch, second: Stretch, division: Division) -> None:
        """Divide two stretches alike."""
        domain = self.domain
        curve = domain.segment_curve[division.first_segment]
        here = self._numbered(division.first_node, np.append(curve, curve[-1]), division)
        images, image = np.unique(curve, return_inverse=True)
        table = domain.curves[images].transformed(self.rigid.matrix, self.rigid.offset)
        low, high = np.full(len(images), np.inf), np.full(len(images), -np.inf)
        np.minimum.at(low, image, division.interval.min(axis=1))
        np.maximum.at(high, image, division.interval.max(axis=1))
        self.curves.append(Curves(table.kind, table.data, np.column_stack([low, high])))
        image = image + self.n_curves
        self.n_curves += len(images)
        there = self._numbered(division.second_node, np.append(image, image[-1]), division)
        back = division.interval[:, ::-1]
        self.rows.append([here[:-1], here[1:], division.first_segment, curve, division.interval])
        self.rows.append([there[1:], there[:-1], division.second_segment, image, back])
        self.pair.append(len(self.maps) - 1)

    def _numbered(self, node: np.ndarray, curve: np.ndarray, division: Division) -> np.ndarray:
        """Numbers of the points, those without one on their exact curve."""
        number = node.copy()
        new = np.flatnonzero(node < 0)
        t = np.append(division.interval[:, 0], division.interval[-1, 1])
        self.points.append(Curves.concatenate(self.curves).points(curve[new], t[new]))
        number[new] = self.n_points + np.arange(len(new))
        self.n_points += len(new)
        return number

    def finished(self, pairs: Sequence[tuple[str, str]]) -> Pslg:
        """The new domain."""
        domain = self.domain
        columns = [np.concatenate(c) for c in zip(*self.rows, strict=True)]
        tail, head, origin, curve, interval = columns
        untouched = np.setdiff1d(np.arange(len(domain.segments)), origin)
        source = np.concatenate([untouched, origin])
        # In the place of the segments that they replace; those of second sides run backwards.
        side = np.concatenate([np.full(len(r[0]), k) for k, r in enumerate(self.rows)])
        step = np.concatenate([np.arange(len(r[0])) for r in self.rows])
        step = np.where(side % 2 == 1, -step, step)
        order = np.lexsort((np.concatenate([np.zeros(len(untouched), int), step]), source))
        number = np.empty(len(order), np.int64)
        number[order] = np.arange(len(order))
        segments = np.vstack([domain.segments[untouched], np.column_stack([tail, head])])[order]
        curves = np.concatenate([domain.segment_curve[untouched], curve])[order]
        intervals = np.vstack([domain.segment_interval[untouched], interval])[order]
        source = source[order]
        row = number[len(untouched) :]
        values = {f.name: getattr(domain, f.name) for f in fields(domain)}
        values |= _compacted(np.concatenate(self.points), domain.point_marker, segments)
        values |= _used_curves(Curves.concatenate(self.curves), curves)
        values["segment_interval"] = intervals
        values["segment_marker"] = domain.segment_marker[source]
        values["segment_region"] = domain.segment_region[source]
        values["periodic"] = self._periodic(pairs, row, side)
        return Pslg.build(**values)

    def _periodic(
        self, pairs: Sequence[tuple[str, str]], row: np.ndarray, side: np.ndarray
    ) -> tuple[PeriodicSides, ...]:
        of_pair = np.array(self.pair)[side // 2]
        found = []
        for k, (names, rigid) in enumerate(zip(pairs, self.maps, strict=True)):
            first, second = (row[(of_pair == k) & (side % 2 == s)] for s in (0, 1))
            segments = np.column_stack([first, second])
            found.append(PeriodicSides(names, rigid.matrix, rigid.offset, segments))
        return tuple(found)


def _compacted(
    points: np.ndarray, marker: np.ndarray, segments: np.ndarray
) -> dict[str, np.ndarray]:
    """Without the points of curves that are divided otherwise now."""
    marker = np.concatenate([marker, np.full(len(points) - len(marker), -1)])
    used = marker >= 0
    used[segments] = True
    number = np.cumsum(used) - 1
    return {
        "points": points[used],
        "point_marker": marker[used],
        "segments": number[segments],
    }


def _used_curves(curves: Curves, of_segment: np.ndarray) -> dict[str, object]:
    used, number = np.unique(of_segment, return_inverse=True)
    return {"curves": curves[used], "segment_curve": number}


def _compare(draft: _Draft, pair: tuple[Side, Side]) -> None:
    """Refuse sides that differ between their ends."""
    domain, rigid = draft.domain, draft.rigid
    rows = [r for r, k in zip(draft.rows[::2], draft.pair, strict=True) if k == len(draft.maps) - 1]
    there = [
        r for r, k in zip(draft.rows[1::2], draft.pair, strict=True) if k == len(draft.maps) - 1
    ]
    curve = np.concatenate([r[3] for r in rows])
    interval = np.concatenate([r[4] for r in rows])
    segment = np.concatenate([r[2] for r in there])
    other = domain.segment_curve[segment]
    span = domain.curves.interval[other]
    worst, where, onto = -1.0, np.zeros(2), np.zeros(2)
    for share in _PROBES:
        points = domain.curves.points(curve, interval @ [1.0 - share, share])
        images = rigid(points)
        t = domain.curves.project(other, images, span[:, 0], span[:, 1])
        off = np.hypot(*(domain.curves.points(other, t) - images).T)
        k = int(np.argmax(off))
        if off[k] > worst:
            worst, where, onto = float(off[k]), points[k], images[k]
    if worst > agreement(domain):
        raise EvaluationError(
            f"periodic sides must be congruent; {place(where)} of {pair[0].name!r} comes to lie at "
            f"{place(onto)}, {worst:.3g} away from {pair[1].name!r}"
        )

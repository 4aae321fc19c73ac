"""How many cells each edge of the blocks gets, and where their ends lie."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from csgmesh import graphs
from csgmesh.domain.curves import LINE
from csgmesh.domain.names import find_markers
from csgmesh.errors import InputError, MeshingError
from csgmesh.meshers.structured.layout import Edge, Layout
from csgmesh.meshers.structured.spacing import TABLE, Spacing, by_density, given
from csgmesh.size.resolve import ResolvedSize, evaluate

#: Without a size, cells across the domain's diagonal.
BY_DEFAULT = 30
#: A count may rise by this share so that joints of curves fall more evenly.
EVENER = 0.2
#: Rounds of adding cells until curves are followed as closely as the domain says.
ROUNDS = 12


@dataclass(frozen=True, eq=False)
class EdgePoints:
    """Points of an edge with a row a point: where on which of its parts they are.

    Attributes
    ----------
    points : (n + 1, 2)
    part : (n,) int64
        Part of each piece.
    interval : (n, 2)
        Parameters of each piece's ends on that part's curve.
    shares : (n + 1,)
        Arc length up to each point, as a share.
    """

    points: np.ndarray
    part: np.ndarray
    interval: np.ndarray
    shares: np.ndarray


class Counts:
    """Numbers of cells: equal on opposite sides, fine enough for size and curves, or as given."""

    def __init__(
        self,
        layout: Layout,
        size: ResolvedSize | None,
        counts: Mapping[str, int],
        spacing: Mapping[str, Any],
    ) -> None:
        self.layout = layout
        self.outline = layout.outline
        self.size = size
        self.table = [self._edge_table(edge) for edge in layout.edges]
        self.length = np.array([table[1][-1] for table in self.table])
        self.group = self._groups()
        self.at_corner = self._corner_sizes()
        regions = self._regions()
        self.density = [self._density(k, regions[k]) for k in range(len(layout.edges))]
        self.spacing: list[Spacing] = [by_density(d) for d in self.density]
        self._given_spacings(spacing)
        wanted = np.array([d.mean() * n for d, n in zip(self.density, self.length, strict=True)])
        joints = np.array([len(edge.parts) for edge in layout.edges])
        n_groups = int(self.group.max()) + 1
        self.of_group = np.ones(n_groups, np.int64)
        np.maximum.at(self.of_group, self.group, np.ceil(wanted - 0.35).astype(np.int64))
        np.maximum.at(self.of_group, self.group, joints)
        self.is_given = np.zeros(n_groups, bool)
        self._given_counts(counts)
        self._even_joints()
        self.edges: list[EdgePoints] = []
        self._settle()

    def __getitem__(self, edge: int) -> int:
        return int(self.of_group[self.group[edge]])

    def _groups(self) -> np.ndarray:
        """Edges that must have equally many cells."""
        sides = [
            pair
            for block in self.layout.blocks
            for pair in ((block.bottom[0], block.top[0]), (block.left[0], block.right[0]))
        ]
        a, b = np.array(sides).T
        return graphs.components(len(self.layout.edges), a, b)[1]

    def _edge_table(self, edge: Edge) -> tuple[np.ndarray, np.ndarray]:
        """Start of each part and the end as arc lengths; the total is last."""
        lengths = np.concatenate([[0.0], [self.outline.sampled(p)[1][-1] for p in edge.parts]])
        return lengths, np.cumsum(lengths)

    def _corner_sizes(self) -> np.ndarray:
        """Sizes that named boundaries ask for at the corners on them."""
        out = np.full(len(self.layout.corners), np.inf)
        if self.size is None:
            return out
        corners = np.array(self.layout.corners)
        for edge in self.layout.edges:
            for end, part in zip(edge.ends, (edge.parts[0], edge.parts[-1]), strict=True):
                for markers, source in self.size.boundary:
                    if part.marker in markers:
                        out[end] = min(out[end], evaluate(source, corners[[end]])[0])
        return out

    def _regions(self) -> list[set[int]]:
        out: list[set[int]] = [set() for _ in self.layout.edges]
        for block in self.layout.blocks:
            for side in (block.bottom, block.right, block.top, block.left):
                out[side[0]].add(block.region)
        return out

    def _density(self, k: int, regions: set[int]) -> np.ndarray:
        """Cells per length along an edge, at equally spaced shares of it."""
        edge = self.layout.edges[k]
        shares = np.linspace(0.0, 1.0, TABLE)
        points, part, _ = self._at(k, shares)
        domain = self.outline.domain
        if self.size is None:
            return np.full(TABLE, BY_DEFAULT / domain.diagonal)
        value = np.full(TABLE, np.inf)
        special = [source for numbers, source in self.size.region if regions & set(numbers)]
        plain = any(all(r not in numbers for numbers, _ in self.size.region) for r in regions)
        if self.size.default is not None and plain:
            special.append(self.size.default)
        for source in special:
            value = np.minimum(value, evaluate(source, points))
        marker = np.array([p.marker for p in edge.parts])[part]
        is_inner = all(p.marker < 0 for p in edge.parts)
        for markers, source in self.size.boundary:
            on = np.isin(marker, markers)
            if on.any():
                value[on] = np.minimum(value[on], evaluate(source, points[on]))
        if is_inner:
            start = min(self.at_corner[edge.ends[0]], value[0])
            end = min(self.at_corner[edge.ends[1]], value[-1])
            if np.isfinite([start, end]).all():
                value = np.minimum(value, start + shares * (end - start))
        value = np.where(np.isfinite(value), value, domain.diagonal / BY_DEFAULT)
        return np.asarray(1.0 / value)

    def _at(self, k: int, shares: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points at shares of an edge's arc length, the part and the parameter of each."""
        edge, (_, start) = self.layout.edges[k], self.table[k]
        s = shares * start[-1]
        part = np.clip(np.searchsorted(start, s, side="right") - 1, 0, len(edge.parts) - 1)
        t = np.empty(len(s))
        curve = np.array([p.curve for p in edge.parts])[part]
        for j in np.unique(part).tolist():
            on = part == j
            t[on] = self._inverse(edge, j, s[on] - start[j])
        return self.outline.curves.points(curve, t), part, t

    def _inverse(self, edge: Edge, j: int, s: np.ndarray) -> np.ndarray:
        """Parameters at arc lengths along a part."""
        part = edge.parts[j]
        curves = self.outline.curves
        if curves.kind[part.curve] == LINE or curves.is_circular()[part.curve]:
            total = self.outline.sampled(part, 2)[1][-1]
            return np.asarray(part.t0 + s / total * (part.t1 - part.t0))
        t, length = self.outline.sampled(part)
        return np.interp(s, length, t)

    def _given_spacings(self, spacing: Mapping[str, Any]) -> None:
        """Spacings of named sides, and of what lies opposite unless it has its own."""
        names = self.outline.domain.boundary_names
        told: dict[int, tuple[Spacing, bool]] = {}
        for name, value in spacing.items():
            shares = given(value, name)
            markers = find_markers(name, names)
            for k, edge in enumerate(self.layout.edges):
                if all(p.marker in markers for p in edge.parts):
                    # Along the boundary with the domain on the left.
                    told[k] = shares, edge.parts[0].sides[0] < 0
        self._pass_on(told)
        for k, (shares, is_turned) in told.items():
            self.spacing[k] = _turned(shares) if is_turned else shares

    def _pass_on(self, told: dict[int, tuple[Spacing, bool]]) -> None:
        todo = list(told)
        while todo:
            k = todo.pop(0)
            shares, is_turned = told[k]
            for block in self.layout.blocks:
                for one, other in ((block.bottom, block.top), (block.left, block.right)):
                    for a, b in ((one, other), (other, one)):
                        if a[0] == k and b[0] not in told:
                            told[b[0]] = shares, is_turned ^ a[1] ^ b[1]
                            todo.append(b[0])

    def _given_counts(self, counts: Mapping[str, int]) -> None:
        names = self.outline.domain.boundary_names
        asked: dict[int, str] = {}
        for name, count in counts.items():
            if isinstance(count, bool) or not isinstance(count, (int, np.integer)) or count < 1:
                raise InputError(f"counts of {name!r} must be a positive integer; got {count!r}")
            markers = find_markers(name, names)
            on = [k for k, edge in enumerate(self.layout.edges)
                  if all(p.marker in markers for p in edge.parts)]  # fmt: skip
            if not on:
                raise InputError(f"counts of {name!r}: no side of a block lies on it alone")
            groups, times = np.unique(self.group[on], return_counts=True)
            shared = _shared_out(count, times, self.of_group[groups])
            if shared is None:
                raise InputError(
                    f"counts of {name!r} must be {' + '.join(f'{t} n' for t in times)} with n >= 1 "
                    f"for the {len(on)} sides on it; got {count}"
                )
            for group, n in zip(groups.tolist(), shared.tolist(), strict=True):
                if group in asked and self.of_group[group] != n:
                    raise InputError(
                        f"opposite sides have equally many cells; {asked[group]!r} asks for "
                        f"{self.of_group[group]}, {name!r} for {n}"
                    )
                asked[group] = name
                self.of_group[group] = n
                self.is_given[group] = True
        joints = np.zeros(len(self.of_group), np.int64)
        np.maximum.at(joints, self.group, np.array([len(e.parts) for e in self.layout.edges]))
        for group, name in asked.items():
            if joints[group] > self.of_group[group]:
                raise InputError(
                    f"counts of {name!r}: a side opposite or beside has {joints[group]} curves, "
                    f"which {self.of_group[group]} cells cannot follow"
                )

    def _even_joints(self) -> None:
        """A few more cells where joints of curves would else fall unevenly."""
        for group in range(len(self.of_group)):
            inner = [self.table[k][1][1:-1] / self.length[k]
                     for k in np.flatnonzero(self.group == group).tolist()]  # fmt: skip
            joints = np.concatenate([np.zeros(0), *inner])
            if not len(joints) or self.is_given[group]:
                continue
            n = int(self.of_group[group])
            tried = np.arange(n, n + 2 + int(EVENER * n))
            off = np.abs(joints[None] * tried[:, None] - np.rint(joints[None] * tried[:, None]))
            cost = off.max(axis=1) * n + 0.1 * (tried - n)
            self.of_group[group] = tried[int(np.argmin(cost))]

    def _settle(self) -> None:
        """Place the points; more of them while a curve strays too far from its chords."""
        allowed = self.outline.domain.deviation
        for _ in range(ROUNDS):
            self.edges = [self._place(k) for k in range(len(self.layout.edges))]
            more = np.ones(len(self.of_group))
            for k, edge in enumerate(self.edges):
                stray = self._deviation(k, edge)
                if stray > allowed * (1 + 1e-6):
                    more[self.group[k]] = max(more[self.group[k]], np.sqrt(stray / allowed))
            more[self.is_given] = 1.0
            if (more <= 1.0).all():
                return
            self.of_group = np.where(
                more > 1,
                np.maximum(np.ceil(self.of_group * more), self.of_group + 1),
                self.of_group,
            ).astype(np.int64)
            self._even_joints()
        raise MeshingError("a structured grid could not follow a curve within its deviation")

    @property
    def deviation(self) -> float:
        """Largest distance of the domain's curves from their chords."""
        own = [self._deviation(k, e) for k, e in enumerate(self.edges)
               if self.layout.edges[k].parts[0].marker >= 0]  # fmt: skip
        return max([0.0, *own])

    def _deviation(self, k: int, edge: EdgePoints) -> float:
        if self.layout.edges[k].parts[0].marker < 0:
            return 0.0
        curve = np.array([p.curve for p in self.layout.edges[k].parts])[edge.part]
        bent = np.flatnonzero(self.outline.curves.kind[curve] != LINE)
        if not len(bent):
            return 0.0
        curve, interval = curve[bent], edge.interval[bent]
        a, b = edge.points[bent], edge.points[bent + 1]
        chord = b - a
        length = np.maximum(np.hypot(*chord.T), np.finfo(float).tiny)
        worst = 0.0
        for share in (0.25, 0.5, 0.75):
            arm = self.outline.curves.points(curve, interval @ [1 - share, share]) - a
            away = np.abs(chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0]) / length
            worst = max(worst, float(away.max()))
        return worst

    def _place(self, k: int) -> EdgePoints:
        """The points of an edge, its joints among them."""
        edge, n = self.layout.edges[k], self[k]
        shares = self.spacing[k](n)
        joints = self.table[k][1] / self.length[k]
        at = _nearest_points(shares, joints)
        for j in range(len(edge.parts)):
            i0, i1 = at[j], at[j + 1]
            old = shares[i0 : i1 + 1]
            new = joints[j] + (old - old[0]) / (old[-1] - old[0]) * (joints[j + 1] - joints[j])
            shares = np.concatenate([shares[:i0], new, shares[i1 + 1 :]])
        part = np.searchsorted(at[1:], np.arange(n), side="right")
        t = np.empty((n, 2))
        points = np.empty((n + 1, 2))
        start = self.table[k][1]
        for j, own in enumerate(edge.parts):
            i0, i1 = at[j], at[j + 1]
            inner = self._inverse(edge, j, shares[i0 + 1 : i1] * start[-1] - start[j])
            row = np.concatenate([[own.t0], inner, [own.t1]])
            t[i0:i1] = np.stack([row[:-1], row[1:]], axis=1)
            points[i0 + 1 : i1] = self.outline.curves.points(np.full(len(inner), own.curve), inner)
            points[i0] = self.outline.point(own.curve, own.t0)
            points[i1] = self.outline.point(own.curve, own.t1)
        points[0], points[-1] = (self.layout.corners[c] for c in edge.ends)
        return EdgePoints(points, part, t, shares)


def _nearest_points(shares: np.ndarray, joints: np.ndarray) -> np.ndarray:
    """A point for each joint: the nearest one, each joint its own, (len(joints),)."""
    n, m = len(shares) - 1, len(joints) - 1
    at = np.array([int(np.argmin(np.abs(shares - joint))) for joint in joints])
    at[0], at[-1] = 0, n
    for j in range(1, m):
        at[j] = max(at[j], at[j - 1] + 1)
    for j in range(m - 1, 0, -1):
        at[j] = min(at[j], at[j + 1] - 1)
    return at


def _turned(shares: Spacing) -> Spacing:
    return lambda n: 1.0 - shares(n)[::-1]


def _shared_out(count: int, times: np.ndarray, wanted: np.ndarray) -> np.ndarray | None:
    """Whole n near `wanted`, scaled, with ``times @ n == count``; None if there are none."""
    ideal = wanted * count / float(times @ wanted)
    n = np.maximum(np.floor(ideal), 1).astype(np.int64)
    while True:
        left = count - int(times @ n)
        fits = np.flatnonzero(times <= left)
        if left == 0:
            return n
        if left < 0 or not len(fits):
            return None
        n[fits[np.argmax((ideal - n)[fits])]] += 1

"""Blocks, their edges and corners: what a multi-block grid consists of before it has points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from csgmesh.errors import MeshingError
from csgmesh.meshers.structured.outline import Outline, Part, turned

#: Corners of blocks nearer than this share of the domain's diagonal are one.
SAME = 1e-9

Side = tuple[int, bool]


@dataclass(frozen=True, eq=False)
class Edge:
    """An edge of blocks: parts in a row from one corner to another.

    Every joint of two parts becomes a vertex of the mesh.
    """

    ends: tuple[int, int]
    parts: tuple[Part, ...]


@dataclass(frozen=True, eq=False)
class Block:
    """Four sides around a piece of a region.

    Attributes
    ----------
    region : int
    sides : tuple of (edge, reversed)
        Bottom and top run along i, left and right along j: bottom and left leave the first corner.
    """

    region: int
    bottom: Side
    right: Side
    top: Side
    left: Side


@dataclass(eq=False)
class Layout:
    """Corners, edges and blocks, shared between neighbours."""

    outline: Outline
    corners: list[np.ndarray] = field(default_factory=list)
    edges: list[Edge] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    known: dict[tuple[object, ...], int] = field(default_factory=dict)
    claimed: dict[int, list[tuple[float, float, int]]] = field(default_factory=dict)

    def corner(self, point: np.ndarray) -> int:
        """Number of the corner at a point."""
        reach = SAME * self.outline.domain.diagonal
        for k, other in enumerate(self.corners):
            if abs(other[0] - point[0]) <= reach and abs(other[1] - point[1]) <= reach:
                return k
        self.corners.append(np.asarray(point, float))
        return len(self.corners) - 1

    def edge(self, parts: Sequence[Part]) -> Side:
        """The edge made of parts; the same one for whoever runs it the other way."""
        if not parts:
            raise MeshingError(
                "a structured grid needs sides with a length; two corners of a block are one"
            )
        row = tuple(parts)
        for way, is_reversed in ((row, False), (turned(row), True)):
            number = self.known.get(_key(way))
            if number is not None:
                return number, is_reversed
        first, last = row[0], row[-1]
        ends = (
            self.corner(self.outline.point(first.curve, first.t0)),
            self.corner(self.outline.point(last.curve, last.t1)),
        )
        self.edges.append(Edge(ends, row))
        number = len(self.edges) - 1
        self.known[_key(row)] = number
        for part in row:
            self._claim(part, number)
        return number, False

    def line(self, a: int, b: int) -> Side:
        """The straight edge between two corners."""
        for key, is_reversed in (((a, b), False), ((b, a), True)):
            if key in self.known:
                return self.known[key], is_reversed
        part = self.outline.line(self.corners[a], self.corners[b])
        self.edges.append(Edge((a, b), (part,)))
        self.known[a, b] = len(self.edges) - 1
        return len(self.edges) - 1, False

    def block(self, region: int, bottom: Side, right: Side, top: Side, left: Side) -> None:
        """Add a block; its sides must meet at its corners."""
        ends = [self.ends(side) for side in (bottom, right, top, left)]
        (b0, b1), (r0, r1), (t0, t1), (l0, l1) = ends
        if (b0, b1, t0, t1) != (l0, r0, l1, r1):
            raise MeshingError("the sides of a block do not meet at its corners")
        self.blocks.append(Block(region, bottom, right, top, left))

    def ends(self, side: Side) -> tuple[int, int]:
        """Corners at the start and the end of a side."""
        a, b = self.edges[side[0]].ends
        return (b, a) if side[1] else (a, b)

    def _claim(self, part: Part, number: int) -> None:
        """Refuse blocks whose sides share a boundary in part only."""
        if part.marker < 0:
            return
        lo, hi = sorted((part.t0, part.t1))
        for low, high, _ in self.claimed.setdefault(part.curve, []):
            if min(hi, high) - max(lo, low) > SAME * max(hi - lo, high - low):
                x, y = self.outline.point(part.curve, part.t0)
                name = " = ".join(self.outline.domain.boundary_names[part.marker])
                raise MeshingError(
                    "blocks of a structured grid meet along whole sides; those at "
                    f"{name} near ({x:.6g}, {y:.6g}) do not; use PerRegion with another mesher, "
                    "or QuadPairing"
                )
        self.claimed[part.curve].append((lo, hi, number))


def reverse(side: Side) -> Side:
    """The side run the other way."""
    return side[0], not side[1]


def _key(parts: tuple[Part, ...]) -> tuple[object, ...]:
    return tuple((part.curve, part.t0, part.t1) for part in parts)

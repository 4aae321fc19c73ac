"""Edges between different regions, joined into chains: maximal stretches of one curve.

A vertex that only hidden leaves left behind, or where a curve was cut to be monotone, is no
corner of the domain and disappears.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.arrangement import Arrangement
from csgmesh.boundary.pieces import FRAME
from csgmesh.csg.program import Program
from csgmesh.domain.curves import ARC
from csgmesh.errors import EmptyDomainError, UnboundedDomainError
from csgmesh.graphs import components


@dataclass(frozen=True, eq=False)
class Chains:
    """Stretches of the domain's boundary between its corners.

    Attributes
    ----------
    source : (k,) int64
        Exact curve of each.
    t0, t1 : (k,) float64
        Parameters at start and end, increasing; an arc's may pass 2π.
    tail, head : (k,) int64
        Vertices of the arrangement; the same one for a closed curve without a corner.
    left, right : (k,) int64
        Regions on both sides, -1 outside.
    marker : (k,) int64
        Into `names`.
    names : tuple of tuple of str
    """

    source: np.ndarray
    t0: np.ndarray
    t1: np.ndarray
    tail: np.ndarray
    head: np.ndarray
    left: np.ndarray
    right: np.ndarray
    marker: np.ndarray
    names: tuple[tuple[str, ...], ...]


def chains(
    program: Program, arrangement: Arrangement, face: np.ndarray, region: np.ndarray
) -> Chains:
    """The domain's boundary, its interfaces and its embedded paths.

    Parameters
    ----------
    program : Program
    arrangement : Arrangement
    face : (2m,) int64
        Face on the left of each half-edge.
    region : (n_faces,) int64
        Region of each face, -1 outside.
    """
    left, right = region[face[0::2]], region[face[1::2]]
    parent_leaf = arrangement.pieces.leaf[arrangement.parent_piece]
    embedded = np.zeros(len(left), bool)
    embedded[arrangement.parent_edge[parent_leaf > len(program.leaves)]] = True
    kept = np.flatnonzero((left != right) | (embedded & (left >= 0)))
    if not (region >= 0).any():
        raise EmptyDomainError(_nothing_left(program))
    marker, names = _markers(program, arrangement, kept)
    free = np.flatnonzero(marker < 0)
    if len(free):
        raise UnboundedDomainError(_reaches_out(program, arrangement, kept[free[0]]))
    if region[0] >= 0:
        outer = np.flatnonzero((face[0::2] == 0) | (face[1::2] == 0))
        raise UnboundedDomainError(_unbounded_around(program, arrangement, outer))
    return _joined(arrangement, kept, left[kept], right[kept], marker, names)


def part_names(program: Program) -> tuple[np.ndarray, list[str]]:
    """Where the names of each leaf, of the frame and of each path start, and all of them."""
    names: list[str] = []
    start = [0]
    for leaf in program.leaves:
        names.extend(leaf.names)
        start.append(len(names))
    start.append(len(names))
    for name, _ in program.paths:
        names.append(name)
        start.append(len(names))
    return np.array(start), names


def _markers(
    program: Program, arrangement: Arrangement, kept: np.ndarray
) -> tuple[np.ndarray, tuple[tuple[str, ...], ...]]:
    """Marker of each kept edge, -1 where nothing but the working frame lies on it."""
    start, names = part_names(program)
    position = np.full(len(arrangement.tail), -1)
    position[kept] = np.arange(len(kept))
    row = position[arrangement.parent_edge]
    part = arrangement.pieces.part[arrangement.parent_piece]
    use = (row >= 0) & (part != FRAME)
    row, piece = row[use], arrangement.parent_piece[use]
    name = start[arrangement.pieces.leaf[piece]] + arrangement.pieces.part[piece]
    order = np.lexsort((name, row))
    row, name = row[order], name[order]
    first = np.searchsorted(row, np.arange(len(kept) + 1))
    count = first[1:] - first[:-1]
    # Nearly all edges have one name; only the others need a tuple of their own.
    marker = np.full(len(kept), -1)
    one = np.flatnonzero(count == 1)
    numbers, single = np.unique(name[first[one]], return_inverse=True)
    table: dict[tuple[str, ...], int] = {}
    order = np.array([table.setdefault((names[n],), len(table)) for n in numbers.tolist()], int)
    marker[one] = order[single] if len(one) else single
    for k in np.flatnonzero(count > 1).tolist():
        several = dict.fromkeys(names[n] for n in name[first[k] : first[k + 1]].tolist())
        marker[k] = table.setdefault(tuple(several), len(table))
    return marker, tuple(table)


def _joined(
    arrangement: Arrangement,
    kept: np.ndarray,
    left: np.ndarray,
    right: np.ndarray,
    marker: np.ndarray,
    names: tuple[tuple[str, ...], ...],
) -> Chains:
    tail, head = arrangement.tail[kept], arrangement.head[kept]
    source = arrangement.source[kept]
    t0, t1 = arrangement.t_tail[kept], arrangement.t_head[kept]
    follower = _followers(arrangement, tail, head, source, t0, t1, left, right, marker)
    label = _runs(len(kept), follower)
    n = int(label.max(initial=-1)) + 1
    has_predecessor = np.zeros(len(kept), bool)
    has_predecessor[follower[follower >= 0]] = True
    # A chain starts where nothing precedes; a closed curve at its lowest parameter.
    order = np.lexsort((t0, has_predecessor, label))
    first = order[np.searchsorted(label[order], np.arange(n))]
    start = t0[first]
    width = np.bincount(label, t1 - t0, n)
    # Where the curve has no wrap the end is the last edge's own parameter, to the bit.
    over = t1 + 2 * np.pi * (t0 < start[label])
    end = np.full(n, -np.inf)
    np.maximum.at(end, label, np.where(arrangement.pieces.curves.kind[source] == ARC, over, t1))
    last = np.lexsort((np.arange(len(kept)), follower >= 0, label))
    last = last[np.searchsorted(label[last], np.arange(n))]
    closed = follower[last] >= 0
    final = np.where(closed, tail[first], head[last])
    end = np.where(np.abs(end - start - width) < 1e-6 * np.abs(width), end, start + width)
    return Chains(
        source[first], start, end, tail[first], final, left[first], right[first], marker[first],
        names,
    )  # fmt: skip


def _followers(
    arrangement: Arrangement,
    tail: np.ndarray,
    head: np.ndarray,
    source: np.ndarray,
    t0: np.ndarray,
    t1: np.ndarray,
    left: np.ndarray,
    right: np.ndarray,
    marker: np.ndarray,
) -> np.ndarray:
    """The edge that continues each edge through a vertex that is no corner, or -1."""
    n = len(arrangement.vertices)
    degree = np.bincount(tail, minlength=n) + np.bincount(head, minlength=n)
    degree[arrangement.probe_vertex] = 0
    leaving = np.full(n, -1)
    leaving[tail] = np.arange(len(tail))
    candidate = leaving[head]
    ok = (degree[head] == 2) & (candidate >= 0)
    c = np.where(ok, candidate, 0)
    gap = t0[c] - t1 if len(c) else t1
    arc = arrangement.pieces.curves.kind[source] == ARC
    gap = np.where(arc, gap - 2 * np.pi * np.round(gap / (2 * np.pi)), gap)
    ok &= (source[c] == source) & (np.abs(gap) <= 1e-9 * np.maximum(1.0, np.abs(t1)))
    ok &= (left[c] == left) & (right[c] == right) & (marker[c] == marker)
    return np.where(ok, candidate, -1)


def _runs(n: int, follower: np.ndarray) -> np.ndarray:
    """The chain of each edge; chains are numbered by their first edge."""
    at = np.flatnonzero(follower >= 0)
    return components(n, at, follower[at])[1]


def _nothing_left(program: Program) -> str:
    labels = [leaf.label for leaf in program.leaves]
    return f"the domain is empty: nothing with an interior is left of {_some(labels)}"


def _reaches_out(program: Program, arrangement: Arrangement, edge: int) -> str:
    a = arrangement.points[arrangement.tail[edge]]
    b = arrangement.points[arrangement.head[edge]]
    x, y = 0.5 * (a + b)
    leaves = [leaf.label for leaf in program.leaves if leaf.primitive.kind == "half_space"]
    return (
        f"the domain is unbounded beyond ({x:.6g}, {y:.6g}), where nothing cuts off "
        f"{_some(leaves)}; intersect the domain with a bounded shape"
    )


def _unbounded_around(program: Program, arrangement: Arrangement, outer: np.ndarray) -> str:
    on_outer = np.isin(arrangement.parent_edge, outer)
    owners = np.unique(arrangement.pieces.leaf[arrangement.parent_piece[on_outer]])
    leaves = [program.leaves[k].label for k in owners.tolist() if k < len(program.leaves)]
    x, y = arrangement.points[arrangement.tail[outer[0]]]
    return (
        f"the domain is unbounded: it holds everything around {_some(leaves)}, as near "
        f"({x:.6g}, {y:.6g}); intersect it with a bounded shape"
    )


def _some(labels: list[str]) -> str:
    return ", ".join(labels[:6]) + (", …" if len(labels) > 6 else "")

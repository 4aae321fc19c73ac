"""Pieces and their meeting points become a planar map of curved edges.

Points within the snap distance become one vertex, pieces are cut at their vertices, pieces that
run along one another become one edge with all of them as parents. From here on topology no longer
looks at coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.intersections import Meetings, candidate_pairs, meetings, project_pieces
from csgmesh.boundary.pieces import Frame, Pieces
from csgmesh.domain.curves import LINE
from csgmesh.graphs import components
from csgmesh.spatial import Boxes, near_pairs
from csgmesh.tolerance import ON_CURVE_SHARE

#: Where two pieces meet, their points differ by what solving for it left, which is no merge.
_MET = ON_CURVE_SHARE / 4


@dataclass(frozen=True, eq=False)
class Arrangement:
    """A planar map of curved edges.

    Attributes
    ----------
    pieces : Pieces
    vertices : (n, 2) float64
        In local coordinates.
    points : (n, 2) float64
        In user coordinates.
    tail, head : (m,) int64
        Vertices of each edge.
    source : (m,) int64
        The edge's curve: that of its first parent in tree order.
    t_tail, t_head : (m,) float64
        Parameters of that curve; increasing from tail to head.
    parent_edge, parent_piece, parent_sign : (p,) int64
        Which pieces lie on which edge, and whether the leaf is on the left (+1) or right (-1) of
        the edge; sorted by edge, then piece.
    probe_vertex : (q,) int64
        Vertex of each embedded point.
    merged : Merged
    """

    pieces: Pieces
    vertices: np.ndarray
    points: np.ndarray
    tail: np.ndarray
    head: np.ndarray
    source: np.ndarray
    t_tail: np.ndarray
    t_head: np.ndarray
    parent_edge: np.ndarray
    parent_piece: np.ndarray
    parent_sign: np.ndarray
    probe_vertex: np.ndarray
    merged: Merged


@dataclass(frozen=True, eq=False)
class Merged:
    """Points that moved by more than rounding when they became a vertex.

    Attributes
    ----------
    place : (k, 2) float64
        Vertices, in user coordinates.
    distance : (k,) float64
        How far a point moved, in user coordinates.
    piece : (k, 2) int64
        A piece through the point that moved, and one through the vertex.
    """

    place: np.ndarray
    distance: np.ndarray
    piece: np.ndarray


def arrange(pieces: Pieces, frame: Frame, probes: np.ndarray, snap: float) -> Arrangement:
    """Cut all pieces at their vertices and merge those that coincide.

    Parameters
    ----------
    pieces : Pieces
    frame : Frame
    probes : (q, 2) float64
        Embedded points in local coordinates.
    snap : float
        In local coordinates.
    """
    pairs = candidate_pairs(pieces, snap)
    meet = meetings(pieces, pairs, snap)
    cloud, user, owner = _cloud(pieces, frame, meet, probes)
    k, e = len(pieces), len(meet.first)
    busy = np.zeros(len(cloud), bool)
    busy[2 * k :] = True
    for part in (meet.first, meet.second):
        busy[part] = busy[part + k] = True
    if len(probes):  # An embedded point may lie on the end of any piece.
        busy[:] = True
    representative = _clusters(cloud, _end_links(cloud[: 2 * k], pairs, snap), busy, snap)
    chosen, vertex = _numbered_from_zero(representative)
    piece = np.concatenate([np.arange(k), np.arange(k), meet.first, meet.second])
    t = np.concatenate([pieces.lo, pieces.hi, meet.t_first, meet.t_second])
    event = vertex[2 * k : 2 * k + e]
    at = np.concatenate([vertex[:k], vertex[k : 2 * k], event, event])
    vertices, points = cloud[chosen], user[chosen]
    # Ends of pieces have been tried on their neighbours already; what is new is where pieces
    # meet, and where merging moved a point.
    new = np.zeros(len(chosen), bool)
    new[vertex[busy | (cloud != vertices[vertex]).any(1)]] = True
    near_piece, near_t, near_vertex = _vertices_on_pieces(
        pieces, vertices, np.flatnonzero(new), piece, at, snap
    )
    piece, t, at = (
        np.concatenate([piece, near_piece]),
        np.concatenate([t, near_t]),
        np.concatenate([at, near_vertex]),
    )
    edges = _cut(pieces, piece, t, at)
    met = slice(2 * k, None)
    moved = _displacements(
        vertices,
        np.concatenate([cloud, pieces.local.points(pieces.source[piece[met]], t[met])]),
        np.concatenate([vertex, at[met]]),
        np.concatenate([owner, piece[met]]),
        np.repeat(_roundings(frame), [len(cloud), len(piece[met])]),
    )
    merged = Merged(
        points[moved.vertex],
        moved.distance * frame.scale,
        np.column_stack([moved.piece, owner[chosen][moved.vertex]]),
    )
    return _merge_coincident(pieces, vertices, points, edges, vertex[2 * k + e :], merged, snap)


def _cloud(
    pieces: Pieces, frame: Frame, meet: Meetings, probes: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All points in local and user coordinates, and a piece through each.

    Ends of pieces come first, in tree order: where points merge, what the user wrote stays.
    """
    straight = pieces.curves.kind[pieces.source] == LINE
    # A line keeps the coordinate it is parallel to, to the bit.
    take = ~straight[meet.first] & straight[meet.second]
    through = np.where(take, meet.second, meet.first)
    t = np.where(take, meet.t_second, meet.t_first)
    everyone = np.arange(len(pieces))
    owner = np.concatenate([everyone, everyone, through])
    t = np.concatenate([pieces.lo, pieces.hi, t])
    source = pieces.source[owner]
    local = np.concatenate([pieces.local.points(source, t), probes])
    user = np.concatenate([pieces.curves.points(source, t), probes * frame.scale + frame.centre])
    owner = np.concatenate([owner, np.full(len(probes), -1)])
    return local, user, owner


def _end_links(ends: np.ndarray, pairs: np.ndarray, snap: float) -> np.ndarray:
    """Pairs of ends of neighbouring pieces no further apart than the snap distance, (k, 2)."""
    k = len(ends) // 2
    own = np.arange(k)
    links = [np.column_stack([own, own + k])]
    for shift_i in (0, k):
        for shift_j in (0, k):
            links.append(pairs + np.array([shift_i, shift_j]))
    found = np.concatenate(links)
    return found[np.hypot(*(ends[found[:, 0]] - ends[found[:, 1]]).T) <= snap]


def _clusters(cloud: np.ndarray, links: np.ndarray, busy: np.ndarray, snap: float) -> np.ndarray:
    """The lowest point of the cluster that each point belongs to, (n,).

    Parameters
    ----------
    cloud : (n, 2) float64
    links : (k, 2) int64
        Pairs known to be near.
    busy : (n,) bool
        Points whose other neighbours are still to be found.
    snap : float
    """
    n = len(cloud)
    some = np.flatnonzero(busy)
    # Cells far smaller than the snap distance first: a thousand lines through one point give half
    # a million events there, and their pairs would be too many to list.
    cell = np.floor(cloud[some] / (snap / 4)).astype(np.int64)
    order = np.lexsort((some, cell[:, 1], cell[:, 0]))
    first = np.r_[True, (cell[order][1:] != cell[order][:-1]).any(1)][: len(order)]
    lead = some[order[first]]
    same = np.column_stack([some[order], lead[np.cumsum(first) - 1]])
    near = lead[near_pairs(cloud[lead], snap)] if len(lead) else same
    pair = np.concatenate([links, same, near])
    count, label = components(n, pair[:, 0], pair[:, 1])
    lowest = np.full(count, n)
    np.minimum.at(lowest, label, np.arange(n))
    return lowest[label]


def _numbered_from_zero(representative: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The distinct representatives in order, and the place of each point's own among them."""
    own = representative == np.arange(len(representative))
    return np.flatnonzero(own), (np.cumsum(own) - 1)[representative]


def _vertices_on_pieces(
    pieces: Pieces,
    vertices: np.ndarray,
    new: np.ndarray,
    piece: np.ndarray,
    at: np.ndarray,
    snap: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """New vertices within the snap distance of a piece that does not know them yet."""
    none = np.zeros(0, np.int64)
    if len(new) == 0:
        return none, np.zeros(0), none
    a = pieces.local.points(pieces.source, pieces.lo)
    b = pieces.local.points(pieces.source, pieces.hi)
    boxes = Boxes(np.minimum(a, b) - snap, np.maximum(a, b) + snap)
    row, box = boxes.overlapping(vertices[new], vertices[new]).T
    row = new[row]
    known = np.sort(piece * len(vertices) + at)
    key = box * len(vertices) + row
    place = np.minimum(np.searchsorted(known, key), len(known) - 1)
    unknown = known[place] != key
    row, box = row[unknown], box[unknown]
    t = project_pieces(pieces, box, vertices[row])
    off = np.hypot(*(pieces.local.points(pieces.source[box], t) - vertices[row]).T)
    near = off <= snap
    return box[near], t[near], row[near]


@dataclass(frozen=True, eq=False)
class _Edges:
    piece: np.ndarray
    tail: np.ndarray
    head: np.ndarray
    t_tail: np.ndarray
    t_head: np.ndarray


def _cut(pieces: Pieces, piece: np.ndarray, t: np.ndarray, at: np.ndarray) -> _Edges:
    """Pieces between consecutive vertices; what begins and ends in one vertex vanishes.

    Parameters
    ----------
    pieces : Pieces
    piece, t, at : (k,)
        Piece, parameter and vertex of each cut; the starts of all pieces come first, then the ends.
    """
    k = len(pieces)
    whole = np.bincount(piece, minlength=k) == 2
    # Most pieces have nothing but their two ends, which come first and second.
    first_vertex, last_vertex = at[:k], at[k : 2 * k]
    straight = np.flatnonzero(whole & (first_vertex != last_vertex))
    split = ~whole[piece]
    piece, t, at = piece[split], t[split], at[split]
    ends_last = (t == pieces.hi[piece]).astype(np.int64) - (t == pieces.lo[piece])
    order = np.lexsort((at, ends_last, t, piece))
    piece, t, at = piece[order], t[order], at[order]
    same = (piece[1:] == piece[:-1]) & (at[1:] == at[:-1])
    keep = np.r_[True, ~same][: len(at)]
    piece, t, at = piece[keep], t[keep], at[keep]
    tail = np.flatnonzero(piece[1:] == piece[:-1])
    owner, end = piece[tail], t[tail + 1]
    # The last run of a piece reaches to the piece's end, whatever vertex of the run came first.
    last = np.r_[owner[1:] != owner[:-1], True][: len(owner)]
    end[last] = pieces.hi[owner[last]]
    owner = np.concatenate([straight, owner])
    order = np.argsort(owner, kind="stable")
    return _Edges(
        owner[order],
        np.concatenate([first_vertex[straight], at[tail]])[order],
        np.concatenate([last_vertex[straight], at[tail + 1]])[order],
        np.concatenate([pieces.lo[straight], t[tail]])[order],
        np.concatenate([pieces.hi[straight], end])[order],
    )


def _merge_coincident(
    pieces: Pieces,
    vertices: np.ndarray,
    points: np.ndarray,
    edges: _Edges,
    probe_vertex: np.ndarray,
    merged: Merged,
    snap: float,
) -> Arrangement:
    low, high = np.minimum(edges.tail, edges.head), np.maximum(edges.tail, edges.head)
    key = low * len(vertices) + high
    order = np.argsort(key, kind="stable")
    group = np.cumsum(np.r_[False, key[order][1:] != key[order][:-1]][: len(order)])
    group_of = np.empty(len(order), np.int64)
    group_of[order] = group
    label = np.full(len(order), -1)
    remaining = order
    n_edges = 0
    while len(remaining):
        # The first of each group leads; whoever runs along it joins it; the rest try again.
        g = group_of[remaining]
        first = np.r_[True, g[1:] != g[:-1]]
        lead = remaining[first][np.cumsum(first) - 1]
        joins = first.copy()
        other = np.flatnonzero(~first)
        joins[other] = _run_along(pieces, edges, lead[other], remaining[other], snap)
        number = n_edges + np.cumsum(first) - 1
        label[remaining[joins]] = number[joins]
        n_edges += int(first.sum())
        remaining = remaining[~joins]
    return _numbered(pieces, vertices, points, edges, label, n_edges, probe_vertex, merged)


def _numbered(
    pieces: Pieces,
    vertices: np.ndarray,
    points: np.ndarray,
    edges: _Edges,
    label: np.ndarray,
    n_edges: int,
    probe_vertex: np.ndarray,
    merged: Merged,
) -> Arrangement:
    lead = np.full(n_edges, len(label))
    np.minimum.at(lead, label, np.arange(len(label)))
    rank = np.empty(n_edges, np.int64)
    rank[np.argsort(lead, kind="stable")] = np.arange(n_edges)
    lead = np.sort(lead)
    edge = rank[label]
    along = (edges.tail == edges.tail[lead][edge]).astype(np.int64) * 2 - 1
    order = np.lexsort((edges.piece, edge))
    sign = along * pieces.forward[edges.piece]
    return Arrangement(
        pieces, vertices, points, edges.tail[lead], edges.head[lead],
        pieces.source[edges.piece[lead]], edges.t_tail[lead], edges.t_head[lead],
        edge[order], edges.piece[order], sign[order], probe_vertex, merged,
    )  # fmt: skip


def _run_along(
    pieces: Pieces, edges: _Edges, a: np.ndarray, b: np.ndarray, snap: float
) -> np.ndarray:
    """Whether edges b run along edges a, whose ends they share, within the snap distance."""
    out = np.ones(len(a), bool)
    pa, pb = edges.piece[a], edges.piece[b]
    bent = (pieces.local.kind[pieces.source[pa]] != LINE) | (
        pieces.local.kind[pieces.source[pb]] != LINE
    )
    for share in (0.5, 0.25, 0.75):
        k = np.flatnonzero(out & bent)
        t = edges.t_tail[a[k]] + share * (edges.t_head[a[k]] - edges.t_tail[a[k]])
        p = pieces.local.points(pieces.source[pa[k]], t)
        s = project_pieces(pieces, pb[k], p)
        q = pieces.local.points(pieces.source[pb[k]], s)
        # Ends of merged vertices lie up to the snap distance off their curves.
        out[k] = np.hypot(*(p - q).T) <= 2 * snap
    return out


@dataclass(frozen=True, eq=False)
class _Moved:
    vertex: np.ndarray
    distance: np.ndarray
    piece: np.ndarray


def _roundings(frame: Frame) -> tuple[float, float]:
    """Distances that mean nothing: of equal points, and of two pieces where they meet."""
    same = 64 * np.finfo(float).eps + 4 * np.spacing(np.abs(frame.centre).max()) / frame.scale
    return float(same), max(float(same), _MET)


def _displacements(
    vertices: np.ndarray,
    places: np.ndarray,
    vertex: np.ndarray,
    piece: np.ndarray,
    rounding: np.ndarray,
) -> _Moved:
    """For each vertex the place, and a piece there, that moved furthest to become it.

    A meeting stands on one of its pieces, and may be the snap distance away from the other.
    """
    off = np.hypot(*(places - vertices[vertex]).T)
    far = np.flatnonzero(off > rounding)
    order = far[np.lexsort((far, -off[far], vertex[far]))]
    first = order[np.r_[True, vertex[order][1:] != vertex[order][:-1]]] if len(order) else order
    return _Moved(vertex[first], off[first], piece[first])

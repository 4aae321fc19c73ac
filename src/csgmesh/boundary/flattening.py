"""Chains become chords: fine enough for the deviation, and never crossing what their curves do not.

Between a chord and its curve lies a lens. Where another chord crosses the chord, or one of its
points lies in the lens, the chord is halved: two arcs nearer to each other than the chord error
are resolved by finer chords.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.arrangement import Arrangement
from csgmesh.boundary.chains import Chains
from csgmesh.domain.curves import CUBIC, LINE, Curves, cross
from csgmesh.errors import EvaluationError, ShapeError
from csgmesh.spatial import Boxes
from csgmesh.tolerance import DEVIATION_SHARE

#: Largest turning of a curve over one chord, in radians: diametral circles protect curves that
#: turn less, and a closed curve needs three chords to be one.
_TURN = np.pi / 4

#: Largest distance of a chord from its curve, as a share of the gap to the next curve.
_GAP_SHARE = 0.5

_ROUNDS = 64


@dataclass(frozen=True, eq=False)
class Chords:
    """Straight pieces of chains, in the order of chains and parameters.

    Attributes
    ----------
    chain : (m,) int64
    t0, t1 : (m,) float64
        Curve parameters at both ends.
    tail, head : (m,) int64
        Points; numbers below the number of vertices are vertices of the arrangement.
    points : (n, 2) float64
        The arrangement's vertices first, in the coordinates of the curves that were asked.
    """

    chain: np.ndarray
    t0: np.ndarray
    t1: np.ndarray
    tail: np.ndarray
    head: np.ndarray
    points: np.ndarray


def flatten(
    arrangement: Arrangement, chains: Chains, deviation: float | None, snap: float
) -> Chords:
    """Chords of all chains, their points in user coordinates.

    Parameters
    ----------
    arrangement : Arrangement
    chains : Chains
    deviation : float, optional
        Largest distance of a chord from its curve in user coordinates; a share of the leaf's extent
        by default.
    snap : float
        In local coordinates.

    Raises
    ------
    EvaluationError
        If chords cross that no refinement separates; the message says where.
    """
    counts = _chord_counts(arrangement, chains, deviation)
    chain = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(chain)) - np.repeat(np.cumsum(counts) - counts, counts)
    t0, t1 = chains.t0[chain], chains.t1[chain]
    begin = t0 + step / counts[chain] * (t1 - t0)
    suspects = _suspect_chains(arrangement, chains, snap)
    involved = np.zeros(len(counts), bool)
    involved[suspects] = True
    busy = involved[chain]
    if busy.any():
        fine_chain, fine_begin = _without_conflicts(
            arrangement, chains, chain[busy], begin[busy], suspects, snap
        )
        chain = np.concatenate([chain[~busy], fine_chain])
        order = np.argsort(chain, kind="stable")
        chain, begin = chain[order], np.concatenate([begin[~busy], fine_begin])[order]
    return _chords(arrangement.pieces.curves, arrangement.points, chains, chain, begin)


def _without_conflicts(
    arrangement: Arrangement,
    chains: Chains,
    chain: np.ndarray,
    begin: np.ndarray,
    suspects: np.ndarray,
    snap: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Chain and start parameter of chords, halved until none is in conflict with another."""
    local, vertices = arrangement.pieces.local, arrangement.vertices
    for _ in range(_ROUNDS):
        chords = _chords(local, vertices, chains, chain, begin)
        halve, stuck = _conflicts(arrangement, chains, chords, suspects, snap)
        if stuck.any():
            first = np.flatnonzero(stuck)[:1]
            x, y = arrangement.pieces.curves.points(chains.source[chain[first]], begin[first])[0]
            raise EvaluationError(
                f"boundaries near ({x:.6g}, {y:.6g}) come closer than rounding can keep apart; "
                "give a larger snap"
            )
        if not halve.any():
            break
        # Only where a chain has new chords can there be new conflicts.
        changed = np.zeros(len(chains.source), bool)
        changed[chain[halve]] = True
        suspects = suspects[changed[suspects].any(axis=1)]
        middle = 0.5 * (chords.t0 + chords.t1)[halve]
        at = np.flatnonzero(halve) + 1
        chain, begin = np.insert(chain, at, chain[halve]), np.insert(begin, at, middle)
    return chain, begin


def _chord_counts(arrangement: Arrangement, chains: Chains, deviation: float | None) -> np.ndarray:
    pieces = arrangement.pieces
    width = chains.t1 - chains.t0
    bend = pieces.curves.second_derivative_bounds()[chains.source]
    share = DEVIATION_SHARE * pieces.extent[chains.source]
    allowed = np.full(len(width), deviation) if deviation is not None else share
    with np.errstate(invalid="ignore", divide="ignore"):
        counts = np.ceil(np.sqrt(width**2 * bend / (8 * allowed)) * (1 - 1e-12))
    if not (counts < 1e8).all():
        raise ShapeError(f"deviation {deviation!r} asks for more than 1e8 chords a curve")
    counts = np.maximum(counts, np.ceil(_turning(pieces.curves, chains) / _TURN * (1 - 1e-12)))
    # A curve that is straight to within its deviation still needs its two ends to differ.
    counts = np.maximum(counts, np.where(chains.tail == chains.head, 3, 1))
    return counts.astype(np.int64)


def _turning(curves: Curves, chains: Chains) -> np.ndarray:
    """Total turning of the tangent along each chain, in radians."""
    out = np.zeros(len(chains.source))
    bent = np.flatnonzero(curves.kind[chains.source] != LINE)
    n = 17
    t = chains.t0[bent, None] + (chains.t1 - chains.t0)[bent, None] * np.linspace(0, 1, n)
    d = curves.derivatives(np.repeat(chains.source[bent], n), t.ravel()).reshape(-1, n, 2)
    a, b = d[:, :-1].reshape(-1, 2), d[:, 1:].reshape(-1, 2)
    turn = np.abs(np.arctan2(cross(a, b), (a * b).sum(1)))
    out[bent] = turn.reshape(-1, n - 1).sum(1)
    return out


def _chords(
    curves: Curves, vertices: np.ndarray, chains: Chains, chain: np.ndarray, begin: np.ndarray
) -> Chords:
    """Chords that begin at the given parameters, sorted by chain and parameter."""
    new = chain[1:] != chain[:-1]
    first, last = np.r_[True, new], np.r_[new, True]
    tail = np.empty(len(chain), np.int64)
    tail[first] = chains.tail[chain[first]]
    inner = np.flatnonzero(~first)
    tail[inner] = len(vertices) + np.arange(len(inner))
    head = np.r_[tail[1:], -1]
    head[last] = chains.head[chain[last]]
    end = np.r_[begin[1:], 0.0]
    end[last] = chains.t1[chain[last]]
    points = np.concatenate([vertices, curves.points(chains.source[chain[inner]], begin[inner])])
    return Chords(chain, begin, end, tail, head, points)


def _suspect_chains(arrangement: Arrangement, chains: Chains, snap: float) -> np.ndarray:
    """Pairs of chains, at least one of them bent, that may come near each other, (k, 2)."""
    pieces = arrangement.pieces
    interval = np.column_stack([chains.t0, chains.t1])
    local = pieces.local[chains.source]
    bent = np.flatnonzero(local.kind != LINE)
    if len(bent) == 0:
        return np.zeros((0, 2), np.int64)
    lo, hi = Curves(local.kind, local.data, interval).bounds()
    found = Boxes(lo, hi).overlapping(lo[bent] - 2 * snap, hi[bent] + 2 * snap)
    first, second = bent[found[:, 0]], found[:, 1]
    twice = (local.kind[second] != LINE) & (second <= first)
    pair = np.sort(np.column_stack([first, second])[~twice], axis=1)
    # A cubic may come near itself; lines, arcs and quadratics are convex.
    own = np.flatnonzero(local.kind == CUBIC)
    return np.concatenate([pair, np.column_stack([own, own])])


def _conflicts(
    arrangement: Arrangement, chains: Chains, chords: Chords, suspects: np.ndarray, snap: float
) -> tuple[np.ndarray, np.ndarray]:
    """Chords to halve, and chords in conflict that are straight to within rounding already."""
    local = arrangement.pieces.local
    source = chains.source[chords.chain]
    sag = (chords.t1 - chords.t0) ** 2 * local.second_derivative_bounds()[source] / 8
    pair = _near_chords(chains, chords, suspects, sag)
    i, j = pair.T
    shared = _shared(chords, i, j)
    bad = np.zeros(len(pair), bool)
    bad[shared == 2] = True
    at = np.flatnonzero(shared == 0)
    bad[at] = _touch(chords, i[at], j[at])
    # Between curves that keep apart the gap sets the scale; where they meet it falls to nothing.
    at = np.flatnonzero((shared == 0) & ~bad & ~_chains_meet(chains, chords, i, j))
    bad[at] = np.maximum(sag[i[at]], sag[j[at]]) > _GAP_SHARE * _distance(chords, i[at], j[at])
    at = np.flatnonzero(shared == 1)
    bad[at] = _disordered(local, source, chords, i[at], j[at])
    halve = np.zeros(len(chords.chain), bool)
    smallest = snap / 256
    # One at a time: halving both of two tangent arcs alike would leave them as alike as before.
    larger = np.where(sag[i] >= sag[j], i, j)
    halve[larger[bad]] = True
    for a, b in ((i, j), (j, i)):
        bulging = np.flatnonzero(sag[a] > smallest)
        inside = _in_lens(local, source, chords, a[bulging], b[bulging], snap)
        halve[a[bulging[inside]]] = True
    stuck = halve & (sag <= smallest)
    return halve & ~stuck, stuck


def _near_chords(
    chains: Chains, chords: Chords, suspects: np.ndarray, sag: np.ndarray
) -> np.ndarray:
    """Pairs of chords of suspect chains whose lenses' boxes overlap, (k, 2)."""
    n = len(chains.source)
    involved = np.zeros(n, bool)
    involved[suspects] = True
    at = np.flatnonzero(involved[chords.chain])
    a, b = chords.points[chords.tail[at]], chords.points[chords.head[at]]
    reach = sag[at, None]
    pair = at[Boxes(np.minimum(a, b) - reach, np.maximum(a, b) + reach).pairs()]
    ends = np.sort(chords.chain[pair], axis=1)
    wanted = np.unique(suspects[:, 0] * n + suspects[:, 1])
    key = ends[:, 0] * n + ends[:, 1]
    place = np.minimum(np.searchsorted(wanted, key), len(wanted) - 1)
    pair = pair[wanted[place] == key]
    # Neighbours on one curve meet at their common point and nowhere else.
    same = chords.chain[pair[:, 0]] == chords.chain[pair[:, 1]]
    return pair[~(same & (_shared(chords, *pair.T) > 0))]


def _shared(chords: Chords, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    count = np.zeros(len(i), np.int64)
    for x in (chords.tail[i], chords.head[i]):
        count += (x == chords.tail[j]) | (x == chords.head[j])
    return count


def _chains_meet(chains: Chains, chords: Chords, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    a, b = chords.chain[i], chords.chain[j]
    meet = a == b
    for x in (chains.tail[a], chains.head[a]):
        meet |= (x == chains.tail[b]) | (x == chains.head[b])
    return meet


def _distance(chords: Chords, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Distance between chords that do not cross: that of an end of one from the other."""
    out = np.full(len(i), np.inf)
    for k, other in ((i, j), (j, i)):
        a, b = chords.points[chords.tail[other]], chords.points[chords.head[other]]
        along = b - a
        for end in (chords.tail[k], chords.head[k]):
            q = chords.points[end]
            share = np.clip(((q - a) * along).sum(1) / (along * along).sum(1), 0.0, 1.0)
            out = np.minimum(out, np.hypot(*(q - a - share[:, None] * along).T))
    return out


def _touch(chords: Chords, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Whether chords without a common end cross or touch, rounding counted as touching."""
    p, q = chords.points[chords.tail[i]], chords.points[chords.head[i]]
    r, s = chords.points[chords.tail[j]], chords.points[chords.head[j]]

    def same_side(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
        along = b - a
        x, y = cross(along, c - a), cross(along, d - a)
        noise = 8 * np.finfo(float).eps * np.abs(along).sum(1)
        return ((x > noise) & (y > noise)) | ((x < -noise) & (y < -noise))

    return ~(same_side(p, q, r, s) | same_side(r, s, p, q) | _boxes_apart(p, q, r, s))


def _boxes_apart(p: np.ndarray, q: np.ndarray, r: np.ndarray, s: np.ndarray) -> np.ndarray:
    below = np.maximum(p, q) < np.minimum(r, s)
    above = np.minimum(p, q) > np.maximum(r, s)
    return (below | above).any(1)


def _disordered(
    local: Curves, source: np.ndarray, chords: Chords, i: np.ndarray, j: np.ndarray
) -> np.ndarray:
    """Whether chords from a common point leave it in another order than their curves."""
    from_head_i = (chords.head[i] == chords.tail[j]) | (chords.head[i] == chords.head[j])
    from_head_j = (chords.head[j] == chords.tail[i]) | (chords.head[j] == chords.head[i])
    origin = chords.points[np.where(from_head_i, chords.head[i], chords.tail[i])]
    d_i = chords.points[np.where(from_head_i, chords.tail[i], chords.head[i])] - origin
    d_j = chords.points[np.where(from_head_j, chords.tail[j], chords.head[j])] - origin
    reach = np.minimum(np.hypot(*d_i.T), np.hypot(*d_j.T))
    turn = cross(d_i, d_j)
    true = np.zeros(len(i))
    # Chords at a wide angle are in order whatever their curves do.
    narrow = np.flatnonzero((d_i * d_j).sum(1) > 0)
    if len(narrow):
        k = narrow
        p = _along(local, source, chords, i[k], from_head_i[k], reach[k])
        q = _along(local, source, chords, j[k], from_head_j[k], reach[k])
        true[k] = cross(p, q)
    noise = 8 * np.finfo(float).eps * np.abs(d_i).sum(1)
    out = np.zeros(len(i), bool)
    out[narrow] = ((np.abs(turn) <= noise) | (np.sign(turn) != np.sign(true)))[narrow]
    return out


def _along(
    local: Curves,
    source: np.ndarray,
    chords: Chords,
    k: np.ndarray,
    from_head: np.ndarray,
    reach: np.ndarray,
) -> np.ndarray:
    """Curve points at a distance from an end of a chord, relative to that end of the curve."""
    start = np.where(from_head, chords.t1[k], chords.t0[k])
    end = np.where(from_head, chords.t0[k], chords.t1[k])
    origin = local.points(source[k], start)
    low, high = np.zeros(len(k)), np.ones(len(k))
    for _ in range(50):
        middle = 0.5 * (low + high)
        p = local.points(source[k], start + middle * (end - start))
        near = np.hypot(*(p - origin).T) < reach
        low, high = np.where(near, middle, low), np.where(near, high, middle)
    return local.points(source[k], start + high * (end - start)) - origin


def _in_lens(
    local: Curves, source: np.ndarray, chords: Chords, i: np.ndarray, j: np.ndarray, snap: float
) -> np.ndarray:
    """Whether a point of chord j's curve lies between chord i and its curve."""
    a, b = chords.points[chords.tail[i]], chords.points[chords.head[i]]
    along = b - a
    middle = 0.5 * (chords.t0 + chords.t1)
    bulge = np.sign(cross(along, local.points(source[i], middle[i]) - a))
    out = np.zeros(len(i), bool)
    tips = (
        (chords.points[chords.tail[j]], chords.tail[j]),
        (chords.points[chords.head[j]], chords.head[j]),
        (local.points(source[j], middle[j]), np.full(len(j), -1)),
    )
    for q, number in tips:
        shared = (number == chords.tail[i]) | (number == chords.head[i])
        along_share = ((q - a) * along).sum(1) / (along * along).sum(1)
        side = cross(along, q - a) * bulge
        k = np.flatnonzero(~shared & ~out & (side >= 0) & (along_share > 0) & (along_share < 1))
        if len(k) == 0:
            continue
        t = local.project(source[i[k]], q[k], chords.t0[i[k]], chords.t1[i[k]])
        off = q[k] - local.points(source[i[k]], t)
        beyond = cross(local.derivatives(source[i[k]], t), off) * bulge[k]
        # Seen along the curve, the chord lies to the left where the curve bulges to the right.
        out[k] = beyond < 0
    return out

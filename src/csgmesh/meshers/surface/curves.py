"""Where the vertices of curves go: as far apart as sizes ask, on the exact curves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surface_mesh import project_on_pairs
from csgmesh.meshers.surface.complexes import FeatureComplex

#: A sample this near to a point of the polyline, as a share of the spacing, is that point.
_SAME = 0.02
#: Places a piece at which sizes are asked for, at least and at most.
_FEWEST, _MOST = 4, 2000


@dataclass(frozen=True, eq=False)
class Samples:
    """New vertices of curves.

    Attributes
    ----------
    kept : (k,) int64
        Points of the Plc that stay.
    segment : (n,) int64
        Piece that each new vertex lies on; those of one piece come from its end to its start.
    points : (n, 3) float64
    """

    kept: np.ndarray
    segment: np.ndarray
    points: np.ndarray


@dataclass(frozen=True, eq=False)
class _Chain:
    """A curve's pieces in order, and which of them are travelled backwards."""

    pieces: np.ndarray
    reversed: np.ndarray
    vertices: np.ndarray
    is_closed: bool


def sample_curves(
    plc: Plc, parts: FeatureComplex, size: Callable[[np.ndarray], np.ndarray], cap: np.ndarray
) -> Samples:
    """Vertices for all curves; `cap` (n,) bounds sizes at the points of the Plc."""
    chains = _chains(parts)
    fewest = _fewest(chains, parts)
    segments, points = [], []
    kept = [np.flatnonzero(parts.dim == 0)]
    stations = _Stations(plc.points, parts.segments, size, cap)
    for curve, chain in enumerate(chains):
        piece, share, near = _places(chain, stations, fewest[curve])
        kept.append(near)
        segments.append(piece)
        points.append(share)
    segment, share = np.concatenate([*segments, []]).astype(int), np.concatenate([*points, []])
    order = np.lexsort((-share, segment))
    segment, share = segment[order], share[order]
    a, b = (plc.points[parts.segments[segment, k]] for k in (0, 1))
    flat = a + share[:, None] * (b - a)
    exact = project_on_pairs(plc.surfaces, parts.curve_surfaces[parts.segment_curve[segment]], flat)
    # No nearer than this does a piece follow its curve; where surfaces nearly touch, Newton's
    # method may run away along them.
    away = np.sqrt(((exact - flat) ** 2).sum(axis=1))
    trusted = away <= 0.3 * np.sqrt(((b - a) ** 2).sum(axis=1))
    return Samples(np.concatenate(kept), segment, np.where(trusted[:, None], exact, flat))


def _chains(parts: FeatureComplex) -> list[_Chain]:
    """The pieces of each curve in order."""
    ends = parts.segments.tolist()
    at: dict[int, list[int]] = {}
    members: list[list[int]] = [[] for _ in range(len(parts.curve_surfaces))]
    for s, c in enumerate(parts.segment_curve.tolist()):
        members[c].append(s)
    is_corner = (parts.dim == 0).tolist()
    for s, (a, b) in enumerate(ends):
        at.setdefault(a, []).append(s)
        at.setdefault(b, []).append(s)
    chains = []
    for own in members:
        start = next(((s, v) for s in own for v in ends[s] if is_corner[v]), None)
        s, v = start or (own[0], ends[own[0]][0])
        pieces, backwards, vertices = [], [], [v]
        while True:
            a, b = ends[s]
            pieces.append(s)
            backwards.append(a != v)
            v = b if a == v else a
            vertices.append(v)
            if is_corner[v] or len(pieces) == len(own):
                break
            one, two = at[v]
            s = two if one == s else one
        chains.append(
            _Chain(np.array(pieces), np.array(backwards), np.array(vertices), start is None)
        )
    return chains


def _fewest(chains: list[_Chain], parts: FeatureComplex) -> list[int]:
    """Fewest segments of each curve, so that no two segments have the same ends."""
    ends = [tuple(sorted((int(c.vertices[0]), int(c.vertices[-1])))) for c in chains]
    count: dict[tuple[int, ...], int] = {}
    for pair in ends:
        count[pair] = count.get(pair, 0) + 1
    return [
        3 if c.is_closed or pair[0] == pair[1] else 2 if count[pair] > 1 else 1
        for c, pair in zip(chains, ends, strict=True)
    ]


class _Stations:
    """Places on all pieces at which sizes are known."""

    def __init__(
        self,
        points: np.ndarray,
        segments: np.ndarray,
        size: Callable[[np.ndarray], np.ndarray],
        cap: np.ndarray,
    ) -> None:
        a, b = points[segments[:, 0]], points[segments[:, 1]]
        self.length = np.sqrt(((b - a) ** 2).sum(axis=1))
        ends = np.minimum(size(a), size(b)) if len(a) else np.zeros(0)
        ends = np.minimum(ends, cap[segments].min(axis=1))
        steps = np.clip(np.ceil(2.0 * self.length / ends), _FEWEST, _MOST).astype(int)
        self.first = np.concatenate([[0], np.cumsum(steps + 1)])
        piece = np.repeat(np.arange(len(a)), steps + 1)
        self.share = (np.arange(len(piece)) - self.first[piece]) / steps[piece]
        t = self.share[:, None]
        places = (1.0 - t) * a[piece] + t * b[piece]
        bound = (1.0 - self.share) * cap[segments[piece, 0]] + self.share * cap[segments[piece, 1]]
        self.density = 1.0 / np.minimum(size(places), bound) if len(a) else np.zeros(0)


def _places(
    chain: _Chain, stations: _Stations, fewest: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Piece and share along it of each new vertex, and old points that stay."""
    share, density, where, piece = [], [], [], []
    done = 0.0
    for s, backwards in zip(chain.pieces.tolist(), chain.reversed.tolist(), strict=True):
        own = slice(stations.first[s], stations.first[s + 1])
        along, dense = stations.share[own], stations.density[own]
        dense = dense[::-1] if backwards else dense
        share.append(along)
        density.append(dense)
        where.append(done + stations.length[s] * along)
        piece.append(np.full(len(along), s))
        done += stations.length[s]
    x, rho = np.concatenate(where), np.concatenate(density)
    total = np.concatenate([[0.0], np.cumsum(0.5 * (rho[1:] + rho[:-1]) * np.diff(x))])
    n = max(round(float(total[-1])), fewest)
    arc = np.interp(total[-1] * np.arange(not chain.is_closed, n) / n, total, x)
    begin = np.concatenate([[0.0], np.cumsum(stations.length[chain.pieces])])
    k = np.clip(np.searchsorted(begin, arc, side="right") - 1, 0, len(chain.pieces) - 1)
    length = stations.length[chain.pieces[k]]
    t = (arc - begin[k]) / np.where(length > 0.0, length, 1.0)
    spacing = done / n
    near = np.where(t > 0.5, k + 1, k)
    same = np.abs(arc - begin[near]) < np.minimum(_SAME * spacing, 0.3 * length)
    t = np.where(chain.reversed[k], 1.0 - t, t)
    return chain.pieces[k[~same]], t[~same], chain.vertices[near[same]]

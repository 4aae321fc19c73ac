"""Thin walls and gaps of a solid: how near two pieces of its boundary are that face each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.graphs import components
from csgmesh.size.facet_tree import FacetTree

#: Pieces of a boundary face each other where they open by less than this: cos 45°.
FACING = np.sqrt(0.5)
#: Faces that share an edge face each other where they open by less than this share of their angle
#: there: those of a lens do in its middle, those of a wedge do nowhere.
PARALLEL = 0.5
#: Distances on a piece that differ by no more than this factor count as one.
EVEN = 1.5
#: Rays begin so far from the corners of a piece, as a share of the way to its centre.
_INWARD = 0.02
#: Nothing counts that is nearer than this share of the diagonal: the facet itself and its
#: neighbours in one plane. A tenth of what evaluation leaves apart.
_OWN = 1e-11
#: Longest edge of what rays are tried against, as a share of the diagonal: long facets lie in
#: many a ray's way.
_TARGET = 0.04
_CUTS = 64
#: More pieces than this are cut no further.
_PIECES = 400_000


@dataclass(frozen=True, eq=False)
class Walls:
    """Pieces of a boundary that face others across a region.

    Attributes
    ----------
    triangles : (k, 3, 3) float64
    facet : (k,) int64
        Facet of the domain that each is a part of.
    width : (k,) float64
        Distance of what faces each, along its normal: the smallest at four places.
    """

    triangles: np.ndarray
    facet: np.ndarray
    width: np.ndarray


def walls(
    domain: Plc,
    reach: Callable[[np.ndarray], np.ndarray],
    spacing: float,
    share: float,
    least: float,
) -> Walls:
    """Where pieces of a boundary face others nearer than `reach`, inside some region.

    From places on each facet rays go along the normal into the regions on both sides. Distances
    are those of the flat facets.

    Parameters
    ----------
    domain : Plc
    reach : callable
        How far to look at points (n, 3), as (n,).
    spacing : float
        Longest edge of a piece looked at first, as a share of the reach.
    share : float
        Pieces are cut where distances on them differ, until no edge is longer than this share of
        the smallest.
    least : float
        Nor are they where the distance is below this.
    """
    seen = _Facing(domain)
    pieces = _Pieces.of(domain).cut_to(lambda points: spacing * reach(points))
    centre = pieces.centres()
    near = np.isfinite(seen.distance(centre, pieces, reach(centre)))
    pieces = pieces[near]
    done, widths = [pieces[:0]], [np.zeros(0)]
    for _ in range(_CUTS):
        if not len(pieces.facet):
            break
        low, high = _extremes(seen, pieces, reach)
        known = np.isfinite(low)
        pieces, low, high = pieces[known], low[known], high[known]
        settled = (high <= EVEN * low) | (pieces.longest() <= share * low) | (low < least)
        settled |= len(pieces.facet) > _PIECES
        done.append(pieces[settled])
        widths.append(low[settled])
        pieces = pieces[~settled].halved()
    found = _Pieces.joined(done)
    return Walls(found.corners, found.facet, np.concatenate(widths))


def _extremes(
    seen: _Facing, pieces: _Pieces, reach: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest distance seen from each piece's centre and from beside its corners."""
    centre = pieces.centres()
    far = reach(centre)
    found = [seen.distance(centre, pieces, far)]
    for k in range(3):
        corner = pieces.corners[:, k]
        found.append(seen.distance(corner + _INWARD * (centre - corner), pieces, far))
    return np.min(found, axis=0), np.max(found, axis=0)


@dataclass(frozen=True, eq=False)
class _Pieces:
    """Parts (k, 3, 3) of facets, each looking to one side: -1 backward, 1 forward."""

    corners: np.ndarray
    facet: np.ndarray
    side: np.ndarray

    @staticmethod
    def of(domain: Plc) -> _Pieces:
        region = domain.facet_region
        facet = np.concatenate([np.flatnonzero(region[:, k] >= 0) for k in (0, 1)])
        n_back = int((region[:, 0] >= 0).sum())
        side = np.where(np.arange(len(facet)) < n_back, -1.0, 1.0)
        return _Pieces(domain.points[domain.facets[facet]], facet, side)

    @staticmethod
    def joined(parts: list[_Pieces]) -> _Pieces:
        """All of some, in turn."""
        return _Pieces(
            np.concatenate([p.corners for p in parts]),
            np.concatenate([p.facet for p in parts]),
            np.concatenate([p.side for p in parts]),
        )

    def __getitem__(self, which: np.ndarray | slice) -> _Pieces:
        return _Pieces(self.corners[which], self.facet[which], self.side[which])

    def longest(self) -> np.ndarray:
        """Length of the longest edge of each."""
        return np.sqrt(np.maximum.reduce(self._squares()))

    def centres(self) -> np.ndarray:
        """Middle of each, (k, 3)."""
        a, b, c = (self.corners[:, k] for k in range(3))
        return np.asarray((a + b + c) / 3.0)

    def _squares(self) -> list[np.ndarray]:
        """Squared lengths of the edges from each corner to the next."""
        p = self.corners
        edges = (p[:, (k + 1) % 3] - p[:, k] for k in range(3))
        return [x * x + y * y + z * z for x, y, z in (e.T for e in edges)]

    def halved(self) -> _Pieces:
        """Both halves of each, on the two sides of the middle of its longest edge."""
        n = np.arange(len(self.facet))
        k = np.argmax(self._squares(), axis=0)
        a, b, c = (self.corners[n, (k + j) % 3] for j in range(3))
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
        return _Pieces(corners, np.tile(self.facet, 2), np.tile(self.side, 2))

    def cut_to(self, length: Callable[[np.ndarray], np.ndarray]) -> _Pieces:
        """All of them halved until no edge is longer than allowed at the centre."""
        done: list[_Pieces] = []
        left, total = self, len(self.facet)
        for _ in range(_CUTS):
            long = left.longest() > length(left.centres())
            long &= total < _PIECES
            done.append(left[~long])
            if not long.any():
                break
            left = left[long].halved()
            total += len(left.facet) // 2
        return _Pieces.joined(done)


class _Facing:
    """What pieces of a boundary see of one another."""

    def __init__(self, domain: Plc) -> None:
        self.domain = domain
        corners = domain.points[domain.facets]
        length = _TARGET * domain.diagonal
        targets = _Pieces(corners, np.arange(domain.n_facets), np.ones(domain.n_facets))
        targets = targets.cut_to(lambda points: np.full(len(points), length))
        self.tree, self.facet = FacetTree(targets.corners), targets.facet
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.normal = normal / np.sqrt((normal**2).sum(axis=1))[:, None]

    def distance(self, places: np.ndarray, pieces: _Pieces, reach: np.ndarray) -> np.ndarray:
        """Distance of what faces each piece from a place on it, infinite beyond reach."""
        ways = pieces.side[:, None] * self.normal[pieces.facet]
        least = _OWN * self.domain.diagonal
        distance, met = self.tree.first_met(places, ways, least, reach)
        hit = np.flatnonzero(met >= 0)
        way, own, other = ways[hit], pieces.facet[hit], self.facet[met[hit]]
        cosine = (way * self.normal[other]).sum(axis=1)
        region = self.domain.facet_region
        between = np.where(pieces.side[hit] < 0, region[own, 0], region[own, 1])
        # Seen from behind, or from in front: its side towards the piece belongs to the region.
        behind = np.where(cosine > 0, region[other, 0], region[other, 1])
        facing = (np.abs(cosine) > FACING) & (between == behind)
        at = np.flatnonzero(facing)
        facing[at] = np.arccos(np.minimum(np.abs(cosine[at]), 1.0)) < self._allowed(
            own[at], other[at]
        )
        distance[hit[~facing]] = np.inf
        return distance

    def _allowed(self, own: np.ndarray, other: np.ndarray) -> np.ndarray:
        """How far the faces of two facets may open to face each other, radians."""
        if not len(own):
            return np.zeros(0)
        face, key, angle = self._corners
        pair = _pair(face[own], face[other], len(face))
        place = np.minimum(np.searchsorted(key, pair), max(len(key) - 1, 0))
        if not len(key):
            return np.full(len(own), np.inf)
        return np.where(key[place] == pair, PARALLEL * angle[place], np.inf)

    @cached_property
    def _corners(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Face of each facet; pairs of faces that share an edge, and their least angle there."""
        domain = self.domain
        start = domain.facets.ravel()
        end = domain.facets[:, [1, 2, 0]].ravel()
        edge = _pair(start, end, domain.n_points)
        order = np.argsort(edge, kind="stable")
        edge, facet = edge[order], order // 3
        key = np.column_stack([domain.facet_surface, domain.facet_region])
        face = components(domain.n_facets, *_joined(edge, facet, key))[1]
        # In the plane of each facet, away from the edge.
        along = domain.points[end[order]] - domain.points[start[order]]
        inward = np.cross(self.normal[facet], along)
        inward /= np.sqrt((inward**2).sum(axis=1))[:, None]
        pairs, angles = [np.zeros(0, np.int64)], [np.zeros(0)]
        step = 1
        while True:
            same = np.flatnonzero(edge[step:] == edge[:-step])
            if not len(same):
                break
            one, two = face[facet[same]], face[facet[same + step]]
            cosine = (inward[same] * inward[same + step]).sum(axis=1)
            differ = one != two
            pairs.append(_pair(one, two, domain.n_facets)[differ])
            angles.append(np.arccos(np.clip(cosine[differ], -1.0, 1.0)))
            step += 1
        pair, angle = np.concatenate(pairs), np.concatenate(angles)
        order = np.lexsort((angle, pair))
        first = np.flatnonzero(np.diff(pair[order], prepend=-1) != 0)
        return face, pair[order][first], angle[order][first]


def _joined(edge: np.ndarray, facet: np.ndarray, key: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Neighbouring facets of one face, from the facets at each edge in turn."""
    same = np.flatnonzero(edge[1:] == edge[:-1])
    one, two = facet[same], facet[same + 1]
    alike = (key[one] == key[two]).all(axis=1)
    return one[alike], two[alike]


def _pair(a: np.ndarray, b: np.ndarray, n: int) -> np.ndarray:
    """One number for two below `n`, whatever their order."""
    return np.asarray(np.minimum(a, b) * n + np.maximum(a, b))

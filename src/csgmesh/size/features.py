"""Features of a domain's boundary: smooth chains of segments, and the corners between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.pslg import Pslg

#: A vertex at which the boundary turns by less than this many degrees is no corner.
SMOOTH = 60.0
#: Directions between the normals at a corner that points into the domain, degrees apart.
FAN = 20.0


@dataclass(frozen=True, eq=False)
class Corners:
    """Corners of a domain and the chains that end there.

    Attributes
    ----------
    chain : (m,) int64
        Smooth chain of each segment.
    vertex : (c,) int64
        Point numbers of the corners.
    shortest : (c,) float64
        Distance from each to the nearest other corner at the end of one of its chains.
    ends : (n_chains, 2) int64
        Corner, as a number into `vertex`, at both ends of each chain; -1 where it closes.
    heading : (n_chains, 2, 2) float64
        Unit vectors in which the chain leaves them.
    outward : (points (k, 2), directions (k, 2), segments (k,))
        At corners that point into the domain, directions in which a disk can touch them.
    """

    chain: np.ndarray
    vertex: np.ndarray
    shortest: np.ndarray
    ends: np.ndarray
    heading: np.ndarray
    outward: tuple[np.ndarray, np.ndarray, np.ndarray]

    def angles(self, own: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Smallest angle in which each chain meets another one, radians; inf where they do not."""
        found = np.full(len(own), np.inf)
        for i in (0, 1):
            for j in (0, 1):
                corner = self.ends[own, i]
                shared = (own != other) & (corner >= 0) & (corner == self.ends[other, j])
                at = np.flatnonzero(shared)
                u, v = self.heading[own[at], i], self.heading[other[at], j]
                angle = np.arccos(np.clip((u * v).sum(axis=1), -1.0, 1.0))
                found[at] = np.minimum(found[at], angle)
        return found


def corners(domain: Pslg) -> Corners:
    """Chains and corners of a domain."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    m, n = len(domain.segments), domain.n_points
    # Half-segments: 0 … m leave the starts, m … 2 m the ends.
    vertex = domain.segments.T.ravel()
    across = domain.points[domain.segments[:, 1]] - domain.points[domain.segments[:, 0]]
    across = across / np.hypot(across[:, 0], across[:, 1])[:, None]
    heading = np.concatenate([across, -across])
    degree = np.bincount(vertex, minlength=n)
    order = np.lexsort((np.arange(2 * m), vertex))
    first = np.searchsorted(vertex[order], np.flatnonzero(degree == 2))
    one, two = order[first], order[first + 1]
    smooth = (heading[one] * heading[two]).sum(axis=1) < -np.cos(np.radians(SMOOTH))
    one, two = one[smooth], two[smooth]
    joined = coo_matrix((np.ones(len(one)), (one % m, two % m)), shape=(m, m))
    chain = connected_components(joined, directed=False)[1].astype(np.int64)
    is_corner = degree > 0
    is_corner[vertex[one]] = False
    number = np.where(is_corner, np.cumsum(is_corner) - 1, -1)
    ends, leaving = _chain_ends(chain, number[vertex], heading)
    position = domain.points[is_corner]
    shortest = np.full(len(position), np.inf)
    whole = (ends >= 0).all(axis=1) & (ends[:, 0] != ends[:, 1])
    length = np.hypot(*(position[ends[whole, 1]] - position[ends[whole, 0]]).T)
    for k in (0, 1):
        np.minimum.at(shortest, ends[whole, k], length)
    known = np.isfinite(shortest)
    return Corners(
        chain,
        np.flatnonzero(is_corner)[known],
        shortest[known],
        ends,
        leaving,
        _fans(domain, heading, is_corner),
    )


def _chain_ends(
    chain: np.ndarray, corner: np.ndarray, heading: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Corners at both ends of each chain, and the headings there."""
    n_chains = int(chain.max()) + 1 if len(chain) else 0
    half = np.flatnonzero(corner >= 0)
    owner = np.tile(chain, 2)[half]
    order = np.argsort(owner, kind="stable")
    half, owner = half[order], owner[order]
    second = np.r_[False, owner[1:] == owner[:-1]] if len(owner) else np.zeros(0, bool)
    ends = np.full((n_chains, 2), -1)
    leaving = np.zeros((n_chains, 2, 2))
    slot = second.astype(np.int64)
    ends[owner, slot] = corner[half]
    leaving[owner, slot] = heading[half]
    return ends, leaving


def _fans(
    domain: Pslg, heading: np.ndarray, is_corner: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Directions in which disks touch corners of more than 180 degrees inside the domain."""
    m = len(domain.segments)
    vertex = domain.segments.T.ravel()
    left = np.concatenate([domain.segment_region[:, 0], domain.segment_region[:, 1]])
    angle = np.arctan2(heading[:, 1], heading[:, 0])
    order = np.lexsort((angle, vertex))
    around = vertex[order]
    start = np.searchsorted(around, around, side="left")
    last = np.searchsorted(around, around, side="right") - 1
    place = np.arange(2 * m)
    after = order[np.where(place == last, start, place + 1)]
    opening = np.mod(angle[after] - angle[order], 2 * np.pi)
    opening[after == order] = 2 * np.pi
    # The sector lies to the left of the half-segment that it begins with.
    wide = (opening > np.pi * (1 + 1e-9)) & (left[order] >= 0) & is_corner[around]
    half, opening = order[wide], opening[wide]
    spare = opening - np.pi
    steps = np.ceil(np.degrees(spare) / FAN).astype(np.int64) + 1
    number = np.repeat(np.arange(len(half)), steps)
    step = np.arange(len(number)) - np.repeat(np.cumsum(steps) - steps, steps)
    share = step / np.maximum(steps[number] - 1, 1)
    turn = angle[half[number]] + 0.5 * np.pi + share * spare[number]
    direction = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return domain.points[vertex[half[number]]], direction, half[number] % m

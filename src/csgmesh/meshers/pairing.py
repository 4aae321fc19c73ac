"""Periodic sides under refinement: what is done to one is done to the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from csgmesh.domain.periodic import PeriodicSides, partners
from csgmesh.errors import MeshingError
from csgmesh.mesh.periodic import PeriodicPair

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg
    from csgmesh.meshers.refiner import Refiner
    from csgmesh.meshers.subdivision import Spaced
    from csgmesh.meshers.workspace import Workspace

#: Two vertices have the same place on their segments if they are nearer than this share of the
#: subsegments beside them: splits fall into the middle third, rounding moves them by nothing.
SAME_PLACE = 0.1


def paired_pieces(domain: Pslg, pieces: np.ndarray) -> np.ndarray:
    """Into how many pieces to cut each segment: as many as its partner."""
    if not domain.periodic:
        return pieces
    other = partners(len(domain.segments), domain.periodic)
    return np.where(other >= 0, np.maximum(pieces, pieces[other]), pieces)


def paired_spacing(domain: Pslg, spacing: Spaced | None) -> Spaced | None:
    """Where the cuts are: on second sides at the images of those on first sides."""
    if spacing is None or not domain.periodic:
        return spacing
    first = np.full(len(domain.segments), -1)
    for sides in domain.periodic:
        first[sides.segments[:, 1]] = sides.segments[:, 0]

    def paired(segment: np.ndarray, share: np.ndarray) -> np.ndarray:
        mirrored = first[segment] >= 0
        at = spacing(
            np.where(mirrored, first[segment], segment), np.where(mirrored, 1 - share, share)
        )
        return np.where(mirrored, 1.0 - at, at)

    return paired


class Subsegments:
    """The subsegments on a pair's sides, in order along the first side.

    Attributes
    ----------
    pair : list of (k,) int64
        For the first side and the second: the row of `PeriodicSides.segments`.
    lo, hi : list of (k,) float64
        From where to where on the first side's segment, as shares of it.
    number : list of (k,) int64
        Which subsegment.
    """

    def __init__(
        self, domain: Pslg, sides: PeriodicSides, segment: np.ndarray, interval: np.ndarray
    ) -> None:
        begin, end = domain.segment_interval[sides.segments[:, 0]].T
        self.pair, self.lo, self.hi, self.number = [], [], [], []
        for side in (0, 1):
            row = np.full(len(domain.segments), -1)
            row[sides.segments[:, side]] = np.arange(len(sides.segments))
            number = np.flatnonzero(row[segment] >= 0)
            pair = row[segment[number]]
            share = (interval[number] - begin[pair, None]) / (end - begin)[pair, None]
            lo, hi = share.min(axis=1), share.max(axis=1)
            order = np.lexsort((lo, pair))
            self.pair.append(pair[order])
            self.lo.append(lo[order])
            self.hi.append(hi[order])
            self.number.append(number[order])
        n = len(sides.segments) + 1
        self.first = [np.searchsorted(pair, np.arange(n)) for pair in self.pair]

    def unequal(self) -> np.ndarray:
        """Rows of segments whose subsegments do not correspond one to one."""
        counts = [np.diff(first) for first in self.first]
        differ = counts[0] != counts[1]
        alike = [~differ[pair] for pair in self.pair]
        lo, other = self.lo[0][alike[0]], self.lo[1][alike[1]]
        shortest = np.minimum(
            (self.hi[0] - self.lo[0])[alike[0]], (self.hi[1] - self.lo[1])[alike[1]]
        )
        differ[self.pair[0][alike[0]][np.abs(lo - other) > SAME_PLACE * shortest]] = True
        return np.flatnonzero(differ)

    def to_split(self) -> np.ndarray:
        """Numbers of subsegments inside which the other side has a vertex."""
        found = [np.zeros(0, np.int64)]
        for row in self.unequal().tolist():
            here, there = (slice(f[row], f[row + 1]) for f in self.first)
            for a, b in (((0, here), (1, there)), ((1, there), (0, here))):
                found.append(self._holding(*a, *b))
        return np.unique(np.concatenate(found))

    def _holding(self, side: int, which: slice, other: int, there: slice) -> np.ndarray:
        """Subsegments of `other` that hold a vertex of `side`."""
        lo, hi = self.lo[side][which], self.hi[side][which]
        vertex = lo[1:]
        room = SAME_PLACE * np.minimum((hi - lo)[1:], (hi - lo)[:-1])
        begin, end = self.lo[other][there], self.hi[other][there]
        at = np.clip(np.searchsorted(begin, vertex, side="right") - 1, 0, len(begin) - 1)
        away = np.minimum(np.abs(vertex - begin[at]), np.abs(vertex - end[at]))
        return self.number[other][there][at[away > room]]


def mirror_splits(refiner: Refiner) -> bool:
    """Ask for splits where only the other side of a pair has been split; False where all match.

    Subsegments of two sides are images of one another from the start, and each is split at a place
    that depends on nothing but itself. So their divisions are the same binary trees, some of them
    cut off earlier: splitting whatever is split on the other side makes them alike.
    """
    domain, n = refiner.work.domain, refiner.n_sub
    interval = refiner.interval[: 2 * n].reshape(-1, 2)
    segment = refiner.segments()
    wanted = [np.zeros(0, np.int64)]
    for sides in domain.periodic:
        wanted.append(Subsegments(domain, sides, segment, interval).to_split())
    number = np.concatenate(wanted)
    stuck = number[refiner.segment[number] < 0]
    if len(stuck):
        a, b = refiner.ends[2 * stuck[0] : 2 * stuck[0] + 2]
        raise MeshingError(
            "the vertices of periodic sides must match, but the edge from "
            f"{refiner.work.place(a)} to {refiner.work.place(b)} is too short to be split as its "
            "partner is"
        )
    refiner.ask_for_splits(number)
    return len(number) > 0


def smaller_of_both(refiner: Refiner) -> bool:
    """Let matching vertices have the smaller size of both; whether that changed any."""
    domain, n = refiner.work.domain, refiner.n_sub
    if not domain.periodic:
        return False
    interval = refiner.interval[: 2 * n].reshape(-1, 2)
    ends = refiner.ends[: 2 * n].reshape(-1, 2)
    size = refiner.size
    changed = False
    for sides in domain.periodic:
        found = Subsegments(domain, sides, refiner.segments(), interval)
        a, b = _end_pairs(found, ends)
        least = np.minimum(size[a], size[b])
        changed |= bool((least < size[a]).any() or (least < size[b]).any())
        np.minimum.at(size, a, least)
        np.minimum.at(size, b, least)
    return changed


def _end_pairs(found: Subsegments, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of the first side and their images, where subsegments correspond; with repeats."""
    differ = np.zeros(len(found.first[0]) - 1, bool)
    differ[found.unequal()] = True
    here, there = (
        ends[number[~differ[pair]]] for pair, number in zip(found.pair, found.number, strict=True)
    )
    return here.ravel(), there[:, ::-1].ravel()


def periodic_pairs(work: Workspace, number: np.ndarray) -> tuple[PeriodicPair, ...]:
    """The pairs of a finished mesh; none where an interrupted run left sides that do not match.

    Parameters
    ----------
    work : Workspace
    number : (n,) int
        Number in the mesh of each vertex.
    """
    domain = work.domain
    # Subsegments with the outside on both sides do not become facets.
    row = np.cumsum((domain.segment_region[work.segment] >= 0).any(axis=1)) - 1
    pairs = []
    ends = work.ends.reshape(-1, 2)
    for sides in domain.periodic:
        found = Subsegments(domain, sides, work.segment, work.interval)
        if len(found.unequal()):
            return ()
        a, b = _end_pairs(found, ends)
        points = number[np.column_stack([a, b])]
        _, first = np.unique(points[:, 0], return_index=True)
        facets = row[np.column_stack(found.number)]
        pairs.append(
            PeriodicPair(
                sides.names, sides.matrix, sides.offset, points[np.sort(first)], {"line": facets}
            )
        )
    return tuple(pairs)

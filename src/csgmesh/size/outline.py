"""The boundary of a domain in pieces that can be cut shorter, on exact curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.size.pieces import is_bent


@dataclass(frozen=True, eq=False)
class Outline:
    """Pieces of segments, in the order of the segments and along each.

    Attributes
    ----------
    segment : (k,) int64
        Segment of the domain of each piece.
    share : (k, 2) float64
        Where on it the piece begins and ends, as shares of the segment's parameters.
    ends : (k, 2, 2) float64
    """

    segment: np.ndarray
    share: np.ndarray
    ends: np.ndarray

    @classmethod
    def of(cls, domain: Pslg) -> Outline:
        """All segments, whole."""
        m = len(domain.segments)
        share = np.tile([0.0, 1.0], (m, 1))
        return cls(np.arange(m), share, domain.points[domain.segments])

    def lengths(self) -> np.ndarray:
        """Length of each piece, (k,)."""
        across = self.ends[:, 1] - self.ends[:, 0]
        return np.hypot(across[:, 0], across[:, 1])

    def first_of(self, segments: np.ndarray) -> np.ndarray:
        """The first piece of each of some segments."""
        return np.searchsorted(self.segment, segments)

    def cut(self, domain: Pslg, parts: np.ndarray) -> Outline:
        """Each piece cut in as many equal parts as wanted; new ends lie on exact curves."""
        number = np.repeat(np.arange(len(parts)), parts)
        step = np.arange(len(number)) - np.repeat(np.cumsum(parts) - parts, parts)
        width = (self.share[number, 1] - self.share[number, 0]) / parts[number]
        begin = self.share[number, 0] + step * width
        share = np.stack([begin, begin + width], axis=1)
        share[step == parts[number] - 1, 1] = self.share[:, 1]
        segment = self.segment[number]
        ends = np.empty((len(number), 2, 2))
        ends[:, 0] = _places(domain, segment, share[:, 0])
        is_first = step == 0
        ends[is_first, 0] = self.ends[:, 0]
        ends[:, 1] = np.where(
            (step == parts[number] - 1)[:, None], self.ends[number, 1], np.roll(ends[:, 0], -1, 0)
        )
        return Outline(segment, share, ends)


def _places(domain: Pslg, segment: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Points at shares of segments, on their exact curves."""
    a, b = (domain.points[domain.segments[segment, k]] for k in (0, 1))
    out = a + share[:, None] * (b - a)
    bent = np.flatnonzero(is_bent(domain)[segment])
    if len(bent):
        begin, end = domain.segment_interval[segment[bent]].T
        t = begin + share[bent] * (end - begin)
        out[bent] = domain.curves.points(domain.segment_curve[segment[bent]], t)
    return out

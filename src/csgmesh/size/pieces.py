"""Boundaries of a domain as short straight pieces, for distances from them."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.curves import LINE
from csgmesh.domain.pslg import Pslg

#: Pieces of a chord of a curve: their deviation from it is a sixteenth of the chord's.
FINER = 4


def is_bent(domain: Pslg) -> np.ndarray:
    """Which segments stand for a piece of a true curve, (m,) bool."""
    bent = domain.segment_curve >= 0
    bent[bent] = domain.curves.kind[domain.segment_curve[bent]] != LINE
    return bent


def boundary_pieces(domain: Pslg, segments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pieces (k, 2, 2) of segments, curved ones cut on their exact curve; the segment of each."""
    bent = is_bent(domain)[segments]
    straight, curved = segments[~bent], segments[bent]
    share = np.linspace(0.0, 1.0, FINER + 1)
    begin, end = domain.segment_interval[curved].T
    t = begin[:, None] + (end - begin)[:, None] * share
    curve = np.repeat(domain.segment_curve[curved], FINER + 1)
    along = domain.curves.points(curve, t.ravel()).reshape(-1, FINER + 1, 2)
    along[:, [0, -1]] = domain.points[domain.segments[curved]]
    short = np.stack([along[:, :-1], along[:, 1:]], axis=2).reshape(-1, 2, 2)
    pieces = np.concatenate([domain.points[domain.segments[straight]], short])
    return pieces, np.concatenate([straight, np.repeat(curved, FINER)])

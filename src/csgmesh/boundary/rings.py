"""Closed rings of segments that keep the domain on their left."""

from __future__ import annotations

import numpy as np


def rings(points: np.ndarray, segments: np.ndarray) -> list[np.ndarray]:
    """Segment numbers of each closed ring, in order of travel, by their lowest number.

    Where rings touch in a point, a ring turns left as sharply as it can: the domain lies on the
    left, so each ring bounds one corner of it and no ring crosses another.

    Examples
    --------
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    >>> [ring.tolist() for ring in rings(square, np.array([[0, 1], [2, 3], [1, 2], [3, 0]]))]
    [[0, 2, 1, 3]]
    """
    tail, head = segments.T
    order = np.argsort(tail, kind="stable")
    first = np.searchsorted(tail[order], head)
    leaving = np.bincount(tail, minlength=len(points))[head]
    following = order[first]
    along = points[head] - points[tail]
    for s in np.flatnonzero(leaving > 1).tolist():
        options = order[first[s] : first[s] + leaving[s]]
        turn = np.arctan2(
            along[s, 0] * along[options, 1] - along[s, 1] * along[options, 0],
            along[options] @ along[s],
        )
        following[s] = options[int(np.argmax(turn))]
    out, seen = [], np.zeros(len(segments), bool)
    for start in range(len(segments)):
        ring = []
        s = start
        while not seen[s]:
            seen[s] = True
            ring.append(s)
            s = int(following[s])
        if ring:
            out.append(np.array(ring))
    return out

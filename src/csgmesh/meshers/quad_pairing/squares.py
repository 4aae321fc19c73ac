"""A lattice of squares inside a domain, as points that its triangulation begins with."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.meshers.background import Background

#: Lattice points nearer to the boundary than this share of a step are left out.
FROM_BOUNDARY = 0.65
#: Where sizes sink below this share of the lattice's, it ends.
NEARLY = 0.95
#: Samples of the boundary, a step of the lattice.
SAMPLES = 4


def with_squares(domain: Pslg, size: float, ground: Background | None) -> Pslg:
    """The domain with the corners of squares of a size inside it as further points."""
    points = square_lattice(domain, size)
    if ground is not None and len(points):
        points = points[ground.at(points.reshape(-1))[0] >= NEARLY * size]
    values = {name: getattr(domain, name) for name in domain.__dataclass_fields__}
    values["points"] = np.concatenate([domain.points, points])
    values["point_marker"] = np.concatenate([domain.point_marker, np.full(len(points), -1)])
    return Pslg.build(**values)


def square_lattice(domain: Pslg, size: float) -> np.ndarray:
    """Points of a lattice of squares inside a domain, aligned with its longest segment, (k, 2).

    Steps are a little longer or shorter than `size`, such that they fit that segment and the box.

    Examples
    --------
    >>> square = Pslg([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> square_lattice(square, 0.48)
    array([[0.5, 0.5]])
    """
    a, b = (domain.points[domain.segments[:, k]] for k in (0, 1))
    longest = int(np.argmax(np.hypot(*(b - a).T)))
    length = float(np.hypot(*(b - a)[longest]))
    along = (b - a)[longest] / length
    frame = np.array([along, [-along[1], along[0]]])
    local = (domain.points - a[longest]) @ frame.T
    lo, hi = local.min(axis=0), local.max(axis=0)
    extent = np.array([length if length > size else hi[0] - lo[0], hi[1] - lo[1]])
    step = extent / np.maximum(np.rint(extent / size), 1)
    place = local / step
    first, last = np.floor(place.min(axis=0)).astype(int), np.ceil(place.max(axis=0)).astype(int)
    place -= first
    free = _inside(domain, place, last - first + 1)
    _clear(free, _samples(domain, place))
    at = np.argwhere(free) + first
    return np.ascontiguousarray(a[longest] + (at * step) @ frame)


def _inside(domain: Pslg, place: np.ndarray, shape: np.ndarray) -> np.ndarray:
    """Which lattice points lie inside the domain, by the crossings of each row."""
    outer = domain.segments[(domain.segment_region < 0).any(axis=1)]
    (ax, ay), (bx, by) = place[outer[:, 0]].T, place[outer[:, 1]].T
    low, high = np.ceil(np.minimum(ay, by)), np.ceil(np.maximum(ay, by))
    n_rows = (high - low).astype(int)
    row = np.arange(int(n_rows.sum())) - np.repeat(np.cumsum(n_rows) - n_rows, n_rows)
    row += np.repeat(low.astype(int), n_rows)
    k = np.repeat(np.arange(len(outer)), n_rows)
    x = ax[k] + (row - ay[k]) / (by - ay)[k] * (bx - ax)[k]
    flips = np.zeros((shape[0] + 1, shape[1]), np.int64)
    np.add.at(flips, (np.clip(np.ceil(x).astype(int), 0, shape[0]), row), 1)
    return np.asarray(np.cumsum(flips, axis=0)[:-1] % 2 == 1)


def _samples(domain: Pslg, place: np.ndarray) -> np.ndarray:
    """Points along all segments, and those that are embedded, in steps of the lattice."""
    a, b = place[domain.segments[:, 0]], place[domain.segments[:, 1]]
    n = np.ceil(SAMPLES * np.hypot(*(b - a).T)).astype(int) + 1
    k = np.repeat(np.arange(len(n)), n)
    share = (np.arange(len(k)) - np.repeat(np.cumsum(n) - n, n)) / n[k]
    along = a[k] + share[:, None] * (b - a)[k]
    return np.concatenate([along, place[domain.point_marker >= 0]])


def _clear(free: np.ndarray, samples: np.ndarray) -> None:
    """Leave out lattice points near samples of the boundary."""
    base = np.floor(samples).astype(int)
    for dx in (0, 1):
        for dy in (0, 1):
            corner = base + np.array([dx, dy])
            near = np.hypot(*(samples - corner).T) < FROM_BOUNDARY
            corner = np.clip(corner[near], 0, np.array(free.shape) - 1)
            free[corner[:, 0], corner[:, 1]] = False

"""Which way three points turn: a floating-point filter, and rational arithmetic where it fails."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from csgmesh import kernels

#: The filter's bound on the rounding error of the determinant: (3 + 16 eps) eps times the sum of
#: the products' magnitudes (Shewchuk, 1997); half of numpy's eps is his.
_EPS = 0.5 * float(np.finfo(float).eps)
_BOUND = (3.0 + 16.0 * _EPS) * _EPS

#: Below this the products may have underflowed and the bound does not hold.
_TINY = 1e-290

#: Starting the compiled kernels takes as long as this many fractions.
_MANY = 20_000


def orientations(points: np.ndarray, triples: np.ndarray) -> np.ndarray:
    """Exact signs of triples of points.

    Parameters
    ----------
    points : (n, 2) float64
    triples : (m, 3) int64

    Returns
    -------
    (m,) int8
        1 counterclockwise, -1 clockwise, 0 on one line.

    Examples
    --------
    >>> points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [2.0, 0.0]])
    >>> orientations(points, np.array([[0, 1, 2], [0, 2, 1], [0, 1, 3]]))
    array([ 1, -1,  0], dtype=int8)
    """
    x, y = points[:, 0][triples], points[:, 1][triples]
    ax, bx = x[:, 0] - x[:, 2], x[:, 1] - x[:, 2]
    ay, by = y[:, 0] - y[:, 2], y[:, 1] - y[:, 2]
    left, right = ax * by, ay * bx
    det = left - right
    size = np.abs(left) + np.abs(right)
    signs = np.sign(det).astype(np.int8)
    unsure = np.flatnonzero((np.abs(det) <= _BOUND * size) | (size < _TINY))
    # Differences have exact signs: where one product has a factor zero, the other one decides.
    s = np.sign([ax[unsure], by[unsure], ay[unsure], bx[unsure]]).astype(np.int8)
    first, second = s[0] * s[1], s[2] * s[3]
    signs[unsure] = first - second
    hard = unsure[(first != 0) & (second != 0)]
    if len(hard) > _MANY:
        signs[hard] = kernels.orientations(points, triples[hard])
        return signs
    for row in hard.tolist():
        signs[row] = _exact(*points[triples[row]].ravel().tolist())
    return signs


def _exact(*coordinates: float) -> int:
    ax, ay, bx, by, cx, cy = map(Fraction, coordinates)
    det = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    return (det > 0) - (det < 0)

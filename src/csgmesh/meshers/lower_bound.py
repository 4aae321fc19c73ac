"""How many points a mesh without small angles must have at least."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.curves import cross
from csgmesh.domain.input_angles import SharpCorners
from csgmesh.domain.pslg import Pslg

#: Areas are sums of products of coordinates: below this share of the squared diagonal they are
#: rounding errors.
ROUNDING = 1e-14


def least_points(domain: Pslg, corners: SharpCorners, min_angle: float) -> tuple[float, int]:
    """A lower bound of the number of points, and the region that asks for most of them.

    A triangle whose angles are all `min_angle` (degrees) or more has an area of at least k times
    the square of the sum of its two longest edges, and hardly more than two of its edges lie on the
    boundary. Those edges make up the perimeter P of a region of area A, so that there are k P² / A
    triangles (Cauchy), and half as many points. Regions with sharp corners, where cells may be as
    thin as they like, count for nothing.

    Examples
    --------
    >>> from csgmesh.domain.input_angles import sharp_corners
    >>> flat = Pslg([[0, 0], [1, 0], [1, 1e-9], [0, 1e-9]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> points, _ = least_points(flat, sharp_corners(flat), 30.0)
    >>> f"{points:.1e}"
    '1.2e+08'
    """
    n = len(domain.region_names)
    a, b = domain.points[domain.segments[:, 0]], domain.points[domain.segments[:, 1]]
    middle = a.mean(axis=0)
    term, length = 0.5 * cross(a - middle, b - middle), np.hypot(*(b - a).T)
    left, right = domain.segment_region.T
    inner = left != right
    area, perimeter, is_sharp = np.zeros(n), np.zeros(n), np.zeros(n, bool)
    for side, sign in ((left, 1.0), (right, -1.0)):
        at = (side >= 0) & inner
        area += sign * np.bincount(side[at], term[at], n)
        perimeter += np.bincount(side[at], length[at], n)
        sharp = (side >= 0) & corners.is_sharp_end.any(axis=1)
        is_sharp[side[sharp]] = True
    angle = np.radians(min_angle)
    # Of all such triangles the one with two angles of `min_angle` is the flattest.
    share = np.sin(angle) * np.cos(angle) / (1.0 + 2.0 * np.cos(angle)) ** 2
    area = np.maximum(np.abs(area), ROUNDING * domain.diagonal**2)
    points = np.where(is_sharp, 0.0, 0.5 * share * perimeter**2 / area)
    return float(points.sum()), int(points.argmax())

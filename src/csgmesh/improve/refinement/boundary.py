"""New vertices on exact curves, and facets halved at them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from csgmesh.domain.curves import LINE, Curves
from csgmesh.mesh import Mesh

#: Halvings of an interval; the parameter is then exact to rounding.
_STEPS = 60


@dataclass(frozen=True, eq=False)
class Facets:
    """The facets of a mesh, halved or not.

    Attributes
    ----------
    arrays : dict of str to mapping
        Arguments of `Mesh`.
    vertex : (k,) int64
        New vertices on facets with an exact curve.
    place : (k, 2) float64
        Where these are.
    is_bent : (k,) bool
        Whether that is off the middle of the chord.
    """

    arrays: dict[str, Any]
    vertex: np.ndarray
    place: np.ndarray
    is_bent: np.ndarray


def halve_facets(mesh: Mesh, middle: np.ndarray) -> Facets:
    """Halve facets at their middle vertices.

    Parameters
    ----------
    mesh : Mesh
    middle : (f,) int64
        New vertex on each facet, -1 for none.
    """
    if "line" not in mesh.facets:
        nothing = np.zeros(0, np.int64)
        return Facets({}, nothing, np.zeros((0, 2)), np.zeros(0, bool))
    rows, interval = mesh.facets["line"], mesh.facet_interval["line"]
    curve = mesh.facet_curve["line"]
    halved = middle >= 0
    t = np.zeros(len(rows))
    on = np.flatnonzero(halved & (curve >= 0))
    place, bent = np.zeros((0, 2)), np.zeros(0, bool)
    if len(on):
        assert mesh.curves is not None
        t[on] = halfway(mesh.curves, curve[on], interval[on])
        place = mesh.curves.points(curve[on], t[on])
        bent = mesh.curves.kind[curve[on]] != LINE
    # Each half stands where its facet stood, the first one first.
    source = np.repeat(np.arange(len(rows)), 1 + halved)
    second = np.r_[False, source[1:] == source[:-1]]
    first = np.r_[second[1:], False]
    new_rows, new_interval = rows[source], interval[source]
    new_rows[first, 1] = new_rows[second, 0] = middle[halved]
    new_interval[first, 1] = new_interval[second, 0] = t[halved]
    arrays = {
        "facets": {"line": new_rows},
        "facet_marker": {"line": mesh.facet_marker["line"][source]},
        "facet_region": {"line": mesh.facet_region["line"][source]},
        "facet_curve": {"line": curve[source]},
        "facet_interval": {"line": new_interval},
    }
    return Facets(arrays, middle[on], place, bent)


def halfway(curves: Curves, curve: np.ndarray, interval: np.ndarray) -> np.ndarray:
    """Parameters of the points of curves as far from either end of their intervals, (k,).

    That is the middle of the interval, where the curve is a line or an arc of a circle.
    """
    t0, t1 = interval.T
    t = 0.5 * (t0 + t1)
    uneven = np.flatnonzero((curves.kind[curve] != LINE) & ~curves.is_circular()[curve])
    if not len(uneven):
        return t
    i, near, far = curve[uneven], t0[uneven].copy(), t1[uneven].copy()
    a, b = curves.points(i, near), curves.points(i, far)
    for _ in range(_STEPS):
        s = 0.5 * (near + far)
        p = curves.points(i, s)
        before = ((p - a) ** 2).sum(axis=1) < ((p - b) ** 2).sum(axis=1)
        near, far = np.where(before, s, near), np.where(before, far, s)
    t[uneven] = 0.5 * (near + far)
    return t

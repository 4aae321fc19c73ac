"""Vertices onto the exact surfaces around them."""

from __future__ import annotations

import numpy as np

from csgmesh.boundary.neighbours import distinct
from csgmesh.domain.curves import ARC, LINE, Curves
from csgmesh.domain.surfaces import PLANE, REVOLVED, Surfaces

#: Steps double the digits, but halve the distance only where surfaces touch.
_STEPS = 40

#: Directions count as independent if the least singular value of the normals exceeds this share of
#: the largest: below it surfaces touch, and where they do is ill-defined along the touching.
_INDEPENDENT = 1e-6

#: How far a vertex may pass the end of a surface, as a share of the profile's length.
_BEYOND = 0.25


def project_vertices(
    points: np.ndarray, triangles: np.ndarray, surface: np.ndarray, surfaces: Surfaces
) -> tuple[np.ndarray, Surfaces]:
    """Move each vertex onto all surfaces of the facets around it (Newton's method).

    A vertex on one surface goes to its projection, one on two to a point of their common curve, one
    on three to the corner; each step solves the linearised equations with the smallest motion. On
    surfaces that touch, the motion along the touching stays out.

    Facets may meet one another where the exact surfaces, which end a little before, do not. Such a
    vertex lies on a surface's continuation; surfaces come back as long as their vertices need.
    """
    key = distinct((triangles * len(surfaces) + surface[:, None]).ravel())
    vertex, on = key // len(surfaces), key % len(surfaces)
    first = np.searchsorted(vertex, np.arange(len(points) + 1))
    count = np.diff(first)
    out = points.copy()
    single = np.flatnonzero(count == 1)
    out[single] = surfaces.project(on[first[single]], points[single])
    longer = _continued(surfaces)
    for k in np.unique(count[count > 1]).tolist():
        at = np.flatnonzero(count == k)
        rows = on[first[at][:, None] + np.arange(k)]
        for _ in range(_STEPS):
            place = out[at]
            flat = np.repeat(place, k, axis=0)
            foot = longer.project(rows.ravel(), flat)
            normal = longer.normals(rows.ravel(), foot).reshape(-1, k, 3)
            gap = ((foot - flat).reshape(-1, k, 3) * normal).sum(axis=2)
            inverse = np.linalg.pinv(normal, rcond=_INDEPENDENT)
            move = np.einsum("vij,vj->vi", inverse, gap)
            # Where surfaces touch, a gap g closes over a way of the order of its root; whoever goes
            # further follows rounding.
            way = np.sqrt((move**2).sum(axis=1))
            most = 2.0 * np.sqrt(np.abs(gap).max(axis=1))
            move *= (most / np.maximum(np.maximum(way, most), 1e-300))[:, None]
            out[at] = place + move
            going = np.abs(move).max(axis=1) > 4.0 * np.finfo(float).eps
            if not going.any():
                break
            at, rows = at[going], rows[going]
    several = count[vertex] > 1
    return out, _prolonged(surfaces, longer, on[several], out[vertex[several]])


def _continued(surfaces: Surfaces) -> Surfaces:
    """Surfaces with lines and arcs longer at both ends, none past its axis."""
    profile = surfaces.profile
    start, end = profile.interval.T
    more = _BEYOND * (end - start)
    start, end = start - more, end + more
    whole = (profile.kind == ARC) & (np.abs(end - start) > 2.0 * np.pi)
    start, end = np.where(whole[:, None], profile.interval, np.column_stack([start, end])).T
    turned = surfaces.kind == REVOLVED
    # A line's radius is r0 + t (r1 - r0), an arc's is largest at the angle of (u_r, v_r).
    data = profile.data
    arc = np.flatnonzero(turned & (profile.kind == ARC) & ~whole)
    u, v = data[arc, 2], data[arc, 4]
    middle = np.arctan2(v, u)
    between = 0.5 * (start[arc] + end[arc])
    middle += 2.0 * np.pi * np.round((between - middle) / (2.0 * np.pi))
    # An arc that stays off the axis has no such end, wherever it is seen from.
    wide = np.arccos(np.clip(-data[arc, 0] / np.hypot(u, v), -1.0, 1.0))
    wide[data[arc, 0] >= np.hypot(u, v)] = np.inf
    start[arc] = np.clip(start[arc], middle - wide, middle + wide)
    end[arc] = np.clip(end[arc], middle - wide, middle + wide)
    line = np.flatnonzero(turned & (profile.kind == LINE) & (data[:, 0] != data[:, 2]))
    apex = data[line, 0] / (data[line, 0] - data[line, 2])
    grows = data[line, 2] > data[line, 0]
    for ends in (start, end):
        ends[line] = np.where(grows, np.maximum(ends[line], apex), np.minimum(ends[line], apex))
    bent = (profile.kind == LINE) | (profile.kind == ARC)
    interval = np.where(bent[:, None], np.column_stack([start, end]), profile.interval)
    return _with_interval(surfaces, interval)


def _prolonged(
    surfaces: Surfaces, longer: Surfaces, on: np.ndarray, points: np.ndarray
) -> Surfaces:
    """Surfaces as long as vertices on the longer ones need."""
    bent = np.flatnonzero(surfaces.kind[on] != PLANE)
    on, points = on[bent], points[bent]
    off = np.flatnonzero(surfaces.distance(on, points) > 4.0 * np.finfo(float).eps)
    on, t = on[off], longer.parameters(on[off], points[off])
    interval = surfaces.profile.interval.copy()
    forward = interval[:, 0] <= interval[:, 1]
    low, high = interval.min(axis=1), interval.max(axis=1)
    np.minimum.at(low, on, t)
    np.maximum.at(high, on, t)
    interval = np.where(
        forward[:, None], np.column_stack([low, high]), np.column_stack([high, low])
    )
    return _with_interval(surfaces, interval)


def _with_interval(surfaces: Surfaces, interval: np.ndarray) -> Surfaces:
    profile = surfaces.profile
    whole = Curves(profile.kind, profile.data, np.ascontiguousarray(interval))
    return Surfaces(surfaces.kind, surfaces.matrix, surfaces.offset, whole)

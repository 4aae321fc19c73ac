"""Halving of a few edges of a surface mesh, everything else left as it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh.domain.surface_mesh import ON_CURVE, ON_FACE, SurfaceMesh, project_on_pairs


def halve_longest(surface: SurfaceMesh, chosen: np.ndarray) -> SurfaceMesh:
    """Halve the longest edge of some triangles, but only one edge of any triangle.

    Middles go onto the exact surface, or both surfaces of a curve. All triangles around such an
    edge become two (M.-C. Rivara 1984).

    Parameters
    ----------
    surface : SurfaceMesh
    chosen : (k,) int64
        Triangles.
    """
    n, triangles = surface.n_points, surface.triangles
    tail, head = triangles, triangles[:, [1, 2, 0]]
    key = np.minimum(tail, head) * n + np.maximum(tail, head)
    long = ((surface.points[tail] - surface.points[head]) ** 2).sum(axis=2)
    longest = np.argmax(long[chosen], axis=1)
    wanted = np.unique(key[chosen, longest])
    # Longer edges first: whoever shares a triangle with one before it waits.
    at, corner = np.nonzero(np.isin(key, wanted))
    edge = np.searchsorted(wanted, key[at, corner])
    length = np.zeros(len(wanted))
    length[edge] = long[at, corner]
    rank = np.empty(len(wanted), np.int64)
    rank[np.lexsort((wanted, -length))] = np.arange(len(wanted))
    first = np.full(len(triangles), len(wanted))
    np.minimum.at(first, at, rank[edge])
    waits = np.zeros(len(wanted), bool)
    waits[edge[first[at] != rank[edge]]] = True
    go = ~waits[edge]
    at, corner, edge = at[go], corner[go], edge[go]
    _, used, number = np.unique(edge, return_index=True, return_inverse=True)
    ends = np.column_stack([wanted[edge[used]] // n, wanted[edge[used]] % n])
    middle, dim, owner, segments, curve = _middles(surface, ends, surface.face[at[used]])
    new = n + number.reshape(-1)
    second = triangles[at].copy()
    halves = triangles.copy()
    halves[at, (corner + 1) % 3] = new
    second[np.arange(len(at)), corner] = new
    return replace(
        surface,
        points=np.concatenate([surface.points, middle]),
        triangles=np.concatenate([halves, second]),
        face=np.concatenate([surface.face, surface.face[at]]),
        segments=segments,
        segment_curve=curve,
        point_dim=np.concatenate([surface.point_dim, dim]),
        point_owner=np.concatenate([surface.point_owner, owner]),
    )


def _middles(
    surface: SurfaceMesh, ends: np.ndarray, face: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Middles of edges (k, 2) on their strata: places, dimensions, owners; segments and curves."""
    n = surface.n_points
    place = surface.points[ends].mean(axis=1)
    whole = np.sort(surface.segments, axis=1) @ np.array([n, 1])
    order = np.argsort(whole)
    found = np.minimum(np.searchsorted(whole[order], ends @ np.array([n, 1])), len(whole) - 1)
    row = order[found] if len(whole) else np.zeros(len(ends), np.int64)
    on_curve = np.zeros(len(ends), bool)
    if len(whole):
        on_curve = whole[row] == ends @ np.array([n, 1])
    inside = np.flatnonzero(~on_curve)
    surfaces = surface.plc.surfaces
    place[inside] = surfaces.project(surface.face_surface[face[inside]], place[inside])
    along = np.flatnonzero(on_curve)
    curve = surface.segment_curve[row[along]]
    place[along] = project_on_pairs(surfaces, surface.curve_surfaces[curve], place[along])
    owner = face.copy()
    owner[along] = curve
    segments = surface.segments.copy()
    new = np.column_stack([n + along, segments[row[along], 1]])
    segments[row[along], 1] = n + along
    return (
        place,
        np.where(on_curve, ON_CURVE, ON_FACE).astype(surface.point_dim.dtype),
        owner,
        np.concatenate([segments, new]),
        np.concatenate([surface.segment_curve, curve]),
    )

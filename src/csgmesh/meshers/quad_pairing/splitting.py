"""Quads of half the edge length: a quad into four, a triangle left over into three."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.mesh import Mesh
from csgmesh.meshers.quad_pairing.matching import Pairing


def split(mesh: Mesh, pairing: Pairing, domain: Pslg, info: Mapping[str, object]) -> Mesh:
    """Quads of a paired mesh, each edge of it halved, those on curves on the curve itself.

    Convex cells make convex quads: each consists of halves of edges and of lines between their
    middles.
    """
    n, e = mesh.n_points, len(pairing.ends)
    is_quad = pairing.corners[:, 3] >= 0
    sides = np.where(is_quad, 4, 3)
    points = np.empty((n + e + len(sides), 2))
    points[:n] = mesh.points
    points[n : n + e] = 0.5 * (mesh.points[pairing.ends[:, 0]] + mesh.points[pairing.ends[:, 1]])
    facets = _facets(mesh, pairing, points, n)
    _centres(points, pairing, n, is_quad)
    rows = []
    for k in range(4):
        at = slice(None) if k < 3 else is_quad
        before = pairing.edges[at, k - 1] if k else pairing.edges[np.arange(len(sides)), sides - 1]
        rows.append(
            np.stack(
                [
                    pairing.corners[at, k],
                    n + pairing.edges[at, k],
                    n + e + np.arange(len(sides))[at],
                    n + before,
                ],
                axis=1,
            )
        )
    order = np.argsort(np.concatenate([np.arange(len(sides))[slice(None) if k < 3 else is_quad]
                                       for k in range(4)]), kind="stable")  # fmt: skip
    return Mesh(
        points=points,
        cells={"quad": np.concatenate(rows)[order]},
        cell_region={"quad": np.repeat(pairing.region, sides)},
        region_names=domain.region_names,
        boundary_names=domain.boundary_names,
        point_marker=np.concatenate([mesh.point_marker, np.full(e + len(sides), -1)]),
        curves=domain.curves,
        domain=domain,
        info={**info, "n_points": len(points), "n_cells": int(sides.sum())},
        **facets,
    )


def _centres(points: np.ndarray, pairing: Pairing, n: int, is_quad: np.ndarray) -> None:
    """Middles of the cells, between the middles of their edges, however these have moved.

    They are the images of the middle under quadratic (triangles) and Coons' (quads) maps.
    """
    centre = points[n + len(pairing.ends) :]
    for which, weights, k in ((is_quad, (0.5, -0.25), 4), (~is_quad, (4 / 9, -1 / 9), 3)):
        at = np.flatnonzero(which)
        middle = np.zeros((len(at), 2))
        corner = np.zeros((len(at), 2))
        for j in range(k):
            middle += points[n + pairing.edges[at, j]]
            corner += points[pairing.corners[at, j]]
        centre[at] = weights[0] * middle + weights[1] * corner


def _facets(mesh: Mesh, pairing: Pairing, points: np.ndarray, n: int) -> dict[str, Any]:
    """Halves of the facets; puts their middles on their curves."""
    line, interval = mesh.facets["line"], mesh.facet_interval["line"]
    curve = mesh.facet_curve["line"]
    edge = np.empty(len(line), np.int64)
    on = np.flatnonzero(pairing.facet >= 0)
    edge[pairing.facet[on]] = on
    middle = n + edge
    t = 0.5 * (interval[:, 0] + interval[:, 1])
    bent = np.flatnonzero(curve >= 0)
    if len(bent) and mesh.curves is not None:
        points[middle[bent]] = mesh.curves.points(curve[bent], t[bent])

    def halves(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        return np.stack([np.stack([a, b], -1), np.stack([b, c], -1)], axis=1).reshape(-1, 2)

    return {
        "facets": {"line": halves(line[:, 0], middle, line[:, 1])},
        "facet_marker": {"line": np.repeat(mesh.facet_marker["line"], 2)},
        "facet_region": {"line": np.repeat(mesh.facet_region["line"], 2, axis=0)},
        "facet_curve": {"line": np.repeat(curve, 2)},
        "facet_interval": {"line": halves(interval[:, 0], t, interval[:, 1])},
    }

"""From the kernels' arrays to a Mesh."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from csgmesh import kernels
from csgmesh.mesh import Mesh

if TYPE_CHECKING:
    from csgmesh.meshers.workspace import Workspace


def assemble(work: Workspace, info: Mapping[str, object]) -> Mesh:
    """The domain's triangles, its facets, and what the domain knows about them.

    Takes the workspace apart, so that it and the mesh are never both in memory.
    """
    domain = work.domain
    cells, regions, used = _cells(work)
    number = _numbering(work, used)
    points = work.points[: 2 * work.n_points].reshape(-1, 2)
    new_points = np.empty((int(used.sum()), 2))
    new_points[number[used]] = points[used]
    facets = _facets(work, number)
    return Mesh(
        points=new_points,
        cells={"triangle": number[cells]},
        cell_region={"triangle": regions},
        region_names=domain.region_names,
        boundary_names=domain.boundary_names,
        point_marker=_point_markers(work, used, number),
        curves=domain.curves,
        domain=domain,
        info={**info, "n_points": len(new_points), "n_cells": len(cells)},
        **facets,
    )


def _cells(work: Workspace) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    cells = np.empty((work.n_triangles, 3), np.int32)
    regions = np.empty(work.n_triangles, np.int64)
    used = np.zeros(work.n_points, np.bool_)
    n = kernels.extract(
        work.origin, work.twin, work.n_triangles, cells.reshape(-1), regions, used.view(np.uint8)
    )
    work.release()
    return cells[:n], regions[:n], used


def _numbering(work: Workspace, used: np.ndarray) -> np.ndarray:
    """New numbers of the used vertices: the domain's points in their order, then the others."""
    n = len(work.order)
    in_order = np.concatenate([used[work.rank], used[n:]])
    position = np.cumsum(in_order) - 1
    number = np.full(work.n_points, -1, np.int64)
    number[: len(position)][:n] = position[:n][work.order]
    number[n:] = position[n:]
    return number


def _facets(work: Workspace, number: np.ndarray) -> dict[str, dict[str, np.ndarray]]:
    """Subsegments as facets, each with its first region on the left."""
    domain, segment = work.domain, work.segment
    ends = number[work.ends.reshape(-1, 2)]
    sides = domain.segment_region[segment]
    left, right = sides.T
    turned = (right >= 0) & ((left < 0) | (right < left))
    curve = domain.segment_curve[segment]
    interval = work.interval * (curve >= 0)[:, None]
    kept = (left >= 0) | (right >= 0)
    return {
        "facets": {"line": _swapped(ends, turned)[kept]},
        "facet_marker": {"line": domain.segment_marker[segment][kept]},
        "facet_region": {"line": _swapped(sides, turned)[kept]},
        "facet_curve": {"line": curve[kept]},
        "facet_interval": {"line": _swapped(interval, turned)[kept]},
    }


def _swapped(pairs: np.ndarray, which: np.ndarray) -> np.ndarray:
    return np.where(which[:, None], pairs[:, ::-1], pairs)


def _point_markers(work: Workspace, used: np.ndarray, number: np.ndarray) -> np.ndarray:
    markers = np.full(int(used.sum()), -1, np.int64)
    marked = np.flatnonzero(work.domain.point_marker >= 0)
    vertex = work.rank[marked]
    markers[number[vertex]] = work.domain.point_marker[marked]
    return markers

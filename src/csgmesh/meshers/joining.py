"""One mesh of the parts of a domain."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from csgmesh import kernels
from csgmesh.domain.pslg import Pslg
from csgmesh.mesh import Mesh
from csgmesh.meshers.assembly import facets_of
from csgmesh.meshers.components import Part
from csgmesh.meshers.side_by_side import SideBySide
from csgmesh.meshers.workspace import Progress, Workspace

A = TypeVar("A")
T = TypeVar("T")


class _Share:
    """What one part brings to the mesh, and where there it goes."""

    def __init__(self, part: Part, work: Workspace) -> None:
        self.work = work
        used = np.zeros(work.n_points, np.uint8)
        self.n_cells = kernels.mark_used(work.origin, work.twin, work.n_triangles, used)
        vertex = np.arange(work.n_points, dtype=np.int32)
        vertex[: len(work.rank)] = work.rank
        is_used = used.view(np.bool_).take(vertex)
        n = len(part.point)
        self.given = vertex[:n][is_used[:n]]
        self.point = part.point[is_used[:n]]
        self.others = vertex[n:][is_used[n:]]
        self.first_point = self.first_cell = 0


def join(
    domain: Pslg,
    parts: Sequence[Part],
    works: Sequence[Workspace],
    info: Mapping[str, object],
    threads: int,
) -> Mesh:
    """The triangles of all parts; the domain's points come in their order, then each part's others.

    Takes the workspaces apart.
    """
    shares = _each(lambda pair: _Share(*pair), list(zip(parts, works, strict=True)), threads)
    is_used = np.zeros(len(domain.points), np.bool_)
    for share in shares:
        is_used[share.point] = True
    number_of_given = np.cumsum(is_used) - 1
    n_points, n_cells = int(is_used.sum()), 0
    for share in shares:
        share.first_point, share.first_cell = n_points, n_cells
        n_points += len(share.others)
        n_cells += share.n_cells
    points = np.empty((n_points, 2))
    cells = np.empty((n_cells, 3), np.int64)
    regions = np.empty(n_cells, np.int64)

    def settle(share: _Share) -> dict[str, Any]:
        work = share.work
        at, n = share.first_point, len(share.others)
        number = np.full(work.n_points, -1, np.int32)
        number[share.given] = number_of_given[share.point]
        number[share.others] = np.arange(at, at + n, dtype=np.int32)
        known = work.points[: 2 * work.n_points].reshape(-1, 2)
        points[number_of_given[share.point]] = known.take(share.given, axis=0)
        known.take(share.others, axis=0, out=points[at : at + n], mode="clip")
        mine = slice(share.first_cell, share.first_cell + share.n_cells)
        kernels.extract(
            work.origin, work.twin, work.n_triangles, number, cells[mine].reshape(-1), regions[mine]
        )
        work.release()
        return facets_of(work, number)

    found = _each(settle, shares, threads)
    facets: dict[str, Any] = {
        name: np.concatenate([each[name] for each in found]) for name in found[0]
    }
    markers = np.full(n_points, -1, np.int64)
    markers[: int(is_used.sum())] = domain.point_marker[is_used]
    for array in (points, cells, regions, markers, *facets.values()):
        array.flags.writeable = False
    return Mesh(
        points=points,
        cells={"triangle": cells},
        cell_region={"triangle": regions},
        region_names=domain.region_names,
        boundary_names=domain.boundary_names,
        point_marker=markers,
        curves=domain.curves,
        periodic=(),
        domain=domain,
        info={**info, "n_points": n_points, "n_cells": n_cells},
        **{name: {"line": array} for name, array in facets.items()},
    )


def _each(function: Callable[[A], T], items: Sequence[A], threads: int) -> list[T]:
    """What a function returns for each item."""

    def job(item: A) -> Callable[[Progress], T]:
        return lambda _: function(item)

    run = SideBySide([job(item) for item in items])
    run.run(threads)
    for i in sorted(run.errors):
        raise run.errors[i]
    return [run.results[i] for i in range(len(items))]

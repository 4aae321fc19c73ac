"""Ways to spoil one entity of a mesh: each takes a generator and a mesh and returns a wrong one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from csgmesh.domain.curves import Curves
from csgmesh.mesh import Mesh

Mutation = Callable[[np.random.Generator, Mesh], Mesh]

CELLS = ("cells", "cell_region")
FACETS = ("facets", "facet_marker", "facet_region", "facet_curve", "facet_interval")


def rows_of(mesh: Mesh, fields: tuple[str, ...], kind: str, rows: np.ndarray) -> Mesh:
    """The mesh with these rows of these fields only, in this order."""
    return replace(mesh, **{f: {kind: getattr(mesh, f)[kind][rows]} for f in fields})


def with_value(mesh: Mesh, field: str, kind: str, row: int, value: object) -> Mesh:
    array = getattr(mesh, field)[kind].copy()
    array[row] = value
    return replace(mesh, **{field: {kind: array}})


def other(rng: np.random.Generator, n: int, than: int, low: int = 0) -> int:
    """A number from `low` to n - 1 that is not `than`."""
    return int(rng.choice([i for i in range(low, n) if i != than]))


def flip_cell(rng, mesh):
    row = rng.integers(mesh.n_cells)
    return with_value(mesh, "cells", "triangle", row, mesh.cells["triangle"][row][::-1])


def delete_cell(rng, mesh):
    keep = np.delete(np.arange(mesh.n_cells), rng.integers(mesh.n_cells))
    return rows_of(mesh, CELLS, "triangle", keep)


def duplicate_cell(rng, mesh):
    rows = np.r_[np.arange(mesh.n_cells), rng.integers(mesh.n_cells)]
    return rows_of(mesh, CELLS, "triangle", rows)


def rewire_cell(rng, mesh):
    row, corner = rng.integers(mesh.n_cells), rng.integers(3)
    cell = mesh.cells["triangle"][row].copy()
    cell[corner] = other(rng, mesh.n_points, cell[corner])
    return with_value(mesh, "cells", "triangle", row, cell)


def recolour_cell(rng, mesh):
    row = rng.integers(mesh.n_cells)
    region = other(rng, len(mesh.region_names), mesh.cell_region["triangle"][row])
    return with_value(mesh, "cell_region", "triangle", row, region)


def cell_out_of_range(rng, mesh):
    cell = mesh.cells["triangle"][0].copy()
    cell[rng.integers(3)] = rng.choice([-1, mesh.n_points])
    return with_value(mesh, "cells", "triangle", 0, cell)


def nudge_facet_point(rng, mesh):
    """A billionth of the diagonal, in any direction, along the boundary too."""
    angle = rng.random() * 2 * np.pi
    point = rng.choice(mesh.facets["line"].ravel())
    points = mesh.points.copy()
    diagonal = np.hypot(*np.ptp(points, axis=0))
    points[point] += 1e-9 * diagonal * np.array([np.cos(angle), np.sin(angle)])
    return replace(mesh, points=points)


def throw_inner_point(rng, mesh):
    inner = np.setdiff1d(np.arange(mesh.n_points), mesh.facets["line"])
    point = int(rng.choice(inner))
    lo, hi = mesh.points.min(axis=0), mesh.points.max(axis=0)
    while True:
        place = lo + (hi - lo) * rng.random(2)
        cell = int(mesh.locate(place[None])[0])
        if cell < 0 or point not in mesh.cells["triangle"][cell]:
            break
    points = mesh.points.copy()
    points[point] = place
    return replace(mesh, points=points)


def lose_a_coordinate(rng, mesh):
    points = mesh.points.copy()
    points[rng.integers(mesh.n_points), rng.integers(2)] = rng.choice([np.nan, np.inf])
    return replace(mesh, points=points)


def delete_point(rng, mesh):
    """All later points move up by one; what named the deleted one names the one behind it."""
    point = int(rng.integers(mesh.n_points - 1))

    def shifted(rows):
        return rows - (rows > point)

    return replace(
        mesh,
        points=np.delete(mesh.points, point, axis=0),
        cells={k: shifted(v) for k, v in mesh.cells.items()},
        facets={k: shifted(v) for k, v in mesh.facets.items()},
        point_marker=np.delete(mesh.point_marker, point),
    )


def duplicate_point(rng, mesh):
    """One cell gets its own copy of a corner."""
    row, corner = rng.integers(mesh.n_cells), rng.integers(3)
    cells = mesh.cells["triangle"].copy()
    points = np.concatenate([mesh.points, mesh.points[cells[row, corner], None]])
    cells[row, corner] = mesh.n_points
    marker = np.r_[mesh.point_marker, -1]
    return replace(mesh, points=points, cells={"triangle": cells}, point_marker=marker)


def add_unused_point(rng, mesh):
    points = np.concatenate([mesh.points, rng.random((1, 2))])
    return replace(mesh, points=points, point_marker=np.r_[mesh.point_marker, -1])


def delete_facet(rng, mesh):
    keep = np.delete(np.arange(mesh.n_facets), rng.integers(mesh.n_facets))
    return rows_of(mesh, FACETS, "line", keep)


def duplicate_facet(rng, mesh):
    rows = np.r_[np.arange(mesh.n_facets), rng.integers(mesh.n_facets)]
    return rows_of(mesh, FACETS, "line", rows)


def turn_facet(rng, mesh):
    row = rng.integers(mesh.n_facets)
    return with_value(mesh, "facets", "line", row, mesh.facets["line"][row][::-1])


def turn_facet_and_interval(rng, mesh):
    """An embedded path may run either way; a boundary may not."""
    sides = mesh.facet_region["line"]
    row = rng.choice(np.flatnonzero(sides[:, 0] != sides[:, 1]))
    turned = with_value(mesh, "facets", "line", row, mesh.facets["line"][row][::-1])
    interval = mesh.facet_interval["line"][row][::-1]
    return with_value(turned, "facet_interval", "line", row, interval)


def rewire_facet(rng, mesh):
    row, end = rng.integers(mesh.n_facets), rng.integers(2)
    facet = mesh.facets["line"][row].copy()
    facet[end] = other(rng, mesh.n_points, facet[end])
    return with_value(mesh, "facets", "line", row, facet)


def rename_facet(rng, mesh):
    row = rng.integers(mesh.n_facets)
    marker = other(rng, len(mesh.boundary_names), mesh.facet_marker["line"][row], -1)
    return with_value(mesh, "facet_marker", "line", row, marker)


def facet_on_an_inner_edge(rng, mesh):
    """A boundary facet too many, inside."""
    known = {tuple(sorted(f)) for f in mesh.facets["line"].tolist()}
    cells = mesh.cells["triangle"]
    while True:
        cell = cells[rng.integers(len(cells))]
        if tuple(sorted(cell[:2].tolist())) not in known:
            break
    rows = np.r_[np.arange(mesh.n_facets), 0]
    mesh = rows_of(mesh, FACETS, "line", rows)
    return with_value(mesh, "facets", "line", mesh.n_facets - 1, cell[:2])


def change_side(rng, mesh):
    row, side = rng.integers(mesh.n_facets), rng.integers(2)
    sides = mesh.facet_region["line"][row].copy()
    sides[side] = other(rng, len(mesh.region_names), sides[side], -1)
    return with_value(mesh, "facet_region", "line", row, sides)


def change_curve(rng, mesh):
    row = rng.integers(mesh.n_facets)
    curve = other(rng, len(mesh.curves), mesh.facet_curve["line"][row])
    return with_value(mesh, "facet_curve", "line", row, curve)


def forget_curve(rng, mesh):
    row = rng.choice(np.flatnonzero(mesh.facet_curve["line"] >= 0))
    return with_value(mesh, "facet_curve", "line", row, -1)


def change_interval(rng, mesh):
    row = rng.choice(np.flatnonzero(mesh.facet_curve["line"] >= 0))
    interval = mesh.facet_interval["line"][row].copy()
    interval[rng.integers(2)] += rng.choice([-1, 1]) * 10.0 ** rng.integers(-8, 0)
    return with_value(mesh, "facet_interval", "line", row, interval)


def wind_interval_once_more(rng, mesh):
    """The ends evaluate to the right points, yet the arc is the whole circle and more."""
    from csgmesh.domain.curves import ARC

    is_arc = mesh.curves.kind[mesh.facet_curve["line"]] == ARC
    row = rng.choice(np.flatnonzero(is_arc))
    interval = mesh.facet_interval["line"][row] + [0.0, 2 * np.pi]
    return with_value(mesh, "facet_interval", "line", row, interval)


def rename_region(rng, mesh):
    names = list(mesh.region_names)
    names[rng.integers(len(names))] = str(rng.choice(["ghost", names[0], names[-1]]))
    if tuple(names) == mesh.region_names:
        names[0] = "ghost"
    return replace(mesh, region_names=tuple(names))


def swap_regions(rng, mesh):
    return replace(mesh, region_names=mesh.region_names[::-1])


def rename_boundary(rng, mesh):
    entries = [list(entry) for entry in mesh.boundary_names]
    entry = entries[rng.integers(len(entries))]
    entry[rng.integers(len(entry))] = str(rng.choice(["ghost", *mesh.names]))
    if [tuple(e) for e in entries] == list(mesh.boundary_names):
        entry[0] = "ghost"
    return replace(mesh, boundary_names=entries)


def drop_boundary_name(rng, mesh):
    entries = [list(entry) for entry in mesh.boundary_names]
    entry = entries[rng.integers(len(entries))]
    del entry[rng.integers(len(entry))]
    return replace(mesh, boundary_names=entries)


def swap_boundary_names(rng, mesh):
    entries = list(mesh.boundary_names)
    i = rng.integers(len(entries))
    j = other(rng, len(entries), i)
    entries[i], entries[j] = entries[j], entries[i]
    return replace(mesh, boundary_names=entries)


def lose_embedded_point(rng, mesh):
    marker = mesh.point_marker.copy()
    marker[rng.choice(np.flatnonzero(marker >= 0))] = -1
    return replace(mesh, point_marker=marker)


def name_another_point(rng, mesh):
    marker = mesh.point_marker.copy()
    point = rng.integers(mesh.n_points)
    marker[point] = other(rng, len(mesh.boundary_names), marker[point])
    return replace(mesh, point_marker=marker)


def bend_curve(rng, mesh):
    """A curve that facets lie on moves by a millionth."""
    curve = rng.choice(mesh.facet_curve["line"][mesh.facet_curve["line"] >= 0])
    data = mesh.curves.data.copy()
    data[curve, rng.integers(4)] += 1e-6
    return replace(mesh, curves=Curves(mesh.curves.kind, data, mesh.curves.interval))


MUTATIONS: tuple[Mutation, ...] = (
    flip_cell,
    delete_cell,
    duplicate_cell,
    rewire_cell,
    recolour_cell,
    cell_out_of_range,
    nudge_facet_point,
    throw_inner_point,
    lose_a_coordinate,
    delete_point,
    duplicate_point,
    add_unused_point,
    delete_facet,
    duplicate_facet,
    turn_facet,
    turn_facet_and_interval,
    rewire_facet,
    rename_facet,
    facet_on_an_inner_edge,
    change_side,
    change_curve,
    forget_curve,
    change_interval,
    wind_interval_once_more,
    rename_region,
    swap_regions,
    rename_boundary,
    drop_boundary_name,
    swap_boundary_names,
    lose_embedded_point,
    name_another_point,
    bend_curve,
)

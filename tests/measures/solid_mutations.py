"""Ways to spoil one entity of a mesh of space: each takes a generator and a mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from mutations import delete_point, other

from csgmesh.mesh import KINDS, Mesh

Mutation = Callable[[np.random.Generator, Mesh], Mesh]

CELLS = ("cells", "cell_region")
FACETS = ("facets", "facet_marker", "facet_region", "facet_curve", "facet_interval")


def a_kind(rng: np.random.Generator, arrays) -> str:
    """A kind, the more likely the more there are of it."""
    sizes = np.array([len(rows) for rows in arrays.values()], float)
    return str(rng.choice(list(arrays), p=sizes / sizes.sum()))


def rows_of(mesh: Mesh, fields: tuple[str, ...], kind: str, rows: np.ndarray) -> Mesh:
    """The mesh with these rows of one kind only, in this order."""
    changed = {f: {**getattr(mesh, f), kind: getattr(mesh, f)[kind][rows]} for f in fields}
    return replace(mesh, cell_parent={}, **changed)


def with_value(mesh: Mesh, field: str, kind: str, row: int, value: object) -> Mesh:
    arrays = dict(getattr(mesh, field))
    arrays[kind] = arrays[kind].copy()
    arrays[kind][row] = value
    return replace(mesh, **{field: arrays})


def flip_cell(rng, mesh):
    kind = a_kind(rng, mesh.cells)
    row = rng.integers(len(mesh.cells[kind]))
    cell = mesh.cells[kind][row].copy()
    swapped = {
        "tetra": [0, 2, 1, 3],
        "tetra10": [0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
        "hexahedron": [4, 5, 6, 7, 0, 1, 2, 3],
    }[kind]
    return with_value(mesh, "cells", kind, row, cell[swapped])


def turn_cell_over(rng, mesh):
    """Two corners change places: of a tetrahedron that inverts it, of others it crosses faces."""
    kind = a_kind(rng, mesh.cells)
    row = rng.integers(len(mesh.cells[kind]))
    cell = mesh.cells[kind][row].copy()
    a, b = rng.choice(len(cell), 2, replace=False)
    cell[[a, b]] = cell[[b, a]]
    return with_value(mesh, "cells", kind, row, cell)


def delete_cell(rng, mesh):
    """A hole."""
    kind = a_kind(rng, mesh.cells)
    n = len(mesh.cells[kind])
    return rows_of(mesh, CELLS, kind, np.delete(np.arange(n), rng.integers(n)))


def duplicate_cell(rng, mesh):
    kind = a_kind(rng, mesh.cells)
    n = len(mesh.cells[kind])
    return rows_of(mesh, CELLS, kind, np.r_[np.arange(n), rng.integers(n)])


def rewire_cell(rng, mesh):
    kind = a_kind(rng, mesh.cells)
    row = rng.integers(len(mesh.cells[kind]))
    cell = mesh.cells[kind][row].copy()
    corner = rng.integers(len(cell))
    cell[corner] = rng.choice(np.setdiff1d(np.arange(mesh.n_points), cell))
    return with_value(mesh, "cells", kind, row, cell)


def recolour_cell(rng, mesh):
    kind = a_kind(rng, mesh.cells)
    row = rng.integers(len(mesh.cells[kind]))
    region = other(rng, max(len(mesh.region_names), 2), mesh.cell_region[kind][row])
    return with_value(mesh, "cell_region", kind, row, region)


def cell_out_of_range(rng, mesh):
    kind = a_kind(rng, mesh.cells)
    cell = mesh.cells[kind][0].copy()
    cell[rng.integers(len(cell))] = rng.choice([-1, mesh.n_points])
    return with_value(mesh, "cells", kind, 0, cell)


def lift_facet_point(rng, mesh):
    """A billionth of the diagonal, off one of its surfaces."""
    kind = a_kind(rng, mesh.facets)
    rows = mesh.facets[kind]
    row = rows[rng.integers(len(rows))]
    a, b, c = mesh.points[row[:3]]
    normal = np.cross(b - a, c - a)
    diagonal = np.sqrt((np.ptp(mesh.points, axis=0) ** 2).sum())
    points = mesh.points.copy()
    lift = rng.choice([-1, 1]) * 1e-9 * diagonal / np.sqrt((normal**2).sum())
    points[rng.choice(row)] += lift * normal
    return replace(mesh, points=points)


def throw_inner_point(rng, mesh):
    """To another place inside, beyond the cells around it."""
    used = [rows.ravel() for rows in mesh.facets.values()]
    point = int(rng.choice(np.setdiff1d(np.arange(mesh.n_points), np.concatenate(used))))
    (cells,) = mesh.cells.values()
    around = np.flatnonzero((cells == point).any(axis=1))
    lo, hi = mesh.points.min(axis=0), mesh.points.max(axis=0)
    while True:
        place = lo + (hi - lo) * rng.random(3)
        if int(mesh.locate(place)[0]) not in around:
            break
    points = mesh.points.copy()
    points[point] = place
    return replace(mesh, points=points)


def lose_a_coordinate(rng, mesh):
    points = mesh.points.copy()
    points[rng.integers(mesh.n_points), rng.integers(3)] = rng.choice([np.nan, np.inf])
    return replace(mesh, points=points)


def duplicate_point(rng, mesh):
    """One cell gets its own copy of a corner."""
    kind = a_kind(rng, mesh.cells)
    cells = mesh.cells[kind].copy()
    row, corner = rng.integers(len(cells)), rng.integers(cells.shape[1])
    points = np.concatenate([mesh.points, mesh.points[cells[row, corner], None]])
    cells[row, corner] = mesh.n_points
    marker = np.r_[mesh.point_marker, -1]
    return replace(mesh, points=points, cells={**mesh.cells, kind: cells}, point_marker=marker)


def add_unused_point(rng, mesh):
    points = np.concatenate([mesh.points, rng.random((1, 3))])
    return replace(mesh, points=points, point_marker=np.r_[mesh.point_marker, -1])


def delete_facet(rng, mesh):
    kind = a_kind(rng, mesh.facets)
    n = len(mesh.facets[kind])
    return rows_of(mesh, FACETS, kind, np.delete(np.arange(n), rng.integers(n)))


def duplicate_facet(rng, mesh):
    kind = a_kind(rng, mesh.facets)
    n = len(mesh.facets[kind])
    return rows_of(mesh, FACETS, kind, np.r_[np.arange(n), rng.integers(n)])


def turn_facet(rng, mesh):
    kind = a_kind(rng, mesh.facets)
    row = rng.integers(len(mesh.facets[kind]))
    return with_value(mesh, "facets", kind, row, mesh.facets[kind][row][::-1])


def rewire_facet(rng, mesh):
    kind = a_kind(rng, mesh.facets)
    row = rng.integers(len(mesh.facets[kind]))
    facet = mesh.facets[kind][row].copy()
    facet[rng.integers(len(facet))] = rng.choice(np.setdiff1d(np.arange(mesh.n_points), facet))
    return with_value(mesh, "facets", kind, row, facet)


def rename_facet(rng, mesh):
    kind = a_kind(rng, mesh.facets)
    row = rng.integers(len(mesh.facets[kind]))
    marker = other(rng, len(mesh.boundary_names), mesh.facet_marker[kind][row], -1)
    return with_value(mesh, "facet_marker", kind, row, marker)


def swap_names_of_two_facets(rng, mesh):
    kind = a_kind(rng, mesh.facets)
    marker = mesh.facet_marker[kind].copy()
    a = rng.integers(len(marker))
    b = rng.choice(np.flatnonzero(marker != marker[a]))
    marker[[a, b]] = marker[[b, a]]
    return replace(mesh, facet_marker={**mesh.facet_marker, kind: marker})


def facet_on_an_inner_face(rng, mesh):
    """A boundary facet too many, inside."""
    kind = a_kind(rng, mesh.facets)
    known = {tuple(sorted(f)) for f in mesh.facets[kind].tolist()}
    (cells,) = mesh.cells.values()
    data = KINDS[next(iter(mesh.cells))]
    while True:
        face = cells[rng.integers(len(cells))][list(data.facets[rng.integers(len(data.facets))])]
        if tuple(sorted(face.tolist())) not in known:
            break
    rows = np.r_[np.arange(len(mesh.facets[kind])), 0]
    return with_value(rows_of(mesh, FACETS, kind, rows), "facets", kind, len(rows) - 1, face)


def change_side(rng, mesh):
    kind = a_kind(rng, mesh.facets)
    row, side = rng.integers(len(mesh.facets[kind])), rng.integers(2)
    sides = mesh.facet_region[kind][row].copy()
    sides[side] = other(rng, max(len(mesh.region_names), 2), sides[side], -1)
    return with_value(mesh, "facet_region", kind, row, sides)


def swap_sides(rng, mesh):
    kind = a_kind(rng, mesh.facets)
    row = rng.integers(len(mesh.facets[kind]))
    return with_value(mesh, "facet_region", kind, row, mesh.facet_region[kind][row][::-1])


def rename_region(rng, mesh):
    names = list(mesh.region_names)
    names[rng.integers(len(names))] = "ghost"
    return replace(mesh, region_names=tuple(names))


def swap_regions(rng, mesh):
    if len(mesh.region_names) < 2:
        return rename_region(rng, mesh)
    return replace(mesh, region_names=mesh.region_names[::-1])


def rename_boundary(rng, mesh):
    entries = [list(entry) for entry in mesh.boundary_names]
    entry = entries[rng.integers(len(entries))]
    k = rng.integers(len(entry))
    entry[k] = str(rng.choice(["ghost", *(n for n in mesh.names if n not in entry)]))
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


def lift_edge_node(rng, mesh):
    """A billionth of the diagonal, off the surface that its edge is on."""
    row = rng.choice(mesh.facets["triangle6"])
    a, b, c = mesh.points[row[:3]]
    normal = np.cross(b - a, c - a)
    diagonal = np.sqrt((np.ptp(mesh.points, axis=0) ** 2).sum())
    points = mesh.points.copy()
    lift = rng.choice([-1, 1]) * 1e-9 * diagonal / np.sqrt((normal**2).sum())
    points[rng.choice(row[3:])] += lift * normal
    return replace(mesh, points=points)


def throw_edge_node(rng, mesh):
    """Of an inner edge, by the length of a cell."""
    nodes = np.setdiff1d(mesh.cells["tetra10"][:, 4:], mesh.facets["triangle6"])
    points = mesh.points.copy()
    turn = rng.normal(size=3)
    points[rng.choice(nodes)] += 0.5 * turn / np.sqrt((turn**2).sum())
    return replace(mesh, points=points)


def swap_edge_nodes(rng, mesh):
    field, kind = [("cells", "tetra10"), ("facets", "triangle6")][rng.integers(2)]
    rows = getattr(mesh, field)[kind]
    row = rng.integers(len(rows))
    nodes = rows[row].copy()
    corners = KINDS[kind].n_corners
    a, b = corners + rng.choice(len(nodes) - corners, 2, replace=False)
    nodes[[a, b]] = nodes[[b, a]]
    return with_value(mesh, field, kind, row, nodes)


#: For curved tetrahedra.
CURVED_MUTATIONS: tuple[Mutation, ...] = (lift_edge_node, throw_edge_node, swap_edge_nodes)

MUTATIONS: tuple[Mutation, ...] = (
    flip_cell,
    turn_cell_over,
    delete_cell,
    duplicate_cell,
    rewire_cell,
    recolour_cell,
    cell_out_of_range,
    lift_facet_point,
    throw_inner_point,
    lose_a_coordinate,
    delete_point,
    duplicate_point,
    add_unused_point,
    delete_facet,
    duplicate_facet,
    turn_facet,
    rewire_facet,
    rename_facet,
    swap_names_of_two_facets,
    facet_on_an_inner_face,
    change_side,
    swap_sides,
    rename_region,
    swap_regions,
    rename_boundary,
    drop_boundary_name,
    swap_boundary_names,
)

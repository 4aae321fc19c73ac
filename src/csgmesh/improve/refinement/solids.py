"""Divide all cells of a mesh of space: eight from each, conforming, on the exact boundary."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from csgmesh.improve.exact_surfaces import ExactSurfaces
from csgmesh.improve.refinement.solid_templates import CELLS, FACETS, shortest_diagonals_first
from csgmesh.improve.solid_edges import SolidEdges
from csgmesh.measures.space.jacobians import least_jacobians
from csgmesh.mesh import Mesh

#: What ``info["refinement"]`` says of meshes whose tetrahedra are numbered for further division.
REGULAR = "regular"

Arrays = Mapping[str, np.ndarray]


def refine_solid(mesh: Mesh) -> Mesh:
    """Divide all cells of a mesh of space of first-order cells; see `csgmesh.refine`."""
    cells = dict(mesh.cells)
    if "tetra" in cells and mesh.info.get("refinement") != REGULAR:
        cells["tetra"] = shortest_diagonals_first(mesh.points, cells["tetra"])
    edges = SolidEdges.of(cells, mesh.facets, mesh.n_points)
    nodes = _nodes(mesh.n_points, cells, edges)
    kinds, arrays = _children(mesh, cells, nodes)
    points, n_on_chords = _placed(mesh, cells, edges, kinds)
    for array in (points, *kinds.values()):
        array.flags.writeable = False
    return Mesh(
        points,
        kinds,
        region_names=mesh.region_names,
        boundary_names=mesh.boundary_names,
        point_marker=np.r_[mesh.point_marker, np.full(len(points) - mesh.n_points, -1)],
        domain=mesh.domain,
        info={**mesh.info, "refinement": REGULAR, "points_on_chords": n_on_chords},
        **arrays,
        **_facets(mesh, edges),
    )


def _nodes(n_points: int, cells: Arrays, edges: SolidEdges) -> dict[str, np.ndarray]:
    """Numbers of the nodes of each cell."""
    first, nodes = n_points + edges.n_edges, {}
    for kind, rows in cells.items():
        parts = [rows, n_points + edges.cell_edges[kind], first + edges.cell_quads[kind]]
        if kind == "hexahedron":
            parts.append((first + edges.n_quads + np.arange(len(rows)))[:, None])
        nodes[kind] = np.hstack(parts)
    return nodes


def _children(
    mesh: Mesh, cells: Arrays, nodes: Arrays
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """New cells by kind; their regions and parents."""
    rows: dict[str, list[np.ndarray]] = {}
    region: dict[str, list[np.ndarray]] = {}
    parent: dict[str, list[np.ndarray]] = {}
    before = 0
    for kind in cells:
        for made, table in CELLS[kind].items():
            rows.setdefault(made, []).append(nodes[kind][:, table].reshape(-1, table.shape[1]))
            n = len(table)
            region.setdefault(made, []).append(np.repeat(mesh.cell_region[kind], n))
            own = before + np.arange(len(nodes[kind]))
            parent.setdefault(made, []).append(np.repeat(own, n))
        before += len(nodes[kind])
    joined = {k: np.concatenate(parts) for k, parts in rows.items()}
    arrays = {
        "cell_region": {k: np.concatenate(parts) for k, parts in region.items()},
        "cell_parent": {k: np.concatenate(parts) for k, parts in parent.items()},
    }
    return joined, arrays


def _facets(mesh: Mesh, edges: SolidEdges) -> dict[str, Any]:
    """Facets divided into four, with what they had."""
    first = mesh.n_points + edges.n_edges
    facets = {}
    for kind, rows in mesh.facets.items():
        parts = [rows, mesh.n_points + edges.facet_edges[kind], first + edges.facet_quads[kind]]
        nodes = np.hstack(parts)
        facets[kind] = nodes[:, FACETS[kind]].reshape(-1, rows.shape[1])
    return {
        "facets": facets,
        "facet_marker": {k: np.repeat(v, 4) for k, v in mesh.facet_marker.items()},
        "facet_region": {k: np.repeat(v, 4, axis=0) for k, v in mesh.facet_region.items()},
    }


def _placed(
    mesh: Mesh, cells: Arrays, edges: SolidEdges, children: Arrays
) -> tuple[np.ndarray, int]:
    """Points of the divided mesh, and how many had to stay on their chords.

    New points go to the exact surfaces all at once; those around children that are not positive
    all over then go back, until there are none.
    """
    n = mesh.n_points
    exact = ExactSurfaces.of(mesh)
    straight = 0.5 * (mesh.points[edges.ends[:, 0]] + mesh.points[edges.ends[:, 1]])
    on_edges, bent = exact.of_edges(edges.facet_edges, straight)
    held = np.zeros(edges.n_edges + edges.n_quads, bool)
    while True:
        bent &= ~held[: edges.n_edges]
        place = np.where(bent[:, None], on_edges, straight)
        on_quads, pushed = _quad_centres(mesh, edges, exact, place, held[edges.n_edges :])
        points = [mesh.points, place, on_quads]
        if "hexahedron" in cells:
            points.append(_hexahedron_centres(mesh, cells, edges, place, on_quads))
        joined = np.concatenate(points)
        moved = np.zeros(len(joined), bool)
        moved[n : n + len(held)] = np.concatenate([bent, pushed])
        back = around_bad_children(joined, children, moved)
        if not len(back):
            return joined, int(held.sum())
        held[back - n] = True


def _quad_centres(
    mesh: Mesh, edges: SolidEdges, exact: ExactSurfaces, place: np.ndarray, held: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Centres of quadrilateral faces between their curved edges; those that left for a surface."""
    out = 0.5 * place[edges.quad_edges].sum(axis=1) - 0.25 * mesh.points[edges.quads].sum(axis=1)
    moved = np.zeros(edges.n_quads, bool)
    if edges.facet_quads.get("quad") is not None:
        number = edges.facet_quads["quad"][:, 0]
        foot, far = exact.of_facets("quad", out[number])
        far &= ~held[number]
        out[number[far]] = foot[far]
        moved[number[far]] = True
    return out, moved


def _hexahedron_centres(
    mesh: Mesh, cells: Arrays, edges: SolidEdges, place: np.ndarray, on_quads: np.ndarray
) -> np.ndarray:
    """Centres of hexahedra between their curved faces (Gordon and Hall)."""
    faces = on_quads[edges.cell_quads["hexahedron"]].sum(axis=1)
    sides = place[edges.cell_edges["hexahedron"]].sum(axis=1)
    corners = mesh.points[cells["hexahedron"]].sum(axis=1)
    return np.asarray(0.5 * faces - 0.25 * sides + 0.125 * corners)


def around_bad_children(points: np.ndarray, children: Arrays, moved: np.ndarray) -> np.ndarray:
    """Moved points of children that are not positive all over, sorted."""
    back = [np.zeros(0, np.int64)]
    if not moved.any():
        return back[0]
    for kind, rows in children.items():
        # A hexahedron without moved corners may have been bent, too, by way of its centre.
        near = rows if kind == "hexahedron" else rows[moved[rows].any(axis=1)]
        if not len(near):
            continue
        bad = near[~(least_jacobians(points, kind, near) > 0.0)]
        back.append(bad[moved[bad]])
    return np.unique(np.concatenate(back))

"""Curve tetrahedra of a mesh of space: a node an edge, those of the boundary on its surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.improve.exact_surfaces import ExactSurfaces
from csgmesh.improve.solid_edges import SolidEdges
from csgmesh.measures.space.curved import tetra_bounds
from csgmesh.mesh import Mesh

#: Cells whose Jacobian may sink below this share of its largest value get help.
FLAT = 0.1
#: From those that still do so below this one the nodes are taken back towards the chords.
FLATTEST = 0.01
#: How much of a curved edge's displacement the edges beside it take over, step by step.
SHARES = (0.25, 0.4, 0.55)
#: How often a displacement is halved before it is given up.
HALVINGS = 4


@dataclass(eq=False)
class _Bends:
    """Straight tetrahedra and the displacements of their edges' nodes from the chords.

    Attributes
    ----------
    mesh : Mesh
    cell_edges : (m, 6) int64
    middle : (e, 3) float64
        Middles of the chords.
    bend : (e, 3) float64
    """

    mesh: Mesh
    cell_edges: np.ndarray
    middle: np.ndarray
    bend: np.ndarray

    def flat_cells(self, share: float) -> np.ndarray:
        """Cells whose Jacobian is not proved to stay above a share of its largest, (k,)."""
        is_bent = np.asarray(self.bend.any(axis=1))
        at = np.flatnonzero(is_bent[self.cell_edges].any(axis=1))
        edges = self.cell_edges[at]
        corners = self.mesh.points[self.mesh.cells["tetra"][at]]
        nodes = np.concatenate([corners, self.middle[edges] + self.bend[edges]], axis=1)
        return at[tetra_bounds(nodes).ratio <= share]


def elevate_solid(mesh: Mesh) -> Mesh:
    """Curve a mesh of straight tetrahedra to second order; see `csgmesh.elevate`."""
    edges = SolidEdges.of(mesh.cells, mesh.facets, mesh.n_points)
    exact = ExactSurfaces.of(mesh)
    middle = 0.5 * (mesh.points[edges.ends[:, 0]] + mesh.points[edges.ends[:, 1]])
    place, is_curved = exact.of_edges(edges.facet_edges, middle)
    fixed = np.zeros(edges.n_edges, bool)
    for of_facet in edges.facet_edges.values():
        fixed[of_facet] = True
    bends = _Bends(mesh, edges.cell_edges["tetra"], middle, place - middle)
    _bend_neighbours(bends, is_curved, fixed)
    held = _take_back(bends)
    # Where nothing holds it back a node lies on its surface to the last bit.
    free = ~held & is_curved
    middle = middle + bends.bend
    middle[free] = place[free]
    return _finished(mesh, edges, middle, int((held & is_curved).sum()), exact.surfaces is not None)


def _bend_neighbours(bends: _Bends, is_curved: np.ndarray, fixed: np.ndarray) -> None:
    """Bend inner edges of flat cells along with the curved ones, as long as it helps."""
    bad = bends.flat_cells(FLAT)
    for share in SHARES:
        if not len(bad):
            return
        before = bends.bend.copy()
        edge = bends.cell_edges[bad]
        curved = is_curved[edge]
        depth = np.where(curved[:, :, None], bends.bend[edge], 0.0).sum(axis=1)
        pull = share * depth / np.maximum(curved.sum(axis=1), 1)[:, None]
        total, count = np.zeros_like(bends.bend), np.zeros(len(bends.bend))
        for k in range(6):
            free = ~fixed[edge[:, k]]
            np.add.at(total, edge[free, k], pull[free])
            np.add.at(count, edge[free, k], 1.0)
        hit = np.flatnonzero(count)
        bends.bend[hit] = total[hit] / count[hit, None]
        after = bends.flat_cells(FLAT)
        if len(after) > len(bad):
            # More harm than help among the neighbours.
            bends.bend = before
            return
        bad = after


def _take_back(bends: _Bends) -> np.ndarray:
    """Move nodes of cells that stay too flat towards their chords; which ones, (e,) bool."""
    times = np.zeros(len(bends.bend), np.int64)
    while True:
        bad = bends.flat_cells(FLATTEST)
        if not len(bad):
            return times > 0
        hit = np.unique(bends.cell_edges[bad])
        hit = hit[bends.bend[hit].any(axis=1)]
        times[hit] += 1
        bends.bend[hit] *= np.where(times[hit] <= HALVINGS, 0.5, 0.0)[:, None]


def _finished(
    mesh: Mesh, edges: SolidEdges, middle: np.ndarray, n_off: int, has_surfaces: bool
) -> Mesh:
    """The curved mesh: the points of the straight one first, then a node an edge."""
    n = mesh.n_points
    cells = np.hstack([mesh.cells["tetra"], n + edges.cell_edges["tetra"]])
    facets = {}
    if "triangle" in mesh.facets:
        facets = {
            "triangle6": np.hstack([mesh.facets["triangle"], n + edges.facet_edges["triangle"]])
        }
    points = np.concatenate([mesh.points, middle])
    info = {**mesh.info, "nodes_on_surfaces": has_surfaces, "nodes_off_surfaces": n_off}
    return Mesh(
        points,
        {"tetra10": cells},
        {"tetra10": mesh.cell_region["tetra"]},
        mesh.region_names,
        facets=facets,
        facet_marker={"triangle6": mesh.facet_marker["triangle"]} if facets else {},
        facet_region={"triangle6": mesh.facet_region["triangle"]} if facets else {},
        boundary_names=mesh.boundary_names,
        point_marker=np.r_[mesh.point_marker, np.full(len(middle), -1)],
        cell_parent={"tetra10": mesh.cell_parent["tetra"]} if mesh.cell_parent else {},
        domain=mesh.domain,
        info=info,
    )

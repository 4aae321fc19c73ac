"""Nodes for a mesh of straight cells: numbered, placed on exact curves, blended into the cells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from csgmesh.domain.curves import LINE
from csgmesh.improve.cell_edges import CellEdges
from csgmesh.improve.elevation.blending import blending_weights, straight_weights
from csgmesh.measures.jacobians import jacobian_bounds
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.lagrange import edge_nodes
from csgmesh.mesh.periodic import elevated_pairs

Arrays = Mapping[str, np.ndarray]

#: Kinds of order 2 to 5, by the number of corners.
CURVED_KINDS = {
    3: {2: "triangle6", 3: "triangle10", 4: "triangle15", 5: "triangle21"},
    4: {2: "quad9", 3: "quad16", 4: "quad25", 5: "quad36"},
}


@dataclass(eq=False)
class Curving:
    """A straight mesh and the nodes of its curved counterpart.

    Attributes
    ----------
    mesh : Mesh
    order : int
    family : str
        Of the nodes.
    edges : CellEdges
    bend : (e, order - 1, 2) float64
        Displacements of the nodes along each edge, from its lower end on, from its chord.
    is_curve : (e,) bool
        Which edges follow an exact curve.
    """

    mesh: Mesh
    order: int
    family: str
    edges: CellEdges
    bend: np.ndarray
    is_curve: np.ndarray

    @staticmethod
    def of(mesh: Mesh, order: int, family: str) -> Curving:
        """The facets' edges bent onto their exact curves."""
        facets = mesh.facets.get("line", np.zeros((0, 2), np.int64))
        edges = CellEdges.of(list(mesh.cells.values()), facets, mesh.n_points)
        bend = np.zeros((edges.n_edges, order - 1, 2))
        curving = Curving(mesh, order, family, edges, bend, np.zeros(edges.n_edges, bool))
        curving._follow_curves(facets)
        return curving

    def _follow_curves(self, facets: np.ndarray) -> None:
        mesh = self.mesh
        if mesh.curves is None or not len(facets):
            return
        curve = mesh.facet_curve["line"]
        bent = np.flatnonzero(np.where(curve >= 0, mesh.curves.kind[curve] != LINE, False))
        inner = edge_nodes(self.order, self.family)[1:-1]
        t0, t1 = mesh.facet_interval["line"][bent].T
        t = t0[:, None] + (t1 - t0)[:, None] * inner
        on = np.repeat(curve[bent], len(inner))
        place = mesh.curves.points(on, t.ravel()).reshape(len(bent), len(inner), 2)
        ends = mesh.points[facets[bent]]
        chord = ends[:, :1] + inner[:, None] * (ends[:, 1:] - ends[:, :1])
        away = place - chord
        turned = facets[bent, 0] > facets[bent, 1]
        away[turned] = away[turned, ::-1]
        self.bend[self.edges.facet_edge[bent]] = away
        self.is_curve[self.edges.facet_edge[bent]] = True

    @property
    def is_bent(self) -> np.ndarray:
        """Which edges are bent, (e,) bool."""
        return np.asarray(self.bend.any(axis=(1, 2)))

    def blocks(self) -> list[tuple[str, np.ndarray, np.ndarray]]:
        """Kind, corners and edges of each block of cells."""
        out, first = [], 0
        for rows in self.mesh.cells.values():
            kind = CURVED_KINDS[rows.shape[1]][self.order]
            out.append((kind, rows, self.edges.of_block(first, rows)))
            first += len(rows)
        return out

    def bent_cells(self) -> list[np.ndarray]:
        """Of each block the cells with a bent edge."""
        bent = self.is_bent
        return [np.flatnonzero(bent[edge].any(axis=1)) for _, _, edge in self.blocks()]

    def nodes(self, kind: str, rows: np.ndarray, edge: np.ndarray) -> np.ndarray:
        """Coordinates of the nodes of cells, (m, n, 2)."""
        n_inner, corners = self.order - 1, rows.shape[1]
        out: np.ndarray = straight_weights(kind, self.family) @ self.mesh.points[rows]
        end = np.roll(rows, -1, axis=1)
        away = self.bend[edge]
        turned = rows > end
        away[turned] = away[turned, ::-1]
        away = away.reshape(len(rows), corners * n_inner, 2)
        out[:, corners : corners + corners * n_inner] += away
        out[:, corners + corners * n_inner :] += blending_weights(kind, self.family) @ away
        return out

    def flat_cells(self, share: float) -> np.ndarray:
        """Cells whose Jacobian is not proved to stay above a share of its largest, (k,)."""
        bad, first = [np.zeros(0, np.int64)], 0
        for (kind, rows, edge), at in zip(self.blocks(), self.bent_cells(), strict=True):
            nodes = self.nodes(kind, rows[at], edge[at])
            bounds = jacobian_bounds(nodes, kind, self.family)
            bad.append(first + at[bounds.ratio <= share])
            first += len(rows)
        return np.concatenate(bad)

    def finished(self) -> Mesh:
        """The curved mesh; its facets' nodes lie on the exact curves."""
        mesh, n_inner = self.mesh, self.order - 1
        n, m = mesh.n_points, self.edges.n_edges
        inner = edge_nodes(self.order, self.family)[1:-1]
        ends = mesh.points[self.edges.ends]
        along = ends[:, :1] + inner[:, None] * (ends[:, 1:] - ends[:, :1]) + self.bend
        points, cells, first = [mesh.points, along.reshape(-1, 2)], {}, n + m * n_inner
        for kind, rows, edge in self.blocks():
            middles = self._inner_numbers(rows, np.roll(rows, -1, axis=1), edge)
            own = KINDS[kind].n_points - rows.shape[1] * self.order
            inside = first + np.arange(len(rows) * own).reshape(len(rows), own)
            cells[kind] = np.hstack(
                [rows, middles.reshape(len(rows), rows.shape[1] * n_inner), inside]
            )
            nodes = self.nodes(kind, rows, edge)
            points.append(nodes[:, nodes.shape[1] - own :].reshape(-1, 2))
            first += len(rows) * own
        facets = {}
        if "line" in mesh.facets:
            rows = mesh.facets["line"]
            middles = self._inner_numbers(rows[:, :1], rows[:, 1:], self.edges.facet_edge[:, None])
            facets = {f"line{self.order + 1}": np.hstack([rows, middles[:, 0]])}
        place = np.concatenate(points)
        info = {**mesh.info, "nodes": self.family, "nodes_on_curves": mesh.curves is not None}
        return _renamed(mesh, cells, facets, place, info)

    def _inner_numbers(self, start: np.ndarray, end: np.ndarray, edge: np.ndarray) -> np.ndarray:
        """Numbers of the nodes between the ends of edges, from `start` to `end`, (..., p - 1)."""
        n_inner = self.order - 1
        forwards = self.mesh.n_points + edge[..., None] * n_inner + np.arange(n_inner)
        return np.where((start > end)[..., None], forwards[..., ::-1], forwards)


def _renamed(
    mesh: Mesh, cells: Arrays, facets: Arrays, points: np.ndarray, info: dict[str, object]
) -> Mesh:
    """The mesh with other points and kinds, each cell and facet with what it had."""

    def of(kinds: Arrays, arrays: Arrays) -> dict[str, np.ndarray]:
        return dict(zip(kinds, arrays.values(), strict=True))

    facet_fields = ("facet_marker", "facet_region", "facet_curve", "facet_interval")
    of_facets: dict[str, Any] = {name: of(facets, getattr(mesh, name)) for name in facet_fields}
    return replace(
        mesh,
        points=points,
        cells=cells,
        facets=facets,
        cell_region=of(cells, mesh.cell_region),
        cell_parent=of(cells, mesh.cell_parent) if mesh.cell_parent else {},
        cell_green={},
        periodic=elevated_pairs(mesh.periodic, *next(iter(facets.items()))) if facets else (),
        blocks={},
        **of_facets,
        point_marker=np.r_[mesh.point_marker, np.full(len(points) - mesh.n_points, -1)],
        info=info,
    )

"""A mesh while it is divided: edges halved, children written, vertices placed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.improve.cell_edges import CellEdges
from csgmesh.improve.refinement.boundary import halve_facets
from csgmesh.improve.refinement.crossings import crossed_facets
from csgmesh.improve.refinement.dividing import Children
from csgmesh.improve.refinement.green import Block, undo_green
from csgmesh.improve.refinement.promise import refined_info
from csgmesh.improve.refinement.settling import settled
from csgmesh.improve.refinement.templates import BISECTION, RED_GREEN
from csgmesh.mesh import Mesh
from csgmesh.mesh.periodic import halved_pairs


@dataclass(eq=False)
class Division:
    """A mesh that is being divided."""

    mesh: Mesh
    method: str
    blocks: dict[str, Block]
    place: np.ndarray
    edges: CellEdges
    halved: np.ndarray
    middle: np.ndarray
    reference: np.ndarray | None

    @staticmethod
    def of(mesh: Mesh, method: str) -> Division:
        if method == "red-green":
            blocks, place = undo_green(mesh)
        else:
            rows, region = (part["triangle"] for part in (mesh.cells, mesh.cell_region))
            place = np.arange(len(rows))
            blocks = {"triangle": Block(rows, region, place, None)}
        facets = mesh.facets.get("line", np.zeros((0, 2), np.int64))
        edges = CellEdges.of([block.rows for block in blocks.values()], facets, mesh.n_points)
        halved, middle = np.zeros(edges.n_edges, np.int8), np.full(edges.n_edges, -1)
        reference = None
        if method != "red-green":
            reference = _references(mesh, method, edges)
        return Division(mesh, method, blocks, place, edges, halved, middle, reference)

    def mark(self, marked: np.ndarray | None) -> None:
        """Decide which edges are halved."""
        edges = self.edges
        if marked is None:
            self.halved[edges.edge] = 1
        else:
            chosen = np.zeros(len(edges.begin) - 1, bool)
            chosen[self.place[marked]] = True
            self.halved[edges.edge[np.repeat(chosen, np.diff(edges.begin))]] = 1
        watch = self._hanging()
        if marked is not None or watch is not None:
            self._spread(watch)
            self._make_way(watch)

    def mark_edges(self, pairs: np.ndarray) -> None:
        """Halve these edges, and others as conformity asks."""
        self.halved[self.edges.find(pairs)] = 1
        self._spread(None)
        self._make_way(None)

    def _spread(self, watch: np.ndarray | None) -> None:
        limit = [np.full(len(b.rows), b.rows.shape[1] - 1) for b in self.blocks.values()]
        self.edges.spread(self.halved, np.concatenate(limit), self.reference, watch)
        while self._halve_partners():
            self.edges.spread(self.halved, np.concatenate(limit), self.reference, watch)

    def _make_way(self, watch: np.ndarray | None) -> None:
        """Halve facets that others would run into, too."""
        edge = self.edges.facet_edge
        while len(edge):
            found = crossed_facets(self.mesh, self.halved[edge] != 0)
            if not len(found):
                return
            self.halved[edge[found]] = 1
            self._spread(watch)

    def _halve_partners(self) -> bool:
        """Halve the partners of halved facets on periodic sides; whether there were any."""
        changed = False
        for pair in self.mesh.periodic:
            both = self.edges.facet_edge[pair.facets["line"]]
            uneven = both[self.halved[both[:, 0]] != self.halved[both[:, 1]]]
            self.halved[uneven] = 1
            changed |= len(uneven) > 0
        return changed

    def _hanging(self) -> np.ndarray | None:
        """Mark edges that are halved on one side already; returns the cells that watch the halves.

        Once one of the halves is halved in turn, the cell on the other side must be divided whole.
        """
        watch, first = None, 0
        for block in self.blocks.values():
            if block.middle is not None:
                edge = self.edges.of_block(first, block.rows)
                cell, side = np.nonzero(block.middle >= 0)
                middle = block.middle[cell, side]
                self.halved[edge[cell, side]] = 1
                self.middle[edge[cell, side]] = middle
                watch = np.full(self.edges.n_edges, -1) if watch is None else watch
                for corner in (side, (side + 1) % block.rows.shape[1]):
                    half = np.stack([block.rows[cell, corner], middle], axis=1)
                    watch[self.edges.find(half)] = first + cell
            first += len(block.rows)
        return watch

    def finished(self) -> Mesh:
        """The divided mesh."""
        mesh, n = self.mesh, self.mesh.n_points
        fresh = np.flatnonzero((self.halved != 0) & (self.middle < 0))
        self.middle[fresh] = n + np.arange(len(fresh))
        children, centres = self._children(n + len(fresh))
        middle_of_facet = self.middle[self.edges.facet_edge]
        facets = halve_facets(mesh, middle_of_facet)
        points = np.empty((n + len(fresh) + len(centres), 2))
        points[:n] = mesh.points
        ends = self.edges.ends[fresh]
        new = points[n : n + len(fresh)]
        kernels.halve(mesh.points.reshape(-1), ends.reshape(-1), new.reshape(-1))
        points[facets.vertex] = facets.place
        if len(centres):
            corners, middles = points[centres[:, :4]], points[centres[:, 4:]]
            points[n + len(fresh) :] = 0.5 * middles.sum(axis=1) - 0.25 * corners.sum(axis=1)
        points.flags.writeable = False
        refined = Mesh(
            points,
            cells=children.joined(children.rows),
            cell_region=children.joined(children.region),
            cell_parent=children.joined(children.source),
            cell_green=children.greens(),
            region_names=mesh.region_names,
            boundary_names=mesh.boundary_names,
            point_marker=_lengthened(mesh.point_marker, len(points)),
            curves=mesh.curves,
            domain=mesh.domain,
            periodic=halved_pairs(mesh.periodic, middle_of_facet),
            info=refined_info(mesh, self.method, children.n_groups > 0),
            **facets.arrays,
        )
        return settled(refined, facets.vertex[facets.is_bent], mesh, list(self.blocks.values()))

    def _children(self, n: int) -> tuple[Children, np.ndarray]:
        """New cells; corners and middles of the quads that get a centre, numbered from n on."""
        children, centres, first = Children(), [np.zeros((0, 8), np.int64)], 0
        templates = RED_GREEN if self.method == "red-green" else BISECTION
        n_centres = 0
        for kind, block in self.blocks.items():
            width = block.rows.shape[1]
            edge = self.edges.of_block(first, block.rows)
            code = np.zeros(len(edge), np.int64)
            for j in range(width):
                code += self.halved[edge[:, j]].astype(np.int64) << j
            whole, is_green = code == (1 << width) - 1, None
            if self.reference is not None:
                code += 8 * (self.reference - 3 * np.arange(len(edge)))
            elif not whole.all():
                is_green = (code > 0) & ~whole
            centre = np.zeros(0, np.int64)
            if kind == "quad":
                centre = n + n_centres + np.cumsum(whole) - 1
                n_centres += int(whole.sum())
                centres.append(np.hstack([block.rows[whole], self.middle[edge[whole]]]))
            children.add(block, edge, self.middle, centre, code, templates[kind], is_green)
            self._close_parents(children, kind, block, code, whole)
            first += len(edge)
        return children, np.concatenate(centres)

    def _close_parents(
        self, children: Children, kind: str, block: Block, code: np.ndarray, whole: np.ndarray
    ) -> None:
        """Close beside deeper cells, where parents put together are divided whole."""
        if block.middle is None:
            return
        cell, side = np.nonzero((block.middle >= 0) & whole[:, None])
        middle, width = block.middle[cell, side], block.rows.shape[1]
        ends = [block.rows[cell, side], block.rows[cell, (side + 1) % width]]
        edge = self.edges.find(np.concatenate([np.stack([end, middle], axis=1) for end in ends]))
        edge = edge[self.halved[edge] != 0]
        if len(edge):
            count = RED_GREEN[kind].counts(kind)[code[: cell[0]]]
            children.close(kind, int(count.sum()), self.edges.ends[edge], self.middle[edge])


def _references(mesh: Mesh, method: str, edges: CellEdges) -> np.ndarray:
    """The half-edge of each triangle that is halved first."""
    begin = edges.begin[:-1]
    if method == "newest vertex" and mesh.info.get("refinement") == method:
        return begin
    a, b = (mesh.points[edges.ends[:, k]] for k in (0, 1))
    length = ((a - b) ** 2).sum(axis=1)
    edge = edges.edge.reshape(-1, 3)
    best, side = edge[:, 0], np.zeros(len(edge), np.int64)
    for j in (1, 2):
        # Of edges as long as each other the one with the lower number comes first, on either side.
        given = edge[:, j]
        longer = length[given] > length[best]
        longer |= (length[given] == length[best]) & (given < best)
        best, side = np.where(longer, given, best), np.where(longer, j, side)
    return begin + side


def _lengthened(marker: np.ndarray, n: int) -> np.ndarray:
    """Markers of points, -1 for new ones."""
    out = np.full(n, -1)
    out[: len(marker)] = marker
    out.flags.writeable = False
    return out

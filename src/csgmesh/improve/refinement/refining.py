"""The verb `csgmesh.refine`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from csgmesh import kernels
from csgmesh.errors import InputError
from csgmesh.improve.cell_edges import CellEdges
from csgmesh.improve.refinement.bending import make_room
from csgmesh.improve.refinement.boundary import halve_facets
from csgmesh.improve.refinement.dividing import Children
from csgmesh.improve.refinement.green import Block, undo_green
from csgmesh.improve.refinement.marks import marked_cells
from csgmesh.improve.refinement.promise import angle_reached, corner_sines, refined_info
from csgmesh.improve.refinement.templates import BISECTION, RED_GREEN
from csgmesh.mesh import Mesh
from csgmesh.mesh.periodic import halved_pairs
from csgmesh.options import check_choice

METHODS = ("red-green", "longest edge", "newest vertex")


def refine(mesh: Mesh, cells: Any = None, method: str = "red-green") -> Mesh:
    """Divide all cells of a plane mesh, or some and what conformity asks for.

    Every edge of a marked cell is halved. Facets keep their names, regions and curves, cells their
    region; new boundary vertices lie on the exact curve, as far from either end of their facet. A
    mesh without curves, such as one read from a file, is refined along its chords.

    Parameters
    ----------
    mesh : Mesh
        Of triangles, quads or both.
    cells : array_like or mapping of str to array_like, optional
        A mask or cell numbers, counted through all kinds, or either by kind. Default: all cells.
    method : {"red-green", "longest edge", "newest vertex"}
        How cells are divided; the last two know triangles only.

    Returns
    -------
    Mesh
        Conforming. ``cell_parent`` has for each cell the number of the one it is a part of, counted
        through all kinds of `mesh`.

    Raises
    ------
    InputError
        If the method is unknown, the mesh holds other cells, or a cell number is out of range.
    MeshingError
        If a curve runs so far from its chord that cells would turn over; with the place.

    Guarantees
    ----------
    The result conforms, and so do all further refinements of it. With a the smallest angle of the
    mesh that was refined first, and as long as edges are straight, no angle of a triangle falls
    below

    - a itself where all cells are refined by the first method: the inscribed triangle divides a
      triangle into four that are similar to it; a quad becomes four quads, ever nearer to
      parallelograms;
    - arctan(tan(a) / 3), some a / 3, where some are ("red-green": Bank, Sherman, Weiser 1983).
      Cells with one halved edge are cut into two (green); these are put together again before they
      are refined further, so angles do not degrade with the levels. The closure beside quads is of
      triangles or quads, so the mesh becomes mixed; angles of a rectangle 1 by r, r >= 1, become
      no smaller than arctan(1 / 2 r);
    - a / 2 ("longest edge": Rivara 1984; Rosenberg and Stenger 1975). Triangles are halved at their
      longest edge first;
    - a / 2 ("newest vertex": Mitchell 1989): each first triangle, whose longest edge is the first
      to be halved, has descendants of four classes of similar triangles only, all of which its
      repeated halving at longest edges has too.

    ``info["min_angle"]`` of the result says so, or what was reached where curves bend cells.

    Exceptions
    ----------
    A cell that an undone green pair was put together for names the pair's first as the parent of
    all its children. Cells at curves are bent by as much as the curve strays from the chord.

    Termination
    -----------
    Each edge is halved once at most.

    References
    ----------
    .. [1] R. E. Bank, A. H. Sherman, A. Weiser, "Some refinement algorithms and data structures for
       regular local mesh refinement", Scientific Computing (1983).
    .. [2] M.-C. Rivara, "Algorithms for refining triangular grids suitable for adaptive and
       multigrid techniques", Int. J. Numerical Methods in Engineering 20 (1984).
    .. [3] I. G. Rosenberg, F. Stenger, "A lower bound on the angles of triangles constructed by
       bisecting the longest side", Mathematics of Computation 29 (1975).
    .. [4] W. F. Mitchell, "A comparison of adaptive refinement techniques for elliptic problems",
       ACM Trans. Mathematical Software 15 (1989).

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], {"triangle": [[0, 1, 2], [0, 2, 3]]})
    >>> cm.refine(mesh).n_cells
    8
    >>> local = cm.refine(mesh, [0])
    >>> local.n_cells, local.cell_parent["triangle"]
    (6, array([0, 0, 0, 0, 1, 1]))
    """
    check_choice("method", method, METHODS, "refine")
    _check_kinds(mesh, method)
    marked = None if cells is None else marked_cells(mesh, cells)
    division = _Division.of(mesh, method)
    division.mark(marked)
    return division.finished()


def halve_edges(mesh: Mesh, pairs: np.ndarray) -> Mesh:
    """Halve some edges of a mesh of triangles, quads or both, and what conformity asks for.

    A triangle with one halved edge is cut into two there, for good; see `refine` for the rest.

    Parameters
    ----------
    mesh : Mesh
    pairs : (k, 2) int64
        Ends of the edges.
    """
    division = _Division.of(replace(mesh, cell_green={}), "red-green")
    division.mark_edges(pairs)
    return replace(division.finished(), cell_green={})


def _check_kinds(mesh: Mesh, method: str) -> None:
    known = ("triangle", "quad") if method == "red-green" else ("triangle",)
    others = [kind for kind in mesh.cells if kind not in known]
    if mesh.dim != 2 or others or set(mesh.facets) - {"line"}:
        held = ", ".join((*mesh.cells, *mesh.facets)) or "no cells"
        what = "triangles and quads" if method == "red-green" else "triangles"
        raise InputError(
            f"{method} refinement is for plane meshes of straight {what}; this one has dim "
            f"{mesh.dim} and holds {held}"
        )


@dataclass(eq=False)
class _Division:
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
    def of(mesh: Mesh, method: str) -> _Division:
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
        return _Division(mesh, method, blocks, place, edges, halved, middle, reference)

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

    def mark_edges(self, pairs: np.ndarray) -> None:
        """Halve these edges, and others as conformity asks."""
        self.halved[self.edges.find(pairs)] = 1
        self._spread(None)

    def _spread(self, watch: np.ndarray | None) -> None:
        limit = [np.full(len(b.rows), b.rows.shape[1] - 1) for b in self.blocks.values()]
        self.edges.spread(self.halved, np.concatenate(limit), self.reference, watch)
        while self._halve_partners():
            self.edges.spread(self.halved, np.concatenate(limit), self.reference, watch)

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
            cell_green=children.joined(children.green) if children.n_groups else {},
            region_names=mesh.region_names,
            boundary_names=mesh.boundary_names,
            point_marker=np.r_[mesh.point_marker, np.full(len(points) - n, -1)],
            curves=mesh.curves,
            domain=mesh.domain,
            periodic=halved_pairs(mesh.periodic, middle_of_facet),
            info=refined_info(mesh, self.method, children.n_groups > 0),
            **facets.arrays,
        )
        return self._settled(refined, facets.vertex[facets.is_bent])

    def _settled(self, refined: Mesh, bent: np.ndarray) -> Mesh:
        """With room made beside curves, and the bound on the angles that was reached."""
        sines = corner_sines(refined)
        if len(bent):
            parent = np.concatenate(list(refined.cell_parent.values()))
            share = 1.0 if self.method == "red-green" else 0.5
            refined = make_room(
                refined, bent, self.mesh.n_points, share * corner_sines(self.mesh)[parent]
            )
            sines = corner_sines(refined)
        bound = refined.info.get("min_angle")
        if not isinstance(bound, float):
            return refined
        reached = angle_reached(refined, sines, bound)
        return replace(refined, info={**refined.info, "min_angle": reached})

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

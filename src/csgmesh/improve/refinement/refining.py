"""The verb `csgmesh.refine`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from csgmesh.errors import InputError
from csgmesh.improve.refinement.bisection import bisect_solid
from csgmesh.improve.refinement.division import Division
from csgmesh.improve.refinement.marks import marked_cells
from csgmesh.improve.refinement.solid_templates import CELLS, FACETS
from csgmesh.improve.refinement.solids import refine_solid
from csgmesh.mesh import Mesh
from csgmesh.mesh.surfaces import require_solid_cells
from csgmesh.options import check_choice

METHODS = ("red-green", "longest edge", "newest vertex")


def refine(mesh: Mesh, cells: Any = None, method: str = "red-green") -> Mesh:
    """Divide all cells of a mesh, or some and what conformity asks for.

    Every edge of a marked cell is halved. Facets keep their names, regions and curves, cells their
    region; new boundary vertices lie on the exact curve, as far from either end of their facet. A
    mesh without curves, such as one read from a file, is refined along its chords.

    Parameters
    ----------
    mesh : Mesh
        Of straight triangles, quads or both; in space of tetrahedra, hexahedra, wedges, pyramids.
    cells : array_like or mapping of str to array_like, optional
        A mask or cell numbers, counted through all kinds, or either by kind. Default: all cells.
        In space some tetrahedra are refined by the method "longest edge".
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

    In space each tetrahedron, hexahedron or wedge becomes eight, each pyramid six and four
    tetrahedra; a tetrahedron has descendants of three shapes at the most (Bey 1995), cut along its
    shortest diagonal first. By "longest edge" tetrahedra become up to eight (Plaza and Carey 2000);
    no bound on their angles is proved, and none was seen to fall far.

    Exceptions
    ----------
    A cell that an undone green pair was put together for names the pair's first as the parent of
    all its children. Cells at curves are bent by as much as the curve strays from the chord. In
    space a vertex that would turn a cell over stays on its chord; ``info["points_on_chords"]``
    counts these.

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
    .. [5] J. Bey, "Tetrahedral grid refinement", Computing 55 (1995).
    .. [6] A. Plaza, G. F. Carey, "Local refinement of simplicial grids based on the skeleton",
       Applied Numerical Mathematics 32 (2000).

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
    if mesh.dim == 3:
        require_solid_cells(mesh.cells, "refine")
        _check_solid(mesh, cells, method)
        if method == METHODS[0]:
            return refine_solid(mesh)
        every = np.arange(mesh.n_cells)
        return bisect_solid(mesh, every if cells is None else marked_cells(mesh, cells))
    _check_kinds(mesh, method)
    marked = None if cells is None else marked_cells(mesh, cells)
    division = Division.of(mesh, method)
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
    division = Division.of(replace(mesh, cell_green={}), "red-green")
    division.mark_edges(pairs)
    return replace(division.finished(), cell_green={})


def _check_solid(mesh: Mesh, cells: Any, method: str) -> None:
    held = [kind for kind in (*mesh.cells, *mesh.facets) if kind not in (*CELLS, *FACETS)]
    if held:
        raise InputError(
            "meshes of space are refined while their cells are straight; this one holds "
            f"{', '.join(held)}: refine first, then elevate"
        )
    if method == "newest vertex":
        raise InputError(f"{method} refinement is for plane meshes; this one has dim 3")
    if method == "longest edge" and set(mesh.cells) != {"tetra"}:
        raise InputError(
            f"{method} refinement in space is for tetrahedra; this mesh holds "
            f"{', '.join(mesh.cells)}"
        )
    if cells is not None and method != "longest edge":
        raise InputError(
            'in space some cells are refined by method="longest edge", and by others all; got '
            f"cells= and method={method!r}"
        )


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

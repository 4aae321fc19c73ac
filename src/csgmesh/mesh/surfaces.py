"""Meshes of surfaces in space: cells that are triangles or quads, and what lies on their sides."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from csgmesh.errors import InputError
from csgmesh.mesh.kinds import KINDS
from csgmesh.mesh.mesh import Mesh


def is_surface(mesh: Mesh) -> bool:
    """Whether a mesh of space has cells, none of which is solid.

    Examples
    --------
    >>> is_surface(Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], {"triangle": [[0, 1, 2]]}))
    True
    """
    return mesh.dim == 3 and bool(mesh.cells) and all(KINDS[k].dim == 2 for k in mesh.cells)


def require_solid_cells(kinds: Iterable[str], what: str) -> None:
    """Refuse triangles and quads in space.

    Raises
    ------
    InputError
        Naming the kind.

    Examples
    --------
    >>> require_solid_cells(["tetra"], "refine")
    """
    for kind in kinds:
        if KINDS[kind].dim == 2:
            raise InputError(
                f"{what} needs solid cells in space; this is the mesh of a surface, of {kind}s"
            )


def with_facets(mesh: Mesh) -> Mesh:
    """The surface with its cells as facets too, if it has none, out of the regions of the cells.

    Examples
    --------
    >>> bare = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], {"triangle": [[0, 1, 2]]})
    >>> with_facets(bare).facet_region["triangle"]
    array([[ 0, -1]])
    """
    if mesh.n_facets:
        return mesh
    sides = {k: np.column_stack([r, np.full(len(r), -1)]) for k, r in mesh.cell_region.items()}
    return replace(
        mesh,
        facets=dict(mesh.cells),
        facet_region=sides,
        facet_marker={},
        facet_curve={},
        facet_interval={},
    )

"""Where the nodes of a mesh's curved cells are, and elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh.mesh.kinds import KINDS
from csgmesh.mesh.lagrange import EQUISPACED, LOBATTO, resampling
from csgmesh.mesh.mesh import Mesh


def node_family(mesh: Mesh) -> str:
    """``"lobatto"`` or ``"equispaced"``; files hold equispaced nodes."""
    return LOBATTO if mesh.info.get("nodes") == LOBATTO else EQUISPACED


def is_curved(mesh: Mesh) -> bool:
    """Whether any cell has nodes beside its corners."""
    return any(KINDS[kind].order > 1 for kind in mesh.cells)


def with_nodes(mesh: Mesh, family: str) -> Mesh:
    """The same curved cells, told by nodes in other places.

    Up to order 2 both families are the same.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.elevate(cm.generate(cm.Disk((0, 0), 1), size=0.5), 3)
    >>> moved = with_nodes(mesh, "equispaced")
    >>> bool(abs(with_nodes(moved, "lobatto").points - mesh.points).max() < 1e-14)
    True
    """
    given = node_family(mesh)
    if family == given or not is_curved(mesh):
        return mesh
    points = np.array(mesh.points)
    for kind, rows in mesh.cells.items():
        if KINDS[kind].order > 2:
            corners = KINDS[kind].n_corners
            origin = mesh.points[rows[:, :1]]
            moved = resampling(kind, given, family)[corners:] @ (mesh.points[rows] - origin)
            points[rows[:, corners:]] = moved + origin
    return replace(
        mesh, points=points, info={**mesh.info, "nodes": family, "nodes_on_curves": False}
    )

"""From any triangulation to the Delaunay triangulation, by turning edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh import kernels
from csgmesh.errors import InputError
from csgmesh.mesh import Mesh
from csgmesh.mesh.orientation import orientations


def flip_to_delaunay(mesh: Mesh) -> Mesh:
    """Turn edges until the triangulation is Delaunay, facets kept.

    An edge whose opposite vertices lie inside the circles of its triangles is replaced by the other
    diagonal, until there is none left (Lawson 1977; with exact predicates, so it ends). Facets and
    edges between regions stay, so with facets inside the result is the constrained Delaunay
    triangulation of vertices and facets. The number of turns grows with the square of the number of
    points at worst.

    Parameters
    ----------
    mesh : Mesh
        Plane, of counterclockwise triangles.

    Returns
    -------
    Mesh
        With the same points, facets and names; ``info["flips"]`` tells how many edges were turned.

    Raises
    ------
    InputError
        If the mesh holds anything but triangles, or one that is not counterclockwise.

    Examples
    --------
    >>> import csgmesh as cm
    >>> kite = cm.Mesh([[0, 0], [1, -0.2], [2, 0], [1, 0.2]], {"triangle": [[0, 1, 2], [0, 2, 3]]})
    >>> cm.flip_to_delaunay(kite).cells["triangle"].tolist()
    [[2, 3, 1], [3, 0, 1]]
    """
    if mesh.dim != 2 or list(mesh.cells) != ["triangle"]:
        raise InputError(f"edges turn in plane meshes of triangles; got {', '.join(mesh.cells)}")
    rows = mesh.cells["triangle"]
    turned = np.flatnonzero(orientations(mesh.points, rows) <= 0)
    if len(turned):
        x, y = mesh.points[rows[turned[0]]].mean(axis=0)
        raise InputError(
            f"triangles must be counterclockwise; triangle {turned[0]} at ({x:.6g}, {y:.6g}) is not"
        )
    m = len(rows)
    origin = rows.astype(np.int32).reshape(-1)
    twin, line = np.full(3 * m, -1, np.int32), np.full(3 * m, -1, np.int32)
    edge_of = np.full(mesh.n_points, -1, np.int32)
    facets = mesh.facets.get("line", np.zeros((0, 2), np.int64)).astype(np.int32).ravel()
    kernels.pair_half_edges(origin, twin, edge_of, np.empty(3 * m, np.int32), facets, line)
    region = np.repeat(mesh.cell_region["triangle"], 3)
    locked = ((line >= 0) | (region != region[twin])).astype(np.int8)
    counts, stack = np.zeros(3, np.int64), np.empty(256, np.int32)
    points = np.array(mesh.points).reshape(-1)
    while kernels.flip_edges(points, origin, twin, locked, stack, counts):
        pass
    return replace(
        mesh,
        cells={"triangle": origin.reshape(-1, 3)},
        cell_parent={},
        cell_green={},
        blocks={},
        info={**mesh.info, "delaunay": True, "flips": int(counts[2])},
    )

"""The verb `csgmesh.elevate`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh.errors import InputError, MeshingError
from csgmesh.improve.elevation.curving import Curving
from csgmesh.improve.elevation.repair import bend_neighbours, divide
from csgmesh.improve.elevation.solids import elevate_solid
from csgmesh.mesh import Mesh
from csgmesh.mesh.lagrange import EQUISPACED, LOBATTO
from csgmesh.options import check_choice

ORDERS = (2, 3, 4, 5)
#: How often cells that cannot be curved as they are get divided.
ROUNDS = 6


def elevate(mesh: Mesh, order: int = 2, nodes: str = "lobatto") -> Mesh:
    """Curve the cells of a mesh: more nodes, those of the boundary on its exact curves or surfaces.

    Nodes along edges stand at the Gauss-Lobatto points of the exact curve's parameter, which makes
    the error of the area one of order 2 p. Nodes inside follow by blending (Szabó and Babuška on
    triangles, Gordon and Hall on quads). Files get equispaced nodes.

    Parameters
    ----------
    mesh : Mesh
        Of straight triangles, quads or both, or of straight tetrahedra. One without curves or
        surfaces, such as one read from a file, keeps its straight edges.
    order : {2, 3, 4, 5}
        Degree p of the polynomials along edges; in space 2.
    nodes : {"lobatto", "equispaced"}
        Where along its edge a node stands. With equispaced ones the error of the area is of order
        p + 1 rounded up to an even number. Up to order 2 there is no difference.

    Returns
    -------
    Mesh
        Of kinds triangle6, triangle10, triangle15, triangle21, quad9, quad16, quad25 or quad36 and
        line3 to line6, or tetra10 and triangle6, with the points of `mesh` first.

    Raises
    ------
    InputError
        If the order or the nodes are unknown, or the mesh holds other cells.
    MeshingError
        If a cell cannot be curved even after refinement; with the place.

    Guarantees
    ----------
    The Jacobian of every cell is positive everywhere, proved by its Bernstein coefficients (Johnen,
    Remacle, Geuzaine 2013). Where the cells at a curve are too flat for it, their other edges bend
    along; where that does not help, or where two edges of a cell meet on a smooth curve, cells are
    divided in ``info["divided_to_curve"]`` rounds, and so the result may have more of them.

    In space nothing is divided: nodes that cannot follow go back towards their chords as far as
    they must, and ``info["nodes_off_surfaces"]`` counts those of the boundary. The error of a
    volume is of order 4.

    References
    ----------
    .. [1] B. Szabó, I. Babuška, "Finite Element Analysis" (1991).
    .. [2] W. J. Gordon, C. A. Hall, "Transfinite element methods", Numerische Mathematik 21 (1973).
    .. [3] A. Johnen, J.-F. Remacle, C. Geuzaine, "Geometrical validity of curvilinear finite
       elements", J. Computational Physics 233 (2013).

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Disk((0, 0), 1), size=0.5)
    >>> for order in (2, 3):
    ...     area = cm.quality(cm.elevate(mesh, order)).total_area
    ...     print(f"{abs(area - 3.141592653589793):.0e}")
    2e-06
    2e-10
    """
    if order not in ORDERS:
        raise InputError(f"order must be one of 2, 3, 4, 5; got {order!r}")
    check_choice("nodes", nodes, (LOBATTO, EQUISPACED), "elevate")
    if mesh.dim == 3:
        _check_solid(mesh, order)
        return elevate_solid(mesh)
    if mesh.dim != 2 or set(mesh.cells) - {"triangle", "quad"} or set(mesh.facets) - {"line"}:
        held = ", ".join((*mesh.cells, *mesh.facets))
        raise InputError(
            "only plane meshes of straight triangles and quads can be elevated; this one has dim "
            f"{mesh.dim} and holds {held}"
        )
    for rounds in range(ROUNDS + 1):
        curving = Curving.of(mesh, order, nodes)
        bad = bend_neighbours(curving)
        if len(bad) and rounds < ROUNDS:
            mesh = divide(curving, bad)
            continue
        bad = curving.flat_cells(0.0) if len(bad) else bad
        if not len(bad):
            curved = curving.finished()
            return replace(curved, info={**curved.info, "divided_to_curve": rounds})
    x, y = _middle(mesh, int(bad[0]))
    raise MeshingError(
        f"{len(bad)} cells cannot be curved, the first at ({x:.6g}, {y:.6g}): their Jacobian stays "
        f"negative after {ROUNDS} divisions; mesh with a smaller size or deviation there"
    )


def _check_solid(mesh: Mesh, order: int) -> None:
    if set(mesh.cells) != {"tetra"} or set(mesh.facets) - {"triangle"}:
        held = ", ".join((*mesh.cells, *mesh.facets))
        raise InputError(
            "of meshes of space only those of straight tetrahedra can be elevated; this one holds "
            f"{held}"
        )
    if order != 2:
        raise InputError(f"tetrahedra can be elevated to order 2; got {order!r}")


def _middle(mesh: Mesh, cell: int) -> np.ndarray:
    for rows in mesh.cells.values():
        if cell < len(rows):
            break
        cell -= len(rows)
    middle: np.ndarray = mesh.points[rows[cell]].mean(axis=0)
    return middle

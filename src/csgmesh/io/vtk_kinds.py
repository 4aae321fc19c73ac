"""VTK's numbers for kinds of cells, and its orders of their points.

Source: VTK's vtkCellType.h and vtkHigherOrderQuadrilateral (Lagrange cells).
"""

from __future__ import annotations

from functools import cache

import numpy as np

from csgmesh.mesh import KINDS
from csgmesh.mesh.lagrange import lattice

#: VTK's numbers for the kinds of cells.
VTK_TYPE = {
    "vertex": 1,
    "line": 3,
    "triangle": 5,
    "quad": 9,
    "tetra": 10,
    "hexahedron": 12,
    "wedge": 13,
    "pyramid": 14,
    "line3": 21,
    "triangle6": 22,
    "quad8": 23,
    "tetra10": 24,
    "quad9": 28,
}

#: Lagrange cells of any order: their kind follows from the number of points.
LAGRANGE = {68: "line", 69: "triangle", 70: "quad"}
VTK_TYPE |= {
    kind: number
    for number, shape in LAGRANGE.items()
    for kind, data in KINDS.items()
    if kind.startswith(shape) and data.dim < 3 and data.order > 2
}


def kind_of(number: int, n_points: int) -> str | None:
    """The kind of a VTK cell with so many points; None for one that is not supported."""
    if number not in LAGRANGE:
        return next((kind for kind, n in VTK_TYPE.items() if n == number), None)
    shape = LAGRANGE[number]
    kinds = (shape, f"{shape}{n_points}")
    return next((k for k in kinds if k in KINDS and KINDS[k].n_points == n_points), None)


@cache
def vtk_order(kind: str) -> np.ndarray | None:
    """For each place in a VTK cell the number of our point; None where the orders agree.

    On the third and fourth edge of a quad VTK goes along the axes, and inside row by row.
    """
    data = KINDS[kind]
    if not kind.startswith("quad") or data.order < 3:
        return None
    p = data.order
    place = {tuple(ij): k for k, ij in enumerate(lattice(4, p).tolist())}
    inner = range(1, p)
    order = [(0, 0), (p, 0), (p, p), (0, p)]
    order += [(i, 0) for i in inner] + [(p, j) for j in inner]
    order += [(i, p) for i in inner] + [(0, j) for j in inner]
    order += [(i, j) for j in inner for i in inner]
    return np.array([place[ij] for ij in order])

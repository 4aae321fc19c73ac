"""Where the inner nodes of a cell go when its edges bend.

The displacement of the edges is blended into the cell: on a triangle each edge's, times the product
of the barycentric coordinates of its ends over what that is on the edge (Szabó and Babuška 1991);
on a quad each edge's, falling off linearly towards the opposite one (Gordon and Hall 1973). Both
give polynomials of the order of the edges.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from csgmesh.mesh.kinds import KINDS
from csgmesh.mesh.lagrange import basis, reference_nodes


@cache
def straight_weights(kind: str, family: str) -> np.ndarray:
    """Matrix (n, corners) from the corners to the nodes of the straight cell."""
    corners = KINDS[kind].n_corners
    x, y = reference_nodes(kind, family).T
    if corners == 3:
        return np.stack([1 - x - y, x, y], axis=1)
    return np.stack([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y], axis=1)


@cache
def blending_weights(kind: str, family: str) -> np.ndarray:
    """Matrix (inner nodes, corners * (p - 1)) from the edges' displacements to the inner nodes'."""
    data = KINDS[kind]
    order, corners = data.order, data.n_corners
    inner = slice(corners * order, data.n_points)
    places = reference_nodes(kind, family)[inner]
    share = straight_weights(kind, family)[inner]
    parts = []
    for e in range(corners):
        if corners == 3:
            a, b = share[:, e], share[:, (e + 1) % 3]
            along = 0.5 * (1.0 + b - a)
            factor = a * b / (along * (1.0 - along))
        else:
            x, y = places.T
            along = (x, y, 1.0 - x, 1.0 - y)[e]
            factor = (1.0 - y, x, y, 1.0 - x)[e]
        values = basis(f"line{order + 1}", family, along[:, None])[:, 2:]
        parts.append(factor[:, None] * values)
    return np.concatenate(parts, axis=1)

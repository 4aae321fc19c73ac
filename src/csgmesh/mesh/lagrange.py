"""Nodes and polynomials of curved cells: lines, triangles and quads up to order 5.

Reference coordinates: a line is [0, 1], a triangle has corners (0, 0), (1, 0), (0, 1), a quad is
the unit square. Nodes come in the order of `Kind`: corners, edges, then the inside likewise.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from csgmesh.errors import InputError
from csgmesh.mesh.kinds import KINDS

LOBATTO, EQUISPACED = "lobatto", "equispaced"


@cache
def edge_nodes(order: int, family: str) -> np.ndarray:
    """Places of the nodes along an edge, ascending, (order + 1,) in [0, 1].

    Examples
    --------
    >>> edge_nodes(3, "lobatto").round(4).tolist()
    [0.0, 0.2764, 0.7236, 1.0]
    """
    if family == EQUISPACED:
        return np.linspace(0.0, 1.0, order + 1)
    if family != LOBATTO:
        raise InputError(f"nodes must be {LOBATTO!r} or {EQUISPACED!r}; got {family!r}")
    legendre = np.polynomial.legendre.Legendre.basis(order)
    inner = np.sort(legendre.deriv().roots().real)
    # Exactly symmetric, so that both cells of an edge see the same nodes.
    inner = 0.5 * (inner - inner[::-1])
    return np.concatenate([[0.0], 0.5 * (1.0 + inner), [1.0]])


@cache
def lattice(corners: int, order: int) -> np.ndarray:
    """Places of the nodes of a cell on a lattice of integers, (n, 2) within 0 .. order.

    Examples
    --------
    >>> lattice(3, 2).tolist()
    [[0, 0], [2, 0], [0, 2], [1, 0], [1, 1], [0, 1]]
    """
    if order == 0:
        return np.zeros((1, 2), np.int64)
    corner = np.array(
        [(0, 0), (1, 0), (0, 1)] if corners == 3 else [(0, 0), (1, 0), (1, 1), (0, 1)]
    )
    corner = corner * order
    parts = [corner]
    for a, b in zip(corner, np.roll(corner, -1, axis=0), strict=True):
        parts.append(a + np.arange(1, order)[:, None] * (b - a) // order)
    rest = order - (3 if corners == 3 else 2)
    if rest >= 0:
        parts.append(lattice(corners, rest) + 1)
    return np.concatenate(parts)


@cache
def reference_nodes(kind: str, family: str) -> np.ndarray:
    """Reference coordinates of the nodes of a line, triangle or quad, (n, 1 or 2).

    Inside a triangle each is the mean of what its three edges suggest (Blyth and Pozrikidis 2006).
    """
    data = KINDS[kind]
    v = edge_nodes(data.order, family)
    if data.dim == 1:
        return np.concatenate([v[[0, -1]], v[1:-1]])[:, None]
    i, j = lattice(data.n_corners, data.order).T
    if data.n_corners == 4:
        return np.stack([v[i], v[j]], axis=1)
    k = data.order - i - j
    x = (1.0 + 2.0 * v[i] - v[j] - v[k]) / 3.0
    y = (1.0 + 2.0 * v[j] - v[i] - v[k]) / 3.0
    return np.stack([x, y], axis=1)


def basis(kind: str, family: str, at: np.ndarray) -> np.ndarray:
    """Values at reference points (m, 1 or 2) of the polynomials that are 1 at one node, (m, n).

    Examples
    --------
    >>> basis("line3", "lobatto", np.array([[0.25]])).round(3).tolist()
    [[0.375, -0.125, 0.75]]
    """
    return _orthogonal(kind, at, None) @ _inverse(kind, family)


def gradients(kind: str, family: str, at: np.ndarray) -> np.ndarray:
    """Their derivatives in each direction, (1 or 2, m, n)."""
    directions = range(at.shape[1])
    return np.stack([_orthogonal(kind, at, d) @ _inverse(kind, family) for d in directions])


@cache
def _inverse(kind: str, family: str) -> np.ndarray:
    inverse: np.ndarray = np.linalg.inv(_orthogonal(kind, reference_nodes(kind, family), None))
    return inverse


def _orthogonal(kind: str, at: np.ndarray, derivative: int | None) -> np.ndarray:
    """Products of Legendre polynomials, or their derivatives in one direction, (m, n)."""
    data = KINDS[kind]
    powers = range(data.order + 1)
    values = []
    for d in range(at.shape[1]):
        columns = []
        for k in powers:
            polynomial = np.polynomial.legendre.Legendre.basis(k, domain=[0, 1])
            columns.append((polynomial.deriv() if d == derivative else polynomial)(at[:, d]))
        values.append(np.stack(columns, axis=1))
    if data.dim == 1:
        return values[0]
    pairs = [(i, j) for i in powers for j in powers if data.n_corners == 4 or i + j <= data.order]
    i, j = np.array(pairs).T
    product: np.ndarray = values[0][:, i] * values[1][:, j]
    return product


def resampling(kind: str, given: str, wanted: str) -> np.ndarray:
    """Matrix (n, n) from values at the nodes of one family to values at those of another."""
    return basis(kind, given, reference_nodes(kind, wanted))

"""Bounds on the Jacobian of curved tetrahedra, and their volumes, in Bernstein form.

The Jacobian determinant of a tetrahedron of second order is a polynomial of degree 3. It lies
between the least and the greatest of its 20 Bernstein coefficients, those at the corners are
values, and the mean of all is its mean. Where the bounds are too far apart the cell is cut into
eight, whose coefficients are nearer to the polynomial.

Source: A. Johnen, J.-F. Remacle, C. Geuzaine, "Geometrical validity of curvilinear finite
elements", J. Computational Physics 233 (2013).
"""

from __future__ import annotations

from functools import cache
from math import factorial

import numpy as np

from csgmesh.measures.jacobians import JacobianBounds
from csgmesh.mesh import KINDS

_DEGREE = 3
#: How often a cell is cut into eight at most.
_DEPTH = 5
#: Bounds are near enough when they differ by less than this share of the largest Jacobian.
_NEAR = 0.02
#: Coefficients are found by solving a system, which costs a few digits of the largest one.
_ROUNDING = 1e-12
#: Cells looked at together.
_BATCH = 20_000


def tetra_bounds(nodes: np.ndarray) -> JacobianBounds:
    """Bounds on the Jacobians of tetrahedra of second order, relative to the unit one.

    Parameters
    ----------
    nodes : (m, 10, 3) float64
        Corners, then the nodes of the edges in the order of `Kind`.

    Examples
    --------
    >>> corners = np.array([(0.0, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 1)])
    >>> middles = [corners[list(edge)].mean(axis=0) for edge in KINDS["tetra10"].edges]
    >>> tetra_bounds(np.vstack([corners, middles])[None]).least.round(9)
    array([2.])
    """
    parts = [
        _bounds(_coefficients(nodes[i : i + _BATCH])) for i in range(0, max(len(nodes), 1), _BATCH)
    ]
    return JacobianBounds(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def curved_volumes(nodes: np.ndarray) -> np.ndarray:
    """Signed volumes of tetrahedra of second order (m, 10, 3), exactly, (m,)."""
    parts = [_coefficients(nodes[i : i + _BATCH]) for i in range(0, max(len(nodes), 1), _BATCH)]
    return np.concatenate([part.mean(axis=1) / 6.0 for part in parts])


def facet_middles(nodes: np.ndarray) -> np.ndarray:
    """Places of triangles of second order (m, 6, 3) at their middles, (m, 3)."""
    return np.asarray((4.0 * nodes[:, 3:].sum(axis=1) - nodes[:, :3].sum(axis=1)) / 9.0)


def _coefficients(nodes: np.ndarray) -> np.ndarray:
    """Bernstein coefficients of the Jacobians, (m, 20), the corners' first."""
    local = nodes - nodes[:, :1]
    du, dv, dw = (slope @ local for slope in _gradients())
    found: np.ndarray = (du * np.cross(dv, dw)).sum(axis=2) @ _solver().T
    return found


@cache
def _lattice() -> np.ndarray:
    """Exponents of the barycentric coordinates of the Bernstein polynomials, (20, 4)."""
    n = _DEGREE
    every = [
        (n - i - j - k, i, j, k)
        for i in range(n + 1)
        for j in range(n + 1 - i)
        for k in range(n + 1 - i - j)
    ]
    corners = [tuple(n * e for e in row) for row in np.eye(4, dtype=int).tolist()]
    return np.array(corners + [row for row in every if row not in corners])


@cache
def _gradients() -> np.ndarray:
    """Derivatives in u, v, w of the nodes' polynomials at the lattice's places, (3, 20, 10)."""
    share = _lattice() / _DEGREE
    slope = np.array([(-1, -1, -1), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
    corner = (4.0 * share - 1.0)[:, :, None] * slope
    edge = [
        4.0 * (share[:, a, None] * slope[b] + share[:, b, None] * slope[a])
        for a, b in KINDS["tetra10"].edges
    ]
    return np.moveaxis(np.concatenate([corner, np.stack(edge, axis=1)], axis=1), 2, 0)


def _bernstein(share: np.ndarray) -> np.ndarray:
    """Bernstein polynomials at barycentric coordinates (k, 4), (k, 20)."""
    many = [
        factorial(_DEGREE) // np.prod([factorial(e) for e in row]) for row in _lattice().tolist()
    ]
    value: np.ndarray = np.array(many, float) * np.prod(share[:, None] ** _lattice(), axis=2)
    return value


@cache
def _solver() -> np.ndarray:
    inverse: np.ndarray = np.linalg.inv(_bernstein(_lattice() / _DEGREE))
    return inverse


@cache
def _eighths() -> np.ndarray:
    """Matrices from coefficients to those of the eight parts, (8, 20, 20)."""
    corners = np.eye(4)
    nodes = np.vstack([corners, [corners[list(e)].mean(axis=0) for e in KINDS["tetra10"].edges]])
    parts = [(0, 4, 6, 7), (4, 1, 5, 8), (6, 5, 2, 9), (7, 8, 9, 3)]
    parts += [(4, 6, 7, 8), (5, 6, 4, 8), (6, 7, 8, 9), (8, 5, 6, 9)]
    share = _lattice() / _DEGREE
    return np.stack([_solver() @ _bernstein(share @ nodes[list(part)]) for part in parts])


def _bounds(coefficients: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    size = np.abs(coefficients).max(axis=1, initial=0.0)
    most, found = coefficients.max(axis=1, initial=-np.inf), coefficients[:, :4].min(axis=1)
    least = np.full(len(coefficients), np.inf)
    cell, piece = np.arange(len(coefficients)), coefficients
    for depth in range(_DEPTH + 1):
        low, seen = piece.min(axis=1), piece[:, :4].min(axis=1)
        np.minimum.at(found, cell, seen)
        unsure = (low < found[cell] - _NEAR * size[cell]) & (depth < _DEPTH)
        # A cell that is turned over somewhere needs no closer look.
        unsure &= found[cell] > 0.0
        np.minimum.at(least, cell[~unsure], low[~unsure])
        cell, piece = np.repeat(cell[unsure], 8), piece[unsure]
        if not len(cell):
            break
        piece = np.einsum("qij,mj->mqi", _eighths(), piece).reshape(-1, piece.shape[1])
    least = np.where(np.isfinite(least), least, found)
    return np.minimum(least, found) - _ROUNDING * size, most + _ROUNDING * size, found

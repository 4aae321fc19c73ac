"""Bounds on the Jacobian of curved cells, by its Bernstein coefficients.

The Jacobian determinant of a cell of order p is a polynomial: of degree 2 (p - 1) on a triangle, of
degree 2 p - 1 in each direction on a quad. It lies between the least and the greatest of its
Bernstein coefficients, and those at the corners are values. Where the two are too far apart, the
cell is cut into four, whose coefficients are nearer to the polynomial.

Source: A. Johnen, J.-F. Remacle, C. Geuzaine, "Geometrical validity of curvilinear finite
elements", J. Computational Physics 233 (2013).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import comb, factorial

import numpy as np

from csgmesh.mesh.kinds import KINDS
from csgmesh.mesh.lagrange import basis, gradients, lattice

#: How often a cell is cut into four at most.
_DEPTH = 8
#: Bounds are near enough when they differ by less than this share of the largest Jacobian.
_NEAR = 0.02
#: Coefficients are found by solving a system, which costs a few digits of the largest one.
_ROUNDING = 1e-11
#: Cells looked at together.
_BATCH = 20_000


@dataclass(frozen=True, eq=False)
class JacobianBounds:
    """Bounds over each cell, relative to its reference cell.

    Attributes
    ----------
    least, most : (m,) float64
        The Jacobian is nowhere less than `least` and nowhere more than `most`.
    found : (m,) float64
        The smallest value that it was seen to take.
    """

    least: np.ndarray
    most: np.ndarray
    found: np.ndarray

    @property
    def ratio(self) -> np.ndarray:
        """Scaled Jacobian: least over most, (m,)."""
        return self.least / np.maximum(self.most, np.finfo(float).tiny)


def jacobian_bounds(nodes: np.ndarray, kind: str, family: str) -> JacobianBounds:
    """Bounds on the Jacobians of curved triangles or quads.

    Parameters
    ----------
    nodes : (m, n, 2) float64
    kind, family : str

    Examples
    --------
    >>> square = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]])
    >>> jacobian_bounds(square, "quad", "equispaced").least.round(12)
    array([1.])
    """
    parts = [
        _bounds(_coefficients(nodes[i : i + _BATCH], kind, family), KINDS[kind].n_corners)
        for i in range(0, max(len(nodes), 1), _BATCH)
    ]
    return JacobianBounds(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _coefficients(nodes: np.ndarray, kind: str, family: str) -> np.ndarray:
    corners, order = KINDS[kind].n_corners, KINDS[kind].order
    degree = 2 * (order - 1) if corners == 3 else 2 * order - 1
    at = lattice(corners, degree) / max(degree, 1)
    du, dv = gradients(kind, family, at)
    local = nodes - nodes[:, :1]
    (xu, yu), (xv, yv) = (np.moveaxis(d @ local, 2, 0) for d in (du, dv))
    found: np.ndarray = (xu * yv - yu * xv) @ _solver(corners, degree).T
    return found


@cache
def _solver(corners: int, degree: int) -> np.ndarray:
    at = lattice(corners, degree) / max(degree, 1)
    inverse: np.ndarray = np.linalg.inv(_bernstein(corners, degree, at))
    return inverse


def _bernstein(corners: int, degree: int, at: np.ndarray) -> np.ndarray:
    """Bernstein polynomials at reference points, (k, N), in the order of the lattice."""
    x, y = at.T[:, :, None]
    i, j = lattice(corners, degree).T
    if corners == 3:
        k = degree - i - j
        many = [
            factorial(degree) // (factorial(a) * factorial(b) * factorial(c))
            for a, b, c in zip(i.tolist(), j.tolist(), k.tolist(), strict=True)
        ]
        return np.array(many, float) * x**i * y**j * (1 - x - y) ** k
    many = [comb(degree, a) * comb(degree, b) for a, b in zip(i.tolist(), j.tolist(), strict=True)]
    value: np.ndarray = np.array(many, float)
    return value * x**i * (1 - x) ** (degree - i) * y**j * (1 - y) ** (degree - j)


@cache
def _quarters(corners: int, degree: int) -> np.ndarray:
    """Matrices from coefficients to those of the four quarters, (4, N, N)."""
    at = lattice(corners, degree) / max(degree, 1)
    if corners == 3:
        maps = [0.5 * at, 0.5 * at + [0.5, 0], 0.5 * at + [0, 0.5], 0.5 - 0.5 * at]
    else:
        maps = [0.5 * at + [a, b] for a in (0, 0.5) for b in (0, 0.5)]
    solver = _solver(corners, degree)
    return np.stack([solver @ _bernstein(corners, degree, part) for part in maps])


def _bounds(coefficients: np.ndarray, corners: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    m, n = coefficients.shape
    degree = {_count(corners, d): d for d in range(12)}[n]
    size = np.abs(coefficients).max(axis=1, initial=0.0)
    most, found = coefficients.max(axis=1), coefficients[:, :corners].min(axis=1)
    least = np.full(m, np.inf)
    # Coefficients may be far larger than any value.
    scale = np.maximum(np.abs(coefficients[:, :corners]).max(axis=1), _NEAR * size)
    cell, piece = np.arange(m), coefficients
    for depth in range(_DEPTH + 1):
        low, seen = piece.min(axis=1), piece[:, :corners].min(axis=1)
        np.minimum.at(found, cell, seen)
        unsure = (low < np.minimum(found[cell], seen) - _NEAR * scale[cell]) & (depth < _DEPTH)
        # A cell that is turned over somewhere needs no closer look.
        unsure &= found[cell] > 0
        np.minimum.at(least, cell[~unsure], low[~unsure])
        cell, piece = cell[unsure], piece[unsure]
        if not len(cell):
            break
        piece = np.einsum("qij,mj->mqi", _quarters(corners, degree), piece).reshape(-1, n)
        cell = np.repeat(cell, 4)
    least = np.where(np.isfinite(least), least, found)
    return np.minimum(least, found) - _ROUNDING * size, most + _ROUNDING * size, found


def _count(corners: int, degree: int) -> int:
    return (degree + 1) * (degree + 2) // 2 if corners == 3 else (degree + 1) ** 2


def edge_area_terms(nodes: np.ndarray, family: str) -> np.ndarray:
    """Green's terms ``1/2 ∫ (x dy - y dx)`` along polynomial edges, (k,), exactly.

    Parameters
    ----------
    nodes : (k, p + 1, 2) float64
        Of each edge: its two ends, then what lies between.
    family : str
    """
    order = nodes.shape[1] - 1
    weight = _area_form(order, family)
    x, y = nodes[:, :, 0], nodes[:, :, 1]
    terms: np.ndarray = 0.5 * (((x @ weight) * y).sum(axis=1) - ((y @ weight) * x).sum(axis=1))
    return terms


@cache
def _area_form(order: int, family: str) -> np.ndarray:
    """Integrals of each polynomial times the derivative of each other one, (p + 1, p + 1)."""
    kind = "line" if order == 1 else f"line{order + 1}"
    x, w = np.polynomial.legendre.leggauss(order + 1)
    at = 0.5 * (x[:, None] + 1)
    value, slope = basis(kind, family, at), gradients(kind, family, at)[0]
    form: np.ndarray = (value * (0.5 * w)[:, None]).T @ slope
    return form


def curved_areas(nodes: np.ndarray, kind: str, family: str) -> np.ndarray:
    """Signed areas of curved cells, (m,), from their edges."""
    total = np.zeros(len(nodes))
    local = nodes - nodes[:, :1]
    for edge in KINDS[kind].facets:
        total += edge_area_terms(local[:, list(edge)], family)
    return total

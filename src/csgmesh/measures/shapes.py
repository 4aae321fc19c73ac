"""Measures of single cells of the plane, vectorised over the cells of one kind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class CellMeasures:
    """Measures of cells, an entry a cell.

    Attributes
    ----------
    min_angle, max_angle : (m,) float64
        Extreme inner angles at the corners, degrees in [0, 360).
    min_edge, max_edge : (m,) float64
        Extreme edge lengths.
    area : (m,) float64
        Signed: positive for counterclockwise cells.
    scaled_jacobian, sicn : (m,) float64
        Smallest over the corners; NaN for triangles.
    """

    min_angle: np.ndarray
    max_angle: np.ndarray
    min_edge: np.ndarray
    max_edge: np.ndarray
    area: np.ndarray
    scaled_jacobian: np.ndarray
    sicn: np.ndarray


def measure_cells(points: np.ndarray, corners: np.ndarray) -> CellMeasures:
    """Measures of straight-sided triangles or quads.

    Parameters
    ----------
    points : (n, 2) float64
    corners : (m, 3 or 4) int64

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> measure_cells(square, np.array([[0, 1, 2, 3]])).scaled_jacobian
    array([1.])
    """
    m, k = corners.shape
    x, y = points[:, 0], points[:, 1]
    edge_x = [x[corners[:, (j + 1) % k]] - x[corners[:, j]] for j in range(k)]
    edge_y = [y[corners[:, (j + 1) % k]] - y[corners[:, j]] for j in range(k)]
    length = [np.hypot(a, b) for a, b in zip(edge_x, edge_y, strict=True)]
    min_angle, max_angle = np.full(m, np.inf), np.full(m, -np.inf)
    jacobian, sicn, area = np.full(m, np.inf), np.full(m, np.inf), np.zeros(m)
    for j in range(k):
        before = (j - 1) % k
        det = edge_x[before] * edge_y[j] - edge_y[before] * edge_x[j]
        dot = -(edge_x[before] * edge_x[j] + edge_y[before] * edge_y[j])
        angle = np.degrees(np.arctan2(det, dot)) % 360.0
        np.minimum(min_angle, angle, out=min_angle)
        np.maximum(max_angle, angle, out=max_angle)
        if k == 4:
            with np.errstate(divide="ignore", invalid="ignore"):
                np.fmin(jacobian, det / (length[before] * length[j]), out=jacobian)
                np.fmin(sicn, 2 * det / (length[before] ** 2 + length[j] ** 2), out=sicn)
    for j in range(1, k - 1):
        # Triangles of a fan from the first corner: differences keep the digits far from the origin.
        ax, ay = x[corners[:, j]] - x[corners[:, 0]], y[corners[:, j]] - y[corners[:, 0]]
        area += 0.5 * (ax * edge_y[j] - ay * edge_x[j])
    if k == 3:
        jacobian, sicn = np.full(m, np.nan), np.full(m, np.nan)
    shortest, longest = np.minimum.reduce(length), np.maximum.reduce(length)
    return CellMeasures(min_angle, max_angle, shortest, longest, area, jacobian, sicn)

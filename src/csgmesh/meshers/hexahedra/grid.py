"""A rectilinear grid whose planes pass through the flat faces of a domain."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from csgmesh.meshers.hexahedra.strata import Strata

#: Planes that are wished for, but not necessary, keep this share of a cell from others.
_APART = 0.6


@dataclass(frozen=True, eq=False)
class Grid:
    """Coordinates of the planes along each axis."""

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray

    @classmethod
    def of(cls, strata: Strata, size: float) -> Grid:
        """Planes through flat faces, near corners where they fit, and about `size` apart."""
        low, high = strata.domain.bounds()
        near = 10.0 * strata.domain.snap
        lines = []
        for axis in range(3):
            flat = strata.face_place[strata.face_axis == axis]
            needed = _distinct(np.concatenate([flat, [low[axis], high[axis]]]), near)
            for wish in np.unique(strata.corners[:, axis]):
                if np.abs(needed - wish).min() >= _APART * size:
                    needed = np.sort(np.append(needed, wish))
            lines.append(_divided(needed, size))
        return cls(*lines)

    @property
    def axes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """x, y and z."""
        return self.x, self.y, self.z

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of cells along each axis."""
        return len(self.x) - 1, len(self.y) - 1, len(self.z) - 1

    def middles(self, cells: np.ndarray) -> np.ndarray:
        """Middles of cells given by their number in the padded grid, (k, 3)."""
        at = np.unravel_index(cells, np.array(self.shape) + 2)
        middle = [0.5 * (line[1:] + line[:-1]) for line in self.axes]
        return np.column_stack([m[i - 1] for m, i in zip(middle, at, strict=True)])

    def corners(self, cells: np.ndarray) -> np.ndarray:
        """Points of the grid, z fastest, of cells given so, (k, 8), as hexahedra."""
        i, j, k = (i - 1 for i in np.unravel_index(cells, np.array(self.shape) + 2))
        _, ny, nz = (len(line) for line in self.axes)
        first = (i * ny + j) * nz + k
        steps = [0, ny * nz, ny * nz + nz, nz]
        return np.stack([first + s for s in (*steps, *(s + 1 for s in steps))], axis=1)

    def points(self, which: np.ndarray) -> np.ndarray:
        """Places of points of the grid, (k, 3)."""
        at = np.unravel_index(which, tuple(len(line) for line in self.axes))
        return np.column_stack([line[i] for line, i in zip(self.axes, at, strict=True)])


def _distinct(values: np.ndarray, near: float) -> np.ndarray:
    values = np.sort(values)
    return values[np.append(True, np.diff(values) > near)]


def _divided(planes: np.ndarray, size: float) -> np.ndarray:
    parts = [planes[:1]]
    for a, b in pairwise(planes):
        n = max(round((b - a) / size), 1)
        steps = a + (b - a) * np.arange(1, n + 1) / n
        steps[-1] = b
        parts.append(steps)
    return np.concatenate(parts)

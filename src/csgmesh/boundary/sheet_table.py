"""Triangles of the boundaries of several bodies as one table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(eq=False)
class Sheets:
    """Triangles, the surface each lies on, and the body whose boundary it belongs to.

    Attributes
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int64
    surface : (m,) int64
    layer : (m,) int64
        The body; -1 for what shall be cut and cut others but bounds nothing.
    moved : list of (int, float)
        Points that others of the same body were merged into, and over which distance.
    """

    points: np.ndarray
    triangles: np.ndarray
    surface: np.ndarray
    layer: np.ndarray
    moved: list[tuple[int, float]]

    def sheet(self) -> np.ndarray:
        """A number for each surface of each body, (m,)."""
        return (self.layer + 1) * (int(self.surface.max()) + 1) + self.surface

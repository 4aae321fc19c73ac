"""Domains that a planar domain sweeps: what a sweeping mesher may know of a solid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from csgmesh.domain.pslg import Pslg


@dataclass(frozen=True, eq=False)
class SweptDomain:
    """A planar domain, extruded or turned, then placed.

    Attributes
    ----------
    profile : Pslg
        In (x, y) if extruded along z from 0; in (r, z) if turned about the z axis.
    is_turned : bool
    amount : float
        Height, or angle in degrees.
    matrix, offset : (3, 3), (3,) float64
        The placement.
    side : mapping of str to str
        Name of the solid's boundary for each name of the profile's.
    start, end : str or None
        Names of the two ends; None for a full turn.
    """

    profile: Pslg
    is_turned: bool
    amount: float
    matrix: np.ndarray
    offset: np.ndarray
    side: Mapping[str, str]
    start: str | None
    end: str | None

    @property
    def is_closed(self) -> bool:
        """Whether the sweep ends where it began."""
        return self.is_turned and self.amount >= 360.0

    def carried(self, points: np.ndarray, amount: float) -> np.ndarray:
        """Points of the profile (n, 2) at a station of the sweep, (n, 3)."""
        if self.is_turned:
            turn = np.radians(amount)
            c, s = np.cos(turn), np.sin(turn)
            local = np.column_stack([c * points[:, 0], s * points[:, 0], points[:, 1]])
        else:
            local = np.column_stack([points, np.full(len(points), amount)])
        return np.asarray(local @ self.matrix.T + self.offset)

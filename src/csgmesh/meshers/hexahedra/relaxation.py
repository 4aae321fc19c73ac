"""Relaxation of the cells behind a boundary: averages first, energies where cells stay bad."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.meshers.hexahedra.blocks import Blocks
from csgmesh.meshers.hexahedra.placing import FIXED, FREE, ON_CURVE, Places, frames, put
from csgmesh.meshers.hexahedra.strata import Strata

#: Cells with a smaller scaled Jacobian are optimised.
_GOOD = 0.45
_AVERAGING = 3
#: Further rounds so many cells from a curve.
_AVERAGING_AT_CURVES, _NEAR_CURVES = 5, 4
_UNTANGLING = 25
_ROUNDING = 6
_SHARPENING = 8


@dataclass
class Relaxation:
    """Cells near the boundary and the state of their relaxation."""

    points: np.ndarray
    hexes: np.ndarray
    star: np.ndarray
    star_begin: np.ndarray
    moves: np.ndarray
    scale: np.ndarray
    quality: np.ndarray
    places: Places
    strata: Strata

    @classmethod
    def of(
        cls,
        points: np.ndarray,
        blocks: Blocks,
        places: Places,
        strata: Strata,
        size: float,
        held: np.ndarray,
    ) -> Relaxation:
        """Of all cells; vertices held (n,) bool and those at corners stay."""
        hexes, n = np.ascontiguousarray(blocks.hexes), len(points)
        begin = np.concatenate([[0], np.cumsum(np.bincount(hexes.ravel(), minlength=n))])
        star = np.empty(hexes.size, np.int64)
        kernels.list_stars(hexes, begin[:-1].copy(), star)
        moves = ~held & (places.kind != FIXED) & (np.diff(begin) > 0)
        scale = np.full(n, 1.0 / size)
        quality = np.empty(len(hexes))
        return cls(points, hexes, star, begin, moves, scale, quality, places, strata)

    def average(self) -> None:
        """Inner vertices to the mean of their neighbours."""
        inner = self.moves & (self.places.kind == FREE)
        close = (self.places.kind == ON_CURVE) & self.moves
        for _ in range(_NEAR_CURVES if close.any() else 0):
            close[self.hexes[close[self.hexes].any(axis=1)].ravel()] = True
        for own, rounds in ((inner, _AVERAGING), (inner & close, _AVERAGING_AT_CURVES)):
            vertices = np.flatnonzero(own)
            for _ in range(rounds if len(vertices) else 0):
                start = 0
                while start < len(vertices):
                    start = kernels.average_in_cells(
                        self.points, self.hexes, self.star, self.star_begin, vertices, start
                    )

    def sweep(self, vertices: np.ndarray, epsilon: float, power: int) -> None:
        """Visit some vertices once, then put those of the boundary back."""
        scratch = np.zeros((4, 9))
        outer = vertices[self.places.kind[vertices] != FREE]
        frame = frames(self.points, self.places, self.strata, outer)
        start = 0
        while start < len(vertices):
            start = kernels.relax(
                self.points,
                self.hexes,
                self.star,
                self.star_begin,
                self.places.kind,
                frame,
                self.scale,
                scratch,
                vertices,
                start,
                epsilon,
                power,
            )
        put(self.points, self.places, self.strata, outer)

    def least(self, hexes: np.ndarray) -> float:
        """Smallest determinant at a corner of some cells."""
        return float(kernels.least_determinant(self.points, hexes, self.scale, np.zeros((1, 9))))

    def measure(self) -> None:
        """Smallest scaled Jacobian at a corner of each cell."""
        kernels.least_corners(self.points, self.hexes, self.quality)

    def run(self) -> None:
        """Average, then untangle, round and raise the worst where cells are bad."""
        self.average()
        self.measure()
        for _ in range(_UNTANGLING):
            if not self.quality.min(initial=1.0) <= 0.0:
                break
            self.visit_bad(1)
        for power, times in ((1, _ROUNDING), (3, _SHARPENING)):
            if not (self.quality < _GOOD).any():
                break
            best, kept = float(self.quality.min()), self.points.copy()
            for _ in range(times):
                self.visit_bad(power)
                now = float(self.quality.min())
                if now > best:
                    best, kept = now, self.points.copy()
                if now >= _GOOD:
                    break
            self.points[:] = kept
            self.measure()

    def visit_bad(self, power: int) -> None:
        """One visit of the vertices of bad cells, at first also of their neighbours."""
        own = np.zeros(len(self.points), bool)
        own[self.hexes[self.quality < _GOOD].ravel()] = True
        own &= self.moves
        if power == 1:
            own[self.hexes[own[self.hexes].any(axis=1)].ravel()] = True
            own &= self.moves
        touched = np.flatnonzero(own[self.hexes].any(axis=1))
        near = self.hexes[touched]
        least = min(self.least(near), 0.0)
        self.sweep(np.flatnonzero(own), float(np.sqrt(1e-12 + 0.04 * least**2)), power)
        fresh = np.empty(len(near))
        kernels.least_corners(self.points, near, fresh)
        self.quality[touched] = fresh

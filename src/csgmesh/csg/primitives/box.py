"""Axis-parallel boxes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitive import Frame, Primitive
from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError
from csgmesh.tolerance import SMALLEST

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Box(Primitive):
    """An axis-parallel rectangle from corner `lo` to corner `hi`.

    Parts of the boundary: ``left``, ``right``, ``bottom``, ``top``.

    Parameters
    ----------
    lo, hi : (2,) float
        Lowest and highest corner.
    name : str, optional
        Default ``"box"``.

    Raises
    ------
    ShapeError
        If `lo` is not below `hi` in every coordinate.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Box((0, 0), (4, 2), name="plate").contains([(1, 1), (5, 1)])
    array([ True, False])
    """

    lo: tuple[float, ...]
    hi: tuple[float, ...]

    kind: ClassVar[str] = "box"
    convex: ClassVar[bool] = True
    simple: ClassVar[bool] = True

    def __init__(self, lo: ArrayLike, hi: ArrayLike, *, name: str | None = None) -> None:
        where = self.place(name)
        low = checks.vector(lo, "lo", where)
        high = checks.vector(hi, "hi", where, len(low))
        if len(low) == 3:
            raise ShapeError(f"{where}: boxes in space are not there yet; got lo {low}, hi {high}")
        for a, b in zip(low, high, strict=True):
            if not b - a >= SMALLEST:
                raise ShapeError(
                    f"{where}: lo must be below hi in every coordinate; got {low} and {high}"
                )
        self._settle(name, lo=low, hi=high)

    @property
    def parts(self) -> tuple[str, ...]:
        return ("left", "right", "bottom", "top")

    def curves(self) -> tuple[Curves, np.ndarray]:
        (x0, y0), (x1, y1) = self.lo, self.hi
        corners = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        return Curves.lines(corners, np.roll(corners, -1, axis=0)), np.array([2, 1, 3, 0])

    def inside(self, points: np.ndarray) -> np.ndarray:
        x, y = points[:, 0], points[:, 1]
        result = (x >= self.lo[0]) & (x <= self.hi[0])
        result &= y >= self.lo[1]
        result &= y <= self.hi[1]
        return result

    def unit_frame(self) -> Frame:
        low, high = np.array(self.lo), np.array(self.hi)
        return Frame("cube", 0.5 * low + 0.5 * high, np.diag(2.0 / (high - low)))

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        low = np.minimum(matrix * self.lo, matrix * self.hi).sum(axis=1)
        high = np.maximum(matrix * self.lo, matrix * self.hi).sum(axis=1)
        return low + offset, high + offset

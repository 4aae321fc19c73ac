"""Axis-parallel boxes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitive import Frame, Planar
from csgmesh.csg.solid import Faceted, Solid
from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError
from csgmesh.tolerance import SMALLEST

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


#: Two triangles a side, in the order of the parts; corner 4·i + 2·j + k lies at x_i, y_j, z_k.
_TRIANGLES = (
    np.array(("013", "032", "467", "475", "026", "064", "157", "173", "045", "051", "237", "276"))
    .view("U1")
    .astype(np.int64)
    .reshape(12, 3)
)


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Box(Planar, Solid):
    """An axis-parallel rectangle, or box in space, from corner `lo` to corner `hi`.

    Parts of the boundary: ``left``, ``right`` (±x), ``bottom``, ``top`` (±y; in space ±z), and in
    space ``front``, ``back`` (±y).

    Parameters
    ----------
    lo, hi : (2,) or (3,) float
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
        for a, b in zip(low, high, strict=True):
            if not b - a >= SMALLEST:
                raise ShapeError(
                    f"{where}: lo must be below hi in every coordinate; got {low} and {high}"
                )
        self._settle(name, lo=low, hi=high)

    @property
    def dim(self) -> int:  # type: ignore[override]
        """2 in the plane, 3 in space."""
        return len(self.lo)

    @property
    def parts(self) -> tuple[str, ...]:
        return ("left", "right", "bottom", "top", "front", "back")[: 2 * self.dim]

    def curves(self) -> tuple[Curves, np.ndarray]:
        (x0, y0), (x1, y1) = self.lo, self.hi
        corners = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        return Curves.lines(corners, np.roll(corners, -1, axis=0)), np.array([2, 1, 3, 0])

    def inside(self, points: np.ndarray) -> np.ndarray:
        result = np.ones(len(points), bool)
        for axis, (low, high) in enumerate(zip(self.lo, self.hi, strict=True)):
            result &= points[:, axis] >= low
            result &= points[:, axis] <= high
        return result

    def body(self) -> Faceted:
        choice = np.indices((2, 2, 2)).reshape(3, 8).T
        corners = np.where(choice == 0, self.lo, self.hi)
        part = np.array([0, 1, 2, 3, 4, 5])
        return Faceted(corners, _TRIANGLES, np.repeat(part, 2), part)

    def support(self, directions: np.ndarray) -> np.ndarray:
        return np.maximum(directions * self.lo, directions * self.hi).sum(axis=1)

    def unit_frame(self) -> Frame:
        low, high = np.array(self.lo), np.array(self.hi)
        return Frame("cube", 0.5 * low + 0.5 * high, np.diag(2.0 / (high - low)))

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return offset - self.support(-matrix), offset + self.support(matrix)

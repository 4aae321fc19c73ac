"""Cylinders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitives.cone import axis_of, direction_of, tapered
from csgmesh.csg.solid import Revolution, Solid, across, frame_along

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Cylinder(Solid):
    """A circular cylinder around the axis from `base` to `top`.

    Parts of the boundary: ``side``, ``base``, ``top``.

    Parameters
    ----------
    base, top : (3,) float
        Ends of the axis.
    radius : float
        Positive.
    name : str, optional
        Default ``"cylinder"``.

    Raises
    ------
    ShapeError
        If base and top are the same point, or the radius is not positive and finite.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Cylinder((0, 0, 0), (0, 0, 2), 1, name="bore").contains([(0.9, 0, 1), (0, 0, 3)])
    array([ True, False])
    """

    base: tuple[float, ...]
    top: tuple[float, ...]
    radius: float

    kind: ClassVar[str] = "cylinder"
    convex: ClassVar[bool] = True

    def __init__(
        self, base: ArrayLike, top: ArrayLike, radius: float, *, name: str | None = None
    ) -> None:
        where = self.place(name)
        start, end = axis_of(base, top, where)
        self._settle(name, base=start, top=end, radius=checks.positive(radius, "radius", where))

    @property
    def parts(self) -> tuple[str, ...]:
        return ("side", "base", "top")

    def inside(self, points: np.ndarray) -> np.ndarray:
        axis, height = direction_of(self.base, self.top)
        local = points - self.base
        along = local @ axis
        local -= along[:, None] * axis
        within = (along >= 0.0) & (along <= height)
        return within & ((local**2).sum(axis=1) <= self.radius * self.radius)

    def support(self, directions: np.ndarray) -> np.ndarray:
        ends = np.maximum(directions @ self.base, directions @ self.top)
        return ends + self.radius * across(directions, direction_of(self.base, self.top)[0])

    def body(self) -> Revolution:
        axis, height = direction_of(self.base, self.top)
        profile = tapered(height, self.radius, self.radius)
        return Revolution(profile, 360.0, frame_along(axis), np.array(self.base))

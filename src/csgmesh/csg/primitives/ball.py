"""Balls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitive import Frame
from csgmesh.csg.primitives.ellipsoid import half_disk
from csgmesh.csg.solid import Revolution, Solid

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Ball(Solid):
    """The points of space at most `radius` from `center`.

    Its boundary is a single part.

    Parameters
    ----------
    center : (3,) float
    radius : float
        Positive.
    name : str, optional
        Default ``"ball"``.

    Raises
    ------
    ShapeError
        If the radius is not positive and finite.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Ball((2, 1, 0), 0.5).bounds()
    (array([ 1.5,  0.5, -0.5]), array([2.5, 1.5, 0.5]))
    """

    center: tuple[float, ...]
    radius: float

    kind: ClassVar[str] = "ball"
    convex: ClassVar[bool] = True

    def __init__(self, center: ArrayLike, radius: float, *, name: str | None = None) -> None:
        where = self.place(name)
        self._settle(
            name,
            center=checks.vector(center, "center", where, 3),
            radius=checks.positive(radius, "radius", where),
        )

    def inside(self, points: np.ndarray) -> np.ndarray:
        return ((points - self.center) ** 2).sum(axis=1) <= self.radius * self.radius

    def unit_frame(self) -> Frame:
        return Frame("ball", np.array(self.center), np.eye(3) / self.radius)

    def support(self, directions: np.ndarray) -> np.ndarray:
        return directions @ self.center + self.radius * np.sqrt((directions**2).sum(axis=1))

    def body(self) -> Revolution:
        return Revolution(half_disk(self.radius), 360.0, np.eye(3), np.array(self.center))

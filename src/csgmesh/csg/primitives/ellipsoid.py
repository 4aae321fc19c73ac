"""Ellipsoids."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitive import Frame
from csgmesh.csg.solid import Profile, Revolution, Solid
from csgmesh.domain.curves import Curves

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def half_disk(radius: float) -> Profile:
    """The profile of a ball: quarter arcs from the south pole to the north pole."""
    centre = np.zeros((2, 2))
    u, v = np.tile([radius, 0.0], (2, 1)), np.tile([0.0, radius], (2, 1))
    quarter = 0.5 * np.pi
    arcs = Curves.arcs(centre, u, v, np.array([-quarter, 0.0]), np.array([0.0, quarter]))
    axis = Curves.lines(np.array([[0.0, radius]]), np.array([[0.0, -radius]]))
    return Profile(Curves.concatenate([arcs, axis]), np.array([0, 0, -1]))


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Ellipsoid(Solid):
    """An ellipsoid with its axes along the coordinate axes.

    Its boundary is a single part.

    Parameters
    ----------
    center : (3,) float
    semi_axes : (3,) float
        Along x, y and z, positive.
    name : str, optional
        Default ``"ellipsoid"``.

    Raises
    ------
    ShapeError
        If a semi-axis is not positive and finite.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Ellipsoid((0, 0, 0), (3, 2, 1)).contains([(2.9, 0, 0), (0, 0, 2)])
    array([ True, False])
    """

    center: tuple[float, ...]
    semi_axes: tuple[float, ...]

    kind: ClassVar[str] = "ellipsoid"
    convex: ClassVar[bool] = True

    def __init__(self, center: ArrayLike, semi_axes: ArrayLike, *, name: str | None = None) -> None:
        where = self.place(name)
        lengths = checks.vector(semi_axes, "semi_axes", where, 3)
        self._settle(
            name,
            center=checks.vector(center, "center", where, 3),
            semi_axes=tuple(checks.positive(a, "each semi-axis", where) for a in lengths),
        )

    def inside(self, points: np.ndarray) -> np.ndarray:
        return (((points - self.center) / self.semi_axes) ** 2).sum(axis=1) <= 1.0

    def unit_frame(self) -> Frame:
        return Frame("ball", np.array(self.center), np.diag(1.0 / np.array(self.semi_axes)))

    def support(self, directions: np.ndarray) -> np.ndarray:
        reach = np.sqrt(((directions * self.semi_axes) ** 2).sum(axis=1))
        return directions @ self.center + reach

    def body(self) -> Revolution:
        return Revolution(half_disk(1.0), 360.0, np.diag(self.semi_axes), np.array(self.center))

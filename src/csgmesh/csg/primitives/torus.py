"""Tori."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitives.ellipse import quarter_arcs
from csgmesh.csg.solid import Profile, Revolution, Solid, across, frame_along
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Torus(Solid):
    """A ring: the points at most `minor_radius` from a circle of `major_radius` around an axis.

    Its boundary is a single part.

    Parameters
    ----------
    center : (3,) float
    axis : (3,) float
        Direction of the axis; its length does not matter.
    major_radius, minor_radius : float
        Positive, the minor one smaller than the major one.
    name : str, optional
        Default ``"torus"``.

    Raises
    ------
    ShapeError
        If the axis is zero, a radius is not positive, or the ring would touch its own axis.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Torus((0, 0, 0), (0, 0, 1), 2, 0.5).contains([(2, 0, 0.4), (0, 0, 0)])
    array([ True, False])
    """

    center: tuple[float, ...]
    axis: tuple[float, ...]
    major_radius: float
    minor_radius: float

    kind: ClassVar[str] = "torus"

    def __init__(
        self,
        center: ArrayLike,
        axis: ArrayLike,
        major_radius: float,
        minor_radius: float,
        *,
        name: str | None = None,
    ) -> None:
        where = self.place(name)
        large = checks.positive(major_radius, "major_radius", where)
        small = checks.positive(minor_radius, "minor_radius", where)
        if small >= large:
            raise ShapeError(
                f"{where}: minor_radius must be smaller than major_radius, or the ring touches "
                f"itself; got {small:g} and {large:g}"
            )
        self._settle(
            name,
            center=checks.vector(center, "center", where, 3),
            axis=checks.direction(axis, "axis", where, 3),
            major_radius=large,
            minor_radius=small,
        )

    def inside(self, points: np.ndarray) -> np.ndarray:
        axis = frame_along(np.array(self.axis))[:, 2]
        local = points - self.center
        along = local @ axis
        local -= along[:, None] * axis
        radial = np.sqrt((local**2).sum(axis=1)) - self.major_radius
        return radial * radial + along * along <= self.minor_radius * self.minor_radius

    def support(self, directions: np.ndarray) -> np.ndarray:
        flat = across(directions, frame_along(np.array(self.axis))[:, 2])
        lengths = np.sqrt((directions**2).sum(axis=1))
        return directions @ self.center + self.major_radius * flat + self.minor_radius * lengths

    def body(self) -> Revolution:
        centre = np.array([self.major_radius, 0.0])
        axes = np.diag([self.minor_radius, self.minor_radius])
        profile = Profile(quarter_arcs(centre, axes[0], axes[1]), np.zeros(4, np.int64))
        frame = frame_along(np.array(self.axis))
        return Revolution(profile, 360.0, frame, np.array(self.center))

"""Cones and frustums."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.solid import Profile, Revolution, Solid, across, frame_along
from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError
from csgmesh.tolerance import SMALLEST

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def tapered(height: float, base_radius: float, top_radius: float) -> Profile:
    """The profile of a cone from z = 0 to its height: side, base and top are parts 0, 1, 2."""
    corners = np.array([(0.0, 0.0), (base_radius, 0.0), (top_radius, height), (0.0, height)])
    part = np.array([1, 0, 2, -1])
    ends = np.roll(corners, -1, axis=0)
    real = (corners != ends).any(axis=1)
    return Profile(Curves.lines(corners[real], ends[real]), part[real])


def axis_of(
    base: ArrayLike, top: ArrayLike, where: str
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Both ends of an axis, checked to be apart."""
    start, end = checks.vector(base, "base", where, 3), checks.vector(top, "top", where, 3)
    if max(abs(a - b) for a, b in zip(start, end, strict=True)) < SMALLEST:
        raise ShapeError(f"{where}: base and top must be different points; got {start} twice")
    return start, end


def direction_of(base: tuple[float, ...], top: tuple[float, ...]) -> tuple[np.ndarray, float]:
    """Unit vector along an axis, and its length."""
    along = np.array(top) - base
    height = float(np.sqrt((along**2).sum()))
    return along / height, height


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Cone(Solid):
    """A cone or, with two radii, a frustum, around the axis from `base` to `top`.

    Parts of the boundary: ``side``, ``base``, ``top``.

    Parameters
    ----------
    base, top : (3,) float
        Ends of the axis.
    base_radius, top_radius : float
        Not negative, not both zero.
    name : str, optional
        Default ``"cone"``.

    Raises
    ------
    ShapeError
        If base and top are the same point, or a radius breaks its rule.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Cone((0, 0, 0), (0, 0, 2), 1).contains([(0.4, 0, 1), (0.6, 0, 1)])
    array([ True, False])
    """

    base: tuple[float, ...]
    top: tuple[float, ...]
    base_radius: float
    top_radius: float = 0.0

    kind: ClassVar[str] = "cone"
    convex: ClassVar[bool] = True

    def __init__(
        self,
        base: ArrayLike,
        top: ArrayLike,
        base_radius: float,
        top_radius: float = 0.0,
        *,
        name: str | None = None,
    ) -> None:
        where = self.place(name)
        start, end = axis_of(base, top, where)
        radii = (
            checks.number(base_radius, "base_radius", where),
            checks.number(top_radius, "top_radius", where),
        )
        if min(radii) < 0.0 or max(radii) < SMALLEST:
            raise ShapeError(
                f"{where}: radii must not be negative, and one must be positive; got {radii}"
            )
        self._settle(name, base=start, top=end, base_radius=radii[0], top_radius=radii[1])

    @property
    def parts(self) -> tuple[str, ...]:
        return ("side", "base", "top")

    def inside(self, points: np.ndarray) -> np.ndarray:
        axis, height = direction_of(self.base, self.top)
        local = points - self.base
        along = local @ axis
        radius = self.base_radius + (self.top_radius - self.base_radius) * (along / height)
        local -= along[:, None] * axis
        within = (along >= 0.0) & (along <= height)
        return within & ((local**2).sum(axis=1) <= radius * radius)

    def support(self, directions: np.ndarray) -> np.ndarray:
        flat = across(directions, direction_of(self.base, self.top)[0])
        return np.maximum(
            directions @ self.base + self.base_radius * flat,
            directions @ self.top + self.top_radius * flat,
        )

    def body(self) -> Revolution:
        axis, height = direction_of(self.base, self.top)
        profile = tapered(height, self.base_radius, self.top_radius)
        return Revolution(profile, 360.0, frame_along(axis), np.array(self.base))

"""Disks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitive import Frame, Planar
from csgmesh.csg.primitives.ellipse import quarter_arcs
from csgmesh.domain.curves import Curves

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Disk(Planar):
    """The points at most `radius` from `center`.

    Its boundary is a single part.

    Parameters
    ----------
    center : (2,) float
    radius : float
        Positive.
    name : str, optional
        Default ``"disk"``.

    Raises
    ------
    ShapeError
        If the radius is not positive and finite.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Disk((2, 1), 0.5).bounds()
    (array([1.5, 0.5]), array([2.5, 1.5]))
    """

    center: tuple[float, ...]
    radius: float

    kind: ClassVar[str] = "disk"
    convex: ClassVar[bool] = True
    simple: ClassVar[bool] = True

    def __init__(self, center: ArrayLike, radius: float, *, name: str | None = None) -> None:
        where = self.place(name)
        self._settle(
            name,
            center=checks.vector(center, "center", where, 2),
            radius=checks.positive(radius, "radius", where),
        )

    def curves(self) -> tuple[Curves, np.ndarray]:
        axes = np.diag([self.radius, self.radius])
        return quarter_arcs(np.array(self.center), axes[0], axes[1]), np.zeros(4, np.int64)

    def inside(self, points: np.ndarray) -> np.ndarray:
        x = points[:, 0] - self.center[0]
        y = points[:, 1] - self.center[1]
        x *= x
        y *= y
        x += y
        return x <= self.radius * self.radius

    def unit_frame(self) -> Frame:
        k = 1.0 / self.radius
        return Frame("ball", np.array(self.center), np.array(((k, 0.0), (0.0, k))))

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        middle = matrix @ self.center + offset
        reach = self.radius * np.hypot(matrix[:, 0], matrix[:, 1])
        return middle - reach, middle + reach

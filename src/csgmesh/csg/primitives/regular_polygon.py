"""Regular polygons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks, matrices
from csgmesh.csg.primitive import Planar
from csgmesh.csg.rings import closed_lines
from csgmesh.domain.curves import Curves

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class RegularPolygon(Planar):
    """A regular polygon with `n` corners on a circle, the first at its right-hand end.

    Its boundary is a single part.

    Parameters
    ----------
    center : (2,) float
    radius : float
        Of the circle through the corners; positive.
    n : int
        Number of corners, at least 3.
    name : str, optional
        Default ``"regular_polygon"``.

    Raises
    ------
    ShapeError
        If the radius is not positive and finite or `n` is below 3.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.RegularPolygon((0, 0), 1, 4).bounds()
    (array([-1., -1.]), array([1., 1.]))
    """

    center: tuple[float, ...]
    radius: float
    n: int

    kind: ClassVar[str] = "regular_polygon"
    convex: ClassVar[bool] = True
    simple: ClassVar[bool] = True

    def __init__(
        self, center: ArrayLike, radius: float, n: int, *, name: str | None = None
    ) -> None:
        where = self.place(name)
        self._settle(
            name,
            center=checks.vector(center, "center", where, 2),
            radius=checks.positive(radius, "radius", where),
            n=checks.whole(n, "n", where, 3),
        )

    def _corners(self) -> np.ndarray:
        turns = [matrices.cos_sin(360.0 * k / self.n) for k in range(self.n)]
        return np.array(self.center) + self.radius * np.array(turns)

    def curves(self) -> tuple[Curves, np.ndarray]:
        return closed_lines(self._corners()), np.zeros(self.n, np.int64)

    def inside(self, points: np.ndarray) -> np.ndarray:
        x, y = points[:, 0] - self.center[0], points[:, 1] - self.center[1]
        sector = 2.0 * np.pi / self.n
        # Angle from the middle of the side that faces the point.
        angle = np.remainder(np.arctan2(y, x), sector) - 0.5 * sector
        return np.hypot(x, y) * np.cos(angle) <= self.radius * np.cos(0.5 * sector)

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        corners = self._corners() @ matrix.T + offset
        return corners.min(axis=0), corners.max(axis=0)

"""Triangles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitive import Planar
from csgmesh.csg.rings import check_ring, closed_lines, ring_area
from csgmesh.domain.curves import Curves

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Triangle(Planar):
    """A triangle with corners `a`, `b`, `c`, in either orientation.

    Its boundary is a single part.

    Parameters
    ----------
    a, b, c : (2,) float
    name : str, optional
        Default ``"triangle"``.

    Raises
    ------
    ShapeError
        If the corners lie on a line.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Triangle((0, 0), (1, 0), (0, 1)).contains([(0.2, 0.2), (0.8, 0.8)])
    array([ True, False])
    """

    a: tuple[float, ...]
    b: tuple[float, ...]
    c: tuple[float, ...]

    kind: ClassVar[str] = "triangle"
    convex: ClassVar[bool] = True
    simple: ClassVar[bool] = True

    def __init__(
        self, a: ArrayLike, b: ArrayLike, c: ArrayLike, *, name: str | None = None
    ) -> None:
        where = self.place(name)
        corners = [checks.vector(p, n, where, 2) for p, n in ((a, "a"), (b, "b"), (c, "c"))]
        check_ring(np.array(corners), "the corners", where)
        self._settle(name, a=corners[0], b=corners[1], c=corners[2])

    def _counterclockwise(self) -> np.ndarray:
        corners = np.array([self.a, self.b, self.c])
        return corners if ring_area(corners) > 0 else corners[::-1].copy()

    def curves(self) -> tuple[Curves, np.ndarray]:
        return closed_lines(self._counterclockwise()), np.zeros(3, np.int64)

    def inside(self, points: np.ndarray) -> np.ndarray:
        result = np.ones(len(points), bool)
        corners = self._counterclockwise()
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            (x, y), (dx, dy) = start, end - start
            result &= dx * (points[:, 1] - y) >= dy * (points[:, 0] - x)
        return result

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        corners = np.array([self.a, self.b, self.c]) @ matrix.T + offset
        return corners.min(axis=0), corners.max(axis=0)

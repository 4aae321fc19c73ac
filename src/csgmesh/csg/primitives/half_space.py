"""Half-planes and half-spaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitive import Frame, Planar
from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class HalfSpace(Planar):
    """All points x with (x − point)·normal ≤ 0.

    Its boundary, a line or a plane, is a single part. Unbounded: a domain needs enough of them, or
    something bounded to cut.

    Parameters
    ----------
    point : (2,) or (3,) float
        On the boundary.
    normal : (2,) or (3,) float
        Points out of the half-space; its length does not matter.
    name : str, optional
        Default ``"half_space"``.

    Raises
    ------
    ShapeError
        If the normal is zero.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.HalfSpace((1, 0), (1, 0)).contains([(0, 5), (2, 5)])
    array([ True, False])
    """

    point: tuple[float, ...]
    normal: tuple[float, ...]

    kind: ClassVar[str] = "half_space"
    convex: ClassVar[bool] = True
    simple: ClassVar[bool] = True

    def __init__(self, point: ArrayLike, normal: ArrayLike, *, name: str | None = None) -> None:
        where = self.place(name)
        start = checks.vector(point, "point", where)
        self._settle(
            name, point=start, normal=checks.direction(normal, "normal", where, len(start))
        )

    @property
    def dim(self) -> int:  # type: ignore[override]
        """2 in the plane, 3 in space."""
        return len(self.point)

    def curves(self) -> tuple[Curves, np.ndarray]:
        """A half-space has no closed boundary: whoever needs one clips the line to a box.

        Raises
        ------
        ShapeError
            Always.
        """
        raise ShapeError(f"{self.place(self.name)}: an unbounded leaf has no closed boundary")

    def inside(self, points: np.ndarray) -> np.ndarray:
        height = np.zeros(len(points))
        for axis, (p, n) in enumerate(zip(self.point, self.normal, strict=True)):
            if n != 0.0:
                height += (points[:, axis] - p) * n
        return height <= 0.0

    def unit_frame(self) -> Frame:
        matrix = np.zeros((self.dim, self.dim))
        matrix[0] = self.normal
        return Frame("half_space", np.array(self.point), matrix)

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        normal = np.linalg.solve(matrix.T, self.normal)
        edge = matrix @ self.point + offset
        low, high = np.full(self.dim, -np.inf), np.full(self.dim, np.inf)
        (parallel,) = np.nonzero(normal)
        if len(parallel) == 1:
            bound = high if normal[parallel[0]] > 0 else low
            bound[parallel[0]] = edge[parallel[0]]
        return low, high

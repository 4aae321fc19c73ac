"""Tetrahedra."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.solid import Faceted, Solid
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

#: Opposite each corner its face, counterclockwise seen from outside a positive tetrahedron.
_FACES = np.array([(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)])


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Tetrahedron(Solid):
    """A tetrahedron with its corners in any order.

    Its boundary is a single part.

    Parameters
    ----------
    a, b, c, d : (3,) float
    name : str, optional
        Default ``"tetrahedron"``.

    Raises
    ------
    ShapeError
        If the corners lie in a plane.

    Examples
    --------
    >>> import csgmesh as cm
    >>> corner = cm.Tetrahedron((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    >>> corner.contains([(0.2, 0.2, 0.2), (0.5, 0.5, 0.5)])
    array([ True, False])
    """

    a: tuple[float, ...]
    b: tuple[float, ...]
    c: tuple[float, ...]
    d: tuple[float, ...]

    kind: ClassVar[str] = "tetrahedron"
    convex: ClassVar[bool] = True

    def __init__(
        self,
        a: ArrayLike,
        b: ArrayLike,
        c: ArrayLike,
        d: ArrayLike,
        *,
        name: str | None = None,
    ) -> None:
        where = self.place(name)
        given = (("a", a), ("b", b), ("c", c), ("d", d))
        corners = {key: checks.vector(value, key, where, 3) for key, value in given}
        edges = np.array([corners[k] for k in "bcd"]) - corners["a"]
        lengths = np.sqrt((edges**2).sum(axis=1))
        if abs(np.linalg.det(edges)) <= 1e-15 * float(lengths.max()) ** 3:
            raise ShapeError(
                f"{where}: the corners must not lie in one plane; got "
                f"{', '.join(str(corners[k]) for k in 'abcd')}"
            )
        self._settle(name, **corners)

    def _corners(self) -> np.ndarray:
        corners = np.array([self.a, self.b, self.c, self.d])
        if np.linalg.det(corners[1:] - corners[0]) < 0.0:
            corners[[2, 3]] = corners[[3, 2]]
        return corners

    def inside(self, points: np.ndarray) -> np.ndarray:
        corners = self._corners()
        result = np.ones(len(points), bool)
        for face in corners[_FACES]:
            normal = np.cross(face[1] - face[0], face[2] - face[0])
            result &= (points - face[0]) @ normal <= 0.0
        return result

    def support(self, directions: np.ndarray) -> np.ndarray:
        return (directions @ self._corners().T).max(axis=1)

    def body(self) -> Faceted:
        return Faceted(self._corners(), _FACES, np.arange(4), np.zeros(4, np.int64))

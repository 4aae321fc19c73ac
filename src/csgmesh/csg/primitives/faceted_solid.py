"""Solids given by a closed triangulated surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.flat_faces import flat_faces
from csgmesh.csg.polyhedra import oriented_outward
from csgmesh.csg.solid import Faceted, Solid
from csgmesh.domain.windings import winding_numbers
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

#: Triangles whose corners lie within this share of the solid's extent of one plane are one face:
#: files carry coordinates of seven digits.
FLAT_SHARE = 1e-6


@dataclass(frozen=True, eq=False, repr=False, init=False)
class FacetedSolid(Solid):
    """The body that a closed triangulated surface encloses, as `read_shape` makes it of a file.

    Neighbouring triangles of one part that lie in one plane, to a millionth of the solid's extent,
    are one face: edges within it are not kept by meshers.

    Parameters
    ----------
    points : (n, 3) float
        At least four.
    triangles : (m, 3) int
        Point numbers; all counterclockwise seen from outside, or all clockwise.
    part_names : sequence of str, optional
        Names of parts of the boundary; without, the boundary is a single part.
    part : (m,) int, optional
        The part of each triangle, into `part_names`; default 0.
    name : str, optional
        Default ``"faceted_solid"``.

    Raises
    ------
    ShapeError
        If the triangles do not close, enclose nothing, or a number is out of range.

    Examples
    --------
    >>> import csgmesh as cm
    >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    >>> sides = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    >>> wedge = cm.FacetedSolid(corners, sides, ("foot", "rest"), (0, 1, 1, 1), name="wedge")
    >>> cm.evaluate(wedge).names
    ('wedge.foot', 'wedge.rest')
    """

    points: np.ndarray
    triangles: np.ndarray
    part_names: tuple[str, ...] = ()
    part: np.ndarray | None = None

    kind: ClassVar[str] = "faceted_solid"

    def __init__(
        self,
        points: ArrayLike,
        triangles: ArrayLike,
        part_names: Sequence[str] = (),
        part: ArrayLike | None = None,
        *,
        name: str | None = None,
    ) -> None:
        where = self.place(name)
        corners = checks.point_array(points, "points", where, 3, least=4)
        rows = _numbers(triangles, "triangles", where, len(corners))
        if rows.ndim != 2 or rows.shape[1] != 3 or len(rows) < 4:
            raise ShapeError(
                f"{where}: triangles must be an (m, 3) array of at least four; got {rows.shape}"
            )
        names = tuple(checks.name(value, where) for value in part_names)
        of_part = None
        if part is not None:
            of_part = _numbers(part, "part", where, max(len(names), 1))
            if of_part.shape != (len(rows),):
                raise ShapeError(
                    f"{where}: part must have one number a triangle, {len(rows)}; "
                    f"got {of_part.shape}"
                )
        if not oriented_outward(corners, rows, where):
            rows = rows[:, ::-1].copy()
            rows.flags.writeable = False
        self._settle(name, points=corners, triangles=rows, part_names=names, part=of_part)

    @property
    def parts(self) -> tuple[str, ...]:
        return self.part_names or ("",)

    @cached_property
    def _faces(self) -> tuple[np.ndarray, np.ndarray]:
        """The flat face of each triangle, and the part of each face."""
        face = flat_faces(self.points, self.triangles, FLAT_SHARE)
        part = np.zeros(len(face), np.int64) if self.part is None else self.part
        both = face * (len(self.part_names) + 1) + part
        _, first, number = np.unique(both, return_index=True, return_inverse=True)
        return number.reshape(-1), part[first]

    def inside(self, points: np.ndarray) -> np.ndarray:
        return winding_numbers(points, self.points, self.triangles) != 0

    def support(self, directions: np.ndarray) -> np.ndarray:
        return (directions @ self.points.T).max(axis=1)

    def body(self) -> Faceted:
        return Faceted(self.points, self.triangles, *self._faces)


def _numbers(value: object, what: str, where: str, count: int) -> np.ndarray:
    """Whole numbers from 0 to below `count`, read-only."""
    try:
        given = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ShapeError(f"{where}: {what} must be whole numbers; got {value!r}") from None
    with np.errstate(invalid="ignore"):
        good = (given == np.floor(given)) & (given >= 0) & (given < count)
    if not good.all():
        raise ShapeError(
            f"{where}: {what} must be whole numbers from 0 to {count - 1}; "
            f"got {given[~good].flat[0]:g}"
        )
    out = np.ascontiguousarray(given, dtype=np.int64)
    out.flags.writeable = False
    return out

"""Polyhedra."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.polyhedra import face_triangles, oriented_outward
from csgmesh.csg.solid import Faceted, Solid
from csgmesh.domain.windings import winding_numbers
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Polyhedron(Solid):
    """The body that flat faces enclose.

    The whole boundary is a single part. All faces may run counterclockwise or all clockwise.

    Parameters
    ----------
    points : (n, 3) float
        At least four.
    faces : sequence of sequences of int
        Point numbers around each face, at least three; faces need not be convex.
    name : str, optional
        Default ``"polyhedron"``.

    Raises
    ------
    ShapeError
        If a face is not flat, the faces do not close, or they enclose nothing.

    Examples
    --------
    >>> import csgmesh as cm
    >>> corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)]
    >>> sides = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    >>> pyramid = cm.Polyhedron(corners, [(3, 2, 1, 0), *sides])
    >>> pyramid.contains([(0.5, 0.5, 0.5), (0.1, 0.1, 0.5)])
    array([ True, False])
    """

    points: np.ndarray
    faces: tuple[tuple[int, ...], ...]

    kind: ClassVar[str] = "polyhedron"

    def __init__(
        self, points: ArrayLike, faces: Sequence[Sequence[int]], *, name: str | None = None
    ) -> None:
        where = self.place(name)
        corners = checks.point_array(points, "points", where, 3, least=4)
        self._settle(name, points=corners, faces=_faces(faces, len(corners), where))
        _ = self._triangles

    @cached_property
    def _triangles(self) -> tuple[np.ndarray, np.ndarray]:
        """Triangles counterclockwise seen from outside, and their faces."""
        where = self.place(self.name)
        triangles, face = face_triangles(self.points, list(self.faces), where)
        if not oriented_outward(self.points, triangles, where):
            triangles = triangles[:, ::-1].copy()
        return triangles, face

    def inside(self, points: np.ndarray) -> np.ndarray:
        return winding_numbers(points, self.points, self._triangles[0]) != 0

    def support(self, directions: np.ndarray) -> np.ndarray:
        return (directions @ self.points.T).max(axis=1)

    def body(self) -> Faceted:
        triangles, face = self._triangles
        return Faceted(self.points, triangles, face, np.zeros(len(self.faces), np.int64))


def _faces(faces: object, n_points: int, where: str) -> tuple[tuple[int, ...], ...]:
    if isinstance(faces, np.ndarray):
        faces = faces.tolist()
    if isinstance(faces, str | bytes) or not hasattr(faces, "__iter__"):
        raise ShapeError(f"{where}: faces must be sequences of point numbers; got {faces!r}")
    out = []
    for k, face in enumerate(faces):
        if not hasattr(face, "__iter__"):
            raise ShapeError(f"{where}: face {k} must be a sequence of point numbers; got {face!r}")
        numbers = tuple(checks.whole(v, f"each number of face {k}", where, 0) for v in face)
        if len(numbers) < 3 or len(set(numbers)) < len(numbers):
            raise ShapeError(
                f"{where}: face {k} must have at least three different points; got {numbers}"
            )
        if max(numbers) >= n_points:
            raise ShapeError(
                f"{where}: face {k} names point {max(numbers)}; there are {n_points} points"
            )
        out.append(numbers)
    if len(out) < 4:
        raise ShapeError(f"{where}: a polyhedron has at least four faces; got {len(out)}")
    return tuple(out)

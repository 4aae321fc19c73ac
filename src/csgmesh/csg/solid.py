"""What a leaf in space must be able to do, and the exact bodies that evaluation works with."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field

import numpy as np

from csgmesh.csg.primitive import Primitive
from csgmesh.csg.shape import Shape
from csgmesh.domain.curves import Curves


@dataclass(frozen=True, eq=False)
class Profile:
    """Closed planar curves, interior on the left, with the parts of the solid that they sweep.

    Attributes
    ----------
    curves : Curves
        In (r, z) for a `Revolution`, in (x, y) for a `Prism`.
    part : (n,) int64
        Part of every curve's surface; -1 for a curve on the axis, which sweeps none.
    """

    curves: Curves
    part: np.ndarray


@dataclass(frozen=True, eq=False)
class Revolution:
    """A profile turned about the z axis, from the x axis counterclockwise, then placed.

    Attributes
    ----------
    profile : Profile or Shape
        A planar shape's own names are parts of the solid, below ``side``.
    angle : float
        Degrees, at most 360.
    matrix, offset : (3, 3), (3,) float64
        Where it is placed.
    """

    profile: Profile | Shape
    angle: float
    matrix: np.ndarray
    offset: np.ndarray


@dataclass(frozen=True, eq=False)
class Prism:
    """A planar shape extruded along z, from 0 to a height, then placed.

    Attributes
    ----------
    profile : Shape
    height : float
    matrix, offset : (3, 3), (3,) float64
        Where it is placed.
    is_one_part : bool
        Whether ends and sides are one part of the solid.
    """

    profile: Shape
    height: float
    matrix: np.ndarray = field(default_factory=lambda: np.eye(3))
    offset: np.ndarray = field(default_factory=lambda: np.zeros(3))
    is_one_part: bool = False


@dataclass(frozen=True, eq=False)
class Faceted:
    """A closed body of flat faces.

    Attributes
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int64
        Counterclockwise seen from outside.
    face : (m,) int64
        Triangles of one flat face have one number.
    part : (n_faces,) int64
    """

    points: np.ndarray
    triangles: np.ndarray
    face: np.ndarray
    part: np.ndarray


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Solid(Primitive):
    """A leaf in space."""

    dim = 3

    @abstractmethod
    def body(self) -> Revolution | Prism | Faceted:
        """The exact boundary, as evaluation needs it."""

    @abstractmethod
    def support(self, directions: np.ndarray) -> np.ndarray:
        """Largest value of direction · x over the solid, (k,), for directions (k, 3)."""

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return offset - self.support(-matrix), offset + self.support(matrix)


def frame_along(axis: np.ndarray) -> np.ndarray:
    """Orthonormal columns, right-handed, the last along the axis; the identity for the z axis.

    Examples
    --------
    >>> frame_along(np.array([0.0, 0.0, 2.0])).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    along = axis / np.abs(axis).max()
    along /= np.sqrt((along**2).sum())
    # The coordinate axis that is furthest from the direction, z last.
    first = np.zeros(3)
    first[int(np.argmin(np.abs(along)))] = 1.0
    across = first - (first @ along) * along
    across /= np.sqrt((across**2).sum())
    return np.column_stack([across, np.cross(along, across), along]) + 0.0


def across(directions: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Length of the directions' components perpendicular to a unit axis, (k,)."""
    flat = directions - (directions @ axis)[:, None] * axis
    return np.sqrt((flat**2).sum(axis=1))

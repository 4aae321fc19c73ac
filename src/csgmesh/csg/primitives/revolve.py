"""Revolutions of planar shapes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitives.extrude import planar, side_parts
from csgmesh.csg.shape import Shape
from csgmesh.csg.solid import Revolution, Solid
from csgmesh.errors import ShapeError
from csgmesh.tolerance import ON_CURVE_SHARE


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Revolve(Solid):
    """A planar shape turned about the z axis, counterclockwise from the x axis.

    The shape's x ≥ 0 becomes the radius, its y becomes z; what lies at x < 0 is left out. Parts of
    the boundary: ``side.<name>`` for each name of the planar shape's boundary and, unless the turn
    is a full one, ``start`` and ``end``.

    Parameters
    ----------
    shape : Shape
        In the plane.
    angle : float
        Degrees, positive, at most 360.
    name : str, optional
        Default ``"revolve"``.

    Raises
    ------
    ShapeError
        If the shape is not in the plane, or the angle is out of range.

    Examples
    --------
    >>> import csgmesh as cm
    >>> bowl = cm.Revolve(cm.Disk((0, 2), 2) - cm.Disk((0, 2), 1.8) - cm.HalfSpace((0, 2), (0, -1)))
    >>> bowl.contains([(0, 0, 0.1), (0, 0, 1), (1.9, 0, 1.9)])
    array([ True, False,  True])
    """

    shape: Shape
    angle: float = 360.0

    kind: ClassVar[str] = "revolve"

    def __init__(self, shape: Shape, angle: float = 360.0, *, name: str | None = None) -> None:
        where = self.place(name)
        turn = checks.positive(angle, "angle", where)
        if turn > 360.0:
            raise ShapeError(f"{where}: angle must be at most 360 degrees; got {turn:g}")
        self._settle(name, shape=planar(shape, where), angle=turn)

    @cached_property
    def parts(self) -> tuple[str, ...]:
        ends = ("start", "end") if self.angle < 360.0 else ()
        return (*ends, *side_parts(self.shape))

    def inside(self, points: np.ndarray) -> np.ndarray:
        radius = np.hypot(points[:, 0], points[:, 1])
        # The axis may be an edge of the profile, where membership is unspecified: ask beside it.
        beside = np.maximum(radius, ON_CURVE_SHARE * abs(self.shape.bounds()[1][0]))
        result = self.shape._program.contains(np.column_stack([beside, points[:, 2]]))
        if self.angle < 360.0:
            turn = np.degrees(np.arctan2(points[:, 1], points[:, 0])) % 360.0
            result &= (turn <= self.angle) | (radius == 0.0)
        return result

    def support(self, directions: np.ndarray) -> np.ndarray:
        (_, bottom), (reach, top) = self.shape.bounds()
        up = directions[:, 2]
        with np.errstate(invalid="ignore"):
            height = np.where(up == 0.0, 0.0, up * np.where(up > 0.0, top, bottom))
        flat = np.hypot(directions[:, 0], directions[:, 1])
        return height + np.where(flat == 0.0, 0.0, max(reach, 0.0) * flat)

    def body(self) -> Revolution:
        return Revolution(self.shape, self.angle, np.eye(3), np.zeros(3))

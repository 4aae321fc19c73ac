"""Extrusions of planar shapes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.shape import Shape
from csgmesh.csg.solid import Prism, Solid
from csgmesh.errors import ShapeError


def planar(shape: object, where: str) -> Shape:
    """A planar shape, checked."""
    if not isinstance(shape, Shape):
        raise ShapeError(f"{where}: shape must be a shape in the plane; got {shape!r}")
    if shape.dim != 2:
        raise ShapeError(f"{where}: shape must be in the plane; got a shape in space, {shape}")
    return shape


def side_parts(shape: Shape) -> tuple[str, ...]:
    """The names of a planar shape's boundary as parts of what it sweeps."""
    names = dict.fromkeys(name for leaf in shape._program.leaves for name in leaf.names)
    return tuple(f"side.{name}" for name in names)


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Extrude(Solid):
    """A planar shape extruded along +z from z = 0.

    Parts of the boundary: ``start`` at z = 0, ``end`` at the height, and ``side.<name>`` for each
    name of the planar shape's boundary.

    Parameters
    ----------
    shape : Shape
        In the plane.
    height : float
        Positive.
    name : str, optional
        Default ``"extrude"``.

    Raises
    ------
    ShapeError
        If the shape is not in the plane, or the height is not positive and finite.

    Examples
    --------
    >>> import csgmesh as cm
    >>> washer = cm.Extrude(cm.Disk((0, 0), 2, name="rim") - cm.Disk((0, 0), 1), 0.5)
    >>> washer.contains([(1.5, 0, 0.2), (0, 0, 0.2), (1.5, 0, 1)])
    array([ True, False, False])
    >>> washer.parts
    ('start', 'end', 'side.rim', 'side.disk')
    """

    shape: Shape
    height: float

    kind: ClassVar[str] = "extrude"

    def __init__(self, shape: Shape, height: float, *, name: str | None = None) -> None:
        where = self.place(name)
        self._settle(
            name, shape=planar(shape, where), height=checks.positive(height, "height", where)
        )

    @cached_property
    def parts(self) -> tuple[str, ...]:
        return ("start", "end", *side_parts(self.shape))

    def inside(self, points: np.ndarray) -> np.ndarray:
        within = (points[:, 2] >= 0.0) & (points[:, 2] <= self.height)
        within[within] = self.shape._program.contains(points[within, :2])
        return within

    def support(self, directions: np.ndarray) -> np.ndarray:
        low, high = self.shape.bounds()
        return _over_box(directions, (*low, 0.0), (*high, self.height))

    def body(self) -> Prism:
        return Prism(self.shape, self.height)


def _over_box(directions: np.ndarray, low: object, high: object) -> np.ndarray:
    """Largest value of direction · x over a box, which may be infinite."""
    far = np.where(directions > 0.0, np.array(high, float), np.array(low, float))
    with np.errstate(invalid="ignore"):  # zero times infinity
        return np.where(directions == 0.0, 0.0, directions * far).sum(axis=1)

"""Convex hulls of other shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitive import Planar
from csgmesh.csg.shape import Shape
from csgmesh.csg.solid import Faceted, Prism, Revolution, Solid
from csgmesh.csg.winding import WindingGrid
from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from csgmesh.boundary.hulls import SolidHull

#: Hulls within hulls, at the most: each level evaluates the one below.
_DEEPEST = 16


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Hull(Planar, Solid):
    """The convex hull of shapes, all of the plane or all of space.

    It is exact where it can be: in the plane for boundaries of lines and elliptic arcs, which it
    joins by their common tangents; in space for polyhedra, for prisms with one axis between the
    same two planes (a plate with round corners is the hull of four cylinders), and for balls,
    cylinders, cones and tori about one axis (the hull of two balls). Any other hull is that of
    points on the shapes' exact boundaries: a polyhedron nowhere further than `deviation` inside
    the true hull, which `contains`, meshes and checks alike take for the shape. The whole boundary
    is a single part.

    Parameters
    ----------
    shapes : sequence of Shape
        Bounded ones, at least one; those that are empty add nothing.
    deviation : float, optional
        Of hulls that are not exact; default 1e-3 of the extent of each shape.
    name : str, optional
        Default ``"hull"``.

    Raises
    ------
    ShapeError
        If there is no shape, or dimensions differ; on first use, if a shape is unbounded or all of
        them are empty.

    Examples
    --------
    >>> import csgmesh as cm
    >>> slot = cm.Hull([cm.Disk((0, 0), 1), cm.Disk((3, 0), 1)])
    >>> cm.evaluate(slot).areas()        # two half disks and a square: π + 6
    array([9.14159265])
    >>> capsule = cm.Hull([cm.Ball((0, 0, 0), 1), cm.Ball((0, 0, 3), 1)])
    >>> capsule.contains([(0.9, 0, 1.5), (0.9, 0, 3.9)])
    array([ True, False])
    """

    shapes: tuple[Shape, ...]
    deviation: float | None = None

    kind: ClassVar[str] = "hull"
    convex: ClassVar[bool] = True
    simple: ClassVar[bool] = True

    def __init__(
        self,
        shapes: Sequence[Shape],
        deviation: float | None = None,
        *,
        name: str | None = None,
    ) -> None:
        where = self.place(name)
        members = _members(shapes, where)
        if deviation is not None:
            deviation = checks.positive(deviation, "deviation", where)
        self._settle(name, shapes=members, deviation=deviation)
        if self._levels > _DEEPEST:
            raise ShapeError(f"{where}: hulls may stand in hulls at most {_DEEPEST} deep")

    @property
    def dim(self) -> int:  # type: ignore[override]
        """2 in the plane, 3 in space."""
        return self.shapes[0].dim

    @cached_property
    def _levels(self) -> int:
        from csgmesh.csg.traversal import postorder

        inner = (n for s in self.shapes for n in postorder(s) if isinstance(n, Hull))
        return 1 + max((hull._levels for hull in inner), default=0)

    @cached_property
    def _outline(self) -> Curves:
        from csgmesh.boundary.hulls import plane_hull

        return plane_hull(self.shapes, self.deviation, self.place(self.name))

    @cached_property
    def _grid(self) -> WindingGrid:
        return WindingGrid.of(self._outline)

    @cached_property
    def _body(self) -> SolidHull:
        from csgmesh.boundary.hulls import solid_hull

        return solid_hull(self.shapes, self.deviation, self.place(self.name))

    def curves(self) -> tuple[Curves, np.ndarray]:
        return self._outline, np.zeros(len(self._outline), np.int64)

    def inside(self, points: np.ndarray) -> np.ndarray:
        return self._grid.winding(points) != 0 if self.dim == 2 else self._body.inside(points)

    def support(self, directions: np.ndarray) -> np.ndarray:
        return self._body.support(directions)

    def body(self) -> Revolution | Prism | Faceted:
        return self._body.body

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if self.dim == 3:
            return Solid.extent(self, matrix, offset)
        low, high = self._outline.transformed(matrix, offset).bounds()
        return low.min(axis=0), high.max(axis=0)


def _members(shapes: object, where: str) -> tuple[Shape, ...]:
    checks.sequence(shapes, "shapes", where, "a sequence of shapes")
    members: tuple[Any, ...] = tuple(shapes)  # type: ignore[arg-type]
    if not members:
        raise ShapeError(f"{where}: shapes must hold at least one shape; got none")
    for k, shape in enumerate(members):
        if not isinstance(shape, Shape):
            raise ShapeError(f"{where}: shapes must be shapes; number {k} is {shape!r}")
        if shape.dim != members[0].dim:
            raise ShapeError(
                f"{where}: shapes must all have the same dimension; number {k} has {shape.dim}, "
                f"the first has {members[0].dim}"
            )
    return members

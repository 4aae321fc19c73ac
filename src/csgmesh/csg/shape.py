"""The face of the expression tree: operators, maps, names, questions and values of any shape."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from csgmesh.csg import checks, matrices
from csgmesh.csg.matrices import Matrix, Vector
from csgmesh.errors import ShapeError
from csgmesh.tolerance import SMALLEST

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from csgmesh.csg.program import Program

Operation = Literal["union", "intersection", "difference", "symmetric_difference"]


class Shape(ABC):
    """A region of the plane or of space, given by an expression.

    Combine shapes with ``|`` (union), ``&`` (intersection), ``-`` (difference), ``^`` (symmetric
    difference) and ``~`` (complement). Booleans are regularised: a result is the closure of its
    interior. Lengths are unitless, angles are in degrees.

    Attributes
    ----------
    dim : int
        2 in the plane, 3 in space.
    n_leaves, n_nodes : int
        Leaves, and leaves and operations, every use of a shared part counted.
    depth : int
        Levels of the tree: 1 for a primitive.

    Examples
    --------
    >>> import csgmesh as cm
    >>> plate = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
    >>> plate.contains([(1, 1), (2, 1)])
    array([ True, False])
    >>> plate
    Box((0, 0), (4, 2), name='plate') - Disk((2, 1), 0.5, name='hole')
    """

    dim: int
    n_leaves: int
    n_nodes: int
    depth: int

    @property
    @abstractmethod
    def children(self) -> Sequence[Shape]:
        """The shapes this one is made of."""

    @property
    @abstractmethod
    def content(self) -> tuple[Any, ...]:
        """What this node holds besides its children, hashable."""

    @abstractmethod
    def rebuilt(self, children: Sequence[Shape]) -> Shape:
        """This node with other children."""

    # -- booleans ---------------------------------------------------------------------------------

    def __or__(self, other: Shape) -> Shape:
        return self._joined("union", other)

    def __and__(self, other: Shape) -> Shape:
        return self._joined("intersection", other)

    def __sub__(self, other: Shape) -> Shape:
        return self._joined("difference", other)

    def __xor__(self, other: Shape) -> Shape:
        return self._joined("symmetric_difference", other)

    def __invert__(self) -> Shape:
        from csgmesh.csg.nodes import Complement

        return Complement(self)

    def _joined(self, operation: Operation, other: object) -> Shape:
        from csgmesh.csg.nodes import joined

        return joined(operation, self, other) if isinstance(other, Shape) else NotImplemented

    # -- maps and names ---------------------------------------------------------------------------

    def translate(self, v: ArrayLike) -> Shape:
        """Move by the vector `v`.

        Examples
        --------
        >>> import csgmesh as cm
        >>> cm.Disk((0, 0), 1).translate((2, 1)).bounds()
        (array([1., 0.]), array([3., 2.]))
        """
        offset = checks.vector(v, "the vector", "translate", self.dim)
        return self._placed(matrices.identity(self.dim), offset)

    def rotate(
        self, degrees: float, center: ArrayLike | None = None, axis: ArrayLike | None = None
    ) -> Shape:
        """Turn by an angle in degrees, counterclockwise, about `center` (default: the origin).

        Multiples of 90 degrees are exact. In space `axis` is the direction turned about
        (default: z).

        Examples
        --------
        >>> import csgmesh as cm
        >>> cm.Box((0, 0), (2, 1)).rotate(90).bounds()
        (array([-1.,  0.]), array([0., 2.]))
        """
        angle = checks.number(degrees, "the angle", "rotate")
        if self.dim == 2:
            if axis is not None:
                raise ShapeError(f"rotate: an axis belongs to space, not the plane; got {axis!r}")
            matrix = matrices.rotation(angle)
        else:
            about = (0.0, 0.0, 1.0) if axis is None else axis
            matrix = matrices.rotation(angle, checks.direction(about, "the axis", "rotate", 3))
        return self._about(matrix, center, "rotate")

    def scale(self, s: float | ArrayLike, center: ArrayLike | None = None) -> Shape:
        """Scale by the factor `s`, or by one factor an axis, about `center` (default: the origin).

        Examples
        --------
        >>> import csgmesh as cm
        >>> cm.Disk((1, 1), 1).scale((2, 1), center=(1, 1)).bounds()
        (array([-1.,  0.]), array([3., 2.]))
        """
        if np.ndim(s) == 0:
            factors: Vector = (checks.number(s, "the factor", "scale"),) * self.dim
        else:
            factors = checks.vector(s, "the factors", "scale", self.dim)
        if any(abs(f) < SMALLEST for f in factors):
            raise ShapeError(f"scale: no factor may be zero; got {s!r}")
        return self._about(matrices.diagonal(factors), center, "scale")

    def mirror(self, point: ArrayLike, normal: ArrayLike) -> Shape:
        """Reflect in the line (in space: the plane) through `point` with this `normal`.

        Examples
        --------
        >>> import csgmesh as cm
        >>> cm.Box((1, 0), (3, 1)).mirror((0, 0), (1, 0)).bounds()
        (array([-3.,  0.]), array([-1.,  1.]))
        """
        direction = checks.direction(normal, "the normal", "mirror", self.dim)
        return self._about(matrices.reflection(direction), point, "mirror")

    def transform(self, matrix: ArrayLike, offset: ArrayLike | None = None) -> Shape:
        """Map every point x to ``matrix @ x + offset``; `matrix` must be invertible.

        Examples
        --------
        >>> import csgmesh as cm
        >>> cm.Box((0, 0), (1, 1)).transform([(1, 0.5), (0, 1)]).bounds()
        (array([0., 0.]), array([1.5, 1. ]))
        """
        array = checks.point_array(matrix, "the matrix", "transform", self.dim, least=self.dim)
        if len(array) != self.dim:
            raise ShapeError(
                f"transform: the matrix must be {self.dim} by {self.dim}; got {array.shape}"
            )
        rows = tuple(tuple(row) for row in array.tolist())
        size = float(np.abs(array).max())
        if abs(matrices.determinant(rows)) <= 1e-14 * size**self.dim:
            raise ShapeError(f"transform: the matrix must be invertible; got {rows!r}")
        shift = (0.0,) * self.dim if offset is None else offset
        return self._placed(rows, checks.vector(shift, "the offset", "transform", self.dim))

    def _about(self, matrix: Matrix, center: ArrayLike | None, where: str) -> Shape:
        if center is None:
            return self._placed(matrix, (0.0,) * self.dim)
        fixed = checks.vector(center, "the center", where, self.dim)
        return self._placed(matrix, matrices.about(matrix, fixed))

    def named(self, name: str) -> Shape:
        """Give a name: an unnamed leaf takes it, anything else has its names prefixed by it.

        Examples
        --------
        >>> import csgmesh as cm
        >>> cm.Disk((0, 0), 1).named("hole")
        Disk((0, 0), 1, name='hole')
        >>> cm.Disk((0, 0), 1, name="hole").named("plate")
        Disk((0, 0), 1, name='plate.hole')
        """
        return self._named(checks.name(name, "named"))

    def _named(self, name: str) -> Shape:
        from csgmesh.csg.nodes import Named

        return Named(self, name)

    def _placed(self, matrix: Matrix, offset: Vector) -> Shape:
        from csgmesh.csg.nodes import placed

        return placed(self, matrix, offset)

    # -- questions --------------------------------------------------------------------------------

    @cached_property
    def _program(self) -> Program:
        from csgmesh.csg.program import compile_shape

        return compile_shape(self)

    def contains(self, points: ArrayLike) -> np.ndarray:
        """Which of the points, ``(n, dim)``, lie in the shape: ``(n,)`` bool.

        Unspecified within rounding of a boundary.

        Examples
        --------
        >>> import csgmesh as cm
        >>> (cm.Disk((0, 0), 2) ^ cm.Disk((0, 0), 1)).contains([(0, 0), (1.5, 0), (3, 0)])
        array([False,  True, False])
        """
        return self._program.contains(checks.query_points(points, self.dim))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of a box around the shape.

        ±inf where it is unbounded, lowest above highest where it is known to be empty. The box is
        the smallest one for primitives, unions, and intersections of boxes and half-spaces; for
        other trees it may be larger.

        Examples
        --------
        >>> import csgmesh as cm
        >>> (cm.HalfSpace((0, 0), (-1, 0)) & cm.HalfSpace((0, 0), (1, 1))).bounds()
        (array([  0., -inf]), array([inf,  0.]))
        """
        return self._program.bounds()

    # -- values -----------------------------------------------------------------------------------

    @cached_property
    def _hash(self) -> int:
        from csgmesh.csg.traversal import structural_hash

        return structural_hash(self)

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        from csgmesh.csg.traversal import structurally_equal

        return structurally_equal(self, other) if isinstance(other, Shape) else NotImplemented

    def __repr__(self) -> str:
        from csgmesh.csg.text import expression

        return expression(self)

    def __str__(self) -> str:
        from csgmesh.csg.text import summary

        return summary(self)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        from csgmesh.csg.text import flattened, from_flat

        return from_flat, (flattened(self),)

    def __copy__(self) -> Shape:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Shape:
        return self

    def to_dict(self) -> dict[str, Any]:
        """The tree as lists, numbers and strings, ready for JSON; `from_dict` reads it back.

        The nodes stand in one list, children before their parents, so that the depth of the tree is
        not the depth of the document.

        Examples
        --------
        >>> import csgmesh as cm
        >>> (~cm.Disk((0, 0), 1)).to_dict()
        {'nodes': [{'disk': {'center': [0.0, 0.0], 'radius': 1.0}}, {'complement': 0}]}
        """
        from csgmesh.csg.text import to_dict

        return to_dict(self)

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Shape:
        """The shape that `to_dict` wrote.

        Examples
        --------
        >>> import csgmesh as cm
        >>> disk = cm.Disk((0, 0), 1)
        >>> cm.Shape.from_dict(disk.to_dict()) == disk
        True
        """
        from csgmesh.csg.text import from_dict

        return from_dict(data)

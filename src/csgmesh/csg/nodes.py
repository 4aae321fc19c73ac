"""The node kinds of the expression tree: primitive, boolean, complement, affine map, name.

A shape is a value: immutable, hashable, comparable, picklable and printable. Building one computes
nothing but its size. Nodes keep a canonical order, which makes equal expressions equal values: an
affine map stands outside a complement, a complement outside a name, and affine maps in a row, names
in a row and double complements merge. Trees may be ten thousand levels deep, so whatever walks one
does so without recursion (`csgmesh.csg.traversal`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from csgmesh.csg import checks, matrices
from csgmesh.csg.matrices import Matrix, Vector
from csgmesh.csg.operands import Run
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from csgmesh.csg.program import Program
    from csgmesh.domain.curves import Curves

Operation = Literal["union", "intersection", "difference", "symmetric_difference"]

#: Largest tree, in leaves and operations, every use of a shared part counted. ``s = s | s`` doubles
#: a tree, so forty lines could ask for more memory than there is; two million leaves are some
#: gigabytes when evaluated.
LARGEST_TREE = 2_000_000

SYMBOLS: dict[Operation, str] = {
    "union": "|",
    "intersection": "&",
    "difference": "-",
    "symmetric_difference": "^",
}


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
    height : int
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
    height: int

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
        return _joined("union", self, other) if isinstance(other, Shape) else NotImplemented

    def __and__(self, other: Shape) -> Shape:
        return _joined("intersection", self, other) if isinstance(other, Shape) else NotImplemented

    def __sub__(self, other: Shape) -> Shape:
        return _joined("difference", self, other) if isinstance(other, Shape) else NotImplemented

    def __xor__(self, other: Shape) -> Shape:
        if not isinstance(other, Shape):
            return NotImplemented
        return _joined("symmetric_difference", self, other)

    def __invert__(self) -> Shape:
        return Complement(self)

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
        return _placed(self, matrices.identity(self.dim), offset)

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
                raise ShapeError(f"rotate: an axis belongs to space, this shape is plane; got {axis!r}")
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
        if np.ndim(s) == 0:  # type: ignore[arg-type]
            factors: Vector = (checks.number(s, "the factor", "scale"),) * self.dim
        else:
            factors = checks.vector(s, "the factors", "scale", self.dim)
        if any(abs(f) < checks.SMALLEST for f in factors):
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
        return _placed(self, rows, checks.vector(shift, "the offset", "transform", self.dim))

    def _about(self, matrix: Matrix, center: ArrayLike | None, where: str) -> Shape:
        if center is None:
            return _placed(self, matrix, (0.0,) * self.dim)
        fixed = checks.vector(center, "the center", where, self.dim)
        return _placed(self, matrix, matrices.about(matrix, fixed))

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
        return Named(self, name)

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


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Primitive(Shape):
    """A leaf of the tree.

    A new primitive is a frozen dataclass of its canonical arguments, which `_settle` stores, with a
    `kind`, the parts of its boundary, its exact boundary curves and its membership, in a file of
    its own under ``csg/primitives`` and a line in that package's list.
    """

    name: str | None = field(default=None, kw_only=True)

    dim = 2
    n_leaves = n_nodes = height = 1

    #: What an unnamed leaf is called; also the key in dictionaries and domain files.
    kind: ClassVar[str]
    #: Whether the shape is convex: a box with its corners inside lies inside.
    convex: ClassVar[bool] = False
    #: Whether the boundary must not cross itself.
    simple: ClassVar[bool] = False
    #: Classes by kind.
    kinds: ClassVar[dict[str, type[Primitive]]] = {}

    def __init_subclass__(cls) -> None:
        Primitive.kinds[cls.kind] = cls

    def _settle(self, name: str | None, **values: Any) -> None:
        for key, value in values.items():
            object.__setattr__(self, key, value)
        if name is not None:
            checks.name(name, type(self).__name__)
        object.__setattr__(self, "name", name)

    @classmethod
    def place(cls, name: object) -> str:
        """The leaf for messages: its class, and its name if it has one."""
        return f"{cls.__name__} {name!r}" if isinstance(name, str) else cls.__name__

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the parts of the boundary; ``""`` for a single one."""
        return ("",)

    @property
    def fill(self) -> str:
        """How winding numbers become membership: ``"nonzero"`` or ``"evenodd"``."""
        return "nonzero"

    @abstractmethod
    def curves(self) -> tuple[Curves, np.ndarray]:
        """The closed boundary, interior on the left, and the part of every curve."""

    @abstractmethod
    def inside(self, points: np.ndarray) -> np.ndarray:
        """Which of the ``(n, dim)`` points lie inside."""

    @abstractmethod
    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The box around the image under the map ``matrix @ x + offset``."""

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of the box around the shape."""
        return self.extent(np.eye(self.dim), np.zeros(self.dim))

    def arguments(self) -> dict[str, Any]:
        """The constructor's arguments that differ from their defaults, in order, the name last."""
        given = {f.name: (getattr(self, f.name), f.default) for f in fields(self)}
        given["name"] = given.pop("name")
        return {
            key: value
            for key, (value, default) in given.items()
            if isinstance(value, np.ndarray) or value != default
        }

    @property
    def children(self) -> Sequence[Shape]:
        return ()

    @property
    def content(self) -> tuple[Any, ...]:
        return (self.kind, *[_hashable(getattr(self, f.name)) for f in fields(self)])

    def rebuilt(self, children: Sequence[Shape]) -> Shape:
        return self

    def _named(self, name: str) -> Shape:
        copy = object.__new__(type(self))
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        copy._settle(**(values | {"name": name if self.name is None else f"{name}.{self.name}"}))
        return copy


@dataclass(frozen=True, eq=False, repr=False)
class Boolean(Shape):
    """An n-ary boolean; a difference is its first operand less all others, a symmetric difference
    the points in an odd number of operands."""

    operation: Operation
    run: Run[Shape]
    dim: int
    n_leaves: int
    n_nodes: int
    height: int

    @property
    def children(self) -> Sequence[Shape]:
        return self.run.items()

    @property
    def content(self) -> tuple[Any, ...]:
        return (self.operation,)

    def rebuilt(self, children: Sequence[Shape]) -> Shape:
        return combined(self.operation, children)


@dataclass(frozen=True, eq=False, repr=False, init=False)
class _Unary(Shape):
    shape: Shape

    def _wrap(self, shape: Shape) -> None:
        object.__setattr__(self, "shape", shape)
        object.__setattr__(self, "dim", shape.dim)
        object.__setattr__(self, "n_leaves", shape.n_leaves)
        object.__setattr__(self, "n_nodes", shape.n_nodes + 1)
        object.__setattr__(self, "height", shape.height + 1)
        _check_size(self.n_nodes, type(self).__name__.lower())

    @property
    def children(self) -> Sequence[Shape]:
        return (self.shape,)


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Complement(_Unary):
    """All points that are not in a shape."""

    def __init__(self, shape: Shape) -> None:
        self._wrap(shape)

    @property
    def content(self) -> tuple[Any, ...]:
        return ("complement",)

    def rebuilt(self, children: Sequence[Shape]) -> Shape:
        return ~children[0]

    def __invert__(self) -> Shape:
        return self.shape

    def _named(self, name: str) -> Shape:
        return Complement(self.shape._named(name))


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Affine(_Unary):
    """The image of a shape under x ↦ matrix·x + offset."""

    matrix: Matrix
    offset: Vector

    def __init__(self, shape: Shape, matrix: Matrix, offset: Vector) -> None:
        self._wrap(shape)
        object.__setattr__(self, "matrix", matrix)
        object.__setattr__(self, "offset", offset)

    @property
    def content(self) -> tuple[Any, ...]:
        return ("transform", self.matrix, self.offset)

    def rebuilt(self, children: Sequence[Shape]) -> Shape:
        return _placed(children[0], self.matrix, self.offset)

    def __invert__(self) -> Shape:
        return _placed(~self.shape, self.matrix, self.offset)

    def _named(self, name: str) -> Shape:
        return _placed(self.shape._named(name), self.matrix, self.offset)


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Named(_Unary):
    """A compound whose names are prefixed."""

    name: str

    def __init__(self, shape: Shape, name: str) -> None:
        self._wrap(shape)
        object.__setattr__(self, "name", name)

    @property
    def content(self) -> tuple[Any, ...]:
        return ("named", self.name)

    def rebuilt(self, children: Sequence[Shape]) -> Shape:
        return children[0].named(self.name)

    def _named(self, name: str) -> Shape:
        return Named(self.shape, f"{name}.{self.name}")


def union(*shapes: Shape | Iterable[Shape]) -> Shape:
    """The points in at least one of the shapes, given one by one or as one iterable.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.union(cm.Disk((x, 0), 1) for x in range(3)).bounds()
    (array([-1., -1.]), array([3., 1.]))
    """
    return combined("union", _listed(shapes))


def intersection(*shapes: Shape | Iterable[Shape]) -> Shape:
    """The points in all of the shapes, given one by one or as one iterable.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.intersection(cm.Box((0, 0), (2, 2)), cm.Box((1, 0), (3, 1))).bounds()
    (array([1., 0.]), array([2., 1.]))
    """
    return combined("intersection", _listed(shapes))


def difference(a: Shape, *others: Shape) -> Shape:
    """The points of `a` in none of the others.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.difference(cm.Box((0, 0), (2, 2)), cm.Disk((0, 0), 1)).contains([(0.5, 0.5), (1, 1)])
    array([False,  True])
    """
    return combined("difference", [a, *_listed(others)])


def symmetric_difference(*shapes: Shape | Iterable[Shape]) -> Shape:
    """The points in an odd number of the shapes, given one by one or as one iterable.

    Examples
    --------
    >>> import csgmesh as cm
    >>> rings = cm.symmetric_difference(cm.Disk((0, 0), r) for r in (1, 2, 3))
    >>> rings.contains([(0.5, 0), (1.5, 0), (2.5, 0)])
    array([ True, False,  True])
    """
    return combined("symmetric_difference", _listed(shapes))


def combined(operation: Operation, shapes: Sequence[Shape]) -> Shape:
    """The boolean of all the shapes, flattened; a single shape is itself."""
    if not shapes:
        raise ShapeError(f"{operation}: at least one shape is needed; got none")
    flat: list[Shape] = []
    for position, shape in enumerate(shapes):
        if not isinstance(shape, Shape):
            raise ShapeError(f"{operation}: operand {position} must be a shape; got {shape!r}")
        if shape.dim != shapes[0].dim:
            raise ShapeError(
                f"{operation}: all shapes must have the same dimension; operand {position} has "
                f"{shape.dim}, the first has {shapes[0].dim}"
            )
        opens = position == 0 or operation != "difference"
        if isinstance(shape, Boolean) and shape.operation == operation and opens:
            _check_size(len(flat) + len(shape.run), operation)
            flat.extend(shape.run)
        else:
            flat.append(shape)
    if len(flat) == 1:
        return flat[0]
    n_nodes = 1 + sum(s.n_nodes for s in flat)
    _check_size(n_nodes, operation)
    return Boolean(
        operation,
        Run.of(flat),
        flat[0].dim,
        sum(s.n_leaves for s in flat),
        n_nodes,
        1 + max(s.height for s in flat),
    )


def _joined(operation: Operation, a: Shape, b: Shape) -> Shape:
    """``a op b``, growing the larger operand that is already such a boolean."""
    left = a.run if isinstance(a, Boolean) and a.operation == operation else None
    right = b.run if isinstance(b, Boolean) and b.operation == operation else None
    if operation == "difference":
        right = None
    if a.dim != b.dim or (left is None and right is None):
        return combined(operation, (a, b))
    n_nodes = a.n_nodes + b.n_nodes + 1 - (left is not None) - (right is not None)
    _check_size(n_nodes, operation)
    run: Run[Shape]
    if left is not None and (right is None or len(left) >= len(right)):
        run = left.extended((b,) if right is None else right.items())
    else:
        assert right is not None
        run = right.preceded((a,) if left is None else left.items())
    return Boolean(
        operation,
        run,
        a.dim,
        a.n_leaves + b.n_leaves,
        n_nodes,
        max(a.height + (left is None), b.height + (right is None)),
    )


def _placed(shape: Shape, matrix: Matrix, offset: Vector) -> Shape:
    """The image of a shape; maps in a row merge, and the identity leaves the shape as it is."""
    if isinstance(shape, Affine):
        inner = matrices.apply(matrix, shape.offset)
        offset = tuple(a + b + 0.0 for a, b in zip(inner, offset, strict=True))
        matrix = matrices.multiply(matrix, shape.matrix)
        shape = shape.shape
    if not any(offset) and matrix == matrices.identity(shape.dim):
        return shape
    return Affine(shape, matrix, offset)


def _check_size(n_nodes: int, operation: str) -> None:
    if n_nodes > LARGEST_TREE:
        raise ShapeError(
            f"{operation}: a tree may hold at most {LARGEST_TREE:,} leaves and operations, every "
            f"use of a shared part counted; this one would hold {n_nodes:,}"
        )


def _listed(shapes: Sequence[Any]) -> list[Any]:
    """The shapes themselves, or those of the one iterable among the arguments."""
    if len(shapes) == 1 and not isinstance(shapes[0], Shape):
        if not isinstance(shapes[0], Iterable):
            raise ShapeError(f"a boolean needs shapes or an iterable of shapes; got {shapes[0]!r}")
        return list(shapes[0])
    return list(shapes)


def _hashable(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    if isinstance(value, tuple):
        return tuple([_hashable(v) for v in value])
    return value

"""The node kinds of the expression tree: primitive, boolean, complement, affine map, name.

A shape is a value: immutable, hashable, comparable, picklable and printable. Building one computes
nothing but its size. Nodes keep a canonical order, which makes equal expressions equal values: an
affine map stands outside a complement, a complement outside a name, and affine maps in a row, names
in a row and double complements merge. Trees may be ten thousand levels deep, so whatever walks one
does so without recursion (`csgmesh.csg.traversal`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from csgmesh.csg import matrices
from csgmesh.csg.matrices import Matrix, Vector
from csgmesh.csg.operands import Run
from csgmesh.csg.primitive import Primitive
from csgmesh.csg.shape import Operation, Shape
from csgmesh.errors import ShapeError

__all__ = [
    "LARGEST_TREE",
    "SYMBOLS",
    "Affine",
    "Boolean",
    "Complement",
    "Named",
    "Operation",
    "Primitive",
    "Shape",
    "combined",
    "joined",
    "placed",
]

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


@dataclass(frozen=True, eq=False, repr=False)
class Boolean(Shape):
    """An n-ary boolean; a difference is its first operand less all others, a symmetric difference
    the points in an odd number of operands."""

    operation: Operation
    run: Run[Shape]
    dim: int
    n_leaves: int
    n_nodes: int
    depth: int

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
        object.__setattr__(self, "depth", shape.depth + 1)
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
        return placed(children[0], self.matrix, self.offset)

    def __invert__(self) -> Shape:
        return placed(~self.shape, self.matrix, self.offset)

    def _named(self, name: str) -> Shape:
        return placed(self.shape._named(name), self.matrix, self.offset)


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
        1 + max(s.depth for s in flat),
    )


def joined(operation: Operation, a: Shape, b: Shape) -> Shape:
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
        max(a.depth + (left is None), b.depth + (right is None)),
    )


def placed(shape: Shape, matrix: Matrix, offset: Vector) -> Shape:
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

"""Compiling a tree: leaves placed and named, and each region as a postfix program over them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from csgmesh.csg import matrices
from csgmesh.csg.embed import Embed, EmbeddedPath
from csgmesh.csg.extent import code_bounds
from csgmesh.csg.membership import Classifier
from csgmesh.csg.naming import Namer, part_names
from csgmesh.csg.nodes import Affine, Boolean, Complement, Named, Primitive, Shape
from csgmesh.csg.periodic import Periodic
from csgmesh.csg.primitive import Frame, Planar
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.regions import Regions
from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError
from csgmesh.tolerance import LARGEST, SMALLEST

#: Postfix: ``("leaf", i)``, then operations with how many values they take.
Code = tuple[tuple[str, int], ...]


_IDENTITY = {dim: np.eye(dim).tolist() for dim in (2, 3)}


@dataclass(frozen=True, eq=False)
class Leaf:
    """A primitive placed and named.

    Attributes
    ----------
    primitive : Primitive
    matrix, offset : (dim, dim), (dim,) float64
        The placement: ``matrix @ x + offset``.
    names : tuple of str
        One full name per part.
    label : str
        For messages, such as ``disk 'hole'``.
    """

    primitive: Primitive
    matrix: np.ndarray
    offset: np.ndarray
    names: tuple[str, ...]
    label: str

    @cached_property
    def _inverse(self) -> np.ndarray | None:
        """The inverse matrix, or None for the identity."""
        if self.matrix.tolist() == _IDENTITY[len(self.matrix)]:
            return None
        if len(self.matrix) == 2:
            (a, b), (c, d) = self.matrix
            return np.array(((d, -b), (-c, a))) / (a * d - b * c) + 0.0
        return np.linalg.inv(self.matrix)

    def inside(self, points: np.ndarray) -> np.ndarray:
        """Which of the ``(n, dim)`` points lie in the placed leaf."""
        inverse = self._inverse
        if inverse is not None:
            points = (points - self.offset) @ inverse.T
        elif self.offset.any():
            points = points - self.offset
        return self.primitive.inside(points)

    def curves(self) -> tuple[Curves, np.ndarray]:
        """The placed closed boundary, interior on the left, and the part of every curve."""
        primitive = self.primitive
        if not isinstance(primitive, Planar):
            raise TypeError(f"{self.label} lies in space")
        table, part = primitive.curves()
        if self._inverse is None and not self.offset.any():
            return table, part
        table = table.transformed(self.matrix, self.offset)
        if np.linalg.det(self.matrix) < 0.0:
            backwards = np.arange(len(table))[::-1]
            return table.reversed()[backwards], part[backwards]
        return table, part

    def half_space(self) -> tuple[np.ndarray, np.ndarray]:
        """Point and outward normal of a placed half-space."""
        primitive = self.primitive
        if not isinstance(primitive, HalfSpace):
            raise TypeError(f"{self.label} is no half-space")
        normal = np.array(primitive.normal)
        if self._inverse is not None:
            normal = self._inverse.T @ normal
        return self.matrix @ primitive.point + self.offset, normal

    @cached_property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of the placed leaf, ±inf where unbounded."""
        return self.primitive.extent(self.matrix, self.offset)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of the placed leaf, ±inf where unbounded."""
        return self.box

    def unit_frame(self) -> Frame | None:
        """The map that takes the placed leaf to a unit body, or None."""
        frame = self.primitive.unit_frame()
        if frame is None:
            return None
        matrix = frame.matrix if self._inverse is None else frame.matrix @ self._inverse
        return Frame(frame.body, self.matrix @ frame.center + self.offset, matrix)

    def covers(self, low: np.ndarray, high: np.ndarray) -> bool:
        """Whether a box surely lies in the leaf."""
        return self.primitive.convex and bool(self.inside(_corners(low, high)).all())


def _corners(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    choice = np.indices((2,) * len(low)).reshape(len(low), -1).T
    return np.where(choice == 0, low, high)


@dataclass(frozen=True, eq=False)
class Program:
    """A tree compiled to flat form.

    Attributes
    ----------
    dim : int
    leaves : tuple of Leaf
        Equal leaves at the same place below the same names are one.
    regions : tuple of (str, Code)
        A plain shape is the one region ``"domain"``.
    paths, probes : tuple of (str, (k, 2) float64)
        Embedded paths and points.
    """

    dim: int
    leaves: tuple[Leaf, ...]
    regions: tuple[tuple[str, Code], ...]
    paths: tuple[tuple[str, np.ndarray], ...] = ()
    probes: tuple[tuple[str, np.ndarray], ...] = ()

    @cached_property
    def _classifier(self) -> Classifier:
        return Classifier.of(self.leaves, [code for _, code in self.regions], self.dim)

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Which of the points lie in any region: ``(n,)`` bool."""
        return self.region(points) >= 0

    def region(self, points: np.ndarray) -> np.ndarray:
        """The last region that contains each point, −1 for none: ``(n,)`` int64."""
        return self._classifier.last(np.ascontiguousarray(points, dtype=np.float64))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of a box around all regions, ±inf where unbounded."""
        boxes = [code_bounds(self.leaves, code, self.dim) for _, code in self.regions]
        lows, highs = zip(*boxes, strict=True)
        return np.min(lows, axis=0), np.max(highs, axis=0)


def compile_shape(shape: Shape | Regions | Embed | Periodic) -> Program:
    """Compile a shape, regions, or either with embedded paths and points or periodic sides.

    Examples
    --------
    >>> import csgmesh as cm
    >>> program = compile_shape(cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5))
    >>> [leaf.names for leaf in program.leaves]
    [('plate.left', 'plate.right', 'plate.bottom', 'plate.top'), ('disk',)]
    >>> program.regions
    (('domain', (('leaf', 0), ('leaf', 1), ('difference', 2))),)
    """
    if isinstance(shape, Periodic):
        shape = shape.shape
    domain = shape.shape if isinstance(shape, Embed) else shape
    entries = domain.entries if isinstance(domain, Regions) else (("domain", domain),)
    compiler = _Compiler(domain.dim)
    regions = tuple((name, compiler.compiled(part)) for name, part in entries)
    paths: list[tuple[str, np.ndarray]] = []
    probes: list[tuple[str, np.ndarray]] = []
    for item in shape.items if isinstance(shape, Embed) else ():
        name = compiler.namer.named("", item.name, item.kind)
        (paths if isinstance(item, EmbeddedPath) else probes).append((name, item.points))
    return Program(domain.dim, tuple(compiler.leaves), regions, tuple(paths), tuple(probes))


class _Compiler:
    """Walks trees in order, placing and naming leaves on the way."""

    def __init__(self, dim: int) -> None:
        self.namer = Namer()
        self.leaves: list[Leaf] = []
        self._unplaced = (matrices.identity(dim), (0.0,) * dim)
        self._numbers: dict[tuple, int] = {}
        self._arrays: dict[tuple, tuple[np.ndarray, np.ndarray]] = {}

    def compiled(self, root: Shape) -> Code:
        code: list[tuple[str, int]] = []
        stack: list[tuple] = [(root, self._unplaced, "")]
        while stack:
            node, placement, prefix = stack.pop()
            if isinstance(node, str):
                code.append((node, placement))
            elif isinstance(node, Primitive):
                code.append(("leaf", self._leaf(node, placement, prefix)))
            elif isinstance(node, Boolean):
                operands = node.children
                stack.append((node.operation, len(operands), prefix))
                stack.extend((operand, placement, prefix) for operand in reversed(operands))
            elif isinstance(node, Complement):
                stack.append(("complement", 1, prefix))
                stack.append((node.shape, placement, prefix))
            elif isinstance(node, Affine):
                stack.append((node.shape, self._placed(placement, node), prefix))
            else:
                assert isinstance(node, Named)
                below = f"{prefix}.{node.name}" if prefix else node.name
                stack.append((node.shape, placement, below))
        return tuple(code)

    def _placed(self, placement: tuple, node: Affine) -> tuple:
        if placement is self._unplaced:
            return (node.matrix, node.offset)
        matrix, offset = placement
        moved = matrices.apply(matrix, node.offset)
        return (
            matrices.multiply(matrix, node.matrix),
            tuple(a + b for a, b in zip(moved, offset, strict=True)),
        )

    def _leaf(self, primitive: Primitive, placement: tuple, prefix: str) -> int:
        key = (primitive, placement, prefix)
        number = self._numbers.get(key)
        if number is None:
            number = self._numbers[key] = len(self.leaves)
            name = self.namer.named(prefix, primitive.name, primitive.kind)
            label = f"{primitive.kind.replace('_', ' ')} {name!r}"
            if placement not in self._arrays:
                matrix, offset = np.array(placement[0]), np.array(placement[1])
                _refuse_far(matrix, offset, label)
                self._arrays[placement] = (matrix, offset)
            names = part_names(name, primitive.parts)
            self.leaves.append(Leaf(primitive, *self._arrays[placement], names, label))
        return number


def _refuse_far(matrix: np.ndarray, offset: np.ndarray, label: str) -> None:
    stretch = np.abs(matrix).max(axis=1)
    # Written so that NaN, from infinity times zero, is refused too.
    if not ((stretch >= SMALLEST) & (stretch <= LARGEST) & (np.abs(offset) <= LARGEST)).all():
        raise ShapeError(
            f"{label}: its transformations together must scale by {SMALLEST:g} to {LARGEST:g} and "
            f"shift by at most {LARGEST:g}; they scale by {stretch.max():g} and shift by "
            f"{tuple(offset.tolist())}"
        )

"""What a leaf of the tree must be able to do."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.shape import Shape

if TYPE_CHECKING:
    from csgmesh.domain.curves import Curves


@dataclass(frozen=True, eq=False)
class Frame:
    """The map q = matrix·(p − center) that takes a shape to a unit body.

    Bodies: ``"ball"`` |q| ≤ 1, ``"cube"`` max |q_i| ≤ 1, ``"half_space"`` q_0 ≤ 0.
    """

    body: Literal["ball", "cube", "half_space"]
    center: np.ndarray
    matrix: np.ndarray


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Primitive(Shape):
    """A leaf of the tree.

    A new primitive is a frozen dataclass of its canonical arguments, which `_settle` stores, with a
    `kind`, the parts of its boundary and its membership, in a file of its own under
    ``csg/primitives`` and a line in that package's list. It is `Planar` with exact boundary curves,
    or `Solid` with a body, or either by the length of its coordinates.
    """

    name: str | None = field(default=None, kw_only=True)

    n_leaves = n_nodes = depth = 1

    #: What an unnamed leaf is called; also the key in dictionaries and domain files.
    kind: ClassVar[str]
    #: Whether the shape is convex: a box with its corners inside lies inside.
    convex: ClassVar[bool] = False
    #: Whether the boundary must not cross itself.
    simple: ClassVar[bool] = False
    #: Classes by kind.
    kinds: ClassVar[dict[str, type[Primitive]]] = {}

    def __init_subclass__(cls) -> None:
        if "kind" in cls.__dict__:
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
    def inside(self, points: np.ndarray) -> np.ndarray:
        """Which of the ``(n, dim)`` points lie inside."""

    def unit_frame(self) -> Frame | None:
        """The affine map that makes a unit body of the shape, or None if there is none.

        Trees of these bodies are cut to a box all leaves at once.
        """
        return None

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

    @cached_property
    def _hash(self) -> int:
        return hash((self.content, ()))

    def rebuilt(self, children: Sequence[Shape]) -> Shape:
        return self

    def _named(self, name: str) -> Shape:
        copy = object.__new__(type(self))
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        copy._settle(**(values | {"name": name if self.name is None else f"{name}.{self.name}"}))
        return copy


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Planar(Primitive):
    """A leaf in the plane."""

    dim = 2

    @abstractmethod
    def curves(self) -> tuple[Curves, np.ndarray]:
        """The closed boundary, interior on the left, and the part of every curve."""


def _hashable(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    if isinstance(value, tuple):
        return tuple([_hashable(v) for v in value])
    return value

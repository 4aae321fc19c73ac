"""Paths and points that a mesh must contain without bounding anything."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.nodes import Shape
from csgmesh.csg.regions import Regions
from csgmesh.csg.whole import Whole
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class _Embedded:
    points: np.ndarray
    name: str | None

    def _settle(self, points: ArrayLike, name: str | None, least: int) -> None:
        where = type(self).__name__ + (f" {name!r}" if isinstance(name, str) else "")
        array = checks.point_array(points, "points", where, least=least)
        object.__setattr__(self, "points", array)
        object.__setattr__(self, "name", None if name is None else checks.name(name, where))

    def _key(self) -> tuple[Any, ...]:
        return type(self), self.name, self.points.shape, self.points.tobytes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Embedded) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __repr__(self) -> str:
        from csgmesh.csg.text import literal

        named = "" if self.name is None else f", name={self.name!r}"
        return f"{type(self).__name__}({literal(self.points)}{named})"


class EmbeddedPath(_Embedded):
    """A polyline that edges of the mesh must follow, such as a crack or a sensor wire.

    Parameters
    ----------
    points : (n, 2) float
        At least two, joined by straight lines in this order.
    name : str, optional
        Default ``"path"``.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.EmbeddedPath([(0, 0), (1, 1)], name="crack")
    EmbeddedPath([(0, 0), (1, 1)], name='crack')
    """

    kind = "path"

    def __init__(self, points: ArrayLike, *, name: str | None = None) -> None:
        self._settle(points, name, least=2)
        if (self.points == self.points[0]).all():
            raise ShapeError(
                f"EmbeddedPath{'' if name is None else f' {name!r}'}: a path must have a length; "
                f"it stays at {tuple(self.points[0].tolist())}"
            )

    def __reduce__(self) -> tuple[Any, ...]:
        return _path, (self.points, self.name)


class EmbeddedPoints(_Embedded):
    """Points that must be vertices of the mesh, such as probes.

    Parameters
    ----------
    points : (n, 2) float
        At least one.
    name : str, optional
        Default ``"points"``.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.EmbeddedPoints([(0.5, 0.5)], name="probe")
    EmbeddedPoints([(0.5, 0.5)], name='probe')
    """

    kind = "points"

    def __init__(self, points: ArrayLike, *, name: str | None = None) -> None:
        self._settle(points, name, least=1)

    def __reduce__(self) -> tuple[Any, ...]:
        return _points, (self.points, self.name)


def _path(points: np.ndarray, name: str | None) -> EmbeddedPath:
    return EmbeddedPath(points, name=name)


def _points(points: np.ndarray, name: str | None) -> EmbeddedPoints:
    return EmbeddedPoints(points, name=name)


@dataclass(frozen=True, repr=False, init=False)
class Embed(Whole):
    """A domain with paths and points that its mesh must contain.

    Parameters
    ----------
    shape : Shape or Regions
    items : sequence of EmbeddedPath and EmbeddedPoints

    Examples
    --------
    >>> import csgmesh as cm
    >>> cracked = cm.Embed(cm.Disk((0, 0), 1), [cm.EmbeddedPath([(0, 0), (0.5, 0)], name="crack")])
    >>> cracked.items[0].name
    'crack'
    """

    shape: Shape | Regions
    items: tuple[EmbeddedPath | EmbeddedPoints, ...]

    def __init__(
        self, shape: Shape | Regions, items: Iterable[EmbeddedPath | EmbeddedPoints]
    ) -> None:
        if not isinstance(shape, Shape | Regions):
            raise ShapeError(f"Embed: a shape or Regions is needed; got {shape!r}")
        if isinstance(items, EmbeddedPath | EmbeddedPoints) or not isinstance(items, Iterable):
            raise ShapeError(f"Embed: a sequence of paths and points is needed; got {items!r}")
        if shape.dim != 2:
            raise ShapeError(f"Embed: paths and points lie in the plane; the shape has {shape.dim}")
        listed = tuple(items)
        for k, item in enumerate(listed):
            if not isinstance(item, EmbeddedPath | EmbeddedPoints):
                raise ShapeError(
                    f"Embed: item {k} must be an EmbeddedPath or EmbeddedPoints; got {item!r}"
                )
        object.__setattr__(self, "shape", shape)
        object.__setattr__(self, "items", listed)

    @property
    def dim(self) -> int:
        """2 in the plane, 3 in space."""
        return self.shape.dim

    def __repr__(self) -> str:
        return f"Embed({self.shape!r}, [{', '.join(map(repr, self.items))}])"

    def __str__(self) -> str:
        return f"{self.shape} with {len(self.items)} embedded"

    def __reduce__(self) -> tuple[type[Embed], tuple[Any, ...]]:
        return Embed, (self.shape, self.items)

    def to_dict(self) -> dict[str, Any]:
        """The domain as lists, numbers and strings, ready for JSON; `from_dict` reads it back."""
        items = [{i.kind: {"points": i.points.tolist(), "name": i.name}} for i in self.items]
        return {"embed": self.shape.to_dict(), "items": items}

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Embed:
        """The domain that `to_dict` wrote."""
        inner = data.get("embed") if isinstance(data, dict) else None
        if not isinstance(inner, dict) or not isinstance(data.get("items"), list):
            raise ShapeError("from_dict: a dictionary with a domain and a list of items is needed")
        shape = Regions.from_dict(inner) if "regions" in inner else Shape.from_dict(inner)
        return Embed(shape, [_read_item(item) for item in data["items"]])


def _read_item(item: Any) -> EmbeddedPath | EmbeddedPoints:
    for kind, made in (("path", EmbeddedPath), ("points", EmbeddedPoints)):
        if isinstance(item, dict) and isinstance(item.get(kind), dict) and len(item) == 1:
            value = item[kind]
            return made(value.get("points"), name=value.get("name"))
    raise ShapeError(f"from_dict: an embedded item must be a path or points; got {item!r}")

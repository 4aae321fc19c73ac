"""OpenSCAD's primitives as leaves: exact, or the facets that a small ``$fn`` asks for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from csgmesh.csg import (
    Ball,
    Box,
    Cone,
    Cylinder,
    Disk,
    Extrude,
    Outline,
    Polygon,
    Polyhedron,
    Shape,
)
from csgmesh.errors import ShapeError


@dataclass(frozen=True)
class Arguments:
    """Arguments of a call, checked as they are asked for.

    A `ShapeError` says what is wrong; the caller knows the line.
    """

    name: str
    values: Mapping[str, Any]
    facets_below: int

    def get(self, *names: str) -> Any:
        """The value of the first of these names that is given, None if none is."""
        return next((self.values[n] for n in names if self.values.get(n) is not None), None)

    def number(self, *names: str, default: float | None = None) -> float:
        """A number."""
        value = self.get(*names)
        if value is None and default is not None:
            return default
        if not isinstance(value, float):
            raise ShapeError(f"{self.name}: {names[0]} must be a number; got {value!r}")
        return value

    def flag(self, name: str) -> bool:
        """true or false; false by default."""
        value = self.get(name)
        if value is not None and not isinstance(value, bool):
            raise ShapeError(f"{self.name}: {name} must be true or false; got {value!r}")
        return bool(value)

    def sizes(self, dim: int) -> np.ndarray:
        """``size``, one number for all sides or one a side."""
        value = self.get("size", "#0")
        given = [1.0] * dim if value is None else value
        given = [given] * dim if isinstance(given, float) else given
        if (
            not isinstance(given, list)
            or len(given) != dim
            or not all(isinstance(v, float) for v in given)
        ):
            raise ShapeError(f"{self.name}: size must be {dim} numbers; got {value!r}")
        return np.array(given)

    def rows(self, name: str, width: int | None) -> list[list[float]]:
        """A list of lists of numbers, of one width if it is given."""
        value = self.get(name)
        good = isinstance(value, list) and all(
            isinstance(row, list)
            and (width is None or len(row) == width)
            and all(isinstance(v, float) for v in row)
            for row in value
        )
        if not good:
            what = "numbers" if width is None else f"{width} numbers"
            raise ShapeError(f"{self.name}: {name} must be a list of lists of {what}")
        rows: list[list[float]] = value
        return rows

    @property
    def facets(self) -> int:
        """How many facets go around, 0 for none: the thing is round."""
        fn = self.number("$fn", default=0.0)
        around = max(int(fn), 3)
        return around if fn > 0.0 and around <= self.facets_below else 0


def cube(given: Arguments) -> Shape | None:
    """A box."""
    size = given.sizes(3)
    if (size <= 0.0).any():
        return None
    low = -0.5 * size if given.flag("center") else np.zeros(3)
    return Box(low, low + size)


def square(given: Arguments) -> Shape | None:
    """A rectangle."""
    size = given.sizes(2)
    if (size <= 0.0).any():
        return None
    low = -0.5 * size if given.flag("center") else np.zeros(2)
    return Box(low, low + size)


def sphere(given: Arguments) -> Shape | None:
    """A ball, or rings of facets: none of them at a pole, as OpenSCAD has them."""
    radius = given.number("r", "#0", default=1.0)
    if radius <= 0.0:
        return None
    n = given.facets
    if not n:
        return Ball((0, 0, 0), radius)
    n_rings = (n + 1) // 2
    polar = np.pi * (np.arange(n_rings) + 0.5) / n_rings
    rings = [_ring(n, radius * np.sin(p), radius * np.cos(p)) for p in polar]
    return _rings(rings[::-1])


def cylinder(given: Arguments) -> Shape | None:
    """A cylinder, a cone or a frustum, round or with facets."""
    height = given.number("h", default=1.0)
    r1, r2 = given.number("r1", "r", default=1.0), given.number("r2", "r", default=1.0)
    if height <= 0.0 or min(r1, r2) < 0.0 or max(r1, r2) <= 0.0:
        return None
    low = -0.5 * height if given.flag("center") else 0.0
    n = given.facets
    if not n:
        base, top = (0, 0, low), (0, 0, low + height)
        return Cylinder(base, top, r1) if r1 == r2 else Cone(base, top, r1, r2)
    if r1 == r2:
        prism = Extrude(Polygon(_ring(n, r1, 0.0)[:, :2]), height)
        return prism.translate((0, 0, low)) if low else prism
    return _rings([_ring(n, r1, low), _ring(n, r2, low + height)])


def circle(given: Arguments) -> Shape | None:
    """A disk or a regular polygon."""
    radius = given.number("r", "#0", default=1.0)
    if radius <= 0.0:
        return None
    n = given.facets
    return Polygon(_ring(n, radius, 0.0)[:, :2]) if n else Disk((0, 0), radius)


def polygon(given: Arguments) -> Shape | None:
    """A polygon; of several paths what an odd number of them surrounds."""
    points = given.rows("points", 2)
    paths = None if given.get("paths") is None else given.rows("paths", None)
    numbers = [range(len(points))] if paths is None else [_whole(p, len(points)) for p in paths]
    rings = [[points[k] for k in path] for path in numbers if len(path) > 2]
    if not rings:
        return None
    if len(rings) == 1:
        return Polygon(rings[0])
    return Outline([[tuple(p) for p in ring] for ring in rings], "evenodd")


def polyhedron(given: Arguments) -> Shape | None:
    """A polyhedron; its faces may all run either way around."""
    points = given.rows("points", 3)
    faces = given.rows("faces" if given.get("faces") is not None else "triangles", None)
    numbered = [_whole(face, len(points)) for face in faces]
    return Polyhedron(points, [face for face in numbered if len(face) > 2]) if numbered else None


PRIMITIVES: Mapping[str, Callable[[Arguments], Shape | None]] = {
    made.__name__: made for made in (cube, square, sphere, cylinder, circle, polygon, polyhedron)
}


def _whole(numbers: list[float], count: int) -> list[int]:
    whole = [int(v) for v in numbers]
    if any(v != w or not 0 <= w < count for v, w in zip(numbers, whole, strict=True)):
        raise ShapeError(f"point numbers must be whole, from 0 to {count - 1}; got {numbers}")
    return whole


def _ring(n: int, radius: float, z: float) -> np.ndarray:
    """Points around the z axis, the first at angle 0; quarter turns exact."""
    degrees = 360.0 * np.arange(n) / n
    around = np.radians(degrees)
    ring = np.column_stack([np.cos(around), np.sin(around)]) * radius
    ring[np.abs(ring) < 1e-15 * radius] = 0.0
    return np.column_stack([ring, np.full(n, z)])


def _rings(rings: list[np.ndarray]) -> Shape:
    """The polyhedron of rings one above the other; a ring of radius zero is an apex."""
    n = len(rings[0])
    points: list[np.ndarray] = []
    numbers: list[list[int]] = []
    for ring in rings:
        is_apex = not ring[:, :2].any()
        start = sum(map(len, points))
        points.append(ring[:1] if is_apex else ring)
        numbers.append([start] * n if is_apex else list(range(start, start + n)))
    faces = [number for number in (numbers[0][::-1], numbers[-1]) if len(set(number)) > 2]
    for low, high in pairwise(numbers):
        for k in range(n):
            after = (k + 1) % n
            side = dict.fromkeys((low[k], low[after], high[after], high[k]))
            faces.append(list(side))
    return Polyhedron(np.concatenate(points), faces)

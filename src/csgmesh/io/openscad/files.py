"""OpenSCAD's calls → a shape, children before parents."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from csgmesh.csg import Extrude, Hull, Revolve, Shape, difference, intersection, union
from csgmesh.errors import FileFormatError, ShapeError
from csgmesh.io.openscad.parsing import Call, parse
from csgmesh.io.openscad.primitives import PRIMITIVES, Arguments
from csgmesh.options import near

_LARGEST = 2**28
#: Calls that only hold their children together.
_GROUPS = ("group", "union", "color", "render")
#: What OpenSCAD has and csgmesh has not.
_REFUSED = (
    *("minkowski", "projection", "text", "import", "surface", "offset", "resize", "fill", "roof"),
    *("rotate_extrude_legacy", "cgaladv"),
)

Children = list[Shape | None]


def openscad_shape(path: Path, facets_below: int) -> Shape:
    """The shape of a ``.csg`` file.

    Raises
    ------
    FileFormatError
        With the line, for what is not understood or not to be had, or if nothing is left.
    """
    if path.stat().st_size > _LARGEST:
        raise FileFormatError(f"{path}: a .csg file may have at most {_LARGEST // 2**20} MiB")
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as problem:
        raise FileFormatError(f"{path}: a .csg file is text; byte {problem.start} is not") from None
    root = Call("group", 1, children=parse(text, str(path)))
    shape = _built(root, str(path), facets_below)
    if shape is None:
        raise FileFormatError(f"{path}: the file makes nothing")
    return shape


def _built(root: Call, where: str, facets_below: int) -> Shape | None:
    """The shape of a call, without recursion: trees may be deep."""
    waiting: list[tuple[Call, bool]] = [(root, False)]
    made: dict[int, Shape | None] = {}
    while waiting:
        call, is_ready = waiting.pop()
        if "%" in call.modifiers or "*" in call.modifiers:
            made[id(call)] = None  # shown in the background, or not at all
        elif not is_ready:
            waiting.append((call, True))
            waiting += [(child, False) for child in call.children]
        else:
            children = [made.pop(id(child)) for child in call.children]
            try:
                made[id(call)] = _shape(call, children, facets_below)
            except ShapeError as problem:
                raise FileFormatError(f"{where}:{call.line}: {problem}") from None
    return made[id(root)]


def _shape(call: Call, children: Children, facets_below: int) -> Shape | None:
    name = call.name
    given = Arguments(name, call.arguments, facets_below)
    if "!" in call.modifiers:
        raise ShapeError(f"{name}: the modifier ! is not supported")
    if name in PRIMITIVES:
        return PRIMITIVES[name](given)
    if name in _GROUPS:
        return _union(children)
    if name in _OPERATIONS:
        return _OPERATIONS[name](given, children)
    if name in _REFUSED:
        raise ShapeError(f"{name} is not supported")
    known = (*PRIMITIVES, *_GROUPS, *_OPERATIONS)
    raise ShapeError(f"{name} is not known; {near(name, known)}")


def _union(children: Children) -> Shape | None:
    present = [child for child in children if child is not None]
    return union(present) if present else None


def _difference(given: Arguments, children: Children) -> Shape | None:
    if not children or children[0] is None:
        return None
    return difference(children[0], *[child for child in children[1:] if child is not None])


def _intersection(given: Arguments, children: Children) -> Shape | None:
    present = [child for child in children if child is not None]
    return intersection(present) if present and len(present) == len(children) else None


def _hull(given: Arguments, children: Children) -> Shape | None:
    present = [child for child in children if child is not None]
    return Hull(present) if present else None


def _multmatrix(given: Arguments, children: Children) -> Shape | None:
    shape = _union(children)
    if shape is None:
        return None
    value = given.get("m", "#0")
    try:
        matrix = np.array(value, dtype=float)
    except (TypeError, ValueError):
        matrix = np.zeros(0)
    if matrix.shape not in ((4, 4), (3, 4)):
        raise ShapeError(f"multmatrix: the matrix must have 4 rows of 4 numbers; got {value!r}")
    if matrix.shape == (4, 4) and (matrix[3] != [0.0, 0.0, 0.0, 1.0]).any():
        raise ShapeError(f"multmatrix: the last row must be [0, 0, 0, 1]; got {value[3]!r}")
    dim = shape.dim
    if dim == 2 and (matrix[:2, 2].any() or matrix[2, :2].any()):
        raise ShapeError("multmatrix: a plane shape must stay in its plane")
    linear, offset = matrix[:dim, :dim], matrix[:dim, 3]
    if (linear == np.eye(dim)).all():
        return shape.translate(offset) if offset.any() else shape
    return shape.transform(linear, offset)


def _linear_extrude(given: Arguments, children: Children) -> Shape | None:
    shape = _plane(given, children)
    height = given.number("height", "h", "#0", default=100.0)
    if given.number("twist", default=0.0) != 0.0:
        raise ShapeError(f"linear_extrude: twist is not supported; got {given.get('twist'):g}")
    scale = given.get("scale")
    if scale is not None and scale not in (1.0, [1.0, 1.0]):
        raise ShapeError(f"linear_extrude: scale is not supported; got {_plain(scale)}")
    along = given.get("v")
    if along is not None and (not isinstance(along, list) or along[:2] != [0.0, 0.0]):
        raise ShapeError(f"linear_extrude: v must be along z; got {_plain(along)}")
    if shape is None or height <= 0.0:
        return None
    solid = Extrude(shape, height)
    return solid.translate((0, 0, -0.5 * height)) if given.flag("center") else solid


def _rotate_extrude(given: Arguments, children: Children) -> Shape | None:
    shape = _plane(given, children)
    angle = given.number("angle", default=360.0)
    start = given.number("start", default=0.0)
    if given.facets:
        raise ShapeError(
            f"rotate_extrude: facets around the axis are not supported; $fn is {given.facets}, "
            "and means an exact revolution where facets_below is less"
        )
    if shape is None or angle == 0.0:
        return None
    low, high = shape.bounds()
    if low[0] < -1e-9 * abs(high[0]) and high[0] > 0.0:
        raise ShapeError(
            f"rotate_extrude: the shape must lie on one side of x = 0; it runs from {low[0]:g} to "
            f"{high[0]:g}"
        )
    if high[0] <= 0.0:
        shape = shape.mirror((0, 0), (1, 0))
        start += 180.0
    angle = max(min(angle, 360.0), -360.0)
    solid: Shape = Revolve(shape, abs(angle))
    turn = start + min(angle, 0.0)
    return solid if abs(angle) == 360.0 or turn == 0.0 else solid.rotate(turn)


def _plane(given: Arguments, children: Children) -> Shape | None:
    shape = _union(children)
    if shape is not None and shape.dim != 2:
        raise ShapeError(f"{given.name}: its children must lie in the plane; one is a solid")
    if given.get("file") is not None:
        raise ShapeError(f"{given.name}: files are not supported; got {given.get('file')!r}")
    return shape


def _plain(value: Any) -> str:
    return repr(value) if not isinstance(value, float) else f"{value:g}"


_OPERATIONS: dict[str, Callable[[Arguments, Children], Shape | None]] = {
    "difference": _difference,
    "intersection": _intersection,
    "hull": _hull,
    "multmatrix": _multmatrix,
    "linear_extrude": _linear_extrude,
    "rotate_extrude": _rotate_extrude,
}

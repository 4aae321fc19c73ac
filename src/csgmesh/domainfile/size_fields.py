"""Size fields in domain files: ``{near_size: {names: hole, size: 0.03}}`` and what is made of them.

Keys are the snake-case names of the classes and of their arguments; ``minimum``, ``product`` and
``clamp`` combine sizes.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from csgmesh.domainfile.parameters import described
from csgmesh.options import near

Path = tuple[str | int, ...]

#: Operations on a list of sizes.
_OF_MANY = ("minimum", "product")


@dataclass(frozen=True)
class SizePart:
    """A size field as a file says it: what it is, and its arguments, checked."""

    key: str
    arguments: Any


@cache
def size_classes() -> Mapping[str, type]:
    """Classes of size fields that a file can say, by key."""
    from csgmesh import size as package
    from csgmesh.domainfile.vocabulary import snake_case

    # A solution does not stand in a file.
    names = [n for n in package.__all__ if n.endswith("Size") and n not in _NOT_IN_FILES]
    return {snake_case(name): getattr(package, name) for name in names}


_NOT_IN_FILES = ("HessianSize", "ResolvedSize")


def size_keys() -> tuple[str, ...]:
    """All keys that begin a size field."""
    return (*size_classes(), *_OF_MANY, "clamp")


def is_field(value: Any) -> bool:
    """Whether a mapping says a size field, not sizes by name."""
    return isinstance(value, dict) and len(value) == 1 and next(iter(value)) in size_keys()


class FieldReader:
    """Checks size fields; the readers of numbers and of simple sizes are given."""

    def __init__(
        self,
        numbers: Callable[[Any, Path], Any],
        simple: Callable[[Any, Path], Any],
        complaint: Callable[..., Exception],
    ) -> None:
        self.numbers, self.simple, self.complaint = numbers, simple, complaint

    def size(self, value: Any, path: Path) -> Any:
        """A size: a field, or a number or expression."""
        if not isinstance(value, dict):
            return self.simple(value, path)
        if not is_field(value):
            key = str(next(iter(value), ""))
            raise self.complaint(
                f"a size is a number, an expression or one of the keys {', '.join(size_keys())}; "
                f"{key!r} is none: {near(key, size_keys())}",
                path=(*path, key) if key else path,
                key=True,
            )
        ((key, given),) = value.items()
        here = (*path, key)
        if key in _OF_MANY:
            return SizePart(key, self._many(given, here))
        return SizePart(key, self._arguments(key, given, here))

    def _many(self, given: Any, path: Path) -> list[Any]:
        if not isinstance(given, list) or not given:
            raise self.complaint(f"expected a list of sizes, not {described(given)}", path=path)
        return [self.size(item, (*path, i)) for i, item in enumerate(given)]

    def _arguments(self, key: str, given: Any, path: Path) -> dict[str, Any]:
        kinds = _kinds(key)
        required = [name for name, (_, needed) in kinds.items() if needed]
        if given is None and not required:
            return {}
        if not isinstance(given, dict):
            # A sole value stands for the first argument.
            if len(required) > 1:
                raise self.complaint(
                    f"expected a mapping with keys {', '.join(kinds)}, not {described(given)}",
                    path=path,
                )
            first = next(iter(kinds))
            return {first: self._argument(kinds[first][0], given, path)}
        if key == "region_size" and not set(given) & set(kinds):
            return {"sizes": self._argument("sizes", given, path)}
        for name in given:
            if name not in kinds:
                raise self.complaint(
                    f"unknown key {name!r}; {near(str(name), kinds)}", path=(*path, name), key=True
                )
        for name in required:
            if name not in given:
                raise self.complaint(f"key {name!r} is missing", path=path, key=True)
        return {
            name: self._argument(kinds[name][0], value, (*path, name))
            for name, value in given.items()
        }

    def _argument(self, kind: str, value: Any, path: Path) -> Any:
        if kind == "size":
            return self.size(value, path)
        if kind == "names":
            items = value if isinstance(value, list) else [value]
            for i, item in enumerate(items):
                if not isinstance(item, str):
                    at = (*path, i) if isinstance(value, list) else path
                    raise self.complaint(f"expected a name, not {described(item)}", path=at)
            return tuple(items)
        if kind == "sizes":
            if not isinstance(value, dict):
                raise self.complaint(
                    f"expected a mapping of regions to sizes, not {described(value)}", path=path
                )
            return {name: self.numbers(item, (*path, name)) for name, item in value.items()}
        return self.numbers(value, path)


def _kinds(key: str) -> Mapping[str, tuple[str, bool]]:
    """What each argument of a field is, and whether it must be given."""
    if key == "clamp":
        return {"size": ("size", True), "lo": ("number", False), "hi": ("number", False)}
    found = {}
    for name, parameter in inspect.signature(size_classes()[key]).parameters.items():
        kind = name if name in ("names", "sizes") else "number"
        found[name] = kind, parameter.default is inspect.Parameter.empty
    return found


def build(
    part: Any, simple: Callable[[Any, Path], Any], placed: Callable[..., Any], path: Path
) -> Any:
    """The size of a part; `placed` runs a constructor and gives its errors their place."""
    from csgmesh.size import minimum
    from csgmesh.size.combinations import ClampedSize, ProductSize

    if not isinstance(part, SizePart):
        return simple(part, path)
    here = (*path, part.key)
    if part.key in _OF_MANY:
        sizes = [build(item, simple, placed, (*here, i)) for i, item in enumerate(part.arguments)]
        if part.key == "minimum":
            return placed(here, lambda: minimum(*sizes))
        product = sizes[0]
        for factor in sizes[1:]:
            product = ProductSize(product, factor)
        return product
    if part.key == "clamp":
        inner = build(part.arguments["size"], simple, placed, (*here, "size"))
        bounds = {k: v for k, v in part.arguments.items() if k != "size"}
        return placed(here, lambda: ClampedSize(inner, **bounds))
    return placed(here, lambda: size_classes()[part.key](**part.arguments))


def place_in(data: Any, path: Path, text: str) -> Path | None:
    """Path of the first value below a path of plain data that is a text.

    Examples
    --------
    >>> place_in({"size": {"near_size": {"names": ["wall", "hole"]}}}, ("size",), "hole")
    ('size', 'near_size', 'names', 1)
    """
    for step in path:
        data = data.get(step) if isinstance(data, dict) else None
    waiting: list[tuple[Path, Any]] = [(path, data)]
    while waiting:
        here, value = waiting.pop()
        if value == text:
            return here
        if isinstance(value, dict):
            waiting += [((*here, key), item) for key, item in value.items()]
            if here != path and text in value:
                return (*here, text)
        elif isinstance(value, list):
            waiting += [((*here, i), item) for i, item in enumerate(value)]
    return None

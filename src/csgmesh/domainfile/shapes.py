"""Validated parts of a domain file → shapes, each built after those it refers to."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from csgmesh.csg import Embed, Periodic, Regions
from csgmesh.csg.nodes import Primitive, Shape, combined
from csgmesh.domainfile.document import Document, KeyPath
from csgmesh.domainfile.fields import LONGEST_TEXT
from csgmesh.domainfile.limits import Limits
from csgmesh.domainfile.schema import ShapePart
from csgmesh.domainfile.vocabulary import BOOLEANS, EMBEDDED, Arguments, swept
from csgmesh.errors import InputError
from csgmesh.options import near

Definition = ShapePart | str


def build_shapes(
    document: Document, definitions: Mapping[str, Definition], limits: Limits
) -> Builder:
    """Build all named shapes.

    Raises
    ------
    DomainFileError
        A name that no shape has, a circle, an argument that breaks a rule of its shape, or more
        leaves than allowed.
    """
    builder = Builder(document, definitions, limits)
    for name in builder.in_order():
        shape = builder.shape(definitions[name], ("shapes", name))
        builder.built[name] = placed(document, ("shapes", name), partial(shape.named, name))
    return builder


def _references(part: Definition, path: KeyPath) -> Iterator[tuple[KeyPath, str]]:
    if isinstance(part, str):
        yield path, part
        return
    for step, operand in part.operands():
        yield from _references(operand, path + step)


class Builder:
    """Builds shapes of a document; `built` holds the named ones so far."""

    def __init__(
        self, document: Document, definitions: Mapping[str, Definition], limits: Limits
    ) -> None:
        self.document = document
        self.definitions = definitions
        self.limits = limits
        self.built: dict[str, Shape] = {}

    def in_order(self) -> list[str]:
        """The names, each after all it refers to; without recursion, for a chain may be long."""
        levels: dict[str, int] = {}
        for name in self.definitions:
            if len(name) > LONGEST_TEXT:
                raise self.document.error(
                    f"a name may have at most {LONGEST_TEXT} characters, not {len(name)}",
                    ("shapes", name),
                    key=True,
                )
            self._enter(name, levels)
        return list(levels)

    def _enter(self, start: str, levels: dict[str, int]) -> None:
        waiting = {start: iter(self._references(start))}
        while waiting:
            name = next(reversed(waiting))
            unread = next(((p, other) for p, other in waiting[name] if other not in levels), None)
            if unread is None:
                levels[name] = self._level(name, levels)
                del waiting[name]
                continue
            path, other = unread
            if other in waiting:
                circle = list(waiting)[list(waiting).index(other) :]
                message = f"shapes refer to each other in a circle: {' → '.join([*circle, other])}"
                raise self.document.error(message, path)
            waiting[self._known(other, path)] = iter(self._references(other))

    def _level(self, name: str, levels: Mapping[str, int]) -> int:
        level = 1
        for path, other in self._references(name):
            level = max(level, levels[other] + 1)
            if level > self.limits.nesting:
                # Each level adds a component to the names of all leaves below.
                raise self.document.error(
                    f"shapes may nest at most {self.limits.nesting} levels (limit nesting)", path
                )
        return level

    def _references(self, name: str) -> list[tuple[KeyPath, str]]:
        return list(_references(self.definitions[name], ("shapes", name)))

    def _known(self, name: str, path: KeyPath) -> str:
        if name not in self.definitions:
            raise self.document.error(
                f"no shape is called {name!r}; {near(name, self.definitions)}", path
            )
        return name

    def shape(self, part: Definition, path: KeyPath) -> Any:
        """The shape or whole domain of a part; recursion is bounded by the document's nesting."""
        if isinstance(part, str):
            return self.built[self._known(part, path)]
        shape = self._source(part, path)
        for key in part.operations:
            value = getattr(part, key)
            if key == "complement":
                shape = ~shape if value else shape
            else:
                shape = self._call(getattr(shape, key), value, (*path, key))
        return shape

    def _source(self, part: ShapePart, path: KeyPath) -> Any:
        source = part.source
        place = (*path, source)
        value = getattr(part, source)
        if source in Primitive.kinds and source not in swept():
            return self._call(Primitive.kinds[source], value, place)
        if source == "read_shape":
            return self._read(value, place)
        operands = [self.shape(operand, path + step) for step, operand in part.operands()]
        if source in BOOLEANS:
            return self._combined(source, operands, place)
        if source == "complement":
            return ~operands[0]
        if source == "regions":
            return self.regions(dict(zip(value, operands, strict=True)), place)
        if source == "embed":
            return self._embed(operands[0], value, place)
        if source == "periodic":
            return self._periodic(operands[0], value, place)
        if source in swept():
            many = "shapes" in type(value).model_fields
            arguments = value.given() | ({"shapes": operands} if many else {"shape": operands[0]})
            return self._at(place, lambda: Primitive.kinds[source](**arguments))
        return operands[0]

    def _read(self, arguments: Arguments, path: KeyPath) -> Shape:
        from csgmesh.io import read_shape

        given = arguments.given()
        name = given.pop("path")
        # A file from strangers reads beside itself and nowhere else.
        file = Path(name)
        if file.is_absolute() or ".." in file.parts or not file.name:
            message = f"path must be a file in the folder of the domain file, not {name!r}"
            raise self.document.error(message, (*path, "path"))
        folder = Path(self.document.file).parent
        shape: Shape = self._at(path, lambda: read_shape(folder / file, **given))
        self._few_leaves(shape.n_leaves, path)
        return shape

    def _few_leaves(self, leaves: int, path: KeyPath) -> None:
        if leaves > self.limits.leaves:
            raise self.document.error(
                f"a shape may have at most {self.limits.leaves} leaves (limit leaves), "
                f"not {leaves}",
                path,
                key=True,
            )

    def _combined(self, operation: Any, operands: list[Shape], path: KeyPath) -> Shape:
        self._few_leaves(sum(operand.n_leaves for operand in operands), path)
        return self._at(path, lambda: combined(operation, operands))

    def regions(self, shapes: Mapping[str, Shape], path: KeyPath) -> Regions:
        """Several materials."""
        return self._at(path, lambda: Regions(shapes))

    def _embed(self, shape: Any, arguments: Any, path: KeyPath) -> Embed:
        items = []
        for i, item in enumerate(arguments.items):
            (key,) = item.keys_written
            items.append(self._call(EMBEDDED[key], getattr(item, key), (*path, "items", i, key)))
        return self._at(path, lambda: Embed(shape, items))

    def _periodic(self, shape: Any, arguments: Any, path: KeyPath) -> Periodic:
        for i, pair in enumerate(arguments.pairs):
            if len(pair) != 2:
                message = f"a pair is of two names, not {len(pair)}"
                raise self.document.error(message, (*path, "pairs", i))
        return self._at(path, lambda: Periodic(shape, arguments.pairs))

    def _call(self, function: Callable[..., Any], arguments: Arguments, path: KeyPath) -> Any:
        return self._at(path, lambda: function(**arguments.given()))

    def _at(self, path: KeyPath, build: Callable[[], Any]) -> Any:
        return placed(self.document, path, build)


def placed(document: Document, path: KeyPath, build: Callable[[], Any]) -> Any:
    """What `build` returns; its error moves to the argument it is about, or else to the key.

    Raises
    ------
    DomainFileError
        For an InputError of `build`.
    """
    try:
        return build()
    except InputError as error:
        message = str(error)
        about = re.search(r"(?:^|: |of )(\w+) must", message)
        if about is not None and document.has((*path, about.group(1))):
            raise document.error(message, (*path, about.group(1))) from None
        raise document.error(message, path, key=True) from None

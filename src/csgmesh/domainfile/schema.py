"""The schema of domain files, put together from the vocabulary; and its JSON Schema."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Annotated, Any, ClassVar

from pydantic import Field, create_model

from csgmesh.domainfile.alternatives import OR_FLAG, OR_NAME, NestedShape
from csgmesh.domainfile.expect import Expect
from csgmesh.domainfile.fields import Parameters, Positive, Size, Text, Version, complaint
from csgmesh.domainfile.parts import Part
from csgmesh.domainfile.vocabulary import (
    BOOLEANS,
    Arguments,
    embedded_kinds,
    meshers,
    primitives,
    read_arguments,
    swept,
    transformations,
)

#: The dialect that `json_schema` is written in.
DIALECT = "https://json-schema.org/draft/2020-12/schema"


_SHAPES = (*BOOLEANS, "shape", "read_shape", "complement")
_WHOLES = ("regions", "embed", "periodic")


class ShapePart(Part):
    """A shape: one key that says what it is, and transformations in the order they are applied."""

    #: Keys of which exactly one says what the shape is; `complement` does where it holds a shape.
    sources: ClassVar[tuple[str, ...]] = ()

    @property
    def source(self) -> str:
        """The key that says what the shape is."""
        return self._sources_written()[0]

    @property
    def operations(self) -> tuple[str, ...]:
        """Keys of the transformations in the order written."""
        source = self.source
        return tuple(key for key in self.keys_written if key != source)

    def _sources_written(self) -> list[str]:
        return [
            key
            for key in self.keys_written
            if key in self.sources
            or (key == "complement" and not isinstance(getattr(self, key), bool))
        ]

    def check(self) -> None:
        """Exactly one key says what the shape is."""
        found = self._sources_written()
        if not found:
            known = ", ".join((*self.sources, "complement"))
            raise complaint(f"a shape needs a key that says what it is: one of {known}")
        if len(found) > 1:
            raise complaint(
                f"a shape is one of {' and '.join(found)}, not both; a union is written "
                f"union: [{{{found[0]}: …}}, {{{found[1]}: …}}]",
                path=(found[1],),
                key=True,
            )

    def operands(self) -> Iterator[tuple[tuple[str | int, ...], ShapePart | str]]:
        """The shapes this one is made of, each with the path to it."""
        source = self.source
        value = getattr(self, source)
        if source in BOOLEANS:
            for i, operand in enumerate(value):
                yield (source, i), operand
        elif source in ("shape", "complement"):
            yield (source,), value
        elif source == "regions":
            for name, operand in value.items():
                yield (source, name), operand
        elif source in swept() and "shapes" in type(value).model_fields:
            for i, operand in enumerate(value.shapes):
                yield (source, "shapes", i), operand
        elif source in ("embed", "periodic") or source in swept():
            yield (source, "shape"), value.shape


class _DomainPart(ShapePart):
    """A shape, several materials, or either with embedded items or periodic sides."""

    def check(self) -> None:
        """As of shapes; and materials are not transformed."""
        super().check()
        if self.source in _WHOLES and self.operations:
            raise complaint(
                f"{self.source} takes no transformations; transform its shapes",
                path=(self.operations[0],),
                key=True,
            )


class MeshPart(Part):
    """How to mesh: at most one mesher, the size, and how exact the boundary is."""

    size: Size | None = Field(None, description="Wanted edge length; by name, or in x and y")
    deviation: Positive | None = Field(
        None, description="Largest distance between a facet and its exact curve"
    )
    snap: Positive | None = Field(None, description="Distance below which points merge")

    @property
    def mesher(self) -> str | None:
        """The key of the mesher, if there is one."""
        return next((key for key in self.keys_written if key in meshers()), None)

    def check(self) -> None:
        """At most one mesher."""
        found = [key for key in self.keys_written if key in meshers()]
        if len(found) > 1:
            raise complaint(
                f"a mesh has one mesher, not {' and '.join(found)}", path=(found[1],), key=True
            )


class _FilePart(Part):
    """A domain file of csgmesh: shapes, the domain made of them, how to mesh it, what to expect."""

    def check(self) -> None:
        """One domain."""
        if "domain" not in self.keys_written and "regions" not in self.keys_written:
            raise complaint("key 'domain' is missing: the shape to mesh")
        if "domain" in self.keys_written and "regions" in self.keys_written:
            raise complaint("a file has a domain or regions, not both", path=("regions",), key=True)


def _optional(kind: Any, description: str = "") -> tuple[Any, Any]:
    return (kind, Field(default=None, description=description or None))


def _list_of(kind: Any) -> Any:
    return list[kind]


def _model(name: str, base: type[Part], fields: dict[str, Any]) -> Any:
    model: Any = create_model(name, __base__=base, **fields)
    return model


@cache
def file_model() -> Any:
    """The model of a whole domain file, a subclass of `Part`."""
    reference: Any = NestedShape
    whole: Any = Annotated["Domain", OR_NAME]  # noqa: F821
    kinds = {key: _optional(model) for key, model in primitives().items()}
    kinds |= {key: _optional(_list_of(reference)) for key in BOOLEANS}
    kinds["shape"] = _optional(reference, "A shape by name, or one to transform further")
    kinds["read_shape"] = _optional(read_arguments(), "A shape from another program's file")
    beside = {key: _optional(model) for key, model in transformations().items()}
    beside["complement"] = _optional(
        Annotated[reference, OR_FLAG], "true beside a shape, or the shape itself"
    )
    shape = _model("Shape", ShapePart, {**kinds, **beside})
    shape.sources = tuple(kinds)
    item = _model("Embedded", _OneOf, {k: _optional(m) for k, m in embedded_kinds().items()})
    embed = _model(
        "EmbedArguments", Arguments, {"shape": (whole, ...), "items": (_list_of(item), ...)}
    )
    periodic = _model(
        "PeriodicArguments", Arguments, {"shape": (whole, ...), "pairs": (list[list[Text]], ...)}
    )
    wholes = {
        "regions": _optional(dict[str, reference]),
        "embed": _optional(embed),
        "periodic": _optional(periodic),
    }
    domain = _model("Domain", _DomainPart, {**kinds, **wholes, **beside})
    domain.sources = (*kinds, *wholes)
    choice = _model(
        "MesherChoice", _OneOf, {key: _optional(model) for key, model in meshers().items()}
    )
    mesh = _model("Mesh", MeshPart, {key: _optional(model) for key, model in meshers().items()})
    for model in (*meshers().values(), choice, mesh):
        model.model_rebuild(_types_namespace={"MesherChoice": choice})
    file = _model(
        "DomainFile",
        _FilePart,
        {
            "csgmesh": (Version, Field(description="Version of the format")),
            "parameters": _optional(Parameters, "Numbers, and arithmetic on each other"),
            "shapes": (dict[str, reference], Field(default={}, description="Shapes by name")),
            "domain": _optional(whole, "What to mesh"),
            "regions": _optional(
                dict[str, reference], "Several materials; later ones cover earlier ones"
            ),
            "mesh": (mesh, Field(default=mesh(), description="How to mesh")),
            "output": (list[Text], Field(default=[], description="Files to write, beside this")),
            "expect": _optional(Expect, "What the mesh must be like"),
        },
    )
    names = {"Shape": shape, "Domain": domain}
    for model in (*(primitives()[key] for key in swept()), shape, embed, periodic, domain, file):
        model.model_rebuild(_types_namespace=names)
    return file


class _OneOf(Part):
    """Exactly one of the keys."""

    def check(self) -> None:
        """One key."""
        if len(self.keys_written) != 1:
            listed = ", ".join(type(self).model_fields)
            raise complaint(f"expected one of the keys {listed}; found {len(self.keys_written)}")


def json_schema() -> dict[str, Any]:
    """The JSON Schema of domain files, draft 2020-12, for editors.

    Examples
    --------
    >>> json_schema()["required"]
    ['csgmesh']
    """
    schema = _without_nulls(file_model().model_json_schema())
    parts = schema["$defs"]
    for name, part in parts.items():
        if name.endswith("Arguments"):
            parts[name] = _with_short_form(part)
    for name, sources in (("Shape", _SHAPES), ("Domain", (*_SHAPES, *_WHOLES))):
        keys = (*primitives(), *sources)
        parts[name]["anyOf"] = [{"required": [key]} for key in keys]
    schema["anyOf"] = [{"required": ["domain"]}, {"required": ["regions"]}]
    return {"$schema": DIALECT, **schema, "title": "csgmesh domain file"}


def _with_short_form(part: dict[str, Any]) -> dict[str, Any]:
    """The schema of arguments, which may also be the sole required one, or nothing."""
    required = part.get("required", [])
    if len(required) > 1:
        return part
    short = part["properties"][required[0]] if required else {"type": "null"}
    return {"description": part.get("description", ""), "anyOf": [part, short]}


def _without_nulls(schema: Any) -> Any:
    """The schema less empty defaults: an optional key is left out, not null."""
    if isinstance(schema, dict):
        return {
            key: _without_nulls(value)
            for key, value in schema.items()
            if not (key == "default" and value in (None, [], {}))
        }
    if isinstance(schema, list):
        return [_without_nulls(item) for item in schema]
    return schema

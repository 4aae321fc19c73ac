"""The words of domain files, taken from the constructors: a new class brings its own key."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, ClassVar, ForwardRef

from pydantic import Field, create_model

from csgmesh.csg import EmbeddedPath, EmbeddedPoints
from csgmesh.csg.nodes import SYMBOLS, Primitive, Shape
from csgmesh.domainfile.alternatives import NestedShape
from csgmesh.domainfile.fields import Count, Number, Text, Whole, field_type
from csgmesh.domainfile.parts import Part

#: Booleans, each of a list of shapes.
BOOLEANS: tuple[str, ...] = tuple(SYMBOLS)

#: Methods of a shape that stand beside it as keys.
TRANSFORMATIONS = ("translate", "rotate", "scale", "mirror", "transform", "named")


def snake_case(name: str) -> str:
    """The key of a class.

    Examples
    --------
    >>> snake_case("HalfSpace")
    'half_space'
    """
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


class Arguments(Part):
    """Arguments of a constructor or a method, by name."""

    #: What the arguments make, where they stand for a value.
    builds: ClassVar[Callable[..., Any] | None] = None
    #: The argument that a mapping without its key stands for.
    sole_mapping: ClassVar[str] = ""

    @classmethod
    def required(cls) -> list[str]:
        """Names of the arguments without a default."""
        return [name for name, info in cls.model_fields.items() if info.is_required()]

    @classmethod
    def spread(cls, data: Any) -> Any:
        """The mapping of arguments: a sole value stands for the one that is required."""
        required = cls.required()
        if cls.sole_mapping and isinstance(data, dict) and cls.sole_mapping not in data:
            return {cls.sole_mapping: data}
        if data is None and not required:
            return {}
        # A mapping of words is arguments; anything else can only be the value of the one.
        if len(required) == 1 and not isinstance(data, dict):
            return {required[0]: data}
        return data

    def given(self) -> dict[str, Any]:
        """The arguments that the file gives."""
        return {name: getattr(self, name) for name in self.keys_written}


#: Fields for arguments that are other shapes.
SHAPES: Mapping[str, Any] = {"Shape": NestedShape, "Sequence[Shape]": list[NestedShape]}


def arguments_of(
    function: Callable[..., Any], name: str, *, counts: bool = False
) -> type[Arguments]:
    """The model of a function's arguments, by its signature.

    Parameters
    ----------
    function : callable
        A class or a method of `Shape`.
    name : str
        Name of the model in the JSON Schema.
    counts : bool
        Whether whole numbers make so many things, and are limited.
    """
    definitions: dict[str, Any] = {}
    for parameter in inspect.signature(function).parameters.values():
        if parameter.name == "self":
            continue
        annotation = str(getattr(parameter.annotation, "__name__", parameter.annotation))
        kind = SHAPES.get(annotation) or _nested(annotation) or field_type(annotation)
        if counts and kind is Whole:
            kind = Count
        if parameter.default is inspect.Parameter.empty:
            definitions[parameter.name] = (kind, Field())
        else:
            # Left out of calls where the file does not give it, so the constructor's own default
            # acts; a default of None shows as "no default" in the JSON Schema.
            definitions[parameter.name] = (kind, Field(default=None))
    # Where the model stands decides what "Shape" means in it: the part of a file, not the class.
    where = NestedShape.__metadata__[0].__module__
    model = create_model(
        name,
        __base__=Arguments,
        __doc__=_summary(function),
        __module__=where,
        **definitions,
    )
    model.builds = function
    named = [k for k, (kind, _) in definitions.items() if kind == NAMED_MESHERS]
    model.sole_mapping = named[0] if named else ""
    return model


#: A mesher inside another, and a mapping of names to meshers; what a mesher is, the schema says
#: when it knows all of them.
ONE_MESHER: Any = ForwardRef("MesherChoice")
NAMED_MESHERS: Any = dict.__class_getitem__((str, ONE_MESHER))


def _nested(annotation: str) -> Any:
    """The field for a mesher, a mapping of names to `Layers` or to meshers; None for others."""
    if annotation == "Mapping[str, Layers]":
        return dict[str, layers_arguments()]  # type: ignore[misc]
    if annotation.removesuffix(" | None") == "Mesher":
        return ONE_MESHER
    return NAMED_MESHERS if annotation == "Mapping[str, Mesher]" else None


@cache
def layers_arguments() -> Any:
    """Model of the arguments of `Layers`."""
    from csgmesh.meshers import Layers

    return arguments_of(Layers, "LayersArguments")


@cache
def primitives() -> Mapping[str, type[Arguments]]:
    """Models of the arguments of the primitives, by key."""
    import csgmesh.csg.primitives  # noqa: F401  importing a primitive enters it into `kinds`

    return {
        key: arguments_of(item, item.__name__ + "Arguments", counts=True)
        for key, item in Primitive.kinds.items()
    }


@cache
def swept() -> frozenset[str]:
    """Keys of primitives made of other shapes: their argument ``shape``, or a list ``shapes``."""
    operands = {"shape", "shapes"}
    return frozenset(key for key, model in primitives().items() if operands & {*model.model_fields})


@cache
def transformations() -> Mapping[str, type[Arguments]]:
    """Models of the arguments of the transformations, by key."""
    return {
        key: arguments_of(getattr(Shape, key), key.title() + "Arguments") for key in TRANSFORMATIONS
    }


def _summary(function: Callable[..., Any]) -> str:
    return (inspect.getdoc(function) or "").split("\n\n")[0].replace("\n", " ")


@cache
def read_arguments() -> type[Arguments]:
    """Model of the arguments of `read_shape`."""
    return create_model(
        "ReadShapeArguments",
        __base__=Arguments,
        __doc__="A shape in another program's file, in the folder of the domain file.",
        path=(Text, Field()),
        name=(Text, Field(default=None)),
        split_angle=(Number, Field(default=None)),
        facets_below=(Whole, Field(default=None)),
    )


#: Classes of what can be embedded, by key.
EMBEDDED: Mapping[str, type] = {snake_case(c.__name__): c for c in (EmbeddedPath, EmbeddedPoints)}


@cache
def embedded_kinds() -> Mapping[str, type[Arguments]]:
    """Models of the arguments of what can be embedded, by key."""
    return {key: arguments_of(c, c.__name__ + "Arguments") for key, c in EMBEDDED.items()}


@cache
def mesher_classes() -> Mapping[str, type]:
    """Classes of meshers by key."""
    from csgmesh import meshers as package

    found = {snake_case(name): getattr(package, name) for name in package.__all__}
    return {key: item for key, item in found.items() if hasattr(item, "generate")}


@cache
def meshers() -> Mapping[str, type[Arguments]]:
    """Models of the options of the meshers, by key."""
    return {
        key: arguments_of(item, item.__name__ + "Arguments")
        for key, item in mesher_classes().items()
    }

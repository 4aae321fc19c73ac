"""Types of the values in a domain file, as pydantic fields chosen by a signature's annotation.

Every check goes through the parsers of this package, so that a message says what was found and
where in the text; `ValidationContext` carries the parameters to them.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import PlainValidator, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from csgmesh.domainfile.conditions import Condition
from csgmesh.domainfile.expressions import Expression
from csgmesh.domainfile.limits import Limits
from csgmesh.domainfile.parameters import described, number
from csgmesh.domainfile.size_fields import FieldReader, is_field
from csgmesh.errors import ExpressionError
from csgmesh.options import near

#: Characters of a name or a file. Names of nested shapes join, leaf by leaf.
LONGEST_TEXT = 200


@dataclass(frozen=True)
class ValidationContext:
    """What the checks of values need to know."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    limits: Limits = field(default_factory=Limits)


def complaint(
    message: str, *, path: tuple[str | int, ...] = (), key: bool = False, offset: int = 0
) -> PydanticCustomError:
    """An error for pydantic to collect.

    Parameters
    ----------
    message : str
        What is wrong.
    path : tuple
        From the value that is being validated to the place meant.
    key : bool
        Whether the key is meant, not the value.
    offset : int
        Characters into the text of the value.
    """
    details = {"message": message, "path": path, "key": key, "offset": offset}
    return PydanticCustomError("csgmesh", "{message}", details)


def _number(value: Any, info: ValidationInfo) -> float:
    context = _context(info)
    try:
        return number(value, context.parameters, context.limits.expression_length)
    except ExpressionError as error:
        raise complaint(str(error), offset=error.offset) from None


def _whole(value: Any, info: ValidationInfo) -> int:
    result = _number(value, info)
    if not result.is_integer():
        raise complaint(f"expected a whole number, not {result:g}")
    return int(result)


def _count(value: Any, info: ValidationInfo) -> int:
    result = _whole(value, info)
    most = _context(info).limits.values
    if result > most:
        raise complaint(f"a shape may count at most {most} (limit values), not {result}")
    return result


def _positive(value: Any, info: ValidationInfo) -> float:
    result = _number(value, info)
    if result <= 0:
        raise complaint(f"expected a positive number, not {result:g}")
    return result


def _flag(value: Any) -> bool:
    if not isinstance(value, bool):
        raise complaint(f"expected true or false, not {described(value)}")
    return value


def _text(value: Any) -> str:
    if not isinstance(value, str):
        hint = "; quote it" if isinstance(value, int | float) else ""
        raise complaint(f"expected a text, not {described(value)}{hint}")
    if len(value) > LONGEST_TEXT:
        raise complaint(f"a text may have at most {LONGEST_TEXT} characters, not {len(value)}")
    return value


def _values(value: Any, info: ValidationInfo) -> Any:
    return _nested(value, info, (), False)


def _nested(value: Any, info: ValidationInfo, path: tuple[str | int, ...], words: bool) -> Any:
    """Numbers, and words if allowed, in lists; the nesting is bounded by that of the document."""
    if isinstance(value, list):
        return [_nested(item, info, (*path, i), words) for i, item in enumerate(value)]
    if words and isinstance(value, str) and "$" not in value:
        return value
    try:
        context = _context(info)
        return number(value, context.parameters, context.limits.expression_length)
    except ExpressionError as error:
        raise complaint(str(error), path=path, offset=error.offset) from None


def _lists(value: Any, info: ValidationInfo) -> Any:
    if not isinstance(value, list):
        raise complaint(f"expected a list, such as [0, 0], not {described(value)}")
    return _nested(value, info, (), False)


def _lists_with_words(value: Any, info: ValidationInfo) -> Any:
    if not isinstance(value, list):
        raise complaint(f"expected a list, not {described(value)}")
    return _nested(value, info, (), True)


def _texts(value: Any) -> list[str]:
    if not isinstance(value, list):
        raise complaint(f"expected a list of names, not {described(value)}")
    return [_text(item) for item in value]


def _by_name(value: Any, info: ValidationInfo, check: Callable[[Any, ValidationInfo], Any]) -> Any:
    """A mapping of names, each value checked on its own."""
    if not isinstance(value, dict):
        raise complaint(f"expected a mapping of names, not {described(value)}")
    out = {}
    for name, item in value.items():
        try:
            out[name] = check(item, info)
        except PydanticCustomError as error:
            details = error.context or {}
            path = (name, *details["path"])
            raise complaint(details["message"], path=path, offset=details["offset"]) from None
    return out


def _counts_by_name(value: Any, info: ValidationInfo) -> Any:
    return _by_name(value, info, _whole)


def _words_by_name(value: Any, info: ValidationInfo) -> Any:
    return _by_name(value, info, _word_or_list)


def _word_or_list(value: Any, info: ValidationInfo) -> Any:
    return _text(value) if isinstance(value, str) else _lists_with_words(value, info)


def _condition(value: Any, info: ValidationInfo) -> Condition:
    context = _context(info)
    try:
        return Condition.parse(value, context.parameters, context.limits.expression_length)
    except ExpressionError as error:
        raise complaint(str(error), offset=error.offset) from None


def _size(value: Any, info: ValidationInfo) -> Any:
    reader = FieldReader(
        lambda item, path: _nested(item, info, path, False),
        lambda item, path: _one_size(item, info, path),
        complaint,
    )
    if isinstance(value, dict) and not is_field(value):
        return {name: reader.size(item, (name,)) for name, item in value.items()}
    return reader.size(value, ())


def _one_size(value: Any, info: ValidationInfo, path: tuple[str | int, ...]) -> float | Expression:
    context = _context(info)
    try:
        if isinstance(value, str):
            return Expression.parse(value, limit=context.limits.expression_length)
        size = number(value, context.parameters, context.limits.expression_length)
    except ExpressionError as error:
        raise complaint(str(error), path=path, offset=error.offset) from None
    if size <= 0:
        raise complaint(f"a size must be positive, not {size:g}", path=path)
    return size


def _parameters(value: Any, info: ValidationInfo) -> Mapping[str, float]:
    # Read before everything else, because all other values may refer to them.
    return _context(info).parameters


def _version(value: Any) -> int:
    if value != 1 or isinstance(value, bool):
        raise complaint(f"this csgmesh reads domain files of version 1, not {described(value)}")
    return 1


def _context(info: ValidationInfo) -> ValidationContext:
    return info.context if isinstance(info.context, ValidationContext) else ValidationContext()


_NUMBER_SCHEMA = {
    "anyOf": [
        {"type": "number"},
        {"type": "string", "pattern": r"\$", "description": "Arithmetic: $r or $(2*r + 1)"},
    ]
}
_LIST_SCHEMA: dict[str, Any] = {"type": "array", "items": _NUMBER_SCHEMA}
for _level in range(3):
    _LIST_SCHEMA = {
        "type": "array",
        "items": {"anyOf": [*_NUMBER_SCHEMA["anyOf"], _LIST_SCHEMA]},
    }
_CONDITION_SCHEMA = {
    "anyOf": [
        *_NUMBER_SCHEMA["anyOf"],
        {"type": "string", "pattern": r"^\s*(>=|<=|==|>|<)", "description": 'Such as ">= 30"'},
        {"type": "array", "items": _NUMBER_SCHEMA, "minItems": 2, "maxItems": 2},
    ]
}

Number = Annotated[float, PlainValidator(_number), WithJsonSchema(_NUMBER_SCHEMA)]
Whole = Annotated[int, PlainValidator(_whole), WithJsonSchema(_NUMBER_SCHEMA)]
Count = Annotated[int, PlainValidator(_count), WithJsonSchema(_NUMBER_SCHEMA)]
Positive = Annotated[float, PlainValidator(_positive), WithJsonSchema(_NUMBER_SCHEMA)]
Flag = Annotated[bool, PlainValidator(_flag), WithJsonSchema({"type": "boolean"})]
Text = Annotated[str, PlainValidator(_text), WithJsonSchema({"type": "string"})]
Lists = Annotated[list, PlainValidator(_lists), WithJsonSchema(_LIST_SCHEMA)]
ListsWithWords = Annotated[
    list, PlainValidator(_lists_with_words), WithJsonSchema({"type": "array"})
]
Texts = Annotated[
    list,
    PlainValidator(_texts),
    WithJsonSchema({"type": "array", "items": {"type": "string"}}),
]
CountsByName = Annotated[
    dict,
    PlainValidator(_counts_by_name),
    WithJsonSchema({"type": "object", "additionalProperties": _NUMBER_SCHEMA}),
]
WordsByName = Annotated[
    dict,
    PlainValidator(_words_by_name),
    WithJsonSchema(
        {
            "type": "object",
            "additionalProperties": {"anyOf": [{"type": "string"}, {"type": "array"}]},
        }
    ),
]
Values = Annotated[
    Any,
    PlainValidator(_values),
    WithJsonSchema({"anyOf": [*_NUMBER_SCHEMA["anyOf"], _LIST_SCHEMA]}),
]
Expected = Annotated[Condition, PlainValidator(_condition), WithJsonSchema(_CONDITION_SCHEMA)]

_SIZE_SCHEMA = {
    "anyOf": [
        {"type": "number", "exclusiveMinimum": 0},
        {"type": "string", "description": 'An expression, such as "0.1 + 0.02*x"'},
    ]
}
Size = Annotated[
    Any,
    PlainValidator(_size),
    WithJsonSchema(
        {
            "anyOf": [
                *_SIZE_SCHEMA["anyOf"],
                {
                    "type": "object",
                    "description": "By name, or a size field: {near_size: {names: …, size: …}}",
                    "additionalProperties": {
                        "anyOf": [*_SIZE_SCHEMA["anyOf"], {"type": ["object", "array", "null"]}]
                    },
                },
            ]
        }
    ),
]
Parameters = Annotated[
    Any,
    PlainValidator(_parameters),
    WithJsonSchema({"type": "object", "additionalProperties": _NUMBER_SCHEMA}),
]
Version = Annotated[int, PlainValidator(_version), WithJsonSchema({"const": 1})]


def _choice(choices: tuple[Any, ...]) -> Any:
    def check(value: Any) -> Any:
        if value not in choices:
            listed = " or ".join(map(repr, choices))
            hint = near(value, choices) if isinstance(value, str) else ""
            said = f"; {hint}" if hint.startswith("did") else ""
            raise complaint(f"expected {listed}, not {described(value)}{said}")
        return value

    return Annotated[Any, PlainValidator(check), WithJsonSchema({"enum": list(choices)})]


_BY_ANNOTATION = {
    "float": Number,
    "int": Whole,
    "bool": Flag,
    "str": Text,
    "Sequence[str]": Texts,
    "Mapping[str, int]": CountsByName,
    "Mapping[str, Any]": WordsByName,
}


def field_type(annotation: str) -> Any:
    """The pydantic type for the annotation of an argument, as it is written in the source.

    Numbers, texts, flags and literals are recognised; anything else is lists of numbers, with words
    among them where the annotation says ``Any``.

    Examples
    --------
    >>> field_type("float | None") is Number, field_type("Sequence[float]") is Lists
    (True, True)
    """
    plain = annotation.removesuffix(" | None")
    if plain.startswith("Literal["):
        return _choice(ast.literal_eval(f"({plain[8:-1]},)"))
    if plain in _BY_ANNOTATION:
        return _BY_ANNOTATION[plain]
    if "Any" in plain:
        return ListsWithWords
    return Values if "float" in plain.split(" | ") else Lists

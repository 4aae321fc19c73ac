"""Fields of a domain file that take a mapping or, instead of it, a simple value."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import core_schema


class Or:
    """Marks a field that takes a mapping, or a value of a simple type as it is."""

    def __init__(self, simple: type, json_schema: dict[str, Any]) -> None:
        self.simple = simple
        self.json_schema = json_schema

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        def check(value: Any, inner: core_schema.ValidatorFunctionWrapHandler) -> Any:
            return value if isinstance(value, self.simple) else inner(value)

        return core_schema.no_info_wrap_validator_function(check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"anyOf": [self.json_schema, handler(schema)]}


#: A shape, or the name of one.
OR_NAME = Or(str, {"type": "string", "description": "The name of a shape"})

#: A shape, or true.
OR_FLAG = Or(bool, {"type": "boolean"})

#: A shape inside another, resolved when the models refer to each other.
NestedShape: Any = Annotated["Shape", OR_NAME]  # noqa: F821

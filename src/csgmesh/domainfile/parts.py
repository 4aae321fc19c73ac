"""The pieces of a domain file as pydantic models, and what pydantic finds wrong with them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, ConfigDict, PrivateAttr, ValidationError, model_validator
from pydantic.functional_validators import ModelWrapValidatorHandler

from csgmesh.domainfile.fields import complaint
from csgmesh.domainfile.parameters import described
from csgmesh.options import near


class Part(BaseModel):
    """A mapping with known keys; it remembers the order in which they were written."""

    model_config = ConfigDict(extra="forbid", arbitrary_types_allowed=True)

    _keys: tuple[str, ...] = PrivateAttr(())

    @property
    def keys_written(self) -> tuple[str, ...]:
        """The keys in the order of the file."""
        return self._keys

    @classmethod
    def spread(cls, data: Any) -> Any:
        """The mapping that a shorter way of writing stands for."""
        return data

    def check(self) -> None:
        """What the fields together must obey; raises a `complaint`."""

    @classmethod
    def _needs_no_value(cls, key: str) -> bool:
        kind = cls.model_fields[key].annotation
        return isinstance(kind, type) and issubclass(kind, Part) and kind.spread(None) is not None

    @model_validator(mode="wrap")
    @classmethod
    def _know_the_keys(cls, data: Any, handler: ModelWrapValidatorHandler[Part]) -> Part:
        data = cls.spread(data)
        if not isinstance(data, dict):
            listed = ", ".join(list(cls.model_fields)[:12])
            raise complaint(f"expected a mapping with keys such as {listed}, not {described(data)}")
        for key, value in data.items():
            if key not in cls.model_fields:
                hint = near(str(key), cls.model_fields)
                raise complaint(f"unknown key {key!r}; {hint}", path=(key,), key=True)
            if value is None and not cls._needs_no_value(key):
                raise complaint(f"key {key!r} has no value", path=(key,), key=True)
        part = handler(data)
        part._keys = tuple(data)
        part.check()
        return part


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong.

    Attributes
    ----------
    message : str
        The rule and the value given.
    path : tuple
        Keys and list positions to the place.
    is_key : bool
        Whether the key at that place is meant, not its value.
    offset : int
        Characters into the text of the value.
    """

    message: str
    path: tuple[str | int, ...]
    is_key: bool = False
    offset: int = 0


def problems_of(error: ValidationError) -> Iterator[Problem]:
    """What pydantic collected, in our words."""
    for item in error.errors(include_url=False):
        path = tuple(item["loc"])
        details = item.get("ctx", {})
        if item["type"] == "csgmesh":
            yield Problem(
                details["message"], path + details["path"], details["key"], details["offset"]
            )
        elif item["type"] == "missing":
            yield Problem(f"key {path[-1]!r} is missing", path[:-1], True)
        elif item["type"] in ("list_type", "dict_type"):
            wanted = "a list" if item["type"] == "list_type" else "a mapping"
            yield Problem(f"expected {wanted}, not {described(item['input'])}", path)
        else:
            yield Problem(item["msg"], path)

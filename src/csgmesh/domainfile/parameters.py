"""The parameters of a domain file: numbers, and arithmetic on each other."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from csgmesh.domainfile.document import Document
from csgmesh.domainfile.expressions import RESERVED, Expression
from csgmesh.domainfile.limits import Limits
from csgmesh.errors import ExpressionError, InputError
from csgmesh.options import near

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def number(value: Any, parameters: Mapping[str, float], limit: int) -> float:
    """A number written as such or as arithmetic on parameters.

    Raises
    ------
    ExpressionError
        Neither a number nor an expression with a finite value.

    Examples
    --------
    >>> number("$(r / 2)", {"r": 3.0}, 1000)
    1.5
    """
    if isinstance(value, str) and "$" in value:
        try:
            return Expression.parse(value, limit=limit).evaluate(parameters)
        except ExpressionError as error:
            if value.count("(") > value.count(")"):
                # Inside [ ] and { } YAML ends an unquoted text at a comma.
                raise ExpressionError(
                    f"{error}; quote an expression with a comma", offset=error.offset
                ) from None
            raise
    if isinstance(value, bool) or not isinstance(value, int | float):
        hint = "; arithmetic is written $(…)" if isinstance(value, str) else ""
        raise ExpressionError(f"expected a number, not {described(value)}{hint}")
    try:
        return float(value)
    except OverflowError:
        raise ExpressionError("a number must be finite") from None


def described(value: Any) -> str:
    """What a value of a document is, for messages.

    Examples
    --------
    >>> described({"a": 1}), described("wide"), described(None)
    ('a mapping', "'wide'", 'nothing')
    """
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        return "a list"
    if isinstance(value, bool):
        return str(value).lower()
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "…" + text[-1]


def resolve_parameters(
    document: Document, overrides: Mapping[str, float | str], limits: Limits
) -> dict[str, float]:
    """Values of all parameters, in the order of the file.

    Parameters
    ----------
    document : Document
        With the mapping ``parameters``, or without.
    overrides : mapping of str to float or str
        Values that replace those of the file; a text is arithmetic on the other parameters.
    limits : Limits
        Bounds the length of each expression.

    Raises
    ------
    DomainFileError
        A name that is taken or no name, a value that is no number, or a circle.
    InputError
        An override of a parameter that the file does not have, or whose value is no number.
    """
    given = document.data.get("parameters", {}) if isinstance(document.data, dict) else {}
    if not isinstance(given, dict):
        raise document.error(
            f"expected a mapping of names to numbers, not {described(given)}", ("parameters",)
        )
    for name in overrides:
        if name not in given:
            raise InputError(f"{document.file} has no parameter {name!r}; {near(name, given)}")
    for name in given:
        if not _NAME.fullmatch(name) or name in RESERVED:
            rule = "is taken" if name in RESERVED else "must be letters, digits and _"
            raise document.error(f"parameter name {name!r} {rule}", ("parameters", name), key=True)
    return _Resolution(document, given, overrides, limits).values()


class _Resolution:
    """Evaluates each parameter after those it refers to, without recursion."""

    def __init__(
        self,
        document: Document,
        given: Mapping[str, Any],
        overrides: Mapping[str, float | str],
        limits: Limits,
    ) -> None:
        self.document = document
        self.overrides = overrides
        self.limit = limits.expression_length
        self.expressions: dict[str, Expression] = {}
        self.numbers: dict[str, float] = {}
        for name, value in given.items():
            self._read(name, overrides.get(name, value))
        self.order = list(given)

    def values(self) -> dict[str, float]:
        for name, expression in self.expressions.items():
            try:
                expression.require(self.order)
            except ExpressionError as error:
                raise self._error(name, error) from None
        for name in self.order:
            self._evaluate(name)
        return {name: self.numbers[name] for name in self.order}

    def _read(self, name: str, value: Any) -> None:
        try:
            if isinstance(value, str) and ("$" in value or name in self.overrides):
                self.expressions[name] = Expression.parse(value, limit=self.limit)
            else:
                self.numbers[name] = number(value, {}, self.limit)
        except ExpressionError as error:
            raise self._error(name, error) from None

    def _evaluate(self, name: str) -> None:
        waiting = {name: None}
        while waiting:
            current = next(reversed(waiting))
            if current in self.numbers:
                del waiting[current]
                continue
            expression = self.expressions[current]
            missing = [n for n in expression.names if n not in self.numbers]
            if not missing:
                try:
                    self.numbers[current] = expression.evaluate(self.numbers)
                except ExpressionError as error:
                    raise self._error(current, error) from None
            elif missing[0] in waiting:
                names = list(waiting)
                circle = " → ".join([*names[names.index(missing[0]) :], missing[0]])
                raise self._error(
                    current,
                    ExpressionError(
                        f"parameters refer to each other in a circle: {circle}",
                        offset=expression.names[missing[0]],
                    ),
                )
            else:
                waiting[missing[0]] = None

    def _error(self, name: str, error: ExpressionError) -> InputError:
        if name in self.overrides:
            return InputError(f"value of parameter {name!r}: {error}")
        return self.document.error(str(error), ("parameters", name), offset=error.offset)

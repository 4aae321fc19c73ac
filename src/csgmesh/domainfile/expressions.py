"""Arithmetic of domain files: parsed here into postfix code, evaluated by numpy, never by Python.

Numbers, ``+ - * / // % **``, parentheses, ``pi``, ``e``, the functions of `FUNCTIONS` and names
given by the caller. Precedence and results are Python's: ``-2**2`` is −4, ``2**3**2`` is 512.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from csgmesh.domainfile.tokens import Token, tokenize
from csgmesh.errors import ExpressionError
from csgmesh.options import near

#: name → (numpy function, fewest arguments, most arguments)
FUNCTIONS: Mapping[str, tuple[Callable, int, int]] = {
    "sqrt": (np.sqrt, 1, 1),
    "exp": (np.exp, 1, 1),
    "log": (np.log, 1, 1),
    "log10": (np.log10, 1, 1),
    "sin": (np.sin, 1, 1),
    "cos": (np.cos, 1, 1),
    "tan": (np.tan, 1, 1),
    "asin": (np.arcsin, 1, 1),
    "acos": (np.arccos, 1, 1),
    "atan": (np.arctan, 1, 1),
    "atan2": (np.arctan2, 2, 2),
    "sinh": (np.sinh, 1, 1),
    "cosh": (np.cosh, 1, 1),
    "tanh": (np.tanh, 1, 1),
    "degrees": (np.degrees, 1, 1),
    "radians": (np.radians, 1, 1),
    "abs": (np.abs, 1, 1),
    "floor": (np.floor, 1, 1),
    "ceil": (np.ceil, 1, 1),
    "hypot": (np.hypot, 2, 2),
    "min": (np.minimum, 1, 20),
    "max": (np.maximum, 1, 20),
}

CONSTANTS: Mapping[str, float] = {"pi": float(np.pi), "e": float(np.e)}

#: Coordinates, free in the expressions of sizes.
AXES = ("x", "y", "z")

#: Names that a parameter may not take.
RESERVED = frozenset((*FUNCTIONS, *CONSTANTS, *AXES))

_BINARY: Mapping[str, tuple[int, int, Callable]] = {  # how tightly it binds to its left and right
    "+": (1, 2, np.add),
    "-": (1, 2, np.subtract),
    "*": (3, 4, np.multiply),
    "/": (3, 4, np.divide),
    "//": (3, 4, np.floor_divide),
    "%": (3, 4, np.mod),
    "**": (8, 7, np.power),
}
_SIGN = 6  # a sign binds tighter than * and looser than **

_DEPTH = 50


@dataclass(frozen=True)
class _Step:
    """One step of the postfix code: push a number, push a name or call a function."""

    what: float | str | Callable
    arity: int
    offset: int


@dataclass(frozen=True)
class Expression:
    """A parsed expression.

    Attributes
    ----------
    text : str
        As written.
    names : dict of str to int
        The names it asks for, and where each stands first.

    Examples
    --------
    >>> Expression.parse("2*r + 1").evaluate({"r": 0.5})
    2.0
    >>> Expression.parse("2*width").evaluate({"widht": 1})
    Traceback (most recent call last):
    ...
    csgmesh.errors.ExpressionError: unknown name 'width' in '2*width'; did you mean 'widht'?
    """

    text: str
    steps: tuple[_Step, ...] = field(repr=False)

    @classmethod
    def parse(cls, text: str, *, limit: int = 1000) -> Expression:
        """Parse an expression of at most `limit` characters.

        Raises
        ------
        ExpressionError
            A syntax error, with the offset of the place.
        """
        if len(text) > limit:
            raise ExpressionError(
                f"an expression may have at most {limit} characters, not {len(text)}"
            )
        return cls(text, tuple(_Parser(text).parse()))

    @property
    def names(self) -> dict[str, int]:
        found: dict[str, int] = {}
        for step in self.steps:
            if isinstance(step.what, str):
                found.setdefault(step.what, step.offset)
        return found

    def require(self, known: Mapping | tuple[str, ...] | list[str]) -> None:
        """Raise ExpressionError unless every name of the expression is `known`."""
        for name, offset in self.names.items():
            if name not in known:
                raise ExpressionError(self._unknown(name, list(known)), offset=offset)

    def evaluate(self, values: Mapping[str, float]) -> float:
        """The value, a finite number.

        Raises
        ------
        ExpressionError
            An unknown name, a division by zero, an overflow or no real result.
        """
        return float(self.evaluate_arrays(values))

    def evaluate_arrays(self, values: Mapping[str, float | np.ndarray]) -> np.ndarray:
        """The value with numbers or arrays of one shape for the names.

        Raises
        ------
        ExpressionError
            As `evaluate`, at the first element concerned.
        """
        self.require(values)
        stack: list[np.ndarray] = []
        with np.errstate(all="ignore"):
            for step in self.steps:
                if isinstance(step.what, float):
                    stack.append(np.asarray(step.what))
                elif isinstance(step.what, str):
                    stack.append(np.asarray(values[step.what], dtype=np.float64))
                else:
                    arguments = stack[len(stack) - step.arity :]
                    del stack[len(stack) - step.arity :]
                    stack.append(self._call(step, arguments))
        return stack[0]

    def _call(self, step: _Step, arguments: list[np.ndarray]) -> np.ndarray:
        function = step.what
        assert callable(function)
        if step.arity == 1:
            result = arguments[0] if function in (np.minimum, np.maximum) else function(*arguments)
        else:
            result = arguments[0]
            for argument in arguments[1:]:
                result = function(result, argument)
        if not np.isfinite(result).all():
            raise ExpressionError(self._not_finite(function, arguments, result), offset=step.offset)
        return result

    def _not_finite(self, function: Callable, arguments: list, result: np.ndarray) -> str:
        where = np.unravel_index(np.argmin(np.isfinite(result)), np.shape(result))
        first, *rest = (np.broadcast_to(a, np.shape(result))[where] for a in arguments)
        values = ", ".join(f"{float(v):g}" for v in (first, *rest))
        by_zero = function in (np.divide, np.floor_divide, np.mod) and rest[0] == 0
        if by_zero or (function is np.power and first == 0 and rest[0] < 0):
            return f"division by zero in {self.text!r}"
        if np.isnan(result[where]) or (function in (np.log, np.log10) and first <= 0):
            return f"no real number for {values} in {self.text!r}"
        return f"overflow for {values} in {self.text!r}"

    def _unknown(self, name: str, known: list[str]) -> str:
        message = f"unknown name {name!r} in {self.text!r}"
        if name in AXES:
            return f"{message}; coordinates stand in sizes only, as far as the domain has them"
        hint = near(name, [*known, *FUNCTIONS, *CONSTANTS])
        if hint.startswith("did you mean"):
            return f"{message}; {hint}"
        return f"{message}; {near(name, known)}"


class _Parser:
    """Pratt parser (V. Pratt, 1973) that writes postfix code."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = tokenize(text)
        self.position = 0
        self.depth = 0
        self.steps: list[_Step] = []

    def parse(self) -> list[_Step]:
        if self.tokens[0].kind == "end":
            raise ExpressionError("an expression is empty")
        self._expression(0)
        if self._next.kind != "end":
            raise self._error("unexpected")
        return self.steps

    @property
    def _next(self) -> Token:
        return self.tokens[self.position]

    def _take(self) -> Token:
        token = self._next
        self.position += 1
        return token

    def _expect(self, text: str) -> None:
        if self._next.text != text:
            raise self._error(f"expected {text!r}, not")
        self._take()

    def _error(self, rule: str) -> ExpressionError:
        token = self._next
        found = "the end" if token.kind == "end" else repr(token.text)
        return ExpressionError(f"{rule} {found} in {self.text!r}", offset=token.offset)

    def _expression(self, binding: int) -> None:
        self.depth += 1
        if self.depth > _DEPTH:
            raise ExpressionError(
                f"an expression may nest at most {_DEPTH} levels", offset=self._next.offset
            )
        self._operand()
        while self._next.kind == "operator" and self._next.text in _BINARY:
            left, right, function = _BINARY[self._next.text]
            if left <= binding:
                break
            operator = self._take()
            self._expression(right)
            self.steps.append(_Step(function, 2, operator.offset))
        self.depth -= 1

    def _operand(self) -> None:
        if self._next.text in ("+", "-"):
            sign = self._take()
            self._expression(_SIGN)
            if sign.text == "-":
                self.steps.append(_Step(np.negative, 1, sign.offset))
        elif self._next.text == "(":
            self._take()
            self._expression(0)
            self._expect(")")
        elif self._next.kind == "number":
            self._number()
        elif self._next.kind == "name":
            self._name()
        else:
            raise self._error("expected a number, a name or '(', not")

    def _number(self) -> None:
        value = float(self._next.text)
        if not np.isfinite(value):
            raise self._error("a number must be finite, not")
        self.steps.append(_Step(value, 0, self._take().offset))

    def _name(self) -> None:
        token = self._take()
        if self._next.text == "(":
            self._function(token)
        elif token.text in CONSTANTS:
            self.steps.append(_Step(CONSTANTS[token.text], 0, token.offset))
        elif token.text in FUNCTIONS:
            raise ExpressionError(
                f"function {token.text!r} needs its arguments in parentheses in {self.text!r}",
                offset=token.offset,
            )
        else:
            self.steps.append(_Step(token.text, 0, token.offset))

    def _function(self, token: Token) -> None:
        if token.text not in FUNCTIONS:
            raise ExpressionError(
                f"unknown function {token.text!r} in {self.text!r}; {near(token.text, FUNCTIONS)}",
                offset=token.offset,
            )
        function, fewest, most = FUNCTIONS[token.text]
        self._expect("(")
        count = 0
        if self._next.text != ")":
            self._expression(0)
            count = 1
        while self._next.text == ",":
            self._take()
            self._expression(0)
            count += 1
        self._expect(")")
        if not fewest <= count <= most:
            wanted = f"{fewest}" if fewest == most else f"{fewest} to {most}"
            raise ExpressionError(
                f"function {token.text!r} takes {wanted} arguments, not {count}, in {self.text!r}",
                offset=token.offset,
            )
        self.steps.append(_Step(function, count, token.offset))

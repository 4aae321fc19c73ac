"""What may stand behind a quantity under ``expect``: a value, a comparison or a range."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from csgmesh.domainfile.expressions import Expression
from csgmesh.domainfile.parameters import described, number
from csgmesh.errors import ExpressionError

_COMPARISON = re.compile(r"\s*(>=|<=|==|>|<)\s*(.*?)\s*", re.DOTALL)


@dataclass(frozen=True)
class Condition:
    """Bounds of a quantity; equal bounds mean an exact value.

    Attributes
    ----------
    low, high : float
        The bounds.
    is_strict : bool
        Whether the bounds themselves are excluded.

    Examples
    --------
    >>> Condition.parse(">= 30")
    Condition(low=30.0, high=inf, is_strict=False)
    >>> Condition.parse([500, 3000]).holds(512), Condition.parse("< 2").holds(2)
    (True, False)
    """

    low: float
    high: float
    is_strict: bool = False

    @classmethod
    def parse(
        cls, value: Any, parameters: Mapping[str, float] | None = None, limit: int = 1000
    ) -> Condition:
        """Read a number, a comparison such as ``">= 30"`` or a range ``[low, high]``.

        Raises
        ------
        ExpressionError
            None of these.
        """
        known = parameters or {}
        if isinstance(value, Condition):
            return value
        if isinstance(value, list | tuple):
            if len(value) != 2:
                raise ExpressionError(f"a range is [lowest, highest], not {len(value)} values")
            low, high = (number(bound, known, limit) for bound in value)
            if low > high:
                raise ExpressionError(f"a range is [lowest, highest], not [{low:g}, {high:g}]")
            return cls(low, high)
        match = _COMPARISON.fullmatch(value) if isinstance(value, str) else None
        if match is not None:
            return cls._compared(match, known, limit)
        if isinstance(value, dict) or (isinstance(value, str) and "$" not in value):
            raise ExpressionError(
                'expected a number, a comparison such as ">= 30" or a range [lowest, highest], '
                f"not {described(value)}"
            )
        exact = number(value, known, limit)
        return cls(exact, exact)

    @classmethod
    def _compared(cls, match: re.Match[str], known: Mapping[str, float], limit: int) -> Condition:
        operator = match.group(1)
        try:
            bound = Expression.parse(match.group(2), limit=limit).evaluate(known)
        except ExpressionError as error:
            raise ExpressionError(str(error), offset=match.start(2) + error.offset) from None
        if operator == "==":
            return cls(bound, bound)
        if operator.startswith(">"):
            return cls(bound, math.inf, operator == ">")
        return cls(-math.inf, bound, operator == "<")

    @property
    def is_exact(self) -> bool:
        """Whether one value is wanted."""
        return self.low == self.high

    def holds(self, value: float) -> bool:
        """Whether a value is within the bounds."""
        if self.is_strict:
            return self.low < value < self.high
        return self.low <= value <= self.high

    def __str__(self) -> str:
        if self.is_exact:
            return f"{self.low:.10g}"
        if math.isinf(self.high):
            return f"{'>' if self.is_strict else '>='} {self.low:.10g}"
        if math.isinf(self.low):
            return f"{'<' if self.is_strict else '<='} {self.high:.10g}"
        return f"{self.low:.10g} to {self.high:.10g}"

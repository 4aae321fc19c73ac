"""Sizes written as expressions in the coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from csgmesh.domainfile.expressions import AXES, Expression
from csgmesh.errors import ExpressionError, SizeError


@dataclass(frozen=True)
class ExpressionSize:
    """A size h(points) given by an expression such as ``"0.1 + 0.02*x"``.

    Parameters
    ----------
    expression : Expression
        In x, y (and z in space) and the parameters.
    dim : int
        Number of coordinates.
    parameters : mapping of str to float
        Values of the parameters.

    Raises
    ------
    ExpressionError
        A name that is neither a coordinate of the domain nor a parameter.

    Examples
    --------
    >>> h = ExpressionSize(Expression.parse("0.1 + 0.02*x"), 2)
    >>> h(np.array([[0.0, 0.0], [5.0, 1.0]])).tolist()
    [0.1, 0.2]
    """

    expression: Expression
    dim: int
    parameters: Mapping[str, float] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        self.expression.require([*AXES[: self.dim], *self.parameters])

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Wanted edge lengths at points (n, dim), as (n,).

        Raises
        ------
        SizeError
            The expression has no positive finite value at one of the points.
        """
        points = np.asarray(points, dtype=np.float64)
        axes = dict(zip(AXES, points.T, strict=False))
        try:
            values = self.expression.evaluate_arrays({**self.parameters, **axes})
        except ExpressionError as error:
            raise SizeError(f"size: {error}") from error
        values = np.broadcast_to(values, (len(points),))
        if len(values) and values.min() <= 0:
            worst = int(values.argmin())
            place = ", ".join(f"{c:g}" for c in points[worst])
            raise SizeError(
                f"size {self.expression.text!r} must be positive, "
                f"but is {values[worst]:g} at ({place})"
            )
        return np.array(values)


def constant_or_size(
    expression: Expression, dim: int, parameters: Mapping[str, float]
) -> ExpressionSize | float:
    """The size an expression stands for; a number where it holds no coordinate.

    Raises
    ------
    ExpressionError
        An unknown name, or a constant that is not positive.

    Examples
    --------
    >>> constant_or_size(Expression.parse("$(r / 4)"), 2, {"r": 2.0})
    0.5
    """
    if any(axis in expression.names for axis in AXES):
        return ExpressionSize(expression, dim, parameters)
    expression.require([*AXES[:dim], *parameters])
    value = expression.evaluate(parameters)
    if value <= 0:
        raise ExpressionError(f"a size must be positive, not {value:g}")
    return value

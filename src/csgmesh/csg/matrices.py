"""Matrices of rigid and affine maps, exact where the exact value is a float."""

from __future__ import annotations

import math
from collections.abc import Sequence

Matrix = tuple[tuple[float, ...], ...]
Vector = tuple[float, ...]


def cos_sin(degrees: float) -> tuple[float, float]:
    """Cosine and sine of an angle in degrees, exact where the value is 0, ±½ or ±1.

    Examples
    --------
    >>> cos_sin(90.0), cos_sin(-30.0)[1], cos_sin(720.0 + 180.0)
    ((0.0, 1.0), -0.5, (-1.0, 0.0))
    """
    turned = math.fmod(degrees, 360.0)
    quarter = round(turned / 90.0)
    rest = turned - 90.0 * quarter  # exact: it needs no digit finer than the angle has
    cosine = math.cos(math.radians(rest))
    sine = math.copysign(0.5, rest) if abs(rest) == 30.0 else math.sin(math.radians(rest))
    for _ in range(quarter % 4):
        cosine, sine = -sine, cosine
    return cosine + 0.0, sine + 0.0


def identity(dim: int) -> Matrix:
    """The identity."""
    return tuple(tuple(1.0 if i == j else 0.0 for j in range(dim)) for i in range(dim))


def rotation(degrees: float, axis: Sequence[float] | None = None) -> Matrix:
    """Rotation of the plane, or of space about `axis` (Rodrigues 1840), by an angle in degrees."""
    c, s = cos_sin(degrees)
    if axis is None:
        return ((c, -s), (s, c))
    length = math.hypot(*axis)
    x, y, z = (a / length for a in axis)
    d = 1.0 - c
    return (
        (c + x * x * d, x * y * d - z * s, x * z * d + y * s),
        (y * x * d + z * s, c + y * y * d, y * z * d - x * s),
        (z * x * d - y * s, z * y * d + x * s, c + z * z * d),
    )


def reflection(normal: Sequence[float]) -> Matrix:
    """Reflection in the plane through the origin with this normal (Householder 1958)."""
    largest = max(map(abs, normal))
    scaled = [n / largest for n in normal]
    square = sum(n * n for n in scaled)
    return tuple(
        tuple((1.0 if i == j else 0.0) - 2.0 * a * b / square + 0.0 for j, b in enumerate(scaled))
        for i, a in enumerate(scaled)
    )


def diagonal(factors: Sequence[float]) -> Matrix:
    """Scaling by a factor an axis."""
    return tuple(
        tuple(f if i == j else 0.0 for j in range(len(factors))) for i, f in enumerate(factors)
    )


def apply(matrix: Matrix, vector: Sequence[float]) -> Vector:
    """Matrix times vector."""
    return tuple([sum([a * x for a, x in zip(row, vector, strict=True)]) + 0.0 for row in matrix])


def multiply(a: Matrix, b: Matrix) -> Matrix:
    """Matrix product a·b."""
    columns = list(zip(*b, strict=True))
    return tuple(
        tuple(sum(x * y for x, y in zip(row, column, strict=True)) + 0.0 for column in columns)
        for row in a
    )


def about(matrix: Matrix, center: Sequence[float]) -> Vector:
    """The offset with which `matrix` leaves `center` where it is: center − matrix·center."""
    return tuple(c - m + 0.0 for c, m in zip(center, apply(matrix, center), strict=True))


def determinant(m: Matrix) -> float:
    """Determinant of a 2×2 or 3×3 matrix."""
    if len(m) == 2:
        return m[0][0] * m[1][1] - m[0][1] * m[1][0]
    return (
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    )

"""The sign of a determinant is exact, however near to zero."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from csgmesh import kernels


def exact_signs(row: np.ndarray) -> tuple[int, int]:
    """Orientation of a, b, c and place of d to their circle, by rational arithmetic."""
    ax, ay, bx, by, cx, cy, dx, dy = (Fraction(float(v)) for v in row)
    turn = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    rel = [(x - dx, y - dy) for x, y in ((ax, ay), (bx, by), (cx, cy))]
    lift = [x * x + y * y for x, y in rel]

    def minor(i: int, j: int) -> Fraction:
        return rel[i][0] * rel[j][1] - rel[i][1] * rel[j][0]

    circle = lift[0] * minor(1, 2) + lift[1] * minor(2, 0) + lift[2] * minor(0, 1)
    return (turn > 0) - (turn < 0), (circle > 0) - (circle < 0)


def random_points(rng: np.random.Generator) -> np.ndarray:
    return rng.random(8)


def on_a_circle(rng: np.random.Generator) -> np.ndarray:
    t = rng.random(4) * 2 * np.pi
    return np.column_stack([np.cos(t), np.sin(t)]).ravel()


def on_a_moved_hexagon(rng: np.random.Generator) -> np.ndarray:
    t = rng.integers(0, 6, 4) * np.pi / 3
    return (np.column_stack([np.cos(t), np.sin(t)]) + rng.random(2)).ravel()


def an_ulp_apart(rng: np.random.Generator) -> np.ndarray:
    return 0.5 + rng.integers(0, 4, 8) * 2.0**-53


def on_a_line(rng: np.random.Generator) -> np.ndarray:
    return (rng.random(2) + np.outer(rng.random(4), rng.random(2))).ravel()


def far_from_the_origin(rng: np.random.Generator) -> np.ndarray:
    return (1e9 + np.outer(rng.random(4), rng.random(2))).ravel()


def of_many_magnitudes(rng: np.random.Generator) -> np.ndarray:
    return rng.choice([-1.0, 1.0], 8) * 2.0 ** rng.integers(-40, 40, 8)


@pytest.mark.parametrize(
    "draw",
    [
        random_points,
        on_a_circle,
        on_a_moved_hexagon,
        an_ulp_apart,
        on_a_line,
        far_from_the_origin,
        of_many_magnitudes,
    ],
)
def test_signs_agree_with_rational_arithmetic(draw) -> None:
    rng = np.random.default_rng(7)
    rows = np.array([draw(rng) for _ in range(400)])
    points = rows.reshape(-1, 2)
    first = 4 * np.arange(len(rows))
    triangles = np.column_stack([first, first + 1, first + 2])
    expected = np.array([exact_signs(row) for row in rows])
    assert np.array_equal(kernels.orientations(points, triangles), expected[:, 0])
    assert np.array_equal(kernels.in_circles(points, triangles, first + 3), expected[:, 1])


def test_machine_code_does_not_fuse_products_and_sums() -> None:
    # The proofs need each operation rounded on its own.
    from numba import njit

    kernels.in_circles(np.zeros((3, 2)), np.zeros((0, 3), int), np.zeros(0, int))
    from csgmesh.kernels import checks

    # Compiled here: machine code that comes out of the cache cannot be looked at.
    fresh = njit(nogil=True, error_model="numpy")(checks._in_circles.py_func)
    square = np.array([0, 0, 1, 0, 1, 1, 0, 1.0])
    fresh(square, np.array([0, 1, 2]), np.array([3]), np.zeros(1, np.int8))
    code = "".join(fresh.inspect_asm().values())
    assert "mul" in code
    assert "fmadd" not in code and "fmsub" not in code and "fnmadd" not in code


def test_arrays_of_any_kind_are_taken() -> None:
    points = [[0, 0], [2, 0], [0, 2]]
    assert kernels.orientations(np.array(points), np.array([[0, 1, 2]], np.int32))[0] == 1
    frozen = np.asfortranarray(np.array(points, float))
    frozen.flags.writeable = False
    assert kernels.orientations(frozen, np.array([[2, 1, 0]]))[0] == -1

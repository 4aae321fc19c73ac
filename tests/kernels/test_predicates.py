"""The sign of a determinant is exact, however near to zero."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

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


def on_a_lattice_circle(rng: np.random.Generator) -> np.ndarray:
    """Whole numbers on one circle, or a unit off it: their differences need up to 50 bits."""
    factor = 3 ** int(rng.integers(0, 17))
    pairs = [(1185665, 0), (268583, 1154844), (711399, 948532), (7852, 1185639)]
    rows = []
    for i in rng.integers(0, 4, 4):
        x, y = pairs[i]
        x, y = (x, y) if rng.random() < 0.5 else (y, x)
        rows.append([factor * x * rng.choice([-1, 1]), factor * y * rng.choice([-1, 1])])
    row = np.array(rows, float) + rng.integers(0, 2, 2) * 2.0**30
    if rng.random() < 0.5:
        row[rng.integers(4), rng.integers(2)] += rng.choice([-1, 1])
    return row.ravel()


def beside_a_circle_along_its_tangent(rng: np.random.Generator) -> np.ndarray:
    """Points of a circle through the origin, the last a tiny step off: only stage D can tell."""
    radius = 1185665 / 2**20
    row = np.array([[1154844, 268583], [711399, -948532], [-7852, 1185639], [0, 0]]) / 2**20
    row[:3, 0] += radius
    row[3, 1] = rng.choice([-1, 0, 1]) * 2.0 ** rng.integers(-90, -30)
    row[3, 0] = rng.choice([-1, 0, 0, 1]) * 2.0 ** rng.integers(-160, -60)
    return row.ravel()


def corners_of_a_rectangle(rng: np.random.Generator) -> np.ndarray:
    x, y = rng.random(2), rng.random(2)
    row = np.array([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])[rng.permutation(4)]
    if rng.random() < 0.3:
        i, j = rng.integers(4), rng.integers(2)
        row[i, j] = np.nextafter(row[i, j], rng.choice([-1.0, 2.0]))
    return row.ravel()


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
        on_a_lattice_circle,
        beside_a_circle_along_its_tangent,
        corners_of_a_rectangle,
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


def test_machine_code_fuses_only_the_errors_of_products() -> None:
    # The proofs need each operation rounded on its own; only where a filter's exact successors ask
    # for the error of a product they get it from a fused operation.
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
    assert "csgmesh_incircle_adaptive" in code


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="names an x86 processor")
def test_signs_are_exact_on_processors_without_fused_operations(tmp_path) -> None:
    code = """
import sys
sys.path.insert(0, sys.argv[1])
import test_predicates as t
for draw in (t.on_a_circle, t.on_a_lattice_circle, t.of_many_magnitudes):
    t.test_signs_agree_with_rational_arithmetic(draw)
"""
    environment = {**os.environ, "NUMBA_CPU_NAME": "x86-64", "NUMBA_CACHE_DIR": str(tmp_path)}
    found = subprocess.run(
        [sys.executable, "-c", code, str(Path(__file__).parent)],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
    )
    assert found.returncode == 0, found.stderr


def test_arrays_of_any_kind_are_taken() -> None:
    points = [[0, 0], [2, 0], [0, 2]]
    assert kernels.orientations(np.array(points), np.array([[0, 1, 2]], np.int32))[0] == 1
    frozen = np.asfortranarray(np.array(points, float))
    frozen.flags.writeable = False
    assert kernels.orientations(frozen, np.array([[2, 1, 0]]))[0] == -1

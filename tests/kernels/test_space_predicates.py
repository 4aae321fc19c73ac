"""The sign of a determinant of space is exact, however near to zero."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from csgmesh import kernels


def determinant(rows: list[list[Fraction]]) -> Fraction:
    if len(rows) == 1:
        return rows[0][0]
    total = Fraction(0)
    for k, first in enumerate(rows[0]):
        rest = [row[:k] + row[k + 1 :] for row in rows[1:]]
        total += (-first if k & 1 else first) * determinant(rest)
    return total


def exact_signs(five: np.ndarray) -> tuple[int, int]:
    """Orientation of the first four of five points, and where the fifth lies to their sphere."""
    p = [[Fraction(float(x)) for x in row] for row in five]
    volume = determinant([[u - v for u, v in zip(p[k], p[0], strict=True)] for k in (1, 2, 3)])
    rel = [[u - v for u, v in zip(p[k], p[4], strict=True)] for k in range(4)]
    sphere = -determinant([[*row, sum(x * x for x in row)] for row in rel])
    return (volume > 0) - (volume < 0), (sphere > 0) - (sphere < 0)


def random_points(rng: np.random.Generator) -> np.ndarray:
    return rng.random((5, 3))


def on_a_sphere(rng: np.random.Generator) -> np.ndarray:
    v = rng.normal(size=(5, 3))
    return v / np.sqrt((v * v).sum(axis=1))[:, None]


def on_a_moved_sphere(rng: np.random.Generator) -> np.ndarray:
    return on_a_sphere(rng) * 0.3 + rng.random(3)


def on_a_lattice(rng: np.random.Generator) -> np.ndarray:
    return rng.integers(0, 3, (5, 3)).astype(float)


def on_a_scaled_lattice(rng: np.random.Generator) -> np.ndarray:
    return rng.integers(0, 3, (5, 3)) / 7 + 0.1


def on_an_exact_lattice(rng: np.random.Generator) -> np.ndarray:
    return rng.integers(-4, 5, (5, 3)) * (2.0**-22 * 1048573)


def on_a_large_lattice(rng: np.random.Generator) -> np.ndarray:
    return rng.integers(-1, 2, (5, 3)) * 2.0**40 + rng.integers(-1, 2, (5, 3))


def an_ulp_apart(rng: np.random.Generator) -> np.ndarray:
    return 0.5 + rng.integers(0, 4, (5, 3)) * 2.0**-53


def on_corners_of_a_box(rng: np.random.Generator) -> np.ndarray:
    low, high = rng.random((2, 3))
    points = np.where(rng.integers(0, 2, (5, 3)), high, low)
    points[rng.integers(0, 8) % 5] = rng.random(3)
    return points if rng.random() < 0.5 else np.where(rng.integers(0, 2, (5, 3)), high, low)


def in_a_plane(rng: np.random.Generator) -> np.ndarray:
    return rng.random(3) + rng.random((5, 2)) @ rng.random((2, 3))


def on_a_circle_of_a_lattice(rng: np.random.Generator) -> np.ndarray:
    """Trapezoids, of which half have no circle: one leg moved; and any point."""
    a, b, h, x, y = rng.integers(1, 5, 5)
    trapezoid = np.array([[-a, x, y], [a, x, y], [-b, x + h, y - h], [b, x + h, y - h]])
    if rng.random() < 0.5:
        trapezoid[3, 0] += 1
    points = np.vstack([trapezoid * (2.0**-22 * 1048573), rng.random(3)])
    return points[rng.permutation(5)][:, rng.permutation(3)]


def far_from_the_origin(rng: np.random.Generator) -> np.ndarray:
    return 1e9 + in_a_plane(rng)


def of_many_magnitudes(rng: np.random.Generator) -> np.ndarray:
    return rng.choice([-1.0, 1.0], (5, 3)) * 2.0 ** rng.integers(-40, 40, (5, 3))


def beside_a_sphere_along_its_tangent(rng: np.random.Generator) -> np.ndarray:
    """Points of a sphere through the origin, the last a tiny step off: only expansions can tell."""
    radius = 1185665.0
    four = np.array(
        [[1154844, 268583, 0], [0, 711399, -948532], [-7852, 0, 1185639], [0, 0, radius]]
    )
    four[:, 1:] *= rng.choice([-1, 1], (4, 2))
    step = rng.choice([-1.0, 1.0], 2) * 2.0 ** rng.integers(-70, -40, 2)
    return np.vstack([rng.permutation(four) - [radius, 0, 0], [0, *step]])


def almost_in_a_plane(rng: np.random.Generator) -> np.ndarray:
    """Volumes of a few units, 2^-104 of the products that make them up."""
    u, v = ([int(c) for c in rng.integers(2**25, 2**26, 3)] for _ in range(2))
    n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    # Bézout's numbers: the plane through e parallel to u and v is the next one.
    (r, x, y), (s, z, w) = (n[0], 1, 0), (n[1], 0, 1)
    while s:
        q = r // s
        (r, x, y), (s, z, w) = (s, z, w), (r - q * s, x - q * z, y - q * w)
    far = [a + b for a, b in zip(u, v, strict=True)]
    four = np.array([[0, 0, 0], u, v, [x + far[0], y + far[1], far[2]]], float)
    return np.vstack([rng.permutation(four + rng.integers(0, 2**20, 3)), rng.random(3)])


@pytest.mark.parametrize(
    "family",
    [
        random_points,
        on_a_sphere,
        on_a_moved_sphere,
        on_a_lattice,
        on_a_scaled_lattice,
        on_an_exact_lattice,
        on_a_large_lattice,
        an_ulp_apart,
        on_corners_of_a_box,
        in_a_plane,
        almost_in_a_plane,
        beside_a_sphere_along_its_tangent,
        on_a_circle_of_a_lattice,
        far_from_the_origin,
        of_many_magnitudes,
    ],
)
def test_signs_are_those_of_rational_arithmetic(family) -> None:
    rng = np.random.default_rng(5)
    rows = np.array([family(rng) for _ in range(200)])
    cells = np.arange(len(rows) * 5).reshape(-1, 5)
    points = rows.reshape(-1, 3)
    wanted = np.array([exact_signs(five) for five in rows])
    assert (kernels.tetra_orientations(points, cells[:, :4]) == wanted[:, 0]).all()
    assert (kernels.in_spheres(points, cells[:, :4], cells[:, 4]) == wanted[:, 1]).all()

"""Hard domains end in valid meshes with no more points than their shape asks for."""

from __future__ import annotations

import numpy as np
import pytest
from plane_domains import comb, koch, loops, star, wedge

import csgmesh as cm


def spiral(turns: int, n: int = 40) -> cm.Pslg:
    """A band of width 0.3 that winds around the origin."""
    t = np.linspace(0, 2 * np.pi * turns, n * turns)
    ring = np.column_stack([np.cos(t), np.sin(t)])
    inner, outer = (radius[:, None] * ring for radius in (1 + t / 6.3, 1.3 + t / 6.3))
    return loops([(float(x), float(y)) for x, y in np.vstack([inner, outer[::-1]])])


#: A domain, and how many points it may take at 30 degrees without a size.
HARD = {
    "star of 1,000 spikes": (star(1000), 4000),
    "comb of 50 teeth": (comb(50), 2000),
    "Koch 2": (koch(2), 120),
    "Koch 3": (koch(3), 600),
    "Koch 4": (koch(4), 2500),
    "spiral": (spiral(20), 12_000),
    "needle": (cm.evaluate(cm.Triangle((0, 0), (1, 0), (1, 1e-8))), 20),
    "far away": (
        cm.evaluate(cm.Disk((1e9, 1e9), 1) - cm.Disk((1e9 + 0.5, 1e9), 0.2)),
        1000,
    ),
    "island 1e-9 from the wall of its hole": (
        loops(
            [(-1, -1), (1, -1), (1, 1), (-1, 1)],
            [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)],
            [(x * (0.5 - 1e-9), y * (0.5 - 1e-9)) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))],
        ),
        40,
    ),
}


@pytest.mark.parametrize("name", HARD)
def test_hard_domains_mesh(name: str) -> None:
    domain, most = HARD[name]
    mesh = cm.generate(domain, cm.DelaunayRefinement(max_points=2 * most))
    certificate = cm.check(mesh)
    assert certificate.ok, str(certificate)
    assert mesh.n_points <= most


@pytest.mark.parametrize("degrees", [5.0, 1.0, 1e-2, 1e-4, 1e-6])
def test_input_angles_cost_a_bounded_number_of_points(degrees: float) -> None:
    for domain in (wedge(degrees, 1.3), wedge(degrees)):
        mesh = cm.generate(domain, cm.DelaunayRefinement(max_points=1000))
        assert cm.check(mesh).ok
        assert mesh.n_points < 200
        sized = cm.generate(domain, cm.DelaunayRefinement(max_points=1000), size=0.3)
        assert cm.check(sized).ok


def test_two_holes_a_billionth_apart_stay_apart() -> None:
    shape = (
        cm.Box((-1, -1), (1, 1))
        - cm.Box((-0.5, -0.5), (0, 0.5), name="west")
        - cm.Box((1e-9, -1e-9), (0.5, 1e-9), name="east")
    )
    domain = cm.evaluate(shape)
    assert float(domain.areas()[0]) == pytest.approx(4 - 0.5 - 0.5 * 2e-9, rel=1e-12)
    mesh = cm.generate(domain, cm.DelaunayRefinement(max_points=50_000))
    assert cm.check(mesh).ok
    assert not set(mesh.boundary_points("west")) & set(mesh.boundary_points("east"))


@pytest.mark.parametrize("deviation", [1e-3, 1e-6, 1e-9])
def test_a_disk_converges_as_the_chord_bound_says(deviation: float) -> None:
    domain = cm.evaluate(cm.Disk((0, 0), 1), deviation=deviation)
    chord = 2 * np.sqrt(2 * deviation)  # sagitta s = c² / 8 on the unit circle
    n = np.ceil(2 * np.pi / chord)
    assert n <= domain.n_segments <= 2 * n + 4
    lost = np.pi - float(domain.chord_areas()[0])
    assert 0 < lost <= 2 / 3 * deviation * 2 * np.pi * 1.001
    assert float(domain.areas()[0]) == pytest.approx(np.pi, rel=1e-14)
    if deviation > 1e-9:
        mesh = cm.generate(domain)
        assert cm.check(mesh).ok
        assert (
            np.abs(np.hypot(*mesh.points[mesh.facets["line"]].reshape(-1, 2).T) - 1).max() < 1e-15
        )


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-5])
def test_nearly_touching_arcs_stay_apart(gap: float) -> None:
    shape = cm.Box((-2, -1.5), (3.5, 1.5)) - cm.Disk((-0.5, 0), 1, name="a") - cm.Disk(
        (1.5 + gap, 0), 1, name="b"
    )  # fmt: skip
    mesh = cm.generate(shape)
    assert cm.check(mesh).ok
    a, b = (mesh.points[mesh.boundary_points(name)] for name in "ab")
    assert a[:, 0].max() <= 0.5 and b[:, 0].min() >= 0.5 + gap - 1e-15
    assert len(set(mesh.boundary_points("a")) & set(mesh.boundary_points("b"))) == 0

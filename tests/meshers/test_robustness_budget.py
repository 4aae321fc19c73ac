"""What cannot be done is refused early, and a failure names the worst places and why."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.domain.input_angles import sharp_corners
from csgmesh.meshers.lower_bound import least_points


def strip(height: float) -> cm.Pslg:
    corners = [[0, 0], [1, 0], [1, height], [0, height]]
    return cm.Pslg(corners, [[0, 1], [1, 2], [2, 3], [3, 0]])


@pytest.mark.parametrize("height", [1e-9, 1e-13, 1e-60])
def test_extremely_flat_domains_are_refused_before_any_work(height: float) -> None:
    with pytest.raises(cm.BudgetError, match="region 'domain' is so flat that angles of 30") as e:
        cm.generate(strip(height))
    assert e.value.mesh.n_points == 4


def test_a_thin_coating_is_refused_by_its_name() -> None:
    core = cm.Disk((0, 0), 1, name="core")
    coated = cm.Regions({"core": core, "coat": cm.Disk((0, 0), 1 + 1e-6) - core})
    with pytest.raises(cm.BudgetError, match="region 'coat' is so flat"):
        cm.generate(coated, cm.DelaunayRefinement(max_points=10_000))


@pytest.mark.parametrize(
    "shape",
    [
        cm.Box((0, 0), (1, 1)),
        cm.Box((0, 0), (1, 1e-3)),
        cm.Disk((0, 0), 1) - cm.Disk((0, 0), 0.99),
        cm.Triangle((0, 0), (1, 0), (1, 1e-6)),
        cm.RegularPolygon((0, 0), 1, 3),
    ],
)
@pytest.mark.parametrize("min_angle", [0, 20, 33])
def test_the_lower_bound_is_one(shape: cm.Shape, min_angle: float) -> None:
    domain = cm.evaluate(shape)
    least, _ = least_points(domain, sharp_corners(domain), min_angle)
    assert least <= cm.generate(domain, cm.DelaunayRefinement(min_angle=min_angle)).n_points


def test_each_reason_is_found() -> None:
    def worst(shape: cm.Shape, mesher: object = None, size: object = None) -> dict[str, object]:
        try:
            return cm.worst_cells(cm.generate(shape, mesher, size), 1)[0]
        except cm.BudgetError as error:
            assert f"{error.mesh.n_points} is used up" in str(error)
            return cm.worst_cells(error.mesh, 1)[0]

    square = cm.Box((0, 0), (1, 1))
    few = cm.DelaunayRefinement(max_points=60)
    wedge = worst(cm.Triangle((0, 0), (4, 0), (4, 1)))
    assert wedge["reason"] == "input angle" and wedge["angle"] == pytest.approx(14.036, abs=1e-3)
    lower = [(x, 0) for x in (-0.2, 0, 1, 2, 3, 3.2)]
    upper = [(x, 0.1) for x in (-0.2, 0.5, 1.5, 2.5, 3.2)]
    gap = worst(cm.Polygon(lower + upper[::-1]), cm.ConstrainedDelaunay())
    assert gap["reason"] == "narrow gap" and 0 < gap["place"][1] < 0.1
    steep = worst(square, few, lambda p: 0.001 + 0.3 * np.hypot(*p.T))
    assert steep["reason"] == "size jump"
    assert worst(cm.Disk((0, 0), 1), few)["reason"] == "budget"
    assert worst(square, None, 0.1)["reason"] == "within the bound"


def test_the_budgets_message_names_the_worst_places() -> None:
    with pytest.raises(cm.BudgetError) as caught:
        cm.generate(
            cm.Box((0, 0), (1, 1)) - cm.Disk((0.5, 0.5), 0.2),
            cm.DelaunayRefinement(max_points=60),
        )
    for cell in cm.worst_cells(caught.value.mesh, 3):
        x, y = cell["place"]
        named = f"{cell['angle']:.3g}° at ({x:.6g}, {y:.6g}) ({cell['reason']})"
        assert named in str(caught.value)
    assert cm.check(caught.value.mesh).failures[0].rule == "smallest angle"


def test_worst_cells_are_listed_worst_first_and_plain() -> None:
    mesh = cm.generate(cm.Disk((0, 0), 1), size=0.2)
    worst = cm.worst_cells(mesh, 10**6)
    assert [cell["angle"] for cell in worst] == sorted(cm.quality(mesh).min_angle.tolist())
    assert json.loads(json.dumps(worst)) == worst
    assert cm.worst_cells(mesh, 7) == worst[:7]
    for count in (0, 2.5, "3"):
        with pytest.raises(cm.InputError, match="count must be a whole number, at least 1"):
            cm.worst_cells(mesh, count)
    with pytest.raises(cm.InputError, match=r"needs a Mesh.*got int"):
        cm.worst_cells(5)


@pytest.mark.parametrize("radius", [1e80, 1e99, 1e-80, 1e-98])
def test_radii_of_any_magnitude_are_refined(radius: float) -> None:
    disk = cm.Disk((0, 0), radius)
    for size in (None, radius / 8, {"disk": radius / 20}, lambda p: np.full(len(p), radius / 8)):
        mesh = cm.generate(disk, size=size)
        assert cm.check(mesh).ok
        assert cm.quality(mesh).min_angle.min() >= 30
    assert cm.check(mesh, disk).ok
    same = cm.generate(cm.Disk((0, 0), 1), size=1 / 8)
    huge = cm.generate(cm.Disk((0, 0), 2.0**300), size=2.0**297)
    assert np.array_equal(same.cells["triangle"], huge.cells["triangle"])
    with pytest.raises(cm.BudgetError, match="in units of") as caught:
        cm.generate(disk, cm.DelaunayRefinement(max_points=100), size={"disk": radius / 50})
    assert np.hypot(*caught.value.mesh.points.T).max() == pytest.approx(radius)


def test_the_command_lists_the_worst_cells(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    from csgmesh.cli.quality import quality

    file = tmp_path / "wedge.yaml"
    file.write_text("csgmesh: 1\ndomain: {triangle: {a: [0, 0], b: [4, 0], c: [4, 1]}}\n")
    quality(file, worst=2)
    *_, first, second = capsys.readouterr().out.strip().split("\n")
    assert first.startswith("14° at (") and first.endswith("(input angle)")
    assert "° at (" in second

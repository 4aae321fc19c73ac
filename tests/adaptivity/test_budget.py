"""A budget of cells is met by scaling the size, or the error says what it takes."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.errors import BudgetError, InputError

PLATE = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")


@pytest.mark.parametrize("cells", [1000, 10000])
@pytest.mark.parametrize(
    "size",
    [None, {"hole": 1, "default": 5}, cm.FeatureSize(3), lambda p: 1 + p[:, 0]],
    ids=["uniform", "names", "features", "callable"],
)
def test_the_budget_is_met_within_five_percent(size, cells):
    mesh = cm.generate_to_budget(PLATE, size=size, cells=cells)
    assert abs(mesh.n_cells - cells) <= 0.05 * cells
    assert cm.check(mesh).ok


def test_sizes_keep_their_ratio():
    mesh = cm.generate_to_budget(PLATE, size={"hole": 3, "default": 12}, cells=8000, tolerance=0.02)
    assert abs(mesh.n_cells - 8000) <= 160
    assert cm.check(mesh, PLATE).ok
    lines = mesh.points[mesh.facets["line"]]
    length = np.hypot(*(lines[:, 1] - lines[:, 0]).T)
    hole = mesh.boundary("hole")["line"]
    far = np.flatnonzero((lines.mean(axis=1)[:, 0] < 0.01) | (lines.mean(axis=1)[:, 0] > 3.99))
    assert length[far].mean() / length[hole].mean() == pytest.approx(4, rel=0.15)


def test_what_is_kept_is_not_scaled():
    channel = cm.Box((0, 0), (4, 0.1)) | cm.Box((4, -1), (6, 1))
    keep = cm.FeatureSize(4)
    mesh = cm.generate_to_budget(channel, cells=6000, keep=keep)
    assert abs(mesh.n_cells - 6000) <= 300
    # Even lines across the channel cut at least four cells each.
    across = np.stack(np.meshgrid(np.linspace(0.2, 3.8, 40), np.linspace(0.001, 0.099, 99)), axis=2)
    cell = mesh.locate(across.reshape(-1, 2)).reshape(99, 40)
    assert ((np.diff(cell, axis=0) != 0).sum(axis=0) + 1).min() >= 4
    with pytest.raises(BudgetError, match=r"500 cells are too few: .* need about") as caught:
        cm.generate_to_budget(channel, cells=500, keep=keep)
    needed = int(str(caught.value).split()[-1])
    assert caught.value.mesh.n_cells == needed > 1000


def test_features_that_need_more_cells_say_how_many():
    comb = cm.difference(
        cm.Box((0, 0), (10, 1)), *[cm.Box((k + 0.3, 0.2), (k + 0.7, 1.1)) for k in range(10)]
    )
    with pytest.raises(BudgetError, match="10 cells are too few") as caught:
        cm.generate_to_budget(comb, cells=10)
    fewest = caught.value.mesh.n_cells
    assert cm.generate_to_budget(comb, cells=2 * fewest).n_cells == pytest.approx(
        2 * fewest, rel=0.05
    )


@pytest.mark.parametrize(("cells", "tolerance"), [(0, 0.05), (10.5, 0.05), (True, 0.1), (100, 0)])
def test_bad_budgets_are_refused(cells, tolerance):
    with pytest.raises(InputError, match=r"cells must be|tolerance must be"):
        cm.generate_to_budget(PLATE, cells=cells, tolerance=tolerance)

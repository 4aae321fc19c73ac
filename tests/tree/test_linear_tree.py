"""Linear quadtrees: neighbours, balance and budgets, against counting by hand."""

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.errors import BudgetError, InputError
from csgmesh.tree import LinearTree

ROOT = LinearTree.root((0, 0), (1, 1))


def around(point, share=0.9, floor=0.004):
    """Tree whose leaves grow with their distance from a point."""

    def is_coarse(lo, size):
        away = np.maximum(np.maximum(lo - point, point - lo - size), 0)
        return size[:, 0] > floor + share * np.hypot(*away.T)

    return ROOT.refined_where(is_coarse)


def touching(tree):
    """Pairs of leaves that share a side or a corner, and whether it is a side, by comparison."""
    lo, size = tree.boxes()
    overlap = np.minimum((lo + size)[:, None], lo + size) - np.maximum(lo[:, None], lo)
    first, second = np.nonzero((overlap >= 0).all(axis=2))
    apart = first != second
    return first[apart], second[apart], (overlap.max(axis=2)[first, second] > 0)[apart]


@pytest.mark.parametrize("point", [(0.3, 0.41), (0.5, 0.5), (0.999, 0.002)])
def test_neighbours_are_those_that_touch(point):
    tree = around(point)
    first, second, _ = touching(tree)
    for leaf in range(tree.n_leaves):
        assert np.array_equal(tree.neighbours(leaf), second[first == leaf])


@pytest.mark.parametrize("corners", [True, False])
@pytest.mark.parametrize("point", [(0.3, 0.41), (0.5, 0.5), (0.999, 0.002)])
def test_balance_is_two_to_one_and_only_refines(point, corners):
    tree = around(point, floor=1e-3)
    even = tree.balanced(corners=corners)
    first, second, is_side = touching(even)
    counted = is_side | corners
    gap = np.abs(even.level[first].astype(int) - even.level[second])
    assert gap[counted].max() == 1
    held = tree.leaf_of(even.boxes()[0] + 0.5 * even.boxes()[1])
    assert (even.level >= tree.level[held]).all()
    assert np.isclose((even.boxes()[1].prod(axis=1)).sum(), 1.0, rtol=0, atol=1e-12)


def test_a_leaf_five_levels_down_reaches_the_root():
    tree = ROOT
    for _ in range(6):
        marked = np.zeros(tree.n_leaves, bool)
        marked[tree.leaf_of([(0.49, 0.49)])] = True
        tree = tree.refined(marked)
    even = tree.balanced()
    first, second, _ = touching(even)
    assert np.abs(even.level[first].astype(int) - even.level[second]).max() == 1


def test_width_puts_more_leaves_of_a_size_in_a_row():
    tree = around((0.5, 0.5), floor=1e-3)
    assert tree.balanced(width=3).n_leaves > 1.5 * tree.balanced().n_leaves


def test_points_find_their_leaves():
    tree = around((0.3, 0.41)).balanced()
    lo, size = tree.boxes()
    points = np.random.default_rng(1).random((500, 2))
    leaf = tree.leaf_of(points)
    assert ((lo[leaf] <= points) & (points < (lo + size)[leaf])).all()
    assert tree.leaf_of([(1.5, 0.5), (0.5, -1e-9)]).tolist() == [-1, -1]


def test_a_picture_shows_every_leaf():
    tree = around((0.3, 0.41))
    figure = cm.draw(tree)
    assert f"{tree.n_leaves} leaves" in figure.axes[0].get_title()


def test_limits_are_errors_with_a_place():
    with pytest.raises(BudgetError, match=r"more than 1,000 leaves .* at \("):
        ROOT.refined_where(lambda lo, size: size[:, 0] > 0.01, max_leaves=1000)
    with pytest.raises(BudgetError, match="at most 30 levels"):
        ROOT.refined_where(lambda lo, size: (lo == 0).all(axis=1))
    with pytest.raises(InputError, match="positive and finite"):
        LinearTree.root((0, 0), (1, 0))
    with pytest.raises(InputError, match="numbered 0 to 0"):
        ROOT.neighbours(1)

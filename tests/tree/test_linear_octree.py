"""Linear octrees: neighbours, balance, items and budgets, against counting by hand."""

import numpy as np
import pytest

from csgmesh import kernels
from csgmesh.errors import BudgetError, InputError
from csgmesh.tree import LinearTree

ROOT = LinearTree.root((0, 0, 0), (1, 1, 1))


def around(point, share=0.9, floor=0.02):
    """Tree whose leaves grow with their distance from a point."""

    def is_coarse(lo, size):
        away = np.maximum(np.maximum(lo - point, point - lo - size), 0)
        return size[:, 0] > floor + share * np.sqrt((away**2).sum(axis=1))

    return ROOT.refined_where(is_coarse)


def touching(tree):
    """Pairs of leaves that meet, and in how many directions they overlap, by comparison."""
    lo, size = tree.boxes()
    overlap = np.minimum((lo + size)[:, None], lo + size) - np.maximum(lo[:, None], lo)
    first, second = np.nonzero((overlap >= 0).all(axis=2))
    apart = first != second
    return first[apart], second[apart], (overlap > 0).sum(axis=2)[first, second][apart]


@pytest.mark.parametrize("point", [(0.3, 0.41, 0.7), (0.5, 0.5, 0.5), (0.999, 0.002, 0.3)])
def test_neighbours_share_a_side_an_edge_or_a_corner(point):
    tree = around(point, floor=0.04)
    first, second, _ = touching(tree)
    for leaf in range(tree.n_leaves):
        assert np.array_equal(tree.neighbours(leaf), second[first == leaf])


@pytest.mark.parametrize("corners", [True, False])
@pytest.mark.parametrize("point", [(0.3, 0.41, 0.7), (0.49, 0.49, 0.49), (0.999, 0.002, 0.3)])
def test_balance_is_two_to_one_and_only_refines(point, corners):
    tree = around(point, share=2.5, floor=0.01)
    even = tree.balanced(corners=corners)
    assert even.n_leaves > tree.n_leaves
    first, second, shared = touching(even)
    gap = np.abs(even.level[first].astype(int) - even.level[second])
    assert gap[(shared == 2) | corners].max() == 1
    held = tree.leaf_of(even.boxes()[0] + 0.5 * even.boxes()[1])
    assert (even.level >= tree.level[held]).all()
    assert np.isclose((even.boxes()[1].prod(axis=1)).sum(), 1.0, rtol=0, atol=1e-12)


def test_points_find_their_leaves():
    tree = around((0.3, 0.41, 0.6)).balanced()
    lo, size = tree.boxes()
    points = np.random.default_rng(1).random((500, 3))
    leaf = tree.leaf_of(points)
    assert ((lo[leaf] <= points) & (points < (lo + size)[leaf])).all()
    assert tree.leaf_of([(1.5, 0.5, 0.5), (0.5, -1e-9, 0.5), (0.5, 0.5, 1.0)]).tolist() == [-1] * 3


def test_leaves_list_the_boxes_that_they_meet():
    tree = around((0.3, 0.41, 0.6)).balanced()
    units = 2**tree.deepest
    corners = np.sort(np.random.default_rng(2).random((40, 2, 3)) * units, axis=1).astype(np.int64)
    lo, size = (np.rint(a * units).astype(np.int64) for a in tree.boxes())
    meets = (corners[:, None, 0] < lo + size) & (corners[:, None, 1] >= lo)
    wanted = np.argwhere(meets.all(axis=2))
    item, leaf = np.empty(len(wanted), np.int64), np.empty(len(wanted), np.int64)
    counts, stack = np.zeros(2, np.int64), np.empty(16 * tree.deepest, np.int64)
    bounds = corners.reshape(-1)
    assert kernels.pair_boxes(tree.key, tree.level, bounds, counts, stack, item, leaf) == 0
    assert counts.tolist() == [40, len(wanted)]
    assert sorted(np.stack([item, leaf], axis=1).tolist()) == wanted.tolist()
    counts[:] = 0
    assert kernels.pair_boxes(tree.key, tree.level, bounds, counts, stack, item, leaf[:-1]) == 1


def test_errors_state_the_rule_and_the_place():
    with pytest.raises(BudgetError, match=r"more than 50 leaves .* is at \(0, 0, 0\)"):
        ROOT.refined_where(lambda lo, size: lo.max(axis=1) == 0, max_leaves=50)
    with pytest.raises(BudgetError, match="at most 20 levels"):
        ROOT.refined_where(lambda lo, size: lo.max(axis=1) == 0)
    with pytest.raises(InputError, match="2 or 3 numbers"):
        LinearTree.root((0, 0, 0, 0), (1, 1, 1, 1))
    with pytest.raises(InputError, match="numbered 0 to 0; got 3"):
        ROOT.neighbours(3)

"""Many disks in narrow gaps: cells across each gap, gradation kept, the budget met."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

import csgmesh as cm
from csgmesh.size.background import cell_edges
from csgmesh.size.gradation import steepest

ACROSS = 4
N_DISKS = 40


@pytest.fixture(scope="module")
def packing():
    """Centres and radii of disks in the unit square, many of them nearly touching."""
    rng = np.random.default_rng(0)
    typical = 0.45 / np.sqrt(N_DISKS)
    centres, radii = np.zeros((0, 2)), np.zeros(0)
    while len(radii) < N_DISKS:
        c = rng.random(2)
        free = min(c.min(), (1 - c).min(), *(np.hypot(*(centres - c).T) - radii), 1.0)
        radius = min(free - rng.uniform(0.02, 0.05) * typical, 1.3 * typical)
        if radius > 0.25 * typical:
            centres, radii = np.vstack([centres, c]), np.append(radii, radius)
    return centres, radii


def gaps(centres, radii, widest):
    """Ends of the shortest way between each two disks that are near."""
    pairs = cKDTree(centres).query_pairs(2 * radii.max() + widest, output_type="ndarray")
    i, j = pairs[np.lexsort(pairs.T)].T
    across = centres[j] - centres[i]
    distance = np.hypot(*across.T)
    near = distance - radii[i] - radii[j] < widest
    i, j, way = i[near], j[near], (across / distance[:, None])[near]
    return centres[i] + radii[i, None] * way, centres[j] - radii[j, None] * way


def test_cells_across_gaps_within_a_budget(packing):
    centres, radii = packing
    holes = [cm.Disk(tuple(c), r, name="hole") for c, r in zip(centres, radii, strict=True)]
    shape = cm.difference(cm.Box((0, 0), (1, 1)), *holes)
    keep = cm.FeatureSize(ACROSS)
    needed = cm.generate(shape, size=keep).n_cells
    cells = int(1.3 * needed)
    mesh = cm.generate_to_budget(shape, cells=cells, keep=keep)
    assert abs(mesh.n_cells - cells) <= 0.05 * cells
    assert cm.check(mesh, shape).ok
    a, b = gaps(centres, radii, 0.1 * radii.mean())
    assert len(a) > 15
    share = np.linspace(0.005, 0.995, 200)
    points = a[:, None] + share[:, None] * (b - a)[:, None]
    cell = mesh.locate(points.reshape(-1, 2)).reshape(len(a), -1)
    assert ((np.diff(cell, axis=1) != 0).sum(axis=1) + 1).min() >= ACROSS
    edges = cell_edges(mesh)[0]
    wanted = cm.size_conformity(mesh, keep).wanted
    assert steepest(mesh.points, edges, wanted) <= 0.3 * (1 + 1e-9)
    with pytest.raises(cm.BudgetError, match=f"are too few.* about {needed}"):
        cm.generate_to_budget(shape, cells=needed // 2, keep=keep)

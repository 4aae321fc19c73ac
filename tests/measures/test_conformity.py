"""The lengths of edges beside the size."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.errors import InputError

PLATE = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")


def test_ratios_are_lengths_over_sizes():
    mesh = cm.Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], {"quad": [[0, 1, 2, 3]]})
    found = cm.size_conformity(
        mesh, lambda p: 1 + p[:, 0], domain=cm.evaluate(cm.Box((0, 0), (1, 1)))
    )
    by_edge = {tuple(e): r for e, r in zip(found.edges.tolist(), found.ratio, strict=True)}
    assert by_edge == pytest.approx({(0, 1): 2 / 3, (1, 2): 1 / 2, (2, 3): 2 / 3, (0, 3): 1})
    assert found.share == 0.75


def test_graded_meshes_follow_their_size():
    size = {"hole": 0.04, "default": 0.3}
    mesh = cm.generate(PLATE, size=size)
    found = cm.size_conformity(mesh, size)
    assert found.share > 0.97
    assert found.ratio.mean() == pytest.approx(1, abs=0.1)
    assert "as long as wanted" in str(found)
    assert cm.size_conformity(mesh, 0.02).share < 0.2
    assert cm.size_conformity(mesh, lambda p: np.full(len(p), 0.02)).ratio.min() > 1.5


def test_a_mesh_without_a_domain_needs_one():
    mesh = cm.Mesh([[0, 0], [1, 0], [1, 1]], {"triangle": [[0, 1, 2]]})
    with pytest.raises(InputError, match="give domain="):
        cm.size_conformity(mesh, 0.1)

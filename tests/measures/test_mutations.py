"""Whatever one thing is changed in a right mesh, the certificate sees it."""

from __future__ import annotations

import numpy as np
import pytest
from mutations import MUTATIONS

import csgmesh as cm
from csgmesh.measures.certificate import check
from csgmesh.testing import assert_valid

N_MUTATIONS = 200


@pytest.fixture(scope="module")
def shape():
    plate = cm.Box((0, 0), (4, 2), name="plate")
    holes = cm.Disk((2, 1), 0.4, name="hole") | cm.Ellipse((3, 1), (0.3, 0.5), 20, name="slot")
    regions = cm.Regions({"rock": plate - holes, "core": cm.Disk((1, 1), 0.5, name="core")})
    return cm.Embed(
        regions,
        [
            cm.EmbeddedPath([(0.2, 0.3), (0.5, 0.3), (0.5, 0.2)], name="crack"),
            cm.EmbeddedPoints([(3.6, 0.5), (3.6, 1.5)], name="probe"),
        ],
    )


@pytest.fixture(scope="module")
def mesh(shape):
    return cm.generate(shape, cm.DelaunayRefinement(min_angle=25), size=0.3)


def test_the_mesh_itself_is_right(mesh, shape):
    assert_valid(mesh, shape)
    assert cm.check(mesh).ok


def test_every_mutation_is_caught(mesh, shape):
    reference = cm.evaluate(shape)
    missed = []
    for seed in range(N_MUTATIONS):
        mutation = MUTATIONS[seed % len(MUTATIONS)]
        try:
            spoiled = mutation(np.random.default_rng(seed), mesh)
        except cm.InputError:  # caught by Mesh itself
            continue
        if check(spoiled, reference).ok:
            missed.append(f"{mutation.__name__} with seed {seed}")
    assert not missed

"""Fields that know curves alone say so in space."""

from __future__ import annotations

import pytest

import csgmesh as cm

BLOCK = cm.Box((0, 0, 0), (1, 1, 1), name="block")


@pytest.mark.parametrize(
    "field",
    [
        cm.NearSize("block.left", 0.1),
        cm.RegionSize({"domain": 0.2}),
        cm.CurvatureSize(24),
        cm.FeatureSize(),
        cm.minimum(cm.NearSize("block.left", 0.1), 0.3),
    ],
    ids=["near", "region", "curvature", "feature", "minimum"],
)
def test_fields_of_the_plane_are_refused(field: cm.SizeField) -> None:
    with pytest.raises(cm.SizeError, match=r"needs a domain in the plane.*callable"):
        cm.generate(BLOCK, size=field)


def test_regions_are_given_by_a_mapping() -> None:
    with pytest.raises(cm.SizeError, match="map names of regions to sizes; got 'core'"):
        cm.RegionSize("core")

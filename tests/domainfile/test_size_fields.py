"""Size fields in domain files, and where their errors are."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.domainfile.schema import json_schema
from csgmesh.errors import DomainFileError

HEAD = """csgmesh: 1
parameters: {r: 0.5}
shapes:
  plate: {box: {lo: [0, 0], hi: [4, 2]}}
  hole: {disk: {center: [2, 1], radius: $r}}
domain: {difference: [plate, hole]}
mesh:
"""


def loaded(tmp_path, size):
    path = tmp_path / "plate.yaml"
    path.write_text(HEAD + size)
    return cm.load(path)


def test_fields_are_built_as_in_python(tmp_path):
    size = """  size:
    minimum:
      - near_size: {names: [hole, plate.left], size: $(r/10), gradation: 0.2}
      - feature_size: 4
      - curvature_size:
      - clamp: {size: "0.1 + 0.05*x", lo: 0.11, hi: 0.2}
      - product: [0.5, {background_size: {background: [[0, 4], [0, 2]], values: [[1, 1], [2, 2]]}}]
      - 0.3
"""
    file = loaded(tmp_path, size)
    near = cm.NearSize(["hole", "plate.left"], 0.05, gradation=0.2)
    assert file.size.sizes[:3] == (near, cm.FeatureSize(4), cm.CurvatureSize())
    grid = cm.BackgroundSize(([0, 4], [0, 2]), [[1, 1], [2, 2]])
    same = cm.minimum(
        near,
        cm.FeatureSize(4),
        cm.CurvatureSize(),
        cm.minimum(lambda p: 0.1 + 0.05 * p[:, 0]).clamp(0.11, 0.2),
        grid * 0.5,
        0.3,
    )
    domain = cm.evaluate(file.shape)
    points = np.random.default_rng(0).uniform((0, 0), (4, 2), (100, 2))
    np.testing.assert_allclose(file.size.bind(domain)(points), same.bind(domain)(points))
    mesh = file.generate()
    assert cm.check(mesh, file.shape).ok
    assert cm.size_conformity(mesh, same).share > 0.9


def test_names_may_have_fields(tmp_path):
    file = loaded(tmp_path, "  size: {hole: 0.05, default: {feature_size: {cells: 5}}}\n")
    assert file.size == {"hole": 0.05, "default": cm.FeatureSize(5)}


def test_regions_have_sizes(tmp_path):
    file = loaded(tmp_path, "  size: {region_size: {sizes: {domain: 0.2}, gradation: 0.1}}\n")
    assert file.size == cm.RegionSize({"domain": 0.2}, 0.1)
    assert loaded(tmp_path, "  size: {region_size: {domain: 0.2}}\n").size == cm.RegionSize(
        {"domain": 0.2}
    )


@pytest.mark.parametrize(
    ("size", "place", "message"),
    [
        ("  size: {near_size: {names: hole, siez: 1}}", "siez", "unknown key 'siez'.*'size'"),
        ("  size: {near_size: {names: hole}}", "near_size", "key 'size' is missing"),
        ("  size: {near_size: {names: 3, size: 1}}", "3", "expected a name, not 3"),
        ("  size: {near_size: {names: hole, size: -1}}", "-1", "size must be positive.*-1"),
        ("  size: {minimum: [0.1, {faeture_size: 2}]}", "faeture", "did you mean 'feature_size'"),
        ("  size: {minimum: 3}", "3", "expected a list of sizes"),
        ("  size: {hole: {feature_size: {cells: $q}}}", "$q", "'q'"),
        ("  size: {clamp: {size: 0.1, lo: 2, hi: 1}}", "2, hi", "lo must not exceed hi"),
    ],
)
def test_errors_have_their_place(tmp_path, size, place, message):
    with pytest.raises(DomainFileError, match=message) as caught:
        loaded(tmp_path, size + "\n")
    line = 1 + HEAD.count("\n")
    assert f"plate.yaml:{line}:{size.index(place) + 1}:" in str(caught.value)


def test_names_that_mean_nothing_are_found_in_the_file(tmp_path):
    file = loaded(tmp_path, "  size:\n    near_size:\n      names: hloe\n      size: 0.1\n")
    with pytest.raises(DomainFileError, match=r"plate.yaml:10:14: .*did you mean 'hole'"):
        file.generate()


def test_the_schema_lets_fields_pass():
    jsonschema = pytest.importorskip("jsonschema")
    schema = json_schema()
    for size in ({"near_size": {"names": "hole", "size": 1}}, {"minimum": [1, "x"]}, {"hole": 0.1}):
        jsonschema.validate(
            {"csgmesh": 1, "domain": {"box": {"lo": [0, 0], "hi": [1, 1]}}, "mesh": {"size": size}},
            schema,
        )

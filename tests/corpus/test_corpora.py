"""Corpora: a fixed sample in every run, all of them behind ``-m corpus``."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from corpora import CORPORA, trees
from degenerate import CASES
from glyphs import outline, sample
from verdict import judge

import csgmesh as cm
from csgmesh.errors import BudgetError, EmptyDomainError, EvaluationError, UnboundedDomainError
from csgmesh.measures import check

#: Rings and slivers so thin that 20 degrees take millions of triangles.
ENDLESS = {"sliver of 1e-6", "sliver of 1e-9", "thin ring"}


def test_a_sample_of_glyphs_meshes_at_20_degrees_with_a_passing_certificate() -> None:
    found = sample("DejaVuSans", 200)
    assert len(found) == 200
    for k, index in enumerate(found):
        domain = cm.evaluate(outline("DejaVuSans", index))
        mesh = cm.DelaunayRefinement(min_angle=20).generate(domain)
        # Samples take three quarters of the time: every twentieth glyph gets them.
        certificate = check(mesh, domain, domain.oracle.region if k % 20 == 0 else None)
        assert certificate.ok, f"glyph {index}: {certificate.failures}"


def test_cubic_glyphs_mesh_at_30_degrees() -> None:
    for index in sample("STIXGeneralItalic", 20):
        domain = cm.evaluate(outline("STIXGeneralItalic", index))
        certificate = check(cm.DelaunayRefinement().generate(domain), domain)
        assert certificate.ok, f"glyph {index}: {certificate.failures}"


def test_random_trees_mesh_or_say_why_not() -> None:
    meshed = 0
    for label, make in islice(trees(), 30):
        shape = make()
        try:
            reference = cm.evaluate(shape)
        except (UnboundedDomainError, EmptyDomainError):
            continue
        except EvaluationError as error:
            assert "give a larger snap" in str(error)
            continue
        mesh = cm.DelaunayRefinement(min_angle=20, max_points=100_000).generate(reference)
        certificate = check(mesh, reference, reference.oracle.region if meshed % 10 == 0 else None)
        assert certificate.ok, f"{label}: {certificate.failures}"
        meshed += 1
    assert meshed > 15


@pytest.mark.parametrize("label", CASES)
def test_degenerate_domains_mesh_wherever_they_lie(label: str) -> None:
    shape, area, names = CASES[label]
    mesher = cm.DelaunayRefinement(min_angle=20, max_points=50_000)
    for placed in (shape, shape.rotate(17)):
        if label in ENDLESS:
            # Known from its flatness before any work is done, or found out by doing it.
            with pytest.raises(BudgetError, match=r"max_points(=| is )50000") as stopped:
                cm.generate(placed, mesher)
            # The work so far is a whole mesh of the domain, with too small angles at the most.
            failed = check(stopped.value.mesh, cm.evaluate(placed)).failures
            assert {failure.rule for failure in failed} <= {"smallest angle"}
            continue
        mesh = cm.generate(placed, mesher)
        certificate = check(mesh, cm.evaluate(placed))
        assert certificate.ok, certificate.failures
        covered = cm.quality(mesh).total_area
        # A chord of length l and sag d leaves out 2/3 l d.
        ends = mesh.points[mesh.facets["line"]]
        left_out = np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum() * mesh.domain.deviation * 2 / 3
        assert covered == pytest.approx(area, abs=left_out + 1e-9)
        assert names <= set(mesh.names)


def test_ten_thousand_terms_of_a_chain_mesh() -> None:
    # Boxes that overlap the next one by a fifth, in a hundred rows that do not touch.
    chain = cm.Box((0, 0), (1, 0.8))
    for k in range(1, 10_000):
        x, y = 0.8 * (k % 100), float(k // 100)
        chain = chain | cm.Box((x, y), (x + 1, y + 0.8))
    domain = cm.evaluate(chain)
    mesh = cm.DelaunayRefinement().generate(domain)
    certificate = check(mesh, domain)
    assert certificate.ok, certificate.failures
    assert cm.quality(mesh).total_area == pytest.approx(100 * (99 * 0.8 + 1) * 0.8, rel=1e-12)


@pytest.mark.corpus
@pytest.mark.parametrize("name", CORPORA)
def test_every_shape_of_a_corpus(name: str) -> None:
    shapes, min_angle = CORPORA[name]
    cm.generate(cm.Disk((0, 0), 1))
    verdicts = [judge(label, make, min_angle) for label, make in shapes()]
    assert not [str(v) for v in verdicts if v.is_failure]
    if "glyph" in name:
        assert not [str(v) for v in verdicts if v.outcome != "ok"]

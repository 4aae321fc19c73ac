"""Each rule of the certificate, on meshes small enough to be read."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.domain.curves import Curves
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import InputError
from csgmesh.measures.certificate import RULES, check
from csgmesh.mesh import Mesh

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
LOOP = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])


def broken(certificate) -> set[str]:
    return {failure.rule for failure in certificate.failures}


def square_mesh(**changes) -> Mesh:
    fields = {
        "points": SQUARE,
        "cells": {"triangle": [[0, 1, 2], [0, 2, 3]]},
        "facets": {"line": LOOP},
        "facet_marker": {"line": [0, 1, 2, 3]},
        "boundary_names": [["bottom"], ["right"], ["top"], ["left"]],
        "facet_region": {"line": [[0, -1]] * 4},
    }
    return Mesh(**(fields | changes))


def square_domain() -> Pslg:
    names = {"bottom": [0], "right": [1], "top": [2], "left": [3]}
    return cm.Pslg(SQUARE, LOOP, names=names)


def two_regions() -> tuple[Mesh, Pslg]:
    """A square cut along its diagonal into two regions."""
    facets = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [2, 0]])
    sides = np.array([[0, -1], [0, -1], [1, -1], [1, -1], [0, 1]])
    names = (("outer",), ("seam", "cut"))
    marker = np.array([0, 0, 0, 0, 1])
    domain = Pslg.build(
        points=SQUARE,
        segments=facets,
        segment_marker=marker,
        segment_region=sides,
        boundary_names=names,
        region_names=("below", "above"),
    )
    mesh = Mesh(
        SQUARE,
        {"triangle": [[0, 1, 2], [0, 2, 3]]},
        {"triangle": [0, 1]},
        ("below", "above"),
        {"line": facets},
        {"line": marker},
        names,
        {"line": sides},
    )
    return mesh, domain


def disk(n: int) -> tuple[Mesh, Pslg]:
    """A unit disk as a fan of n triangles, and its domain of four arcs."""
    t = 2 * np.pi * np.arange(n) / n
    rim = np.stack([np.cos(t), np.sin(t)], axis=1)
    after = np.r_[np.arange(1, n), 0]
    zero, one = np.zeros((1, 2)), np.eye(2)
    curves = Curves.arcs(zero, one[:1], one[1:], np.array([0.0]), np.array([2 * np.pi]))
    quarter = np.pi / 2 * np.arange(4)
    domain = Pslg.build(
        points=np.stack([np.cos(quarter), np.sin(quarter)], axis=1),
        segments=LOOP,
        segment_marker=np.zeros(4, int),
        segment_region=np.tile([0, -1], (4, 1)),
        boundary_names=(("rim",),),
        curves=curves,
        segment_curve=np.zeros(4, int),
        segment_interval=np.stack([quarter, quarter + np.pi / 2], axis=1),
        deviation=0.3,
    )
    mesh = Mesh(
        np.concatenate([rim, zero]),
        {"triangle": np.stack([np.arange(n), after, np.full(n, n)], axis=1)},
        facets={"line": np.stack([np.arange(n), after], axis=1)},
        facet_marker={"line": np.zeros(n, int)},
        boundary_names=[["rim"]],
        facet_region={"line": np.tile([0, -1], (n, 1))},
        facet_curve={"line": np.zeros(n, int)},
        facet_interval={"line": np.stack([t, t + 2 * np.pi / n], axis=1)},
        curves=curves,
    )
    return mesh, domain


def test_right_meshes_pass():
    assert check(square_mesh(), square_domain()).ok
    assert check(*two_regions()).ok
    for n in (4, 8, 12, 400):
        assert check(*disk(n)).ok


def test_every_rule_is_listed_under_its_name():
    certificate = check(square_mesh(), square_domain())
    assert [c.rule for c in certificate.checks] == [name for name, _ in RULES]
    spoiled = check(square_mesh(cell_region={"triangle": [0, 9]}), square_domain())
    assert [c.rule for c in spoiled.checks] == [name for name, _ in RULES]


def test_numbers_out_of_range_end_the_check_with_a_failure():
    certificate = check(square_mesh(cell_region={"triangle": [0, 1]}), square_domain())
    assert broken(certificate) == {"indices"}
    assert "cell_region['triangle'] must lie from 0 to 0; row 1 is 1" in str(certificate)
    assert "area" in {c.rule for c in certificate.checks if c.status == "skipped"}


def test_clockwise_and_flat_cells():
    certificate = check(square_mesh(cells={"triangle": [[0, 1, 2], [0, 3, 2]]}))
    failure = certificate["orientation"].failures[0]
    assert failure.what == "cell" and failure.entities == (1,)
    assert failure.place == pytest.approx((1 / 3, 2 / 3))
    flat = np.array([[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]) * 0.1
    assert "orientation" in broken(check(Mesh(flat, {"triangle": [[0, 1, 2]]})))


def test_a_quad_must_be_convex():
    dart = [[0, 0], [4, 0], [1, 1], [0, 4]]
    assert "orientation" in broken(check(Mesh(dart, {"quad": [[0, 1, 2, 3]]})))


def test_a_hanging_vertex_is_found_without_a_domain():
    points = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 1], [1, 2]]
    cells = {"triangle": [[0, 1, 2], [0, 2, 3], [3, 4, 5], [4, 2, 5]]}
    certificate = check(Mesh(points, cells))
    assert "overlap" in broken(certificate)
    assert "2-3" in certificate["overlap"].failures[0].message


def test_meshes_that_lie_over_each_other():
    small = SQUARE * 0.1 + 0.3
    cells = {"triangle": [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]}
    inside = check(Mesh(np.concatenate([SQUARE, small]), cells))
    assert "overlap" in broken(inside)
    across = check(Mesh(np.concatenate([SQUARE, SQUARE + 0.5]), cells))
    assert "overlap" in broken(across)
    beside = check(Mesh(np.concatenate([SQUARE, SQUARE + 5]), cells))
    assert "overlap" not in broken(beside)
    # Two squares that share a corner and nothing else do not overlap.
    corner = np.concatenate([SQUARE, SQUARE[1:] + 1])
    touching = {"triangle": [[0, 1, 2], [0, 2, 3], [2, 4, 5], [2, 5, 6]]}
    assert "overlap" not in broken(check(Mesh(corner, touching)))


def test_a_cell_turned_over_onto_its_neighbour_is_not_conforming():
    cells = {"triangle": [[0, 1, 2], [0, 3, 2], [0, 1, 3]]}
    assert "conforming" in broken(check(Mesh(SQUARE, cells)))


def test_points_twice_and_unused():
    doubled = np.concatenate([SQUARE, SQUARE[2:3]])
    certificate = check(square_mesh(points=doubled), square_domain())
    assert broken(certificate) == {"points"}
    assert len(certificate["points"].failures) == 2


def test_missing_and_wrong_names_are_told_with_both_names():
    certificate = check(square_mesh(facet_marker={"line": [0, 1, 2, 2]}), square_domain())
    assert broken(certificate) == {"names", "facet names"}
    assert certificate["facet names"].failures[0].message == (
        "1 facet has another name than the domain there; the first is facet 3 at (0, 0.5): "
        "'top' where the domain has 'left'"
    )
    unnamed = check(square_mesh(facet_marker={"line": [0, 1, 2, -1]}))
    assert "facet names" in broken(unnamed)


def test_consistently_swapped_names_and_regions_are_seen():
    names = [["top"], ["right"], ["bottom"], ["left"]]
    assert broken(check(square_mesh(boundary_names=names), square_domain())) == {"facet names"}
    mesh, domain = two_regions()
    swapped = replace(mesh, region_names=("above", "below"))
    assert "regions" in broken(check(swapped, domain))


def test_regions_may_be_numbered_otherwise():
    """A file format may sort them; names decide."""
    mesh, domain = two_regions()
    sides = mesh.facet_region["line"]
    renumbered = np.where(sides >= 0, 1 - sides, -1)
    facets = mesh.facets["line"].copy()
    facets[4], renumbered[4] = facets[4][::-1], renumbered[4][::-1]
    other = replace(
        mesh,
        region_names=("above", "below"),
        cell_region={"triangle": [1, 0]},
        facets={"line": facets},
        facet_region={"line": renumbered},
    )
    assert check(other, domain).ok


def test_a_mesh_without_the_interface_facet():
    mesh, domain = two_regions()
    four = {name: {"line": getattr(mesh, name)["line"][:4]} for name in FACET_FIELDS}
    certificate = check(replace(mesh, **four), domain)
    assert {"facets", "coverage", "names"} <= broken(certificate)
    assert "'seam' and 'cut'" in certificate["coverage"].failures[0].message


FACET_FIELDS = ("facets", "facet_marker", "facet_region", "facet_curve", "facet_interval")


def test_vertices_off_their_curve():
    mesh, domain = disk(12)
    points = mesh.points.copy()
    points[4] *= 1 + 1e-10
    wrong = {"on curves", "coverage", "intervals"}
    assert wrong <= broken(check(replace(mesh, points=points), domain))
    without = replace(mesh, points=points, curves=None, facet_curve={})
    assert {"on curves", "coverage"} <= broken(check(without, domain))


def test_a_polygon_is_no_disk_and_a_coarse_one_strays():
    mesh, domain = disk(8)
    certificate = check(mesh, replace_domain(domain, deviation=0.01))
    assert broken(certificate) == {"deviation"}
    straight = replace(mesh, facet_curve={"line": np.full(8, -1)})
    assert broken(check(straight, domain)) == {"intervals"}
    polygon = cm.Pslg(mesh.points[:8], np.c_[np.arange(8), np.r_[1:8, 0]], names={"rim": range(8)})
    assert "intervals" in broken(check(mesh, polygon))
    assert check(replace(mesh, curves=None, facet_curve={}), polygon).ok


def replace_domain(domain: Pslg, **changes) -> Pslg:
    names = (
        *("points", "segments", "segment_curve", "segment_interval", "segment_marker"),
        *("segment_region", "point_marker", "boundary_names", "region_names", "curves"),
        *("deviation", "snap", "report", "oracle"),
    )
    return Pslg.build(**({name: getattr(domain, name) for name in names} | changes))


def test_missing_and_filled_holes():
    plate = cm.Box((0, 0), (4, 2), name="plate")
    pierced = plate - cm.Disk((2, 1), 0.5, name="hole")
    mesh = cm.generate(pierced, size=0.4)
    assert {"on curves", "components and holes", "area"} <= broken(cm.check(mesh, plate))
    filled = cm.generate(plate, size=0.4)
    assert {"coverage", "components and holes", "area", "samples"} <= broken(
        cm.check(filled, pierced)
    )


@pytest.mark.parametrize(
    "change",
    [
        lambda s: s.translate((1e-9, 0)),
        lambda s: s.rotate(180, center=(2, 1)),
        lambda s: s.mirror((2, 1), (1, 0)),
        lambda s: s.scale(1 + 1e-9),
        lambda s: s | cm.Disk((9, 9), 0.5),
        lambda s: s.named("other"),
    ],
)
def test_meshes_of_other_shapes_are_refused(change):
    shape = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
    mesh = cm.generate(shape, size=0.5)
    assert cm.check(mesh, shape).ok
    assert not cm.check(mesh, change(shape)).ok


def test_meshes_of_finer_and_coarser_outlines_are_accepted():
    shape = cm.Disk((0, 0), 1) - cm.Ellipse((0.8, 0), (0.5, 0.2), 30)
    for deviation in (0.02, 1e-5):
        mesh = cm.generate(shape, deviation=deviation)
        reference = cm.evaluate(shape)
        # The shell of the input angle is another one, so a lower bound is asked for.
        certificate = check(mesh, reference, reference.oracle.region, min_angle=20)
        assert certificate.ok, str(certificate)


def test_without_a_domain_it_says_what_it_could_not_check():
    certificate = check(square_mesh())
    assert certificate.ok
    skipped = {c.rule: c.note for c in certificate.checks if c.status == "skipped"}
    assert skipped["area"] == "no domain to compare with; the cells cover 1"
    assert "1 component, 0 holes" in skipped["components and holes"]
    assert {"on curves", "coverage", "regions", "samples"} <= set(skipped)


def test_small_angles_are_refused_but_at_input_angles():
    wedge = cm.Triangle((0, 0), (4, 0), (4, 0.4))
    mesh = cm.generate(wedge, cm.DelaunayRefinement(min_angle=25))
    certificate = check(mesh, cm.evaluate(wedge), min_angle=25)
    assert certificate["smallest angle"].status == "passed"
    assert "excused at input angles" in certificate["smallest angle"].note
    thin = [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.02]]
    cells = {"triangle": [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]}
    spoiled = check(square_mesh(points=thin, cells=cells), square_domain(), min_angle=20)
    assert broken(spoiled) == {"smallest angle"}
    assert "below 20°; the first is cell 0 at (0.5, 0.00666667): 2.291°" in str(spoiled)
    assert check(square_mesh(points=thin, cells=cells, info={"min_angle": 1.0})).ok
    alone = check(square_mesh(points=thin, cells=cells), min_angle=20)["smallest angle"]
    assert alone.status == "skipped" and "1 cell is below 20°" in alone.note


def test_delaunay_is_told_and_fails_only_where_it_was_promised():
    long = SQUARE * [3, 1] + [[0, 0], [1, 0], [0, 0], [0, 0]]
    one = check(Mesh(long, {"triangle": [[0, 1, 2], [0, 2, 3]]}))["Delaunay"]
    other = check(Mesh(long, {"triangle": [[0, 1, 3], [1, 2, 3]]}))["Delaunay"]
    notes = {one.note, other.note}
    assert notes == {"Delaunay; the discrete maximum principle holds", "1 edge is not Delaunay"}
    assert check(Mesh(SQUARE, {"triangle": [[0, 1, 2], [0, 2, 3]]}))["Delaunay"].note == (
        "Delaunay; the discrete maximum principle holds"
    )


def test_json_and_print():
    certificate = check(square_mesh(facet_marker={"line": [0, 1, 2, 2]}), square_domain())
    told = json.loads(certificate.to_json())
    assert told["ok"] is False
    failed = [c for c in told["checks"] if c["status"] == "failed"]
    assert [c["rule"] for c in failed] == ["names", "facet names"]
    assert failed[1]["failures"][0]["entities"] == [3]
    assert "failed   facet names" in str(certificate)
    assert repr(certificate).startswith("<Certificate: 2 failures; ")


def test_solid_meshes_are_refused():
    solid = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], {"tetra": [[0, 1, 2, 3]]})
    with pytest.raises(InputError, match="plane"):
        check(solid)

"""What cannot be evaluated says which leaf, and where."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm


def test_an_open_intersection_of_half_spaces_is_unbounded():
    wedge = cm.HalfSpace((0, 0), (0, -1), name="floor") & cm.HalfSpace((0, 0), (-1, 0))
    with pytest.raises(cm.UnboundedDomainError, match=r"beyond \(.*half space 'floor'"):
        cm.evaluate(wedge)


def test_a_complement_is_unbounded_around_its_leaf():
    with pytest.raises(cm.UnboundedDomainError, match=r"around disk 'hole', as near \("):
        cm.evaluate(~cm.Disk((0, 0), 1, name="hole"))


@pytest.mark.parametrize(
    "shape",
    [
        cm.Box((0, 0), (1, 1), name="a") & cm.Box((2, 2), (3, 3), name="b"),
        cm.Box((0, 0), (1, 1), name="a") - cm.Box((-1, -1), (2, 2), name="b"),
        cm.Box((0, 0), (1, 1), name="a") & cm.Box((1, 0), (2, 1), name="b"),
        cm.Box((0, 0), (1, 1), name="a") - cm.Box((0, 0), (1, 1), name="b"),
    ],
)
def test_an_empty_domain_names_its_leaves(shape):
    with pytest.raises(cm.EmptyDomainError, match=r"empty.*"):
        cm.evaluate(shape)


def test_a_self_crossing_polygon_says_where():
    bow = cm.Polygon([(0, 0), (2, 2), (2, 0), (0, 2)], name="bow")
    with pytest.raises(cm.ShapeError, match=r"polygon 'bow' crosses .* near \(1, 1\)"):
        cm.evaluate(bow)


def test_an_outline_may_cross_itself():
    bow = cm.Outline([[(0, 0), (2, 2), (2, 0), (0, 2)]])
    assert cm.evaluate(bow).areas()[0] == pytest.approx(2.0)


@pytest.mark.parametrize("argument", ["deviation", "snap"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_tolerances_must_be_positive(argument, value):
    with pytest.raises(cm.ShapeError, match=rf"{argument} must be a positive, finite number; got"):
        cm.evaluate(cm.Disk((0, 0), 1), **{argument: value})


def test_an_absurd_deviation_ends_at_once():
    with pytest.raises(cm.ShapeError, match="more than 1e8 chords"):
        cm.evaluate(cm.Disk((0, 0), 1), deviation=1e-30)


@pytest.mark.parametrize("deviation", [1e-3, 1e-6, 1e-9])
def test_a_disk_converges_as_the_chord_bound_says(deviation):
    pslg = cm.evaluate(cm.Disk((0, 0), 1), deviation=deviation)
    assert np.hypot(*pslg.points.T) == pytest.approx(np.ones(pslg.n_points), abs=1e-12)
    middle = pslg.points[pslg.segments].mean(axis=1)
    sagitta = 1 - np.hypot(*middle.T)
    assert 0.5 * deviation <= sagitta.max() <= deviation
    lost = np.pi - pslg.chord_areas()[0]
    # Two thirds of chord times sagitta, summed over the circle.
    assert lost == pytest.approx(2 * np.pi * 2 / 3 * sagitta.max(), rel=0.02)


def test_embedded_paths_are_cut_at_the_boundary_and_named():
    crack = cm.EmbeddedPath([(-1, 0.5), (0.5, 0.5), (0.5, 1.0)], name="crack")
    probe = cm.EmbeddedPoints([(0.25, 0.25), (0.0, 0.0)], name="probe")
    pslg = cm.evaluate(cm.Embed(cm.Box((0, 0), (1, 1), name="box"), [crack, probe]))
    (marker,) = [k for k, names in enumerate(pslg.boundary_names) if names == ("crack",)]
    at = pslg.segment_marker == marker
    ends = pslg.points[pslg.segments[at]]
    assert sorted(map(tuple, ends.reshape(-1, 2).tolist())) == [
        (0.0, 0.5),
        (0.5, 0.5),
        (0.5, 0.5),
        (0.5, 1.0),
    ]
    assert (pslg.segment_region[at] == 0).all()
    named = pslg.points[pslg.point_marker >= 0]
    assert sorted(map(tuple, named.tolist())) == [(0.0, 0.0), (0.25, 0.25)]


def test_an_embedded_point_outside_says_where():
    probe = cm.EmbeddedPoints([(5, 5)], name="probe")
    with pytest.raises(cm.ShapeError, match=r"embedded point \(5, 5\) of 'probe' lies outside"):
        cm.evaluate(cm.Embed(cm.Box((0, 0), (1, 1)), [probe]))


def test_a_path_along_the_boundary_adds_its_name():
    path = cm.EmbeddedPath([(0, 0), (0.5, 0)], name="inlet")
    pslg = cm.evaluate(cm.Embed(cm.Box((0, 0), (1, 1), name="box"), [path]))
    assert ("box.bottom", "inlet") in pslg.boundary_names


def test_three_regions_share_a_point_and_conform():
    regions = cm.Regions(
        {
            "sky": cm.Box((-1, 0), (1, 1)),
            "left": cm.Box((-1, -1), (0, 0)),
            "right": cm.Box((0, -1), (1, 0)),
        }
    )
    pslg = cm.evaluate(regions)
    assert pslg.areas() == pytest.approx([2, 1, 1])
    pairs = {tuple(sorted(sides)) for sides in pslg.segment_region.tolist()}
    assert {(0, 1), (0, 2), (1, 2)} <= pairs


@pytest.mark.parametrize("value", ["0.1", True, float("nan"), 1j, [0.1]])
@pytest.mark.parametrize("argument", ["deviation", "snap"])
def test_tolerances_must_be_numbers(argument, value):
    with pytest.raises(cm.ShapeError, match=f"{argument} must be a positive, finite number; got"):
        cm.evaluate(cm.Disk((0, 0), 1), **{argument: value})


@pytest.mark.parametrize("thing", [None, 5, "plate.yaml", [cm.Disk((0, 0), 1)], cm.Disk])
def test_only_shapes_are_evaluated(thing):
    with pytest.raises(cm.InputError, match="a shape must be a Shape, Regions, Embed, "):
        cm.evaluate(thing)
    with pytest.raises(cm.InputError, match="a shape must be a Shape, Regions, Embed, "):
        cm.generate(thing)


@pytest.mark.parametrize("factor", [1e100, 1e-100])
def test_a_tower_of_scalings_beyond_all_floats_ends(factor):
    shape = cm.Box((0, 0), (1, 1), name="tower")
    for _ in range(4):
        shape = shape.scale(factor)
    for use in (cm.evaluate, lambda s: s.contains([(0.5, 0.5)])):
        with pytest.raises(cm.ShapeError, match="box 'tower': its transformations together must"):
            use(shape)


@pytest.mark.parametrize("points", [[(5, 5), (6, 6)], [(0.4, 0.5), (0.6, 0.5)]])
def test_an_embedded_path_all_outside_says_where(points):
    plate = cm.Box((0, 0), (1, 1)) - cm.Disk((0.5, 0.5), 0.25)
    with pytest.raises(cm.ShapeError, match=r"embedded path 'crack' from \(.*\) lies outside"):
        cm.evaluate(cm.Embed(plate, [cm.EmbeddedPath(points, name="crack")]))


def test_check_and_progress_say_what_they_need():
    disk = cm.Disk((0, 0), 1)
    for wrong in (5, disk):
        with pytest.raises(cm.InputError, match="check needs a Mesh"):
            cm.check(wrong, disk)
    with pytest.raises(cm.InputError, match="progress must be callable"):
        cm.generate(disk, progress=5)

"""Solids evaluate to closed, named boundaries on exact surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import csgmesh as cm

PI = np.pi
BOX = cm.Box((0, 0, 0), (2, 2, 2), name="plate")
BORE = cm.Cylinder((1, 1, -1), (1, 1, 3), 0.5, name="bore")

#: Solid, exact volume, Euler characteristic.
SOLIDS = {
    "box": (BOX, 8.0, 2),
    "ball": (cm.Ball((1, 2, 3), 1), 4 / 3 * PI, 2),
    "ellipsoid": (cm.Ellipsoid((0, 0, 0), (1, 2, 3)), 8 * PI, 2),
    "cylinder": (cm.Cylinder((0, 0, 0), (1, 2, 2), 0.5), 0.75 * PI, 2),
    "cone": (cm.Cone((0, 0, 0), (0, 0, 2), 1), 2 / 3 * PI, 2),
    "frustum": (cm.Cone((0, 0, 0), (0, 3, 0), 2, 1), 7 * PI, 2),
    "torus": (cm.Torus((0, 0, 0), (1, 1, 1), 2, 0.5), PI**2, 0),
    "washer": (cm.Extrude(cm.Disk((0, 0), 2) - cm.Disk((0, 0), 1), 0.5), 1.5 * PI, 0),
    "bowl": (
        cm.Revolve(cm.Disk((0, 2), 2) - cm.Disk((0, 2), 1.5) - cm.HalfSpace((0, 2), (0, -1))),
        2 / 3 * PI * (8 - 1.5**3),
        2,
    ),
    "quarter": (cm.Revolve(cm.Box((0, 0), (1, 1)), 90), PI / 4, 2),
    "half ring": (cm.Revolve(cm.Disk((2, 0), 0.5), 180), PI**2 / 2, 2),
    "bored": (BOX - BORE, 8 - PI / 2, 0),
    "dent": (BOX - cm.Ball((1, 1, 2), 0.5), 8 - PI / 12, 2),
    "cavity": (BOX - cm.Ball((1, 1, 1), 0.5), 8 - PI / 6, 4),
    "half ball": (cm.Ball((0, 0, 0), 1) & cm.HalfSpace((0, 0, 0), (0, 0, 1)), 2 / 3 * PI, 2),
    "Steinmetz": (
        cm.Cylinder((-2, 0, 0), (2, 0, 0), 1) & cm.Cylinder((0, 0, -2), (0, 0, 2), 1),
        16 / 3,
        2,
    ),
    "half-spaces": (
        cm.intersection(
            *(cm.HalfSpace((0, 0, 0), -axis) for axis in np.eye(3)),
            cm.HalfSpace((1, 0, 0), (1, 1, 1)),
        ),
        1 / 6,
        2,
    ),
    "shared face": (BOX | cm.Box((2, 0, 0), (4, 2, 2)), 16.0, 2),
    "part of a face": (BOX | cm.Box((2, 1, 0), (4, 3, 2)), 16.0, 2),
    "coplanar tops": (BOX | cm.Box((1, 1, 0), (3, 3, 2)), 14.0, 2),
    "twice": (BOX | BOX.translate((0, 0, 1e-13)), 8.0, 2),
    "flush": (BOX - cm.Box((0, 0, 0), (1, 1, 2)), 6.0, 2),
    "symmetric difference": (BOX ^ cm.Box((1, 1, 1), (3, 3, 3)), 14.0, None),
    "shared edge": (BOX | cm.Box((2, 2, 0), (4, 4, 2)), 16.0, 3),
    "shared corner": (BOX | cm.Box((2, 2, 2), (4, 4, 4)), 16.0, 3),
    "corner on an edge": (BOX | cm.Box((2, 2, 1), (4, 4, 4)), 20.0, 3),
    "ball on a face, inside": (BOX - cm.Ball((1, 1, 1), 1), 8 - 4 / 3 * PI, -2),
    "ball on a face, outside": (BOX | cm.Ball((1, 1, 3), 1), 8 + 4 / 3 * PI, 3),
    "tangent cylinders": (
        cm.Cylinder((0, 0, 0), (0, 0, 1), 1) | cm.Cylinder((2, 0, 0), (2, 0, 1), 1),
        2 * PI,
        3,
    ),
    "two": (BOX | cm.Ball((9, 0, 0), 1), 8 + 4 / 3 * PI, 4),
}


def is_closed(plc: cm.Plc) -> bool:
    edges = plc.facets[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    forward = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    _, key = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    return not np.bincount(key.ravel(), weights=forward).any()


def off_surface(plc: cm.Plc) -> float:
    corners = plc.points[plc.facets].reshape(-1, 3)
    return float(plc.surfaces.distance(np.repeat(plc.facet_surface, 3), corners).max())


@pytest.mark.parametrize("name", SOLIDS)
def test_volume_topology_and_vertices_on_exact_surfaces(name: str) -> None:
    shape, volume, euler = SOLIDS[name]
    plc = cm.evaluate(shape)
    assert is_closed(plc)
    if euler is not None:
        assert plc.euler_characteristic() == euler
    assert off_surface(plc) < 1e-12 * plc.diagonal
    flat = plc.volumes()[0]
    # A facet is no further from its surface than the deviation, all over the area.
    assert abs(flat - volume) <= plc.deviation * plc.facet_areas().sum() + 1e-12 * volume
    finer = cm.evaluate(shape, deviation=(plc.deviation or 1.0) / 32).volumes()[0]
    assert abs(finer - volume) <= 0.1 * abs(flat - volume) + 1e-12 * volume


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("move", ["turned", "mirrored", "far", "tiny", "sheared"])
def test_volume_wherever_the_solid_is(name: str, move: str) -> None:
    shape, _, euler = SOLIDS[name]
    moved, factor = {
        "turned": (shape.rotate(33, axis=(1, 2, 3)), 1.0),
        "mirrored": (shape.mirror((1, 0, 0), (1, 1, 0)), 1.0),
        "far": (shape.translate((1e7, -1e7, 1e7)), 1.0),
        "tiny": (shape.scale(1e-6), 1e-18),
        "sheared": (shape.transform([(1, 0.5, 0), (0, 1, 0.25), (0, 0, 2)]), 2.0),
    }[move]
    plain, plc = (cm.evaluate(s, deviation=d) for s, d in ((shape, None), (moved, None)))
    assert is_closed(plc)
    if euler is not None:
        assert plc.euler_characteristic() == euler
    slack = plain.deviation * plain.facet_areas().sum() * factor * 4
    assert abs(plc.volumes()[0] - factor * plain.volumes()[0]) <= slack + 1e-7 * factor


def test_facets_lie_on_the_part_they_name() -> None:
    plc = cm.evaluate(BOX - BORE | cm.Ball((0, 0, 2), 0.75, name="knob"))
    centre = plc.points[plc.facets].mean(axis=1)
    marked = {n: centre[[n in plc.boundary_names[m] for m in plc.facet_marker]] for n in plc.names}
    assert set(marked) == {
        *(f"plate.{side}" for side in ("left", "right", "bottom", "top", "front", "back")),
        "bore.side",
        "knob",
    }
    for name, axis, value in (
        ("plate.left", 0, 0),
        ("plate.right", 0, 2),
        ("plate.bottom", 2, 0),
        ("plate.top", 2, 2),
        ("plate.front", 1, 0),
        ("plate.back", 1, 2),
    ):
        np.testing.assert_allclose(marked[name][:, axis], value, atol=1e-12)
    bore = np.hypot(*(marked["bore.side"][:, :2] - 1).T)
    assert np.abs(bore - 0.5).max() <= plc.deviation
    knob = np.sqrt(((marked["knob"] - (0, 0, 2)) ** 2).sum(axis=1))
    assert np.abs(knob - 0.75).max() <= plc.deviation
    assert plc.area("bore") == pytest.approx(2 * PI, rel=5e-3)


def test_a_facet_on_two_parts_has_both_names() -> None:
    tower = cm.Box((0, 0, 0), (1, 1, 3), name="tower")
    plc = cm.evaluate(tower & cm.Box((0, 0, 0), (3, 3, 1), name="slab"))
    assert {"tower.bottom", "slab.bottom"} in [set(names) for names in plc.boundary_names]
    assert {"tower.left", "slab.left"} in [set(names) for names in plc.boundary_names]
    assert ("tower.right",) in plc.boundary_names


def test_feature_edges_are_where_surfaces_meet() -> None:
    plc = cm.evaluate(BOX - BORE)
    edges = plc.points[plc.feature_edges()]
    straight = (np.abs(edges[:, 0] - edges[:, 1]) > 0).sum(axis=1) == 1
    rims = edges[~straight]
    radius = np.hypot(*(rims[:, :, :2].reshape(-1, 2) - 1).T)
    np.testing.assert_allclose(radius, 0.5, atol=1e-14)
    assert len(plc.corners()) == 8
    assert not len(cm.evaluate(cm.Ball((0, 0, 0), 1)).feature_edges())


@pytest.mark.parametrize(
    ("shape", "error", "message"),
    [
        (~cm.Ball((0, 0, 0), 1), cm.UnboundedDomainError, "complement of a bounded solid"),
        (
            cm.HalfSpace((0, 0, 0), (0, 0, 1)) - cm.Ball((0, 0, 0), 1),
            cm.UnboundedDomainError,
            "half-spaces alone do not bound it",
        ),
        (cm.Ball((0, 0, 0), 1) & cm.Ball((3, 0, 0), 1), cm.EmptyDomainError, "empty"),
        (cm.Extrude(cm.HalfSpace((0, 0), (1, 0)), 1), cm.UnboundedDomainError, "extrude"),
    ],
)
def test_what_cannot_be_evaluated(shape, error, message: str) -> None:
    with pytest.raises(error, match=message):
        cm.evaluate(shape)


def test_half_spaces_and_complements_only_need_a_bounded_end() -> None:
    slab = cm.HalfSpace((0, 0, 1), (0, 0, 1)) - cm.HalfSpace((0, 0, 0), (0, 0, 1))
    assert cm.evaluate(slab & BOX).volumes()[0] == pytest.approx(4.0)
    assert cm.evaluate(BOX & ~BORE).volumes()[0] == cm.evaluate(BOX - BORE).volumes()[0]


coordinate = st.floats(-1, 1).map(lambda x: round(x, 2))
point = st.tuples(coordinate, coordinate, coordinate)
length = st.floats(0.3, 1.5).map(lambda x: round(x, 2))
leaf = st.one_of(
    st.builds(lambda p, r: cm.Ball(p, r), point, length),
    st.builds(lambda p, a, b, c: cm.Box(p, np.add(p, (a, b, c))), point, length, length, length),
    st.builds(lambda p, h, r: cm.Cylinder(p, np.add(p, (0, 0, h)), r), point, length, length),
)


def volume(shape: cm.Shape) -> float:
    try:
        plc = cm.evaluate(shape, deviation=0.02)
    except cm.EmptyDomainError:
        return 0.0
    assert is_closed(plc)
    return float(plc.volumes()[0])


@settings(max_examples=25)
@given(leaf, leaf)
def test_volumes_obey_inclusion_and_exclusion(a: cm.Shape, b: cm.Shape) -> None:
    both = volume(a & b)
    # Vertices on common curves move onto both surfaces, by no more than facets deviate.
    slack = 0.02 * 20
    assert volume(a | b) == pytest.approx(volume(a) + volume(b) - both, abs=slack)
    assert volume(a - b) == pytest.approx(volume(a) - both, abs=slack)
    assert volume(a ^ b) == pytest.approx(volume(a | b) - both, abs=slack)


def test_the_same_bytes_every_time() -> None:
    shape = cm.union(cm.Ball((x, 0.3 * x, 0), 0.7) for x in range(4)) - BORE
    first, second = cm.evaluate(shape), cm.evaluate(shape)
    assert first.points.tobytes() == second.points.tobytes()
    assert first.facets.tobytes() == second.facets.tobytes()
    assert first.boundary_names == second.boundary_names


@pytest.mark.parametrize("turn", [0.0, 37.0])
def test_both_ends_of_one_arc_revolved(turn: float) -> None:
    # The disk's arc is met above and below; what lies between on the far side of the axis is none.
    lens = cm.Disk((0, 0), 2, name="rim").rotate(turn) & cm.Box((0, -5), (1, 5), name="cut")
    plc = cm.evaluate(cm.Revolve(lens), deviation=1e-4)
    exact = 4.0 / 3.0 * np.pi * (8.0 - 3.0**1.5)
    assert plc.volumes()[0] == pytest.approx(exact, rel=1e-3)
    radius = np.hypot(*plc.points[:, :2].T)
    assert radius.max() == pytest.approx(1.0, abs=1e-12)
    on_rim = plc.points[
        np.unique(plc.facets[plc.facet_marker == plc.names.index("revolve.side.rim")])
    ]
    np.testing.assert_allclose(np.linalg.norm(on_rim, axis=1), 2.0, atol=1e-12)


def test_an_arc_turned_with_its_hollow_side_outwards() -> None:
    groove = cm.Disk((3, 0.5), 0.4, name="groove")
    plc = cm.evaluate(cm.Revolve(cm.Box((0.5, 0), (2.8, 1)) - groove), deviation=1e-4)
    # Pappus: a rectangle of 2.3 by 1 less a circular segment whose centroid is at `middle`.
    segment = 0.16 * np.arccos(0.5) - 0.2 * np.sqrt(0.12)
    middle = 3.0 - 2.0 / 3.0 * 0.12**1.5 / segment
    exact = np.pi * (2.8**2 - 0.5**2) - 2.0 * np.pi * middle * segment
    assert plc.volumes()[0] == pytest.approx(exact, rel=1e-4)

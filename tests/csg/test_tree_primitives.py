"""Every primitive: membership against an independent computation, boundaries, bounds, refusals."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import csgmesh as cm
from csgmesh.csg.program import compile_shape

RNG = np.random.default_rng(3)
POINTS = RNG.uniform(-4, 4, (4000, 2))
X, Y = POINTS.T


def by_shapely(polygon: shapely.Geometry) -> np.ndarray:
    return shapely.contains_xy(polygon, X, Y)


def turned(degrees: float) -> tuple[np.ndarray, np.ndarray]:
    z = (X + 1j * Y) * np.exp(-1j * np.radians(degrees))
    return z.real, z.imag


CORNERS = np.array([(-3, -3), (3, -2), (1, 0), (3, 3), (0, 1.5), (-2, 3), (-1, 0)])
HOLE = np.array([(-1, -2), (1, -2), (0, -0.5)])
STAR = [(3 * np.cos(a), 3 * np.sin(a)) for a in np.radians(90 + 144 * np.arange(5))]
# make_valid keeps what is enclosed an odd number of times; the middle is enclosed twice.
RAYS = shapely.make_valid(shapely.Polygon(STAR))
WHOLE = shapely.union_all(shapely.polygonize([shapely.node(shapely.LinearRing(STAR))]))

CASES = {
    "box": (cm.Box((-1, -2), (2, 1)), (X >= -1) & (X <= 2) & (Y >= -2) & (Y <= 1)),
    "disk": (cm.Disk((1, 0), 2), np.hypot(X - 1, Y) <= 2),
    "ellipse": (
        cm.Ellipse((0, 0), (3, 1), angle=25),
        (turned(25)[0] / 3) ** 2 + turned(25)[1] ** 2 <= 1,
    ),
    "triangle": (
        cm.Triangle((-3, -3), (0, 3), (3, -1)),
        by_shapely(shapely.Polygon([(-3, -3), (0, 3), (3, -1)])),
    ),
    "regular_polygon": (
        cm.RegularPolygon((0.5, 0), 3, 7),
        by_shapely(
            shapely.Polygon(
                [(0.5 + 3 * np.cos(a), 3 * np.sin(a)) for a in 2 * np.pi * np.arange(7) / 7]
            )
        ),
    ),
    "half_space": (cm.HalfSpace((1, 1), (2, -1)), 2 * (X - 1) - (Y - 1) <= 0),
    "polygon": (cm.Polygon(CORNERS, holes=[HOLE]), by_shapely(shapely.Polygon(CORNERS, [HOLE]))),
    "clockwise polygon": (
        cm.Polygon(CORNERS[::-1], holes=[HOLE[::-1]]),
        by_shapely(shapely.Polygon(CORNERS, [HOLE])),
    ),
    "even-odd star": (cm.Outline([STAR], "evenodd"), by_shapely(RAYS)),
    "non-zero star": (cm.Outline([STAR]), by_shapely(WHOLE)),
    "arcs": (
        cm.Outline(
            [
                [(2, 0), ("arc", (-2, 0), (2, 0))],
                [(0, 1), ("arc", (1, 0), (0, -1)), ("arc", (-1, 0), (0, 1))],
            ]
        ),
        (np.hypot(X, Y) <= 2) & (np.hypot(X, Y) >= 1),
    ),
    "arc on the other side": (
        cm.Outline([[(-2, 0), ("arc", (0, -2), (2, 0)), ("line", (-2, 0))]]),
        (np.hypot(X, Y) <= 2) & (Y <= 0),
    ),
    # y = x²/2 − 2 on [−2, 2] is a quadratic Bézier with its middle control point at y = −4.
    "parabola": (
        cm.Outline([[(-2, 0), ("quadratic", (0, -4), (2, 0))]]),
        (Y <= 0) & (Y >= X * X / 2 - 2) & (np.abs(X) <= 2),
    ),
    # y = x³ on [−1.5, 1.5]: control points by blossoming.
    "cubic": (
        cm.Outline(
            [[(-1.5, -3.375), ("cubic", (-0.5, 3.375), (0.5, -3.375), (1.5, 3.375)), (1.5, -3.375)]]
        ),
        (np.abs(X) <= 1.5) & (Y <= X**3) & (Y >= -3.375),
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_membership(case: str) -> None:
    shape, expected = CASES[case]
    assert np.array_equal(shape.contains(POINTS), expected)


@pytest.mark.parametrize("case", CASES)
def test_boundary_closes_and_bounds_are_tight(case: str) -> None:
    shape, _ = CASES[case]
    if shape.kind == "half_space":
        with pytest.raises(cm.ShapeError, match="unbounded"):
            shape.curves()
        return
    curves, part = shape.curves()
    assert len(part) == len(curves)
    assert part.max() < len(shape.parts)
    # Every end is some piece's start.
    gaps = np.abs(curves.ends()[:, None] - curves.starts()[None]).max(axis=2).min(axis=1)
    assert gaps.max() < 1e-14
    i = np.repeat(np.arange(len(curves)), 200)
    share = np.tile(np.linspace(0, 1, 200), len(curves))
    t = curves.interval[i, 0] + share * (curves.interval[i, 1] - curves.interval[i, 0])
    samples = curves.points(i, t)
    low, high = shape.bounds()
    assert (samples >= low - 1e-12).all()
    assert (samples <= high + 1e-12).all()
    if case not in ("parabola", "cubic"):  # control polygons: not tight
        assert np.abs(samples.min(axis=0) - low).max() < 1e-3
        assert np.abs(samples.max(axis=0) - high).max() < 1e-3


def test_box_parts_are_where_their_names_say() -> None:
    box = cm.Box((0, 0), (4, 2), name="plate")
    curves, part = box.curves()
    middle = 0.5 * (curves.starts() + curves.ends())
    place = {box.parts[p]: tuple(m) for p, m in zip(part, middle.tolist(), strict=True)}
    assert place == {"left": (0, 1), "right": (4, 1), "bottom": (2, 0), "top": (2, 2)}


def test_disk_is_four_quarter_arcs() -> None:
    curves, _ = cm.Disk((1, 2), 3).curves()
    assert curves.interval.tolist() == [[k * np.pi / 2, (k + 1) * np.pi / 2] for k in range(4)]


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=3, max_size=12))
def test_random_outlines_by_crossing_count(ring: list[tuple[int, int]]) -> None:
    corners = np.array(ring, float)
    if (corners == corners[0]).all():
        return
    rng = np.random.default_rng(len(ring))
    points = rng.uniform(-1, 7, (200, 2))
    # Heights on the corners' own: the cases that ray casting gets wrong.
    points[::2, 1] = rng.integers(0, 7, 100)
    points[1::4, 0] = rng.integers(0, 7, 50)
    a, b = corners, np.roll(corners, -1, axis=0)
    distance = shapely.distance(
        shapely.MultiLineString([*zip(a, b, strict=True)]), shapely.points(points)
    )
    side = (b - a)[:, 0] * (points[:, None, 1] - a[:, 1]) - (b - a)[:, 1] * (
        points[:, None, 0] - a[:, 0]
    )
    low = a[:, 1] <= points[:, None, 1]
    up = low & (b[:, 1] > points[:, None, 1]) & (side > 0)
    down = ~low & (b[:, 1] <= points[:, None, 1]) & (side < 0)
    winding = up.sum(axis=1) - down.sum(axis=1)
    clear = distance > 1e-9
    for fill, expected in (("nonzero", winding != 0), ("evenodd", winding % 2)):
        inside = cm.Outline([ring], fill).contains(points)
        assert np.array_equal(inside[clear], expected[clear])


def test_a_large_coastline() -> None:
    angle = np.linspace(0, 2 * np.pi, 60_000, endpoint=False)
    radius = 3 + 0.5 * np.sin(40 * angle) + 1e-4 * RNG.random(len(angle))
    ring = np.column_stack([1e6 + radius * np.cos(angle), radius * np.sin(angle)])
    inside = cm.Polygon(ring).contains(np.add(POINTS, (1e6, 0)))
    polygon = shapely.Polygon(ring)
    shapely.prepare(polygon)
    assert np.array_equal(inside, shapely.contains_xy(polygon, X + 1e6, Y))


def test_a_comb_of_tall_teeth() -> None:
    x = np.arange(20_000.0)
    ring = np.vstack([np.column_stack([x, np.where(x % 2, 1, 0.1)]), [(x[-1], 0), (0, 0)]])
    points = RNG.random((5000, 2)) * (20_000, 1.1)
    polygon = shapely.Polygon(ring)
    shapely.prepare(polygon)
    expected = shapely.contains_xy(polygon, *points.T)
    assert np.array_equal(cm.Polygon(ring).contains(points), expected)


def test_path_arrays_make_outlines() -> None:
    vertices = [(0, 0), (2, 0), (2, 1), (1, 1), (0, 1), (0, 0), (0, 0), (5, 5)]
    outline = cm.Outline.from_path(vertices, [1, 2, 3, 3, 4, 4, 4, 1], name="glyph")
    ((start, *segments),) = outline.contours
    assert start == (0, 0)
    assert [s[0] for s in segments] == ["line", "quadratic", "cubic"]
    assert outline.name == "glyph"
    with pytest.raises(cm.ShapeError, match="give 3 points for each cubic"):
        cm.Outline.from_path([(0, 0), (1, 0), (1, 1)], [1, 4, 4])
    with pytest.raises(cm.ShapeError, match="1, 2, 3, 4 or 79; got 5"):
        cm.Outline.from_path([(0, 0), (1, 0)], [1, 5])


def test_glyphs_of_a_font_match_their_signed_area() -> None:
    # An "o": two contours of opposite orientation, quadratic, as TrueType fonts have them.
    def ring(radius: float, sign: int) -> list:
        turns = np.radians(45 * np.arange(17)) * sign
        far = radius / np.cos(np.radians(22.5))
        corners = [((radius, radius)[k % 2], t) for k, t in enumerate(turns)]
        xy = [(r * np.cos(t), r * np.sin(t)) for r, t in corners]
        middles = [(far * np.cos(t), far * np.sin(t)) for t in turns[:-1] + sign * np.radians(22.5)]
        return [xy[0], *[("quadratic", m, p) for m, p in zip(middles[:8], xy[1:9], strict=True)]]

    glyph = cm.Outline([ring(3, 1), ring(2, -1)])
    radius = np.hypot(X, Y)
    clear = (np.abs(radius - 3) > 0.02) & (np.abs(radius - 2) > 0.02)
    assert np.array_equal(glyph.contains(POINTS)[clear], ((radius < 3) & (radius > 2))[clear])


REFUSED = [
    (lambda: cm.Disk((0, 0), 0), "Disk: radius must be positive; got 0.0"),
    (lambda: cm.Disk((0, 0), -1, name="hole"), "Disk 'hole': radius must be positive; got -1.0"),
    (lambda: cm.Disk((0, 0), float("nan")), "radius must be finite; got nan"),
    (lambda: cm.Disk((0, float("inf")), 1), "each coordinate of center must be finite; got inf"),
    (lambda: cm.Disk((0, 0, 0), 1), "center must have 2 coordinates"),
    (lambda: cm.Disk("ab", 1), "center must be a point"),
    (lambda: cm.Disk(3, 1), "center must be a point"),
    (lambda: cm.Disk((0, 0), "1"), "radius must be a number; got '1'"),
    (lambda: cm.Disk((0, 0), True), "radius must be a number; got True"),
    (lambda: cm.Disk((0, 0), 1e200), "must not exceed 1e\\+100"),
    (lambda: cm.Disk((0, 0), 1, name=""), "must not be empty"),
    (lambda: cm.Disk((0, 0), 1, name=" a"), "blank-padded"),
    (lambda: cm.Disk((0, 0), 1, name="a..b"), "empty"),
    (lambda: cm.Disk((0, 0), 1, name="a*"), "'a\\*' with \\*"),
    (lambda: cm.Disk((0, 0), 1, name="a\n"), "control character"),
    (lambda: cm.Disk((0, 0), 1, name=7), "must be a string; got 7"),
    (lambda: cm.Disk((0, 0), 1).named("x?"), "named: a name must not contain"),
    (lambda: cm.Ellipse((0, 0), (1, 0)), "each of semi_axes must be positive"),
    (lambda: cm.Ellipse((0, 0), 1), "semi_axes must be a point"),
    (lambda: cm.Box((0, 0), (1, 0)), "lo must be below hi"),
    (lambda: cm.Box((2, 0), (1, 1)), "lo must be below hi"),
    (lambda: cm.Box((0, 0), (1, 1, 1)), "hi must have 2 coordinates"),
    (lambda: cm.HalfSpace((0, 0), (0, 0)), "normal must not be zero"),
    (lambda: cm.Triangle((0, 0), (1, 1), (2, 2)), "corners must enclose an area"),
    (lambda: cm.RegularPolygon((0, 0), 1, 2), "whole number, at least 3; got 2"),
    (lambda: cm.RegularPolygon((0, 0), 1, 3.5), "whole number"),
    (lambda: cm.Polygon([(0, 0), (1, 0)]), "at least 3 points; got 2"),
    (lambda: cm.Polygon([(0, 0), (1, 0), (1, 0), (0, 0)]), "3 or more different points"),
    (lambda: cm.Polygon([(0, 0), (0.1, 0.3), (0.2, 0.6)]), "lie on the line"),
    (lambda: cm.Polygon([(0, 0), (1, 0), (np.nan, 1)]), "point 2 is"),
    (lambda: cm.Polygon([(0, 0, 0), (1, 0, 0), (0, 1, 0)]), "shape \\(3, 3\\)"),
    (lambda: cm.Polygon([(0, 0), (1, 0), "x"]), "array of numbers"),
    (lambda: cm.Polygon(CORNERS, holes=[[(0, 0)]]), "hole 0 must hold"),
    (lambda: cm.Polygon(CORNERS, holes=[HOLE + 20]).curves(), "hole 0 must lie inside"),
    (
        lambda: cm.Polygon(CORNERS, holes=[HOLE, HOLE * 0.9]).curves(),
        "outside its other holes",
    ),
    (lambda: cm.Outline([]), "at least one contour"),
    (lambda: cm.Outline([[(0, 0)]]), "contour 0 must have a start point and segments"),
    (lambda: cm.Outline([[(0, 0), ("spline", (1, 1))]]), "must be one of 'line'"),
    (lambda: cm.Outline([[(0, 0), ("arc", (1, 1))]]), "takes 2 point"),
    (lambda: cm.Outline([[(0, 0), (0, 0)]]), "must have an extent"),
    (lambda: cm.Outline([[(0, 0), (1, 0), (0, 1)]], fill="odd"), "fill must be"),
    (lambda: cm.Disk((0, 0), 1).scale(0), "no factor may be zero"),
    (lambda: cm.Disk((0, 0), 1).scale((1, 2, 3)), "must have 2 coordinates"),
    (lambda: cm.Disk((0, 0), 1).rotate(float("inf")), "angle must be finite"),
    (lambda: cm.Disk((0, 0), 1).rotate(9, axis=(0, 0, 1)), "axis belongs to space"),
    (lambda: cm.Disk((0, 0), 1).mirror((0, 0), (0, 0)), "normal must not be zero"),
    (lambda: cm.Disk((0, 0), 1).transform([(1, 2), (2, 4)]), "must be invertible"),
    (lambda: cm.Disk((0, 0), 1).contains([(0, 0, 0)]), "\\(n, 2\\) array"),
    (lambda: cm.Disk((0, 0), 1).contains([(0, np.nan)]), "points must be finite"),
    (lambda: cm.union([]), "at least one shape"),
    (lambda: cm.union(3), "shapes or an iterable"),
    (lambda: cm.union(cm.Disk((0, 0), 1), 3), "operand 1 must be a shape; got 3"),
    (lambda: cm.Regions({}), "at least one region"),
    (lambda: cm.Regions({"a": 3}), "region 'a' must be a shape"),
    (lambda: cm.Regions({"a*": cm.Disk((0, 0), 1)}), "must not contain"),
    (lambda: cm.Embed(3, []), "shape or Regions is needed"),
    (lambda: cm.Embed(cm.Disk((0, 0), 1), [(0, 0)]), "item 0 must be"),
    (lambda: cm.EmbeddedPath([(0, 0)], name="crack"), "'crack': points must hold at least 2"),
    (lambda: cm.EmbeddedPath([(0, 0), (0, 0)]), "must have a length"),
]


@pytest.mark.parametrize(("made", "message"), REFUSED)
def test_refused_with_rule_value_and_place(made, message: str) -> None:
    with pytest.raises(cm.ShapeError, match=message):
        made()


def test_operators_refuse_what_is_no_shape() -> None:
    with pytest.raises(TypeError):
        cm.Disk((0, 0), 1) | 3  # type: ignore[operator]


@pytest.mark.parametrize("scale", [1e-9, 1, 1e9])
def test_membership_at_any_scale_and_offset(scale: float) -> None:
    placed = (cm.Box((-2, -1), (2, 1)) - cm.Disk((0, 0), 0.5)).rotate(17).scale(scale)
    z = (X + 1j * Y) * np.exp(1j * np.radians(17)) * scale
    inside = (np.abs(X) <= 2) & (np.abs(Y) <= 1) & (np.hypot(X, Y) >= 0.5)
    points = np.column_stack([z.real, z.imag])
    assert np.array_equal(placed.contains(points), inside)
    (leaf,) = compile_shape(cm.Disk((0, 0), 1).scale(scale).translate((1e9, 0))).leaves
    assert leaf.bounds()[0][0] == pytest.approx(1e9 - scale)

"""Quadtree: what it promises, on shapes whose features no tree knows of."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import csgmesh as cm
from csgmesh.errors import BudgetError, InputError

BOX = cm.Box((0, 0), (2, 1), name="plate")
SHAPES = {
    "square": (cm.Box((0, 0), (1, 1)), 0.1),
    "disk": (cm.Disk((0, 0), 1), 0.1),
    "plate": (BOX - cm.Disk((1, 0.5), 0.25, name="hole"), {"hole": 0.03, "default": 0.2}),
    "ring": (cm.Disk((0, 0), 1) - cm.Disk((0, 0), 0.9), 0.2),
    "corner of 45 degrees": (cm.Polygon([(0, 0), (2, 0), (2, 2)]), 0.15),
    "wedge of 14 degrees": (cm.Polygon([(0, 0), (2, 0), (2, 0.5)]), 0.1),
    "lens": (cm.Disk((0, 0), 1) & cm.Disk((1.2, 0), 1), 0.1),
    "cusp": (cm.Disk((0, 0), 1) - cm.Disk((0.5, 0), 0.5), 0.1),
    "regions sharing an arc": (
        cm.Regions({"rock": BOX, "core": cm.Disk((1, 1), 0.6) & BOX}),
        {"core": 0.05, "default": 0.2},
    ),
    "crack and probe": (
        cm.Embed(
            BOX,
            [
                cm.EmbeddedPath([(0.3, 0.3), (1.1, 0.62), (1.2, 0.3)], name="crack"),
                cm.EmbeddedPoints([(1.6, 0.41)], name="probe"),
            ],
        ),
        0.12,
    ),
    "graded 1:100": (BOX, lambda p: 0.002 + 0.2 * np.hypot(p[:, 0] - 0.7, p[:, 1] - 0.4)),
    "no size": (BOX - cm.Disk((1, 0.5), 0.25), None),
    "far away": (cm.Disk((1e6, -1e6), 1), 0.2),
}


def mesher(**options):
    return cm.Quadtree(max_points=200_000, **options)


@pytest.mark.parametrize("label", SHAPES)
def test_triangles_pass_the_certificate_and_are_few(label):
    shape, size = SHAPES[label]
    mesh = cm.generate(shape, mesher(), size)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, certificate.failures
    assert mesh.info["min_angle"] == 18.4
    plain = cm.generate(shape, cm.DelaunayRefinement(), size)
    assert mesh.n_cells <= 3 * plain.n_cells
    assert mesh.names == plain.names


def test_without_sharp_corners_angles_are_half_right_angles_nearly():
    for label in ("square", "disk", "plate", "ring", "regions sharing an arc", "graded 1:100"):
        mesh = cm.generate(SHAPES[label][0], mesher(), SHAPES[label][1])
        assert cm.quality(mesh).min_angle.min() >= 26, label


def test_improvement_reaches_28_degrees():
    for label in ("square", "disk", "plate", "ring", "regions sharing an arc"):
        mesh = cm.generate(SHAPES[label][0], mesher(improve=True), SHAPES[label][1])
        assert cm.quality(mesh).min_angle.min() >= 28, label
        assert cm.check(mesh, SHAPES[label][0]).ok


def test_the_inside_is_right_angled_and_edges_follow_the_size():
    mesh = cm.generate(cm.Disk((0, 0), 1), mesher(), 0.05)
    angle = cm.quality(mesh).min_angle
    assert np.mean(np.abs(angle - 45) < 3) > 0.8
    corner = mesh.points[mesh.cells["triangle"]]
    length = np.hypot(*np.moveaxis(np.roll(corner, 1, axis=1) - corner, 2, 0))
    assert 0.02 <= length.min() <= length.max() <= 0.12
    assert np.mean((length >= 0.03) & (length <= 0.08)) > 0.98


def test_no_delaunay_mesher_is_called(monkeypatch):
    def refuse(*_):
        raise AssertionError("called")

    for other in (cm.DelaunayRefinement, cm.ConstrainedDelaunay):
        monkeypatch.setattr(other, "generate", refuse)
    assert cm.generate(BOX - cm.Disk((1, 0.5), 0.25), mesher(), 0.1).n_cells > 100


def test_the_same_input_gives_the_same_bytes():
    shape, size = SHAPES["plate"]
    assert cm.generate(shape, mesher(), size).equals(cm.generate(shape, mesher(), size))


def test_curves_that_bulge_out_of_the_box_of_their_chords():
    mesh = cm.generate(cm.Disk((0, 0), 1), cm.Quadtree(), 0.0085)
    assert cm.quality(mesh).min_angle.min() >= 26
    assert cm.check(mesh).ok


def test_gradation_bounds_the_growth():
    shape, size = SHAPES["graded 1:100"]
    steep, gentle = (cm.generate(shape, mesher(gradation=g), size) for g in (0.5, 0.1))
    assert gentle.n_cells > 1.2 * steep.n_cells


def test_a_budget_ends_it_with_a_place():
    with pytest.raises(BudgetError, match=r"more than 1,000 leaves .* at \("):
        cm.generate(BOX, cm.Quadtree(max_points=1000), 0.01)
    ring = cm.Disk((0, 0), 1) - cm.Disk((0, 0), 1 - 1e-6)
    with pytest.raises(BudgetError, match="leaves of the tree"):
        cm.generate(ring, cm.Quadtree(max_points=20_000))


def test_wrong_options_are_errors():
    with pytest.raises(InputError, match=r"cells must be one of .*'triangles'"):
        cm.Quadtree(cells="triangles")
    with pytest.raises(InputError, match="gradation must be positive"):
        cm.Quadtree(gradation=0)
    with pytest.raises(InputError, match="gradation must be positive and finite; got 'steep'"):
        cm.Quadtree(gradation="steep")
    with pytest.raises(InputError, match=r"max_points must be a whole number.*got 2\.5"):
        cm.Quadtree(max_points=2.5)
    with pytest.raises(InputError, match="improve must be True or False"):
        cm.Quadtree(improve=1)


@pytest.mark.parametrize("cells", ["mixed", "quad"])
@pytest.mark.parametrize("label", SHAPES)
def test_quads_pass_the_certificate(label, cells):
    shape, size = SHAPES[label]
    mesh = cm.generate(shape, mesher(cells=cells), size)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, certificate.failures
    assert mesh.names == cm.generate(shape, mesher(), size).names
    if cells == "quad":
        assert list(mesh.cells) == ["quad"]
        assert (cm.quality(mesh).scaled_jacobian > 0).all()


def irregular(mesh):
    """Share of the inner vertices that do not have four quads."""
    count = np.bincount(mesh.cells["quad"].ravel(), minlength=mesh.n_points)
    inner = np.ones(mesh.n_points, bool)
    inner[mesh.facets["line"]] = False
    return np.mean(count[inner] != 4)


def test_uniform_quads_are_a_grid_but_near_curves():
    square = cm.generate(cm.Box((0, 0), (1, 1)), mesher(cells="quad"), 0.05)
    assert irregular(square) == 0
    assert cm.quality(square).sicn.min() > 1 - 1e-9
    disk = cm.generate(cm.Disk((0, 0), 1), mesher(cells="quad"), 0.02)
    assert irregular(disk) < 0.05
    assert cm.quality(disk).sicn.mean() >= 0.97


def test_mixed_cells_are_triangles_near_curves_alone():
    mesh = cm.generate(cm.Disk((0, 0), 1), mesher(cells="mixed"), 0.05)
    assert len(mesh.cells["quad"]) > 10 * len(mesh.cells["triangle"])
    centre = mesh.points[mesh.cells["triangle"]].mean(axis=1)
    assert np.hypot(*centre.T).min() > 0.85


def test_sharp_quads_are_listed():
    shape, size = SHAPES["wedge of 14 degrees"]
    assert cm.generate(shape, mesher(cells="quad"), size).info["excused"] == 1
    assert cm.generate(BOX, mesher(cells="quad"), 0.2).info["excused"] == 0


def test_a_domain_file_asks_for_quads(tmp_path):
    text = "{csgmesh: 1, domain: {disk: {center: [0, 0], radius: 1}}, mesh: {quadtree: {cells: %s}, size: 0.2}}"  # noqa: E501
    good, bad = tmp_path / "quads.yaml", tmp_path / "bad.yaml"
    good.write_text(text % "quad")
    assert list(cm.load(good).generate().cells) == ["quad"]
    bad.write_text(text % "hexagon")
    with pytest.raises(cm.DomainFileError, match=r"bad.yaml:1.*cells"):
        cm.load(bad)


numbers = st.floats(0.1, 1.5)
places = st.tuples(st.floats(-1, 1), st.floats(-1, 1))
leaves = st.one_of(
    st.builds(cm.Disk, places, numbers),
    st.builds(lambda p, w, h, a: cm.Box(p, (p[0] + w, p[1] + h)).rotate(a), places, numbers,
              numbers, st.sampled_from([0, 0, 30, 45])),
    st.builds(cm.RegularPolygon, places, numbers, st.integers(3, 7)),
)  # fmt: skip
trees = st.recursive(
    leaves,
    lambda s: st.one_of(st.builds(lambda a, b: a | b, s, s), st.builds(lambda a, b: a - b, s, s)),
    max_leaves=4,
)


@settings(max_examples=25)
@given(trees, st.sampled_from([None, 0.2]), st.sampled_from(["triangle", "mixed", "quad"]))
def test_random_trees_pass_the_certificate(shape, size, cells):
    try:
        domain = cm.evaluate(shape)
        mesh = cm.generate(domain, mesher(cells=cells), size)
    except (cm.EvaluationError, BudgetError):
        return
    certificate = cm.check(mesh, domain)
    assert certificate.ok, (shape, certificate.failures)


@pytest.mark.parametrize("cells", ["triangle", "mixed", "quad"])
@pytest.mark.parametrize("wall", ["wall.bottom", "body"])
def test_boundary_layers_under_a_quadtree(cells: str, wall: str) -> None:
    shape = cm.Box((0, 0), (4, 1), name="wall") - cm.Disk((1, 0.5), 0.2, name="body")
    layers = {wall: cm.Layers(first=0.01, growth=1.3, n=4)}
    mesh = cm.generate(shape, cm.Quadtree(cells=cells, layers=layers), size=0.15)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, certificate
    # The first layer is as thin as asked for: its vertices lie 0.01 off the wall.
    x, y = mesh.points.T
    off = y if wall == "wall.bottom" else np.hypot(x - 1, y - 0.5) - 0.2
    off = off[(np.abs(x - 1) < 0.5) & (off > 1e-9)]
    if cells == "quad" and wall == "body":
        # Halves of the layers' outer edges lie on chords: nearer by the sag, and by no more.
        edge = np.pi * 0.21 / len(mesh.boundary("body")["line"])
        assert 0.01 - edge**2 / (2 * 0.21) <= off.min() <= 0.01 + 1e-9
    else:
        assert off.min() == pytest.approx(0.01, rel=1e-6)
    if cells == "quad":
        assert list(mesh.cells) == ["quad"]

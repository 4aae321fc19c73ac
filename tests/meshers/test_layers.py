"""Boundary layers: heights as asked for, fans, ends, gaps, exact walls."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.errors import DomainFileError, InputError

CHANNEL = cm.Box((0, 0), (3, 1), name="c")
CYLINDER = CHANNEL - cm.Disk((1, 0.5), 0.2, name="cyl")
FOIL = cm.Box((0, 0), (2, 1), name="a") - cm.Box((0.6, 0.45), (1.4, 0.55), name="foil")
EIGHT = cm.Layers(first=0.004, growth=1.3, n=8)


def meshed(shape, layers, size=0.08, **options) -> cm.Mesh:
    mesh = cm.generate(shape, cm.DelaunayRefinement(layers=layers, **options), size=size)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, str(certificate)
    return mesh


SHAPES = {
    "channel": (CHANNEL, {"c.bottom": EIGHT, "c.top": EIGHT}),
    "corner": (CHANNEL, {"c.bottom": EIGHT, "c.left": EIGHT}),
    "cylinder": (CYLINDER, {"cyl": EIGHT}),
    "all round": (CYLINDER, {"c": EIGHT, "cyl": EIGHT}),
    "convex corners": (FOIL, {"foil": EIGHT}),
    "half a disk": (
        cm.Disk((0, 0), 1, name="rim") & cm.HalfSpace((0, 0), (0, -1), name="flat"), {"rim": EIGHT},
    ),
    "blunt and sharp corners": (
        cm.Polygon([(0, 0), (1, 0), (2, 0.3), (1.2, 1), (0, 1)], name="p"), {"p": EIGHT},
    ),
    "ends on a smooth boundary": (
        cm.Pslg(
            [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)], [(k, (k + 1) % 5) for k in range(5)],
            names={"wall": [1], "rest": [0, 2, 3, 4]},
        ),
        {"wall": EIGHT},
    ),
    "slides on a curve": (
        cm.Box((0, 0), (2, 1), name="b") - cm.Disk((2, 0), 0.5, name="bump"), {"b.bottom": EIGHT},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SHAPES)
def test_shapes(name: str) -> None:
    shape, layers = SHAPES[name]
    mesh = meshed(shape, layers)
    assert mesh.info["n_layer_cells"] >= 8 * 5
    assert len(mesh.cells["quad"]) >= 8 * 5
    assert (cm.quality(mesh).area > 0).all()
    assert mesh.names == cm.generate(shape, size=0.3).names


def test_heights_are_as_asked_for() -> None:
    mesh = meshed(CHANNEL, {"c.bottom": EIGHT})
    x, y = mesh.points.T
    column = np.sort(y[np.abs(x - x[np.argmin(np.abs(x - 1.5) + 10 * y)]) < 1e-12])[:9]
    assert column == pytest.approx(EIGHT.heights(), abs=1e-12)
    # The layers slide on the inlet, whose facets they cut.
    inlet = np.sort(mesh.points[mesh.boundary_points("c.left"), 1])[:9]
    assert inlet == pytest.approx(EIGHT.heights(), abs=1e-12)


def test_walls_stay_exact() -> None:
    mesh = meshed(CYLINDER, {"cyl": EIGHT})
    wall = mesh.boundary_points("cyl")
    assert np.hypot(*(mesh.points[wall] - (1, 0.5)).T) == pytest.approx(0.2, abs=1e-15)
    tops = np.hypot(*(mesh.points[np.unique(mesh.cells["quad"])] - (1, 0.5)).T) - 0.2
    assert tops.max() == pytest.approx(EIGHT.heights()[-1], rel=0.01)


def test_fans_at_convex_corners() -> None:
    mesh = meshed(FOIL, {"foil": EIGHT})
    corner = np.flatnonzero((mesh.points == (1.4, 0.55)).all(axis=1))[0]
    # Lowest layer: triangles that share the corner.
    assert (mesh.cells["triangle"] == corner).any(axis=1).sum() >= 3


def test_layers_shrink_in_narrow_gaps() -> None:
    gap = 0.02
    shape = cm.Box((0, 0), (2, 1)) - cm.Disk((0.7, 0.5), 0.25, name="d")
    shape -= cm.Disk((1.2 + gap, 0.5), 0.25, name="e")
    layers = cm.Layers(first=0.01, growth=1.2, n=6)
    mesh = meshed(shape, {"d": layers, "e": layers}, size=0.06)
    used = mesh.points[np.unique(mesh.cells["quad"])]
    high = np.hypot(*(used - (0.7, 0.5)).T) - 0.25
    own = used[:, 0] < 0.95 + gap / 2
    facing = own & (np.abs(used[:, 1] - 0.5) < 0.01) & (used[:, 0] > 0.9)
    assert 0 < high[facing].max() <= 0.36 * gap
    away = own & (used[:, 0] < 0.6)
    assert high[away].max() == pytest.approx(layers.heights()[-1], rel=0.02)


def test_triangles() -> None:
    split = cm.Layers(first=0.004, growth=1.3, n=8, cells="triangle")
    mesh = meshed(CYLINDER, {"cyl": split})
    assert list(mesh.cells) == ["triangle"]


def test_regions_and_embedded_points_outside_the_layers() -> None:
    shape = cm.Regions({"air": CHANNEL, "core": cm.Disk((1.5, 0.5), 0.2, name="bond")})
    mesh = meshed(shape, {"c.bottom": EIGHT})
    assert set(np.unique(mesh.cell_region["quad"])) == {0}
    embedded = cm.Embed(CHANNEL, [cm.EmbeddedPoints([(1.5, 0.5)], name="probe")])
    mesh = meshed(embedded, {"c.bottom": EIGHT})
    assert (mesh.points[mesh.boundary_points("probe")] == (1.5, 0.5)).all()


def test_an_interface_that_ends_on_the_wall_is_slid_on_from_both_sides() -> None:
    left, right = cm.Box((0, 0), (1, 1), name="l"), cm.Box((1, 0), (2, 1), name="r")
    shape = cm.Regions({"left": left, "right": right})
    mesh = meshed(shape, {"l.bottom": EIGHT, "r.bottom": EIGHT})
    rows = mesh.interface("left", "right")["line"]
    y = np.sort(np.unique(mesh.points[mesh.facets["line"][rows], 1]))[:9]
    assert y == pytest.approx(EIGHT.heights(), abs=1e-12)


def test_errors() -> None:
    with pytest.raises(InputError, match="first must be a positive height; got 0"):
        cm.Layers(first=0)
    with pytest.raises(InputError, match="growth must be at least 1"):
        cm.Layers(first=0.1, growth=0.5)
    with pytest.raises(InputError, match="must be Layers"):
        cm.DelaunayRefinement(layers={"wall": 0.1})
    with pytest.raises(InputError, match="equally many layers"):
        cm.DelaunayRefinement(layers={"a": EIGHT, "b": cm.Layers(0.1)})
    with pytest.raises(InputError, match="no boundary matches 'wall'"):
        meshed(CHANNEL, {"wall": EIGHT})
    bond = cm.Regions({"air": CHANNEL, "core": cm.Disk((1.5, 0.5), 0.2, name="bond")})
    with pytest.raises(InputError, match=r"'bond' .* lies between two regions"):
        meshed(bond, {"bond": EIGHT})


def test_domain_file(tmp_path) -> None:
    text = """
csgmesh: 1
shapes: {c: {box: {lo: [0, 0], hi: [2, 1]}}}
domain: c
mesh:
  delaunay_refinement:
    layers:
      c.bottom: {first: 0.01, n: 4}
  size: 0.2
"""
    path = tmp_path / "a.yaml"
    path.write_text(text)
    assert len(cm.load(path).generate().cells["quad"]) == 40
    for old, new, place in (
        ("first: 0.01", "first: -1", "a.yaml:8:25"),
        ("n: 4", "m: 4", "a.yaml:8:31"),
        ("c.bottom:", "c.botom:", "a.yaml:8:7"),
    ):
        path.write_text(text.replace(old, new))
        with pytest.raises(DomainFileError, match=place):
            cm.load(path).generate()

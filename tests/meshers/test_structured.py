"""Structured grids of every kind of domain they know, and what they say of the others."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import csgmesh as cm
from csgmesh.errors import BudgetError, DomainFileError, InputError, MeshingError
from csgmesh.mesh.blocks import Block

SQUARE = cm.Box((0, 0), (1, 1), name="plate")
QUARTER = (
    (cm.Disk((0, 0), 2, name="outer") - cm.Disk((0, 0), 1, name="inner"))
    & cm.HalfSpace((0, 0), (-1, 0), name="left")
    & cm.HalfSpace((0, 0), (0, -1), name="bottom")
)
NINE = [cm.Disk((i + 0.5, j + 0.5), 0.25) for i in range(3) for j in range(3)]

#: Domain, size, number of blocks, smallest scaled Jacobian that it must reach.
KNOWN = {
    "box": (SQUARE, 0.1, 1, 1 - 1e-12),
    "rotated box": (cm.Box((0, 0), (2, 1)).rotate(30), 0.1, 1, 1 - 1e-9),
    "box of two regions": (
        cm.Regions({"a": cm.Box((0, 0), (2, 1)), "b": cm.Box((0, 0), (1, 1))}), 0.1, 2, 1 - 1e-12,
    ),
    "L": (cm.Box((0, 0), (2, 2)) - cm.Box((1, 1), (3, 3)), 0.1, 3, 1 - 1e-12),
    "box with a box hole": (cm.Box((0, 0), (3, 3)) - cm.Box((1, 1), (2, 1.7)), 0.2, 8, 1 - 1e-12),
    "disk": (cm.Disk((3, -2), 1), 0.1, 5, 0.8),
    "ellipse": (cm.Ellipse((0, 0), (2, 1), angle=20), 0.1, 5, 0.5),
    "annulus": (cm.Disk((0, 0), 1) - cm.Disk((0, 0), 0.4), 0.1, 1, 0.99),
    "eccentric annulus": (cm.Disk((0, 0), 1) - cm.Disk((0.2, 0.1), 0.4), 0.1, 1, 0.85),
    "quarter of a ring": (QUARTER, 0.1, 1, 1 - 1e-3),
    "disk minus box": (cm.Disk((0, 0), 2) - cm.Box((-0.5, -0.5), (0.5, 0.5)), 0.2, 4, 0.7),
    "square minus disk": (SQUARE - cm.Disk((0.5, 0.5), 0.2), 0.05, 4, 0.7),
    "off centre, rotated": (
        (cm.Box((0, 0), (2, 1)) - cm.Disk((0.5, 0.6), 0.2)).rotate(20), 0.05, 5, 0.5,
    ),
    "box minus ellipse": (
        cm.Box((0, 0), (2, 1)) - cm.Ellipse((0.9, 0.5), (0.4, 0.2), angle=30), 0.05, 5, 0.4,
    ),
    "two disks": (SQUARE - cm.Disk((0.3, 0.3), 0.12) - cm.Disk((0.7, 0.7), 0.15), 0.05, 10, 0.45),
    "nine disks": (cm.difference(cm.Box((0, 0), (3, 3)), *NINE), 0.12, 36, 0.7),
    "inclusion": (
        cm.Regions({"rock": SQUARE, "core": cm.Disk((0.4, 0.5), 0.2, name="bond")}), 0.05, 9, 0.6,
    ),
    "three rings": (
        cm.Regions({"a": cm.Disk((0, 0), 3), "b": cm.Disk((0, 0), 2), "c": cm.Disk((0, 0), 1)}),
        0.2, 13, 0.8,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", KNOWN)
def test_known_domains(name: str) -> None:
    shape, size, n_blocks, worst = KNOWN[name]
    mesh = cm.generate(shape, cm.Structured(), size=size)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, str(certificate)
    assert certificate["blocks"].status == "passed"
    assert list(mesh.cells) == ["quad"]
    assert len(mesh.blocks) == n_blocks
    quality = cm.quality(mesh)
    assert quality.scaled_jacobian.min() >= worst
    # Opposite sides have as many cells as the finer of them asks for, so edges are seldom longer.
    assert np.quantile(quality.max_edge, 0.9) < 1.6 * size


def test_regions_and_names_are_those_of_the_delaunay_mesh() -> None:
    shape = KNOWN["inclusion"][0]
    grid = cm.generate(shape, cm.Structured(), size=0.1)
    other = cm.generate(shape, size=0.1)
    assert grid.names == other.names
    assert grid.region_names == other.region_names
    assert set(np.unique(grid.cell_region["quad"])) == {0, 1}
    assert len(grid.interface("rock", "core")["line"]) >= 16


def test_blocks_number_points_and_cells_for_finite_differences() -> None:
    mesh = cm.generate(cm.Box((0, 0), (2, 1)), cm.Structured(), size=0.1)
    block = mesh.blocks["domain"]
    assert block.cells.shape == (20, 10)
    x, y = np.moveaxis(mesh.points[block.points], 2, 0)
    assert np.allclose(x, np.linspace(0, 2, 21)[:, None], atol=1e-14)
    assert np.allclose(y, np.linspace(0, 1, 11), atol=1e-14)
    u = np.zeros(mesh.n_points)
    u[block.points] = x**2 - y**2
    inner = u[block.points]
    laplacian = inner[2:, 1:-1] + inner[:-2, 1:-1] + inner[1:-1, 2:] + inner[1:-1, :-2]
    assert np.allclose(laplacian - 4 * inner[1:-1, 1:-1], 0, atol=1e-12)


def test_a_ring_closes_on_itself() -> None:
    mesh = cm.generate(*KNOWN["annulus"][:1], cm.Structured(), size=0.2)
    points = mesh.blocks["domain"].points
    assert np.array_equal(points[:, 0], points[:, -1])
    r = np.hypot(*np.moveaxis(mesh.points[points], 2, 0))
    assert np.allclose(r[0], 0.4, atol=1e-14)
    assert np.allclose(r[-1], 1, atol=1e-14)


def test_triangles() -> None:
    shape = KNOWN["square minus disk"][0]
    mesh = cm.generate(shape, cm.Structured(cells="triangle"), size=0.05)
    assert cm.check(mesh, shape).ok
    assert list(mesh.cells) == ["triangle"]
    first, second = np.moveaxis(mesh.cells["triangle"][mesh.blocks["domain"].cells], 2, 0)
    shared = (first[..., :, None] == second[..., None, :]).sum(axis=(-1, -2))
    assert (shared == 2).all()


def test_counts_and_spacing_by_name() -> None:
    box = cm.Box((0, 0), (2, 1), name="b")
    mesher = cm.Structured(
        counts={"b.left": 10, "b.bottom": 8},
        spacing={"b.left": ("geometric", 0.5), "b.top": ("tanh", 3.0)},
    )
    mesh = cm.generate(box, mesher)
    assert cm.check(mesh, box).ok
    points = mesh.points[mesh.blocks["domain"].points]
    y, x = points[0, :, 1], points[:, 0, 0]
    # The left side runs down, with the domain on its left: cells shrink downwards.
    assert np.allclose(np.diff(y)[1:] / np.diff(y)[:-1], 2.0)
    assert np.array_equal(y, points[-1, :, 1])
    assert np.allclose(np.diff(x), np.diff(x)[::-1])
    assert np.diff(x)[0] < 0.5 * np.diff(x)[3]


def test_counts_may_be_coarser_than_the_deviation_and_the_mesh_says_so() -> None:
    shape = cm.Disk((0, 0), 1, name="rim")
    mesh = cm.generate(shape, cm.Structured(counts={"rim": 16}), size=0.25)
    assert len(mesh.facets["line"]) == 16
    assert cm.check(mesh, shape).ok
    assert mesh.domain.deviation == pytest.approx(1 - np.cos(np.pi / 16), rel=1e-6)


def test_four_sided_by_names_and_by_corners() -> None:
    sides = [("low", [(0, 0), (1, -0.2), (2, 0)]), ("high", [(2, 1), (1, 1.2), (0, 1)])]
    points = [p for _, row in sides for p in row]
    names = {"low": [0, 1], "out": [2], "high": [3, 4], "in": [5]}
    domain = cm.Pslg(points, [(k, (k + 1) % 6) for k in range(6)], names=names)
    for mesher in (
        cm.Structured(sides=["low", "out", "high", "in"]),
        cm.Structured(corners=[(0, 0), (2, 0), (2, 1), (0, 1)]),
    ):
        mesh = cm.generate(domain, mesher, size=0.1)
        assert cm.check(mesh, domain).ok
        assert len(mesh.blocks) == 1
        # The kinks of both chains are vertices.
        assert (np.hypot(*(mesh.points - (1, -0.2)).T) == 0).any()
        assert (np.hypot(*(mesh.points - (1, 1.2)).T) == 0).any()


def test_corners_may_lie_on_smooth_curves() -> None:
    disk = cm.Disk((0, 0), 1)
    r = np.sqrt(0.5)
    mesh = cm.generate(disk, cm.Structured(corners=[(r, r), (-r, r), (-r, -r), (r, -r)]), size=0.1)
    assert cm.check(mesh, disk).ok
    assert len(mesh.blocks) == 1


def test_sizes_by_name_and_callable() -> None:
    shape = SQUARE - cm.Disk((0.5, 0.5), 0.2, name="hole")
    mesh = cm.generate(shape, cm.Structured(), size={"hole": 0.02, "default": 0.1})
    hole = mesh.facets["line"][mesh.boundary("hole")["line"]]
    edge = np.hypot(*(mesh.points[hole[:, 1]] - mesh.points[hole[:, 0]]).T)
    assert edge.max() < 0.025
    mesh = cm.generate(SQUARE, cm.Structured(), size=lambda p: 0.02 + 0.2 * p[:, 0])
    x = np.unique(mesh.points[:, 0].round(9))
    h = 0.02 + 0.2 * 0.5 * (x[1:] + x[:-1])
    assert np.all((np.diff(x) / h > 0.7) & (np.diff(x) / h < 1.3))


def test_errors_say_why_and_what_else() -> None:
    cases = [
        (cm.Triangle((0, 0), (1, 0), (0, 1)), {}, "has 3 corners, not four; .*QuadPairing"),
        (cm.Disk((0, 0), 2) - cm.Disk((-1, 0), 0.3) - cm.Disk((1, 0), 0.3), {}, "it has 2 holes"),
        (
            cm.Embed(SQUARE, [cm.EmbeddedPath([(0.2, 0.2), (0.4, 0.6)], name="crack")]), {},
            "no room for embedded paths.*crack",
        ),
        (
            cm.Box((0, 0), (2, 2)) - cm.Box((1, 1), (3, 3)) - cm.Disk((0.5, 1), 0.2), {},
            "in their way",
        ),
    ]  # fmt: skip
    for shape, options, message in cases:
        with pytest.raises(MeshingError, match=message):
            cm.generate(shape, cm.Structured(**options), size=0.1)
    for options, message in (
        ({"counts": {"plate.left": 3, "plate.right": 4}}, "equally many cells"),
        ({"counts": {"plate.left": 0}}, "positive integer"),
        ({"counts": {"door": 3}}, "no boundary matches 'door'"),
        ({"spacing": {"plate.left": ("cosine", 2)}}, "no kind 'cosine'"),
        ({"spacing": {"plate.left": ("tanh", -2)}}, "positive number"),
        ({"sides": ["plate.left", "plate.right", "plate.top", "plate.top"]}, "four sides"),
        ({"corners": [(0, 0), (1, 0), (1, 1), (0.5, 0.5)]}, "lie on the boundary"),
    ):
        with pytest.raises(InputError, match=message):
            cm.generate(SQUARE, cm.Structured(**options), size=0.1)
    with pytest.raises(BudgetError, match="max_points is 100"):
        cm.generate(SQUARE, cm.Structured(max_points=100), size=0.01)
    with pytest.raises(InputError, match="cells must be one of 'quad', 'triangle'"):
        cm.Structured(cells="hexagon")


def test_a_fold_is_an_error_with_its_place() -> None:
    shape = cm.Polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])
    with pytest.raises(MeshingError, match=r"fold over each other near \(0.7\d*, 1.0\d*\)"):
        corners = [(0, 0), (2, 0), (1, 2), (0, 2)]
        cm.generate(shape, cm.Structured(corners=corners), size=0.1)


@settings(max_examples=10, deadline=None)
@given(
    st.floats(0.05, 0.3), st.floats(-0.9, 0.9), st.floats(-0.9, 0.9), st.floats(0, 90),
    st.floats(1, 3),
)  # fmt: skip
def test_a_box_minus_a_disk_anywhere(
    r: float, u: float, v: float, angle: float, width: float
) -> None:
    centre = (width / 2 + u * (width / 2 - r), 0.5 + v * (0.5 - r))
    shape = (cm.Box((0, 0), (width, 1)) - cm.Disk(centre, r)).rotate(angle)
    mesh = cm.generate(shape, cm.Structured(), size=0.1)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, str(certificate)


def test_a_wrong_block_fails_the_check() -> None:
    mesh = cm.generate(SQUARE, cm.Structured(), size=0.25)
    block = mesh.blocks["domain"]
    for wrong in (
        Block(block.cells[:, ::-1], block.points),
        Block(block.cells, block.points[::-1]),
        Block(block.cells * 0, block.points),
    ):
        values = {name: getattr(mesh, name) for name in mesh.__dataclass_fields__}
        assert not cm.check(cm.Mesh(**(values | {"blocks": {"domain": wrong}}))).ok


def test_domain_file(tmp_path) -> None:
    text = """
csgmesh: 1
shapes: {plate: {box: {lo: [0, 0], hi: [2, 1]}}}
domain: plate
mesh:
  structured:
    counts: {plate.left: 10}
    spacing: {plate.left: [geometric, 1.2], plate.top: uniform}
  size: 0.1
"""
    path = tmp_path / "a.yaml"
    path.write_text(text)
    mesh = cm.load(path).generate()
    assert mesh.n_cells == 200
    for old, new, place in (
        ("plate.left: 10", "plate.left: ten", "a.yaml:7:26"),
        ("plate.left: 10", "plate.lft: 10", "a.yaml:7:14"),
        ("[geometric, 1.2]", "[cosine, 1.2]", "a.yaml:8:15"),
        ("counts:", "cuonts:", "a.yaml:7:5"),
    ):
        path.write_text(text.replace(old, new))
        with pytest.raises(DomainFileError, match=place):
            cm.load(path).generate()

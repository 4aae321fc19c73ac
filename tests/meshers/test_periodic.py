"""Periodic sides get matching vertices, whatever refines them, and say so."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.csg import Periodic

CELL = [("c.left", "c.right"), ("c.bottom", "c.top")]
BOX = cm.Box((0, 0), (1, 1), name="c")
SIDES = [("l", "r"), ("c.bottom", "c.top")]


def between(slope: float) -> cm.Shape:
    """A parallelogram of height 1 and width 1, leaning by `slope`."""
    left = cm.HalfSpace((0, 0), (-1, slope), name="l")
    return cm.Box((-9, 0), (9, 1), name="c") & left & cm.HalfSpace((1, 0), (1, -slope), name="r")


def sector(degrees: float) -> cm.Shape:
    turn = math.radians(degrees)
    low = cm.HalfSpace((0, 0), (0, -1), name="low")
    high = cm.HalfSpace((0, 0), (-math.sin(turn), math.cos(turn)), name="high")
    return cm.Disk((0, 0), 1, name="rim") & low & high


WAVY = (cm.Box((0, 0), (3, 1), name="c") | cm.Disk((3, 0.5), 0.3, name="bump")) - cm.Disk(
    (0, 0.5), 0.3, name="dent"
)
INLET = cm.Box((2.9, 0.52), (3.6, 0.9), name="inlet") & WAVY

CASES = {
    "a hole near one side": (BOX - cm.Disk((0.1, 0.3), 0.05, name="hole"), CELL),
    "a hole across a side": (
        BOX - cm.Disk((0, 0.5), 0.2, name="one") - cm.Disk((1, 0.5), 0.2, name="two"),
        CELL,
    ),
    "far from the origin": (
        (BOX - cm.Disk((0.1, 0.3), 0.05, name="hole")).translate((1e6, -3e5)),
        CELL,
    ),
    "curved sides": (WAVY, [("c.left", "c.right"), ("dent", "bump")]),
    "sides of several parts": (WAVY, [("*e[fn]t", "[cb]*[hm][tp]")]),
    "an interface at one side": (
        cm.Regions({"plate": WAVY, "inlet": INLET}),
        [("c.left", "c.right"), ("dent", "bump")],
    ),
    "a sector": (sector(30) - cm.Disk((0.6, 0.1), 0.06, name="hole"), [("low", "high")]),
    "a sector of 90 degrees": (sector(90) - cm.Disk((0.6, 0.1), 0.06), [("low", "high")]),
    # At two of its corners this has an input angle below 60 degrees, at their images not.
    "a rhomboid": (between(2) - cm.Disk((0.6, 0.12), 0.08, name="hole"), SIDES),
    "a probe on one side": (
        cm.Embed(
            BOX,
            [
                cm.EmbeddedPoints([(0, 0.21)], name="probe"),
                cm.EmbeddedPath([(1, 0.6), (0.7, 0.5)], name="crack"),
            ],
        ),
        CELL,
    ),
}
SIZES = {
    "none": None,
    "uniform": 0.06,
    "callable": lambda p: 0.03 + 0.1 * np.abs(p[:, 0] - p[:, 0].min()),
}


def assert_paired(mesh: cm.Mesh) -> None:
    assert mesh.periodic
    lines = mesh.facets["line"]
    for pair in mesh.periodic:
        here, there = pair.points.T
        off = mesh.points[here] @ pair.matrix.T + pair.offset - mesh.points[there]
        assert np.abs(off).max() <= 16 * np.spacing(np.abs(mesh.points).max())
        image = dict(pair.points.tolist())
        first, second = pair.facets["line"].T
        assert [[image[i] for i in ends] for ends in lines[first].tolist()] == [
            ends[::-1] for ends in lines[second].tolist()
        ]
        for name, facets in zip(pair.names, (first, second), strict=True):
            assert sorted(facets.tolist()) == mesh.boundary(name)["line"].tolist()
            ends = sorted(image) if facets is first else sorted(set(image.values()))
            assert ends == mesh.boundary_points(name).tolist() or mesh.point_marker.max() >= 0


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("case", CASES)
def test_refinement_keeps_sides_alike(case: str, size: str) -> None:
    shape, pairs = CASES[case]
    domain = cm.Periodic(shape, pairs)
    mesh = cm.generate(domain, size=SIZES[size])
    assert_paired(mesh)
    certificate = cm.check(mesh, domain)
    assert certificate.ok, str(certificate)


@pytest.mark.parametrize("case", CASES)
def test_without_steiner_points(case: str) -> None:
    domain = cm.Periodic(*CASES[case])
    mesh = cm.generate(domain, cm.ConstrainedDelaunay())
    assert_paired(mesh)
    assert cm.check(mesh, domain).ok


@pytest.mark.parametrize("case", ["curved sides", "a sector", "a hole near one side"])
def test_improvement_keeps_sides_alike(case: str) -> None:
    domain = cm.Periodic(*CASES[case])
    mesh = cm.generate(domain, cm.DelaunayRefinement(improve=True), size=0.08)
    assert_paired(mesh)
    assert cm.check(mesh, domain).ok
    assert_paired(cm.smooth(mesh))


@pytest.mark.parametrize("method", ["red-green", "newest vertex", "longest edge"])
def test_refined_meshes_keep_pairs(method: str) -> None:
    domain = cm.Periodic(*CASES["curved sides"])
    mesh = cm.generate(domain, size=0.2)
    beside = mesh.locate([[0.02, 0.1], [2.98, 0.95], [1.5, 0.98]])
    for cells in (None, beside):
        finer = cm.refine(cm.refine(mesh, cells, method=method), cells, method=method)
        assert finer.n_cells > mesh.n_cells
        assert_paired(finer)
        certificate = cm.check(finer, domain)
        assert certificate.ok, str(certificate)


def test_the_finer_side_decides() -> None:
    """Sizes on one side hold on the other, and grow from there."""
    domain = cm.Periodic(BOX, CELL)
    mesh = cm.generate(domain, size={"c.left": 0.02, "default": 0.3})
    right = mesh.facets["line"][mesh.boundary("c.right")["line"]]
    length = np.hypot(*(mesh.points[right[:, 1]] - mesh.points[right[:, 0]]).T)
    assert length.max() < 0.03
    beside = mesh.points[(mesh.points[:, 0] > 0.9) & (mesh.points[:, 0] < 1)]
    assert len(beside) > 100


def test_corners_are_one_point() -> None:
    mesh = cm.generate(cm.Periodic(BOX, CELL), size=0.3)
    one = mesh.periodic_representatives()
    corner = np.flatnonzero(np.isin(mesh.points, [0, 1]).all(axis=1))
    assert len(corner) == 4
    assert len(set(one[corner])) == 1
    # A torus: one vertex a cell of the quotient, V - E + F = 0 after identification.
    ends = np.concatenate([mesh.cells["triangle"][:, [i, (i + 1) % 3]] for i in range(3)])
    edges = {tuple(sorted(e)) for e in one[ends].tolist()}
    assert len(set(one)) - len(edges) + mesh.n_cells == 0


def test_the_map_is_exact_where_coordinates_are() -> None:
    across, up = cm.generate(cm.Periodic(BOX, CELL), size=0.3).periodic
    assert across.matrix.tolist() == up.matrix.tolist() == [[1, 0], [0, 1]]
    assert (across.offset.tolist(), up.offset.tolist()) == ([1, 0], [0, 1])
    turn = cm.generate(cm.Periodic(sector(90), [("low", "high")])).periodic[0]
    assert np.abs(turn.matrix - [[0, -1], [1, 0]]).max() < 1e-15
    assert turn.offset.tolist() == [0, 0]


DENTED = BOX - cm.Disk((1, 0.05), 0.2, name="dent")


@pytest.mark.parametrize(
    ("shape", "pairs", "error", "message"),
    [
        (BOX, [("c.left", "c.rigt")], cm.NameLookupError, "did you mean 'c.right'"),
        (DENTED, [("c.left", "c.right")], cm.EvaluationError, r"ends at \(0, 0\).* 0.25 away"),
        (WAVY, [("c.left", "dent")], cm.EvaluationError, "congruent"),
        (
            WAVY | cm.Polygon([(-1, 0), (0, 0), (0, 1), (-1, 1)], name="p"),
            [("bump", "p")],
            cm.EvaluationError,
            "congruent",
        ),
        (BOX - cm.Disk((0.5, 0.5), 0.2), [("disk", "c.left")], cm.EvaluationError, "closed"),
        (BOX, [*CELL, ("c.top", "c.left")], cm.EvaluationError, "one periodic side only"),
        (
            cm.Regions({"a": BOX, "b": cm.Box((0.5, 0), (1, 1), name="half")}),
            [("half.left", "c.right")],
            cm.EvaluationError,
            r"both sides at \(0.5, 0.5\)",
        ),
    ],
)
def test_what_cannot_be_paired(shape, pairs, error, message) -> None:
    with pytest.raises(error, match=message):
        cm.evaluate(cm.Periodic(shape, pairs))


def test_sides_that_differ_between_their_ends() -> None:
    bulge = cm.Disk((0.8, 0.5), math.hypot(0.2, 0.5), name="bulge")
    with pytest.raises(cm.EvaluationError, match=r"congruent; .* long, its partner"):
        cm.evaluate(cm.Periodic(BOX | bulge & cm.HalfSpace((1, 0), (-1, 0)), [("c.left", "bulge")]))


def test_a_side_a_little_off() -> None:
    lean = cm.HalfSpace((1, 0), (1, 1e-8), name="r")
    box = cm.Box((0, 0), (2, 1), name="c") & lean
    with pytest.raises(cm.EvaluationError, match="congruent"):
        cm.evaluate(cm.Periodic(box, [("c.left", "r")]))
    assert cm.evaluate(cm.Periodic(box, [("c.left", "r")]), snap=1e-7).periodic


@pytest.mark.parametrize(
    "pairs", ["ab", 3, ["ab"], [("a",)], [("a", "b", "c")], [("a", 1)], [("a", "a")], [("", "a")]]
)
def test_unusable_pairs(pairs) -> None:
    with pytest.raises(cm.ShapeError, match="pairs must be"):
        cm.Periodic(BOX, pairs)


def test_is_a_value() -> None:
    for shape, pairs in CASES.values():
        domain = cm.Periodic(shape, pairs)
        read = [
            eval(repr(domain), vars(cm) | {name: getattr(cm, name) for name in cm.__all__}),
            Periodic.from_dict(domain.to_dict()),
            pickle.loads(pickle.dumps(domain)),
        ]
        assert all(other == domain and hash(other) == hash(domain) for other in read)
    assert cm.Periodic(BOX, CELL) != cm.Periodic(BOX, CELL[:1])
    assert cm.Periodic(BOX, CELL).contains([(0.5, 0.5), (2, 0)]).tolist() == [True, False]


def test_other_meshers_refuse() -> None:
    class Other:
        def generate(self, domain, size=None, progress=None):
            return replace(cm.ConstrainedDelaunay().generate(domain), periodic=())

    with pytest.raises(cm.MeshingError, match="Other does not match"):
        cm.generate(cm.Periodic(BOX, CELL), Other())


@pytest.mark.parametrize("suffix", ["npz", "msh"])
def test_files_keep_pairs(tmp_path, suffix) -> None:
    for case in ("an interface at one side", "a sector"):
        domain = cm.Periodic(*CASES[case])
        mesh = cm.generate(domain, size=0.1)
        cm.write(tmp_path / f"a.{suffix}", mesh)
        read = cm.read(tmp_path / f"a.{suffix}")
        assert_paired(read)
        assert cm.check(read, domain).ok
        assert [pair.names for pair in read.periodic] == [pair.names for pair in mesh.periodic]
        for ours, theirs in zip(mesh.periodic, read.periodic, strict=True):
            assert (ours.matrix == theirs.matrix).all()
            assert (ours.offset == theirs.offset).all()
            assert set(map(tuple, ours.points)) == set(map(tuple, theirs.points))
            assert set(map(tuple, ours.facets["line"])) == set(map(tuple, theirs.facets["line"]))


def test_text_files_keep_pairs(tmp_path) -> None:
    mesh = cm.generate(cm.Periodic(BOX, CELL), size=0.3)
    cm.write(tmp_path / "a.msh", mesh, binary=False)
    assert "$Periodic\n2\n1 2 1\n16 1.0 0.0 0.0 1.0" in (tmp_path / "a.msh").read_text()
    assert_paired(cm.read(tmp_path / "a.msh"))


def tampered(mesh: cm.Mesh) -> dict[str, tuple[cm.Mesh, str]]:
    first, *others = mesh.periodic
    inner = int(np.flatnonzero(mesh.points[first.points[:, 1], 1] == 0.5)[0])
    points = mesh.points.copy()
    points[first.points[inner, 1], 1] += 1e-3
    one, two = first.facets["line"].T
    swapped = first.points.copy()
    swapped[:2, 1] = swapped[1::-1, 1]

    def changed(**values) -> cm.Mesh:
        return replace(mesh, periodic=(replace(first, **values), *others))

    return {
        "a point moved": (replace(mesh, points=points), "not where"),
        "points swapped": (changed(points=swapped), "not where"),
        "a facet forgotten": (changed(facets={"line": first.facets["line"][1:]}), "single partner"),
        "facets shuffled": (
            changed(facets={"line": np.column_stack([one, two[::-1]])}),
            "other partners",
        ),
        "a number too large": (changed(points=first.points + 10**6), "must pair points"),
        "another map": (changed(offset=np.add(first.offset, [0, 0.5])), "not that of the domain"),
        "a pair forgotten": (replace(mesh, periodic=tuple(others)), "does not pair 'c.left'"),
    }  # fmt: skip


def test_the_certificate_catches_what_is_wrong() -> None:
    domain = cm.Periodic(BOX, CELL)
    mesh = cm.generate(domain, size=0.25)
    for name, (bad, message) in tampered(mesh).items():
        failures = cm.check(bad, domain)["periodic sides"].failures
        assert failures, name
        assert message in " ".join(f.message for f in failures), name


def test_domain_file(tmp_path) -> None:
    path = tmp_path / "cell.yaml"
    text = """csgmesh: 1
shapes:
  c: {box: {lo: [0, 0], hi: [1, 1]}}
domain:
  periodic:
    shape: {difference: [c, {disk: {center: [0.3, 0.5], radius: 0.1}}]}
    pairs: [[c.left, c.right], [c.bottom, PLACE]]
"""
    path.write_text(text.replace("PLACE", "c.top"))
    assert_paired(cm.load(path).generate())
    path.write_text(text.replace("PLACE", "c.tip"))
    with pytest.raises(cm.DomainFileError, match=r"yaml:\d+:\d+: no boundary matches 'c.tip'"):
        cm.load(path).generate()
    path.write_text(text.replace("PLACE", "c.top, c.left"))
    with pytest.raises(cm.DomainFileError, match=r"yaml:7:32: a pair is of two names, not 3"):
        cm.load(path)
    path.write_text(text.replace("PLACE", "c.bottom"))
    with pytest.raises(cm.DomainFileError, match=r"yaml:7:\d+: .*'c.bottom' twice"):
        cm.load(path)

"""Meshes of the surfaces of solids from the front door: closed, named, certified, in files."""

from dataclasses import replace

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.errors import BudgetError, DomainFileError, InputError, SizeError

PI = np.pi
BOX = cm.Box((0, 0, 0), (2, 2, 2), name="plate")
SOLID = BOX - cm.Cylinder((1, 1, -1), (1, 1, 3), 0.5, name="bore")
TEE = cm.Cylinder((-2, 0, 0), (2, 0, 0), 0.6, name="main") | cm.Cylinder(
    (0, 0, 0), (0, 0, 2), 0.4, name="branch"
)
TWO = cm.Regions({"soft": BOX, "hard": cm.Ball((1, 1, 1), 0.6, name="ball")})

#: Solid, exact area, exact volume; None where there is no formula.
SOLIDS = {
    "bore": (SOLID, 24 - 2 * PI * 0.25 + 2 * PI, 8 - PI / 2),
    "ball": (cm.Ball((1, 2, 3), 1), 4 * PI, 4 / 3 * PI),
    "tee": (TEE, None, None),
    "cap": (cm.Ball((0, 0, 0), 1) & cm.HalfSpace((0, 0, 0.8), (0, 0, -1)), 0.76 * PI, None),
    "two": (TWO, 24 + 4 * PI * 0.36, 8.0),
}


@pytest.fixture(scope="module")
def two():
    return cm.generate(TWO, cm.SurfaceRefinement(), size=0.4)


def enclosed(mesh, region=None):
    """Volume inside the outer triangles, or around a region."""
    rows, sides = mesh.facets["triangle"], mesh.facet_region["triangle"]
    if region is None:
        rows = rows[sides[:, 1] < 0]
    else:
        rows = np.concatenate([rows[sides[:, 0] == region], rows[sides[:, 1] == region][:, ::-1]])
    a, b, c = (mesh.points[rows[:, k]] for k in range(3))
    return (a * np.cross(b, c)).sum() / 6


@pytest.mark.parametrize("name", SOLIDS)
def test_surfaces_pass_the_certificate_and_have_their_angles(name):
    solid, area, volume = SOLIDS[name]
    mesh = cm.generate(solid, cm.SurfaceRefinement(), size=0.25)
    assert list(mesh.cells) == ["triangle"]
    certificate = cm.check(mesh, solid)
    assert certificate.ok, certificate.failures
    domain = cm.evaluate(solid)
    assert mesh.names == domain.names
    assert all(len(mesh.boundary(n)["triangle"]) for n in mesh.names)
    quality = cm.quality(mesh)
    assert np.min(quality.min_angle) >= 25
    assert area is None or abs(quality.total_area / area - 1) < 0.02
    assert volume is None or abs(enclosed(mesh) / volume - 1) < 0.02


def test_an_interface_is_meshed_once_and_closes_both_regions(two):
    assert abs(enclosed(two, 0) + enclosed(two, 1) - 8) < 1e-12
    ball = two.boundary("ball")["triangle"]
    assert np.array_equal(np.sort(two.interface("soft", "hard")["triangle"]), ball)
    rows = np.sort(two.cells["triangle"], axis=1)
    assert len(np.unique(rows, axis=0)) == len(rows)
    off = np.linalg.norm(two.points[two.boundary_points("ball")] - 1, axis=1) - 0.6
    assert np.abs(off).max() < 1e-14


def test_sizes_by_name_make_a_part_finer():
    mesh = cm.generate(SOLID, cm.SurfaceRefinement(), {"plate.top": 0.1, "default": 0.6})
    a, b, _ = mesh.facets["triangle"][mesh.boundary("plate.top")["triangle"]].T
    assert 0.07 < np.linalg.norm(mesh.points[a] - mesh.points[b], axis=1).mean() < 0.12
    assert cm.check(mesh, SOLID).ok


def test_a_fine_uniform_size_is_not_counted_in_the_volume():
    # 1e6 cubes of this size fill the box, but its surface needs some 70,000 points.
    mesh = cm.generate(BOX, cm.SurfaceRefinement(max_points=100_000), size=0.02)
    assert 50_000 < mesh.n_points < 100_000


@pytest.mark.parametrize(
    ("rule", "spoil"),
    [
        ("closed", lambda m: dropped(m)),
        ("closed", lambda m: turned(m)),
        ("names", lambda m: moved(m, [1e-3, 0, 0])),
        ("volume", lambda m: replace(m, region_names=("hard", "soft"))),
        ("facets", lambda m: replace(m, cell_region={"triangle": 1 - m.cell_region["triangle"]})),
        ("points", lambda m: replace(m, points=[*m.points, [5, 5, 5]], point_marker=[])),
    ],
)
def test_the_certificate_finds_what_is_wrong(two, rule, spoil):
    certificate = cm.check(spoil(two), TWO)
    assert rule in {failure.rule for failure in certificate.failures}


def dropped(mesh):
    fields = ("cells", "cell_region", "facets", "facet_marker", "facet_region")
    new = {name: {"triangle": getattr(mesh, name)["triangle"][1:]} for name in fields}
    return replace(mesh, **new, facet_curve={}, facet_interval={})


def turned(mesh):
    rows = mesh.cells["triangle"].copy()
    rows[0] = rows[0, ::-1]
    return replace(mesh, cells={"triangle": rows}, facets={"triangle": rows})


def moved(mesh, by):
    points = mesh.points.copy()
    points[mesh.boundary_points("ball")] += by
    return replace(mesh, points=points)


@pytest.mark.parametrize(
    ("name", "options"),
    [("a.msh", {}), ("a.msh", {"binary": False}), ("a.vtu", {}), ("a.npz", {})],
)
def test_files_keep_everything(tmp_path, two, name, options):
    cm.write(tmp_path / name, two, **options)
    again = cm.read(tmp_path / name)
    assert again.equals(two)
    assert cm.check(again, TWO).ok


def test_gmsh_surfaces_without_volumes_are_read(tmp_path, two):
    cm.write(tmp_path / "a.msh", two, binary=False)
    text = (tmp_path / "a.msh").read_text()
    head, rest = text.split("$Entities\n")
    lines, rest = rest.split("$EndEntities\n")
    counts, *rows = lines.splitlines()
    n = int(counts.split()[2])
    lines = "\n".join([f"0 0 {n} 0", *rows[:n]]) + "\n"
    (tmp_path / "b.msh").write_text(f"{head}$Entities\n{lines}$EndEntities\n{rest}")
    again = cm.read(tmp_path / "b.msh")
    assert again.region_names == ("soft", "hard", "domain")
    assert (again.cell_region["triangle"] == 2).all()
    assert np.array_equal(again.cells["triangle"], two.cells["triangle"])


def test_surface_formats_hold_the_outer_boundary(tmp_path, two):
    trimesh = pytest.importorskip("trimesh")
    assert np.isclose(cm.to_trimesh(two).volume, 8)
    for suffix in (".stl", ".obj", ".ply", ".off"):
        cm.write(tmp_path / f"a{suffix}", two)
        found = trimesh.load(tmp_path / f"a{suffix}", force="mesh")
        assert found.is_watertight
        assert np.isclose(found.volume, 8, rtol=1e-6)
    assert "g plate.left\n" in (tmp_path / "a.obj").read_text()
    given = cm.to_meshio(two)
    assert [(block.type, len(block.data)) for block in given.cells] == [("triangle", two.n_cells)]
    assert "ball" in given.cell_sets


def test_drawing_shows_the_inside_where_it_is_cut(tmp_path, two):
    count = []
    for cut in (None, ((1, 1, 1), (0, -1, 0))):
        axes = cm.draw(two, cut=cut).axes[0]
        count.append(len(axes.collections[0].get_paths()))
        assert "ball" in [t.get_text() for t in axes.figure.findobj(type(axes.title))]
    assert count[1] > 0.5 * count[0]


def test_domain_files_choose_surface_refinement(tmp_path):
    path = tmp_path / "part.yaml"
    text = """csgmesh: 1
shapes:
  part: {difference: [{box: {lo: [0, 0, 0], hi: [1, 1, 1]}},
                      {ball: {center: [0.5, 0.5, 0.5], radius: 0.3, name: void}}]}
domain: part
mesh: {surface_refinement: {min_angle: 25}, size: 0.3}
"""
    path.write_text(text)
    file = cm.load(path)
    assert file.mesher == cm.SurfaceRefinement(min_angle=25)
    assert list(file.generate().cells) == ["triangle"]
    path.write_text(text.replace("25", "50"))
    with pytest.raises(DomainFileError, match=r"part.yaml:6:.*min_angle must be between 0 and 30"):
        cm.load(path).generate()


def test_the_same_input_gives_the_same_bytes(two):
    again = cm.generate(TWO, cm.SurfaceRefinement(), size=0.4)
    assert again.points.tobytes() == two.points.tobytes()
    assert again.equals(two)


def test_errors_state_the_rule_and_the_value(two):
    with pytest.raises(InputError, match="between 0 and 30 degrees; got 40"):
        cm.SurfaceRefinement(min_angle=40)
    with pytest.raises(InputError, match="gradation must be positive"):
        cm.SurfaceRefinement(gradation=0)
    with pytest.raises(SizeError, match="got 0"):
        cm.generate(SOLID, cm.SurfaceRefinement(), size=0)
    with pytest.raises(BudgetError, match="max_points = 500 do not suffice"):
        cm.generate(SOLID, cm.SurfaceRefinement(max_points=500), size=0.05)
    with pytest.raises(InputError, match="meshes domains in space; this one lies in the p"):
        cm.generate(cm.Box((0, 0), (1, 1)), cm.SurfaceRefinement())
    for verb in (cm.refine, cm.smooth, lambda mesh: mesh.locate([[1, 1, 1]])):
        with pytest.raises(InputError, match="surface"):
            verb(two)

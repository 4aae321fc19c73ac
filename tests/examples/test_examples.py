"""Every example runs, passes its own check, draws its picture, and prints the right numbers."""

import re
import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import meshio
import numpy as np
import pytest

import csgmesh as cm

EXAMPLES = Path(__file__).parents[2] / "examples"
LONGEST = 40
#: A collection: one short function a solid.
COLLECTIONS = {"solids"}
PLATE = {"plate.left", "plate.right", "plate.bottom", "plate.top", "hole"}


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Runs an example in a folder of its own; what it printed, and where it wrote."""

    def runner(name):
        monkeypatch.chdir(tmp_path)
        plt.switch_backend("Agg")
        runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
        return capsys.readouterr().out, tmp_path

    yield runner
    plt.close("all")


def check_picture(path):
    from matplotlib.image import imread

    pixels = imread(path)
    assert min(pixels.shape[:2]) > 200
    assert pixels[..., :3].std() > 0.05, "the picture is blank"


def test_each_example_is_run_here_and_short():
    tested = {name.removeprefix("test_") for name in globals() if name.startswith("test_")}
    for path in EXAMPLES.glob("*.py"):
        assert path.stem in tested, f"no test runs {path.name}"
        lines = len(path.read_text().splitlines())
        assert lines <= LONGEST or path.stem in COLLECTIONS, path.name


def test_plate(run):
    printed, folder = run("plate")
    assert "the mesh is valid" in printed
    check_picture(folder / "plate.png")
    assert set(meshio.read(folder / "plate.msh").field_data) >= PLATE


def test_quadtree(run):
    printed, folder = run("quadtree")
    angles = [float(a) for a in re.findall(r"smallest angle (\S+)°", printed)]
    assert len(angles) == 3
    assert min(angles[:2]) >= 18.4
    assert "triangle" not in printed.splitlines()[2]
    check_picture(folder / "quadtree.png")


def test_pulley(run):
    printed, folder = run("pulley")
    assert "the mesh is valid" in printed
    check_picture(folder / "pulley.png")
    mesh = cm.read(folder / "pulley.msh")
    seat = mesh.points[mesh.boundary_points("pulley.side.groove")]
    radius = np.hypot(*seat[:, :2].T)
    # On the torus that the groove sweeps: its circle about (3, 0.5) has the radius 0.4.
    np.testing.assert_allclose(np.hypot(radius - 3, seat[:, 2] - 0.5), 0.4, atol=1e-12)


def test_block(run):
    printed, folder = run("block")
    least = float(re.search(r"smallest dihedral angle ([\d.]+)", printed).group(1))
    assert least >= 15.0
    assert float(re.search(r"smallest scaled Jacobian ([\d.]+)", printed).group(1)) >= 0.2
    check_picture(folder / "block.png")
    check_picture(folder / "block_hexahedra.png")
    check_picture(folder / "block_mixed.png")
    mesh = cm.read(folder / "block.msh")
    cavity = mesh.points[mesh.boundary_points("cavity")] - (0.6, 0.5, 0.5)
    np.testing.assert_allclose(np.linalg.norm(cavity, axis=1), 0.3, atol=1e-12)


def test_bracket(run):
    printed, folder = run("bracket")
    assert "the mesh is valid" in printed
    check_picture(folder / "bracket.png")
    names = cm.read(folder / "bracket.vtu").names
    assert {"wall", "face", "head", "web", "boss", "bore", "slot.disk", "slot.disk.2"} <= set(names)


def test_inclusion(run):
    printed, folder = run("inclusion")
    found = re.search(r"interface: (\S+) in chords, (\S+) exactly", printed)
    chords, exact = map(float, found.groups())
    assert exact == pytest.approx(2 * np.pi * 0.55, abs=1e-4)
    assert 0 < exact - chords < 0.002
    check_picture(folder / "inclusion.png")
    mesh = meshio.read(folder / "inclusion.msh")
    assert {"matrix", "grain", "bond", "block.left"} <= set(mesh.field_data)


def test_corner(run):
    printed, folder = run("corner")
    assert "area 3\n" in printed
    check_picture(folder / "corner.png")


def test_glyphs(run):
    printed, folder = run("glyphs")
    assert "the mesh is valid" in printed
    check_picture(folder / "glyphs.png")


def test_poisson(run):
    printed, folder = run("poisson")
    errors = [float(e) for e in re.findall(r"error (\S+)", printed)]
    assert len(errors) == 4
    # Linear elements converge quadratically, also along curved boundaries: over three halvings
    # of h the error falls by 8² = 64, give or take what unstructured meshes add.
    assert 40 < errors[0] / errors[-1] < 110
    assert errors[-1] < 4e-4
    check_picture(folder / "poisson.png")


def test_structured(run):
    printed, folder = run("structured")
    assert "domain.5" in printed
    assert float(re.search(r"off by (\S+) at", printed).group(1)) < 1e-3
    check_picture(folder / "structured.png")


def test_improved(run):
    printed, folder = run("improved")
    before, after = map(float, re.findall(r"smallest angle (\S+) degrees", printed))
    assert before >= 30
    assert after >= 38
    check_picture(folder / "improved.png")


def test_sharp(run):
    printed, folder = run("sharp")
    assert printed.count("input angle\n") == 3
    assert "status='passed'" in printed
    check_picture(folder / "sharp.png")


def test_graded(run):
    printed, folder = run("graded")
    lengths = {
        n: (float(a), float(b)) for n, a, b in re.findall(r"(\w+): .* of (\S+) to (\S+)", printed)
    }
    assert lengths["crack"][1] < 0.015
    assert lengths["dome"][1] > 0.3
    check_picture(folder / "graded.png")


def test_periodic_cell(run):
    printed, folder = run("periodic_cell")
    assert "status='passed'" in printed
    found, series = map(float, re.search(r"conductivity (\S+), .* (\S+)\n", printed).groups())
    # Of a mesh without matching sides the mean flux would be off by far more.
    assert found == pytest.approx(series, rel=2e-3)
    check_picture(folder / "periodic_cell.png")


def test_walls(run):
    printed, folder = run("walls")
    assert "8 layers" in printed
    assert {"quad", "triangle"} <= set(meshio.read(folder / "walls.msh").cells_dict)
    check_picture(folder / "walls.png")


def test_hybrid(run):
    printed, folder = run("hybrid")
    for kind in ("triangles", "quads", "both"):
        orders = [float(o) for o in re.findall(rf"{kind}.*order (\S+)", printed)]
        assert orders and min(orders) > 1.7
    check_picture(folder / "hybrid.png")


def test_quads(run):
    printed, folder = run("quads")
    worst, mean = map(float, re.search(r"SICN from (\S+), (\S+) on", printed).groups())
    assert worst > 0.5
    assert mean > 0.93
    check_picture(folder / "quads.png")


def test_adaptive_corner(run):
    printed, folder = run("adaptive_corner")
    adapted, uniform = (
        float(re.search(rf"{name}: order (\S+)", printed)[1]) for name in ("adapted", "uniform")
    )
    assert adapted == pytest.approx(-1, abs=0.1)
    assert uniform > -0.75
    assert "H1 error" in printed
    check_picture(folder / "adaptive_corner.png")


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_domain_files(path):
    file = cm.load(path)
    mesh = file.generate()
    assert file.expect is not None
    assert not file.mismatches(mesh)
    certificate = cm.check(mesh, file.shape)
    assert certificate.ok, str(certificate)


def test_refined(run):
    printed, folder = run("refined")
    assert float(re.search(r"smallest angle (\S+)", printed).group(1)) > 10.9
    assert float(re.search(r"off by (\S+)", printed).group(1)) < 1e-5
    check_picture(folder / "refined.png")


def test_solids(run):
    printed, folder = run("solids")
    assert len(printed.splitlines()) == 7
    check_picture(folder / "solids.png")
    solids = runpy.run_path(str(EXAMPLES / "solids.py"))["ALL"]
    bracket = cm.evaluate(solids["bracket"](), deviation=1e-3)
    rib, plates = 6 * 24 * 22 / 2, 40 * (60 * 8 + 8 * 42)
    bores = np.pi * (2 * 16 + 25) * 8
    assert bracket.volumes()[0] == pytest.approx(plates + rib - bores, rel=1e-4)
    assert bracket.euler_characteristic() == 2 - 2 * 3
    assert {"bore.side", "eye.side", "rib.side.slope", "wall.right"} <= set(bracket.names)
    tee = cm.evaluate(solids["pipe_tee"]())
    assert tee.euler_characteristic() == 2 - 2 * 2
    assert tee.names == (
        *("run.side", "run.base", "run.top", "branch.side", "branch.top"),
        *("bore.side", "inlet.side"),
    )
    gear = cm.evaluate(solids["gear"]())
    assert {"gear.start", "gear.side.flank", "gear.side.key.top"} <= set(gear.names)
    pawn = cm.evaluate(solids["chess_piece"]())
    assert pawn.euler_characteristic() == 2
    assert pawn.bounds()[1] == pytest.approx([1.3, 1.3, 3.75], abs=5e-3)
    assert cm.evaluate(solids["bowl"]()).names[:3] == tuple(
        f"bowl.side.{part}" for part in ("outside", "inside", "brim")
    )


def test_openscad(run):
    printed, folder = run("openscad")
    volume, bore = (float(re.search(rf"{w}: (\S+)", printed)[1]) for w in ("volume", "bore"))
    # A plate with round corners, a block on it, two bores through the plate, a seat for a rod of
    # radius 8 at the block's top, and a hexagonal pocket below, whose corners are on radius 5.
    plate = (60 * 30 - (4 - np.pi) * 36) * 8 - 2 * np.pi * 9 * 8
    pocket = 4.9 * 6 * 0.5 * 25 * np.sin(np.pi / 3)
    assert volume == pytest.approx(plate + 24 * 24 * 16 - np.pi * 32 * 24 - pocket, rel=1e-3)
    assert bore == pytest.approx(np.pi * 8 * 24, rel=2e-3)  # in chords 0.04 deep
    check_picture(folder / "openscad.png")


def test_elasticity(run):
    printed, folder = run("elasticity")
    orders = re.findall(r"order (\S+) (\w+)", printed)
    assert [float(order) > 1.85 for order, _ in orders] == [True, True]
    assert {valid for _, valid in orders} == {"True"}
    assert re.findall(r"tetra|hexahedron", printed) == 2 * ["tetra"] + 2 * ["hexahedron"]
    check_picture(folder / "elasticity.png")


def test_heat(run):
    printed, folder = run("heat")
    orders = [float(order) for order in re.findall(r"order (\S+)", printed)]
    assert len(orders) == 2
    assert min(orders) > 1.9
    assert "\nvalid\n" in printed
    inside, middle, outside = map(float, re.search(r"wall: (.*) (.*) (.*)", printed).groups())
    assert abs(middle - np.log(2 / 1.5)) < 0.005
    assert inside > 0.68 > 0.01 > outside
    check_picture(folder / "heat.png")

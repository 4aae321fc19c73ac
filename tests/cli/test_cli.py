"""The command line: what is written, what is said, and the exit codes."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import meshio
import numpy as np
import pytest
from typer.testing import CliRunner, Result

import csgmesh as cm
from csgmesh.cli.app import app

PLATE = """\
csgmesh: 1
parameters: {r: 0.5}
shapes:
  plate: {box: {lo: [0, 0], hi: [4, 2]}}
  hole: {disk: {center: [2, 1], radius: $r}}
domain: {difference: [plate, hole]}
mesh: {size: {default: 0.4, hole: 0.2}}
output: [plate.msh, plate.svg]
expect: {area: $(8 - pi*r**2), names: [plate, hole]}
"""
NAMES = {"plate.left", "plate.right", "plate.bottom", "plate.top", "hole"}


@pytest.fixture
def plate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The plate's file, in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = Path("plate.yaml")
    path.write_text(PLATE)
    return path


def run(*arguments: object) -> Result:
    """Run a command in this process."""
    return CliRunner().invoke(app, [str(a) for a in arguments])


def python(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    """Run the command in a process of its own."""
    command = [sys.executable, "-m", "csgmesh", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **options)


def changed(path: Path, old: str, new: str) -> Path:
    """Another file with one text replaced."""
    text = path.read_text()
    assert old in text
    other = path.with_name("changed.yaml")
    other.write_text(text.replace(old, new))
    return other


# -- mesh -----------------------------------------------------------------------------------------


def test_mesh_writes_what_the_file_lists_beside_it(plate: Path, tmp_path: Path) -> None:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    os.chdir(folder)
    result = run("mesh", "../plate.yaml")
    assert result.exit_code == 0, result.output
    assert sorted(p.name for p in tmp_path.glob("plate.*")) == [
        "plate.msh",
        "plate.svg",
        "plate.yaml",
    ]
    assert "plate.msh: " in result.stdout


def test_the_names_arrive_as_physical_groups(plate: Path) -> None:
    assert run("mesh", plate, "-o", "out.msh").exit_code == 0
    assert set(meshio.read("out.msh").field_data) >= NAMES
    assert not Path("plate.msh").exists()


def test_mesh_writes_several_outputs(plate: Path) -> None:
    result = run("mesh", plate, "-o", "a.vtu", "-o", "b.npz", "--output", "c.png")
    assert result.exit_code == 0, result.output
    assert cm.read("a.vtu").n_cells == cm.read("b.npz").n_cells > 50
    assert Path("c.png").read_bytes().startswith(b"\x89PNG")
    assert len(result.stdout.splitlines()) == 3


def test_parameters_are_replaced(plate: Path) -> None:
    assert run("mesh", plate, "-o", "a.npz", "--param", "r=0.3").exit_code == 0
    assert run("mesh", plate, "-o", "b.npz", "-p", "r=3/10").exit_code == 0
    a, b = cm.read("a.npz"), cm.read("b.npz")
    assert np.array_equal(a.points, b.points)
    radius = np.hypot(*(a.points[a.boundary_points("hole")] - (2, 1)).T)
    assert np.allclose(radius, 0.3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-o", "out.mhs"], "out.mhs: unknown suffix '.mhs'; did you mean '.msh'"),
        (["-o", "none/out.msh"], "there is no folder none"),
        (["-p", "q=1"], "no parameter 'q'; there are 'r'"),
        (["-p", "r"], "--param takes NAME=VALUE, not 'r'"),
        (["-p", "r=wide"], "value of parameter 'r': unknown name 'wide'"),
        (["--limit", "cels=9"], "no option 'cels'; did you mean 'cells'"),
        (["--limit", "cells=many"], "whole number, not 'many'"),
        (["--max-cells", "0"], "positive whole number, not 0"),
        (["--max-cell", "9"], "--max-cells"),
        (["--sise", "9"], "No such option"),
    ],
)
def test_bad_options(plate: Path, arguments: list[str], message: str) -> None:
    result = run("mesh", plate, *arguments)
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.split())
    assert not list(Path().glob("*.msh"))


def test_a_file_without_output_needs_one(plate: Path) -> None:
    result = run("mesh", changed(plate, "output: [plate.msh, plate.svg]\n", ""))
    assert result.exit_code == 2
    assert "say where to write by -o" in result.stderr


def test_a_mistake_is_shown_at_its_place(plate: Path) -> None:
    result = run("mesh", changed(plate, "radius: $r", "radius: $q"))
    assert result.exit_code == 2
    assert result.stdout == ""
    first, line, caret = result.stderr.splitlines()
    assert first == "changed.yaml:5:41: unknown name 'q' in '$q'; there are 'r'"
    assert line.endswith("hole: {disk: {center: [2, 1], radius: $q}}")
    assert line[caret.index("^") :].startswith("$q")


def test_what_the_mesher_cannot_do(plate: Path) -> None:
    result = run("mesh", plate, "--max-cells", 50)
    assert result.exit_code == 3
    assert "raise it by --limit cells=N" in result.stderr
    result = run("mesh", changed(plate, "difference: [plate, hole]", "difference: [hole, plate]"))
    assert result.exit_code == 3
    assert result.stderr.startswith("changed.yaml:6:1: the domain is empty")
    assert not Path("plate.msh").exists()


# -- the other commands ---------------------------------------------------------------------------


def test_check_passes_domain_files_and_meshes(plate: Path) -> None:
    assert run("mesh", plate).exit_code == 0
    result = run("check", plate, "plate.msh")
    assert result.exit_code == 0, result.output
    said = [line.split(" rules")[0].rstrip("0123456789") for line in result.stdout.splitlines()]
    assert said == ["plate.yaml: ok, ", "plate.msh: ok, "]
    assert "passed   orientation" in run("check", "-v", plate).stdout


def test_check_says_where_an_expectation_fails(plate: Path) -> None:
    wrong = changed(plate, "area: $(8", "area: $(9")
    result = run("check", plate, wrong)
    assert result.exit_code == 1
    assert "changed.yaml:9:16: area: 7.2146" in result.stdout
    assert "expected 8.214601837 within" in result.stdout
    assert result.stderr == ""


def test_check_of_a_mesh_that_is_wrong(plate: Path) -> None:
    run("mesh", plate, "-o", "good.npz")
    mesh = cm.read("good.npz")
    cells = mesh.cells["triangle"].copy()
    cells[3] = cells[3][::-1]
    cm.write("bad.npz", cm.Mesh(mesh.points, {"triangle": cells}))
    result = run("check", "bad.npz")
    assert result.exit_code == 1
    assert (
        "bad.npz: orientation: 1 cell is not counterclockwise; the first is cell 3" in result.stdout
    )


def test_check_goes_on_after_a_bad_file(plate: Path) -> None:
    result = run("check", "none.yaml", "none.msh", plate)
    assert result.exit_code == 2
    assert "none.yaml: cannot be read" in result.stderr
    assert "none.msh: there is no such file" in result.stderr
    assert "plate.yaml: ok" in result.stdout


def test_quality_of_a_file_and_of_its_mesh(plate: Path) -> None:
    run("mesh", plate, "-o", "plate.msh")
    table = run("quality", "plate.msh").stdout
    assert "smallest angle" in table
    assert run("quality", plate).stdout.splitlines()[0] == table.splitlines()[0]


def test_draw(plate: Path) -> None:
    assert run("draw", plate).exit_code == 0
    assert Path("plate.png").exists()
    assert run("draw", plate, "--domain", "-o", "domain.svg").exit_code == 0
    assert "hole" in Path("domain.svg").read_text()
    run("mesh", plate, "-o", "plate.msh")
    assert run("draw", "plate.msh", "-o", "mesh.png").exit_code == 0
    result = run("draw", "plate.msh", "--domain")
    assert result.exit_code == 2
    assert "--domain needs a domain file" in result.stderr
    assert run("draw", plate, "-o", "plate.gif").exit_code == 2


def test_solids_are_drawn_without_a_mesher(tmp_path: Path, monkeypatch) -> None:
    from matplotlib.image import imread

    monkeypatch.chdir(tmp_path)
    Path("part.yaml").write_text(
        "csgmesh: 1\ndomain: {difference: [{box: {lo: [0, 0, 0], hi: [4, 2, 1]}}, "
        "{ball: {center: [4, 0, 1], radius: 1}}]}\n"
    )
    Path("part.csg").write_text("cube(size = [4, 2, 1], center = false);")
    for source, options in (
        ("part.yaml", ()),
        ("part.yaml", ("--domain", "--view", "30,40")),
        ("part.csg", ()),
    ):
        result = run("draw", source, "-o", "part.png", *options)
        assert result.exit_code == 0, result.stderr
        assert imread("part.png")[..., :3].std() > 0.05
        Path("part.png").unlink()
    for options, said in (
        (("--view", "30"), "--view takes 2 numbers"),
        (("--cut", "a,b"), "--cut takes 6 numbers"),
        (("--cut", "0,0,0,1,0,0"), "cut needs a mesh"),
    ):
        result = run("draw", "part.yaml", *options)
        assert result.exit_code == 2
        assert said in result.stderr


def test_convert_writes_the_boundary_of_a_solid(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    box = cm.Box((0, 0, 0), (1, 2, 3))
    cm.write("box.vtu", cm.generate(box, cm.Sweep(cm.Structured()), size=1))
    for suffix in ("stl", "obj", "3mf"):
        assert run("convert", "box.vtu", f"box.{suffix}").exit_code == 0
        assert cm.evaluate(cm.read_shape(f"box.{suffix}")).volumes()[0] == pytest.approx(6)


def test_convert_keeps_names(plate: Path) -> None:
    run("mesh", plate, "-o", "plate.msh")
    assert run("convert", "plate.msh", "plate.vtu").exit_code == 0
    assert set(cm.read("plate.vtu").names) == NAMES
    assert "csgmesh mesh plate.yaml" in run("convert", plate, "plate.vtu").stderr
    assert run("convert", "plate.msh", "plate.xyz").exit_code == 2


def test_schema_is_json() -> None:
    schema = json.loads(run("schema").stdout)
    assert schema["properties"].keys() >= {"csgmesh", "shapes", "domain", "mesh", "expect"}


def test_version_help_and_misspelt_commands() -> None:
    assert run("--version").stdout == f"csgmesh {cm.__version__}\n"
    for command in ("mesh", "draw", "check", "quality", "convert", "schema"):
        assert command in run("-h").stdout
        assert run(command, "--help").exit_code == 0
    result = run("mehs")
    assert result.exit_code == 2
    assert "Did you mean 'mesh'?" in result.stderr


# -- as a process ---------------------------------------------------------------------------------


def test_it_runs_as_a_module_without_a_traceback(plate: Path) -> None:
    done = python("mesh", "plate.yaml")
    assert (done.returncode, done.stderr) == (0, "")
    failed = python("mesh", "none.yaml")
    assert failed.returncode == 2
    assert failed.stderr == "none.yaml: cannot be read: No such file or directory\n"


def test_help_and_mistakes_import_no_heavy_library(plate: Path) -> None:
    wrong = changed(plate, "radius: $r", "radius: $q")
    code = (
        "import sys, csgmesh.cli.app as c\n"
        "for arguments in (['--help'], ['mesh', sys.argv[1]]):\n"
        "    try: c.app(arguments)\n"
        "    except SystemExit: pass\n"
        "heavy = ('numba', 'matplotlib', 'scipy', 'shapely', 'meshio')\n"
        "print('imported', [m for m in heavy if m in sys.modules])"
    )
    result = subprocess.run(
        [sys.executable, "-c", code, str(wrong)], capture_output=True, text=True
    )
    assert "unknown name 'q'" in result.stderr
    assert result.stdout.splitlines()[-1] == "imported []"


def test_a_reader_that_has_read_enough(plate: Path) -> None:
    command = f"{sys.executable} -m csgmesh schema | head -1; echo ${{PIPESTATUS[0]}}"
    result = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert result.stdout.splitlines() == ["{", "0"]
    assert result.stderr == ""


def test_ctrl_c_ends_it_with_its_code(plate: Path) -> None:
    slow = changed(plate, "default: 0.4", "default: 0.002")
    command = [sys.executable, "-m", "csgmesh", "mesh", str(slow), "--max-cells", "100000000"]
    with subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        text=True,
        # Shells start what runs in the background deaf to it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as process:
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=60)
    # Python itself ends by the signal where it strikes in generated code; a shell says 130 to both.
    assert process.returncode in (130, -signal.SIGINT)
    assert stderr in ("csgmesh: interrupted\n", "")
    assert not Path("plate.msh").exists()


def test_progress_is_shown_on_a_terminal_only(plate: Path) -> None:
    code = (
        "import csgmesh.cli.progress as p, time\n"
        "p.PATIENCE = 0.05\n"
        "with p.TerminalProgress() as progress:\n"
        "    progress('evaluate', 1, 1)\n"
        "    progress('refine', 3, 9)\n"
        "    time.sleep(0.5)\n"
    )
    master, slave = pty.openpty()
    try:
        subprocess.run([sys.executable, "-c", code], stderr=slave, check=True)
        shown = os.read(master, 10_000).decode()
    finally:
        os.close(slave)
        os.close(master)
    assert "refine" in shown
    silent = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert silent.stderr == silent.stdout == b""


def test_progress_says_that_kernels_are_compiled(tmp_path: Path) -> None:
    code = (
        "import csgmesh.cli.progress as p, time\n"
        "p.PATIENCE = 0.05\n"
        "with p.TerminalProgress() as progress:\n"
        "    progress('evaluate', 1, 1)\n"
        "    time.sleep(0.5)\n"
    )
    master, slave = pty.openpty()
    try:
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
        subprocess.run([sys.executable, "-c", code], stderr=slave, env=environment, check=True)
        shown = os.read(master, 10_000).decode()
    finally:
        os.close(slave)
        os.close(master)
    assert "compiling, once" in shown

"""The command line on solids and meshes of space."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import csgmesh as cm
from csgmesh.cli.app import app

WASHER = """\
csgmesh: 1
shapes:
  ring: {disk: {center: [0, 0], radius: 2}, named: rim}
  hole: {disk: {center: [0, 0], radius: 1}, named: bore}
domain: {extrude: {shape: {difference: [ring, hole]}, height: 0.5}, named: washer}
mesh: {sweep: {layers: 2}, size: 0.5}
output: [washer.msh]
"""


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


@pytest.fixture
def washer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = Path("washer.yaml")
    path.write_text(WASHER)
    assert run("mesh", path).exit_code == 0
    return path


def test_check_and_quality_of_a_solid(washer: Path) -> None:
    checked = run("check", "-v", washer)
    assert checked.exit_code == 0, checked.output
    assert "passed   samples         100,000" in checked.output
    measured = run("quality", washer)
    assert "smallest dihedral °" in measured.output
    assert "smallest dihedral angle of the cells\n  " in measured.output


def test_check_and_quality_of_a_mesh_file(washer: Path) -> None:
    checked = run("check", "washer.msh")
    assert checked.exit_code == 0
    assert checked.output.startswith("washer.msh: ok, ")
    mesh = cm.read("washer.msh")
    assert run("quality", "washer.msh").output == f"{cm.quality(mesh)}\n"
    assert set(mesh.names) == set(cm.load("washer.yaml").generate().names)


def test_a_broken_mesh_fails_with_its_place(washer: Path) -> None:
    mesh = cm.read("washer.msh")
    cells = np.array(mesh.cells["wedge"])
    cells[7] = cells[7, [0, 2, 1, 3, 5, 4]]
    cm.write("turned.npz", replace(mesh, cells={"wedge": cells}))
    found = run("check", "turned.npz")
    assert found.exit_code == 1
    assert "turned.npz: orientation: 1 cell is not positively oriented all over" in found.output
    assert "the first is cell 7 at (" in found.output


def test_refined_and_curved_meshes_are_checked_from_their_files(tmp_path: Path) -> None:
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    mesh = cm.Mesh(
        corners,
        {"tetra": [[0, 1, 2, 3]]},
        facets={"triangle": faces},
        facet_marker={"triangle": [0, 1, 2, 3]},
        boundary_names=[["floor"], ["front"], ["slope"], ["left"]],
        facet_region={"triangle": np.tile([0, -1], (4, 1))},
    )
    for name, made in (("fine", cm.refine(mesh)), ("curved", cm.elevate(cm.refine(mesh)))):
        for suffix in ("msh", "vtu", "npz"):
            path = tmp_path / f"{name}.{suffix}"
            cm.write(path, made)
            assert run("check", path).exit_code == 0
            assert "volume 0.1666666667" in run("quality", path).output


def test_the_worst_cells_are_listed(washer: Path) -> None:
    found = run("quality", "--worst", "3", "washer.msh")
    assert found.exit_code == 0
    listed = re.findall(r"^([\d.]+)° at \(\S+, \S+, \S+\) \(.*\)$", found.output, re.MULTILINE)
    assert len(listed) == 3
    assert sorted(listed, key=float) == listed

"""One domain file through every mesher."""

from typer.testing import CliRunner

import csgmesh as cm
from csgmesh.cli.app import app


def test_compare(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text(
        "{csgmesh: 1, domain: {triangle: {a: [0, 0], b: [1, 0], c: [0, 1]}}, "
        "mesh: {quad_pairing: {sweeps: 2}, size: 0.2}}"
    )
    done = CliRunner().invoke(app, ["compare", str(path)])
    assert done.exit_code == 0
    lines = {line.split("  ")[0]: line for line in done.stdout.splitlines()}
    assert "quads" in lines["as the file says"]
    assert "triangles" in lines["DelaunayRefinement"]
    assert "cannot: a structured grid knows" in lines["Structured"]


def test_rows_measure_what_they_say():
    square = cm.Box((0, 0), (1, 1))
    table = cm.compare(square, 0.25, {"grid": cm.Structured(), "fine": cm.Structured(
        counts={"box.left": 8, "box.bottom": 8})})  # fmt: skip
    grid, fine = table.rows
    assert (grid.cells, grid.worst, grid.size_error) == ("16 quads", 1.0, 0.0)
    assert abs(fine.size_error - 0.6931) < 1e-3
    assert grid.megabytes > 0
    assert "size error" in str(table)


def test_solids_go_through_the_meshers_of_space(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text(
        "{csgmesh: 1, domain: {box: {lo: [0, 0, 0], hi: [1, 1, 1]}}, mesh: {size: 0.5}}"
    )
    done = CliRunner().invoke(app, ["compare", str(path)])
    assert done.exit_code == 0, done.stderr
    lines = {line.split("  ")[0]: line for line in done.stdout.splitlines()}
    assert "tetras" in lines["Octree"]
    assert "triangles" in lines["SurfaceRefinement"]
    assert "16 wedges" in lines["Sweep"]
    table = cm.compare(
        cm.Extrude(cm.Box((0, 0), (1, 1)), 1), 0.25, {"grid": cm.Sweep(cm.Structured())}
    )
    (grid,) = table.rows
    assert (grid.cells, grid.worst, grid.min_angle) == ("64 hexahedra", 1.0, 90.0)
    assert grid.size_error < 1e-12

"""Run every solid of examples/solids.py through every mesher: ``python docs/make_matrix.py``.

Each combination runs in a process of its own, so that one that fails, hangs or crashes costs only
its own line; it is shown as failed, with the reason. Writes solids-matrix.json with the figures,
pictures below images/matrix, and the page solids-matrix.md.

``python docs/make_matrix.py gear mixed`` runs the combinations whose solid and mesher are named,
keeps the others' figures, and writes the page again; ``--page`` alone only writes the page.
"""

from __future__ import annotations

import argparse
import json
import platform
import runpy
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

import csgmesh as cm

HERE = Path(__file__).parent
SOLIDS = HERE.parent / "examples" / "solids.py"
FIGURES = HERE / "solids-matrix.json"
PAGE = HERE / "solids-matrix.md"
IMAGES = HERE / "images" / "matrix"
#: Seconds that one combination may take, and all of them.
LONGEST, ALL_IN_ALL = 200.0, 900.0
#: What takes less is timed once more.
SHORT = 20.0

#: Wanted edge lengths: some ten thousand cells each, or what the solid's narrowest parts ask for.
SIZES = {
    "bracket": 2.5,
    "pipe_tee": 0.15,
    "ball_in_box": 0.12,
    "gear": 0.8,
    "bowl": 0.35,
    "chess_piece": 0.12,
    "crowd": 0.4,
}
#: Where on the y axis pictures are cut, and how far above the ground they are seen from, degrees.
VIEWS = {
    "bracket": (20.0, 20.0),
    "pipe_tee": (0.0, 20.0),
    "ball_in_box": (1.0, 20.0),
    "gear": (0.0, 45.0),
    "bowl": (0.0, 25.0),
    "chess_piece": (0.0, 15.0),
    "crowd": (5.0, 20.0),
}
#: Solids that are swept.
SWEPT = ("gear", "bowl", "chess_piece")
#: The mesher as it is written, and the solids it is for, by its short name.
MESHERS: dict[str, tuple[str, tuple[str, ...]]] = {
    "surface": ("SurfaceRefinement()", tuple(SIZES)),
    "tetra": ('Octree(cells="tetra")', tuple(SIZES)),
    "mixed": ('Octree(cells="mixed")', tuple(SIZES)),
    "hexahedron": ('Octree(cells="hexahedron")', tuple(SIZES)),
    "sweep": ("Sweep()", SWEPT),
    "sweep-quads": ("Sweep(QuadPairing())", SWEPT),
    "sweep-o-grid": ('Sweep(QuadPairing(), axis="o-grid")', ("bowl", "chess_piece")),
}


def mesher_of(name: str) -> Any:
    """The mesher of a short name."""
    if name == "sweep":
        return cm.Sweep()
    if name.startswith("sweep"):
        return cm.Sweep(cm.QuadPairing(), axis="o-grid" if name == "sweep-o-grid" else "wedges")
    return cm.SurfaceRefinement() if name == "surface" else cm.Octree(cells=name)


def measured(solid: str, mesher: str) -> dict[str, Any]:
    """The figures of one combination; draws its picture."""
    shape, method = runpy.run_path(str(SOLIDS))["ALL"][solid](), mesher_of(mesher)
    mesh, seconds = timed(shape, method, SIZES[solid])
    if seconds < SHORT:
        # The first time may have been the compiler's.
        mesh, seconds = timed(shape, method, SIZES[solid])
    draw(mesh, solid, mesher)
    quality = cm.quality(mesh)
    what = "angle" if mesher == "surface" else "dihedral angle"
    values = quality.min_angle if mesher == "surface" else quality.min_dihedral
    if list(mesh.cells) == ["hexahedron"]:
        what, values = "scaled Jacobian", quality.scaled_jacobian
    certificate = cm.check(mesh, shape)
    return {
        "cells": {kind: len(rows) for kind, rows in mesh.cells.items()},
        "hexahedra": hexahedral_share(mesh),
        "measure": what,
        "worst": float(values.min()),
        "mean": float(values.mean()),
        "seconds": seconds,
        "check": "" if certificate.ok else str(certificate.failures[0])[:200],
    }


def timed(shape: Any, method: Any, size: float) -> tuple[cm.Mesh, float]:
    """A mesh, and the processor's time."""
    begun = time.process_time()
    mesh = cm.generate(shape, method, size=size)
    return mesh, time.process_time() - begun


def hexahedral_share(mesh: cm.Mesh) -> float:
    """Share of the volume in hexahedra."""
    if "hexahedron" not in mesh.cells:
        return 0.0
    volume, before = cm.quality(mesh).volume, list(mesh.cells).index("hexahedron")
    start = sum(len(rows) for rows in list(mesh.cells.values())[:before])
    return float(volume[start:][: len(mesh.cells["hexahedron"])].sum() / volume.sum())


def draw(mesh: cm.Mesh, solid: str, mesher: str) -> None:
    """A small picture, cut open."""
    from PIL import Image

    IMAGES.mkdir(parents=True, exist_ok=True)
    path = picture(solid, mesher)
    place, above = VIEWS[solid]
    cut = (0.0, place, 0.0), (0.0, -1.0, 0.0)
    look = {"cut": cut, "view": (-70.0, above)}
    cm.draw(mesh, path, legend=False, title="", figsize=(3.6, 3.2), dpi=110, **look)
    with Image.open(path) as image:
        small = image.convert("RGB").quantize(96)
    small.save(path, optimize=True)


def picture(solid: str, mesher: str) -> Path:
    """Where the picture of a combination is."""
    return IMAGES / f"{solid}-{mesher}.png"


def run(solid: str, mesher: str, seconds: float) -> dict[str, Any]:
    """The figures of one combination from a process of its own, or why there are none."""
    command = [sys.executable, __file__, "--here", solid, mesher]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return {"failed": f"took more than {seconds:.0f} s"}
    if done.returncode == 0:
        found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        return found
    said = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    return {"failed": said.split("csgmesh.errors.", 1)[-1][:300]}


def row(solid: str, mesher: str, found: dict[str, Any]) -> str:
    """A row of the table."""
    start = f"| {solid.replace('_', ' ')}, {SIZES[solid]} | `{MESHERS[mesher][0]}` |"
    if "failed" in found:
        return f"{start} **failed**: {found['failed'].replace('|', '/')} | | | | |"
    unit, digits = ("", 3) if found["measure"] == "scaled Jacobian" else ("°", 1)
    cells = f"{sum(found['cells'].values()):,}"
    if len(found["cells"]) > 1 and found["hexahedra"]:
        cells += f", {100 * found['hexahedra']:.0f} % of the volume in hexahedra"
    check = f"**fails**: {found['check'].replace('|', '/')}" if found["check"] else "green"
    return (
        f"{start} {cells} | {found['measure']} {found['worst']:.{digits}f}{unit} "
        f"| {found['mean']:.{digits}f}{unit} | {found['seconds']:.2f} s | {check} |"
    )


def write_page(figures: dict[str, dict[str, Any]]) -> None:
    """The page of all figures that there are."""
    page = [
        "# Seven solids through every mesher of space",
        "",
        "[solids.py](../examples/solids.py) meshed: the smallest angle of each triangle, the",
        "smallest dihedral angle of each cell, or the smallest scaled Jacobian where all cells are",
        "hexahedra; their worst and their mean. The time is the processor's for the whole call",
        "from tree to mesh, with warm kernels; the check is `cm.check` with the shape given. What",
        "fails is shown as failed. At the axis of a revolution a sweep has cells as thin as its",
        "turns are small, unless an O-grid fills it. Drawn up by `docs/make_matrix.py` with",
        f"csgmesh {cm.__version__}, Python {platform.python_version()}, numpy {version('numpy')}, "
        f"manifold3d {version('manifold3d')}.",
        "",
        "| solid, size | mesher | cells | worst | mean | time | check |",
        "|---|---|--:|--:|--:|--:|---|",
    ]
    known = [(s, m) for s, m in combinations([]) if f"{s} {m}" in figures]
    page += [row(s, m, figures[f"{s} {m}"]) for s, m in known]
    for solid in dict.fromkeys(s for s, _ in known):
        drawn = [m for s, m in known if s == solid and picture(s, m).exists()]
        if not drawn:
            continue
        page += ["", f"## {solid.replace('_', ' ').capitalize()}", ""]
        page += [" | ".join(["", *(f"`{MESHERS[m][0]}`" for m in drawn), ""]).strip()]
        page += ["|".join(["", *("---" for _ in drawn), ""])]
        links = [f"![{solid}, {m}](images/matrix/{picture(solid, m).name})" for m in drawn]
        page += [" | ".join(["", *links, ""]).strip()]
    PAGE.write_text("\n".join([*page, ""]))


def combinations(chosen: list[str]) -> list[tuple[str, str]]:
    """Solids and meshers; of each kind only the chosen ones, where any are chosen."""
    solids = [s for s in SIZES if s in chosen] or list(SIZES)
    meshers = [m for m in MESHERS if m in chosen] or list(MESHERS)
    return [(s, m) for s in solids for m in meshers if s in MESHERS[m][1]]


def main() -> None:
    """Run what is asked for and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("chosen", nargs="*", choices=[[], *SIZES, *MESHERS], metavar="NAME")
    parser.add_argument("--page", action="store_true", help="write the page, run nothing")
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.here:
        print(json.dumps(measured(*asked.chosen)))
        return
    figures = json.loads(FIGURES.read_text()) if FIGURES.exists() else {}
    end = time.monotonic() + ALL_IN_ALL
    for solid, mesher in [] if asked.page else combinations(asked.chosen):
        left = min(LONGEST, end - time.monotonic())
        if left < 1.0:
            print(f"no time left for {solid} {mesher}", flush=True)
            continue
        figures[f"{solid} {mesher}"] = found = run(solid, mesher, left)
        if "failed" in found:
            picture(solid, mesher).unlink(missing_ok=True)
        FIGURES.write_text(json.dumps(figures, indent=1, sort_keys=True) + "\n")
        print(row(solid, mesher, found), flush=True)
    write_page(figures)


if __name__ == "__main__":
    main()

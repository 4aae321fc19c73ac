"""Run every solid of examples/solids.py through every mesher: ``python docs/make_matrix.py``.

Each combination runs in a process of its own, so that one that fails or takes too long costs only
its own line; it is shown as failed, with the reason. Writes docs/solids-matrix.md.
"""

from __future__ import annotations

import json
import platform
import runpy
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

import csgmesh as cm

HERE = Path(__file__).parent
SOLIDS = HERE.parent / "examples" / "solids.py"
LONGEST = 300.0

#: Wanted edge lengths: some ten thousand cells each.
SIZES = {
    "bracket": 2.5,
    "pipe_tee": 0.15,
    "ball_in_box": 0.12,
    "gear": 0.8,
    "bowl": 0.35,
    "chess_piece": 0.12,
    "crowd": 0.4,
}

#: The class of each mesher, its options, and the solids it is for; None for all.
SWEPT = ("gear", "bowl", "chess_piece")
MESHERS: dict[str, tuple[str, dict[str, Any], tuple[str, ...] | None]] = {
    "SurfaceRefinement": ("SurfaceRefinement", {}, None),
    'Octree("tetra")': ("Octree", {"cells": "tetra"}, None),
    'Octree("mixed")': ("Octree", {"cells": "mixed"}, None),
    'Octree("hexahedron")': ("Octree", {"cells": "hexahedron"}, None),
    "Sweep": ("Sweep", {}, SWEPT),
    "Sweep(QuadPairing)": ("Sweep", {"profile": "QuadPairing"}, SWEPT),
}


def measured(solid: str, mesher: str) -> dict[str, Any]:
    """One line of the matrix."""
    name, options, _ = MESHERS[mesher]
    shape = runpy.run_path(str(SOLIDS))["ALL"][solid]()
    if "profile" in options:
        method = getattr(cm, name)(getattr(cm, options["profile"])())
    else:
        method = getattr(cm, name)(**options)
    # A small mesh first, so that no time is the compiler's.
    cm.generate(cm.Extrude(cm.Disk((0, 0), 1), 1), method, size=0.5)
    begun = time.process_time()
    mesh = cm.generate(shape, method, size=SIZES[solid])
    seconds = time.process_time() - begun
    what, values = quality_of(mesh)
    certificate = cm.check(mesh, shape)
    failed = [str(failure) for failure in certificate.failures]
    return {
        "cells": mesh.n_cells or mesh.n_facets,
        "measure": what,
        "worst": float(values.min()),
        "mean": float(values.mean()),
        "seconds": seconds,
        "check": "green" if certificate.ok else f"fails: {failed[0][:100] if failed else ''}",
    }


def quality_of(mesh: cm.Mesh) -> tuple[str, np.ndarray]:
    """The smallest angle a triangle, the smallest dihedral angle or scaled Jacobian a cell."""
    solid = {kind for kind in mesh.cells if kind not in ("triangle", "quad")}
    if not solid:
        tables = [*mesh.cells.items()] or [*mesh.facets.items()]
        return "angle", np.concatenate([_angles(mesh.points[rows]) for _, rows in tables])
    quality = cm.quality(mesh)
    if solid == {"hexahedron"}:
        return "Jacobian", quality.scaled_jacobian
    return "dihedral", quality.min_dihedral


def _angles(corner: np.ndarray) -> np.ndarray:
    ahead = np.roll(corner, -1, axis=1) - corner
    back = np.roll(corner, 1, axis=1) - corner
    sine = np.sqrt((np.cross(ahead, back) ** 2).sum(axis=2))
    return np.degrees(np.arctan2(sine, (ahead * back).sum(axis=2))).min(axis=1)


def run(solid: str, mesher: str) -> dict[str, Any]:
    """The same in a process of its own."""
    command = [sys.executable, __file__, solid, mesher]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return {"failed": f"more than {LONGEST:.0f} s"}
    if done.returncode == 0:
        found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        return found
    said = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    return {"failed": said.split("errors.", 1)[-1][:160]}


def line(solid: str, mesher: str, found: dict[str, Any]) -> str:
    """A row of the table."""
    start = f"| {solid.replace('_', ' ')} | `{mesher}` |"
    if "failed" in found:
        return f"{start} **failed**: {found['failed'].replace('|', '/')} | | | | |"
    unit = {"angle": "°", "dihedral": "°", "Jacobian": ""}[found["measure"]]
    digits = 1 if unit else 3
    return (
        f"{start} {found['cells']:,} | {found['measure']} {found['worst']:.{digits}f}{unit} "
        f"| {found['mean']:.{digits}f}{unit} | {found['seconds']:.2f} s | {found['check']} |"
    )


def main() -> None:
    """Write the page."""
    rows = []
    for solid in SIZES:
        for mesher, (name, _, only) in MESHERS.items():
            if name in cm.__all__ and (only is None or solid in only):
                rows.append(line(solid, mesher, run(solid, mesher)))
                print(rows[-1], flush=True)
    page = [
        "# Seven solids through every mesher of space",
        "",
        "[solids.py](../examples/solids.py) meshed: the smallest angle of each triangle, the",
        "smallest dihedral angle of each cell, or the smallest scaled Jacobian where all cells are",
        "hexahedra; their worst and their mean. The time is the processor's for the whole call",
        "from tree to mesh, with warm kernels; the check is `cm.check` with the shape given. What",
        "fails is shown as failed. Drawn up by `docs/make_matrix.py` with csgmesh",
        f"{cm.__version__}, Python {platform.python_version()}, numpy {version('numpy')} and "
        f"manifold3d {version('manifold3d')}.",
        "",
        "| solid | mesher | cells | worst | mean | time | check |",
        "|---|---|--:|--:|--:|--:|---|",
        *rows,
        "",
    ]
    (HERE / "solids-matrix.md").write_text("\n".join(page))


if __name__ == "__main__":
    if len(sys.argv) == 3:
        print(json.dumps(measured(*sys.argv[1:])))
    else:
        main()

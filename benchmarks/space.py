"""Meshing of solids beside Gmsh, TetGen, Netgen and rapidmesh: cells a second and what they are.

Run with ``python benchmarks/space.py [SECTION]…``; sections are uniform, graded, surface,
hexahedra, memory and evaluation, all unless named. Each measurement has a process of its own and a
time limit, so that all of them end within some twelve minutes. What a section finds replaces what
results/space.json had of it; ``--dry`` writes nothing, ``--small`` asks for a tenth of the cells
and writes nothing.

Times are processor times of whole calls on one thread, from the description to arrays. TetGen
knows no solids: it gets csgmesh's surface, whose time counts.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from report import RESULTS, machine, show
from space_solids import MODELS

Row = dict[str, Any]
Rows = list[Row]

PACKAGES = ("gmsh", "tetgen", "netgen-mesher", "rapidmesh", "manifold3d")
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
#: Seconds that a measurement may take.
LIMIT = 90.0
#: Cells times the cube of the edge length, which hardly depends on it.
UNIFORM = {
    "ours": 15.5,
    "gmsh_hxt": 7.1,
    "gmsh_delaunay": 8.1,
    "rapidmesh": 10.0,
    "tetgen": 20.0,
    "netgen": 6.5,
}
#: Peers without a bar are slow enough to be measured once.
REPEATED = ("ours", "gmsh_hxt")
#: Triangles times the square of the edge length.
SURFACE = {"our_surface": 29.8, "gmsh_surface": 29.2}
#: Edge lengths at the bore at which both make about so many cells.
GRADED = {
    100_000: {"ours_graded": 0.025, "gmsh_graded": 0.0115},
    500_000: {"ours_graded": 0.0105, "gmsh_graded": 0.00485},
}


def measure(function: str, arguments: list[Any], limit: float = LIMIT) -> Row:
    """A row from a process of its own, or why there is none."""
    here = Path(__file__).parent
    command = [sys.executable, str(here / "space_calls.py"), function, json.dumps(arguments)]
    environment = {**os.environ, **ONE_THREAD}
    try:
        out = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=limit, check=False
        )
    except subprocess.TimeoutExpired:
        return {"failed": f"stopped after {limit:g} s"}
    if out.returncode:
        lines = out.stderr.strip().splitlines() or [f"ended with status {out.returncode}"]
        return {"failed": lines[-1][:200]}
    return dict(json.loads(out.stdout.strip().splitlines()[-1]))


def mesher(name: str, size: float, repeats: int) -> Row:
    """What one mesher takes for an edge length."""
    print(f"  {name}, {size:.4g}", flush=True)
    return {"mesher": name, **measure("mesher", [name, size, repeats])}


def bar(what: str, ours: float | None, theirs: float | None, least: float) -> Row:
    """A bar of the form "so many times as fast": `ours` over `theirs`."""
    if not ours or not theirs:
        return {"bar": what, "least": least, "met": "not measured"}
    factor = ours / theirs
    return {
        "bar": what,
        "ours": ours,
        "theirs": theirs,
        "factor": factor,
        "least": least,
        "met": "yes" if factor >= least else "NO",
    }


def _pace(rows: Rows, name: str, wanted: int) -> float | None:
    for row in rows:
        if row["mesher"] == name and row["wanted"] == wanted:
            return row.get("cells_per_second")
    return None


def uniform(share: float) -> tuple[Rows, Rows]:
    """Box minus ball and bore, one size, 10⁵ and 10⁶ tetrahedra."""
    rows: Rows = []
    bars: Rows = []
    for cells in (int(share * 10**5), int(share * 10**6)):
        for name, density in UNIFORM.items():
            size = (density / cells) ** (1 / 3)
            repeats = 1 if name not in REPEATED else (5 if cells <= 10**5 else 3)
            rows.append({"wanted": cells, **mesher(name, size, repeats)})
        ours = _pace(rows, "ours", cells)
        for name, least in (("gmsh_hxt", 3.0), ("tetgen", 10.0)):
            what = f"tets/s, {cells:.0e} tets, over {name}'s"
            bars.append(bar(what, ours, _pace(rows, name, cells), least))
    return rows, bars


def graded(share: float) -> tuple[Rows, Rows]:
    """Edges 1 : 100 from the bore outwards, at like numbers of cells."""
    rows: Rows = []
    bars: Rows = []
    for full, sizes in GRADED.items():
        wanted = int(share * full)
        for name, fine in sizes.items():
            repeats = 3 if wanted <= 10**5 or name == "ours_graded" else 1
            rows.append({"wanted": wanted, **mesher(name, fine / share**0.55, repeats)})
        paces = [_pace(rows, name, wanted) for name in sizes]
        bars.append(bar(f"tets/s, graded, about {wanted:.0e} tets", *paces, 2.0))
    return rows, bars


def surface(share: float) -> tuple[Rows, Rows]:
    """The surface alone, 10⁴ and 10⁵ triangles."""
    rows: Rows = []
    bars: Rows = []
    for cells in (int(share * 10**4), int(share * 10**5)):
        for name, density in SURFACE.items():
            rows.append({"wanted": cells, **mesher(name, (density / cells) ** 0.5, 5)})
        paces = [_pace(rows, name, cells) for name in SURFACE]
        bars.append(bar(f"triangles/s, {cells:.0e} triangles", *paces, 3.0))
    return rows, bars


def hexahedra(share: float) -> tuple[Rows, Rows]:
    """Hexahedra alone, and with others around a core of them."""
    rows: Rows = []
    bars: Rows = []
    for kind in ("hexahedron", "mixed"):
        for size in (0.04, 0.025, 0.0115):
            print(f"  {kind}, {size:g}", flush=True)
            row = measure("hexahedra", [kind, size / share ** (1 / 3)])
            rows.append({"kind": kind, **row})
            if kind == "hexahedron" and "cells" in row:
                label = f"hexahedra/s over a million, {row['cells']:,} of them"
                bars.append(bar(label, row["cells_per_second"], 1e6, 1.0))
    return rows, bars


def memory(share: float) -> tuple[Rows, Rows]:
    """Bytes that numpy allocates beyond the result, 10⁵ and 10⁶ tetrahedra."""
    rows: Rows = []
    bars: Rows = []
    for cells in (int(share * 10**5), int(share * 10**6)):
        row = measure("memory", [(UNIFORM["ours"] / cells) ** (1 / 3)])
        rows.append(row)
        bars.append(
            bar(f"300 over bytes a tet, {cells:.0e}", 300.0, row.get("bytes_per_cell"), 1.0)
        )
    return rows, bars


def evaluation(share: float) -> tuple[Rows, Rows]:
    """Evaluation of solids of 10⁵ facets beside manifold3d's own boolean."""
    rows: Rows = []
    bars: Rows = []
    for model in MODELS:
        row = measure("evaluation", [model, share], 2 * LIMIT)
        rows.append({"model": model, **row})
        theirs, ours = row.get("manifold3d_seconds"), row.get("seconds")
        what = f"twice manifold3d's time over ours, {model}"
        bars.append(bar(what, 2.0 * theirs if theirs else None, ours, 1.0))
    return rows, bars


SECTIONS: dict[str, Callable[[float], tuple[Rows, Rows]]] = {
    s.__name__: s for s in (uniform, graded, surface, hexahedra, memory, evaluation)
}


def keep(name: str, rows: Rows, bars: Rows) -> None:
    """Put a section into results/space.json in place of what was there of it."""
    path = RESULTS / "space.json"
    found = json.loads(path.read_text()) if path.exists() else {}
    found[name] = {"machine": machine(*PACKAGES), "rows": rows, "bars": bars}
    RESULTS.mkdir(exist_ok=True)
    path.write_text(json.dumps({s: found[s] for s in SECTIONS if s in found}, indent=1) + "\n")


def main() -> None:
    """Run the sections named on the command line."""
    flags = {word for word in sys.argv[1:] if word.startswith("--")}
    wanted = [word for word in sys.argv[1:] if word not in flags] or list(SECTIONS)
    for name in wanted:
        if name not in SECTIONS:
            raise SystemExit(f"no section {name!r}; there are {', '.join(SECTIONS)}")
    if flags - {"--dry", "--small"}:
        raise SystemExit("flags are --dry and --small")
    for name in wanted:
        print(name, flush=True)
        rows, bars = SECTIONS[name](0.1 if "--small" in flags else 1.0)
        show(rows)
        show(bars)
        if not flags:
            keep(name, rows, bars)


if __name__ == "__main__":
    main()

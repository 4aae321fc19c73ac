"""Structured grids and quads alone: speed, and quality beside Gmsh's ways to make quads.

``python benchmarks/grids.py`` measures everything and keeps ``results/grids_*.json``; with
``--small`` at sizes that take seconds, keeping nothing. Needs the extra ``peers``.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from report import save, show

import csgmesh as cm

Rows = list[dict[str, Any]]
TWO_DISKS = cm.Box((0, 0), (1, 1)) - cm.Disk((0.3, 0.3), 0.15) - cm.Disk((0.7, 0.7), 0.15)
SHAPES = {
    "square": cm.Box((0, 0), (1, 1)),
    "disk": cm.Disk((0, 0), 1),
    "square minus disk": cm.Box((0, 0), (1, 1)) - cm.Disk((0.5, 0.5), 0.2),
    "two regions": cm.Regions({"a": cm.Box((0, 0), (1, 1)), "b": cm.Disk((0.4, 0.5), 0.2)}),
}
#: Name, Gmsh's algorithm for the plane, for recombination, and whether it subdivides.
GMSH = (
    ("frontal for quads, blossom", 8, 1, 0),
    ("packing of parallelograms, blossom", 9, 1, 0),
    ("frontal for quads, full quads", 8, 3, 0),
    ("frontal, simple, subdivided", 6, 0, 1),
)


def processor_seconds(run: Callable[[], Any], repeats: int = 5) -> tuple[Any, float]:
    """Result of a call and the median of its processor time, after one that compiles."""
    result, times = run(), []
    for _ in range(repeats):
        start = time.process_time()
        result = run()
        times.append(time.process_time() - start)
    return result, statistics.median(times)


def speed(count: int) -> Rows:
    """Quads per second of processor time, whole calls on ready domains."""
    rows: Rows = []
    for mesher, n in ((cm.Structured(), count), (cm.QuadPairing(), count // 10)):
        for name, shape in SHAPES.items():
            domain = cm.evaluate(shape)
            size = float(np.sqrt(domain.areas().sum() / n))
            mesh, seconds = processor_seconds(lambda m=mesher, d=domain, h=size: m.generate(d, h))
            rows.append({
                "mesher": type(mesher).__name__, "case": name, "quads": mesh.n_cells,
                "processor s": seconds, "quads/s": mesh.n_cells / seconds, **shares(mesh),
            })  # fmt: skip
    return rows


def shares(mesh: cm.Mesh) -> dict[str, float]:
    """Quality of quads, and how many inner vertices have other than four of them."""
    quality = cm.quality(mesh)
    inner = np.ones(mesh.n_points, bool)
    inner[mesh.facets["line"]] = False
    quads = np.bincount(mesh.cells["quad"].ravel(), minlength=mesh.n_points)
    return {
        "worst SICN": float(quality.sicn.min()),
        "mean SICN": float(quality.sicn.mean()),
        "irregular": float((quads[inner] != 4).mean()),
    }


def quality_beside_gmsh(_: int) -> Rows:
    """Square minus two disks, h = 0.03."""
    domain = cm.evaluate(TWO_DISKS)
    mesh, seconds = processor_seconds(lambda: cm.QuadPairing().generate(domain, 0.03))
    rows: Rows = [
        {"mesher": "csgmesh QuadPairing", "quads": mesh.n_cells, "triangles": 0,
         "processor s": seconds, **shares(mesh)}
    ]  # fmt: skip
    return rows + [_gmsh(*options) for options in GMSH]


def _gmsh(name: str, algorithm: int, recombination: int, subdivision: int) -> dict[str, Any]:
    import gmsh

    gmsh.initialize()
    for option, value in (
        ("General.Terminal", 0), ("General.NumThreads", 1), ("Mesh.Algorithm", algorithm),
        ("Mesh.RecombineAll", 1), ("Mesh.RecombinationAlgorithm", recombination),
        ("Mesh.SubdivisionAlgorithm", subdivision), ("Mesh.MeshSizeMax", 0.03),
        ("Mesh.MeshSizeMin", 0.03),
    ):  # fmt: skip
        gmsh.option.setNumber(option, value)
    occ = gmsh.model.occ
    square = occ.addRectangle(0, 0, 0, 1, 1)
    disks = [(2, occ.addDisk(c, c, 0, 0.15, 0.15)) for c in (0.3, 0.7)]
    occ.cut([(2, square)], disks)
    occ.synchronize()
    start = time.process_time()
    gmsh.model.mesh.generate(2)
    seconds = time.process_time() - start
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    cells = [
        gmsh.model.mesh.getElementsByType(kind)[1].reshape(-1, k) for kind, k in ((3, 4), (2, 3))
    ]
    gmsh.finalize()
    number = np.zeros(int(tags.max()) + 1, np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    points = xyz.reshape(-1, 3)[:, :2]
    quads = number[cells[0].astype(np.int64)]
    sicn = cm.quality(cm.Mesh(points, {"quad": quads})).sicn
    return {
        "mesher": f"Gmsh {name}", "quads": len(quads), "triangles": len(cells[1]),
        "processor s": seconds, "worst SICN": float(sicn.min()), "mean SICN": float(sicn.mean()),
    }  # fmt: skip


SECTIONS = {"speed": (speed, 2_000_000), "quality": (quality_beside_gmsh, 0)}


def main(words: list[str]) -> None:
    """Run sections by name."""
    is_small = "--small" in words
    for name in [w for w in words if w != "--small"] or SECTIONS:
        measure, count = SECTIONS[name]
        rows = measure(20_000 if is_small else count)
        print(f"\n{name}: {(measure.__doc__ or '').strip()}")
        show(rows)
        if not is_small:
            save(f"grids_{name}", rows, "gmsh")


if __name__ == "__main__":
    main(sys.argv[1:])

"""The quadtree mesher beside Triangle: cells a second by processor time, and what they are like.

Run with ``python benchmarks/quadtree.py``; writes results/quadtree.json.
"""

from __future__ import annotations

import json
import os
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from peers import triangle_graded, triangle_package
from report import RESULTS, machine

import csgmesh as cm
from csgmesh.tree import LinearTree

N = 10**6
REPEATS = 3
HOLES = cm.Box((0, 0), (1, 1)) - cm.Disk((0.3, 0.3), 0.15) - cm.Disk((0.7, 0.65), 0.2)


def seconds(run: Callable[[], Any], repeats: int = REPEATS) -> tuple[float, Any]:
    """Median processor time of a call after a warm one, and its last result."""
    result = run()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        result = run()
        times.append(time.process_time() - start)
    return statistics.median(times), result


def row(case: str, run: Callable[[], cm.Mesh], peer: float | None = None) -> dict[str, Any]:
    """What a mesh took and is; `peer`: cells a second of Triangle."""
    taken, mesh = seconds(run)
    quality = cm.quality(mesh)
    found = {
        "case": case,
        "cells": mesh.n_cells,
        "seconds": taken,
        "per_second": mesh.n_cells / taken,
        "min_angle": float(quality.min_angle.min()),
        "mean_min_angle": float(quality.min_angle.mean()),
    }
    if "quad" in mesh.cells:
        found["min_sicn"] = float(np.nanmin(quality.sicn))
        found["mean_sicn"] = float(np.nanmean(quality.sicn))
    if peer is not None:
        found["times_triangle"] = found["per_second"] / peer
    print({k: float(f"{v:.4g}") if isinstance(v, float) else v for k, v in found.items()})
    return found


def main() -> None:
    """All rows."""
    rows = []
    square, disk = (cm.evaluate(s) for s in (cm.Box((0, 0), (1, 1)), cm.Disk((0, 0), 1)))
    for name, domain, area in (("square", square, 1.0), ("disk", disk, np.pi)):
        taken, out = seconds(lambda d=domain, a=area: triangle_package(d, a / N / 0.57), 1)
        rate = len(out[1]) / taken
        rows.append({"case": f"{name}, Triangle", "cells": len(out[1]), "per_second": rate})
        for cells, share in (("triangle", 0.433), ("mixed", 1.0), ("quad", 1.0)):
            h, mesher = float(np.sqrt(area / share / N)), cm.Quadtree(cells=cells)
            peer = rate if cells == "triangle" else None
            rows.append(row(f"{name}, {cells}", lambda: mesher.generate(domain, h), peer))  # noqa: B023

    def size(p: np.ndarray) -> np.ndarray:
        return 2e-5 + 0.02 * np.hypot(p[:, 0] - 0.4, p[:, 1] - 0.3)

    taken, out = seconds(lambda: triangle_graded(square, size), 1)
    rows.append({"case": "graded 1:1000, Triangle", "per_second": len(out[1]) / taken})
    rate = len(out[1]) / taken
    rows.append(row("graded 1:1000", lambda: cm.Quadtree().generate(square, size), rate))
    rows.append(row("two holes, quad", lambda: cm.generate(HOLES, cm.Quadtree(cells="quad"), 0.03)))
    tree = LinearTree.root((0, 0), (1, 1)).refined_where(
        lambda lo, s: s[:, 0] > 0.0026 * np.abs(np.hypot(*(lo + s / 2 - 0.5).T) - 0.3) + 2.2e-4,
        2 * 10**7,
    )
    taken, even = seconds(tree.balanced, 1)
    rows.append({"case": "balance", "leaves": even.n_leaves, "seconds": taken})
    print(rows[-1])
    load = os.getloadavg()[0]
    result = {"machine": machine("triangle"), "load": load, "rows": rows}
    (RESULTS / "quadtree.json").write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

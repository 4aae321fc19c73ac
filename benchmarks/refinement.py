"""How fast meshes are refined, smoothed and curved, and points triangulated.

    python benchmarks/refinement.py            all sections, a million cells
    python benchmarks/refinement.py 100000     fewer

Times are of the processor, medians of several runs; new triangles a second where that is asked for.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from report import save, show
from scipy.spatial import Delaunay

import csgmesh as cm

Rows = list[dict[str, Any]]
METHODS = ("red-green", "longest edge", "newest vertex")
SHAPES = {
    "disk": cm.Disk((0, 0), 1),
    "ellipse": cm.Ellipse((0, 0), (2, 1), angle=20),
    "half disk": cm.Disk((0, 0), 1) & cm.HalfSpace((0, 0), (0, 1)),
    "lens": cm.Disk((0, 0), 1) & cm.Disk((1, 0), 1),
    "crescent": cm.Disk((0, 0), 1) - cm.Disk((0.5, 0), 0.8),
}


def processor_seconds(run: Callable[[], Any], repeats: int = 5) -> float:
    """Median processor time of a call, after one that may compile."""
    run()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return statistics.median(times)


def speed(cells: int) -> Rows:
    """New triangles a second."""
    mesh = cm.generate(cm.Disk((0, 0), 1), size=float(np.sqrt(7.2 / cells)))
    centres = mesh.points[mesh.cells["triangle"]].mean(axis=1)
    marks = {
        "a spot, 9 %": np.hypot(*centres.T) < 0.3,
        "10 % at random": np.random.default_rng(1).random(mesh.n_cells) < 0.1,
        "half": centres[:, 0] > 0,
    }
    rows = [_speed("all", mesh, None, "red-green")]
    for name, mark in marks.items():
        rows += [_speed(name, mesh, mark, method) for method in METHODS]
    return rows


def _speed(name: str, mesh: cm.Mesh, mark: np.ndarray | None, method: str) -> dict[str, Any]:
    fine = cm.refine(mesh, mark, method)
    parent = np.bincount(fine.cell_parent["triangle"], minlength=mesh.n_cells)
    new = int(parent[parent > 1].sum())
    seconds = processor_seconds(lambda: cm.refine(mesh, mark, method))
    return {
        "refine": name,
        "method": method,
        "cells": mesh.n_cells,
        "new": new,
        "s": seconds,
        "million new/s": new / seconds / 1e6,
    }


def levels() -> Rows:
    """Smallest angle over ten levels towards a point, beside what is promised."""
    first = cm.generate(cm.Polygon([(0, 0), (3, 0), (2.2, 1.9), (0.3, 1.2)]), size=0.7)
    macro = cm.quality(first).min_angle.min()
    bounds = {"red-green": np.degrees(np.arctan(np.tan(np.radians(macro)) / 3))}
    rows = []
    for method in METHODS:
        mesh = first
        for level in range(10):
            centres = mesh.points[mesh.cells["triangle"]].mean(axis=1)
            near = np.hypot(*(centres - [0.3, 1.2]).T) < 1.5 * 0.6**level
            mesh = cm.refine(mesh, near, method)
        rows.append({
            "ten levels": method,
            "cells": mesh.n_cells,
            "first mesh": float(macro),
            "promised": float(bounds.get(method, macro / 2)),
            "smallest angle": float(cm.quality(mesh).min_angle.min()),
        })  # fmt: skip
    return rows


def areas() -> Rows:
    """Errors of areas with curved cells, and observed orders."""
    rows = []
    for name, shape in SHAPES.items():
        exact = cm.evaluate(shape).areas().sum()
        for nodes in ("lobatto", "equispaced"):
            for order in (2, 3, 4, 5):
                mesh, errors = cm.generate(shape, size=0.5, deviation=0.05), []
                for _ in range(4):
                    area = cm.quality(cm.elevate(mesh, order, nodes)).total_area
                    errors.append(float(abs(area - exact)))
                    mesh = cm.refine(mesh)
                steps = [(a, b) for a, b in pairwise(errors) if b > 1e-13 * exact]
                observed = [float(np.log2(a / b)) for a, b in steps]
                rows.append({
                    "area": name,
                    "nodes": nodes,
                    "order": order,
                    "coarsest": errors[0],
                    "finest": errors[-1],
                    "observed": round(observed[-1], 2) if observed else "rounding",
                })  # fmt: skip
    return rows


def others(cells: int) -> Rows:
    """Smoothing, curving and triangulating."""
    mesh = cm.generate(cm.Disk((0, 0), 1), size=float(np.sqrt(72 / cells)))
    points = np.random.default_rng(2).random((cells // 2, 2))
    rough = cm.delaunay(points * [1, 8])
    runs: dict[str, tuple[Callable[[], Any], int]] = {
        "elevate to 2": (lambda: cm.elevate(mesh, 2), mesh.n_cells),
        "elevate to 5": (lambda: cm.elevate(mesh, 5), mesh.n_cells),
        "delaunay": (lambda: cm.delaunay(points), cells),
        "scipy Delaunay": (lambda: Delaunay(points), cells),
        "flips from a sheared triangulation": (
            lambda: cm.flip_to_delaunay(cm.Mesh(points, rough.cells)),
            cells,
        ),
        "minimum spanning tree": (lambda: cm.minimum_spanning_tree(points), cells),
        "nearest neighbours": (lambda: cm.nearest_neighbours(points), cells),
        "voronoi": (lambda: cm.voronoi(points[: cells // 20]), cells // 10),
    }
    rows = []
    for name, (run, n) in runs.items():
        seconds = processor_seconds(run, 3)
        rows.append({"what": name, "triangles": n, "s": seconds, "million/s": n / seconds / 1e6})
    return rows


def main() -> None:
    """All sections into ``results/refinement_*.json``."""
    cells = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    sections = {"speed": speed(cells), "levels": levels(), "areas": areas()}
    sections["others"] = others(cells)
    for name, rows in sections.items():
        save(f"refinement_{name}", rows)
        show(rows)
        print()


if __name__ == "__main__":
    main()

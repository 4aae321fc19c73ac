"""Errors of adapted and of uniform meshes, and cells across narrow gaps.

    python benchmarks/adaptivity.py [corner] [layer] [gaps]

Solutions by scikit-fem, linear elements. Writes results/adaptivity_*.json.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from report import save
from scipy.spatial import cKDTree
from skfem import Basis, ElementTriP1, Functional, LinearForm, condense, solve
from skfem.models.poisson import laplace

import csgmesh as cm

SQUARE = cm.Box((0, 0), (1, 1))
L_SHAPE = cm.Box((-1, -1), (1, 1)) - cm.Box((0, -1), (1, 0), name="notch")
STEEPNESS = 100.0
TARGET = 1e-3


class Corner:
    """Harmonic, with the singularity of a re-entrant corner of 270 degrees."""

    def value(self, x: Any, y: Any) -> Any:
        return np.hypot(x, y) ** (2 / 3) * np.sin(np.mod(np.arctan2(y, x) + 1e-14, 2 * np.pi) / 1.5)

    def gradient(self, x: Any, y: Any) -> Any:
        r, t = np.hypot(x, y), np.mod(np.arctan2(y, x), 2 * np.pi)
        a, b = (r ** (-1 / 3) / 1.5 * f(t / 1.5) for f in (np.sin, np.cos))
        return a * np.cos(t) - b * np.sin(t), a * np.sin(t) + b * np.cos(t)

    def source(self, x: Any, y: Any) -> Any:
        return 0 * x


class Layer:
    """tanh(100 (r - 1/2)) around a centre."""

    def __init__(self, centre: tuple[float, float]) -> None:
        self.centre = centre

    def _polar(self, x: Any, y: Any) -> Any:
        x, y = x - self.centre[0], y - self.centre[1]
        r = np.hypot(x, y)
        t = np.tanh(STEEPNESS * (r - 0.5))
        return x, y, r, t, STEEPNESS * (1 - t * t)

    def value(self, x: Any, y: Any) -> Any:
        return self._polar(x, y)[3]

    def gradient(self, x: Any, y: Any) -> Any:
        x, y, r, _, slope = self._polar(x, y)
        return slope * x / r, slope * y / r

    def source(self, x: Any, y: Any) -> Any:
        _, _, r, t, slope = self._polar(x, y)
        return 2 * STEEPNESS * slope * t - slope / r


def solver(problem: Any) -> Callable[[cm.Mesh], np.ndarray]:
    """Solves Poisson's equation with the exact values on the boundary."""

    def poisson(mesh: cm.Mesh) -> np.ndarray:
        basis = Basis(cm.to_skfem(mesh), ElementTriP1(), intorder=6)
        load = LinearForm(lambda v, w: problem.source(*w.x) * v).assemble(basis)
        held = basis.get_dofs().flatten()
        u = problem.value(*mesh.points.T)
        return solve(*condense(laplace.assemble(basis), load, x=u, D=held))

    return poisson


def row(problem: Any, mesh: cm.Mesh, u: np.ndarray, seconds: float) -> dict[str, float]:
    """Errors of a solution."""
    basis = Basis(cm.to_skfem(mesh), ElementTriP1(), intorder=6)
    square = Functional(lambda w: (w["u"] - problem.value(*w.x)) ** 2)
    slope = Functional(
        lambda w: sum((w["u"].grad[i] - problem.gradient(*w.x)[i]) ** 2 for i in (0, 1))
    )
    return {
        "cells": mesh.n_cells,
        "unknowns": mesh.n_points,
        "L2 error": float(np.sqrt(square.assemble(basis, u=u))),
        "H1 error": float(np.sqrt(slope.assemble(basis, u=u))),
        "min angle": float(cm.quality(mesh).min_angle.min()),
        "processor seconds": seconds,
    }


def orders(rows: list[dict[str, float]], last: int = 4) -> dict[str, float]:
    """Slopes over the last rows."""
    n = np.log([r["unknowns"] for r in rows[-last:]])
    return {
        name: float(np.polyfit(n, np.log([r[name] for r in rows[-last:]]), 1)[0])
        for name in ("L2 error", "H1 error")
    }


def compare(
    shape: Any, problem: Any, budgets: list[int], sizes: list[float], first: float
) -> dict[str, Any]:
    """Adapted meshes in both norms beside uniform ones."""
    found: dict[str, Any] = {}
    for norm in ("L2", "H1"):
        rows = []
        for cells in budgets:
            start = time.process_time()
            run = cm.adapt(shape, solver(problem), size=first, cells=cells, norm=norm)
            rows.append(row(problem, run.mesh, run.values, time.process_time() - start))
            rows[-1]["estimate"] = run.steps[-1].error
            print(norm, rows[-1], flush=True)
        found[f"adapted in {norm}"] = {"rows": rows, "orders": orders(rows)}
    rows = []
    for size in sizes:
        start = time.process_time()
        mesh = cm.generate(shape, size=size)
        u = solver(problem)(mesh)
        rows.append(row(problem, mesh, u, time.process_time() - start))
        print("uniform", rows[-1], flush=True)
    found["uniform"] = {"rows": rows, "orders": orders(rows)}
    return found


def cells_for(rows: list[dict[str, float]]) -> float:
    """Cells for an L2 error of `TARGET`, between rows."""
    n, e = (np.log([r[k] for r in rows]) for k in ("cells", "L2 error"))
    return float(np.exp(np.interp(-np.log(TARGET), -e, n)))


def corner() -> dict[str, Any]:
    """The L-shape."""
    budgets = [1000 * 2**k for k in range(8)]
    return compare(L_SHAPE, Corner(), budgets, [0.1, 0.05, 0.025, 0.0125], 0.2)


def layer() -> dict[str, Any]:
    """The layer, around the middle of the square and around its corner."""
    out = {}
    for name, centre in (("middle", (0.5, 0.5)), ("corner", (0.0, 0.0))):
        budgets = [4000 * 2**k for k in range(5)]
        found = compare(SQUARE, Layer(centre), budgets, [0.02, 0.01, 0.005, 0.0025], 0.05)
        uniform, adapted = (cells_for(found[k]["rows"]) for k in ("uniform", "adapted in L2"))
        found["cells for an L2 error of 1e-3"] = {
            "uniform": uniform,
            "adapted": adapted,
            "factor": uniform / adapted,
        }
        print(name, found["cells for an L2 error of 1e-3"], flush=True)
        out[name] = found
    return out


def packed(n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Disks in the unit square, many of them nearly touching."""
    rng = np.random.default_rng(seed)
    typical = 0.45 / np.sqrt(n)
    centres, radii = np.zeros((0, 2)), np.zeros(0)
    while len(radii) < n:
        c = rng.random(2)
        free = min(c.min(), (1 - c).min())
        if len(radii):
            free = min(free, (np.hypot(*(centres - c).T) - radii).min())
        radius = min(free - rng.uniform(0.003, 0.03) * typical, 1.3 * typical)
        if radius > 0.25 * typical:
            centres, radii = np.vstack([centres, c]), np.append(radii, radius)
    return centres, radii


def gaps(n: int = 1000, across: int = 4) -> dict[str, Any]:
    """Cells across the gaps of a random microstructure, and its budget."""
    centres, radii = packed(n)
    holes = [cm.Disk(tuple(c), r, name="hole") for c, r in zip(centres, radii, strict=True)]
    domain = cm.evaluate(cm.difference(SQUARE, *holes))
    keep = cm.FeatureSize(across)
    start = time.process_time()
    keep.bind(domain)
    bound = time.process_time() - start
    start = time.process_time()
    needed = cm.generate(domain, size=keep).n_cells
    meshed = time.process_time() - start
    cells = int(1.25 * needed)
    start = time.process_time()
    mesh = cm.generate_to_budget(domain, size=0.1, cells=cells, keep=keep)
    budget = time.process_time() - start
    widest = 0.1 * radii.mean()
    pairs = cKDTree(centres).query_pairs(2 * radii.max() + widest, output_type="ndarray")
    i, j = pairs[np.lexsort(pairs.T)].T
    way = centres[j] - centres[i]
    distance = np.hypot(*way.T)
    near = distance - radii[i] - radii[j] < widest
    i, j, way = i[near], j[near], (way / distance[:, None])[near]
    a, b = centres[i] + radii[i, None] * way, centres[j] - radii[j, None] * way
    share = np.linspace(0.005, 0.995, 200)
    points = a[:, None] + share[:, None] * (b - a)[:, None]
    cell = mesh.locate(points.reshape(-1, 2)).reshape(len(a), -1)
    crossed = (np.diff(cell, axis=1) != 0).sum(axis=1) + 1
    width = np.hypot(*(b - a).T)
    return {
        "disks": n,
        "gaps": len(width),
        "narrowest, widest": [float(width.min()), float(width.max())],
        "cells asked for across": across,
        "fewest cells met across": int(crossed.min()),
        "mean cells met across": float(crossed.mean()),
        "cells needed by the gaps": needed,
        "budget": cells,
        "cells": mesh.n_cells,
        "off by": mesh.n_cells / cells - 1,
        "min angle": float(cm.quality(mesh).min_angle.min()),
        "certificate": cm.check(mesh).ok,
        "processor seconds": {"find gaps": bound, "mesh once": meshed, "to budget": budget},
    }


if __name__ == "__main__":
    for name in sys.argv[1:] or ["corner", "layer", "gaps"]:
        result = {"corner": corner, "layer": layer, "gaps": gaps}[name]()
        print(name, result if name == "gaps" else "")
        save(f"adaptivity_{name}", [result], "scikit-fem")

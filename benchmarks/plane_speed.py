"""Sections of ``plane.py`` that compare speed and quality with Triangle and Gmsh."""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from peers import (
    equilateral,
    for_triangle,
    gmsh_frontal,
    measures,
    ours,
    triangle_graded,
    triangle_package,
)
from report import median_seconds, show

import csgmesh as cm
from csgmesh.domain import Pslg

Rows = list[dict[str, Any]]

#: A mesh whose mean edge is h has about so many triangles per area / h².
PER_AREA = 2.31
#: Triangle under an area bound A makes triangles of about this share of A on average.
TRIANGLES_SHARE = 0.57
#: Smallest over largest size of the graded cases.
SPREAD = 1000.0


def square() -> cm.Shape:
    return cm.Box((0, 0), (1, 1), name="box")


def domains(n: int) -> dict[str, tuple[Pslg, Pslg, float]]:
    """Uniform cases: a domain, the same in chords of the wanted length, and that length.

    The peers get chords, since curves are not theirs to follow.
    """
    box, disk = cm.evaluate(square()), cm.evaluate(cm.Disk((0, 0), 1))
    h_box, h_disk = (float(np.sqrt(PER_AREA * area / n)) for area in (1.0, np.pi))
    chords = cm.evaluate(cm.RegularPolygon((0, 0), 1, round(2 * np.pi / h_disk)))
    return {"square": (box, box, h_box), "disk": (disk, chords, h_disk)}


def _repeats(n: int) -> int:
    return 5 if n < 10**6 else 3


def _compare(case: str, runs: dict[str, Callable[[], Any]], repeats: int, size: Any) -> Rows:
    """A row for each mesher, measured in turns so that other work on the machine hits all alike.

    Processor seconds stand beside wall seconds: every call runs on one thread, so they are what
    the wall would show on an idle machine.
    """
    wall: dict[str, list[float]] = {who: [] for who in runs}
    processor: dict[str, list[float]] = {who: [] for who in runs}
    found = {}
    for turn in range(repeats):
        for who, run in runs.items():
            # A minute and more of Gmsh is measured once.
            if turn and wall[who][0] > 20:
                continue
            start, spent = time.perf_counter(), time.process_time()
            found[who] = run()
            wall[who].append(time.perf_counter() - start)
            processor[who].append(time.process_time() - spent)
    rows: Rows = []
    for who, (points, cells) in found.items():
        seconds, busy = statistics.median(wall[who]), statistics.median(processor[who])
        row = {
            "case": case,
            "mesher": who,
            "seconds": seconds,
            "processor s": busy,
            "triangles/s": len(cells) / seconds,
            **measures(points, cells, size),
            "load": round(os.getloadavg()[0], 1),
        }
        if rows:
            row["csgmesh is faster by"] = rows[0]["triangles/s"] / row["triangles/s"]
            row["by processor time"] = busy / len(cells) * rows[0]["triangles"]
            row["by processor time"] /= rows[0]["processor s"]
        rows.append(row)
    show(rows)
    return rows


def speed(counts: list[int]) -> Rows:
    """Uniform size at 30 degrees, whole calls, one thread."""
    rows: Rows = []
    ours(cm.evaluate(square()), 0.3)
    for n in counts:
        for name, (domain, chords, h) in domains(n).items():
            size = cm.UniformSize(h)
            case, repeats = f"{name}, {n:.0e} triangles", _repeats(n)
            bound = float(chords.areas().sum()) / n / TRIANGLES_SHARE
            runs = {
                "csgmesh": partial(ours, domain, h),
                "Triangle": partial(triangle_package, chords, bound),
                "Gmsh frontal": partial(gmsh_frontal, chords, h),
            }
            rows += _compare(case, runs, repeats, size)
    return rows


def graded(counts: list[int]) -> Rows:
    """Sizes 1 : 1000, by a callable and by a name."""
    rows: Rows = []
    domain = cm.evaluate(square())
    per = 1.0 / equilateral(1.0)
    for n in counts:
        # The integral of per / h² over a quarter disk about the corner, and over the square.
        slope = float(np.sqrt(0.5 * np.pi * np.log(SPREAD) * per / n))
        small = slope * np.sqrt(2) / (SPREAD - 1)
        low = float(np.sqrt(per / (SPREAD - 1) / n))
        for case, size, mesher, wanted in (
            ("corner, callable", _from_corner(small, slope), {}, _from_corner(small, slope)),
            (
                "side, by name",
                {"box.bottom": low},
                {"gradation": low * (SPREAD - 1)},
                _from_bottom(low, low * (SPREAD - 1)),
            ),
        ):
            label, repeats = f"{case}, {n:.0e} triangles", _repeats(n)
            runs = {
                "csgmesh": partial(_graded_mesh, domain, size, cm.DelaunayRefinement(**mesher)),
                "Triangle": partial(triangle_graded, domain, wanted),
            }
            rows += _compare(label, runs, repeats, wanted)
    return rows


def _graded_mesh(domain: Pslg, size: Any, mesher: Any) -> tuple[np.ndarray, np.ndarray]:
    mesh = mesher.generate(domain, size)
    return mesh.points, mesh.cells["triangle"]


def _from_corner(small: float, slope: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda p: small + slope * np.hypot(p[:, 0], p[:, 1])


def _from_bottom(small: float, slope: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda p: small + slope * p[:, 1]


def delaunay(counts: list[int]) -> Rows:
    """Constrained Delaunay triangulations, random and degenerate."""
    import triangle

    rows: Rows = []
    mesher = cm.ConstrainedDelaunay()
    mesher.generate(cm.evaluate(square()))
    n = max(counts)
    for case, domain in {**_point_sets(n), "coastline": coastline(n // 2)}.items():
        given = for_triangle(domain)
        mine = median_seconds(partial(mesher.generate, domain), 3)
        # Triangle's Delaunay triangulation of points alone does without segments.
        options = "pQ" if case == "coastline" else "Q"
        if options == "Q":
            del given["segments"]
        theirs = median_seconds(partial(triangle.triangulate, given, options), 3)
        rows.append({
            "case": f"{case}, {len(domain.points):.0e} points",
            "csgmesh s": mine, "Triangle s": theirs, "csgmesh is faster by": theirs / mine,
            "load": round(os.getloadavg()[0], 1),
        })  # fmt: skip
    return rows


def _point_sets(n: int) -> dict[str, Pslg]:
    rng = np.random.default_rng(0)
    side = int(np.sqrt(n))
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), -1).reshape(-1, 2).astype(float)
    t = np.linspace(0, 2 * np.pi, n // 10, endpoint=False)
    runs = np.column_stack([np.repeat(np.arange(100.0), n // 100), rng.random(n // 100 * 100)])
    sets = {
        "random": rng.random((n, 2)),
        "integer grid": grid,
        "grid / 7": grid / 7,
        "circle": np.column_stack([np.cos(t), np.sin(t)]),
        "collinear runs": runs,
    }
    return {name: _framed(points) for name, points in sets.items()}


def _framed(points: np.ndarray) -> Pslg:
    """Points inside a square: the domain that a mesher of domains needs."""
    lo, hi = points.min(0), points.max(0)
    w = float((hi - lo).max())
    frame = np.array([lo - w, (hi[0] + w, lo[1] - w), hi + w, (lo[0] - w, hi[1] + w)])
    return Pslg.build(
        points=np.vstack([frame, points]),
        segments=[[0, 1], [1, 2], [2, 3], [3, 0]],
        segment_marker=np.zeros(4, int),
        segment_region=[[0, -1]] * 4,
        boundary_names=(("frame",),),
        point_marker=np.r_[[-1] * 4, np.zeros(len(points), int)],
    )


def coastline(n: int) -> Pslg:
    """A closed line of n points, rough at every scale."""
    rng = np.random.default_rng(2)
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    r = np.ones(n)
    for k in range(1, int(np.log2(n)) - 1):
        r += 0.15 * 0.6**k * np.cos(2**k * t + rng.uniform(0, 2 * np.pi))
    r += 0.1 / n * rng.standard_normal(n)
    index = np.arange(n)
    return Pslg.build(
        points=np.column_stack([r * np.cos(t), r * np.sin(t)]),
        segments=np.column_stack([index, np.roll(index, -1)]),
        segment_marker=np.zeros(n, int),
        segment_region=np.tile([0, -1], (n, 1)),
        boundary_names=(("coast",),),
    )

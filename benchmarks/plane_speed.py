"""Sections of ``plane.py`` that compare speed and quality with Triangle and Gmsh."""

from __future__ import annotations

import os
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
from report import median_seconds

import csgmesh as cm
from csgmesh.domain import Pslg

Rows = list[dict[str, Any]]

#: A mesh whose mean edge is h has about so many triangles per area / h².
PER_AREA = 2.27
#: Triangle under an area bound A makes triangles of about this share of A on average.
TRIANGLES_SHARE = 0.57
#: Smallest over largest size of the graded cases.
SPREAD = 1000.0


def square() -> cm.Shape:
    return cm.Box((0, 0), (1, 1), name="box")


def domains() -> dict[str, Pslg]:
    """Uniform cases."""
    disk = cm.evaluate(cm.Disk((0, 0), 1), deviation=1e-6)
    return {"square": cm.evaluate(square()), "disk": disk}


def _repeats(n: int) -> int:
    return 5 if n < 10**6 else 3


def _row(case: str, who: str, run: Callable[[], Any], repeats: int, size: Any = None) -> dict:
    points, cells = run()
    seconds = median_seconds(run, repeats)
    return {
        "case": case,
        "mesher": who,
        "seconds": seconds,
        "triangles/s": len(cells) / seconds,
        **measures(points, cells, size),
        "load": round(os.getloadavg()[0], 1),
    }


def _compare(rows: Rows) -> Rows:
    """Add to each row of a peer how many times as fast csgmesh is."""
    for row in rows[1:]:
        row["csgmesh is faster by"] = rows[0]["triangles/s"] / row["triangles/s"]
    return rows


def speed(counts: list[int]) -> Rows:
    """Uniform size at 30 degrees, whole calls, one thread."""
    rows: Rows = []
    for name, domain in domains().items():
        area = float(domain.areas().sum())
        ours(domain, 0.3)
        for n in counts:
            h = float(np.sqrt(PER_AREA * area / n))
            size = cm.UniformSize(h)
            case, repeats = f"{name}, {n:.0e} triangles", _repeats(n)
            bound = area / n / TRIANGLES_SHARE
            triangle = partial(triangle_package, domain, bound)
            gmsh = partial(gmsh_frontal, domain, h)
            rows += _compare([
                _row(case, "csgmesh", partial(ours, domain, h), repeats, size),
                _row(case, "Triangle", triangle, repeats, size),
                _row(case, "Gmsh frontal", gmsh, 1 if n >= 10**6 else repeats, size),
            ])  # fmt: skip
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
            ask = partial(_graded_mesh, domain, size, cm.DelaunayRefinement(**mesher))
            peer = partial(triangle_graded, domain, wanted)
            rows += _compare([
                _row(label, "csgmesh", ask, repeats, wanted),
                _row(label, "Triangle", peer, 1 if n >= 10**6 else 3, wanted),
            ])  # fmt: skip
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

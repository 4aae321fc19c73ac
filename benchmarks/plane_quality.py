"""Sections of ``plane.py`` about angles, numbers of triangles and curves."""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from peers import gmsh_frontal, holed, measures, ours, triangle_inside
from plane_domains import HARD, poly_samples, three_shapes
from plane_lfs import integral

import csgmesh as cm
from csgmesh.domain import Pslg
from csgmesh.domain.input_angles import sharp_corners
from csgmesh.errors import BudgetError, CsgmeshError

sys.path.append(str(Path(__file__).parents[1] / "tests" / "corpus"))
from corpora import CASES
from glyphs import outline, sample
from seeded_trees import domain as tree

Rows = list[dict[str, Any]]
#: Points that a corpus's domain may need.
MAX_POINTS = 500_000


def angles(counts: list[int]) -> Rows:
    """Which domains without input angles below 60 degrees reach 30 and 33 degrees."""
    n = max(counts)
    rows = []
    for corpus, shapes in (
        ("glyphs", [partial(outline, "DejaVuSans", i) for i in sample("DejaVuSans", n)]),
        ("random trees", [partial(tree, seed) for seed in range(n // 2)]),
        ("degenerate cases", [lambda s=case[0]: s for case in CASES.values()]),
    ):
        domains = list(_without_sharp_corners(shapes))
        for angle in (30.0, 33.0):
            reached, budget, other, worst = 0, [], [], 90.0
            for domain in domains:
                try:
                    mesh = _mesher(angle).generate(domain)
                except BudgetError as error:
                    budget.append(str(error).partition("finest at ")[2].partition(", edges")[0])
                    continue
                except CsgmeshError as error:
                    other.append(str(error))
                    continue
                found = float(cm.quality(mesh).min_angle.min())
                worst = min(worst, found)
                reached += found >= angle - 1e-9
            rows.append({
                "corpus": corpus, "angle": angle, "domains": len(domains), "reached": reached,
                "share": reached / max(len(domains), 1), "worst": worst,
                "budget errors at": "; ".join(budget), "other errors": "; ".join(other),
            })  # fmt: skip
    return rows


def _mesher(angle: float, **options: Any) -> cm.DelaunayRefinement:
    return cm.DelaunayRefinement(min_angle=angle, max_points=MAX_POINTS, **options)


def _without_sharp_corners(shapes: list[Callable[[], Any]]) -> Iterator[Pslg]:
    for make in shapes:
        try:
            domain = cm.evaluate(make())
        except CsgmeshError:
            continue
        if not len(sharp_corners(domain).vertex):
            yield domain


def uniform(counts: list[int]) -> Rows:
    """Smallest angles at one size, by default and improved, beside Gmsh's frontal algorithm."""
    rows: Rows = []
    for n in counts:
        for name, (domain, chords, h) in three_shapes(n).items():
            size = cm.UniformSize(h)
            runs = {
                "csgmesh": partial(ours, domain, h),
                "csgmesh, improved": partial(_improved, domain, h),
                "Gmsh frontal": partial(gmsh_frontal, chords, h),
            }
            for who, run in runs.items():
                run()
                start = time.process_time()
                points, cells = run()
                spent = time.process_time() - start
                rows.append({
                    "case": f"{name}, {n:.0e} triangles", "mesher": who,
                    "processor s": spent, **measures(points, cells, size),
                })  # fmt: skip
            rows[-2]["times the default's time"] = rows[-2]["processor s"] / rows[-3]["processor s"]
    return rows


def _improved(domain: Pslg, size: float) -> tuple[np.ndarray, np.ndarray]:
    mesh = cm.DelaunayRefinement(improve=True).generate(domain, size)
    return mesh.points, mesh.cells["triangle"]


def letters(counts: list[int]) -> Rows:
    """Worst angles of glyphs, by default and improved."""
    shapes = [partial(outline, "DejaVuSans", i) for i in sample("DejaVuSans", max(counts))]
    domains = list(_without_sharp_corners(shapes))
    rows: Rows = []
    for who, mesher in (("csgmesh", _mesher(30.0)), ("improved", _mesher(30.0, improve=True))):
        worst = [float(cm.quality(mesher.generate(d)).min_angle.min()) for d in domains]
        spent = statistics.median(_seconds(mesher, domains) for _ in range(5))
        rows.append({
            "mesher": who, "glyphs": len(domains), "mean of worst angles": statistics.mean(worst),
            "median": statistics.median(worst), "worst": min(worst), "processor s": spent,
        })  # fmt: skip
    rows[1]["times the default's time"] = rows[1]["processor s"] / rows[0]["processor s"]
    return rows


def _seconds(mesher: Any, domains: list[Pslg]) -> float:
    start = time.process_time()
    for domain in domains:
        mesher.generate(domain)
    return time.process_time() - start


def numbers(counts: list[int]) -> Rows:
    """Triangles without a size, beside Triangle's at the same angle, and over the integral of
    1 / lfs²."""
    shapes = [partial(outline, "DejaVuSans", i) for i in sample("DejaVuSans", max(counts))]
    cases = {f"{max(counts)} glyphs": list(_without_sharp_corners(shapes))}
    cases |= {f"{name}.poly": [domain] for name, domain in poly_samples().items()}
    rows = []
    for case, domains in cases.items():
        for angle in (20.0, 30.0):
            mine = theirs = 0
            ratios, optimal = [], []
            for domain in domains:
                mesh = _mesher(angle).generate(domain)
                other = len(triangle_inside(domain, angle)[1])
                mine, theirs = mine + mesh.n_cells, theirs + other
                ratios.append(mesh.n_cells / other)
                optimal.append(mesh.n_cells / integral(domain, mesh))
            rows.append({
                "case": case, "angle": angle, "csgmesh": mine, "Triangle": theirs,
                "csgmesh / Triangle": mine / theirs, "median": statistics.median(ratios),
                "over the integral, median": statistics.median(optimal), "largest": max(optimal),
            })  # fmt: skip
    return rows


def curves(counts: list[int]) -> Rows:
    """A disk at three deviations: chords, their distance from the circle, area."""
    rows: Rows = []
    for deviation in (1e-3, 1e-6, 1e-9):
        mesh = cm.generate(cm.Disk((0, 0), 1), deviation=deviation)
        chord = mesh.points[mesh.facets["line"]]
        off = 1.0 - np.hypot(*chord.mean(axis=1).T)
        corners = mesh.points[mesh.cells["triangle"]]
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = 0.5 * float((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum())
        rows.append({
            "deviation": deviation, "chords": len(chord), "triangles": mesh.n_cells,
            "largest distance": float(off.max()), "missing area": np.pi - area,
            "largest distance of a vertex": float(np.abs(np.hypot(*chord[:, 0].T) - 1).max()),
            "chords needed": int(np.ceil(np.pi / np.arccos(1 - deviation))),
        })  # fmt: skip
    return rows


def robustness(counts: list[int]) -> Rows:
    """Small input angles and other hard domains, beside Triangle's number of triangles."""
    rows = []
    for name, domain in HARD.items():
        start = time.process_time()
        row: dict[str, Any] = {"domain": name, "segments": domain.n_segments}
        try:
            mesh = _mesher(30.0).generate(domain)
        except CsgmeshError as error:
            row["error"] = f"{type(error).__name__}: {error}"
        else:
            row["processor s"] = time.process_time() - start
            below = int((cm.quality(mesh).min_angle < 30.0 - 1e-9).sum())
            row |= {"triangles": mesh.n_cells, "below 30": below}
            # Cells below the bound must be excused by an input angle.
            row["valid"] = cm.check(mesh).ok
        # Triangle ends the process on some of these, so it runs in one of its own.
        row["Triangle"] = _apart(domain)
        rows.append(row)
    return rows


def _apart(domain: Pslg, seconds: float = 20.0) -> Any:
    """Triangle's number of triangles, or how it failed."""
    import multiprocessing

    context = multiprocessing.get_context("spawn")
    receive, send = context.Pipe(duplex=False)
    given = holed(domain)
    process = context.Process(target=_counted, args=(given, send))
    process.start()
    send.close()
    try:
        return receive.recv() if receive.poll(seconds) else f"no answer in {seconds:g} s"
    except EOFError:
        return "crash"
    finally:
        process.kill()
        process.join()


def _counted(given: dict[str, np.ndarray], send: Any) -> None:
    import triangle

    send.send(len(triangle.triangulate(given, "pq30Q")["triangles"]))

"""Sections of ``plane.py`` about what else a user waits or pays for."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator
from functools import partial
from itertools import islice
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from typing import Any

import numpy as np
from plane_speed import PER_AREA, square
from report import median_seconds

import csgmesh as cm

Rows = list[dict[str, Any]]
ROOT = Path(__file__).parents[1]
FORMATS = ("npz", "vtu", "msh")
#: Distinct glyphs that stand for 10,000 small domains.
GLYPHS = 400


def small(counts: list[int]) -> Rows:
    """Thousands of small domains one after the other, evaluation apart."""
    domains = [cm.evaluate(outline) for outline in islice(_glyphs(), GLYPHS)]
    rounds = max(max(counts) // 100 // len(domains), 1)
    rows = []
    for angle in (20.0, 30.0):
        mesher = cm.DelaunayRefinement(min_angle=angle)
        cells = sum(mesher.generate(domain).n_cells for domain in domains)
        start, busy = time.perf_counter(), time.process_time()
        for _ in range(rounds):
            for domain in domains:
                mesher.generate(domain)
        n = rounds * len(domains)
        rows.append({
            "case": f"{n} glyphs at {angle:g} degrees",
            "triangles each": cells / len(domains),
            "ms each": 1e3 * (time.perf_counter() - start) / n,
            "processor ms each": 1e3 * (time.process_time() - busy) / n,
            "load": round(os.getloadavg()[0], 1),
        })  # fmt: skip
    return rows


def _glyphs() -> Iterator[cm.Shape]:
    """Outlines of DejaVu Sans, in the order of the font."""
    from matplotlib import get_data_path
    from matplotlib.ft2font import FT2Font, LoadFlags

    font = FT2Font(str(Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"))
    font.set_size(64, 72)
    for index in range(font.num_glyphs):
        font.load_glyph(index, flags=LoadFlags.NO_HINTING)
        if len(font.get_path()[0]):
            yield cm.Outline.from_path(*font.get_path())


def memory(counts: list[int]) -> Rows:
    """Peak of numpy's allocations in a second call, beyond the result."""
    domain = cm.evaluate(square())
    rows = []
    for n in counts:
        h = float(np.sqrt(PER_AREA / n))
        for case, size in (("uniform", h), ("callable", lambda p, h=h: np.full(len(p), h))):
            cm.generate(domain, size=size)
            tracemalloc.start()
            mesh = cm.generate(domain, size=size)
            kept, peak = tracemalloc.get_traced_memory()
            tracemalloc.stop()
            rows.append({
                "case": f"{case}, {n:.0e} triangles",
                "bytes a triangle beyond the result": (peak - kept) / mesh.n_cells,
                "result, bytes a triangle": kept / mesh.n_cells,
            })  # fmt: skip
    return rows


def cold(counts: list[int]) -> Rows:
    """Compiling for the first mesh ever, and the command line afterwards."""
    python = sys.executable
    mesh = [python, "-c", "import csgmesh as cm; cm.generate(cm.Disk((0, 0), 1))"]
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(Path(folder) / "cache")}
        output = str(Path(folder) / "plate.msh")
        plate = [str(ROOT / "examples" / "plate.yaml"), "-o", output]
        run = partial(_run, environment=environment)
        first = run(mesh)
        again = _median_run(run, mesh)
        command = [python, "-m", "csgmesh", "mesh", *plate]
        run(command)
        meshed = _median_run(run, command)
    help_text = _median_run(partial(_run, environment=os.environ), [python, "-m", "csgmesh", "-h"])
    return [
        {"what": what, "seconds": wall, "processor s": busy, "load": round(os.getloadavg()[0], 1)}
        for what, (wall, busy) in (
            ("first mesh, nothing compiled yet", first),
            ("the same, compiled", again),
            ("of which compiling", (first[0] - again[0], first[1] - again[1])),
            ("csgmesh mesh examples/plate.yaml, compiled", meshed),
            ("csgmesh --help", help_text),
        )
    ]


def _median_run(run: Callable[[list[str]], tuple[float, float]], command: list[str]) -> Any:
    """Medians of five runs."""
    return tuple(np.median([run(command) for _ in range(5)], axis=0).tolist())


def _run(command: list[str], environment: Any) -> tuple[float, float]:
    """Seconds on the wall and of processor time."""
    start, before = time.perf_counter(), getrusage(RUSAGE_CHILDREN)
    subprocess.run(command, env=environment, check=True, capture_output=True)
    after = getrusage(RUSAGE_CHILDREN)
    busy = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - start, busy


def files(counts: list[int]) -> Rows:
    """Writing and reading."""
    mesh = cm.generate(square(), size=float(np.sqrt(PER_AREA / max(counts))))
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for suffix in FORMATS:
            path = Path(folder) / f"mesh.{suffix}"
            rows.append({
                "format": suffix,
                "triangles": mesh.n_cells,
                "write s": median_seconds(lambda p=path: cm.write(p, mesh), 5),
                "read s": median_seconds(lambda p=path: cm.read(p), 3),
                "bytes": path.stat().st_size,
                "load": round(os.getloadavg()[0], 1),
            })  # fmt: skip
    return rows


def contains(counts: list[int]) -> Rows:
    """Membership in a tree of 100 leaves."""
    rng = np.random.default_rng(3)
    leaves: list[cm.Shape] = []
    for k in range(100):
        x, y = rng.random(2).tolist()
        r = float(rng.uniform(0.02, 0.1))
        leaves.append(cm.Disk((x, y), r) if k % 2 else cm.Box((x, y), (x + r, y + r)))
    chain = leaves[0]
    for k, leaf in enumerate(leaves[1:]):
        chain = chain - leaf if k % 4 == 3 else chain | leaf
    points = rng.random((max(counts), 2))
    rows = []
    for case, tree in (("union", cm.union(leaves)), ("chain of | and -", chain)):
        rows.append({
            "case": f"{case}, 100 leaves",
            "points": len(points),
            "seconds": median_seconds(partial(tree.contains, points), 5),
            "load": round(os.getloadavg()[0], 1),
        })  # fmt: skip
    return rows

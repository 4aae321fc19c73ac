"""What every benchmark shares: the machine, medians, and a JSON file of results."""

from __future__ import annotations

import json
import os
import platform
import statistics
import time
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parent / "results"


def median_seconds(run: Callable[[], Any], repeats: int = 5) -> float:
    """Median wall time of a call."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def machine(*packages: str) -> dict[str, Any]:
    """Processor and versions that a result belongs to."""
    processor = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        lines = [x for x in info.read_text().splitlines() if x.startswith("model name")]
        processor = lines[0].split(":", 1)[1].strip() if lines else processor
    found = {}
    for package in ("csgmesh", "numpy", "numba", "scipy", "shapely", *packages):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return {
        "processor": processor,
        "cores": os.cpu_count(),
        # Above the number of cores the times are those of a machine that others use as well.
        "load average": [round(x, 2) for x in os.getloadavg()],
        "python": platform.python_version(),
        "versions": found,
    }


def save(name: str, rows: list[dict[str, Any]], *packages: str) -> None:
    """Write rows to ``results/NAME.json``."""
    RESULTS.mkdir(exist_ok=True)
    text = json.dumps({"machine": machine(*packages), "rows": rows}, indent=1)
    (RESULTS / f"{name}.json").write_text(text + "\n")


def show(rows: list[dict[str, Any]]) -> None:
    """Print rows as a table."""
    keys = list(dict.fromkeys(k for row in rows for k in row))
    cells = [[_text(row.get(k, "")) for k in keys] for row in rows]
    widths = [max(len(k), *(len(c[i]) for c in cells)) for i, k in enumerate(keys)]
    print("  ".join(k.ljust(w) for k, w in zip(keys, widths, strict=True)))
    for line in cells:
        print("  ".join(c.rjust(w) for c, w in zip(line, widths, strict=True)))


def _text(value: Any) -> str:
    return f"{value:,.3g}" if isinstance(value, float) else str(value)

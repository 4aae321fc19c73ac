"""Section of ``plane.py`` about threads: components of a domain meshed side by side."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from plane_speed import PER_AREA
from report import median_seconds

import csgmesh as cm

Rows = list[dict[str, Any]]

#: Steps of the loop that shows what the machine's cores gain at best.
STEPS = 4 * 10**8


def threads(counts: list[int]) -> Rows:
    """Two, three and sixteen disks by 1, 2 and 4 threads, beside loops that share nothing."""
    rows: Rows = []
    spin = _spinner()
    for n in counts:
        for disks in (2, 3, 16):
            domain = cm.evaluate(cm.union([cm.Disk((3 * k, 0), 1) for k in range(disks)]))
            h = float(np.sqrt(PER_AREA * disks * np.pi / n))
            for case, size in (
                ("uniform", h),
                ("callable", lambda p, h=h: h * (0.8 + 0.4 * np.sin(p[:, 0]) ** 2)),
            ):
                rows += _by_threads(f"{disks} disks, {case}, {n:.0e} triangles", domain, size, spin)
    return rows


def _by_threads(case: str, domain: Any, size: Any, spin: Callable[[int], Any]) -> Rows:
    rows: Rows = []
    first = cm.DelaunayRefinement(threads=1).generate(domain, size)
    for n in (1, 2, 4):
        mesher = cm.DelaunayRefinement(threads=n)
        mesh = mesher.generate(domain, size)
        seconds = median_seconds(partial(mesher.generate, domain, size), 5)
        alone = median_seconds(partial(_spin_in, 1, spin), 3)
        shared = median_seconds(partial(_spin_in, n, spin), 3)
        rows.append({
            "case": case,
            "threads": n,
            "triangles": mesh.n_cells,
            "seconds": seconds,
            "gain": rows[0]["seconds"] / seconds if rows else 1.0,
            "a loop's gain": alone / shared,
            "same bytes": mesh.equals(first),
            "load": round(os.getloadavg()[0], 1),
        })  # fmt: skip
    return rows


def _spinner() -> Callable[[int], Any]:
    from numba import njit

    @njit(nogil=True)
    def spin(steps: int) -> int:
        total = 1
        for i in range(steps):
            total = total * 3 + i
        return total

    spin(10)
    return spin


def _spin_in(n: int, spin: Callable[[int], Any]) -> None:
    """The same work in n threads."""
    crew = [threading.Thread(target=spin, args=(STEPS // n,)) for _ in range(n)]
    for thread in crew:
        thread.start()
    for thread in crew:
        thread.join()

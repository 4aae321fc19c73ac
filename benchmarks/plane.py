"""Meshing in the plane: speed and quality beside Triangle and Gmsh, and what else it costs.

``python benchmarks/plane.py`` measures everything, with section names only those, with
``--small`` at sizes that take seconds. Each section keeps its own file in ``results/``, with the
processor, the versions and the load of the machine; small runs keep none. Needs the extra
``peers``.
"""

from __future__ import annotations

import os
import sys

from plane_costs import cold, contains, files, memory, small
from plane_speed import delaunay, graded, speed
from plane_threads import threads
from report import save, show

#: Name: what measures it, numbers of triangles or points.
SECTIONS = {
    "speed": (speed, [10**4, 10**5, 10**6]),
    "graded": (graded, [10**5, 10**6]),
    "delaunay": (delaunay, [10**6]),
    "threads": (threads, [10**6]),
    "small": (small, [10**6]),
    "memory": (memory, [10**5, 10**6]),
    "cold": (cold, []),
    "files": (files, [10**6]),
    "contains": (contains, [10**6]),
}


def main(words: list[str]) -> None:
    """Run sections by name."""
    # One thread: what numpy's libraries would use beside it is not what is measured.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    is_small = "--small" in words
    wanted = [w for w in words if w != "--small"] or list(SECTIONS)
    unknown = sorted(set(wanted) - set(SECTIONS))
    if unknown:
        raise SystemExit(f"sections are {', '.join(SECTIONS)}; got {', '.join(unknown)}")
    for name in wanted:
        measure, counts = SECTIONS[name]
        rows = measure([10**4] if is_small else counts)
        print(f"\n{name}: {(measure.__doc__ or '').strip()}")
        show(rows)
        if not is_small:
            save(f"plane_{name}", rows, "triangle", "gmsh")


if __name__ == "__main__":
    main(sys.argv[1:])

"""Meshing in the plane: speed and quality beside Triangle and Gmsh, and what else it costs.

``python benchmarks/plane.py`` measures everything, with section names only those, with
``--quick`` at sizes that take seconds. Each section keeps its own file in ``results/``, with the
processor, the versions and the load of the machine; quick runs keep none. Needs the extra
``peers``.
"""

from __future__ import annotations

import os
import sys

from plane_costs import cold, contains, files, memory, small
from plane_quality import angles, curves, letters, numbers, robustness, uniform
from plane_speed import delaunay, graded, speed
from plane_threads import threads
from report import save, show

#: Name: what measures it, and how many triangles, points or glyphs: in full, and quick.
SECTIONS = {
    "speed": (speed, [10**4, 10**5, 10**6], [10**4]),
    "graded": (graded, [10**5, 10**6], [10**4]),
    "delaunay": (delaunay, [10**6], [10**4]),
    "threads": (threads, [10**6], [10**4]),
    "small": (small, [10**6], [10**4]),
    "memory": (memory, [10**5, 10**6], [10**4]),
    "cold": (cold, [], [10**4]),
    "files": (files, [10**6], [10**4]),
    "contains": (contains, [10**6], [10**4]),
    "uniform": (uniform, [10**4, 10**5], [10**4]),
    "letters": (letters, [600], [60]),
    "numbers": (numbers, [600], [60]),
    "angles": (angles, [7000], [80]),
    "curves": (curves, [], []),
    "robustness": (robustness, [], []),
}


def main(words: list[str]) -> None:
    """Run sections by name."""
    # One thread: what numpy's libraries would use beside it is not what is measured.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    is_quick = "--quick" in words
    wanted = [w for w in words if w != "--quick"] or list(SECTIONS)
    unknown = sorted(set(wanted) - set(SECTIONS))
    if unknown:
        raise SystemExit(f"sections are {', '.join(SECTIONS)}; got {', '.join(unknown)}")
    for name in wanted:
        measure, counts, few = SECTIONS[name]
        rows = measure(few if is_quick else counts)
        print(f"\n{name}: {(measure.__doc__ or '').strip()}")
        show(rows)
        if not is_quick:
            save(f"plane_{name}", rows, "triangle", "gmsh")


if __name__ == "__main__":
    main(sys.argv[1:])

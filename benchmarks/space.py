"""Meshing of solids beside Gmsh, TetGen, Netgen and rapidmesh: cells a second and what they are.

Run with ``python benchmarks/space.py [SECTION]…``; sections are uniform, graded, surface,
hexahedra, memory and evaluation, all unless named. Writes results/space_SECTION.json. Times are
processor times of whole calls on one thread, from the description to arrays.
"""

from __future__ import annotations

import statistics
import sys
import time
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import space_peers as peers
from report import save, show

import csgmesh as cm

Arrays = tuple[np.ndarray, np.ndarray]
Row = dict[str, Any]
#: Peers that make fewer cells a second than this are run once, and not for a million cells.
SLOW = 20_000.0
PACKAGES = ("gmsh", "tetgen", "netgen-mesher", "rapidmesh", "manifold3d")
UNIFORM = (
    peers.ours,
    peers.gmsh_hxt,
    peers.gmsh_delaunay,
    peers.rapidmesh,
    peers.tetgen,
    peers.netgen,
)


def dihedrals(points: np.ndarray, tets: np.ndarray) -> np.ndarray:
    """All dihedral angles in degrees, (n, 6)."""
    corner = points[tets]
    normal = [
        np.cross(corner[:, b] - corner[:, a], corner[:, c] - corner[:, a])
        for a, b, c in ((1, 3, 2), (0, 2, 3), (0, 3, 1), (0, 1, 2))
    ]
    unit = [n / np.sqrt((n**2).sum(axis=1))[:, None] for n in normal]
    pairs = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
    cosines = [-(unit[a] * unit[b]).sum(axis=1) for a, b in pairs]
    return np.degrees(np.arccos(np.clip(np.column_stack(cosines), -1.0, 1.0)))


def angles(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """All angles of triangles in degrees, (n, 3)."""
    corner = points[triangles]
    found = []
    for k in range(3):
        u, v = (corner[:, (k + i) % 3] - corner[:, k] for i in (1, 2))
        across = np.sqrt((np.cross(u, v) ** 2).sum(axis=1))
        found.append(np.degrees(np.arctan2(across, (u * v).sum(axis=1))))
    return np.column_stack(found)


def timed(run: Callable[[], Arrays], repeats: int) -> tuple[float, Arrays]:
    """Median processor time and the last result."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        out = run()
        times.append(time.process_time() - start)
    return statistics.median(times), out


def sized(mesher: Callable[[float], Arrays], cells: int, power: int = 3) -> float:
    """The size at which a mesher makes about so many cells: asked of smaller meshes."""
    size = 0.1
    for _ in range(3):
        got = len(mesher(size)[1])
        aim = min(cells, 30_000)
        size *= (got / aim) ** (1.0 / power)
    return size * (aim / cells) ** (1.0 / power)


def row(mesher: Callable[[float], Arrays], size: float, repeats: int) -> Row:
    """What a mesh of one size took and is."""
    seconds, (points, cells) = timed(lambda: mesher(size), repeats)
    found: Row = {
        "mesher": mesher.__name__,
        "cells": len(cells),
        "seconds": seconds,
        "cells_per_second": len(cells) / seconds,
    }
    if cells.shape[1] == 4:
        angle = dihedrals(points, cells)
        found |= {"min_dihedral": float(angle.min()), "max_dihedral": float(angle.max())}
        found["mean_min_dihedral"] = float(angle.min(axis=1).mean())
    else:
        angle = angles(points, cells)
        found |= {"min_angle": float(angle.min()), "mean_min_angle": float(angle.min(1).mean())}
    return found


def uniform() -> list[Row]:
    """Box minus ball and bore, one size, 10⁵ and 10⁶ tetrahedra."""
    rows = []
    pace = dict.fromkeys(UNIFORM, np.inf)
    for cells in (10**5, 10**6):
        for mesher in UNIFORM:
            if pace[mesher] < SLOW:
                continue
            found = row(mesher, sized(mesher, cells), 3 if mesher is peers.ours else 1)
            pace[mesher] = found["cells_per_second"]
            rows.append({"wanted": cells, **found})
    return rows


def graded() -> list[Row]:
    """Edges 1 : 100 from the bore outwards, growing by 0.3."""
    rows = []

    def by_name(fine: float) -> Arrays:
        size = {"bore": fine, "default": 100 * fine}
        mesh = cm.generate(peers.solid(), cm.Octree(), size=size, deviation=peers.DEVIATION)
        return mesh.points, mesh.cells["tetra"]

    def gmsh_hxt(fine: float) -> Arrays:
        return peers.gmsh_graded(fine, 100 * fine)

    for fine in (0.01, 0.005):
        for mesher in (by_name, gmsh_hxt):
            rows.append({"fine": fine, **row(mesher, fine, 3 if mesher is by_name else 1)})
    return rows


def surface() -> list[Row]:
    """The surface alone."""
    rows = []
    for cells in (10**4, 10**5):
        for mesher in (peers.our_surface, peers.gmsh_surface):
            rows.append({"wanted": cells, **row(mesher, sized(mesher, cells, 2), 3)})
    return rows


def hexahedra() -> list[Row]:
    """All hexahedra, and a core of them."""
    rows = []
    for kind in ("hexahedron", "mixed"):
        for size in (0.04, 0.02):
            mesher = cm.Octree(cells=kind)
            cm.generate(peers.solid(), mesher, size=0.1)
            start = time.process_time()
            mesh = cm.generate(peers.solid(), mesher, size=size)
            seconds = time.process_time() - start
            jacobian = cm.quality(mesh).scaled_jacobian
            found = {"cells": kind, "size": size, "n_cells": mesh.n_cells, "seconds": seconds}
            found["cells_per_second"] = mesh.n_cells / seconds
            found["hexahedra"] = len(mesh.cells.get("hexahedron", ()))
            found["min_scaled_jacobian"] = float(np.nanmin(jacobian))
            found["mean_scaled_jacobian"] = float(np.nanmean(jacobian))
            rows.append(found)
    return rows


def memory() -> list[Row]:
    """Bytes that numpy allocates beyond the result."""
    rows = []
    for size in (0.045, 0.02):
        cm.generate(peers.solid(), cm.Octree(), size=0.2)
        tracemalloc.start()
        mesh = cm.generate(peers.solid(), cm.Octree(), size=size, deviation=peers.DEVIATION)
        held, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        rows.append({"cells": mesh.n_cells, "bytes_per_cell": (peak - held) / mesh.n_cells})
    return rows


def evaluation() -> list[Row]:
    """Evaluation beside manifold3d's own boolean of the same facets."""
    import manifold3d

    rng = np.random.default_rng(3)
    center = rng.random((100, 3)) * 4
    radius = 0.3 + 0.2 * rng.random(100)
    shape = cm.union(
        [cm.Ball(tuple(c), float(r)) for c, r in zip(center.tolist(), radius, strict=True)]
    )
    cm.evaluate(cm.Ball((0, 0, 0), 1) | cm.Ball((0.5, 0, 0), 1))
    rows = []
    for deviation in (2e-3, 2e-4):
        start = time.process_time()
        plc = cm.evaluate(shape, deviation=deviation)
        seconds = time.process_time() - start
        # As many segments as our balls have for this deviation.
        turns = [int(np.ceil(np.pi / np.arccos(1 - deviation / r))) for r in radius]
        start = time.process_time()
        balls = [
            manifold3d.Manifold.sphere(float(r), n).translate(c.tolist())
            for c, r, n in zip(center, radius, turns, strict=True)
        ]
        whole = manifold3d.Manifold.batch_boolean(balls, manifold3d.OpType.Add)
        n_facets = whole.num_tri()
        alone = time.process_time() - start
        rows.append(
            {
                "leaves": 100,
                "facets": plc.n_facets,
                "seconds": seconds,
                "manifold3d_facets": n_facets,
                "manifold3d_seconds": alone,
                "times": seconds / alone,
            }
        )
    return rows


SECTIONS = {s.__name__: s for s in (uniform, graded, surface, hexahedra, memory, evaluation)}


def main() -> None:
    """Run the sections named on the command line."""
    wanted = sys.argv[1:] or list(SECTIONS)
    for name in wanted:
        if name not in SECTIONS:
            raise SystemExit(f"no section {name!r}; there are {', '.join(SECTIONS)}")
    peers.solid()
    for name in wanted:
        rows = SECTIONS[name]()
        print(name)
        show(rows)
        save(f"space_{name}", rows, *PACKAGES)


if __name__ == "__main__":
    main()

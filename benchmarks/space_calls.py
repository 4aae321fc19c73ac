"""One measurement of ``space.py``, in a process of its own: ``space_calls.py FUNCTION ARGUMENTS``.

Arguments are a list in JSON, and so is what is printed last: a row. Times are processor times,
medians of whole calls after a coarse one that is not counted.
"""

from __future__ import annotations

import json
import statistics
import sys
import time
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import space_peers as peers
from space_solids import MODELS

import csgmesh as cm

Row = dict[str, Any]


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


def timed(run: Callable[[], Any], repeats: int) -> tuple[Row, Any]:
    """Median processor time, the wall's beside it, and the last result."""
    spent, wall = [], []
    for _ in range(repeats):
        start, at = time.process_time(), time.perf_counter()
        out = run()
        spent.append(time.process_time() - start)
        wall.append(time.perf_counter() - at)
    return {"seconds": statistics.median(spent), "wall": statistics.median(wall)}, out


def mesher(name: str, size: float, repeats: int) -> Row:
    """What one mesher takes for an edge length, and what it makes of it."""
    run: Callable[[float], tuple[np.ndarray, np.ndarray]] = getattr(peers, name)
    # Loads packages and kernels.
    run(max(0.1, size))
    row, (points, cells) = timed(lambda: run(size), repeats)
    row |= {"size": size, "cells": len(cells), "cells_per_second": len(cells) / row["seconds"]}
    if cells.shape[1] == 4:
        found = dihedrals(points, cells)
        return row | {
            "min_dihedral": float(found.min()),
            "max_dihedral": float(found.max()),
            "mean_min_dihedral": float(found.min(axis=1).mean()),
        }
    found = angles(points, cells)
    return row | {
        "min_angle": float(found.min()),
        "mean_min_angle": float(found.min(axis=1).mean()),
    }


def hexahedra(kind: str, size: float) -> Row:
    """Hexahedra alone, or mixed with others, by csgmesh."""
    octree = cm.Octree(cells=kind)
    cm.generate(peers.solid(), octree, size=0.1)
    row, mesh = timed(lambda: cm.generate(peers.solid(), octree, size=size), 1)
    jacobian = cm.quality(mesh).scaled_jacobian
    return row | {
        "size": size,
        "cells": mesh.n_cells,
        "cells_per_second": mesh.n_cells / row["seconds"],
        "hexahedra": len(mesh.cells.get("hexahedron", ())),
        "min_scaled_jacobian": float(np.nanmin(jacobian)),
        "mean_scaled_jacobian": float(np.nanmean(jacobian)),
    }


def memory(size: float) -> Row:
    """Bytes a cell that numpy allocates beyond the result."""
    cm.generate(peers.solid(), cm.Octree(), size=0.2)
    tracemalloc.start()
    mesh = cm.generate(peers.solid(), cm.Octree(), size=size, deviation=peers.DEVIATION)
    held, peak = tracemalloc.get_traced_memory()
    return {"size": size, "cells": mesh.n_cells, "bytes_per_cell": (peak - held) / mesh.n_cells}


def evaluation(model: str, share: float) -> Row:
    """Evaluation of a model beside manifold3d's own boolean of as many facets."""
    wanted = MODELS[model](share)
    cm.evaluate(cm.Ball((0, 0, 0), 1) | cm.Ball((0.5, 0, 0), 1))
    row, plc = timed(lambda: cm.evaluate(wanted.shape, deviation=wanted.deviation), 1)
    theirs, facets = timed(lambda: wanted.manifold3d().num_tri(), 1)
    return row | {
        "leaves": wanted.leaves,
        "facets": plc.n_facets,
        "manifold3d_facets": int(facets),
        "manifold3d_seconds": theirs["seconds"],
    }


if __name__ == "__main__":
    print(json.dumps(globals()[sys.argv[1]](*json.loads(sys.argv[2]))))

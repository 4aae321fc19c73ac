"""Evaluation of large trees beside shapely's `node` and `polygonize` of the same curves.

Shapely gets the flattened boundaries of all leaves and returns faces without names or regions;
csgmesh returns the named, exact boundary. Run ``python benchmarks/evaluation.py``.
"""

from __future__ import annotations

import numpy as np
import shapely
from report import median_seconds, save, show

import csgmesh as cm
from csgmesh.csg.program import compile_shape
from csgmesh.tolerance import DEVIATION_SHARE


def flattened(shape: cm.Shape) -> list[np.ndarray]:
    """Closed polylines of all leaves at csgmesh's default deviation."""
    loops = []
    for leaf in compile_shape(shape).leaves:
        curves, _ = leaf.curves()
        lo, hi = leaf.bounds()
        allowed = DEVIATION_SHARE * float(np.max(np.asarray(hi) - np.asarray(lo)))
        width = np.abs(curves.interval[:, 1] - curves.interval[:, 0])
        bend = curves.second_derivative_bounds()
        count = np.maximum(np.ceil(np.sqrt(width**2 * bend / (8 * allowed))), 1).astype(int)
        row = np.repeat(np.arange(len(curves)), count)
        step = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
        t0, t1 = curves.interval[row].T
        points = curves.points(row, t0 + (t1 - t0) * step / count[row])
        loops.append(np.concatenate([points, points[:1]]))
    return loops


def shapely_faces(loops: list[np.ndarray]) -> int:
    """Number of faces of the arrangement, by GEOS."""
    lines = shapely.multilinestrings([shapely.linestrings(loop) for loop in loops])
    faces = shapely.polygonize([shapely.node(lines)])
    return len(faces.geoms)


def cases() -> dict[str, cm.Shape]:
    """The trees measured."""
    rng = np.random.default_rng(1)
    centres, radii = rng.random((10_000, 2)) * 100, 0.2 + rng.random(10_000)
    disks = [cm.Disk(tuple(c), float(r)) for c, r in zip(centres.tolist(), radii, strict=True)]
    chain = disks[0]
    for disk in disks[1:]:
        chain = chain | disk
    holes = [cm.Disk((i + 0.5, j + 0.5), 0.3) for i in range(100) for j in range(100)]
    t = np.linspace(0, 2 * np.pi, 500_000, endpoint=False)
    r = 1 + 0.1 * np.sin(7 * t) + 1e-6 * rng.standard_normal(len(t))
    return {
        "union of 10,000 random disks": cm.union(disks),
        "chain of 10,000 |": chain,
        "plate with 10,000 holes": cm.difference(cm.Box((0, 0), (100, 100)), *holes),
        "polygon of 500,000 vertices": cm.Polygon(np.column_stack([r * np.cos(t), r * np.sin(t)])),
    }


def main() -> None:
    """Measure, print and save."""
    rows = []
    for label, shape in cases().items():
        loops = flattened(shape)
        ours = median_seconds(lambda shape=shape: cm.evaluate(shape), 3)
        theirs = median_seconds(lambda loops=loops: shapely_faces(loops), 3)
        pslg = cm.evaluate(shape)
        rows.append(
            {
                "case": label,
                "segments": pslg.n_segments,
                "csgmesh s": ours,
                "shapely s": theirs,
                "ratio": ours / theirs,
            }
        )
        show(rows[-1:])
    show(rows)
    save("evaluation", rows)


if __name__ == "__main__":
    main()

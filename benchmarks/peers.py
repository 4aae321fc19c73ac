"""The same meshing tasks for csgmesh and for its peers, Triangle and Gmsh (extra ``peers``).

Each function takes a domain and returns points and triangles, which is what is timed: the whole
call from arrays to arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import csgmesh as cm
from csgmesh.domain import Pslg

Arrays = tuple[np.ndarray, np.ndarray]


def ours(domain: Pslg, size: Any, min_angle: float = 30.0) -> Arrays:
    """csgmesh with default options."""
    mesh = cm.DelaunayRefinement(min_angle=min_angle).generate(domain, size)
    return mesh.points, mesh.cells["triangle"]


def for_triangle(domain: Pslg) -> dict[str, np.ndarray]:
    """A domain's chords; the package refuses read-only arrays."""
    return {"vertices": domain.points.copy(), "segments": domain.segments.astype(np.int32)}


def triangle_package(domain: Pslg, area: float, min_angle: float = 30.0) -> Arrays:
    """Triangle under an area bound."""
    import triangle

    out = triangle.triangulate(for_triangle(domain), f"pq{min_angle:g}a{area:.17f}Q")
    return out["vertices"], out["triangles"]


def triangle_inside(domain: Pslg, min_angle: float) -> Arrays:
    """Triangle without a size, kept out of whatever is outside the domain."""
    import triangle

    out = triangle.triangulate(holed(domain), f"pq{min_angle:g}Q")
    return out["vertices"], out["triangles"]


def holed(domain: Pslg) -> dict[str, np.ndarray]:
    """A domain's chords, and points outside beside them, from which Triangle eats holes.

    Around the largest component there is nothing to be told.
    """
    given = for_triangle(domain)
    n = len(domain.points)
    links = coo_array((np.ones(domain.n_segments), domain.segments.T), shape=(n, n))
    _, component = connected_components(links, directed=False)
    of_segment = component[domain.segments[:, 0]]
    lo, hi = np.full((n, 2), np.inf), np.full((n, 2), -np.inf)
    np.minimum.at(lo, component, domain.points)
    np.maximum.at(hi, component, domain.points)
    inner = (domain.segment_region < 0).any(axis=1)
    inner &= of_segment != np.argmax((hi - lo).max(axis=1))
    start, end = (domain.points[domain.segments[inner, k]] for k in (0, 1))
    across = (end - start) @ np.array([[0.0, -1.0], [1.0, 0.0]])
    points, left = np.zeros((0, 2)), np.ones(len(start), bool)
    assert domain.oracle is not None
    for share in (1e-3, 1e-10):
        beside = 0.5 * (start + end)[left] + share * across[left]
        outside = domain.oracle.region(beside) < 0
        points = np.concatenate([points, beside[outside]])
        left[left] = ~outside
    return given | {"holes": points} if len(points) else given


def triangle_graded(
    domain: Pslg, size: Callable[[np.ndarray], np.ndarray], min_angle: float = 30.0
) -> Arrays:
    """Triangle refining its own meshes under areas from the size at each centroid."""
    import triangle

    out = triangle.triangulate(
        for_triangle(domain),
        f"pq{min_angle:g}Q",
    )
    while True:
        corners = out["vertices"][out["triangles"]]
        wanted = equilateral(size(corners.mean(axis=1)))
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        # Sizes at new centroids differ a little: stop when next to nothing would be split.
        if (area > 1.5 * wanted).mean() < 1e-3:
            return out["vertices"], out["triangles"]
        keep = {k: out[k] for k in ("vertices", "segments", "triangles")}
        out = triangle.triangulate(
            keep | {"triangle_max_area": wanted[:, None]}, f"rpq{min_angle:g}aQ"
        )


def gmsh_frontal(domain: Pslg, size: float) -> Arrays:
    """Gmsh's frontal-Delaunay algorithm, on the chords."""
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.option.setNumber("Mesh.Algorithm", 6)
    geo = gmsh.model.geo
    for k, (x, y) in enumerate(domain.points.tolist()):
        geo.addPoint(x, y, 0.0, size, k + 1)
    for k, (a, b) in enumerate(domain.segments.tolist()):
        geo.addLine(a + 1, b + 1, k + 1)
    loops = _loops(domain.segments)
    for k, chain in enumerate(loops):
        geo.addCurveLoop((chain + 1).tolist(), k + 1)
    # The outer loop is the longest way around; the others are holes.
    order = sorted(range(len(loops)), key=lambda k: -_reach(domain, loops[k]))
    geo.addPlaneSurface([k + 1 for k in order], 1)
    geo.synchronize()
    gmsh.model.mesh.generate(2)
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    _, nodes = gmsh.model.mesh.getElementsByType(2)
    gmsh.finalize()
    number = np.zeros(int(tags.max()) + 1, np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    return xyz.reshape(-1, 3)[:, :2], number[nodes.astype(np.int64)].reshape(-1, 3)


def _loops(segments: np.ndarray) -> list[np.ndarray]:
    """Segments of each loop, one after the other."""
    starting_at = {int(a): k for k, (a, _) in enumerate(segments)}
    left, found = set(range(len(segments))), []
    while left:
        chain = [min(left)]
        while (onward := starting_at[int(segments[chain[-1], 1])]) != chain[0]:
            chain.append(onward)
        left -= set(chain)
        found.append(np.array(chain))
    return found


def _reach(domain: Pslg, chain: np.ndarray) -> float:
    """How far a loop extends."""
    return float(np.ptp(domain.points[domain.segments[chain]].reshape(-1, 2), axis=0).max())


def equilateral(edge: Any) -> Any:
    """Area of an equilateral triangle."""
    return np.sqrt(3.0) / 4.0 * edge**2


def measures(points: np.ndarray, cells: np.ndarray, size: Any = None) -> dict[str, float]:
    """Angles of a mesh, and how many of its edges are about as long as wanted."""
    quality = cm.quality(cm.Mesh(points, {"triangle": cells}))
    found = {
        "triangles": len(cells),
        "min angle": float(quality.min_angle.min()),
        "mean of min angles": float(quality.min_angle.mean()),
    }
    if size is not None:
        ends = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), 1)
        ends = np.unique(ends[:, 0].astype(np.int64) * len(points) + ends[:, 1])
        a, b = points[ends // len(points)], points[ends % len(points)]
        ratio = np.hypot(*(b - a).T) / size(0.5 * (a + b))
        found["mean edge / h"] = float(ratio.mean())
        found["share in [0.6, 1.6] h"] = float(((ratio >= 0.6) & (ratio <= 1.6)).mean())
    return found

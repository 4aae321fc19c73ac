"""A hexagonal lattice inside a domain: where the size is uniform, nothing is better."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.meshers.background import Background
from csgmesh.meshers.workspace import MOST_POINTS, ROOM, SLICE, Workspace, grown, rounds

#: Lattice points nearer than this to a vertex, or to a subsegment, are left out (shares of the
#: size): what lies between lattice and boundary is left to refinement.
FROM_VERTEX = 0.7
FROM_SEGMENT = 0.5
#: Where sizes sink below this share of the lattice's, it ends; above, its triangles are not yet too
#: large for refinement.
NEARLY = 0.95


def fill_with_lattice(work: Workspace, size: float, ground: Background | None = None) -> None:
    """Insert the points of a hexagonal lattice of edge length `size` that lie inside.

    Only those at which the background, if there is one, wants that size.
    """
    points = lattice(work, size)
    if len(points):
        keys = np.empty(len(points), np.int64)
        kernels.curve_keys(points.reshape(-1), rounds(len(points)), keys)
        keys.sort()
        points = points[keys & (MOST_POINTS - 1)]
    if ground is not None and len(points):
        points = points[ground.at(points.reshape(-1))[0] >= NEARLY * size]
    n = len(points)
    if not n:
        return
    candidates = points.reshape(-1)
    work.points = grown(work.points, 2 * (work.n_points + n))
    for name in ("origin", "twin", "sub"):
        setattr(work, name, grown(getattr(work, name), 4 * (work.n_triangles + 2 * n)))
    counts = np.array([work.n_points, work.n_triangles, 0, 0], np.int64)
    distances = np.array([(FROM_VERTEX * size) ** 2, (FROM_SEGMENT * size) ** 2])
    while True:
        status = kernels.fill(
            work.points,
            work.origin,
            work.twin,
            work.sub,
            work.work,
            candidates,
            counts,
            distances,
        )
        work.report("fill", int(counts[2]), n)
        if status == ROOM:
            work.widen()
        elif status != SLICE:
            break
    work.n_points, work.n_triangles = int(counts[0]), int(counts[1])


def lattice(work: Workspace, size: float) -> np.ndarray:
    """Points of a hexagonal lattice over the domain's box, aligned with its longest segment."""
    domain = work.domain
    a, b = (domain.points[domain.segments[:, k]] for k in (0, 1))
    longest = int(np.argmax(np.hypot(*(b - a).T)))
    along = (b - a)[longest] / np.hypot(*(b - a)[longest])
    across = np.array([-along[1], along[0]])
    # Row 0 lies on the longest segment; odd rows stand over the middles of its parts.
    start = a[longest] + 0.5 * size * along
    lo, hi = work.pieces.points.min(axis=0), work.pieces.points.max(axis=0)
    corners = np.array([lo, (hi[0], lo[1]), hi, (lo[0], hi[1])]) - start
    s, t = corners @ along / size, corners @ across / (np.sqrt(0.75) * size)
    rows = np.arange(int(np.ceil(t.min())), int(np.floor(t.max())) + 1)
    steps = np.arange(int(np.floor(s.min())) - 1, int(np.ceil(s.max())) + 1)
    x = size * (steps[None, :] - 0.5 * (rows[:, None] % 2 == 0))
    y = np.broadcast_to(np.sqrt(0.75) * size * rows[:, None], x.shape)
    points = start + x.reshape(-1, 1) * along + y.reshape(-1, 1) * across
    return np.ascontiguousarray(points[((points > lo) & (points < hi)).all(axis=1)])

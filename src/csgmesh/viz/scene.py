"""What a picture shows, whatever it was made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from csgmesh.domain.curves import LINE
from csgmesh.domain.pslg import Pslg
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.lagrange import basis
from csgmesh.mesh.nodes import node_family
from csgmesh.tree import LinearTree

#: Straight pieces drawn for each segment of a curve: segments are already near their curve, so a
#: few are enough for the eye.
_PIECES = 6

#: And for each edge of a curved cell, which may turn by 50 degrees.
_BENT_PIECES = 12


@dataclass(frozen=True)
class Scene:
    """Polygons by region, polylines by marker, points.

    Attributes
    ----------
    lo, hi : (2,) float64
        Box of the points.
    cells : list of (polygons (m, k, 2), region (m,))
        Cells of a mesh.
    areas : dict of int to list of (k, 2)
        Closed loops around each region, the region on their left; for a domain without cells.
    lines : list of (polylines (m, k, 2), marker (m,))
        Boundaries, interfaces and embedded paths.
    points : (n, 2) float64
        Embedded points, with their markers.
    vertices : (n, 2) float64
        Ends of segments, for a PSLG.
    title : str
        Counts.
    """

    lo: np.ndarray
    hi: np.ndarray
    region_names: tuple[str, ...]
    boundary_names: tuple[tuple[str, ...], ...]
    title: str
    cells: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    areas: Mapping[int, list[np.ndarray]] = field(default_factory=dict)
    lines: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    points: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    point_marker: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    vertices: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))


def mesh_scene(mesh: Mesh) -> Scene:
    """Scene of a plane mesh: facets are drawn as they are, not as the curves they stand for."""
    is_marked = mesh.point_marker >= 0
    cells = []
    for kind in mesh.cells:
        cells.append((_outlines(mesh, kind), mesh.cell_region[kind]))
    lines = []
    for kind, rows in mesh.facets.items():
        lines.append((_edge(mesh, kind, rows), mesh.facet_marker[kind]))
    counts = [_count(len(rows), kind) for kind, rows in mesh.cells.items() if len(rows)]
    return Scene(
        *_box(mesh.points),
        mesh.region_names,
        mesh.boundary_names,
        ", ".join([*counts, _count(mesh.n_points, "point")]),
        cells=cells,
        lines=lines,
        points=mesh.points[is_marked],
        point_marker=mesh.point_marker[is_marked],
    )


def _outlines(mesh: Mesh, kind: str) -> np.ndarray:
    """Polygons around cells of a kind, (m, k, 2), through the points of bent edges."""
    rows, data = mesh.cells[kind], KINDS[kind]
    if data.order == 1:
        return mesh.points[rows]
    edges = [_edge(mesh, data.facet_kinds[0], rows[:, list(edge)]) for edge in data.facets]
    return np.concatenate([edge[:, :-1] for edge in edges], axis=1)


def _edge(mesh: Mesh, kind: str, rows: np.ndarray) -> np.ndarray:
    """Polylines along edges, (m, k, 2)."""
    if KINDS[kind].order == 1:
        return mesh.points[rows]
    places = np.linspace(0.0, 1.0, _BENT_PIECES + 1)[:, None]
    lines: np.ndarray = basis(kind, node_family(mesh), places) @ mesh.points[rows]
    return lines


def pslg_scene(domain: Pslg, *, vertices: bool) -> Scene:
    """Scene of a PSLG, through its exact curves."""
    curve = domain.segment_curve
    is_curved = curve >= 0
    is_curved[is_curved] = domain.curves.kind[curve[is_curved]] != LINE
    ends = domain.points[domain.segments]
    bent = _along_curves(domain, np.flatnonzero(is_curved))
    is_marked = domain.point_marker >= 0
    lines = [
        (ends[~is_curved], domain.segment_marker[~is_curved]),
        (bent, domain.segment_marker[is_curved]),
    ]
    n_regions = len(domain.region_names)
    counts = f"{_count(len(domain.segments), 'segment')}, {_count(len(domain.points), 'point')}"
    if not vertices:
        n_names = len({name for names in domain.boundary_names for name in names})
        counts = f"area {domain.areas().sum():.6g}, {_count(n_names, 'boundary name')}"
    return Scene(
        *_box(np.concatenate([domain.points, bent.reshape(-1, 2)])),
        domain.region_names,
        domain.boundary_names,
        f"{n_regions} regions, {counts}" if n_regions > 1 else counts,
        areas=_areas(domain, ends, bent, is_curved),
        lines=lines,
        points=domain.points[is_marked],
        point_marker=domain.point_marker[is_marked],
        vertices=domain.points if vertices else np.zeros((0, 2)),
    )


def tree_scene(tree: LinearTree) -> Scene:
    """Scene of a quadtree: its leaves."""
    lo, size = tree.boxes()
    corners = lo[:, None] + size[:, None] * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    return Scene(
        tree.lo,
        tree.lo + tree.extent,
        ("tree",),
        (),
        f"{_count(tree.n_leaves, 'leaf')}".replace("leafs", "leaves"),
        cells=[(corners, np.zeros(len(corners), np.int64))],
    )


def _count(n: int, noun: str) -> str:
    return f"{n:,} {noun if n == 1 else noun + 's'}"


def _box(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    if not len(points):
        return np.zeros(2), np.ones(2)
    return points.min(axis=0), points.max(axis=0)


def _along_curves(domain: Pslg, which: np.ndarray) -> np.ndarray:
    """Points along the exact curves of some segments, (k, pieces + 1, 2); the ends are vertices."""
    share = np.linspace(0.0, 1.0, _PIECES + 1)
    t0, t1 = domain.segment_interval[which].T
    t = t0[:, None] + (t1 - t0)[:, None] * share
    curve = np.repeat(domain.segment_curve[which], _PIECES + 1)
    points = domain.curves.points(curve, t.ravel()).reshape(-1, _PIECES + 1, 2)
    points[:, [0, -1]] = domain.points[domain.segments[which]]
    return points


def _areas(
    domain: Pslg, ends: np.ndarray, bent: np.ndarray, is_curved: np.ndarray
) -> dict[int, list[np.ndarray]]:
    curved_number = np.cumsum(is_curved) - 1
    left, right = domain.segment_region.T
    loops: dict[int, list[np.ndarray]] = {}
    for region in range(len(domain.region_names)):
        forward = np.flatnonzero((left == region) & (right != region))
        backward = np.flatnonzero((right == region) & (left != region))
        directed = np.concatenate([domain.segments[forward], domain.segments[backward][:, ::-1]])
        number = np.concatenate([forward, backward])
        loops[region] = []
        for walk in closed_walks(directed):
            parts = []
            for step in walk:
                segment = number[step]
                line = bent[curved_number[segment]] if is_curved[segment] else ends[segment]
                parts.append((line if step < len(forward) else line[::-1])[:-1])
            loops[region].append(np.concatenate(parts))
    return loops


def closed_walks(directed: np.ndarray) -> list[list[int]]:
    """Directed edges (m, 2), as many into as out of each vertex, as closed walks of edge numbers.

    Any pairing of an edge into a vertex with one out of it gives the same filled area, so they are
    paired in the order of their numbers.

    Examples
    --------
    >>> closed_walks(np.array([[0, 1], [2, 0], [1, 2]]))
    [[0, 2, 1]]
    """
    out = np.argsort(directed[:, 0], kind="stable")
    into = np.argsort(directed[:, 1], kind="stable")
    follower = np.empty(len(directed), np.int64)
    follower[into] = out
    after, seen = follower.tolist(), [False] * len(directed)
    walks = []
    for first in range(len(directed)):
        walk = []
        step = first
        while not seen[step]:
            seen[step] = True
            walk.append(step)
            step = after[step]
        if walk:
            walks.append(walk)
    return walks

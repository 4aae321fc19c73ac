"""Take vertices away again that a mesher put on edges which were there before."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from csgmesh import kernels
from csgmesh.errors import MeshingError
from csgmesh.mesh import Mesh


def unsplit(mesh: Mesh, is_given: np.ndarray, who: str) -> Mesh:
    """Join the pieces of each given facet, and fill the gap beside it with other triangles.

    Parameters
    ----------
    mesh : Mesh
        Whose facets on given edges have a marker each.
    is_given : (f,) bool
        Which facets lie on given edges.
    who : str
        Name of the mesher, for messages.

    Raises
    ------
    MeshingError
        If there is anything but triangles beside such a vertex.
    """
    line, marker = mesh.facets["line"], mesh.facet_marker["line"]
    given = np.flatnonzero(is_given)
    count = np.bincount(marker[given], minlength=1)
    split = given[count[marker[given]] > 1]
    if not len(split):
        return mesh
    ends = np.concatenate([line[split, 0], line[split, 1]])
    owner = np.concatenate([marker[split]] * 2)
    pairs, times = np.unique(np.stack([owner, ends], axis=1), axis=0, return_counts=True)
    inner = pairs[times == 2, 1]
    cells = _Triangles(mesh, who)
    before = dict(zip(line[split, 1].tolist(), split.tolist(), strict=True))
    after = dict(zip(line[split, 0].tolist(), split.tolist(), strict=True))
    ends_of = {int(k): line[k].tolist() for k in split}
    gone = set()
    for v in inner.tolist():
        f, g = before[v], after[v]
        cells.remove(v, ends_of[f][0], ends_of[g][1])
        # Facet f takes g's part over.
        ends_of[f][1] = ends_of[g][1]
        before[ends_of[g][1]] = f
        gone.add(g)
    lines = line.copy()
    for k, row in ends_of.items():
        lines[k] = row
    kept = np.array([k for k in range(len(line)) if k not in gone])
    return cells.finished(lines, kept, inner)


class _Triangles:
    """Triangles around some vertices, by their vertices."""

    def __init__(self, mesh: Mesh, who: str) -> None:
        self.mesh, self.who = mesh, who
        self.rows: dict[int, list[int]] = dict(enumerate(mesh.cells["triangle"].tolist())) if (
            "triangle" in mesh.cells) else {}  # fmt: skip
        self.region = mesh.cell_region.get("triangle", np.zeros(0, np.int64)).tolist()
        self.at: dict[int, set[int]] = {}
        for t, row in self.rows.items():
            for v in row:
                self.at.setdefault(v, set()).add(t)

    def remove(self, v: int, a: int, b: int) -> None:
        """Remove a vertex between a and b of the boundary, with the domain on the left."""
        around = sorted(self.at.get(v, ()))
        onward = {}
        for t in around:
            row = self.rows[t]
            k = row.index(v)
            onward[row[(k + 1) % 3]] = row[(k + 2) % 3]
        ring = [b]
        while ring[-1] != a and ring[-1] in onward:
            ring.append(onward[ring[-1]])
        if ring[-1] != a or len(ring) != len(around) + 1:
            x, y = self.mesh.points[v]
            raise MeshingError(
                f"{self.who} needs a vertex at ({x:.6g}, {y:.6g}), on an interface that another "
                "mesher has meshed already, and has no triangles there; let DelaunayRefinement do "
                "one of the two regions"
            )
        region = self.region[around[0]]
        for t in around:
            for u in self.rows.pop(t):
                self.at[u].discard(t)
        for row in _triangulated(self.mesh.points, [a, *ring[:-1]]):
            t = len(self.region)
            self.region.append(region)
            self.rows[t] = row
            for u in row:
                self.at[u].add(t)

    def finished(self, lines: np.ndarray, kept: np.ndarray, removed: np.ndarray) -> Mesh:
        """The mesh as it is now."""
        mesh = self.mesh
        is_left = np.ones(mesh.n_points, bool)
        is_left[removed] = False
        number = np.cumsum(is_left) - 1
        order = sorted(self.rows)
        cells = {kind: number[rows] for kind, rows in mesh.cells.items()}
        cells["triangle"] = number[np.array([self.rows[t] for t in order])]
        regions = dict(mesh.cell_region)
        regions["triangle"] = np.array([self.region[t] for t in order])
        facets: dict[str, Any] = {"facets": number[lines[kept]]}
        for name in ("facet_marker", "facet_region", "facet_curve", "facet_interval"):
            facets[name] = getattr(mesh, name)["line"][kept]
        by_kind: dict[str, Any] = {name: {"line": rows} for name, rows in facets.items()}
        return replace(
            mesh,
            points=mesh.points[is_left],
            point_marker=mesh.point_marker[is_left],
            cells=cells,
            cell_region=regions,
            **by_kind,
        )


def _triangulated(points: np.ndarray, polygon: list[int]) -> list[list[int]]:
    """Triangles of a simple counterclockwise polygon, the best ear first."""
    polygon = list(polygon)
    out = []
    while len(polygon) > 3:
        n = len(polygon)
        ears = np.array([[polygon[k - 1], polygon[k], polygon[(k + 1) % n]] for k in range(n)])
        good = kernels.orientations(points, ears) > 0
        for k in np.flatnonzero(good).tolist():
            others = [p for p in polygon if p not in ears[k]]
            inside = np.ones(len(others), bool)
            for j in range(3):
                side = np.array([[ears[k][j], ears[k][(j + 1) % 3], p] for p in others])
                inside &= kernels.orientations(points, side) >= 0
            good[k] = not inside.any()
        if not good.any():
            break
        value = np.where(good, [_smallest_angle(points[ear]) for ear in ears], -1.0)
        k = int(np.argmax(value))
        out.append(ears[k].tolist())
        polygon.pop(k)
    return [*out, polygon]


def _smallest_angle(corner: np.ndarray) -> float:
    u, v = np.roll(corner, -1, axis=0) - corner, np.roll(corner, 1, axis=0) - corner
    return float(np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1)).min())

"""Sheets that overlap in a plane get one triangulation.

Once vertices are settled, the outlines of overlapping sheets are edges and vertices in common, but
each sheet still has diagonals of its own. Outlines divide the plane into cells; each cell is
triangulated once, and every sheet takes the triangles of the cells that it covers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.errors import EvaluationError
from csgmesh.graphs import components

#: A point lies on a facet's edge if the edge and it span less than this share of the facet.
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Overlaid:
    """Facets that take the place of others.

    Attributes
    ----------
    triangles : (m, 3) int64
    parent : (m,) int64
        A facet of the same sheet in whose place each one is.
    gone : (k,) int64
    """

    triangles: np.ndarray
    parent: np.ndarray
    gone: np.ndarray


def coplanar_overlaps(corner: np.ndarray, pairs: np.ndarray, snap: float) -> np.ndarray:
    """Pairs of facets that lie in one plane and have more than an edge in common, (k, 2).

    Parameters
    ----------
    corner : (m, 3, 3) float64
    pairs : (k', 2) int64
    snap : float
    """
    for a, b in ((0, 1), (1, 0)):
        p, q = corner[pairs[:, a]], corner[pairs[:, b]]
        normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        size = np.sqrt((normal * normal).sum(axis=1))
        height = np.abs(np.einsum("kij,kj->ki", q - p[:, :1], normal)).max(axis=1)
        pairs = pairs[(height <= 2.0 * snap * size) & (size > 0.0)]
    # Some edge of either has the other triangle on its outer side if they do not overlap.
    apart = np.zeros(len(pairs), bool)
    for a, b in ((0, 1), (1, 0)):
        p, q = corner[pairs[:, a]], corner[pairs[:, b]]
        normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        normal /= np.sqrt((normal * normal).sum(axis=1))[:, None]
        for k in range(3):
            d = p[:, (k + 1) % 3] - p[:, k]
            inward = np.cross(normal, d)
            inward /= np.sqrt((inward * inward).sum(axis=1))[:, None]
            apart |= (np.einsum("kij,kj->ki", q - p[:, k, None], inward) <= snap).all(axis=1)
    return pairs[~apart]


def overlaid(
    points: np.ndarray, triangles: np.ndarray, sheet: np.ndarray, pairs: np.ndarray, snap: float
) -> Overlaid:
    """One triangulation for all sheets of each cluster of overlapping facets.

    Parameters
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int64
    sheet : (m,) int64
    pairs : (k, 2) int64
        Facets of different sheets that overlap in a plane.
    snap : float

    Raises
    ------
    EvaluationError
        If outlines cross where they have no vertex, with the place.
    """
    ranked = np.sort(triangles, axis=1)
    differ = (ranked[pairs[:, 0]] != ranked[pairs[:, 1]]).any(axis=1)
    member, number = np.unique(pairs, return_inverse=True)
    number = number.reshape(-1, 2)
    _, label = components(len(member), number[:, 0], number[:, 1])
    unsettled = np.unique(label[number[differ, 0]])
    rows, parents, gone = [np.zeros((0, 3), np.int64)], [member[:0]], [member[:0]]
    order = np.argsort(label, kind="stable")
    start = np.searchsorted(label[order], unsettled)
    end = np.searchsorted(label[order], unsettled, side="right")
    for first, last in zip(start.tolist(), end.tolist(), strict=True):
        own = member[order[first:last]]
        new, parent = _retriangulated(points, triangles[own], sheet[own], snap)
        rows.append(new)
        parents.append(own[parent])
        gone.append(own)
    return Overlaid(np.concatenate(rows), np.concatenate(parents), np.concatenate(gone))


def _retriangulated(
    points: np.ndarray, triangles: np.ndarray, sheet: np.ndarray, snap: float
) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of all sheets of a cluster, and for each a triangle of the same sheet."""
    used, local = np.unique(triangles, return_inverse=True)
    local = local.reshape(-1, 3)
    flat = _in_plane(points[used], local)
    a, b, c = (flat[local[:, k]] for k in range(3))
    way = _turn(a, b, c)
    # A flap has one surface on both its sides: what faces the other way is another sheet.
    _, sheet = np.unique(2 * sheet + (way > 0), return_inverse=True)
    cells = _cells(flat, _outlines(local, sheet))
    forward = np.where((way > 0)[:, None], local, local[:, ::-1])
    corner = flat[forward]
    rows, parents = [], []
    covered = np.zeros(int(sheet.max()) + 1)
    for cell in cells:
        p, q, r = (flat[cell[:, k]] for k in range(3))
        size = _turn(p, q, r)
        middle = (p + q + r)[int(np.argmax(size))] / 3.0
        depth = np.min(
            [_turn(corner[:, k], corner[:, (k + 1) % 3], middle) for k in range(3)], axis=0
        )
        # The middle of a cell may lie on a sheet's diagonal: one facet of each sheet is asked.
        inside = np.flatnonzero(depth > -_ROUNDING * np.abs(way))
        inside = inside[np.lexsort((-depth[inside], sheet[inside]))]
        inside = inside[np.r_[True, np.diff(sheet[inside]) != 0][: len(inside)]]
        for facet in inside.tolist():
            rows.append(cell if way[facet] > 0 else cell[:, ::-1])
            parents.append(np.full(len(cell), facet))
            covered[sheet[facet]] += size.sum()
    wanted = np.bincount(sheet, np.abs(way), len(covered))
    reach = 4.0 * snap * float(np.ptp(flat, axis=0).sum())
    if np.abs(covered - wanted).max() > reach * len(triangles):
        x, y, z = points[used].mean(axis=0)
        raise EvaluationError(f"faces that coincide cannot be divided alike near ({x}, {y}, {z})")
    return used[np.concatenate(rows)], np.concatenate(parents)


def _turn(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the signed area of triangles in the plane."""
    u, v = b - a, c - a
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


def _in_plane(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Coordinates (n, 2) in the plane of the largest triangle."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    largest = int(np.argmax((normal**2).sum(axis=1)))
    along = b[largest] - a[largest]
    along = along / np.sqrt(along @ along)
    across = np.cross(normal[largest], along)
    across = across / np.sqrt(across @ across)
    return (points - a[largest]) @ np.column_stack([along, across])


def _outlines(triangles: np.ndarray, sheet: np.ndarray) -> np.ndarray:
    """Edges that only one triangle of a sheet has, each once, (k, 2)."""
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    n = int(triangles.max()) + 1
    key = edges.min(axis=1) * n + edges.max(axis=1)
    of_sheet = np.column_stack([key, np.repeat(sheet, 3)])
    rows, count = np.unique(of_sheet, axis=0, return_counts=True)
    lone = np.unique(rows[count == 1, 0])
    return np.column_stack([lone // n, lone % n])


def _cells(flat: np.ndarray, edges: np.ndarray) -> list[np.ndarray]:
    """Triangles over the points, counterclockwise, of each cell between the edges."""
    import shapely
    from manifold3d import triangulate

    number = {place: k for k, place in enumerate(map(tuple, flat.tolist()))}
    found = shapely.polygonize(list(shapely.linestrings(flat[edges])))
    out = []
    for polygon in shapely.get_parts(found):
        polygon = shapely.orient_polygons(polygon)
        rings = shapely.get_rings(polygon)
        loops = [shapely.get_coordinates(ring)[:-1] for ring in rings]
        vertex = np.array([number[tuple(p)] for loop in loops for p in loop.tolist()])
        if len(vertex) == 3:
            out.append(vertex[None])
        else:
            cell = np.asarray(triangulate(loops, allow_convex=False), np.int64).reshape(-1, 3)
            out.append(vertex[cell])
    return out

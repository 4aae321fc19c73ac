"""Surface meshes made of a boundary's own facets, halved until they are small."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surface_mesh import SurfaceMesh


def surface_of(plc: Plc, size: float = np.inf) -> SurfaceMesh:
    """The facets of a boundary, their edges halved while any is longer than `size`."""
    points, triangles = np.array(plc.points), np.array(plc.facets)
    table = np.column_stack([plc.facet_surface, plc.facet_marker, plc.facet_region])
    kinds, face = np.unique(table, axis=0, return_inverse=True)
    face = face.reshape(-1)
    segments = np.sort(plc.feature_edges(), axis=1)
    while True:
        edges = np.sort(triangles[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2), axis=1)
        edges, where = np.unique(edges, axis=0, return_inverse=True)
        where = where.reshape(-1, 3)
        lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
        longest = where[np.arange(len(where)), lengths[where].argmax(axis=1)]
        # An edge is halved that is the longest of all triangles around it.
        users = np.bincount(where.reshape(-1), minlength=len(edges))
        mine = np.bincount(longest, minlength=len(edges))
        split = np.flatnonzero((lengths > size) & (users == mine))
        if not len(split):
            break
        middle = np.full(len(edges), -1)
        middle[split] = len(points) + np.arange(len(split))
        points = np.vstack([points, points[edges[split]].mean(axis=1)])
        k = np.flatnonzero(middle[longest] >= 0)
        slot = (where[k] == longest[k, None]).argmax(axis=1)
        apex, a, b = (triangles[k, (slot + turn) % 3] for turn in range(3))
        m = middle[longest[k]]
        triangles[k] = np.column_stack([apex, a, m])
        triangles = np.vstack([triangles, np.column_stack([apex, m, b])])
        face = np.append(face, face[k])
        number = {tuple(e): i for i, e in enumerate(edges.tolist())}
        rows = []
        for u, v in segments.tolist():
            m = middle[number[(u, v)]]
            rows += [(u, v)] if m < 0 else [(u, m), (v, m)]
        segments = np.array(rows).reshape(-1, 2)
    on_curve = np.unique(segments)
    dim = np.full(len(points), 2, np.int8)
    dim[on_curve] = 1
    return SurfaceMesh(
        points,
        triangles,
        face,
        kinds[:, 0],
        kinds[:, 1],
        kinds[:, 2:],
        segments,
        np.zeros(len(segments), np.int64),
        np.zeros((1, 2), np.int64),
        dim,
        np.zeros(len(points), np.int64),
        plc,
    )

"""Cells and facets between two stations of a sweep, collapsed where they meet an axis."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from csgmesh.errors import MeshingError


def swept_cells(
    flat_cells: Mapping[str, np.ndarray],
    flat_region: Mapping[str, np.ndarray],
    here: np.ndarray,
    after: np.ndarray,
    on_axis: np.ndarray,
    flips: bool,
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Cells of all layers by kind, and their regions.

    Parameters
    ----------
    flat_cells, flat_region : mapping of str to array
        Triangles, quads or both, and their regions.
    here, after : (n_layers, n_points) int64
        Numbers of the planar points at the beginning and the end of each layer.
    on_axis : (n_points,) bool
        Points that stay where they are.
    flips : bool
        Whether the sweep goes against the normal of counterclockwise cells.
    """
    found: dict[str, list[np.ndarray]] = {}
    region: dict[str, list[np.ndarray]] = {}
    for kind, rows in flat_cells.items():
        if kind not in ("triangle", "quad"):
            raise MeshingError(f"Sweep takes profiles of triangles and quads; got {kind}")
        if flips:
            rows = rows[:, ::-1]
        rows = axis_first(rows, on_axis)
        n_axis = on_axis[rows].sum(axis=1)
        for k in np.unique(n_axis).tolist():
            own = np.flatnonzero(n_axis == k)
            for made, corners in _columns(kind, int(k), rows[own], on_axis):
                floor = here[:, corners[0]], after[:, corners[0]]
                table = np.stack([floor[s][..., j] for s, j in corners[1]], axis=-1)
                found.setdefault(made, []).append(table.reshape(-1, len(corners[1])))
                region.setdefault(made, []).append(np.tile(flat_region[kind][own], len(here)))
    kinds = [k for k in ("hexahedron", "wedge", "pyramid", "tetra") if k in found]
    return (
        {k: np.concatenate(found[k]) for k in kinds},
        {k: np.concatenate(region[k]) for k in kinds},
    )


def axis_first(rows: np.ndarray, on_axis: np.ndarray) -> np.ndarray:
    """Cells turned so that those of their corners that lie on the axis come first."""
    k = rows.shape[1]
    at = on_axis[rows]
    start = np.argmax(at & ~np.roll(at, 1, axis=1), axis=1)
    return np.take_along_axis(rows, (start[:, None] + np.arange(k)) % k, axis=1)


#: A corner of a swept cell: 0 at the beginning of its layer or 1 at the end, and which corner of
#: the planar cell.
Corners = list[tuple[int, int]]

_WEDGE: Corners = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)]
_HEXAHEDRON: Corners = [(s, j) for s in (0, 1) for j in range(4)]
#: With corner 0 on the axis: the base is swept by the side 1-2, the apex is corner 0.
_PYRAMID: Corners = [(0, 1), (1, 1), (1, 2), (0, 2), (0, 0)]
_TETRA: Corners = [(0, 0), (0, 1), (0, 2), (1, 2)]
#: With corners 0 and 1 on the axis.
_LYING_WEDGE: Corners = [(0, 0), (0, 3), (1, 3), (0, 1), (0, 2), (1, 2)]
_SECOND_PYRAMID: Corners = [(0, 2), (1, 2), (1, 3), (0, 3), (0, 0)]

_SWEPT: dict[tuple[str, int], list[tuple[str, Corners]]] = {
    ("triangle", 0): [("wedge", _WEDGE)],
    ("triangle", 1): [("pyramid", _PYRAMID)],
    ("triangle", 2): [("tetra", _TETRA)],
    ("quad", 0): [("hexahedron", _HEXAHEDRON)],
    ("quad", 1): [("pyramid", _PYRAMID), ("pyramid", _SECOND_PYRAMID)],
    ("quad", 2): [("wedge", _LYING_WEDGE)],
}


def _columns(
    kind: str, n_axis: int, rows: np.ndarray, on_axis: np.ndarray
) -> list[tuple[str, tuple[np.ndarray, Corners]]]:
    if (kind, n_axis) not in _SWEPT or (n_axis == 2 and not on_axis[rows[:, 1]].all()):
        raise MeshingError(
            f"a {kind} of the profile has {n_axis} corners on the axis of the revolution; a finer "
            "size keeps its cells off the axis"
        )
    return [(made, (rows, corners)) for made, corners in _SWEPT[kind, n_axis]]


def swept_facets(
    lines: np.ndarray, here: np.ndarray, after: np.ndarray, on_axis: np.ndarray, flips: bool
) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Facets that the profile's boundary sweeps: kind, corners, and the line each comes from.

    Lines keep the domain on their left; facets look out of it.
    """
    tail, head = (lines[:, 1], lines[:, 0]) if flips else (lines[:, 0], lines[:, 1])
    out = []
    number = np.arange(len(lines))
    for kind, at, corners in (
        ("quad", ~on_axis[tail] & ~on_axis[head], [(0, 0), (0, 1), (1, 1), (1, 0)]),
        ("triangle", on_axis[tail] & ~on_axis[head], [(0, 0), (0, 1), (1, 1)]),
        ("triangle", ~on_axis[tail] & on_axis[head], [(0, 0), (0, 1), (1, 0)]),
    ):
        ends = tail[at], head[at]
        station = here, after
        table = np.stack([station[s][:, ends[j]] for s, j in corners], axis=-1)
        if len(ends[0]):
            out.append((kind, table.reshape(-1, len(corners)), np.tile(number[at], len(here))))
    return out

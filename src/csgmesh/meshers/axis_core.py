"""The O-grid of hexahedra around the axis of a full turn, in place of wedges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.sweep import SweptDomain
from csgmesh.errors import MeshingError
from csgmesh.mesh import Mesh
from csgmesh.meshers.swept_cells import axis_first

#: Radius of the square core's corners as a share of the disk's, and how far its sides are bent from
#: straight ones to arcs: square angles inside and angles of 130 degrees outside, about alike.
_CORNER, _BEND = 0.6, 0.35

#: Cells of the rings are at most so many times as thick as they are wide.
_THICKEST = 3.0


@dataclass(frozen=True, eq=False)
class AxisCore:
    """Hexahedra around an axis, and what of the profile they stand for.

    Attributes
    ----------
    points : (n, 3) float64
        Those that the swept mesh does not have.
    hexahedra : (m, 8) int64
        Into the swept mesh's points, then these.
    region : (m,) int64
    facets : (k, 4) int64
        Looking out of the solid.
    facet_line : (k,) int64
        The line of the profile that each is of.
    column : (n_quads,) bool
        Quads of the profile that they replace.
    """

    points: np.ndarray
    hexahedra: np.ndarray
    region: np.ndarray
    facets: np.ndarray
    facet_line: np.ndarray
    column: np.ndarray


def axis_core(
    flat: Mesh, sweep: SweptDomain, at: np.ndarray, number: np.ndarray, on_axis: np.ndarray
) -> AxisCore:
    """Fill the column of quads at the axis by an O-grid.

    Each line of the profile from the axis to the next vertices sweeps a disk; all of them have the
    same quads, a square of n/4 by n/4 in rings of n, whose outermost vertices are those swept.

    Parameters
    ----------
    flat : Mesh
        Of the profile, with quads that have a side on the axis.
    sweep : SweptDomain
    at : (n + 1,) float64
        Stations, in degrees; n a multiple of four.
    number : (n, n_points) int64
        Numbers of the profile's points at each station.
    on_axis : (n_points,) bool

    Raises
    ------
    MeshingError
        If a cell touches the axis otherwise, or the stations are too uneven.
    """
    column, rows = _column(flat, sweep, on_axis)
    low, high = rows[:, [1, 2]], rows[:, [0, 3]]
    rails, which = np.unique(np.concatenate([low, high]), axis=0, return_inverse=True)
    split = np.flatnonzero(np.diff(rails[:, 0]) == 0)
    if len(split):
        raise _refused(flat, sweep, int(rails[split[0], 0]), "cells meet the axis unevenly")
    polar, quads = disk(at)
    n = len(at) - 1
    inner = len(polar) - n
    place = [_disk_points(flat, sweep, rail, polar[:inner]) for rail in rails]
    first = number.size + inner * np.arange(len(rails))
    table = np.concatenate(
        [first[:, None] + np.arange(inner), number[:, rails[:, 1]].T.astype(np.int64)], axis=1
    )
    if np.linalg.det(sweep.matrix) < 0.0:
        quads = quads[:, ::-1]
    which = which.reshape(-1)
    below, above = which[: len(rows)], which[len(rows) :]
    cells = np.concatenate([table[below][:, quads], table[above][:, quads]], axis=2)
    facets, line = _end_disks(flat, on_axis, rails, table, quads)
    return AxisCore(
        np.concatenate(place),
        cells.reshape(-1, 8),
        np.repeat(flat.cell_region["quad"][column], len(quads)),
        facets,
        line,
        column,
    )


def _column(flat: Mesh, sweep: SweptDomain, on_axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which quads have a side on the axis, and their corners: from above on the axis, around."""
    for kind, rows in flat.cells.items():
        touching = on_axis[rows].sum(axis=1)
        wrong = np.flatnonzero((touching > 0) & ((touching != 2) | (kind != "quad")))
        if len(wrong):
            row = rows[wrong[0]]
            how = "has a corner on it" if touching[wrong[0]] == 1 else "has a side on it"
            raise _refused(flat, sweep, int(row[on_axis[row]][0]), f"a {kind} {how}")
    rows = flat.cells["quad"]
    column = np.asarray(on_axis[rows].any(axis=1))
    turned = axis_first(rows[column], on_axis)
    apart = np.flatnonzero(~on_axis[turned[:, 1]])
    if len(apart):
        raise _refused(flat, sweep, int(turned[apart[0], 0]), "a quad has opposite corners on it")
    return column, turned


def _refused(flat: Mesh, sweep: SweptDomain, point: int, what: str) -> MeshingError:
    where = sweep.carried(flat.points[point : point + 1], 0.0)[0]
    place = ", ".join(f"{c:.6g}" for c in where)
    return MeshingError(
        f"an O-grid needs a column of quads with a side each on the axis; at ({place}) {what}. "
        "Structured() makes such profiles of rectangles and of what has four sides"
    )


def disk(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The O-grid of the unit disk: distances from the centre and angles (k, 2), and quads.

    Parameters
    ----------
    at : (n + 1,) float64
        Angles of the vertices on the circle, in degrees, which come last.
    """
    n = len(at) - 1
    m = n // 4
    even = 2.0 * np.pi * np.arange(n) / n
    within = np.mod(even, np.pi / 2)
    straight = _CORNER / (np.cos(within) + np.sin(within))
    radius = (1.0 - _BEND) * straight + _BEND * _CORNER
    rim = radius[:, None] * np.column_stack([np.cos(even), np.sin(even)])
    square = _between_sides(np.concatenate([rim, rim[:1]]), m)
    grid = np.arange((m + 1) ** 2).reshape(m + 1, m + 1)
    around = np.concatenate([grid[:-1, 0], grid[-1, :-1], grid[:0:-1, -1], grid[0, :0:-1]])
    thick = (1.0 - _CORNER) / (2.0 * np.pi * 0.5 * (1.0 + _CORNER) / n)
    rings = max(1, int(np.ceil(thick / _THICKEST)))
    share = np.arange(1, rings + 1)[:, None] / rings
    polar = [np.column_stack([np.hypot(*square.T), np.arctan2(square[:, 1], square[:, 0])])]
    out = radius + share * (1.0 - radius)
    turn = even + share * (np.radians(at[:n]) - even)
    polar.append(np.column_stack([out.ravel(), turn.ravel()]))
    number = np.concatenate([around[None], len(square) + np.arange(rings * n).reshape(rings, n)])
    quads = [
        np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=-1),
        np.stack(
            [number[:-1], number[1:], np.roll(number[1:], -1, 1), np.roll(number[:-1], -1, 1)],
            axis=-1,
        ),
    ]
    found = np.concatenate(polar), np.concatenate([q.reshape(-1, 4) for q in quads])
    _check_convex(*found)
    return found


def _between_sides(rim: np.ndarray, m: int) -> np.ndarray:
    """Points of a square grid by transfinite interpolation between its sides, ((m + 1)², 2)."""
    south, east = rim[: m + 1], rim[m : 2 * m + 1]
    north, west = rim[2 * m : 3 * m + 1][::-1], rim[3 * m :][::-1]
    u = (np.arange(m + 1) / m)[:, None, None]
    v = (np.arange(m + 1) / m)[None, :, None]
    ruled = (1 - v) * south[:, None] + v * north[:, None] + (1 - u) * west + u * east
    corners = (
        (1 - u) * (1 - v) * south[0] + u * (1 - v) * south[-1]
        + (1 - u) * v * north[0] + u * v * north[-1]
    )  # fmt: skip
    return np.asarray(ruled - corners).reshape(-1, 2)


def _check_convex(polar: np.ndarray, quads: np.ndarray) -> None:
    flat = polar[:, :1] * np.column_stack([np.cos(polar[:, 1]), np.sin(polar[:, 1])])
    corner = flat[quads]
    ahead = np.roll(corner, -1, axis=1) - corner
    behind = np.roll(corner, 1, axis=1) - corner
    turn = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    if turn.min() <= 0.0:
        raise MeshingError(
            "an O-grid needs layers of about the same thickness all around the axis; the size "
            "varies too much along the turn"
        )


def _disk_points(flat: Mesh, sweep: SweptDomain, rail: np.ndarray, polar: np.ndarray) -> np.ndarray:
    """The disk that a line of the profile sweeps, on its exact curve if it has one, (n, 3)."""
    ends = flat.points[rail]
    own = np.sort(flat.facets["line"], axis=1) == np.sort(rail)
    curve = flat.facet_curve["line"][own.all(axis=1)]
    profile = ends[0] + polar[:, :1] * (ends[1] - ends[0])
    if len(curve) and curve[0] >= 0 and flat.curves is not None:
        both = np.repeat(curve[:1], 2)
        first, last = flat.curves.project(both, ends, *flat.curves.interval[both].T)
        t = first + polar[:, 0] * (last - first)
        profile = flat.curves.points(np.repeat(curve[:1], len(t)), t)
    r, z = profile.T
    local = np.column_stack([r * np.cos(polar[:, 1]), r * np.sin(polar[:, 1]), z])
    return np.asarray(local @ sweep.matrix.T + sweep.offset)


def _end_disks(
    flat: Mesh, on_axis: np.ndarray, rails: np.ndarray, table: np.ndarray, quads: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Facets where the column ends at the boundary, and the line of the profile of each."""
    lines = flat.facets["line"]
    ends = flat.facet_region["line"][:, 1] < 0
    ends &= on_axis[lines].sum(axis=1) == 1
    facets, source = [np.empty((0, 4), np.int64)], []
    for k in np.flatnonzero(ends).tolist():
        tail_on_axis = bool(on_axis[lines[k, 0]])
        axis = lines[k, 0] if tail_on_axis else lines[k, 1]
        own = table[int(np.searchsorted(rails[:, 0], axis))]
        # A line that leaves the axis has the solid above it.
        facets.append(own[quads[:, ::-1] if tail_on_axis else quads])
        source.append(k)
    return np.concatenate(facets), np.repeat(np.array(source, np.int64), len(quads))

"""Which surfaces of different leaves coincide, whatever leaves they come from.

A flat surface is known by its plane. Cylinders, cones, spheres and their affine images are quadrics
and known by their equations, however they are placed, turned and cut off. All others are the same
if their tables are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.curves import ARC, LINE, Curves
from csgmesh.domain.surfaces import EXTRUDED, PLANE, REVOLVED, Surfaces
from csgmesh.graphs import components
from csgmesh.spatial import near_pairs

#: Curved surfaces are the same if their equations or tables agree to so many digits: they come from
#: the same arguments by the same arithmetic, or from a map that is exact but for rounding.
_DIGITS = 9

#: An arc's centre this near the axis, or its axes this near to the coordinate axes, as a share of
#: the arc's size, make it turn into a quadric.
_STRAIGHT = 1e-12


@dataclass(frozen=True, eq=False)
class Coincidence:
    """Classes of coincident surfaces.

    Attributes
    ----------
    of : (n,) int64
        Class of each surface: the number of its lowest member.
    surfaces : Surfaces
        A row a surface; that of a class's lowest member reaches as far as any member does.
    """

    of: np.ndarray
    surfaces: Surfaces

    def shared(self, leaf: np.ndarray) -> np.ndarray:
        """Which surfaces are in a class with surfaces of other leaves, (n,) bool."""
        low = np.full(len(self.of), len(leaf))
        high = np.full(len(self.of), -1)
        np.minimum.at(low, self.of, leaf)
        np.maximum.at(high, self.of, leaf)
        return (low < high)[self.of]


def coincidence(surfaces: Surfaces, snap: float) -> Coincidence:
    """Find which surfaces coincide.

    Parameters
    ----------
    surfaces : Surfaces
        In local coordinates of order one.
    snap : float
        Distance below which planes are one.
    """
    n = len(surfaces)
    pairs = [_same_planes(surfaces, snap)]
    form, is_quadric = _quadrics(surfaces)
    rows = np.flatnonzero(is_quadric)
    pairs.append(rows[near_pairs(form[rows], 10.0**-_DIGITS)].reshape(-1, 2))
    pairs.append(_same_tables(surfaces, ~is_quadric & (surfaces.kind != PLANE)))
    a, b = np.concatenate(pairs).T
    _, label = components(n, a, b)
    _, first = np.unique(label, return_index=True)
    of = first[label]
    return Coincidence(of, _covering_classes(surfaces, of, is_quadric))


def _same_planes(surfaces: Surfaces, snap: float) -> np.ndarray:
    planes = np.flatnonzero(surfaces.kind == PLANE)
    normal = surfaces.plane_normals[planes]
    height = (normal * surfaces.offset[planes]).sum(axis=1)
    lead = np.argmax(np.abs(normal) > 0.5, axis=1)
    sign = np.sign(normal[np.arange(len(planes)), lead])
    key = np.column_stack([normal, height]) * sign[:, None]
    return planes[near_pairs(key, max(2.0 * snap, 1e-12))].reshape(-1, 2)


def _same_tables(surfaces: Surfaces, which: np.ndarray) -> np.ndarray:
    rows = np.flatnonzero(which)
    table: dict[tuple, int] = {}
    pairs = []
    for k in rows.tolist():
        parts = (surfaces.matrix[k], surfaces.offset[k], surfaces.profile.data[k])
        rounded = tuple(tuple((np.round(p, _DIGITS) + 0.0).ravel().tolist()) for p in parts)
        key = (int(surfaces.kind[k]), int(surfaces.profile.kind[k]), *rounded)
        pairs.append((table.setdefault(key, k), k))
    return np.array(pairs, np.int64).reshape(-1, 2)


def _quadrics(surfaces: Surfaces) -> tuple[np.ndarray, np.ndarray]:
    """The equations of quadrics (n, 13), normalised, with the sheet of cones; and which are some.

    An equation is the upper triangle of a symmetric 4 by 4 matrix.
    """
    n = len(surfaces)
    canonical = np.zeros((n, 4, 4))
    sheet = np.zeros((n, 3))
    known = np.zeros(n, bool)
    data = surfaces.profile.data
    line = (surfaces.kind == REVOLVED) & (surfaces.profile.kind == LINE)
    line &= data[:, 1] != data[:, 3]
    rows = np.flatnonzero(line)
    slope = (data[rows, 2] - data[rows, 0]) / (data[rows, 3] - data[rows, 1])
    radius = data[rows, 0] - slope * data[rows, 1]
    canonical[rows] = _squares(rows, {0: (1, 0, 0, 0), 1: (0, 1, 0, 0)}, (0, 0, slope, radius))
    axis = surfaces.matrix[rows, :, 2]
    sheet[rows] = np.sign(slope)[:, None] * axis / np.sqrt((axis**2).sum(axis=1))[:, None]
    known[rows] = True
    arcs = np.flatnonzero((surfaces.profile.kind == ARC) & (surfaces.kind != PLANE))
    inverse = np.linalg.inv(np.swapaxes(data[arcs, 2:6].reshape(-1, 2, 2), 1, 2))
    shift = -np.einsum("kij,kj->ki", inverse, data[arcs, :2])
    x, y = ((inverse[:, k, 0], inverse[:, k, 1], shift[:, k]) for k in (0, 1))
    flat = surfaces.kind[arcs] == EXTRUDED
    at = arcs[flat]
    terms = {k: (t[0][flat], t[1][flat], 0, t[2][flat]) for k, t in enumerate((x, y))}
    canonical[at] = _squares(at, terms, (0, 0, 0, 1))
    known[at] = True
    # Arcs about a point of the axis, upright: (r / a)² + ((z - c) / b)² = 1.
    metric = np.einsum("kji,kjl->kil", inverse, inverse)
    size = np.sqrt((data[arcs, 2:6] ** 2).sum(axis=1))
    upright = np.abs(metric[:, 0, 1]) <= _STRAIGHT * (metric[:, 0, 0] + metric[:, 1, 1])
    upright &= np.abs(data[arcs, 0]) <= _STRAIGHT * size
    round_ = ~flat & upright
    at = arcs[round_]
    a, b = np.sqrt(metric[round_, 0, 0]), np.sqrt(metric[round_, 1, 1])
    terms = {0: (a, 0, 0, 0), 1: (0, a, 0, 0), 2: (0, 0, b, -b * data[at, 1])}
    canonical[at] = _squares(at, terms, (0, 0, 0, 1))
    known[at] = True
    back = np.tile(np.eye(4), (n, 1, 1))
    back[:, :3, :3] = surfaces.inverse
    back[:, :3, 3] = -np.einsum("nij,nj->ni", surfaces.inverse, surfaces.offset)
    form = np.einsum("nji,njk,nkl->nil", back, canonical, back)
    scale = np.sqrt((form[:, :3, :3] ** 2).sum(axis=(1, 2)))
    form /= np.where(scale > 0.0, scale, 1.0)[:, None, None]
    upper = np.triu_indices(4)
    return np.column_stack([form[:, upper[0], upper[1]], sheet]), known


def _squares(rows: np.ndarray, plus: dict, minus: tuple) -> np.ndarray:
    """Matrices of sums of squares of linear forms, less the square of another, (k, 4, 4)."""
    out = np.zeros((len(rows), 4, 4))
    for sign, terms in [*((1.0, t) for t in plus.values()), (-1.0, minus)]:
        linear = np.stack([np.broadcast_to(np.asarray(t, float), len(rows)) for t in terms], axis=1)
        out += sign * linear[:, :, None] * linear[:, None, :]
    return out


def _covering_classes(surfaces: Surfaces, of: np.ndarray, is_quadric: np.ndarray) -> Surfaces:
    """Surfaces, those that stand for a class of quadrics as long as all of it."""
    count = np.bincount(of, minlength=len(of))
    crowded = np.flatnonzero(is_quadric & (count > 1) & (of == np.arange(len(of))))
    if not len(crowded):
        return surfaces
    source = np.arange(len(of))
    interval = surfaces.profile.interval.copy()
    for lowest in crowded.tolist():
        members = np.flatnonzero(of == lowest)
        # An extruded surface has no end, whatever the others are.
        long = members[surfaces.kind[members] == EXTRUDED]
        source[lowest] = chosen = int(long[0]) if len(long) else lowest
        interval[lowest] = _whole_interval(surfaces, chosen, members)
    out = surfaces[source]
    profile = Curves(out.profile.kind, out.profile.data, interval)
    return Surfaces(out.kind, out.matrix, out.offset, profile)


def _whole_interval(
    surfaces: Surfaces, chosen: int, members: np.ndarray
) -> tuple[float, float] | np.ndarray:
    """Parameters of the profile of `chosen` that cover all members."""
    profile = surfaces.profile
    start, end = profile.interval[chosen].tolist()
    way = 1.0 if end >= start else -1.0
    data = profile.data[chosen]
    if profile.kind[chosen] == ARC:
        if surfaces.kind[chosen] == EXTRUDED:
            return start, start + way * 2.0 * np.pi
        # Half of it lies on the right side of the axis.
        middle = float(np.arctan2(data[4], data[2]))
        middle += 2.0 * np.pi * np.round((0.5 * (start + end) - middle) / (2.0 * np.pi))
        return middle - way * 0.5 * np.pi, middle + way * 0.5 * np.pi
    flat = np.concatenate([profile[members].starts(), profile[members].ends()])
    rim = np.column_stack([flat[:, 0], np.zeros(len(flat)), flat[:, 1]])
    own = np.tile(members, 2)
    place = np.einsum("kij,kj->ki", surfaces.matrix[own], rim) + surfaces.offset[own]
    q = (place - surfaces.offset[chosen]) @ surfaces.inverse[chosen].T
    along = (q[:, 2] - data[1]) / (data[3] - data[1])
    low, high = float(along.min()), float(along.max())
    return (low, high) if way > 0.0 else (high, low)

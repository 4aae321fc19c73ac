"""A domain taken apart into what can be meshed side by side."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from csgmesh import kernels
from csgmesh.domain.pslg import Pslg
from csgmesh.meshers.constrained_delaunay import triangulated
from csgmesh.meshers.sizing import OVER_BUDGET, POINTS_PER_AREA
from csgmesh.meshers.workspace import Progress
from csgmesh.size.field import UniformSize
from csgmesh.size.resolve import ResolvedSize, evaluate

#: A domain of which fewer points are expected is meshed as a whole: threads would not pay.
WORTHWHILE = 40_000
#: Without a size, what to expect is known of the domain's own segments only.
SEGMENTS = 5_000
#: A domain is taken apart into at most so many parts, whatever the number of threads: the mesh
#: must not depend on it. Thousands of small components are better off together.
PARTS = 16


@dataclass(frozen=True, eq=False)
class Part:
    """Some components of a domain.

    Attributes
    ----------
    domain : Pslg
        The components as a domain of their own, with all the names of the whole.
    point : (n,) int64
        The whole domain's number of each of its points.
    """

    domain: Pslg
    point: np.ndarray


def parts_of(
    domain: Pslg, size: ResolvedSize | None, max_points: int, progress: Progress | None = None
) -> list[Part]:
    """Parts that do not touch, in the order of their first points; one if it is not worthwhile.

    Components that touch at a vertex stay together, and so do small ones, and all of a domain with
    periodic sides, which may belong to different components.

    Parameters
    ----------
    domain : Pslg
    size : ResolvedSize or None
        How fine the mesh will be.
    max_points : int
        The budget: what asks for far more in one place is refused as a whole.
    progress : callable, optional
        Told of the triangulation that finds the components.
    """
    if domain.periodic or not is_worthwhile(domain, size, max_points) or count_outer(domain) < 2:
        return [Part(domain, np.arange(len(domain.points)))]
    component = components(domain, progress)
    begin = component[domain.segments[:, 0]]
    n = int(component.max()) + 1
    weight = _weights(domain, begin, n)
    # Equal shares along the list of components; one that fills several shares has them alone.
    middle = np.cumsum(weight) - 0.5 * weight
    share = np.minimum((PARTS * middle / weight.sum()).astype(np.int64), PARTS - 1)
    number = np.append(np.unique(share, return_inverse=True)[1], -1)
    part_of_point = number[component]
    return [_part(domain, part_of_point, k) for k in range(int(number.max()) + 1)]


def is_worthwhile(domain: Pslg, size: ResolvedSize | None, max_points: int) -> bool:
    """Whether a domain gets enough points for threads to pay, as far as can be told at once."""
    if size is not None and size.uniform is not None:
        expected = _expected(domain, size.uniform)
        return WORTHWHILE <= expected <= OVER_BUDGET * max_points
    if len(domain.segments) >= SEGMENTS:
        return True
    if size is None:
        return False
    sources = [size.default, *(source for _, source in (*size.boundary, *size.region))]
    smallest = [source.value for source in sources if isinstance(source, UniformSize)]
    if size.default is not None and not isinstance(size.default, UniformSize):
        smallest.append(float(evaluate(size.default, domain.points).min()))
    if len(smallest) < sum(source is not None for source in sources):
        return True
    return _expected(domain, min(smallest)) >= WORTHWHILE


def _expected(domain: Pslg, size: float) -> float:
    return float(domain.chord_areas().sum()) * POINTS_PER_AREA / size**2


def count_outer(domain: Pslg) -> int:
    """Number of groups of connected segments that nothing of the domain surrounds."""
    n = len(domain.points)
    nothing = np.full((2, n), -1, np.int32)
    return int(
        kernels.count_outer(
            np.array(domain.points).reshape(-1),
            np.array(domain.segments).reshape(-1),
            np.array(domain.segment_region).reshape(-1),
            np.arange(n, dtype=np.int32),
            nothing[0],
            nothing[1],
        )
    )


def components(domain: Pslg, progress: Progress | None = None) -> np.ndarray:
    """Component of each point, numbered by first points; -1 of points outside, (n,) int64.

    The triangles inside tell, so that an island in a hole, which nothing but its place separates
    from what is around it, is found as surely as any other component.
    """
    work = triangulated(domain, np.ones(len(domain.segments), np.int64), progress)
    parent = np.arange(work.n_points, dtype=np.int32)
    kernels.join_triangles(work.origin, work.twin, work.n_triangles, parent)
    n = len(domain.points)
    group = parent.take(work.rank[:n]).astype(np.int64)
    is_inside = np.zeros(work.n_points, np.bool_)
    kept = (domain.segment_region >= 0).any(axis=1)
    is_inside[group[domain.segments[kept]]] = True
    inside = np.flatnonzero(is_inside[group])
    least, first = np.unique(group[inside], return_index=True)
    number = np.full(work.n_points, -1, np.int64)
    number[least[np.argsort(first)]] = np.arange(len(least))
    return number[group]


def _weights(domain: Pslg, begin: np.ndarray, n: int) -> np.ndarray:
    """Shares of the n components in the work: of the area and, as much again, of the segments."""
    kept = np.flatnonzero(begin >= 0)
    ends = domain.points[domain.segments[kept]] - domain.points[domain.segments[kept[0], 0]]
    turn = ends[:, 0, 0] * ends[:, 1, 1] - ends[:, 0, 1] * ends[:, 1, 0]
    inside = (domain.segment_region[kept] >= 0).astype(np.int64)
    area = np.bincount(begin[kept], turn * (inside[:, 0] - inside[:, 1]), n)
    segments = np.bincount(begin[kept], minlength=n)
    share: np.ndarray = area / area.sum() + segments / segments.sum()
    return share


def _part(domain: Pslg, part_of_point: np.ndarray, k: int) -> Part:
    point = np.flatnonzero(part_of_point == k)
    number = np.full(len(domain.points), -1, np.int64)
    number[point] = np.arange(len(point))
    mine = np.flatnonzero((part_of_point[domain.segments] == k).all(axis=1))
    values = {field.name: getattr(domain, field.name) for field in fields(domain)}
    for name, value in values.items():
        if name.startswith("segment_"):
            values[name] = value[mine]
    values["segments"] = number[domain.segments[mine]]
    values["points"] = domain.points[point]
    values["point_marker"] = domain.point_marker[point]
    return Part(Pslg.build(**values), point)

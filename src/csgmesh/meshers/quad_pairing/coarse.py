"""The triangulation that is paired: twice the wanted size, right-angled inside."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from csgmesh.domain.input_angles import sharp_corners
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import BudgetError
from csgmesh.mesh import Mesh
from csgmesh.meshers.assembly import assemble
from csgmesh.meshers.meshing import Meshing
from csgmesh.meshers.quad_pairing.squares import with_squares
from csgmesh.meshers.workspace import Progress
from csgmesh.size import ResolvedSize, UniformSize
from csgmesh.tolerance import ON_CURVE_SHARE, accuracy

Source = Callable[[np.ndarray], np.ndarray]


def coarse_triangles(
    domain: Pslg,
    size: ResolvedSize | None,
    limits: tuple[float, float, int],
    progress: Progress | None,
) -> Mesh:
    """Triangles of twice the wanted size."""
    run = Meshing(domain, sharp_corners(domain), limits, progress, with_squares)
    # Without a size the features' own, growing by the gradation: triangles graded by nothing but
    # their angles pair badly.
    wanted = ResolvedSize(UniformSize(domain.diagonal)) if size is None else _doubled(size)
    finished = run.run(wanted)
    run.refiner.publish()
    mesh = assemble(run.work, {})
    if not finished:
        raise BudgetError(
            f"a quarter of max_points, {limits[2]}, is used up by the triangles that are to be "
            "paired",
            mesh,
        )
    return mesh


def _doubled(size: ResolvedSize) -> ResolvedSize:
    """Twice the size everywhere."""

    def twice(source: Source) -> Source:
        if isinstance(source, UniformSize):
            return UniformSize(2 * source.value)
        return lambda points: 2 * np.asarray(source(points))

    return ResolvedSize(
        None if size.default is None else twice(size.default),
        tuple((markers, twice(source)) for markers, source in size.boundary),
        tuple((regions, twice(source)) for regions, source in size.region),
    )


def joined_chords(domain: Pslg) -> Pslg:
    """The domain with chords of bent curves joined two by two, where a curve has three or more."""
    bent = domain.segment_curve >= 0
    bent[bent] = domain.curves.kind[domain.segment_curve[bent]] > 0
    start, end = domain.segments.T
    degree = np.bincount(domain.segments.ravel(), minlength=domain.n_points)
    leaving = np.full(domain.n_points, -1)
    leaving[start[bent]] = np.flatnonzero(bent)
    after = np.where(bent & (degree[end] == 2), leaving[end], -1)
    at = np.flatnonzero(after >= 0)
    next_ = after[at]
    same = (domain.segment_curve[at] == domain.segment_curve[next_]) & (
        domain.segment_marker[at] == domain.segment_marker[next_]
    )
    same &= (domain.segment_region[at] == domain.segment_region[next_]).all(axis=1)
    same &= domain.segment_interval[at, 1] == domain.segment_interval[next_, 0]
    same &= (domain.point_marker[end[at]] < 0) & (at != next_)
    # A vertex that merging moved off its curve is known to be allowed to only as a vertex.
    away = _distances(domain)
    reach = accuracy(ON_CURVE_SHARE, domain.diagonal, domain.points)
    same &= (away[at] <= reach) & (away[next_] <= reach)
    after[:] = -1
    after[at[same]] = next_[same]
    first = _every_other(after)
    if not len(first):
        return domain
    second = after[first]
    kept = np.ones(domain.n_segments, bool)
    kept[second] = False
    segments, interval = domain.segments.copy(), domain.segment_interval.copy()
    segments[first, 1], interval[first, 1] = segments[second, 1], interval[second, 1]
    is_used = np.ones(domain.n_points, bool)
    is_used[domain.segments[second, 0]] = False
    number = np.cumsum(is_used) - 1
    values = {name: getattr(domain, name) for name in domain.__dataclass_fields__}
    return Pslg.build(
        **values
        | {
            "points": domain.points[is_used],
            "point_marker": domain.point_marker[is_used],
            "segments": number[segments[kept]],
            "segment_curve": domain.segment_curve[kept],
            "segment_interval": interval[kept],
            "segment_marker": domain.segment_marker[kept],
            "segment_region": domain.segment_region[kept],
        }
    )


def _distances(domain: Pslg) -> np.ndarray:
    """How far the ends of each segment are from its curve at their parameters, (m,)."""
    out = np.zeros(domain.n_segments)
    bent = np.flatnonzero(domain.segment_curve >= 0)
    for k in (0, 1) if len(bent) else ():
        exact = domain.curves.points(domain.segment_curve[bent], domain.segment_interval[bent, k])
        away = exact - domain.points[domain.segments[bent, k]]
        out[bent] = np.maximum(out[bent], np.hypot(away[:, 0], away[:, 1]))
    return out


def halved_near(domain: Pslg, mesh: Mesh, cells: np.ndarray) -> Pslg:
    """The domain with those curved segments halved on which cells of a mesh of quads lie."""
    near = np.zeros(mesh.n_points, bool)
    near[mesh.cells["quad"][cells]] = True
    near[mesh.cells["quad"][near[mesh.cells["quad"]].any(axis=1)]] = True
    facet = np.flatnonzero(near[mesh.facets["line"]].any(axis=1))
    curve = mesh.facet_curve["line"][facet]
    middle = mesh.facet_interval["line"][facet].mean(axis=1)
    lo, hi = np.sort(domain.segment_interval, axis=1).T
    cut = np.zeros(domain.n_segments, bool)
    for c, t in zip(curve.tolist(), middle.tolist(), strict=True):
        if c >= 0 and domain.curves.kind[c] > 0:
            cut |= (domain.segment_curve == c) & (lo <= t) & (t <= hi)
    at = np.flatnonzero(cut)
    if not len(at):
        return domain
    t = domain.segment_interval[at].mean(axis=1)
    new = domain.n_points + np.arange(len(at))
    segments, interval = domain.segments.copy(), domain.segment_interval.copy()
    rest = np.stack([new, segments[at, 1]], axis=1)
    rest_interval = np.stack([t, interval[at, 1]], axis=1)
    segments[at, 1], interval[at, 1] = new, t
    values = {name: getattr(domain, name) for name in domain.__dataclass_fields__}
    for name in ("segment_curve", "segment_marker", "segment_region"):
        values[name] = np.concatenate([values[name], values[name][at]])
    return Pslg.build(
        **values
        | {
            "points": np.concatenate(
                [domain.points, domain.curves.points(domain.segment_curve[at], t)]
            ),
            "point_marker": np.concatenate([domain.point_marker, np.full(len(at), -1)]),
            "segments": np.concatenate([segments, rest]),
            "segment_interval": np.concatenate([interval, rest_interval]),
        }
    )


def _every_other(after: np.ndarray) -> np.ndarray:
    """Segments to be joined with the one after them: every other one of each chain of three."""
    follow = after.tolist()
    has_before = np.zeros(len(after), bool)
    has_before[after[after >= 0]] = True
    seen = np.zeros(len(after), bool)
    first = []
    # Chains from their starts; what closes on itself has none, and begins anywhere.
    for k in [*np.flatnonzero((after >= 0) & ~has_before), *np.flatnonzero(after >= 0)]:
        chain = []
        while k >= 0 and not seen[k]:
            seen[k] = True
            chain.append(int(k))
            k = follow[k]
        if len(chain) > 2:
            first += chain[: len(chain) - 1 : 2]
    return np.array(first, np.int64)

"""The certificate of a mesh of a solid's surface: closed, in place, named, of the right extent."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.windings import winding_numbers
from csgmesh.measures.results import Certificate, Check, offenders
from csgmesh.measures.rules.arrays import check_indices, check_points
from csgmesh.measures.space.case import SpaceCase
from csgmesh.measures.space.certificate import N_SAMPLES, SEED, check_names, compare_volumes
from csgmesh.measures.space.sags import area_bounds, facet_sags, rim_bounds, triangle_areas
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.faces import canonical_faces
from csgmesh.mesh.surfaces import with_facets
from csgmesh.tolerance import AREA_SHARE


def check_surface(
    mesh: Mesh,
    reference: Plc | None = None,
    contains: Callable[[np.ndarray], np.ndarray] | None = None,
) -> Certificate:
    """Check a mesh of a surface in space against the solid it bounds; see `csgmesh.check`."""
    mesh = with_facets(mesh)
    case = SpaceCase(mesh, mesh.domain if reference is None else reference, contains)  # type: ignore[arg-type]
    return Certificate.of(_RULES, case)


def check_areas(case: SpaceCase) -> Check:
    """No facet is degenerate."""
    flat = np.unique(case.triangles[~(triangle_areas(case) > 0.0), 3])
    failures = offenders("areas", "facet", flat, case.facet_places(flat), "has|have no area")
    return Check.of("areas", len(case.facets[0]), failures)


def check_cells(case: SpaceCase) -> Check:
    """The cells are the facets, each once, out of one of the regions beside."""
    rule, mesh = "facets", case.mesh
    tables = [canonical_faces(rows[:, : KINDS[k].n_corners])[0] for k, rows in mesh.cells.items()]
    cells, facets = np.concatenate([np.zeros((0, 4), np.int64), *tables]), case.facets[0]
    _, key = np.unique(np.concatenate([cells, facets]), axis=0, return_inverse=True)
    key = key.reshape(-1)
    own, theirs = key[: len(cells)], key[len(cells) :]
    n = int(key.max(initial=-1)) + 1
    twice = np.flatnonzero(np.bincount(own, minlength=n)[own] > 1)
    failures = offenders(rule, "cell", twice, case.centres[twice], "is|are there more than once")
    stray = np.flatnonzero(np.bincount(own, minlength=n)[theirs] == 0)
    failures += offenders(rule, "facet", stray, case.facet_places(stray), "is|are no cell")
    facet_of = np.full(n, -1)
    facet_of[theirs] = np.arange(len(facets))
    at = facet_of[own]
    bare = np.flatnonzero(at < 0)
    failures += offenders(rule, "cell", bare, case.centres[bare], "is|are no facet")
    beside = (case.facet_region[at] == case.cell_region[:-1, None]).any(axis=1)
    wrong = np.flatnonzero((at >= 0) & ~beside)
    complaint = "has|have a region that is not beside"
    failures += offenders(rule, "cell", wrong, case.centres[wrong], complaint)
    same = np.flatnonzero(case.facet_region[:, 0] == case.facet_region[:, 1])
    complaint = "has|have the same region on both sides"
    failures += offenders(rule, "facet", same, case.facet_places(same), complaint)
    return Check.of(rule, len(cells), failures)


def check_closed(case: SpaceCase) -> Check:
    """The facets around each region are a closed surface, oriented alike at every edge."""
    rule, points, failures = "closed", case.mesh.points, []
    n, total = len(points), 0
    for number, name in enumerate(case.mesh.region_names):
        rows = around(case, number)
        ends = rows[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        low, high = ends.min(axis=1), ends.max(axis=1)
        keys, edge = np.unique(low * n + high, return_inverse=True)
        balance = np.bincount(edge.reshape(-1), np.sign(ends[:, 1] - ends[:, 0]), len(keys))
        bad = np.flatnonzero(balance)
        places = 0.5 * (points[keys[bad] // n] + points[keys[bad] % n])
        complaint = f"of the surface of {name!r} is|of the surface of {name!r} are open or folded"
        failures += offenders(rule, "edge", bad, places, complaint)
        total += len(keys)
    return Check.of(rule, total, failures)


def around(case: SpaceCase, region: int) -> np.ndarray:
    """The triangles around a region, counterclockwise seen from outside it, (k, 3)."""
    sides = case.facet_region[case.triangles[:, 3]]
    rows = case.triangles[:, :3]
    return np.concatenate([rows[sides[:, 0] == region], rows[sides[:, 1] == region][:, ::-1]])


def check_area(case: SpaceCase) -> Check:
    """The facets of each name have the domain's area, to the bound on chords."""
    rule, areas = "area", triangle_areas(case)
    if case.domain is None:
        return Check.skipped(rule, f"no domain to compare with; the area is {areas.sum():.12g}")
    domain = case.domain
    other = SpaceCase(_facets_alone(domain), domain, None)
    slacks = [area_bounds(c) + rim_bounds(c) for c in (case, other)]
    bad, found = [], []
    for name in domain.names:
        own = _named(case, name)
        theirs = _named(other, name)
        given, exact = areas[own].sum(), triangle_areas(other)[theirs].sum()
        slack = slacks[0][own].sum() + slacks[1][theirs].sum() + AREA_SHARE * domain.diagonal**2
        if not abs(given - exact) <= slack:
            bad.append(name)
            found.append(f"{name} has {given:.10g}, not {exact:.10g}")
    failures = offenders(
        rule,
        "name",
        np.arange(len(bad)),
        np.zeros((len(bad), 0)),
        "has|have another area than in the domain",
        found[0] if found else "",
    )
    note = f"{areas.sum():.12g}, the domain's facets have {domain.facet_areas().sum():.12g}"
    return Check.of(rule, len(areas), failures, note)


def _facets_alone(domain: Plc) -> Mesh:
    return Mesh(
        domain.points,
        {},
        region_names=domain.region_names,
        facets={"triangle": domain.facets},
        facet_marker={"triangle": domain.facet_marker},
        boundary_names=domain.boundary_names,
        facet_region={"triangle": domain.facet_region},
    )


def _named(case: SpaceCase, name: str) -> np.ndarray:
    """Which triangles have a name, (t,) bool."""
    names = case.mesh.boundary_names
    markers = [m for m, entry in enumerate(names) if name in entry]
    return np.isin(case.facet_marker[case.triangles[:, 3]], markers)


def check_volume(case: SpaceCase) -> Check:
    """The surface of each region encloses the domain's volume, to the bound on chords."""
    return compare_volumes(case, enclosed_volumes(case))


def enclosed_volumes(case: SpaceCase) -> np.ndarray:
    """Volume inside the facets around each region, (n_regions,)."""
    points = case.mesh.points
    centre = points.mean(axis=0) if len(points) else np.zeros(3)
    out = np.zeros(len(case.mesh.region_names))
    for number in range(len(out)):
        a, b, c = (points[rows] - centre for rows in around(case, number).T)
        out[number] = (a * np.cross(b, c)).sum() / 6.0
    return out


def check_samples(case: SpaceCase) -> Check:
    """Random points lie inside the surface of a region if they lie in it, boundaries apart."""
    rule = "samples"
    if case.contains is None or case.domain is None:
        return Check.skipped(rule, "no shape to compare with")
    domain = case.domain
    low, high = domain.bounds()
    points = low + (high - low) * np.random.default_rng(SEED).random((N_SAMPLES, 3))
    region = np.asarray(case.contains(points))
    wrong = np.zeros(N_SAMPLES, bool)
    number = {name: k for k, name in enumerate(domain.region_names)}
    for own, name in enumerate(case.mesh.region_names):
        inside = winding_numbers(points, case.mesh.points, around(case, own)) == 1
        wrong |= inside != (region == number.get(name, -2))
    differ = np.flatnonzero(wrong)
    near = 2.0 * (float(facet_sags(case).max(initial=0.0)) + domain.deviation)
    off = np.full(len(differ), np.inf)
    for s in range(len(domain.surfaces)):
        np.minimum(off, domain.surfaces.distance(np.full(len(differ), s), points[differ]), out=off)
    bad = differ[off > near]
    complaint = "lies|lie elsewhere in the mesh than in the shape"
    failures = offenders(rule, "sample", bad, points[bad], complaint)
    note = f"{len(differ) - len(bad)} within the deviation of a boundary"
    return Check.of(rule, N_SAMPLES, failures, note)


_RULES: tuple[tuple[str, Callable[[SpaceCase], Check]], ...] = (
    ("indices", check_indices),
    ("points", check_points),
    ("areas", check_areas),
    ("facets", check_cells),
    ("closed", check_closed),
    ("names", check_names),
    ("area", check_area),
    ("volume", check_volume),
    ("samples", check_samples),
)

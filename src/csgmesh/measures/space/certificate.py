"""The certificate of a mesh of space."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surfaces import PLANE
from csgmesh.domain.windings import winding_numbers
from csgmesh.measures.results import Certificate, Check, offenders
from csgmesh.measures.rules.arrays import check_indices, check_points
from csgmesh.measures.space.case import SpaceCase
from csgmesh.measures.space.curved import tetra_bounds
from csgmesh.measures.space.delaunay import are_oriented, check_delaunay
from csgmesh.measures.space.jacobians import least_jacobians
from csgmesh.measures.space.placement import misplaced_facets
from csgmesh.measures.space.sags import facet_sags, triangle_areas
from csgmesh.mesh import KINDS, Mesh
from csgmesh.tolerance import AREA_SHARE, coordinate_ulp

#: Points tried against the tree.
N_SAMPLES = 100_000
SEED = 20260117

_NONE = np.zeros(0, np.int64)


def check_space(
    mesh: Mesh,
    reference: Plc | None = None,
    contains: Callable[[np.ndarray], np.ndarray] | None = None,
) -> Certificate:
    """Check a mesh of space against the domain it must mesh; see `csgmesh.check`."""
    case = SpaceCase(mesh, mesh.domain if reference is None else reference, contains)  # type: ignore[arg-type]
    return Certificate.of(_RULES, case)


def check_orientation(case: SpaceCase) -> Check:
    """The Jacobian is positive all over each cell; of straight tetrahedra by an exact predicate."""
    rule, bad, before = "orientation", [_NONE], 0
    for kind, rows in case.corners.items():
        if kind == "tetra":
            bad.append(np.flatnonzero(~are_oriented(case.mesh.points, rows)) + before)
            before += len(rows)
            continue
        least = least_jacobians(case.mesh.points, KINDS[kind].straight, rows)
        if kind == "tetra10":
            nodes = case.mesh.points[case.mesh.cells[kind]]
            least = np.minimum(least, tetra_bounds(nodes).least)
        bad.append(np.flatnonzero(~(least > 0.0)) + before)
        before += len(rows)
    numbers = np.concatenate(bad)
    complaint = "is|are not positively oriented all over"
    failures = offenders(rule, "cell", numbers, case.centres[numbers], complaint)
    return Check.of(rule, before, failures)


def check_conforming(case: SpaceCase) -> Check:
    """Each face has one cell, or two on different sides."""
    rule, faces = "conforming", case.faces
    crowded = np.flatnonzero(faces.count > 2)
    failures = offenders(
        rule, "face", crowded, case.face_places(crowded), "has|have more than two cells"
    )
    folded = np.flatnonzero((faces.count == 2) & (faces.n_behind != 1))
    failures += offenders(
        rule, "face", folded, case.face_places(folded), "has|have two cells on the same side"
    )
    return Check.of(rule, len(faces.points), failures)


def check_facets(case: SpaceCase) -> Check:
    """The facets are the faces between different regions, with the right regions beside them."""
    rule, faces = "facets", case.faces
    at = case.facet_face
    stray = np.flatnonzero(at < 0)
    failures = offenders(rule, "facet", stray, case.facet_places(stray), "is|are no face of a cell")
    times = np.bincount(at[at >= 0], minlength=len(faces.points))
    twice = np.flatnonzero(times > 1)
    failures += offenders(
        rule, "face", twice, case.face_places(twice), "is|are listed as a facet more than once"
    )
    behind, ahead = case.cell_region[faces.behind], case.cell_region[faces.ahead]
    missing = np.flatnonzero((behind != ahead) & (times == 0))
    failures += offenders(
        rule, "face", missing, case.face_places(missing), "bounds|bound a region without a facet"
    )
    known = np.flatnonzero(at >= 0)
    way = case.facets[1][known]
    sides = np.column_stack([behind[at[known]], ahead[at[known]]])
    sides[~way] = sides[~way, ::-1]
    wrong = known[(sides != case.facet_region[known]).any(axis=1)]
    failures += offenders(
        rule,
        "facet",
        wrong,
        case.facet_places(wrong),
        "has|have other regions than the cells beside",
    )
    return Check.of(rule, len(at), failures)


def check_names(case: SpaceCase) -> Check:
    """Each facet's corners lie on an exact surface of the domain that carries all its names."""
    rule = "names"
    if case.domain is None:
        return Check.skipped(rule, "no domain to compare with")
    domain, mesh = case.domain, case.mesh
    rows = case.facets[0]
    numbers = np.flatnonzero(~(case.corners_off <= case.tolerance))
    failures = offenders(
        rule,
        "facet",
        numbers,
        case.facet_places(numbers),
        "does|do not lie on the exact surfaces of its names",
    )
    beside = misplaced_facets(case)
    complaint = "lies|lie beside the part of the boundary that it names"
    failures += offenders(rule, "facet", beside, case.facet_places(beside), complaint)
    missing = [n for n in domain.names if n not in mesh.names]
    if missing:
        failures += offenders(
            rule,
            "name",
            np.arange(len(missing)),
            np.zeros((len(missing), 0)),
            "of the domain is|of the domain are missing from the mesh",
            ", ".join(missing),
        )
    return Check.of(rule, len(rows), failures)


def check_edge_nodes(case: SpaceCase) -> Check:
    """Edges of curved cells have one node each; those of facets lie on the exact surfaces."""
    rule, mesh = "edge nodes", case.mesh
    blocks = [(k, rows) for k, rows in (*mesh.cells.items(), *mesh.facets.items())]
    blocks = [(kind, rows) for kind, rows in blocks if KINDS[kind].order > 1]
    if not blocks:
        return Check.skipped(rule, "the cells are straight")
    ends, nodes = [], []
    for kind, rows in blocks:
        ends.append(np.sort(rows[:, np.array(KINDS[kind].edges)], axis=2).reshape(-1, 2))
        nodes.append(rows[:, KINDS[kind].n_corners :].reshape(-1, 1))
    known = np.unique(np.hstack([np.concatenate(ends), np.concatenate(nodes)]), axis=0)
    twice = known[1:][(known[1:, :2] == known[:-1, :2]).all(axis=1)]
    failures = offenders(
        rule, "edge", twice[:, 2], mesh.points[twice[:, 2]], "has|have more than one node"
    )
    off = np.zeros(len(case.facet_kind))
    curved = case.facet_kind == "triangle6"
    if case.domain is not None and curved.any():
        places = np.repeat(case.facet_places(np.arange(len(off)))[:, None], 6, axis=1)
        places[curved] = mesh.points[mesh.facets["triangle6"]]
        off = np.where(curved, case.off_surfaces(places), 0.0)
        bad = np.flatnonzero(~(off <= case.tolerance))
        complaint = "has|have nodes off the exact surfaces of its names"
        failures += offenders(rule, "facet", bad, case.facet_places(bad), complaint)
    return Check.of(rule, len(known), failures)


def check_volume(case: SpaceCase) -> Check:
    """The cells of each region fill the domain's volume, to the bound on chords."""
    n = len(case.mesh.region_names)
    return compare_volumes(case, np.bincount(case.cell_region[:-1], case.quality.volume, n))


def compare_volumes(case: SpaceCase, given: np.ndarray) -> Check:
    """The volume of each region, (n_regions,), is the domain's, to the bound on chords."""
    rule, points, total = "volume", case.mesh.points, float(given.sum())
    if case.domain is None:
        return Check.skipped(rule, f"no domain to compare with; the cells fill {total:.12g}")
    domain = case.domain
    exact = domain.volumes()
    # Each facet may be off by its distance from the exact surface all over its area.
    slack = float(
        (facet_sags(case, curved=True)[case.triangles[:, 3]] * triangle_areas(case)).sum()
    )
    bent = domain.surfaces.kind[domain.facet_surface] != PLANE
    slack += domain.deviation * float(domain.facet_areas()[bent].sum())
    slack += AREA_SHARE * domain.diagonal**3 + coordinate_ulp(points) * float(
        triangle_areas(case).sum()
    )
    number = {name: k for k, name in enumerate(domain.region_names)}
    bad = [
        k
        for k, name in enumerate(case.mesh.region_names)
        if name not in number or not abs(given[k] - exact[number[name]]) <= slack
    ]
    failures = offenders(
        rule,
        "region",
        np.array(bad, np.int64),
        np.zeros((len(bad), 0)),
        "has|have another volume than in the domain",
        f"{given[bad[0]]:.10g}" if bad else "",
    )
    note = f"cells fill {total:.12g}, the domain has {exact.sum():.12g}, chords allow {slack:.3g}"
    return Check.of(rule, case.mesh.n_cells, failures, note)


def _in_other_regions(case: SpaceCase, points: np.ndarray, region: np.ndarray) -> np.ndarray:
    """Which points lie in a region of another name than the cell around them, (n,) bool."""
    mesh, domain = case.mesh, case.domain
    assert domain is not None
    if len(domain.region_names) < 2:
        return np.zeros(len(points), bool)
    names = dict.fromkeys([*mesh.region_names, *domain.region_names])
    number = {name: k for k, name in enumerate(names)}
    ours = np.array([*(number[name] for name in mesh.region_names), -1])
    theirs = np.array([*(number[name] for name in domain.region_names), -1])
    found, wanted = ours[case.cell_region[mesh.locate(points)]], theirs[region]
    return np.asarray((found != wanted) & (found >= 0) & (wanted >= 0))


def check_samples(case: SpaceCase) -> Check:
    """Random points lie inside the facets if they lie in the shape, boundaries apart."""
    rule = "samples"
    if case.contains is None or case.domain is None:
        return Check.skipped(rule, "no shape to compare with")
    low, high = case.domain.bounds()
    points = low + (high - low) * np.random.default_rng(SEED).random((N_SAMPLES, 3))
    outer = case.triangles[(case.facet_region[case.triangles[:, 3]] < 0).any(axis=1)]
    inside = winding_numbers(points, case.mesh.points, outer[:, :3]) != 0
    region = np.asarray(case.contains(points))
    elsewhere = _in_other_regions(case, points, region)
    differ = np.flatnonzero((inside != (region >= 0)) | elsewhere)
    near = 2.0 * (float(facet_sags(case).max(initial=0.0)) + case.domain.deviation)
    surfaces = case.domain.surfaces
    off = np.full(len(differ), np.inf)
    for s in range(len(surfaces)):
        np.minimum(off, surfaces.distance(np.full(len(differ), s), points[differ]), out=off)
    bad = differ[off > near]
    failures = offenders(
        rule, "sample", bad, points[bad], "lies|lie elsewhere in the mesh than in the shape"
    )
    note = f"{len(differ) - len(bad)} within the deviation of a boundary"
    return Check.of(rule, N_SAMPLES, failures, note)


_RULES: tuple[tuple[str, Callable[[SpaceCase], Check]], ...] = (
    ("indices", check_indices),
    ("points", check_points),
    ("orientation", check_orientation),
    ("conforming", check_conforming),
    ("facets", check_facets),
    ("names", check_names),
    ("edge nodes", check_edge_nodes),
    ("volume", check_volume),
    ("samples", check_samples),
    ("Delaunay", check_delaunay),
)

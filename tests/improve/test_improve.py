"""Improved meshes: better angles, the same domain, exact curves, the same bytes."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import csgmesh as cm
from csgmesh import kernels
from csgmesh.errors import InputError
from csgmesh.improve import optimise
from csgmesh.mesh import Mesh

BOX = cm.Box((0, 0), (4, 2), name="plate")
PLATE = BOX - cm.Disk((1, 1), 0.5, name="left") - cm.Disk((3, 1), 0.3, name="right")
CRACK = [(-0.5, 0.0), (0.0, 0.1), (0.5, 0.0)]
DOMAINS = {
    "square": (cm.Box((0, 0), (1, 1)), 0.025),
    "disk": (cm.Disk((0, 0), 1), 0.05),
    "plate": (PLATE, 0.06),
    "graded": (PLATE, {"left": 0.03, "default": 0.3}),
    "no size": (PLATE, None),
    "ellipse": (cm.Ellipse((0, 0), (3, 1), angle=20), 0.15),
    "regions": (cm.Regions({"rock": BOX, "core": cm.Disk((2, 1), 0.6)}), 0.1),
    "crack": (
        cm.Embed(
            cm.Disk((0, 0), 1),
            [
                cm.EmbeddedPath(CRACK, name="crack"),
                cm.EmbeddedPoints([(0.1, 0.5)], name="probe"),
            ],
        ),
        0.1,
    ),
    "wedge": (cm.Polygon([(0, 0), (4, 0), (4, 1)]) | cm.Disk((4, 0.5), 0.7), 0.2),
    "lens": (cm.Disk((0, 0), 2) ^ cm.Disk((1.5, 0), 1), 0.2),
}


@functools.cache
def plain(name: str) -> Mesh:
    shape, size = DOMAINS[name]
    return cm.generate(shape, cm.DelaunayRefinement(), size=size)


@functools.cache
def improved(name: str) -> Mesh:
    shape, size = DOMAINS[name]
    return cm.generate(shape, cm.DelaunayRefinement(improve=True), size=size)


def smallest(mesh: Mesh) -> float:
    return float(cm.quality(mesh).min_angle.min())


@pytest.mark.parametrize("name", DOMAINS)
def test_the_result_passes_the_certificate(name: str) -> None:
    certificate = cm.check(improved(name), DOMAINS[name][0])
    assert certificate.ok, str(certificate)


@pytest.mark.parametrize("name", DOMAINS)
@pytest.mark.parametrize("method", ["laplace", "odt", "optimize"])
def test_smoothing_never_turns_a_cell_over_nor_lowers_the_worst_angle(
    name: str, method: str
) -> None:
    mesh = plain(name)
    better = cm.smooth(mesh, method=method)
    assert (kernels.orientations(better.points, better.cells["triangle"]) == 1).all()
    assert smallest(better) >= smallest(mesh) - 1e-9
    assert cm.check(better, DOMAINS[name][0]).ok


@pytest.mark.parametrize("name", ["square", "disk", "plate"])
def test_uniform_meshes_reach_38_degrees_at_their_size(name: str) -> None:
    shape, size = DOMAINS[name]
    mesh = cm.generate(shape, cm.DelaunayRefinement(improve=True), size=0.5 * size)
    assert smallest(mesh) >= 38
    assert smallest(mesh) > smallest(cm.generate(shape, size=0.5 * size))
    corners = mesh.points[mesh.cells["triangle"]]
    length = np.hypot(*np.moveaxis(corners - np.roll(corners, 1, axis=1), 2, 0)) / (0.5 * size)
    assert ((length > 0.6) & (length < 1.6)).mean() > 0.99


def test_letters_reach_35_degrees_on_average() -> None:
    from matplotlib.textpath import TextPath

    worst = []
    for letter in "BDEGHORSbdeghn0235689":
        path = TextPath((0, 0), letter, size=10)
        shape = cm.Outline.from_path(path.vertices, path.codes)
        mesh = cm.generate(shape, cm.DelaunayRefinement(improve=True))
        assert cm.check(mesh).ok
        worst.append(smallest(mesh))
    assert np.mean(worst) >= 35


def test_corners_junctions_and_embedded_points_stay() -> None:
    for name in ("crack", "regions", "square", "wedge"):
        before, after = plain(name), improved(name)
        facets = before.facets["line"]
        is_end = np.bincount(facets.ravel(), minlength=before.n_points) % 2 == 1
        kept = [tuple(p) for p in before.points[is_end | (before.point_marker >= 0)]]
        markers = before.facet_marker["line"]
        low, high = np.full(before.n_points, 99), np.full(before.n_points, -1)
        np.minimum.at(low, facets, markers[:, None])
        np.maximum.at(high, facets, markers[:, None])
        kept += [tuple(p) for p in before.points[low < high]]
        assert set(kept) <= {tuple(p) for p in after.points}


def test_vertices_slide_on_their_exact_curves() -> None:
    before, after = plain("disk"), improved("disk")
    on = np.unique(after.facets["line"])
    assert np.abs(np.hypot(*after.points[on].T) - 1).max() < 1e-15
    assert (before.points[on] != after.points[on]).any()


def test_what_is_named_stays_named() -> None:
    before, after = plain("regions"), improved("regions")
    assert after.names == before.names
    assert after.region_names == before.region_names
    for a, b in (("rock", "core"), ("core", "rock")):
        assert len(after.interface(a, b)["line"]) == len(before.interface(a, b)["line"])
    assert np.array_equal(after.facets["line"], before.facets["line"])
    assert np.array_equal(after.cell_region["triangle"], before.cell_region["triangle"])


@pytest.mark.parametrize("name", ["plate", "crack"])
def test_the_same_input_gives_the_same_bytes(name: str) -> None:
    shape, size = DOMAINS[name]
    again = cm.generate(shape, cm.DelaunayRefinement(improve=True), size=size)
    assert again.equals(improved(name))


def test_boundaries_a_hair_apart_do_not_run_into_each_other() -> None:
    for gap in (1e-2, 1e-5):
        left, right = cm.Disk((-1, 0), 1 - gap), cm.Disk((1, 0), 1)
        for shape in (left | right, cm.Box((-3, -2), (3, 2)) - left - right):
            mesh = cm.generate(shape, cm.DelaunayRefinement(improve=True))
            assert cm.check(mesh, shape).ok


def test_a_breakthrough_is_found_and_its_vertices_are_pinned() -> None:
    from csgmesh.improve.breakthrough import broken_through
    from csgmesh.improve.workpiece import SLIDING, Workpiece

    gap = 1e-3
    shape = cm.Disk((0, 0), 1) - (cm.Disk((0, 0), 0.8) - cm.Disk((0, 0), 0.8 - gap))
    work = Workpiece(cm.generate(shape), None, np.zeros(0, np.int64))
    radius = np.hypot(*work.arrays.xy.reshape(-1, 2).T)
    inside = np.flatnonzero((work.arrays.kind == SLIDING) & (abs(radius - 0.8 + gap) < 1e-9))
    # As if a vertex of the inner disk had slid right across the gap.
    work.arrays.xy.reshape(-1, 2)[inside[3]] *= (0.8 + gap) / (0.8 - gap)
    assert broken_through(work).tolist() == [inside[3]]


def test_a_mesh_from_a_file_keeps_its_boundary(tmp_path) -> None:
    before = plain("plate")
    cm.write(tmp_path / "plate.msh", before)
    mesh = cm.read(tmp_path / "plate.msh")
    after = cm.smooth(mesh, "optimize")
    on = np.unique(mesh.facets["line"])
    assert np.array_equal(after.points[on], mesh.points[on])
    assert smallest(after) > smallest(mesh)


def test_a_mesh_without_facets_keeps_its_outline() -> None:
    before = plain("regions")
    bare = Mesh(before.points, before.cells, before.cell_region, before.region_names)
    after = optimise(bare)
    on = np.unique(before.facets["line"])
    assert np.array_equal(after.points[on], before.points[on])
    assert smallest(after) >= smallest(before)


def test_progress_is_told_and_may_stop_the_work() -> None:
    def stop(stage: str, done: int, total: int) -> None:
        raise KeyboardInterrupt

    mesh = cm.generate(cm.Box((0, 0), (1, 1)), size=0.003)
    with pytest.raises(KeyboardInterrupt):
        cm.smooth(mesh, "odt", progress=stop)


def test_what_cannot_be_done_is_refused() -> None:
    mesh = plain("disk")
    with pytest.raises(InputError, match="did you mean 'laplace'"):
        cm.smooth(mesh, method="laplacian")
    with pytest.raises(InputError, match="sweeps"):
        cm.smooth(mesh, sweeps=-1)
    with pytest.raises(InputError, match="goal"):
        optimise(mesh, goal=60)
    with pytest.raises(InputError, match="improve"):
        cm.DelaunayRefinement(improve="yes")
    quads = Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], {"quad": [[0, 1, 2, 3]]})
    with pytest.raises(InputError, match="quad"):
        optimise(quads)

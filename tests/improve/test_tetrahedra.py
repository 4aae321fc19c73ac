"""Improvement of tetrahedra: angles rise, and everything else is as it was."""

from __future__ import annotations

import numpy as np
import pytest
from delaunay_solids import as_mesh, ball, box_around_ball, delaunay

import csgmesh as cm
from csgmesh.errors import InputError
from csgmesh.improve.tetrahedra import improve_tetrahedra


def worst(mesh):
    measured = cm.quality(mesh)
    return measured.min_dihedral.min(), measured.max_dihedral.max()


@pytest.mark.parametrize("make", [ball, box_around_ball])
def test_slivers_go_and_the_mesh_stays_that_of_the_solid(make):
    case, solid = make(0.25)
    before = as_mesh(case[:5], case[5])
    assert worst(before)[0] < 4
    after = as_mesh(improve_tetrahedra(*case), case[5])
    low, high = worst(after)
    assert low >= 18
    assert high <= 160
    assert cm.check(after, solid).ok
    assert after.names == before.names
    assert len(after.facets["triangle"]) == len(before.facets["triangle"])


def test_strata_stay():
    (*parts, surface), _ = box_around_ball(0.25)
    points, _, _, triangles, face = improve_tetrahedra(*parts, surface, goal=30)
    n = surface.n_points
    moved = (points[:n] != surface.points).any(axis=1)
    assert moved[surface.point_dim == 2].any()
    assert moved[surface.point_dim == 1].any()
    assert not moved[surface.point_dim == 0].any()
    on = surface.project(np.arange(n), points[:n])
    assert np.abs(on - points[:n]).max() < 1e-14
    edges = {tuple(sorted(e)) for e in triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).tolist()}
    assert {tuple(sorted(e)) for e in surface.segments.tolist()} <= edges
    assert (np.bincount(face) == np.bincount(surface.face)).all()


def test_chords_stray_no_further():
    (*parts, surface), _ = ball(0.3)
    points, _, _, triangles, _ = improve_tetrahedra(*parts, surface, goal=30)

    def depth(points, triangles):
        ends = points[triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)]
        return 1 - np.sqrt((ends.mean(axis=1) ** 2).sum(axis=1)).min()

    assert depth(points, triangles) <= 1.01 * depth(surface.points, surface.triangles)


def sharpest(points, triangles):
    """Smallest angle of triangles in space, degrees."""
    corners, least = points[triangles], 180.0
    for k in range(3):
        u, v = (corners[:, (k + j) % 3] - corners[:, k] for j in (1, 2))
        across = np.sqrt((np.cross(u, v) ** 2).sum(axis=1))
        least = min(least, np.degrees(np.arctan2(across, (u * v).sum(axis=1))).min())
    return least


@pytest.mark.parametrize("make", [ball, box_around_ball])
def test_triangles_of_the_surface_stay_well_shaped(make):
    (*parts, surface), _ = make(0.2)
    points, _, _, triangles, _ = improve_tetrahedra(*parts, surface, goal=30)
    before = sharpest(surface.points, surface.triangles)
    assert sharpest(points, triangles) >= min(25 - 0.01, before)
    assert (points[: surface.n_points] != surface.points).any()


def test_an_interface_is_kept_from_both_sides():
    (*parts, surface), _ = box_around_ball(0.25, keep_ball=True)
    before = as_mesh(parts, surface)
    after = as_mesh(improve_tetrahedra(*parts, surface), surface)
    assert worst(after)[0] >= 18
    for rule in ("orientation", "conforming", "facets"):
        assert not cm.check(after)[rule].failures
    for name in before.region_names:
        volumes = [
            cm.quality(mesh).volume[mesh.region(name)["tetra"]].sum() for mesh in (before, after)
        ]
        assert volumes[0] == pytest.approx(volumes[1], rel=2e-2)
    assert cm.quality(after).total_volume == pytest.approx(8, rel=1e-12)


def test_good_cells_are_not_touched():
    (*parts, surface), _ = ball(0.12)
    points, tets, *_ = improve_tetrahedra(*parts, surface)
    deep = (np.sqrt((parts[0][parts[1]] ** 2).sum(axis=2)) < 0.5).all(axis=1)
    assert deep.sum() > 1000
    kept = {tuple(row) for row in tets.tolist()}
    assert all(tuple(row) in kept for row in parts[1][deep].tolist())
    assert (points[parts[1][deep]] == parts[0][parts[1][deep]]).all()


@pytest.mark.parametrize("seed", range(4))
def test_random_points_make_valid_meshes(seed):
    """Without any order among the points, so that vertices have to come and go."""
    (_, _, _, _, _, surface), _ = ball(0.4)
    rng = np.random.default_rng(seed)
    inner = rng.normal(size=(150, 3))
    inner *= 0.9 * (rng.random(150) ** (1 / 3) / np.sqrt((inner**2).sum(axis=1)))[:, None]
    points = np.concatenate([surface.points, inner])
    tets = delaunay(points)
    region = np.zeros(len(tets), np.int64)
    parts = (points, tets, region, surface.triangles, surface.face)
    before = worst(as_mesh(parts, surface))
    found = []
    for passes in (2, 6):
        after = as_mesh(improve_tetrahedra(*parts, surface, passes=passes), surface)
        assert cm.check(after, cm.Ball((0, 0, 0), 1)).ok
        found.append(worst(after)[0])
    assert before[0] < 3
    assert found[1] >= max(found[0], 12)


def test_the_same_input_gives_the_same_bytes():
    case, _ = box_around_ball(0.3)
    first, second = (improve_tetrahedra(*case, passes=4) for _ in range(2))
    assert all(a.tobytes() == b.tobytes() for a, b in zip(first, second, strict=True))


def test_no_passes_change_nothing_and_options_are_checked():
    case, _ = ball(0.4)
    same = improve_tetrahedra(*case, passes=0)
    assert all((a == b).all() for a, b in zip(same, case, strict=False))
    with pytest.raises(InputError, match="goal must be between 0 and 60 degrees; got 75"):
        improve_tetrahedra(*case, goal=75)
    with pytest.raises(InputError, match="passes must be a whole number"):
        improve_tetrahedra(*case, passes=1.5)

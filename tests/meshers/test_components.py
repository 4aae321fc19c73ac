"""Components of a domain are meshed side by side, and nobody can tell from the mesh."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from plane_domains import loops

import csgmesh as cm
from csgmesh.domain import Pslg
from csgmesh.errors import BudgetError, InputError, MeshingError, SizeError
from csgmesh.meshers import DelaunayRefinement
from csgmesh.meshers.components import components, parts_of
from csgmesh.size import resolve

FINE = 0.02


def box(x: float, y: float, w: float, h: float) -> list[tuple[float, float]]:
    return [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]


def archipelago() -> cm.Shape:
    """A plate of two materials with a hole, an island with a point in the hole, a disk outside."""
    plate = cm.Box((0, 0), (4, 4), name="plate") - cm.Disk((2, 2), 1.5, name="hole")
    island = cm.Disk((2, 2), 1, name="island")
    far = cm.Disk((7, 2), 1, name="far")
    core = cm.Box((0, 0), (0.4, 4), name="core")
    regions = cm.Regions({"core": core & plate, "rock": (plate - core) | island | far})
    return cm.Embed(regions, [cm.EmbeddedPoints([(2.1, 2.05)], name="probe")])


def arrays(mesh: cm.Mesh) -> list[bytes]:
    found = [mesh.points, mesh.cells["triangle"], mesh.cell_region["triangle"], mesh.point_marker]
    found += [
        field["line"]
        for field in (
            mesh.facets,
            mesh.facet_marker,
            mesh.facet_region,
            mesh.facet_curve,
            mesh.facet_interval,
        )
    ]
    return [array.tobytes() for array in found]


SIZES = {
    "uniform": FINE,
    "named": {"island": 0.004, "default": 0.1},
    "callable": lambda p: FINE * (0.7 + 0.5 * np.abs(np.sin(p[:, 0]))),
}


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES)
def test_bytes_do_not_depend_on_the_number_of_threads(size) -> None:
    shape = archipelago()
    domain = cm.evaluate(shape)
    assert len(parts_of(domain, resolve(size, domain), 10**7)) == 3
    one, *others = (DelaunayRefinement(threads=n).generate(domain, size) for n in (1, 2, 4))
    assert len(one.cells["triangle"]) > 10_000
    for other in others:
        assert arrays(other) == arrays(one)
        assert other.info == one.info
    found = cm.check(one, shape)
    assert found.ok, found


def test_names_regions_and_embedded_points_arrive_from_all_parts() -> None:
    domain = cm.evaluate(archipelago())
    mesh = DelaunayRefinement().generate(domain, FINE)
    assert mesh.names == domain.names and mesh.region_names == domain.region_names
    corners = mesh.points[mesh.cells["triangle"]]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.bincount(mesh.cell_region["triangle"], 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))
    exact = np.array([0.4 * 4, 3.6 * 4 - np.pi * 1.5**2 + 2 * np.pi])
    assert area == pytest.approx(exact, rel=1e-4)
    (probe,) = mesh.boundary_points("probe")
    assert np.array_equal(mesh.points[probe], [2.1, 2.05])
    for name, radius, centre in (("hole", 1.5, 2), ("island", 1, 2), ("far", 1, 7)):
        on = mesh.points[mesh.boundary_points(name)]
        assert len(on) > 100
        assert np.hypot(on[:, 0] - centre, on[:, 1] - 2) == pytest.approx(radius, rel=1e-14)


def test_an_island_in_a_hole_is_a_component_and_a_hole_is_none() -> None:
    domain = loops(box(0, 0, 9, 9), box(1, 1, 7, 7), box(2, 2, 5, 5), box(3, 3, 1, 1))
    assert components(domain).tolist() == [0] * 8 + [1] * 8


def test_components_that_touch_at_a_vertex_stay_together() -> None:
    points = [*box(0, 0, 1, 1), (2, 1), (2, 2), (1, 2), *box(5, 5, 1, 1)]
    ends = [(0, 1), (1, 2), (2, 3), (3, 0), (2, 4), (4, 5), (5, 6), (6, 2)]
    ends += [(7, 8), (8, 9), (9, 10), (10, 7)]
    domain = Pslg(points, ends)
    assert components(domain).tolist() == [0] * 7 + [1] * 4
    mesh = DelaunayRefinement().generate(domain, 0.005)
    assert cm.check(mesh).ok


def test_many_components_are_meshed_in_few_parts_in_their_order() -> None:
    domain = loops(*(box(2 * i, 2 * j, 1, 1) for j in range(13) for i in range(13)))
    parts = parts_of(domain, resolve(0.05, domain), 10**7)
    assert 4 <= len(parts) <= 16
    assert np.array_equal(np.concatenate([part.point for part in parts]), np.arange(676))
    mesh = DelaunayRefinement(threads=2).generate(domain, 0.05)
    assert cm.check(mesh).ok


@pytest.mark.parametrize("size", [None, 0.1, {"boundary": 0.1}])
def test_small_domains_are_not_taken_apart(size) -> None:
    domain = loops(box(0, 0, 1, 1), box(2, 0, 1, 1))
    assert len(parts_of(domain, resolve(size, domain), 10**7)) == 1


def two_boxes() -> Pslg:
    return loops(box(0, 0, 1, 1), box(2, 0, 1, 1), box(4, 0, 1, 1))


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_an_error_in_one_component_names_the_place(threads) -> None:
    def size(p: np.ndarray) -> np.ndarray:
        inside = (p[:, 0] > 2.3) & (p[:, 0] < 2.7) & (np.abs(p[:, 1] - 0.5) < 0.4)
        return np.where(inside, np.nan, 0.01)

    with pytest.raises(SizeError, match=r"positive and finite; got nan at \(2\.[3-6]"):
        DelaunayRefinement(threads=threads).generate(two_boxes(), size)


def test_segments_that_cross_in_one_component_are_named() -> None:
    points = [*box(0, 0, 1, 1), (3, 0), (4, 1), (4, 0), (3, 1)]
    ends = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
    domain = Pslg.build(
        points=points,
        segments=ends,
        segment_marker=np.repeat([0, 1], 4),
        segment_region=[[0, -1]] * 8,
        boundary_names=(("box",), ("bow",)),
    )
    with pytest.raises(MeshingError, match=r"bow from .* meets bow from"):
        DelaunayRefinement().generate(domain, 0.004)


def test_the_budget_is_for_all_parts_together() -> None:
    domain = two_boxes()
    n = DelaunayRefinement().generate(domain, 0.007).n_points
    enough = DelaunayRefinement(max_points=n, threads=2).generate(domain, 0.007)
    assert enough.n_points == n
    stopped = []
    for threads in (1, 2, 4):
        with pytest.raises(BudgetError, match=f"max_points={n - 100} is used up") as caught:
            DelaunayRefinement(max_points=n - 100, threads=threads).generate(domain, 0.007)
        stopped.append(caught.value.mesh)
    assert all(arrays(mesh) == arrays(stopped[0]) for mesh in stopped)
    # The first two are done, the third is as far as the budget went.
    assert stopped[0].n_points <= n
    centres = stopped[0].points[stopped[0].cells["triangle"]].mean(axis=1)[:, 0]
    assert np.unique(np.floor(centres)).tolist() == [0, 2, 4]


def test_no_two_threads_are_in_the_users_size_at_once() -> None:
    inside, met = [], []

    def size(p: np.ndarray) -> np.ndarray:
        inside.append(threading.get_ident())
        met.append(len(inside))
        value = 0.012 + 0.004 * np.sin(p).sum(axis=1)
        inside.pop()
        return value

    DelaunayRefinement(threads=4).generate(two_boxes(), size)
    assert max(met) == 1


@pytest.mark.parametrize("threads", [1, 3])
def test_an_interruption_ends_all_threads(threads) -> None:
    def progress(stage: str, done: int, total: int) -> None:
        assert threading.current_thread() is threading.main_thread()
        assert 0 <= done <= total
        if stage == "refine":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        DelaunayRefinement(threads=threads).generate(two_boxes(), 0.003, progress)
    assert threading.active_count() == 1


def test_threads_are_counted_from_one() -> None:
    with pytest.raises(InputError, match="threads must be a whole number, at least 1; got 0"):
        DelaunayRefinement(threads=0)

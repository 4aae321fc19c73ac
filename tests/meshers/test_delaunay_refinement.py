"""Delaunay refinement keeps its guarantees: angles, curves, regions, sizes, budget, bytes."""

from __future__ import annotations

import json

import numpy as np
import pytest
from plane_domains import (
    assert_angles,
    assert_on_curves,
    assert_sound,
    comb,
    disks,
    edge_lengths,
    koch,
    loops,
    smallest_angles,
    square,
    star,
    wedge,
)

from csgmesh.domain import Pslg
from csgmesh.errors import BudgetError, InputError, MeshingError, NameLookupError, SizeError
from csgmesh.meshers import DelaunayRefinement, worst_cells

ELL = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
FRAME = [(0, 0), (1, 0), (1, 1), (0, 1)]


def hole(x: float, y: float, w: float) -> list[tuple[float, float]]:
    return [(x, y), (x + w, y), (x + w, y + w), (x, y + w)]


DOMAINS = {
    "square": square(),
    "ell": loops(ELL),
    "holes": loops(FRAME, hole(0.2, 0.2, 0.3), hole(0.51, 0.51, 0.01), hole(0.7, 0.1, 0.1)),
    "slit": loops([(0, 0), (1, 0), (1, 1), (0.5, 1), (0.5, 0.3), (0.4999, 1), (0, 1)]),
    "star": star(9),
    "needles": star(150),
    "koch": koch(3),
    "comb": comb(10),
    "narrow": loops(FRAME, hole(0.3, 0.3, 0.4), hole(0.3 + 1e-3, 0.3 + 1e-3, 0.4 - 2e-3)),
    "nested": loops(FRAME, hole(0.3, 0.3, 1e-5)),
    "disk": disks([(0, 0, 1, 0, -1)]),
    "three chords": disks([(0, 0, 1, 0, -1)], n=3),
    "plate": disks([(0.5, 0.5, 0.2, -1, 0)], box=(0, 0, 1, 1)),
    "inclusion": disks([(0.5, 0.5, 0.2, 1, 0)], n=5, box=(0, 0, 1, 1)),
    "near circles": disks([(0, 0, 1, 0, -1), (0.29, 0, 0.7, -1, 0)], n=64),
}


@pytest.mark.parametrize("name", DOMAINS)
@pytest.mark.parametrize("bound", [20, 30, 33])
def test_angles_are_kept_and_the_mesh_is_sound(name: str, bound: float) -> None:
    domain = DOMAINS[name]
    mesh = DelaunayRefinement(min_angle=bound, max_points=200_000).generate(domain)
    assert_sound(mesh, domain)
    assert_angles(mesh, domain, bound)
    assert_on_curves(mesh, 1e-14)


@pytest.mark.parametrize("scale, offset", [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e9), (1e9, 1e9)])
@pytest.mark.parametrize("contours", [[ELL], [FRAME, hole(0.2, 0.2, 0.3), hole(0.51, 0.51, 0.01)]])
def test_scale_and_offset_change_nothing(contours, scale: float, offset: float) -> None:
    domain = loops(*contours, scale=scale, offset=offset)
    mesh = DelaunayRefinement(max_points=20_000).generate(domain)
    assert_sound(mesh, domain)
    assert_angles(mesh, domain, 30)


@pytest.mark.parametrize("degrees", [59, 45, 30, 10, 1, 1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("ratio", [1.0, 1.3])
def test_small_input_angles_end_with_few_points(degrees: float, ratio: float) -> None:
    domain = wedge(degrees, ratio)
    for size in (None, 0.1):
        mesh = DelaunayRefinement(max_points=2000).generate(domain, size)
        assert_sound(mesh, domain)
        assert_angles(mesh, domain, 30)


@pytest.mark.parametrize("degrees", [30, 1, 1e-3, 1e-6])
def test_a_fan_of_segments_of_all_lengths_ends(degrees: float) -> None:
    t = np.radians(degrees)
    spokes = [(0, 0), (1, 0)]
    for k, r in enumerate((3.0, 0.7, 2.2, 1.0), start=1):
        spokes += [(r * np.cos(k * t), r * np.sin(k * t)), (0.01 * k, 1e-9 * k)][:1]
    points = [*spokes, (-5, -5), (5, -5), (5, 5), (-5, 5)]
    n = len(spokes)
    frame = [(n, n + 1), (n + 1, n + 2), (n + 2, n + 3), (n + 3, n)]
    rays = [(0, k) for k in range(1, n)]
    domain = Pslg.build(
        points=points,
        segments=frame + rays,
        segment_marker=[0] * 4 + [1] * len(rays),
        segment_region=[[0, -1]] * 4 + [[0, 0]] * len(rays),
        boundary_names=(("frame",), ("rays",)),
    )
    mesh = DelaunayRefinement(max_points=20_000).generate(domain)
    assert_sound(mesh, domain)
    assert_angles(mesh, domain, 30)


def test_cusps_between_tangent_circles_end() -> None:
    # Angle 0: two circles touch inside at (1, 0), where both have a vertex.
    for n in (6, 16, 64, 256):
        domain = disks([(0, 0, 1, 0, -1), (0.5, 0, 0.5, -1, 0)], n=n)
        points, segments = domain.points, domain.segments.copy()
        segments[segments == n] = 0
        keep = np.r_[:n, n + 1 : 2 * n]
        number = np.full(2 * n, -1)
        number[keep] = np.arange(2 * n - 1)
        merged = Pslg.build(
            **{f: getattr(domain, f) for f in domain.__dataclass_fields__}
            | {
                "points": points[keep],
                "segments": number[segments],
                "point_marker": np.full(2 * n - 1, -1),
            }
        )
        mesh = DelaunayRefinement(max_points=50_000).generate(merged)
        assert_sound(mesh, merged)
        assert_angles(mesh, merged, 30)
        assert_on_curves(mesh, 1e-14)


def test_regions_and_markers_arrive() -> None:
    domain = DOMAINS["inclusion"]
    mesh = DelaunayRefinement().generate(domain, {"core": 0.03, "default": 0.2})
    centres = mesh.points[mesh.cells["triangle"]].mean(axis=1)
    core = mesh.cell_region["triangle"] == 1
    # Chords of the inclusion lie inside it: centres of its cells are nearer than its radius.
    assert np.array_equal(core, np.hypot(*(centres - 0.5).T) < 0.2 - 1e-3 * core)
    sides, marker = mesh.facet_region["line"], mesh.facet_marker["line"]
    assert (sides[marker == 0] == [0, 1]).all()
    assert (sides[marker == 1] == [0, -1]).all()
    assert {len(mesh.boundary(f)["line"]) > 0 for f in ("disk0", "box")} == {True}
    # An outer facet has the domain on its left.
    a, b = (mesh.points[mesh.facets["line"][marker == 1, k]] - 0.5 for k in (0, 1))
    assert (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0).all()


def test_embedded_paths_and_points_are_kept() -> None:
    points = [*FRAME, (0.2, 0.5), (0.8, 0.5), (0.3, 0.3)]
    domain = Pslg.build(
        points=points,
        segments=[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5]],
        segment_marker=[0, 0, 0, 0, 1],
        segment_region=[[0, -1]] * 4 + [[0, 0]],
        point_marker=[-1] * 6 + [2],
        boundary_names=(("frame",), ("crack",), ("probe",)),
    )
    mesh = DelaunayRefinement().generate(domain, {"crack": 0.02, "probe": 0.01})
    crack = mesh.points[mesh.boundary_points("crack")]
    assert np.array_equal(np.unique(crack[:, 1]), [0.5])
    assert (crack[:, 0].min(), crack[:, 0].max()) == (0.2, 0.8)
    probe = mesh.boundary_points("probe")
    assert np.array_equal(mesh.points[probe], [[0.3, 0.3]])
    cells = mesh.cells["triangle"]
    around = mesh.points[cells[(cells == probe[0]).any(axis=1)]].reshape(-1, 2)
    assert np.hypot(*(around - [0.3, 0.3]).T).max() < 0.03


@pytest.mark.parametrize("h", [0.2, 0.03])
@pytest.mark.parametrize("name", ["square", "ell", "disk", "three chords"])
def test_edges_are_as_long_as_wanted(name: str, h: float) -> None:
    mesh = DelaunayRefinement().generate(DOMAINS[name], h)
    edges = edge_lengths(mesh) / h
    assert 0.9 < edges.mean() < 1.1
    assert np.mean((edges > 0.6) & (edges < 1.6)) > (0.99 if h < 0.1 else 0.95)


def test_a_callable_size_is_followed() -> None:
    found = []
    for x in (0.3, 0.37, 0.45):

        def size(p: np.ndarray, x: float = x) -> np.ndarray:
            return 0.004 + 0.15 * np.hypot(*(p - [x, 0.2]).T)

        calls: list[int] = []
        mesh = DelaunayRefinement().generate(
            square(), lambda p, c=calls, h=size: c.append(len(p)) or h(p)
        )
        cells = mesh.cells["triangle"]
        edges = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
        p, q = mesh.points[edges[:, 0]], mesh.points[edges[:, 1]]
        found.append(np.hypot(*(p - q).T) / size((p + q) / 2))
        # In batches: each point once, and those of a coarse mesh.
        assert len(calls) < 40 and sum(calls) < 1.5 * mesh.n_points
        assert smallest_angles(mesh).mean() > 49
    share = np.concatenate(found)
    assert 0.9 < share.mean() < 1.1
    assert np.mean((share > 0.6) & (share < 1.6)) > 0.99


def test_sizes_grow_no_faster_than_the_gradation() -> None:
    mesh = DelaunayRefinement(gradation=0.2).generate(
        DOMAINS["plate"], {"disk0": 0.01, "default": 0.5}
    )
    cells = mesh.cells["triangle"]
    edges = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    p, q = mesh.points[edges[:, 0]], mesh.points[edges[:, 1]]
    away = np.hypot(*((p + q) / 2 - 0.5).T) - 0.2
    assert np.all(np.hypot(*(p - q).T) < 2.0 * (0.01 + 0.2 * np.maximum(away, 0)))


@pytest.mark.parametrize(
    "size, message",
    [
        (0, "positive and finite; got 0"),
        (-1.0, "positive and finite; got -1.0"),
        (np.nan, "got nan"),
        ("fine", "got 'fine'"),
        (True, "got True"),
        (lambda p: np.zeros(len(p)), r"got 0 at \(0, 0\)"),
        (lambda p: np.where(p[:, 0] > 0.9, np.nan, 0.1), r"got nan at \(1, [01]\)"),
        (lambda p: np.where(p[:, 1] > 0.9, np.inf, 0.1), r"got inf at \([01], 1\)"),
        (lambda p: -p[:, 0] - 1, r"got -1 at \(0, 0\)"),
        (lambda p: np.ones((len(p), 2)), r"got shape \(4, 2\)"),
        (lambda p: np.array(["a"] * len(p)), "must return numbers"),
        ({"boundary": -2}, "size of 'boundary' must be positive"),
    ],
)
def test_bad_sizes_are_named_with_the_point(size, message: str) -> None:
    with pytest.raises(SizeError, match=message):
        DelaunayRefinement().generate(square(), size)


def test_unknown_names_in_a_size_are_refused() -> None:
    with pytest.raises(NameLookupError, match="did you mean 'boundary'"):
        DelaunayRefinement().generate(square(), {"boundry": 0.1})


def test_impossible_sizes_are_refused_before_memory_ends() -> None:
    for size in (1e-6, lambda p: np.full(len(p), 1e-6), {"boundary": 0.1, "default": 1e-6}):
        with pytest.raises(BudgetError, match="max_points is 10000000") as caught:
            DelaunayRefinement().generate(square(), size)
        assert_sound(caught.value.mesh, square())


def test_the_budget_ends_the_work_with_the_mesh_so_far() -> None:
    domain = koch(3)
    with pytest.raises(BudgetError, match=r"max_points=210 .* at \(") as caught:
        DelaunayRefinement(max_points=210).generate(domain)
    assert_sound(caught.value.mesh, domain)
    assert caught.value.mesh.n_points <= 210


@pytest.mark.parametrize(
    "options", [{"min_angle": 40}, {"min_angle": -1}, {"gradation": 0}, {"max_points": 0}]
)
def test_options_out_of_range_are_refused(options) -> None:
    with pytest.raises(InputError, match=next(iter(options))):
        DelaunayRefinement(**options)


def test_crossing_curves_are_refused_with_the_place() -> None:
    domain = disks([(0, 0, 1, 0, -1), (1, 0, 0.5, 0, -1)])
    with pytest.raises(MeshingError, match=r"disk0 from .* meets disk1 from"):
        DelaunayRefinement().generate(domain)


def test_chords_that_cross_where_curves_do_not_are_refined() -> None:
    # The inner circle's vertices lie beyond the outer one's five chords.
    domain = disks([(0, 0, 1, 0, -1), (0, 0, 0.9, -1, 0)], n=5)
    turned = domain.points.copy()
    t = np.arange(5) * 2 * np.pi / 5 + np.pi / 5
    turned[5:] = 0.9 * np.column_stack([np.cos(t), np.sin(t)])
    interval = domain.segment_interval.copy()
    interval[5:] += np.pi / 5
    fields = {f: getattr(domain, f) for f in domain.__dataclass_fields__}
    domain = Pslg.build(**fields | {"points": turned, "segment_interval": interval})
    mesh = DelaunayRefinement().generate(domain)
    assert_sound(mesh, domain)
    assert_on_curves(mesh, 1e-14)
    radius = np.hypot(*mesh.points.T)
    assert radius.min() > 0.9 - 1e-12 and radius.max() < 1 + 1e-12


def test_the_same_input_gives_the_same_bytes() -> None:
    meshes = [DelaunayRefinement().generate(DOMAINS["plate"], {"disk0": 0.01}) for _ in range(2)]
    for field in ("points", "point_marker"):
        assert getattr(meshes[0], field).tobytes() == getattr(meshes[1], field).tobytes()
    for field in ("cells", "facets", "cell_region", "facet_interval"):
        first, second = (getattr(m, field) for m in meshes)
        assert all(first[k].tobytes() == second[k].tobytes() for k in first)


def test_long_work_comes_back_to_python_often() -> None:
    class Stop(Exception):
        pass

    seen = []

    def progress(stage: str, done: int, total: int) -> None:
        if stage == "refine":
            seen.append(done)
        if done > 150_000:
            raise Stop

    # Sizes so steep that there is no room for lattices.
    with pytest.raises(Stop):
        DelaunayRefinement().generate(square(), {"boundary": 6e-5}, progress=progress)
    assert len(seen) > 3
    assert np.diff(seen).max() <= 110_000


def test_a_mesh_tells_how_it_was_made() -> None:
    mesh = DelaunayRefinement(min_angle=25).generate(square(), 0.2)
    assert mesh.info["method"] == "DelaunayRefinement"
    assert mesh.info["options"]["min_angle"] == 25
    assert mesh.info["n_steiner"] == mesh.n_points - 4


@pytest.mark.parametrize("name", ["square", "ell", "disk", "three chords"])
def test_uniform_meshes_are_nearly_regular(name: str) -> None:
    mesh = DelaunayRefinement().generate(DOMAINS[name], 0.02)
    assert_sound(mesh, DOMAINS[name])
    assert_angles(mesh, DOMAINS[name], 30)
    assert smallest_angles(mesh).mean() > 57


def test_the_lattice_keeps_to_regions_and_interfaces() -> None:
    domain = disks([(0.5, 0.5, 0.3, 1, 0)], n=5, box=(0, 0, 1, 1))
    mesh = DelaunayRefinement().generate(domain, 0.03)
    assert_sound(mesh, domain)
    assert_angles(mesh, domain, 30)
    assert_on_curves(mesh, 1e-14)


@pytest.mark.parametrize("degrees", [50, 20, 1])
def test_a_lattice_row_on_a_long_sharp_segment_leaves_no_slivers(degrees: float) -> None:
    # Sharp corners are not seeded, so that the lattice meets bare slanted segments.
    t = np.radians([17.0, 17.0 + degrees])
    far = list(zip(3 * np.cos(t), 3 * np.sin(t), strict=True))
    domain = loops([(0, 0), *far, (-1, 2)])
    for size in (0.2, 0.03):
        mesh = DelaunayRefinement(max_points=100_000).generate(domain, size)
        assert_sound(mesh, domain)
        assert_angles(mesh, domain, 30)
        assert mesh.info["n_given_up"] == 0


def test_short_chords_leave_the_lattice_elsewhere() -> None:
    # Chords of 0.01 where edges of 0.03 are wanted.
    domain = disks([(0.3, 0.3, 0.15, -1, 0), (0.7, 0.6, 0.2, -1, 0)], n=100, box=(0, 0, 1, 1))
    mesh = DelaunayRefinement().generate(domain, 0.02)
    assert_sound(mesh, domain)
    assert_angles(mesh, domain, 30)
    assert_on_curves(mesh, 1e-14)
    assert smallest_angles(mesh).mean() > 54


def test_edges_on_the_boundary_grow_with_the_size() -> None:
    mesh = DelaunayRefinement().generate(square(), lambda p: 0.01 + 0.1 * p[:, 0])
    ends = mesh.points[mesh.facets["line"]]
    bottom = ends[(ends[..., 1] == 0).all(axis=1)]
    share = np.hypot(*(bottom[:, 1] - bottom[:, 0]).T) / (0.01 + 0.1 * bottom[..., 0].mean(axis=1))
    assert share.min() > 0.9 and share.max() < 1.1


def test_the_worst_cells_are_explained() -> None:
    sharp = DelaunayRefinement().generate(wedge(10), 0.05)
    worst = worst_cells(sharp, 3)
    assert [w["reason"] for w in worst] == ["input angle"] * 3
    assert worst[0]["angle"] == pytest.approx(smallest_angles(sharp).min())
    assert json.loads(json.dumps(worst)) == worst
    with pytest.raises(BudgetError) as caught:
        DelaunayRefinement(max_points=210).generate(DOMAINS["holes"], 0.001)
    assert {w["reason"] for w in worst_cells(caught.value.mesh)} <= {
        "narrow gap",
        "size jump",
        "budget",
    }
    assert worst_cells(DelaunayRefinement().generate(square(), 0.1), 1)[0]["reason"] == (
        "within the bound"
    )

"""The constrained Delaunay triangulation, against what defines it."""

from __future__ import annotations

import numpy as np
import pytest
from plane_domains import assert_sound, koch, square, star

from csgmesh import kernels
from csgmesh.domain import Pslg
from csgmesh.errors import InputError, MeshingError
from csgmesh.meshers import ConstrainedDelaunay


def framed(points: np.ndarray, chain: np.ndarray | None = None) -> Pslg:
    """Points, and segments between them, in a frame well outside."""
    lo, hi = points.min(0), points.max(0)
    w = 3 * max(hi - lo) + 1
    frame = [lo - w, (hi[0] + w, lo[1] - w), hi + w, (lo[0] - w, hi[1] + w)]
    edges = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    segments = edges if chain is None else np.vstack([edges, chain + 4])
    m = len(segments)
    return Pslg.build(
        points=np.vstack([frame, points]),
        segments=segments,
        segment_marker=np.zeros(m, int),
        segment_region=[[0, -1]] * 4 + [[0, 0]] * (m - 4),
        boundary_names=(("edge",),),
        point_marker=np.zeros(len(points) + 4, int),
    )


def locally_delaunay(mesh) -> bool:
    """Whether no edge but the facets has a far vertex inside the circle of its triangle."""
    cells = mesh.cells["triangle"]
    n = len(cells)
    edges = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    apex = np.concatenate([cells[:, 2], cells[:, 0], cells[:, 1]])
    order = np.lexsort(edges.T)
    same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
    first, second = order[:-1][same], order[1:][same]
    fixed = {tuple(e) for e in np.sort(mesh.facets["line"], axis=1).tolist()}
    free = np.array([tuple(e) not in fixed for e in edges[first].tolist()])
    first, second = first[free], second[free]
    return not (kernels.in_circles(mesh.points, cells[first % n], apex[second]) > 0).any()


def grid(n: int) -> np.ndarray:
    return np.stack(np.meshgrid(np.arange(n), np.arange(n)), -1).reshape(-1, 2).astype(float)


def circle(n: int) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.column_stack([np.cos(t), np.sin(t)])


POINT_SETS = {
    "random": np.random.default_rng(0).random((2000, 2)),
    "clustered": np.random.default_rng(1).normal(size=(1500, 2)) ** 5,
    "grid": grid(40),
    "grid / 7": grid(40) / 7 + 0.1,
    "circle": circle(1000),
    "line": np.outer(np.linspace(0, 1, 500), [0.3, 0.7]),
    "few": np.array([[0.5, 0.5]]),
    "far away": 1e9 + grid(20) * 1e-3,
}


@pytest.mark.parametrize("name", POINT_SETS)
def test_points_alone_give_the_delaunay_triangulation(name: str) -> None:
    domain = framed(POINT_SETS[name])
    mesh = ConstrainedDelaunay().generate(domain)
    assert_sound(mesh, domain)
    assert np.array_equal(mesh.points, domain.points)
    assert mesh.n_cells == 2 * len(domain.points) - 2 - 4
    assert locally_delaunay(mesh)


def test_a_cavity_of_thousands_of_triangles() -> None:
    # One point in the middle of a circle: its cavity is the whole triangulation.
    domain = framed(np.vstack([circle(20_000), [[1e-9, 1e-9]]]))
    mesh = ConstrainedDelaunay().generate(domain)
    assert mesh.n_cells == 2 * len(domain.points) - 2 - 4


@pytest.mark.parametrize("seed", range(5))
def test_segments_become_edges(seed: int) -> None:
    points = np.random.default_rng(seed).random((800, 2))
    order = np.argsort(points[:, 0])
    chain = np.column_stack([order[:-1], order[1:]])
    domain = framed(points, chain)
    mesh = ConstrainedDelaunay().generate(domain)
    assert_sound(mesh, domain)
    assert len(mesh.facets["line"]) == len(domain.segments)
    assert locally_delaunay(mesh)


def test_one_long_segment_through_many_triangles() -> None:
    points = np.vstack([np.random.default_rng(3).random((5000, 2)), [[-0.1, 0.503], [1.1, 0.497]]])
    domain = framed(points, np.array([[5000, 5001]]))
    mesh = ConstrainedDelaunay().generate(domain)
    assert_sound(mesh, domain)
    assert locally_delaunay(mesh)


def test_a_segment_with_all_points_near_it() -> None:
    # Edges across it turn into ever more edges across it before they turn away.
    rng = np.random.default_rng(5)
    x = np.sort(rng.random(400))
    points = np.column_stack([x, 1e-7 * rng.normal(size=400)])
    points = np.vstack([points, [[-0.1, 0.0], [1.1, 0.0]]])
    mesh = ConstrainedDelaunay().generate(framed(points, np.array([[400, 401]])))
    assert (kernels.orientations(mesh.points, mesh.cells["triangle"]) == 1).all()
    assert locally_delaunay(mesh)


def test_polygons_keep_their_area() -> None:
    for domain in (star(50), koch(4)):
        mesh = ConstrainedDelaunay().generate(domain)
        assert_sound(mesh, domain)
        assert mesh.n_cells == len(domain.points) - 2


def test_a_vertex_on_a_segment_splits_it() -> None:
    points = np.array([[0, 0], [0.25, 0.25], [1, 1], [0.5, 0.5], [0.9, 0.1]])
    domain = framed(points, np.array([[0, 2]]))
    mesh = ConstrainedDelaunay().generate(domain)
    assert_sound(mesh, domain)
    on_path = mesh.facets["line"][(mesh.facet_region["line"] == [0, 0]).all(axis=1)]
    assert sorted(map(sorted, on_path.tolist())) == [[4, 5], [5, 7], [6, 7]]


def test_crossing_segments_are_named_with_their_place() -> None:
    points = np.array([[0, 0], [1, 1], [0, 1], [1, 0.0]])
    with pytest.raises(MeshingError, match=r"common points only: edge from .* meets edge from"):
        ConstrainedDelaunay().generate(framed(points, np.array([[0, 1], [2, 3]])))


def test_repeated_points_are_named() -> None:
    points = np.array([[0.5, 0.5], [0.25, 0.5], [0.5, 0.5]])
    with pytest.raises(MeshingError, match=r"points 4 and 6 are both \(0.5, 0.5\)"):
        ConstrainedDelaunay().generate(framed(points))


def test_points_on_one_line_are_refused() -> None:
    line = Pslg.build(
        points=[[0, 0], [1, 0], [2, 0]],
        segments=[[0, 1], [1, 2]],
        segment_marker=[0, 0],
        segment_region=[[0, -1]] * 2,
        boundary_names=(("edge",),),
    )
    with pytest.raises(MeshingError, match="collinear"):
        ConstrainedDelaunay().generate(line)


def test_an_open_region_is_refused() -> None:
    good = square()
    leaky = Pslg.build(
        points=good.points,
        segments=good.segments[:3],
        segment_marker=[0] * 3,
        segment_region=[[0, -1]] * 3,
        boundary_names=(("edge",),),
    )
    with pytest.raises(MeshingError, match="closed"):
        ConstrainedDelaunay().generate(leaky)


def test_a_size_is_refused() -> None:
    with pytest.raises(InputError, match=r"size=0\.1"):
        ConstrainedDelaunay().generate(square(), size=0.1)


def test_progress_is_told() -> None:
    seen = []
    ConstrainedDelaunay().generate(square(), progress=lambda *what: seen.append(what))
    assert ("triangulate", 4, 4) in seen

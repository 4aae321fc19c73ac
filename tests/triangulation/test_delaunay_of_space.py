"""Delaunay tetrahedra of points, random and degenerate."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, Delaunay

import csgmesh as cm
from csgmesh import kernels
from csgmesh.errors import InputError

RNG = np.random.default_rng(12)


def directions(n: int) -> np.ndarray:
    v = RNG.normal(size=(n, 3))
    return v / np.sqrt((v * v).sum(axis=1))[:, None]


def grid(*counts: int) -> np.ndarray:
    return np.indices(counts).reshape(3, -1).T.astype(float)


def assert_delaunay(points: np.ndarray) -> cm.Mesh:
    mesh = cm.delaunay(points)
    certificate = cm.check(mesh)
    assert certificate.ok, str(certificate)
    assert certificate["Delaunay"].status == "passed"
    rows = mesh.cells["tetra"]
    assert (np.unique(rows) == np.arange(len(points))).all()
    for _ in range(5):
        others = RNG.integers(0, len(points), len(rows))
        assert (kernels.in_spheres(points, rows, others) <= 0).all()
    return mesh


def test_tetrahedra_and_hull_are_those_of_scipy() -> None:
    points = RNG.random((3000, 3))
    mesh = assert_delaunay(points)
    for mine, wanted in (
        (mesh.cells["tetra"], Delaunay(points).simplices),
        (mesh.facets["triangle"], ConvexHull(points).simplices),
    ):
        assert {tuple(sorted(r)) for r in mine.tolist()} == {
            tuple(sorted(r)) for r in wanted.tolist()
        }


@pytest.mark.parametrize(
    ("points", "volume"),
    [
        (grid(10, 10, 10), 729.0),
        (grid(10, 10, 10) / 7 + 0.1, 729 / 343),
        (grid(6, 5, 4) * 2.0**-30 + 1.0, 60 * 2.0**-90),
        (np.vstack([grid(5, 5, 5), grid(4, 4, 4) + 0.5]), 64.0),
        (np.vstack([directions(500), [[0, 0, 0]]]), None),
        (np.vstack([grid(8, 8, 1), [[3, 3, 1e-15]]]), 49e-15 / 3),
        (grid(6, 6, 6) * [1.0, 1e-9, 1e9], 125.0),
    ],
    ids=["grid", "sevenths", "tiny", "body-centred", "sphere", "nearly coplanar", "stretched"],
)
def test_degenerate_points_are_connected_without_gaps(
    points: np.ndarray, volume: float | None
) -> None:
    mesh = assert_delaunay(points)
    if volume is None:
        volume = ConvexHull(points).volume
    assert cm.quality(mesh).total_volume == pytest.approx(volume, rel=1e-9)


@given(st.integers(0, 10**6), st.integers(5, 60), st.sampled_from([2, 3, 5, 50]))
def test_no_sphere_holds_a_point(seed: int, n: int, sides: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.unique(rng.integers(0, sides, (n, 3)), axis=0).astype(float)
    if np.linalg.matrix_rank(points - points[0]) < 3:
        with pytest.raises(InputError, match=r"in one plane|need four points"):
            cm.delaunay(points)
        return
    assert_delaunay(points)


def test_a_promise_of_delaunay_is_held_to() -> None:
    cube = grid(2, 2, 2)
    cube[7] *= 1.2
    mesh = cm.delaunay(cube)
    moved = np.array(mesh.points)
    moved[7] = [0.8, 0.8, 0.8]
    failed = {f.rule for f in cm.check(cm.Mesh(**_parts(mesh, moved))).failures}
    assert "Delaunay" in failed


def _parts(mesh: cm.Mesh, points: np.ndarray) -> dict[str, object]:
    names = ("cells", "facets", "facet_marker", "facet_region", "boundary_names", "info")
    return {"points": points} | {name: getattr(mesh, name) for name in names}


def test_what_spans_no_volume_is_refused() -> None:
    with pytest.raises(InputError, match=r"points 2 and 5 are both \(0, 1, 0\)"):
        cm.delaunay([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [0, 1, 0]])
    with pytest.raises(InputError, match=r"points 0 and 3 are both \(0, 0, 0\)"):
        cm.delaunay([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]])
    with pytest.raises(InputError, match="all 25 points lie in one plane"):
        cm.delaunay(grid(5, 5, 1) @ [[1, 0, 1], [0, 1, 1], [0, 0, 1]])
    with pytest.raises(InputError, match="need four points; got 3"):
        cm.delaunay(np.eye(3))
    with pytest.raises(InputError, match=r"point 1 is \(0, inf, 0\)"):
        cm.delaunay([[0, 0, 0], [0, np.inf, 0], [1, 1, 1], [2, 0, 0]])
    with pytest.raises(InputError, match=r"\(n, 2\) or \(n, 3\); got \(2, 4\)"):
        cm.delaunay(np.zeros((2, 4)))

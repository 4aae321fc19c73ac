"""Meshes of the boundaries of solids: closed, on the exact surfaces, as fine as asked for."""

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.errors import BudgetError, SizeError
from csgmesh.meshers.surface import surface_mesh

BORED = cm.Box((-1, -1, -1), (1, 1, 1), name="plate") - cm.Cylinder(
    (0, 0, -2), (0, 0, 2), 0.5, name="bore"
)
SOLIDS = {
    "box": cm.Box((0, 0, 0), (2, 1, 1)),
    "ball": cm.Ball((0, 0, 0), 1),
    "ellipsoid": cm.Ellipsoid((0, 0, 0), (2, 1, 0.7)),
    "cylinder": cm.Cylinder((0, 0, 0), (0, 0, 2), 0.5),
    "torus": cm.Torus((0, 0, 0), (0, 0, 1), 1, 0.3),
    "bore": BORED,
    "box and ball": cm.Box((0, 0, 0), (2, 2, 2)) | cm.Ball((2, 2, 2), 0.8),
    "pipes": cm.Cylinder((0, 0, -2), (0, 0, 2), 0.5) | cm.Cylinder((0, 0, 0), (2, 0, 0), 0.3),
    "equal pipes": cm.Cylinder((0, 0, -2), (0, 0, 2), 0.5) | cm.Cylinder((0, 0, 0), (2, 0, 0), 0.5),
    "cavity": cm.Box((-1, -1, -1), (1, 1, 1)) - cm.Ball((0, 0, 0), 0.6),
}


def even(h):
    return lambda points: np.full(len(points), h)


def angles(points, triangles):
    """Smallest angle of each triangle in degrees."""
    p = points[triangles]
    out = np.full(len(p), 180.0)
    for i in range(3):
        u, v = p[:, (i + 1) % 3] - p[:, i], p[:, (i + 2) % 3] - p[:, i]
        cosine = (u * v).sum(1) / np.sqrt((u * u).sum(1) * (v * v).sum(1))
        out = np.minimum(out, np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    return out


def volume(mesh):
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


def assert_sound(mesh):
    """Closed, on the exact surfaces, with segments where faces meet."""
    edges = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    assert (count % 2 == 0).all()
    segments = np.unique(np.sort(mesh.segments, axis=1), axis=0)
    assert len(segments) == len(mesh.segments)
    many = unique[count > 2]
    both = np.concatenate([segments, many])
    assert len(np.unique(both, axis=0)) == len(segments)
    for k in range(3):
        on = mesh.face_surface[mesh.face]
        assert mesh.plc.surfaces.distance(on, mesh.points[mesh.triangles[:, k]]).max() < 1e-9
    assert len(np.unique(mesh.triangles)) == mesh.n_points
    everyone = np.arange(mesh.n_points)
    moved = mesh.project(everyone, mesh.points) - mesh.points
    assert np.abs(moved).max() < 1e-9


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("h", [0.3, 0.1])
def test_solids(name, h):
    plc = cm.evaluate(SOLIDS[name])
    mesh = surface_mesh(plc, even(h))
    assert_sound(mesh)
    assert angles(mesh.points, mesh.triangles).min() >= 25.0
    exact = cm.evaluate(SOLIDS[name], deviation=1e-4).volumes()[0]
    assert volume(mesh) == pytest.approx(exact, rel=0.1 if h > 0.2 else 0.02)
    assert set(mesh.face_marker) == set(plc.facet_marker)


def test_the_count_follows_the_size_and_not_the_facets():
    for name in ("ball", "pipes", "torus"):
        coarse, fine = (
            surface_mesh(cm.evaluate(SOLIDS[name], deviation=d), even(0.15)) for d in (5e-3, 5e-4)
        )
        assert coarse.n_points == pytest.approx(fine.n_points, rel=0.2)
    plc = cm.evaluate(SOLIDS["box"])
    counts = [surface_mesh(plc, even(h)).n_triangles for h in (0.2, 0.1)]
    assert counts[1] == pytest.approx(4 * counts[0], rel=0.2)


def test_sizes_vary_as_asked():
    plc = cm.evaluate(BORED)
    mesh = surface_mesh(plc, lambda p: 0.02 + 0.2 * np.linalg.norm(p - [1, 1, 1], axis=1))
    assert_sound(mesh)
    centre = mesh.points[mesh.triangles].mean(axis=1)
    edge = np.linalg.norm(
        mesh.points[mesh.triangles[:, 0]] - mesh.points[mesh.triangles[:, 1]], axis=1
    )
    wanted = 0.02 + 0.2 * np.linalg.norm(centre - [1, 1, 1], axis=1)
    assert 0.7 < np.median(edge / wanted) < 1.2
    assert (edge / wanted).max() < 2.5


def test_it_gives_the_same_bytes_every_time():
    plc = cm.evaluate(SOLIDS["pipes"])
    one, two = (surface_mesh(plc, even(0.15)) for _ in range(2))
    assert one.points.tobytes() == two.points.tobytes()
    assert one.triangles.tobytes() == two.triangles.tobytes()


def test_what_cannot_be_is_refused():
    plc = cm.evaluate(SOLIDS["box"])
    with pytest.raises(SizeError, match="positive and finite"):
        surface_mesh(plc, even(-1.0))
    with pytest.raises(BudgetError, match="max_points = 100"):
        surface_mesh(plc, even(0.05), max_points=100)


def test_a_union_of_many_balls_and_boxes_stays_closed():
    rng = np.random.default_rng(0)
    parts = []
    for k in range(30):
        c, d = rng.uniform(0, 3, 3), rng.uniform(0.3, 0.9, 3)
        parts.append(cm.Ball(c, d[0]) if k % 2 else cm.Box(c - d / 2, c + d / 2))
    plc = cm.evaluate(cm.union(parts))
    mesh = surface_mesh(plc, even(0.15))
    assert_sound(mesh)
    assert volume(mesh) == pytest.approx(plc.volumes()[0], rel=0.02)
    assert (angles(mesh.points, mesh.triangles) < 25.0).mean() < 0.005

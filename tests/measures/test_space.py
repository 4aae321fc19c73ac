"""Meshes of space: measures of cells, and mutations that the certificate must catch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import csgmesh as cm
from csgmesh.measures.space.jacobians import least_jacobians

UNIT = {
    "tetra": np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float),
    "hexahedron": np.array(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        float,
    ),
    "wedge": np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)], float),
    "pyramid": np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)], float),
}
VOLUME = {"tetra": 1 / 6, "hexahedron": 1.0, "wedge": 0.5, "pyramid": 1 / 3}
DIHEDRAL = {
    "tetra": (np.degrees(np.arccos(1 / np.sqrt(3))), 90.0),
    "hexahedron": (90.0, 90.0),
    "wedge": (45.0, 90.0),
    "pyramid": (np.degrees(np.arctan(2)), np.degrees(np.arccos(-0.2))),
}


def one(kind: str, points: np.ndarray) -> cm.Mesh:
    return cm.Mesh(points, {kind: [list(range(len(points)))]})


@pytest.mark.parametrize("kind", UNIT)
def test_volume_and_dihedral_angles(kind: str) -> None:
    turn = np.array(cm.csg.matrices.rotation(40, (1, 2, 3)))
    found = cm.quality(one(kind, 3.0 * UNIT[kind] @ turn.T + (5, 6, 7)))
    assert found.volume[0] == pytest.approx(27 * VOLUME[kind], rel=1e-13)
    assert found.min_dihedral[0] == pytest.approx(DIHEDRAL[kind][0], abs=1e-10)
    assert found.max_dihedral[0] == pytest.approx(DIHEDRAL[kind][1], abs=1e-10)
    assert found.min_jacobian[0] > 0.3


def test_the_scaled_jacobian_of_sheared_and_broken_hexahedra() -> None:
    points = UNIT["hexahedron"].copy()
    assert cm.quality(one("hexahedron", points)).scaled_jacobian[0] == pytest.approx(1.0)
    sheared = points + np.outer(points[:, 2], (1, 0, 0))
    assert cm.quality(one("hexahedron", sheared)).scaled_jacobian[0] == pytest.approx(0.5**0.5)
    points[6] = (0.1, 0.1, 0.1)
    assert cm.quality(one("hexahedron", points)).scaled_jacobian[0] < 0


def test_hexahedra_valid_at_their_corners_but_not_inside_are_found() -> None:
    rng = np.random.default_rng(5)
    n = 1000
    points = (UNIT["hexahedron"] + rng.uniform(-0.6, 0.6, (n, 8, 3))).reshape(-1, 3)
    rows = np.arange(8 * n).reshape(n, 8)
    fine_at_corners = cm.quality(cm.Mesh(points, {"hexahedron": rows})).scaled_jacobian > 0
    bound = least_jacobians(points, "hexahedron", rows)
    assert (fine_at_corners & (bound <= 0)).sum() > 0
    u = np.stack(np.meshgrid(*[np.linspace(0, 1, 7)] * 3), axis=3).reshape(-1, 3)
    sampled = np.array([_hexahedron_jacobians(p, u).min() for p in points.reshape(n, 8, 3)])
    assert (sampled[bound > 0] > 0).all()
    # What is refused is invalid, or so nearly that five halvings do not tell.
    assert (sampled[bound <= 0] < 0.05).all()


def _hexahedron_jacobians(points: np.ndarray, u: np.ndarray) -> np.ndarray:
    """By finite differences of the trilinear map, independent of the code under test."""

    def place(u: np.ndarray) -> np.ndarray:
        weights = np.prod(
            np.where(UNIT["hexahedron"][None] > 0, u[:, None], 1 - u[:, None]), axis=2
        )
        return weights @ points

    e = 1e-5
    columns = [(place(u + e * d) - place(u - e * d)) / (2 * e) for d in np.eye(3)]
    return np.linalg.det(np.stack(columns, axis=2))


@given(st.sampled_from(sorted(UNIT)), st.integers(0, 10_000))
def test_a_positive_bound_means_a_positive_volume(kind: str, seed: int) -> None:
    points = UNIT[kind] + np.random.default_rng(seed).uniform(-0.5, 0.5, UNIT[kind].shape)
    found = cm.quality(one(kind, points))
    if found.min_jacobian[0] > 0:
        assert found.volume[0] > 0
    turned = cm.quality(one(kind, points * (1, 1, -1)))
    assert turned.volume[0] == pytest.approx(-found.volume[0], abs=1e-12)
    assert not (turned.min_jacobian[0] > 0 and found.min_jacobian[0] > 0)


SHAPE = cm.Extrude(cm.Disk((0, 0), 1, name="rim") - cm.Box((-0.3, -0.3), (0.3, 0.3)), 0.5)


@pytest.fixture(scope="module")
def mesh() -> cm.Mesh:
    return cm.generate(SHAPE, cm.Sweep(), size=0.3)


def failed(mesh: cm.Mesh) -> set[str]:
    return {failure.rule for failure in cm.check(mesh).failures}


def test_the_certificate_reads_like_a_table(mesh: cm.Mesh) -> None:
    certificate = cm.check(mesh, SHAPE)
    assert certificate.ok, certificate
    assert "the mesh is valid" in str(certificate)
    assert certificate["samples"].count == 100_000


def with_cells(mesh: cm.Mesh, rows: np.ndarray, region: np.ndarray | None = None) -> cm.Mesh:
    regions = mesh.cell_region["wedge"][: len(rows)] if region is None else region
    return replace(
        mesh, cells={"wedge": rows}, cell_region={"wedge": regions}, cell_parent={}, cell_green={}
    )


def test_mutations_are_caught(mesh: cm.Mesh) -> None:
    wedges = np.array(mesh.cells["wedge"])
    turned = wedges.copy()
    turned[3] = turned[3, [0, 2, 1, 3, 5, 4]]
    assert "orientation" in failed(with_cells(mesh, turned))

    assert "facets" in failed(with_cells(mesh, np.delete(wedges, 5, axis=0)))

    twice = np.concatenate([wedges, wedges[:1]])
    region = np.zeros(len(twice), np.int64)
    assert "conforming" in failed(with_cells(mesh, twice, region))

    for name in ("extrude.side.rim", "extrude.side.box.left", "extrude.end"):
        points = np.array(mesh.points)
        moved = mesh.boundary_points(name)[0]
        points[moved] += (1e-6, 2e-6, 3e-6)
        assert "names" in failed(replace(mesh, points=points))

    marker = {k: np.array(v) for k, v in mesh.facet_marker.items()}
    marker["quad"][0] = marker["triangle"][0]
    assert "names" in failed(replace(mesh, facet_marker=marker))

    sides = {k: np.array(v) for k, v in mesh.facet_region.items()}
    sides["quad"][2] = (-1, 0)
    assert "facets" in failed(replace(mesh, facet_region=sides))

    kept = {k: v[1:] if k == "quad" else v for k, v in mesh.facets.items()}
    less = {
        field: {k: v[1:] if k == "quad" else v for k, v in getattr(mesh, field).items()}
        for field in ("facet_marker", "facet_region", "facet_curve", "facet_interval")
    }
    assert "facets" in failed(replace(mesh, facets=kept, **less))

    renamed = tuple(("lid",) if n == ("extrude.end",) else n for n in mesh.boundary_names)
    assert "names" in failed(replace(mesh, boundary_names=renamed))

    squeezed = np.array(mesh.points) * (1, 1, 0.9)
    assert failed(replace(mesh, points=squeezed)) >= {"names", "volume"}


def test_another_shape_is_not_this_mesh(mesh: cm.Mesh) -> None:
    other = SHAPE - cm.Box((0.5, -0.2, 0), (0.7, 0.2, 0.5))
    assert not cm.check(mesh, other).ok
    assert not cm.check(mesh, SHAPE.scale((1, 1, 1.2))).ok
    with pytest.raises(cm.InputError, match="the shape in the plane"):
        cm.check(mesh, cm.Disk((0, 0), 1))


def test_without_a_shape_or_domain_less_can_be_checked(mesh: cm.Mesh) -> None:
    assert cm.check(mesh).ok
    bare = cm.Mesh(mesh.points, mesh.cells, facets=mesh.facets, facet_region=mesh.facet_region)
    certificate = cm.check(bare)
    assert certificate.ok
    assert certificate["names"].status == "skipped"


@pytest.mark.parametrize("suffix", [".msh", ".vtu", ".npz", ".inp"])
def test_solid_meshes_survive_files_with_their_names(mesh: cm.Mesh, tmp_path, suffix: str) -> None:
    path = tmp_path / f"part{suffix}"
    cm.write(path, mesh)
    read = cm.read(path)
    assert set(read.names) == set(mesh.names)
    assert cm.check(read, SHAPE).ok
    for name in mesh.names:
        np.testing.assert_array_equal(
            np.unique(read.points[read.boundary_points(name)], axis=0),
            np.unique(mesh.points[mesh.boundary_points(name)], axis=0),
        )


def test_facets_are_added_to_files_that_have_none(tmp_path) -> None:
    import meshio

    cells = [("tetra", [[0, 1, 2, 3], [1, 2, 3, 4]])]
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
    meshio.write(tmp_path / "two.vtu", meshio.Mesh(np.array(points, float), cells))
    mesh = cm.read(tmp_path / "two.vtu")
    assert mesh.names == ("boundary",)
    assert mesh.n_facets == 6
    assert cm.check(mesh).ok


def test_pictures_show_the_side_that_faces_the_viewer(mesh: cm.Mesh) -> None:
    from matplotlib.collections import PolyCollection

    def polygons(**options: object) -> int:
        figure = cm.draw(mesh, **options)
        (shown,) = [c for c in figure.axes[0].collections if isinstance(c, PolyCollection)]
        return len(shown.get_paths())

    top = polygons(view=(0, 90))
    assert top == len(mesh.boundary("extrude.end")["triangle"])
    assert polygons(view=(0, 90), cut=((0, 0, 0), (1, 0, 0))) < top
    domain = cm.draw(cm.evaluate(SHAPE))
    assert "extrude.side.rim" in [t.get_text() for t in domain.axes[0].get_legend().get_texts()]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"view": 3}, "view must be two angles"),
        ({"cut": ((0, 0), (1, 0))}, "cut must be a point and a normal"),
        (
            {"color": "min_angle"},
            "the plane; here it is one of .region., .min_dihedral.",
        ),
    ],
)
def test_wrong_options_of_pictures(mesh: cm.Mesh, options: dict, message: str) -> None:
    with pytest.raises(cm.InputError, match=message):
        cm.draw(mesh, **options)


def test_space_options_of_plane_pictures_are_refused() -> None:
    with pytest.raises(cm.InputError, match="belongs to space"):
        cm.draw(cm.Disk((0, 0), 1), view=(0, 0))

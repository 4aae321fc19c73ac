"""Tetrahedra of solids, from the tree to the mesh: volumes, names, angles, sizes, errors."""

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.errors import BudgetError, DomainFileError, InputError, NameLookupError, SizeError

PI = np.pi
BOX = cm.Box((0, 0, 0), (2, 2, 2), name="plate")
BALL = cm.Ball((0.7, 0.7, 0.7), 0.4, name="ball")
BORE = cm.Cylinder((1.4, 1.4, -1), (1.4, 1.4, 3), 0.3, name="bore")
SOLID = BOX - BALL - BORE

#: Solid, exact volume, size.
SOLIDS = {
    "box, ball, bore": (SOLID, 8 - 4 / 3 * PI * 0.4**3 - 2 * PI * 0.09, 0.2),
    "ball": (cm.Ball((1, 2, 3), 1), 4 / 3 * PI, None),
    "cone": (cm.Cone((0, 0, 0), (0, 0, 2), 1), 2 / 3 * PI, 0.3),
    "torus": (cm.Torus((0, 0, 0), (1, 1, 1), 2, 0.5), PI**2, None),
    "cavity": (BOX - cm.Ball((1, 1, 1), 0.5), 8 - PI / 6, 0.3),
    "touching balls": (cm.Ball((0, 0, 0), 1) | cm.Ball((2, 0, 0), 1), 8 / 3 * PI, None),
    "ball on a face": (BOX | cm.Ball((1, 1, 3), 1), 8 + 4 / 3 * PI, None),
    "ball below a face": (BOX - cm.Ball((1, 1, 1), 1), 8 - 4 / 3 * PI, None),
    "tangent cylinders": (
        cm.Cylinder((0, 0, 0), (0, 0, 1), 1) | cm.Cylinder((2, 0, 0), (2, 0, 1), 1),
        2 * PI,
        None,
    ),
    "part of a face": (BOX | cm.Box((2, 1, 0), (4, 3, 2)), 16.0, 0.5),
    "shared edge": (BOX | cm.Box((2, 2, 0), (4, 4, 2)), 16.0, 0.5),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_meshes_fill_the_solid_and_pass_the_certificate(name):
    solid, volume, size = SOLIDS[name]
    mesh = cm.generate(solid, size=size)
    assert list(mesh.cells) == ["tetra"]
    certificate = cm.check(mesh, solid)
    assert certificate.ok, certificate.failures
    domain = cm.evaluate(solid)
    assert mesh.names == domain.names
    quality = cm.quality(mesh)
    # Facets lie within the deviation of the exact surface.
    slack = 2 * domain.deviation * domain.facet_areas().sum() + 1e-9
    assert abs(quality.total_volume - volume) <= slack
    # Between a ball and the faces that it touches from within, angles go down to zero.
    assert name == "ball below a face" or np.min(quality.min_dihedral) >= 12


def test_edges_are_as_long_as_the_size_asks_for():
    mesh = cm.generate(SOLID, size=0.12)
    tets = mesh.cells["tetra"]
    edges = np.concatenate([tets[:, [a, b]] for a in range(4) for b in range(a)])
    edges = np.unique(np.sort(edges, axis=1), axis=0)
    length = np.sqrt(((mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]]) ** 2).sum(axis=1))
    share = length / 0.12
    assert abs(share.mean() - 1) < 0.1
    assert np.mean((share > 0.6) & (share < 1.6)) > 0.97


def test_sizes_by_name_make_a_surface_finer():
    mesh = cm.generate(SOLID, size={"ball": 0.05, "default": 0.3})
    assert cm.check(mesh, SOLID).ok

    def mean_edge(name):
        a, b, _ = mesh.facets["triangle"][mesh.boundary(name)["triangle"]].T
        return np.sqrt(((mesh.points[a] - mesh.points[b]) ** 2).sum(axis=1)).mean()

    assert 0.035 < mean_edge("ball") < 0.065
    assert mean_edge("plate.top") > 0.12


def test_two_materials_share_their_interface():
    regions = cm.Regions({"soft": BOX, "hard": cm.Ball((1, 1, 1), 0.6, name="ball")})
    mesh = cm.generate(regions, size=0.25)
    assert cm.check(mesh, regions).ok
    assert mesh.region_names == ("soft", "hard")
    volume = cm.quality(mesh).volume
    hard = volume[mesh.cell_region["tetra"] == 1].sum()
    assert abs(hard / (4 / 3 * PI * 0.6**3) - 1) < 0.02
    assert len(mesh.interface("soft", "hard")["triangle"])


def test_the_same_input_gives_the_same_bytes():
    meshes = [cm.generate(SOLID, cm.Octree(), {"bore": 0.08, "default": 0.3}) for _ in range(2)]
    for get in (lambda m: m.points, lambda m: m.cells["tetra"], lambda m: m.facets["triangle"]):
        assert get(meshes[0]).tobytes() == get(meshes[1]).tobytes()


def test_domain_files_choose_the_octree(tmp_path):
    path = tmp_path / "part.yaml"
    text = """csgmesh: 1
shapes:
  part: {difference: [{box: {lo: [0, 0, 0], hi: [1, 1, 1]}},
                      {ball: {center: [0.5, 0.5, 0.5], radius: 0.3, name: void}}]}
domain: part
mesh: {octree: {cells: tetra}, size: {default: 0.3, part.void: 0.1}}
"""
    path.write_text(text)
    file = cm.load(path)
    assert isinstance(file.mesher, cm.Octree)
    assert "tetra" in file.generate().cells
    path.write_text(text.replace("octree: {cells: tetra}, ", ""))
    assert "tetra" in cm.load(path).generate().cells
    path.write_text(text.replace("tetra", "cubes"))
    with pytest.raises(DomainFileError, match=r"part.yaml:6:.*cells"):
        cm.load(path).generate()


def test_errors_state_the_rule_the_value_and_the_place():
    with pytest.raises(InputError, match=r"'tetra'.*'hexahedron'.*got 'cubes'"):
        cm.Octree(cells="cubes")
    with pytest.raises(InputError, match="gradation must be positive"):
        cm.Octree(gradation=0)
    with pytest.raises(SizeError, match="got 0"):
        cm.generate(SOLID, size=0)
    with pytest.raises(SizeError, match=r"positive and finite; got nan at \("):
        cm.generate(SOLID, size=lambda p: np.where(p[:, 0] > 1, np.nan, 0.3))
    with pytest.raises(NameLookupError, match=r"did you mean 'bore\.side'"):
        cm.generate(SOLID, size={"bor": 0.1})
    with pytest.raises(BudgetError, match=r"about .* points, max_points allows 1,000"):
        cm.generate(SOLID, cm.Octree(max_points=1000), size=0.02)
    with pytest.raises(InputError, match="Octree meshes domains in space; this one lies in the p"):
        cm.generate(cm.Box((0, 0), (1, 1)), cm.Octree())


def test_hexahedra_by_the_same_mesher() -> None:
    plate = cm.Box((0, 0, 0), (2, 2, 0.5), name="plate") - cm.Cylinder(
        (1, 1, -1), (1, 1, 1), 0.4, name="bore"
    )
    mesh = cm.generate(plate, cm.Octree(cells="hexahedron"), size={"bore": 0.2, "default": 0.3})
    assert list(mesh.cells) == ["hexahedron"]
    certificate = cm.check(mesh, plate)
    assert certificate.ok, certificate
    quality = cm.quality(mesh)
    assert quality.scaled_jacobian.min() > 0.5
    # The smallest size holds everywhere.
    assert 0.15 < np.median(quality.max_edge) < 0.3
    with pytest.raises(cm.SizeError):
        cm.generate(plate, cm.Octree(cells="hexahedron"), size=0)


def test_a_size_along_a_part_is_asked_for_there_alone() -> None:
    part = cm.Box((0, 0, 0), (2, 1, 1)) | cm.Cylinder((1, 0.5, 1), (1, 0.5, 2), 0.3, name="knob")
    mesh = cm.generate(
        part, cm.Octree(), {"default": 0.4, "knob.*": lambda p: 0.2 * (p[:, 2] - 0.5)}
    )
    assert cm.check(mesh, part).ok

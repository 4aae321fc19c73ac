"""Meshes of space in scikit-fem: names, orientation, and the heat equation at the right order.

A pipe is heated through its bore and cooled at its rim: u = ln(2 / r), so that the flux through the
bore, at r = 1, is 1.
"""

from __future__ import annotations

import numpy as np
import pytest
import skfem
from skfem.models.poisson import laplace

import csgmesh as cm
from csgmesh.mesh.solid_location import tetrahedra_of

PIPE = cm.Extrude(
    cm.Disk((0, 0), 2, name="rim") - cm.Disk((0, 0), 1, name="bore"), 0.5, name="pipe"
)
ELEMENTS = {
    "MeshHex1": skfem.ElementHex1,
    "MeshTet1": skfem.ElementTetP1,
    "MeshTet2": skfem.ElementTetP2,
}


def hexahedra() -> cm.Mesh:
    return cm.generate(PIPE, cm.Sweep(cm.QuadPairing(), layers=1), size=0.7)


def tetrahedra() -> cm.Mesh:
    """The wedges of a sweep cut along the diagonals through their faces' lowest corners."""
    mesh = cm.generate(PIPE, cm.Sweep(layers=1), size=0.7)
    facets, marker = [mesh.facets["triangle"]], [mesh.facet_marker["triangle"]]
    quads = mesh.facets["quad"]
    turn = (quads.argmin(axis=1)[:, None] + np.arange(4)) % 4
    quads = np.take_along_axis(quads, turn, axis=1)
    for half in ([0, 1, 2], [0, 2, 3]):
        facets.append(quads[:, half])
        marker.append(mesh.facet_marker["quad"])
    rows = np.concatenate(facets)
    return cm.Mesh(
        mesh.points,
        {"tetra": tetrahedra_of(mesh.cells)[0]},
        region_names=mesh.region_names,
        facets={"triangle": rows},
        facet_marker={"triangle": np.concatenate(marker)},
        boundary_names=mesh.boundary_names,
        facet_region={"triangle": np.tile([0, -1], (len(rows), 1))},
        domain=mesh.domain,
    )


def element_of(solid) -> object:
    return ELEMENTS[type(solid).__name__]()


def heat(mesh: cm.Mesh) -> tuple[float, float]:
    """Errors of the temperature and of its gradient, in the mean square."""
    solid = cm.to_skfem(mesh)
    basis = skfem.Basis(solid, element_of(solid), intorder=5)
    bore = skfem.FacetBasis(solid, element_of(solid), facets="pipe.side.bore", intorder=5)
    conduct = laplace.assemble(basis)
    heated = skfem.LinearForm(lambda v, w: v).assemble(bore)
    cold = basis.get_dofs("pipe.side.rim")
    u = skfem.solve(*skfem.condense(conduct, heated, D=cold))

    def off(w) -> np.ndarray:
        return (w["u"] - np.log(2 / np.hypot(w.x[0], w.x[1]))) ** 2

    def slope(w) -> np.ndarray:
        r2 = w.x[0] ** 2 + w.x[1] ** 2
        exact = -w.x[0] / r2, -w.x[1] / r2, 0 * r2
        return sum((w["u"].grad[k] - exact[k]) ** 2 for k in range(3))

    found = basis.interpolate(u)
    return tuple(float(np.sqrt(skfem.Functional(f).assemble(basis, u=found))) for f in (off, slope))


@pytest.mark.parametrize("make", [hexahedra, tetrahedra])
def test_heat_converges_at_second_order(make) -> None:
    mesh, errors = make(), []
    for _ in range(2):
        assert cm.check(mesh).ok
        errors.append(heat(mesh))
        mesh = cm.refine(mesh)
    value, slope = np.log2(np.array(errors[:-1]) / errors[1:])[-1]
    assert value > 1.7
    assert slope > 0.85


def test_heat_converges_at_third_order_on_curved_tetrahedra() -> None:
    mesh, errors = tetrahedra(), []
    for _ in range(2):
        errors.append(heat(cm.elevate(mesh)))
        mesh = cm.refine(mesh)
    value, slope = np.log2(np.array(errors[0]) / errors[1])
    assert value > 2.7
    assert slope > 1.7


@pytest.mark.parametrize("make", [hexahedra, tetrahedra, lambda: cm.elevate(tetrahedra())])
def test_names_areas_and_normals_arrive(make) -> None:
    mesh = make()
    solid = cm.to_skfem(mesh)
    assert set(solid.boundaries) == set(mesh.names)
    assert solid.subdomains["domain"].tolist() == list(range(mesh.n_cells))
    total = 0.0
    for name in mesh.names:
        basis = skfem.FacetBasis(solid, element_of(solid), facets=name, intorder=4)
        # By Gauss' theorem, with normals that point outward.
        total += skfem.Functional(lambda w: (w.n * w.x).sum(axis=0) / 3).assemble(basis)
        r = {"pipe.side.bore": 1.0, "pipe.side.rim": 2.0}.get(name)
        if r is not None:
            area = skfem.Functional(lambda w: 1.0 + 0 * w.x[0]).assemble(basis)
            assert area == pytest.approx(np.pi * r, rel=0.05)
    assert total == pytest.approx(cm.quality(mesh).total_volume, rel=1e-12)


def test_interfaces_are_oriented_out_of_their_first_region() -> None:
    mesh = cm.Mesh(
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)],
        {"tetra": [[0, 1, 2, 3], [1, 2, 3, 4]]},
        {"tetra": [0, 1]},
        ["rock", "core"],
        facets={"triangle": [[1, 2, 3]]},
        facet_marker={"triangle": [0]},
        boundary_names=[["seam"]],
        facet_region={"triangle": [[0, 1]]},
    )
    for turned in (False, True):
        if turned:
            mesh = cm.Mesh(
                mesh.points,
                mesh.cells,
                mesh.cell_region,
                mesh.region_names,
                facets={"triangle": [[1, 3, 2]]},
                facet_marker=mesh.facet_marker,
                boundary_names=mesh.boundary_names,
                facet_region={"triangle": [[1, 0]]},
            )
        solid = cm.to_skfem(mesh)
        basis = skfem.FacetBasis(solid, skfem.ElementTetP1(), facets="seam")
        flux = skfem.Functional(lambda w: w.n.sum(axis=0)).assemble(basis)
        # The seam's area is sqrt(3) / 2; the sum of its unit normal's parts is sqrt(3) either way.
        assert flux == pytest.approx(-1.5 if turned else 1.5)
        assert {k: v.tolist() for k, v in solid.subdomains.items()} == {"rock": [0], "core": [1]}


def test_cells_that_scikit_fem_does_not_have_are_refused() -> None:
    wedges = cm.generate(PIPE, cm.Sweep(), size=0.7)
    with pytest.raises(cm.InputError, match=r"to_skfem needs cells of one kind .*\['wedge'\]"):
        cm.to_skfem(wedges)

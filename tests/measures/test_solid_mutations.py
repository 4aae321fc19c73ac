"""Whatever one thing is changed in a right mesh of space, the certificate sees it."""

from __future__ import annotations

import numpy as np
import pytest
from solid_mutations import CURVED_MUTATIONS, MUTATIONS

import csgmesh as cm
from csgmesh.measures.space.certificate import check_space
from csgmesh.mesh.faces import faces_of
from csgmesh.mesh.solid_location import tetrahedra_of

N_MUTATIONS = 200

#: Two materials side by side, with coplanar faces of different names.
BLOCKS = cm.Regions(
    {
        "rock": cm.Box((0, 0, 0), (1, 1, 1), name="a"),
        "core": cm.Box((1, 0, 0), (2, 1, 1), name="b"),
    }
)
ROD = cm.Cylinder((0, 0, 0), (0, 0, 1), 0.5, name="rod")


def blocks() -> cm.Mesh:
    """Hexahedra of a box, half of them of either material."""
    whole = cm.Box((0, 0, 0), (2, 1, 1))
    mesh = cm.generate(whole, cm.Sweep(cm.Structured(), layers=3), size=1 / 3)
    plc = cm.evaluate(BLOCKS)
    rows = mesh.cells["hexahedron"]
    side = (mesh.points[rows].mean(axis=1)[:, 0] > 1).astype(np.int64)
    faces = faces_of(mesh.cells)
    region = np.append(side, -1)
    sides = np.column_stack([region[faces.behind], region[faces.ahead]])
    at = np.flatnonzero(sides[:, 0] != sides[:, 1])
    corners, sides = faces.points[at], sides[at]
    turn = (sides[:, 0] < 0) | ((sides[:, 1] >= 0) & (sides[:, 1] < sides[:, 0]))
    corners[turn], sides[turn] = corners[turn][:, ::-1], sides[turn][:, ::-1]
    return cm.Mesh(
        mesh.points,
        mesh.cells,
        {"hexahedron": side},
        plc.region_names,
        facets={"quad": corners},
        facet_marker={"quad": _markers(plc, mesh.points[corners], sides)},
        boundary_names=plc.boundary_names,
        facet_region={"quad": sides},
        domain=plc,
    )


def _markers(plc, corners: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Marker of the flat face of the domain that each facet lies on, between its regions."""
    out = np.full(len(corners), -1)
    for m in range(len(plc.boundary_names)):
        own = np.flatnonzero(plc.facet_marker == m)
        surface, region = plc.facet_surface[own[0]], plc.facet_region[own[0]]
        off = plc.surfaces.distance(np.full(4 * len(corners), surface), corners.reshape(-1, 3))
        on = (off.reshape(-1, 4) < 1e-12).all(axis=1)
        out[on & (np.sort(sides, axis=1) == np.sort(region)).all(axis=1)] = m
    return out


def rod(size: float = 0.35, layers: int = 3) -> cm.Mesh:
    """Tetrahedra of a cylinder, from the wedges of a sweep."""
    mesh = cm.generate(ROD, cm.Sweep(layers=layers), size=size)
    quads = mesh.facets["quad"]
    turn = (quads.argmin(axis=1)[:, None] + np.arange(4)) % 4
    quads = np.take_along_axis(quads, turn, axis=1)
    rows = np.concatenate([mesh.facets["triangle"], quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    marker = np.concatenate([mesh.facet_marker["triangle"], *[mesh.facet_marker["quad"]] * 2])
    return cm.Mesh(
        mesh.points,
        {"tetra": tetrahedra_of(mesh.cells)[0]},
        region_names=mesh.region_names,
        facets={"triangle": rows},
        facet_marker={"triangle": marker},
        boundary_names=mesh.boundary_names,
        facet_region={"triangle": np.tile([0, -1], (len(rows), 1))},
        domain=mesh.domain,
    )


def curved() -> cm.Mesh:
    return cm.elevate(rod(0.6, 2))


@pytest.mark.parametrize(
    ("make", "shape", "mutations"),
    [
        (blocks, BLOCKS, MUTATIONS),
        (rod, ROD, MUTATIONS),
        (curved, ROD, MUTATIONS + CURVED_MUTATIONS * 4),
    ],
)
def test_every_mutation_is_caught(make, shape, mutations) -> None:
    mesh, reference = make(), cm.evaluate(shape)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, certificate
    missed = []
    for seed in range(N_MUTATIONS // 2):
        mutation = mutations[seed % len(mutations)]
        try:
            spoiled = mutation(np.random.default_rng(seed), mesh)
        except cm.InputError:  # caught by Mesh itself
            continue
        if check_space(spoiled, reference).ok:
            missed.append(f"{mutation.__name__} with seed {seed}")
    assert not missed

"""Hessians are recovered, errors estimated, and sizes made for them."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementTriP1, Functional

import csgmesh as cm
from csgmesh.errors import SizeError
from csgmesh.size.background import cell_edges
from csgmesh.size.gradation import steepest
from csgmesh.size.recovery import cell_errors, recovered_hessians, total_error

DISK = cm.Disk((0, 0), 1)


def bend(x, y):
    return x**2 - 3 * x * y + 0.5 * y**2 + x - 2


def test_quadratics_are_recovered_exactly_up_to_the_boundary():
    mesh = cm.generate(DISK, size=0.2)
    found = recovered_hessians(mesh, bend(*mesh.points.T))
    np.testing.assert_allclose(found, np.tile([2.0, -3.0, 1.0], (mesh.n_points, 1)), atol=1e-7)


def test_errors_of_quadratics_are_exact():
    mesh = cm.generate(DISK, size=0.3)
    u = bend(*mesh.points.T)
    basis = Basis(cm.to_skfem(mesh), ElementTriP1(), intorder=6)
    square = Functional(lambda w: (w["u"] - bend(*w.x)) ** 2)
    slope = Functional(
        lambda w: (
            (w["u"].grad[0] - 2 * w.x[0] + 3 * w.x[1] - 1) ** 2
            + (w["u"].grad[1] + 3 * w.x[0] - w.x[1]) ** 2
        )
    )
    hessians = recovered_hessians(mesh, u)
    for norm, form in (("L2", square), ("H1", slope)):
        exact = np.sqrt(form.elemental(basis, u=u))
        np.testing.assert_allclose(cell_errors(mesh, hessians, norm), exact, rtol=1e-6)


@pytest.mark.parametrize(("norm", "order"), [("L2", 2), ("H1", 1), ("max", 2)])
def test_the_error_asked_for_comes_out(norm, order):
    def bump(points):
        return np.exp(-30 * ((points - (0.2, 0.1)) ** 2).sum(axis=1))

    mesh = cm.generate(DISK, size=0.05)
    cells = []
    for error in (4e-3, 1e-3) if norm != "H1" else (0.2, 0.1):
        size = cm.HessianSize(mesh, bump(mesh.points), error=error, norm=norm)
        adapted = cm.generate(DISK, size=size)
        values = bump(adapted.points)
        found = total_error(cell_errors(adapted, recovered_hessians(adapted, values), norm), norm)
        # The largest error of all cells depends on the worst of them.
        assert 0.6 < found / error < (1.8 if norm == "max" else 1.25)
        cells.append(adapted.n_cells)
    ratio = 4 if norm != "H1" else 2
    assert cells[1] / cells[0] == pytest.approx(ratio ** (2 / order), rel=0.35)


def test_bounds_and_gradation_hold():
    mesh = cm.generate(DISK, size=0.1)
    u = np.tanh(20 * mesh.points[:, 0])
    size = cm.HessianSize(mesh, u, cells=5000, lo=0.02, hi=0.1, gradation=0.2)
    assert size.sizes.min() >= 0.02
    assert size.sizes.max() <= 0.1
    assert steepest(mesh.points, cell_edges(mesh)[0], size.sizes) <= 0.2 * (1 + 1e-9)
    wide = cm.HessianSize(mesh, u, cells=5000, gradation=1.0)
    assert wide.sizes.min() < 0.02


def test_flat_solutions_get_coarse_meshes():
    mesh = cm.generate(DISK, size=0.2)
    flat = cm.HessianSize(mesh, mesh.points @ [1.0, 2.0], error=1e-3, hi=0.5)
    assert flat.sizes.min() == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "either the error or the cells"),
        ({"error": 1, "cells": 1}, "not both"),
        ({"error": -1}, "error must be positive"),
        ({"values": [1, 2]}, "one finite number a point"),
        ({"mesh": 3}, "needs a mesh of triangles; got int"),
    ],
)
def test_bad_arguments_are_refused(arguments, message):
    mesh = cm.generate(DISK, size=0.5)
    given = {"mesh": mesh, "values": np.zeros(mesh.n_points), **arguments}
    with pytest.raises(SizeError, match=message):
        cm.HessianSize(**given)

"""Adapted meshes reach optimal orders, keep names, and count what they promise."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementTriP1, Functional, condense, solve
from skfem.models.poisson import laplace

import csgmesh as cm
from csgmesh.errors import InputError, SizeError

L_SHAPE = cm.Box((-1, -1), (1, 1), name="wall") - cm.Box((0, -1), (1, 0), name="notch")


def exact(x, y):
    """r^(2/3) sin(2 t / 3), harmonic and 0 on the notch; its gradient is singular in the corner."""
    t = np.mod(np.arctan2(y, x) + 1e-14, 2 * np.pi)
    return np.hypot(x, y) ** (2 / 3) * np.sin(2 * t / 3)


def gradient(x, y):
    r, t = np.hypot(x, y), np.mod(np.arctan2(y, x), 2 * np.pi)
    along, across = (2 / 3 * r ** (-1 / 3) * f(2 * t / 3) for f in (np.sin, np.cos))
    return along * np.cos(t) - across * np.sin(t), along * np.sin(t) + across * np.cos(t)


def poisson(mesh):
    basis = Basis(cm.to_skfem(mesh), ElementTriP1())
    u = exact(*mesh.points.T)
    held = basis.get_dofs().flatten()
    return solve(*condense(laplace.assemble(basis), np.zeros(len(u)), x=u, D=held))


def true_errors(mesh, u):
    basis = Basis(cm.to_skfem(mesh), ElementTriP1(), intorder=6)
    value = Functional(lambda w: (w["u"] - exact(*w.x)) ** 2)
    slope = Functional(lambda w: sum((w["u"].grad[i] - gradient(*w.x)[i]) ** 2 for i in (0, 1)))
    return [np.sqrt(f.assemble(basis, u=u)) for f in (value, slope)]


@pytest.mark.parametrize("norm", ["L2", "H1"])
def test_optimal_orders_on_the_l_shape(norm):
    rows = []
    for cells in (1000, 8000):
        found = cm.adapt(L_SHAPE, poisson, size=0.2, cells=cells, norm=norm)
        assert found.reached
        assert abs(found.mesh.n_cells - cells) < 0.1 * cells
        rows.append([found.mesh.n_points, *true_errors(found.mesh, found.values)])
    points, square, slope = np.log(rows).T
    # A uniform mesh has -2/3 and -1/3.
    assert np.polyfit(points, square, 1)[0] == pytest.approx(-1, abs=0.1)
    assert np.polyfit(points, slope, 1)[0] == pytest.approx(-0.5, abs=0.05)
    if norm == "H1":
        assert found.steps[-1].error == pytest.approx(np.exp(slope[-1]), rel=0.05)
    assert cm.check(found.mesh, L_SHAPE).ok
    assert {"wall.left", "notch.left", "notch.top"} <= set(found.mesh.names)


def layer(mesh):
    return np.tanh(30 * (np.hypot(*mesh.points.T) - 0.5))


def test_an_error_is_reached_with_few_cells():
    square = cm.Box((0, 0), (1, 1))
    found = cm.adapt(square, layer, size=0.1, error=2e-3)
    assert found.reached
    assert found.steps[-1].error <= 2e-3 < found.steps[-2].error
    assert found.steps[-1].error > 1e-3
    assert [s.cells for s in found.steps] == sorted(s.cells for s in found.steps)
    text = str(found)
    assert len(text.splitlines()) == len(found.steps) + 1
    assert "L2 error" in text
    too_few = cm.adapt(square, layer, size=0.1, error=1e-9, cells=1000)
    assert not too_few.reached
    assert too_few.mesh.n_cells < 1200


def test_the_last_solution_is_the_start_of_the_next():
    started = []

    def solver(mesh, start=None):
        if start is not None:
            started.append(np.abs(start - (mesh.points @ [2.0, 1.0])).max())
        return mesh.points @ [2.0, 1.0] + 1e-3 * mesh.points[:, 0] ** 2

    found = cm.adapt(cm.Disk((0, 0), 1), solver, size=0.5, cells=600)
    assert len(started) == len(found.steps) - 1 > 0
    assert max(started) < 0.05


def test_marked_cells_are_refined_and_names_kept():
    def jumps(mesh, u):
        basis = Basis(cm.to_skfem(mesh), ElementTriP1(), intorder=4)
        slope = Functional(lambda w: sum((w["u"].grad[i] - gradient(*w.x)[i]) ** 2 for i in (0, 1)))
        return np.sqrt(slope.elemental(basis, u=u))

    found = cm.adapt(L_SHAPE, poisson, size=0.3, cells=3000, norm="H1", indicator=jumps, steps=40)
    assert found.reached
    assert cm.check(found.mesh, L_SHAPE).ok
    assert {"wall.left", "notch.left"} <= set(found.mesh.names)
    rows = [(step.points, step.error) for step in found.steps if step.points > 200]
    assert np.polyfit(*np.log(rows).T, 1)[0] == pytest.approx(-0.5, abs=0.08)
    corner = np.hypot(*found.mesh.points.T)
    assert np.sort(corner)[1] < 0.005


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "the error wanted, the cells"),
        ({"cells": 0}, "cells must be positive; got 0"),
        ({"cells": 10, "norm": "L1"}, "norm must be one of"),
        ({"cells": 10, "share": 2}, "share must be between 0 and 1"),
        ({"cells": 10, "indicator": lambda m, u: u}, "one error a cell"),
    ],
)
def test_bad_arguments_are_refused(arguments, message):
    with pytest.raises(InputError, match=message):
        cm.adapt(cm.Box((0, 0), (1, 1)), layer, size=0.5, **arguments)


def test_a_solution_must_fit_its_mesh():
    with pytest.raises(SizeError, match="one finite number a point"):
        cm.adapt(cm.Box((0, 0), (1, 1)), lambda mesh: np.zeros(3), size=0.5, cells=100)

"""Poisson on an L, u = r^(2/3) sin(2 t / 3): adapted meshes regain the order the corner costs."""

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP1, Functional, condense, solve
from skfem.models.poisson import laplace

import csgmesh as cm

shape = cm.Box((-1, -1), (1, 1), name="wall") - cm.Box((0, -1), (1, 0), name="notch")


def exact(x, y):
    return np.hypot(x, y) ** (2 / 3) * np.sin(np.mod(np.arctan2(y, x) + 1e-14, 2 * np.pi) / 1.5)


def poisson(mesh):
    basis = Basis(cm.to_skfem(mesh), ElementTriP1())
    u = exact(*mesh.points.T)
    return solve(*condense(laplace.assemble(basis), 0 * u, x=u, D=basis.get_dofs(set(mesh.names))))


def error(mesh, u):
    basis = Basis(cm.to_skfem(mesh), ElementTriP1(), intorder=6)
    return np.sqrt(Functional(lambda w: (w["u"] - exact(*w.x)) ** 2).assemble(basis, u=u))


runs = [cm.adapt(shape, poisson, size=0.2, cells=n, norm="H1") for n in (2000, 8000, 32000)]
even = [cm.generate(shape, size=h) for h in (0.07, 0.035, 0.0175)]
print(str(runs[-1]))
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.6), layout="constrained")
cm.draw(runs[1].mesh, ax=left, legend=False)
for label, meshes in (("adapted", [r.mesh for r in runs]), ("uniform", even)):
    rows = np.array([(m.n_points, error(m, poisson(m))) for m in meshes])
    order = np.polyfit(*np.log(rows.T), 1)[0]
    right.loglog(*rows.T, "o-", label=f"{label}, order {order:.2f}")
    print(f"{label}: order {order:.2f}")
right.legend(title="L² error beside unknowns")
figure.savefig("adaptive_corner.png", dpi=110)

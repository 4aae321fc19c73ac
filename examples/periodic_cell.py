"""Heat through a periodic array of grains: what conductivity it has as a whole.

One cell of the array, whose sides cut through the grains. The temperature is x plus something
periodic; its flux has the mean that one conductivity for all would give. Rayleigh (1892) has the
exact number as a series, here as shortened by Perrins, McKenzie and McPhedran (1979).
"""

import numpy as np
from scipy.sparse import csr_matrix
from skfem import Basis, BilinearForm, ElementTriP1, LinearForm, solve
from skfem.helpers import dot, grad

import csgmesh as cm

RADIUS, GRAIN = 0.35, 50.0

cell = cm.Box((0, 0), (1, 1), name="cell")
grains = cm.union(cm.Disk((x, y), RADIUS, name="grain") for x in (0, 1) for y in (0, 1))
materials = cm.Regions({"matrix": cell, "grains": grains & cell})
array = cm.Periodic(materials, [("cell.left", "cell.right"), ("cell.bottom", "cell.top")])
mesh = cm.generate(
    array, cm.DelaunayRefinement(improve=True), size={"grain": 0.01, "default": 0.04}
)
print(cm.check(mesh, array)["periodic sides"])

basis = Basis(cm.to_skfem(mesh), ElementTriP1())
conductivity = np.array([1.0, GRAIN])[mesh.cell_region["triangle"]][:, None]
flux = BilinearForm(lambda u, v, w: w.k * dot(grad(u), grad(v))).assemble(basis, k=conductivity)
drive = LinearForm(lambda v, w: -w.k * grad(v)[0]).assemble(basis, k=conductivity)

# All points that periodicity identifies share one unknown.
kept, unknown = np.unique(mesh.periodic_representatives(), return_inverse=True)
join = csr_matrix((np.ones(len(unknown)), (np.arange(len(unknown)), unknown)))
wave = join[:, 1:] @ solve(join[:, 1:].T @ flux @ join[:, 1:], join[:, 1:].T @ drive)
u = mesh.points[:, 0] + wave

f, t = np.pi * RADIUS**2, (1 + GRAIN) / (1 - GRAIN)
series = t + f - 0.305827 * f**4 * t / (t**2 - 1.402958 * f**8) - 0.013362 * f**8 / t
print(f"conductivity {u @ flux @ u:.4f}, by Rayleigh's series {1 - 2 * f / series:.4f}")
cm.draw(mesh, "periodic_cell.png")

"""Poisson's equation on a quarter of a ring: boundary conditions by name, and the true error.

-Δu = 4, u = 0 on shaft and housing, no flow through the planes of symmetry. Exactly,
u = 1 - r² + 3 log₂ r.
"""

import numpy as np
from skfem import Basis, ElementTriP1, Functional, condense, solve
from skfem.models.poisson import laplace, unit_load
from skfem.visuals.matplotlib import plot

import csgmesh as cm

ring = cm.Disk((0, 0), 2, name="housing") - cm.Disk((0, 0), 1, name="shaft")
quarter = ring & cm.HalfSpace((0, 0), (-1, 0)) & cm.HalfSpace((0, 0), (0, -1))


@Functional
def squared_error(w):
    r = np.hypot(*w.x)
    return (w.u - (1 - r**2 + 3 * np.log2(r))) ** 2


previous = None
for h in (0.2, 0.1, 0.05, 0.025):
    basis = Basis(cm.to_skfem(cm.generate(quarter, size=h)), ElementTriP1())
    held = basis.get_dofs({"shaft", "housing"})
    u = solve(*condense(laplace.assemble(basis), 4 * unit_load.assemble(basis), D=held))
    error = np.sqrt(squared_error.assemble(basis, u=u))
    order = f"  order {np.log2(previous / error):.2f}" if previous else ""
    print(f"h = {h:<6} error {error:.2e}{order}")
    previous = error

picture = plot(basis, u, shading="gouraud", cmap="viridis", colorbar=True)
picture.get_figure().savefig("poisson.png", dpi=150)

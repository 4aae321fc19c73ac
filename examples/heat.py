"""Heat through the wall of a pipe: a load by name, on hexahedra that are refined twice.

Heat enters through the bore, one unit an area, and leaves through the rim, which is kept at 0; the
ends let none through. Exactly, the temperature is ln(2 / r).
"""

import numpy as np
from skfem import Basis, ElementHex1, FacetBasis, Functional, condense, solve
from skfem.models.poisson import laplace, unit_load

import csgmesh as cm

ring = cm.Disk((0, 0), 2, name="rim") - cm.Disk((0, 0), 1, name="bore")
pipe = cm.Extrude(ring, 0.5, name="pipe")


@Functional
def squared_error(w):
    return (w.u - np.log(2 / np.hypot(w.x[0], w.x[1]))) ** 2


mesh = cm.generate(pipe, cm.Sweep(cm.QuadPairing(), layers=1), size=0.7)
previous = None
for level in range(3):
    if level:
        mesh = cm.refine(mesh)
    solid = cm.to_skfem(mesh)
    basis = Basis(solid, ElementHex1())
    heated = unit_load.assemble(FacetBasis(solid, ElementHex1(), facets="pipe.side.bore"))
    cold = basis.get_dofs("pipe.side.rim")
    u = solve(*condense(laplace.assemble(basis), heated, D=cold))
    error = np.sqrt(squared_error.assemble(basis, u=u))
    order = f"  order {np.log2(previous / error):.2f}" if previous else ""
    print(f"{mesh.n_cells:>6} hexahedra  error {error:.2e}{order}")
    previous = error

print("valid" if cm.check(mesh, pipe).ok else "not valid")
across = mesh.interpolate(u, [(1.001, 0, 0.25), (1.5, 0, 0.25), (1.999, 0, 0.25)])
print("across the wall:", *(f"{value:.3f}" for value in across))
cm.draw(mesh, "heat.png")

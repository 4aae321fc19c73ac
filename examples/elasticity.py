"""A pipe under pressure: loads and supports by name, on tetrahedra and hexahedra of one part.

A quarter of it is held by its planes of symmetry and at both ends, and pressed from inside. Lamé's
solution moves each point outwards by A r + B / r.
"""

import numpy as np
import skfem as fem
from skfem.models.elasticity import lame_parameters, linear_elasticity

import csgmesh as cm

ring = cm.Disk((0, 0), 2, name="rim") - cm.Disk((0, 0), 1, name="bore")
quarter = cm.Extrude(ring & cm.Box((0, 0), (3, 3), name="cut"), 0.5, name="pipe")
held = {"pipe.side.cut.left": "u^1", "pipe.side.cut.bottom": "u^2"}
held |= {"pipe.start": "u^3", "pipe.end": "u^3"}
young, poisson, pressure = 210.0, 0.3, 1.0
B = pressure * (1 + poisson) * 4 / (3 * young)
A = B * (1 - 2 * poisson) / 4
law = linear_elasticity(*lame_parameters(young, poisson))
push = fem.LinearForm(lambda v, w: -pressure * (w.n * v).sum(axis=0))
error = fem.Functional(
    lambda w: ((w.u[:2] - w.x[:2] * (A + B / (w.x[:2] ** 2).sum(0))) ** 2).sum(0)
)

for mesher, kind in (
    (cm.Octree(), fem.ElementTetP1()),
    (cm.Sweep(cm.Structured()), fem.ElementHex1()),
):
    coarse, errors = cm.generate(quarter, mesher, size=0.4), []
    for mesh in (coarse, cm.refine(coarse)):
        solid, element = cm.to_skfem(mesh), fem.ElementVector(kind)
        basis = fem.Basis(solid, element)
        load = push.assemble(fem.FacetBasis(solid, element, facets="pipe.side.bore"))
        fixed = np.concatenate([basis.get_dofs(name).all(u) for name, u in held.items()])
        u = fem.solve(*fem.condense(law.assemble(basis), load, D=np.unique(fixed)))
        errors.append(np.sqrt(error.assemble(basis, u=u)))
        print(f"{mesh.n_cells:>6} {next(iter(mesh.cells))}  error {errors[-1]:.2e}")
    print(f"order {np.log2(errors[0] / errors[1]):.2f}", cm.check(mesh, quarter).ok)
cm.draw(mesh, "elasticity.png")

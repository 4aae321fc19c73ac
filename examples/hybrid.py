"""Poisson's equation on triangles, on quads and on both at once: all converge at second order."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementQuad1, ElementTriP1, Functional, LinearForm, MeshQuad1, MeshTri1
from skfem.models.poisson import laplace

import csgmesh as cm

insert = cm.Disk((0.5, 0.4), 0.2)
shape = cm.Regions({"plate": cm.Box((0, 0), (1, 1), name="plate"), "insert": insert})
both = cm.PerRegion({"insert": cm.Structured()})
meshers = {"triangles": cm.DelaunayRefinement(), "quads": cm.QuadPairing(), "both": both}
KINDS = {"triangle": (MeshTri1, ElementTriP1()), "quad": (MeshQuad1, ElementQuad1())}
exact = lambda x, y: np.sin(np.pi * x) * np.sin(np.pi * y)  # noqa: E731
right_side = LinearForm(lambda v, w: 2 * np.pi**2 * exact(*w.x) * v)
squared_error = Functional(lambda w: (w.u - exact(*w.x)) ** 2)


def error_of(mesh):
    """L2 norm of the error; the elements of each kind of cells are summed up by their points."""
    n, bases = mesh.n_points, []
    matrix, load, u = coo_array((n, n)), np.zeros(n), np.zeros(n)
    for kind, cells in mesh.cells.items():
        as_skfem, element = KINDS[kind]
        bases.append(basis := Basis(as_skfem(mesh.points.T.copy(), cells.T.copy()), element))
        part = laplace.assemble(basis).tocoo()
        matrix = matrix + coo_array((part.data, (part.row, part.col)), shape=(n, n))
        load[: basis.N] += right_side.assemble(basis)
    free = np.setdiff1d(np.arange(n), mesh.boundary_points("plate"))
    u[free] = spsolve(matrix.tocsr()[free][:, free].tocsc(), load[free])
    return np.sqrt(sum(squared_error.assemble(b, u=b.interpolate(u[: b.N])) for b in bases))


for name, mesher in meshers.items():
    meshes = [cm.generate(shape, mesher, size=h, deviation=0.01) for h in (0.08, 0.04, 0.02)]
    errors = [error_of(mesh) for mesh in meshes]
    print(f"{name}: {errors[-1]:.1e} at the end, order {np.log2(errors[0] / errors[-1]) / 2:.2f}")
cm.draw(meshes[0], "hybrid.png")

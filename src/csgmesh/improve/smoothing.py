"""The verb `csgmesh.smooth`."""

from __future__ import annotations

import numpy as np

from csgmesh.errors import InputError
from csgmesh.improve.breakthrough import broken_through
from csgmesh.improve.cell_smoothing import smooth_cells
from csgmesh.improve.optimisation import optimise
from csgmesh.improve.stars import BEST, CENTROIDS, NEIGHBOURS, Stars
from csgmesh.improve.tetrahedra.smoothing import smooth_tetrahedra
from csgmesh.improve.workpiece import Progress, Workpiece
from csgmesh.mesh import Mesh
from csgmesh.mesh.surfaces import require_solid_cells
from csgmesh.options import near

METHODS = ("laplace", "odt", "optimize")


def smooth(
    mesh: Mesh, method: str = "odt", *, sweeps: int = 5, progress: Progress | None = None
) -> Mesh:
    """Move the vertices of a mesh to better places.

    A vertex moves only if no cell around it turns over and the worst cell around it does not get
    worse; so the mesh's worst cell never does. Among triangles alone that is the one with the
    smallest angle; where there are quads, the one with the smallest scaled Jacobian: the sine of
    the angle at a quad's sharpest or bluntest corner, or of a triangle's smallest angle over that
    of 60 degrees. Of tetrahedra the worst is the one whose dihedral angles come nearest to 0 or 180
    degrees. Vertices of the boundary slide along their exact curve or surface; corners, junctions
    and embedded points stay, and so do periodic sides, vertices on facets without an exact curve or
    surface, and the boundary of a mesh of space with other cells than tetrahedra.

    Parameters
    ----------
    mesh : Mesh
        Of triangles, quads or both, or of straight cells of space.
    method : {"odt", "laplace", "optimize"}
        To the centre that minimises the interpolation error (optimal Delaunay triangulation: Chen
        and Xu 2004), with quads, hexahedra and the like to the mean of the cells' centroids; to the
        mean of the neighbours;
        or raise the smallest angles, which also turns edges of a mesh of triangles and flips
        tetrahedra: see `csgmesh.improve.optimise` and `csgmesh.improve.improve_tetrahedra`.
    sweeps : int, default 5
        How often to go through all vertices; with triangles or tetrahedra alone "optimize" decides
        for itself.
    progress : callable, optional
        Called as ``progress(stage, done, total)``.

    Returns
    -------
    Mesh
        With the same names; the same cells too, but for "optimize".

    Raises
    ------
    InputError
        If the method is unknown, or the mesh holds curved cells; in space also if "optimize" is
        asked for anything but tetrahedra.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Box((0, 0), (2, 1)), size=0.3)
    >>> cm.smooth(mesh, method="odt").n_cells == mesh.n_cells
    True
    """
    if method not in METHODS:
        raise InputError(f"smooth has no method {method!r}; {near(str(method), METHODS)}")
    if sweeps < 0:
        raise InputError(f"sweeps must not be negative; got {sweeps!r}")
    if mesh.dim == 3 and set(mesh.cells) == {"tetra"} and set(mesh.facets) <= {"triangle"}:
        return smooth_tetrahedra(mesh, method, sweeps, progress)
    if mesh.dim == 3:
        require_solid_cells(mesh.cells, "smooth")
        return smooth_cells(mesh, method, sweeps)
    if set(mesh.cells) - {"triangle"}:
        return _smooth_with_quads(mesh, method, sweeps, progress)
    if method == "optimize":
        return optimise(mesh, progress=progress)
    pinned = np.zeros(0, np.int64)
    while True:
        work = Workpiece(mesh, None, pinned)
        for _ in range(sweeps):
            if not work.smooth(method == "odt", progress):
                break
        found = broken_through(work)
        if not len(found):
            return work.finished()
        pinned = np.concatenate([pinned, found])


def _smooth_with_quads(mesh: Mesh, method: str, sweeps: int, progress: Progress | None) -> Mesh:
    target = {"laplace": NEIGHBOURS, "odt": CENTROIDS, "optimize": BEST}[method]
    pinned = np.zeros(0, np.int64)
    while True:
        stars = Stars(mesh, pinned)
        for sweep in range(sweeps):
            if progress is not None:
                progress("smooth", sweep, sweeps)
            if not stars.move(target):
                break
        found = broken_through(stars)
        if not len(found):
            return stars.finished()
        pinned = np.concatenate([pinned, found])

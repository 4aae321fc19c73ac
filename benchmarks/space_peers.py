"""The same solid for csgmesh and for its peers (extra ``peers``): a box less a ball and a bore.

Each function takes an edge length and returns points and cells, which is what is timed: from the
description of the solid to arrays, on one thread.
"""

from __future__ import annotations

import numpy as np

import csgmesh as cm

Arrays = tuple[np.ndarray, np.ndarray]

#: As far may chords be from curved faces: Gmsh knows no such bound, and with it edges would not be
#: alike everywhere.
DEVIATION = 0.02
#: Box (0, 0, 0) to (2, 1, 1).
BALL = (0.6, 0.5, 0.5)
BALL_RADIUS = 0.3
BORE = (1.4, 0.5)
BORE_RADIUS = 0.25
VOLUME = 2.0 - 4.0 / 3.0 * np.pi * BALL_RADIUS**3 - np.pi * BORE_RADIUS**2


def solid() -> cm.Shape:
    """Box minus ball and cylinder."""
    bore = cm.Cylinder((*BORE, -0.1), (*BORE, 1.1), BORE_RADIUS, name="bore")
    ball = cm.Ball(BALL, BALL_RADIUS, name="ball")
    return cm.Box((0, 0, 0), (2, 1, 1), name="block") - ball - bore


def ours(size: float) -> Arrays:
    """csgmesh with its default mesher."""
    mesh = cm.generate(solid(), cm.Octree(), size=size, deviation=DEVIATION)
    return mesh.points, mesh.cells["tetra"]


def our_surface(size: float) -> Arrays:
    """csgmesh's surface alone."""
    mesh = cm.generate(solid(), cm.SurfaceRefinement(), size=size, deviation=DEVIATION)
    return mesh.points, mesh.cells["triangle"]


def ours_graded(fine: float) -> Arrays:
    """csgmesh, edges 1 : 100 from the bore outwards, named, with the default growth of 0.3."""
    size = {"bore": fine, "default": 100 * fine}
    mesh = cm.generate(solid(), cm.Octree(), size=size, deviation=DEVIATION)
    return mesh.points, mesh.cells["tetra"]


def _gmsh_solid(size: float) -> None:
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    kernel = gmsh.model.occ
    box = kernel.addBox(0, 0, 0, 2, 1, 1)
    ball = kernel.addSphere(*BALL, BALL_RADIUS)
    bore = kernel.addCylinder(*BORE, -0.1, 0, 0, 1.2, BORE_RADIUS)
    kernel.cut([(3, box)], [(3, ball), (3, bore)])
    kernel.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)


def _gmsh_arrays(kind: int, corners: int) -> Arrays:
    import gmsh

    tags, points, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    _, nodes = gmsh.model.mesh.getElementsByType(kind)
    return points.reshape(-1, 3), number[nodes.astype(np.int64)].reshape(-1, corners)


def _gmsh(size: float, algorithm: int) -> Arrays:
    import gmsh

    _gmsh_solid(size)
    gmsh.option.setNumber("Mesh.Algorithm3D", algorithm)
    gmsh.model.mesh.generate(3)
    out = _gmsh_arrays(4, 4)
    gmsh.finalize()
    return out


def gmsh_hxt(size: float) -> Arrays:
    """Gmsh, HXT."""
    return _gmsh(size, 10)


def gmsh_delaunay(size: float) -> Arrays:
    """Gmsh, its default algorithm in space."""
    return _gmsh(size, 1)


def gmsh_surface(size: float) -> Arrays:
    """Gmsh's surface alone."""
    import gmsh

    _gmsh_solid(size)
    gmsh.model.mesh.generate(2)
    out = _gmsh_arrays(2, 3)
    gmsh.finalize()
    return out


def tetgen(size: float) -> Arrays:
    """TetGen, which has no solids: csgmesh's surface is given to it, and its time counts."""
    import tetgen as package

    points, triangles = our_surface(size)
    mesher = package.TetGen(points, triangles.astype(np.int32))
    mesher.add_hole(np.array(BALL))
    # A tetrahedron of even edges h has the volume h³ / (6 √2).
    out = mesher.tetrahedralize(switches=f"pYq1.4/10a{1.3 * size**3 / 8.485:.12f}Q")
    return out[0], out[1]


def netgen(size: float) -> Arrays:
    """Netgen's own solids."""
    from netgen.csg import CSGeometry, Cylinder, OrthoBrick, Pnt, Sphere

    geometry = CSGeometry()
    box = OrthoBrick(Pnt(0, 0, 0), Pnt(2, 1, 1))
    ball = Sphere(Pnt(*BALL), BALL_RADIUS)
    bore = Cylinder(Pnt(*BORE, 0), Pnt(*BORE, 1), BORE_RADIUS)
    geometry.Add(box - ball - bore)
    mesh = geometry.GenerateMesh(maxh=size)
    # Copies: the arrays are views of a mesh that is gone after this function.
    nodes = np.array(mesh.Elements3D().NumPy()["nodes"])[:, :4]
    return np.array(mesh.Coordinates()), nodes.astype(np.int64) - 1


def rapidmesh(size: float) -> Arrays:
    """rapidmesh's own solids."""
    import rapidmesh as package

    geometry = package.Geometry(maxh=size)
    geometry.box(2, 1, 1)
    geometry.sphere(BALL_RADIUS, position=BALL, void=True)
    geometry.cylinder(BORE_RADIUS, 1.2, position=(*BORE, -0.1), void=True)
    mesh = geometry.mesh()
    return np.asarray(mesh.points), np.asarray(mesh.tets, dtype=np.int64)


def gmsh_graded(fine: float) -> Arrays:
    """Gmsh HXT, edges 1 : 100 from the bore outwards, growing by 0.3."""
    import gmsh

    _gmsh_solid(100 * fine)
    gmsh.option.setNumber("Mesh.MeshSizeMin", fine)
    gmsh.option.setNumber("Mesh.Algorithm3D", 10)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
    field = gmsh.model.mesh.field
    field.add("MathEval", 1)
    x, y = BORE
    distance = f"Sqrt((x-{x})*(x-{x})+(y-{y})*(y-{y}))-{BORE_RADIUS}"
    field.setString(1, "F", f"{fine}+0.3*Fabs({distance})")
    field.setAsBackgroundMesh(1)
    gmsh.model.mesh.generate(3)
    out = _gmsh_arrays(4, 4)
    gmsh.finalize()
    return out

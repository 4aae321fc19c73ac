"""Raise the smallest angles of a mesh."""

from __future__ import annotations

import numpy as np

from csgmesh.errors import InputError
from csgmesh.improve.breakthrough import broken_through
from csgmesh.improve.workpiece import EASY, GOAL, LIMIT, Progress, Workpiece
from csgmesh.mesh import Mesh

#: Angle that every triangle is treated to reach, degrees.
USUAL_GOAL = 39.0
#: Stars that are this much better than the goal are left alone, degrees.
EASE = 4.0
#: How the triangles beyond the goal are treated, pass by pass: sweeps over the vertices near one,
#: and rounds of the search for a vertex's place. Most are mended by the first pass.
PASSES = ((3, 7), (3, 7), (3, 7), (4, 10), (4, 10), (4, 10), (4, 10))
#: Vertices tried in other places at most, and how many more for each triangle.
EFFORT, EFFORT_PER_CELL = 1200, 1.5


def optimise(
    mesh: Mesh,
    size: float | None = None,
    *,
    goal: float = USUAL_GOAL,
    progress: Progress | None = None,
) -> Mesh:
    """Raise the smallest angles of a mesh of triangles by moving vertices and turning edges.

    The worst triangles come first. Their vertices go to better places of their stars: that of
    optimal Delaunay triangulations, the mean of the neighbours, or where a pattern search ends;
    edges turn where that and new places for their four vertices help; where neither does, all
    neighbours move together. Vertices of the boundary and of interfaces slide along their exact
    curve; corners, junctions, embedded points, ends of embedded paths and the points of periodic
    sides stay. So do all vertices on facets without an exact curve, such as those of a mesh read
    from a file.

    Parameters
    ----------
    mesh : Mesh
        Plane, of triangles.
    size : float, optional
        Wanted edge length that the edges keep to; without one, that of the edges around.
    goal : float, default 39
        Angle in degrees beyond which a triangle is good enough, between 0 and 60.
    progress : callable, optional
        Called as ``progress("improve", done, total)``.

    Returns
    -------
    Mesh
        With the same points, cells, facets and names by number, but other coordinates and corners.

    Raises
    ------
    InputError
        If the mesh holds anything but triangles, or the goal is out of range.

    Guarantees
    ----------
    No triangle turns over, by exact arithmetic. No step lowers the smallest angle around the
    vertices that it moves, so the mesh's smallest angle never sinks. Facets stray no further from
    their curves than they did, or than the domain allows. Edges within 0.62 and 1.55 of the size
    stay so, all others do not get worse when a vertex moves. The same input gives the same bytes.

    Exceptions
    ----------
    The mesh is not Delaunay afterwards. Where the boundary leaves no choice, angles stay as they
    are.

    Termination
    -----------
    After a fixed number of passes, or an effort in proportion to the number of triangles.

    References
    ----------
    .. [1] L. Chen, J. Xu, "Optimal Delaunay triangulations", J. Computational Mathematics 22
       (2004).
    .. [2] H. Erten, A. Üngör, "Quality triangulations with locally optimal Steiner points", SIAM J.
       Scientific Computing 31 (2009).
    .. [3] L. A. Freitag, C. Ollivier-Gooch, "Tetrahedral mesh improvement using swapping and
       smoothing", Int. J. Numerical Methods in Engineering 40 (1997).

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Disk((0, 0), 1), size=0.2)
    >>> better = optimise(mesh, 0.2)
    >>> bool(cm.quality(better).min_angle.min() >= cm.quality(mesh).min_angle.min())
    True
    """
    if not 0 < goal < 60:
        raise InputError(f"goal must be between 0 and 60 degrees; got {goal!r}")
    pinned = np.zeros(0, np.int64)
    while True:
        work = Workpiece(mesh, size, pinned)
        _climb(work, goal, progress)
        found = broken_through(work)
        if not len(found):
            return work.finished()
        pinned = np.concatenate([pinned, found])


def _climb(work: Workpiece, goal: float, progress: Progress | None) -> None:
    arrays = work.arrays
    easy = min(goal + EASE, 0.5 * (goal + 60.0))
    arrays.number[[GOAL, EASY]] = 1.0 / np.tan(np.radians([goal, easy]))
    arrays.count[LIMIT] = int(EFFORT + EFFORT_PER_CELL * len(arrays.failed))
    before = PASSES[0]
    for effort in PASSES:
        if effort != before:
            # What a short search could not mend, a longer one may.
            arrays.failed[:] = -1
        before = effort
        work.treat(*effort, progress)

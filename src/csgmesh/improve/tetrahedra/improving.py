"""Raise the smallest dihedral angles of tetrahedra on a surface mesh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from csgmesh import kernels
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.errors import InputError
from csgmesh.improve.tetrahedra.chords import Chords
from csgmesh.improve.tetrahedra.piece import Piece
from csgmesh.options import check_whole

Progress = Callable[[str, int, int], None]
Improved = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]

#: Angle that every tetrahedron is treated to reach, degrees.
USUAL_GOAL = 25.0
#: A vertex stops moving where its worst angle is this much beyond the goal, degrees.
EASE = 6.0
#: Vertices come and go only for cells whose worst angle is below this share of the goal: they
#: change the sizes, flips and moves do not.
POOR = 0.72
#: Passes that only flip and move; those after them put vertices in and take them out, too.
FAST_PASSES = 2
USUAL_PASSES = 4
#: Rounds of a pass: cells are treated, then vertices slide along the surface.
ROUNDS = 4


def improve_tetrahedra(
    points: np.ndarray,
    tets: np.ndarray,
    region: np.ndarray,
    triangles: np.ndarray,
    face: np.ndarray,
    surface: SurfaceMesh,
    goal: float = USUAL_GOAL,
    passes: int = USUAL_PASSES,
    progress: Progress | None = None,
) -> Improved:
    """Raise the smallest dihedral angles of tetrahedra on a surface mesh, and lower the largest.

    The worst tetrahedra come first. The best flip at one of their edges or faces is done; where
    none helps, their vertices move to where the worst angle around them is best; from the third
    pass on, edges are contracted or divided where that does not help either and angles are below
    0.72 of the goal. Vertices on the
    surface slide along their face or curve and are put on the exact surface; edges of the surface
    turn within a face. Only the cells around bad ones are looked at, so that time grows with their
    number.

    Parameters
    ----------
    points : (n, 3) float64
        Those of `surface` first.
    tets : (m, 4) int64
        Positively oriented. Some may have no volume; these are treated first.
    region : (m,) int64
        Region of each tetrahedron.
    triangles : (k, 3) int64
        Those of `surface`, or what swaps have made of them; each a face of tetrahedra.
    face : (k,) int64
        Face of each triangle.
    surface : SurfaceMesh
        What each of its points lies on, and the segments of the feature curves.
    goal : float, default 25
        Angle in degrees, between 0 and 60, beyond which a tetrahedron is good enough. It counts at
        both ends: no angle is to be larger than its supplement.
    passes : int, default 4
        How often bad cells are gathered and treated, at most.
    progress : callable, optional
        Called as ``progress("improve", done, total)``.

    Returns
    -------
    points, tets, region, triangles, face
        As given. Points of the surface keep their numbers; of the others, some may be gone and some
        new.

    Raises
    ------
    InputError
        If the goal is out of range, or `passes` not a whole number.

    Guarantees
    ----------
    Every cell that is changed stays positively oriented, exactly: a step whose sign is in doubt by
    the rounding error of the triple product is not taken. No step lowers the worst angle around
    what it changes. Feature edges, regions and names stay; vertices of faces and curves lie on
    their exact surfaces. Chords of a face stray no further from its surface than the domain's
    deviation or the deepest that the face had before, by the exact normals at their ends. Angles of
    the surface's triangles fall no lower than 25 degrees, or than what they were. The same input
    gives the same bytes.

    Exceptions
    ----------
    The mesh is not Delaunay afterwards. Where the surface leaves no choice, angles stay as they
    are: at feature edges with small angles, and in tetrahedra all of whose corners are fixed.

    Termination
    -----------
    After a fixed number of rounds, in each of which every bad cell is treated once.

    References
    ----------
    .. [1] L. A. Freitag, C. Ollivier-Gooch, "Tetrahedral mesh improvement using swapping and
       smoothing", Int. J. Numerical Methods in Engineering 40 (1997).
    .. [2] J. R. Shewchuk, "Two discrete optimization algorithms for the topological improvement of
       tetrahedral meshes" (2002).
    .. [3] B. M. Klingner, J. R. Shewchuk, "Aggressive tetrahedral mesh improvement", 16th
       International Meshing Roundtable (2007).

    Examples
    --------
    A cube around a point near its bottom, which goes to the middle:

    >>> import csgmesh as cm
    >>> plc = cm.evaluate(cm.Box((0, 0, 0), (1, 1, 1)))
    >>> surface = SurfaceMesh(
    ...     plc.points, plc.facets, plc.facet_surface, np.arange(6), plc.facet_marker[::2],
    ...     plc.facet_region[::2], plc.feature_edges(), np.arange(12), np.zeros((12, 2), int),
    ...     np.zeros(8, np.int8), np.arange(8), plc)
    >>> points = np.vstack([plc.points, [0.5, 0.5, 0.05]])
    >>> tets = np.column_stack([plc.facets[:, ::-1], np.full(12, 8)])
    >>> before = cm.Mesh(points, {"tetra": tets})
    >>> points, tets, *_ = improve_tetrahedra(
    ...     points, tets, np.zeros(12, int), plc.facets, plc.facet_surface, surface, goal=45)
    >>> after = cm.Mesh(points, {"tetra": tets})
    >>> [round(float(cm.quality(mesh).min_dihedral.min())) for mesh in (before, after)]
    [6, 45]
    """
    if not 0 < goal < 60:
        raise InputError(f"goal must be between 0 and 60 degrees; got {goal!r}")
    passes = check_whole("passes", passes, 0)
    points = np.array(points, dtype=np.float64)
    tets = np.array(tets, dtype=np.int64)
    region = np.array(region, dtype=np.int64)
    chords = Chords(np.array(triangles, dtype=np.int64), np.array(face, dtype=np.int64), surface)
    angles = np.array([goal, min(goal + EASE, 0.5 * (goal + 60.0)), POOR * goal])
    bars = np.sin(np.radians(angles)) ** 2
    scores = shapes(points, tets)
    for number in range(passes):
        if not (scores <= bars[0]).any():
            break
        piece = Piece(points, tets, region, scores, chords, number > 0, bars)
        done = piece.work(ROUNDS, number >= FAST_PASSES, progress)
        points, tets, region, scores = piece.put_back(points, tets, region, scores)
        if not done and number >= FAST_PASSES:
            break
    points, tets = _without_unused(points, tets, surface.n_points)
    return points, tets, region, chords.triangles, chords.face


def shapes(points: np.ndarray, tets: np.ndarray) -> np.ndarray:
    """Squared sine of the worst dihedral angle of each tetrahedron, (m,); at most 0 if flat."""
    scores = np.empty(len(tets))
    flat, corners = points.reshape(-1), tets.reshape(-1)
    done = 0
    while done < len(tets):
        done = kernels.score_cells(flat, corners, scores, done)
    return scores


def _without_unused(
    points: np.ndarray, tets: np.ndarray, n_kept: int
) -> tuple[np.ndarray, np.ndarray]:
    """Take out points from the `n_kept`-th on that no tetrahedron has."""
    used = np.zeros(len(points), bool)
    used[tets] = True
    used[:n_kept] = True
    if used.all():
        return points, tets
    number = np.cumsum(used) - 1
    return points[used], number[tets]

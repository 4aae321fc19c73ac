"""All quads of any domain, by pairing triangles."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from csgmesh.domain.input_angles import input_angles
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import BudgetError, InputError, MeshingError
from csgmesh.improve.squaring import square_up
from csgmesh.measures import quality
from csgmesh.mesh import Mesh
from csgmesh.meshers.delaunay_refinement import LARGEST_MIN_ANGLE
from csgmesh.meshers.quad_pairing.coarse import coarse_triangles, halved_near, joined_chords
from csgmesh.meshers.quad_pairing.matching import pair
from csgmesh.meshers.quad_pairing.splitting import split
from csgmesh.meshers.workspace import Progress
from csgmesh.options import check_growth, check_real, check_whole
from csgmesh.size import resolve

#: Quads at an input angle below this many degrees may be as sharp.
EXCUSED = 30.0
#: How often to begin again with shorter chords where quads at a curve fold.
ROUNDS = 6


@dataclass(frozen=True)
class QuadPairing:
    """Quads only, of any domain with any regions.

    A right-angled triangulation of twice the wanted size is paired into quads, in such an order
    that square corners and vertices of four quads come first; what is left over are pairs of
    triangles at the ends of alternating paths. Every cell is then halved along both directions,
    which leaves no triangle, and vertices move until the quads are nearly square.

    Parameters
    ----------
    gradation : float, default 0.3
        Bound on the growth of sizes per unit of length.
    min_angle : float, default 30
        Bound on the angles of the triangles that are paired, degrees, at most 34.
    max_points : int, default 10**7
        Bound on the number of points.
    sweeps : int, default 10
        How often vertices move at most; 0 leaves them where they are.

    Raises
    ------
    InputError
        If an option is out of range.

    Guarantees
    ----------
    Every cell is a convex quad. Every segment is a union of edges, and each of their vertices lies
    on the segment's exact curve. No quad has two edges on one smooth stretch of the boundary.
    Regions and names are those of the domain. The same input gives the same bytes.

    Exceptions
    ----------
    At an input angle below 30 degrees a quad is as sharp as the angle: ``info["excused"]`` counts
    the quads there. Between sizes that vary quickly, and where curves come close to each other,
    more vertices have three or five quads. Between curves that touch, edges may be shorter than
    wanted: chords are halved there until no quad folds.

    Termination
    -----------
    As of `DelaunayRefinement`; pairing and smoothing take linear time.

    References
    ----------
    .. [1] J.-F. Remacle, J. Lambrechts, B. Seny, E. Marchandise, A. Johnen, C. Geuzaine,
       "Blossom-Quad: a non-uniform quadrilateral mesh generator using a minimum-cost
       perfect-matching algorithm", Int. J. Numerical Methods in Engineering 89 (2012).
    .. [2] S. J. Owen, M. L. Staten, S. A. Canann, S. Saigal, "Q-Morph: an indirect approach to
       advancing front quad meshing", Int. J. Numerical Methods in Engineering 44 (1999).
    .. [3] P. M. Knupp, "Achieving finite element mesh quality via optimization of the Jacobian
       matrix norm and associated quantities", Int. J. Numerical Methods in Engineering 48 (2000).

    Examples
    --------
    >>> import csgmesh as cm
    >>> plate = cm.Box((0, 0), (2, 1)) - cm.Disk((1, 0.5), 0.25)
    >>> mesh = cm.generate(plate, cm.QuadPairing(), size=0.05)
    >>> list(mesh.cells), bool(cm.quality(mesh).sicn.min() > 0.5)
    (['quad'], True)
    """

    gradation: float = 0.3
    min_angle: float = 30.0
    max_points: int = 10**7
    sweeps: int = 10

    def __post_init__(self) -> None:
        angle_rule = f"between 0 and {LARGEST_MIN_ANGLE:g} degrees"
        checked = {
            "gradation": check_growth("gradation", self.gradation),
            "min_angle": check_real(
                "min_angle", self.min_angle, angle_rule, lambda x: 0 <= x <= LARGEST_MIN_ANGLE
            ),
            "max_points": check_whole("max_points", self.max_points, 16),
            "sweeps": check_whole("sweeps", self.sweeps, 0),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def generate(self, domain: Pslg, size: Any = None, progress: Progress | None = None) -> Mesh:
        """Mesh a domain.

        Parameters
        ----------
        domain : Pslg
            What to mesh.
        size : None, float, mapping, callable or SizeField
            Wanted edge length; without one the domain's features and curves decide.
        progress : callable, optional
            Called as ``progress(stage, done, total)``.

        Returns
        -------
        Mesh
            Quads, with the domain's names and regions.

        Raises
        ------
        BudgetError
            If `max_points` do not suffice.
        MeshingError
            If segments cross or a region is not closed; with the place.
        SizeError, NameLookupError
            If the size is not positive and finite somewhere, or names nothing.
        """
        if domain.periodic:
            raise InputError("QuadPairing cannot mesh periodic sides alike; use DelaunayRefinement")
        limits = self.min_angle, self.gradation, max(self.max_points // 4, 3)
        wanted = resolve(size, domain)
        outline = joined_chords(domain)
        for _ in range(ROUNDS):
            try:
                coarse = coarse_triangles(outline, wanted, limits, progress)
            except BudgetError:
                raise
            except MeshingError:
                # Joined chords may cross where the domain's own do not.
                if outline is domain:
                    raise
                outline = domain
                continue
            pairing = pair(coarse)
            info = {
                "method": "QuadPairing",
                "options": asdict(self),
                "n_left_over": int((pairing.corners[:, 3] < 0).sum()),
            }
            mesh = square_up(split(coarse, pairing, domain, info), self.sweeps, progress)
            folded = np.flatnonzero(quality(mesh).scaled_jacobian <= 0)
            if not len(folded):
                break
            outline = halved_near(outline, mesh, folded)
        return replace(mesh, info={**mesh.info, "excused": _excused(mesh, domain)})


def _excused(mesh: Mesh, domain: Pslg) -> int:
    """How many quads have a corner at an input angle below 30 degrees."""
    apexes, angles, _ = input_angles(domain)
    apexes = apexes[angles < EXCUSED]
    if not len(apexes):
        return 0
    numbers = {tuple(p): k for k, p in enumerate(mesh.points[: domain.n_points].tolist())}
    at = [numbers[tuple(p)] for p in apexes.tolist() if tuple(p) in numbers]
    return int(np.isin(mesh.cells["quad"], at).any(axis=1).sum())

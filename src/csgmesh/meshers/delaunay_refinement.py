"""Delaunay refinement: quality triangles of any domain, with exact curved boundaries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from csgmesh.domain.input_angles import sharp_corners
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import BudgetError
from csgmesh.improve import optimise
from csgmesh.mesh import Mesh
from csgmesh.meshers.assembly import assemble
from csgmesh.meshers.components import parts_of
from csgmesh.meshers.joining import join
from csgmesh.meshers.layers import Layers, checked_layers, with_layers
from csgmesh.meshers.meshing import Meshing
from csgmesh.meshers.partwise import Partwise
from csgmesh.meshers.side_by_side import cores
from csgmesh.meshers.units import mesh_in_own_unit, own_unit
from csgmesh.meshers.workspace import MOST_POINTS, Progress
from csgmesh.meshers.worst import describe, worst_cells
from csgmesh.options import check_flag, check_growth, check_real, check_whole
from csgmesh.size import ResolvedSize, resolve

#: Beyond this no ordering of Delaunay refinement is known to end on most inputs.
LARGEST_MIN_ANGLE = 34.0
#: Worst cells looked at when the budget ran out, and how many of them the message names.
LOOKED_AT, NAMED = 50, 3


@dataclass(frozen=True)
class DelaunayRefinement:
    """Triangles with no small angles, graded by size, features and curvature.

    Parameters
    ----------
    min_angle : float, default 30
        Smallest angle allowed, degrees, at most 34.
    gradation : float, default 0.3
        Bound on the growth of sizes per unit of length.
    max_points : int, default 10**7
        Bound on the number of points.
    improve : bool, default False
        Whether to raise the smallest angles afterwards by moving vertices and turning edges, to 39
        degrees where the boundary lets them: see `csgmesh.improve.optimise`.
    threads : int, optional
        Bound on the number of threads, by default the number of processor cores. Components of a
        large domain are meshed side by side; the mesh does not depend on it.
    layers : mapping of str to Layers, optional
        Boundary layers along named outer boundaries; see `Layers`.

    Raises
    ------
    InputError
        If an option is out of range.

    Guarantees
    ----------
    Every segment is a union of edges, and each of their vertices lies on the segment's exact curve.
    No angle is smaller than `min_angle`, except as below. The triangulation is constrained
    Delaunay. Edge lengths follow the size where the domain's features do not ask for shorter
    ones. Regions and names are those of the domain. Sides of a `csgmesh.Periodic` domain get the
    same vertices. The same input gives the same bytes.

    Exceptions
    ----------
    Cells with a vertex at the apex of an input angle below 60 degrees, or within its protected
    shell (see `csgmesh.domain.input_angles`), may have smaller angles: along two segments that
    leave a vertex at a small angle, new vertices lie on common circles around it, and the edges
    between them are left alone. Edges a few units in the last place long are not divided. On
    periodic sides the shells of an apex are repeated at its images.
    With `improve` the triangulation is not Delaunay in places. With `layers` there is no bound on
    angles: layers are as thin as asked for.

    Termination
    -----------
    Proved, for straight segments and without a size, with numbers of triangles that are optimal up
    to a constant: Ruppert's algorithm up to 20.7 degrees, where segments meet at 90 degrees or
    more [1]_, or at 60 [2]_; Chew's second, which guards subsegments by lenses and removes
    vertices from their circles, up to 26.5 degrees [2]_, with off-centres up to 28.6 [7]_; with
    concentric shells, for any input angles, but not beside small ones [4]_. What runs here is
    Ruppert's algorithm with off-centres, shells and, without a size, Chew's lenses, but vertices
    stay once they are there: no proof covers it to the letter.

    Practice: 30 degrees, and 33 on nearly all inputs, those with curves too, whose subsegments turn
    by no more than 50 degrees from the start. Where it does not end, or features ask for more than
    `max_points`, a `BudgetError` names the place and carries the mesh so far.

    References
    ----------
    .. [1] J. Ruppert, "A Delaunay refinement algorithm for quality 2-dimensional mesh generation",
       J. Algorithms 18 (1995).
    .. [2] J. R. Shewchuk, "Delaunay refinement algorithms for triangular mesh generation",
       Computational Geometry 22 (2002).
    .. [3] A. Üngör, "Off-centers: a new type of Steiner points", LATIN (2004).
    .. [4] G. L. Miller, S. E. Pav, N. J. Walkington, "When and why Delaunay refinement algorithms
       work", Int. J. Computational Geometry and Applications 15 (2005).
    .. [5] S. Rebay, "Efficient unstructured mesh generation by means of Delaunay triangulation and
       Bowyer-Watson algorithm", J. Computational Physics 106 (1993).
    .. [6] D. Engwirda, D. Ivers, "Off-centre Steiner points for Delaunay-refinement on curved
       surfaces", Computer-Aided Design 72 (2016).
    .. [7] A. Rand, "Where and how Chew's second Delaunay refinement algorithm works", Canadian
       Conference on Computational Geometry (2011).

    Examples
    --------
    >>> from csgmesh.domain import Pslg
    >>> square = Pslg([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> mesh = DelaunayRefinement(min_angle=30).generate(square, size=0.5)
    >>> mesh.n_points >= 9
    True
    """

    min_angle: float = 30.0
    gradation: float = 0.3
    max_points: int = 10**7
    improve: bool = False
    threads: int | None = None
    layers: Mapping[str, Layers] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        angle_rule = (
            f"between 0 and {LARGEST_MIN_ANGLE:g} degrees, beyond which Delaunay refinement does "
            "not end"
        )
        checked = {
            "min_angle": check_real(
                "min_angle", self.min_angle, angle_rule, lambda x: 0 <= x <= LARGEST_MIN_ANGLE
            ),
            "gradation": check_growth("gradation", self.gradation),
            "max_points": check_whole("max_points", self.max_points, 3),
            "improve": check_flag("improve", self.improve),
            "threads": None if self.threads is None else check_whole("threads", self.threads, 1),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)

        checked_layers(self.layers)

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
            Triangles, with the domain's names and regions.

        Raises
        ------
        BudgetError
            If `max_points` do not suffice; with the mesh so far.
        MeshingError
            If segments cross or a region is not closed; with the place.
        SizeError, NameLookupError
            If the size is not positive and finite somewhere, or names nothing.
        """
        wanted = resolve(size, domain)
        if self.layers:
            info = {"method": "DelaunayRefinement", "options": self._options()}
            inside = replace(self, layers={})

            def mesh_inside(inner: Pslg) -> Mesh:
                return inside.generate(inner, size, progress)

            return with_layers(domain, self.layers, wanted, mesh_inside, info)
        unit = own_unit(domain)
        if unit != 1.0:
            return mesh_in_own_unit(
                domain, wanted, unit, lambda here, h: self._generate(here, h, progress)
            )
        return self._generate(domain, wanted, progress)

    def _generate(
        self, domain: Pslg, wanted: ResolvedSize | None, progress: Progress | None
    ) -> Mesh:
        limits = self.min_angle, self.gradation, min(self.max_points, MOST_POINTS)
        parts = parts_of(domain, wanted, self.max_points, progress)
        if len(parts) > 1:
            together = Partwise(parts, wanted, limits, progress)
            threads = self.threads or cores()
            finished = together.run(threads)
            mesh = self._joined(domain, together, threads)
        else:
            run = Meshing(domain, sharp_corners(domain), limits, progress)
            try:
                finished = run.run(wanted)
            except BudgetError as error:
                error.mesh = self._mesh(run)
                raise
            mesh = self._mesh(run)
        if not finished:
            raise BudgetError(_where_it_stopped(mesh, self, wanted), mesh)
        uniform = wanted.uniform if wanted is not None else None
        return optimise(mesh, uniform, progress=progress) if self.improve else mesh

    def _options(self) -> dict[str, object]:
        # The mesh does not depend on the number of threads, and so says nothing of it.
        silent = {"threads"} if self.layers else {"threads", "layers"}
        return {name: value for name, value in vars(self).items() if name not in silent}

    def _mesh(self, run: Meshing) -> Mesh:
        run.refiner.publish()
        return assemble(run.work, self._info([run], len(run.domain.points)))

    def _joined(self, domain: Pslg, together: Partwise, threads: int) -> Mesh:
        for run in together.runs:
            run.refiner.publish()
        works = [run.work for run in together.runs]
        info = self._info(together.runs, sum(len(part.point) for part in together.parts))
        return join(domain, together.parts, works, info, threads)

    def _info(self, runs: Sequence[Meshing], n_given: int) -> dict[str, object]:
        return {
            "method": "DelaunayRefinement",
            "min_angle": self.min_angle,
            "options": self._options(),
            "n_steiner": sum(run.work.n_points for run in runs) - n_given,
            "n_sharp_corners": sum(int((run.refiner.radius > 0).sum()) for run in runs),
            "n_given_up": sum(int(run.refiner.count[7]) for run in runs),
        }


def _where_it_stopped(mesh: Mesh, mesher: DelaunayRefinement, size: ResolvedSize | None) -> str:
    """Where a mesh that ran out of points is finest, and where its worst cells are."""
    corners = mesh.points[mesh.cells["triangle"]]
    edges = np.roll(corners, -1, axis=1) - corners
    shortest = np.hypot(edges[..., 0], edges[..., 1]).min(axis=1)
    finest = int(np.argmin(shortest))
    x, y = corners[finest].mean(axis=0)
    reason = "its features and the angle bound" if size is None else "the size or the features"
    found = worst_cells(mesh, LOOKED_AT)
    # At input angles cells are allowed to be bad: they are not what the points were missing for.
    found = [cell for cell in found if cell["reason"] != "input angle"] or found
    return (
        f"max_points={mesher.max_points} is used up before every angle reaches "
        f"{mesher.min_angle:g} degrees; the mesh is finest at ({x:.6g}, {y:.6g}), edges of "
        f"{shortest[finest]:.3g}, where {reason} ask for it; its worst cells are "
        + ", ".join(describe(cell) for cell in found[:NAMED])
    )

"""Hierarchical meshing of the plane: a quadtree, templates inside, a strip along the boundary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.errors import BudgetError, InputError
from csgmesh.improve import optimise, smooth
from csgmesh.improve.squaring import square_up
from csgmesh.measures import quality
from csgmesh.mesh import Mesh
from csgmesh.meshers.layers import Layers, checked_layers, with_layers
from csgmesh.meshers.quadtree_cells import mixed_mesh, quad_mesh, triangle_mesh
from csgmesh.meshers.quadtree_run import Run
from csgmesh.meshers.workspace import Progress
from csgmesh.options import check_choice, check_flag, check_growth, check_whole
from csgmesh.size import resolve

CELLS = ("triangle", "quad", "mixed")
#: Smallest angle of triangles that is promised, degrees (Bern, Eppstein, Gilbert).
PROMISED = 18.4
#: Smallest angle below which the tree is refined around a triangle, degrees.
WANTED = 20.0
#: Side of a leaf as a share of a uniform size: two of its triangles are as large as two equilateral
#: ones of the size.
UNIFORM = 0.93
#: Times that the tree is refined where quads fold.
ROUNDS = 6
#: Growth of sizes in a tree whose neighbours differ by one level.
GROWTH = 0.5


@dataclass(frozen=True)
class Quadtree:
    """Cells from a quadtree: right-angled templates inside, a strip fitted to the boundary.

    The tree is refined until its leaves are as small as the size, the curves' chords and the gaps
    between features ask for, and balanced. Leaves at some distance from every boundary are cut by
    templates, two triangles a leaf, or a fan around the centre where neighbours are smaller.
    Boundaries get vertices on their exact curves as far apart as the leaves there are large. The
    strip between, one or two leaves wide, is triangulated on these vertices and no others; then its
    vertices move and its edges turn until the smallest angles are as large as they can be.

    Mixed cells are the leaves themselves, and what pairs of triangles of the strip and of the fans
    make good quads. Quads come from mixed cells of twice the size, each halved along both
    directions (a triangle left over makes three); then inner vertices move until the quads are as
    square as they can be.

    Parameters
    ----------
    cells : {"triangle", "quad", "mixed"}
        What to make.
    gradation : float, default 0.5
        Bound on the growth of sizes per unit of length: 0.5 or more lets neighbouring leaves
        differ by one level, 0.25 puts two leaves of a size in a row, and so on.
    max_points : int, default 10**7
        Bound on the number of leaves, which is about that of the points.
    improve : bool, default False
        Whether to raise the smallest angles of the whole mesh afterwards, of triangles to 39
        degrees where the boundary lets them; vertices then slide along their curves.
    layers : mapping of str to Layers, optional
        Boundary layers along named outer boundaries; see `Layers`.

    Raises
    ------
    InputError
        If an option is out of range.

    Guarantees
    ----------
    No angle of a triangle is smaller than 18.4 degrees, except as below; inside they are 45 and 90
    degrees. Every corner, junction and end of a path is a vertex; every curve is a union of edges
    whose vertices lie on it. Regions and names are those of the domain. The same input gives the
    same bytes. With ``cells="quad"`` there is no triangle, and every quad is convex; with
    ``"mixed"`` the bound on angles holds for quads too.

    Exceptions
    ----------
    Cells with a vertex at the apex of an input angle below 60 degrees, or within its protected
    shell (see `csgmesh.domain.input_angles`), may have smaller angles. A leaf is a power of two of
    the root, so that with a size that varies edges are between half and 1.6 times as long as asked
    for. A point in the middle of a smooth curve, put there when it was flattened, is not kept. At
    an input angle below 30 degrees a quad is as sharp as the angle: ``info["excused"]`` counts
    those. Periodic sides are refused. With `layers` there is no bound on angles: layers are as thin
    as asked for.

    Termination
    -----------
    Always: every refinement halves a leaf, and the number of leaves and of levels is bounded. A
    `BudgetError` with the place ends what would take more.

    References
    ----------
    .. [1] M. Bern, D. Eppstein, J. Gilbert, "Provably good mesh generation", J. Computer and System
       Sciences 48 (1994).
    .. [2] F. Labelle, J. R. Shewchuk, "Isosurface stuffing", ACM Trans. Graphics 26 (2007).
    .. [3] M. S. Ebeida, R. L. Davis, R. W. Freund, "A new fast hybrid adaptive grid generation
       technique for arbitrary two-dimensional domains", Int. J. Numerical Methods in Engineering 84
       (2010).
    .. [4] J. Liang, M. S. Ebeida, Y. Zhang, "Guaranteed-quality all-quadrilateral mesh generation
       with feature preservation", Computer Methods in Applied Mechanics and Engineering 199 (2010).

    Examples
    --------
    >>> from csgmesh.domain import Pslg
    >>> square = Pslg([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> Quadtree().generate(square, size=0.25)
    <Mesh 2D: 25 points, 32 triangles, 16 facets, regions: domain, boundaries: boundary>
    >>> Quadtree(cells="quad").generate(square, size=0.25)
    <Mesh 2D: 25 points, 16 quads, 16 facets, regions: domain, boundaries: boundary>
    """

    cells: str = "triangle"
    gradation: float = 0.5
    max_points: int = 10**7
    improve: bool = False
    layers: Mapping[str, Layers] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        check_choice("cells", self.cells, CELLS, "Quadtree")
        checked = {
            "gradation": check_growth("gradation", self.gradation),
            "max_points": check_whole("max_points", self.max_points, 4),
            "improve": check_flag("improve", self.improve),
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
            With the domain's names and regions.

        Raises
        ------
        BudgetError
            If `max_points` leaves do not suffice, or an angle stays too small; with the place.
        MeshingError
            If segments cross or a region is not closed; with the place.
        SizeError, NameLookupError
            If the size is not positive and finite somewhere, or names nothing.
        """
        if domain.periodic:
            raise InputError("Quadtree does not mesh periodic sides alike; DelaunayRefinement does")
        wanted = resolve(size, domain)
        if self.layers:
            about: dict[str, object] = {"method": "Quadtree", "options": self._options()}
            inside = replace(self, layers={})

            def mesh_inside(inner: Pslg) -> Mesh:
                return inside.generate(inner, size, progress)

            return with_layers(domain, self.layers, wanted, mesh_inside, about)
        width = max(int(np.ceil(GROWTH / self.gradation - 1e-9)), 1)
        scale = {"triangle": UNIFORM, "mixed": 1.0, "quad": 2.0}[self.cells]
        parts = 2 if self.cells == "quad" else 1
        run = Run(domain, wanted, scale, width, self.max_points, WANTED, progress, parts)
        info: dict[str, object] = {"method": "Quadtree", "options": self._options()}
        if self.cells == "quad":
            return self._quads(run, info, progress)
        stuck = run.run(PROMISED)
        info["min_angle"] = PROMISED
        mesh = triangle_mesh(run, info) if self.cells == "triangle" else mixed_mesh(run, info)
        if stuck is not None:
            raise BudgetError(
                f"no refinement of the tree brings the angles at ({stuck[0]:.6g}, {stuck[1]:.6g}) "
                f"to {PROMISED:g} degrees",
                mesh,
            )
        if not self.improve:
            return mesh
        if self.cells == "mixed":
            return smooth(mesh, "optimize", progress=progress)
        return optimise(mesh, wanted.uniform if wanted is not None else None, progress=progress)

    def _options(self) -> dict[str, object]:
        silent = () if self.layers else ("layers",)
        return {name: value for name, value in vars(self).items() if name not in silent}

    def _quads(self, run: Run, info: dict[str, object], progress: Progress | None) -> Mesh:
        """Quads; the tree is refined where they fold."""
        for _ in range(ROUNDS):
            run.run(PROMISED)
            mesh = quad_mesh(run, info, progress)
            folded = np.flatnonzero(quality(mesh).scaled_jacobian <= 0)
            if not len(folded):
                if not self.improve:
                    return mesh
                # The first lets vertices slide along the boundary, the second evens out.
                better = smooth(mesh, "optimize", sweeps=2, progress=progress)
                return square_up(better, progress=progress)
            corners = mesh.points[mesh.cells["quad"][folded]]
            run.refine(corners)
        x, y = corners[0].mean(axis=0)
        raise BudgetError(f"no refinement of the tree unfolds the quad at ({x:.6g}, {y:.6g})", mesh)

"""Tetrahedra of solids: a mesh of the surface, a lattice inside, Delaunay between."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.errors import BudgetError
from csgmesh.improve.tetrahedra import improve_tetrahedra
from csgmesh.mesh import Mesh
from csgmesh.meshers.hexahedra import hexahedral_mesh
from csgmesh.meshers.octree.cubes import mixed_cells
from csgmesh.meshers.octree.filling import fill
from csgmesh.meshers.octree.lattice import Lattice
from csgmesh.meshers.octree.sizes import SpaceSizes
from csgmesh.meshers.tetrahedra import Tetrahedra
from csgmesh.meshers.workspace import Progress
from csgmesh.options import check_choice, check_flag, check_growth, check_whole
from csgmesh.size.field import Source
from csgmesh.size.resolve import ResolvedSize, resolve

CELLS = ("tetra", "hexahedron", "mixed")
STAGES = 4
#: Sizes for mixed cells that vary by no more than this are made even: cells of one size are
#: hexahedra, of which there are a twelfth as many as of tetrahedra.
EVEN = 0.65


@dataclass(frozen=True)
class Octree:
    """Tetrahedra from an octree: a body-centred lattice inside, a mesh of the exact surface around.

    An octree is refined until its leaves are as small as the size, the surface's curvature and
    short edges ask for, and balanced. The surface is meshed by itself, vertices on its exact
    corners, curves and faces. Centres and corners of leaves inside, at some distance from it, are
    the other vertices. Where leaves are equal the tetrahedra between two centres and an edge are
    taken as they are; Delaunay tetrahedra fill what is left up to the surface. Then the smallest
    dihedral angles are raised.

    Parameters
    ----------
    cells : {"tetra", "hexahedron", "mixed"}
        What to make. ``"mixed"`` makes hexahedra of the lattice's cubes, one or two layers of them
        away from the surface, pyramids around these, and tetrahedra for the rest. Hexahedra alone
        come from a grid whose planes fit the flat faces, with sheets of cells along the others;
        the smallest size holds everywhere, and `gradation` and `improve` do not matter.
    gradation : float, default 0.3
        Bound on the growth of sizes per unit of length.
    improve : bool, default True
        Whether to raise the smallest dihedral angles at last.
    max_points : int, default 10**7
        Bound on the number of points.
    walls : int, default 1
        Cells across thin walls and gaps: edges there are no longer than three times the thickness
        over this number, 0 looks at no walls. See the exceptions. Sizes of hexahedra do not regard
        walls.

    Raises
    ------
    InputError
        If an option is out of range.

    Guarantees
    ----------
    The mesh conforms, every cell is positively oriented by exact arithmetic, all feature edges and
    corners of the domain are edges and vertices, and vertices on the boundary lie on its exact
    surfaces. Regions and names are those of the domain. The same input gives the same bytes. Away
    from the surface, where leaves are equal, cells are those of the body-centred cubic lattice,
    whose dihedral angles are 60 and 90 degrees; of mixed cells, cubes and pyramids of a sixth of
    one, whose dihedral angles are 45, 90 and 120 degrees.

    Jacobians of hexahedra are positive all over each cell, by Bernstein bounds.

    Exceptions
    ----------
    Chords of curved faces of hexahedra are as long as the size, and their materials may meet along
    closed interfaces only. Solids they do not resolve even at half the size are refused with the
    place.
    There is no bound on dihedral angles at the surface and where leaves of different sizes meet:
    they are measured (see `csgmesh.quality`), not proved. A leaf is half or twice its
    neighbour, so that edges lie between 0.6 and 1.4 times a size that varies. Chords of curved
    faces are as short as the domain's deviation asks for, even where the size allows longer ones.

    Mixed cells are
    tetrahedra where leaves of different sizes meet, and where the solid is thinner than about four
    sizes; so where the boundary needs down to two thirds of the one size that was asked for, or of
    the largest where none was, that smaller size holds everywhere.

    No size goes below a thousandth of the domain's diagonal for the sake of a wall, and walls take
    no more than a fiftieth of `max_points`: beyond that they are crossed by flatter cells, with
    edges of up to eight times the thickness. What is thinner still, and with it the cusps where two
    surfaces touch or all but touch, gets no finer cells at all: they would only be flatter. Where a
    mesh has thin walls ``info["walls"]`` has the ``thinnest`` as far as it was looked at, its
    ``place``, the ``smallest_size`` that walls led to, and the ``flat_area`` of the boundary where
    cells are flatter than asked for.

    Termination
    -----------
    Always: sizes are made smaller a bounded number of times where the surface cannot be filled; a
    `MeshingError` with the place ends what would take more, a `BudgetError` what takes more points
    than allowed.

    References
    ----------
    .. [1] F. Labelle, J. R. Shewchuk, "Isosurface stuffing", ACM Trans. Graphics 26 (2007).
    .. [2] N. Molino, R. Bridson, J. Teran, R. Fedkiw, "A crystalline, red green strategy for
       meshing highly deformable objects with tetrahedra", 12th Int. Meshing Roundtable (2003).
    .. [3] H. Si, "TetGen, a Delaunay-based quality tetrahedral mesh generator", ACM Trans.
       Mathematical Software 41 (2015).

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Box((0, 0, 0), (2, 1, 1)) - cm.Ball((1, 0.5, 0.5), 0.25), size=0.2)
    >>> mesh.names
    ('box.left', 'box.right', 'box.bottom', 'box.top', 'box.front', 'box.back', 'ball')
    """

    cells: str = "tetra"
    gradation: float = 0.3
    improve: bool = True
    max_points: int = 10**7
    walls: int = 1

    dim = 3

    def __post_init__(self) -> None:
        check_choice("cells", self.cells, CELLS, "Octree")
        checked = {
            "gradation": check_growth("gradation", self.gradation),
            "walls": check_whole("walls", self.walls, 0),
            "max_points": check_whole("max_points", self.max_points, 4),
            "improve": check_flag("improve", self.improve),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def generate(self, domain: Plc, size: Any = None, progress: Progress | None = None) -> Mesh:
        """Mesh a solid.

        Parameters
        ----------
        domain : Plc
        size : None, float, mapping, callable or SizeField
            Wanted edge length; without one curvature and features decide.
        progress : callable, optional
            Called as ``progress(stage, done, total)``.

        Returns
        -------
        Mesh
            With the domain's names and regions.

        Raises
        ------
        BudgetError
            If `max_points` do not suffice.
        MeshingError
            If no refinement of the surface can be filled; with the place.
        SizeError, NameLookupError
            If the size is not positive and finite somewhere, or names nothing.
        """
        if self.cells == "hexahedron":
            sizes = even_sizes(domain, size, self.gradation, self.max_points)
            return hexahedral_mesh(domain, sizes, max_points=self.max_points, progress=progress)
        filled, surface, grid, sizes = self._tetrahedra(domain, size, progress)
        info: dict[str, object] = {"method": "Octree", "options": dict(vars(self))}
        if sizes.walls is not None:
            info["walls"] = sizes.walls.info()
        if grid is None:
            return tetra_mesh(filled, surface, info)
        return mixed_mesh(filled, surface, grid, info)

    def _sizes(self, domain: Plc, size: Any) -> SpaceSizes:
        sizes = SpaceSizes.of(domain, size, self.gradation, self.max_points)
        if self.cells == "mixed":
            sizes = _even(sizes, resolve(size, domain), self.max_points)  # type: ignore[arg-type]
        return sizes.fit_for_walls(self.walls, self.max_points, self.max_points)

    def _tetrahedra(
        self, domain: Plc, size: Any, progress: Progress | None
    ) -> tuple[Tetrahedra, SurfaceMesh, Lattice | None, SpaceSizes]:
        told = progress or _silent

        def tell(stage: int) -> None:
            told(("surface", "lattice", "tetrahedra")[stage], stage, STAGES)

        surface, grid, filled, sizes = fill(
            domain, lambda d: self._sizes(d, size), self.max_points, progress, tell
        )
        # What is needed no more goes before memory is asked for.
        left = grid if self.cells == "mixed" else None
        del grid
        told("improve", 3, STAGES)
        if self.improve:
            better = improve_tetrahedra(
                filled.points,
                filled.tets,
                filled.region,
                filled.triangles,
                filled.face,
                surface,
                progress=progress,
            )
            filled = replace(
                filled,
                points=better[0],
                tets=better[1],
                region=better[2],
                triangles=better[3],
                face=better[4],
            )
        told("improve", STAGES, STAGES)
        return filled, surface, left, sizes


def _even(sizes: SpaceSizes, asked: ResolvedSize | None, max_points: int) -> SpaceSizes:
    """What the boundary needs everywhere, where that is not much smaller than the one size."""
    least = sizes.given.least
    varies = sizes.wanted is not None or (asked is not None and asked.boundary)
    if varies or sizes.uniform is not None or least < EVEN * sizes.largest:
        return sizes
    try:
        return SpaceSizes.of(sizes.domain, least, sizes.gradation, max_points)
    except BudgetError:
        return sizes


def even_sizes(domain: Plc, size: Any, gradation: float, max_points: int) -> Source:
    """What is asked for by any part of a size, as a function of points; or what the boundary needs.

    Raises
    ------
    SizeError, NameLookupError
        If the size is no size, or names nothing.
    """
    asked = resolve(size, domain)  # type: ignore[arg-type]
    if asked is None:
        return SpaceSizes.of(domain, None, gradation, max_points)
    sources = [source for _, source in (*asked.boundary, *asked.region)]
    if asked.default is not None:
        sources.append(asked.default)
    return lambda points: np.min([np.broadcast_to(s(points), len(points)) for s in sources], axis=0)


def tetra_mesh(filled: Tetrahedra, surface: SurfaceMesh, info: dict[str, object]) -> Mesh:
    """The mesh of tetrahedra, its facets named as the faces of the surface mesh."""
    cells, region = {"tetra": filled.tets}, {"tetra": filled.region}
    return _mesh(filled.points, cells, region, filled.triangles, filled.face, surface, info)


def mixed_mesh(
    filled: Tetrahedra, surface: SurfaceMesh, grid: Lattice, info: dict[str, object]
) -> Mesh:
    """The mesh with hexahedra, and pyramids around them, where the lattice is whole."""
    mixed = mixed_cells(filled.points, filled.tets, filled.region, grid)
    triangles = mixed.number[filled.triangles]
    return _mesh(mixed.points, mixed.cells, mixed.region, triangles, filled.face, surface, info)


def _mesh(
    points: np.ndarray,
    cells: dict[str, np.ndarray],
    region: dict[str, np.ndarray],
    triangles: np.ndarray,
    face: np.ndarray,
    surface: SurfaceMesh,
    info: dict[str, object],
) -> Mesh:
    domain = surface.plc
    return Mesh(
        points,
        cells,
        region,
        domain.region_names,
        {"triangle": triangles},
        {"triangle": surface.face_marker[face]},
        domain.boundary_names,
        {"triangle": surface.face_region[face]},
        domain=domain,  # type: ignore[arg-type]
        info=info,
    )


def _silent(stage: str, done: int, total: int) -> None:
    """Progress that nobody asked for."""

"""Structured grids: blocks of quads in rows and columns, with exact curved sides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.errors import BudgetError, InputError
from csgmesh.mesh import Mesh
from csgmesh.mesh.blocks import Block
from csgmesh.meshers.structured.counts import Counts
from csgmesh.meshers.structured.layout import Layout
from csgmesh.meshers.structured.outline import Outline
from csgmesh.meshers.structured.recognition import (
    Recognition,
    from_corners,
    from_names,
    round_loop,
)
from csgmesh.meshers.structured.rectilinear import Grid, frame_of
from csgmesh.meshers.structured.transfinite import Filling
from csgmesh.meshers.workspace import Progress
from csgmesh.options import check_choice
from csgmesh.size import resolve


@dataclass(frozen=True)
class Structured:
    """Blocks of quads in rows and columns, recognised from the boundary.

    Boxes, rectilinear domains and boxes with round holes or inclusions are split along straight
    lines; four-sided domains are one block; a ring is one block that closes on itself; a disk or an
    ellipse is a core with four blocks around it. Regions conform.

    Parameters
    ----------
    cells : {"quad", "triangle"}, default "quad"
        Whether to split each quad along its shorter diagonal.
    corners : sequence of four points, optional
        Corners of a four-sided domain. Default: where its boundary turns by more than 30 degrees.
    sides : sequence of four names, optional
        The sides of a four-sided domain, each of any number of curves, instead of corners.
    counts : mapping of str to int, optional
        Cells along named boundaries, instead of what the size asks for.
    spacing : mapping of str to str or tuple, optional
        Of the points along named boundaries, on the sides of blocks that lie on them, and along
        what lies opposite: ``"uniform"``, ``("geometric", ratio)`` with the ratio from each cell to
        the next, ``("tanh", strength)`` for short cells at both ends. Sides run with the domain on
        their left.
    max_points : int, default 10**7
        Bound on the number of points.

    Raises
    ------
    InputError
        If an option is out of range.

    Guarantees
    ----------
    Every cell is convex and counterclockwise, or there is an error. Boundary vertices lie on their
    exact curves, and each joint of two curves or names is a vertex. Opposite sides of a block have
    equally many cells, as many as the finest asks for. ``mesh.blocks`` tells the rows and columns.
    Curves are followed as closely as the domain's deviation, or as the counts given allow.

    Exceptions
    ----------
    Domains of other kinds, embedded paths and points: an error says which mesher can do them.
    Sizes between sides are interpolated; ones that vary inside only are not seen.

    Termination
    -----------
    Always, in time linear in the number of cells.

    References
    ----------
    .. [1] W. J. Gordon, C. A. Hall, "Construction of curvilinear co-ordinate systems and
       applications to mesh generation", Int. J. Numerical Methods in Engineering 7 (1973).
    .. [2] B. K. Soni, "Two- and three-dimensional grid generation for internal flow applications of
       computational fluid dynamics", AIAA 85-1526 (1985).
    .. [3] M. Vinokur, "On one-dimensional stretching functions for finite-difference calculations",
       J. Computational Physics 50 (1983).

    Examples
    --------
    >>> import csgmesh as cm
    >>> plate = cm.Box((0, 0), (1, 1), name="plate") - cm.Disk((0.5, 0.5), 0.2, name="hole")
    >>> mesh = cm.generate(plate, cm.Structured(counts={"hole": 32}), size=0.1)
    >>> mesh.n_cells, list(mesh.blocks)
    (160, ['domain', 'domain.2', 'domain.3', 'domain.4'])
    """

    cells: Literal["quad", "triangle"] = "quad"
    corners: Sequence[Sequence[float]] | None = None
    sides: Sequence[str] | None = None
    counts: Mapping[str, int] = field(default_factory=dict, hash=False)
    spacing: Mapping[str, Any] = field(default_factory=dict, hash=False)
    max_points: int = 10**7

    def __post_init__(self) -> None:
        check_choice("cells", self.cells, ("quad", "triangle"), "Structured")
        if self.corners is not None and self.sides is not None:
            raise InputError("a block has corners= or sides=, not both")
        for name in ("counts", "spacing"):
            if not isinstance(getattr(self, name), Mapping):
                raise InputError(
                    f"{name} must map names of boundaries; got {getattr(self, name)!r}"
                )
        if self.max_points < 4:
            raise InputError(f"max_points must be at least 4; got {self.max_points!r}")

    def generate(self, domain: Pslg, size: Any = None, progress: Progress | None = None) -> Mesh:
        """Mesh a domain.

        Parameters
        ----------
        domain : Pslg
            What to mesh.
        size : None, float, mapping, callable or SizeField
            Wanted edge length; without one a thirtieth of the domain's diagonal.
        progress : callable, optional
            Called as ``progress(stage, done, total)``.

        Raises
        ------
        MeshingError
            If the domain is of no kind that this mesher knows, or grid lines would fold; with the
            place.
        BudgetError
            If it would have more than `max_points` points.
        """
        if domain.periodic:
            raise InputError("Structured cannot mesh periodic sides alike; use DelaunayRefinement")
        report = progress or (lambda stage, done, total: None)
        wanted = resolve(size, domain)
        report("recognise blocks", 0, 1)
        layout = self._layout(domain)
        counts = Counts(layout, wanted, self.counts, self.spacing)
        n = sum(counts[b.bottom[0]] * counts[b.left[0]] for b in layout.blocks)
        if n > self.max_points:
            raise BudgetError(f"the grid would have {n} cells; max_points is {self.max_points}")
        filling = Filling(layout, counts, report)
        return self._assemble(domain, filling)

    def _layout(self, domain: Pslg) -> Layout:
        outline = Outline(domain)
        recognition = Recognition(outline)
        if self.sides is not None:
            from_names(recognition, self.sides)
            return recognition.layout
        if self.corners is not None:
            from_corners(recognition, self.corners)
            return recognition.layout
        faces = sorted(outline.faces, key=lambda face: -face.outer.area)
        frame = frame_of(outline)
        boxed = [f for f in faces if not round_loop(f.outer)]
        in_round = any(not round_loop(h) for f in faces if round_loop(f.outer) for h in f.holes)
        if frame is not None and boxed and not in_round:
            Grid(recognition, frame).lay_out()
            faces = [face for face in faces if round_loop(face.outer)]
        for face in faces:
            recognition.face(face)
        return recognition.layout

    def _assemble(self, domain: Pslg, filling: Filling) -> Mesh:
        counts = filling.counts
        region = np.repeat(
            [block.region for block in filling.layout.blocks], np.diff(filling.first_cell)
        )
        cells, blocks = filling.cells, filling.named_blocks()
        if self.cells == "triangle":
            cells = _split(filling.points, cells)
            region = np.repeat(region, 2)
            blocks = {
                name: Block(np.stack([2 * b.cells, 2 * b.cells + 1], axis=-1), b.points)
                for name, b in blocks.items()
            }
        for array in (filling.points, cells):
            array.flags.writeable = False
        if counts.is_given.any():
            domain = _remembered(domain, max(domain.deviation, counts.deviation * (1 + 1e-9)))
        return Mesh(
            points=filling.points,
            cells={self.cells: cells},
            cell_region={self.cells: region},
            region_names=domain.region_names,
            boundary_names=domain.boundary_names,
            curves=domain.curves,
            domain=domain,
            blocks=blocks,
            info={"method": "Structured", "options": asdict(self), "n_blocks": len(blocks)},
            **filling.facets(),
        )


def _split(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Two triangles a quad, by its shorter diagonal."""
    a, b, c, d = (points[quads[:, k]] for k in range(4))
    first = ((c - a) ** 2).sum(axis=1) <= ((d - b) ** 2).sum(axis=1) * (1 + 1e-12)
    way = np.where(first[:, None], [0, 1, 2, 0, 2, 3], [0, 1, 3, 1, 2, 3])
    return np.take_along_axis(quads, way, axis=1).reshape(-1, 3)


def _remembered(domain: Pslg, deviation: float) -> Pslg:
    """The domain, asked for with a larger deviation."""
    values = {name: getattr(domain, name) for name in domain.__dataclass_fields__}
    return Pslg.build(**(values | {"deviation": deviation}))

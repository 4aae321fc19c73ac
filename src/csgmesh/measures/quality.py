"""How good the cells of a mesh are."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from csgmesh.errors import InputError
from csgmesh.measures.jacobians import curved_areas, jacobian_bounds
from csgmesh.measures.shapes import CellMeasures, measure_cells
from csgmesh.measures.space.quality import space_quality
from csgmesh.measures.summary import extremes, headline, histogram, table
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.nodes import node_family
from csgmesh.mesh.surfaces import is_surface


@dataclass(frozen=True, eq=False, repr=False)
class Quality:
    """Measures of each cell of a mesh of the plane or of a surface, and their extremes.

    Arrays have an entry a cell, counted through all kinds in the order of ``mesh.cells``. Angles
    and edges of curved cells are measured by their corners. A printed Quality is a table with a
    histogram of the angles.

    Attributes
    ----------
    min_angle, max_angle : (n_cells,) float64
        Smallest and largest inner angle of each cell, degrees.
    scaled_jacobian : (n_cells,) float64
        Of quads: the smallest over the corners of ``det / (|a| |b|)``, with a and b the edges
        there; 1 for a rectangle, below 0 where the quad is not convex. NaN for triangles. Of curved
        cells: a lower bound on the Jacobian across the cell, over an upper one (Persson and Peraire
        2009); 1 where it is constant, below 0 where the cell may be turned over.
    sicn : (n_cells,) float64
        Of quads: the smallest over the corners of ``2 det / (a² + b²)``, the signed inverse
        condition number; 1 for a square. NaN for triangles.
    min_edge, max_edge : (n_cells,) float64
        Shortest and longest edge of each cell.
    area : (n_cells,) float64
        Signed area of each cell; exact for curved ones too.
    n_points, n_cells : int
    n_by_kind : dict of str to int
        Number of cells of each kind.
    """

    min_angle: np.ndarray
    max_angle: np.ndarray
    scaled_jacobian: np.ndarray
    sicn: np.ndarray
    min_edge: np.ndarray
    max_edge: np.ndarray
    area: np.ndarray
    n_points: int
    n_cells: int
    n_by_kind: dict[str, int]

    @property
    def extremes(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest value of each measure; those that no cell has are left out."""
        return extremes(self._measures)

    @property
    def _measures(self) -> dict[str, np.ndarray]:
        return {name: getattr(self, name) for name in _LABELS}

    @property
    def total_area(self) -> float:
        """Sum of the cells' areas."""
        return float(self.area.sum())

    def __repr__(self) -> str:
        kinds = ", ".join(f"{n:,} {kind}" for kind, n in self.n_by_kind.items())
        if not self.n_cells:
            return "<Quality: no cells>"
        low, high = self.extremes["min_angle"][0], self.extremes["max_angle"][1]
        return f"<Quality: {kinds}; angles {low:.2f}° to {high:.2f}°>"

    def __str__(self) -> str:
        lines = [headline(self.n_points, self.n_by_kind)]
        if not self.n_cells:
            return lines[0]
        lines += [f"area {self.total_area:.10g}", "", *table(_LABELS, self._measures), ""]
        if "triangle" in self.n_by_kind or len(self.n_by_kind) > 1:
            lines += ["smallest angle of the cells", *histogram(self.min_angle, 0.0, 90.0, 9)]
        else:
            lines += ["scaled Jacobian", *histogram(self.scaled_jacobian, 0.0, 1.0, 10)]
        return "\n".join(lines)


_LABELS = {
    "min_angle": "smallest angle °",
    "max_angle": "largest angle °",
    "scaled_jacobian": "scaled Jacobian",
    "sicn": "SICN",
    "min_edge": "shortest edge",
    "max_edge": "longest edge",
    "area": "cell area",
}


def quality(mesh: Mesh) -> Any:
    """Measure the cells of a mesh.

    Parameters
    ----------
    mesh : Mesh
        Of the plane, of space, or of a surface in it, whose cells are measured by their corners.

    Returns
    -------
    Quality or SpaceQuality
        Arrays with an entry a cell, extremes, and a printable table.

    Raises
    ------
    InputError
        If a cell names a point that does not exist.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], {"triangle": [[0, 1, 2], [0, 2, 3]]})
    >>> print(cm.quality(mesh))
    4 points, 2 cells (2 triangle)
    area 1
    <BLANKLINE>
                          smallest        mean     largest
    smallest angle °            45          45          45
    largest angle °             90          90          90
    shortest edge                1           1           1
    longest edge            1.4142      1.4142      1.4142
    cell area                  0.5         0.5         0.5
    <BLANKLINE>
    smallest angle of the cells
      40 to 50   2  ########################################
    """
    if not isinstance(mesh, Mesh):
        raise InputError(f"quality needs a Mesh, as generate returns; got {type(mesh).__name__}")
    if mesh.dim == 3 and not is_surface(mesh):
        return space_quality(mesh)
    parts = []
    for kind, rows in mesh.cells.items():
        corners = rows[:, : KINDS[kind].n_corners]
        points = mesh.points
        if mesh.dim == 3:
            points, corners = _laid_flat(points[corners])
        measures = measure_cells(points, corners)
        if mesh.dim == 2 and KINDS[kind].order > 1:
            measures = _of_curved(mesh, kind, measures)
        parts.append(measures)
    joined = {
        f.name: np.concatenate([np.zeros(0), *(getattr(part, f.name) for part in parts)])
        for f in fields(CellMeasures)
    }
    counts = {kind: len(rows) for kind, rows in mesh.cells.items()}
    return Quality(**joined, n_points=mesh.n_points, n_cells=mesh.n_cells, n_by_kind=counts)


def _laid_flat(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cells (m, 3 or 4, 3), each in a plane of its own: points (k, 2) and rows of numbers.

    The plane of a warped quad is parallel to both diagonals.
    """
    m, k, _ = corners.shape
    away = corners - corners[:, :1]
    first = away[:, k - 2]
    normal = np.cross(first, corners[:, -1] - corners[:, k - 3])
    first, normal = (
        v / np.maximum(np.sqrt((v * v).sum(1)), 1e-300)[:, None] for v in (first, normal)
    )
    axes = np.stack([first, np.cross(normal, first)], axis=2)
    return (away @ axes).reshape(-1, 2), np.arange(m * k).reshape(m, k)


def _of_curved(mesh: Mesh, kind: str, straight: CellMeasures) -> CellMeasures:
    """Area and scaled Jacobian of curved cells in place of those of their straight counterparts."""
    if kind == "quad8":
        return straight
    nodes, family = mesh.points[mesh.cells[kind]], node_family(mesh)
    area = curved_areas(nodes, kind, family)
    ratio = jacobian_bounds(nodes, kind, family).ratio
    return replace(straight, area=area, scaled_jacobian=ratio)

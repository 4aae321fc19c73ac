"""How good the cells of a mesh of space are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.errors import InputError
from csgmesh.measures.space.curved import curved_volumes, tetra_bounds
from csgmesh.measures.space.jacobians import least_jacobians
from csgmesh.measures.summary import extremes, headline, histogram, table
from csgmesh.mesh import KINDS, Mesh


@dataclass(frozen=True, eq=False, repr=False)
class SpaceQuality:
    """Measures of each cell of a mesh of space, and their extremes.

    Arrays have an entry a cell, counted through all kinds in the order of ``mesh.cells``. A printed
    SpaceQuality is a table with a histogram of the dihedral angles.

    Attributes
    ----------
    min_dihedral, max_dihedral : (n_cells,) float64
        Smallest and largest angle between two faces along an edge, degrees; where faces are not
        flat, at the ends of the edge.
    scaled_jacobian : (n_cells,) float64
        Of hexahedra: the smallest over the corners of the determinant of the unit vectors along the
        three edges; 1 for a box, below 0 where the corner is turned inside out. Of curved
        tetrahedra: a lower bound of the Jacobian across the cell over an upper one. NaN for others.
    min_jacobian : (n_cells,) float64
        A lower bound of the Jacobian determinant over the whole cell, relative to its mean;
        positive exactly where the cell is valid everywhere.
    min_edge, max_edge : (n_cells,) float64
    volume : (n_cells,) float64
        Of faces that are bilinear where they are not flat, exact for curved cells; negative for
        cells inside out.
    n_points, n_cells : int
    n_by_kind : dict of str to int
    """

    min_dihedral: np.ndarray
    max_dihedral: np.ndarray
    scaled_jacobian: np.ndarray
    min_jacobian: np.ndarray
    min_edge: np.ndarray
    max_edge: np.ndarray
    volume: np.ndarray
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
    def total_volume(self) -> float:
        """Sum of the cells' volumes."""
        return float(self.volume.sum())

    def __repr__(self) -> str:
        kinds = ", ".join(f"{n:,} {kind}" for kind, n in self.n_by_kind.items())
        if not self.n_cells:
            return "<SpaceQuality: no cells>"
        low, high = self.extremes["min_dihedral"][0], self.extremes["max_dihedral"][1]
        return f"<SpaceQuality: {kinds}; dihedral angles {low:.2f}° to {high:.2f}°>"

    def __str__(self) -> str:
        lines = [headline(self.n_points, self.n_by_kind)]
        if not self.n_cells:
            return lines[0]
        lines += [f"volume {self.total_volume:.10g}", "", *table(_LABELS, self._measures)]
        lines += ["", "smallest dihedral angle of the cells"]
        return "\n".join([*lines, *histogram(self.min_dihedral, 0.0, 90.0, 9)])


_LABELS = {
    "min_dihedral": "smallest dihedral °",
    "max_dihedral": "largest dihedral °",
    "scaled_jacobian": "scaled Jacobian",
    "min_jacobian": "least Jacobian",
    "min_edge": "shortest edge",
    "max_edge": "longest edge",
    "volume": "cell volume",
}


def space_quality(mesh: Mesh) -> SpaceQuality:
    """Measure the cells of a mesh of space; see `csgmesh.quality`.

    Examples
    --------
    >>> import csgmesh as cm
    >>> corner = cm.Mesh(
    ...     [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], {"tetra": [[0, 1, 2, 3]]}
    ... )
    >>> space_quality(corner)
    <SpaceQuality: 1 tetra; dihedral angles 54.74° to 90.00°>
    """
    parts: list[list[np.ndarray]] = []
    for kind, rows in mesh.cells.items():
        if rows.size and not 0 <= rows.min() <= rows.max() < mesh.n_points:
            raise InputError(
                f"{kind} cells must name points 0 to {mesh.n_points - 1}; "
                f"got {rows.min()} to {rows.max()}"
            )
        measures = _measured(mesh.points, kind, rows[:, : KINDS[kind].n_corners])
        parts.append(_curved(mesh.points[rows], measures) if kind == "tetra10" else measures)
    empty = [np.zeros(0)] * len(_LABELS)
    columns = [np.concatenate(column) for column in zip(empty, *parts, strict=True)]
    counts = {kind: len(rows) for kind, rows in mesh.cells.items()}
    joined = dict(zip(_LABELS, columns, strict=True))
    return SpaceQuality(**joined, n_points=mesh.n_points, n_cells=mesh.n_cells, n_by_kind=counts)


def _measured(points: np.ndarray, kind: str, rows: np.ndarray) -> list[np.ndarray]:
    """The measures of the cells of one kind, in the order of the attributes."""
    corners = points[rows]
    base = KINDS[kind].straight
    low, high = np.full(len(rows), np.inf), np.full(len(rows), -np.inf)
    for at, along, left, right in _fans(base):
        angle = _dihedral(*(corners[:, k] - corners[:, at] for k in (along, left, right)))
        np.fmin(low, angle, out=low)
        np.fmax(high, angle, out=high)
    ends = [corners[:, b] - corners[:, a] for a, b in KINDS[base].edges]
    lengths = [np.sqrt((e * e).sum(axis=1)) for e in ends]
    volume = _volumes(corners, base)
    mean = volume / {"tetra": 1 / 6, "hexahedron": 1.0, "wedge": 0.5, "pyramid": 1 / 3}[base]
    least = least_jacobians(points, base, rows)
    with np.errstate(divide="ignore", invalid="ignore"):
        least = least / np.abs(mean)
    jacobian = np.full(len(rows), np.nan)
    if base == "hexahedron":
        jacobian = _scaled_jacobian(corners)
    shortest, longest = np.minimum.reduce(lengths), np.maximum.reduce(lengths)
    return [low, high, jacobian, least, shortest, longest, volume]


def _curved(nodes: np.ndarray, straight: list[np.ndarray]) -> list[np.ndarray]:
    """Volumes and Jacobians of curved tetrahedra in place of those of the straight ones."""
    low, high, _, _, shortest, longest, _ = straight
    volume, bounds = curved_volumes(nodes), tetra_bounds(nodes)
    with np.errstate(divide="ignore", invalid="ignore"):
        least = bounds.least / np.abs(6.0 * volume)
    return [low, high, bounds.ratio, least, shortest, longest, volume]


def _fans(kind: str) -> list[tuple[int, int, int, int]]:
    """For each corner and edge there: corner, other end, and the next corners in both faces."""
    after: dict[tuple[int, int], int] = {}
    before: dict[tuple[int, int], int] = {}
    for face in KINDS[kind].facets:
        for k, v in enumerate(face):
            previous, following = face[k - 1], face[(k + 1) % len(face)]
            after[v, previous] = following
            before[v, following] = previous
    return [(v, w, after[v, w], before[v, w]) for v, w in sorted(after)]


def _dihedral(along: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Angles between the planes (along, left) and (along, right), degrees."""
    a, b = np.cross(along, left), np.cross(along, right)
    length = np.sqrt((along * along).sum(axis=1))
    sine = (np.cross(a, b) * along).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.degrees(np.arctan2(np.abs(sine) / length, (a * b).sum(axis=1)))


def _volumes(corners: np.ndarray, kind: str) -> np.ndarray:
    """Volumes inside faces that are flat triangles or bilinear quads."""
    centre = corners.mean(axis=1)
    total = np.zeros(len(corners))
    for face in KINDS[kind].facets:
        p = [corners[:, k] - centre for k in face]
        if len(p) == 3:
            total += (p[0] * np.cross(p[1], p[2])).sum(axis=1) / 6.0
            continue
        # A bilinear face is the mean of its two triangulations, as far as volume goes.
        for a, b, c in ((0, 1, 2), (0, 2, 3), (1, 2, 3), (1, 3, 0)):
            total += (p[a] * np.cross(p[b], p[c])).sum(axis=1) / 12.0
    return total


def _scaled_jacobian(corners: np.ndarray) -> np.ndarray:
    least = np.full(len(corners), np.inf)
    for k in range(8):
        top = 4 * (k // 4)
        following, previous = top + (k + 1) % 4, top + (k - 1) % 4
        other = (k + 4) % 8
        a, b, c = (corners[:, j] - corners[:, k] for j in (following, previous, other))
        size = np.sqrt((a * a).sum(1) * (b * b).sum(1) * (c * c).sum(1))
        with np.errstate(divide="ignore", invalid="ignore"):
            value = (a * np.cross(b, c)).sum(axis=1) / size
        np.fmin(least, value if top == 0 else -value, out=least)
    return least

"""A size given by values on a mesh or a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.errors import SizeError
from csgmesh.mesh import KINDS, Mesh
from csgmesh.size.field import SizeField, Source, require_plane
from csgmesh.size.sources import GradedSources

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg


@dataclass(frozen=True, eq=False)
class BackgroundSize(SizeField):
    """Sizes known at the points of a mesh or of a grid, linear between them.

    Outside the mesh or grid the size is that of its nearest boundary point.

    Parameters
    ----------
    background : Mesh or (x, y)
        A plane mesh, or the increasing coordinates of a grid's lines, (nx,) and (ny,).
    values : array_like (n_points,) or (nx, ny)
        Wanted edge length at each point of the mesh, or at each crossing ``(x[i], y[j])``.

    Raises
    ------
    SizeError
        If the values do not fit, or one is not positive and finite.

    Examples
    --------
    >>> import csgmesh as cm
    >>> field = cm.BackgroundSize(([0, 1], [0, 1]), [[0.1, 0.1], [0.3, 0.3]])
    >>> h = field.bind(cm.evaluate(cm.Box((0, 0), (1, 1))))
    >>> h(np.array([[0.5, 0.5], [2.0, 0.0]])).round(6)
    array([0.2, 0.3])
    """

    background: Mesh | Sequence[Sequence[float]]
    values: Any

    def __post_init__(self) -> None:
        try:
            values = np.array(self.values, float)
        except (TypeError, ValueError):
            raise SizeError("BackgroundSize: values must be numbers") from None
        wanted: tuple[int, ...]
        if isinstance(self.background, Mesh):
            wanted = (self.background.n_points,)
        else:
            axes = _grid_lines(self.background)
            object.__setattr__(self, "background", axes)
            wanted = tuple(map(len, axes))
        if values.shape != wanted:
            raise SizeError(f"BackgroundSize: values must have shape {wanted}; got {values.shape}")
        if not (np.isfinite(values) & (values > 0)).all():
            wrong = values[~(np.isfinite(values) & (values > 0))][0]
            raise SizeError(f"BackgroundSize: values must be positive and finite; got {wrong:g}")
        values.flags.writeable = False
        object.__setattr__(self, "values", values)

    def bind(self, domain: Pslg) -> Source:
        """The interpolated values, which do not depend on the domain."""
        require_plane(domain, "BackgroundSize")
        if isinstance(self.background, Mesh):
            return on_mesh(self.background, self.values)
        return _OnGrid(self.background, self.values)


def _grid_lines(background: Any) -> tuple[np.ndarray, np.ndarray]:
    try:
        x, y = (np.array(line, float) for line in background)
    except (TypeError, ValueError):
        raise SizeError(
            "BackgroundSize: background must be a Mesh, or the coordinates (x, y) of grid lines; "
            f"got {type(background).__name__}"
        ) from None
    for name, line in (("x", x), ("y", y)):
        if line.ndim != 1 or len(line) < 2 or not (np.diff(line) > 0).all():
            raise SizeError(
                f"BackgroundSize: {name} must be two or more increasing coordinates; got {line}"
            )
    return x, y


def on_mesh(mesh: Mesh, values: np.ndarray) -> Source:
    """Values at the points of a mesh as a function of place: linear in cells, constant beyond."""
    return _OnMesh(mesh, values)


class _OnMesh:
    """Values at the points of a mesh, linear in its cells."""

    def __init__(self, mesh: Mesh, values: np.ndarray) -> None:
        self.mesh, self.values = mesh, values
        self.edges = outer_edges(mesh)
        self.outside = GradedSources(mesh.points[self.edges], np.zeros(len(self.edges)), 0.0, 1.0)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        out = self.mesh.interpolate(self.values, points)
        beyond = np.flatnonzero(np.isnan(out))
        if len(beyond):
            edge = self.edges[self.outside.lowest(points[beyond])[1]]
            a, b = self.mesh.points[edge[:, 0]], self.mesh.points[edge[:, 1]]
            along = ((points[beyond] - a) * (b - a)).sum(1) / ((b - a) ** 2).sum(1)
            share = np.clip(along, 0.0, 1.0)
            out[beyond] = (1 - share) * self.values[edge[:, 0]] + share * self.values[edge[:, 1]]
        return out


class _OnGrid:
    """Values at the crossings of a grid, bilinear between them."""

    def __init__(self, lines: Any, values: np.ndarray) -> None:
        self.x, self.y = lines
        self.values = values

    def __call__(self, points: np.ndarray) -> np.ndarray:
        i, s = _between(self.x, points[:, 0])
        j, t = _between(self.y, points[:, 1])
        v = self.values
        low = (1 - s) * v[i, j] + s * v[i + 1, j]
        return (1 - t) * low + t * ((1 - s) * v[i, j + 1] + s * v[i + 1, j + 1])


def _between(line: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The grid line before each x, and the share of the way to the next; clipped outside."""
    i = np.clip(np.searchsorted(line, x, side="right") - 1, 0, len(line) - 2)
    return i, np.clip((x - line[i]) / (line[i + 1] - line[i]), 0.0, 1.0)


def cell_edges(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Edges between the corners of a plane mesh's cells, (k, 2), and in how many cells each is."""
    rows = [np.zeros((0, 2), np.int64)]
    for kind, cells in mesh.cells.items():
        corners = cells[:, : KINDS[kind].n_corners]
        rows.append(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2))
    low, high = np.sort(np.concatenate(rows), axis=1).T
    key, count = np.unique(low * mesh.n_points + high, return_counts=True)
    return np.stack([key // mesh.n_points, key % mesh.n_points], axis=1), count


def outer_edges(mesh: Mesh) -> np.ndarray:
    """Edges (k, 2) that belong to one cell only."""
    edges, count = cell_edges(mesh)
    return edges[count == 1]

"""The result: points, cells and named facets as frozen arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from csgmesh.mesh.blocks import Block, frozen_blocks
from csgmesh.mesh.description import counted, listed, same
from csgmesh.mesh.fields import by_kind, connectivity, frozen, lineage, marker_names, point_array
from csgmesh.mesh.periodic import PeriodicPair, representatives

if TYPE_CHECKING:
    from csgmesh.domain.curves import Curves
    from csgmesh.domain.pslg import Pslg
    from csgmesh.mesh.locate import Locator
    from csgmesh.mesh.solid_location import SolidLocator

Arrays = Mapping[str, np.ndarray]


@dataclass(frozen=True, eq=False, repr=False)
class Mesh:
    """A mesh with named regions and boundaries.

    Arrays are read-only, C-contiguous, float64 or int64; those given writeable are copied.
    Shapes are checked here, meaning by `csgmesh.check`.

    Parameters
    ----------
    points : array_like (n, dim)
        Coordinates, dim 2 or 3.
    cells : mapping of str to array_like (m, k)
        Connectivity by kind (`triangle`, `quad`, `tetra`, ... as in meshio), counterclockwise.
    cell_region : mapping of str to array_like (m,), optional
        Region of each cell, into `region_names`. Default: all 0.
    region_names : sequence of str, optional
        Default ``("domain",)``.
    facets : mapping of str to array_like (m, k), optional
        Boundary and interface facets and embedded paths, by kind (`line` in the plane).
    facet_marker : mapping of str to array_like (m,), optional
        Into `boundary_names`; -1 for an unnamed facet, the default.
    boundary_names : sequence of sequences of str, optional
        For each marker all the part names its facets lie on.
    facet_region : mapping of str to array_like (m, 2), optional
        Regions on the left and the right (inner and outer) side, -1 outside.
    facet_curve : mapping of str to array_like (m,), optional
        Exact curve of each facet, into `curves`; -1 where the chord itself is exact.
    facet_interval : mapping of str to array_like (m, 2), optional
        Parameters of the facet's two ends on its curve.
    point_marker : array_like (n,), optional
        Names of embedded points, into `boundary_names`; -1 for all others.
    curves : Curves, optional
        The exact curves; None for a mesh read from a file.
    domain : Pslg, optional
        What was meshed; None for a mesh read from a file.
    cell_parent : mapping of str to array_like (m,), optional
        Of refined meshes: the cell of the coarser one, counted through all kinds.
    cell_green : mapping of str to array_like (m,), optional
        Cells of one green closure, undone before the next refinement, share a number; others -1.
    periodic : sequence of PeriodicPair, optional
        Sides whose points and facets match; see `csgmesh.Periodic`.
    info : mapping, optional
        Facts from the mesher: its name, the angle asked for, how many points it inserted.
    blocks : mapping of str to Block, optional
        The blocks of a structured grid, with cells and points numbered by i and j.

    Raises
    ------
    InputError
        If a shape, type or kind is wrong, or a cell or facet names a point that is not there.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
    <Mesh 2D: 3 points, 1 triangle, 0 facets, regions: domain>
    """

    points: np.ndarray
    cells: Arrays
    cell_region: Arrays = field(default_factory=dict)
    region_names: tuple[str, ...] = ("domain",)
    facets: Arrays = field(default_factory=dict)
    facet_marker: Arrays = field(default_factory=dict)
    boundary_names: tuple[tuple[str, ...], ...] = ()
    facet_region: Arrays = field(default_factory=dict)
    facet_curve: Arrays = field(default_factory=dict)
    facet_interval: Arrays = field(default_factory=dict)
    point_marker: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    curves: Curves | None = None
    domain: Pslg | None = None
    info: Mapping[str, object] = field(default_factory=dict)
    blocks: Mapping[str, Block] = field(default_factory=dict)
    cell_parent: Arrays = field(default_factory=dict)
    cell_green: Arrays = field(default_factory=dict)
    periodic: tuple[PeriodicPair, ...] = ()

    def __post_init__(self) -> None:
        points = point_array(self.points)
        dim = points.shape[1]
        cells = connectivity("cells", self.cells, tuple(range(2, dim + 1)), len(points))
        facets = connectivity("facets", self.facets, (dim - 1,), len(points))
        marker = self.point_marker
        if not np.size(marker):
            marker = np.full(len(points), -1)
        new: dict[str, Any] = {
            "points": points,
            "cells": cells,
            "cell_region": by_kind("cell_region", self.cell_region, cells, (), 0),
            **lineage({"cell_parent": self.cell_parent, "cell_green": self.cell_green}, cells),
            "region_names": tuple(str(name) for name in self.region_names),
            "facets": facets,
            "facet_marker": by_kind("facet_marker", self.facet_marker, facets, (), -1),
            "boundary_names": marker_names(self.boundary_names),
            "facet_region": by_kind("facet_region", self.facet_region, facets, (2,), -1),
            "facet_curve": by_kind("facet_curve", self.facet_curve, facets, (), -1),
            "facet_interval": by_kind("facet_interval", self.facet_interval, facets, (2,), 0.0),
            "point_marker": frozen("point_marker", marker, np.int64, (len(points),)),
            "periodic": tuple(self.periodic),
            "info": MappingProxyType(dict(self.info)),
            "blocks": frozen_blocks(self.blocks),
        }
        for name, value in new.items():
            object.__setattr__(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        plain = [getattr(self, f.name) for f in fields(self)]
        return Mesh, tuple(dict(v) if isinstance(v, MappingProxyType) else v for v in plain)

    def __repr__(self) -> str:
        cells = ", ".join(counted(len(rows), kind) for kind, rows in self.cells.items())
        text = f"<Mesh {self.dim}D: {counted(self.n_points, 'point')}, {cells or 'no cells'}, "
        text += f"{counted(self.n_facets, 'facet')}, regions: {listed(self.region_names)}"
        return text + (f", boundaries: {listed(self.names)}>" if self.names else ">")

    @property
    def dim(self) -> int:
        """Dimension of space, 2 or 3."""
        return int(self.points.shape[1])

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def n_cells(self) -> int:
        """Number of cells of all kinds."""
        return sum(len(rows) for rows in self.cells.values())

    @property
    def n_facets(self) -> int:
        """Number of boundary, interface and embedded facets of all kinds."""
        return sum(len(rows) for rows in self.facets.values())

    @property
    def names(self) -> tuple[str, ...]:
        """All names of boundaries, interfaces and embedded entities, in order of appearance."""
        return tuple(dict.fromkeys(name for entry in self.boundary_names for name in entry))

    def boundary(self, name: str) -> dict[str, np.ndarray]:
        """Facets that carry a name.

        Parameters
        ----------
        name : str
            An exact name, a prefix (`plate` stands for all of `plate.*`) or a glob.

        Returns
        -------
        dict of str to ndarray of int64
            Facet numbers by kind, rows of ``mesh.facets[kind]``.

        Raises
        ------
        NameLookupError
            If nothing has that name; with suggestions.

        Examples
        --------
        >>> import csgmesh as cm
        >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]},
        ...                facets={"line": [[0, 1], [1, 2], [2, 0]]},
        ...                facet_marker={"line": [0, 1, 0]}, boundary_names=[["wall"], ["door"]])
        >>> mesh.boundary("wall")
        {'line': array([0, 2])}
        """
        markers = self._markers(name)
        return {k: np.flatnonzero(np.isin(m, markers)) for k, m in self.facet_marker.items()}

    def boundary_points(self, name: str) -> np.ndarray:
        """Numbers of the points on all facets that carry a name, embedded points included.

        Parameters
        ----------
        name : str
            An exact name, a prefix or a glob.

        Returns
        -------
        ndarray of int64
            Sorted point numbers.

        Examples
        --------
        >>> import csgmesh as cm
        >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]},
        ...                facets={"line": [[0, 1], [1, 2], [2, 0]]},
        ...                facet_marker={"line": [0, 1, 0]}, boundary_names=[["wall"], ["door"]])
        >>> mesh.boundary_points("door")
        array([1, 2])
        """
        markers = self._markers(name)
        parts = [np.flatnonzero(np.isin(self.point_marker, markers))]
        parts += [self.facets[kind][rows].ravel() for kind, rows in self.boundary(name).items()]
        return np.unique(np.concatenate(parts))

    def region(self, name: str) -> dict[str, np.ndarray]:
        """Cells of a region.

        Parameters
        ----------
        name : str
            An exact name, a prefix or a glob.

        Returns
        -------
        dict of str to ndarray of int64
            Cell numbers by kind, rows of ``mesh.cells[kind]``.

        Raises
        ------
        NameLookupError
            If no region has that name; with suggestions.

        Examples
        --------
        >>> import csgmesh as cm
        >>> cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]}).region("domain")
        {'triangle': array([0])}
        """
        regions = self._regions(name)
        return {k: np.flatnonzero(np.isin(r, regions)) for k, r in self.cell_region.items()}

    def interface(self, a: str, b: str) -> dict[str, np.ndarray]:
        """Facets between two regions.

        Parameters
        ----------
        a, b : str
            Regions on the two sides: exact names, prefixes or globs.

        Returns
        -------
        dict of str to ndarray of int64
            Facet numbers by kind; empty arrays where the regions do not touch.

        Examples
        --------
        >>> import csgmesh as cm
        >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1], [1, 1]],
        ...                {"triangle": [[0, 1, 2], [1, 3, 2]]}, {"triangle": [0, 1]},
        ...                ["rock", "core"], facets={"line": [[1, 2]]},
        ...                facet_region={"line": [[0, 1]]})
        >>> mesh.interface("rock", "core")
        {'line': array([0])}
        """
        left, right = self._regions(a), self._regions(b)
        found = {}
        for kind, sides in self.facet_region.items():
            is_left, is_right = np.isin(sides, left), np.isin(sides, right)
            both = (is_left[:, 0] & is_right[:, 1]) | (is_left[:, 1] & is_right[:, 0])
            found[kind] = np.flatnonzero(both & (sides[:, 0] != sides[:, 1]))
        return found

    def periodic_representatives(self) -> np.ndarray:
        """One of the points that periodicity identifies with each point: the lowest number.

        Returns
        -------
        ndarray (n_points,) of int64
            Where pairs meet, at corners, all points of an orbit have one representative.

        Examples
        --------
        >>> import csgmesh as cm
        >>> cell = cm.Periodic(cm.Box((0, 0), (1, 1)), [("box.left", "box.right"),
        ...                                             ("box.bottom", "box.top")])
        >>> cm.generate(cell, cm.ConstrainedDelaunay()).periodic_representatives()
        array([0, 0, 0, 0])
        """
        return representatives(self.n_points, self.periodic)

    def locate(self, points: ArrayLike) -> np.ndarray:
        """Numbers of the cells that contain points.

        Parameters
        ----------
        points : array_like (n, dim)
            Where to look; a single point counts as one row.

        Returns
        -------
        ndarray (n,) of int64
            Cell numbers, counted through all kinds in the order of `cells`; -1 outside the mesh.
            A point that several cells share gets the lowest of their numbers. Decided exactly, by
            the corners of curved cells; a warped face is two triangles at its lowest corner.

        Examples
        --------
        >>> import csgmesh as cm
        >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
        >>> mesh.locate([[0.5, 0.5], [0.6, 0.5]])
        array([ 0, -1])
        """
        return self._finder.cells_of(points)

    def interpolate(self, values: ArrayLike, points: ArrayLike) -> np.ndarray:
        """Values at points from values at the vertices, as cells are mapped: bilinear on quads.

        Parameters
        ----------
        values : array_like (n_points,) or (n_points, k)
            A value, or a row of them, at each point of the mesh.
        points : array_like (m, dim)
            Where to evaluate; a single point counts as one row.

        Returns
        -------
        ndarray (m,) or (m, k) of float64
            NaN outside the mesh.

        Raises
        ------
        InputError
            If there is not one value a point.

        Examples
        --------
        >>> import csgmesh as cm
        >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
        >>> mesh.interpolate([0, 1, 2], [[0.5, 0.5], [2, 2]])
        array([1.5, nan])
        """
        return self._finder.interpolate(values, points)

    def equals(self, other: Mesh) -> bool:
        """Whether all arrays and names are the same, to the last bit, but for `info` and `blocks`.

        Examples
        --------
        >>> import csgmesh as cm
        >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
        >>> mesh.equals(cm.Mesh(mesh.points, mesh.cells))
        True
        """
        if not isinstance(other, Mesh):
            return False
        compared = (f.name for f in fields(self) if f.name not in _NOT_COMPARED)
        if not all(same(getattr(self, n), getattr(other, n)) for n in compared):
            return False
        if self.curves is None or other.curves is None:
            return self.curves is other.curves
        mine, theirs = self.curves, other.curves
        return all(same(getattr(mine, n), getattr(theirs, n)) for n in ("kind", "data"))

    def _markers(self, pattern: str) -> np.ndarray:
        from csgmesh.domain.names import find_markers

        return np.asarray(find_markers(pattern, self.boundary_names))

    def _regions(self, pattern: str) -> np.ndarray:
        from csgmesh.domain.names import find_names

        found = set(find_names(pattern, self.region_names, what="region"))
        return np.array([i for i, name in enumerate(self.region_names) if name in found])

    @cached_property
    def locator(self) -> Locator:
        """Search structure behind `locate` of a plane mesh, built at its first use."""
        from csgmesh.mesh.locate import Locator

        return Locator.of(self.points, self.cells)

    @cached_property
    def _finder(self) -> Locator | SolidLocator:
        from csgmesh.mesh.solid_location import SolidLocator

        return self.locator if self.dim == 2 else SolidLocator.of(self.points, self.cells)


_NOT_COMPARED = ("curves", "domain", "info", "blocks")

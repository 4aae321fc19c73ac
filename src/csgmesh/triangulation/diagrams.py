"""Voronoi diagrams, clipped to a domain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from csgmesh.boundary import evaluate
from csgmesh.domain import Pslg
from csgmesh.errors import InputError
from csgmesh.mesh import Mesh
from csgmesh.triangulation.clipping import Clip
from csgmesh.triangulation.points import circles, plane_points, triangulate

#: Points far away that close the cells of the outermost sites: how many, and how far, in diagonals
#: of sites and domain. What lies within is nearer to any site than to these.
_FAR, _DISTANCE = 16, 8.0
#: Without a domain cells end at the box of the sites, widened by this share of its diagonal.
_MARGIN = 0.1


@dataclass(frozen=True, eq=False, repr=False)
class Voronoi:
    """A Voronoi diagram.

    Attributes
    ----------
    sites : (n, 2) float64
    cells : tuple of tuple of ndarray
        The cell of each site as rings (k, 2), not closed: outer ones counterclockwise, holes
        clockwise. More than one where the domain cuts the cell into parts, none where it lies
        outside.
    areas : (n,) float64
    """

    sites: np.ndarray
    cells: tuple[tuple[np.ndarray, ...], ...]
    areas: np.ndarray

    def __repr__(self) -> str:
        return f"<Voronoi: {len(self.sites)} sites, area {self.areas.sum():.6g}>"


def voronoi(points: ArrayLike | Mesh, domain: Any = None) -> Voronoi:
    """The Voronoi diagram of points: for each the part of the domain that is nearest to it.

    The dual of the Delaunay triangulation: the centres of its balls are the corners of the cells.

    Parameters
    ----------
    points : (n, 2) array_like or Mesh
        Sites, all different; of a mesh its points, and its domain.
    domain : Shape, Regions, Pslg or Mesh, optional
        What the cells are clipped to, curves by their chords; of a mesh its outer facets. Default:
        the box of the points, wider by a tenth of its diagonal on each side.

    Returns
    -------
    Voronoi

    Raises
    ------
    InputError
        If two points are the same, or there are none.

    Examples
    --------
    >>> import csgmesh as cm
    >>> diagram = cm.voronoi([[0.25, 0.5], [0.75, 0.5]], cm.Box((0, 0), (1, 2)))
    >>> diagram.areas
    array([1., 1.])
    """
    if isinstance(points, Mesh):
        domain = points if domain is None else domain
        points = points.points
    sites = plane_points(points)
    if not len(sites):
        raise InputError("a Voronoi diagram needs a site; got none")
    clip = Clip(*_outline(sites, domain))
    corners, begin = _open_cells(sites, clip.points)
    cells, areas = clip.cells(corners, begin)
    return Voronoi(sites, cells, areas)


def _outline(sites: np.ndarray, domain: Any) -> tuple[np.ndarray, np.ndarray]:
    """Points and segments around the domain."""
    if domain is None:
        lo, hi = sites.min(axis=0), sites.max(axis=0)
        margin = _MARGIN * (float(np.hypot(*(hi - lo))) or 1.0)
        (x0, y0), (x1, y1) = lo - margin, hi + margin
        corners = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        return corners, np.array([(0, 1), (1, 2), (2, 3), (3, 0)])
    if isinstance(domain, Mesh):
        if domain.dim != 2 or "line" not in domain.facets:
            raise InputError("a mesh that clips must be plane and have straight boundary facets")
        points, rows, sides = domain.points, domain.facets["line"], domain.facet_region["line"]
    else:
        pslg = domain if isinstance(domain, Pslg) else evaluate(domain)
        points, rows, sides = pslg.points, pslg.segments, pslg.segment_region
    return points, rows[(sides >= 0).sum(axis=1) == 1]


def _open_cells(sites: np.ndarray, outline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of all cells, one after the other, and where each cell's begin.

    Points far away bound all of them.
    """
    everything = np.concatenate([sites, outline])
    lo, hi = everything.min(axis=0), everything.max(axis=0)
    centre, reach = 0.5 * (lo + hi), _DISTANCE * (float(np.hypot(*(hi - lo))) or 1.0)
    angle = 2 * np.pi * np.arange(_FAR) / _FAR + 0.1
    far = centre + reach * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate([sites, far])
    triangles, _ = triangulate(points)
    centres, _ = circles(points, triangles)
    site = triangles.ravel()
    triangle = np.repeat(np.arange(len(triangles)), 3)
    arm = centres[triangle] - points[site]
    order = np.lexsort((np.arctan2(arm[:, 1], arm[:, 0]), site))
    order = order[site[order] < len(sites)]
    begin = np.searchsorted(site[order], np.arange(len(sites) + 1))
    return centres[triangle[order]], begin

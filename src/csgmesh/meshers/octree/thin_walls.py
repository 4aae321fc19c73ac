"""Sizes in thin walls and gaps of a solid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.graphs import components
from csgmesh.size.field import Source
from csgmesh.size.thickness import Walls, walls

#: Edges of a wall over its thickness, for one cell across. Plates have dihedral angles of 25
#: degrees with 2, of 18 with 3, of 15 with 4, of 11 with 6.
LONG = 3.0
#: Interfaces between two regions have cells on both sides: their triangles are faces of Delaunay
#: tetrahedra if the wall's other side lies outside the smallest spheres around them.
INTERFACE = 0.5
#: Walls that are not thinner than this share of what would do are no thin ones.
NEARLY = 0.85
#: No size is made smaller than this share of the domain's diagonal for the sake of a wall.
FINEST = 1e-3
#: Where a wall would have flatter cells than this even so, as at a cusp, it is left alone with all
#: that is connected with it: the finer the cells towards a cusp, the flatter is the last one.
FLATTEST = 8.0
#: Walls may take this share of the points that are allowed.
SHARE = 0.02
#: Longest piece of the boundary looked at first, as a share of the size there.
_SPACING = 4.0
#: Points on a surface of equilateral triangles, times the square of their edge, over its area.
_POINTS = 2.0 / np.sqrt(3.0)
#: Growth of the finest size while walls ask for too many points.
_COARSER = 1.2


@dataclass(frozen=True, eq=False)
class ThinWalls:
    """What thin walls ask of sizes.

    Attributes
    ----------
    triangles : (k, 3, 3) float64
        Pieces of the boundary.
    size : (k,) float64
        The largest size on each.
    thinnest : float
        Smallest distance between two facing pieces, as far as their facets tell.
    place : tuple of float
        Where.
    finest : float
        The smallest size that walls were granted, infinite if none was.
    flat_area : float
        Area of the pieces whose wall has flatter cells than asked for.
    """

    triangles: np.ndarray
    size: np.ndarray
    thinnest: float
    place: tuple[float, ...]
    finest: float
    flat_area: float

    def info(self) -> dict[str, object]:
        """What a mesh tells of its walls."""
        return {
            "thinnest": self.thinnest,
            "place": list(self.place),
            "smallest_size": self.finest if np.isfinite(self.finest) else None,
            "flat_area": self.flat_area,
        }


def thin_walls(domain: Plc, sizes: Source, across: int, max_points: float) -> ThinWalls | None:
    """Sizes that thin walls of a domain need, None if it has none.

    Parameters
    ----------
    domain : Plc
    sizes : callable
        Sizes without regard to walls.
    across : int
        Edges along a stretch of a wall twice as long as it is thick.
    max_points : float
        Points that the mesh may have, of which walls take a share.
    """
    share = LONG / across
    finest = FINEST * domain.diagonal
    spacing = _SPACING * share / NEARLY
    found = walls(domain, lambda p: NEARLY / share * sizes(p), spacing, share, finest / FLATTEST)
    if not len(found.width):
        return None
    between = (domain.facet_region[found.facet] >= 0).all(axis=1)
    wanted = np.where(between, INTERFACE, 1.0) * share * found.width
    return _granted(found, wanted, finest, SHARE * max_points)


def _granted(found: Walls, wanted: np.ndarray, finest: float, n_points: float) -> ThinWalls:
    """Sizes with which walls take no more than so many points."""
    first, second = (found.triangles[:, k] - found.triangles[:, 0] for k in (1, 2))
    area = 0.5 * np.sqrt((np.cross(first, second) ** 2).sum(axis=1))
    part = _connected(found.triangles)
    narrowest = np.full(len(found.width), np.inf)
    np.minimum.at(narrowest, part, found.width)
    while True:
        size = np.maximum(wanted, finest)
        kept = finest <= FLATTEST * narrowest[part]
        if (_POINTS * area / size**2).sum(where=kept) <= n_points:
            break
        finest *= _COARSER
    is_flat = ~kept | (size > wanted)
    at = int(np.argmin(found.width))
    return ThinWalls(
        found.triangles[kept],
        size[kept],
        float(found.width[at]),
        tuple(found.triangles[at].mean(axis=0).tolist()),
        float(size.min(initial=np.inf, where=kept)),
        float(area.sum(where=is_flat)),
    )


def _connected(triangles: np.ndarray) -> np.ndarray:
    """Component of each piece; pieces with a common corner are connected."""
    corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)[1].reshape(-1)
    n = len(triangles)
    piece = np.repeat(np.arange(n), 3)
    return components(n + int(corner.max()) + 1, piece, n + corner)[1][:n]

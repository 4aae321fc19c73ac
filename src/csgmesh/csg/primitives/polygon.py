"""Polygons with holes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks
from csgmesh.csg.primitive import Planar
from csgmesh.csg.rings import check_ring, closed_lines, point_within, ring_area, without_repeats
from csgmesh.csg.winding import WindingGrid
from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Polygon(Planar):
    """A polygon, less its holes.

    Rings close by themselves and may be given in either orientation; points that repeat the one
    before are skipped. A ring must not cross itself or another one, which evaluation checks and
    answers with the place of the crossing; rings may touch. The whole boundary, holes included, is
    a single part: subtract polygons where holes need names of their own.

    Parameters
    ----------
    points : (n, 2) float
        At least three.
    holes : sequence of (m, 2) float
        Rings inside the polygon.
    name : str, optional
        Default ``"polygon"``.

    Raises
    ------
    ShapeError
        If a ring has fewer than three points or all its points lie on a line; on first use, if a
        hole lies outside the polygon or in another hole.

    Examples
    --------
    >>> import csgmesh as cm
    >>> hole = [(1, 1), (3, 1), (3, 3), (1, 3)]
    >>> frame = cm.Polygon([(0, 0), (4, 0), (4, 4), (0, 4)], holes=[hole])
    >>> frame.contains([(0.5, 0.5), (2, 2)])
    array([ True, False])
    """

    points: np.ndarray
    holes: tuple[np.ndarray, ...] = ()

    kind: ClassVar[str] = "polygon"
    simple: ClassVar[bool] = True

    def __init__(
        self,
        points: ArrayLike,
        holes: Iterable[ArrayLike] = (),
        *,
        name: str | None = None,
    ) -> None:
        where = self.place(name)
        outer = _ring(points, "points", where)
        checks.sequence(holes, "holes", where, "a sequence of rings, each of points")
        inner = tuple(_ring(hole, f"hole {k}", where) for k, hole in enumerate(holes))
        self._settle(name, points=outer, holes=inner)

    @cached_property
    def _rings(self) -> list[np.ndarray]:
        """The rings without repeats, the outer one counterclockwise, the holes clockwise."""
        rings = [without_repeats(ring) for ring in (self.points, *self.holes)]
        return [
            ring if (ring_area(ring) > 0) == (k == 0) else ring[::-1].copy()
            for k, ring in enumerate(rings)
        ]

    @cached_property
    def _table(self) -> Curves:
        return Curves.concatenate(closed_lines(ring) for ring in self._rings)

    @cached_property
    def _grid(self) -> WindingGrid:
        grid = WindingGrid.of(self._table)
        if self.holes:
            within = np.array([point_within(ring) for ring in self._rings[1:]])
            for k in np.flatnonzero(grid.winding(within) < 0)[:1].tolist():
                raise ShapeError(
                    f"{self.place(self.name)}: hole {k} must lie inside the polygon and outside "
                    f"its other holes; it does not at {tuple(within[k].tolist())}"
                )
        return grid

    def curves(self) -> tuple[Curves, np.ndarray]:
        if self.holes:
            _ = self._grid  # checks the holes
        return self._table, np.zeros(len(self._table), np.int64)

    def inside(self, points: np.ndarray) -> np.ndarray:
        return self._grid.winding(points) != 0

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        corners = self.points @ matrix.T + offset
        return corners.min(axis=0), corners.max(axis=0)


def _ring(value: ArrayLike, what: str, where: str) -> np.ndarray:
    points = checks.point_array(value, what, where, least=3)
    if len(without_repeats(points)) < 3:
        raise ShapeError(f"{where}: {what} must hold 3 or more different points; got {points!r}")
    check_ring(points, what, where)
    return points

"""Outlines: several closed contours of lines, circular arcs and Bézier curves."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from csgmesh.csg.contours import Contour, contour_curves, path_contours, read_contour
from csgmesh.csg.primitive import Planar
from csgmesh.csg.winding import WindingGrid
from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Outline(Planar):
    """Several closed contours of lines, circular arcs, quadratic and cubic Béziers (glyphs, SVG).

    Contours may cross themselves and each other; the filling rule decides what is inside. The whole
    boundary is a single part.

    Parameters
    ----------
    contours : sequence of contours
        A contour is a start point followed by segments, each from where the last one ended:

        - ``("line", p)`` or just ``p``: straight to `p`;
        - ``("arc", q, p)``: on the circle through `q` to `p`;
        - ``("quadratic", c, p)``: a quadratic Bézier with control point `c`;
        - ``("cubic", c1, c2, p)``: a cubic Bézier.

        A contour that does not end at its start is closed by a line.
    fill : {"nonzero", "evenodd"}
        Inside is where the winding number is not zero, or where it is odd.
    name : str, optional
        Default ``"outline"``.

    Raises
    ------
    ShapeError
        If a segment is none of these, a coordinate is not finite, or a contour has no extent.

    Examples
    --------
    >>> import csgmesh as cm
    >>> right, left = ("arc", (3, 1), (2, 2)), ("arc", (-1, 1), (0, 0))
    >>> stadium = cm.Outline([[(0, 0), (2, 0), right, (0, 2), left]])
    >>> stadium.contains([(2.9, 1), (2.9, 0)])
    array([ True, False])
    """

    contours: tuple[Contour, ...]
    fill: str = "nonzero"

    kind: ClassVar[str] = "outline"

    def __init__(
        self, contours: Iterable[Any], fill: str = "nonzero", *, name: str | None = None
    ) -> None:
        where = self.place(name)
        if fill not in ("nonzero", "evenodd"):
            raise ShapeError(f"{where}: fill must be 'nonzero' or 'evenodd'; got {fill!r}")
        if isinstance(contours, str) or not isinstance(contours, Iterable):
            raise ShapeError(f"{where}: contours must be a sequence of contours; got {contours!r}")
        read = tuple(read_contour(c, f"contour {k}", where) for k, c in enumerate(contours))
        if not read:
            raise ShapeError(f"{where}: at least one contour is needed; got none")
        self._settle(name, contours=read, fill=fill)

    @classmethod
    def from_path(
        cls,
        vertices: ArrayLike,
        codes: ArrayLike,
        fill: str = "nonzero",
        *,
        name: str | None = None,
    ) -> Outline:
        """An outline from path arrays as matplotlib and many font libraries have them.

        Parameters
        ----------
        vertices : (n, 2) float
        codes : (n,) int
            1 move, 2 line, 3 quadratic (control, end), 4 cubic (two controls, end), 79 close.
        fill, name
            As for `Outline`.

        Examples
        --------
        >>> import csgmesh as cm
        >>> cm.Outline.from_path([(0, 0), (1, 0), (0, 1), (0, 0)], [1, 2, 2, 79]).bounds()
        (array([0., 0.]), array([1., 1.]))
        """
        return cls(path_contours(vertices, codes, cls.place(name)), fill, name=name)

    @cached_property
    def _table(self) -> Curves:
        return contour_curves(self.contours)

    @cached_property
    def _grid(self) -> WindingGrid:
        return WindingGrid.of(self._table)

    def curves(self) -> tuple[Curves, np.ndarray]:
        return self._table, np.zeros(len(self._table), np.int64)

    def inside(self, points: np.ndarray) -> np.ndarray:
        winding = self._grid.winding(points)
        return winding != 0 if self.fill == "nonzero" else winding % 2 == 1

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        low, high = self._table.transformed(matrix, offset).bounds()
        return low.min(axis=0), high.max(axis=0)

"""Kinds of cells as data: how many points, which edges, which facets.

Point orders are those of meshio (and VTK). A cell is positively oriented when its Jacobian is
positive: triangles and quads run counterclockwise. The facets of a plane cell keep the cell on
their left, those of a solid cell have their normal pointing out of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class Kind:
    """A kind of cell.

    Attributes
    ----------
    name : str
        As in meshio.
    dim : int
        Dimension of the cell itself.
    n_points : int
        Points in a row of the connectivity; the corners come first.
    n_corners : int
        Points at the corners of the straight cell.
    edges : tuple of tuple of int
        Local corner numbers of each edge.
    facets : tuple of tuple of int
        Local point numbers of each facet (mid-side points included).
    facet_kinds : tuple of str
        The kind of each facet.
    """

    name: str
    dim: int
    n_points: int
    n_corners: int
    edges: tuple[tuple[int, ...], ...]
    facets: tuple[tuple[int, ...], ...]
    facet_kinds: tuple[str, ...]

    @property
    def order(self) -> int:
        """Degree of the polynomials along the edges; 1 for straight cells."""
        if self.dim == 2:
            return len(self.facets[0]) - 1
        if self.dim == 1:
            return self.n_points - 1
        return 1 if self.n_points == self.n_corners else 2

    @property
    def straight(self) -> str:
        """Name of the kind of the corners alone."""
        return _STRAIGHT[self.dim, self.n_corners]


_STRAIGHT = {
    (0, 1): "vertex",
    (1, 2): "line",
    (2, 3): "triangle",
    (2, 4): "quad",
    (3, 4): "tetra",
    (3, 5): "pyramid",
    (3, 6): "wedge",
    (3, 8): "hexahedron",
}

_LINE = ((0, 1),)
_TRIANGLE = ((0, 1), (1, 2), (2, 0))
_QUAD = ((0, 1), (1, 2), (2, 3), (3, 0))
_TETRA = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_HEXAHEDRON = (
    *((0, 1), (1, 2), (2, 3), (3, 0)),
    *((4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
_WEDGE = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
_PYRAMID = ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4))

_TETRA_FACETS = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_HEXAHEDRON_FACETS = (
    *((0, 3, 2, 1), (4, 5, 6, 7)),
    *((0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
)
_WEDGE_FACETS = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
_PYRAMID_FACETS = ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4))

_QUAD8_FACETS = ((0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7))
_TETRA10_FACETS = (
    *((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7)),
    *((1, 2, 3, 5, 9, 8), (0, 3, 2, 7, 9, 6)),
)


def _of_order(corners: int, order: int) -> Kind:
    """A plane cell of higher order: corners, then the inner points of each edge along it, then
    those of the cell, which in turn are those of a cell of lower order (as in Gmsh)."""
    n_points = (order + 1) * (order + 2) // 2 if corners == 3 else (order + 1) ** 2
    edges: tuple[tuple[int, ...], ...] = _TRIANGLE if corners == 3 else _QUAD
    inner = [tuple(corners + e * (order - 1) + k for k in range(order - 1)) for e in range(corners)]
    facets = tuple((*edge, *inner[e]) for e, edge in enumerate(edges))
    name = f"{'triangle' if corners == 3 else 'quad'}{n_points}"
    return Kind(name, 2, n_points, corners, edges, facets, (f"line{order + 1}",) * corners)


def _table() -> dict[str, Kind]:
    kinds = (
        Kind("vertex", 0, 1, 1, (), (), ()),
        Kind("line", 1, 2, 2, _LINE, ((0,), (1,)), ("vertex",) * 2),
        Kind("triangle", 2, 3, 3, _TRIANGLE, _TRIANGLE, ("line",) * 3),
        Kind("quad", 2, 4, 4, _QUAD, _QUAD, ("line",) * 4),
        Kind("tetra", 3, 4, 4, _TETRA, _TETRA_FACETS, ("triangle",) * 4),
        Kind("hexahedron", 3, 8, 8, _HEXAHEDRON, _HEXAHEDRON_FACETS, ("quad",) * 6),
        Kind("wedge", 3, 6, 6, _WEDGE, _WEDGE_FACETS, ("triangle",) * 2 + ("quad",) * 3),
        Kind("pyramid", 3, 5, 5, _PYRAMID, _PYRAMID_FACETS, ("quad",) + ("triangle",) * 4),
        Kind("line3", 1, 3, 2, _LINE, ((0,), (1,)), ("vertex",) * 2),
        _of_order(3, 2),
        Kind("quad8", 2, 8, 4, _QUAD, _QUAD8_FACETS, ("line3",) * 4),
        _of_order(4, 2),
        Kind("tetra10", 3, 10, 4, _TETRA, _TETRA10_FACETS, ("triangle6",) * 4),
        *(Kind(f"line{n}", 1, n, 2, _LINE, ((0,), (1,)), ("vertex",) * 2) for n in (4, 5, 6)),
        *(_of_order(corners, order) for corners in (3, 4) for order in (3, 4, 5)),
    )
    return {kind.name: kind for kind in kinds}


#: Every kind of cell, by name.
KINDS: Mapping[str, Kind] = MappingProxyType(_table())

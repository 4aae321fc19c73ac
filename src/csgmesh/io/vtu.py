"""VTK XML unstructured grids (``.vtu``), for ParaView.

The cells come first, then the facets as line cells, then embedded points as vertex cells. Two
integer arrays on the cells tell them apart: `region` (-1 on facets) and `marker` (-1 on cells).
Names are arrays in the field data: ``region:rock`` holds the number of a region,
``boundary:plate.left`` the markers of all facets of that name. (String arrays would be prettier in
ParaView, but meshio refuses files that contain them.)

The triangles of a surface in space are written once, with `region` behind them, `marker`, and
`ahead`, the region in front.

Source: VTK File Formats, https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import BinaryIO
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import ArrayLike

from csgmesh.errors import FileFormatError, InputError
from csgmesh.io.assemble import Listing
from csgmesh.io.assemble_space import dimension
from csgmesh.io.assemble_surface import lists_surface
from csgmesh.io.vtk_kinds import VTK_TYPE, kind_of, vtk_order
from csgmesh.io.vtu_parse import Grid, VtuFile
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.lagrange import EQUISPACED
from csgmesh.mesh.nodes import with_nodes
from csgmesh.mesh.surfaces import is_surface, with_facets
from csgmesh.options import check_choice

_TYPE_NAME = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}
_BLOCK = 1 << 20


def write(
    path: Path,
    mesh: Mesh,
    *,
    compress: bool = False,
    encoding: str = "raw",
    point_data: Mapping[str, ArrayLike] | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
) -> None:
    """Write a ``.vtu`` file with appended binary data.

    Parameters
    ----------
    compress : bool
        With zlib; about a third of the size and ten times slower.
    encoding : {"raw", "base64"}
        "base64" keeps the file valid XML and is a third larger.
    point_data, cell_data : mapping of str to array_like
        Values at the points, and at the cells of all kinds in the order of ``mesh.cells``
        (facets get NaN, or -1 where the values are integers).
    """
    check_choice("encoding", encoding, ("raw", "base64"), "a .vtu file")
    mesh = with_nodes(mesh, EQUISPACED)
    grid = _Grid(mesh)
    appended = _Appended(bool(compress), encoding)
    points = np.zeros((mesh.n_points, 3))
    points[:, : mesh.dim] = mesh.points
    lines = ['<?xml version="1.0"?>', appended.opening(), "<UnstructuredGrid>", "<FieldData>"]
    lines += grid.names()
    lines += [
        "</FieldData>",
        f'<Piece NumberOfPoints="{mesh.n_points}" NumberOfCells="{grid.n}">',
        "<PointData>",
        *(appended.add(k, v) for k, v in _values(point_data, mesh.n_points, "point_data")),
        '</PointData>\n<CellData Scalars="region">',
        appended.add("region", grid.regions()),
        appended.add("marker", grid.markers()),
        *([appended.add("ahead", grid.ahead())] if grid.is_surface else []),
        *(
            appended.add(k, grid.padded(v))
            for k, v in _values(cell_data, mesh.n_cells, "cell_data")
        ),
        "</CellData>\n<Points>",
        appended.add("Points", points),
        "</Points>\n<Cells>",
        appended.add("connectivity", grid.connectivity()),
        appended.add("offsets", grid.offsets()),
        appended.add("types", grid.types()),
        "</Cells>\n</Piece>\n</UnstructuredGrid>",
        f'<AppendedData encoding="{encoding}">\n_',
    ]
    with open(path, "wb") as file:
        file.write("\n".join(lines).encode())
        appended.write(file)
        file.write(b"\n</AppendedData>\n</VTKFile>\n")


def read(path: Path) -> Mesh:
    """Read a ``.vtu`` file of any encoding."""
    file = VtuFile(path)
    grid = file.grid()
    listing = Listing(path, grid.points)
    region_of, marker_of = listing.names_in(file.field_data())
    kinds = [kind_of(t, 0) or "" for t in np.unique(grid.types).tolist()]
    is_skin = lists_surface(kinds, grid.points)
    dim = 3 if is_skin else dimension(kinds)
    starts = np.concatenate([[0], grid.offsets[:-1]]) if len(grid.offsets) else grid.offsets
    widths = grid.offsets - starts
    for number, width in dict.fromkeys(zip(grid.types.tolist(), widths.tolist(), strict=True)):
        kind = kind_of(number, width)
        if kind is None:
            raise FileFormatError(f"{path}: cells of VTK type {number}, which are not supported")
        if KINDS[kind].n_points != width:
            raise FileFormatError(f"{path}: offsets do not fit cells of kind {kind!r}")
        which = np.flatnonzero((grid.types == number) & (widths == width))
        rows = grid.connectivity[starts[which][:, None] + np.arange(width)]
        order = vtk_order(kind)
        if order is not None:
            rows = rows[:, np.argsort(order)]
        if KINDS[kind].dim >= dim:
            tags = _numbers(grid, "region", which, region_of, listing.region_number)
        else:
            tags = _numbers(grid, "marker", which, marker_of, listing.marker_number)
        listing.add(kind, rows, tags)
        if is_skin:
            sides = [
                _numbers(grid, name, which, region_of, listing.region_number)
                for name in ("region", "ahead")
            ]
            listing.beside.setdefault(kind, []).append(np.column_stack(sides))
    return listing.mesh()


class _Grid:
    """Cells, facets and embedded points of a mesh as one list of VTK cells."""

    def __init__(self, mesh: Mesh) -> None:
        vertices = np.flatnonzero(mesh.point_marker >= 0)
        self.is_surface = is_surface(mesh)
        self.mesh = mesh = with_facets(mesh) if self.is_surface else mesh
        self.blocks = [*mesh.facets.items()]
        if not self.is_surface:
            self.blocks = [*mesh.cells.items(), *self.blocks]
        self.extra = list(mesh.facet_marker.values())
        if len(vertices):
            self.blocks.append(("vertex", vertices[:, None]))
            self.extra.append(mesh.point_marker[vertices])
        self.n = sum(len(rows) for _, rows in self.blocks)

    def regions(self) -> np.ndarray:
        out = np.full(self.n, -1, np.int32)
        if self.is_surface:
            out[: self.mesh.n_facets] = self._beside(0)
        else:
            out[: self.mesh.n_cells] = np.concatenate([*self.mesh.cell_region.values(), []])
        return out

    def ahead(self) -> np.ndarray:
        """Regions in front of the facets of a surface."""
        out = np.full(self.n, -1, np.int32)
        out[: self.mesh.n_facets] = self._beside(1)
        return out

    def _beside(self, side: int) -> np.ndarray:
        return np.concatenate([sides[:, side] for sides in self.mesh.facet_region.values()])

    def markers(self) -> np.ndarray:
        out = np.full(self.n, -1, np.int32)
        first = 0 if self.is_surface else self.mesh.n_cells
        out[first:] = np.concatenate([*self.extra, []])
        return out

    def padded(self, values: np.ndarray) -> np.ndarray:
        fill = np.nan if values.dtype.kind == "f" else -1
        rest = np.full((self.n - len(values), *values.shape[1:]), fill, values.dtype)
        return np.concatenate([values, rest])

    def connectivity(self) -> np.ndarray:
        parts = []
        for kind, rows in self.blocks:
            order = vtk_order(kind)
            parts.append((rows if order is None else rows[:, order]).ravel())
        return np.concatenate([*parts, np.zeros(0, np.int64)])

    def offsets(self) -> np.ndarray:
        widths = [np.full(len(rows), rows.shape[1]) for _, rows in self.blocks]
        return np.cumsum(np.concatenate([*widths, np.zeros(0, np.int64)]))

    def types(self) -> np.ndarray:
        types = [np.full(len(rows), VTK_TYPE[kind], np.uint8) for kind, rows in self.blocks]
        return np.concatenate([*types, np.zeros(0, np.uint8)])

    def names(self) -> list[str]:
        """Field data; see the module."""
        numbers = {f"region:{name}": [i] for i, name in enumerate(self.mesh.region_names)}
        for marker, names in enumerate(self.mesh.boundary_names):
            for name in names:
                numbers.setdefault(f"boundary:{name}", []).append(marker)
        return [
            f'<DataArray type="Int64" Name={quoteattr(name)} NumberOfTuples="{len(values)}" '
            f'format="ascii">{" ".join(map(str, values))}</DataArray>'
            for name, values in numbers.items()
        ]


class _Appended:
    """Arrays collected for the AppendedData element."""

    def __init__(self, compress: bool, encoding: str) -> None:
        self.compress, self.encoding = compress, encoding
        self.chunks: list[bytes | memoryview] = []
        self.size = 0

    def opening(self) -> str:
        compressor = ' compressor="vtkZLibDataCompressor"' if self.compress else ""
        return (
            '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
            f'header_type="UInt64"{compressor}>'
        )

    def add(self, name: str, values: np.ndarray) -> str:
        """Queue an array; its DataArray element."""
        array = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
        components = f' NumberOfComponents="{array.shape[1]}"' if array.ndim == 2 else ""
        type_name = _TYPE_NAME[array.dtype.str[1:]]
        offset = self.size
        for part in self._encoded(array.reshape(-1).view(np.uint8).data):
            self.chunks.append(part)
            self.size += len(part)
        return (
            f'<DataArray type="{type_name}" Name={quoteattr(name)}{components} '
            f'format="appended" offset="{offset}"/>'
        )

    def _encoded(self, data: memoryview) -> list[bytes | memoryview]:
        if not self.compress:
            size = np.array([len(data)], "<u8").tobytes()
            return [size, data] if self.encoding == "raw" else [base64.b64encode(size + data)]
        blocks = [zlib.compress(data[i : i + _BLOCK], 6) for i in range(0, len(data), _BLOCK)]
        header = np.array(
            [len(blocks), _BLOCK, len(data) % _BLOCK, *map(len, blocks)], "<u8"
        ).tobytes()
        if self.encoding == "raw":
            return [header, *blocks]
        return [base64.b64encode(header), base64.b64encode(b"".join(blocks))]

    def write(self, file: BinaryIO) -> None:
        for chunk in self.chunks:
            file.write(chunk)


def _values(
    data: Mapping[str, ArrayLike] | None, n: int, what: str
) -> list[tuple[str, np.ndarray]]:
    found = []
    for name, given in (data or {}).items():
        values = np.asarray(given)
        if values.dtype.kind not in "iufb":
            raise InputError(f"{what}[{name!r}] must hold numbers; got {values.dtype}")
        if values.ndim not in (1, 2) or len(values) != n:
            raise InputError(
                f"{what}[{name!r}] must have shape ({n},) or ({n}, k); got {values.shape}"
            )
        if name in ("region", "marker", "ahead"):
            raise InputError(f"{what}: {name!r} is the name of an array that csgmesh writes")
        found.append((name, values.astype(np.float64 if values.dtype.kind == "f" else np.int64)))
    return found


def _numbers(
    grid: Grid, name: str, which: np.ndarray, known: dict[int, int], new: Callable[[int], int]
) -> np.ndarray:
    """Numbers in the listing of some cells; `new` makes one for a number without a name."""
    if name not in grid.cell_data:
        return np.full(len(which), -1)
    values, at = np.unique(grid.cell_data[name][which].astype(np.int64), return_inverse=True)
    for value in values.tolist():
        if value not in known:
            known[value] = new(value) if value >= 0 else -1
    return np.array([known[v] for v in values.tolist()], np.int64)[at]

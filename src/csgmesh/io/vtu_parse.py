"""The layout of ``.vtu`` files: XML with arrays inline or appended, as text, base64 or bytes."""

from __future__ import annotations

import base64
import binascii
import re
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from csgmesh.errors import FileFormatError

_DTYPE = {
    "Float32": "f4",
    "Float64": "f8",
    **{f"Int{8 * n}": f"i{n}" for n in (1, 2, 4, 8)},
    **{f"UInt{8 * n}": f"u{n}" for n in (1, 2, 4, 8)},
}


@dataclass(frozen=True)
class Grid:
    """All pieces of an unstructured grid, joined."""

    points: np.ndarray
    connectivity: np.ndarray
    offsets: np.ndarray
    types: np.ndarray
    cell_data: Mapping[str, np.ndarray]


class VtuFile:
    """A ``.vtu`` file whose XML has been parsed and whose arrays can be decoded."""

    def __init__(self, path: Path) -> None:
        self.path = path
        head, self._appended, self._encoding = self._split(path.read_bytes())
        try:
            self._root = ElementTree.fromstring(head)
        except ElementTree.ParseError as error:
            raise FileFormatError(f"{path} is no VTK XML file, or is damaged: {error}") from error
        kind = self._root.get("type", self._root.tag)
        if self._root.tag != "VTKFile" or kind != "UnstructuredGrid":
            raise self.error(f"holds {kind!r}; expected a VTKFile of type 'UnstructuredGrid'")
        order = "<" if self._root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        header = self._root.get("header_type", "UInt32")
        if header not in ("UInt32", "UInt64"):
            raise self.error(f"has header_type {header!r}; known are 'UInt32', 'UInt64'")
        self._order, self._header = order, np.dtype(order + _DTYPE[header])
        compressor = self._root.get("compressor", "")
        if compressor not in ("", "vtkZLibDataCompressor"):
            raise self.error(f"is compressed by {compressor}; only vtkZLibDataCompressor is known")
        self._compressed = bool(compressor)

    def error(self, text: str) -> FileFormatError:
        """An error about this file."""
        return FileFormatError(f"{self.path} {text}")

    def field_data(self) -> dict[str, np.ndarray]:
        """Integer arrays of the field data."""
        found = {}
        for element in self._root.findall("UnstructuredGrid/FieldData/DataArray"):
            if element.get("type", "").startswith(("Int", "UInt")):
                found[element.get("Name", "")] = self._array(element)
        return found

    def grid(self) -> Grid:
        """Points and cells of all pieces, with the cell data that all pieces have."""
        pieces = self._root.findall("UnstructuredGrid/Piece")
        if not pieces:
            raise self.error("has no Piece")
        parts = [self._piece(piece) for piece in pieces]
        point_shift = np.cumsum([0] + [len(p.points) for p in parts])
        offset_shift = np.cumsum([0] + [len(p.connectivity) for p in parts])
        common = set.intersection(*(set(p.cell_data) for p in parts))
        return Grid(
            np.concatenate([p.points for p in parts]),
            np.concatenate([p.connectivity + s for p, s in zip(parts, point_shift, strict=False)]),
            np.concatenate([p.offsets + s for p, s in zip(parts, offset_shift, strict=False)]),
            np.concatenate([p.types for p in parts]),
            {k: np.concatenate([p.cell_data[k] for p in parts]) for k in sorted(common)},
        )

    def _piece(self, piece: ElementTree.Element) -> Grid:
        n_points, n_cells = (
            self._count(piece, "NumberOfPoints"),
            self._count(piece, "NumberOfCells"),
        )
        points = self._needed(piece, "Points/DataArray", 3 * n_points).reshape(-1, 3)
        offsets = self._needed(piece, "Cells/DataArray[@Name='offsets']", n_cells)
        types = self._needed(piece, "Cells/DataArray[@Name='types']", n_cells)
        last = int(offsets[-1]) if n_cells else 0
        if n_cells and (offsets[0] < 0 or (np.diff(offsets.astype(np.int64)) < 0).any()):
            raise self.error("has cell offsets that decrease")
        connectivity = self._needed(piece, "Cells/DataArray[@Name='connectivity']", last)
        data = {}
        for name in ("region", "marker", "ahead"):
            if piece.find(f"CellData/DataArray[@Name='{name}']") is not None:
                data[name] = self._needed(piece, f"CellData/DataArray[@Name='{name}']", n_cells)
        return Grid(
            points.astype(np.float64),
            connectivity.astype(np.int64),
            offsets.astype(np.int64),
            types.astype(np.int64),
            data,
        )

    def _count(self, piece: ElementTree.Element, name: str) -> int:
        text = piece.get(name, "")
        if not text.isdigit():
            raise self.error(f"has a Piece with {name}={text!r}; expected a number")
        return int(text)

    def _needed(self, piece: ElementTree.Element, where: str, size: int) -> np.ndarray:
        element = piece.find(where)
        if element is None:
            raise self.error(f"has no {where}")
        array = self._array(element)
        if array.size != size:
            raise self.error(f"is damaged: {where} holds {array.size} values instead of {size}")
        return array

    def _array(self, element: ElementTree.Element) -> np.ndarray:
        name, type_name = element.get("Name", "?"), element.get("type", "")
        if type_name not in _DTYPE:
            raise self.error(f"has an array {name!r} of unknown type {type_name!r}")
        dtype = np.dtype(self._order + _DTYPE[type_name])
        layout = element.get("format", "ascii")
        try:
            if layout == "ascii":
                return np.array((element.text or "").split(), dtype.newbyteorder("="))
            if layout == "binary":
                data = self._decoded((element.text or "").strip().encode(), True)
            elif layout == "appended":
                data = self._decoded(self._from_offset(element), self._encoding == "base64")
            else:
                raise self.error(f"has an array {name!r} in unknown format {layout!r}")
            return np.frombuffer(data, dtype).astype(dtype.newbyteorder("="))
        except (ValueError, OverflowError, zlib.error, binascii.Error) as error:
            if isinstance(error, FileFormatError):
                raise
            raise self.error(f"is damaged in the array {name!r}: {error}") from error

    def _from_offset(self, element: ElementTree.Element) -> memoryview:
        text = element.get("offset", "").strip()
        if not text.isdigit() or int(text) >= max(len(self._appended), 1):
            name = element.get("Name", "?")
            raise self.error(
                f"is cut short: array {name!r} starts at offset {text!r}, past the end"
            )
        return self._appended[int(text) :]

    def _decoded(self, data: bytes | memoryview, is_base64: bool) -> bytes | memoryview:
        return self._inflated(data, is_base64) if self._compressed else self._plain(data, is_base64)

    def _plain(self, data: bytes | memoryview, is_base64: bool) -> bytes | memoryview:
        width = self._header.itemsize
        if not is_base64:
            return _cut(data, width, int(self._integers(data, 1)[0]))
        # The length may be encoded by itself (with padding) or in one go with the data.
        head = bytes(data[: _encoded_size(width)])
        size = int(self._integers(base64.b64decode(head), 1)[0])
        if head.endswith(b"="):
            rest = base64.b64decode(bytes(data[len(head) :][: _encoded_size(size)]))
            return _cut(rest, 0, size)
        return _cut(base64.b64decode(bytes(data[: _encoded_size(width + size)])), width, size)

    def _inflated(self, data: bytes | memoryview, is_base64: bool) -> bytes:
        width = self._header.itemsize
        first = base64.b64decode(bytes(data[: _encoded_size(width)])) if is_base64 else data
        n_blocks = int(self._integers(first, 1)[0])
        n_header = width * (3 + n_blocks)
        if is_base64:
            head_size = _encoded_size(n_header)
            head: bytes | memoryview = base64.b64decode(bytes(data[:head_size]))
        else:
            head_size, head = n_header, data
        sizes = self._integers(head, 3 + n_blocks)[3:].tolist()
        body = data[head_size:]
        if is_base64:
            body = base64.b64decode(bytes(body[: _encoded_size(sum(sizes))]))
        ends = np.cumsum([0, *sizes]).tolist()
        pairs = zip(ends[:-1], sizes, strict=True)
        return b"".join(zlib.decompress(_cut(body, start, size)) for start, size in pairs)

    def _integers(self, data: bytes | memoryview, n: int) -> np.ndarray:
        return np.frombuffer(_cut(data, 0, n * self._header.itemsize), self._header)

    def _split(self, data: bytes) -> tuple[bytes, memoryview, str]:
        """The XML without appended data, the appended data, and its encoding."""
        found = re.search(rb"<AppendedData[^>]*>\s*_", data)
        if found is None:
            return data, memoryview(b""), ""
        encoding = "base64" if b"base64" in found.group() else "raw"
        end = data.rfind(b"</AppendedData>")
        if end < 0:
            raise self.error("is cut short: the appended data has no end")
        return data[: found.start()] + b"</VTKFile>", memoryview(data)[found.end() : end], encoding


def _encoded_size(n: int) -> int:
    return 4 * ((n + 2) // 3)


def _cut(data: bytes | memoryview, start: int, size: int) -> bytes | memoryview:
    if start + size > len(data):
        raise ValueError(f"{size} bytes promised at byte {start}, but there are only {len(data)}")
    return data[start : start + size]

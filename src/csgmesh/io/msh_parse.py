"""The layout of MSH 4.1 files: sections of numbers, as bytes of either order or as text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from csgmesh.errors import FileFormatError
from csgmesh.io.msh_periodic import Link
from csgmesh.mesh import KINDS

#: Gmsh's numbers for the kinds of cells.
GMSH_TYPE = {
    "line": 1,
    "triangle": 2,
    "quad": 3,
    "tetra": 4,
    "hexahedron": 5,
    "wedge": 6,
    "pyramid": 7,
    "line3": 8,
    "triangle6": 9,
    "quad9": 10,
    "tetra10": 11,
    "vertex": 15,
    "quad8": 16,
    "triangle10": 21,
    "triangle15": 23,
    "triangle21": 25,
    "line4": 26,
    "line5": 27,
    "line6": 28,
    "quad16": 36,
    "quad25": 37,
    "quad36": 38,
}

#: Where Gmsh orders points differently: our point k is its point FROM_GMSH[kind][k].
FROM_GMSH: Mapping[str, list[int]] = {"tetra10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]}


@dataclass(frozen=True)
class Entity:
    """Elements of one kind in one entity; rows count points from 0."""

    dim: int
    entity: int
    kind: str
    tags: np.ndarray
    rows: np.ndarray


@dataclass
class MshContent:
    """What a file lists. Points are in the order of their tags."""

    points: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    point_tags: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    names: dict[tuple[int, int], str] = field(default_factory=dict)
    physical: dict[tuple[int, int], tuple[int, ...]] = field(default_factory=dict)
    bounding: dict[tuple[int, int], list[int]] = field(default_factory=dict)
    elements: list[Entity] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)


def is_version_4_1(path: Path, data: bytes) -> bool:
    """Whether this is MSH 4.1; an error if it is no MSH file at all."""
    found = re.match(rb"\s*(?:\$Comments.*?\$EndComments\s*)?\$MeshFormat\s+([\d.]+)", data, re.S)
    if found is None:
        raise FileFormatError(f"{path} is no .msh file: it does not begin with $MeshFormat")
    version = found.group(1)
    # Gmsh writes "4" for 4.0, whose layout is another one.
    if version not in (b"4.1", b"2.2", b"2"):
        raise FileFormatError(f"{path} is of MSH version {version.decode()}; known are 4.1 and 2.2")
    return version == b"4.1"


def parse(path: Path, data: bytes) -> MshContent:
    """Read all sections that describe the mesh; others are skipped."""
    reader = _Reader(path, data)
    content = MshContent()
    seen = set()
    readers = {"Entities": _entities, "Nodes": _nodes, "Elements": _elements, "Periodic": _periodic}
    while name := reader.next_section():
        seen.add(name)
        if name == "MeshFormat":
            reader.format()
        elif name == "PhysicalNames":
            reader.names(content.names)
        elif name in readers:
            readers[name](reader, content)
        reader.end_section()
    for name in ("MeshFormat", "Nodes", "Elements"):
        if name not in seen:
            raise FileFormatError(f"{path} has no ${name}: it is cut short, or no mesh")
    return content


def _entities(reader: _Reader, content: MshContent) -> None:
    for dim, count in enumerate(reader.sizes(4)):
        for _ in range(count):
            tag = reader.ints(1)[0]
            reader.doubles(3 if dim == 0 else 6)
            tags = tuple(abs(t) for t in reader.ints(reader.sizes(1)[0]))
            content.physical[dim, tag] = tags
            if dim:
                content.bounding[dim, tag] = reader.ints(reader.sizes(1)[0])


def _nodes(reader: _Reader, content: MshContent) -> None:
    tags, points = [], []
    n_blocks = reader.sizes(4)[0]
    for _ in range(n_blocks):
        dim, _entity, parametric = reader.ints(3)
        count = reader.sizes(1)[0]
        width = 3 + (dim if parametric else 0)
        tags.append(reader.size_array(count))
        points.append(reader.double_array(count * width).reshape(count, width)[:, :3])
    all_tags = np.concatenate([*tags, np.zeros(0, np.int64)])
    order = np.argsort(all_tags, kind="stable")
    content.point_tags = all_tags[order]
    content.points = np.concatenate([*points, np.zeros((0, 3))])[order]
    if (np.diff(content.point_tags) == 0).any():
        raise reader.error("has two nodes with the same tag")


def _elements(reader: _Reader, content: MshContent) -> None:
    n_blocks = reader.sizes(4)[0]
    kind_of = {number: kind for kind, number in GMSH_TYPE.items()}
    for _ in range(n_blocks):
        dim, entity, number = reader.ints(3)
        count = reader.sizes(1)[0]
        if number not in kind_of:
            raise reader.error(f"has elements of Gmsh type {number}, which are not supported")
        kind = kind_of[number]
        width = 1 + KINDS[kind].n_points
        table = reader.size_array(count * width).reshape(count, width)
        rows = _numbered(reader, content.point_tags, table[:, 1:])
        if kind in FROM_GMSH:
            rows = rows[:, FROM_GMSH[kind]]
        content.elements.append(Entity(dim, entity, kind, table[:, 0], rows))


def _periodic(reader: _Reader, content: MshContent) -> None:
    for _ in range(reader.sizes(1)[0]):
        dim, entity, master = reader.ints(3)
        affine = reader.double_array(reader.sizes(1)[0])
        count = reader.sizes(1)[0]
        table = reader.size_array(2 * count).reshape(count, 2)
        nodes = _numbered(reader, content.point_tags, table)
        content.links.append(Link(dim, entity, master, affine, nodes))


def _numbered(reader: _Reader, tags: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Positions of node tags."""
    n = len(tags)
    if n and tags[0] == 1 and tags[-1] == n:
        rows = wanted - 1
        unknown = (rows < 0) | (rows >= n)
    else:
        rows = np.minimum(np.searchsorted(tags, wanted), max(n - 1, 0))
        unknown = tags[rows] != wanted if n else np.ones(wanted.shape, bool)
    if unknown.any():
        raise reader.error(f"has an entry with node {int(wanted[unknown][0])}, which is not listed")
    return rows


class _Reader:
    """A place in the file, and the numbers that follow it."""

    def __init__(self, path: Path, data: bytes) -> None:
        self.path, self.data, self.at = path, data, 0
        self.section = ""
        self.is_text, self.order, self.size = True, "<", 8
        self._tokens: list[bytes] = []
        self._token = 0

    def error(self, text: str) -> FileFormatError:
        where = f" in ${self.section}" if self.section else ""
        return FileFormatError(f"{self.path}: the file {text} ({where.strip() or 'at its start'})")

    def next_section(self) -> str:
        """Go behind the next header; its name, empty at the end of the file."""
        found = re.compile(rb"\s*\$(\w+)[^\S\n]*\r?\n").match(self.data, self.at)
        if found is None:
            if self.data[self.at :].strip():
                raise self.error(f"has no section header at byte {self.at}")
            return ""
        self.section, self.at = found.group(1).decode(), found.end()
        if self.is_text:
            end = self.data.find(b"$End", self.at)
            self._tokens = self.data[self.at : end if end >= 0 else None].split()
            self._token = 0
        return self.section

    def end_section(self) -> None:
        """Go behind the end of the section."""
        mark = b"$End" + self.section.encode()
        end = self.data.find(mark, self.at)
        if end < 0:
            raise self.error(f"is cut short: there is no {mark.decode()}")
        self.at = end + len(mark)

    def format(self) -> None:
        """Read what $MeshFormat says of the coding of numbers."""
        line_end = self.data.find(b"\n", self.at)
        words = self.data[self.at : line_end].split() if line_end >= 0 else []
        if len(words) != 3 or words[1] not in (b"0", b"1") or words[2] not in (b"4", b"8"):
            raise self.error(f"has a bad format line {b' '.join(words).decode(errors='replace')!r}")
        self.is_text, self.size = words[1] == b"0", int(words[2])
        if not self.is_text:
            one = self.data[line_end + 1 : line_end + 5]
            if one not in (b"\1\0\0\0", b"\0\0\0\1"):
                raise self.error(f"has a bad byte order mark {one!r}")
            self.order = "<" if one[0] else ">"
            self.at = line_end + 5

    def names(self, names: dict[tuple[int, int], str]) -> None:
        """Read $PhysicalNames, which is text in either mode."""
        end = self.data.find(b"$EndPhysicalNames", self.at)
        lines = self.data[self.at : max(end, self.at)].decode("utf-8", "replace").splitlines()
        for line in lines[1:]:
            found = re.fullmatch(r'\s*(\d+)\s+(-?\d+)\s+"(.*)"\s*', line)
            if found is None:
                raise self.error(f"has a bad line {line!r}")
            names[int(found.group(1)), int(found.group(2))] = found.group(3)

    def ints(self, n: int) -> list[int]:
        return self._integers(n, "i4").tolist()

    def sizes(self, n: int) -> list[int]:
        return self._integers(n, f"u{self.size}").tolist()

    def size_array(self, n: int) -> np.ndarray:
        return self._integers(n, f"u{self.size}")

    def doubles(self, n: int) -> list[float]:
        return self.double_array(n).tolist()

    def double_array(self, n: int) -> np.ndarray:
        if self.is_text:
            return self._from_text(n, np.float64)
        return self._from_bytes(n, "f8").astype(np.float64)

    def _integers(self, n: int, code: str) -> np.ndarray:
        if self.is_text:
            return self._from_text(n, np.int64)
        values = self._from_bytes(n, code)
        if values.dtype.kind == "u" and values.size and int(values.max()) > 2**62:
            raise self.error(f"is damaged: a number as large as {int(values.max())}")
        return values.astype(np.int64)

    def _from_bytes(self, n: int, code: str) -> np.ndarray:
        dtype = np.dtype(self.order + code)
        end = self.at + n * dtype.itemsize
        if n < 0 or end > len(self.data):
            raise self.error(f"is cut short: {n} numbers wanted at byte {self.at}")
        values = np.frombuffer(self.data, dtype, n, self.at)
        self.at = end
        return values

    def _from_text(self, n: int, dtype: type) -> np.ndarray:
        words = self._tokens[self._token : self._token + n]
        if n < 0 or len(words) < n:
            raise self.error(f"is cut short: {n} numbers wanted, {len(words)} left")
        self._token += n
        try:
            return np.array(words, "S").astype(dtype) if n else np.zeros(0, dtype)
        except ValueError as error:
            raise self.error(f"is damaged: {error}") from error

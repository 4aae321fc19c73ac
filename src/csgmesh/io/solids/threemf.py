"""3MF: a zip of XML with objects of triangles, placed by build items and components."""

from __future__ import annotations

import xml.etree.ElementTree as ET
import zipfile
import zlib
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from csgmesh.errors import FileFormatError

_SPACE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_MODEL = "3D/3dmodel.model"
#: Bytes of a model, unpacked.
_LARGEST = 2**30
#: Levels and uses of components.
_DEEPEST, _MOST = 16, 10_000

_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" '
    'ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" '
    'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>\n'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    f'<Relationship Target="/{_MODEL}" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
)

#: What bad zips and bad XML raise.
_BAD = (
    *(zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error, ET.ParseError, OSError),
    *(ValueError, KeyError, EOFError, NotImplementedError, RuntimeError),
)

Part = tuple[str, np.ndarray, np.ndarray]


def read_parts(path: Path) -> list[Part]:
    """Name, points (n, 3) and triangles (m, 3) of every object that is built, placed.

    Raises
    ------
    FileFormatError
        If the file is no 3MF, or refers to what it does not have.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            names = [n for n in archive.namelist() if n.lower().endswith(".model")]
            entry = _MODEL if _MODEL in names else next(iter(sorted(names)), None)
            if entry is None:
                raise FileFormatError(f"{path}: a .3mf file must hold a 3D/3dmodel.model")
            if archive.getinfo(entry).file_size > _LARGEST:
                raise FileFormatError(f"{path}: the model must unpack to less than 1 GiB")
            root = ET.fromstring(archive.read(entry))
        return _Reader(path, root).parts()
    except FileFormatError:
        raise
    except _BAD as problem:
        raise FileFormatError(f"{path} cannot be read as .3mf: {problem}") from None


class _Reader:
    def __init__(self, path: Path, root: ET.Element) -> None:
        self.path = path
        self.objects = {o.get("id", ""): o for o in root.iterfind(".//{*}resources/{*}object")}
        self.items = list(root.iterfind("{*}build/{*}item"))
        self.found: list[Part] = []

    def parts(self) -> list[Part]:
        for item in self.items:
            self._place(item.get("objectid", ""), _transform(item), 0)
        return self.found

    def _place(self, number: str, matrix: np.ndarray, depth: int) -> None:
        item = self.objects.get(number)
        if item is None:
            raise FileFormatError(f"{self.path}: there is no object {number!r} to build")
        if depth > _DEEPEST or len(self.found) > _MOST:
            raise FileFormatError(
                f"{self.path}: components may nest {_DEEPEST} deep and make {_MOST:,} objects"
            )
        mesh = item.find("{*}mesh")
        if mesh is not None:
            points, triangles = _arrays(mesh)
            if len(triangles) and (triangles.max() >= len(points) or triangles.min() < 0):
                raise FileFormatError(f"{self.path}: object {number!r} names points it has not")
            placed = points @ matrix[:3] + matrix[3]
            if np.linalg.det(matrix[:3]) < 0.0:
                triangles = triangles[:, ::-1]
            self.found.append((item.get("name") or f"object{number}", placed, triangles))
        for component in item.iterfind("{*}components/{*}component"):
            inner = _transform(component)
            both = np.vstack([inner[:3] @ matrix[:3], inner[3] @ matrix[:3] + matrix[3]])
            self._place(component.get("objectid", ""), both, depth + 1)


def _arrays(mesh: ET.Element) -> tuple[np.ndarray, np.ndarray]:
    points = [
        [float(v.attrib[key]) for key in ("x", "y", "z")]
        for v in mesh.iterfind("{*}vertices/{*}vertex")
    ]
    triangles = [
        [int(t.attrib[key]) for key in ("v1", "v2", "v3")]
        for t in mesh.iterfind("{*}triangles/{*}triangle")
    ]
    return np.array(points).reshape(-1, 3), np.array(triangles, np.int64).reshape(-1, 3)


def _transform(element: ET.Element) -> np.ndarray:
    """Rows of the 4 × 3 matrix by which row vectors are multiplied."""
    text = element.get("transform")
    if not text:
        return np.vstack([np.eye(3), np.zeros(3)])
    numbers = [float(word) for word in text.split()]
    if len(numbers) != 12 or not np.isfinite(numbers).all():
        raise ValueError(f"a transform has twelve numbers, not {text!r}")
    return np.array(numbers).reshape(4, 3)


def write_parts(path: Path, parts: list[Part]) -> None:
    """Objects of named triangles, in millimetres; the same parts give the same bytes."""
    resources, items = [], []
    for number, (name, points, triangles) in enumerate(parts, start=1):
        vertices = "".join(
            f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in points.tolist()
        )
        faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in triangles.tolist())
        resources.append(
            f'<object id="{number}" type="model" name={quoteattr(name)}><mesh><vertices>{vertices}'
            f"</vertices><triangles>{faces}</triangles></mesh></object>\n"
        )
        items.append(f'<item objectid="{number}"/>')
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<model unit="millimeter" xml:lang="en-US" xmlns="{_SPACE}"><resources>\n'
        f"{''.join(resources)}</resources><build>{''.join(items)}</build></model>\n"
    )
    with zipfile.ZipFile(path, "w") as archive:
        for entry, text in (
            ("[Content_Types].xml", _TYPES),
            ("_rels/.rels", _RELATIONS),
            (_MODEL, model),
        ):
            # No time of writing: equal meshes must give equal bytes.
            info = zipfile.ZipInfo(entry, date_time=(1980, 1, 1, 0, 0, 0))
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, text)

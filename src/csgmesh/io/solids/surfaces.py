"""Closed triangulated surfaces from STL, OBJ, PLY, OFF and 3MF files."""

from __future__ import annotations

import io
import logging
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from csgmesh.csg import FacetedSolid, Shape, union
from csgmesh.csg.flat_faces import neighbours
from csgmesh.errors import FileFormatError
from csgmesh.graphs import components
from csgmesh.io.solids.crossings import first_crossing
from csgmesh.io.solids.repair import Soup, repaired
from csgmesh.io.solids.threemf import Part, read_parts

#: Bytes of a file that is read at once.
_LARGEST = 2**31
#: Where a file says how many things it holds; each takes at least one byte.
_COUNTS = {
    ".ply": re.compile(rb"element\s+\w+\s+(\d+)"),
    ".off": re.compile(rb"\A\s*(?:OFF)?\s*(?:#[^\n]*\s+)*(\d+)\s+(\d+)"),
}


def surface_solid(path: Path, name: str | None, split_angle: float | None) -> Shape:
    """The solid, or the union of solids, that a file's triangles enclose.

    Raises
    ------
    FileFormatError
        If the file is not what its suffix says, or its triangles enclose no solid.
    """
    parts = read_parts(path) if path.suffix.lower() == ".3mf" else _through_trimesh(path)
    parts = [part for part in parts if len(part[2])]
    if not parts:
        raise FileFormatError(f"{path}: the file holds no triangles")
    whole = name or _usable(path.stem, "part")
    bodies = _bodies(parts, path) if len(parts) > 1 else None
    if bodies is not None:
        called = _different([_usable(label, "part") for label, _, _ in parts])
        solids = [
            _solid(body, (), f"{whole}.{own}", split_angle)
            for own, body in zip(called, bodies, strict=True)
        ]
        return union(solids)
    body = _checked(repaired(_joined(parts), str(path)), str(path))
    if len(parts) == 1:
        own = name or _usable(parts[0][0], whole)
        return _solid(body, (), own, split_angle)
    names = tuple(_different([_usable(label, "part") for label, _, _ in parts]))
    return _solid(body, names, whole, split_angle)


def _bodies(parts: list[Part], path: Path) -> list[Soup] | None:
    """Each part as a solid, if each closes by itself."""
    try:
        whole = [repaired(_joined([part]), str(path)) for part in parts]
    except FileFormatError:
        return None
    return [_checked(body, str(path)) for body in whole]


def _solid(soup: Soup, names: tuple[str, ...], name: str, split_angle: float | None) -> Shape:
    part = soup.group if names else None
    if split_angle is not None:
        part = _patches(soup, split_angle)
        prefix = [f"{n}." for n in names] or [""]
        _, first = np.unique(part, return_index=True)
        names = tuple(f"{prefix[soup.group[k] if len(prefix) > 1 else 0]}face{i + 1}"
                      for i, k in enumerate(first.tolist()))  # fmt: skip
    return FacetedSolid(soup.points, soup.triangles, names, part, name=name)


def _patches(soup: Soup, angle: float) -> np.ndarray:
    """Stretches of the surface between edges that turn by more than an angle, in degrees."""
    corner = soup.points[soup.triangles]
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    a, b = neighbours(soup.triangles)
    sine = np.sqrt((np.cross(area[a], area[b]) ** 2).sum(axis=1))
    turn = np.degrees(np.arctan2(sine, (area[a] * area[b]).sum(axis=1)))
    joined = (turn <= angle) & (soup.group[a] == soup.group[b])
    return components(len(soup.triangles), a[joined], b[joined])[1]


def _joined(parts: list[Part]) -> Soup:
    shift = np.cumsum([0, *[len(points) for _, points, _ in parts]])
    return Soup(
        np.concatenate([points for _, points, _ in parts]),
        np.concatenate([t + s for (_, _, t), s in zip(parts, shift, strict=False)]),
        np.repeat(np.arange(len(parts)), [len(t) for _, _, t in parts]),
    )


def _checked(soup: Soup, where: str) -> Soup:
    at = first_crossing(soup.points, soup.triangles)
    if at is not None:
        x, y, z = at
        raise FileFormatError(
            f"{where}: the surface must not pass through itself; it does near "
            f"({x:.6g}, {y:.6g}, {z:.6g})"
        )
    return soup


def _through_trimesh(path: Path) -> list[Part]:
    """Groups of triangles, with their names, as trimesh reads them."""
    if path.stat().st_size > _LARGEST:
        raise FileFormatError(f"{path}: a file may have at most {_LARGEST // 2**30} GiB")
    data = path.read_bytes()
    suffix = path.suffix.lower()
    counts = _COUNTS[suffix].findall(data[:4096]) if suffix in _COUNTS else []
    flat = [int(n) for found in counts for n in ([found] if isinstance(found, bytes) else found)]
    if flat and max(flat) > len(data):
        raise FileFormatError(
            f"{path}: the file says it holds {max(flat):,} entries, more than its bytes"
        )
    import trimesh

    # What it has to say of a damaged file is said by an error; without a handler it would print.
    log = logging.getLogger("trimesh")
    if not log.handlers:
        log.addHandler(logging.NullHandler())
    options: dict[str, Any] = {"process": False, "maintain_order": True}
    if suffix == ".obj":
        options |= {"skip_materials": True, "group_material": False}
        options |= {"split_objects": b"\no " in b"\n" + data, "split_groups": True}
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(io.BytesIO(data), file_type=suffix[1:], **options)
        return [
            (_called(key, mesh), np.asarray(mesh.vertices, float), _faces(mesh, path))
            for key, mesh in scene.geometry.items()
            if hasattr(mesh, "faces")
        ]
    except FileFormatError:
        raise
    except Exception as problem:
        # Whatever a damaged file makes of the reader is the file's fault, and says so.
        said = str(problem).strip() or type(problem).__name__
        raise FileFormatError(f"{path} cannot be read as {suffix}: {said[:200]}") from None


def _faces(mesh: Any, path: Path) -> np.ndarray:
    if np.shape(mesh.vertices)[1:] != (3,):
        raise FileFormatError(f"{path}: points must have three coordinates")
    faces = np.asarray(mesh.faces, np.int64).reshape(-1, 3)
    if len(faces) and (faces.min() < 0 or faces.max() >= len(mesh.vertices)):
        raise FileFormatError(f"{path}: a triangle names a point that the file does not have")
    return faces


def _called(key: str, mesh: Any) -> str:
    """The name of a group in the file; a reader's own invention is none."""
    name = str(mesh.metadata.get("name") or key)
    return "" if re.fullmatch(r"geometry(_\d+)?|.*\.(stl|obj|ply|off)", name) else name


def _usable(name: str, default: str) -> str:
    """A name without what names must not hold; dots stay, between parts that are not empty."""
    parts = (re.sub(r"[^\w+-]+", "_", part).strip("_") for part in name.split("."))
    return ".".join(part for part in parts if part) or default


def _different(names: list[str]) -> list[str]:
    """Repeated names numbered from the second on."""
    count: dict[str, int] = {}
    out = []
    for name in names:
        count[name] = count.get(name, 0) + 1
        out.append(name if count[name] == 1 else f"{name}{count[name]}")
    return out

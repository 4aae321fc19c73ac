"""NumPy archives (``.npz``): everything a mesh knows except its domain, without loss.

Arrays are called after the mesh's attributes, those by kind as ``cells.triangle``. Nothing is
pickled, so a file from a stranger can do no harm.
"""

from __future__ import annotations

import json
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from csgmesh.domain.curves import WIDTH, Curves
from csgmesh.errors import FileFormatError, InputError
from csgmesh.mesh import Mesh, PeriodicPair

_VERSION = 1
_CELLS = ("cells", "cell_region")
#: What only refined meshes have.
_LINEAGE = ("cell_parent", "cell_green")
_FACETS = ("facets", "facet_marker", "facet_region", "facet_curve", "facet_interval")
_CURVES = ("kind", "data", "interval")
_PAIR = ("matrix", "offset", "points")


def write(path: Path, mesh: Mesh, *, compress: bool = False) -> None:
    """Write an ``.npz`` file; `compress` makes it smaller and slower."""
    header = {
        "csgmesh_mesh": _VERSION,
        "region_names": list(mesh.region_names),
        "boundary_names": [list(names) for names in mesh.boundary_names],
        "info": dict(mesh.info),
        "cell_kinds": list(mesh.cells),
        "facet_kinds": list(mesh.facets),
        "periodic": [[*pair.names, list(pair.facets)] for pair in mesh.periodic],
    }
    try:
        text = json.dumps(header, ensure_ascii=False, allow_nan=True)
    except TypeError as error:
        raise InputError(f"mesh.info must hold plain values that JSON knows: {error}") from error
    arrays = {"header": np.frombuffer(text.encode(), np.uint8), "points": mesh.points}
    arrays["point_marker"] = mesh.point_marker
    for name in (*_CELLS, *_FACETS):
        arrays.update({f"{name}.{k}": array for k, array in getattr(mesh, name).items()})
    for name in _LINEAGE:
        arrays.update({f"{name}.{k}": array for k, array in getattr(mesh, name).items()})
    for k, pair in enumerate(mesh.periodic):
        arrays.update({f"periodic.{k}.{name}": getattr(pair, name) for name in _PAIR})
        arrays.update({f"periodic.{k}.facets.{kind}": rows for kind, rows in pair.facets.items()})
    if mesh.curves is not None:
        arrays.update({f"curves.{name}": getattr(mesh.curves, name) for name in _CURVES})
    method = zipfile.ZIP_DEFLATED if compress else zipfile.ZIP_STORED
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, array in arrays.items():
            # The date of a ZipInfo is fixed in 1980, so that equal meshes give equal bytes.
            entry = zipfile.ZipInfo(f"{name}.npy")
            entry.compress_type = method
            with archive.open(entry, "w", force_zip64=True) as file:
                np.lib.format.write_array(file, np.ascontiguousarray(array), allow_pickle=False)


def read(path: Path) -> Mesh:
    """Read an ``.npz`` file that `write` made."""
    arrays = _arrays(path)
    header = _header(path, arrays)
    fields: dict[str, Any] = {"info": header["info"]}
    for group, kinds in ((_CELLS, header["cell_kinds"]), (_FACETS, header["facet_kinds"])):
        for name in group:
            fields[name] = {kind: _needed(path, arrays, f"{name}.{kind}") for kind in kinds}
    for name in _LINEAGE:
        known = {kind: arrays.get(f"{name}.{kind}") for kind in header["cell_kinds"]}
        fields[name] = {kind: array for kind, array in known.items() if array is not None}
    curves = None
    if "curves.kind" in arrays:
        curves = Curves(*(_needed(path, arrays, f"curves.{name}") for name in _CURVES))
    try:
        mesh = Mesh(
            _needed(path, arrays, "points"),
            region_names=header["region_names"],
            boundary_names=header["boundary_names"],
            point_marker=_needed(path, arrays, "point_marker"),
            curves=curves,
            periodic=_pairs(path, arrays, header),
            **fields,
        )
    except (InputError, TypeError, AttributeError) as error:
        raise FileFormatError(f"{path} is damaged: {error}") from error
    _check(path, mesh)
    return mesh


def _arrays(path: Path) -> dict[str, np.ndarray]:
    try:
        with zipfile.ZipFile(path) as archive:
            arrays = {}
            for name in archive.namelist():
                with archive.open(name) as file:
                    array = np.lib.format.read_array(file, allow_pickle=False)
                array.flags.writeable = False
                arrays[name.removesuffix(".npy")] = array
            return arrays
    except zipfile.BadZipFile as error:
        raise FileFormatError(f"{path} is no .npz file, or is cut short: {error}") from error
    except (ValueError, EOFError, zlib.error, NotImplementedError, RuntimeError) as error:
        raise FileFormatError(f"{path} is damaged: {error}") from error


def _header(path: Path, arrays: Mapping[str, np.ndarray]) -> dict:
    if "header" not in arrays:
        raise FileFormatError(f"{path} is an .npz file, but holds no csgmesh mesh")
    try:
        header = json.loads(arrays["header"].tobytes().decode())
        version = header["csgmesh_mesh"]
        wanted = ("region_names", "boundary_names", "info", "cell_kinds", "facet_kinds")
        missing = [name for name in wanted if name not in header]
    except (ValueError, TypeError, KeyError) as error:
        raise FileFormatError(f"{path} has a damaged header: {error}") from error
    if version != _VERSION:
        raise FileFormatError(f"{path} is of version {version}; this csgmesh reads {_VERSION}")
    if missing:
        raise FileFormatError(f"{path} has a damaged header: {missing[0]} is missing")
    return header


def _pairs(
    path: Path, arrays: Mapping[str, np.ndarray], header: Mapping[str, Any]
) -> tuple[PeriodicPair, ...]:
    found = []
    for k, entry in enumerate(header.get("periodic", ())):
        if not isinstance(entry, list) or len(entry) != 3 or not isinstance(entry[2], list):
            raise FileFormatError(f"{path} has a damaged header: periodic pair {k} is {entry!r}")
        first, second, kinds = entry
        matrix, offset, points = (_needed(path, arrays, f"periodic.{k}.{n}") for n in _PAIR)
        facets = {kind: _needed(path, arrays, f"periodic.{k}.facets.{kind}") for kind in kinds}
        found.append(PeriodicPair((first, second), matrix, offset, points, facets))
    return tuple(found)


def _needed(path: Path, arrays: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    if name not in arrays:
        raise FileFormatError(f"{path} is damaged: the array {name!r} is missing")
    return arrays[name]


def _check(path: Path, mesh: Mesh) -> None:
    """What `Mesh` does not check: that markers and regions point at something."""
    n_curves = 0 if mesh.curves is None else len(mesh.curves)
    ranges = [
        ("point_marker", {"": mesh.point_marker}, -1, len(mesh.boundary_names)),
        ("cell_region", mesh.cell_region, 0, len(mesh.region_names)),
        ("facet_marker", mesh.facet_marker, -1, len(mesh.boundary_names)),
        ("facet_region", mesh.facet_region, -1, len(mesh.region_names)),
        ("facet_curve", mesh.facet_curve, -1, n_curves),
    ]
    for pair in mesh.periodic:
        ranges.append(("periodic.points", {"": pair.points}, 0, mesh.n_points))
        for kind, rows in pair.facets.items():
            n = len(mesh.facets.get(kind, ()))
            ranges.append(("periodic.facets", {kind: rows}, 0, n))
    for name, by_kind, lowest, end in ranges:
        for kind, array in by_kind.items():
            if array.size and (array.min() < lowest or array.max() >= end):
                raise FileFormatError(
                    f"{path} is damaged: {name}{'.' * bool(kind)}{kind} must lie in "
                    f"[{lowest}, {end}); got {array.min()} to {array.max()}"
                )
    if not np.isfinite(mesh.points).all():
        raise FileFormatError(f"{path} is damaged: a point is not finite")
    if mesh.curves is not None:
        shapes = [getattr(mesh.curves, name).shape for name in _CURVES]
        n = len(mesh.curves)
        if shapes != [(n,), (n, 8), (n, 2)] or not set(mesh.curves.kind.tolist()) <= set(WIDTH):
            raise FileFormatError(f"{path} is damaged: curves of shapes {shapes}")

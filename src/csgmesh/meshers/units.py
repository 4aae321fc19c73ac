"""Domains of extreme extent, meshed in units of their own.

Refinement multiplies up to ten differences of coordinates. Beyond some thirty orders of magnitude
such products leave the range of double precision, so that a domain 1e80 across is meshed in units
of a power of two near 1e80: a change of units that rounds nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np

from csgmesh.domain.curves import Curves
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import MeshingError
from csgmesh.mesh import Mesh
from csgmesh.size.field import Source, UniformSize
from csgmesh.size.resolve import ResolvedSize, evaluate

#: Domains whose diagonal, or whose inverse, is below this are meshed in the units given.
ORDINARY = 1e30


def own_unit(domain: Pslg) -> float:
    """A power of two near the diagonal of a domain of extreme extent; 1 for any other."""
    diagonal = domain.diagonal
    # Periodic sides know their displacement in the units given.
    if 1.0 / ORDINARY < diagonal < ORDINARY or domain.periodic:
        return 1.0
    return float(2.0 ** round(math.log2(diagonal)))


def in_units(domain: Pslg, unit: float) -> Pslg:
    """The domain with all lengths divided by `unit`."""
    known = {field.name: getattr(domain, field.name) for field in fields(domain)}
    curves = domain.curves
    return Pslg.build(
        **known
        | {
            "points": domain.points / unit,
            "curves": Curves(curves.kind, curves.data / unit, curves.interval),
            "deviation": domain.deviation / unit,
            "snap": domain.snap / unit,
            "oracle": None,
        }
    )


def size_in_units(size: ResolvedSize | None, unit: float) -> ResolvedSize | None:
    """The size with all lengths divided by `unit`."""
    if size is None:
        return None

    def changed(source: Source) -> Source:
        if isinstance(source, UniformSize):
            return UniformSize(source.value / unit)
        return lambda points: evaluate(source, points * unit) / unit

    return ResolvedSize(
        None if size.default is None else changed(size.default),
        tuple((markers, changed(source)) for markers, source in size.boundary),
        tuple((regions, changed(source)) for regions, source in size.region),
    )


def mesh_in_own_unit(
    domain: Pslg,
    size: ResolvedSize | None,
    unit: float,
    generate: Callable[[Pslg, ResolvedSize | None], Mesh],
) -> Mesh:
    """Mesh a domain in other units, and change the mesh back.

    Raises
    ------
    MeshingError
        As `generate`, with a note on the units of the places that it names.
    """
    try:
        return _changed_back(
            generate(in_units(domain, unit), size_in_units(size, unit)), domain, unit
        )
    except MeshingError as error:
        error.args = (f"{error} (in units of {unit:.6g})",)
        mesh = getattr(error, "mesh", None)
        if mesh is not None:
            error.mesh = _changed_back(mesh, domain, unit)  # type: ignore[attr-defined]
        raise


def _changed_back(mesh: Mesh, domain: Pslg, unit: float) -> Mesh:
    points: np.ndarray = mesh.points * unit
    return replace(mesh, points=points, curves=domain.curves, domain=domain)

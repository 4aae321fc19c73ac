"""The ``expect`` block of a domain file, and what a mesh has against it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import Field, ValidationError

from csgmesh.domain.input_angles import ANGLE_ROUNDING
from csgmesh.domain.names import find_names
from csgmesh.domainfile.conditions import Condition
from csgmesh.domainfile.exact import Measured, boundary_length, covered_area
from csgmesh.domainfile.exact_space import boundary_area, filled_volume
from csgmesh.domainfile.fields import Expected, Positive, Text, ValidationContext
from csgmesh.domainfile.parts import Part, problems_of
from csgmesh.errors import InputError, NameLookupError
from csgmesh.mesh import Mesh
from csgmesh.tolerance import EXPECTED_SHARE


class ExpectedBoundary(Part):
    """What is expected of a boundary, an interface or an embedded path."""

    length: Expected | None = Field(None, description="Exact length, in the plane")
    area: Expected | None = Field(None, description="Exact area, in space")
    facets: Expected | None = Field(None, description="Number of facets")
    tolerance: Positive | None = Field(None, description="Largest difference from the chords")


class ExpectedRegion(Part):
    """What is expected of a region."""

    area: Expected | None = Field(None, description="Exact area, in the plane")
    volume: Expected | None = Field(None, description="Exact volume, in space")
    cells: Expected | None = Field(None, description="Number of cells")
    tolerance: Positive | None = Field(None, description="Largest difference from the chords")


class Expect(Part):
    """What is expected of a mesh: a geometry regression test.

    A number for a length, an area or a volume is its exact value: a mesh passes if its exact curves
    have it within what these and their chords differ by, and in space if its facets have it within
    what these and their surfaces differ by; or, where a tolerance is given, if its chords or facets
    have it within that. A number for `min_angle` (`max_angle`) is the smallest (largest) allowed.
    """

    area: Expected | None = Field(None, description="Exact area of the domain, in the plane")
    volume: Expected | None = Field(None, description="Exact volume of the domain, in space")
    min_angle: Expected | None = Field(None, description="Smallest angle in degrees")
    max_angle: Expected | None = Field(None, description="Largest angle in degrees")
    min_dihedral: Expected | None = Field(None, description="Smallest dihedral angle in degrees")
    max_dihedral: Expected | None = Field(None, description="Largest dihedral angle in degrees")
    cells: Expected | None = Field(None, description="Number of cells")
    points: Expected | None = Field(None, description="Number of points")
    boundary: dict[str, ExpectedBoundary] = Field({}, description="By name, prefix or glob")
    regions: dict[str, ExpectedRegion] = Field({}, description="By name, prefix or glob")
    names: list[Text] | None = Field(
        None, description="Names, prefixes or globs that together cover all boundary names"
    )
    tolerance: Positive | None = Field(
        None, description="Largest difference from the mesh's lengths, areas and volumes"
    )


@dataclass(frozen=True)
class Mismatch:
    """One expectation that a mesh does not meet.

    Attributes
    ----------
    path : tuple of str or int
        Where it stands in the ``expect`` block.
    message : str
        The value found and what was expected.
    """

    path: tuple[str | int, ...]
    message: str

    def __str__(self) -> str:
        return self.message


def read_expect(expect: Expect | Mapping[str, Any]) -> Expect:
    """An ``expect`` block given as a mapping.

    Raises
    ------
    InputError
        An unknown key or a value that is no condition.

    Examples
    --------
    >>> read_expect({"cells": ">= 2"}).cells
    Condition(low=2.0, high=inf, is_strict=False)
    """
    if isinstance(expect, Expect):
        return expect
    try:
        return Expect.model_validate(dict(expect), context=ValidationContext())
    except ValidationError as error:
        listed = "; ".join(
            f"expect {'.'.join(map(str, problem.path))}: {problem.message}"
            for problem in problems_of(error)
        )
        raise InputError(listed) from None


def mismatches(mesh: Mesh, expect: Expect) -> list[Mismatch]:
    """What a mesh has against expectations, in the order of the fields; empty if it meets them.

    Examples
    --------
    >>> mesh = Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
    >>> [str(m) for m in mismatches(mesh, read_expect({"area": 0.5, "cells": ">= 2"}))]
    ['cells: 1, expected >= 2']
    """
    return list(_mismatches(mesh, expect))


def _mismatches(mesh: Mesh, expect: Expect) -> Iterator[Mismatch]:
    common = expect.tolerance
    if expect.area is not None:
        yield from _measure(("area",), covered_area(mesh), expect.area, common)
    if expect.volume is not None:
        yield from _measure(("volume",), filled_volume(mesh), expect.volume, common)
    yield from _angles(mesh, expect)
    for what, value in (("cells", mesh.n_cells), ("points", mesh.n_points)):
        yield from _count((what,), value, getattr(expect, what))
    for name, side in expect.boundary.items():
        path = ("boundary", name)
        yield from _named(path, _boundary, mesh, name, side, side.tolerance or common)
    for name, region in expect.regions.items():
        path = ("regions", name)
        yield from _named(path, _region, mesh, name, region, region.tolerance or common)
    if expect.names is not None:
        yield from name_mismatches(mesh, expect.names)


def _named(
    path: tuple[str, ...], check: Callable[..., Iterator[Mismatch]], mesh: Mesh, *rest: Any
) -> Iterator[Mismatch]:
    try:
        yield from check(path, mesh, *rest)
    except NameLookupError as error:
        yield Mismatch(path, str(error))


def _boundary(
    path: tuple[str, ...],
    mesh: Mesh,
    name: str,
    wanted: ExpectedBoundary,
    tolerance: float | None,
) -> Iterator[Mismatch]:
    facets = sum(len(rows) for rows in mesh.boundary(name).values())
    if wanted.length is not None:
        length = boundary_length(mesh, name)
        yield from _measure((*path, "length"), length, wanted.length, tolerance)
    if wanted.area is not None:
        yield from _measure((*path, "area"), boundary_area(mesh, name), wanted.area, tolerance)
    yield from _count((*path, "facets"), facets, wanted.facets)


def _region(
    path: tuple[str, ...], mesh: Mesh, name: str, wanted: ExpectedRegion, tolerance: float | None
) -> Iterator[Mismatch]:
    cells = sum(len(rows) for rows in mesh.region(name).values())
    if wanted.area is not None:
        yield from _measure((*path, "area"), covered_area(mesh, name), wanted.area, tolerance)
    if wanted.volume is not None:
        yield from _measure((*path, "volume"), filled_volume(mesh, name), wanted.volume, tolerance)
    yield from _count((*path, "cells"), cells, wanted.cells)


def _count(path: tuple[str, ...], value: int, wanted: Condition | None) -> Iterator[Mismatch]:
    if wanted is not None and not wanted.holds(value):
        yield Mismatch(path, f"{'.'.join(path)}: {value}, expected {wanted}")


def _measure(
    path: tuple[str, ...], measured: Measured, wanted: Condition, tolerance: float | None
) -> Iterator[Mismatch]:
    message = measure_mismatch(".".join(path), measured, wanted, tolerance)
    if message:
        yield Mismatch(path, message)


def measure_mismatch(
    what: str, measured: Measured, wanted: Condition, tolerance: float | None
) -> str:
    """What a length or area has against a condition; empty if it meets it.

    Examples
    --------
    >>> measure_mismatch("area", Measured(7.0, 7.1, 0.1), Condition(8, 8), None)
    'area: 7.1 (7 over the chords), expected 8 within 0.1'
    >>> measure_mismatch("area", Measured(7.0, 7.1, 0.1), Condition(7, 7), 0.01)
    ''
    """
    if not wanted.is_exact:
        if wanted.holds(measured.chords):
            return ""
        return f"{what}: {measured.chords:.10g}, expected {wanted}"
    rounding = EXPECTED_SHARE * max(abs(wanted.low), abs(measured.chords))
    if tolerance is not None or measured.exact is None:
        found, within = measured.chords, tolerance or rounding
        shown = f"{found:.10g}"
    else:
        found, within = measured.exact, measured.bound + rounding
        shown = f"{found:.10g} ({measured.chords:.10g} over the chords)"
    if abs(found - wanted.low) <= within:
        return ""
    hint = ""
    if tolerance is None and measured.exact is None:
        hint = "; a mesh from a file has no exact curves, give a tolerance"
    return f"{what}: {shown}, expected {wanted} within {within:.2g}{hint}"


def _angles(mesh: Mesh, expect: Expect) -> Iterator[Mismatch]:
    known = ("min_angle", "max_angle", "min_dihedral", "max_dihedral")
    keys = [key for key in known if getattr(expect, key) is not None]
    if not keys:
        return
    from csgmesh.measures import quality

    report = quality(mesh)
    for key in keys:
        if not hasattr(report, key):
            place = "the plane" if mesh.dim == 2 else "space"
            yield Mismatch((key,), f"{key}: a mesh of {place} has none")
            continue
        # A mesher's angle of 30 degrees may be measured as 29.999999999999996.
        wanted, is_least = getattr(expect, key), key.startswith("min")
        if wanted.is_exact and is_least:
            wanted = Condition(wanted.low, float("inf"))
        elif wanted.is_exact:
            wanted = Condition(float("-inf"), wanted.high)
        values = getattr(report, key)
        found = float(values.min() if is_least else values.max())
        eased = found + (ANGLE_ROUNDING if is_least else -ANGLE_ROUNDING)
        if not (wanted.holds(found) or wanted.holds(eased)):
            yield Mismatch((key,), f"{key}: {found:.6g}, expected {wanted}")


def name_mismatches(mesh: Mesh, names: list[str] | tuple[str, ...]) -> Iterator[Mismatch]:
    """Names that match no boundary, and boundaries that no name matches.

    Examples
    --------
    >>> mesh = Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]},
    ...             boundary_names=[["wall"], ["door.left"]])
    >>> [str(m) for m in name_mismatches(mesh, ["door", "window"])]
    ["names: no boundary matches 'window'; there are 'wall', 'door.left'", \
"names: unexpected 'wall'"]
    """
    matched: set[str] = set()
    for i, name in enumerate(names):
        try:
            matched.update(find_names(name, mesh.names, what="boundary"))
        except NameLookupError as error:
            yield Mismatch(("names", i), f"names: {error}")
    unexpected = [name for name in mesh.names if name not in matched]
    if unexpected:
        yield Mismatch(("names",), f"names: unexpected {', '.join(map(repr, unexpected))}")

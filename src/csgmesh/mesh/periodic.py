"""Points and facets of a mesh that periodicity identifies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from csgmesh.errors import InputError
from csgmesh.mesh.fields import frozen


@dataclass(frozen=True, eq=False)
class PeriodicPair:
    """Two sides of a mesh whose points match under a rigid map.

    Parameters
    ----------
    names : (str, str)
        The first side and the second, as `csgmesh.Periodic` was given them.
    matrix, offset : (dim, dim), (dim,) float64
        The map ``matrix @ x + offset`` from the first side to the second.
    points : (k, 2) int64
        Numbers of points on the first side and of their images on the second. A point that is its
        own image, such as the apex of a sector, is paired with itself.
    facets : mapping of str to (m, 2) int64
        Numbers of facets that match, by kind. Both have the domain on their left, so in the plane
        the second runs from the image of the first's end to that of its start.

    Raises
    ------
    InputError
        If an array has the wrong shape or type.
    """

    names: tuple[str, str]
    matrix: np.ndarray
    offset: np.ndarray
    points: np.ndarray
    facets: Mapping[str, np.ndarray]

    def __post_init__(self) -> None:
        names = tuple(str(name) for name in self.names)
        if len(names) != 2:
            raise InputError(f"names must be of two sides; got {self.names!r}")
        dim = len(np.atleast_1d(self.offset))
        facets = {
            kind: frozen(f"facets[{kind!r}]", rows, np.int64, (None, 2))
            for kind, rows in self.facets.items()
        }
        new: dict[str, Any] = {
            "names": names,
            "matrix": frozen("matrix", self.matrix, np.float64, (dim, dim)),
            "offset": frozen("offset", self.offset, np.float64, (dim,)),
            "points": frozen("points", self.points, np.int64, (None, 2)),
            "facets": MappingProxyType(facets),
        }
        for name, value in new.items():
            object.__setattr__(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        plain = (self.names, self.matrix, self.offset, self.points, dict(self.facets))
        return PeriodicPair, plain

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PeriodicPair) or self.names != other.names:
            return NotImplemented if not isinstance(other, PeriodicPair) else False
        arrays = ("matrix", "offset", "points")
        same = all(np.array_equal(getattr(self, n), getattr(other, n)) for n in arrays)
        return same and (
            list(self.facets) == list(other.facets)
            and all(np.array_equal(rows, other.facets[k]) for k, rows in self.facets.items())
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<PeriodicPair {self.names[0]} → {self.names[1]}: {len(self.points)} points>"


def representatives(n_points: int, pairs: tuple[PeriodicPair, ...]) -> np.ndarray:
    """The lowest number among the points that each point is identified with, (n,) int64.

    Pairs meet at corners: there it takes several steps from one point of an orbit to another.
    """
    lowest = np.arange(n_points)
    links = np.concatenate([np.zeros((0, 2), np.int64), *(pair.points for pair in pairs)])
    while len(links):
        before = lowest.copy()
        smaller = lowest[links].min(axis=1)
        np.minimum.at(lowest, links[:, 0], smaller)
        np.minimum.at(lowest, links[:, 1], smaller)
        if (lowest == before).all():
            break
    return lowest


def halved_pairs(pairs: tuple[PeriodicPair, ...], middle: np.ndarray) -> tuple[PeriodicPair, ...]:
    """The pairs of a mesh whose line facets are halved, partners alike.

    Parameters
    ----------
    pairs : tuple of PeriodicPair
        Of the mesh before.
    middle : (f,) int64
        The new point on each facet, -1 for none. The halves stand where their facet stood.
    """
    halved = middle >= 0
    first = np.arange(len(middle)) + np.cumsum(halved) - halved
    made = []
    for pair in pairs:
        rows = pair.facets["line"]
        a, b = rows.T
        both = halved[a]
        facets = first[rows]
        # The second facet runs against the first: its second half is the first one's first.
        facets[both, 1] += 1
        behind = first[rows[both]] + [1, 0]
        order = np.argsort(np.r_[np.arange(len(rows)), np.flatnonzero(both)], kind="stable")
        points = np.vstack([pair.points, np.column_stack([middle[a], middle[b]])[both]])
        lines = np.vstack([facets, behind])[order]
        made.append(PeriodicPair(pair.names, pair.matrix, pair.offset, points, {"line": lines}))
    return tuple(made)


def elevated_pairs(
    pairs: tuple[PeriodicPair, ...], kind: str, facets: np.ndarray
) -> tuple[PeriodicPair, ...]:
    """The pairs of a mesh whose line facets became curved ones.

    Parameters
    ----------
    pairs : tuple of PeriodicPair
        Of the mesh before.
    kind : str
        What the facets became.
    facets : (f, k) int64
        Their points: ends first, then what lies between, in the order of the lines.
    """
    made = []
    for pair in pairs:
        rows = pair.facets["line"]
        # The second facet runs against the first.
        inner = [facets[rows[:, 0], 2:].ravel(), facets[rows[:, 1], 2:][:, ::-1].ravel()]
        points = np.vstack([pair.points, np.column_stack(inner)])
        made.append(PeriodicPair(pair.names, pair.matrix, pair.offset, points, {kind: rows}))
    return tuple(made)

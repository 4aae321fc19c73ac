"""Contours of outlines: reading them, and their exact curves."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.csg import checks
from csgmesh.domain.curves import Curves
from csgmesh.errors import ShapeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

Point = tuple[float, ...]
#: ``(start, segment, …)``; a segment is its kind followed by its points, the last one its end.
Contour = tuple[Any, ...]

#: Points of a segment, its end included.
SEGMENT_POINTS = {"line": 1, "arc": 2, "quadratic": 2, "cubic": 3}

#: Codes of path arrays, and the segments they stand for.
_MOVE, _CLOSE = 1, 79
_PATH_SEGMENTS = {2: "line", 3: "quadratic", 4: "cubic"}


def read_contour(value: Any, what: str, where: str) -> Contour:
    """A contour in canonical form: every segment spelled out, those without extent left out."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise ShapeError(f"{where}: {what} must be a start point and segments; got {value!r}")
    items = list(value)
    if len(items) < 2:
        raise ShapeError(f"{where}: {what} must have a start point and segments; got {value!r}")
    start = at = checks.vector(items[0], f"the start of {what}", where, 2)
    segments = []
    for k, item in enumerate(items[1:]):
        segment = _read_segment(item, f"segment {k} of {what}", where)
        if any(p != at for p in segment[1:]):
            segments.append(segment)
        at = segment[-1]
    if not segments:
        raise ShapeError(f"{where}: {what} must have an extent; it stays at {start}")
    return (start, *segments)


def _read_segment(item: Any, what: str, where: str) -> tuple[Any, ...]:
    parts = list(item) if isinstance(item, Iterable) and not isinstance(item, str) else [item]
    if not parts or not isinstance(parts[0], str):
        return ("line", checks.vector(item, what, where, 2))
    kind, points = parts[0], parts[1:]
    if kind not in SEGMENT_POINTS:
        known = ", ".join(repr(k) for k in SEGMENT_POINTS)
        raise ShapeError(f"{where}: {what} must be one of {known}; got {kind!r}")
    if len(points) != SEGMENT_POINTS[kind]:
        raise ShapeError(
            f"{where}: {what}, {kind!r}, takes {SEGMENT_POINTS[kind]} point(s); got {len(points)}"
        )
    return (kind, *[checks.vector(p, what, where, 2) for p in points])


def path_contours(vertices: ArrayLike, codes: ArrayLike, where: str) -> list[list[Any]]:
    """Contours of path arrays; those that stay at one point, as fonts have them, are skipped."""
    points = checks.point_array(vertices, "vertices", where).tolist()
    kinds = np.asarray(codes).tolist()
    if len(kinds) != len(points):
        raise ShapeError(f"{where}: {len(points)} vertices need as many codes; got {len(kinds)}")
    contours: list[list[Any]] = []
    k = 0
    while k < len(points):
        code = kinds[k]
        if code == _MOVE:
            contours.append([points[k]])
            k += 1
        elif code == _CLOSE:
            k += 1
        elif code in _PATH_SEGMENTS:
            kind = _PATH_SEGMENTS[code]
            count = SEGMENT_POINTS[kind]
            if not contours or kinds[k : k + count] != [code] * count:
                raise ShapeError(
                    f"{where}: codes must begin with a move (1) and give {count} points for each "
                    f"{kind} ({code}); got {kinds[k : k + count]} at {k}"
                )
            contours[-1].append((kind, *points[k : k + count]))
            k += count
        else:
            raise ShapeError(f"{where}: codes must be 1, 2, 3, 4 or 79; got {code!r} at {k}")
    return [c for c in contours if any(list(p) != c[0] for _, *ps in c[1:] for p in ps)]


def contour_curves(contours: Sequence[Contour]) -> Curves:
    """The curves of all contours, each closed, in order."""
    found: dict[str, list[tuple[int, tuple[Point, ...]]]] = {kind: [] for kind in SEGMENT_POINTS}
    count = 0
    for start, *segments in contours:
        at = start
        closing = [("line", start)] if segments[-1][-1] != start else []
        for kind, *points in [*segments, *closing]:
            found[kind].append((count, (at, *points)))
            at = points[-1]
            count += 1
    tables, position = [], []
    for kind, entries in found.items():
        if entries:
            controls = np.array([points for _, points in entries]).transpose(1, 0, 2)
            tables.append(_TABLES[kind](*controls))
            position += [k for k, _ in entries]
    return Curves.concatenate(tables)[np.argsort(position)]


def _circular(start: np.ndarray, through: np.ndarray, end: np.ndarray) -> Curves:
    """Circular arcs through three points; straight where they lie on a line.

    An arc's first axis is the radius to its start, so that it starts exactly there. Three points
    that come back to the start make the whole circle whose diameter is start–through.
    """
    a, b = through - start, end - start
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    aa, bb = (a * a).sum(axis=1), (b * b).sum(axis=1)
    closed = bb == 0.0
    straight = (np.abs(cross) <= 1e-15 * np.maximum(aa, bb)) & ~closed
    twice = np.where(straight | closed, 1.0, 2.0 * cross)
    middle = np.stack([aa * b[:, 1] - bb * a[:, 1], bb * a[:, 0] - aa * b[:, 0]], axis=1)
    middle = np.where(closed[:, None], 0.5 * a, middle / twice[:, None])
    u = -middle
    # Counterclockwise (through lies right of the chord) or clockwise.
    turn = np.where(closed | (cross > 0.0), 1.0, -1.0)
    v = np.stack([-u[:, 1], u[:, 0]], axis=1) * turn[:, None]
    reach = b - middle
    sweep = np.arctan2((reach * v).sum(axis=1), (reach * u).sum(axis=1))
    sweep = np.where(closed, 2.0 * np.pi, np.where(sweep <= 0.0, sweep + 2.0 * np.pi, sweep))
    arcs = Curves.arcs(start + middle, u, v, np.zeros(len(u)), sweep)
    if not straight.any():
        return arcs
    lines = Curves.lines(start, end)
    return Curves(
        np.where(straight, lines.kind, arcs.kind),
        np.where(straight[:, None], lines.data, arcs.data),
        np.where(straight[:, None], lines.interval, arcs.interval),
    )


_TABLES: dict[str, Callable[..., Curves]] = {
    "line": Curves.lines,
    "arc": _circular,
    "quadratic": Curves.quadratics,
    "cubic": Curves.cubics,
}

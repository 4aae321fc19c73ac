"""Domains of the benchmarks in the plane."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

import csgmesh as cm
from csgmesh.domain import Pslg
from csgmesh.errors import CsgmeshError

#: A mesh whose mean edge is h has about so many triangles per area / h².
PER_AREA = 2.31

Loop = Sequence[tuple[float, float]] | np.ndarray


def square() -> cm.Shape:
    """The unit square."""
    return cm.Box((0, 0), (1, 1), name="box")


def three_shapes(n: int) -> dict[str, tuple[Pslg, Pslg, float]]:
    """A domain, the same in chords of the wanted length, and that length for n triangles.

    The peers get chords, since curves are not theirs to follow.
    """
    holes = ((0.3, 0.3, 0.15), (0.7, 0.4, 0.1), (0.4, 0.75, 0.12))
    shapes = {"square": square(), "disk": cm.Disk((0, 0), 1), "square minus disks": square()}
    for x, y, r in holes:
        shapes["square minus disks"] -= cm.Disk((x, y), r)
    found = {}
    for name, shape in shapes.items():
        h = float(np.sqrt(PER_AREA * cm.evaluate(shape).areas().sum() / n))
        # Around the smallest hole chords may be as long as the size: finer ones would decide.
        domain = cm.evaluate(shape, deviation=h * h / (8 * 0.1))
        chords = domain
        if name == "disk":
            chords = cm.evaluate(cm.RegularPolygon((0, 0), 1, round(2 * np.pi / h)))
        elif name == "square minus disks":
            polygon = square()
            for x, y, r in holes:
                polygon -= cm.RegularPolygon((x, y), r, round(2 * np.pi * r / h))
            chords = cm.evaluate(polygon)
        found[name] = (domain, chords, h)
    return found


def poly_samples() -> dict[str, Pslg]:
    """The ``.poly`` samples of the triangle package, read from where it is installed."""
    import triangle

    folder = os.path.join(os.path.dirname(triangle.__file__), "data")
    found = {}
    for file in sorted(os.listdir(folder)):
        name = file.removesuffix(".poly")
        if file.endswith(".poly") and "." not in name:
            given = triangle.get_data(name)
            try:
                found[name] = Pslg(
                    given["vertices"], given["segments"], holes=given.get("holes", ())
                )
            except (CsgmeshError, KeyError):
                # One of them leaves its outline open, which a Pslg must not.
                continue
    return found


def loops(*contours: Loop) -> Pslg:
    """A domain of closed contours, holes and islands by turns."""
    points, segments, first = [], [], 0
    for contour in contours:
        n = len(contour)
        points.append(np.asarray(contour, float))
        index = np.arange(n)
        segments.append(first + np.column_stack([index, np.roll(index, -1)]))
        first += n
    return Pslg(np.vstack(points), np.vstack(segments))


def _polar(radii: np.ndarray) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    return np.column_stack([radii * np.cos(t), radii * np.sin(t)])


def _wedge(degrees: float) -> Pslg:
    """A sharp corner between sides of different lengths, in a domain that goes on behind it."""
    t = np.radians(degrees)
    return loops([(0, 0), (1, 0), (1, 1), (0.6 * np.cos(t), 0.6 * np.sin(t))])


def _koch(level: int) -> Pslg:
    p = np.array([0, 1, np.exp(1j * np.pi / 3)])[::-1]
    for _ in range(level):
        d = (np.roll(p, -1) - p) / 3
        p = np.stack([p, p + d, p + d + d * np.exp(1j * np.pi / 3), p + 2 * d], 1).ravel()
    return loops(np.column_stack([p.real, p.imag]))


def _comb(teeth: int) -> Pslg:
    top = [q for k in range(teeth)[::-1]
           for q in ((k + 0.95, 5.0), (k + 0.5, 5.0), (k + 0.5, 0.5), (k + 0.0, 5.0))]  # fmt: skip
    return loops([(0, 0), (teeth - 0.05, 0), *top])


def _spiral(turns: int, n: int) -> Pslg:
    t = np.linspace(np.pi, 2 * np.pi * turns, n)
    inner = np.column_stack([t * np.cos(t), t * np.sin(t)])
    outer = np.column_stack([(t + 2) * np.cos(t), (t + 2) * np.sin(t)])
    return loops(np.vstack([inner, outer[::-1]]))


def _box(w: float) -> Loop:
    return [(-w, -w), (w, -w), (w, w), (-w, w)]


#: What a mesher may stumble over.
HARD = {
    **{f"wedge of {a:g} degrees": _wedge(a) for a in (45, 10, 1, 1e-2, 1e-4, 1e-6)},
    "star of 1,000 spikes": loops(_polar(np.where(np.arange(2000) % 2, 0.1, 1.0))),
    "comb of 100 teeth": _comb(100),
    "spiral": _spiral(8, 400),
    "Koch snowflake, level 5": _koch(5),
    "frame 1e-3 wide": loops(_box(1), _box(1 - 1e-3)),
    "hole with an island 1e-9 inside": loops(_box(2), _box(1), _box(1 - 1e-9)),
    "square at 1e9": loops(1e9 + np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)),
    "needle": loops([(0, 0), (1, 0), (1, 1e-3), (0, 1e-3)]),
}

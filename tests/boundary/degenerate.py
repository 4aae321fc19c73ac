"""Degenerate domains with their exact areas: the normal case in constructive solid geometry."""

from __future__ import annotations

from math import acos, pi, sqrt

import csgmesh as cm

BOX = cm.Box((0, 0), (2, 2), name="box")
UNIT = cm.Disk((0, 0), 1, name="unit")


def lens(r: float, s: float, d: float) -> float:
    """Area common to two disks of radii r and s at distance d."""
    a = r * r * acos((d * d + r * r - s * s) / (2 * d * r))
    b = s * s * acos((d * d + s * s - r * r) / (2 * d * s))
    c = sqrt((-d + r + s) * (d + r - s) * (d - r + s) * (d + r + s)) / 2
    return a + b - c


#: Label: shape, exact area, names that must arrive, number of components, number of holes.
CASES = {
    "disks touching outside": (UNIT | cm.Disk((2, 0), 1, name="b"), 2 * pi, {"unit", "b"}),
    "disk touching inside": (UNIT - cm.Disk((0.5, 0), 0.5, name="b"), 0.75 * pi, {"unit", "b"}),
    "disk tangent to a side, outside": (
        BOX | cm.Disk((3, 1), 1, name="b"),
        4 + pi,
        {"box.left", "box.right", "box.bottom", "box.top", "b"},
    ),
    "disk tangent to a side, inside": (
        BOX - cm.Disk((1, 0.5), 0.5, name="b"),
        4 - pi / 4,
        {"box.left", "box.right", "box.bottom", "box.top", "b"},
    ),
    "disk tangent to four sides": (
        BOX - cm.Disk((1, 1), 1, name="b"),
        4 - pi,
        {"box.left", "box.right", "box.bottom", "box.top", "b"},
    ),
    "circle through a vertex": (
        BOX | cm.Disk((2.6, 2.8), 1, name="b"),
        4 + pi,
        {"box.left", "box.right", "box.bottom", "box.top", "b"},
    ),
    "circle around a vertex": (BOX - UNIT, 4 - pi / 4, {"box.left", "unit"}),
    "duplicated leaves": (UNIT | cm.Disk((0, 0), 1, name="b") | UNIT, pi, {"unit", "b"}),
    "duplicated holes": (
        BOX - cm.Disk((1, 1), 0.5, name="b") - cm.Disk((1, 1), 0.5, name="c"),
        4 - pi / 4,
        {"b", "c"},
    ),
    "coincident edges": (BOX | cm.Box((2, 0), (4, 2), name="b"), 8, {"box.left", "b.right"}),
    "partly coincident edges": (
        BOX | cm.Box((2, 0.5), (4, 1), name="b"),
        5,
        {"box.right", "b.right"},
    ),
    "shared vertex": (BOX | cm.Box((2, 2), (3, 3), name="b"), 5, {"box.top", "b.left"}),
    "holes touching each other": (
        cm.Box((0, 0), (4, 4), name="box")
        - cm.Disk((1, 2), 1, name="b")
        - cm.Disk((3, 2), 1, name="c"),
        16 - 2 * pi,
        {"b", "c"},
    ),
    "holes sharing an edge": (
        cm.Box((0, 0), (4, 4), name="box")
        - cm.Box((1, 1), (2, 2), name="b")
        - cm.Box((2, 1), (3, 2), name="c"),
        14,
        {"b.left", "c.right"},
    ),
    "nested": (
        (cm.Disk((0, 0), 3, name="a") - cm.Disk((0, 0), 2, name="b")) | UNIT,
        6 * pi,
        {"a", "b", "unit"},
    ),
    "disconnected": (UNIT | cm.Box((3, 3), (4, 4), name="b"), pi + 1, {"unit", "b.left"}),
    "cut in two": (BOX - cm.Box((0.5, -1), (1.5, 3), name="b"), 2, {"b.left", "b.right"}),
    "half-spaces only": (
        cm.HalfSpace((0, 0), (-1, 0), name="a")
        & cm.HalfSpace((0, 0), (0, -1), name="b")
        & cm.HalfSpace((1, 1), (1, 1), name="c"),
        2,
        {"a", "b", "c"},
    ),
    "sliver of 1e-3": (BOX - cm.Box((0, 0), (2 - 1e-3, 2), name="b"), 2e-3, {"b.right"}),
    "sliver of 1e-6": (BOX - cm.Box((0, 0), (2 - 1e-6, 2), name="b"), 2e-6, {"b.right"}),
    "sliver of 1e-9": (BOX - cm.Box((0, 0), (2 - 1e-9, 2), name="b"), 2e-9, {"b.right"}),
    "gap of 1e-3": (UNIT | cm.Disk((2 + 1e-3, 0), 1, name="b"), 2 * pi, {"unit", "b"}),
    "gap of 1e-6": (UNIT | cm.Disk((2 + 1e-6, 0), 1, name="b"), 2 * pi, {"unit", "b"}),
    "gap of 1e-9": (UNIT | cm.Disk((2 + 1e-9, 0), 1, name="b"), 2 * pi, {"unit", "b"}),
    "overlap of 1e-3": (
        UNIT | cm.Disk((2 - 1e-3, 0), 1, name="b"),
        2 * pi - lens(1, 1, 2 - 1e-3),
        {"unit", "b"},
    ),
    "overlap of 1e-9": (UNIT | cm.Disk((2 - 1e-9, 0), 1, name="b"), 2 * pi, {"unit", "b"}),
    "lens": (UNIT & cm.Disk((1, 0), 1, name="b"), lens(1, 1, 1), {"unit", "b"}),
    "crescent": (UNIT - cm.Disk((1, 0), 1, name="b"), pi - lens(1, 1, 1), {"unit", "b"}),
    "half disk": (UNIT & cm.HalfSpace((0, 0), (0, -1), name="b"), pi / 2, {"unit", "b"}),
    "ellipse touching a disk": (
        cm.Ellipse((0, 0), (2, 1), name="a") - cm.Disk((0, 0), 1, name="b"),
        pi,
        {"a", "b"},
    ),
    "nearly the same disk": (
        UNIT - cm.Disk((0.01, 0), 0.99, name="b"),
        pi * (1 - 0.99**2),
        {"unit", "b"},
    ),
    "thin ring": (
        cm.Disk((0, 0), 1 + 1e-6, name="a") - UNIT,
        pi * (2e-6 + 1e-12),
        {"a", "unit"},
    ),
    "four disks round one": (
        cm.union(
            [cm.Disk((2 * x, 2 * y), 1, name="b") for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))]
        )
        | UNIT,
        5 * pi,
        {"b", "unit"},
    ),
}

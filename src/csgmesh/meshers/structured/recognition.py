"""Which blocks a domain consists of: four-sided faces, rings and disks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from csgmesh.domain.curves import Curves
from csgmesh.domain.names import find_markers
from csgmesh.errors import InputError, MeshingError
from csgmesh.meshers.structured.layout import Layout, Side, reverse
from csgmesh.meshers.structured.outline import Face, Loop, Outline, Part, turned

#: Corners of a disk's core lie at this share of the way from its centre to its boundary.
CORE = 0.55
#: How far the sides of the core bulge, of the way from the chord to the parallel of the boundary:
#: the three angles at its corners are then nearly equal.
BULGE = 0.3
#: A block's corner on a round boundary moves to a joint of curves within this share of a quarter.
NEAR_JOINT = 0.1
#: Corners that a caller gives may be off the boundary by this share of the diagonal.
CORNER_REACH = 1e-3
#: Points of a ring's outer boundary at which its width is probed.
PROBES = 32


def round_loop(loop: Loop) -> bool:
    """Whether a loop has no corner."""
    return not loop.corners()


def ccw(loop: Loop) -> Loop:
    """The loop run counterclockwise."""
    return loop if loop.area > 0 else Loop(loop.outline, turned(loop.parts))


class Recognition:
    """Lays blocks out, face by face, from the outside inwards."""

    def __init__(self, outline: Outline) -> None:
        self.layout = Layout(outline)
        self.outline = outline
        self.rows: dict[object, list[Side]] = {}
        self.in_quarters = any(
            (round_loop(face.outer) and not face.holes)
            or (face.holes and len({round_loop(loop) for loop in (face.outer, *face.holes)}) > 1)
            for face in outline.faces
        )

    def face(self, face: Face) -> None:
        """Blocks of one face."""
        corners = face.outer.corners()
        if len(face.holes) > 1:
            raise self._not_possible(face, f"it has {len(face.holes)} holes")
        if face.holes:
            self.ring(face.region, face.outer, face.holes[0])
        elif not corners:
            self.disk(face.region, face.outer)
        elif len(corners) == 4:
            self.four_sided(face.region, face.outer, corners)
        else:
            raise self._not_possible(
                face, f"its outer boundary has {len(corners)} corners, not four"
            )

    def four_sided(self, region: int, loop: Loop, corners: Sequence[float]) -> None:
        """One block."""
        bottom, right, top, left = self.quarters(loop, corners)
        self.layout.block(region, bottom, right, reverse(top), reverse(left))

    def ring(self, region: int, outer: Loop, hole: Loop) -> None:
        """Four blocks around a hole, or one that closes on itself."""
        inner = ccw(hole)
        corners, inner_corners = outer.corners(), inner.corners()
        for loop, found in ((outer, corners), (inner, inner_corners)):
            if len(found) not in (0, 4):
                x, y = loop.polygon[0]
                raise MeshingError(
                    "a ring of blocks needs boundaries that are smooth or have four corners; the "
                    f"one through ({x:.6g}, {y:.6g}) has {len(found)}; use QuadPairing or "
                    "DelaunayRefinement"
                )
        if not corners and not inner_corners and not self.in_quarters:
            self._closed_ring(region, outer, inner)
            return
        if corners:
            outside = self.quarters(outer, corners)
            inside = self.facing(inner, inner_corners, outside)
        elif inner_corners and outer.key not in self.rows:
            inside = self.quarters(inner, inner_corners)
            outside = self.facing(outer, [], inside)
        else:
            outside = self.quarters(outer)
            inside = self.facing(inner, inner_corners, outside)
        self.join(region, inside, outside)

    def quarters(self, loop: Loop, cuts: Sequence[float] | None = None) -> list[Side]:
        """The four edges of a loop, counterclockwise; those it was cut into first stay."""
        if loop.key not in self.rows:
            places = _quarter_places(loop) if cuts is None else list(cuts)
            if len(places) != 4 or len({round(p, 12) for p in places}) < 4:
                x, y = loop.polygon[0]
                raise MeshingError(
                    f"the boundary through ({x:.6g}, {y:.6g}) cannot be cut into four sides"
                )
            self.rows[loop.key] = [
                self.layout.edge(loop.between(places[k], places[(k + 1) % 4])) for k in range(4)
            ]
        return self.rows[loop.key]

    def facing(self, loop: Loop, corners: list[float], others: list[Side]) -> list[Side]:
        """The four edges of a loop that lie opposite those of another one, in their order."""
        points = [self.layout.corners[self.layout.ends(side)[0]] for side in others]
        if loop.key not in self.rows:
            reach = NEAR_JOINT * loop.length / 4
            cuts = corners or [loop.snapped(loop.nearest(p)[0], reach) for p in points]
            first = int(np.argmin(cuts))
            self.quarters(loop, [*cuts[first:], *cuts[:first]])
        row = self.rows[loop.key]
        starts = np.array([self.layout.corners[self.layout.ends(side)[0]] for side in row])
        # The assignment that turns the connecting lines the least.
        shift = min(
            range(4),
            key=lambda s: sum(
                float(np.hypot(*(starts[(k + s) % 4] - points[k]))) for k in range(4)
            ),
        )
        return [row[(k + shift) % 4] for k in range(4)]

    def join(self, region: int, inside: list[Side], outside: list[Side]) -> None:
        ends = self.layout.ends
        spokes = [self.layout.line(ends(a)[0], ends(b)[0])
                  for a, b in zip(inside, outside, strict=True)]  # fmt: skip
        for k in range(4):
            self.layout.block(region, spokes[k], outside[k], spokes[(k + 1) % 4], inside[k])

    def _closed_ring(self, region: int, outer: Loop, inner: Loop) -> None:
        if outer.key not in self.rows:
            place = _widest(outer, inner)
            self.rows[outer.key] = [self.layout.edge(outer.between(place, place))]
        if inner.key not in self.rows:
            point = self.layout.corners[self.layout.ends(self.rows[outer.key][0])[0]]
            place = inner.snapped(inner.nearest(point)[0], NEAR_JOINT * inner.length / 4)
            self.rows[inner.key] = [self.layout.edge(inner.between(place, place))]
        left, right = self.rows[inner.key][0], self.rows[outer.key][0]
        spoke = self.layout.line(self.layout.ends(left)[0], self.layout.ends(right)[0])
        self.layout.block(region, spoke, right, spoke, left)

    def disk(self, region: int, loop: Loop) -> None:
        """A core, and four blocks around it."""
        outside = self.quarters(loop)
        layout = self.layout
        centre = _centroid(loop.polygon)
        at = [layout.corners[layout.ends(side)[0]] for side in outside]
        core = [layout.corner(centre + CORE * (p - centre)) for p in at]
        inside = []
        for k in range(4):
            p, q = (layout.corners[core[j]] for j in (k, (k + 1) % 4))
            middle = 0.5 * (p + q)
            s = 0.5 * (loop.nearest(at[k])[0] + _after(loop, at[k], at[(k + 1) % 4]))
            outer = centre + CORE * (self._at(loop, s) - centre)
            control = middle + 2 * BULGE * (outer - middle)
            curve = Curves.quadratics(p[None], control[None], q[None])
            inside.append(layout.edge([Part(self.outline.add(curve), 0.0, 1.0)]))
        bottom, right, top, left = inside
        layout.block(region, bottom, right, reverse(top), reverse(left))
        self.join(region, inside, outside)

    def _at(self, loop: Loop, s: float) -> np.ndarray:
        k, t = loop.place_of(s)
        return self.outline.point(loop.parts[k].curve, t)

    def _not_possible(self, face: Face, reason: str) -> MeshingError:
        name = self.outline.domain.region_names[face.region]
        x, y = face.outer.polygon[0]
        return MeshingError(
            "a structured grid knows boxes with disks in them, rectilinear domains, four-sided "
            f"domains, rings and disks; region {name!r} at ({x:.6g}, {y:.6g}) is none: {reason}; "
            "give corners= or sides=, or use QuadPairing"
        )


def from_names(recognition: Recognition, sides: Sequence[str]) -> None:
    """One block whose four sides carry the given names."""
    outline = recognition.outline
    face = _only_face(outline, "sides")
    if len(sides) != 4:
        raise InputError(f"sides must be four names; got {list(sides)!r}")
    names = outline.domain.boundary_names
    markers = [set(find_markers(name, names).tolist()) for name in sides]
    loop = face.outer
    owner = []
    for part in loop.parts:
        found = [k for k in range(4) if part.marker in markers[k]]
        if len(found) != 1:
            told = " = ".join(names[part.marker])
            ways = "none" if not found else " and ".join(repr(sides[k]) for k in found)
            raise InputError(
                f"each boundary must lie on one of the four sides; {told} is on {ways}"
            )
        owner.append(found[0])
    starts = [k for k in range(len(owner)) if owner[k] != owner[k - 1]]
    if len(starts) != 4 or len(set(owner)) != 4:
        raise InputError(
            f"sides must be four connected stretches of the boundary; {list(sides)!r} are "
            f"{len(starts)} in the order {', '.join(repr(sides[owner[k]]) for k in starts)}"
        )
    recognition.four_sided(face.region, loop, [float(loop.start[k]) for k in starts])


def from_corners(recognition: Recognition, corners: Sequence[Sequence[float]]) -> None:
    """One block with the given corners."""
    outline = recognition.outline
    face = _only_face(outline, "corners")
    points = np.asarray(corners, float)
    if points.shape != (4, 2):
        raise InputError(f"corners must be four points; got shape {points.shape}")
    loop, places = face.outer, []
    for point in points:
        place, away = loop.nearest(point)
        if away > CORNER_REACH * outline.domain.diagonal:
            raise InputError(
                f"corners must lie on the boundary; ({point[0]:.6g}, {point[1]:.6g}) is "
                f"{away:.3g} away from it"
            )
        places.append(loop.snapped(place, CORNER_REACH * loop.length))
    order = np.argsort(places)
    recognition.four_sided(face.region, loop, [places[k] for k in order])


def _only_face(outline: Outline, what: str) -> Face:
    if len(outline.faces) != 1 or outline.faces[0].holes:
        raise InputError(
            f"{what}= are those of a domain of one region without holes; this one has "
            f"{len(outline.faces)} faces and {sum(len(f.holes) for f in outline.faces)} holes"
        )
    return outline.faces[0]


def _quarter_places(loop: Loop) -> list[float]:
    """Where a smooth loop is cut: at 45 degrees to its principal axes, scaled to one length."""
    p = loop.polygon - _centroid(loop.polygon)
    axes = np.linalg.svd(p, full_matrices=False)
    if axes[1][0] < 1.02 * axes[1][1]:
        direction = np.eye(2)
    else:
        direction = (
            axes[2] * np.sign(axes[2][np.arange(2), np.abs(axes[2]).argmax(axis=1)])[:, None]
        )
    x, y = (p @ direction.T / axes[1]).T
    if np.linalg.det(direction) < 0:
        y = -y
    angle = np.unwrap(np.arctan2(y, x))
    s = np.concatenate([row[:-1] + start for row, start in zip(loop.s, loop.start, strict=False)])
    first = np.ceil((angle[0] - np.pi / 4) / (np.pi / 2)) * np.pi / 2 + np.pi / 4
    wanted = first + np.arange(4) * np.pi / 2
    angle, s = np.append(angle, angle[0] + 2 * np.pi), np.append(s, loop.length)
    reach = NEAR_JOINT * loop.length / 4
    return sorted(loop.snapped(float(np.interp(w, angle, s)), reach) for w in wanted)


def _widest(outer: Loop, inner: Loop) -> float:
    """Where a ring is widest, on its outer loop: the way across needs most cells there."""
    step = max(1, len(outer.polygon) // PROBES)
    gaps = np.array([inner.nearest(point)[1] for point in outer.polygon[::step]])
    s = np.concatenate([row[:-1] + at for row, at in zip(outer.s, outer.start, strict=False)])
    first = int(np.flatnonzero(gaps >= gaps.max() * (1 - 1e-6))[0])
    return outer.snapped(float(s[::step][first]), NEAR_JOINT * outer.length / 4)


def _after(loop: Loop, p: np.ndarray, q: np.ndarray) -> float:
    """Place of q, which comes after p."""
    a, b = loop.nearest(p)[0], loop.nearest(q)[0]
    return b if b > a else b + loop.length


def _centroid(polygon: np.ndarray) -> np.ndarray:
    base = polygon.mean(axis=0)
    p, q = polygon - base, np.roll(polygon, -1, axis=0) - base
    area = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    return base + ((p + q) * area[:, None]).sum(axis=0) / (3 * area.sum())

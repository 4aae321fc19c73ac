"""Leaves as facets in local coordinates; those whose curved surfaces coincide are cut alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from csgmesh.boundary.coincidence import coincidence
from csgmesh.boundary.facets import Facets, facets
from csgmesh.csg.primitives.box import Box
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.program import Leaf
from csgmesh.csg.solid import Profile, Revolution, Solid, frame_along
from csgmesh.domain.curves import ARC
from csgmesh.domain.surfaces import PLANE, Surfaces
from csgmesh.errors import UnboundedDomainError
from csgmesh.graphs import components
from csgmesh.spatial import near_pairs
from csgmesh.tolerance import DEVIATION_SHARE

#: Half-spaces alone bound a domain with corners where three planes meet; beyond this many planes
#: there are too many triples to try.
_MOST_PLANES = 60

_SIDES = Box((0, 0, 0), (1, 1, 1)).parts

#: How far a half-space reaches, in units of the frame.
_REACH = 4.0

#: Axes differ by less, as a share of their length, if only rounding made them differ.
_ROUND = 1e-12

#: Share of the deviation that leaves keep near places where facets are too coarse, and how far off
#: such a place their surfaces may be, in deviations.
_FINER = 1.0 / 16.0
_BESIDE = 8.0


@dataclass(frozen=True, eq=False)
class Frame:
    """Local coordinates of order one, so that offsets and scales cost no digits."""

    centre: np.ndarray
    scale: float

    def local(self, body: Facets) -> Facets:
        """A body in local coordinates."""
        return body.transformed(np.eye(3) / self.scale, -self.centre / self.scale)


def frame_of(leaves: Sequence[Leaf]) -> Frame:
    """A frame around all bounded leaves and all places where half-spaces may end a domain."""
    for leaf in leaves:
        if not (np.isfinite(leaf.box).all() or isinstance(leaf.primitive, HalfSpace)):
            raise UnboundedDomainError(f"{leaf.label} reaches to infinity")
    corners = [np.stack(leaf.box) for leaf in leaves if np.isfinite(leaf.box).all()]
    planes = [leaf.half_space() for leaf in leaves if isinstance(leaf.primitive, HalfSpace)]
    corners += [np.array([point]) for point, _ in planes]
    if len(planes) <= _MOST_PLANES:
        corners += _meeting_points(planes)
    cloud = np.concatenate(corners)
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    scale = 0.5 * float(np.sqrt(((high - low) ** 2).sum()))
    return Frame(0.5 * (low + high), scale or 1.0)


def _meeting_points(planes: Sequence[tuple[np.ndarray, np.ndarray]]) -> list[np.ndarray]:
    out = []
    for chosen in combinations(planes, 3):
        normals = np.array([n / np.sqrt((n**2).sum()) for _, n in chosen])
        if abs(np.linalg.det(normals)) > 1e-9:
            heights = [p @ n for (p, _), n in zip(chosen, normals, strict=True)]
            out.append(np.linalg.solve(normals, heights)[None])
    return out


def leaf_bodies(
    leaves: Sequence[Leaf],
    frame: Frame,
    deviation: float | None,
    snap: float,
    finer: Sequence[np.ndarray] = (),
) -> list[Facets]:
    """Facets of all leaves in local coordinates.

    Facets of two leaves on one curved surface would cross one another all over it if each leaf
    were cut in its own way, so such leaves are cut with one deviation, at the same angles.

    Parameters
    ----------
    leaves : sequence of Leaf
    frame : Frame
    deviation : float, optional
        In user coordinates; by default a share of each leaf's extent.
    snap : float
        In local coordinates.
    finer : sequence of (k, 3) float64
        Places in user coordinates near which leaves get a smaller deviation, for each array.
    """
    allowed = [_allowed(leaf, deviation) for leaf in leaves]
    known: dict[bytes, Facets] = {}
    bodies = [frame.local(_facets(*row, frame, known)) for row in zip(leaves, allowed, strict=True)]
    for places in finer:
        for k in _beside(bodies, (places - frame.centre) / frame.scale, allowed, frame):
            allowed[k] *= _FINER
            bodies[k] = frame.local(_facets(leaves[k], allowed[k], frame, known))
    surfaces = Surfaces.concatenate([body.surfaces for body in bodies])
    leaf_of = np.repeat(np.arange(len(bodies)), [len(body.surfaces) for body in bodies])
    classes = coincidence(surfaces, snap)
    shared = classes.shared(leaf_of)
    bent = np.flatnonzero(shared & (surfaces.kind != PLANE))
    if len(bent):
        _, group = components(len(bodies), leaf_of[bent], leaf_of[classes.of[bent]])
        for number in np.unique(group[leaf_of[bent]]).tolist():
            own = np.flatnonzero(group == number).tolist()
            finest = min(allowed[k] for k in own)
            around = max(bodies[k].around for k in own)
            for k in own:
                bodies[k] = frame.local(
                    _facets(leaves[k], finest, frame, known, around, upright=True)
                )
    return _together(bodies, leaf_of, shared, snap)


def _together(
    bodies: list[Facets], leaf_of: np.ndarray, shared: np.ndarray, snap: float
) -> list[Facets]:
    """Bodies whose points on shared surfaces agree to the last bit where they nearly do."""
    start = np.searchsorted(leaf_of, np.arange(len(bodies) + 1))
    places, owners, numbers = [], [], []
    for k, body in enumerate(bodies):
        on = np.unique(body.triangles[shared[start[k] : start[k + 1]][body.surface]])
        places.append(body.points[on])
        owners.append(np.full(len(on), k))
        numbers.append(on)
    place, owner, number = (np.concatenate(parts) for parts in (places, owners, numbers))
    pairs = near_pairs(place, snap)
    pairs = pairs[(place[pairs[:, 0]] != place[pairs[:, 1]]).any(axis=1)]
    if not len(pairs):
        return bodies
    _, label = components(len(place), *pairs.T)
    _, first = np.unique(label, return_index=True)
    target = place[first[label]]
    out = list(bodies)
    for k in np.unique(owner[pairs]).tolist():
        own = owner == k
        points = bodies[k].points.copy()
        points[number[own]] = target[own]
        out[k] = replace(bodies[k], points=points)
    return out


def _beside(
    bodies: Sequence[Facets], places: np.ndarray, allowed: Sequence[float], frame: Frame
) -> list[int]:
    """Bodies whose curved surfaces run by some of the places (k, 3), in local coordinates."""
    out = []
    for k, body in enumerate(bodies):
        bent = np.flatnonzero(body.surfaces.kind != PLANE)
        on, at = np.repeat(bent, len(places)), np.tile(places, (len(bent), 1))
        reach = _BESIDE * allowed[k] / frame.scale
        if len(on) and (body.surfaces.distance(on, at) < reach).any():
            out.append(k)
    return out


def _allowed(leaf: Leaf, deviation: float | None) -> float:
    if isinstance(leaf.primitive, HalfSpace):
        return np.inf
    low, high = leaf.box
    return deviation or DEVIATION_SHARE * float((high - low).max())


def _facets(
    leaf: Leaf,
    deviation: float,
    frame: Frame,
    known: dict[bytes, Facets],
    around: int = 0,
    *,
    upright: bool = False,
) -> Facets:
    """Facets of a leaf in user coordinates; `upright` if cut at angles that others share."""
    primitive = leaf.primitive
    if isinstance(primitive, HalfSpace):
        return _half_space(leaf, frame)
    assert isinstance(primitive, Solid)
    body = primitive.body()
    if upright and isinstance(body, Revolution) and body.angle >= 360.0:
        body = _upright(body, leaf.matrix)
    # Facets are made before the leaf is placed, where lengths differ by the placement's stretch.
    stretch = float(np.linalg.norm(leaf.matrix, 2))
    deviation /= stretch
    if isinstance(body, Revolution) and isinstance(body.profile, Profile):
        own = _turned_alike(body, body.profile, primitive.parts, deviation, around, known)
    else:
        own = facets(body, primitive.parts, deviation, around)
    return own.transformed(leaf.matrix, leaf.offset)


def _turned_alike(
    body: Revolution,
    profile: Profile,
    part_names: tuple[str, ...],
    deviation: float,
    around: int,
    known: dict[bytes, Facets],
) -> Facets:
    """Facets of a revolution, made once for all that differ in nothing but their placement."""
    curves = profile.curves
    parts = (curves.kind, curves.data, curves.interval, profile.part)
    numbers = np.array([body.angle, deviation, around])
    key = b"|".join(a.tobytes() for a in (*parts, numbers))
    if key not in known:
        unplaced = replace(body, matrix=np.eye(3), offset=np.zeros(3))
        known[key] = facets(unplaced, part_names, deviation, around)
    return known[key].transformed(body.matrix, body.offset)


def _upright(body: Revolution, placement: np.ndarray) -> Revolution:
    """A full turn that starts where all turns about the same axis do, if its rings are circles.

    A sphere has no axis, and is turned about the z axis.
    """
    total = placement @ body.matrix
    gram = total.T @ total
    size = gram[0, 0]
    if max(abs(gram[1, 1] - size), abs(gram[0, 1])) > _ROUND * size:
        return body
    if _is_sphere(body) and np.abs(gram - size * np.eye(3)).max() <= _ROUND * size:
        matrix = np.linalg.solve(placement, np.sqrt(size) * np.eye(3))
        return replace(body, matrix=matrix)
    axis = np.cross(total[:, 0], total[:, 1])
    lead = axis[int(np.argmax(np.abs(axis) > 0.5 * np.abs(axis).max()))]
    start = frame_along(axis * np.sign(lead))[:, 0]
    cosine, sine = start @ total[:, 0] / size, start @ total[:, 1] / size
    length = float(np.hypot(cosine, sine))
    c, s = cosine / length, sine / length
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return replace(body, matrix=body.matrix @ turn)


def _is_sphere(body: Revolution) -> bool:
    profile = body.profile
    if not isinstance(profile, Profile):
        return False
    curved = profile.curves[profile.part >= 0]
    return bool((curved.kind == ARC).all() and curved.is_circular().all()) and not bool(
        curved.data[:, :2].any()
    )


def _half_space(leaf: Leaf, frame: Frame) -> Facets:
    """A box with one side on the plane, and the others, without a part, beyond everything."""
    point, normal = leaf.half_space()
    plane = Surfaces.planes(point[None], normal[None])
    axes = plane.matrix[0]
    unit = axes[:, 2]
    foot = frame.centre - ((frame.centre - point) @ unit) * unit
    cube = facets(Box((-_REACH,) * 3, (_REACH,) * 3).body(), (), 1.0)
    placed = cube.transformed(axes * frame.scale, foot - _REACH * frame.scale * unit)
    parts = tuple((0,) if side == "top" else () for side in _SIDES)
    return Facets(placed.points, placed.triangles, placed.surface, placed.surfaces, parts)

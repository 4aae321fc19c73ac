"""The order of curved edges around each vertex, and which face holds which component.

Edges leave a vertex in the order of their tangents; those with nearly the same tangent in the
order they have at a common distance from the vertex, which is their order all the way since they
meet at vertices only.
"""

from __future__ import annotations

import numpy as np

from csgmesh.boundary.arrangement import Arrangement
from csgmesh.domain.curves import cross
from csgmesh.domain.planar_map import PlanarMap
from csgmesh.errors import EvaluationError
from csgmesh.spatial import Boxes

#: Tangents closer than this (radians) are told apart by position, not by their computed angle:
#: where curves touch, a vertex within the snap distance of the contact turns them by its root.
_TIE = 1e-2

#: Heights closer than this may be rounded out of order.
_SAME_HEIGHT = 1e-5


def half_edge_tails(arrangement: Arrangement) -> np.ndarray:
    """Vertex that each half-edge leaves, (2m,)."""
    return np.column_stack([arrangement.tail, arrangement.head]).ravel()


def counterclockwise(arrangement: Arrangement, snap: float) -> np.ndarray:
    """All half-edges, grouped by the vertex they leave, counterclockwise within a group."""
    tail = half_edge_tails(arrangement)
    everyone = np.argsort(tail, kind="stable")
    # Two half-edges are in order whichever comes first; only busier vertices need directions.
    busy = np.bincount(tail, minlength=1)[tail[everyone]] > 2
    order = everyone[busy]
    if len(order) == 0:
        return everyone
    direction = _directions(arrangement, snap)[order]
    angle = np.arctan2(direction[:, 1], direction[:, 0])
    vertex = tail[order]
    by_angle = np.lexsort((angle, vertex))
    order, vertex, a = order[by_angle], vertex[by_angle], angle[by_angle]
    # Cut the circle of directions at its widest gap, so that no tie straddles the cut.
    first = np.r_[True, vertex[1:] != vertex[:-1]]
    start = np.flatnonzero(first)
    group = np.cumsum(first) - 1
    previous = np.roll(a, 1)
    previous[start] = a[np.r_[start[1:] - 1, len(a) - 1]] - 2 * np.pi
    gap = a - previous
    widest = np.lexsort((-gap, group))[start]
    turned = (a - a[widest][group]) % (2 * np.pi)
    turned[widest] = 0.0
    resort = np.lexsort((turned, group))
    everyone[busy] = _settle_ties(arrangement, order[resort], turned[resort], group[resort], snap)
    return everyone


def _settle_ties(
    arrangement: Arrangement, order: np.ndarray, angle: np.ndarray, group: np.ndarray, snap: float
) -> np.ndarray:
    """Sort runs of nearly equal tangents by odd-even transposition, all vertices at once."""
    tie = (group[1:] == group[:-1]) & (angle[1:] - angle[:-1] < _TIE)
    at = np.flatnonzero(tie)
    run = np.cumsum(~np.r_[False, tie])[at]
    rounds = int(np.bincount(run).max(initial=0)) + 1 if len(at) else 0
    for k in range(2 * rounds):
        now = at[at % 2 == k % 2]
        wrong = now[_is_right_of(arrangement, order[now + 1], order[now], snap)]
        order[wrong], order[wrong + 1] = order[wrong + 1], order[wrong].copy()
    return order


def _is_right_of(arrangement: Arrangement, a: np.ndarray, b: np.ndarray, snap: float) -> np.ndarray:
    """Whether half-edge a leaves clockwise of half-edge b, which has nearly its direction."""
    tail = half_edge_tails(arrangement)
    origin = arrangement.vertices[tail[a]]
    reach = np.minimum(_chord(arrangement, a), _chord(arrangement, b))
    turn = np.zeros(len(a))
    for share in (0.5, 1.0):
        p = _at_distance(arrangement, a, share * reach) - origin
        q = _at_distance(arrangement, b, share * reach) - origin
        here = cross(q, p)
        doubtful = np.abs(turn) <= snap * share * reach
        turn = np.where(doubtful, here, turn)
    return turn < 0


def _chord(arrangement: Arrangement, h: np.ndarray) -> np.ndarray:
    e = h >> 1
    d = arrangement.vertices[arrangement.head[e]] - arrangement.vertices[arrangement.tail[e]]
    return np.hypot(*d.T)


def _at_distance(arrangement: Arrangement, h: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Points of half-edges at a distance from their tails; monotone pieces have just one."""
    local = arrangement.pieces.local
    e = h >> 1
    back = (h & 1).astype(bool)
    start = np.where(back, arrangement.t_head[e], arrangement.t_tail[e])
    end = np.where(back, arrangement.t_tail[e], arrangement.t_head[e])
    origin = local.points(arrangement.source[e], start)
    low, high = np.zeros(len(h)), np.ones(len(h))
    for _ in range(52):
        middle = 0.5 * (low + high)
        p = local.points(arrangement.source[e], start + middle * (end - start))
        near = np.hypot(*(p - origin).T) < reach
        low, high = np.where(near, middle, low), np.where(near, high, middle)
    return local.points(arrangement.source[e], start + high * (end - start))


def _directions(arrangement: Arrangement, snap: float) -> np.ndarray:
    """Direction in which each half-edge leaves, (2m, 2)."""
    local = arrangement.pieces.local
    forth = local.derivatives(arrangement.source, arrangement.t_tail)
    back = -local.derivatives(arrangement.source, arrangement.t_head)
    out = np.stack([forth, back], axis=1).reshape(-1, 2)
    chord = arrangement.vertices[arrangement.head] - arrangement.vertices[arrangement.tail]
    chords = np.stack([chord, -chord], axis=1).reshape(-1, 2)
    speed, length = np.hypot(*out.T), np.hypot(*chords.T)
    # A tangent says nothing where it vanishes (coinciding control points), nor on an edge so short
    # that merging its ends turned it.
    useless = (speed <= 1e-9 * length) | (length <= 1e3 * snap)
    out[useless] = chords[useless]
    vanishing = np.flatnonzero((speed <= 1e-9 * length) & (length > 1e3 * snap))
    if len(vanishing):
        near = _at_distance(arrangement, vanishing, 1e-3 * length[vanishing])
        tail = half_edge_tails(arrangement)[vanishing]
        out[vanishing] = near - arrangement.vertices[tail]
    return out


def planar_map(arrangement: Arrangement, snap: float) -> tuple[PlanarMap, np.ndarray]:
    """The map of an arrangement, and the face on the left of each half-edge."""
    found = PlanarMap.from_rotation(
        half_edge_tails(arrangement), counterclockwise(arrangement, snap)
    )
    if not found.is_planar():
        raise EvaluationError(
            "curves nearly coincide over a stretch that the snap distance neither joins nor keeps "
            "apart; give a larger snap"
        )
    forth = arrangement.pieces.local.area_terms(
        arrangement.source, arrangement.t_tail, arrangement.t_head
    )
    terms = np.column_stack([forth, -forth]).ravel()
    outer = found.outer_cycles(terms)
    return found, found.faces(outer, _inside_of(arrangement, found))


def _inside_of(arrangement: Arrangement, found: PlanarMap) -> np.ndarray:
    """A half-edge directly below the lowest vertex of each component, with the same face; or -1."""
    n = found.n_components
    inside = np.full(n, -1)
    if n < 2:
        return inside
    p = _lowest_points(arrangement, found)
    a, b = arrangement.vertices[arrangement.tail], arrangement.vertices[arrangement.head]
    lo, hi = np.minimum(a, b), np.maximum(a, b)
    boxes = Boxes(lo, hi)
    floor = lo[:, 1].min()
    reach = 4 * np.sqrt(np.prod(hi.max(0) - lo.min(0)) / len(a)) + 1e-300
    waiting = np.arange(n)
    while len(waiting):
        bottom = np.maximum(p[:, 1] - reach, floor)
        corner = np.column_stack([p[:, 0], bottom])[waiting]
        row, edge = boxes.overlapping(corner, p[waiting]).T
        component, height, half_edge = _highest_below(
            arrangement, found, waiting[row], edge, p, lo, hi
        )
        # A box may be met whose edge passes below the window: only what lies in it is settled.
        over = bottom <= floor
        settled = (height >= bottom[component]) | over[component]
        inside[component[settled]] = half_edge[settled]
        over[component[settled]] = True
        waiting = waiting[~over[waiting]]
        reach *= 2
    return inside


def _lowest_points(arrangement: Arrangement, found: PlanarMap) -> np.ndarray:
    v = arrangement.vertices[found.tail]
    order = np.lexsort((v[:, 0], v[:, 1], found.component))
    first = np.searchsorted(found.component[order], np.arange(found.n_components))
    return v[order[first]]


def _highest_below(
    arrangement: Arrangement,
    found: PlanarMap,
    component: np.ndarray,
    edge: np.ndarray,
    p: np.ndarray,
    lo: np.ndarray,
    hi: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of the given (component, edge) pairs the highest edge below each component's point.

    Returns
    -------
    component : (k,) int64
    height : (k,) float64
    half_edge : (k,) int64
        From left to right, so that the point's face is on its left.
    """
    x, y = p[component].T
    other = found.component[2 * edge] != component
    # Half open: seen from just right of x, a vertex there belongs to the edges on its right.
    stabbed = other & (lo[edge, 0] <= x) & (x < hi[edge, 0])
    component, edge, x, y = component[stabbed], edge[stabbed], x[stabbed], y[stabbed]
    height = np.where(x == lo[edge, 0], _left_end(arrangement, edge), _height(arrangement, edge, x))
    below = height <= y
    component, edge, height = component[below], edge[below], height[below]
    order = np.lexsort((-height, component))
    component, edge, height = component[order], edge[order], height[order]
    new = component[1:] != component[:-1]
    first = np.flatnonzero(np.r_[True, new][: len(component)])
    best = _settle_heights(arrangement, component, edge, height, first, lo, hi)
    component, height, edge = component[first], height[first], edge[best]
    tail, head = arrangement.tail[edge], arrangement.head[edge]
    leftward = arrangement.vertices[tail, 0] > arrangement.vertices[head, 0]
    return component, height, 2 * edge + leftward


def _settle_heights(
    arrangement: Arrangement,
    component: np.ndarray,
    edge: np.ndarray,
    height: np.ndarray,
    first: np.ndarray,
    lo: np.ndarray,
    hi: np.ndarray,
) -> np.ndarray:
    """The row of the really highest edge of each component, where rounding left several.

    Edges that meet at vertices only keep their order all over the stretch of x they share.
    """
    best = first.copy()
    running = np.arange(len(first))
    step = 1
    while len(running):
        row = first[running] + step
        inside = row < len(component)
        running, row = running[inside], row[inside]
        close = (component[row] == component[first[running]]) & (
            height[first[running]] - height[row] <= _SAME_HEIGHT
        )
        running, row = running[close], row[close]
        a, b = edge[best[running]], edge[row]
        x = 0.5 * (np.maximum(lo[a, 0], lo[b, 0]) + np.minimum(hi[a, 0], hi[b, 0]))
        higher = _height(arrangement, b, x) > _height(arrangement, a, x)
        best[running[higher]] = row[higher]
        step += 1
    return best


def _left_end(arrangement: Arrangement, edge: np.ndarray) -> np.ndarray:
    ends = arrangement.vertices[np.stack([arrangement.tail[edge], arrangement.head[edge]])]
    return np.where(ends[0, :, 0] < ends[1, :, 0], ends[0, :, 1], ends[1, :, 1])


def _height(arrangement: Arrangement, edge: np.ndarray, x: np.ndarray) -> np.ndarray:
    """y of monotone edges at x."""
    local, source = arrangement.pieces.local, arrangement.source[edge]
    t0, t1 = arrangement.t_tail[edge], arrangement.t_head[edge]
    ends = arrangement.vertices[np.stack([arrangement.tail[edge], arrangement.head[edge]])]
    rising = ends[0, :, 0] < ends[1, :, 0]
    low, high = np.zeros(len(edge)), np.ones(len(edge))
    for _ in range(52):
        middle = 0.5 * (low + high)
        before = (local.points(source, t0 + middle * (t1 - t0))[:, 0] <= x) == rising
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return local.points(source, t0 + low * (t1 - t0))[:, 1]

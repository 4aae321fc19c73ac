"""Random trees for the property tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import csgmesh as cm

coordinates = st.integers(-40, 40).map(lambda k: k / 8)
points = st.tuples(coordinates, coordinates)
sizes = st.integers(1, 24).map(lambda k: k / 8)
angles = st.integers(-360, 360).map(float)
names = st.none() | st.sampled_from(["a", "b", "plate", "hole.inner"])


@st.composite
def boxes(draw: st.DrawFn) -> cm.Shape:
    x, y = draw(points)
    return cm.Box((x, y), (x + draw(sizes), y + draw(sizes)), name=draw(names))


leaves = st.one_of(
    boxes(),
    st.builds(cm.Disk, points, sizes, name=names),
    st.builds(cm.Ellipse, points, st.tuples(sizes, sizes), angles, name=names),
    st.builds(cm.RegularPolygon, points, sizes, st.integers(3, 9), name=names),
    st.builds(
        cm.HalfSpace,
        points,
        st.tuples(st.integers(1, 5), st.integers(-5, 5)),
        name=names,
    ),
    st.builds(
        lambda p, s, name: cm.Polygon(np.add([(0, 0), (3, 0), (1, 1), (0, 3)], p) * s, name=name),
        points,
        sizes,
        names,
    ),
    st.builds(
        lambda p, s, fill: cm.Outline(
            [
                [p, ("quadratic", (p[0] + s, p[1] - s), (p[0] + 2 * s, p[1])), (p[0], p[1] + s)],
                [p, ("arc", (p[0] + s, p[1] + s), (p[0], p[1] + 2 * s))],
            ],
            fill,
        ),
        points,
        sizes,
        st.sampled_from(["nonzero", "evenodd"]),
    ),
)


def _grown(inner: st.SearchStrategy) -> st.SearchStrategy:
    pairs = st.tuples(inner, inner)
    return st.one_of(
        pairs.map(lambda p: p[0] | p[1]),
        pairs.map(lambda p: p[0] & p[1]),
        pairs.map(lambda p: p[0] - p[1]),
        pairs.map(lambda p: p[0] ^ p[1]),
        inner.map(lambda s: ~s),
        st.tuples(inner, points).map(lambda p: p[0].translate(p[1])),
        st.tuples(inner, angles, points).map(lambda p: p[0].rotate(p[1], center=p[2])),
        st.tuples(inner, sizes, sizes).map(lambda p: p[0].scale((p[1], -p[2]))),
        st.tuples(inner, points).map(lambda p: p[0].mirror(p[1], (1, 2))),
        st.tuples(inner, st.sampled_from(["top", "bracket"])).map(lambda p: p[0].named(p[1])),
    )


trees = st.recursive(leaves, _grown, max_leaves=12)

#: Irregular points: none lies on a boundary made of multiples of an eighth.
SAMPLE = np.random.default_rng(7).uniform(-8, 8, (400, 2))

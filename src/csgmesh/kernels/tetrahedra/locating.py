"""Which tetrahedra contain points, exactly."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, pointer
from .net import orient_point


@njit(**ENTRY)
def find_containing(points, tets, boxes, candidates, firsts, counts, queries, founds):
    """Lower founds[i] to the lowest tetrahedron among its candidates that contains query i.

    Query i looks at counts[i] of the `candidates` from firsts[i] on. `boxes` has the least and the
    greatest coordinates of each tetrahedron; a closed tetrahedron contains its boundary.
    """
    p = pointer(points)
    tet = pointer(tets)
    box = pointer(boxes)
    candidate = pointer(candidates)
    first = pointer(firsts)
    count = pointer(counts)
    query = pointer(queries)
    found = pointer(founds)
    for i in range(founds.shape[0]):
        x = query[3 * i]
        y = query[3 * i + 1]
        z = query[3 * i + 2]
        for k in range(first[i], first[i] + count[i]):
            t = candidate[k]
            j = 6 * t
            if t >= found[i] or x < box[j] or y < box[j + 1] or z < box[j + 2]:
                continue
            if x > box[j + 3] or y > box[j + 4] or z > box[j + 5]:
                continue
            inside = True
            # With one corner in turn replaced by the query, orientation stays positive; the query
            # stands last here, so that the other corners are turned round.
            for face in range(4):
                a = tet[4 * t + (face + 1) % 4]
                b = tet[4 * t + ((face + 2) if face % 2 == 0 else (face + 3)) % 4]
                c = tet[4 * t + ((face + 3) if face % 2 == 0 else (face + 2)) % 4]
                if orient_point(p, b, a, c, x, y, z) < 0.0:
                    inside = False
                    break
            if inside:
                found[i] = t

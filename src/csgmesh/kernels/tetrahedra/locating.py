"""Which tetrahedra contain points, exactly."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, pointer
from .predicates import orient3d


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
            # With one corner in turn replaced by the query, orientation stays positive.
            for face in range(4):
                a = 3 * tet[4 * t + (face + 1) % 4]
                b = 3 * tet[4 * t + ((face + 2) if face % 2 == 0 else (face + 3)) % 4]
                c = 3 * tet[4 * t + ((face + 3) if face % 2 == 0 else (face + 2)) % 4]
                o = orient3d(
                    x,
                    y,
                    z,
                    p[a],
                    p[a + 1],
                    p[a + 2],
                    p[b],
                    p[b + 1],
                    p[b + 2],
                    p[c],
                    p[c + 1],
                    p[c + 2],
                )
                if o < 0.0:
                    inside = False
                    break
            if inside:
                found[i] = t

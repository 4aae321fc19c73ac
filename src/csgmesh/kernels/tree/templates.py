"""The inside of a tree as cells: vertices numbered without searching, leaves cut by templates.

Each vertex belongs to the leaf above and to the right of it, of which it is the lower left corner,
or the middle of the left or of the bottom side where that hangs between two smaller leaves. With
the centre, a fan's hub, that makes four slots a leaf; a vertex's code is four times its leaf's
number and the slot.
"""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .morton import DEPTH, gathered, holder, is_inside, key_of

CORNER, LEFT, BOTTOM, HUB = 0, 1, 2, 3
#: Kinds of leaves: outside, near the boundary, inside.
BAND, CORE = 1, 2
#: Bits of a vertex's status.
OF_BAND, OF_CORE = 1, 2


@njit(**HELPER)
def code_at(keys, n, x, y, near):
    """Code of the vertex at a place of a balanced tree, -1 outside the root."""
    if not is_inside(x, y):
        return -1
    j = holder(keys, n, key_of(x, y), near)
    u = gathered(keys[j])
    v = gathered(keys[j] >> 1)
    if u == x:
        return 4 * j + (0 if v == y else 1)
    return 4 * j + 2


@njit(**ENTRY)
def mark_vertices(key, level, kind, begin, end, corner, status):
    """Find the codes of the four corners of each leaf that counts, and mark them."""
    keys = pointer(key)
    levels = pointer(level)
    kinds = pointer(kind)
    out = pointer(corner)
    used = pointer(status)
    n = key.shape[0]
    for i in range(begin, end):
        if kinds[i] == 0:
            continue
        size = 1 << (DEPTH - levels[i])
        x = gathered(keys[i])
        y = gathered(keys[i] >> 1)
        out[4 * i] = 4 * i
        out[4 * i + 1] = code_at(keys, n, x + size, y, i)
        out[4 * i + 2] = code_at(keys, n, x + size, y + size, i)
        out[4 * i + 3] = code_at(keys, n, x, y + size, i)
        for c in range(4):
            code = out[4 * i + c]
            if code >= 0:
                used[code] = used[code] | kinds[i]


@njit(**HELPER)
def drop_slot(used, code, x, y, ends, f, reach):
    """Drop a vertex of the band alone that is nearer to piece f than `reach`."""
    if used[code] == OF_BAND:
        dx = ends[4 * f + 2] - ends[4 * f]
        dy = ends[4 * f + 3] - ends[4 * f + 1]
        px = x - ends[4 * f]
        py = y - ends[4 * f + 1]
        square = dx * dx + dy * dy
        s = 0.0 if square == 0.0 else min(max((px * dx + py * dy) / square, 0.0), 1.0)
        px -= s * dx
        py -= s * dy
        if px * px + py * py < reach * reach:
            used[code] = 0


@njit(**ENTRY)
def drop_near(key, level, box, ends, pieces, leaves, share, status):
    """Drop the band's vertices too near to pieces: pairs of (piece, leaf) that are near."""
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    end = pointer(ends)
    piece = pointer(pieces)
    leaf = pointer(leaves)
    used = pointer(status)
    for p in range(pieces.shape[0]):
        i = leaf[p]
        size = 1 << (DEPTH - levels[i])
        w = size * at[2]
        h = size * at[3]
        x = at[0] + gathered(keys[i]) * at[2]
        y = at[1] + gathered(keys[i] >> 1) * at[3]
        reach = share * max(w, h)
        drop_slot(used, 4 * i, x, y, end, piece[p], reach)
        drop_slot(used, 4 * i + 1, x, y + 0.5 * h, end, piece[p], reach)
        drop_slot(used, 4 * i + 2, x + 0.5 * w, y, end, piece[p], reach)


@njit(**HELPER)
def hanging(keys, levels, n, used, i, mids):
    """Codes of the hanging vertices of leaf i (bottom, right, top, left; -1), and their number."""
    size = 1 << (DEPTH - levels[i])
    half = size >> 1
    x = gathered(keys[i])
    y = gathered(keys[i] >> 1)
    for k in range(4):
        mids[k] = -1
    found = 0
    if used[4 * i + 2] != 0:
        mids[0] = 4 * i + 2
        found += 1
    if used[4 * i + 1] != 0:
        mids[3] = 4 * i + 1
        found += 1
    if is_inside(x + size, y):
        j = holder(keys, n, key_of(x + size, y), i)
        if levels[j] > levels[i]:
            mids[1] = 4 * holder(keys, n, key_of(x + size, y + half), j)
            found += 1
    if is_inside(x, y + size):
        j = holder(keys, n, key_of(x, y + size), i)
        if levels[j] > levels[i]:
            mids[2] = 4 * holder(keys, n, key_of(x + half, y + size), j)
            found += 1
    return found


@njit(**ENTRY)
def count_cells(key, level, kind, corner, status, begin, end, hubs, fan, total, room):
    """Count leaves cut by each template; marks the hubs of fans if there are any.

    fan: 1 where a core leaf has hanging vertices. total: plain leaves, fans, triangles of fans.
    room: 12 numbers to work with.
    """
    keys = pointer(key)
    levels = pointer(level)
    kinds = pointer(kind)
    codes = pointer(corner)
    used = pointer(status)
    fans = pointer(fan)
    out = pointer(total)
    mids = pointer(room)
    n = key.shape[0]
    for i in range(begin, end):
        if kinds[i] != CORE:
            continue
        # The leaves on the right and above are those that own the corners there.
        right = codes[4 * i + 1] >> 2
        top = codes[4 * i + 3] >> 2
        if (
            levels[right] <= levels[i]
            and levels[top] <= levels[i]
            and used[4 * i + 1] | used[4 * i + 2] == 0
        ):
            out[0] += 1
            continue
        fans[i] = 1
        out[1] += 1
        out[2] += 4 + hanging(keys, levels, n, used, i, mids)
        if hubs != 0:
            used[4 * i + 3] = OF_CORE


@njit(**ENTRY)
def number_vertices(key, level, box, status, begin, end, number, points, counts):
    """Number the used vertices from counts[0] on, and give their coordinates."""
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    used = pointer(status)
    to = pointer(number)
    xy = pointer(points)
    n = counts[0]
    for i in range(begin, end):
        size = 1 << (DEPTH - levels[i])
        for c in range(4):
            code = 4 * i + c
            to[code] = -1
            if used[code] != 0:
                to[code] = n
                x = gathered(keys[i])
                y = gathered(keys[i] >> 1)
                if c >= 2:
                    x += size >> 1
                if c == 1 or c == 3:
                    y += size >> 1
                xy[2 * n] = at[0] + x * at[2]
                xy[2 * n + 1] = at[1] + y * at[3]
                n += 1
    counts[0] = n


@njit(**HELPER)
def write_ring(keys, levels, n, used, corner, ids, i, mids, ring, o):
    """Vertices around leaf i, hanging ones too, to ring[o ...]; how many."""
    hanging(keys, levels, n, used, i, mids)
    m = 0
    for c in range(4):
        ring[o + m] = ids[corner[4 * i + c]]
        m += 1
        if mids[c] >= 0:
            ring[o + m] = ids[mids[c]]
            m += 1
    return m


@njit(**ENTRY)
def write_triangles(
    key,
    level,
    kind,
    corner,
    status,
    fan,
    number,
    region,
    begin,
    end,
    cells,
    regions,
    counts,
    room,
    plain,
):
    """Cut core leaves into triangles: two, or a fan around the hub; counts[0] of them so far.

    plain: 0 to leave out leaves without hanging vertices.
    """
    keys = pointer(key)
    levels = pointer(level)
    kinds = pointer(kind)
    codes = pointer(corner)
    used = pointer(status)
    fans = pointer(fan)
    ids = pointer(number)
    inside = pointer(region)
    out = pointer(cells)
    to = pointer(regions)
    ring = pointer(room[4:])
    mids = pointer(room)
    n = key.shape[0]
    t = counts[0]
    for i in range(begin, end):
        if kinds[i] != CORE or plain + fans[i] == 0:
            continue
        if fans[i] == 0:
            a = ids[4 * i]
            c = ids[codes[4 * i + 2]]
            out[3 * t] = a
            out[3 * t + 1] = ids[codes[4 * i + 1]]
            out[3 * t + 2] = c
            out[3 * t + 3] = a
            out[3 * t + 4] = c
            out[3 * t + 5] = ids[codes[4 * i + 3]]
            to[t] = inside[i]
            to[t + 1] = inside[i]
            t += 2
        else:
            m = write_ring(keys, levels, n, used, codes, ids, i, mids, ring, 0)
            for k in range(m):
                out[3 * t] = ids[4 * i + 3]
                out[3 * t + 1] = ring[k]
                out[3 * t + 2] = ring[k + 1 if k + 1 < m else 0]
                to[t] = inside[i]
                t += 1
    counts[0] = t


@njit(**ENTRY)
def write_quads(kind, corner, fan, number, region, begin, end, cells, regions, counts):
    """Core leaves without hanging vertices as quads; counts[0] of them so far."""
    kinds = pointer(kind)
    codes = pointer(corner)
    fans = pointer(fan)
    ids = pointer(number)
    inside = pointer(region)
    out = pointer(cells)
    to = pointer(regions)
    q = counts[0]
    for i in range(begin, end):
        if kinds[i] == CORE and fans[i] == 0:
            for c in range(4):
                out[4 * q + c] = ids[codes[4 * i + c]]
            to[q] = inside[i]
            q += 1
    counts[0] = q


@njit(**HELPER)
def write_edge(keys, n, kinds, near, ax, ay, bx, by, k, edges, leaf, e):
    """The edge between two places of a side, if leaf k beyond it belongs to the core."""
    if kinds[k] != CORE:
        return e
    edges[2 * e] = code_at(keys, n, ax, ay, near)
    edges[2 * e + 1] = code_at(keys, n, bx, by, near)
    leaf[e] = k
    return e + 1


@njit(**ENTRY)
def core_edges(key, level, kind, band, edges, leaf):
    """Edges between the leaves of the band and the core, the core on their left; how many.

    edges: codes of the ends. leaf: the leaf of the core.
    """
    keys = pointer(key)
    levels = pointer(level)
    kinds = pointer(kind)
    bands = pointer(band)
    out = pointer(edges)
    to = pointer(leaf)
    n = key.shape[0]
    e = 0
    for b in range(band.shape[0]):
        i = bands[b]
        size = 1 << (DEPTH - levels[i])
        x = gathered(keys[i])
        y = gathered(keys[i] >> 1)
        for side in range(4):
            # Bottom, right, top, left; (u, v) the first place beyond it, (p, q) to (r, s) along it.
            u = x + (size if side == 1 else (-1 if side == 3 else 0))
            v = y + (size if side == 2 else (-1 if side == 0 else 0))
            if not is_inside(u, v):
                continue
            p = x + (size if side <= 1 else 0)
            q = y + (size if side == 1 or side == 2 else 0)
            r = x + (size if side == 1 or side == 2 else 0)
            s = y + (size if side >= 2 else 0)
            k = holder(keys, n, key_of(u, v), i)
            if levels[k] <= levels[i]:
                e = write_edge(keys, n, kinds, i, p, q, r, s, k, out, to, e)
                continue
            half = size >> 1
            far = holder(keys, n, key_of(u + half * (1 - (side & 1)), v + half * (side & 1)), k)
            mx = (p + r) >> 1
            my = (q + s) >> 1
            if side == 0 or side == 1:
                e = write_edge(keys, n, kinds, i, p, q, mx, my, far, out, to, e)
                e = write_edge(keys, n, kinds, i, mx, my, r, s, k, out, to, e)
            else:
                e = write_edge(keys, n, kinds, i, p, q, mx, my, k, out, to, e)
                e = write_edge(keys, n, kinds, i, mx, my, r, s, far, out, to, e)
    return e

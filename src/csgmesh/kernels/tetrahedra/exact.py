"""What is left of orientation and in-sphere tests when a filter cannot tell; exact signs.

Stages, each entered only when the one before cannot tell: planes, boxes and rectangles parallel to
the axes; small multiples of a power of two or of the smallest difference, for which plain
arithmetic rounds nothing; about 32 digits with a bound of their error; larger multiples, whose
determinant is zero or above it; circles through four points with few bits; determinants of the
coordinates themselves as expansions, after J. R. Shewchuk, "Adaptive precision floating-point
arithmetic and fast robust geometric predicates", Discrete & Computational Geometry 18 (1997).

Both functions are compiled once and called by name from the machine code of every other kernel.
"""

from __future__ import annotations

from math import frexp, ldexp

from numba import njit

from ..exact import are_rectangle
from ..expansions import add_expansions, cross, diff_tail, scale_expansion, two_product
from ..pointers import HELPER, scratch
from .doubled import add, minor, multiply, sum_of_products
from .linking import name_function

#: Error of a determinant with 32 digits, as a share of its permanent: no more than 16 operations
#: follow one another, each of which errs by less than 2^-102.
DOUBLED = 2.0**-97
#: 1.5 * 2^52: adding it to a number and taking it away rounds the number to an integer.
ROUNDING = 6755399441055744.0
#: Determinants of degree five of multiples of one 2^9th of the largest fit into 52 bits: plain
#: arithmetic rounds nothing.
FEW = 2.0**9
#: Those of one 2^17th are multiples of 2^-85 of its fifth power, of which their permanent is at
#: most 72: if they are smaller than the error of 32 digits, they are zero.
MANY = 2.0**17


@njit(**HELPER)
def are_multiples(x, n, largest, parts):
    """Whether n doubles are multiples of one in `parts` of a power of two not below the largest."""
    share, exponent = frexp(largest)
    unit = max(ldexp(1.0, exponent if share > 0.5 else exponent - 1), 1e-280)
    magic = ROUNDING * (unit / parts)
    rest = 0.0
    for i in range(n):
        rest += abs(((x[i] + magic) - magic) - x[i])
    return rest == 0.0


@njit(**HELPER)
def make_integers(d, n, largest, q):
    """q: n doubles as multiples of a half or a third of the smallest one, if all are few."""
    smallest = largest
    for i in range(n):
        if d[i] != 0.0:
            smallest = min(smallest, abs(d[i]))
    if largest > 0.5 * FEW * smallest:
        return False
    for parts in range(2, 4):
        unit = smallest / parts
        rest = 0.0
        for i in range(n):
            q[i] = ((d[i] / unit) + ROUNDING) - ROUNDING
            p, error = two_product(q[i], unit)
            rest += abs(p - d[i]) + abs(error)
            if abs(q[i]) > FEW:
                rest = 1.0
        if rest == 0.0:
            return True
    return False


@njit(**HELPER)
def take_differences(x, y, z, n, d, t):
    """d, t: coordinates of points 0 … n - 1 less those of point n, and the tails; the largest.

    The largest is negative if a difference has a tail.
    """
    largest = 0.0
    has_tails = False
    for i in range(n):
        d[3 * i] = x[i] - x[n]
        d[3 * i + 1] = y[i] - y[n]
        d[3 * i + 2] = z[i] - z[n]
        t[3 * i] = diff_tail(x[i], x[n], d[3 * i])
        t[3 * i + 1] = diff_tail(y[i], y[n], d[3 * i + 1])
        t[3 * i + 2] = diff_tail(z[i], z[n], d[3 * i + 2])
        for k in range(3 * i, 3 * i + 3):
            largest = max(largest, abs(d[k]))
            if t[k] != 0.0:
                has_tails = True
    return -1.0 if has_tails else largest


@njit(**HELPER)
def determinant(d, i, j, k):
    """Of the differences of three points, in plain arithmetic, and its permanent."""
    a = 3 * i
    b = 3 * j
    c = 3 * k
    p = d[b + 1] * d[c + 2]
    q = d[b + 2] * d[c + 1]
    r = d[b + 2] * d[c]
    s = d[b] * d[c + 2]
    u = d[b] * d[c + 1]
    v = d[b + 1] * d[c]
    det = d[a] * (p - q) + d[a + 1] * (r - s) + d[a + 2] * (u - v)
    size = (
        abs(d[a]) * (abs(p) + abs(q))
        + abs(d[a + 1]) * (abs(r) + abs(s))
        + abs(d[a + 2]) * (abs(u) + abs(v))
    )
    return det, size


@njit(**HELPER)
def long_determinant(d, t, i, j, k):
    """The same with about 32 digits."""
    a = 3 * i
    b = 3 * j
    c = 3 * k
    x, x_low = minor(d[b + 1], t[b + 1], d[b + 2], t[b + 2], d[c + 1], t[c + 1], d[c + 2], t[c + 2])
    y, y_low = minor(d[b + 2], t[b + 2], d[b], t[b], d[c + 2], t[c + 2], d[c], t[c])
    z, z_low = minor(d[b], t[b], d[b + 1], t[b + 1], d[c], t[c], d[c + 1], t[c + 1])
    return sum_of_products(
        d[a], t[a], x, x_low, d[a + 1], t[a + 1], y, y_low, d[a + 2], t[a + 2], z, z_low
    )


@njit(**HELPER)
def exact_volume(x, y, z, i, j, k, m, h, spare):
    """h: the determinant of the rows (x, y, z, 1) of four points, of at most 96 terms."""
    p = scratch(2)
    q = scratch(2)
    small = scratch(4)
    part = scratch(8)
    n = 0
    for left in range(4):
        # The three that stay, in order.
        a = j if left == 0 else i
        b = k if left <= 1 else j
        c = m if left <= 2 else k
        for _ in range(3):
            n_small = cross(x[a], y[a], x[b], y[b], p, q, small)
            n_part = scale_expansion(n_small, small, z[c] if left & 1 else -z[c], part)
            n_sum = add_expansions(n, h, n_part, part, spare)
            for s in range(n_sum):
                h[s] = spare[s]
            n = n_sum
            a, b, c = b, c, a
    return n


@njit(**HELPER)
def orient3d_adaptive(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """Orientation of four points with an exact sign."""
    if (ax == bx and ax == cx and ax == dx) or (ay == by and ay == cy and ay == dy):
        return 0.0
    if az == bz and az == cz and az == dz:
        return 0.0
    x = scratch(4)
    y = scratch(4)
    z = scratch(4)
    # Relative to a, which comes last.
    x[0], y[0], z[0] = bx, by, bz
    x[1], y[1], z[1] = cx, cy, cz
    x[2], y[2], z[2] = dx, dy, dz
    x[3], y[3], z[3] = ax, ay, az
    d = scratch(9)
    t = scratch(9)
    q = scratch(9)
    largest = take_differences(x, y, z, 3, d, t)
    det, size = determinant(d, 0, 1, 2)
    if largest >= 0.0 and (size == 0.0 or are_multiples(d, 9, largest, FEW)):
        return det
    if largest >= 0.0 and make_integers(d, 9, largest, q):
        det, _ = determinant(q, 0, 1, 2)
        return det
    det, _ = long_determinant(d, t, 0, 1, 2)
    if abs(det) > DOUBLED * size:
        return det
    if largest >= 0.0 and are_multiples(d, 9, largest, MANY):
        return 0.0
    h = scratch(96)
    spare = scratch(96)
    # The determinant of rows that end in 1 is positive where a stands behind b: one swap away.
    n = exact_volume(x, y, z, 0, 3, 1, 2, h, spare)
    return h[n - 1] if n > 0 else 0.0


@njit(**HELPER)
def is_rectangle(u, v, w, i, j, k):
    """Whether three points and the last are a rectangle parallel to u and v."""
    return (
        w[i] == w[4]
        and w[j] == w[4]
        and w[k] == w[4]
        and are_rectangle(u[i], v[i], u[j], v[j], u[k], v[k], u[4], v[4])
    )


@njit(**HELPER)
def are_on_box(x, y, z):
    """Whether five points are corners of one box parallel to the axes, or the last one and three
    others of a rectangle: the commonest points on a sphere.
    """
    for k in range(4):
        i = 1 if k == 0 else 0
        j = 2 if k <= 1 else 1
        m = 3 if k <= 2 else 2
        if is_rectangle(x, y, z, i, j, m) or is_rectangle(y, z, x, i, j, m):
            return True
        if is_rectangle(z, x, y, i, j, m):
            return True
    for axis in range(3):
        c = x if axis == 0 else (y if axis == 1 else z)
        low = min(min(c[0], c[1]), min(c[2], c[3]))
        high = max(max(c[0], c[1]), max(c[2], c[3]))
        for i in range(5):
            if c[i] != low and c[i] != high:
                return False
    return True


@njit(**HELPER)
def are_cocircular(d):
    """Whether the origin and three points with few bits lie on one circle, in plain arithmetic.

    If w = r u + s v, it lies on the circle of 0, u, v where |w|^2 = r |u|^2 + s |v|^2.
    """
    if determinant(d, 0, 1, 2)[0] != 0.0:
        return False
    u = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    v = d[3] * d[3] + d[4] * d[4] + d[5] * d[5]
    w = d[6] * d[6] + d[7] * d[7] + d[8] * d[8]
    for axis in range(3):
        i = 1 if axis == 0 else 0
        j = 1 if axis == 2 else 2
        uv = d[i] * d[3 + j] - d[j] * d[3 + i]
        if uv != 0.0:
            wv = d[6 + i] * d[3 + j] - d[6 + j] * d[3 + i]
            uw = d[i] * d[6 + j] - d[j] * d[6 + i]
            return w * uv == u * wv + v * uw
    return False


@njit(**HELPER)
def has_circle(x, y, z):
    """Whether four of five points are seen to be on one circle: points of a lattice, mostly."""
    u = scratch(4)
    v = scratch(4)
    w = scratch(4)
    d = scratch(9)
    t = scratch(9)
    q = scratch(9)
    for left in range(5):
        n = 0
        for i in range(5):
            if i != left:
                u[n] = x[i]
                v[n] = y[i]
                w[n] = z[i]
                n += 1
        largest = take_differences(u, v, w, 3, d, t)
        if largest < 0.0:
            continue
        if are_multiples(d, 9, largest, FEW):
            if are_cocircular(d):
                return True
        elif make_integers(d, 9, largest, q) and are_cocircular(q):
            return True
    return False


@njit(**HELPER)
def exact_insphere(x, y, z):
    """The in-sphere determinant of the coordinates themselves."""
    volume = scratch(96)
    spare = scratch(96)
    once = scratch(192)
    twice = scratch(384)
    total = scratch(5760)
    other = scratch(5760)
    n = 0
    for i in range(5):
        n_volume = exact_volume(
            x,
            y,
            z,
            1 if i == 0 else 0,
            2 if i <= 1 else 1,
            3 if i <= 2 else 2,
            4 if i <= 3 else 3,
            volume,
            spare,
        )
        for axis in range(3):
            c = x[i] if axis == 0 else (y[i] if axis == 1 else z[i])
            n_once = scale_expansion(n_volume, volume, c, once)
            n_twice = scale_expansion(n_once, once, -c if i & 1 else c, twice)
            n_sum = add_expansions(n, total, n_twice, twice, other)
            for s in range(n_sum):
                total[s] = other[s]
            n = n_sum
    return total[n - 1] if n > 0 else 0.0


@njit(**HELPER)
def sphere_determinant(d):
    """In-sphere determinant of differences in plain arithmetic, and its permanent."""
    det = 0.0
    size = 0.0
    for i in range(4):
        volume, share = determinant(d, 1 if i == 0 else 0, 2 if i <= 1 else 1, 3 if i <= 2 else 2)
        lift = d[3 * i] * d[3 * i] + d[3 * i + 1] * d[3 * i + 1] + d[3 * i + 2] * d[3 * i + 2]
        det += lift * (-volume if i & 1 else volume)
        size += lift * share
    return det, size


@njit(**HELPER)
def insphere_adaptive(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, ex, ey, ez):
    """In-sphere determinant of five points with an exact sign."""
    x = scratch(5)
    y = scratch(5)
    z = scratch(5)
    x[0], y[0], z[0] = ax, ay, az
    x[1], y[1], z[1] = bx, by, bz
    x[2], y[2], z[2] = cx, cy, cz
    x[3], y[3], z[3] = dx, dy, dz
    x[4], y[4], z[4] = ex, ey, ez
    if are_on_box(x, y, z):
        return 0.0
    d = scratch(12)
    t = scratch(12)
    q = scratch(12)
    largest = take_differences(x, y, z, 4, d, t)
    det, size = sphere_determinant(d)
    if largest >= 0.0 and (size == 0.0 or are_multiples(d, 12, largest, FEW)):
        return det
    if largest >= 0.0 and make_integers(d, 12, largest, q):
        det, _ = sphere_determinant(q)
        return det
    det = 0.0
    low = 0.0
    for i in range(4):
        volume, volume_low = long_determinant(
            d, t, 1 if i == 0 else 0, 2 if i <= 1 else 1, 3 if i <= 2 else 2
        )
        a = 3 * i
        lift, lift_low = sum_of_products(
            d[a],
            t[a],
            d[a],
            t[a],
            d[a + 1],
            t[a + 1],
            d[a + 1],
            t[a + 1],
            d[a + 2],
            t[a + 2],
            d[a + 2],
            t[a + 2],
        )
        term, term_low = multiply(lift, lift_low, volume, volume_low)
        if i & 1:
            det, low = add(det, low, -term, -term_low)
        else:
            det, low = add(det, low, term, term_low)
    if abs(det) > DOUBLED * size:
        return det
    if largest >= 0.0 and are_multiples(d, 12, largest, MANY):
        return 0.0
    if has_circle(x, y, z):
        return 0.0
    return exact_insphere(x, y, z)


ORIENT3D = "csgmesh_orient3d_adaptive"
INSPHERE = "csgmesh_insphere_adaptive"
name_function(ORIENT3D, orient3d_adaptive, 12)
name_function(INSPHERE, insphere_adaptive, 15)

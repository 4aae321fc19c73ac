"""What a good mesh is: which triangles are bad, and where their new vertex goes."""

from __future__ import annotations

from collections import namedtuple
from math import hypot, sqrt

import numpy as np
from numba import njit

from .background import background_size
from .pointers import HELPER
from .queue import COARSE, FINE, bucket

#: What refinement knows of the wanted mesh. apex_of: up to two apexes on whose segments a vertex
#: lies; radius: of an apex's protected shell; size: wanted edge length at each vertex if `graded`;
#: home: the triangle of the background `ground` in which each vertex lies, if that gives the sizes.
Aim = namedtuple("Aim", "apex_of radius size graded number todo count home ground")

# Values of `graded`: one size everywhere; at a new vertex as at its neighbours; as the background.
INHERITED = np.int64(1)
BACKGROUND = np.int64(2)

# Places in `number`.
N_COS2 = 0  # squared cosine of the smallest angle
N_OFF = 1  # distance of the off-centre from its edge, as a share of the edge
N_CIRCLE = 2  # squared circumradius allowed, as a share of the squared size
N_SEGMENT = 3  # squared length of a subsegment allowed, as a share of the squared size
N_SIZE = 4  # squared size where it is uniform, 0 without
N_SCALE = 5  # 1 / squared diagonal
N_TINY = 6  # squared length below which nothing is split
N_LEVEL = 7  # how many times as long as wanted edges may be for now

# Places in `count`.
C_POINTS = 0
C_TRIANGLES = 1
C_SUBSEGMENTS = 2
C_TODO = 3  # height of the stack of subsegments to split
C_FIRST = 4  # the next triangle to look at for the first time, in half-edges
C_LIMIT = 5  # points allowed
C_BLOCKED = 6  # splits in a row that another subsegment stood in the way of
C_GIVEN_UP = 7  # triangles left bad because nothing could be split further
C_WHERE = 8  # subsegment that could not be split
C_REGULAR = 9  # triangles from this one on need no first look

ONE = np.int64(1)
ALL_SEEN = np.int64(2**62)
MANY_BLOCKED = 1000
#: Two vertices on segments of one apex are on a common shell if their distances agree this well.
SAME_SHELL = 1e-4


@njit(**HELPER)
def wanted(aim, a, b, c):
    """Squared size at a triangle of vertices a, b, c; 0 without one."""
    if aim.graded != 0:
        h = (aim.size[a] + aim.size[b] + aim.size[c]) / 3.0
        return h * h
    return aim.number[N_SIZE]


@njit(**HELPER)
def same_shell(xy, aim, apex, u, v):
    """Whether u and v lie on a common protected shell of an apex."""
    du = hypot(xy[2 * u] - xy[2 * apex], xy[2 * u + 1] - xy[2 * apex + 1])
    dv = hypot(xy[2 * v] - xy[2 * apex], xy[2 * v + 1] - xy[2 * apex + 1])
    far = max(du, dv)
    return abs(du - dv) <= SAME_SHELL * far and far <= aim.radius[apex] * (1.0 + SAME_SHELL)


@njit(**HELPER)
def excused(xy, aim, u, v):
    """Whether u and v lie on a common shell of an apex of both: then their edge cannot grow."""
    for i in range(2):
        apex = aim.apex_of[2 * u + i]
        shared = apex >= 0 and (aim.apex_of[2 * v] == apex or aim.apex_of[2 * v + 1] == apex)
        if shared and same_shell(xy, aim, apex, u, v):
            return True
    return False


@njit(**HELPER)
def badness(xy, origin, twin, aim, t):
    """Bucket of a bad triangle, -1 of a good one; and whether it is bad by its angle."""
    if twin[t + 3] < 0:
        return -1, False
    a = origin[t]
    b = origin[t + 1]
    c = origin[t + 2]
    abx = xy[2 * b] - xy[2 * a]
    aby = xy[2 * b + 1] - xy[2 * a + 1]
    bcx = xy[2 * c] - xy[2 * b]
    bcy = xy[2 * c + 1] - xy[2 * b + 1]
    cax = xy[2 * a] - xy[2 * c]
    cay = xy[2 * a + 1] - xy[2 * c + 1]
    ab = abx * abx + aby * aby
    bc = bcx * bcx + bcy * bcy
    ca = cax * cax + cay * cay
    if ab <= bc and ab <= ca:
        dot = bcx * cax + bcy * cay
        shortest = ab
        product = bc * ca
        u = a
        v = b
    elif bc <= ca:
        dot = abx * cax + aby * cay
        shortest = bc
        product = ab * ca
        u = b
        v = c
    else:
        dot = abx * bcx + aby * bcy
        shortest = ca
        product = ab * bc
        u = c
        v = a
    if shortest <= aim.number[N_TINY]:
        return -1, False
    skinny = dot * dot > aim.number[N_COS2] * product
    if skinny and excused(xy, aim, u, v):
        skinny = False
    if not skinny:
        h2 = wanted(aim, a, b, c)
        if h2 <= 0.0:
            return -1, False
        area2 = abx * bcy - aby * bcx
        if ab * bc * ca <= 4.0 * aim.number[N_CIRCLE] * h2 * area2 * area2:
            return -1, False
    # Coarse buckets make fewer triangles where only angles count, fine ones follow sizes better.
    sized = aim.graded != 0 or aim.number[N_SIZE] > 0.0
    return bucket(shortest * aim.number[N_SCALE], FINE if sized else COARSE), skinny


@njit(**HELPER)
def apex_height(aim, u, v, mx, my, nx, ny, uu):
    """Height, as a share of edge u–v of squared length uu, of an apex as far away as wanted.

    (mx, my) is the middle of the edge, (nx, ny) a normal as long as the edge. Not lower than
    that of an equilateral triangle; 0 without a size.
    """
    if aim.graded == 0:
        h2 = aim.number[N_SIZE]
        return sqrt(max(h2 / uu - 0.25, 0.75)) if h2 > 0.0 else 0.0
    h = 0.5 * (aim.size[u] + aim.size[v]) * aim.number[N_LEVEL]
    high = sqrt(max(h * h / uu - 0.25, 0.75))
    if aim.graded == BACKGROUND:
        there, _ = background_size(aim.ground, aim.home[u], mx + high * nx, my + high * ny)
        h = 0.5 * (h + there)
        high = sqrt(max(h * h / uu - 0.25, 0.75))
    return high


@njit(**HELPER)
def steiner_place(xy, origin, aim, t, skinny):
    """Where triangle t gets its vertex: on the bisector of its shortest edge; and an end of that.

    At the distance of the off-centre if t is skinny, and not further than makes the two new edges
    as long as wanted (Rebay 1993; Engwirda, Ivers 2016); at the circumcentre where that is nearer.
    """
    a = origin[t]
    b = origin[t + 1]
    c = origin[t + 2]
    bx = xy[2 * b] - xy[2 * a]
    by = xy[2 * b + 1] - xy[2 * a + 1]
    cx = xy[2 * c] - xy[2 * a]
    cy = xy[2 * c + 1] - xy[2 * a + 1]
    bb = bx * bx + by * by
    cc = cx * cx + cy * cy
    ee = (cx - bx) * (cx - bx) + (cy - by) * (cy - by)
    scale = 0.5 / (bx * cy - cx * by)
    dx = xy[2 * a] + (cy * bb - by * cc) * scale
    dy = xy[2 * a + 1] + (bx * cc - cx * bb) * scale
    u = b
    v = c
    uu = ee
    if bb < cc and bb < ee:
        u = a
        v = b
        uu = bb
    elif cc < ee:
        u = c
        v = a
        uu = cc
    nx = xy[2 * u + 1] - xy[2 * v + 1]
    ny = xy[2 * v] - xy[2 * u]
    mx = 0.5 * (xy[2 * u] + xy[2 * v])
    my = 0.5 * (xy[2 * u + 1] + xy[2 * v + 1])
    high = apex_height(aim, u, v, mx, my, nx, ny, uu)
    if skinny:
        high = min(high, aim.number[N_OFF]) if high > 0.0 else aim.number[N_OFF]
    if high <= 0.0:
        return dx, dy, u
    fx = mx + high * nx
    fy = my + high * ny
    ox = xy[2 * u]
    oy = xy[2 * u + 1]
    near = (fx - ox) * (fx - ox) + (fy - oy) * (fy - oy)
    if near < (dx - ox) * (dx - ox) + (dy - oy) * (dy - oy):
        return fx, fy, u
    return dx, dy, u

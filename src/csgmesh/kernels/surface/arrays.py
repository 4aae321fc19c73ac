"""The arrays of a surface that is being meshed, as kernels see them."""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from ..pointers import HELPER, pointer
from .topology import View

SurfaceArrays = namedtuple(
    "SurfaceArrays",
    "xyz size cap dim owner link keep origin twin ring seg face_surface face_sign pair "
    "curve_ends code number queue later todo buffer count",
)


@njit(**HELPER)
def view_of(arrays):
    """Pointers to all arrays."""
    return View(
        pointer(arrays.xyz),
        pointer(arrays.size),
        pointer(arrays.cap),
        pointer(arrays.dim),
        pointer(arrays.owner),
        pointer(arrays.link),
        pointer(arrays.keep),
        pointer(arrays.origin),
        pointer(arrays.twin),
        pointer(arrays.ring),
        pointer(arrays.seg),
        pointer(arrays.face_surface),
        pointer(arrays.face_sign),
        pointer(arrays.pair),
        pointer(arrays.curve_ends),
        pointer(arrays.code),
        pointer(arrays.number),
        pointer(arrays.queue),
        pointer(arrays.later),
        pointer(arrays.todo),
        pointer(arrays.buffer),
        pointer(arrays.count),
    )

"""Outlines that nobody here drew: the glyphs of the fonts that matplotlib ships."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import matplotlib
from matplotlib.ft2font import FT2Font, LoadFlags

import csgmesh as cm

FONTS = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
#: Size at which glyphs are taken, without hinting.
POINTS = 64


@cache
def font(name: str) -> FT2Font:
    """A font by the name of its file."""
    found = FT2Font(str(FONTS / f"{name}.ttf"))
    found.set_size(POINTS, 72)
    return found


def outline(name: str, index: int) -> cm.Shape:
    """Glyph number `index` of a font."""
    face = font(name)
    face.load_glyph(index, flags=LoadFlags.NO_HINTING)
    return cm.Outline.from_path(*face.get_path(), name="ink")


def drawable(name: str) -> Iterator[int]:
    """Numbers of all glyphs that draw anything."""
    face = font(name)
    for index in range(face.num_glyphs):
        face.load_glyph(index, flags=LoadFlags.NO_HINTING)
        if len(face.get_path()[0]):
            yield index


def sample(name: str, n: int) -> list[int]:
    """About n drawable glyphs, evenly spread."""
    found = list(drawable(name))
    return found[:: max(len(found) // n, 1)][:n]

"""The corpora: labelled shapes, each made when its turn comes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from glyphs import drawable, outline
from seeded_trees import domain

sys.path.append(str(Path(__file__).parents[1] / "boundary"))
from degenerate import CASES

Labelled = Iterator[tuple[str, Callable[[], Any]]]

STIX = ("STIXGeneral", "STIXGeneralItalic", "STIXGeneralBolIta", "STIXSizFourSymReg")
#: Every so many of the STIX glyphs, of which there are some 4,000.
STIX_STEP = 7
N_TREES = 3000


def dejavu() -> Labelled:
    """All drawable glyphs of DejaVu Sans."""
    for index in drawable("DejaVuSans"):
        yield f"DejaVuSans {index}", partial(outline, "DejaVuSans", index)


def stix() -> Labelled:
    """A sample of cubic outlines."""
    for name in STIX:
        for index in list(drawable(name))[::STIX_STEP]:
            yield f"{name} {index}", partial(outline, name, index)


def trees() -> Labelled:
    """Random trees."""
    for seed in range(N_TREES):
        yield f"tree {seed}", partial(domain, seed)


def degenerate() -> Labelled:
    """The table of degenerate domains, also turned and scaled."""
    for label, (shape, _, _) in CASES.items():
        yield label, lambda shape=shape: shape
        yield f"{label}, turned", partial(shape.rotate, 17)
        yield f"{label}, turned and large", partial(shape.rotate(17).scale, 1e6)
        yield f"{label}, turned and small", partial(shape.rotate(17).scale, 1e-6)


#: Name: shapes, smallest angle asked for.
CORPORA: dict[str, tuple[Callable[[], Labelled], float]] = {
    "glyphs of DejaVu Sans at 20 degrees": (dejavu, 20.0),
    "every 7th glyph of four STIX fonts at 30 degrees": (stix, 30.0),
    "3,000 random trees at 20 degrees": (trees, 20.0),
    "degenerate domains at 20 degrees": (degenerate, 20.0),
}

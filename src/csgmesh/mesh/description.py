"""How meshes are compared, and what is said of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def same(a: Any, b: Any) -> bool:
    """Whether arrays, or mappings of arrays, are the same to the last bit."""
    if isinstance(a, Mapping):
        return list(a) == list(b) and all(same(a[k], b[k]) for k in a)
    if isinstance(a, np.ndarray):
        return np.array_equal(a, b)
    return bool(a == b)


def counted(n: int, noun: str) -> str:
    """A number with its noun."""
    plural = {"hexahedron": "hexahedra", "vertex": "vertices"}.get(noun, noun + "s")
    return f"{n:,} {noun if n == 1 else plural}"


def listed(names: Sequence[str], most: int = 8) -> str:
    """The first few names, and how many more there are."""
    rest = len(names) - most
    return ", ".join(names[:most]) + (f" and {rest} more" if rest > 0 else "")

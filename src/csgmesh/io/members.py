"""Who carries a name: from a number an entity to entities by name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def members(numbers: np.ndarray, names: Sequence[Sequence[str]]) -> dict[str, np.ndarray]:
    """Sorted positions by name, in order of appearance.

    Number i stands for all of ``names[i]``, -1 for none.

    Examples
    --------
    >>> members(np.array([1, 0, 1, -1]), [("wall",), ("lid", "wall")])
    {'wall': array([0, 1, 2]), 'lid': array([0, 2])}
    """
    order = np.argsort(numbers, kind="stable")
    ordered = numbers[order]
    starts = np.flatnonzero(np.concatenate([[True], ordered[1:] != ordered[:-1]])[: len(order)])
    parts: dict[str, list[np.ndarray]] = {}
    for group in np.split(order, starts[1:]) if len(order) else ():
        number = int(numbers[group[0]])
        for name in names[number] if number >= 0 else ():
            parts.setdefault(name, []).append(group)
    return {name: np.sort(np.concatenate(groups)) for name, groups in parts.items()}

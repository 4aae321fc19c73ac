"""Names of leaves: given ones as they are, automatic ones numbered in tree order."""

from __future__ import annotations


class Namer:
    """Hands out names in tree order.

    Given names never change. An unnamed leaf is called by its kind, and numbered if a leaf before
    it answers to that already, so that appending a leaf changes no earlier name.

    Examples
    --------
    >>> namer = Namer()
    >>> [namer.named("", given, "disk") for given in (None, "hole", None)]
    ['disk', 'hole', 'disk.2']
    >>> namer.named("bracket", None, "disk")
    'bracket.disk'
    """

    def __init__(self) -> None:
        self._count: dict[str, int] = {}
        self._taken: set[str] = set()

    def named(self, prefix: str, given: str | None, kind: str) -> str:
        """The full name of the next leaf: below `prefix`, `given` or by its kind."""
        base = given if given is not None else kind
        full = f"{prefix}.{base}" if prefix else base
        count = self._count.get(full, 0) + 1
        if given is None and count > 1:
            while f"{full}.{count}" in self._taken:
                count += 1
        self._count[full] = count
        name = full if given is not None or count == 1 else f"{full}.{count}"
        self._taken.add(name)
        return name


def part_names(leaf: str, parts: tuple[str, ...]) -> tuple[str, ...]:
    """Full names of a leaf's parts; a single part is called as the leaf."""
    return tuple([f"{leaf}.{part}" if part else leaf for part in parts])

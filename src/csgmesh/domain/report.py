"""What an evaluation had to do to the boundary it was given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class Merge:
    """Features closer than the snap distance that became one.

    Attributes
    ----------
    place : tuple of float
        Where.
    distance : float
        How far a point moved at the most.
    leaves : tuple of str
        The leaves whose boundaries met there.
    """

    place: tuple[float, ...]
    distance: float
    leaves: tuple[str, ...]

    def __str__(self) -> str:
        where = ", ".join(f"{x:.6g}" for x in self.place)
        return f"({where}): {' and '.join(self.leaves)} merged over {self.distance:.3g}"


@dataclass(frozen=True)
class Report:
    """What was merged, and how far a point moved at the most.

    Attributes
    ----------
    merges : tuple of Merge
        The first `LISTED` merges, in the order of their points.
    n_merges : int
        How many there were.
    largest_displacement : float
        In coordinate units.
    """

    merges: tuple[Merge, ...] = ()
    n_merges: int = 0
    largest_displacement: float = 0.0

    LISTED: ClassVar[int] = 100

    def __str__(self) -> str:
        if not self.n_merges:
            return "nothing merged"
        lines = [f"{self.n_merges} merged, by {self.largest_displacement:.3g} at the most"]
        lines += [f"  {m}" for m in self.merges]
        if self.n_merges > len(self.merges):
            lines.append(f"  … and {self.n_merges - len(self.merges)} more")
        return "\n".join(lines)

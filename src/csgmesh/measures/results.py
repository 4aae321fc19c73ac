"""What a check found: failures with place and entities, and the certificate that lists them."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

PASSED, FAILED, SKIPPED = "passed", "failed", "skipped"


@dataclass(frozen=True)
class Failure:
    """A rule that does not hold.

    Attributes
    ----------
    rule : str
        Name of the rule.
    message : str
        The rule, the value found, and where first.
    place : tuple of float
        Coordinates of the first offender; empty where it has none.
    what : str
        What the entities are: ``"cell"``, ``"facet"``, ``"point"``, ``"edge"``, ...
    entities : tuple of int
        Numbers of the offenders, the first `LISTED` of them.
    count : int
        How many there are.
    """

    rule: str
    message: str
    place: tuple[float, ...] = ()
    what: str = ""
    entities: tuple[int, ...] = ()
    count: int = 1

    def __str__(self) -> str:
        return f"{self.rule}: {self.message}"


#: A failure lists no more entities than this.
LISTED = 100


@dataclass(frozen=True)
class Check:
    """One rule and how it went.

    Attributes
    ----------
    rule : str
        Name of the rule.
    status : str
        ``"passed"``, ``"failed"`` or ``"skipped"``.
    count : int
        How many entities were checked.
    note : str
        What was measured, or why the rule could not be checked.
    failures : tuple of Failure
    """

    rule: str
    status: str
    count: int = 0
    note: str = ""
    failures: tuple[Failure, ...] = ()

    @staticmethod
    def of(rule: str, count: int, failures: list[Failure], note: str = "") -> Check:
        """Passed without failures, failed with them."""
        return Check(rule, FAILED if failures else PASSED, count, note, tuple(failures))

    @staticmethod
    def skipped(rule: str, reason: str) -> Check:
        """Not checked, and why."""
        return Check(rule, SKIPPED, 0, reason)


@dataclass(frozen=True, repr=False)
class Certificate:
    """All rules that a mesh was checked against, and the failures.

    Attributes
    ----------
    checks : tuple of Check
        Every rule, in the order of checking.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 2, 1]]})
    >>> certificate = cm.check(mesh)
    >>> certificate.ok
    False
    >>> print(certificate.failures[0])
    orientation: 1 cell is not counterclockwise; the first is cell 0 at (0.333333, 0.333333)
    """

    checks: tuple[Check, ...]

    @staticmethod
    def of(rules: Sequence[tuple[str, Callable[[Any], Check]]], case: object) -> Certificate:
        """Check a case by rules; all but the first are skipped when numbers are out of range."""
        checks = [rules[0][1](case)]
        for name, rule in rules[1:]:
            if checks[0].failures:
                checks.append(Check.skipped(name, "numbers are out of range"))
            else:
                checks.append(rule(case))
        return Certificate(tuple(checks))

    @property
    def ok(self) -> bool:
        """Whether no rule failed."""
        return not self.failures

    @property
    def failures(self) -> tuple[Failure, ...]:
        """The failures of all rules."""
        return tuple(failure for check in self.checks for failure in check.failures)

    def __getitem__(self, rule: str) -> Check:
        """The check of one rule, by its name."""
        for check in self.checks:
            if check.rule == rule:
                return check
        raise KeyError(f"no rule {rule!r}; there are {', '.join(c.rule for c in self.checks)}")

    def to_json(self) -> str:
        """The certificate as JSON: ``ok`` and a list of ``checks``."""
        return json.dumps({"ok": self.ok, "checks": [asdict(check) for check in self.checks]})

    def __repr__(self) -> str:
        verdict = "ok" if self.ok else f"{len(self.failures)} failures"
        skipped = sum(check.status == SKIPPED for check in self.checks)
        return f"<Certificate: {verdict}; {len(self.checks)} rules, {skipped} skipped>"

    def __str__(self) -> str:
        width = max((len(check.rule) for check in self.checks), default=0)
        lines = []
        for check in self.checks:
            count = f"{check.count:,}" if check.count else ""
            line = f"{check.status:<8} {check.rule:<{width}} {count:>11}  {check.note}"
            lines.append(line.rstrip())
            lines += [f"         {failure.message}" for failure in check.failures]
        lines.append("the mesh is valid" if self.ok else f"{len(self.failures)} rules are broken")
        return "\n".join(lines)


def offenders(
    rule: str,
    what: str,
    numbers: np.ndarray,
    places: np.ndarray,
    complaint: str,
    detail: str = "",
) -> list[Failure]:
    """One failure for all entities that break a rule the same way, none if none does.

    Parameters
    ----------
    rule, what : str
    numbers : (k,) int64
        The offenders.
    places : (k, dim) float64
        Where each is.
    complaint : str
        Put behind "n cells"; ``is|are`` and its like are chosen by the number.
    detail : str
        Said of the first.

    Examples
    --------
    >>> offenders("r", "cell", np.array([3]), np.array([[0.0, 1.0]]), "is|are flat")[0].message
    '1 cell is flat; the first is cell 3 at (0, 1)'
    """
    if not len(numbers):
        return []
    n = len(numbers)
    verb, _, rest = complaint.partition(" ")
    one, _, many = verb.partition("|")
    place = tuple(float(x) for x in places[0])
    where = ", ".join(f"{x:.6g}" for x in place)
    message = (
        f"{n:,} {what if n == 1 else what + 's'} {one if n == 1 or not many else many} {rest}; "
        f"the first is {what} {numbers[0]} at ({where})" + (f": {detail}" if detail else "")
    )
    return [Failure(rule, message, place, what, tuple(numbers[:LISTED].tolist()), n)]

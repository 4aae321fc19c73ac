"""One shape through evaluation, meshing and the certificate, in bounded time."""

from __future__ import annotations

import signal
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import csgmesh as cm
from csgmesh.errors import CsgmeshError

#: Seconds after which a single shape counts as hanging.
PATIENCE = 60
#: Points a single shape may use: far more than any of the corpora needs.
MAX_POINTS = 500_000


class Hang(Exception):
    """A shape took longer than `PATIENCE`."""


@dataclass(frozen=True)
class Verdict:
    """What became of a shape: ``ok``, ``refused`` with a csgmesh error, or a failure."""

    label: str
    outcome: str
    detail: str = ""
    n_cells: int = 0
    seconds: float = 0.0

    @property
    def is_failure(self) -> bool:
        return self.outcome not in ("ok", "refused")

    def __str__(self) -> str:
        return f"{self.label}: {self.outcome}: {self.detail}"


@contextmanager
def patience(seconds: int) -> Iterator[None]:
    """Raise `Hang` in the block after so many seconds."""

    def ring(*_: object) -> None:
        raise Hang(f"no result after {seconds} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def judge(label: str, make: Callable[[], Any], min_angle: float, size: Any = None) -> Verdict:
    """Mesh a shape and check the mesh against it."""
    start = time.perf_counter()
    mesher = cm.DelaunayRefinement(min_angle=min_angle, max_points=MAX_POINTS)
    cells = 0
    try:
        with patience(PATIENCE):
            shape = make()
            mesh = cm.generate(shape, mesher, size)
            cells = mesh.n_cells
            certificate = cm.check(mesh, shape)
    except CsgmeshError as error:
        outcome, detail = "refused", f"{type(error).__name__}: {error}"
    except Hang as error:
        outcome, detail = "hang", str(error)
    except Exception as error:
        outcome, detail = "crash", f"{type(error).__name__}: {error}"
    else:
        outcome = "ok" if certificate.ok else "wrong"
        detail = "; ".join(str(f) for f in certificate.failures)
    return Verdict(label, outcome, detail, cells, time.perf_counter() - start)


def counts(verdicts: Iterable[Verdict]) -> dict[str, Any]:
    """Numbers of a corpus for the record, with every failure in full."""
    verdicts = list(verdicts)
    slowest = max(verdicts, key=lambda v: v.seconds)
    refusals = Counter(v.detail.split(":")[0] for v in verdicts if v.outcome == "refused")
    return {
        "shapes": len(verdicts),
        **Counter(v.outcome for v in verdicts),
        "refused with": dict(refusals),
        "triangles": sum(v.n_cells for v in verdicts),
        "seconds": round(sum(v.seconds for v in verdicts), 1),
        "slowest": f"{slowest.label}, {slowest.seconds:.1f} s",
        "failures": [str(v) for v in verdicts if v.is_failure],
    }

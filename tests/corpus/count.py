"""Run corpora and record what became of them in ``counts.json``.

``python tests/corpus/count.py`` runs all of them, some half an hour on one core; with words of
their names, only those, and the counts of the others stay.
"""

from __future__ import annotations

import json
import os
import platform
import sys
from datetime import date
from pathlib import Path

from corpora import CORPORA
from verdict import counts, judge

import csgmesh as cm

RECORD = Path(__file__).with_name("counts.json")


def run(name: str) -> dict[str, object]:
    """Run one corpus, printing failures as they come."""
    shapes, min_angle = CORPORA[name]
    cm.generate(cm.Disk((0, 0), 1))  # compiles the kernels, which is no shape's fault
    verdicts = []
    for label, make in shapes():
        verdicts.append(judge(label, make, min_angle))
        if verdicts[-1].outcome != "ok":
            print(verdicts[-1], flush=True)
        if len(verdicts) % 500 == 0:
            print(f"{len(verdicts)} shapes", flush=True)
    where = f"Python {platform.python_version()}, load average {os.getloadavg()[0]:.1f}"
    return {"date": date.today().isoformat(), "where": where, **counts(verdicts)}


def main(words: list[str]) -> None:
    """Run the corpora whose names hold one of the words."""
    for name in CORPORA:
        if not words or any(word in name for word in words):
            print(name, flush=True)
            found = run(name)
            record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
            record[name] = found
            RECORD.write_text(json.dumps({k: record[k] for k in CORPORA if k in record}, indent=1))
            print(json.dumps(found, indent=1), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])

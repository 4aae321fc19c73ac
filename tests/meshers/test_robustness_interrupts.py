"""Ctrl-C acts at once, during meshing and during evaluation."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

#: An interrupt comes while the work runs. What is printed is the processor time from the signal to
#: the exception: on a busy machine seconds on the wall would measure other processes.
PROGRAM = """
import os, signal, threading, time
import numpy as np
import csgmesh as cm

square = cm.Box((0, 0), (1, 1))
cm.generate(square, size=0.01)  # what is compiled is compiled
t = np.linspace(0, 2 * np.pi, 200_000, endpoint=False)
wave = (1 + 0.1 * np.sin(50 * t))[:, None] * np.column_stack([np.cos(t), np.sin(t)])
sent = []

def interrupt():
    # Python itself drops what is raised within a destructor; then people press again.
    while True:
        time.sleep(0.5 if sent else 0.15)
        sent.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt, daemon=True).start()
try:
    while True:
        WORK
except KeyboardInterrupt:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    print(time.process_time() - sent[-1])
"""


@pytest.mark.parametrize(
    "work", ["cm.generate(square, size=5e-4)", "cm.evaluate(cm.Polygon(wave))"]
)
def test_an_interrupt_stops_the_work_at_once(work: str) -> None:
    program = PROGRAM.replace("WORK", work)
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
        # Shells start what runs in the background deaf to it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    assert float(done.stdout) < 0.3

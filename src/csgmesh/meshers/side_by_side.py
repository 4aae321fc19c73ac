"""Jobs in threads: for kernels, which let go of the interpreter's lock while they run."""

from __future__ import annotations

import contextlib
import contextvars
import ctypes
import os
import threading
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

from csgmesh.meshers.workspace import Progress

T = TypeVar("T")

#: Seconds between two looks at how far the threads are; also how long Ctrl-C may wait.
PAUSE = 0.05


class _Stopped(BaseException):
    """Ends a job whose result nobody wants any more."""


class SideBySide(Generic[T]):
    """Runs jobs in threads, the caller's thread waiting for them.

    A job is called with a function to report its progress to, through which it is stopped: when a
    job before it in the list has failed, or the caller was interrupted. Jobs before one that fails
    are finished, so that the first failure of the list is found whatever the number of threads.

    Attributes
    ----------
    results : dict of int to T
        What the jobs have returned.
    errors : dict of int to Exception
        What they have raised; of the first failure and perhaps of some after it.
    """

    def __init__(
        self, jobs: Sequence[Callable[[Progress], T]], progress: Progress | None = None
    ) -> None:
        self.jobs = jobs
        self.progress = progress
        self.results: dict[int, T] = {}
        self.errors: dict[int, Exception] = {}
        self._lock = threading.Lock()
        self._next = 0
        self._stop_from = len(jobs)
        self._told: dict[int, tuple[str, int, int]] = {}
        self._latest = ""

    def run(self, threads: int) -> None:
        """Run the jobs; raises only what the caller's own progress or an interruption raises."""
        n = min(threads, len(self.jobs))
        if n < 2:
            self._work(self._tell_at_once)
            return
        context = contextvars.copy_context
        crew = [
            threading.Thread(target=context().run, args=(self._work, self._tell), daemon=True)
            for _ in range(n)
        ]
        try:
            for thread in crew:
                thread.start()
            for thread in crew:
                while thread.is_alive():
                    thread.join(PAUSE)
                    self._report()
        except BaseException:
            self._stop_from = -1
            for thread in crew:
                if thread.ident is not None:
                    _interrupt(thread)
                    thread.join()
            raise

    def _work(self, tell: Callable[[int, str, int, int], None]) -> None:
        with contextlib.suppress(_Stopped):
            self._work_on(tell)

    def _work_on(self, tell: Callable[[int, str, int, int], None]) -> None:
        while True:
            with self._lock:
                i = self._next
                if i >= self._stop_from:
                    return
                self._next += 1
            try:
                result = self.jobs[i](lambda *what, i=i: tell(i, *what))
            except _Stopped:
                continue
            except Exception as error:
                self.errors[i] = error
                with self._lock:
                    self._stop_from = min(self._stop_from, i)
            else:
                self.results[i] = result

    def _tell(self, i: int, stage: str, done: int, total: int) -> None:
        if i > self._stop_from:
            raise _Stopped
        self._told[i] = stage, done, total
        self._latest = stage

    def _tell_at_once(self, i: int, stage: str, done: int, total: int) -> None:
        self._tell(i, stage, done, total)
        self._report()

    def _report(self) -> None:
        """Tell the caller's progress the sum over all jobs at the stage reported last."""
        stage = self._latest
        if self.progress is None or not stage:
            return
        here = [(done, total) for told, done, total in list(self._told.values()) if told == stage]
        self.progress(stage, sum(done for done, _ in here), sum(total for _, total in here))


def _interrupt(thread: threading.Thread) -> None:
    """Stop a thread where it is, as Ctrl-C stops the main one: before its next line of Python."""
    identity = ctypes.c_ulong(thread.ident or 0)
    ctypes.pythonapi.PyThreadState_SetAsyncExc(identity, ctypes.py_object(_Stopped))


def cores() -> int:
    """Number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

"""Progress on a terminal, for whatever takes longer than a second."""

from __future__ import annotations

import sys
import threading
from types import TracebackType
from typing import TYPE_CHECKING

from csgmesh.kernels import must_compile

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

#: Seconds of silence; what is done by then needs no bar.
PATIENCE = 1.0

COMPILING = "compiling, once"


class TerminalProgress:
    """A callable for `csgmesh.generate`; shows a bar on stderr if that is a terminal.

    Use as a context manager around the work.
    """

    def __init__(self) -> None:
        self._stage = "starting"
        self._done = 0
        self._total = 0
        self._lock = threading.Lock()
        self._timer: threading.Timer | None = None
        self._bar: Progress | None = None
        self._task: TaskID | None = None
        self._is_compiling = False
        self._closed = False

    def __enter__(self) -> TerminalProgress:
        if sys.stderr.isatty():
            self._is_compiling = must_compile()
            self._timer = threading.Timer(PATIENCE, self._show)
            self._timer.daemon = True
            self._timer.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        with self._lock:
            self._closed = True
            if self._timer is not None:
                self._timer.cancel()
            if self._bar is not None:
                self._bar.stop()

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Note how far a stage is."""
        if self._timer is None:
            return
        with self._lock:
            self._stage, self._done, self._total = stage, done, total
            # Each kernel compiles at its first call, so one stage after another may have to.
            self._is_compiling = self._is_compiling and must_compile()
            self._update()

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        with self._lock:
            if self._closed:
                return
            self._bar = Progress(
                TextColumn("{task.description}"),
                BarColumn(),
                TimeElapsedColumn(),
                console=Console(stderr=True),
                transient=True,
            )
            self._task = self._bar.add_task(self._stage, total=None)
            self._bar.start()
            self._update()

    def _update(self) -> None:
        if self._bar is None or self._task is None:
            return
        stage = f"{self._stage}: {COMPILING}" if self._is_compiling else self._stage
        self._bar.update(
            self._task, description=stage, completed=self._done, total=self._total or None
        )

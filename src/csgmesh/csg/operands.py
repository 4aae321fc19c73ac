"""Operands of a boolean: immutable runs of shapes in a buffer shared with the run they grew from.

``s = s | x`` ten thousand times makes ten thousand booleans. Were each to own its operands, the
loop would copy fifty million references; sharing one growing buffer makes each step constant on
average. A run at the end of its buffer is extended in place, any other is copied first, so no run
ever sees another's additions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from threading import Lock
from typing import Generic, TypeVar

T = TypeVar("T")

#: Guards "is this run the end of its buffer? then append", which two threads must not interleave.
_GROWING = Lock()


class _Buffer(Generic[T]):
    """A list that grows at both ends: item i is ``back[i]``, or ``front[-1 - i]`` for i < 0."""

    __slots__ = ("back", "front")

    def __init__(self, items: Sequence[T]) -> None:
        self.back = list(items)
        self.front: list[T] = []


class Run(Generic[T]):
    """Items ``start`` to ``stop`` of a shared buffer.

    Examples
    --------
    >>> ab = Run.of(["a", "b"])
    >>> abc, abd = ab.extended(["c"]), ab.extended(["d"])
    >>> list(ab), list(abc), list(abd), list(abc.preceded(["z"]))
    (['a', 'b'], ['a', 'b', 'c'], ['a', 'b', 'd'], ['z', 'a', 'b', 'c'])
    """

    __slots__ = ("_buffer", "_start", "_stop")

    def __init__(self, buffer: _Buffer[T], start: int, stop: int) -> None:
        self._buffer, self._start, self._stop = buffer, start, stop

    @staticmethod
    def of(items: Sequence[T]) -> Run[T]:
        """A run of its own buffer."""
        return Run(_Buffer(items), 0, len(items))

    def __len__(self) -> int:
        return self._stop - self._start

    def __iter__(self) -> Iterator[T]:
        return iter(self.items())

    def items(self) -> list[T]:
        """The items, copied into a list."""
        front, back = self._buffer.front, self._buffer.back
        if self._start >= 0:
            return back[self._start : self._stop]
        before = front[max(-self._stop, 0) : -self._start]
        before.reverse()
        return before + back[: max(self._stop, 0)]

    def extended(self, items: Sequence[T]) -> Run[T]:
        """This run followed by `items`."""
        buffer = self._buffer
        with _GROWING:
            if self._stop >= 0 and self._stop == len(buffer.back):
                buffer.back.extend(items)
                return Run(buffer, self._start, self._stop + len(items))
        return Run.of(self.items() + list(items))

    def preceded(self, items: Sequence[T]) -> Run[T]:
        """`items` followed by this run."""
        buffer = self._buffer
        with _GROWING:
            if self._start <= 0 and -self._start == len(buffer.front):
                buffer.front.extend(reversed(items))
                return Run(buffer, self._start - len(items), self._stop)
        return Run.of(list(items) + self.items())

"""Turns of requests that wait for one another, of which only the newest of each kind is worth answering."""

from __future__ import annotations

from collections.abc import Callable
from threading import Condition
from typing import Generic, TypeVar

Result = TypeVar("Result")


class NewestTurn(Generic[Result]):
    """Queue of calculations that run one at a time; of several of a kind that wait, only the newest has its turn.

    Kinds keep their places in the queue when a newer request of theirs comes, so that none starves.

    Examples
    --------
    >>> NewestTurn().take("answer", lambda: 6.268)
    6.268
    """

    def __init__(self) -> None:
        self._changed = Condition()
        self._waiting: dict[str, int] = {}
        self._count = 0
        self._is_busy = False

    def take(self, kind: str, calculate: Callable[[], Result]) -> Result | None:
        """Result of a calculation once it has its turn, None where a newer one of its kind took its place."""
        with self._changed:
            self._count += 1
            own = self._waiting[kind] = self._count
            self._changed.notify_all()
            while self._waiting.get(kind) == own and (self._is_busy or next(iter(self._waiting)) != kind):
                self._changed.wait()
            if self._waiting.get(kind) != own:
                return None
            del self._waiting[kind]
            self._is_busy = True
        try:
            return calculate()
        finally:
            with self._changed:
                self._is_busy = False
                self._changed.notify_all()

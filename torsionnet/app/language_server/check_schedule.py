"""Schedule of checks: the newest text of a file wins, and nothing waits for a long check."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

CHANGE_DELAY = 0.1
"""Time in s without a further change after which a changed text is checked, as nobody reads while typing."""


class CheckSchedule:
    """Tasks that check open files, at most one of each file; a newer one takes the place of the one before."""

    def __init__(self, check: Callable[[str], Awaitable[None]]) -> None:
        self._check = check
        self._tasks: dict[str, asyncio.Task[None]] = {}

    def ask(self, uri: str, delay: float = 0.0) -> None:
        """Check a file after a delay in s, unless it is asked for again before."""
        self.drop(uri)
        task = asyncio.get_running_loop().create_task(self._later(uri, delay))
        self._tasks[uri] = task
        task.add_done_callback(lambda done: self._forget(uri, done))

    def drop(self, uri: str) -> None:
        """Give up the check of a file that is no longer wanted; what it finds is not shown."""
        task = self._tasks.pop(uri, None)
        if task is not None:
            task.cancel()

    async def _later(self, uri: str, delay: float) -> None:
        await asyncio.sleep(delay)
        await self._check(uri)

    def _forget(self, uri: str, task: asyncio.Task[None]) -> None:
        if self._tasks.get(uri) is task:
            del self._tasks[uri]

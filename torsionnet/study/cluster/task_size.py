"""How many chunks go into one task, so that a task takes long against what a scheduler does for it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from math import ceil
from statistics import median

TASK_SECONDS = 2.0
"""Of a task, at least; what is done for each takes some milliseconds of a worker."""

TASKS_A_SECOND = 50.0
"""Of all workers together; a scheduler and a client manage some hundred."""


@dataclass
class TaskSize:
    """Chunks of a task by the time that the last ones took.

    Examples
    --------
    >>> size = TaskSize()
    >>> size.chunks(left=1000, workers=2)
    1
    >>> size.learn([0.5, 0.5, 0.5])
    >>> size.chunks(left=1000, workers=2), size.chunks(left=4, workers=2)
    (4, 2)
    >>> size.chunks(left=10**6, workers=1000)
    40
    """

    seconds: deque[float] = field(default_factory=lambda: deque(maxlen=50))

    def learn(self, seconds: Iterable[float]) -> None:
        """Wall clock of finished chunks."""
        self.seconds.extend(seconds)

    def chunks(self, left: int, workers: int) -> int:
        """Of the next task; towards the end fewer, so that no worker is idle while another has a pile."""
        if not self.seconds:
            return 1
        wanted = ceil(max(TASK_SECONDS, workers / TASKS_A_SECOND) / max(median(self.seconds), 1e-6))
        return max(1, min(wanted, ceil(left / max(workers, 1))))

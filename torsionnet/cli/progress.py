"""Progress bars on stderr, where somebody looks at it."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.progress import TaskID


class Show(Protocol):
    """Tells how far a stage is: its name, how much is done and of how much; None if nobody knows."""

    def __call__(self, stage: str, done: float, total: float | None, words: str = "") -> None:
        """With words beside the bar instead of the name."""
        ...


@contextlib.contextmanager
def progress(what: str, total: float | None) -> Iterator[Callable[[float], None]]:
    """A bar that is full when the calls of the function given have added up to ``total``; it only moves without one."""
    done = 0.0

    def advance(amount: float) -> None:
        nonlocal done
        done += amount
        show(what, done, total)

    with stages() as show:
        show(what, 0.0, total)
        yield advance


@contextlib.contextmanager
def stages() -> Iterator[Show]:
    """A bar for one stage after the other."""
    if not sys.stderr.isatty():
        yield lambda stage, done, total, words="": None  # noqa: ARG005  (a Show that shows nothing)
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    tasks: dict[str, TaskID] = {}

    def show(stage: str, done: float, total: float | None, words: str = "") -> None:
        if stage not in tasks:
            for _ in range(len(tasks)):
                bar.remove_task(tasks.popitem()[1])
            tasks[stage] = bar.add_task(stage, total=total)
        bar.update(tasks[stage], completed=done, total=total, description=words or stage)

    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        yield show

"""Progress bars on stderr, shown only in a terminal."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.progress import TaskID


class ShowProgress(Protocol):
    """Function that shows how far a stage of a calculation is: name, amount done, total amount (None: unknown)."""

    def __call__(self, stage: str, done: float, total: float | None, words: str = "") -> None:
        """Update the progress bar of a stage.

        ``words``, if given, stand beside the bar instead of the name of the stage.
        """
        ...


@contextlib.contextmanager
def progress(what: str, total: float | None) -> Iterator[Callable[[float], None]]:
    """Context with a progress bar of one stage.

    Yields a function that adds an amount, up to ``total`` (None: unknown).
    """
    done = 0.0

    def advance(amount: float) -> None:
        nonlocal done
        done += amount
        show(what, done, total)

    with stages() as show:
        show(what, 0.0, total)
        yield advance


@contextlib.contextmanager
def stages() -> Iterator[ShowProgress]:
    """Context with progress bars of stages one after the other; yields a function that shows how far a stage is."""
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

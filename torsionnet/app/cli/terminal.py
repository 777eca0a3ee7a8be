"""Printing of messages on stderr, and of tables and data on stdout."""

from __future__ import annotations

import contextlib
import os
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol

import click

from torsionnet.base.errors import in_brackets, printable_text
from torsionnet.base.notes import Note, NoteOrText
from torsionnet.base.number_text import json_finite

if TYPE_CHECKING:
    from rich.progress import TaskID

    from torsionnet.base.errors import Fault
    from torsionnet.base.table import Table


COLOURS = {"error": "red", "warning": "yellow", "note": "blue"}
NARROWEST_TEXT = 16
"""Least width in characters of a framed text column."""


def message(kind: str, text: str) -> None:
    """Print a message on stderr after its kind, as "note" or "error"."""
    head = click.style(f"{kind}:", fg=COLOURS.get(kind), bold=True) if _coloured(sys.stderr) else f"{kind}:"
    click.echo(f"{head} {printable_text(text)}", err=True)


def print_line(text: str = "") -> None:
    """Print a line of text on stdout."""
    click.echo(printable_text(text))


def print_file_written(path: str) -> None:
    """Print on stderr that a file was written."""
    message("wrote", path)


def print_faults(faults: Iterable[Fault]) -> None:
    """Print warnings and notes about a model on stderr, a line each."""
    # A solver may warn of the same finding again; marked as seen here, it is not printed twice.
    seen: set[str] = getattr(warnings.showwarning, "seen", set())
    for fault in faults:
        seen.add(fault.text)
        where = f"{fault.position.file}:{fault.position.line}: " if fault.position else ""
        message(fault.severity, f"{where}{fault.text}{in_brackets(fault.kind)}")


def print_warnings(notes: Iterable[NoteOrText]) -> None:
    """Print on stderr the notes of a result that are warnings."""
    for note in notes:
        if isinstance(note, Note) and note.severity == "warning":
            message("warning", note.named)


def print_json(data: Any) -> None:
    """Print data as JSON on stdout; inf and nan become null."""
    import json

    click.echo(json.dumps(json_finite(data), indent=1))


def print_table(table: Table) -> None:
    """Print a table with its notes on stdout: framed in a terminal, aligned text in a pipe or file."""
    from torsionnet.base.table import SCREEN_WIDTH, aligned_lines, wrapped  # help of commands needs no tables

    table = _safe(table)
    if sys.stdout.isatty():
        _print_framed(table)
    else:
        click.echo("\n".join(aligned_lines(table, SCREEN_WIDTH)))
    for note in table.notes:
        for line in wrapped(note, indent="  "):
            print_line(line)


def _safe(table: Table) -> Table:
    """Copy of a table with control characters in its texts made visible."""
    return replace(
        table, title=printable_text(table.title), rows=tuple(tuple(map(_safe_cell, row)) for row in table.rows)
    )


def _safe_cell(cell: Any) -> Any:
    if isinstance(cell, tuple):
        return tuple(map(_safe_cell, cell))
    return printable_text(cell) if isinstance(cell, str) else cell


def _coloured(stream: Any) -> bool:
    return bool(stream.isatty()) and not os.environ.get("NO_COLOR")


def _print_framed(table: Table) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table as Framed
    from rich.text import Text

    from torsionnet.base.table import BETWEEN_COLUMNS, NARROWEST_HEADING, broken_heading

    console = Console(highlight=False, color_system=None if os.environ.get("NO_COLOR") else "auto")
    framed = Framed(
        title=Text(table.title) if table.title else None,
        title_justify="left",
        title_style="bold",
        box=box.ASCII if console.options.ascii_only else box.SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    cells, least = table.cells(), BETWEEN_COLUMNS
    for index, column in enumerate(table.columns):
        number, widest = table.is_numeric(index), max((len(row[index]) for row in cells), default=0)
        heading = broken_heading(column.name, column.unit, max(widest, NARROWEST_HEADING))
        needed = max([widest if number else min(widest, NARROWEST_TEXT), *map(len, heading)])
        framed.add_column(Text("\n".join(heading)), justify="right" if number else "left", min_width=needed)
        least += needed + BETWEEN_COLUMNS
    for row in cells:
        framed.add_row(*map(Text, row))
    console.width = max(console.width, least)  # rather long lines than digits cut off
    console.print(framed, crop=False)


def blank_zero_shares(table: Table) -> Table:
    """Copy of a table of energy shares with two decimals and empty cells for zeros."""
    rows = tuple((row[0], *(share or None for share in row[1:])) for row in table.rows)
    return replace(table, columns=tuple(replace(column, decimals=2) for column in table.columns), rows=rows)


# Progress bars on stderr, shown only in a terminal.


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


# Note on stderr on the memory that a command will take.

LARGE_MEMORY = 1e9
"""Bytes of memory above which a command announces its need, since any computer has room for less."""


def note_memory(needed: float, advice: str) -> None:
    """Print a note on stderr if a command needs more than 1 GB, with advice on what takes less."""
    if needed > LARGE_MEMORY:
        message("note", f"takes about {needed / 1e9:.1f} GB of memory; {advice}")

"""Printing of messages on stderr, and of tables and data on stdout."""

from __future__ import annotations

import os
import sys
import textwrap
import warnings
from collections.abc import Iterable
from dataclasses import replace
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

import click

from torsionnet.base.errors import printable_text
from torsionnet.base.notes import Note, NoteOrText
from torsionnet.base.number_text import json_finite, unit_in_brackets

if TYPE_CHECKING:
    from torsionnet.base.errors import Fault
    from torsionnet.base.table import Table

COLOURS = {"error": "red", "warning": "yellow", "note": "blue"}
NARROWEST_HEADING, NARROWEST_TEXT, BETWEEN_COLUMNS = 9, 16, 2
"""Least width in characters of a broken heading and of a framed text column, and the gap between columns."""
NARROWEST_FOLDED = 30
"""Least width in characters of a column into which long texts are folded, as narrower ones are hard to read."""
SCREEN_WIDTH = 120
"""Characters of a line to which tables are folded or split, so that a usual terminal does not wrap them."""


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
        message(fault.severity, f"{where}{fault.text}")


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
    table = _safe(table)
    if sys.stdout.isatty():
        _print_framed(table)
    else:
        click.echo("\n".join(_aligned(table)))
    for note in table.notes:
        for line in wrapped(note, indent="  "):
            print_line(line)


def table_width(table: Table) -> int:
    """Number of characters in the longest line of a table that is printed as aligned text."""
    return max(map(len, _aligned(table)), default=0)


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


def _aligned(table: Table) -> list[str]:
    """Lines of a table as text with aligned columns.

    Title, broken headings, rows; numbers to the right, long texts folded.
    """
    cells = table.cells()
    right = [table.is_numeric(index) for index in range(len(table.columns))]
    widths, headings = [], []
    for index, column in enumerate(table.columns):
        content = max((len(row[index]) for row in cells), default=0)
        lines = _broken(column.name, column.unit, max(content, NARROWEST_HEADING))
        headings.append(lines)
        widths.append(max([content, *map(len, lines)]))
    narrower = _narrower(widths, right)
    if narrower != widths:
        widths, cells = narrower, _folded(cells, narrower)
    height = max((len(lines) for lines in headings), default=0)
    padded = [[*lines, *[""] * (height - len(lines))] for lines in headings]
    rows = [*([lines[level] for lines in padded] for level in range(height)), ["-" * width for width in widths], *cells]
    return [*([table.title] if table.title else []), *(_line(row, widths, right) for row in rows)]


def _narrower(widths: list[int], right: list[bool]) -> list[int]:
    """Widths in characters of columns, the last one or two of text made narrower to fit the screen."""
    for count in (1, 2):
        if len(widths) < count or any(right[-count:]):
            break
        room = (SCREEN_WIDTH - sum(widths[:-count]) - BETWEEN_COLUMNS * (len(widths) - 1)) // count
        if room >= NARROWEST_FOLDED:
            return [*widths[:-count], *(min(room, width) for width in widths[-count:])]
    return widths


def _folded(cells: list[list[str]], widths: list[int]) -> list[list[str]]:
    """Rows of cells whose long texts are folded over several rows."""
    folded = []
    for row in cells:
        lines = [wrapped(cell, width) if len(cell) > width else [cell] for cell, width in zip(row, widths, strict=True)]
        folded += [list(line) for line in zip_longest(*lines, fillvalue="")]
    return folded


def wrapped(text: str, width: int = SCREEN_WIDTH, indent: str = "") -> list[str]:
    """Lines of a text wrapped to a width in characters; a number stays with its percent sign, and words stay whole."""
    kept = text.replace(" %", "\N{NO-BREAK SPACE}%")
    lines = textwrap.wrap(kept, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
    return [line.replace("\N{NO-BREAK SPACE}%", " %") for line in lines]


def _line(row: list[str], widths: list[int], right: list[bool]) -> str:
    cells = [
        cell.rjust(width) if is_right else cell.ljust(width)
        for cell, width, is_right in zip(row, widths, right, strict=True)
    ]
    return "  ".join(cells).rstrip()


def _broken(name: str, unit: str, width: int) -> list[str]:
    lines = [""]
    for word in [*name.split(" "), *filter(None, [unit_in_brackets(unit)])]:
        if not lines[-1] or len(lines[-1]) + 1 + len(word) <= width:
            lines[-1] = f"{lines[-1]} {word}".strip()
        else:
            lines.append(word)
    return lines


def _print_framed(table: Table) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table as Framed
    from rich.text import Text

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
        heading = _broken(column.name, column.unit, max(widest, NARROWEST_HEADING))
        needed = max([widest if number else min(widest, NARROWEST_TEXT), *map(len, heading)])
        framed.add_column(Text("\n".join(heading)), justify="right" if number else "left", min_width=needed)
        least += needed + BETWEEN_COLUMNS
    for row in cells:
        framed.add_row(*map(Text, row))
    console.width = max(console.width, least)  # rather long lines than digits cut off
    console.print(framed, crop=False)

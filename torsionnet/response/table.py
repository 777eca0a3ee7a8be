"""A small table of results: columns with units, shown as text, CSV, JSON or HTML."""

from __future__ import annotations

import csv
import html
import io
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torsionnet.core.atomic import write_text


@dataclass(frozen=True)
class Column:
    """Heading of a column; ``digits`` are the significant digits of numbers shown as text."""

    name: str
    unit: str = ""
    digits: int = 6

    @property
    def heading(self) -> str:
        return f"{self.name} [{self.unit}]" if self.unit else self.name


@dataclass(frozen=True)
class Table:
    """Columns, rows of plain values, a title and notes (conventions) that go along into every form."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Any, ...], ...]
    notes: tuple[str, ...] = ()

    def cells(self) -> list[list[str]]:
        """Every cell as text with the digits of its column."""
        return [
            [show(value, column.digits) for value, column in zip(row, self.columns, strict=True)] for row in self.rows
        ]

    def to_text(self) -> str:
        headings = [column.heading for column in self.columns]
        cells = self.cells()
        widths = [max(len(row[i]) for row in [headings, *cells]) for i in range(len(headings))]
        lines = [
            "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in [headings, *cells]
        ]
        return "\n".join([self.title, *lines, *self.notes])

    def to_csv(self, path: str | Path | None = None) -> str:
        """Text with the notes as ``#`` lines, a heading with units and full precision; also written to ``path``."""
        buffer = io.StringIO()
        for note in (self.title, *self.notes):
            buffer.write(f"# {note}\n")
        writer = csv.writer(buffer, lineterminator="\n")
        writer.writerow([column.heading for column in self.columns])
        writer.writerows([[_exact(value) for value in row] for row in self.rows])
        return _written(buffer.getvalue(), path)

    def to_json(self, path: str | Path | None = None) -> str:
        """JSON object with title, columns (name, unit), rows and notes; numbers that JSON lacks become null."""
        data = {
            "title": self.title,
            "columns": [{"name": column.name, "unit": column.unit} for column in self.columns],
            "rows": [[_plain(value) for value in row] for row in self.rows],
            "notes": list(self.notes),
        }
        return _written(json.dumps(data, indent=1, ensure_ascii=False) + "\n", path)

    def to_html(self) -> str:
        def line(cells: Sequence[str], tag: str) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"

        head = line([column.heading for column in self.columns], "th")
        body = "\n".join(line(row, "td") for row in self.cells())
        notes = "".join(f"<br><small>{html.escape(note)}</small>" for note in self.notes)
        caption = f"<caption>{html.escape(self.title)}{notes}</caption>"
        return f"<table>\n{caption}\n<thead>{head}</thead>\n<tbody>\n{body}\n</tbody></table>"

    def __str__(self) -> str:
        return self.to_text()


def show(value: Any, digits: int = 6) -> str:
    """A value as a short text: ``-`` for nothing."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, float):
        return f"{value:.{digits}g}"
    return str(value)


def _exact(value: Any) -> Any:
    return (
        ""
        if value is None or (isinstance(value, float) and math.isnan(value))
        else repr(value)
        if isinstance(value, float)
        else value
    )


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _written(text: str, path: str | Path | None) -> str:
    if path is not None:
        write_text(path, text)
    return text

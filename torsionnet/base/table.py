"""Table of results, columns with units, as text, CSV, JSON or HTML."""

from __future__ import annotations

import csv
import html
import io
import json
import os
import shutil
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.base.atomic import write_text
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import MissingExtraError, UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.number_text import csv_value, json_finite, screen_text, unit_in_brackets
from torsionnet.base.packages import thinned
from torsionnet.base.result_fields import OutField, out_fields, shown_value
from torsionnet.base.saved_results import json_object

if TYPE_CHECKING:
    import pandas

NARROWEST_HEADING, BETWEEN_COLUMNS = 9, 2
"""Least width in characters of a broken heading, and the gap between columns."""
NARROWEST_FOLDED = 30
"""Least width in characters of a column into which long texts are folded, as narrower ones are hard to read."""
SCREEN_WIDTH = 120
"""Characters of a line to which tables are folded or split where no terminal says how wide it is."""


@dataclass(frozen=True)
class Column:
    """Column of a table with name, unit, and significant digits and most decimals of its numbers as text."""

    name: str
    unit: str = ""
    digits: int = 6
    decimals: int | None = None

    @property
    def heading(self) -> str:
        """Heading of a table's column, its name with the unit in brackets."""
        return f"{self.name} {unit_in_brackets(self.unit)}".rstrip()

    def text(self, value: Any) -> str:
        """Value in a table's column as text, rounded to the digits of the column."""
        rounded = isinstance(value, float) and self.decimals is not None
        return screen_text(round(value, self.decimals) if rounded else value, self.digits)


@dataclass(frozen=True, repr=False)
class Table:
    """Table of results with title, columns, rows of plain values, and notes that are part of every output format.

    ``short_title`` is the title without the name of what the table is of, where it has one.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Any, ...], ...]
    notes: tuple[str, ...] = ()
    short_title: str = ""

    @classmethod
    def of(
        cls,
        name: str,
        short_title: str,
        columns: tuple[Column, ...],
        rows: tuple[tuple[Any, ...], ...],
        notes: tuple[str, ...] = (),
    ) -> Table:
        """Table whose title begins with the name of what it is of, as that of a study, unless that is empty.

        >>> table = Table.of("Damper of the rig", "yield", (Column("share"),), ())
        >>> table.title, table.short_title
        ('Damper of the rig: yield', 'yield')
        """
        return cls(f"{name}: {short_title}" if name else short_title, columns, rows, notes, short_title)

    def with_digits(self, digits: int) -> Table:
        """Copy of the table with ``digits`` significant digits in every column."""
        return replace(self, columns=tuple(replace(column, digits=digits, decimals=None) for column in self.columns))

    def chosen(self, indices: Sequence[int]) -> Table:
        """Copy of the table with some of its columns only, given by their indices."""
        rows = tuple(tuple(row[index] for index in indices) for row in self.rows)
        return replace(self, columns=tuple(self.columns[index] for index in indices), rows=rows)

    def is_numeric(self, column: int) -> bool:
        """Whether a table's column holds only numbers or empty cells, so that it is aligned to the right."""
        return all(row[column] is None or isinstance(row[column], (int, float)) for row in self.rows)

    def cells(self) -> list[list[str]]:
        """Cells of every row of a table as text, with the digits of their columns."""
        return [[column.text(value) for value, column in zip(row, self.columns, strict=True)] for row in self.rows]

    def to_text(self, width: int | None = None) -> str:
        """Table as text with its title, aligned columns, and its notes; with a width in characters, no wider than it.

        Long texts are folded then, and columns that do not fit follow below the others.
        """
        if width is None:
            return "\n".join([*aligned_lines(self), *self.notes])
        lines = [line for part in split_table(self, 1, width) for line in aligned_lines(part, width)]
        notes = [line for note in self.notes for line in wrapped(note, width, indent="  ")]
        return "\n".join([*lines, *notes])

    def to_csv(self, path: str | Path | None = None) -> str:
        """Table as CSV text in full precision, title and notes as ``#`` lines; also written to ``path`` if given.

        pandas reads it by ``read_csv(path, comment="#")``; :meth:`to_dataframe` needs no file.
        """
        buffer = io.StringIO()
        for note in (self.title, *self.notes):
            buffer.write(f"# {note}\n")
        writer = csv.writer(buffer, lineterminator="\n")
        writer.writerow([column.heading for column in self.columns])
        writer.writerows([[csv_value(value) for value in row] for row in self.rows])
        return _written(buffer.getvalue(), path)

    def to_json(self, path: str | Path | None = None) -> str:
        """Table as JSON text with title, columns (name, unit), rows and notes; numbers that JSON lacks are null."""
        data = {
            "title": self.title,
            "columns": [{"name": column.name, "unit": column.unit} for column in self.columns],
            "rows": [
                [screen_text(cell) if isinstance(cell, tuple) else json_finite(cell) for cell in row]
                for row in self.rows
            ],
            "notes": list(self.notes),
        }
        return _written(json.dumps(data, indent=1, ensure_ascii=False) + "\n", path)

    @classmethod
    def from_json(cls, source: str | os.PathLike[str]) -> Table:
        """Table from the text that :meth:`to_json` has made, or from the file with it.

        Raises
        ------
        UsageError
            There is no such file, or it holds no table.
        """
        name, data = json_object(source)
        try:
            columns = tuple(Column(column["name"], column["unit"]) for column in data["columns"])
            rows = tuple(map(tuple, data["rows"]))
            return cls(data["title"], columns, rows, tuple(data["notes"]))
        except (AttributeError, KeyError, TypeError) as error:
            raise UsageError(
                f"{name} holds no table as Table.to_json writes it: {error} is missing", kind="wrong-file"
            ) from None

    def to_dataframe(self) -> pandas.DataFrame:
        """Table as a pandas.DataFrame of numbers and texts, with title, units by column and notes in its ``attrs``.

        Raises
        ------
        MissingExtraError
            pandas is not installed.

        Examples
        --------
        >>> import torsionnet as tn
        >>> frame = tn.load("dmf_rig").modes().to_dataframe()
        >>> frame["damping ratio"].round(3).tolist(), frame.attrs["units"]["damping ratio"]
        ([0.223, 0.014], '1')
        """
        pandas = import_pandas()
        names = [column.name for column in self.columns]
        cells = [[screen_text(cell) if isinstance(cell, tuple) else cell for cell in row] for row in self.rows]
        frame = pandas.DataFrame(cells, columns=names)
        units = {name: column.unit for name, column in zip(names, self.columns, strict=True)}
        frame.attrs |= {"title": self.title, "units": units, "notes": list(self.notes)}
        return frame

    def to_html(self) -> str:
        """Table as HTML text with title and notes in its caption."""
        # Notebooks align every cell to the right, which only numbers bear.
        sides = ["" if self.is_numeric(at) else ' style="text-align:left"' for at in range(len(self.columns))]

        def line(cells: Sequence[str], tag: str) -> str:
            there = zip(cells, sides, strict=True)
            return f"<tr>{''.join(f'<{tag}{side}>{html.escape(cell)}</{tag}>' for cell, side in there)}</tr>"

        head = line([column.heading for column in self.columns], "th")
        body = "\n".join(line(row, "td") for row in self.cells())
        notes = "".join(f"<br><small>{html.escape(note)}</small>" for note in self.notes)
        caption = f"<caption>{html.escape(self.title)}{notes}</caption>"
        return f"<table>\n{caption}\n<thead>{head}</thead>\n<tbody>\n{body}\n</tbody></table>"

    def _repr_html_(self) -> str:
        return thinned(self).to_html()

    def __str__(self) -> str:
        return self.to_text(terminal_width())

    __repr__ = __str__


def result_table(
    title: str,
    rows: Sequence[object],
    kind: type,
    columns: Sequence[str] = (),
    conventions: Conventions = SI,
    notes: Sequence[NoteOrText] = (),
) -> Table:
    """Table of result rows, with a column for each declared field of their class that has a heading.

    Parameters
    ----------
    title : str
    rows : sequence
        Objects of ``kind``.
    kind : type
        Result class, see :class:`torsionnet.base.result_rows.Out`.
    columns : sequence of str
        Names of the fields in the order of their columns; default: all with a heading, as declared.
    conventions : Conventions
        Units shown.
    notes : sequence of str or Note
    """
    fields = {field.name: field for field in out_fields(kind) if field.out.heading}
    shown = [fields[name] for name in columns] if columns else list(fields.values())
    headings = tuple(
        Column(field.out.heading, conventions.unit_of_column(field.out.unit), field.out.digits, field.out.decimals)
        for field in shown
    )
    cells = tuple(tuple(_cell(row, field, conventions) for field in shown) for row in rows)
    return Table(title, headings, cells, tuple(map(str, notes)))


def _cell(row: object, field: OutField, conventions: Conventions) -> Any:
    value, unit = shown_value(row, field.name), field.out.unit
    if isinstance(value, tuple):  # notes, in one cell
        return "; ".join(map(str, value))
    if field.out.unit_of:
        unit = getattr(row, field.out.unit_of)
        if isinstance(value, str):
            return conventions.unit(value)
    scale = field.out.factor * conventions.scale_of_column(unit)
    return float(value * scale) if isinstance(value, float) or (scale != 1.0 and value is not None) else value


def data_frame(
    values: Any, index: tuple[str, Any], units: Mapping[str, str], title: str, notes: Iterable[object]
) -> pandas.DataFrame:
    """Values (n, columns) as a pandas.DataFrame over an index, its name and numbers, with units by column in SI."""
    pandas = import_pandas()
    frame = pandas.DataFrame(values, pandas.Index(index[1], name=index[0]), list(units))
    frame.attrs |= {"title": title, "units": dict(units), "notes": list(map(str, notes))}
    return frame


def import_pandas() -> Any:
    """Import of the package pandas, which data frames need.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    try:
        import pandas
    except ImportError as error:
        raise MissingExtraError('a DataFrame needs pandas: pip install "torsionnet[pandas]"') from error
    return pandas


def _written(text: str, path: str | Path | None) -> str:
    if path is not None:
        write_text(path, text)
    return text


# Tables as text for a screen: aligned columns with broken headings, long texts folded, wide tables split.


def terminal_width() -> int:
    """Characters in a line of the terminal, or of a usual one where there is none."""
    return shutil.get_terminal_size((SCREEN_WIDTH, 24)).columns


def aligned_lines(table: Table, width: int | None = None) -> list[str]:
    """Lines of a table as text with aligned columns.

    Title, broken headings, rows; numbers to the right, long texts folded to a width in characters if there is one.
    """
    cells = table.cells()
    right = [table.is_numeric(index) for index in range(len(table.columns))]
    widths, headings = [], []
    for index, column in enumerate(table.columns):
        content = max((len(row[index]) for row in cells), default=0)
        lines = broken_heading(column.name, column.unit, max(content, NARROWEST_HEADING))
        headings.append(lines)
        widths.append(max([content, *map(len, lines)]))
    narrower = widths if width is None else _narrower(widths, right, width)
    if narrower != widths:
        widths, cells = narrower, _folded(cells, narrower)
    height = max((len(lines) for lines in headings), default=0)
    padded = [[*lines, *[""] * (height - len(lines))] for lines in headings]
    rows = [*([lines[level] for lines in padded] for level in range(height)), ["-" * width for width in widths], *cells]
    return [*([table.title] if table.title else []), *(_line(row, widths, right) for row in rows)]


def _narrower(widths: list[int], right: list[bool], screen: int) -> list[int]:
    """Widths in characters of columns, the last one or two of text made narrower to fit the screen."""
    for count in (1, 2):
        if len(widths) < count or any(right[-count:]):
            break
        room = (screen - sum(widths[:-count]) - BETWEEN_COLUMNS * (len(widths) - 1)) // count
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


def broken_heading(name: str, unit: str, width: int) -> list[str]:
    """Lines of a heading with its unit, broken between words to a width in characters."""
    lines = [""]
    for word in [*name.split(" "), *filter(None, [unit_in_brackets(unit)])]:
        if not lines[-1] or len(lines[-1]) + 1 + len(word) <= width:
            lines[-1] = f"{lines[-1]} {word}".strip()
        else:
            lines.append(word)
    return lines


def split_table(table: Table, group: int, screen: int = SCREEN_WIDTH) -> Iterator[Table]:
    """Parts of a table that each fit the screen: the first column, and whole groups of ``group`` columns.

    The title stands over the first block, the notes below the last one.
    """
    start, count = 1, len(table.columns)
    if count == 1:
        yield table
    while start < count:
        end = start + group
        while end < count and _width(_columns(table, start, end + group), screen) <= screen:
            end += group
        block = _columns(table, start, end)
        yield replace(block, title=table.title if start == 1 else "", notes=table.notes if end >= count else ())
        start = end


def _width(table: Table, screen: int) -> int:
    return max(map(len, aligned_lines(table, screen)), default=0)


def _columns(table: Table, start: int, end: int) -> Table:
    return replace(table.chosen([0, *range(start, end)]), title="")

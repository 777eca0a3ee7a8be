"""Reader of text files with recorded orders or spectra from an order analysis."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from torsionnet.base.delimited.dialect import data_start, detect_dialect, detect_encoding
from torsionnet.base.delimited.headings import headings
from torsionnet.base.delimited.number_rows import NumberRows
from torsionnet.base.errors import Fault, ModelError, Position, UsageError
from torsionnet.machinery.excitations.measured_columns import FORM, measured_lines

DIALECT_LINES = 400
"""Number of lines from which separators and the first row of numbers are recognised, longer than any head."""


def read_order_table(path: Path) -> tuple[tuple[str, ...], tuple[tuple[float, ...], ...]]:
    """Headings with units, and rows of numbers, of a text file from an order analysis.

    Raises
    ------
    ModelError
        The file cannot be read; the message names the line.
    """
    with path.open(encoding=detect_encoding(path), newline=None, errors="replace") as file:
        lines = file.readlines()
    above = next((at for at, line in enumerate(lines) if line.strip() and not line.startswith(("#", "%"))), 0)
    body = lines[above:]
    dialect = detect_dialect(body[:DIALECT_LINES])
    first = data_start(dialect, body[:DIALECT_LINES])
    if first == min(len(body), DIALECT_LINES):
        raise _fault(f"found no rows of numbers; expected {FORM} and rows below", path.name, above + 1, lines)
    heading = headings(dialect, body[:first], len(dialect.cells(body[first])))
    if not heading.lines:
        raise _fault(f"no heading; the first line says what the columns are: {FORM}", path.name, above + 1, lines)
    reader = NumberRows(iter(body[first:]), path.name, dialect, len(heading.names), above + first + 1, heading.names)
    blocks = [np.column_stack(block) for block in reader.blocks(range(len(heading.names)), 0)]
    columns = tuple(
        f"{name} [{unit}]" if unit else name for name, unit in zip(heading.names, heading.units, strict=True)
    )
    rows = np.concatenate(blocks)
    try:
        if not np.isfinite(rows).all():
            raise UsageError("a number is missing; every row has one in each column")
        measured_lines(columns, rows)
    except UsageError as error:
        raise _fault(str(error), path.name, above + first, lines) from None
    return columns, tuple(tuple(row) for row in rows.tolist())


def _fault(text: str, file: str, number: int, lines: Sequence[str]) -> ModelError:
    """Error with a fault at a line of an order analysis file, counted from 1."""
    source = lines[number - 1].rstrip()[:200].replace("\t", " ") if 0 < number <= len(lines) else ""
    return ModelError([Fault(text, position=Position(file, max(number, 1), 1, len(source) + 1, source))], file)

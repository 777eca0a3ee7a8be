"""Reading of catalogues from their files."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from torsionnet.base.delimited.cell_grid import Cell, CellGrid, read_grid
from torsionnet.base.delimited.sheet_numbers import decimal_sign, is_like_number, plain_number_text
from torsionnet.base.delimited.sheet_units import named_unit, sheet_unit
from torsionnet.base.errors import Fault, ModelError, UsageError, comma_list, nearest
from torsionnet.base.units import UnitError, numeral_of, parse_number
from torsionnet.model.catalogues.catalogue import Catalogue, CatalogueCell, CatalogueRow
from torsionnet.model.catalogues.catalogue_entries import SIZE

MOST_NAMED = 20
"""Largest number of sizes listed in the message that a size does not exist, so that the message stays readable."""


def read_catalogue(path: str | os.PathLike[str]) -> Catalogue:
    """Catalogue of machine elements with the sizes that a text file has.

    A text file with a column ``size`` and columns named as entries, each with its unit.

    Raises
    ------
    ModelError
        The file is no catalogue, with the row and column of every fault.
    UsageError
        There is no such file.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "couplings.csv")
    >>> _ = path.write_text("size;stiffness [kN*m/rad]\\nA350;11,2\\nA400;16,0\\n", encoding="utf-8")
    >>> read_catalogue(path).sizes
    ('A350', 'A400')
    """
    found = Path(path)
    if not found.is_file():
        raise UsageError(f'there is no file "{path}"')
    stat = found.stat()
    return Catalogue(found, tuple(row.size for row in _rows(found, stat.st_mtime_ns, stat.st_size)))


def catalogue_row(path: Path, file: str, size: str) -> CatalogueRow:
    """Catalogue row of one size, from a catalogue that the model calls ``file``.

    Raises
    ------
    ModelError
        No such size, two rows of it, or a file that is no catalogue, each with its place.
    """
    stat = path.stat()
    rows = _rows(path, stat.st_mtime_ns, stat.st_size)
    names = [row.size for row in rows]
    found = [row for row in rows if row.size == size]
    if not found:
        raise ModelError([_unknown(size, names, file)], file)
    if len(found) > 1:
        lines = [row.cells[0].place.line for row in found]
        first = found[1].cells[0].place
        text = f'{len(found)} rows are of size "{size}", in lines {", ".join(map(str, lines))}; each size has one'
        raise ModelError([Fault(text, position=first)], file)
    return CatalogueRow(file, size, found[0].cells, path)


def _unknown(size: str, names: Iterable[str], file: str) -> Fault:
    known = list(dict.fromkeys(names))
    meant = nearest(size, known)
    shown = comma_list(known, MOST_NAMED, ", ...")
    hint = f'; did you mean "{meant}"? It has {shown}' if meant else f"; it has {shown}"
    return Fault(f'{file} has no size "{size}"{hint}', (SIZE,))


@lru_cache(maxsize=16)
def _rows(path: Path, changed: int, length: int) -> tuple[CatalogueRow, ...]:
    """All rows of a catalogue's file, read once as long as the file does not change."""
    del changed, length
    grid = read_grid(path)
    head, *rest = grid.rows
    names = [named_unit(cell.text) for cell in head]
    place = next((index for index, (name, _) in enumerate(names) if name.casefold() == SIZE), None)
    faults = [grid.fault(f'two columns are named "{name}"; rename one', head[[one for one, _ in names].index(name)])
              for name, count in Counter(name for name, _ in names if name).items() if count > 1]  # fmt: skip
    if place is None:
        faults.append(
            grid.fault('the catalogue has no column "size", by which a model names its rows; add it', head[0])
        )
    units = [_unit(grid, cell, unit, faults) for cell, (_, unit) in zip(head, names, strict=True)]
    numbers = [cell for row in rest for cell in row if is_like_number(cell.text)]
    decimal, wrong = decimal_sign(numbers)
    faults += [grid.fault(wrong[1], wrong[0])] if wrong else []
    if faults or place is None:
        raise ModelError(faults, grid.file)
    rows = []
    for row in rest:
        cells = []
        for index, cell in enumerate(row[: len(names)]):
            name, unit = names[index][0], units[index]
            if cell.text and name:
                raw = cell.text if index == place else _raw(cell.text, unit, decimal)
                where, heading = grid.fault("", cell).position, grid.fault("", head[index]).position
                assert where is not None
                assert heading is not None
                cells.append(CatalogueCell(name, raw, unit is not None, is_like_number(raw), where, heading))
        size = row[place].text if place < len(row) else ""
        if size:
            rows.append(CatalogueRow(grid.file, size, tuple(cells)))
    return tuple(rows)


def _unit(grid: CellGrid, cell: Cell, text: str, faults: list[Fault]) -> str | None:
    """Unit of a catalogue's heading as a model file writes it, None where the heading has none."""
    if not text or text in ("1", "-"):
        return None if not text else ""
    try:
        unit = sheet_unit(text)
    except UnitError as error:
        faults.append(grid.fault(str(error), cell))
        return None
    if unit.power:
        faults.append(grid.fault(f'the unit "{text}" has a power of ten; write another unit, as MN*m/rad', cell))
    return unit.text


def _raw(text: str, unit: str | None, decimal: str) -> str:
    number = plain_number_text(text, decimal)
    if number is None:
        return text
    try:
        plain = numeral_of(parse_number(number))
    except UnitError:
        return text
    return f"{plain} {unit}" if unit else plain

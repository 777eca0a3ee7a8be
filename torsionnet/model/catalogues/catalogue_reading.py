"""Reading of catalogues from their files."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from torsionnet.base.delimited.cell_grid import (
    Cell,
    CellGrid,
    decimal_sign,
    is_like_number,
    plain_number_text,
    read_grid,
)
from torsionnet.base.delimited.sheet_headings import named_unit, sheet_unit
from torsionnet.base.entries.spec import EntryError, Spec
from torsionnet.base.errors import Fault, ModelError, UsageError, comma_list, got, nearest, question
from torsionnet.base.nearby_files import nearby_file
from torsionnet.base.units import UnitError, expected_unit, numeral_of, parse_number
from torsionnet.model.catalogues.catalogue import Catalogue, CatalogueCell, CatalogueRow
from torsionnet.model.element_base.element_entries import CATALOGUE, SIZE

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
    file = Path(path)
    if not file.is_file():
        raise UsageError(f'there is no file "{path}"', kind="missing-file")
    stat = file.stat()
    return Catalogue(file, tuple(row.size for row in _catalogue_rows(file, stat.st_mtime_ns, stat.st_size)))


def catalogue_row(path: Path, file: str, size: str) -> CatalogueRow:
    """Catalogue row of one size, from a catalogue that the model calls ``file``.

    Raises
    ------
    ModelError
        No such size, two rows of it, or a file that is no catalogue, each with its place.
    """
    stat = path.stat()
    rows = _catalogue_rows(path, stat.st_mtime_ns, stat.st_size)
    names = [row.size for row in rows]
    matching = [row for row in rows if row.size == size]
    if not matching:
        raise ModelError([_unknown(size, names, file)], file)
    if len(matching) > 1:
        lines = [row.cells[0].place.line for row in matching]
        first = matching[1].cells[0].place
        text = f'{len(matching)} rows are of size "{size}", in lines {", ".join(map(str, lines))}; each size has one'
        raise ModelError([Fault(text, position=first, kind="repeated-name")], file)
    return CatalogueRow(file, size, matching[0].cells, path)


def _unknown(size: str, names: Iterable[str], file: str) -> Fault:
    known = list(dict.fromkeys(names))
    meant = nearest(size, known)
    shown = comma_list(known, MOST_NAMED, ", ...")
    hint = f'; did you mean "{meant}"? It has {shown}' if meant else f"; it has {shown}"
    return Fault(f'{file} has no size "{size}"{hint}', (SIZE,), kind="unknown-name")


@lru_cache(maxsize=16)
def _catalogue_rows(path: Path, changed: int, length: int) -> tuple[CatalogueRow, ...]:
    """All rows of a catalogue's file, read once as long as the file does not change."""
    del changed, length
    grid = read_grid(path)
    head, *rest = grid.rows
    names = [named_unit(cell.text) for cell in head]
    place = next((index for index, (name, _) in enumerate(names) if name.casefold() == SIZE), None)
    faults = [grid.fault(f'two columns are named "{name}"; rename one', head[[text for text, _ in names].index(name)],
                         kind="repeated-name")
              for name, count in Counter(name for name, _ in names if name).items() if count > 1]  # fmt: skip
    if place is None:
        faults.append(
            grid.fault(
                'the catalogue has no column "size", by which a model names its rows; add it',
                head[0],
                kind="missing-column",
            )
        )
    units = [_heading_unit(grid, cell, unit, faults) for cell, (_, unit) in zip(head, names, strict=True)]
    numbers = [cell for row in rest for cell in row if is_like_number(cell.text)]
    decimal, wrong = decimal_sign(numbers)
    faults += [grid.fault(wrong[1], wrong[0], kind="ambiguous-number")] if wrong else []
    if faults or place is None:
        raise ModelError(faults, grid.file)
    rows = []
    for row in rest:
        cells = []
        for index, cell in enumerate(row[: len(names)]):
            name, unit = names[index][0], units[index]
            if cell.text and name:
                raw = cell.text if index == place else _raw(cell.text, unit, decimal)
                where, heading = grid.position(cell), grid.position(head[index])
                cells.append(CatalogueCell(name, raw, unit is not None, is_like_number(raw), where, heading))
        size = row[place].text if place < len(row) else ""
        if size:
            rows.append(CatalogueRow(grid.file, size, tuple(cells)))
    return tuple(rows)


def _heading_unit(grid: CellGrid, cell: Cell, text: str, faults: list[Fault]) -> str | None:
    """Unit of a catalogue's heading as a model file writes it, None where the heading has none."""
    if not text or text in ("1", "-"):
        return None if not text else ""
    try:
        unit = sheet_unit(text)
    except UnitError as error:
        faults.append(grid.fault(str(error), cell, kind=error.kind))
        return None
    if unit.power:
        faults.append(
            grid.fault(
                f'the unit "{text}" has a power of ten; write another unit, as MN*m/rad', cell, kind="wrong-unit"
            )
        )
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


# Entries of an element that come from a row of a catalogue, and the faults of those that cannot be taken.

PACKAGE = Path(__file__).resolve().parents[2]
"""Folder of the package ``torsionnet``, from which its library of catalogues is found."""


def shipped_catalogues() -> dict[str, Path]:
    """Path of every catalogue that comes with the package, by name.

    >>> "example_couplings" in shipped_catalogues()
    True
    """
    installed = PACKAGE / "library"
    folder = installed if installed.is_dir() else PACKAGE.parent / "library"
    return {path.stem: path for path in sorted((folder / "catalogues").glob("*.csv"))}


def chosen_row(entries: Mapping[str, Any]) -> tuple[CatalogueRow | None, list[Fault]]:
    """Catalogue row that an element's ``catalogue`` and ``size`` name, None where they name none, and faults."""
    file, size = entries.get(CATALOGUE), entries.get(SIZE)
    if isinstance(file, CatalogueRow):
        return file, []
    if file is None:
        lone = Fault(
            "a size is looked up in a catalogue; add catalogue: couplings.csv",
            (SIZE,),
            on_key=True,
            kind="missing-entry",
        )
        return None, [lone] if SIZE in entries else []
    if isinstance(file, Catalogue):
        return chosen_row({**entries, CATALOGUE: file.path})
    if not isinstance(file, str | Path):
        return None, [
            Fault(f"expected the name of a catalogue, as couplings.csv, {got(file)}", (CATALOGUE,), kind="wrong-form")
        ]
    if size is None:
        return None, [
            Fault(
                "a catalogue needs the size that is meant, as size: A350",
                (CATALOGUE,),
                on_key=True,
                kind="missing-entry",
            )
        ]

    try:
        path = file if isinstance(file, Path) else _path(file)
        return catalogue_row(path, path.name if path is file else str(file), str(size)), []
    except EntryError as error:
        return None, [fault.under(CATALOGUE) for fault in error.faults]
    except OSError as error:
        return None, [Fault(f"{file} cannot be read: {error.strerror or error}", (CATALOGUE,), kind="unreadable-file")]
    except ModelError as error:
        told = [] if any(fault.path for fault in error.faults) else [_useless(str(file), len(error.faults))]
        return None, [*told, *error.faults]


def _useless(file: str, count: int) -> Fault:
    return Fault(
        f"{file} cannot be used; {count} fault{'s' if count > 1 else ''} in it", (CATALOGUE,), kind="unreadable-file"
    )


def _path(file: str) -> Path:
    shipped = shipped_catalogues()
    if file in shipped:
        return shipped[file]
    if not Path(file).suffix:
        meant = nearest(file, shipped)
        hint = question(meant) or f"; there are {', '.join(shipped)}"
        text = f'no catalogue that comes with the package is named "{file}"{hint} (a file ends in .csv)'
        raise EntryError(Fault(text, about=file, meant=meant, kind="unknown-name"))
    return nearby_file(file)


def row_entries(
    row: CatalogueRow, specs: Mapping[str, Spec[object]], given: Mapping[str, Any]
) -> tuple[dict[str, Any], list[Fault]]:
    """Entries, by name, that a catalogue row gives and the model does not, and faults.

    ``loss_factor.psi`` is part of an entry.
    """
    entries: dict[str, Any] = {}
    faults: list[Fault] = []
    for cell in row.cells:
        name, _, part = cell.column.partition(".")
        if name not in specs or name in (CATALOGUE, SIZE, "enabled") or name in given:
            continue
        if part:
            entries.setdefault(name, {})[part] = cell.raw
        else:
            entries[name] = cell_value(cell, specs[name], faults)
    return entries, [*([_useless(row.file, len(faults))] if faults else []), *faults]


def entries_of_other_size(
    row: CatalogueRow, size: str, specs: Mapping[str, Spec[object]], stored: Mapping[str, Any]
) -> tuple[dict[str, Any], list[Fault]]:
    """Entries of an element that change with another size of its catalogue.

    The row itself, and entries that still have the values of the old row.
    """
    try:
        new = catalogue_row(row.path, row.file, size)
    except ModelError as error:
        return {}, list(error.faults)
    before, _ = row_entries(row, specs, {})
    after, faults = row_entries(new, specs, {})
    kept = {name for name, raw in before.items() if specs[name].coerce(raw) != stored[name]}
    lacking = [name for name in before if name not in after and name not in kept]
    faults += [
        Fault(f"{row.file} has no {name} of size {size}, but of {row.size}", (SIZE,), kind="empty-entry")
        for name in lacking
    ]
    return {CATALOGUE: new, **{name: raw for name, raw in after.items() if name not in kept}}, faults


def cell_value(cell: CatalogueCell, spec: Spec[object], faults: list[Fault]) -> Any:
    """Value of a catalogue cell as an entry takes it; a value that does not fit is added to ``faults``."""
    dimension = getattr(spec, "dimension", "1")
    if dimension != "1" and cell.is_number and not cell.has_unit:
        example = f"{cell.column} [{expected_unit(dimension)}]"
        text = f'the column "{cell.column}" has no unit; write its heading as {example}, in the unit it has'
        faults.append(Fault(text, position=cell.heading, kind="missing-unit"))
        return None
    raw: Any = cell.raw
    if not hasattr(spec, "dimension"):
        raw = {"true": True, "false": False}.get(raw.casefold(), int(raw) if raw.isdigit() else raw)
    try:
        spec.coerce(raw)
    except EntryError as error:
        faults.append(error.fault.at(cell.place))
    return raw

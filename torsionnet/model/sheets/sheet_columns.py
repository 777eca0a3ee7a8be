"""Recognition of the columns of a mass-elastic sheet and their units; unclear ones are faults at their heading."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher

from torsionnet.core.delimited.cell_grid import Cell, CellGrid
from torsionnet.core.delimited.sheet_numbers import is_like_number
from torsionnet.core.delimited.sheet_units import SheetUnit, named_unit, sheet_unit
from torsionnet.core.errors import Fault, ModelError
from torsionnet.core.units import DIMENSIONS, UnitError
from torsionnet.model.sheets.meanings import BY_KEY, DAMPING, MEANINGS, Meaning, is_referred, meanings_of, plain_heading

LEAST_SIMILARITY = 0.8
"""Smallest ``difflib`` ratio at which an unknown heading is taken for a misspelt word: a letter or two in a word; a
lower value would take other words for misspelt ones."""
_WORDS = {
    "inertia": "inertia", "moment of inertia": "inertia", "trägheitsmoment": "inertia", "drehmasse": "inertia",
    "stiffness": "stiffness", "torsional stiffness": "stiffness", "drehsteifigkeit": "stiffness",
    "compliance": "stiffness", "elasticity": "stiffness", "nachgiebigkeit": "stiffness", "outer diameter": "outer",
    "inner diameter": "inner", "aussendurchmesser": "outer", "innendurchmesser": "inner", "length": "length",
    "absolute damping": "absolute", "relative damping": "relative", "loss factor": "eta", "speed ratio": "ratio",
    "drehzahlverhältnis": "ratio",
}  # fmt: skip
"""Meaning of each word for which an unknown heading may be a misspelling, by word."""
_NO_UNIT = {"", "-", "–", "—", "1", "[-]", "(-)"}


@dataclass(frozen=True)
class SheetColumn:
    """Column of a mass-elastic sheet with its heading, meaning and unit."""

    place: int
    cell: Cell
    meaning: str
    unit: SheetUnit | None
    unit_text: str
    referred: bool | None
    remark: str = ""

    @property
    def heading(self) -> str:
        return self.cell.text


@dataclass(frozen=True)
class SheetColumns:
    """Columns of a mass-elastic sheet in their order, and the rows of cells below."""

    all: tuple[SheetColumn, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def of(self, key: str) -> SheetColumn | None:
        """Column of the sheet that has this meaning, None where there is none."""
        return next((column for column in self.all if column.meaning == key), None)

    def cell(self, row: Sequence[Cell], key: str) -> Cell | None:
        """Cell of a row in the column that has this meaning, None where there is none or it is empty."""
        column = self.of(key)
        if column is None or column.place >= len(row) or not row[column.place].text:
            return None
        return row[column.place]


def read_columns(grid: CellGrid) -> SheetColumns:
    """Columns of a sheet with the meaning and unit that their headings give.

    Raises
    ------
    ModelError
        No inertia, two columns for one thing, units that are missing or wrong, each at its heading.
    """
    first = next((at for at, row in enumerate(grid.rows) if any(map(is_inertia_heading, row))), None)
    if first is None:
        raise ModelError([_no_inertia(grid)], grid.file)
    above = [grid.rows[first]]
    for row in grid.rows[first + 1 :]:
        if any(is_like_number(cell.text) for cell in row):
            break
        above.append(row)
    rows = grid.rows[first + len(above) :]
    faults: list[Fault] = []
    columns = []
    for place, cell in enumerate(above[0]):
        below = [row[place] for row in rows if place < len(row) and row[place].text]
        more = [row[place].text for row in above[1:] if place < len(row)]
        columns.append(_column(place, cell, more, below, faults, grid))
    columns = _without_doubles(columns, faults, grid)
    faults += [fault for column in columns for fault in _misspelt(column, columns, grid)]
    if not faults and all(column.meaning != "inertia" for column in columns):
        faults.append(_no_inertia(grid))
    if faults:
        raise ModelError(faults, grid.file)
    return SheetColumns(tuple(column for column in columns if column.heading or column.meaning), rows)


def is_inertia_heading(cell: Cell) -> bool:
    """Whether a cell is the heading of a column of inertias, by its words or by its unit."""
    name, unit = named_unit(cell.text)
    if is_like_number(cell.text):
        return False
    by_words = [meaning.key for meaning in meanings_of(name)[:1]] == ["inertia"]
    return by_words or (_readable(unit) is not None and _by_unit(unit) == "inertia")


def _no_inertia(grid: CellGrid) -> Fault:
    text = "no column of inertias; write its heading as J [kg*m^2] or inertia (kg m²)"
    return grid.fault(text, next(cell for row in grid.rows for cell in row if cell.text))


def _readable(text: str) -> SheetUnit | None:
    try:
        return sheet_unit(text)
    except UnitError:
        return None


def _by_unit(text: str) -> str:
    """Meaning of a sheet's column by its unit alone: those of inertia and stiffness are used for nothing else."""
    unit = _readable(text)
    if unit is None:
        return ""
    if unit.dimension == DIMENSIONS["inertia"]:
        return "inertia"
    # A torque has the dimension of a stiffness.
    if "rad" in text and unit.dimension in (DIMENSIONS["stiffness"], DIMENSIONS["compliance"]):
        return "stiffness"
    return DAMPING if "rad" in text and unit.dimension == DIMENSIONS["damping"] else ""


def _column(
    place: int, cell: Cell, more: Sequence[str], below: Sequence[Cell], faults: list[Fault], grid: CellGrid
) -> SheetColumn:
    name, unit_text = named_unit(cell.text)
    if not unit_text:
        unit_text = next((text.strip("[]() ") for text in more if _readable(text.strip("[]() ")) is not None), "")
    unit_text = "" if unit_text in _NO_UNIT else unit_text
    if not unit_text and re.search(r"\brpm\b|\br/min\b", cell.text, re.IGNORECASE):
        unit_text = "rpm"
    disc = "gd2" in plain_heading(name).replace(" ", "").replace("²", "2") or "schwungmoment" in name.casefold()
    if unit_text and disc and "GD" not in unit_text:
        unit_text += " GD2"
    unit = _readable(unit_text) if unit_text else None
    known = meanings_of(name) or next(filter(None, map(meanings_of, filter(None, more))), [])
    words = "" if unit_text else _text_or_not(known, below)
    blank = SheetColumn(place, cell, "", unit, unit_text, is_referred(cell.text))
    if not cell.text and not any(more):
        return blank
    if unit_text and unit is None:
        if known and known[0].needs_unit:
            faults.append(grid.fault(_bad_unit(unit_text, known[0]), cell))
        return blank
    dimension = unit.dimension if unit else None
    fitting = [one for one in known if one.fits(dimension)] if not words else [BY_KEY[words]]
    if not fitting and _by_unit(unit_text):
        return replace(blank, meaning=_by_unit(unit_text), remark="told by its unit")
    if not fitting:
        if known and known[0].needs_unit and known[0].key in ("inertia", "stiffness", "absolute", "relative"):
            faults.append(grid.fault(_bad_unit(unit_text, known[0]), cell))
        return blank
    meaning = _preferred(fitting, unit)
    faults += [grid.fault(text, cell) for text in _doubts(meaning, cell.text, unit_text, below)]
    return replace(blank, meaning=meaning.key)


def _preferred(fitting: Sequence[Meaning], unit: SheetUnit | None) -> Meaning:
    """Meaning chosen of several that a heading may have.

    Relative damping is psi where it has no unit, and viscous where it has one.
    """
    if unit is None or unit.dimension == DIMENSIONS["1"]:
        return next((one for one in fitting if one.key == "psi"), fitting[0])
    return fitting[0]


def _text_or_not(known: Sequence[Meaning], below: Sequence[Cell]) -> str:
    """Meaning "name" or "number" of a sheet's column where the words of its heading leave it open.

    ``Drehmasse`` and ``Mass`` head both.
    """
    keys = [meaning.key for meaning in known]
    numbers = sum(is_like_number(cell.text) for cell in below)
    if not {"name", "number"} & set(keys) or not below:
        return ""
    if 2 * numbers < len(below):
        return "name"
    whole = all(cell.text.isdigit() for cell in below)
    return "number" if whole and keys[0] in ("name", "number") else ""


def _bad_unit(text: str, meaning: Meaning) -> str:
    try:
        sheet_unit(text)
        said = f'"{text}" is not a unit of {meaning.dimensions[0]}'
    except UnitError as error:
        said = str(error)
    return f"{said}; write the heading as {meaning.example}"


def _doubts(meaning: Meaning, heading: str, unit_text: str, below: Sequence[Cell]) -> Iterator[str]:
    """Messages why a sheet's column cannot be used although its words are known."""
    if meaning.key == "gear ratio":
        yield (
            f'"{heading}" may be the speed of this mass over that of the first, or the reverse; '
            "call it speed ratio: speed of the mass over speed of the crank"
        )
    elif meaning.key == "psi" and unit_text == "%":
        yield f'"{heading}" may be psi or a share of critical damping; call it psi [%] or zeta [%]'
    elif meaning.needs_unit and not unit_text and any(is_like_number(cell.text) for cell in below):
        bracketed = re.search(r"[\[(]([^\[\]()]*[A-Za-z][^\[\]()]*)[\])]", heading)
        if bracketed and is_referred(bracketed[1]) is None:
            yield _bad_unit(bracketed[1], meaning)
        else:
            yield f'the column "{heading}" has no unit; write its heading as {meaning.example}, in the unit it has'


def _without_doubles(columns: Sequence[SheetColumn], faults: list[Fault], grid: CellGrid) -> list[SheetColumn]:
    """Columns of a sheet of which no two have the same meaning.

    Real values are preferred to referred ones, other doubles are faults.
    """
    kept = list(columns)
    for meaning in MEANINGS:
        same = [column for column in kept if column.meaning == meaning.key]
        real = [column for column in same if not column.referred]
        if len(same) < 2:
            continue
        if len(real) == 1:
            referred = {column.place for column in same if column.referred}
            kept = [replace(one, meaning="", remark="referred; the real values are used") if one.place in referred
                    else one for one in kept]  # fmt: skip
            continue
        if meaning.is_text and meaning.key in ("name", "number"):
            places = {column.place for column in same[1:]}
            kept = [replace(one, meaning="", remark="the first of these is used") if one.place in places else one
                    for one in kept]  # fmt: skip
            continue
        text = f'"{same[0].heading}" and "{same[1].heading}" both mean {meaning.shown}'
        faults.append(grid.fault(f"{text}; leave one, or call the other something else", same[1].cell))
    return kept


def _misspelt(column: SheetColumn, columns: Sequence[SheetColumn], grid: CellGrid) -> Iterator[Fault]:
    """Fault of a column's heading that is not understood, but nearly a word for a column that the sheet lacks."""
    if column.meaning or not column.heading or column.remark:
        return
    plain = plain_heading(named_unit(column.heading)[0])
    near = [word for word in _WORDS if SequenceMatcher(None, plain, word).ratio() >= LEAST_SIMILARITY]
    if near and _WORDS[near[0]] not in {one.meaning for one in columns}:
        yield grid.fault(f'"{column.heading}" is no heading of a mass-elastic sheet; did you mean "{near[0]}"?',
                         column.cell)  # fmt: skip

"""Recognition of the columns of a mass-elastic sheet and their units; unclear ones are faults at their heading."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher

from torsionnet.base.delimited.cell_grid import Cell, CellGrid, is_like_number
from torsionnet.base.delimited.sheet_headings import (
    MOST_CHARACTERS,
    NO_UNIT,
    HeadingFactor,
    SheetHeading,
    SheetUnit,
    read_heading,
    sheet_unit,
)
from torsionnet.base.errors import Fault, ModelError, comma_list
from torsionnet.base.units import DIMENSIONS, UnitError
from torsionnet.model.sheets.meanings import (
    BY_KEY,
    DAMPING,
    MEANINGS,
    Meaning,
    heading_side,
    is_limit,
    meanings_of,
    unknown_words,
)

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
_MEASURED = re.compile(r"[+\-−]?[\d.,]*\d(?:\s|$)")
"""Expression of a cell that begins with a number, with or without a unit behind it."""
_INERTIA_SYMBOLS = {"j", "i", "θ", "theta"}


@dataclass(frozen=True)
class SheetColumn:
    """Column of a mass-elastic sheet with its heading, meaning and unit.

    ``factor`` is what its heading multiplies by, ``reading`` whether it was taken to multiply the quantity (``values``)
    or its unit (``unit``), by which ``unit`` is scaled already; empty as long as that is open.
    """

    place: int
    cell: Cell
    meaning: str
    unit: SheetUnit | None
    unit_text: str
    referred: bool | None
    remark: str = ""
    factor: HeadingFactor | None = None
    reading: str = ""

    @property
    def heading(self) -> str:
        return self.cell.text

    def read_as(self, reading: str) -> SheetColumn:
        """Column whose factor multiplies the quantity (``values``) or its unit (``unit``)."""
        if self.factor is None or self.unit is None:
            return self
        return replace(self, reading=reading, unit=self.unit.times(self.factor.scale(reading)))


@dataclass(frozen=True)
class SheetColumns:
    """Columns of a mass-elastic sheet in their order, the rows of cells below, and those above the headings."""

    all: tuple[SheetColumn, ...]
    rows: tuple[tuple[Cell, ...], ...]
    above: tuple[tuple[Cell, ...], ...] = ()

    def of(self, key: str) -> SheetColumn | None:
        """Column of the sheet that has this meaning, None where there is none."""
        return next((column for column in self.all if column.meaning == key), None)

    def cell(self, row: Sequence[Cell], key: str) -> Cell | None:
        """Cell of a row in the column that has this meaning, None where there is none or it is empty."""
        column = self.of(key)
        if column is None or column.place >= len(row) or not row[column.place].text:
            return None
        return row[column.place]

    def read_as(self, readings: Mapping[int, str]) -> SheetColumns:
        """Columns with the readings, by place, of the factors in their headings."""
        read = (column.read_as(readings[column.place]) if column.place in readings else column for column in self.all)
        return replace(self, all=tuple(read))


def read_columns(grid: CellGrid) -> SheetColumns:
    """Columns of a sheet with the meaning and unit that their headings give.

    Raises
    ------
    ModelError
        No inertia, two columns for one thing, words that are not understood, units that are missing or wrong, each at
        its heading.
    """
    begin, end = _heading_rows(grid)
    heads, rows = grid.rows[begin:end], grid.rows[end:]
    faults: list[Fault] = []
    columns = []
    for place in range(max(map(len, (*heads, *rows)))):
        below = [row[place] for row in rows if place < len(row) and row[place].text]
        texts = [row[place] for row in heads if place < len(row) and row[place].text]
        if texts:
            columns.append(_column(place, texts, below, faults, grid))
            continue
        # A first column without heading numbers the rows.
        faults += [grid.fault(f'"{cell.text}" stands below no heading; give its column one', cell,
                              kind="missing-column")
                   for cell in below if place and is_like_number(cell.text)]  # fmt: skip
        remark = "has no heading and is left out" if below else ""
        columns.append(SheetColumn(place, Cell("", heads[0][0].line, 1), "", None, "", None, remark))
    columns = _without_doubles(columns, faults, grid)
    faults += [fault for column in columns for fault in _misspelt(column, columns, grid)]
    if not faults and all(column.meaning != "inertia" for column in columns):
        faults.append(_no_inertia(grid))
    if faults:
        raise ModelError(faults, grid.file)
    return SheetColumns(tuple(column for column in columns if column.heading or column.remark), rows, grid.rows[:begin])


def _heading_rows(grid: CellGrid) -> tuple[int, int]:
    """Places of the first row of headings and of the first row below them.

    The row with that of the inertia, one above it with headings of other quantities, and those below without numbers.
    """
    several = [at for at, row in enumerate(grid.rows) if sum(bool(cell.text) for cell in row) > 1]
    first = next((at for at, row in enumerate(grid.rows) if any(map(is_inertia_heading, row))), None)
    if first is None:
        first = next((at for at in several if any(_may_be_inertia(cell) for cell in grid.rows[at])), None)
    if first is None:
        raise ModelError([_no_inertia(grid)], grid.file)
    end = first + 1
    while end < len(grid.rows) and _heads(grid.rows[end]):
        end += 1
    begin = first - 1 if first and any(_is_quantity(cell) for cell in grid.rows[first - 1][1:]) else first
    return begin, end


def _heads(row: Sequence[Cell]) -> bool:
    """Whether a row has no numbers; the 1 of a row of units is none."""
    numbers = {cell.text for cell in row if is_like_number(cell.text)}
    units = (cell.text for cell in row if not _MEASURED.match(cell.text))
    return not numbers or (numbers <= NO_UNIT and any(read_heading(f"[{text}]").unit for text in units))


def is_inertia_heading(cell: Cell) -> bool:
    """Whether a cell is the heading of a column of inertias, by its words or by its unit."""
    if not cell.text or is_like_number(cell.text):
        return False
    heading = read_heading(cell.text)
    by_words = [meaning.key for meaning in meanings_of(_words(heading))[:1]] == ["inertia"]
    return by_words or _by_unit(heading.unit_text, heading.unit) == "inertia"


def _may_be_inertia(cell: Cell) -> bool:
    return [meaning.key for meaning in meanings_of(_words(read_heading(cell.text)), loosely=True)[:1]] == ["inertia"]


def _is_quantity(cell: Cell) -> bool:
    """Whether a cell is the heading of a column of values, by its words or its unit."""
    heading = read_heading(cell.text)
    known = meanings_of(_words(heading))
    return bool(known and not known[0].is_text) or bool(_by_unit(heading.unit_text, heading.unit))


def _words(heading: SheetHeading) -> str:
    return f"{heading.words} gd2" if heading.disc else heading.words


def _no_inertia(grid: CellGrid) -> Fault:
    text = "no column of inertias; write its heading as J [kg*m^2] or inertia (kg m²)"
    return grid.fault(text, next(cell for row in grid.rows for cell in row if cell.text), kind="missing-column")


def _readable(text: str) -> SheetUnit | None:
    try:
        return sheet_unit(text)
    except UnitError:
        return None


def _by_unit(text: str, unit: SheetUnit | None) -> str:
    """Meaning of a sheet's column by its unit alone: those of inertia and stiffness are used for nothing else."""
    if unit is None:
        return ""
    if unit.dimension == DIMENSIONS["inertia"]:
        return "inertia"
    # A torque has the dimension of a stiffness.
    if "rad" in text and unit.dimension in (DIMENSIONS["stiffness"], DIMENSIONS["compliance"]):
        return "stiffness"
    return DAMPING if "rad" in text and unit.dimension == DIMENSIONS["damping"] else ""


def _joined(texts: Sequence[Cell]) -> str:
    """Heading in several rows as one text, a unit or a factor in a row of its own in brackets."""
    first, *more = (cell.text for cell in texts)
    for text in more:
        alone = read_heading(f"[{text.strip('[]')}]")
        first += f" [{text.strip('[]')}]" if alone.unit or alone.factor or text in NO_UNIT else f" {text}"
    return first


def _column(
    place: int, texts: Sequence[Cell], below: Sequence[Cell], faults: list[Fault], grid: CellGrid
) -> SheetColumn:
    cell, joined = texts[0], _joined(texts)
    if len(joined) > MOST_CHARACTERS and any(is_like_number(cell.text) for cell in below):
        faults.append(
            grid.fault(f"the heading is longer than {MOST_CHARACTERS} characters; shorten it", cell, kind="too-large")
        )
    heading = read_heading(joined)
    words, referred = heading_side(_words(heading))
    unit, unit_text = _unit_of(heading, words)
    if unit is None and unit_text and heading_side(unit_text)[0] == "":
        referred, unit_text = heading_side(unit_text)[1], ""
    blank = SheetColumn(place, cell, "", unit, unit_text, referred, factor=heading.factor)
    known = meanings_of(words)
    named = "" if unit_text else _text_or_not(known, below)
    dimension = unit.dimension if unit else None
    fitting = [meaning for meaning in known if meaning.fits(dimension)] if not named else [BY_KEY[named]]
    if unit_text and unit is None:
        if known and known[0].needs_unit:
            faults.append(grid.fault(_bad_unit(unit_text, known[0]), cell, kind="wrong-unit"))
        return blank
    by_unit = _by_unit(unit_text, unit)
    likely = known or meanings_of(words, loosely=True) or meanings_of(re.sub(r"\([^()]*\)", " ", heading.words))
    if not fitting and by_unit and not words:
        return replace(blank, meaning=by_unit, remark="told by its unit")
    if not fitting and is_limit(words):
        return replace(blank, remark="a limit, which a model of the shafts does not use")
    if not fitting and (by_unit or (likely and not known and not likely[0].is_text)):
        if any(is_like_number(cell.text) for cell in below):
            meaning = BY_KEY[by_unit] if by_unit else likely[0]
            bracket = None if unit_text else re.search(r"[(]([^()]*[A-Za-z][^()]*[*·/^²³\d][^()]*)[)]", heading.words)
            fault = _not_understood(unknown_words(words, meaning), meaning, texts, grid)
            faults.append(grid.fault(_bad_unit(bracket[1], meaning), cell, kind="wrong-unit") if bracket else fault)
        return blank
    if not fitting:
        if known and known[0].needs_unit and known[0].key in ("inertia", "stiffness", "absolute", "relative"):
            faults.append(grid.fault(_bad_unit(unit_text, known[0]), cell, kind="wrong-unit"))
        return blank
    meaning = _preferred(fitting, unit)
    doubt = "ambiguous-name" if meaning.key == "gear ratio" else "missing-unit"
    doubts = (grid.fault(text, cell, kind=doubt) for text in _doubts(meaning, cell.text, unit_text, below))
    faults += [
        replace(doubt, about=cell.text, meant=meaning.dimensions[0]) for doubt in doubts
    ]  # for who asks for the unit
    if not meaning.is_text:
        faults += [grid.fault(text, cell, kind="ambiguous-name") for text in _unclear(heading, words, meaning)]
    if referred and meaning.fits(DIMENSIONS["length"]):
        text = f'"{cell.text}" is not of the shaft itself; give the stiffness instead, or its real {meaning.shown}'
        faults.append(grid.fault(text, cell, kind="ambiguous-name"))
    return replace(blank, meaning=meaning.key)


def _unit_of(heading: SheetHeading, words: str) -> tuple[SheetUnit | None, str]:
    """Unit of a column, with that of GD2 or WR2 where the heading says so, and its text; None for what is no unit."""
    unit, text = heading.unit, heading.unit_text
    if not text and re.search(r"\brpm\b|\br/min\b", heading.words, re.IGNORECASE):
        text = "rpm"
    is_disc = heading.disc == "GD" or (not heading.disc and "schwungmoment" in words)
    if text and is_disc and "GD" not in text:
        text += " GD2"
    elif heading.disc == "WR" and (unit is None or unit.dimension != DIMENSIONS["inertia"]) and text:
        text += " WR2"
    return (_readable(text) if text else None), text


def _unclear(heading: SheetHeading, words: str, meaning: Meaning) -> Iterator[str]:
    """Messages why the parts of a heading do not fit together."""
    if heading.second:
        yield f'the heading has a second unit or factor, "{heading.second}"; write it as {meaning.example}'
    if heading.factor is not None and not heading.factor.value:
        text = heading.factor.text
        yield f'"{text}" is ambiguous: it may be 1e... or 10 times as much, or a power of ten; write 1e-9 or 10^-9'
    if heading.disc == "GD" and _INERTIA_SYMBOLS & set(words.split()):
        yield f'"{heading.words}" and GD2, four times as much, are both in the heading; leave one, or write GD2/4'
    if heading.factor is not None and heading.unit is None and meaning.needs_unit:
        yield f'the factor "{heading.factor.text}" has no unit beside it; write the heading as {meaning.example}'
    elif heading.factor is not None and not meaning.needs_unit:
        yield f'"{heading.factor.text}" in the heading of {meaning.shown} is not understood; write plain values'


def _not_understood(unknown: Sequence[str], meaning: Meaning, texts: Sequence[Cell], grid: CellGrid) -> Fault:
    """Fault of words in a heading, at the first of them."""
    quoted = [f'"{word}"' for word in unknown]
    said = f"{comma_list(quoted, 4)} in the heading of {meaning.shown} is not understood"
    text = (
        f"{said}; write it as {meaning.example}, or, if it is something else, without words and unit of {meaning.shown}"
    )
    for cell in texts:
        at = cell.text.casefold().find(unknown[0])
        if at >= 0:
            return grid.fault(
                text, Cell(cell.text[at : at + len(unknown[0])], cell.line, cell.column + at), kind="ambiguous-name"
            )
    return grid.fault(text, texts[0], kind="ambiguous-name")


def _preferred(fitting: Sequence[Meaning], unit: SheetUnit | None) -> Meaning:
    """Meaning chosen of several that a heading may have.

    Relative damping is psi where it has no unit, and viscous where it has one.
    """
    if unit is None or unit.dimension == DIMENSIONS["1"]:
        return next((meaning for meaning in fitting if meaning.key == "psi"), fitting[0])
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
        if bracketed and heading_side(bracketed[1])[0]:
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
            kept = [replace(column, meaning="", remark="referred; the real values are used") if column.place in referred
                    else column for column in kept]  # fmt: skip
            continue
        if meaning.is_text and meaning.key in ("name", "number"):
            places = {column.place for column in same[1:]}
            remark = "the first of these is used"
            kept = [replace(column, meaning="", remark=remark) if column.place in places else column for column in kept]
            continue
        text = f'"{same[0].heading}" and "{same[1].heading}" both mean {meaning.shown}'
        faults.append(
            grid.fault(f"{text}; leave one, or call the other something else", same[1].cell, kind="repeated-name")
        )
    return kept


def _misspelt(column: SheetColumn, columns: Sequence[SheetColumn], grid: CellGrid) -> Iterator[Fault]:
    """Fault of a column's heading that is not understood, but nearly a word for a column that the sheet lacks."""
    if column.meaning or not column.heading or column.remark:
        return
    plain = heading_side(read_heading(column.heading).words)[0]
    near = [word for word in _WORDS if SequenceMatcher(None, plain, word).ratio() >= LEAST_SIMILARITY]
    if near and _WORDS[near[0]] not in {other.meaning for other in columns}:
        yield grid.fault(f'"{column.heading}" is no heading of a mass-elastic sheet; did you mean "{near[0]}"?',
                         column.cell, kind="unknown-entry")  # fmt: skip

"""Values in the cells of a mass-elastic sheet: numbers in the unit of their column, scaled where referred."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from torsionnet.base.delimited.cell_grid import Cell, CellGrid, decimal_sign, is_like_number, plain_number_text
from torsionnet.base.delimited.sheet_headings import SheetUnit, sheet_unit
from torsionnet.base.errors import Fault, ModelError
from torsionnet.base.expressions import is_beyond_range
from torsionnet.base.units import DIMENSIONS, Real, UnitError, exact, parse_number
from torsionnet.model.sheets.meanings import BY_KEY
from torsionnet.model.sheets.sheet_columns import SheetColumn, SheetColumns

NOTHING = {"", "-", "–", "—", "--", "n/a", "na", "n.a.", "none", "keine"}
"""Texts that stand for an empty cell of a sheet."""
RIGID = {"rigid", "starr", "inf", "infinite", "∞", "unendlich"}
"""Texts that stand for an infinite stiffness in a sheet."""
_NUMBER_AND_UNIT = re.compile(r"(?P<number>[+\-−]?[\d.,]*\d(?:[eE][+\-]?\d+)?)\s*(?P<unit>[A-Za-zµμ°%].*)")


@dataclass(frozen=True)
class SheetValue:
    """Value of a cell in SI units, and its text for a model file, empty where the value was scaled."""

    si: Real
    text: str = ""
    is_rigid: bool = False

    @property
    def raw(self) -> str | Real:
        """Text or number in SI units with which an element's entry takes the value."""
        return self.text or self.si

    def times(self, factor: Fraction) -> SheetValue:
        """Value of the cell multiplied by a factor."""
        return self if factor == 1 or self.is_rigid else SheetValue(self.si * factor)


@dataclass
class SheetValues:
    """Reader of the values in the cells of a mass-elastic sheet; its faults grow while it reads."""

    grid: CellGrid
    columns: SheetColumns
    faults: list[Fault] = field(default_factory=list)
    decimal: str = "."

    def __post_init__(self) -> None:
        cells = [
            replaced
            for row in self.columns.rows
            for column in self.columns.all
            if column.meaning and not BY_KEY[column.meaning].is_text and column.place < len(row)
            for replaced in [_number_part(row[column.place])]
            if is_like_number(replaced.text)
        ]
        self.decimal, wrong = decimal_sign(cells)
        if wrong:
            raise ModelError([self.grid.fault(wrong[1], wrong[0], kind="ambiguous-number")], self.grid.file)

    def label(self, row: Sequence[Cell]) -> str:
        """Text that names a row, empty where it has neither name nor number."""
        cell = self.columns.cell(row, "name") or self.columns.cell(row, "number")
        return cell.text if cell else ""

    def of(self, row: Sequence[Cell], key: str) -> SheetValue | None:
        """Value, in SI units, of a row in the column that has this meaning; None where there is none."""
        column, cell = self.columns.of(key), self.columns.cell(row, key)
        if column is None or cell is None or cell.text.casefold() in NOTHING:
            return None
        if key == "stiffness" and cell.text.casefold() in RIGID:
            return SheetValue(Fraction(0), is_rigid=True)
        value = self._value(column, cell)
        if value is not None and value.si < 0 and key not in ("ratio", "speed"):
            self.faults.append(
                self.grid.fault(f"{cell.text}: the {BY_KEY[key].shown} must not be negative", cell, kind="out-of-range")
            )
            return None
        return value

    def _value(self, column: SheetColumn, cell: Cell) -> SheetValue | None:
        meaning = BY_KEY[column.meaning]
        split = _NUMBER_AND_UNIT.fullmatch(cell.text)
        quotient = re.fullmatch(r"(\S+?)\s*[/:]\s*(\S+)", cell.text) if column.meaning == "ratio" else None
        if quotient:
            return self._quotient(cell, *quotient.groups())
        number = plain_number_text(cell.text, self.decimal)
        unit = column.unit
        if number is None and split:
            number = plain_number_text(split["number"], self.decimal)
            unit = self._own_unit(column, cell, split["unit"])
            if unit is None:
                return None
        elif unit is None and meaning.needs_unit:
            text = f'"{cell.text}" has no unit, and neither has the heading "{column.heading}"'
            self.faults.append(self.grid.fault(f"{text}; write that as {meaning.example}", cell, kind="missing-unit"))
            return None
        if number is None:
            text = f'"{cell.text}" is not a number; the column "{column.heading}" was taken as {meaning.shown}'
            self.faults.append(self.grid.fault(text, cell, kind="not-a-number"))
            return None
        try:
            return self._possible(_in_unit(number, unit), cell)
        except (UnitError, OverflowError) as error:
            self.faults.append(self.grid.fault(str(error), cell, kind="not-finite"))
            return None

    def _possible(self, value: SheetValue, cell: Cell) -> SheetValue | None:
        if not is_beyond_range(value.si):
            return value
        text = f"{cell.text} is far outside the sizes of drivetrains; check its unit"
        self.faults.append(self.grid.fault(text, cell, kind="implausible-size"))
        return None

    def _quotient(self, cell: Cell, above: str, below: str) -> SheetValue | None:
        """Ratio of speeds from a cell that is written as 1/4 or 1:4."""
        parts = [plain_number_text(text, self.decimal) for text in (above, below)]
        try:
            numbers = [parse_number(part or "") for part in parts]
        except UnitError:
            numbers = []
        if not numbers or not numbers[1]:
            self.faults.append(self.grid.fault(f'"{cell.text}" is not a number', cell, kind="not-a-number"))
            return None
        return self._possible(SheetValue(numbers[0] / numbers[1]), cell)

    def _own_unit(self, column: SheetColumn, cell: Cell, text: str) -> SheetUnit | None:
        """Unit in a cell of the sheet, which has to be that of the heading where the heading has one."""
        meaning = BY_KEY[column.meaning]
        try:
            unit = sheet_unit(text)
        except UnitError as error:
            self.faults.append(self.grid.fault(f'"{cell.text}" is not a number: {error}', cell, kind="not-a-number"))
            return None
        if not meaning.fits(unit.dimension):
            said = f'"{text}" is not a unit of {meaning.dimensions[0]}; write one, as in {meaning.example}'
            self.faults.append(self.grid.fault(said, cell, kind="wrong-unit"))
            return None
        if column.unit is not None and (unit.factor, unit.dimension) != (column.unit.factor, column.unit.dimension):
            said = f'"{cell.text}" is in another unit than its heading says ("{column.unit_text}")'
            self.faults.append(
                self.grid.fault(f"{said}; write all cells of a column in one unit", cell, kind="wrong-unit")
            )
            return None
        return unit


def _in_unit(number: str, unit: SheetUnit | None) -> SheetValue:
    """Value in SI units of a number with its unit in a sheet.

    A compliance becomes a stiffness, and rigid where it is 0.
    """
    value = parse_number(number)
    if unit is None or unit.dimension == DIMENSIONS["1"]:
        return SheetValue(exact(value * (unit.factor if unit else 1)))
    si: Real = value * unit.factor if isinstance(unit.factor, Fraction) else float(value) * unit.factor
    if unit.dimension == DIMENSIONS["compliance"]:
        if not si:
            return SheetValue(Fraction(0), is_rigid=True)
        si = 1 / si
    # Beyond the range of numbers, or nothing left of it: as a model file is refused.
    if value:
        exact(si)
    if not unit.text or (unit.power and "e" in number.casefold()):
        return SheetValue(si)
    return SheetValue(si, f"{number}{f'e{unit.power}' if unit.power else ''} {unit.text}")


def _number_part(cell: Cell) -> Cell:
    split = _NUMBER_AND_UNIT.fullmatch(cell.text)
    return Cell(split["number"], cell.line, cell.column) if split else cell

"""Mass-elastic sheet as it was read, with inertias, shafts and how each column was understood."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.base.delimited.cell_grid import CellGrid, read_grid
from torsionnet.base.errors import ModelError
from torsionnet.base.units import DIMENSIONS, numeral_of
from torsionnet.model.sheets.factor_readings import FactorDecision, decide_factors, factor_text
from torsionnet.model.sheets.meanings import BY_KEY
from torsionnet.model.sheets.sheet_columns import SheetColumn, SheetColumns, read_columns
from torsionnet.model.sheets.sheet_remarks import SheetRemark, decide_side
from torsionnet.model.sheets.sheet_rows import SheetLink, SheetMass, SheetRows, read_rows
from torsionnet.model.sheets.sheet_values import SheetValues

if TYPE_CHECKING:
    from torsionnet.base.table import Table


@dataclass(frozen=True)
class SheetReading:
    """Choices of a user where a sheet leaves open how it is meant.

    ``values`` are ``real`` or ``referred``; ``factors`` of headings multiply the ``unit`` or the ``values`` of the
    quantity. Empty where the sheet decides.
    """

    values: str = ""
    factors: str = ""


@dataclass(frozen=True)
class SheetGear:
    """Gear that a sheet does not name: it was put where the speed changes from one mass to the next.

    ``ratio`` is the speed of the first mass over that of the second; ``link`` the name of the connection, ``has_shaft``
    whether a shaft of the first speed leads to the gear.
    """

    link: str
    first: str
    second: str
    ratio: Fraction
    has_shaft: bool


@dataclass(frozen=True, eq=False)
class MassElasticSheet:
    """Masses and shafts of a mass-elastic sheet, and how its columns were read.

    Attributes
    ----------
    file : str
        Its name.
    masses, links : tuple
        In the order of the rows; real values in SI.
    columns : tuple of SheetColumn
        Every column, understood or not.
    referred : bool
        Whether the values of the file are referred to one speed; those here are real.
    notes : tuple of str
        What was assumed or left out.
    factors : FactorDecision
        How factors in headings were read, and the lowest vibrations that decided it.
    gears : tuple of SheetGear
        Gears that were put where the speed changes.
    remarks : tuple of SheetRemark
        Texts beside the table.
    reading : SheetReading
        What the user said of the sheet.
    """

    file: str
    masses: tuple[SheetMass, ...]
    links: tuple[SheetLink, ...]
    columns: tuple[SheetColumn, ...]
    referred: bool
    notes: tuple[str, ...]
    factors: FactorDecision
    gears: tuple[SheetGear, ...] = ()
    remarks: tuple[SheetRemark, ...] = ()
    reading: SheetReading = SheetReading()

    def report(self) -> Table:
        """Table of how each column of the sheet was read, its heading, meaning and unit."""
        from torsionnet.base.table import Column, Table  # loads numpy, which reading a model can do without

        rows = tuple((column.heading, _taken(column), _unit(column), column.remark) for column in self.columns)
        headings = ("column", "taken as", "unit", "remark")
        count = f"{len(self.masses)} masses, {len(self.links)} shafts and connections"
        return Table(f"{self.file}: {count}", tuple(map(Column, headings)), rows, self.notes)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MassElasticSheet):
            return NotImplemented
        return (self.file, self.reading, self.masses, self.links) == (
            other.file,
            other.reading,
            other.masses,
            other.links,
        )

    def __hash__(self) -> int:
        return hash((self.file, self.reading, self.masses, self.links))


def _taken(column: SheetColumn) -> str:
    if column.meaning == "stiffness" and column.unit and column.unit.dimension == DIMENSIONS["compliance"]:
        return "compliance"
    return BY_KEY[column.meaning].shown if column.meaning else "not understood" if not column.remark else "not used"


def _unit(column: SheetColumn) -> str:
    if not column.meaning or BY_KEY[column.meaning].is_text:
        return ""
    if column.factor and column.reading and column.unit_text:
        return f"{factor_text(column.factor.scale(column.reading))} {column.unit_text}"
    return column.unit_text or ("in the cells" if BY_KEY[column.meaning].needs_unit else "1")


def read_sheet(path: Path, name: str = "", reading: SheetReading = SheetReading()) -> MassElasticSheet:
    """Mass-elastic sheet read from a file.

    CSV, or text saved by a spreadsheet program; ``name`` is shown instead of the path's.

    Raises
    ------
    ModelError
        With the row and column of every fault found.
    """
    return replace(parse_sheet(read_grid(path), reading), file=name or path.name)


def parse_sheet(grid: CellGrid, reading: SheetReading = SheetReading()) -> MassElasticSheet:
    """Mass-elastic sheet made from cells that are already read.

    >>> from torsionnet.base.delimited.cell_grid import parse_grid
    >>> grid = parse_grid(["Masse;J [kgm²];k [MNm/rad]", "Zyl. 1;0,45;2,1", "Schwungrad;14;"], "sheet.csv")
    >>> sheet = parse_sheet(grid)
    >>> [mass.name for mass in sheet.masses], float(sheet.links[0].stiffness.si)
    (['Zyl_1', 'Schwungrad'], 2100000.0)
    """
    columns = read_columns(grid)
    values = SheetValues(grid, columns)
    rows = read_rows(values)
    if values.faults:
        raise ModelError(values.faults, grid.file)
    sides = decide_side(columns, rows, grid, reading.values)

    def rows_of(readings: SheetColumns) -> SheetRows:
        scaled = SheetValues(grid, readings)
        found = read_rows(scaled)
        if scaled.faults:
            raise ModelError(scaled.faults, grid.file)
        return found

    power = 0 if sides.referred else 2
    factors = decide_factors(columns, grid, lambda readings: rows_of(readings).scaled(power), reading.factors)
    faults = [*sides.faults, *factors.faults]
    if faults:
        raise ModelError(faults, grid.file)
    real = rows_of(factors.columns).scaled(-2 if sides.referred else 0)
    gears = tuple(_gears(real))
    notes = [f"decimal {'comma' if values.decimal == ',' else 'point'}", *factors.notes(), *sides.notes(rows.ratios)]
    notes += [f'row {row[0].line}, "{values.label(row)}", is left out' for row in rows.totals]
    notes += map(_gear_note, gears)
    notes += [f'"{one.heading or f"column {one.place + 1}"}" {one.remark or "was not understood and is left out"}'
              for one in columns.all if not one.meaning and (not one.remark or not one.heading)]  # fmt: skip
    return MassElasticSheet(
        grid.file, real.masses, real.links, factors.columns.all, sides.referred, tuple(notes), factors, gears,
        sides.remarks, reading,
    )  # fmt: skip


def _gears(rows: SheetRows) -> Iterator[SheetGear]:
    ratios = rows.ratios
    for link in rows.links:
        ratio = ratios[link.first] / ratios.get(link.second, ratios[link.first])
        if ratio != 1:
            has_shaft = link.stiffness is not None or link.length is not None
            yield SheetGear(link.name, link.first, link.second, ratio, has_shaft)


def _gear_note(gear: SheetGear) -> str:
    where = (
        "at the end of the shaft, whose values are at the speed of the first" if gear.has_shaft else "without a shaft"
    )
    return f"between {gear.first} and {gear.second} a gear of ratio {numeral_of(gear.ratio)} was put, {where}"

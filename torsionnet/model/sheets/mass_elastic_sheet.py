"""Mass-elastic sheet as it was read, with inertias, shafts and how each column was understood."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.core.delimited.cell_grid import CellGrid, read_grid
from torsionnet.core.errors import ModelError
from torsionnet.core.units import DIMENSIONS
from torsionnet.model.sheets.meanings import BY_KEY, is_referred
from torsionnet.model.sheets.sheet_columns import SheetColumn, SheetColumns, read_columns
from torsionnet.model.sheets.sheet_rows import SheetLink, SheetMass, read_rows
from torsionnet.model.sheets.sheet_values import SheetValues

if TYPE_CHECKING:
    from torsionnet.response.table import Table


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
    """

    file: str
    masses: tuple[SheetMass, ...]
    links: tuple[SheetLink, ...]
    columns: tuple[SheetColumn, ...]
    referred: bool
    notes: tuple[str, ...]

    def report(self) -> Table:
        """Table of how each column of the sheet was read, its heading, meaning and unit."""
        from torsionnet.response.table import Column, Table  # loads numpy, which reading a model can do without

        rows = tuple((column.heading, _taken(column), _unit(column), column.remark) for column in self.columns)
        headings = ("column", "taken as", "unit", "remark")
        count = f"{len(self.masses)} masses, {len(self.links)} shafts and connections"
        return Table(f"{self.file}: {count}", tuple(map(Column, headings)), rows, self.notes)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MassElasticSheet):
            return NotImplemented
        return (self.file, self.masses, self.links) == (other.file, other.masses, other.links)

    def __hash__(self) -> int:
        return hash((self.file, self.masses, self.links))


def _taken(column: SheetColumn) -> str:
    if column.meaning == "stiffness" and column.unit and column.unit.dimension == DIMENSIONS["compliance"]:
        return "compliance"
    return BY_KEY[column.meaning].shown if column.meaning else "not understood" if not column.remark else "not used"


def _unit(column: SheetColumn) -> str:
    if not column.meaning or BY_KEY[column.meaning].is_text:
        return ""
    return column.unit_text or ("in the cells" if BY_KEY[column.meaning].needs_unit else "1")


def read_sheet(path: Path, name: str = "") -> MassElasticSheet:
    """Mass-elastic sheet read from a file.

    CSV, or text saved by a spreadsheet program; ``name`` is shown instead of the path's.

    Raises
    ------
    ModelError
        With the row and column of every fault found.
    """
    return replace(parse_sheet(read_grid(path)), file=name or path.name)


def parse_sheet(grid: CellGrid) -> MassElasticSheet:
    """Mass-elastic sheet made from cells that are already read.

    >>> from torsionnet.core.delimited.cell_grid import parse_grid
    >>> grid = parse_grid(["Masse;J [kgm²];k [MNm/rad]", "Zyl. 1;0,45;2,1", "Schwungrad;14;"], "sheet.csv")
    >>> sheet = parse_sheet(grid)
    >>> [mass.name for mass in sheet.masses], float(sheet.links[0].stiffness.si)
    (['Zyl_1', 'Schwungrad'], 2100000.0)
    """
    columns = read_columns(grid)
    values = SheetValues(grid, columns)
    first = columns.rows[0][0].line if columns.rows else 0
    referred, said = _referred(columns, grid, first)
    masses, links, notes = read_rows(values, referred=referred)
    if values.faults:
        raise ModelError(values.faults, grid.file)
    unclear = [f'"{one.heading}" was not understood and is left out' for one in columns.all if one.heading
               and not one.meaning and not one.remark]  # fmt: skip
    decimal = f"decimal {'comma' if values.decimal == ',' else 'point'}"
    notes = [decimal, *_speeds(masses, referred, said), *notes, *unclear]
    return MassElasticSheet(grid.file, tuple(masses), tuple(links), columns.all, referred, tuple(notes))


def _referred(columns: SheetColumns, grid: CellGrid, first: int) -> tuple[bool, bool]:
    """Whether values of the sheet are referred to one speed, and whether the sheet says so.

    In headings, remarks, or the lines above.
    """
    used = [column.referred for column in columns.all if column.meaning in ("inertia", "stiffness")]
    above = [cell.text for row in grid.rows for cell in row if cell.line < first]
    texts = [*grid.remarks, *(text for text in above if text not in {one.heading for one in columns.all})]
    said = [*(one for one in used if one is not None), *filter(lambda one: one is not None, map(is_referred, texts))]
    return bool(said and said[0]), bool(said)


def _speeds(masses: Iterable[SheetMass], referred: bool, said: bool) -> list[str]:
    """Notes on what several speeds of a sheet's masses mean for its values."""
    if len({abs(mass.ratio) for mass in masses} | {Fraction(1)}) == 1:
        return []
    if referred:
        return ["values are referred to the speed of ratio 1, says the sheet; they were made real by the speed ratio"]
    return ["values are real" if said else "whether values are referred is not said; they were taken as real"]

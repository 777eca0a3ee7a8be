"""Texts beside the table of a mass-elastic sheet, and whether its values are referred to one speed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from torsionnet.base.delimited.cell_grid import Cell, CellGrid
from torsionnet.base.delimited.sheet_headings import has_power
from torsionnet.base.delimited.sheet_numbers import is_like_number
from torsionnet.base.errors import Fault
from torsionnet.base.plain_names import plain_name
from torsionnet.model.sheets.referral_words import referral_target, remark_side
from torsionnet.model.sheets.sheet_columns import SheetColumns
from torsionnet.model.sheets.sheet_rows import SheetMass, SheetRows

SIDES = ("real", "referred")
"""Values of a sheet: each at the speed of its mass, or all referred to one speed."""
_OF_VALUES = re.compile(
    r"\b(?:values?|all|inertias?|moments?|\w*stiff\w*|elasticit\w*|flexibilit\w*|complian\w*|[jikce]|times|multipl\w*|divided"
    r"|werte?|\w*trägheit\w*|drehmasse\w*|\w*steifigkeit\w*|nachgiebigkeit\w*)\b", re.IGNORECASE)  # fmt: skip
_DISC = re.compile(r"(?<![^\W_])(?:[GP]\s?D)\s?\^?\s?[2²]", re.IGNORECASE)
_SPEED_WORDS = {"speed", "drehzahl", "shaft", "welle", "side", "rpm", "ratio", "one", "common", "main", "of", "the"}
_UNKNOWN_SIDE = (
    "may say that values are referred to one speed, or something else; say which: all values are real, or values are "
    "referred to the crank; or choose by the option values, real or referred"
)


@dataclass(frozen=True)
class SheetRemark:
    """Text of a sheet beside its table, and what was taken from it: ``referred``, ``real`` or nothing."""

    text: str
    line: int
    taken: str = ""


@dataclass(frozen=True)
class SideDecision:
    """Whether values of a sheet are referred to one speed, whether it says so, its remarks, and what stays open."""

    referred: bool
    is_said: bool
    remarks: tuple[SheetRemark, ...]
    faults: tuple[Fault, ...]
    by_option: bool = False

    def notes(self, ratios: Mapping[str, Fraction]) -> Iterator[str]:
        """Sentences on the remarks, and on what several speeds of the masses mean for the values."""
        for remark in self.remarks:
            if not remark.taken:
                yield f'line {remark.line}, "{remark.text}", is not used'
        if not _turn_apart(ratios):
            return
        says = "says the option values" if self.by_option else "says the sheet"
        if self.referred:
            yield f"values are referred to the speed of ratio 1, {says}; they were made real by the speed ratio"
        elif self.is_said:
            yield "values are real"
        else:
            yield "whether values are referred is not said; they were taken as real"


def decide_side(columns: SheetColumns, rows: SheetRows, grid: CellGrid, option: str = "") -> SideDecision:
    """Whether values of a sheet are referred to one speed: by option, headings, remarks above the table, or below.

    A word such as reduced that does not stand in a sentence on the values is a fault where speeds differ, as is a
    factor or GD2 in a remark.
    """
    names = {
        word
        for row in columns.rows
        for cell in row
        for word in (cell.text.casefold(), plain_name(cell.text).casefold())
    }
    faults: list[Fault] = []
    remarks: list[SheetRemark] = []
    unclear: list[Cell] = []
    said = [one.referred for one in columns.all if one.meaning in ("inertia", "stiffness") and one.referred is not None]
    texts = _texts(columns, rows, grid)
    for cell in texts:
        side, is_unclear = remark_side(cell.text, names)
        unclear += [cell] if is_unclear else []
        said += [] if side is None else [side]
        remarks.append(SheetRemark(cell.text, cell.line, "" if side is None else "referred" if side else "real"))
        faults += [grid.fault(text, cell) for text in _weighing(cell.text, columns)]
    for cell in _free_cells(columns):
        unclear += [cell] if any(remark_side(cell.text, names)) else []
    if not option and _turn_apart(rows.ratios):
        first = next((one for one in remarks if one.taken), None)
        if first and len(set(said)) > 1:
            both = "the sheet says of its values that they are referred, and that they are real"
            faults.append(
                grid.fault(f"{both}; choose by the option values, real or referred", Cell(first.text, first.line, 1))
            )
        faults += [grid.fault(f'"{cell.text}" {_UNKNOWN_SIDE}', cell) for cell in unclear]
        headings = [one.cell for one in columns.all if one.referred and one.meaning in ("inertia", "stiffness")]
        for cell in (*headings, *(cell for cell in texts if remark_side(cell.text, names)[0])):
            if elsewhere := _turning_elsewhere(referral_target(cell.text), rows):
                said_to = f'"{cell.text}" refers values to {elsewhere.label}, whose speed ratio is not 1'
                faults.append(grid.fault(f"{said_to}; give ratios to that speed, or choose by the option values", cell))
    referred = option == "referred" if option else bool(said and said[0])
    return SideDecision(referred, bool(said or option), tuple(remarks), tuple(faults), bool(option))


def _turn_apart(ratios: Mapping[str, Fraction]) -> bool:
    return len({abs(ratio) for ratio in ratios.values()} | {Fraction(1)}) > 1


def _turning_elsewhere(target: str, rows: SheetRows) -> SheetMass | None:
    """Mass to whose speed values are referred, by the words for it, where that is not the speed of ratio 1."""
    words = {word for word in target.split() if word not in _SPEED_WORDS}
    called = [mass for mass in rows.masses if words & set(re.split(r"[^\w]+", mass.label.casefold()))]
    return called[0] if called and all(abs(mass.ratio) != 1 for mass in called) else None


def _texts(columns: SheetColumns, rows: SheetRows, grid: CellGrid) -> list[Cell]:
    """Comments, and rows above the headings or without values below, each as one text where it begins."""
    joined = []
    for row in (*columns.above, *rows.without_values):
        filled = [cell for cell in row if cell.text]
        joined.append(Cell(", ".join(cell.text for cell in filled), filled[0].line, filled[0].column))
    return sorted([*(cell for cell in grid.remarks if cell.text), *joined], key=lambda cell: cell.line)


def _free_cells(columns: SheetColumns) -> list[Cell]:
    """Texts in columns that have no meaning, as remarks on masses."""
    places = [one.place for one in columns.all if not one.meaning]
    cells = [row[place] for row in columns.rows for place in places if place < len(row)]
    return [cell for cell in cells if cell.text and not is_like_number(cell.text)]


def _weighing(text: str, columns: SheetColumns) -> Iterator[str]:
    """Messages on what a remark may say of the size of values, which a heading has to say."""
    if has_power(text) and _OF_VALUES.search(text):
        yield f'"{text}" may give a factor of values; put it into the heading of its column, as k [10^6 N*m/rad]'
    inertia = columns.of("inertia")
    if (
        _DISC.search(text)
        and inertia is not None
        and not _DISC.search(inertia.heading)
        and "GD" not in inertia.unit_text
    ):
        yield f'"{text}" speaks of GD2, four times the inertia; write GD2 or GD2/4 into "{inertia.heading}"'

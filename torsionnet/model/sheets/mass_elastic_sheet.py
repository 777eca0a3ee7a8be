"""Mass-elastic sheet as it was read, with inertias, shafts and how each column was understood."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.base.delimited.cell_grid import Cell, CellGrid, is_like_number, read_grid
from torsionnet.base.delimited.sheet_headings import has_power
from torsionnet.base.entries.spec import EntryError, Schema, Spec, full_name
from torsionnet.base.errors import Fault, ModelError, got
from torsionnet.base.nearby_files import nearby_file
from torsionnet.base.plain_names import plain_name
from torsionnet.base.units import DIMENSIONS, numeral_of
from torsionnet.model.sheets.factor_readings import READINGS, FactorDecision, decide_factors, factor_text
from torsionnet.model.sheets.meanings import BY_KEY, referral_target, remark_side
from torsionnet.model.sheets.sheet_columns import SheetColumn, SheetColumns, read_columns
from torsionnet.model.sheets.sheet_rows import SheetLink, SheetMass, SheetRows, read_rows
from torsionnet.model.sheets.sheet_values import SheetValues

if TYPE_CHECKING:
    from torsionnet.base.table import Table


# Texts beside the table of a mass-elastic sheet, and whether its values are referred to one speed.

SIDES = ("real", "referred")
"""Values of a sheet: each at the speed of its mass, or all referred to one speed."""
_OF_VALUES = re.compile(
    r"\b(?:values?|all|inertias?|moments?|\w*stiff\w*|elasticit\w*|flexibilit\w*|complian\w*|[jikce]|times|multipl\w*|divided"
    r"|werte?|\w*trägheit\w*|drehmasse\w*|\w*steifigkeit\w*|nachgiebigkeit\w*)\b", re.IGNORECASE)  # fmt: skip
_DISC = re.compile(r"(?<![^\W_])(?:[GP]\s?D)\s?\^?\s?[2²]", re.IGNORECASE)
_SPEED_WORDS = {"speed", "drehzahl", "shaft", "welle", "side", "rpm", "ratio", "one", "common", "main", "of", "the"}
_IDLE = "was not understood and is left out"
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
    said = [
        column.referred
        for column in columns.all
        if column.meaning in ("inertia", "stiffness") and column.referred is not None
    ]
    texts = _texts(columns, rows, grid)
    for cell in texts:
        side, is_unclear = remark_side(cell.text, names)
        unclear += [cell] if is_unclear else []
        said += [] if side is None else [side]
        remarks.append(SheetRemark(cell.text, cell.line, "" if side is None else "referred" if side else "real"))
        faults += [
            grid.fault(text, cell, kind="contradicting-entries") for text in _remarks_on_sizes(cell.text, columns)
        ]
    for cell in _free_cells(columns):
        unclear += [cell] if any(remark_side(cell.text, names)) else []
    if not option and _turn_apart(rows.ratios):
        first = next((remark for remark in remarks if remark.taken), None)
        if first and len(set(said)) > 1:
            both = "the sheet says of its values that they are referred, and that they are real"
            faults.append(
                grid.fault(
                    f"{both}; choose by the option values, real or referred",
                    Cell(first.text, first.line, 1),
                    kind="ambiguous-name",
                )
            )
        faults += [grid.fault(f'"{cell.text}" {_UNKNOWN_SIDE}', cell, kind="unknown-word") for cell in unclear]
        headings = [
            column.cell for column in columns.all if column.referred and column.meaning in ("inertia", "stiffness")
        ]
        for cell in (*headings, *(cell for cell in texts if remark_side(cell.text, names)[0])):
            if elsewhere := _turning_elsewhere(referral_target(cell.text), rows):
                said_to = f'"{cell.text}" refers values to {elsewhere.label}, whose speed ratio is not 1'
                faults.append(
                    grid.fault(
                        f"{said_to}; give ratios to that speed, or choose by the option values",
                        cell,
                        kind="ambiguous-name",
                    )
                )
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
    places = [column.place for column in columns.all if not column.meaning]
    cells = [row[place] for row in columns.rows for place in places if place < len(row)]
    return [cell for cell in cells if cell.text and not is_like_number(cell.text)]


def _remarks_on_sizes(text: str, columns: SheetColumns) -> Iterator[str]:
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
        read = read_rows(scaled)
        if scaled.faults:
            raise ModelError(scaled.faults, grid.file)
        return read

    # The readings of factors are judged on values referred to one speed: real ones take the square of the ratio.
    power = 0 if sides.referred else 2
    factors = decide_factors(columns, grid, lambda readings: rows_of(readings).scaled(power), reading.factors)
    faults = [*sides.faults, *factors.faults]
    if faults:
        raise ModelError(faults, grid.file)
    real = rows_of(factors.columns).scaled(-2 if sides.referred else 0)
    gears = tuple(_gears(real))
    notes = [f"decimal {'comma' if values.decimal == ',' else 'point'}", *factors.notes(), *sides.notes(rows.ratios)]
    notes += [f'row {row[0].line}, "{values.label(row)}", is left out' for row in rows.totals]
    notes += ["each shaft stands in the row of the mass behind it"] * real.is_behind
    notes += map(_gear_note, gears)
    idle = [column for column in columns.all if not column.meaning and (not column.remark or not column.heading)]
    notes += [f'"{column.heading or f"column {column.place + 1}"}" {column.remark or _IDLE}' for column in idle]
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


# Entry of a mass-elastic sheet in a file beside the model file.

FILE = "file"
"""Key of the name of the file where the entry of a sheet has others, too."""
_CHOICES = {"values": SIDES, "factors": READINGS}


class SheetEntry(Spec[MassElasticSheet]):
    """Entry that names the file of a mass-elastic sheet.

    The name of a file in the folder of the model file, or below; with what its sheet leaves open, as
    ``{file: engine.csv, factors: unit}``.
    """

    @property
    def example(self) -> str:
        return "the name of a file beside the model, as engine.csv"

    def coerce(self, raw: object) -> MassElasticSheet:
        if isinstance(raw, MassElasticSheet):
            return raw
        said: dict[str, str] = {}
        if isinstance(raw, Mapping):
            said = {str(key): value for key, value in raw.items() if key != FILE}
            for key, value in said.items():
                allowed = _CHOICES.get(key, ())
                if value not in allowed:
                    text = f"expected {' or '.join(allowed)}" if allowed else f"a sheet has {FILE}, values and factors"
                    kind = "unknown-word" if allowed else "unknown-entry"
                    raise EntryError(
                        Fault(f"{text}, {got(value if allowed else key)}", (key,), on_key=not allowed, kind=kind)
                    )
            raw = raw.get(FILE)
        if not isinstance(raw, str | Path):
            raise EntryError(f"expected the name of a sheet, as engine.csv, {got(raw)}", kind="wrong-form")
        reading = SheetReading(**said)
        try:
            if isinstance(raw, Path):
                return read_sheet(raw, reading=reading)
            return read_sheet(nearby_file(raw), raw, reading)
        except ModelError as error:
            count = f"{len(error.faults)} fault{'s' if len(error.faults) > 1 else ''}"
            raise EntryError(
                [Fault(f'the sheet "{raw}" cannot be used; {count} in it', kind="unreadable-file"), *error.faults]
            ) from None
        except OSError as error:
            raise EntryError(
                f'the sheet "{raw}" cannot be read: {error.strerror or error}', kind="unreadable-file"
            ) from None

    def plain(self, value: Any) -> str | dict[str, str]:
        said = {key: text for key, text in asdict(value.reading).items() if text}
        return {FILE: str(value.file), **said} if said else str(value.file)

    def schema(self) -> Schema:
        name: Schema = {"type": "string", "description": self.description}
        choices: dict[str, Schema]
        choices = {key: {"type": "string", "enum": list(allowed)} for key, allowed in _CHOICES.items()}
        mapping: Schema = {"type": "object", "properties": {FILE: {"type": "string"}, **choices}, "required": [FILE],
                   "additionalProperties": False}  # fmt: skip
        return {"anyOf": [name, mapping], "description": self.description}

    @property
    def accepted(self) -> str:
        return f"str | pathlib.Path | collections.abc.Mapping[str, str] | {full_name(MassElasticSheet)}"

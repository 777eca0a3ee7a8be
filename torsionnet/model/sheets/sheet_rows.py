"""Rows of a mass-elastic sheet, read as masses and the shafts between them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from torsionnet.base.delimited.cell_grid import Cell
from torsionnet.base.errors import did_you_mean
from torsionnet.base.plain_names import Names, plain_name
from torsionnet.base.registers import Groups
from torsionnet.base.units import exact
from torsionnet.model.sheets.meanings import DAMPING
from torsionnet.model.sheets.sheet_values import NOTHING, SheetValue, SheetValues

GROUND = "ground"
"""Name of the fixed end of a shaft in a mass-elastic sheet."""
_EARTH = {"ground", "earth", "fixed", "grund", "erde", "fest"}
_TOTAL = re.compile(r"(?:total|sum|summe|gesamt|Σ|overall)\b", re.IGNORECASE)
_LOSSES = ("psi", "eta", "zeta", "magnifier")
_OF_SHAFTS = ("stiffness", "relative", "outer", "inner", "length", *_LOSSES)
"""Meanings of the columns of a sheet that say what a shaft is like."""
Row = Sequence[Cell]


@dataclass(frozen=True)
class SheetMass:
    """Inertia with damping to ground in one row of a sheet, in real values, not referred ones.

    ``ratio`` is its speed over that of the crank.
    """

    name: str
    label: str
    number: str
    inertia: SheetValue | None
    damping: SheetValue | None
    ratio: Fraction


@dataclass(frozen=True)
class SheetLink:
    """Shaft or mesh between two masses of a sheet, in real values, not referred ones; without a stiffness it is rigid.

    It turns with the speed of the first; where that of the second is another, a gear is at its end.
    """

    name: str
    first: str
    second: str
    stiffness: SheetValue | None = None
    damping: SheetValue | None = None
    loss: tuple[str, SheetValue] | None = None
    outer: SheetValue | None = None
    inner: SheetValue | None = None
    length: SheetValue | None = None


@dataclass
class _Begun:
    """Shaft or mesh that is read from a sheet's row before the mass at its end is known."""

    row: Row
    first: str | None
    second: str | None
    link: SheetLink | None
    """Shaft or mesh that the row begins; None where the row does not say how the masses are connected."""


@dataclass(frozen=True)
class SheetRows:
    """Masses of a sheet and links between them, as its rows give them, and the rows that have no values."""

    masses: tuple[SheetMass, ...]
    links: tuple[SheetLink, ...]
    totals: tuple[Row, ...] = ()
    without_values: tuple[Row, ...] = ()
    is_behind: bool = False
    """Whether each shaft stands in the row of the mass behind it, as in German sheets."""

    @property
    def ratios(self) -> dict[str, Fraction]:
        """Speed of every mass over that of the crank, by its name."""
        return {mass.name: mass.ratio for mass in self.masses}

    def scaled(self, power: int) -> SheetRows:
        """Masses and links with all values multiplied by this power of their speed ratio.

        -2 makes real values of referred ones, 2 the reverse.
        """
        ratios, masses, links = self.ratios, [], []
        for mass in self.masses:
            inertia, damping = (_times(value, mass.ratio**power) for value in (mass.inertia, mass.damping))
            masses.append(replace(mass, inertia=inertia, damping=damping))
        for link in self.links:
            factor = ratios[link.first] ** power
            stiffness, damping = (_times(value, factor) for value in (link.stiffness, link.damping))
            links.append(replace(link, stiffness=stiffness, damping=damping))
        return replace(self, masses=tuple(masses), links=tuple(links))


def _times(value: SheetValue | None, factor: Fraction) -> SheetValue | None:
    return None if value is None else value.times(factor)


def read_rows(values: SheetValues) -> SheetRows:
    """Masses and links between them of a sheet; faults are added to those of ``values``."""
    reader = _Rows(values)
    reader.read()
    links = reader.connected() if not values.faults else []
    return SheetRows(tuple(reader.masses.values()), tuple(links), tuple(reader.totals),
                     tuple(reader.without_values), reader.is_behind)  # fmt: skip


def _quotient(speed: SheetValue, first: SheetValue) -> Fraction:
    """Ratio of two speeds of a sheet as a fraction; in the same unit it is exact, since rpm in rad/s is no fraction."""
    (above, _, unit), (below, _, first_unit) = speed.text.partition(" "), first.text.partition(" ")
    if unit and unit == first_unit:
        return Fraction(above) / Fraction(below)
    return exact(speed.si) / exact(first.si)


@dataclass
class _Rows:
    values: SheetValues
    masses: dict[str, SheetMass] = field(default_factory=dict)
    rows: dict[str, Row] = field(default_factory=dict)
    begun: list[_Begun] = field(default_factory=list)
    totals: list[Row] = field(default_factory=list)
    without_values: list[Row] = field(default_factory=list)
    names: Names = field(default_factory=lambda: Names([GROUND]))
    first_speed: SheetValue = SheetValue(Fraction(1))

    def __post_init__(self) -> None:
        self.all: list[Row] = []
        for row in self.values.columns.rows:
            label = self._label(row)
            if label and _TOTAL.match(label.text):
                self.totals.append(row)
            else:
                self.all.append(row)
        numbered = Counter(self._plain(row) for row in self.all if self._is_mass(row))
        self.repeated = {name for name, count in numbered.items() if count > 1}
        self.count: Counter[str] = Counter()
        self.branched = any(self.values.columns.of(key) for key in ("from", "to"))
        self.one_row = any(self._has(row, "inertia") and self._has_link(row) for row in self.all)
        stiff = [self._has_link(row) for row in self.all]
        self.is_behind = not self.branched and all(map(self._is_mass, self.all)) and stiff[:1] == [False] and stiff[-1]
        if self.is_behind:
            self.all = self._with_shafts_of_next()

    def _with_shafts_of_next(self) -> list[Row]:
        """Rows with what the row below says of its shaft, which leads from this mass to that one."""
        places = [column.place for key in _OF_SHAFTS if (column := self.values.columns.of(key))]
        rows: list[Row] = []
        for row, below in zip(self.all, [*self.all[1:], ()], strict=True):
            moved = [*row, *(Cell("", row[0].line, 1) for _ in range(len(row), max(places) + 1))]
            for place in places:
                moved[place] = below[place] if place < len(below) else Cell("", row[0].line, 1)
            rows.append(moved)
        return rows

    def _has(self, row: Row, key: str) -> bool:
        cell = self.values.columns.cell(row, key)
        return cell is not None and cell.text.casefold() not in NOTHING

    def _has_link(self, row: Row) -> bool:
        return self._has(row, "stiffness") or (self._has(row, "outer") and self._has(row, "length"))

    def _is_mass(self, row: Row) -> bool:
        return self._has(row, "inertia")

    def _label(self, row: Row) -> Cell | None:
        columns = self.values.columns
        return columns.cell(row, "name") or columns.cell(row, "number")

    def _plain(self, row: Row) -> str:
        label = self._label(row)
        if label is None:
            return "mass"
        return f"mass_{label.text}" if label.text.isdigit() else plain_name(label.text)

    def _fault(self, kind: str, text: str, cell: Cell | None, row: Row) -> None:
        at = cell or self._label(row) or next(filled for filled in row if filled.text)
        self.values.faults.append(self.values.grid.fault(text, at, kind=kind))

    def read(self) -> None:
        """Read the masses of a sheet, and links whose ends may still be open."""
        pending: list[_Begun] = []
        last: str | None = None
        ratio = Fraction(1)
        for row in self.all:
            both = self._has(row, "from") and self._has(row, "to")
            shaft_only = both or (self._has_link(row) and not self._is_mass(row) and not self.one_row)
            if shaft_only:
                if both and self._is_mass(row):
                    cell = self.values.columns.cell(row, "inertia")
                    self._fault(
                        "needless-entry",
                        "a row with from and to is a shaft; its inertia stands in a row of its own",
                        cell,
                        row,
                    )
                if not both:
                    pending = [begun for begun in pending if begun.link is not None]
                pending.append(self._link(row, None if both else last))
                continue
            if not self._is_mass(row) and not self._has_link(row):
                self.without_values.append(row)
                continue
            name, ratio = self._mass(row, ratio)
            for begun in pending:
                begun.second = begun.second or name
            self.begun += pending
            pending = [self._link(row, name)]
            last = name
        self.begun += pending
        if not self.masses and not self.values.faults:
            row = self.all[0] if self.all else self.values.grid.rows[-1]
            self._fault("missing-entry", "no row has an inertia", None, row)

    def _mass(self, row: Row, before: Fraction) -> tuple[str, Fraction]:
        label, plain = self._label(row), self._plain(row)
        if plain in self.repeated:
            self.count[plain] += 1
            plain = f"{plain}_{self.count[plain]}"
        name = self.names.new(plain)
        number = self.values.columns.cell(row, "number")
        absolute = self.values.of(row, "absolute")
        if absolute is None and self._has(row, DAMPING):
            absolute = self._open_damping(row)
        ratio = self._ratio(row, before)
        self.masses[name] = SheetMass(name, label.text if label else name, number.text if number else "",
                                      self.values.of(row, "inertia"), absolute, ratio)  # fmt: skip
        self.rows[name] = row
        return name, ratio

    def _open_damping(self, row: Row) -> SheetValue | None:
        """Damping in a row about one thing that does not say where it acts; else a fault."""
        if not self.one_row:
            return self.values.of(row, DAMPING)
        column = self.values.columns.of(DAMPING)
        assert column is not None
        text = f'"{column.heading}" does not say what it acts on'
        text += '; call it "absolute damping" (of the mass, to ground) or "relative damping" (of the shaft)'
        fault = self.values.grid.fault(text, column.cell, kind="ambiguous-name")
        if fault not in self.values.faults:
            self.values.faults.append(fault)
        return None

    def _ratio(self, row: Row, before: Fraction) -> Fraction:
        ratio, speed = self.values.of(row, "ratio"), self.values.of(row, "speed")
        given = ratio or speed
        if given is None:
            return before
        cell = self.values.columns.cell(row, "ratio" if ratio else "speed")
        if not given.si:
            self._fault(
                "out-of-range",
                "a mass that does not turn has no speed ratio; expected a number other than 0",
                cell,
                row,
            )
            return before
        if ratio:
            return exact(given.si)
        self.first_speed = self.first_speed if self.masses else given
        return _quotient(given, self.first_speed)

    def _link(self, row: Row, first: str | None) -> _Begun:
        """Shaft that a row of the sheet begins; rows of later masses may say which masses it connects."""
        if not self._has_link(row):
            return _Begun(row, first, None, None)
        of = self.values.of
        losses = [(key, value) for key in _LOSSES if (value := of(row, key)) is not None]
        losses = [(key, value) for key, value in losses if value.si]
        if len(losses) > 1:
            self._fault(
                "contradicting-entries",
                f"{losses[0][0]} and {losses[1][0]} say the same thing twice; leave one",
                None,
                row,
            )
        relative = of(row, "relative")
        if relative is None and self._has(row, DAMPING) and not self._is_mass(row):
            relative = self._open_damping(row)
        label = self.values.columns.cell(row, "name") if not self._is_mass(row) else None
        between = not self.one_row or (self._has(row, "from") and self._has(row, "to"))
        named = self.names.new(label.text) if label and between else ""
        outer, length = of(row, "outer"), of(row, "length")
        stiffness = of(row, "stiffness")
        link = SheetLink(named, "", "", stiffness, relative, losses[0] if losses else None, outer,
                         of(row, "inner"), None if self._has(row, "stiffness") else length)  # fmt: skip
        return _Begun(row, first, None, link)

    def connected(self) -> list[SheetLink]:
        """Shafts and meshes between the masses that were read from the sheet."""
        links: list[SheetLink] = []
        for begun in self.begun:
            links += self._ended(begun)
        if not self.values.faults:
            self._check_connected(links)
        return links

    def _ended(self, begun: _Begun) -> list[SheetLink]:
        first, second = begun.first, begun.second
        source, target = (self.values.columns.cell(begun.row, key) for key in ("from", "to"))
        is_mass = begun.first in self.rows and self.rows[begun.first] is begun.row
        if source is not None:
            second = first if is_mass else second
            first = self._meant_mass(source)
        if target is not None:
            second = self._meant_mass(target)
        if (source and first is None) or (target and second is None):
            return []
        link = begun.link
        if second is None or first is None:
            return self._open_end(begun)
        if first == GROUND:
            first, second = second, first
        if link is None:
            return self._rigid_gear(begun, first, second, explicit=bool(source or target))
        if first == second:
            self._fault(
                "same-node", f'"{self.masses[first].label}" is connected to itself', target or source, begun.row
            )
            return []
        if not self._is_whole(link, begun.row):
            return []
        rigid = link.stiffness is not None and link.stiffness.is_rigid
        name = link.name or self.names.new(f"{first}_to_{second}")
        return [replace(link, name=name, first=first, second=second, stiffness=None if rigid else link.stiffness)]

    def _open_end(self, begun: _Begun) -> list[SheetLink]:
        """Empty list, with a fault for a shaft after the last mass unless its cell is empty or 0."""
        link = begun.link
        if link is not None and not (link.stiffness is not None and (link.stiffness.is_rigid or not link.stiffness.si)):
            cell = self.values.columns.cell(begun.row, "stiffness")
            which = "after the last mass" if begun.first else "before the first mass"
            self._fault(
                "missing-entry",
                f"a shaft {which} leads nowhere; leave its stiffness empty, or say to: ground",
                cell,
                begun.row,
            )
        return []

    def _rigid_gear(self, begun: _Begun, first: str, second: str, *, explicit: bool) -> list[SheetLink]:
        """Rigid link between two masses of a sheet without a shaft: a mesh, where their speeds differ; else a fault."""
        mass, other = self.masses.get(first), self.masses.get(second)
        if mass is None or other is None or mass.ratio == other.ratio:
            if self.branched and not explicit:
                return []
            text = (
                f'nothing is said of how "{mass.label if mass else first}" and "{other.label if other else second}" are'
            )
            self._fault(
                "missing-entry", f"{text} connected; give a stiffness or a compliance, or write rigid", None, begun.row
            )
            return []
        if self.branched and not explicit:
            return []
        return [SheetLink(self.names.new(f"{first}_to_{second}"), first, second)]

    def _is_whole(self, link: SheetLink, row: Row) -> bool:
        if link.stiffness is None and not (link.outer and link.length):
            self._fault("missing-entry", "the shaft has neither stiffness nor outer diameter and length", None, row)
            return False
        if link.stiffness is not None and not link.stiffness.is_rigid and not link.stiffness.si:
            if link.damping is not None and link.damping.si:
                return True
            cell = self.values.columns.cell(row, "stiffness")
            self._fault(
                "out-of-range",
                "a shaft of stiffness 0 connects nothing; write rigid, or leave the cell empty",
                cell,
                row,
            )
            return False
        if link.outer is not None and link.inner is not None and link.inner.si >= link.outer.si:
            cell = self.values.columns.cell(row, "inner")
            self._fault("contradicting-values", "the inner diameter must be smaller than the outer diameter", cell, row)
            return False
        return True

    def _meant_mass(self, cell: Cell) -> str | None:
        """Name of the mass that a cell of the sheet means by its number or name.

        None with a fault where there is none.
        """
        text = cell.text.casefold()
        if text in _EARTH:
            return GROUND
        masses = [mass.name for mass in self.masses.values() if cell.text in (mass.label, mass.number)]
        masses = masses or [mass.name for mass in self.masses.values() if mass.label.casefold() == text]
        masses = masses or [mass.name for mass in self.masses.values() if mass.name.casefold() == text]
        if len(masses) == 1:
            return masses[0]
        kind = "ambiguous-name" if masses else "unknown-name"
        if masses:
            told = f'"{cell.text}" is the name of {len(masses)} masses; say which by its number'
        else:
            told = f'no mass is named or numbered "{cell.text}"'
            told += did_you_mean(cell.text, [mass.label for mass in self.masses.values()])
        self._fault(kind, told, cell, ())
        return None

    def _check_connected(self, links: Sequence[SheetLink]) -> None:
        joined = Groups(self.masses)
        for link in links:
            if GROUND not in (link.first, link.second):
                joined.join(link.first, link.second)
        groups = joined.groups()
        home = joined.of(next(iter(self.masses)))
        for group in groups:
            if group is not home:
                pair = " with ".join(f'"{self.masses[name].label}"' for name in (group[0], home[0]))
                text = f"nothing connects {pair}; say in a column to or from what does"
                self._fault("unconnected-nodes", text, None, self.rows[group[0]])

"""Factors in the headings of a sheet: whether they multiply the quantity or its unit, decided by magnitude alone."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from torsionnet.base.delimited.cell_grid import Cell, CellGrid
from torsionnet.base.errors import Fault
from torsionnet.base.registers import Groups
from torsionnet.base.units import numeral_of
from torsionnet.model.sheets.sheet_columns import SheetColumn, SheetColumns
from torsionnet.model.sheets.sheet_rows import GROUND, SheetLink, SheetRows

READINGS = ("unit", "values")
"""Readings of a factor: the cells are in units times the factor, or they are the quantity times the factor."""
LOWEST_USUAL, HIGHEST_USUAL = 0.1, 2000.0
"""Range in Hz of the lowest vibration of a drivetrain, from a wind turbine on a soft shaft to small machines."""
APART = 10.0
"""Factor by which the lowest vibration of every other reading has to lie outside of this range."""
MOST_MASSES = 200
"""Largest number of masses of which the lowest vibration is calculated, a fraction of a second."""
MOST_FACTORS = 5
"""Largest number of headings with factors of which all readings are tried."""
STEEL = 79.3e9
"""Shear modulus in Pa of a shaft that is given by its dimensions, as in the elements."""


@dataclass(frozen=True)
class FactorReading:
    """Reading of the factor in a heading of a sheet.

    Attributes
    ----------
    heading, factor : str
        As written.
    scale : Fraction
        Number by which a cell is multiplied to be in the unit of the heading.
    taken : str
        ``unit`` or ``values``: what the factor multiplies.
    by : str
        What decided: ``place`` directly before the unit, ``magnitude`` or ``option``.
    """

    heading: str
    factor: str
    scale: Fraction
    taken: str
    by: str


@dataclass(frozen=True)
class PossibleReading:
    """Readings of all factors of a sheet, in the order of its columns, and the lowest vibration in Hz that they give.

    None where nothing can vibrate, or there are too many masses to calculate it.
    """

    taken: tuple[str, ...]
    lowest: float | None

    @property
    def is_usual(self) -> bool:
        return self.lowest is not None and LOWEST_USUAL <= self.lowest <= HIGHEST_USUAL

    @property
    def is_impossible(self) -> bool:
        return self.lowest is not None and not LOWEST_USUAL / APART <= self.lowest <= HIGHEST_USUAL * APART


@dataclass(frozen=True)
class FactorDecision:
    """Readings of the factors in the headings of a sheet, all that were possible, and faults of those left open."""

    columns: SheetColumns
    readings: tuple[FactorReading, ...] = ()
    possible: tuple[PossibleReading, ...] = ()
    faults: tuple[Fault, ...] = ()

    def notes(self) -> list[str]:
        """Sentences on the readings that were decided, and why."""
        frequencies = ", ".join(_hertz(reading) for reading in self.possible if reading.taken != self._taken)
        chosen = next((_hertz(reading) for reading in self.possible if reading.taken == self._taken), "")
        why = {"place": "it stands before the unit", "option": "as the option says",
               "magnitude": f"the lowest vibration is {chosen}, else {frequencies}"}  # fmt: skip
        return [f'"{reading.factor}" in the heading "{reading.heading}" multiplies the '
                f"{'unit' if reading.taken == 'unit' else 'values of the quantity'}, so that cells times "
                f"{factor_text(reading.scale)} are taken: {why[reading.by]}" for reading in self.readings]  # fmt: skip

    @property
    def _taken(self) -> tuple[str, ...]:
        return tuple(reading.taken for reading in self.readings)


def decide_factors(
    columns: SheetColumns, grid: CellGrid, rows_of: Callable[[SheetColumns], SheetRows], option: str = ""
) -> FactorDecision:
    """Readings of all factors in the headings of a sheet.

    A factor directly before a unit belongs to it; others as ``option`` says, without it by the one reading whose lowest
    vibration is usual, where that of every other is impossible. ``rows_of`` reads the rows, all values referred to one
    speed.
    """
    factored = [
        column for column in columns.all if column.meaning and column.factor is not None and column.unit is not None
    ]
    if not factored:
        return FactorDecision(columns)
    places = [column.place for column in factored]
    usual = [("unit",) if column.factor and column.factor.before_unit else (option,) if option else READINGS
             for column in factored]  # fmt: skip
    is_certain = all(len(choices) == 1 for choices in usual)
    possible: tuple[PossibleReading, ...] = ()
    # Each combination of readings makes another plant, with a lowest vibration of its own.
    if not option and len(factored) <= MOST_FACTORS:
        combinations = product(READINGS, repeat=len(factored))
        possible = tuple(
            PossibleReading(taken, lowest_vibration(rows_of(columns.read_as(dict(zip(places, taken, strict=True))))))
            for taken in combinations
        )
    among = [
        reading
        for reading in possible
        if all(taken in choices for taken, choices in zip(reading.taken, usual, strict=True))
    ]
    chosen = next((reading.taken for reading in among if reading.is_usual), None)
    if is_certain:
        chosen = tuple(choices[0] for choices in usual)
        is_open = any(reading.is_impossible for reading in among) and any(reading.is_usual for reading in possible)
    else:
        is_open = chosen is None or not all(reading.is_impossible for reading in among if reading.taken != chosen)
    if is_open or chosen is None:
        asked = [column for column, choices in zip(factored, usual, strict=True) if is_certain or len(choices) > 1]
        return FactorDecision(
            columns, (), possible, tuple(_question(column, factored, possible, grid) for column in asked)
        )
    readings = tuple(_reading(column, taken, option) for column, taken in zip(factored, chosen, strict=True))
    return FactorDecision(columns.read_as(dict(zip(places, chosen, strict=True))), readings, possible)


def _reading(column: SheetColumn, taken: str, option: str) -> FactorReading:
    factor = column.factor
    assert factor is not None
    by = "place" if factor.before_unit else "option" if option else "magnitude"
    return FactorReading(column.heading, factor.text, factor.scale(taken), taken, by)


def _question(
    column: SheetColumn, factored: Sequence[SheetColumn], possible: Sequence[PossibleReading], grid: CellGrid
) -> Fault:
    factor = column.factor
    assert factor is not None
    scales = [factor_text(factor.scale(reading)) for reading in READINGS]
    headings = " or ".join(f"[{scale} {column.unit_text}]" for scale in scales)
    tried = "; ".join(f"{', '.join(reading.taken)}: {_hertz(reading)}" for reading in possible)
    several = "" if len(factored) == 1 else f" (readings of {', '.join(column.heading for column in factored)})"
    text = (
        f'"{factor.text}" in the heading "{column.heading}" may multiply the unit or the values: a cell times '
        f"{scales[0]} or times {scales[1]} is in {column.unit_text}; give the unit as {headings}, or choose by the "
        f"option factors, unit or values{f'; lowest vibrations: {tried}{several}' if tried else ''}"
    )
    at = max(column.cell.text.find(factor.text), 0)
    shown = factor.text if factor.text in column.cell.text else column.cell.text
    return grid.fault(text, Cell(shown, column.cell.line, column.cell.column + at), kind="ambiguous-name")


def _hertz(possible: PossibleReading) -> str:
    return "none" if possible.lowest is None else f"{possible.lowest:.4g} Hz"


def factor_text(scale: Fraction) -> str:
    """Factor as a decimal number where that is exact, else as a fraction."""
    return f"{float(scale):g}" if Fraction(f"{float(scale):g}") == scale else numeral_of(scale)


def lowest_vibration(rows: SheetRows) -> float | None:
    """Lowest natural frequency in Hz, without damping, of masses and shafts whose values are referred to one speed.

    Rigid links join masses; the eigenvalues 1/(omega^2 + s) of M^1/2 (K + s M)^-1 M^1/2 are found for a shift s below
    the lowest omega^2 that is not 0.
    """
    import numpy as np  # reading a model without factors can do without it

    joined = Groups([*(mass.name for mass in rows.masses), GROUND])
    springs = [(link, _stiffness(link)) for link in rows.links]
    for link, stiffness in springs:
        if stiffness == math.inf:
            joined.join(link.first, link.second)
    groups = [group for group in joined.groups() if group is not joined.of(GROUND)]
    place = {name: at for at, group in enumerate(groups) for name in group}
    if not 0 < len(groups) <= MOST_MASSES:
        return None
    inertia, k = np.zeros(len(groups)), np.zeros((len(groups), len(groups)))
    for mass in rows.masses:
        if mass.name in place and mass.inertia is not None:
            inertia[place[mass.name]] += float(mass.inertia.si)
    held = False
    for link, stiffness in springs:
        ends = [place[name] for name in (link.first, link.second) if name in place]
        if stiffness == math.inf or not stiffness or (len(ends) == 2 and ends[0] == ends[1]):
            continue
        held |= len(ends) == 1
        # K takes k at both ends and -k between them; a spring to ground has one end here.
        for row in ends:
            for column in ends:
                k[row, column] += stiffness if row == column else -stiffness
    held |= len(joined.of(GROUND)) > 1
    if not inertia.any() or not k.any():
        return None
    # The shift begins at a mean omega^2 and comes down until the lowest one is not lost in rounding beside it.
    shift, root = float(k.trace() / inertia.sum()), np.sqrt(inertia)
    for _ in range(6):
        try:
            inverse = np.linalg.inv(k + shift * np.diag(inertia))
        except np.linalg.LinAlgError:
            return None
        values = np.sort(np.linalg.eigvalsh(root[:, None] * inverse * root[None, :]))[::-1]
        # Where nothing holds the plant, the largest eigenvalue is its motion as a rigid body, and the next is sought.
        if len(values) < 2 - held or values[1 - held] <= 0:
            return None
        squared = 1 / float(values[1 - held]) - shift
        if squared > shift / 100:
            return math.sqrt(squared) / (2 * math.pi)
        shift /= 1000
    return None


def _stiffness(link: SheetLink) -> float:
    if link.stiffness is not None:
        return math.inf if link.stiffness.is_rigid else float(link.stiffness.si)
    if link.outer is None or link.length is None or not link.length.si:
        return math.inf
    # k = G pi (D^4 - d^4)/(32 L).
    inner = float(link.inner.si) if link.inner is not None else 0.0
    return STEEL * math.pi / 32 * (float(link.outer.si) ** 4 - inner**4) / float(link.length.si)

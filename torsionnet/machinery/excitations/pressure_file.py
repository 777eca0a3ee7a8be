"""Reader of text files with pressure traces from makers and indicators."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from torsionnet.base.delimited.dialect import Dialect, data_start, detect_dialect, detect_encoding
from torsionnet.base.delimited.headings import Headings, headings, plain_unit
from torsionnet.base.delimited.number_rows import NumberRows
from torsionnet.base.errors import Fault, ModelError, Position
from torsionnet.base.units import ANGLES, DIMENSIONS, Unit, UnitError, parse_unit
from torsionnet.machinery.excitations.order_excitation import FloatArray
from torsionnet.machinery.excitations.pressure_trace import (
    CLOSING_RTOL,
    LEAST_SAMPLES,
    WHOLE_CYCLE,
    PressureTrace,
    peak_pressure_fault,
)

DIALECT_LINES = 400
"""Number of lines from which separators and the first row of numbers are recognised, longer than any head."""
FORM = "angle [deg];pressure [bar]"
EVEN_STEP_TOL = 0.02
"""Share of a step of crank angle by which even steps may be off, as their decimals are rounded."""
LARGEST_END_GAP = 1.5
"""Largest number of steps missing between a trace's last sample and the end of the cycle, one and rounding."""
CLOSING_STEP_RATIO = 1.5
"""Largest pressure step from a trace's last to its first sample, over the largest step within the trace."""
MOST_STEPS = 14_400
"""Largest number of interpolated steps of a cycle, 0.05 deg of two revolutions, finer than indicators sample."""
_DEGREES = re.compile(r"(\bdeg|°)\s*(CAD?|KW|crank)?(?![A-Za-z])")
"""Regular expression of the spellings of crank degrees in headings."""


@dataclass(frozen=True)
class _Rows:
    """Angles in degrees and pressures in Pa of a trace file, with the lines of the file."""

    angles: FloatArray
    pressures: FloatArray
    numbers: Sequence[int]
    lines: Sequence[str]
    heading: int
    file: str

    def fault(self, text: str, row: int) -> Fault:
        return _fault(text, self.file, self.numbers[row], self.lines)

    def without_last(self) -> _Rows:
        return replace(self, angles=self.angles[:-1], pressures=self.pressures[:-1])


def read_pressure_file(path: Path) -> PressureTrace:
    """Pressure trace from a file of two columns, crank angle and pressure, with units in the heading.

    Even steps are kept as they are, others interpolated linearly at the finest of them.

    Raises
    ------
    ModelError
        The file cannot be read; the message names the line.
    """
    rows = _rows(path)
    _refuse(_wrong_rows(rows), path)
    revolutions, both_ends = _covered(rows)
    _refuse(_not_closing(rows, both_ends, revolutions), path)
    trace = _trace(rows.without_last() if both_ends else rows, revolutions)
    _refuse((_fault(text, path.name, rows.heading, rows.lines) for text in [peak_pressure_fault(trace)] if text), path)
    return trace


def _refuse(faults: Iterator[Fault], path: Path) -> None:
    found = list(faults)
    if found:
        raise ModelError(found, path.name)


def _fault(text: str, file: str, number: int, lines: Sequence[str]) -> Fault:
    """Fault at a line of a trace file, counted from 1."""
    source = lines[number - 1].rstrip()[:200].replace("\t", " ") if 0 < number <= len(lines) else ""
    return Fault(text, position=Position(file, max(number, 1), 1, len(source) + 1, source))


def _rows(path: Path) -> _Rows:
    """Angles in degrees and pressures in Pa that a trace file has."""
    with path.open(encoding=detect_encoding(path), newline=None, errors="replace") as file:
        lines = file.readlines()
    above = next((at for at, line in enumerate(lines) if line.strip() and not line.startswith(("#", "%"))), 0)
    body = lines[above:]
    dialect = detect_dialect(body[:DIALECT_LINES])
    first = data_start(dialect, body[:DIALECT_LINES])
    if first == min(len(body), DIALECT_LINES):
        raise ModelError([_fault(f"found no rows of numbers; expected {FORM} and rows below", path.name, 1, lines)])
    width = len(dialect.cells(body[first]))
    heading = headings(dialect, [_DEGREES.sub("deg", line) for line in body[:first]], width)
    number = above + first
    angle, pressure = _columns(heading, dialect, body[first], path.name, number, lines)
    factors = [_factor(heading, column, kind, path.name, number, lines) for column, kind in
               ((angle, "angle"), (pressure, "pressure"))]  # fmt: skip
    reader = NumberRows(iter(body[first:]), path.name, dialect, width, number + 1, heading.names)
    blocks = list(reader.blocks([angle, pressure], 0))
    with np.errstate(over="ignore"):  # infinite is found to be wrong below
        angles, pressures = (np.concatenate([block[i] for block in blocks]) * factors[i] for i in range(2))
    numbers = [number + 1 + at for at, line in enumerate(body[first:]) if line.strip()]
    return _Rows(angles, pressures, numbers, lines, max(number, 1), path.name)


def _columns(
    heading: Headings, dialect: Dialect, row: str, file: str, number: int, lines: Sequence[str]
) -> tuple[int, int]:
    """Indices of the columns of crank angle and pressure, by their units, else in this order."""
    width = len(heading.names)
    if width > 1 and not dialect.cells(row)[-1]:
        width -= 1  # every row ends with a separator
    if width != 2:
        text = f"{width} column{'s' if width != 1 else ''}; a pressure trace has two: {FORM}"
        raise ModelError([_fault(text, file, number or 1, lines)], file)
    if not heading.lines:
        raise ModelError(
            [_fault(f"no heading; the first line says what the columns are: {FORM}", file, 1, lines)], file
        )
    first = _unit(heading.units[0])
    return (1, 0) if first is not None and first.dimension == DIMENSIONS["pressure"] else (0, 1)


def _factor(heading: Headings, column: int, kind: str, file: str, number: int, lines: Sequence[str]) -> float:
    """Factor from the unit of a trace file's column to degrees or Pa."""
    name, text = heading.names[column], heading.units[column]
    meant = "angle [deg]" if kind == "angle" else "pressure [bar]"
    unit = _unit(text)
    if not text:
        said = f"the column {name} has no unit; write its heading as {meant}"
    elif unit is None or unit.dimension != DIMENSIONS[kind] or (kind == "angle" and unit.text not in ANGLES):
        said = f'"{text}" is no unit of {kind}; write the heading as {meant}'
    else:
        return float(unit.factor) * (180 / np.pi if kind == "angle" else 1)
    raise ModelError([_fault(said, file, number, lines)], file)


def _unit(text: str) -> Unit | None:
    try:
        return parse_unit(plain_unit(text))
    except UnitError:
        return None


def _wrong_rows(rows: _Rows) -> Iterator[Fault]:
    for row in np.flatnonzero(~(np.isfinite(rows.angles) & np.isfinite(rows.pressures)))[:5].tolist():
        yield rows.fault("a number is missing; every row has an angle and a pressure", row)
        return
    for row in np.flatnonzero(np.diff(rows.angles) <= 0)[:1].tolist():
        text = f"the angle {rows.angles[row + 1]:g} deg follows {rows.angles[row]:g} deg; angles increase"
        yield rows.fault(text, row + 1)
    if len(rows.angles) < LEAST_SAMPLES:
        text = f"{len(rows.angles)} pressures are too few for a cycle; give {LEAST_SAMPLES} or more"
        yield rows.fault(text, len(rows.angles) - 1)


def _covered(rows: _Rows) -> tuple[int, bool]:
    """Number of revolutions in a trace file, and whether it has both ends of the cycle."""
    step, span = float(np.median(np.diff(rows.angles))), float(rows.angles[-1] - rows.angles[0])
    for revolutions in (1, 2):
        missing = 360 * revolutions - span
        if -EVEN_STEP_TOL * step <= missing <= LARGEST_END_GAP * step:
            return revolutions, missing < step / 2
    text = f"the trace covers {rows.angles[0]:g} to {rows.angles[-1]:g} deg"
    text += f"; {WHOLE_CYCLE}, with one or both ends"
    raise ModelError([rows.fault(text, len(rows.angles) - 1)], rows.file)


def _not_closing(rows: _Rows, both_ends: bool, revolutions: int) -> Iterator[Fault]:
    p = rows.pressures
    allowed = CLOSING_RTOL * float(np.max(np.abs(p)))
    if not both_ends:
        allowed = max(allowed, CLOSING_STEP_RATIO * float(np.max(np.abs(np.diff(p)))))
    if abs(p[0] - p[-1]) > allowed:
        text = f"the trace does not close: it begins with {p[0] / 1e5:.6g} bar and ends with {p[-1] / 1e5:.6g} bar"
        yield rows.fault(f"{text}; it covers 360 deg: {WHOLE_CYCLE}" if revolutions == 1 else text, len(p) - 1)


def _trace(rows: _Rows, revolutions: int) -> PressureTrace:
    """Pressure trace in Pa at even steps of crank angle, the first at or after 0 degrees."""
    cycle, count = 360.0 * revolutions, len(rows.angles)
    step, note = cycle / count, ""
    angles: FloatArray = rows.angles
    pressures: FloatArray = rows.pressures
    if np.max(np.abs(angles - angles[0] - step * np.arange(count))) > EVEN_STEP_TOL * step:
        steps = min(MOST_STEPS, round(cycle / float(np.min(np.diff(angles)))))
        note = f"{rows.file} has uneven steps; it is interpolated linearly at {steps} steps of a cycle"
        step = cycle / steps
        pressures = np.asarray(np.interp(step * np.arange(steps), angles, pressures, period=cycle))
        angles = np.arange(float(steps)) * step
    begin = angles[0] % cycle
    passed = int(np.ceil((cycle - begin) / step - EVEN_STEP_TOL)) % len(angles)  # samples before 0 degrees
    start = begin + passed * step - (cycle if passed else 0)
    start = 0.0 if abs(start) < EVEN_STEP_TOL * step else start
    values = tuple(np.roll(pressures, -passed).tolist())
    place = Position(rows.file, rows.heading, 1, 1)
    return PressureTrace(values, float(np.radians(start)), revolutions, rows.file, place, note)

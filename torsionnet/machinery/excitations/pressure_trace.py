"""Pressure trace over one cycle of an engine: harmonics and mean indicated pressure."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.delimited.dialect import (
    Dialect,
    Headings,
    data_start,
    detect_dialect,
    detect_encoding,
    headings,
    line_position,
    plain_unit,
)
from torsionnet.base.delimited.number_rows import NumberRows
from torsionnet.base.entries.composite import Composite
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.base.entries.spec import EntryError, Json, Schema, not_none
from torsionnet.base.errors import Fault, ModelError, Position, got
from torsionnet.base.nearby_files import nearby_file
from torsionnet.base.phrases import phrase
from torsionnet.base.units import ANGLES, DIMENSIONS, Unit, UnitError, parse_unit
from torsionnet.machinery.excitations.order_excitation import ComplexArray, FloatArray

# Motion of a piston over the crank angle, and harmonics of gas and inertia torques.


def piston_rate(angle: FloatArray, ratio: float) -> FloatArray:
    """Piston rate dx/dphi over the crank radius, x from top dead centre, in the shape of ``angle`` (rad).

    ``ratio`` is crank radius over rod length.

    >>> bool(abs(piston_rate(np.array([np.pi / 2]), 0.25)[0] - 1) < 1e-12)
    True
    """
    # x/r = 1 - cos phi + (1 - sqrt(1 - lambda^2 sin^2 phi))/lambda with lambda = r/l, exact for the slider crank.
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.asarray(sine * (1 + ratio * cosine / np.sqrt(1 - (ratio * sine) ** 2)))


def piston_curvature(angle: FloatArray, ratio: float) -> FloatArray:
    """Piston curvature d2x/dphi2 over the crank radius, in the shape of ``angle`` (rad)."""
    sine, cosine = np.sin(angle), np.cos(angle)
    root = np.sqrt(1 - (ratio * sine) ** 2)
    # 1 - 2 sin^2 is cos^2 - sin^2; the last term is the change of the rod's own slope.
    return np.asarray(cosine + ratio * (cosine**2 - sine**2) / root + ratio**3 * (sine * cosine) ** 2 / root**3)


def inertia_harmonics(ratio: float, orders: FloatArray) -> ComplexArray:
    """Torque -x' x'' of a reciprocating mass over m r^2 Omega^2, complex, at whole orders, shape (n_orders,).

    0 at others.

    The torque is a sine series. For a short rod, as for r/l = 0.25, orders 1 to 4 are:

    >>> [round(float(value), 6) for value in -inertia_harmonics(0.25, np.arange(1.0, 5.0)).imag]
    [0.063506, -0.50013, -0.192056, -0.016129]
    """
    # One revolution of -x' x'': orders above half the samples are far below rounding for any rod that is built.
    angle = 2 * np.pi * np.arange(4096) / 4096
    return harmonics(-piston_rate(angle, ratio) * piston_curvature(angle, ratio), 1, orders)


def harmonics(samples: FloatArray, revolutions: int, orders: FloatArray) -> ComplexArray:
    """Complex amplitudes at orders, shape (n_orders,), of evenly spaced samples over ``revolutions``.

    0 at orders the cycle does not hold.

    >>> phi = 2 * np.pi * np.arange(8) / 8
    >>> bool(abs(harmonics(3 * np.cos(phi + 0.5), 1, np.array([1.0]))[0] - 3 * np.exp(0.5j)) < 1e-12)
    True
    """
    lines = np.asarray(orders) * revolutions
    whole = np.rint(lines).astype(int)
    # X_h = 2/N sum_n x_n exp(-j 2 pi h n/N): peak values, and at order 0 twice the mean.
    spectrum = 2 * np.fft.rfft(samples) / len(samples)
    # Half orders exist over two revolutions only; the line at half the sampling rate has no phase and is left out.
    held = (np.abs(lines - whole) < 1e-9) & (whole < (len(samples) + 1) // 2)
    return np.where(held, spectrum[np.where(held, whole, 0)], 0)


LOWEST_PEAK, HIGHEST_PEAK = 1e3, 1e9
"""Smallest and largest possible peak pressure of a cylinder in Pa, as one in bar without its unit lies below."""
CLOSING_RTOL = 0.02
"""Share of the peak by which the two ends of a pressure trace may differ, for measuring noise and drift."""
LEAST_SAMPLES = 24
"""Smallest number of pressures in a cycle, as fewer cannot give the orders of a gas torque."""
WHOLE_CYCLE = "a cycle is 720 deg of a four-stroke engine, 360 deg of a two-stroke engine"
"""Hint for messages on pressure traces that cover another angle than a whole cycle."""


@dataclass(frozen=True)
class PressureTrace:
    """Pressures at even steps over one cycle, without its second end.

    Attributes
    ----------
    values : tuple of float
        Pa.
    start : float
        Crank angle of the first pressure, rad.
    revolutions : int, optional
        Revolutions that a file covers; a list covers the cycle of the engine.
    file : str
        Name of the file.
    place : Position, optional
        Position of the heading in that file.
    note : str
        Remark for the author, as on interpolation.
    """

    values: tuple[float, ...]
    start: float = 0.0
    revolutions: int | None = field(default=None, compare=False)
    file: str = field(default="", compare=False)
    place: Position | None = field(default=None, compare=False)
    note: str = field(default="", compare=False)

    def __str__(self) -> str:
        low, high = min(self.values) / 1e5, max(self.values) / 1e5
        text = "{count} pressures of {file}, {low:.4g} to {high:.4g} bar"
        if not self.file:
            text = "{count} pressures, {low:.4g} to {high:.4g} bar"
        return phrase(text, count=len(self.values), file=self.file, low=low, high=high)

    @property
    def origin(self) -> str:
        """Text with which messages on the trace begin: its file, or nothing."""
        return f"{self.file}: " if self.file else ""

    def tangential(self, ratio: float, revolutions: int, zero: float, below: float) -> tuple[FloatArray, FloatArray]:
        """Angles in rad after firing top dead centre and tangential pressures in Pa, each of shape (n_samples,).

        ``zero`` is the angle of the trace at firing top dead centre, ``below`` the pressure under the piston.
        """
        # Tangential pressure (p - p_below) x'/r, work per angle over piston area and crank radius.
        angles = self.start - zero + 2 * np.pi * revolutions * np.arange(len(self.values)) / len(self.values)
        return angles, (np.array(self.values) - below) * piston_rate(angles, ratio)

    def harmonics(
        self, ratio: float, revolutions: int, orders: FloatArray, zero: float = 0.0, below: float = 0.0
    ) -> ComplexArray:
        """Complex tangential pressure in Pa by order, shape (n_orders,), from the samples without smoothing."""
        # Phases count from the first sample; exp(-j h phi_0) refers them to firing top dead centre.
        angles, tangential = self.tangential(ratio, revolutions, zero, below)
        return np.asarray(harmonics(tangential, revolutions, orders) * np.exp(-1j * orders * angles[0]))

    def mean_indicated_pressure(self, ratio: float, revolutions: int, zero: float = 0.0) -> float:
        """Mean indicated pressure of the trace in Pa, the work of a cycle over the swept volume."""
        # Work A r integral (p x' dphi) over the swept volume 2 A r: mean of p x' times 2 pi revolutions/2.
        _, tangential = self.tangential(ratio, revolutions, zero, 0.0)
        return float(np.mean(tangential) * np.pi * revolutions)


def peak_pressure_fault(trace: PressureTrace) -> str:
    """Message if the peak pressure of a trace is impossible for a cylinder, else an empty text."""
    peak = max(map(abs, trace.values))
    if peak < LOWEST_PEAK:
        meant = "is the column in another unit?" if trace.file else f"a bare number is Pa, write {peak:.6g} bar"
        return f"a peak of {peak:g} Pa ({peak / 1e5:.2g} bar) is too low for a cylinder; {meant}"
    return f"a peak of {peak / 1e5:g} bar is too high for a cylinder; check the unit" if peak > HIGHEST_PEAK else ""


# Reader of text files with pressure traces from makers and indicators.

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

    def fault(self, text: str, row: int, *, kind: str) -> Fault:
        return _fault(kind, text, self.file, self.numbers[row], self.lines)

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
    rows = _trace_rows(path)
    _refuse(_wrong_rows(rows), path)
    revolutions, both_ends = _covered(rows)
    _refuse(_not_closing(rows, both_ends, revolutions), path)
    trace = _trace(rows.without_last() if both_ends else rows, revolutions)
    _refuse(
        (
            _fault("implausible-size", text, path.name, rows.heading, rows.lines)
            for text in [peak_pressure_fault(trace)]
            if text
        ),
        path,
    )
    return trace


def _refuse(faults: Iterator[Fault], path: Path) -> None:
    wrong = list(faults)
    if wrong:
        raise ModelError(wrong, path.name)


def _fault(kind: str, text: str, file: str, number: int, lines: Sequence[str], heading: str = "") -> Fault:
    """Fault at a line of a trace file, counted from 1, or at a heading in it."""
    return Fault(text, position=line_position(file, number, lines, heading), kind=kind)


def _trace_rows(path: Path) -> _Rows:
    """Angles in degrees and pressures in Pa that a trace file has."""
    with path.open(encoding=detect_encoding(path), newline=None, errors="replace") as file:
        lines = file.readlines()
    above = next((at for at, line in enumerate(lines) if line.strip() and not line.startswith(("#", "%"))), 0)
    body = lines[above:]
    dialect = detect_dialect(body[:DIALECT_LINES])
    first = data_start(dialect, body[:DIALECT_LINES])
    if first == min(len(body), DIALECT_LINES):
        raise ModelError(
            [_fault("wrong-file", f"found no rows of numbers; expected {FORM} and rows below", path.name, 1, lines)]
        )
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
        raise ModelError([_fault("missing-column", text, file, number or 1, lines)], file)
    if not heading.lines:
        raise ModelError(
            [_fault("missing-column", f"no heading; the first line says what the columns are: {FORM}", file, 1, lines)],
            file,
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
    raise ModelError([_fault("wrong-unit" if text else "missing-unit", said, file, number, lines, name)], file)


def _unit(text: str) -> Unit | None:
    try:
        return parse_unit(plain_unit(text))
    except UnitError:
        return None


def _wrong_rows(rows: _Rows) -> Iterator[Fault]:
    for row in np.flatnonzero(~(np.isfinite(rows.angles) & np.isfinite(rows.pressures)))[:5].tolist():
        yield rows.fault("a number is missing; every row has an angle and a pressure", row, kind="not-a-number")
        return
    for row in np.flatnonzero(np.diff(rows.angles) <= 0)[:1].tolist():
        text = f"the angle {rows.angles[row + 1]:g} deg follows {rows.angles[row]:g} deg; angles increase"
        yield rows.fault(text, row + 1, kind="unordered-rows")
    if len(rows.angles) < LEAST_SAMPLES:
        text = f"{len(rows.angles)} pressures are too few for a cycle; give {LEAST_SAMPLES} or more"
        yield rows.fault(text, len(rows.angles) - 1, kind="unfit-curve")


def _covered(rows: _Rows) -> tuple[int, bool]:
    """Number of revolutions in a trace file, and whether it has both ends of the cycle."""
    step, span = float(np.median(np.diff(rows.angles))), float(rows.angles[-1] - rows.angles[0])
    for revolutions in (1, 2):
        # With one end a cycle lacks one step, with both none; half a step decides.
        missing = 360 * revolutions - span
        if -EVEN_STEP_TOL * step <= missing <= LARGEST_END_GAP * step:
            return revolutions, missing < step / 2
    text = f"the trace covers {rows.angles[0]:g} to {rows.angles[-1]:g} deg"
    text += f"; {WHOLE_CYCLE}, with one or both ends"
    raise ModelError([rows.fault(text, len(rows.angles) - 1, kind="unfit-curve")], rows.file)


def _not_closing(rows: _Rows, both_ends: bool, revolutions: int) -> Iterator[Fault]:
    p = rows.pressures
    allowed = CLOSING_RTOL * float(np.max(np.abs(p)))
    # Without the second end the pressures differ by what a step may change, as at a steep compression.
    if not both_ends:
        allowed = max(allowed, CLOSING_STEP_RATIO * float(np.max(np.abs(np.diff(p)))))
    if abs(p[0] - p[-1]) > allowed:
        text = f"the trace does not close: it begins with {p[0] / 1e5:.6g} bar and ends with {p[-1] / 1e5:.6g} bar"
        yield rows.fault(
            f"{text}; it covers 360 deg: {WHOLE_CYCLE}" if revolutions == 1 else text, len(p) - 1, kind="unfit-curve"
        )


def _trace(rows: _Rows, revolutions: int) -> PressureTrace:
    """Pressure trace in Pa at even steps of crank angle, the first at or after 0 degrees."""
    cycle, count = 360.0 * revolutions, len(rows.angles)
    step, note = cycle / count, ""
    angles: FloatArray = rows.angles
    pressures: FloatArray = rows.pressures
    # Angles rounded to a few decimals count as even, anything else is brought to the finest step.
    if np.max(np.abs(angles - angles[0] - step * np.arange(count))) > EVEN_STEP_TOL * step:
        steps = min(MOST_STEPS, round(cycle / float(np.min(np.diff(angles)))))
        note = f"{rows.file} has uneven steps; it is interpolated linearly at {steps} steps of a cycle"
        step = cycle / steps
        pressures = np.asarray(np.interp(step * np.arange(steps), angles, pressures, period=cycle))
        angles = np.arange(float(steps)) * step
    # The cycle is periodic: samples before 0 degrees move to its end.
    begin = angles[0] % cycle
    passed = int(np.ceil((cycle - begin) / step - EVEN_STEP_TOL)) % len(angles)  # samples before 0 degrees
    start = begin + passed * step - (cycle if passed else 0)
    start = 0.0 if abs(start) < EVEN_STEP_TOL * step else start
    values = tuple(np.roll(pressures, -passed).tolist())
    place = Position(rows.file, rows.heading, 1, 1)
    return PressureTrace(values, float(np.radians(start)), revolutions, rows.file, place, note)


# Entry for a pressure trace: a list of pressures, or the name of a file.

PRESSURE = Value("a pressure", "pressure", lower=None)
_ANGLE = Value("crank angle of the first pressure", "angle", lower=None)


class TraceEntry(Composite[PressureTrace]):
    """Entry for a pressure trace of a cylinder over one cycle.

    A list at even steps, a list with its first angle, or the name of a file.
    """

    @property
    def example(self) -> str:
        return "p100.csv, or a list of pressures"

    def read(self, raw: object) -> tuple[Any, list[Fault]]:
        if isinstance(raw, PressureTrace):
            return raw, []
        try:
            return self._read(raw)
        except EntryError as error:
            return None, error.faults
        except ModelError as error:
            return None, list(error.faults)

    def _read(self, raw: object) -> tuple[Any, list[Fault]]:
        if isinstance(raw, str | Path):
            return read_pressure_file(raw if isinstance(raw, Path) else nearby_file(raw)), []
        start = 0.0
        if isinstance(raw, Mapping):
            if set(raw) != {"start", "pressures"}:
                raise EntryError(f"expected {{start: 0.5 deg, pressures: [...]}}, {got(raw)}", kind="wrong-form")
            start, raw = _ANGLE.coerce(raw["start"]), raw["pressures"]
        if not isinstance(raw, Sequence | np.ndarray):
            raise EntryError(f"expected a list of pressures or the name of a file, {got(raw)}", kind="wrong-form")
        values, faults = _pressures(raw)
        faults = faults or [Fault(text, on_key=True, kind="unfit-curve") for text in _wrong_list(values)]
        return PressureTrace(tuple(values[:-1] if len(values) % 2 else values), start), faults

    def plain(self, value: Any) -> Json:
        """Plain list of pressures in Pa instead of the file name, so that a written model can be read anywhere."""
        return list(value.values) if not value.start else {"start": value.start, "pressures": list(value.values)}

    def schema(self) -> Schema:
        several: Schema = {"type": "array", "items": SCALAR_SCHEMA}
        begun: Schema = {
            "type": "object",
            "properties": {"start": SCALAR_SCHEMA, "pressures": several},
            "required": ["start", "pressures"],
            "additionalProperties": False,
        }
        return {"description": self.description, "anyOf": [several, {"type": "string"}, begun]}


def _pressures(raw: Sequence[Any] | np.ndarray[Any, Any]) -> tuple[list[float], list[Fault]]:
    """Pressures of a list in Pa, and the faults of entries that are no pressures."""
    values: list[float] = []
    faults: list[Fault] = []
    for index, pressure in enumerate(raw.tolist() if isinstance(raw, np.ndarray) else raw):
        plain = isinstance(pressure, float) and math.isfinite(pressure)
        value, wrong = (pressure, []) if plain else PRESSURE.read(pressure)
        faults += [fault.under(index) for fault in wrong]
        values += [] if wrong else [not_none(value)]
    return values, faults


def _wrong_list(values: Sequence[float]) -> Iterator[str]:
    """Messages on a list of too few pressures, or one that does not close.

    An odd list has both ends of the cycle: 721 values at 0 to 720 degrees are 720 steps.
    """
    if len(values) < LEAST_SAMPLES:
        yield f"{len(values)} pressures are too few for a cycle; give {LEAST_SAMPLES} or more"
        return
    if len(values) % 2 and abs(values[0] - values[-1]) > CLOSING_RTOL * max(map(abs, values)):
        text = f"the trace does not close: it begins with {values[0]:.6g} Pa and ends with {values[-1]:.6g} Pa"
        yield f"{text}; give the whole cycle, with or without its last point: {WHOLE_CYCLE}"
    elif text := peak_pressure_fault(PressureTrace(tuple(values))):
        yield text

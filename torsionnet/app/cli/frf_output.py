"""Frequency responses as tables for the screen and CSV, and as data for JSON."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np

from torsionnet.base.conventions import Conventions
from torsionnet.base.equal_remarks import collected_warnings
from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.linear.frequency_response import SIGN_NOTE, FloatArray, FrequencyResponse
from torsionnet.linear.phase import phase_at_zero_frequency
from torsionnet.linear.responses.grid import RANGE_BELOW, Peak, Solver, peaks, static_value, vibration_range

if TYPE_CHECKING:
    from collections.abc import Sequence

    from torsionnet.app.cli.command import ConfiguredCase


@dataclass(frozen=True)
class DisplayUnits:
    """Units in which responses are shown, and whether magnitudes are in dB."""

    conventions: Conventions
    decibels: bool

    def magnitude(self, value: float, scale: float) -> float:
        """Magnitude in the unit shown, or in dB, from a value in SI units and the scale of the unit shown."""
        if not self.decibels:
            return value * scale
        if math.isnan(value):
            return value
        return 20 * math.log10(value * scale / self.conventions.db_reference) if value else -math.inf

    def unit(self, unit: str) -> str:
        """Unit of a magnitude as text, with its reference value if magnitudes are in decibels."""
        return f"dB re {self.conventions.db_reference:g} {unit}" if self.decibels else unit


def output_input_pairs(response: FrequencyResponse) -> Iterator[tuple[int, int, str]]:
    """Index of output, index of input and label "output/input" of every transfer function."""
    for o, out in enumerate(response.outputs):
        for i, into in enumerate(response.inputs):
            yield o, i, f"{out.name}/{into.name}"


def peak_table(response: FrequencyResponse, solve: Solver, shown: DisplayUnits) -> Table:
    """Table of a frequency response, with a row for the static value and each peak of every transfer function."""
    conventions = shown.conventions
    columns = (
        Column("response"),
        Column("unit"),
        Column("at"),
        Column("frequency", conventions.frequency, 5),
        Column("magnitude"),
        Column("phase", "deg", 4),
    )
    rows = []
    for o, i, label in output_input_pairs(response):
        scale, unit = response.scale(conventions, o, i), shown.unit(response.unit(o, i, conventions))
        for name, peak in _points(response, solve, o, i):
            magnitude = shown.magnitude(peak.magnitude, scale)
            rows.append((label, unit, name, peak.frequency * conventions.frequency_scale, magnitude, peak.phase))
    low, high = (edge * conventions.frequency_scale for edge in (response.frequencies[0], response.frequencies[-1]))
    span = f"{len(response.frequencies)} frequencies from {low:g} to {high:g} {conventions.frequency}"
    return Table(response.title, columns, tuple(rows), (span, *map(str, _notes(response, solve)), SIGN_NOTE))


def _notes(response: FrequencyResponse, solve: Solver) -> tuple[NoteOrText, ...]:
    """Notes on a frequency response with its static values, which read tables over frequency at 0 Hz."""
    with collected_warnings(Counter()):  # of infinite values, which the table shows
        return solve(np.array([0.0, *response.frequencies[[0, -1]]])).notes


def _points(response: FrequencyResponse, solve: Solver, o: int, i: int) -> Iterator[tuple[str, Peak]]:
    value = static_value(solve, o, i)
    yield "static", Peak(0.0, abs(value), phase_at_zero_frequency(value))
    for number, peak in enumerate(peaks(response, solve, o, i), 1):
        yield f"peak {number}", peak


def full_table(response: FrequencyResponse, shown: DisplayUnits) -> Table:
    """Table of a frequency response, with a row for each frequency in Hz; magnitudes in dB if asked for."""
    table = response.table(shown.conventions)
    if not shown.decibels:
        return table
    levels = response.decibels(shown.conventions)
    columns, rows = list(table.columns), [list(row) for row in table.rows]
    headings = [column.name for column in columns]
    for o, i, label in output_input_pairs(response):
        index = headings.index(f"|{label}|")
        columns[index] = Column(f"|{label}|", shown.unit(response.unit(o, i, shown.conventions)))
        for row, level in zip(rows, levels[:, o, i], strict=True):
            row[index] = float(level)
    return Table(table.title, tuple(columns), tuple(map(tuple, rows)), table.notes)


@dataclass(frozen=True, eq=False)
class ResponseCurve:
    """Complex transfer function of one output to one input in the angle unit chosen, at all frequencies.

    Calculated ones have their static value and peaks, estimated ones their coherence.
    """

    output: str
    input: str
    quantity: str
    unit: str
    real: FloatArray
    imag: FloatArray
    coherence: FloatArray | None = None
    static: Annotated[complex, Out(after="unit")] = math.nan
    peaks: Annotated[tuple[Peak, ...], Out(after="static")] = ()


@dataclass(frozen=True, eq=False)
class ResponseCurves:
    """Frequency response in the angle unit chosen, curve by curve."""

    title: str
    notes: tuple[NoteOrText, ...]
    usable_up_to: Annotated[float | None, Out(json="usable_up_to_Hz")]
    frequencies: Annotated[FloatArray, Out(json="frequencies_Hz")]
    responses: tuple[ResponseCurve, ...]


OF_ESTIMATES, OF_SOLVERS = ("usable_up_to", "coherence"), ("static", "peaks")
"""Fields of curves that only estimates have, and only calculated responses: JSON of the others leaves them out."""


def solved_curves(response: FrequencyResponse, solve: Solver, conventions: Conventions) -> ResponseCurves:
    """Curves of a calculated response with static values and peaks, in the angle unit chosen."""
    curves = []
    for (o, i, _), curve in zip(output_input_pairs(response), _curves(response, conventions), strict=True):
        scale = response.scale(conventions, o, i)
        scaled = tuple(replace(peak, magnitude=peak.magnitude * scale) for peak in peaks(response, solve, o, i))
        curves.append(replace(curve, static=static_value(solve, o, i) * scale, peaks=scaled))
    return ResponseCurves(
        response.title, (*_notes(response, solve), SIGN_NOTE), None, response.frequencies, tuple(curves)
    )


def estimated_curves(response: FrequencyResponse, conventions: Conventions) -> ResponseCurves:
    """Curves of an estimated response with their coherence, in the angle unit chosen."""
    curves = tuple(_curves(response, conventions))
    return ResponseCurves(response.title, response.notes, response.usable_up_to, response.frequencies, curves)


def _curves(response: FrequencyResponse, conventions: Conventions) -> Iterator[ResponseCurve]:
    for o, i, _ in output_input_pairs(response):
        # Part by part: infinite values at a free turn times a complex scale are no numbers.
        values, scale = response.values[:, o, i], response.scale(conventions, o, i)
        names = response.outputs[o].name, response.inputs[i].name
        coherence = None if response.coherence is None else response.coherence[:, o, i]
        yield ResponseCurve(
            *names, response.kind(o, i), response.unit(o, i, conventions),
            values.real * scale, values.imag * scale, coherence,
        )  # fmt: skip


# Frequencies of a response from the command line: a list, a range, or a range chosen from the modes.

DEFAULT_POINTS, MOST_POINTS = 500, 1_000_000
"""Number of frequencies in a range unless ``--points`` is given, and the largest number that a list may have."""


@dataclass(frozen=True)
class Sampling:
    """Options on the frequencies of a response as given on the command line, in the unit chosen there.

    None: not given.
    """

    band: tuple[float, float] | None = None
    points: int | None = None
    logarithmic: bool | None = None
    listed: str | None = None

    def frequencies(self, cases: Sequence[ConfiguredCase], scale: float) -> FloatArray:
        """Frequencies of the response in Hz, shape (n_f,); ``scale`` converts Hz to the unit chosen."""
        if self.listed is not None:
            if any(given is not None for given in (self.band, self.points, self.logarithmic)):
                raise UsageError("give --frequencies, or --band and --points, not both", kind="contradicting-entries")
            return read_list(self.listed) / scale
        start, stop = self.band or (
            end * scale for end in vibration_range(*(case.drivetrain.modes() for case in cases))
        )
        return frequency_range(start, stop, self.points or DEFAULT_POINTS, self.logarithmic) / scale


def frequency_range(start: float, stop: float, points: int, logarithmic: bool | None) -> FloatArray:
    """Frequencies from start to stop in the unit of both, linearly or logarithmically spaced, shape (points,).

    ``logarithmic`` None: if the range is more than a decade and does not begin at 0.
    """
    if not (math.isfinite(start) and math.isfinite(stop) and 0 <= start < stop):
        raise UsageError(
            f"--band must not begin below 0 and must end above its beginning, got {start:g} and {stop:g}",
            kind="unordered-rows",
        )
    if logarithmic is None:
        logarithmic = 0 < start <= stop / RANGE_BELOW
    if logarithmic and start == 0:
        raise UsageError(
            "a logarithmic range cannot begin at 0; give --band a lowest frequency above 0", kind="out-of-range"
        )
    return np.asarray(np.geomspace(start, stop, points) if logarithmic else np.linspace(start, stop, points))


def read_list(text: str) -> FloatArray:
    """Frequencies in Hz, shape (n,), from ``0.1:40:0.1`` (start:stop:step, the stop included) or ``1,2,5.5``.

    >>> read_list("0:1:0.25,5").tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0, 5.0]
    """
    parts = [_part(part, text) for part in text.split(",")]
    frequencies = np.unique(np.concatenate(parts))
    if frequencies[0] < 0:
        raise UsageError(f"a frequency must not be negative, got {frequencies[0]:g} Hz", kind="out-of-range")
    return frequencies


def _part(part: str, text: str) -> FloatArray:
    try:
        numbers = [float(number) for number in part.split(":")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 3) or not all(map(math.isfinite, numbers)):
        raise _unreadable(text)
    if len(numbers) == 1:
        return np.array(numbers)
    start, stop, step = numbers
    if step <= 0 or stop < start:
        raise _unreadable(text)
    count = math.floor((stop - start) / step * (1 + 1e-12) + 1e-9) + 1
    if count > MOST_POINTS:
        raise UsageError(
            f'"{part}" are {count} frequencies, and at most {MOST_POINTS} are calculated at once: take a larger step',
            kind="too-large",
        )
    return np.asarray(start + step * np.arange(count), dtype=np.float64)


def _unreadable(text: str) -> UsageError:
    return UsageError(f'frequencies are written "start:stop:step" or "1,2,5", got "{text}"', kind="wrong-form")

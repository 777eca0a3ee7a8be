"""Frequency responses as tables for the screen and CSV, and as data for JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from torsionnet.cli.cases import ConfiguredCase
from torsionnet.response import Column, Conventions, FrequencyResponse, Table
from torsionnet.response.frequency_response import SIGN_NOTE
from torsionnet.response.phase import phase_at_zero_frequency
from torsionnet.solve.responses.peaks import Peak, Solver, peaks, static_value


@dataclass(frozen=True)
class DisplayUnits:
    """Units in which responses are shown, and whether magnitudes are in dB."""

    conventions: Conventions
    decibels: bool

    def magnitude(self, value: float, scale: float) -> float:
        """Magnitude in the unit shown, or in dB, from an SI value and the scale of its unit."""
        if not self.decibels:
            return value * scale
        if math.isnan(value):
            return value
        return 20 * math.log10(value * scale / self.conventions.db_reference) if value else -math.inf

    def unit(self, unit: str) -> str:
        """Unit as text, with its dB reference if magnitudes are in dB."""
        return f"dB re {self.conventions.db_reference:g} {unit}" if self.decibels else unit


def output_input_pairs(response: FrequencyResponse) -> Iterator[tuple[int, int, str]]:
    """Index of output, index of input and label "output/input" of every transfer function."""
    for o, out in enumerate(response.outputs):
        for i, into in enumerate(response.inputs):
            yield o, i, f"{out.name}/{into.name}"


def peak_table(response: FrequencyResponse, solve: Solver, shown: DisplayUnits) -> Table:
    """Table of a response with a row for the static value and for each peak of every transfer function."""
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
    return Table(response.title, columns, tuple(rows), (span, *response.notes, SIGN_NOTE))


def _points(response: FrequencyResponse, solve: Solver, o: int, i: int) -> Iterator[tuple[str, Peak]]:
    value = static_value(solve, o, i)
    yield "static", Peak(0.0, abs(value), phase_at_zero_frequency(value))
    for number, peak in enumerate(peaks(response, solve, o, i), 1):
        yield f"peak {number}", peak


def full_table(response: FrequencyResponse, shown: DisplayUnits) -> Table:
    """Table of a response with a row per frequency; magnitudes in dB if asked for."""
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


def response_json(
    case: ConfiguredCase, response: FrequencyResponse, solve: Solver, conventions: Conventions
) -> dict[str, Any]:
    """JSON data of a response: complex values in the angle unit chosen, static values, peaks; frequencies in Hz."""
    return {
        "title": response.title,
        "configuration": case.configuration,
        "notes": [*response.notes, SIGN_NOTE],
        "frequencies_Hz": response.frequencies.tolist(),
        "responses": [_pair(response, solve, conventions, o, i) for o, i, _ in output_input_pairs(response)],
    }


def _pair(response: FrequencyResponse, solve: Solver, conventions: Conventions, o: int, i: int) -> dict[str, Any]:
    scale = response.scale(conventions, o, i)
    static = static_value(solve, o, i) * scale
    found = [
        {"frequency_Hz": peak.frequency, "magnitude": peak.magnitude * scale, "phase_deg": peak.phase}
        for peak in peaks(response, solve, o, i)
    ]
    return curve_data(response, conventions, o, i, static=[static.real, static.imag], peaks=found)


def curve_data(response: FrequencyResponse, conventions: Conventions, o: int, i: int, **about: Any) -> dict[str, Any]:
    """JSON data of one transfer function in the angle unit chosen; ``about`` is added between unit and values."""
    values = response.values[:, o, i] * response.scale(conventions, o, i)
    return {
        "output": response.outputs[o].name,
        "input": response.inputs[i].name,
        "quantity": response.kind(o, i),
        "unit": response.unit(o, i, conventions),
        **about,
        "real": values.real.tolist(),
        "imag": values.imag.tolist(),
    }

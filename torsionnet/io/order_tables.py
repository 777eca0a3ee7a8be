"""Tables of measured orders in CSV files: of order tracking, or as ``torsionnet orders --csv`` writes them."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from torsionnet.core.errors import Fault, ModelError, Position, UsageError
from torsionnet.model.excitations.measured_columns import MeasuredLines, measured_lines
from torsionnet.response.frequency_response import Channel
from torsionnet.response.order_comparison import MeasuredOrder

FORM = "speed [rpm], order, amplitude [N*m]"
UNITS = {"torque": "N*m", "angle": "rad", "speed": "rad/s", "acceleration": "rad/s^2"}
_OF_OUTPUT = re.compile(r"(?P<name>.*) (?P<part>real|imag) (?P<unit>\[.*\])")
_WRITTEN = ("excitation", "frequency [Hz]")
"""Columns of a file of ``torsionnet orders`` beside speed and order."""


def read_orders(path: str | os.PathLike[str], output: Channel, configuration: str = "") -> tuple[MeasuredOrder, ...]:
    """The orders of an output in a file, with their speeds.

    Parameters
    ----------
    path : path
        Headings with units and rows below: speed, order, and amplitude, rms or peak_to_peak, or real and imag; or a
        file of ``torsionnet orders``, of which the columns of the output are taken, and orders of the reference shaft.
    output : Channel
    configuration : str, optional
        Whose rows are taken of a file with several.

    Raises
    ------
    ModelError
        A line that is no row of numbers.
    UsageError
        No such file or columns, or amplitudes in a unit of something else.
    """
    rows = _cells(Path(path))
    heading = rows[0][1]
    if all(name in heading for name in _WRITTEN):
        lines = _of_this_package(Path(path).name, rows, output, configuration)
    else:
        lines = measured_lines(heading, np.array([_numbers(Path(path).name, *row, len(heading)) for row in rows[1:]]))
    if not lines.speeds or lines.by_frequency:
        raise UsageError(f"{Path(path).name} has no amplitudes by speed and order; expected {FORM}")
    if UNITS[lines.quantity] != output.unit:
        raise UsageError(f"{Path(path).name} is in {UNITS[lines.quantity]}, but {output.name} is in {output.unit}")
    groups = zip(lines.keys.tolist(), lines.speeds, lines.values, strict=True)
    return tuple(MeasuredOrder(order, speeds, np.abs(values)) for order, speeds, values in groups)


def _cells(path: Path) -> list[tuple[int, list[str]]]:
    """Number and cells of every line that is neither empty nor a remark; the first is the heading."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise UsageError(f"{path.name} is no text file; expected {FORM}") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"]
    if len(lines) < 2:
        raise UsageError(f"{path.name} has no rows below a heading; expected {FORM}")
    separator = max(";\t,", key=lines[0][1].count)
    cells = csv.reader([line for _, line in lines], delimiter=separator)
    return [(number, [cell.strip() for cell in row]) for (number, _), row in zip(lines, cells, strict=True)]


def _numbers(file: str, number: int, cells: Sequence[str], width: int) -> list[float]:
    place = Position(file, number, 1, 1, ", ".join(cells)[:200])
    if len(cells) != width:
        raise ModelError([Fault(f"the row has {len(cells)} cells, the heading has {width}", position=place)], file)
    try:
        return [float(cell) for cell in cells]
    except ValueError:
        wrong = next(cell for cell in cells if not _is_number(cell))
        raise ModelError([Fault(f'"{wrong}" is not a number', position=place)], file) from None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _of_this_package(
    file: str, rows: Sequence[tuple[int, list[str]]], output: Channel, configuration: str
) -> MeasuredLines:
    """Real and imaginary parts of the output, lines of one frequency added, by orders of the reference shaft."""
    heading = rows[0][1]
    parts = {}
    for place, name in enumerate(heading):
        match = _OF_OUTPUT.fullmatch(name)
        if match and match["name"] == output.name:
            parts[match["part"]] = (place, match["unit"])
    if len(parts) < 2:
        raise UsageError(f"{file} has no columns of {output.name}")
    chosen = list(rows[1:])
    if "configuration" in heading:
        of = heading.index("configuration")
        known = dict.fromkeys(cells[of] for _, cells in chosen)
        if len(known) > 1 and configuration not in known:
            raise UsageError(f"{file} has the configurations {', '.join(known)}; choose one of them with -c")
        chosen = [row for row in chosen if len(known) == 1 or row[1][of] == configuration]
    places = [heading.index("speed [rpm]"), heading.index("frequency [Hz]"), parts["real"][0], parts["imag"][0]]
    numbers = np.array([_numbers(file, number, [cells[place] for place in places], 4) for number, cells in chosen])
    sums: dict[tuple[float, float], complex] = {}
    for speed, frequency, real, imag in numbers.tolist():
        key = (speed, round(60 * frequency / speed, 9))
        sums[key] = sums.get(key, 0) + complex(real, imag)
    table = np.array([(speed, order, value.real, value.imag) for (speed, order), value in sums.items()])
    return measured_lines(["speed [rpm]", "order", *(f"{part} {parts[part][1]}" for part in ("real", "imag"))], table)

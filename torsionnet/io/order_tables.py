"""Reading of measured orders from CSV files, tables of order tracking, or files of ``torsionnet orders --csv``."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from torsionnet.base.delimited.dialect import detect_encoding
from torsionnet.base.errors import UsageError
from torsionnet.io.tracked_order_tables import is_tracked_table, read_tracked_orders
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.excitations.measured_columns import MeasuredLines, measured_lines
from torsionnet.machinery.excitations.order_table_file import read_order_table
from torsionnet.machinery.orders.order_sums import is_sum_name
from torsionnet.signals.orders.tracked_orders import MeasuredOrder, TrackedOrders

EXPECTED_COLUMNS = "speed [rpm], order, amplitude [N*m]"
"""Columns of an order table, as error messages name them."""
LINE_UNITS = {"torque": "N*m", "angle": "rad", "speed": "rad/s", "acceleration": "rad/s^2"}
"""SI unit of the amplitudes in an order table by quantity."""
_OF_OUTPUT = re.compile(r"(?P<name>.*) (?P<part>real|imag) (?P<unit>\[.*\])")
_WRITTEN = ("excitation", "frequency [Hz]")
"""Columns of a file of ``torsionnet orders``, beside speed and order, by which such a file is recognised."""


def read_orders(path: str | os.PathLike[str], output: Channel, configuration: str = "") -> tuple[MeasuredOrder, ...]:
    """Measured orders of an output in a file, with amplitudes in the SI unit of the output over speed in rad/s.

    Parameters
    ----------
    path : path
        Headings with units and rows below: speed, order, and amplitude, rms or peak_to_peak, with or without phase, or
        real and imag, with or without half_width; or a file of ``torsionnet orders`` or of ``torsionnet track``, of
        which the columns of the output are taken, and orders of the reference shaft.
    output : Channel
    configuration : str, optional
        Configuration whose rows are taken from a file with several.

    Raises
    ------
    ModelError
        A line that is no row of numbers, or headings that mean nothing.
    UsageError
        No such file or columns, or amplitudes in a unit of something else.
    """
    if is_tracked_table(path):
        return tracked_channel(path, output).measured()
    rows = _cells(Path(path))
    if _is_written(rows):
        lines = _of_this_package(Path(path).name, rows, output, configuration)
    else:
        columns, numbers = read_order_table(Path(path))
        lines = measured_lines(columns, np.array(numbers))
    if not lines.speeds or lines.by_frequency:
        raise UsageError(f"{Path(path).name} has no amplitudes by speed and order; expected {EXPECTED_COLUMNS}")
    if LINE_UNITS[lines.quantity] != output.unit:
        raise UsageError(f"{Path(path).name} is in {LINE_UNITS[lines.quantity]}, but {output.name} is in {output.unit}")
    return tuple(
        MeasuredOrder(
            order,
            lines.speeds[line],
            np.abs(lines.values[line]),
            lines.values[line] if lines.has_phase else None,
            lines.half_widths[line] if lines.half_widths else None,
        )
        for line, order in enumerate(lines.keys.tolist())
    )


def tracked_channel(path: str | os.PathLike[str], output: Channel) -> TrackedOrders:
    """Tracked orders (SI) of the channel with the name of an output, or of the only one with its unit."""
    tracked = read_tracked_orders(path)
    named = [one for one in tracked if one.name == output.name]
    fitting = named or [one for one in tracked if one.unit == output.unit]
    names = ", ".join(f"{one.name} in {one.unit}" for one in tracked)
    if len(fitting) != 1:
        which = "several channels" if fitting else "no channel"
        raise UsageError(
            f"{Path(path).name} has {which} for {output.name} in {output.unit}; there are {names}: name the channel as "
            "the output"
        )
    if fitting[0].unit != output.unit:
        raise UsageError(f"{Path(path).name}: {names}, but {output.name} is in {output.unit}")
    return fitting[0]


def is_written_table(path: str | os.PathLike[str]) -> bool:
    """Whether a file is of ``torsionnet orders`` or ``torsionnet track``, whose columns name the outputs."""
    return is_tracked_table(path) or _is_written(_cells(Path(path)))


def _is_written(rows: Sequence[list[str]]) -> bool:
    return bool(rows) and all(name in rows[0] for name in _WRITTEN)


def _cells(path: Path) -> list[list[str]]:
    """Cells of every line of an order table that is neither empty nor a comment."""
    try:
        text = path.read_text(encoding=detect_encoding(path), errors="replace")
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}") from None
    return list(csv.reader(line for line in text.splitlines() if line.strip() and line[0] != "#"))


def _of_this_package(file: str, rows: Sequence[list[str]], output: Channel, configuration: str) -> MeasuredLines:
    """Orders of the output in a file of ``torsionnet orders``, complex amplitudes in SI, equal frequencies added."""
    heading, *written = rows
    excitation = heading.index("excitation")
    chosen = [cells for cells in written if not is_sum_name(cells[excitation])]
    parts = {}
    for place, name in enumerate(heading):
        match = _OF_OUTPUT.fullmatch(name)
        if match and match["name"] == output.name:
            parts[match["part"]] = (place, match["unit"])
    if len(parts) < 2:
        text = f"{file} has no columns {output.name} real and {output.name} imag"
        raise UsageError(f"{text}; write it with torsionnet orders --csv --output {output.name}")
    if "configuration" in heading:
        of = heading.index("configuration")
        known = dict.fromkeys(cells[of] for cells in chosen)
        if len(known) > 1 and configuration not in known:
            raise UsageError(f"{file} has the configurations {', '.join(known)}; choose one of them with -c")
        chosen = [cells for cells in chosen if len(known) == 1 or cells[of] == configuration]
    places = [heading.index("speed [rpm]"), heading.index("frequency [Hz]"), parts["real"][0], parts["imag"][0]]
    try:
        numbers = np.array([[float(cells[place]) for place in places] for cells in chosen])
    except (IndexError, ValueError):
        raise UsageError(
            f"{file} has incomplete rows or cells without a number; write it again with torsionnet orders --csv"
        ) from None
    sums: dict[tuple[float, float], complex] = {}
    for speed, frequency, real, imag in numbers.tolist():
        key = (speed, round(60 * frequency / speed, 9))
        sums[key] = sums.get(key, 0) + complex(real, imag)
    table = np.array([(speed, order, value.real, value.imag) for (speed, order), value in sums.items()])
    return measured_lines(["speed [rpm]", "order", *(f"{part} {parts[part][1]}" for part in ("real", "imag"))], table)

"""Columns of a recording by order or frequency, recognised by their headings."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.machinery.excitations.order_excitation import ComplexArray, FloatArray

FORM = "order, amplitude [N*m], phase [deg]"
POWERS = {"torque": 0, "angle": 0, "speed": 1, "acceleration": 2}
"""Power of s over the angle that each recorded quantity has, by quantity; 0 for a torque."""
PEAKS = {"amplitude": 1.0, "rms": np.sqrt(2), "peak_to_peak": 0.5}
"""Factor from the recorded size of a line to its peak value, by name of the column."""
KEYS = ("order", "frequency", "speed")
KNOWN = (*KEYS, *PEAKS, "phase", "real", "imag", "half_width")
_HEADING = re.compile(r"\s*(\w+)\s*(?:\[([^\]]*)\])?\s*")


@dataclass(frozen=True, eq=False)
class MeasuredLines:
    """Recorded lines of a torque or motion by order (or Hz), with complex peak values in SI units over speed.

    Attributes
    ----------
    quantity : str
        torque, angle, speed or acceleration.
    by_frequency : bool
        Whether ``keys`` are frequencies in Hz; else they are orders.
    keys : (n_lines,) array
    speeds : tuple of (n,) arrays
        rad/s, rising, of each line; empty where the recording has no speeds.
    values : tuple of (n,) complex arrays
        Peak values in SI; one where there are no speeds.
    has_phase : bool
        Whether the recording states phases.
    half_widths : tuple of (n,) arrays
        Half width of the 95 % interval of real and imaginary part, SI, of each line; empty where none is stated.
    """

    quantity: str
    by_frequency: bool
    keys: FloatArray
    speeds: tuple[FloatArray, ...]
    values: tuple[ComplexArray, ...]
    has_phase: bool = True
    half_widths: tuple[FloatArray, ...] = ()

    def at(self, line: int, speeds: FloatArray) -> ComplexArray:
        """Complex peak values in SI units of a recorded line at speeds in rad/s, shape (n_speeds,).

        Magnitude and phase are interpolated linearly.
        """
        values = self.values[line]
        if not self.speeds:
            return np.full(len(speeds), values[0])
        size = np.interp(speeds, self.speeds[line], np.abs(values))
        return np.asarray(size * np.exp(1j * np.interp(speeds, self.speeds[line], np.unwrap(np.angle(values)))))


def measured_lines(headings: Sequence[str], rows: FloatArray) -> MeasuredLines:
    """Lines by order or frequency from rows of a recording, shape (n, n_columns), under given headings.

    Raises
    ------
    UsageError
        A column is unknown, missing or without unit, or two rows give the same line.

    Examples
    --------
    >>> found = measured_lines(["order", "rms [N*m]", "phase [deg]"], np.array([[2.0, 10, 90], [4, 1, 0]]))
    >>> found.keys.tolist(), found.quantity, [complex(value[0].round(3)) for value in found.values]
    ([2.0, 4.0], 'torque', [14.142j, (1.414+0j)])
    """
    columns = _columns(headings)
    key = _key(columns)
    numbers = {name: rows[:, place] for name, (place, _) in columns.items()}
    quantity, values = _values(columns, numbers)
    has_phase = "phase" in columns or "real" in columns
    widths = _half_widths(columns, numbers, quantity)
    keys = numbers[key] * (_factor(columns[key][1], "frequency", key) if key == "frequency" else 1)
    if (keys <= 0).any():
        raise UsageError(f"{key} is above 0; the mean value is no vibration, leave its row out")
    speeds = numbers["speed"] * _factor(columns["speed"][1], "speed", "speed") if "speed" in columns else None
    found = np.unique(keys)
    groups = [np.flatnonzero(keys == one) for one in found]
    if speeds is None:
        _require(
            all(len(group) == 1 for group in groups), f"every {key} has one row, unless there is a column of speeds"
        )
        return MeasuredLines(
            quantity, key == "frequency", found, (), _parts(values, groups), has_phase, _parts(widths, groups)
        )
    sorted_groups = [group[np.argsort(speeds[group])] for group in groups]
    _require(
        all((np.diff(speeds[group]) > 0).all() for group in sorted_groups), f"every {key} has one row at each speed"
    )
    at, of = _parts(speeds, sorted_groups), _parts(values, sorted_groups)
    return MeasuredLines(quantity, key == "frequency", found, at, of, has_phase, _parts(widths, sorted_groups))


def _parts(values: NDArray[Any] | None, groups: Sequence[NDArray[np.int64]]) -> tuple[NDArray[Any], ...]:
    return () if values is None else tuple(values[group] for group in groups)


def _half_widths(
    columns: dict[str, tuple[int, str]], numbers: dict[str, FloatArray], quantity: str
) -> FloatArray | None:
    """Half widths of the intervals in SI as of peak values, shape (n_rows,); None where no column states them."""
    if "half_width" not in columns:
        return None
    own, factor = _quantity("half_width", columns["half_width"][1])
    _require(own == quantity, f"half_width is one of {quantity}, as the amplitudes are")
    size = next((name for name in PEAKS if name in columns), "amplitude")
    return np.asarray(factor * PEAKS[size] * numbers["half_width"])


def _require(holds: bool, text: str) -> None:
    if not holds:
        raise UsageError(text)


def _columns(headings: Sequence[str]) -> dict[str, tuple[int, str]]:
    """Index and unit of each column of a recording, by the column's name."""
    found: dict[str, tuple[int, str]] = {}
    for place, heading in enumerate(headings):
        match = _HEADING.fullmatch(heading)
        name = match[1] if match else heading
        if match is None or name not in KNOWN:
            hint = did_you_mean(name, KNOWN)
            raise UsageError(f'"{heading}" is not a heading of a recording{hint}; known: {", ".join(KNOWN)}, as {FORM}')
        _require(name not in found, f"{name} is given by two headings; keep one of them")
        found[name] = place, (match[2] or "").strip()
    return found


def _key(columns: dict[str, tuple[int, str]]) -> str:
    given = [name for name in ("order", "frequency") if name in columns]
    _require(len(given) == 1, f"a recording has a column order or frequency [Hz], one of the two, as {FORM}")
    return given[0]


def _values(columns: dict[str, tuple[int, str]], numbers: dict[str, FloatArray]) -> tuple[str, ComplexArray]:
    """Name of the recorded quantity, and its complex peak values in SI units, shape (n_rows,)."""
    if "real" in columns and "imag" in columns:
        quantity, factor = _quantity("real", columns["real"][1])
        _require(_quantity("imag", columns["imag"][1]) == (quantity, factor), "real and imag must have the same unit")
        return quantity, np.asarray(factor * (numbers["real"] + 1j * numbers["imag"]))
    sizes = [name for name in PEAKS if name in columns]
    _require(len(sizes) == 1, f"a recording has one column of {', '.join(PEAKS)}, or real and imag, as {FORM}")
    quantity, factor = _quantity(sizes[0], columns[sizes[0]][1])
    values = np.asarray(factor * PEAKS[sizes[0]] * numbers[sizes[0]], dtype=np.complex128)
    if "phase" in columns:
        values *= np.exp(1j * numbers["phase"] * _factor(columns["phase"][1], "angle", "phase"))
    return quantity, values


def _quantity(name: str, unit: str) -> tuple[str, float]:
    for quantity in POWERS:
        try:
            return quantity, _factor(unit, quantity, name)
        except UsageError:
            continue
    raise UsageError(
        f'"{unit}" is not a unit of torque, angle, speed or acceleration; write the heading as {name} [N*m]'
    )


def _factor(unit: str, dimension: str, name: str) -> float:
    """Factor from the unit of a recording's column to the SI unit."""
    example = {"speed": "rpm", "angle": "deg", "frequency": "Hz"}.get(dimension, "N*m")
    if not unit or unit == "1":
        raise UsageError(f"the column {name} has no unit; write its heading as {name} [{example}]")
    try:
        return Value(name, dimension).coerce(f"1 {unit}")
    except EntryError:
        raise UsageError(f'"{unit}" is no unit of the column {name}; write its heading as {name} [{example}]') from None

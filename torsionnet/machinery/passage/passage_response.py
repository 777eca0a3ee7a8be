"""Response of a drivetrain to all orders along a speed over time, with its envelope, peaks and cycles.

Half ranges of a vibration over time in windows of one cycle, and number of its cycles above a level. Half range of
each, crests between samples, and how many exceed a level.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table, result_table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import Channel, FloatArray
from torsionnet.machinery.verdicts.speed_spans import spans_above

if TYPE_CHECKING:
    import pandas

# Half ranges of a vibration over time in windows of one cycle, and number of its cycles above a level.

WINDOWS_PER_CYCLE = 8
"""Number of overlapping windows, each one cycle long, that begin within each cycle: a shorter step than this changes a
half range by less than the growth of vibration in an eighth of a cycle."""


def crests(values: FloatArray) -> FloatArray:
    """Values over time (n,), in their unit, with local extremes replaced by those of parabolas through three samples.

    Examples
    --------
    >>> wave = np.cos(0.5 * np.arange(20) + 0.2)
    >>> round(float(wave.max()), 4), round(float(crests(wave).max()), 4)
    (0.9965, 0.9998)
    """
    refined = values.copy()
    if len(values) < 3:
        return refined
    before, here, after = values[:-2], values[1:-1], values[2:]
    bend = before - 2 * here + after
    # A sample no lower or no higher than both neighbours; the vertex lies (y_1 - y_3)^2/(-8 bend) beyond it.
    extreme = (here - before) * (after - here) <= 0
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(extreme & (bend != 0), (before - after) ** 2 / (-8 * bend), 0.0)
    refined[1:-1] = here + rise
    return refined


def envelopes(angles: FloatArray, values: FloatArray, cycle: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middle angles in rad of windows one cycle long, smallest and largest value in them, all (n,).

    Parameters
    ----------
    angles, values : (n,) arrays
        Angle of the shaft in rad, rising, and the vibration in any unit, which the envelopes have too.
    cycle : float
        Length of a cycle in rad; a shorter record is one window.

    Examples
    --------
    >>> angle = np.linspace(0, 20 * np.pi, 4001)
    >>> middle, low, high = envelopes(angle, 1 + 2 * np.cos(angle), 2 * np.pi)
    >>> round(float(low.max()), 3), round(float(high.min()), 3)
    (-1.0, 3.0)
    """
    exact = crests(values)
    count = int((angles[-1] - angles[0]) / cycle * WINDOWS_PER_CYCLE * (1 + 1e-12))
    if count < WINDOWS_PER_CYCLE:
        return np.array([(angles[0] + angles[-1]) / 2]), np.array([exact.min()]), np.array([exact.max()])
    # Windows of a cycle begin at every part of it: extremes of parts first, then over all parts of a window.
    edges = angles[0] + np.arange(count + 1) * cycle / WINDOWS_PER_CYCLE
    starts = np.searchsorted(angles, edges[:-1])
    last = int(np.searchsorted(angles, edges[-1], side="right"))
    starts = np.minimum(starts, last - 1)
    high, low = (operation.reduceat(exact[:last], starts) for operation in (np.maximum, np.minimum))
    wide = np.lib.stride_tricks.sliding_window_view
    most, least = (wide(high, WINDOWS_PER_CYCLE).max(axis=1), wide(low, WINDOWS_PER_CYCLE).min(axis=1))
    return edges[: len(most)] + cycle / 2, np.asarray(least), np.asarray(most)


def cycles_above(values: FloatArray, level: float) -> float:
    """Number of cycles of a vibration around zero whose amplitude exceeds a level, a half for each half cycle.

    Between two crossings of zero the largest value counts alone ("mean crossing peak counting", ASTM E1049-85, 5.2).

    Examples
    --------
    >>> cycles_above(np.cos(np.linspace(0, 20 * np.pi, 2000)) * np.linspace(0, 1, 2000), 0.52)
    5.0
    """
    positive = values > 0
    # Each stretch between changes of sign is a half cycle with one peak.
    starts = np.concatenate([[0], np.flatnonzero(positive[1:] != positive[:-1]) + 1])
    peaks = np.maximum.reduceat(np.abs(crests(values)), starts)
    return float((peaks > level).sum() / 2)


@dataclass(frozen=True, eq=False)
class PassagePeak:
    """Largest half range of an output along a speed over time, in its SI unit, with time in s and speed in r/min."""

    output: Annotated[str, Out("output")]
    half_range: Annotated[float, Out("largest half range", digits=5, unit_of="unit")]
    unit: Annotated[str, Out("unit", unit_of="unit")]
    time: Annotated[float, Out("time", "s", digits=5)]
    rpm: Annotated[float, Out("speed", "rpm", json="speed_rpm", digits=5)]


@dataclass(frozen=True, eq=False, repr=False)
class PassageResponse(SavedResult):
    """Vibration of outputs (SI) due to all orders along a speed (rad/s) over time (s), shape (n_t, n_out).

    The mean values are not part of it.

    Attributes
    ----------
    times : (n_t,) array
        s, from 0.
    speeds : (n_t,) array
        Speed of the reference shaft, rad/s.
    angles : (n_t,) array
        Angle of the reference shaft, rad; 0 at first unless a start angle is given.
    reference : str
        Node of the reference shaft.
    values : (n_t, n_out) array
        SI units of the outputs.
    outputs : tuple of Channel
    cycle : float
        Angle of the reference shaft in rad after which all orders repeat; of several shafts whose common cycle is too
        long for the passage, the longest cycle of one of them.
    error : float
        Estimated error of the values, over the largest of each output.
    title : str
        Name of the model with its configuration.
    notes : tuple of str
        What the values are based on.
    window_angles : (n_t,) array, optional
        Angle in rad that turns by a cycle while every line repeats; default: that of the shaft. Fixed frequencies and
        slips that repeat more slowly than the orders hold it back.
    """

    picture: ClassVar[str] = "passage_response"

    times: FloatArray
    speeds: FloatArray
    angles: FloatArray
    reference: str
    values: FloatArray
    outputs: tuple[Channel, ...]
    cycle: float = 2 * math.pi
    error: float = 0.0
    title: str = ""
    notes: tuple[str, ...] = ()
    window_angles: FloatArray | None = None

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft over time in r/min, shape (n_t,)."""
        return np.asarray(self.speeds * RPM)

    def output(self, name: str | None = None) -> int:
        """Index of an output of the passage by its name, or of the only output without one.

        Raises
        ------
        UsageError
            There is no such output, or there are several and none is named.
        """
        names = [channel.name for channel in self.outputs]
        if name is None and len(names) == 1:
            return 0
        if name not in names:
            what = f'no output is named "{name}"{did_you_mean(str(name), names)}' if name else "say which output"
            raise UsageError(f"{what}; there are {', '.join(names)}", kind="unknown-channel")
        return names.index(name)

    def of(self, output: str | None = None) -> FloatArray:
        """Values of an output over time in SI units, shape (n_t,)."""
        return np.asarray(self.values[:, self.output(output)])

    def envelope(self, output: str | None = None) -> tuple[FloatArray, FloatArray]:
        """Times in s, and half ranges (max - min)/2 in SI of an output within a cycle around each time, both (n,).

        At constant speed this is the half range of the order response, which limits judge.
        """
        times, low, high = self.bounds(output)
        return times, (high - low) / 2

    def bounds(self, output: str | None = None) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Times in s, smallest and largest value in SI of an output within a cycle around each time, all (n,)."""
        angles = self.angles if self.window_angles is None else self.window_angles
        middle, low, high = envelopes(angles, self.of(output), self.cycle)
        return np.interp(middle, angles, self.times), low, high

    def peak(self, output: str | None = None) -> PassagePeak:
        """Largest half range (SI) of an output along the speed, with its time in s and speed in r/min."""
        times, half_range = self.envelope(output)
        at, channel = int(np.argmax(half_range)), self.outputs[self.output(output)]
        rpm = float(np.interp(times[at], self.times, self.rpm))
        return PassagePeak(channel.name, float(half_range[at]), channel.unit, float(times[at]), rpm)

    def cycles_above(self, level: ArrayLike, output: str | None = None) -> float:
        """Number of vibration cycles of an output whose amplitude exceeds a level in SI, counted in half cycles.

        The level is one number or one for each time, above 0. Between two crossings of zero the largest value counts
        ("mean crossing peak counting", ASTM E1049-85, 5.2).
        """
        return cycles_above(self.of(output) / np.asarray(level), 1.0)

    def seconds_above(self, level: ArrayLike, output: str | None = None) -> float:
        """Time in s in which the half range of an output exceeds a level (SI), a number or an array (n_t,)."""
        times, half_range = self.envelope(output)
        levels = np.interp(times, self.times, np.broadcast_to(np.asarray(level, dtype=float), self.times.shape))
        return sum((span.high - span.low for span in spans_above(times, half_range, levels)), 0.0)

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of the largest half range of every output along the speed, with its time in s and speed in rpm."""
        peaks = [self.peak(channel.name) for channel in self.outputs]
        notes = (f"speeds of {self.reference}", *self.notes)
        return result_table(f"{self.title}: {self._words}", peaks, PassagePeak, conventions=conventions, notes=notes)

    def to_dataframe(self) -> pandas.DataFrame:
        """All values over time as a pandas.DataFrame, the columns of :meth:`long_table`."""
        return self.long_table().to_dataframe()

    def long_table(self, conventions: Conventions = SI) -> Table:
        """Table of the values of all outputs with a row for each time in s, and the speed in rpm."""
        columns = [Column("time", "s"), Column("speed", "rpm")]
        columns += [Column(channel.name, conventions.unit(channel.unit)) for channel in self.outputs]
        scales = np.array([conventions.scale(channel.unit) for channel in self.outputs])
        rows = np.column_stack([self.times, self.rpm, self.values * scales]).tolist()
        return Table(f"{self.title}: {self._words}", tuple(columns), tuple(map(tuple, rows)), self.notes)

    @property
    def _words(self) -> str:
        return f"from {self.rpm[0]:g} to {self.rpm[-1]:g} rpm in {self.times[-1] - self.times[0]:g} s"

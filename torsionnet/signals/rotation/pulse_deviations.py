"""Errors of the times and places of a wheel's pulses, and the pattern of these that a calibration finds.

What repeats from turn to turn are places of teeth or whole orders; what does not are times, or half orders. Both have
slow parts that are vibration: only the sixth difference from tooth to tooth is taken, in which independent errors grow
by sqrt(924) and order o of z by (2 sin(pi o/z))^6, at order 6 of 60 to a twentieth.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import comb, sqrt
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.entries.scalars import Value
from torsionnet.base.errors import comma_list
from torsionnet.base.notes import NoteOrText
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.pitch_order import ABOVE, CALCULATED, PitchOrder
from torsionnet.signals.rotation.wheel import WheelPattern

# Errors of the times and of the places of a wheel's pulses: what the counter leaves, and what the pulses show.

DIFFERENCES = 6
"""Number of times that differences from tooth to tooth are taken, so that orders up to a tenth of the teeth vanish."""
DIFFERENCE_GAIN = sqrt(comb(2 * DIFFERENCES, DIFFERENCES))
"""Factor by which the differences raise the standard deviation of independent errors."""
FEWEST_TURNS, FEWEST_TEETH = 3, 12
"""Fewest turns, and teeth of a turn, from which errors of times and places are told apart."""
NORMAL_FROM_MEDIAN = 1.4826
"""Standard deviation of normal errors over the median of their sizes, which single disturbances leave as it is."""
PULSES_TOGETHER = 2**17
"""Number of pulses whose differences are taken together, which limits the memory."""
UNIFORM_STEPS = sqrt(12)
"""Step of a counter over the standard deviation of the time it leaves."""


@dataclass(frozen=True)
class PulseDeviations:
    """Standard deviations of the times and of the places of a wheel's pulses.

    Attributes
    ----------
    tick : float
        Step of the counter, s; 0 where it is not known.
    jitter : float or None
        Standard deviation of the times that the pulses show, s, with that of the counter; None where they are too few.
    places : float or None
        Standard deviation of the places of the teeth on the wheel, rad, as far as they are independent from tooth to
        tooth; None where the pulses are too few.
    pattern : float or None
        That of a pitch pattern which was removed, rad, from its intervals; None without one.
    """

    tick: float = 0.0
    jitter: float | None = None
    places: float | None = None
    pattern: float | None = None

    @property
    def time(self) -> float:
        """Standard deviation of the times of pulses in s: what the counter leaves, or more if more is seen."""
        return max(self.tick / UNIFORM_STEPS, self.jitter or 0.0)

    @property
    def place(self) -> float:
        """Standard deviation of the places of teeth in rad on the wheel: by the pattern, or more if more is seen."""
        return max(self.pattern or 0.0, self.places or 0.0)


def seen_deviations(
    read: Callable[[slice], tuple[FloatArray, FloatArray]], numbers: NDArray[np.intp], teeth: int
) -> tuple[float | None, float | None]:
    """Standard deviations of the times in s and of the places in rad that pulses show, None where they are too few.

    Parameters
    ----------
    read : callable
        Angle of the wheel beyond a smooth course in rad, and its speed in rad/s, at a range of the pulses.
    numbers : (n,) int array
        Tooth of each pulse, counted on from turn to turn.
    teeth : int
    """
    turns = int(numbers[-1] - numbers[0]) // teeth
    if turns < FEWEST_TURNS or teeth < FEWEST_TEETH:
        return None, None
    sums, counts, of_speeds = np.zeros(teeth), np.zeros(teeth), 0.0
    sizes, count = np.empty((turns - 1) * teeth), 0
    together = max(PULSES_TOGETHER // teeth, 1)
    for turn in range(0, turns, together):
        last = turn + together >= turns
        steps, between, speeds = _turns(read, numbers, teeth, turn, None if last else turn + together)
        known = np.isfinite(steps)
        counts += known.sum(axis=0)
        sums += np.where(known, steps, 0.0).sum(axis=0)
        of_speeds += speeds
        sizes[count : count + len(between)] = between
        count += len(between)
    # Errors of times differ from turn to turn, errors of places stay in the mean over the turns.
    jitter = _standard_deviation(sizes[:count])
    some = counts > 0
    means = sums[some] / counts[some]
    if jitter is None or len(means) < 2:
        return jitter, None
    # Jitter, as an angle at the mean speed, stays in a mean over n turns by 1/sqrt(n); its square is taken off.
    of_times = jitter * of_speeds / len(numbers) / sqrt(float(counts[some].mean()))
    squared = float(np.mean(means**2)) / DIFFERENCE_GAIN**2 - of_times**2
    return jitter, sqrt(max(squared, 0.0))


def _turns(
    read: Callable[[slice], tuple[FloatArray, FloatArray]],
    numbers: NDArray[np.intp],
    teeth: int,
    begin: int,
    end: int | None,
) -> tuple[FloatArray, FloatArray, float]:
    """Differences from tooth to tooth in rad in the turns from ``begin`` up to ``end``, by turn and tooth.

    And what differs in the next turn, in s, where it is known; and the sum of the speeds at the pulses in rad/s.
    """
    turns = int(numbers[-1] - numbers[0]) // teeth
    stop, next_stop = end or turns, min((end or turns) + 1, turns)
    first = numbers[0] + begin * teeth
    # Differences need some teeth of the turn behind, and speeds the pulse behind it.
    count = min((next_stop - begin) * teeth + DIFFERENCES, (turns - begin) * teeth)
    low, own, high = np.searchsorted(numbers, [first, numbers[0] + stop * teeth, first + count])
    part = slice(int(low), len(numbers) if end is None else int(high) + 1)
    residuals, speeds = read(part)
    at = numbers[part] - first
    whole = np.full(count, np.nan)
    inside = at < count
    whole[at[inside]] = residuals[inside]
    # High differences take out vibration of low orders and keep the errors of single teeth.
    steps = np.diff(whole, DIFFERENCES)
    # A tooth has the same place a turn later, so that times alone differ; sqrt(2) as two errors add in squares.
    between = (steps[teeth:] - steps[:-teeth]) / sqrt(2)
    rates = np.interp(np.arange(len(between)) + teeth, at, speeds)
    differing = (between / rates)[: (stop - begin) * teeth]
    by_turn = np.concatenate([steps, np.full(DIFFERENCES, np.nan)])[: (stop - begin) * teeth].reshape(-1, teeth)
    return by_turn, differing[np.isfinite(differing)], float(speeds[: None if end is None else own - low].sum())


def _standard_deviation(differences: FloatArray) -> float | None:
    """Standard deviation of errors from their differences, which are overwritten; None where there are too few."""
    if len(differences) < 2:
        return None
    sizes = np.abs(differences, out=differences)
    return NORMAL_FROM_MEDIAN * float(np.median(sizes, overwrite_input=True)) / DIFFERENCE_GAIN


# Result of the calibration of a toothed wheel: its pattern, and order by order what is known of it.

MOST_LISTED = 12
"""Orders that a note lists at most, so that it stays short."""


@dataclass(frozen=True, eq=False, repr=False)
class WheelCalibration(SavedResult):
    """Calibrated wheel with its pitch pattern in rad, and with what is known of each order.

    Attributes
    ----------
    pattern : WheelPattern
        Of all orders that are resolved.
    orders : tuple of PitchOrder
        All whole orders up to half the teeth.
    speeds : tuple of float
        Lowest and highest speed of the reference shaft, rad/s.
    windows : int
        Windows of whole revolutions that were used.
    revolutions : int
        Of a window.
    angle : float or None
        From the first to the second pickup as the pulses say it, rad.
    angle_half_width : float or None
        Half width of its 95 % interval, rad.
    source : str
        Origin of calculated orders.
    known : bool
        Whether tooth 0 is the same in every record of the wheel.
    remarks : tuple of str
        Repairs of pulses, and how records were aligned.
    """

    picture: ClassVar[str] = "wheel_pattern"
    SHOWN: ClassVar = (
        "pattern.name", "pattern.teeth", "pattern.missing", "pattern.first", "lowest_rpm", "highest_rpm", "windows",
        "revolutions", "angle", "angle_half_width", "pattern.positions", "pattern.half_widths", "orders", "notes",
    )  # fmt: skip

    pattern: WheelPattern
    orders: tuple[PitchOrder, ...]
    speeds: tuple[float, float]
    windows: int
    revolutions: Annotated[int, Out(json="revolutions_of_a_window")]
    angle: Annotated[float | None, Out(json="angle_between_pickups_rad")] = None
    angle_half_width: Annotated[float | None, Out(json="angle_half_width_rad")] = None
    source: str = ""
    known: bool = True
    remarks: tuple[NoteOrText, ...] = ()

    @property
    def title(self) -> str:
        """Title of a calibration's table, with the number of teeth."""
        return f"Pitch pattern of {self.pattern.name or 'the wheel'}, {self.pattern.teeth} teeth"

    @property
    def lowest_rpm(self) -> Annotated[float, Out(json="lowest_speed_rpm")]:
        """Lowest speed of the reference shaft in r/min."""
        return self.speeds[0] * RPM

    @property
    def highest_rpm(self) -> Annotated[float, Out(json="highest_speed_rpm")]:
        """Highest speed of the reference shaft in r/min."""
        return self.speeds[1] * RPM

    @property
    def notes(self) -> tuple[NoteOrText, ...]:
        """Notes on speeds, methods, what is unresolved and why, as sentences."""
        speeds = f"{self.lowest_rpm:.4g} to {self.highest_rpm:.4g} rpm"
        notes = [f"{self.windows} windows of {self.revolutions} revolutions at {speeds}"]
        if self.angle is not None and self.angle_half_width is not None:
            angle, half = np.degrees([self.angle, self.angle_half_width])
            notes.append(f"two pickups, {angle:.4f} +-{half:.2g} degrees apart by the pulses themselves")
        if any(row.by == CALCULATED for row in self.orders):
            notes.append(f"vibration in orders 'calculated orders' is that of {self.source or 'the calculation'}")
        above = [row.order for row in self.orders if row.by == ABOVE]
        if above:
            notes.append(f"orders {above[0]} to {above[-1]} count as pattern: no vibration is sought there")
        notes += self._unresolved_notes()
        notes.append(f"tooth 0 is {self.pattern.first}" if self.pattern.first else "")
        notes.append("a pattern touches whole orders of the wheel only; unresolved ones are left out of the positions")
        return (*filter(None, notes), *self.remarks)

    def _unresolved_notes(self) -> list[str]:
        reasons: dict[str, list[PitchOrder]] = {}
        for row in self.orders:
            if not row.resolved:
                reasons.setdefault(row.why, []).append(row)
        return [
            f"not resolved: order {comma_list([_amount(row) for row in rows], MOST_LISTED)}: {why}"
            for why, rows in reasons.items()
        ]

    def stored(self) -> WheelPattern:
        """Pattern of the calibrated wheel in rad with the notes that its file keeps."""
        return replace(self.pattern, notes=tuple(map(str, self.notes)))

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of the pitch pattern order by order, with amplitude, interval and method."""
        scale, unit = conventions.scale("rad"), conventions.unit("rad")
        columns = (
            Column("order"),
            Column("amplitude", unit, 4),
            Column("half_width", unit, 2),
            Column("phase", "deg", 4),
            Column("resolved"),
            Column("by"),
            Column("gain", "", 3),
        )
        return Table(
            self.title, columns, tuple(self._row(row, scale) for row in self.orders), tuple(map(str, self.notes))
        )

    def _row(self, row: PitchOrder, scale: float) -> tuple[Any, ...]:
        half = row.half_width * scale if math.isfinite(row.half_width) else None
        phase = float(np.degrees(np.angle(row.value)))
        resolved = "yes" if row.resolved else "no"
        return (row.order, abs(row.value) * scale, half, phase, resolved, row.by, row.gain)


def _amount(row: PitchOrder) -> str:
    return f"{row.order} ({np.degrees(abs(row.value)):.2g} degrees)"


# Angles that a calibration of a wheel takes, with their units, for the command line and files.

PICKUP_ANGLE = Value(
    "angle from the first to the second pickup in the sense of rotation", "angle", exclusive=True, below=2 * math.pi
)
ZERO_ANGLE = Value("angle of the reference shaft at tooth 0", "angle", lower=None)
TICK = Value("time of one count of the counter", "time", exclusive=True)

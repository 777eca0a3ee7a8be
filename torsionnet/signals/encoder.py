"""Angle of incremental encoders from counts or from times of pulses, and removal of wrap-around."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import UsageError, warn_user
from torsionnet.signals.pulses import check_pulses, repaired_pulses
from torsionnet.signals.recording import FloatArray, Signal
from torsionnet.signals.resampling import even_times

if TYPE_CHECKING:
    from torsionnet.signals.bandlimited import Rotation


REVOLUTION = 2 * np.pi
"""Angle of one revolution in rad, the period at which an absolute encoder wraps around."""


def angle_from_counts(counts: ArrayLike, steps_per_revolution: float, bits: int | None = None) -> FloatArray:
    """Angle in rad (n,) from the counts of an encoder, without the wrap-around of a counter of ``bits`` bits.

    >>> angle_from_counts([254, 255, 0, 1], 4, bits=8).round(3).tolist()
    [398.982, 400.553, 402.124, 403.695]
    """
    if not steps_per_revolution > 0:
        raise UsageError(
            f"the steps per revolution must be a positive number, got {steps_per_revolution}", kind="out-of-range"
        )
    steps = np.asarray(counts, dtype=float)
    whole = steps if bits is None else np.unwrap(steps, period=2.0**bits)
    return whole * (REVOLUTION / steps_per_revolution)


def unwrapped(signal: Signal, period: float = REVOLUTION) -> Signal:
    """Angle signal in rad with the wrap-around of an encoder after ``period`` rad removed.

    >>> unwrapped(Signal("phi", "angle", np.array([6.0, 6.2, 0.1]))).values.round(3).tolist()
    [6.0, 6.2, 6.383]
    """
    if not period > 0:
        raise UsageError(f"the period must be a positive angle in rad, got {period}", kind="out-of-range")
    values = np.unwrap(signal.values, period=period)
    return replace(signal, values=values, notes=(*signal.notes, f"wrap-around of {period:.6g} rad removed"))


def angle_from_pulses(
    times: ArrayLike, steps_per_revolution: float, sampling_rate: float, *, fill: bool = True
) -> tuple[FloatArray, float]:
    """Angle in rad (n,) at uniform times from the times of an encoder's pulses, and the time in s of its first sample.

    The angle is exact at the pulses and band-limited between them: orders up to 5/6 of half the steps of a turn come
    out right, of 60 lines orders 6 and 15 within 1e-6 and order 25 within 0.05 %. Twenty pulses from the ends it is
    0.1 % of the amplitude of order 15, at the ends 10 %. Next to m pulses missing, orders up to half the steps of a
    turn over m + 1 are within 2 %. Take a sampling rate above twice the highest frequency that the shaft turns with,
    such as the rate of the pulses, and decimate afterwards.

    Parameters
    ----------
    times : (n,) array
        Time of every pulse, s; the shaft turns in one direction.
    steps_per_revolution : float
        Steps per revolution, missing teeth of a wheel with a gap included.
    sampling_rate : float
        Sampling rate of the angle, Hz.
    fill : bool
        Count missing pulses and leave out double ones as :func:`repaired_pulses` does, with a warning.

    Raises
    ------
    UsageError
        Pulses that cannot be repaired, or times and a rate that make far more samples than there are pulses.

    Examples
    --------
    >>> angle, start = angle_from_pulses(np.arange(9) / 8, 8, sampling_rate=2.0)
    >>> ((angle / np.pi).round(9) + 0.0).tolist(), start
    ([0.0, 1.0, 2.0], 0.0)
    """
    stamps, rotation, remarks = rotation_of(times, steps_per_revolution, fill=fill)
    for remark in remarks:
        warn_user(remark)
    even = even_times(float(stamps[0]), float(stamps[-1]), sampling_rate, len(stamps), "pulses")
    return angle_from_counts(rotation.at(even), steps_per_revolution), float(stamps[0])


def rotation_of(
    times: ArrayLike, steps_per_revolution: float, *, fill: bool = True
) -> tuple[FloatArray, Rotation, tuple[str, ...]]:
    """Times in s of the pulses kept, the rotation interpolated through them, and remarks on repairs of pulses."""
    from torsionnet.signals.bandlimited import Rotation

    stamps = check_pulses(times)
    if not fill:
        return stamps, Rotation(stamps, np.arange(len(stamps)), steps_per_revolution), ()
    repaired = repaired_pulses(stamps, steps_per_revolution)
    return repaired.times, Rotation(repaired.times, repaired.numbers, steps_per_revolution), repaired.remarks


# Times of pulses from a recorded channel that holds the output of an encoder.

Edge: TypeAlias = Literal["rising", "falling", "both"]
Pickup: TypeAlias = Literal["switching", "inductive"]

LOW_PERCENTILE, HIGH_PERCENTILE = 1.0, 99.0
"""Percentiles of a channel's values that are taken as the two levels of its pulses, so that single spikes do not
count."""
HYSTERESIS = 0.2
"""Share of the pulse height by which a signal must pass the middle on either side, so that noise makes no pulse."""
LEAST_SAMPLES_PER_PULSE = 4.0
"""Least number of samples from one pulse to the next, as with fewer the times of rises are not reliable."""


HALF_WAVES_AROUND = 15
"""Number of half waves around a sample whose largest gives the height of an inductive pickup's pulses there: more than
noise makes where the signal passes 0, few enough to follow the speed."""
LEAST_HEIGHT_SHARE = 0.01
"""Share of the usual height of an inductive pickup's pulses below which a signal is noise at standstill."""
SLOWEST, SMALLER_UNITS = 10.0, {"ms": 1e-3, "us": 1e-6, "ns": 1e-9}
"""Speed in rpm below which times of pulses without unit are not taken for s, and units in s that they may have."""
CUBIC_STEPS = 4
"""Newton steps from the straight line to the zero of a cubic, each of which doubles the digits."""


def refuse_unlikely_unit(times: FloatArray, pulses_per_turn: float) -> None:
    """Refuse times of pulses whose unit is not known, if they are hardly in s by the speed of the shaft.

    Raises
    ------
    UsageError
        With the speed, and the unit in which it would be usual.
    """
    duration = float(times[-1] - times[0]) if len(times) > 1 else 0.0
    speed = 60 * (len(times) - 1) / pulses_per_turn / duration if duration > 0 else np.inf
    if speed >= SLOWEST:
        return
    likely = next((unit for unit, factor in SMALLER_UNITS.items() if speed / factor >= SLOWEST), "")
    usual = f", in {likely} {speed / SMALLER_UNITS[likely]:.4g} rpm" if likely else ""
    raise UsageError(
        f"the times of the pulses have no unit: taken for s the shaft turns at {speed:.2g} rpm{usual}; give their "
        f"unit, {likely or 'ms'} or s, or the tick or clock if they are counts",
        kind="missing-unit",
    )


def holds_pulse_times(values: FloatArray) -> bool:
    """Whether a channel holds the times of pulses, which only increase, rather than the shape of pulses."""
    return len(values) > 2 and bool(np.all(np.diff(values) > 0))


def pulse_times(
    values: FloatArray,
    times: FloatArray,
    *,
    level: float | None = None,
    hysteresis: float = HYSTERESIS,
    edge: Edge = "rising",
    pickup: Pickup = "switching",
) -> FloatArray:
    """Times in s (n_pulses,) at which a signal passes the middle between its two levels.

    Noise of less than a fifth of the height makes no pulse.

    Parameters
    ----------
    values : (n,) array
        Voltage, or whatever was recorded.
    times : (n,) array
        Times of the samples, s.
    level : float, optional
        Value that the signal passes; by default the middle between its levels, of an inductive pickup its mean.
    hysteresis : float
        Share of the height, of an inductive pickup of the height around, by which it must pass on either side.
    edge : {"rising", "falling", "both"}
        Which passages are pulses. Both make a pitch that is uneven by the width of the teeth.
    pickup : {"switching", "inductive"}
        An inductive one has no direct component and grows with the speed: its height is that of the teeth around, and
        the passage is found on a cubic through four samples.

    Raises
    ------
    UsageError
        There are no pulses, or too few samples from one to the next.

    Examples
    --------
    >>> time = np.arange(2000) / 1000
    >>> pulse_times(np.where(np.sin(2 * np.pi * 10 * time) > 0, 5.0, 0.0), time)[:3].round(4)
    array([0.0005, 0.1005, 0.2005])
    """
    rising, falling = flanks(values, times, level=level, hysteresis=hysteresis, pickup=pickup)
    return {"rising": rising, "falling": falling}.get(edge, np.sort(np.concatenate([rising, falling])))


def flanks(
    values: FloatArray,
    times: FloatArray,
    *,
    level: float | None = None,
    hysteresis: float = HYSTERESIS,
    pickup: Pickup = "switching",
) -> tuple[FloatArray, FloatArray]:
    """Times in s at which a signal rises, and at which it falls, through a level; arguments as of :func:`pulse_times`.

    Raises
    ------
    UsageError
        There are no pulses, or too few samples from one to the next.
    """
    low, high = np.percentile(values, [LOW_PERCENTILE, HIGH_PERCENTILE])
    inductive = pickup == "inductive"
    if level is None:
        level = float(np.mean(values)) if inductive else float(low + high) / 2
    beyond = values - level
    height = _height_around(beyond, float(high - low)) if inductive else float(high - low)
    # A flank counts where the signal was clearly below the level before and is clearly above it afterwards.
    state = np.where(beyond > hysteresis * height, 1, np.where(beyond < -hysteresis * height, -1, 0))
    sure = np.flatnonzero(state)
    changes = np.diff(state[sure])
    passages = []
    for sign in (1, -1):
        before = sure[np.flatnonzero(sign * changes > 0)]
        passing = np.flatnonzero((sign * beyond[:-1] <= 0) & (sign * beyond[1:] > 0)) + 1
        passages.append(passing[np.searchsorted(passing, before, side="right")] if len(before) else before)
    if not high > low or len(passages[0]) < 2:
        raise UsageError(
            "there are no pulses: the signal does not rise between two levels at least twice; it lies between "
            f"{low:.4g} and {high:.4g}, and {level:.4g} was taken for the level",
            kind="lost-pulses",
        )
    spacing = float(np.median(np.diff(passages[0])))
    if spacing < LEAST_SAMPLES_PER_PULSE:
        raise UsageError(
            f"there are only {spacing:g} samples from pulse to pulse, {LEAST_SAMPLES_PER_PULSE:g} are needed; "
            "sample faster",
            kind="beyond-sampling",
        )
    share = _share_on_cubic if inductive else _share_on_line
    rising, falling = (
        np.asarray(times[after - 1] + share(beyond, after) * (times[after] - times[after - 1])) for after in passages
    )
    return rising, falling


def _height_around(beyond: FloatArray, usual: float) -> FloatArray:
    """Height of the pulses around each sample of a signal without direct component, (n,), in its unit."""
    from scipy.ndimage import maximum_filter1d

    starts = np.concatenate([[0], np.flatnonzero(np.diff(np.signbit(beyond))) + 1])
    extremes = np.maximum.reduceat(np.abs(beyond), starts)
    around = 2 * maximum_filter1d(extremes, HALF_WAVES_AROUND, mode="nearest")
    return np.repeat(np.maximum(around, LEAST_HEIGHT_SHARE * usual), np.diff(np.append(starts, len(beyond))))


def _share_on_line(beyond: FloatArray, after: NDArray[np.intp]) -> FloatArray:
    """Share of the sampling interval before each sample ``after`` at which a straight line passes 0."""
    return np.asarray(beyond[after - 1] / (beyond[after - 1] - beyond[after]))


def _share_on_cubic(beyond: FloatArray, after: NDArray[np.intp]) -> FloatArray:
    """Share of the sampling interval before each sample ``after`` at which the cubic through four samples passes 0."""
    share = _share_on_line(beyond, after)
    whole = (after >= 2) & (after <= len(beyond) - 2)
    a, b, c, d = (beyond[after[whole] + shift] for shift in (-2, -1, 0, 1))
    # Lagrange's cubic through samples at -1, 0, 1 and 2, by powers of the share.
    linear = -a / 3 - b / 2 + c - d / 6
    square, cube = a / 2 - b + c / 2, (d - a) / 6 + (b - c) / 2
    passage = share[whole]
    # Newton's steps from the straight line's passage, kept within the interval.
    for _ in range(CUBIC_STEPS):
        slope = linear + passage * (2 * square + 3 * cube * passage)
        value = b + passage * (linear + passage * (square + cube * passage))
        passage = np.clip(passage - np.where(slope != 0, value / np.where(slope != 0, slope, 1), 0), 0, 1)
    share[whole] = passage
    return share

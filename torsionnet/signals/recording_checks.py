"""Checks of a recording for faults (gaps, clipping, spikes, standstill, repetition, encoder errors)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from torsionnet.base.errors import Fault, UsageError, comma_list
from torsionnet.base.remedies import remedy
from torsionnet.signals.pulses import repaired_pulses
from torsionnet.signals.recording import QUANTITY_UNITS, FloatArray, Recording, Signal
from torsionnet.signals.repeated_blocks import repeated_blocks
from torsionnet.signals.rotation.turn_pattern import turn_pattern
from torsionnet.signals.sensor_resolution import step_of
from torsionnet.signals.spikes import spikes
from torsionnet.signals.standstill import frozen_stretches
from torsionnet.signals.timing import gaps, jitter
from torsionnet.signals.value_faults import Stretches, encoder_leaps, flat_tops, true_stretches, wrap_jumps

MOST_LISTED = 3
"""Number of places that the message on a fault of a recording lists at most, so that it stays short."""
MOST_JITTER = 0.01
"""Standard deviation of the sampling intervals over their mean above which sampling counts as not uniform."""
FEWEST_WINDOWS = 4
"""Number of windows in a record below which a warning is given, as averages over so few have large random errors."""


def check_recording(
    recording: Recording, window: float = 2.0, ranges: Mapping[str, float] | None = None
) -> tuple[Fault, ...]:
    """Faults of a recording that make it unfit, or questionable, for estimating frequency responses.

    Parameters
    ----------
    recording : Recording
    window : float
        Length of the windows of the estimate, s.
    ranges : mapping, optional
        By channel, the largest value it can measure, in SI; values that reach it are clipped.

    Returns
    -------
    tuple of Fault
        Errors first, then warnings, then notes.

    Examples
    --------
    >>> record = Recording((Signal("T_T", "torque", np.ones(100)),), sampling_rate=100.0)
    >>> for fault in check_recording(record):
    ...     print(fault)
    channels: error: the record lasts 1 s, less than one window of 2 s; record longer or take a shorter window
    channels.T_T: warning: constant at 1 N*m: the sensor may be dead, or not connected
    """
    found = [*_names(recording), *_length(recording, window), *_times(recording)]
    for signal in recording:
        found += [fault.under("channels", signal.name) for fault in _signal(signal, recording, ranges or {})]
    for channel in recording.pulses:
        if len(channel) > 1:
            found += [replace(fault, path=("channels", channel.name)) for fault in _pulses(channel.times)]
    order = ("error", "warning", "note")
    return tuple(sorted(found, key=lambda fault: order.index(fault.severity)))


def _names(recording: Recording) -> Iterator[Fault]:
    for name, count in Counter(recording.names).items():
        if count > 1:
            yield Fault(f"{count} channels are named {name}; rename all but one", ("channels", name))


def _length(recording: Recording, window: float) -> Iterator[Fault]:
    if not window:
        return
    windows = recording.duration / window
    if len(recording) < round(window * recording.sampling_rate):
        text = f"the record lasts {recording.duration:.6g} s, less than one window of {window:g} s"
        yield Fault(f"{text}; record longer or take a shorter window", ("channels",))
    elif windows < FEWEST_WINDOWS:
        text = f"the record has only {windows:.2g} windows of {window:g} s: few averages, large random errors"
        yield Fault(f"{text}; record longer", ("channels",), "warning")


def _times(recording: Recording) -> Iterator[Fault]:
    times = recording.times
    if times is None or len(times) < 2:
        return
    if not np.all(np.diff(times) > 0):
        at = int(np.flatnonzero(~(np.diff(times) > 0))[0])
        text = f"time stamps do not increase: {times[at + 1]:.9g} s follows {times[at]:.9g} s"
        yield Fault(f"{text}; cut the record there", ("time",))
        return
    if any(_counts_steps(signal) for signal in recording):
        yield from _pulses(times)
        return
    found = gaps(times)
    if len(found):
        where = comma_list([f"{times[at + 1] - times[at]:.4g} s after {times[at]:.6g} s" for at in found], MOST_LISTED)
        text = f"{len(found)} gap{'s' * (len(found) > 1)} in the time stamps: {where}"
        yield Fault(f"{text}; cut the record there", ("time",))
    spread = jitter(times)
    if spread > MOST_JITTER:
        text = f"sampling is not uniform: intervals vary by {100 * spread:.2g} % (standard deviation)"
        yield Fault(f"{text}; {remedy('resampled()')} makes it uniform", ("time",), "warning")


def _counts_steps(signal: Signal) -> bool:
    """Whether every sample of an angle is one encoder step further, so that the time stamps are pulses."""
    if signal.quantity != "angle" or len(signal.values) < 3:
        return False
    steps = np.diff(signal.values)
    return bool(steps[0] != 0 and np.allclose(steps, steps[0], rtol=1e-6, atol=0.0))


def _pulses(times: FloatArray) -> Iterator[Fault]:
    try:
        found = repaired_pulses(times)
    except UsageError as error:
        yield Fault(str(error), ("time",))
        return
    lost = found.irregular
    if lost.total:
        after = zip(found.times[lost.after], lost.counts, strict=True)
        where = comma_list([f"{count} after {time:.6g} s" for time, count in after], MOST_LISTED)
        text = f"{lost.total} encoder pulses are missing: {where}; {remedy('angle_from_pulses()')} counts them"
        yield Fault(text, ("time",))
    if len(found.left_out):
        where = comma_list([f"{time:.6g} s" for time in found.left_out], MOST_LISTED)
        text = f"{len(found.left_out)} encoder pulses too many: at {where}"
        yield Fault(f"{text}; {remedy('angle_from_pulses()')} leaves them out", ("time",))


def _signal(signal: Signal, recording: Recording, ranges: Mapping[str, float]) -> Iterator[Fault]:
    if signal.quantity not in QUANTITY_UNITS:
        says = f'unknown quantity "{signal.quantity}"' if signal.quantity else "quantity and unit are missing"
        yield Fault(f"{says}; give one of {', '.join(QUANTITY_UNITS)}")
    if not len(signal.values):
        return
    finite = np.isfinite(signal.values)
    if not finite.all():
        yield _not_finite(true_stretches(~finite), recording)
        if not finite.any():
            return
    values = signal.values[finite]
    if np.ptp(values) == 0 and len(values) > 1:
        yield Fault(f"constant at {values[0]:g} {signal.unit}: the sensor may be dead, or not connected", (), "warning")
    else:
        yield from _limits(signal, recording, ranges.get(signal.name))
        if signal.quantity in QUANTITY_UNITS and finite.all():
            yield from _disturbed(signal, recording)
        if signal.quantity == "angle" and finite.all():
            yield from _jumps(signal, recording)
        if signal.quantity in ("angle", "velocity") and finite.all() and recording.times is None:
            yield from _returning(signal, recording.sampling_rate)


def _not_finite(found: Stretches, recording: Recording) -> Fault:
    count = sum(last - first + 1 for first, last in found)
    where = comma_list([_time_span(first, last, recording) for first, last in found], MOST_LISTED)
    return Fault(f"{count} value{'s' * (count > 1)} NaN or infinite: {where}; cut them out or mend the record")


def _limits(signal: Signal, recording: Recording, limit: float | None) -> Iterator[Fault]:
    values = signal.values
    found = true_stretches(np.abs(values) >= limit) if limit is not None else flat_tops(values)
    if found:
        count = sum(last - first + 1 for first, last in found)
        where = comma_list([_time_span(first, last, recording) for first, last in found], MOST_LISTED)
        at = float(np.abs(values[found[0][0]]))
        yield Fault(f"clipped: {count} samples at the range of {at:.6g} {signal.unit}, {where}; take a larger range")


def _disturbed(signal: Signal, recording: Recording) -> Iterator[Fault]:
    """Yield the faults of a signal by spikes, stretches that stand still, and repeated blocks."""
    step = step_of(signal.values)
    found = spikes(signal.values, step)
    if len(found):
        where = comma_list(
            [f"{signal.values[at]:.6g} {signal.unit} at {recording.time[at]:.6g} s" for at in found], MOST_LISTED
        )
        text = f"{len(found)} single sample{'s' * (len(found) > 1)} far from those around: {where}"
        yield Fault(f"{text}; a disturbance, to be mended or cut out", (), "warning")
    still = frozen_stretches(signal.values, recording.sampling_rate, step)
    if still:
        where = comma_list([_time_span(first, last, recording) for first, last in still], MOST_LISTED)
        text = f"stands still where it moves before and after: {where}"
        yield Fault(f"{text}; samples may have been lost: cut it out, or record again", (), "warning")
    again = repeated_blocks(signal.values, recording.sampling_rate, step)
    if again:
        where = comma_list(
            (
                f"{_time_span(block.first, block.first + block.count - 1, recording)} as "
                f"{_time_span(block.source, block.source + block.count - 1, recording)}"
                for block in again
            ),
            MOST_LISTED,
        )
        text = f"repeats itself exactly: {where}"
        yield Fault(f"{text}; a buffer was recorded twice: cut it out, or record again", (), "warning")


def _returning(signal: Signal, rate: float) -> Iterator[Fault]:
    """Yield a warning on what returns with every turn in a speed or an angle, as the pitch errors of its wheel do."""
    speeds = signal.values if signal.quantity == "velocity" else np.gradient(signal.values) * rate
    found = turn_pattern(speeds, rate)
    if found is not None:
        yield Fault(found.words(), (), "warning" if found.constant else "note")


def _jumps(signal: Signal, recording: Recording) -> Iterator[Fault]:
    jumps, size = wrap_jumps(signal.values)
    if len(jumps):
        text = (
            f"the encoder wraps around: {len(jumps)} jumps of {size:.4g} rad, first at {recording.time[jumps[0]]:.6g} s"
        )
        yield Fault(f"{text}; {remedy('unwrapped()')} removes them")
        return
    found = encoder_leaps(signal.values)
    if len(found):
        where = comma_list([f"{recording.time[at]:.6g} s" for at in found], MOST_LISTED)
        yield Fault(f"the angle leaps by encoder steps at {where}: pulses are missing or too many", (), "warning")


def _time_span(first: int, last: int, recording: Recording) -> str:
    time = recording.time
    return f"at {time[first]:.6g} s" if first == last else f"from {time[first]:.6g} to {time[last]:.6g} s"

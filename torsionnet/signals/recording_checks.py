"""Checks of a recording for faults (gaps, clipping, spikes, standstill, repetition, encoder errors)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import Fault, UsageError, comma_list, remedy
from torsionnet.signals.pulses import repaired_pulses
from torsionnet.signals.recording import QUANTITY_UNITS, FloatArray, Recording, Signal
from torsionnet.signals.records.channel_choice import untold_quantities
from torsionnet.signals.resampling import gaps, jitter
from torsionnet.signals.rotation.turn_pattern import turn_pattern
from torsionnet.signals.uncertainty import step_of
from torsionnet.signals.value_faults import (
    Stretches,
    encoder_leaps,
    flat_tops,
    frozen_stretches,
    is_rough,
    spikes,
    true_stretches,
    wrap_jumps,
)

# Search of a signal for blocks of samples that repeat earlier ones exactly, such as a buffer recorded twice.

LEAST_TIME, LEAST_SAMPLES = 0.15, 24
"""Least length of a repeated block in s and in samples, as shorter ones may recur by chance."""
FEWEST_CHANGES, FEWEST_LEVELS = 20, 5
"""Fewest changes and fewest different values in a repeated block, as fewer recur by chance."""
SURPLUS_BITS = 20.0
"""Bits of information that a repeated block must hold beyond those of two positions in the record, so that chance makes
one in about a million."""
MOST_REPEATED_SHARE = 0.2
"""Largest share of a record that may be repeated blocks, as more is a periodic signal or a test that was run twice."""
MOST_PERIODS = 3
"""Length of a repeated block over its distance to the original above which it is a periodic signal, not a copy."""
MOST_EQUAL_NEIGHBOURS = 0.5
"""Largest share of samples beside a repeated block that recur at the same distance, as more do in a nearly periodic
signal."""
NOISE_REVERSALS = 0.1
"""Share of sign changes between the steps of a quantised signal above which it holds noise, as smooth motion has
fewer."""
KINK_RATIO = 5.0
"""Second difference at an end of a repeated block, over the largest within it, above which that end is a kink, as where
a buffer was copied in."""
_BASE, _MIX = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9
"""Odd 64-bit multipliers of the rolling hash of samples (constants of the splitmix64 generator, which mix bits
well)."""
_TABLE_BITS = 20
"""Number of bits of a hash that index the table for quick rejection, whose 2^20 entries fit in the cache."""

WholeArray = NDArray[np.uint64]


@dataclass(frozen=True)
class RepeatedBlock:
    """Block of ``count`` samples that begins at index ``first`` and equals those from index ``source`` on."""

    source: int
    first: int
    count: int


def repeated_blocks(values: FloatArray, sampling_rate: float, step: float = 0.0) -> list[RepeatedBlock]:
    """Blocks of a signal of 0.15 s or longer that are exact copies of earlier ones, in order of time.

    Periodic signals, signals at rest, and computed signals without noise that are smooth at both ends of the copy have
    none.

    Parameters
    ----------
    values : (n,) array
        Samples, all finite.
    sampling_rate : float
        Hz.
    step : float, optional
        Step of the sensor in the unit of the values; 0 if it has none.

    Examples
    --------
    >>> values = np.random.default_rng(1).normal(size=5000)
    >>> values[3000:3200] = values[1000:1200]
    >>> repeated_blocks(values, 1000.0)
    [RepeatedBlock(source=1000, first=3000, count=200)]
    """
    least = max(LEAST_SAMPLES, int(np.ceil(LEAST_TIME * sampling_rate - 1e-9)))
    if len(values) < 3 * least:
        return []
    plain = np.ascontiguousarray(values, dtype=np.float64) + 0.0  # -0.0 becomes 0.0
    blocks = [
        block
        for block in _maximal(plain, least // 2)
        if block.count >= least and least <= block.first - block.source and _tells_enough(plain, block)
    ]
    if sum(block.count for block in blocks) > MOST_REPEATED_SHARE * len(plain):
        return []
    chosen: list[RepeatedBlock] = []
    for block in sorted(blocks, key=lambda block: (block.first, block.source)):
        is_new = not chosen or block.first >= chosen[-1].first + chosen[-1].count
        if is_new and _is_single(plain, block, least) and _is_measured(plain, block, step):
            chosen.append(block)
    return chosen


def _maximal(values: FloatArray, width: int) -> Iterator[RepeatedBlock]:
    """Yield the longest pairs of equal stretches that contain a window starting at a multiple of its width."""
    # Stretches that stand still equal every other pause: only windows in which values change are compared.
    changes = np.concatenate([[0], np.cumsum(values[1:] != values[:-1])])
    moves = changes[width - 1 :] - changes[: len(changes) - width + 1] >= FEWEST_CHANGES // 2
    prints = _fingerprints(values, width)
    anchors = np.arange(0, len(prints), width)
    anchors = anchors[moves[anchors]]
    # A table of the first bits of the fingerprints passes over most windows before they are looked up in order.
    table, places = np.zeros(1 << _TABLE_BITS, dtype=bool), prints >> np.uint64(64 - _TABLE_BITS)
    table[places[anchors]] = True
    seen = np.flatnonzero(table[places] & moves)
    anchors = anchors[np.argsort(prints[anchors], kind="stable")]
    if not len(anchors):
        return
    at = np.minimum(np.searchsorted(prints[anchors], prints[seen]), len(anchors) - 1)
    alike = (prints[anchors[at]] == prints[seen]) & (anchors[at] != seen)
    pairs = np.sort(np.stack([anchors[at][alike], seen[alike]]), axis=0)
    if pairs.shape[1] * width > 2 * MOST_REPEATED_SHARE * np.count_nonzero(moves) + width:
        return
    # Pairs of one lag belong together: each stretch is widened to both sides once, and its other pairs are passed over.
    lags = pairs[1] - pairs[0]
    reached: dict[int, int] = {}
    for number in np.lexsort((pairs[0], lags)):
        source, lag = int(pairs[0, number]), int(lags[number])
        if source >= reached.get(lag, 0):
            begin = source - _equal(values[:source][::-1], values[: source + lag][::-1])
            end = source + _equal(values[source:], values[source + lag :])
            reached[lag] = end
            if end - begin >= width:
                yield RepeatedBlock(begin, begin + lag, end - begin)


def _fingerprints(values: FloatArray, width: int) -> WholeArray:
    """Hash of every window of ``width`` samples, equal for equal windows, (n - width + 1,)."""
    bits = values.view(np.uint64)
    mixed = (bits ^ (bits >> np.uint64(29))) * np.uint64(_MIX)
    mixed ^= mixed >> np.uint64(32)
    sums = np.concatenate([np.zeros(1, np.uint64), np.cumsum(mixed * _powers(_BASE, len(mixed)), dtype=np.uint64)])
    inverse = pow(_BASE, -1, 1 << 64)
    hashed = (sums[width:] - sums[:-width]) * _powers(inverse, len(sums) - width)
    hashed ^= hashed >> np.uint64(31)
    return np.asarray(hashed * np.uint64(_MIX))


def _powers(base: int, count: int) -> WholeArray:
    """Powers 0 to count - 1 of a base modulo 2^64, shape (count,)."""
    factors = np.full(count, base, dtype=np.uint64)
    factors[0] = 1
    return np.cumprod(factors, dtype=np.uint64)


def _equal(first: FloatArray, other: FloatArray) -> int:
    """Number of equal samples at the beginning of two arrays, up to the first that differs."""
    most, begin, size = min(len(first), len(other)), 0, 256
    while begin < most:
        unlike = np.flatnonzero(first[begin : min(begin + size, most)] != other[begin : min(begin + size, most)])
        if len(unlike):
            return begin + int(unlike[0])
        begin, size = begin + size, 2 * size
    return most


def _tells_enough(values: FloatArray, block: RepeatedBlock) -> bool:
    """Whether a repeated block holds so much information that it can hardly recur by chance."""
    stretch = values[block.first : block.first + block.count]
    steps = np.diff(stretch)
    if np.count_nonzero(steps) < FEWEST_CHANGES or len(np.unique(stretch)) < FEWEST_LEVELS:
        return False
    shares = np.unique(steps, return_counts=True)[1] / len(steps)
    information = -float(np.sum(shares * np.log2(shares))) * len(steps)
    return bool(information > 2 * np.log2(len(values)) + SURPLUS_BITS)


def _is_single(values: FloatArray, block: RepeatedBlock, width: int) -> bool:
    """Whether a repeated block is a single copy, with neither itself nor its surroundings periodic."""
    lag, end = block.first - block.source, block.first + block.count
    if block.count > MOST_PERIODS * lag:
        return False
    before = slice(max(lag, block.first - width), block.first)
    after = slice(end, min(end + width, len(values)))
    shares = [
        np.mean(values[side] == values[side.start - lag : side.stop - lag])
        for side in (before, after)
        if side.stop > side.start
    ]
    return bool(shares) and max(shares) < MOST_EQUAL_NEIGHBOURS


def _is_measured(values: FloatArray, block: RepeatedBlock, step: float) -> bool:
    """Whether a repeated block was measured, seen by noise in it (which never recurs) or a kink at an end.

    A block that directly follows its source is smooth at its end in any case, and at its start if it is a period.
    """
    # A kink: second differences across a seam far above those inside the block.
    end = block.first + block.count
    stretch = values[block.first : end]
    usual = float(np.abs(np.diff(stretch, 2)).max())
    for seam in (block.first, *([end] if block.first > block.source + block.count else [])):
        around = values[seam - 2 : seam + 2]
        if 2 <= seam <= len(values) - 2 and float(np.abs(np.diff(around, 2)).max()) > KINK_RATIO * usual:
            return True
    if not step:
        return is_rough((stretch, stretch))
    # Noise turns back from step to step, a signal seldom does.
    moved = np.diff(stretch)
    signs = np.sign(moved[moved != 0])
    return float(np.mean(signs[1:] != signs[:-1])) > NOISE_REVERSALS


MOST_LISTED = 3
"""Number of places that the message on a fault of a recording lists at most, so that it stays short."""
MOST_JITTER = 0.01
"""Standard deviation of the sampling intervals over their mean above which sampling counts as not uniform."""
FEWEST_WINDOWS = 4
"""Number of windows in a record below which a warning is given, as averages over so few have large random errors."""


def check_recording(
    recording: Recording, seconds: float = 2.0, ranges: Mapping[str, float] | None = None
) -> tuple[Fault, ...]:
    """Faults of a recording that make it unfit, or questionable, for estimating frequency responses.

    Parameters
    ----------
    recording : Recording
    seconds : float
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
    channels: error: the record lasts 1 s, less than one window of 2 s; record longer or take a shorter window \
[too-short]
    channels.T_T: warning: constant at 1 N*m: the sensor may be dead, or not connected [disturbed-signal]
    """
    faults = [*_names(recording), *_length(recording, seconds), *_times(recording)]
    untold = {signal.name: "" for signal in recording if not signal.quantity}
    faults += [untold_quantities(untold)] if untold else []
    for signal in recording:
        faults += [fault.under("channels", signal.name) for fault in _signal(signal, recording, ranges or {})]
    for channel in recording.pulses:
        if len(channel) > 1:
            faults += [replace(fault, path=("channels", channel.name)) for fault in _pulses(channel.times)]
    order = ("error", "warning", "note")
    return tuple(sorted(faults, key=lambda fault: order.index(fault.severity)))


def _names(recording: Recording) -> Iterator[Fault]:
    for name, count in Counter(recording.names).items():
        if count > 1:
            yield Fault(
                f"{count} channels are named {name}; rename all but one", ("channels", name), kind="repeated-name"
            )


def _length(recording: Recording, window: float) -> Iterator[Fault]:
    if not window:
        return
    windows = recording.duration / window
    if len(recording) < round(window * recording.sampling_rate):
        text = f"the record lasts {recording.duration:.6g} s, less than one window of {window:g} s"
        yield Fault(f"{text}; record longer or take a shorter window", ("channels",), kind="too-short")
    elif windows < FEWEST_WINDOWS:
        text = f"the record has only {windows:.2g} windows of {window:g} s: few averages, large random errors"
        yield Fault(f"{text}; record longer", ("channels",), "warning", kind="too-short")


def _times(recording: Recording) -> Iterator[Fault]:
    times = recording.times
    if times is None or len(times) < 2:
        return
    if not np.all(np.diff(times) > 0):
        at = int(np.flatnonzero(~(np.diff(times) > 0))[0])
        text = f"time stamps do not increase: {times[at + 1]:.9g} s follows {times[at]:.9g} s"
        yield Fault(f"{text}; cut the record there", ("time",), kind="unordered-rows")
        return
    if any(_counts_steps(signal) for signal in recording):
        yield from _pulses(times)
        return
    breaks = gaps(times)
    if len(breaks):
        where = comma_list([f"{times[at + 1] - times[at]:.4g} s after {times[at]:.6g} s" for at in breaks], MOST_LISTED)
        text = f"{len(breaks)} gap{'s' * (len(breaks) > 1)} in the time stamps: {where}"
        yield Fault(f"{text}; cut the record there", ("time",), kind="uneven-samples")
    spread = jitter(times)
    if spread > MOST_JITTER:
        text = f"sampling is not uniform: intervals vary by {100 * spread:.2g} % (standard deviation)"
        yield Fault(f"{text}; {remedy('resampled()')} makes it uniform", ("time",), "warning", kind="uneven-samples")


def _counts_steps(signal: Signal) -> bool:
    """Whether every sample of an angle is one encoder step further, so that the time stamps are pulses."""
    if signal.quantity != "angle" or len(signal.values) < 3:
        return False
    steps = np.diff(signal.values)
    return bool(steps[0] != 0 and np.allclose(steps, steps[0], rtol=1e-6, atol=0.0))


def _pulses(times: FloatArray) -> Iterator[Fault]:
    try:
        pulses = repaired_pulses(times)
    except UsageError as error:
        yield error.fault.under("time")
        return
    lost = pulses.irregular
    if lost.total:
        after = zip(pulses.times[lost.after], lost.counts, strict=True)
        where = comma_list([f"{count} after {time:.6g} s" for time, count in after], MOST_LISTED)
        text = f"{lost.total} encoder pulses are missing: {where}; {remedy('angle_from_pulses()')} counts them"
        yield Fault(text, ("time",), kind="lost-pulses")
    if len(pulses.left_out):
        where = comma_list([f"{time:.6g} s" for time in pulses.left_out], MOST_LISTED)
        text = f"{len(pulses.left_out)} encoder pulses too many: at {where}"
        yield Fault(f"{text}; {remedy('angle_from_pulses()')} leaves them out", ("time",), kind="lost-pulses")


def _signal(signal: Signal, recording: Recording, ranges: Mapping[str, float]) -> Iterator[Fault]:
    if signal.quantity and signal.quantity not in QUANTITY_UNITS:
        text = f'unknown quantity "{signal.quantity}"; give one of {", ".join(QUANTITY_UNITS)}'
        yield Fault(text, kind="unknown-word")
    if not len(signal.values):
        return
    finite = np.isfinite(signal.values)
    if not finite.all():
        yield _not_finite(true_stretches(~finite), recording)
        if not finite.any():
            return
    values = signal.values[finite]
    if np.ptp(values) == 0 and len(values) > 1:
        yield Fault(
            f"constant at {values[0]:g} {signal.unit}: the sensor may be dead, or not connected",
            (),
            "warning",
            kind="disturbed-signal",
        )
    else:
        yield from _limits(signal, recording, ranges.get(signal.name))
        if signal.quantity in QUANTITY_UNITS and finite.all():
            yield from _disturbed(signal, recording)
        if signal.quantity == "angle" and finite.all():
            yield from _jumps(signal, recording)
        if signal.quantity in ("angle", "velocity") and finite.all() and recording.times is None:
            yield from _returning(signal, recording.sampling_rate)


def _not_finite(stretches: Stretches, recording: Recording) -> Fault:
    count = sum(last - first + 1 for first, last in stretches)
    where = comma_list([_time_span(first, last, recording) for first, last in stretches], MOST_LISTED)
    return Fault(
        f"{count} value{'s' * (count > 1)} NaN or infinite: {where}; cut them out or mend the record", kind="not-finite"
    )


def _limits(signal: Signal, recording: Recording, limit: float | None) -> Iterator[Fault]:
    values = signal.values
    stretches = true_stretches(np.abs(values) >= limit) if limit is not None else flat_tops(values)
    if stretches:
        count = sum(last - first + 1 for first, last in stretches)
        where = comma_list([_time_span(first, last, recording) for first, last in stretches], MOST_LISTED)
        at = float(np.abs(values[stretches[0][0]]))
        yield Fault(
            f"clipped: {count} samples at the range of {at:.6g} {signal.unit}, {where}; take a larger range",
            kind="disturbed-signal",
        )


def _disturbed(signal: Signal, recording: Recording) -> Iterator[Fault]:
    """Yield the faults of a signal by spikes, stretches that stand still, and repeated blocks."""
    step = step_of(signal.values)
    outliers = spikes(signal.values, step)
    if len(outliers):
        where = comma_list(
            [f"{signal.values[at]:.6g} {signal.unit} at {recording.time[at]:.6g} s" for at in outliers], MOST_LISTED
        )
        text = f"{len(outliers)} single sample{'s' * (len(outliers) > 1)} far from those around: {where}"
        yield Fault(f"{text}; a disturbance, to be mended or cut out", (), "warning", kind="disturbed-signal")
    still = frozen_stretches(signal.values, recording.sampling_rate, step)
    if still:
        where = comma_list([_time_span(first, last, recording) for first, last in still], MOST_LISTED)
        text = f"stands still where it moves before and after: {where}"
        yield Fault(
            f"{text}; samples may have been lost: cut it out, or record again", (), "warning", kind="disturbed-signal"
        )
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
        yield Fault(
            f"{text}; a buffer was recorded twice: cut it out, or record again", (), "warning", kind="disturbed-signal"
        )


def _returning(signal: Signal, rate: float) -> Iterator[Fault]:
    """Yield a warning on what returns with every turn in a speed or an angle, as the pitch errors of its wheel do."""
    if len(signal.values) < 2:  # no difference, no speed
        return
    speeds = signal.values if signal.quantity == "velocity" else np.gradient(signal.values) * rate
    pattern = turn_pattern(speeds, rate)
    if pattern is not None:
        yield Fault(pattern.words(), (), "warning" if pattern.constant else "note")


def _jumps(signal: Signal, recording: Recording) -> Iterator[Fault]:
    jumps, size = wrap_jumps(signal.values)
    if len(jumps):
        text = (
            f"the encoder wraps around: {len(jumps)} jumps of {size:.4g} rad, first at {recording.time[jumps[0]]:.6g} s"
        )
        yield Fault(f"{text}; {remedy('unwrapped()')} removes them", kind="wrapped-count")
        return
    leaps = encoder_leaps(signal.values)
    if len(leaps):
        where = comma_list([f"{recording.time[at]:.6g} s" for at in leaps], MOST_LISTED)
        yield Fault(
            f"the angle leaps by encoder steps at {where}: pulses are missing or too many",
            (),
            "warning",
            kind="lost-pulses",
        )


def _time_span(first: int, last: int, recording: Recording) -> str:
    time = recording.time
    return f"at {time[first]:.6g} s" if first == last else f"from {time[first]:.6g} to {time[last]:.6g} s"

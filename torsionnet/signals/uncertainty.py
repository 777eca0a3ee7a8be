"""Errors of estimated frequency responses: random ones, those by steps of a sensor, and warnings about them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, comma_list
from torsionnet.base.notes import Note, warning
from torsionnet.linear.estimation import Estimation
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.resampling import VALID_SHARE
from torsionnet.signals.spectra import CrossSpectra

# Warnings about unreliable peaks of an estimated response, and the frequency up to which a sensor resolves motion.

LEAST_BINS = 3
"""Number of bins that the half-power bandwidth of a peak must span, as the window widens a narrower peak."""
LEAST_COHERENCE = 0.8
"""Coherence at a peak below which a warning is given, and of a line below which test and model are not compared, as
noise is too large."""
COHERENT_SHARE = 0.5
"""Share of an output's power due to the inputs below which the output is taken for noise, being less than half."""
PEAK_PROMINENCE = 3.0
"""Height in dB by which a peak must stand out from its surroundings to be examined, more than noise makes."""
PEAK_RANGE = 20.0
"""Range in dB below the highest peak in which peaks are examined, as lower ones matter little."""
MOST_LISTED_PEAKS = 5
"""Number of peaks that a warning lists at most, so that it stays short."""


def significant_peaks(magnitude: FloatArray) -> list[int]:
    """Indices of the peaks of a magnitude that stand out by 3 dB and are at most 20 dB below the highest."""
    from scipy.signal import find_peaks

    if not magnitude.size:
        return []
    with np.errstate(divide="ignore", invalid="ignore"):
        level = 20 * np.log10(np.nan_to_num(magnitude))
    level = np.maximum(level, level.max() - 200)
    places, _ = find_peaks(level, height=level.max() - PEAK_RANGE, prominence=PEAK_PROMINENCE)
    return [int(place) for place in places]


def is_coherent(response: FrequencyResponse, output: int, least: float = LEAST_COHERENCE) -> NDArray[np.bool_]:
    """Mask (n_f,) of the lines where the coherences of an output with all inputs add up to at least ``least``."""
    if response.coherence is None:
        return np.zeros(len(response.frequencies), dtype=bool)
    return np.asarray(response.coherence[:, output].sum(axis=1) >= least)


def above_noise_up_to(response: FrequencyResponse, output: int) -> float:
    """Frequency in Hz up to which an output is more than noise, as the response states or by the last coherent line.

    Infinite if neither is known, or no line is coherent.
    """
    if response.usable_up_to is not None:
        return response.usable_up_to
    lines = response.frequencies[is_coherent(response, output, COHERENT_SHARE)]
    return float(lines.max()) if lines.size else np.inf


def half_power_bandwidth(frequencies: FloatArray, magnitude: FloatArray, peak: int) -> float:
    """Width in Hz of a peak where its magnitude has fallen by 3 dB; NaN if it does not fall so far on both sides.

    >>> frequencies = np.linspace(9, 11, 2001)
    >>> magnitude = 1 / abs(1 - (frequencies / 10) ** 2 + 2j * 0.01 * frequencies / 10)
    >>> round(half_power_bandwidth(frequencies, magnitude, int(magnitude.argmax())), 3)
    0.2
    """
    level = magnitude[peak] / np.sqrt(2)
    below = np.flatnonzero(magnitude < level)
    left, right = below[below < peak], below[below > peak]
    if not len(left) or not len(right):
        return float("nan")
    edges = [
        np.interp(level, magnitude[[low, high]], frequencies[[low, high]])
        for low, high in ((left[-1], left[-1] + 1), (right[0], right[0] - 1))
    ]
    return float(edges[1] - edges[0])


def peak_warnings(response: FrequencyResponse, bin_width: float, *, judge_coherence: bool = True) -> tuple[Note, ...]:
    """Warnings about the peaks of a response estimated with bins that are ``bin_width`` Hz wide, one sentence each.

    A peak narrower than three bins is widened by the window, which reads as too much damping. With several
    inputs, ordinary coherence is low for reasons other than noise: set ``judge_coherence`` to False. Peaks above the
    frequency up to which the response can be used or is more than noise are ignored.
    """
    notes: list[Note] = []
    for o, output in enumerate(response.outputs):
        meant = response.between(0, above_noise_up_to(response, o))
        for i, into in enumerate(response.inputs):
            coherence = meant.coherence[:, o, i] if meant.coherence is not None and judge_coherence else None
            magnitude = meant.magnitude[:, o, i]
            notes += (
                warning(f"{output.name}/{into.name} {text}")
                for text in _peak_remarks(meant.frequencies, magnitude, coherence, bin_width)
            )
    return tuple(notes)


def _peak_remarks(
    frequencies: FloatArray, magnitude: FloatArray, coherence: FloatArray | None, bin_width: float
) -> Iterator[str]:
    narrow, incoherent = [], []
    for peak in significant_peaks(magnitude):
        width = half_power_bandwidth(frequencies, magnitude, peak)
        if coherence is not None and coherence[peak] < LEAST_COHERENCE:
            incoherent.append(f"{frequencies[peak]:g} Hz ({coherence[peak]:.2f})")
        elif width < LEAST_BINS * bin_width:
            narrow.append(f"{frequencies[peak]:g} Hz ({width:.3g} Hz)")
    if narrow:
        yield (
            f"half-power bandwidth under {LEAST_BINS} bins of {bin_width:g} Hz at "
            f"{comma_list(narrow, MOST_LISTED_PEAKS)}: the height reads low and the damping high; use longer segments"
        )
    if incoherent:
        yield f"coherence under {LEAST_COHERENCE:g} at the peak at {comma_list(incoherent, MOST_LISTED_PEAKS)}"


def resolution_limit(frequencies: FloatArray, amplitude: FloatArray, step: float, steps: float = 4.0) -> float:
    """Frequency in Hz up to which an angle's amplitude is at least ``steps`` steps of the encoder.

    Parameters
    ----------
    frequencies : (n_f,) array
        Hz, increasing.
    amplitude : (n_f,) array
        Peak amplitude of the angle, rad.
    step : float
        Resolution, rad: a turn by lines per turn, and by four in quadrature.
    steps : float, optional
        At four the quantiser's error is a few percent; at half a step the response is lost.

    Returns
    -------
    float
        Where the amplitude first falls below that many steps; the last frequency if it never does, 0 if it is never
        as large.

    Examples
    --------
    >>> frequencies = np.linspace(1, 50, 50)
    >>> round(resolution_limit(frequencies, 1 / frequencies**2, step=2 * np.pi / 4096), 1)
    12.8
    """
    if not step > 0:
        raise UsageError(f"an encoder's step must be a positive angle, got {step}", kind="out-of-range")
    level = step * steps
    enough = amplitude >= level
    if not enough.any():
        return 0.0
    lost = np.flatnonzero(~enough & np.maximum.accumulate(enough))
    if not len(lost):
        return float(frequencies[-1])
    around = [lost[0], lost[0] - 1]
    return float(np.interp(level, amplitude[around], frequencies[around]))


# Resolution of a sensor with steps in a sweep, given by the frequencies up to which it resolves the motion.

ENOUGH_STEPS, LOST_STEPS = 4.0, 0.5
"""Amplitude in sensor steps from which the quantisation error is a few percent, and below which motion may go
unseen."""
WHOLE_STEP_TOLERANCE = 0.01
"""Largest distance of a change from a whole number of steps, in steps, up to which a signal counts as quantised."""
MOST_STEPS = 1e12
"""Largest change of a quantised signal in steps, more than any converter has, so that rounding is not taken for
steps."""
FEWEST_STEPS = 3
"""Fewest changes of a signal from which its step is found, and fewest segments of a sweep from which frequency limits
are."""
SINE_POWER_SHARE = 0.5
"""Share of the input's power in one line and its neighbours above which the input counts as a sine."""


@dataclass(frozen=True)
class Resolution:
    """Resolution of a sensor in a sweep, with its step and the frequencies (Hz) up to which it resolves the motion.

    Attributes
    ----------
    step : float
        Step of the sensor in the unit of the signal.
    enough_up_to, lost_above : float
        Frequency in Hz up to which the amplitude is four steps or more, and above which it is under half a step;
        inf if the sweep ends before.
    """

    step: float
    enough_up_to: float
    lost_above: float


def step_of(values: FloatArray) -> float:
    """Step of a quantised signal in the signal's unit, or 0 if the signal is not quantised.

    >>> step_of(np.array([0.0, 0.5, 0.5, 1.5, 1.0, 0.5]))
    0.5
    >>> step_of(np.array([0.0, 0.5, 0.7, 1.5]))
    0.0
    """
    steps = np.diff(values)
    moved = np.abs(steps[steps != 0])
    if len(moved) < FEWEST_STEPS:
        return 0.0
    smallest = float(moved.min())
    if moved.max() > MOST_STEPS * smallest:
        return 0.0
    counts = moved / smallest
    # The mean over many single steps is more exact than the smallest of them.
    if np.abs(counts - np.rint(counts)).max() > WHOLE_STEP_TOLERANCE:
        return 0.0
    return float(moved.sum() / np.rint(counts).sum())


def sweep_amplitudes(
    recording: Recording, output: str, input: str, seconds: float = 2.0
) -> tuple[FloatArray, FloatArray]:
    """Frequency of the input in Hz and peak amplitude of the output in each segment of a sweep, each (n_segments,).

    Segments in which the input is not a sine are left out.
    """
    count = round(seconds * recording.sampling_rate)
    if count < 8 or len(recording) < count:
        return np.empty(0), np.empty(0)
    whole = len(recording) // count
    drive = recording[input].values[: whole * count].reshape(whole, count)
    answer = recording[output].values[: whole * count].reshape(whole, count)
    power = np.abs(np.fft.rfft((drive - drive.mean(axis=1, keepdims=True)) * np.hanning(count), axis=1)) ** 2
    line = power.argmax(axis=1)
    cumulated = np.pad(power.cumsum(axis=1), ((0, 0), (1, 0)))
    half_width = 4 + line // 20  # a sweep moves on within a segment
    rows, last = np.arange(whole), power.shape[1]
    near = cumulated[rows, np.minimum(line + half_width + 1, last)] - cumulated[rows, np.maximum(line - half_width, 0)]
    is_sine = near > SINE_POWER_SHARE * cumulated[:, -1]
    # Peak of a sine from its RMS.
    return line[is_sine] / seconds, (np.sqrt(2) * answer.std(axis=1))[is_sine]


def resolution(recording: Recording, output: str, input: str, seconds: float = 2.0) -> Resolution | None:
    """Resolution of an output's sensor in a sweep, or None if it has no steps or the input is not swept.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> time = np.arange(40_000) / 1000
    >>> sine = np.sin(2 * np.pi * (1 + 0.25 * time) * time)
    >>> angle = 0.1 * np.round(sine / (1 + 0.25 * time) ** 2 / 0.1)
    >>> record = Recording((Signal("T", "torque", sine), Signal("phi", "angle", angle)), sampling_rate=1000)
    >>> limit = resolution(record, "phi", "T")
    >>> round(limit.step, 6), 1.5 < limit.enough_up_to < 3, 5 < limit.lost_above < 8
    (0.1, True, True)
    """
    watch = ResolutionWatch((output,), input, seconds)
    for _ in watch.collecting([recording]):
        pass
    return watch.resolution_of(output)


def with_resolution_limit(
    response: FrequencyResponse, watch: ResolutionWatch, decimation: int, highest: float = float("inf")
) -> FrequencyResponse:
    """Frequency response with its highest usable frequency (Hz), and a note for every sensor that limits it.

    Limits above the highest frequency of interest (Hz) are not noted.
    """
    limits, notes = [], list[Note]()
    if decimation > 1:
        limits.append(VALID_SHARE * float(response.frequencies[-1]))
    for channel in response.outputs:
        limit = watch.resolution_of(channel.name)
        if limit is not None and np.isfinite(limit.enough_up_to):
            limits.append(limit.enough_up_to)
            notes += [_remark(channel, limit)] if limit.enough_up_to < highest else []
    if not limits:
        return response
    return replace(response, notes=(*response.notes, *notes), usable_up_to=min(limits))


def _remark(channel: Channel, limit: Resolution) -> Note:
    step = f"{np.degrees(limit.step):.4g} deg" if channel.unit == "rad" else f"{limit.step:.4g} {channel.unit}"
    lost = f", under half a step from {limit.lost_above:.3g} Hz" if np.isfinite(limit.lost_above) else ""
    return warning(
        f"{channel.name} moves by less than {ENOUGH_STEPS:g} steps of {step} above {limit.enough_up_to:.3g} Hz"
        f"{lost}: its size is biased there, then lost; use a finer sensor or more torque"
    )


class ResolutionWatch:
    """Collector of sensor steps and sweep amplitudes from the blocks of a record before they are decimated."""

    def __init__(self, outputs: Sequence[str], input: str, seconds: float) -> None:
        self.outputs: tuple[str, ...] = tuple(outputs)
        self.input: str = input
        self.seconds: float = seconds
        self.steps: dict[str, list[float]] = {output: [] for output in self.outputs}
        self.sweep: dict[str, list[tuple[FloatArray, FloatArray]]] = {output: [] for output in self.outputs}

    def collecting(self, blocks: Iterable[Recording]) -> Iterator[Recording]:
        """Yield blocks of a record unchanged, after collecting their sensor steps and sweep amplitudes."""
        for block in blocks:
            for output in self.outputs:
                values = block[output].values
                if np.count_nonzero(np.diff(values)) >= FEWEST_STEPS and np.isfinite(values).all():
                    self.steps[output].append(step_of(values))
                self.sweep[output].append(sweep_amplitudes(block, output, self.input, self.seconds))
            yield block

    def resolution_of(self, output: str) -> Resolution | None:
        """Resolution of an output's sensor from the blocks collected, or None without steps or a sweep."""
        steps = self.steps[output]
        if not steps or not all(steps):
            return None
        frequency, amplitude = (np.concatenate(part) for part in zip(*self.sweep[output], strict=True))
        if len(frequency) < FEWEST_STEPS or np.ptp(frequency) == 0:
            return None
        order = np.argsort(frequency, kind="stable")
        frequency, amplitude = frequency[order], amplitude[order]
        limits = [resolution_limit(frequency, amplitude, min(steps), level) for level in (ENOUGH_STEPS, LOST_STEPS)]
        return Resolution(min(steps), *(limit if limit < frequency[-1] else float("inf") for limit in limits))


# Random errors of estimated frequency responses, from coherence and number of averages.


@dataclass(frozen=True, eq=False)
class RandomError:
    """Random error of a frequency response, as standard deviations of magnitude and phase (n_f, n_out, n_in).

    Attributes
    ----------
    magnitude : array
        Standard deviation of the magnitude, relative to it.
    phase : array
        Standard deviation of the phase, degrees.
    """

    magnitude: FloatArray
    phase: FloatArray


def random_error(coherence: FloatArray, averages: float) -> RandomError:
    """Random error of H1 with one input, from its coherence and the effective number of averages.

    Magnitude: ``sqrt((1 - g) / (2 n g))`` with coherence ``g``; the phase has the same error in radians, at most that
    of a uniformly distributed phase (104 degrees). In a sweep most segments hold noise alone at a given frequency; the
    coherence is then lower in proportion to the larger number of averages, so the formula is valid there too. Bias,
    such as the widening of narrow peaks by the window, is not included.

    >>> random_error(np.array([0.9]), averages=50).magnitude.round(4).tolist()
    [0.0333]
    """
    if not averages > 0:
        raise UsageError(f"the number of averages must be positive, got {averages}", kind="out-of-range")
    bounded = np.clip(coherence, 0, 1)
    with np.errstate(divide="ignore"):
        return _of_relative(np.sqrt((1 - bounded) / (2 * averages * bounded)))


def _of_relative(relative: FloatArray) -> RandomError:
    uniform_phase = np.pi / np.sqrt(3)
    return RandomError(np.asarray(relative), np.degrees(np.minimum(relative, uniform_phase)))


# Data on how an estimated response was averaged (segments, sweep, sensor steps, record).

MOST_KEPT_VALUES = 2**22
"""Largest number of values of a record that is kept with its estimate, as more would take too much memory."""

SWEPT_SEGMENTS = 0.5
"""Share of segments with a sine as input above which the input counts as swept, as noise may look like a sine in a
few."""


def averaging_data(estimator: str, spectra: CrossSpectra) -> Estimation:
    """Data on the averaging of an estimate from its spectra (window, segment length, overlap, averages)."""
    used, rate = spectra.settings, spectra.sampling_rate
    length = used.samples(rate)
    overlap = 1 - used.step(rate) / length
    worth = spectra.effective_averages
    return Estimation(estimator, used.window, length / rate, overlap, used.detrend, spectra.averages, worth)


def with_record(
    estimation: Estimation, outputs: tuple[str, ...], driven: str, fine: Recording, coarse: Recording
) -> Estimation:
    """Data on averaging with sweep, sensor steps and record added, from the record before and after decimation."""
    seconds, output = estimation.seconds, outputs[0]
    sweep = sweep_amplitudes(fine, output, driven, seconds)[0]
    segments = fine.duration / seconds
    is_swept = len(sweep) > max(1, SWEPT_SEGMENTS * segments) and bool(sweep[0] != sweep[-1])
    begun = sweep_amplitudes(_beginning(fine, 2 * seconds), output, driven, seconds)[0]
    return replace(
        estimation,
        swept=is_swept,
        settled_from=float(begun.mean()) if is_swept and len(begun) > 1 and begun[1] > begun[0] else 0.0,
        record=coarse if len(coarse) * len(coarse.signals) <= MOST_KEPT_VALUES else None,
        steps={name: step_of(fine[name].values) for name in outputs},
        decimation=round(fine.sampling_rate / coarse.sampling_rate),
    )


def _beginning(record: Recording, seconds: float) -> Recording:
    count = round(seconds * record.sampling_rate)
    return replace(record, signals=tuple(replace(signal, values=signal.values[:count]) for signal in record))

"""Resolution of a sensor with steps in a sweep, given by the frequencies up to which it resolves the motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.notes import Note, warning
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.advice import resolution_limit
from torsionnet.signals.decimation import VALID_SHARE
from torsionnet.signals.recording import FloatArray, Recording

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
    >>> found = resolution(record, "phi", "T")
    >>> round(found.step, 6), 1.5 < found.enough_up_to < 3, 5 < found.lost_above < 8
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
        found = watch.resolution_of(channel.name)
        if found is not None and np.isfinite(found.enough_up_to):
            limits.append(found.enough_up_to)
            notes += [_remark(channel, found)] if found.enough_up_to < highest else []
    if not limits:
        return response
    return replace(response, notes=(*response.notes, *notes), usable_up_to=min(limits))


def _remark(channel: Channel, found: Resolution) -> Note:
    step = f"{np.degrees(found.step):.4g} deg" if channel.unit == "rad" else f"{found.step:.4g} {channel.unit}"
    lost = f", under half a step from {found.lost_above:.3g} Hz" if np.isfinite(found.lost_above) else ""
    return warning(
        f"{channel.name} moves by less than {ENOUGH_STEPS:g} steps of {step} above {found.enough_up_to:.3g} Hz"
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

"""Estimation of frequency responses without averaging, from a stepped sine or the spectrum of a whole record."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.between_samples import course_remark
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.detrending import Trend, without_trend
from torsionnet.signals.record_blocks import check_processable, stacked
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.spectral_matrix import ComplexArray

Names: TypeAlias = str | Sequence[str]


@dataclass(frozen=True)
class Step:
    """Step of a stepped sine, with its frequency in Hz and its start and end in s."""

    frequency: float
    start: float
    end: float


def stepped_sine(
    recording: Recording, output: Names, input: str, steps: Iterable[Step], settling: float = 0.0
) -> FrequencyResponse:
    """Frequency response at the steps of a stepped sine, from sines fitted to the signals by least squares.

    Mean and slope of each signal are fitted too. Only whole periods at the end of each step are used.

    Parameters
    ----------
    recording : Recording
    output : str or sequence of str
    input : str
    steps : iterable of Step
    settling : float, optional
        Time in s left out at the start of every step, for the transient to decay.

    Raises
    ------
    UsageError
        A step has no whole period within the record.
    """
    outputs = (output,) if isinstance(output, str) else tuple(output)
    chosen, ordered = _checked(recording, (*outputs, input)), sorted(steps, key=lambda step: step.frequency)
    sines = np.array([_sines(chosen, step, settling) for step in ordered])
    note = f"stepped sine of {len(ordered)} steps, {settling:g} s each left to settle"
    return _response(chosen, np.array([step.frequency for step in ordered]), sines, note)


def full_record(
    recording: Recording, output: Names, input: str, detrend: Trend = "mean", floor: float = 1e-3
) -> FrequencyResponse:
    """Frequency response of a whole record without averaging, the output's spectrum over the input's.

    Valid if the record holds whole periods of a periodic test, or begins and ends at rest. It has the finest
    possible resolution, and noise is not reduced.

    Parameters
    ----------
    recording : Recording
    output : str or sequence of str
    input : str
    detrend : {"mean", "linear", "none"}, optional
    floor : float, optional
        Frequencies where the input is below this share of its largest line are left out.
    """
    outputs = (output,) if isinstance(output, str) else tuple(output)
    chosen = _checked(recording, (*outputs, input))
    lines = np.fft.rfft(without_trend(stacked(chosen), detrend), axis=1).T
    excited = np.abs(lines[:, -1])
    kept = (excited >= floor * excited.max()) & (excited > 0)
    frequencies = np.fft.rfftfreq(len(chosen), 1 / chosen.sampling_rate)
    note = f"full record of {chosen.duration:g} s, detrend {detrend}, no averaging"
    return _response(chosen, frequencies[kept], lines[kept], note)


def _checked(recording: Recording, names: Sequence[str]) -> Recording:
    chosen = recording.select(names)
    check_processable(chosen)
    return chosen


def _sines(recording: Recording, step: Step, settling: float) -> ComplexArray:
    """Complex amplitude of every signal in one step of a stepped sine, by least squares, (n_signals,)."""
    rate, begin = recording.sampling_rate, step.start + settling
    last = min(round((step.end - recording.start) * rate), len(recording))
    periods = int((last / rate - (begin - recording.start)) * step.frequency + 1e-9)
    if periods < 1 or begin < recording.start:
        raise UsageError(
            f"the step at {step.frequency:g} Hz has no whole period in the record after settling; hold it longer"
        )
    first = last - round(periods / step.frequency * rate)
    time = recording.time[first:last]
    angle = 2 * np.pi * step.frequency * time
    basis = np.array([np.cos(angle), np.sin(angle), np.ones_like(time), np.linspace(-1, 1, len(time))]).T
    fit = np.linalg.lstsq(basis, stacked(recording)[:, first:last].T, rcond=None)[0]
    return np.asarray(fit[0] - 1j * fit[1], dtype=np.complex128)


def _response(recording: Recording, frequencies: FloatArray, lines: ComplexArray, note: str) -> FrequencyResponse:
    courses = (signal.course(recording.sampling_rate) for signal in recording)
    *outputs, into = (Channel(one.name, one.unit, course) for one, course in zip(recording, courses, strict=True))
    assert into.course is not None
    driven = lines[:, -1] * into.course.share(frequencies)
    remark = "" if into.course.is_band_limited else course_remark(into.name, into.course, float(frequencies.max()))
    return FrequencyResponse(
        frequencies=frequencies,
        values=np.asarray(lines[:, :-1, None] / driven[:, None, None], dtype=np.complex128),
        outputs=tuple(outputs),
        inputs=(into,),
        title=recording.title,
        notes=(*recording.notes, note, *filter(None, [remark])),
    )

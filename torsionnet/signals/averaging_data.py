"""Data on how an estimated response was averaged (segments, sweep, sensor steps, record)."""

from __future__ import annotations

from dataclasses import replace

from torsionnet.linear.estimation import Estimation
from torsionnet.signals.recording import Recording
from torsionnet.signals.sensor_resolution import step_of, sweep_amplitudes
from torsionnet.signals.spectral_matrix import CrossSpectra

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

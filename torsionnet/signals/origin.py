"""What an estimate remembers of its records: how they were averaged and swept, and the signals themselves."""

from __future__ import annotations

from dataclasses import replace

from torsionnet.response.estimation import Estimation
from torsionnet.response.recording import Recording
from torsionnet.signals.resolution import step_of, swept
from torsionnet.signals.spectral_matrix import CrossSpectra

MOST_VALUES = 2**22
"""Of a record that is remembered; beyond, a fit smooths as if the input were stationary."""

SINES = 0.5
"""Share of segments in which the input is a sine above which it is swept; in short ones noise is one by chance."""


def averaging(estimator: str, spectra: CrossSpectra) -> Estimation:
    """What spectra know of themselves."""
    used, rate = spectra.settings, spectra.sampling_rate
    length = used.samples(rate)
    overlap = 1 - used.step(rate) / length
    worth = spectra.effective_averages
    return Estimation(estimator, used.window, length / rate, overlap, used.detrend, spectra.averages, worth)


def remembering(
    estimation: Estimation, outputs: tuple[str, ...], driven: str, fine: Recording, coarse: Recording
) -> Estimation:
    """The same with the signals in it, before (``fine``) and after (``coarse``) decimation."""
    seconds, output = estimation.seconds, outputs[0]
    sweep = swept(fine, output, driven, seconds)[0]
    segments = fine.duration / seconds
    is_swept = len(sweep) > max(1, SINES * segments) and bool(sweep[0] != sweep[-1])
    begun = swept(_beginning(fine, 2 * seconds), output, driven, seconds)[0]
    return replace(
        estimation,
        swept=is_swept,
        settled_from=float(begun.mean()) if is_swept and len(begun) > 1 and begun[1] > begun[0] else 0.0,
        record=coarse if len(coarse) * len(coarse.signals) <= MOST_VALUES else None,
        steps={name: step_of(fine[name].values) for name in outputs},
        decimation=round(fine.sampling_rate / coarse.sampling_rate),
    )


def _beginning(record: Recording, seconds: float) -> Recording:
    count = round(seconds * record.sampling_rate)
    return replace(record, signals=tuple(replace(signal, values=signal.values[:count]) for signal in record))

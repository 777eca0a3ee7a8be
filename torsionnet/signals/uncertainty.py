"""Random errors of estimated frequency responses, from coherence and number of averages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.estimation import Estimation
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.sensor_resolution import step_of, sweep_amplitudes
from torsionnet.signals.spectra import CrossSpectra, hr, unexplained_spectra


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

    def band(self, response: FrequencyResponse, deviations: float = 1.96) -> tuple[FloatArray, FloatArray]:
        """Lower and upper confidence limit of a response's magnitude, each (n_f, n_out, n_in), in its unit."""
        half_width = deviations * self.magnitude
        return np.maximum(1 - half_width, 0) * response.magnitude, (1 + half_width) * response.magnitude


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
        raise UsageError(f"the number of averages must be positive, got {averages}")
    bounded = np.clip(coherence, 0, 1)
    with np.errstate(divide="ignore"):
        return _of_relative(np.sqrt((1 - bounded) / (2 * averages * bounded)))


def random_errors(
    spectra: CrossSpectra, response: FrequencyResponse, reference: str | Sequence[str] = ()
) -> RandomError:
    """Random error of every transfer function of an estimated response, from the spectra behind it.

    The noise of an output is the part that all inputs together do not explain; its effect on the path of an input is
    larger the less this input varies independently. For one input this is :func:`random_error`. Against a reference
    r it is ``sqrt(S_rr S_ee / (2 n |S_ry|^2))`` with the spectral density ``S_ee`` of ``y - H x``, which contains the
    noise of both sides: the error of ``H = S_ry / S_rx`` to first order.

    Parameters
    ----------
    spectra : CrossSpectra
    response : FrequencyResponse
        Response that :func:`~torsionnet.signals.estimators.estimate` returned for them.
    reference : str or sequence of str, optional
        Reference signals of ``Hr``.
    """
    inputs, outputs = _names(response.inputs), _names(response.outputs)
    references = [reference] if isinstance(reference, str) else list(reference) or inputs
    s_xx, s_xy = spectra.between(inputs, inputs), spectra.between(inputs, outputs)
    s_yy = spectra.between(outputs, outputs)
    s_rx, s_ry = spectra.between(references, inputs), spectra.between(references, outputs)
    free = spectra.effective_averages - len(inputs) + 1
    if free <= 0:
        raise UsageError(
            f"{spectra.effective_averages:.1f} effective averages cannot tell {len(inputs)} inputs from noise"
        )
    backward, found = np.linalg.pinv(s_rx), hr(s_rx, s_ry)
    alone = np.einsum("fir,frs,fis->fi", backward, spectra.between(references, references), backward.conj()).real
    # What the inputs leave of the output, passed back through the references, over twice the free averages.
    squared = unexplained_spectra(found, s_xx, s_xy, s_yy)[:, :, None] * alone[:, None, :] / (2 * free)
    with np.errstate(divide="ignore", invalid="ignore"):
        return _of_relative(np.sqrt(squared) / np.abs(found))


def _of_relative(relative: FloatArray) -> RandomError:
    uniform_phase = np.pi / np.sqrt(3)
    return RandomError(np.asarray(relative), np.degrees(np.minimum(relative, uniform_phase)))


def _names(channels: Sequence[Channel]) -> list[str]:
    return [channel.name for channel in channels]


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

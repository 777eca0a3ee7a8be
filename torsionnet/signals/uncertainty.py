"""Random errors of estimated frequency responses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.response import Channel, FrequencyResponse
from torsionnet.response.recording import FloatArray
from torsionnet.signals.spectral_matrix import CrossSpectra
from torsionnet.signals.transfer_matrices import hr, unexplained


@dataclass(frozen=True, eq=False)
class RandomError:
    """Standard deviations of an estimate, (n_f, n_out, n_in).

    Attributes
    ----------
    magnitude : array
        Relative to the magnitude.
    phase : array
        Degrees.
    """

    magnitude: FloatArray
    phase: FloatArray

    def band(self, response: FrequencyResponse, deviations: float = 1.96) -> tuple[FloatArray, FloatArray]:
        """Lower and upper limit of the magnitude; 1.96 standard deviations hold 95 % of normal errors."""
        reach = deviations * self.magnitude
        return np.maximum(1 - reach, 0) * response.magnitude, (1 + reach) * response.magnitude


def random_error(coherence: FloatArray, averages: float) -> RandomError:
    """Random error of one input's H1 from its coherence and the effective number of averages.

    Magnitude: ``sqrt((1 - g) / (2 n g))`` with coherence ``g``; the phase has the same error in radians, at most that
    of a phase which may be anything (104 degrees). In a sweep most segments hold noise alone at a given frequency;
    the coherence is then lower in the measure in which the averages are more, so the formula serves there too.
    Errors of bias, such as the widening of narrow peaks by the window, are not in it.

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
    """Random error of every transfer function of an estimate made from these spectra.

    The noise of an output is what all inputs together do not explain; it weighs on an input's path by how little
    that input does on its own. For one input this is :func:`random_error`. Against a reference r it is
    ``sqrt(S_rr S_ee / (2 n |S_ry|^2))`` with the spectral density ``S_ee`` of ``y - H x``, which noise on both sides
    makes: what comes of ``H = S_ry / S_rx`` to first order.

    Parameters
    ----------
    spectra : CrossSpectra
    response : FrequencyResponse
        What :func:`~torsionnet.signals.estimators.estimate` made of them.
    reference : str or sequence of str, optional
        Those of ``Hr``.
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
    squared = unexplained(found, s_xx, s_xy, s_yy)[:, :, None] * alone[:, None, :] / (2 * free)
    with np.errstate(divide="ignore", invalid="ignore"):
        return _of_relative(np.sqrt(squared) / np.abs(found))


def _of_relative(relative: FloatArray) -> RandomError:
    uniform_phase = np.pi / np.sqrt(3)
    return RandomError(np.asarray(relative), np.degrees(np.minimum(relative, uniform_phase)))


def _names(channels: Sequence[Channel]) -> list[str]:
    return [channel.name for channel in channels]

"""Difference of two frequency responses in dB and degrees, and their assurance criterion (FRAC)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.recording import FloatArray


@dataclass(frozen=True, eq=False)
class Difference:
    """Difference of two frequency responses in dB and degrees, each (n_f, n_out, n_in).

    Attributes
    ----------
    frequencies : (n_f,) array
        Frequencies, Hz.
    decibels : (n_f, n_out, n_in) array
        Ratio of the magnitudes in dB, positive where the first is larger.
    degrees : (n_f, n_out, n_in) array
        Phase difference, -180 to 180, positive where the first leads; NaN where one has no phase.
    """

    frequencies: FloatArray
    decibels: FloatArray
    degrees: FloatArray


def difference(first: FrequencyResponse, second: FrequencyResponse) -> Difference:
    """Difference of two frequency responses in dB and degrees, each (n_f, n_out, n_in), at every frequency.

    Raises
    ------
    UsageError
        The responses differ in frequencies or units.

    Examples
    --------
    >>> one = FrequencyResponse(np.ones(1), np.full((1, 1, 1), -2j), (Channel("y", "rad"),), (Channel("x", "N*m"),))
    >>> two = FrequencyResponse(np.ones(1), np.full((1, 1, 1), 1 + 0j), one.outputs, one.inputs)
    >>> apart = difference(one, two)
    >>> apart.decibels.round(2).item(), apart.degrees.item()
    (6.02, -90.0)
    """
    _check_comparable(first, second)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = first.values / second.values
        known = first.has_phase and second.has_phase
        degrees = np.degrees(np.angle(ratio)) if known else np.full(ratio.shape, np.nan)
        return Difference(first.frequencies, 20 * np.log10(np.abs(ratio)), degrees)


def frac(first: FrequencyResponse, second: FrequencyResponse) -> FloatArray:
    """Frequency response assurance criterion (FRAC) of two responses, 0 to 1, (n_out, n_in).

    1 where the two are proportional over frequency, 0 where they are orthogonal. A constant factor does not lower it:
    look at the difference in dB too.
    """
    _check_comparable(first, second)
    if not (first.has_phase and second.has_phase):
        raise UsageError(
            "the assurance criterion compares complex responses, and one of these has no phase; give both with phase"
        )
    common = np.abs(np.einsum("foi,foi->oi", first.values.conj(), second.values)) ** 2
    sizes = [np.einsum("foi,foi->oi", r.values.conj(), r.values).real for r in (first, second)]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(common / (sizes[0] * sizes[1]))


def _check_comparable(first: FrequencyResponse, second: FrequencyResponse) -> None:
    for what, one, other in (("output", first.outputs, second.outputs), ("input", first.inputs, second.inputs)):
        if _units(one) != _units(other):
            raise UsageError(
                f"the {what}s differ: {_described(one)} against {_described(other)}; compare the same quantities"
            )
    if first.frequencies.shape != second.frequencies.shape or not np.allclose(
        first.frequencies, second.frequencies, rtol=1e-9, atol=0
    ):
        raise UsageError(
            "the two responses have different frequencies, and interpolating would falsify resonances; calculate the "
            "model at the frequencies of the test"
        )


def _units(channels: tuple[Channel, ...]) -> list[str]:
    return [channel.unit for channel in channels]


def _described(channels: tuple[Channel, ...]) -> str:
    return ", ".join(f"{channel.name} in {channel.unit or 'an unknown unit'}" for channel in channels)

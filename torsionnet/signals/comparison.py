"""Difference of two frequency responses in dB and degrees, and their assurance criterion (FRAC)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table, result_table
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.uncertainty import LEAST_COHERENCE


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
    >>> first = FrequencyResponse(np.ones(1), np.full((1, 1, 1), -2j), (Channel("y", "rad"),), (Channel("x", "N*m"),))
    >>> second = FrequencyResponse(np.ones(1), np.full((1, 1, 1), 1 + 0j), first.outputs, first.inputs)
    >>> apart = difference(first, second)
    >>> apart.decibels.round(2).item(), apart.degrees.item()
    (6.02, -90.0)
    """
    _check_comparable(first, second)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = first.values / second.values
        # The phase of the quotient is the difference of phases, always within half a turn.
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
            "the assurance criterion compares complex responses, and one of these has no phase; give both with phase",
            kind="missing-data",
        )
    # FRAC = |sum H1* H2|^2 / (sum |H1|^2 sum |H2|^2), over all frequencies
    common = np.abs(np.einsum("foi,foi->oi", first.values.conj(), second.values)) ** 2
    sizes = [np.einsum("foi,foi->oi", r.values.conj(), r.values).real for r in (first, second)]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(common / (sizes[0] * sizes[1]))


def _check_comparable(first: FrequencyResponse, second: FrequencyResponse) -> None:
    for what, own, other in (("output", first.outputs, second.outputs), ("input", first.inputs, second.inputs)):
        if _units(own) != _units(other):
            raise UsageError(
                f"the {what}s differ: {_described(own)} against {_described(other)}; compare the same quantities",
                kind="unlike-results",
            )
    if first.frequencies.shape != second.frequencies.shape or not np.allclose(
        first.frequencies, second.frequencies, rtol=1e-9, atol=0
    ):
        raise UsageError(
            "the two responses have different frequencies, and interpolating would falsify resonances; calculate the "
            "model at the frequencies of the test",
            kind="unlike-results",
        )


def _units(channels: tuple[Channel, ...]) -> list[str]:
    return [channel.unit for channel in channels]


def _described(channels: tuple[Channel, ...]) -> str:
    return ", ".join(f"{channel.name} in {channel.unit or 'an unknown unit'}" for channel in channels)


# Agreement of the responses of test and model in a few numbers (peaks, largest and RMS differences, FRAC).


@dataclass(frozen=True)
class AgreementNumber:
    """Number that says how far a test and the model agree, with the frequency in Hz where it was found."""

    what: Annotated[str, Out("test against model")]
    at: Annotated[float | None, Out("at", "Hz", "at_Hz", digits=4)]
    value: Annotated[float | None, Out("value", digits=4)]
    unit: Annotated[str | None, Out("unit")]


def agreement_numbers(
    test: FrequencyResponse, model: FrequencyResponse, conventions: Conventions
) -> tuple[AgreementNumber, ...]:
    """Highest peaks, differences (dB, degrees) and FRAC of test and model, at lines of good coherence."""
    good = comparable_lines(test)
    if not good.any():
        return ()
    picked = [at_good_lines(response, good) for response in (test, model)]
    differences = difference(*picked)
    f, decibels, degrees = picked[0].frequencies, differences.decibels[:, 0, 0], differences.degrees[:, 0, 0]
    unit, scale = test.unit(conventions=conventions), test.scale(conventions)
    numbers = []
    for whose, response in zip(("test", "model"), picked, strict=True):
        sizes = response.magnitude[:, 0, 0]
        top = int(np.argmax(sizes))
        name = f"largest response of the {whose}"
        numbers.append(AgreementNumber(name, float(response.frequencies[top]), float(sizes[top] * scale), unit))
    # A test without phase leaves magnitudes alone to be compared.
    compared = [("magnitude", decibels, "dB"), ("phase", degrees, "deg")][: 2 if test.has_phase else 1]
    for what, values, unit in compared:
        worst = int(np.abs(values).argmax())
        numbers += [
            AgreementNumber(f"largest difference in {what}", float(f[worst]), float(values[worst]), unit),
            AgreementNumber(f"RMS difference in {what}", None, float(np.sqrt(np.mean(values**2))), unit),
        ]
    if test.has_phase:
        numbers.append(AgreementNumber("FRAC", None, float(frac(*picked)[0, 0]), "1"))
    return tuple(numbers)


def agreement(test: FrequencyResponse, model: FrequencyResponse, conventions: Conventions) -> Table:
    """Table of highest peaks, differences (dB, degrees) and FRAC of test and model, at lines of good coherence."""
    numbers, f = agreement_numbers(test, model, conventions), test.frequencies[comparable_lines(test)]
    if not numbers:
        return Table(model.title, (Column("nothing can be compared"),), (), ("no frequency at which the test is good",))
    span = f"over {len(f)} lines from {f[0]:g} to {f[-1]:g} Hz with coherence of {LEAST_COHERENCE:g} or more"
    usable = f"the test can be used up to {usable_limit(test):.4g} Hz" if test.usable_up_to is not None else ""
    signs = "differences are test - model; positive degrees: the test leads"
    notes = tuple(filter(None, (span, usable, signs, *map(str, model.notes))))
    title = f"{model.title}: {test.outputs[0].name}/{test.inputs[0].name}"
    return result_table(title, numbers, AgreementNumber, notes=notes)


def usable_limit(test: FrequencyResponse) -> float:
    """Highest frequency in Hz up to which a test can be used; its last one where nothing is said."""
    return test.usable_up_to if test.usable_up_to is not None else float(test.frequencies[-1])


def comparable_lines(test: FrequencyResponse) -> NDArray[np.bool_]:
    """Mask, shape (n_f,), of the usable frequencies at which the first response of a test has good coherence."""
    good = test.frequencies <= usable_limit(test)
    if test.coherence is not None:
        good &= test.coherence[:, 0, 0] >= LEAST_COHERENCE
    return np.asarray(good)


def at_good_lines(response: FrequencyResponse, good: NDArray[np.bool_]) -> FrequencyResponse:
    """Frequency response at the frequencies that a mask (n_f,) marks, without coherence and conditioning."""
    return replace(
        response,
        frequencies=response.frequencies[good],
        values=response.values[good],
        coherence=None,
        conditioning=None,
    )

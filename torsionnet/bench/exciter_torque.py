"""Set-point and torque of the exciter that follows an excitation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from torsionnet.base.entries.spec import not_none
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.bench.plan import Exciter
from torsionnet.signals.excitation.excitation import Excitation
from torsionnet.signals.recording import FloatArray

TURN = 2 * np.pi  # rad


@dataclass(frozen=True, eq=False)
class ExciterOutput:
    """Set-point at the analog output and torque at the motor over time, both (n,) in N m, with notes on clipping."""

    set_point: FloatArray
    torque: FloatArray
    notes: tuple[NoteOrText, ...] = ()


def exciter_output(excitation: Excitation, exciter: Exciter, sampling_rate: float) -> ExciterOutput:
    """Set-point and torque of an exciter that follows an excitation.

    The set-point is raised beforehand if it is compensated, clipped at the rated torque and rounded to the steps of
    the analog output; the torque follows it with a first-order lag and is bent by the harmonics.
    """
    wanted = excitation.samples(sampling_rate)
    raised = (
        compensated_set_point(wanted, not_none(exciter.bandwidth), sampling_rate) if exciter.compensated else wanted
    )
    set_point, notes = _limited(raised, exciter)
    followed = (
        first_order_lag(set_point, exciter.bandwidth, sampling_rate, wanted[0]) if exciter.bandwidth else set_point
    )
    torque = with_harmonics(followed, excitation, exciter.harmonics or {})
    return ExciterOutput(set_point, torque, notes)


def compensated_set_point(wanted: FloatArray, bandwidth: float, sampling_rate: float) -> FloatArray:
    """Set-point with which a first-order lag delivers the torque wanted at every sample, (n,) in N m.

    The lag's step y[n+1] = a y[n] + (1 - a) u[n] solved for u; the last sample is held.
    """
    a = _decay(bandwidth, sampling_rate)
    raised = (wanted[1:] - a * wanted[:-1]) / (1 - a)
    return np.append(raised, wanted[-1:])


def first_order_lag(set_point: FloatArray, bandwidth: float, sampling_rate: float, rest: float) -> FloatArray:
    """Torque behind a first-order lag, 3 dB down at ``bandwidth`` (Hz), with the set-point held between samples.

    Before the first sample the torque is steady at ``rest``.
    """
    from scipy.signal import lfilter

    a = _decay(bandwidth, sampling_rate)
    return np.asarray(rest + lfilter([0.0, 1 - a], [1.0, -a], set_point - rest))


def _decay(bandwidth: float, sampling_rate: float) -> float:
    return float(np.exp(-TURN * bandwidth / sampling_rate))


def with_harmonics(torque: FloatArray, excitation: Excitation, shares: dict[int, float]) -> FloatArray:
    """Torque with harmonics added, in N m: Chebyshev polynomials turn a sine of full amplitude into its multiples.

    ``shares`` are relative amplitudes by harmonic. The mean of even harmonics is left out: the control holds the mean.
    """
    if not any(shares.values()) or not excitation.amplitude:
        return torque
    share = (torque - excitation.mean) / excitation.amplitude
    coefficients = np.zeros(max(shares) + 1)
    coefficients[list(shares)] = list(shares.values())
    even = chebyshev.chebval(share, coefficients * (np.arange(len(coefficients)) % 2 == 0))
    added = chebyshev.chebval(share, coefficients) - even.mean()
    return np.asarray(torque + excitation.amplitude * added)


def _limited(set_point: FloatArray, exciter: Exciter) -> tuple[FloatArray, tuple[NoteOrText, ...]]:
    notes: list[NoteOrText] = []
    ends = [end for end in (exciter.limit, exciter.full_scale) if end is not None]
    if ends:
        limit = min(ends)
        clipped = np.count_nonzero(np.abs(set_point) > limit)
        if clipped:
            what = "rated torque" if limit == exciter.limit else "range of the analog output"
            share = f"{100 * clipped / len(set_point):.2g} % of the time"
            peak = f"it asks for {np.abs(set_point).max():.4g} N*m"
            notes.append(warning(f"set-point clipped at the {what} of {limit:g} N*m {share}; {peak}"))
            set_point = np.clip(set_point, -limit, limit)
    if exciter.bits is not None:
        set_point = quantised(set_point, 2 * not_none(exciter.full_scale) / 2**exciter.bits)
    return set_point, tuple(notes)


def quantised(values: FloatArray, step: float) -> FloatArray:
    """Values rounded to the nearest step of an analog-digital converter."""
    return np.asarray(step * np.round(values / step))

"""From the excitation wanted to the torque a motor delivers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from torsionnet.core.entries.spec import present
from torsionnet.model.bench import Exciter
from torsionnet.response.recording import FloatArray
from torsionnet.signals.excitation.excitation import Excitation

TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class Delivered:
    """Set-point as it leaves the analog output, torque at the motor, both (n,) in N m, and what was noticed."""

    set_point: FloatArray
    torque: FloatArray
    notes: tuple[str, ...] = ()


def deliver(excitation: Excitation, exciter: Exciter, sampling_rate: float) -> Delivered:
    """Torque of an exciter that is to follow an excitation.

    The set-point is raised beforehand if it is compensated, clipped at the rated torque and rounded to the steps of
    the analog output; the torque follows it with a first-order lag and is bent by the harmonics.
    """
    wanted = excitation.samples(sampling_rate)
    raised = compensated(wanted, present(exciter.bandwidth), sampling_rate) if exciter.compensated else wanted
    set_point, notes = _limited(raised, exciter)
    followed = lagged(set_point, exciter.bandwidth, sampling_rate, wanted[0]) if exciter.bandwidth else set_point
    torque = bent(followed, excitation, exciter.harmonics or {})
    return Delivered(set_point, torque, notes)


def compensated(wanted: FloatArray, bandwidth: float, sampling_rate: float) -> FloatArray:
    """The set-point after which a first-order lag delivers what is wanted, at every sample.

    The lag's step y[n+1] = a y[n] + (1 - a) u[n] solved for u; the last sample is held.
    """
    a = _decay(bandwidth, sampling_rate)
    raised = (wanted[1:] - a * wanted[:-1]) / (1 - a)
    return np.append(raised, wanted[-1:])


def lagged(set_point: FloatArray, bandwidth: float, sampling_rate: float, rest: float) -> FloatArray:
    """Torque of a control loop of the first order, 3 dB down at ``bandwidth``, under a set-point held at each step.

    It has long been at ``rest`` when the test begins.
    """
    from scipy.signal import lfilter

    a = _decay(bandwidth, sampling_rate)
    return np.asarray(rest + lfilter([0.0, 1 - a], [1.0, -a], set_point - rest))


def _decay(bandwidth: float, sampling_rate: float) -> float:
    return float(np.exp(-TURN * bandwidth / sampling_rate))


def bent(torque: FloatArray, excitation: Excitation, shares: dict[int, float]) -> FloatArray:
    """Torque with harmonics: Chebyshev polynomials make of a sine of full amplitude its multiples and nothing else.

    The mean that even orders bring along is left out: the motor's control holds it.
    """
    if not any(shares.values()) or not excitation.amplitude:
        return torque
    share = (torque - excitation.mean) / excitation.amplitude
    coefficients = np.zeros(max(shares) + 1)
    coefficients[list(shares)] = list(shares.values())
    even = chebyshev.chebval(share, coefficients * (np.arange(len(coefficients)) % 2 == 0))
    added = chebyshev.chebval(share, coefficients) - even.mean()
    return np.asarray(torque + excitation.amplitude * added)


def _limited(set_point: FloatArray, exciter: Exciter) -> tuple[FloatArray, tuple[str, ...]]:
    notes: list[str] = []
    ends = [end for end in (exciter.limit, exciter.full_scale) if end is not None]
    if ends:
        limit = min(ends)
        clipped = np.count_nonzero(np.abs(set_point) > limit)
        if clipped:
            what = "rated torque" if limit == exciter.limit else "range of the analog output"
            share = f"{100 * clipped / len(set_point):.2g} % of the time"
            peak = f"it asks for {np.abs(set_point).max():.4g} N*m"
            notes.append(f"warning: set-point clipped at the {what} of {limit:g} N*m {share}; {peak}")
            set_point = np.clip(set_point, -limit, limit)
    if exciter.bits is not None:
        set_point = rounded(set_point, 2 * present(exciter.full_scale) / 2**exciter.bits)
    return set_point, tuple(notes)


def rounded(values: FloatArray, step: float) -> FloatArray:
    """Values on the nearest step of a converter."""
    return np.asarray(step * np.round(values / step))

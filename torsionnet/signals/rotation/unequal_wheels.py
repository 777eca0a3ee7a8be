"""Tooth numbers on a wheel without gap, from a second wheel on the same shaft with another number of teeth."""

from __future__ import annotations

from math import gcd

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.wheel_rotation import WheelRotation

LARGEST_SHARE = 0.25
"""Largest distance of the phase seen from that of a tooth, in shares of the step between neighbouring phases, half of
what would fit the next tooth as well."""


def phase_between(first: WheelRotation, second: WheelRotation) -> float:
    """Share of a pitch of the second wheel that has passed when tooth 0 of the first passes, from 0 to 1.

    It is what :func:`tooth_by_difference` needs of a record in which tooth 0 is known, as by an index pulse.

    Raises
    ------
    UsageError
        The wheels do not turn together.
    """
    shares = _shares(first, second, 0)
    return float(np.angle(np.exp(2j * np.pi * shares).mean()) / (2 * np.pi) % 1)


def tooth_by_difference(first: WheelRotation, second: WheelRotation, phase: float) -> int:
    """Tooth of the first pulse of a wheel, counted from its tooth 0, by a wheel of another number of teeth beside it.

    When tooth k of z1 passes, the phase of z2 teeth is ``phase`` + k z2/z1: without a common divisor it is another at
    each tooth, so that their difference is an absolute position, as on a vernier.

    Parameters
    ----------
    first, second : WheelRotation
        On one shaft, over a common time.
    phase : float
        As of :func:`phase_between`, in shares of a pitch of the second wheel.

    Raises
    ------
    UsageError
        The counts have a common divisor, the wheels do not turn together, or two teeth fit about as well.
    """
    one, two = first.wheel.teeth, second.wheel.teeth
    if gcd(one, two) > 1:
        raise UsageError(
            f"{first.name} and {second.name}: {one} and {two} teeth have the common divisor {gcd(one, two)}, so that "
            "their difference returns within a turn; take counts without one, as 60 and 61"
        )
    shares = _shares(first, second, int(first.numbers[0]))
    seen = np.exp(2j * np.pi * shares).mean()
    expected = np.exp(2j * np.pi * (phase + np.arange(one) * two / one))
    away = np.abs(np.angle(seen * expected.conj())) / (2 * np.pi) * one
    best = int(away.argmin())
    if away[best] > LARGEST_SHARE:
        raise UsageError(
            f"{first.name} and {second.name}: the phase of the two is {away[best]:.2f} of a step beside tooth {best}, "
            "and the next tooth fits about as well: the phase is from another assembly, or errors of the teeth are "
            "larger than a quarter of a step"
        )
    return best


def _shares(first: WheelRotation, second: WheelRotation, number: int) -> FloatArray:
    """Phases of the second wheel at whole turns of the first after its tooth ``number``, in shares of a pitch (n,)."""
    inside = (first.times >= second.times[0]) & (first.times <= second.times[-1])
    times, numbers = first.times[inside], first.numbers[inside] - number
    if len(times) < 2:
        raise UsageError(f"{first.name} and {second.name} have no time in common")
    pitches = second.rotation.at(times) - numbers * second.wheel.teeth / first.wheel.teeth
    if np.ptp(pitches) > 1:
        raise UsageError(
            f"{first.name} and {second.name}: their teeth drift apart by {np.ptp(pitches):.2f} pitches: they are not "
            "on one shaft, or their numbers of teeth are wrong"
        )
    return np.asarray(pitches % 1)

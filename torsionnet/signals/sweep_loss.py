"""Loss of amplitude and shift of frequency of a resonance peak in a run-up, against the steady response."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.linear.modes.modes import Modes

LEAST_LOSS = 0.01
"""Share of the steady peak from which a loss is told: less drowns in the interval of a test."""
GRID = 2000
"""Number of points on which the swept peak is looked for; the largest is exact to 1e-5 of the peak."""
BEFORE, BEHIND = -3.0, 12.0
"""Reach of this grid around the resonance, in widths of the resonance or, behind it, of the slower of sweep and
decay."""
MOST_DAMPED = 0.3
"""Damping ratio from which a mode has no peak that a sweep could miss."""
NEIGHBOURS = 3
"""Number of measured times on either side over which the rate of the speed is taken."""


@dataclass(frozen=True)
class SweepLoss:
    """Loss of a peak passed with a steady rate, as a share of the steady peak, and shift of its frequency as a share.

    Attributes
    ----------
    loss : float
    shift : float
        Along the sweep: positive where the frequency rises.
    """

    loss: float
    shift: float


def swept_amplitude(offset: FloatArray, sweep: float) -> ComplexArray:
    """Amplitude of a lightly damped mode passed by a frequency at a steady rate, over the steady peak, shape (n,).

    In the time s in units of 1/(zeta omega_0) the slowly varying amplitude a follows a' = -(1 + j p s) a + 1, where p =
    rate/(zeta omega_0)^2 with the rate in rad/s^2. Its integral is a Faddeeva function. F. M. Lewis, "Vibration during
    acceleration through a critical speed", Trans. ASME 54 (1932), has the undamped and damped curves.

    Parameters
    ----------
    offset : (n,) array
        p s, the distance of the frequency from the resonance over zeta omega_0.
    sweep : float
        p, above 0.

    Examples
    --------
    Slowly swept it is the steady amplitude, 1/(1 + j offset):

    >>> np.abs(swept_amplitude(np.array([0.0, 1.0]), 1e-4)).round(3).tolist()
    [1.0, 0.707]
    """
    # Integral of exp(-(1 + j p s) r + j p r^2/2) dr from 0 on, with the square completed.
    root = math.sqrt(sweep / 2) * np.exp(-0.25j * math.pi)
    return np.asarray(math.sqrt(math.pi) / (2 * root) * scipy.special.wofz(1j * (1 + 1j * offset) / (2 * root)))


def sweep_loss(rate: float, natural: float, ratio: float) -> SweepLoss:
    """Loss of the peak of a mode (natural frequency in Hz, damping ratio) passed at a rate in Hz/s, and its shift.

    Exact for light damping; at a ratio of 0.02 and 10 Hz/s through 20 Hz the loss is 0.43 against 0.44 (upward) and
    0.42 (downward) of the full equation.

    Examples
    --------
    >>> loss = sweep_loss(10.0, 20.0, 0.02)
    >>> round(loss.loss, 2), round(loss.shift, 2)
    (0.43, 0.11)
    """
    # d omega/dt over (zeta omega_0)^2: half bandwidths passed in the time 1/(zeta omega_0) in which a mode settles.
    sweep = abs(rate) / (2 * math.pi * (ratio * natural) ** 2)
    if not sweep:
        return SweepLoss(0.0, 0.0)
    offsets = np.linspace(BEFORE, BEHIND * max(1.0, math.sqrt(sweep)), GRID)
    sizes = np.abs(swept_amplitude(offsets, sweep))
    at = int(sizes.argmax())
    return SweepLoss(1 - float(sizes[at]), math.copysign(float(offsets[at]) * ratio, rate))


def sweep_remarks(times: FloatArray, speeds: FloatArray, orders: Sequence[float], modes: Modes) -> tuple[str, ...]:
    """Remarks on orders that passed a mode so fast that the steady peak was not reached, with the expected loss.

    Parameters
    ----------
    times : (n,) array
        s.
    speeds : (n,) array
        Of the reference shaft, rad/s.
    orders : sequence of float
    modes : Modes
        Of the model.
    """
    if len(times) < 2:
        return ()
    remarks = []
    for order in orders:
        frequency = order * speeds / (2 * math.pi)
        for natural, ratio in zip(modes.damped_frequencies.tolist(), modes.damping_ratios.tolist(), strict=True):
            if natural <= 0 or not 0 < ratio < MOST_DAMPED:
                continue
            beside = np.flatnonzero(frequency != natural)  # a sample may lie right on the mode
            above = frequency[beside] > natural
            crossed = beside[:-1][above[1:] != above[:-1]]
            losses = [
                (sweep_loss(rate, natural, ratio), rate)
                for at in crossed.tolist()
                if (rate := _rate(times, frequency, at))
            ]
            worst = max(losses, key=lambda pair: pair[0].loss, default=None)
            if worst is not None and worst[0].loss >= LEAST_LOSS:
                rpm = natural * 2 * math.pi / order * RPM
                remarks.append(
                    phrase(
                        "order {order:g} passed {frequency:.4g} Hz (damping ratio {ratio:.3g}, {speed:.4g} rpm) at "
                        "{rate:.3g} Hz/s: the model's steady peak loses {loss:.2g} % and moves by {shift:+.2g} % in "
                        "speed",
                        order=order,
                        frequency=natural,
                        ratio=ratio,
                        speed=rpm,
                        rate=abs(worst[1]),
                        loss=100 * worst[0].loss,
                        shift=100 * worst[0].shift,
                    )
                )
    return tuple(remarks)


def _rate(times: FloatArray, frequency: FloatArray, at: int) -> float:
    """Rate of a frequency in Hz/s around a crossing."""
    near = slice(max(0, at - NEIGHBOURS), at + NEIGHBOURS + 2)
    own = times[near] - times[near].mean()
    return float((own * frequency[near]).sum() / (own**2).sum())

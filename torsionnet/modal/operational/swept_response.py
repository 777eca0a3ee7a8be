"""Response of one mode to an order while the speed changes, over time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray

Excitation = Literal["constant", "inertia"]
"""Names of laws of the excitation's amplitude over speed: constant, or as its square, as of an inertia torque."""
DERIVATIVES = {"velocity": 1, "acceleration": 2}
"""Number of derivatives over time from an angle to a quantity, by its name; torque and stress follow the angle."""


@dataclass(frozen=True, eq=False)
class SpeedSweep:
    """An order over time at equal steps, with phase, phase in the middle of the steps, and relative excitation.

    Attributes
    ----------
    step : float
        s.
    phase : (n,) array
        Phase of the order at each time, rad.
    middle : (n - 1,) array
        Phase in the middle of each step, rad.
    speed : (n,) array
        Rate of the phase, rad/s.
    excitation : (n,) array
        Amplitude of the excitation over its largest.
    """

    step: float
    phase: FloatArray
    middle: FloatArray
    speed: FloatArray
    excitation: FloatArray

    @cached_property
    def turning(self) -> ComplexArray:
        """Turning unit phasor of the order at each time, shape (n,)."""
        return np.asarray(np.exp(1j * self.phase))

    @cached_property
    def torque(self) -> tuple[ComplexArray, ComplexArray]:
        """Relative excitation times the phasor, at each time (n,) and in the middle of the steps (n - 1,)."""
        g = self.excitation
        return np.asarray(g * self.turning), np.asarray((g[1:] + g[:-1]) / 2 * np.exp(1j * self.middle))


def sweep_of(times: FloatArray, angle: FloatArray, order: float, excitation: Excitation = "constant") -> SpeedSweep:
    """Sweep of one order from the angle of the reference shaft in rad at times in s, at equal steps, shape (n,).

    Raises
    ------
    UsageError
        The excitation is neither constant nor that of inertia.
    """
    from scipy.interpolate import CubicSpline

    if excitation not in {"constant", "inertia"}:
        raise UsageError(f'the excitation is "constant" or "inertia" (as the square of the speed), got "{excitation}"')
    spline = CubicSpline(times, order * angle)
    speed = np.asarray(spline(times, 1))
    amplitude = np.ones(len(times)) if excitation == "constant" else (speed / np.abs(speed).max()) ** 2
    middle = np.asarray(spline((times[1:] + times[:-1]) / 2))
    return SpeedSweep(float((times[-1] - times[0]) / (len(times) - 1)), order * angle, middle, speed, amplitude)


def swept_response(pole: complex, sweep: SpeedSweep, derivative: int = 0) -> ComplexArray:
    """Complex amplitude over time of a mode's response to an order, over the static response to the largest amplitude.

    The response is Re X(t) exp(j phase(t)), that of ``q'' + 2 zeta omega_0 q' + omega_0^2 q = omega_0^2 Re g exp(j
    phase)``, from the steady response at the first speed on. The state of the mode passes from sample to sample by its
    exact solution, the torque within a step by Simpson's rule.

    Parameters
    ----------
    pole : complex
        rad/s, Im > 0.
    sweep : SpeedSweep
    derivative : int
        1 for the velocity of the response, 2 for its acceleration.

    Examples
    --------
    Very slowly, the response is the steady one, here at the natural frequency of a mode of 5 % damping.

    >>> times = np.arange(0, 60, 0.002)
    >>> sweep = sweep_of(times, 2 * np.pi * (9 * times + times**2 / 60), order=1)
    >>> pole = 2 * np.pi * 10 * complex(-0.05, (1 - 0.05**2) ** 0.5)
    >>> found = swept_response(pole, sweep)
    >>> at = int(np.abs(sweep.speed - 2 * np.pi * 10).argmin())
    >>> print(abs(found[at]).round(2))
    10.0
    """
    total = _forced(pole, sweep) * pole**derivative - _forced(pole.conjugate(), sweep) * pole.conjugate() ** derivative
    values = total / (2j * pole.imag) * sweep.turning.conj()
    if derivative == 2:
        values = values + sweep.excitation
    return np.asarray(abs(pole) ** 2 * values)


def _forced(pole: complex, sweep: SpeedSweep) -> ComplexArray:
    """State z of ``z' = pole z + g exp(j phase)`` over time, shape (n,), from the steady state on."""
    from scipy.signal import lfilter

    h, g = sweep.step, sweep.excitation
    torque, middle = sweep.torque
    over = np.exp(pole * h)
    gains = h / 6 * (over * torque[:-1] + 4 * np.exp(pole * h / 2) * middle + torque[1:])
    steady = g[:2] / (1j * sweep.speed[:2] - pole)
    rate = 1j * sweep.speed[0] - pole
    start = (steady[0] - (steady[1] - steady[0]) / h / rate) * sweep.turning[0]
    later, _ = lfilter([1.0], [1.0, -over], gains.astype(complex), zi=np.array([over * start]))
    return np.concatenate([[start], later])

"""Vibrations of known natural frequency and damping: run-ups by solve_ivp, decays and ambient records in closed form."""

from __future__ import annotations

from functools import cache

import numpy as np

from torsionnet.signals.recording import Recording, Signal

F0, ZETA = 20.0, 0.02


@cache
def swept(rate, first=8.0, last=36.0, *, f0=F0, zeta=ZETA, order=1.0, power=0, sampling=400.0, phase=0.3):
    """Record of a torque and the speed while an order's frequency rises by ``rate`` Hz/s, by scipy's solve_ivp."""
    from scipy.integrate import solve_ivp

    end, w = abs(last - first) / abs(rate), 2 * np.pi * f0
    times = np.arange(0, end, 1 / sampling)

    def turned(t):
        return 2 * np.pi * (first * t + rate * t**2 / 2)

    def slope(t, state):
        force = ((first + rate * t) / f0) ** power * np.cos(turned(t) + phase)
        return [state[1], w**2 * (force - state[0]) - 2 * zeta * w * state[1]]

    start = np.exp(1j * phase) * (first / f0) ** power / (1 - (first / f0) ** 2 + 2j * zeta * first / f0)
    start = [start.real, (2j * np.pi * first * start).real]
    solution = solve_ivp(slope, (0, times[-1]), start, t_eval=times, rtol=1e-8, atol=1e-9, method="DOP853")
    speed = 2 * np.pi * (first + rate * times) / order
    return Recording((Signal("T", "torque", solution.y[0]), Signal("n", "velocity", speed)), sampling)


def two_light_modes(rate=200):
    """Record of a torque and angles with resonances at 5 and 48 Hz (60 Hz before the bilinear transform), hardly damped."""
    from scipy import signal

    torque = np.random.default_rng(5).normal(size=20_000)
    angle = np.zeros_like(torque)
    for f in (5.0, 60.0):
        w = 2 * np.pi * f
        b, a = signal.cont2discrete(([w**2], [1, 0.004 * w, w**2]), 1 / rate, method="bilinear")[:2]
        angle += signal.lfilter(b[0], a, torque)
    return Recording((Signal("T", "torque", torque), Signal("t", "angle", angle)), rate)


def with_noise(record, sigma, seed):
    """The record with white noise on its torque."""
    torque = record["T"]
    noise = np.random.default_rng(seed).normal(0, sigma, len(record))
    return record.with_signals(Signal("T", "torque", torque.values + noise))


def closed_form(rate, frequencies, *, f0=F0, zeta=ZETA):
    """X over the frequency of a linear sweep from the far past, one degree of freedom, static response 1.

    z' = lambda z + exp(j a t^2/2) with z -> 0 long before: z = exp(lambda t) integral to t of exp(j a s^2/2 - lambda s),
    which is sqrt(pi/2/|a|) exp(j pi/4) exp(j a t^2/2) times w(), the Faddeeva function.
    """
    from scipy.special import wofz

    w, a = 2 * np.pi * f0, 2 * np.pi * rate
    t = np.asarray(frequencies) / rate
    total = 0
    for sign, pole in ((1, w * complex(-zeta, np.sqrt(1 - zeta**2))), (-1, w * complex(-zeta, -np.sqrt(1 - zeta**2)))):
        argument = -np.exp(1j * np.pi / 4) * (a * t + 1j * pole) / np.sqrt(2 * a)
        total = total + sign * np.sqrt(np.pi / (2 * a)) * np.exp(1j * np.pi / 4) * wofz(argument)
    return w**2 * total / (2j * w * np.sqrt(1 - zeta**2))


def half_power(frequencies, amplitude, f0=F0):
    """Peak, its frequency, and the half-power width over twice the natural frequency."""
    top = int(amplitude.argmax())
    above = np.flatnonzero(amplitude >= amplitude[top] / np.sqrt(2))
    gaps = np.flatnonzero(np.diff(above) > 1)  # the width of the first hump: beats follow it
    pieces = np.split(above, gaps + 1)
    piece = next(one for one in pieces if top in one)
    return amplitude[top], frequencies[top], (frequencies[piece[-1]] - frequencies[piece[0]]) / (2 * f0)

"""Steps of sines at several amplitudes on one inertia, solved without the package's calculations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from torsionnet.signals.stepped_levels import SteppedStiffness

INERTIA = 0.152
"""kg m^2"""
STAGES = {"k1": 460.0, "g1": 0.12, "k2": 1500.0, "c": 0.5, "M": 3.0}
"""Two stages in N m/rad with the break in rad, damping in N m s/rad and friction in N m."""
Answer = Callable[[np.ndarray, float], np.ndarray]


def of_stages(k1: float, g1: float, k2: float, c: float, M: float) -> Answer:
    """Complex stiffness over amplitudes and a circular frequency, of two stages with friction and a damper."""

    def answer(a: np.ndarray, omega: float) -> np.ndarray:
        x = np.minimum(g1 / a, 1.0)
        share = 2 / np.pi * (np.arcsin(x) + x * np.sqrt(1 - x**2))
        return k2 - (k2 - k1) * share + 1j * (omega * c + 4 * M / (np.pi * a))

    return answer


def upward(answer: Answer, torque: float, frequencies: np.ndarray) -> np.ndarray:
    """First harmonics of the twist under a torque, of the branch that a sweep upward follows."""
    grid, twists, before = np.geomspace(1e-4, 2.0, 4000), [], None
    for omega in 2 * np.pi * frequencies:

        def missed(a: np.ndarray, omega: float = omega) -> np.ndarray:
            return np.abs((answer(a, omega) - INERTIA * omega**2) * a) - torque

        values = missed(grid)
        places = np.flatnonzero(values[:-1] * values[1:] < 0)
        roots = [scipy.optimize.brentq(missed, grid[i], grid[i + 1], xtol=1e-13) for i in places]
        a = roots[-1] if before is None else min(roots, key=lambda one: abs(one - before))
        twists.append(torque / (answer(np.array(a), omega) - INERTIA * omega**2))
        before = a
    return np.array(twists)


def measured(
    answer: Answer, levels: tuple[float, ...], frequencies: np.ndarray, seed: int, error: float = 0.01
) -> SteppedStiffness:
    """Steps upward at each level of torque in N m, with noise of ``error`` of each response."""
    rng = np.random.default_rng(seed)
    twists = np.concatenate([upward(answer, level, frequencies) for level in levels])
    noise = rng.normal(size=len(twists)) + 1j * rng.normal(size=len(twists))
    return steps(np.tile(frequencies, len(levels)), twists * (1 + error * noise), np.repeat(levels, len(frequencies)))


def steps(frequencies: np.ndarray, twists: np.ndarray, torques: np.ndarray) -> SteppedStiffness:
    """Steps without means."""
    none = np.zeros(len(frequencies))
    return SteppedStiffness(frequencies, twists, torques.astype(complex), none, none, none)


def integrated(levels: tuple[float, ...], frequencies: np.ndarray, samples: int = 250, periods: int = 50) -> np.ndarray:
    """First harmonics of the twist with all harmonics of two stages and friction, from rest, by Runge and Kutta."""
    torque, omega = np.repeat(levels, len(frequencies)), 2 * np.pi * np.tile(frequencies, len(levels))
    k1, g1, k2, c, M = STAGES.values()
    h, x, v = 2 * np.pi / omega / samples, np.zeros(len(torque)), np.zeros(len(torque))
    harmonic = np.zeros(len(torque), dtype=complex)

    def bend(phase: float, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        size = np.abs(x)
        spring = np.sign(x) * (k1 * np.minimum(size, g1) + k2 * np.maximum(size - g1, 0))
        return (torque * np.cos(phase) - spring - c * v - M * np.tanh(v / 0.02)) / INERTIA

    for step in range(samples * periods):
        phase = 2 * np.pi * step / samples
        if step >= samples * (periods - 1):
            harmonic += x * np.exp(-1j * phase) * 2 / samples
        middle, after = phase + np.pi / samples, phase + 2 * np.pi / samples
        a = bend(phase, x, v)
        b = bend(middle, x + h / 2 * v, v + h / 2 * a)
        d = bend(middle, x + h / 2 * (v + h / 2 * a), v + h / 2 * b)
        e = bend(after, x + h * (v + h / 2 * b), v + h * d)
        x, v = x + h * v + h * h / 6 * (a + b + d), v + h / 6 * (a + 2 * b + 2 * d + e)
    return harmonic

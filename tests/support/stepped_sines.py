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
    grid, found, before = np.geomspace(1e-4, 2.0, 4000), [], None
    for omega in 2 * np.pi * frequencies:

        def missed(a: np.ndarray, omega: float = omega) -> np.ndarray:
            return np.abs((answer(a, omega) - INERTIA * omega**2) * a) - torque

        values = missed(grid)
        places = np.flatnonzero(values[:-1] * values[1:] < 0)
        roots = [scipy.optimize.brentq(missed, grid[i], grid[i + 1], xtol=1e-13) for i in places]
        a = roots[-1] if before is None else min(roots, key=lambda one: abs(one - before))
        found.append(torque / (answer(np.array(a), omega) - INERTIA * omega**2))
        before = a
    return np.array(found)


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

"""Modes missed and modes invented by each method of modal identification, over random systems with noise.

python -m benchmarks.modal_methods [SYSTEMS]    # 22 of each kind take some minutes
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

import torsionnet as tn
from benchmarks._sizes import ARGUMENTS, sized
from torsionnet import Channel, FrequencyResponse
from torsionnet.modal import Settings, identify_modes

METHODS = ("rational", "lscf", "auto")
SAME_FREQUENCY, SAME_DAMPING = 0.004, 0.5
"""Relative errors of frequency and damping up to which a mode counts as found; modes 1.5 % apart stay distinct."""


@dataclass(frozen=True)
class Kind:
    """Kind of random systems: natural frequencies in Hz, damping ratios, sensors, and noise over the RMS."""

    name: str
    modes: Any
    outputs: int
    inputs: int
    noise: float
    frequencies: NDArray[np.float64]


def close(spacing: float, damping: float) -> Any:
    def modes(rng: Any) -> tuple[Any, Any]:
        first = rng.uniform(8, 15)
        return np.array([first, first * (1 + spacing), rng.uniform(18, 26)]), damping * rng.uniform(0.7, 1.4, 3)

    return modes


def spread(count: int, low: float, high: float, damping: tuple[float, float]) -> Any:
    def modes(rng: Any) -> tuple[Any, Any]:
        places = np.linspace(0, 1, count) + rng.uniform(-0.25, 0.25, count) / max(count - 1, 1)
        return low * (high / low) ** places, rng.uniform(*damping, count)

    return modes


LINES, HIGH = np.arange(2, 30.001, 0.05), np.arange(20, 130, 0.1)
KINDS = (
    Kind("pair 1.5 % apart, damping 0.5 %, 1 sensor", close(0.015, 0.005), 1, 1, 0.05, LINES),
    Kind("pair 1.5 % apart, damping 0.5 %, 3 sensors", close(0.015, 0.005), 3, 1, 0.05, LINES),
    Kind("pair 1.5 % apart, damping 1 %, 3 sensors", close(0.015, 0.01), 3, 1, 0.05, LINES),
    Kind("pair 3 % apart, damping 1 %, 3 sensors", close(0.03, 0.01), 3, 1, 0.05, LINES),
    Kind("2 modes of 15 to 40 %, 1 sensor, noise 1 %", spread(2, 5, 20, (0.15, 0.4)), 1, 1, 0.01, LINES),
    Kind("5 modes of 0.5 to 3 %, 4 sensors", spread(5, 4, 26, (0.005, 0.03)), 4, 1, 0.05, LINES),
    Kind("12 modes of 0.5 to 1 %, 6 sensors", spread(12, 30, 120, (0.005, 0.01)), 6, 1, 0.05, HIGH),
    Kind("12 modes of 0.5 to 1 %, 6 sensors, 2 inputs", spread(12, 30, 120, (0.005, 0.01)), 6, 2, 0.05, HIGH),
)


def response(kind: Kind, seed: int) -> tuple[NDArray[np.complex128], FrequencyResponse]:
    """Poles of a system, and its response with random shapes and noise."""
    rng = np.random.default_rng([seed, len(kind.name)])
    f, zeta = kind.modes(rng)
    poles = 2 * np.pi * f * (-zeta + 1j * np.sqrt(1 - zeta**2))
    s = 2j * np.pi * kind.frequencies
    values = np.zeros((len(s), kind.outputs, kind.inputs), dtype=complex)
    for pole in poles:
        shapes = (rng.choice([-1, 1], n) * rng.uniform(0.4, 1, n) for n in (kind.outputs, kind.inputs))
        peak = 2 * np.abs(pole.real * pole)  # all peaks are of one height
        values += np.outer(*shapes) * (peak / ((s - pole) * (s - pole.conj())))[:, None, None]
    size = kind.noise * np.sqrt(np.mean(np.abs(values) ** 2, axis=0))
    values = values + size * (rng.normal(size=values.shape) + 1j * rng.normal(size=values.shape)) / np.sqrt(2)
    outputs = tuple(Channel(f"y{o}", "rad") for o in range(kind.outputs))
    inputs = tuple(Channel(f"u{i}", "N*m") for i in range(kind.inputs))
    return poles, FrequencyResponse(kind.frequencies, values, outputs, inputs, "test")


def missed_and_invented(
    poles: NDArray[np.complex128], found: NDArray[np.complex128], top: float = np.inf
) -> tuple[int, int]:
    """Numbers of modes missed and of modes invented, from a one-to-one assignment."""
    found = found[np.abs(found) <= 2 * np.pi * top]
    if not len(found):
        return len(poles), 0
    ratios = -poles.real / np.abs(poles)
    apart = np.abs(np.abs(found) / np.abs(poles)[:, None] - 1)
    damping = np.abs((-found.real / np.abs(found)) / ratios[:, None] - 1)
    good = (apart < SAME_FREQUENCY * np.maximum(1, ratios / 0.02)[:, None]) & (damping < SAME_DAMPING)
    rows, columns = linear_sum_assignment(np.where(good, apart, 1e3))
    pairs = int(good[rows, columns].sum())
    return len(poles) - pairs, len(found) - pairs


def campaign(kind: Kind, method: Any, systems: int) -> tuple[int, int, int]:
    """Numbers of modes, of modes missed, and of modes invented, over random systems of a kind."""
    counts = np.zeros(3, dtype=int)
    for seed in range(systems):
        poles, measured = response(kind, seed)
        try:
            found = identify_modes(measured, Settings(method)).poles
        except tn.SolveError:
            found = np.zeros(0, dtype=complex)
        counts += (len(poles), *missed_and_invented(poles, found, float(kind.frequencies[-1])))
    modes, missed, invented = counts.tolist()
    return modes, missed, invented


def main(systems: int, kinds: tuple[Kind, ...] = KINDS) -> None:
    for kind in kinds:
        for method in METHODS:
            began = time.perf_counter()
            modes, missed, invented = campaign(kind, method, systems)
            counts = f"{missed:3d} of {modes} missed, {invented:3d} invented"
            print(f"{kind.name:44s} {method:9s} {counts}, {time.perf_counter() - began:.1f} s", flush=True)


if __name__ == "__main__":
    main(int(ARGUMENTS[0]) if ARGUMENTS else sized(22, 1), sized(KINDS, KINDS[:1]))

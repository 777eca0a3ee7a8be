"""Draws of machines whose modes, orders, patterns and run-ups are known, for the coverage of intervals.

Each function gives the errors of one draw over the half widths of their 95 % intervals, NaN where one is withheld.
Records are simulated exactly: modes by their poles over a torque that is held, pulses by Newton's method, run-ups by
the closed recursion of a mode over a torque that is straight between samples.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from torsionnet import SolveError
from torsionnet.modal import identify_modes, modes_from_run_up
from torsionnet.signals import (
    PhaseReference,
    PulseChannel,
    Recording,
    Signal,
    Welch,
    Wheel,
    WheelTest,
    calibrate_wheel,
    estimate,
    track_orders,
    wheel_rotation,
)

RATE, FINE, NORMAL_HALF_WIDTH = 200.0, 10, 1.96
TEETH, TURNS, STEP, ANGLE = 60, 18, 1e-6, np.radians(114)
ORDERS = np.arange(1, 13) / 2


def passed(
    torque: NDArray[np.float64], poles: Sequence[complex], h: float, straight: bool = False
) -> NDArray[np.float64]:
    """Sum of unit modes ``1/Im p Im(1/(s - p))`` behind a torque that is held, or straight, over steps of h seconds."""
    from scipy.signal import lfilter

    total = np.zeros(len(torque))
    for p in poles:
        step = np.exp(p * h)
        whole = (step - 1) / p
        rising = (whole / h - 1) / p if straight else 0.0  # of the torque at the end of the step
        state = lfilter([rising, whole - rising], [1, -step], torque.astype(complex))
        total += state.imag / p.imag * abs(p) ** 2
    return total


def coloured(rng: np.random.Generator, count: int, share: float) -> NDArray[np.float64]:
    """Noise of unit variance in which each value keeps a share of the one before."""
    from scipy.signal import lfilter

    return np.asarray(lfilter([np.sqrt(1 - share**2)], [1, -share], rng.standard_normal(count + 500))[500:])


def modes(seed: int) -> list[float]:
    """One to five modes of 1.5 to 18 Hz and 0.2 to 50 %, windows of 1 to 20 s, noise of any size, colour and place."""
    from scipy.signal import butter, chirp, sosfilt

    rng = np.random.default_rng(seed)
    count, duration = int(rng.integers(1, 6)), float(rng.choice([60, 120]))
    f = np.sort(np.exp(rng.uniform(np.log(1.5), np.log(18), count)))
    while count > 1 and (f[1:] / f[:-1]).min() < 1.2:
        f = np.sort(np.exp(rng.uniform(np.log(1.5), np.log(18), count)))
    zeta = np.exp(rng.uniform(np.log(0.002), np.log(0.5), count))
    t = np.arange(round(duration * RATE * FINE)) / (RATE * FINE)
    low = butter(10, 40, fs=RATE * FINE, output="sos")
    torque = chirp(t, 0.3, duration, 30) if seed % 2 else sosfilt(low, 5 * rng.standard_normal(len(t)))
    poles = 2 * np.pi * f * (-zeta + 1j * np.sqrt(1 - zeta**2))
    angle = passed(torque, poles.tolist(), 1 / (RATE * FINE))[::FINE]
    level, colour, seconds = 10 ** rng.uniform(-5, -1.5), float(rng.choice([0, 0.9])), float(rng.choice([1, 2, 5, 20]))
    pair = [torque[::FINE], angle]
    for place in ((1,), (0,), (0, 1))[seed // 2 % 3]:  # noise on the angle, on the torque, or on both
        pair[place] = pair[place] + level * pair[place].std() * coloured(rng, len(angle), colour)
    record = Recording((Signal("T", "torque", pair[0]), Signal("y", "angle", pair[1])), RATE)
    settings = Welch(seconds=seconds)
    found = identify_modes(estimate(record, "y", "T", settings=settings).between(0.5, 20))
    scores: list[float] = []
    for own, damping in zip(f, zeta, strict=True):
        if not len(found):
            scores += [np.inf, np.inf]
            continue
        at = int(np.argmin(np.abs(found.natural_frequencies - own)))
        scores += [
            (found.natural_frequencies[at] - own) / (NORMAL_HALF_WIDTH * found.frequency_errors[at]),
            (found.damping_ratios[at] - damping) / (NORMAL_HALF_WIDTH * found.damping_errors[at]),
        ]
    return scores


def vibration(rng: np.random.Generator) -> NDArray[np.complex128]:
    """Amplitudes in rad of orders 0.5 to 6, falling with the order."""
    return np.radians(0.1) / ORDERS * np.exp(1j * rng.uniform(0, 2 * np.pi, len(ORDERS)))


def pulses(
    values: NDArray[np.complex128], positions: NDArray[np.float64], speed: float, behind: float = 0.0
) -> NDArray[np.float64]:
    """Times in s, in steps of the counter, at which teeth pass a pickup on a vibrating shaft at a steady speed."""
    numbers = np.arange(TEETH * TURNS)
    wanted = 2 * np.pi * numbers / TEETH + positions[numbers % TEETH] + behind
    phi = wanted.copy()
    for _ in range(12):
        turning = np.exp(1j * np.outer(phi, ORDERS)) * values
        phi -= (phi + turning.sum(axis=1).real - wanted) / (1 + (1j * ORDERS * turning).sum(axis=1).real)
    return np.asarray(np.round(phi / speed / STEP) * STEP)


def parts(away: NDArray[np.complex128], half: NDArray[np.float64]) -> list[float]:
    return [*(away.real / half).tolist(), *(away.imag / half).tolist()]


def speed_of(rng: np.random.Generator) -> float:
    """Speed in rad/s at which a turn takes a whole number of the counter's steps, or any other."""
    return float(2 * np.pi * rng.choice([20.0, 25.0, rng.uniform(15, 30)]))


def orders(seed: int) -> list[float]:
    """Half orders of a wheel's vibration, teeth with errors of 0.005 degrees, steps of 1 us, one steady speed."""
    rng = np.random.default_rng(seed)
    values, places = vibration(rng), np.radians(0.005) * rng.standard_normal(TEETH)
    wheel = wheel_rotation(PulseChannel("n", pulses(values, places, speed_of(rng))), Wheel(teeth=TEETH))
    half = ORDERS[::2]
    (found,) = track_orders(None, wheel, wheels=[wheel], orders=half, phase_reference=PhaseReference(0.0, "tooth 0"))
    return parts(found.values[:, 0] - values[::2], found.half_widths[:, 0])


def patterns(seed: int) -> list[float]:
    """Orders of a pitch pattern by two pickups, steps of 1 us, one steady speed."""
    rng = np.random.default_rng(seed)
    values, places, speed = vibration(rng), np.radians(0.02) * rng.standard_normal(TEETH), speed_of(rng)
    pickups = [PulseChannel(str(at), pulses(values, places, speed, at)) for at in (0.0, ANGLE)]
    marks = PulseChannel("index", (2 * np.pi * np.arange(1, TURNS) - np.pi / TEETH) / speed)
    found = calibrate_wheel([WheelTest(*pickups, marks)], Wheel(teeth=TEETH), pickup_angle=float(ANGLE)).orders[:12]
    tooth = 2 * np.pi * np.arange(TEETH) / TEETH
    exact = np.array([2 / TEETH * (places * np.exp(-1j * row.order * tooth)).sum() for row in found])
    return parts(np.array([row.value for row in found]) - exact, np.array([row.half_width for row in found]))


def run_ups(seed: int) -> list[float]:
    """Frequency and damping of a mode of 1 to 5 % that order 1 passes in a run-up, with noise of 0.1 to 3 %."""
    rng = np.random.default_rng(seed)
    zeta, sweep, rate = float(rng.uniform(0.01, 0.05)), float(rng.uniform(0.5, 8)), 1000.0
    t = np.arange(0, 28 / sweep, 1 / rate)
    phase = 2 * np.pi * (8 * t + sweep * t**2 / 2)
    pole = 2 * np.pi * 20 * complex(-zeta, np.sqrt(1 - zeta**2))
    torque = passed(np.cos(phase + rng.uniform(0, 2 * np.pi)), [pole], 1 / rate, straight=True)
    torque = torque + 10 ** rng.uniform(-3, -1.5) * np.abs(torque).max() * rng.standard_normal(len(t))
    speed = Signal("n", "velocity", 2 * np.pi * (8 + sweep * t))
    try:
        found = modes_from_run_up(Recording((Signal("T", "torque", torque), speed), rate), "T", 1, "n")
    except SolveError:
        return [np.nan, np.nan]
    return [
        (found.natural_frequencies[0] - 20) / found.frequency_half_widths[0],
        (found.damping_ratios[0] - zeta) / found.damping_half_widths[0],
    ]


DRAWS: dict[str, Callable[[int], list[float]]] = {
    "modes": modes, "orders": orders, "patterns": patterns, "run-ups": run_ups
}  # fmt: skip
"""Functions that draw, by the name of the case."""


def covered(name: str, seeds: range) -> list[list[float]]:
    """Errors over half widths of the draws of one case, a list for each draw."""
    return [DRAWS[name](seed) for seed in seeds]


def drawn_row(name: str, draws: list[list[float]]) -> str:
    """Table row of a case: draws, intervals, those withheld, share that holds the truth, RMS of the scores."""
    scores = np.concatenate([np.asarray(one, dtype=float) for one in draws])
    known = scores[~np.isnan(scores)]
    rms = NORMAL_HALF_WIDTH * np.sqrt(np.median(known**2)) / 0.6745
    withheld = f"{100 * (1 - len(known) / len(scores)):.1f} %"
    inside = f"{100 * np.mean(np.abs(known) <= 1):.1f} %"
    return f"| {name} | {len(draws)} | {len(scores)} | {withheld} | {inside} | {rms:.2f} |"

"""Motions of random plants with two and three rigid frictions, against exponentials and enumerated states."""

import numpy as np
import pytest
from support import campaigns
from support.friction_plants import RubbingPlant, rubbing_motion, rubbing_plant

from torsionnet.response import MotionStart
from torsionnet.solve.motion.guard_polynomials import DEGREE, first_root

SECONDS = 0.2


def simulated(plant, rate, seconds):
    """Angles (n_t, n) in rad of a plant sampled at a rate in Hz."""
    nodes = [f"n{i}" for i in range(len(plant.inertias))]
    torques = {}
    for i, mean, rise, amplitude, omega, phase in plant.loads:
        wave = {"mean": mean, "amplitude": amplitude, "frequency": omega / (2 * np.pi), "phase": f"{phase!r} rad"}
        torques[f"n{i}"] = wave if amplitude else {"0 s": mean, "100 s": mean + 100 * rise}
    record = plant.drivetrain().simulate(
        nodes,
        scenario={"type": "torques", "duration": seconds, "torque": torques},
        start=MotionStart(speeds=dict(zip(nodes, plant.speeds, strict=True))),
        sampling_rate=rate,
    )
    return np.array([record[node].values for node in nodes]).T


def compared(plant, rates, seconds=SECONDS):
    """Check samples at all rates against the reference, and return its events."""
    common = np.arange(round(100 * seconds) + 1) / 100
    wanted, events = rubbing_motion(plant, common)
    for rate in rates:
        apart = np.abs(simulated(plant, rate, seconds)[:: round(rate / 100)] - wanted).max()
        assert apart < 1e-10 * np.abs(wanted).max()
    return events


@pytest.mark.parametrize(("frictions", "seed"), [(2, 19), (2, 29), (3, 12), (3, 14)])
def test_few_seeds(frictions, seed):
    assert len(compared(rubbing_plant(seed, frictions), (300.0, 1000.0, 7000.0))) > 3


@pytest.mark.slow
@pytest.mark.parametrize("frictions", [2, 3])
def test_many_seeds(frictions):
    events = [compared(rubbing_plant(seed, frictions), (500.0, 20e3)) for seed in range(campaigns.examples(12, 250))]
    assert sum(map(len, events)) > 5 * len(events)


def test_slip_that_begins_without_acceleration():
    """A light disc lets go of a heavy one: both turn at 5 rad/s, and their slip begins with an acceleration of zero."""
    plant = RubbingPlant(
        [0.81, 0.88, 1.7, 2.0, 0.046, 0.41],
        [(1, 2, 2.3e4, 0.0), (2, 3, 5.6e4, 14.0), (4, 5, 2.6e3, 0.77)],
        [(0, 1, 310.0, 310.0), (3, 4, 12.0, 12.0)],
        [(0, -41.0, 0.0, 270.0, 8 * np.pi, 0.0), (3, 0.0, -290.0, 0.0, 1.0, 0.0)],
        [-2.3, 4.5, 3.1, 0.0, 0.0, 1.7],
    )
    assert len(compared(plant, (200.0, 1000.0, 9000.0), 0.3)) > 5


@pytest.mark.parametrize(
    ("start", "rise", "expected"),
    [(-5.42e-18, 1.4e-3, -1.0), (-5.42e-18, -1.4e-3, 0.0), (-1e-9, 1e-3, 0.0), (-5.42e-18, 1e-16, 0.0)],
)
def test_guard_that_begins_below_zero_by_rounding(start, rise, expected):
    """One that rises above zero at once has not fallen; one that falls, or was far below, or stays, has."""
    course = [start, rise, *[0.0] * (DEGREE - 1)]
    assert first_root(course, 0.25, 5.4e-18) == expected


def test_guard_that_rises_from_below_and_falls_again():
    """0.1 s - s^2 from -5e-18 on falls below zero at 0.1, not where it begins."""
    assert first_root([-5e-18, 0.1, -1.0, *[0.0] * (DEGREE - 2)], 0.25, 4e-18) == pytest.approx(0.1, rel=1e-12)

"""Motions over time of random plants with clearances, stages and friction against CVODE with located events."""

import numpy as np
import pytest
from support import campaigns
from support.motion_reference import reference_motion
from support.random_motion_plants import moving_plant

from torsionnet.model.channels import Sensor
from torsionnet.motion.contact_states import MotionStart

ROUNDING = 1e-12
"""Share of the speeds by which the start is changed, to see how much a motion amplifies errors of this size."""


def simulated(plant, nodes, times, speeds):
    sensors = [Sensor("angle", node) for node in nodes]
    start = MotionStart(speeds=speeds)
    record = plant.drivetrain.simulate(sensors, plant.samples(times), 1 / (times[1] - times[0]), initial_state=start)
    return np.array([record[str(sensor)].values for sensor in sensors]).T


def compared(seed, most, seconds):
    """Largest differences to CVODE and to a motion from a start changed by rounding, as shares of the largest angle."""
    plant = moving_plant(seed, most)
    times = np.linspace(0, seconds, round(1000 * seconds) + 1)
    # CVODE looks for roots at every time asked for, too: with fewer it misses two roots that follow each other closely
    reference = reference_motion(plant.drivetrain, plant.functions(), times, speeds=plant.speeds)
    nodes = [node for node in reference.nodes if node.startswith("n")]
    wanted = np.array([reference.angle(node) for node in nodes]).T
    found = simulated(plant, nodes, times, plant.speeds)
    moved = simulated(plant, nodes, times, {node: (1 + ROUNDING) * w for node, w in plant.speeds.items()})
    scale = np.abs(wanted).max()
    return np.abs(found - wanted).max() / scale, np.abs(found - moved).max() / scale, reference


@pytest.mark.parametrize("seed", [3, 6, 7])
def test_a_few_inertias(seed):
    apart, _, reference = compared(seed, 3, 0.1)
    assert len(reference.events) >= 3
    assert apart < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("seed", campaigns.by_day(range(12), 4))
def test_up_to_twenty_inertias(seed):
    apart, grown, reference = compared(seed, 20, 1.0)
    assert len(reference.events) > 20
    assert apart < 2e-10 + 100 * grown

"""Orders over the own angle of a wheel, which are not those over its mean angle of rotation (issue 32)."""

import numpy as np
import pytest
import scipy
from support.turned_wheels import crossing_angles, steady

import torsionnet as tn
from torsionnet.signals import PhaseReference, track_orders
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import Wheel
from torsionnet.signals.rotation.wheel_rotation import wheel_rotation

DEGREE = np.pi / 180
TEETH, TURNS = 60, 40
SPEED = 600 * np.pi / 30
HALF = np.arange(1, 25) / 2


def passages(values, teeth=TEETH, turns=TURNS):
    """Mean angles in rad at which the teeth of a perfect wheel pass, on a shaft with these orders of vibration."""
    return crossing_angles(HALF, values, np.zeros(teeth), turns)


def over_own_angle(values):
    """Orders of the vibration over the angle of the wheel itself, which is even from tooth to tooth: a plain sum."""
    teeth = 20 * TEETH  # so fine that nothing aliases
    own = 2 * np.pi * np.arange(2 * teeth) / teeth
    vibration = own - passages(values, teeth, 2)
    return 2 * np.mean(vibration * np.exp(-1j * np.outer(HALF, own)), axis=1)


def largest_change(values, seen):
    """Largest change of an order, of an amplitude, and of a phase where the peak is above 0.01 degrees; in degrees."""
    large = np.abs(values) > 0.01 * DEGREE
    phases = np.abs(np.angle(seen[large] / values[large]))
    changes = np.abs(seen - values).max(), np.abs(np.abs(seen) - np.abs(values)).max(), phases.max()
    return np.array(changes) / DEGREE


@pytest.fixture(scope="module")
def plant():
    return tn.load("engine_generator_set").configured("firing=normal,rubber=warm")


def orders_of(plant, node):
    run = plant.order_response(node, speeds=np.array([SPEED]))
    assert [float(line.relative) for line in run.lines] == HALF.tolist()
    return run.values[0, :, 0]


@pytest.mark.parametrize(
    ("node", "share", "order", "amplitude", "phase"),
    [
        ("fly", 0.0, 0.0055, 0.0027, 4.2),
        ("nose", 0.0, 0.0059, 0.0046, 12.4),
        ("fly", 1.0, 0.041, 0.039, 134),
    ],
    ids=["flywheel", "free end", "flywheel, cylinder 4 lost"],
)
def test_own_angle_of_the_generating_set_at_600_rpm(plant, node, share, order, amplitude, phase):
    """What is wrong over the own angle, and that the tracker, which uses the mean angle, has none of it."""
    values = orders_of(plant.with_excitation_numbers({"engine.misfire_share.4": share}), node)
    assert largest_change(values, over_own_angle(values)) == pytest.approx([order, amplitude, phase], rel=0.02)

    wheel = wheel_rotation(PulseChannel("fly", steady(passages(values), SPEED)), Wheel(teeth=TEETH))
    (found,) = track_orders(None, wheel, wheels=[wheel], orders=HALF, phase_reference=PhaseReference(0.0, "tooth 0"))
    mean = largest_change(values, np.mean(found.values, axis=1))
    assert mean[0] < 2e-4
    assert mean[2] < 0.5


def test_own_angle_puts_0_075_degrees_into_order_6_from_1_69_degrees_of_order_3():
    """Kepler's equation: 3 theta = E + 3 V sin E with E = 3 phi, whose solution is a sum of Bessel functions."""
    size = 1.69 * DEGREE
    values = np.where(HALF == 3, -1j * size, 0)  # size * sin(3 phi)
    seen = over_own_angle(values)
    for place in np.flatnonzero(HALF % 3 == 0):
        n = HALF[place] / 3
        assert seen[place] == pytest.approx(1j * 2 / (3 * n) * scipy.special.jv(n, -3 * n * size), abs=1e-9)
    assert abs(seen[HALF == 6][0]) == pytest.approx(3 / 2 * size**2, rel=0.01)
    assert abs(seen[HALF == 6][0]) / DEGREE == pytest.approx(0.075, abs=5e-4)

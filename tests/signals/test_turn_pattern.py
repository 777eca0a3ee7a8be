"""The pitch errors of a wheel in a speed signal are named with order and amplitude; vibration is not taken for them."""

import re

import numpy as np
import pytest

from torsionnet.signals import Recording, Signal, check_recording
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.turn_pattern import turn_pattern

RATE = 2000.0
TIME = np.arange(0, 30, 1 / RATE)
RUN_UP = 600 * np.pi / 30 * (1 + TIME / TIME[-1])
TURNED = np.cumsum(RUN_UP) / RATE
PATTERN = {1: np.radians(0.05), 2: np.radians(0.01), 5: np.radians(0.02)}


def wheel_speed(turned, speed):
    """Speed that a wheel of these errors shows: the derivative of its angle, by the chain rule."""
    slopes = sum(-order * size * np.sin(order * turned + order) for order, size in PATTERN.items())
    return speed * (1 + slopes)


def noise(size=0.02):
    return np.random.default_rng(1).normal(size=len(TIME)) * size


def said(values, quantity="velocity"):
    record = Recording((Signal("n", quantity, values),), RATE)
    return [str(fault) for fault in check_recording(record) if "returns with every turn" in fault.message]


def test_named_over_a_run_up_with_order_and_amplitude():
    found = turn_pattern(wheel_speed(TURNED, RUN_UP) + noise(), RATE)
    assert found.constant is True
    for order, size in PATTERN.items():
        assert abs(found.amplitudes[order - 1]) == pytest.approx(size, rel=0.03)
    (text,) = said(wheel_speed(TURNED, RUN_UP) + noise())
    assert text.startswith("channels.n: warning: returns with every turn: order 1 of 0.05 degrees, order 2 of 0.0")
    assert "nothing was removed: calibrate the wheel" in text


def test_named_in_an_angle():
    angle = np.cumsum(wheel_speed(TURNED, RUN_UP)) / RATE
    assert len(said(angle, "angle")) == 1


def test_vibration_over_a_run_up_is_not_a_wheel():
    """Under a torque of constant amplitude the angle falls with the square of the speed."""
    size = np.radians(0.05) * (RUN_UP[0] / RUN_UP) ** 2
    assert said(RUN_UP * (1 - size * np.sin(TURNED)) + noise()) == []


def test_at_one_speed_both_readings_are_said():
    speed = np.full(len(TIME), 100.0)
    turned = np.cumsum(speed) / RATE
    values = speed * (1 - sum(np.radians(0.01) * np.sin(order * turned + order**2) for order in range(1, 9)))
    (text,) = said(values + noise())
    assert text.startswith("channels.n: note: returns with every turn")
    assert "one speed does not tell them from vibration" in text
    vibration = speed * (1 - np.radians(0.3) * np.sin(3 * turned))
    assert said(vibration + noise()) == []


@pytest.mark.parametrize("values", [noise(1.0), 100 + noise(1.0), np.zeros(len(TIME)), np.sin(TIME)])
def test_nothing_is_said_of_other_signals(values):
    assert said(values) == []


def test_missing_pulses_of_a_channel_of_pulses_are_named():
    times = np.delete(np.arange(600) / 100, 300)
    record = Recording((Signal("T", "torque", np.sin(TIME)),), RATE, pulses=(PulseChannel("n1", times),))
    (text,) = [str(fault) for fault in check_recording(record) if "n1" in fault.path]
    assert re.match(r"channels\.n1: .* 2\.99 s.*lost-pulses", text)

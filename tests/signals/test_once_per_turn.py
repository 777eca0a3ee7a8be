"""One pulse per turn: what it can show, the count of turns and the speed, beside rota-order, and what it cannot.

The run is as one published by D. H. Diamond, Intro to Blade Tip Timing, chapter 3 (2024): from 950 to 1325 r/min and back
in 41 s. docs/validation.md tells how the published times themselves read.
"""

import numpy as np
import pytest
from support.known_rotation import pulse_times

from torsionnet.base.errors import UsageError
from torsionnet.signals import PulseChannel, Wheel, mean_rotation, wheel_rotation

RPM = np.pi / 30
SECONDS = 41.0
RISE = 2 * np.pi / SECONDS


def speed(t):
    """Speed in rad/s."""
    return (1137.5 - 187.5 * np.cos(RISE * t)) * RPM


def angle(t):
    """Integral of the speed, in rad."""
    return (1137.5 * t - 187.5 / RISE * np.sin(RISE * t)) * RPM


@pytest.fixture(scope="module")
def times():
    turns = np.arange(1, int(angle(SECONDS) / (2 * np.pi)))
    return pulse_times(angle, 2 * np.pi * turns, SECONDS)


def test_turns_and_speeds_are_those_of_the_closed_form(times):
    wheel = wheel_rotation(PulseChannel("key", times), Wheel(teeth=1))
    assert (wheel.remarks, wheel.revolutions, len(times)) == ((), len(times) - 1, 776)
    middle = (times[1:] + times[:-1])[5:-5] / 2
    assert wheel.speed(middle) == pytest.approx(speed(middle), rel=1e-6)
    mean = mean_rotation(PulseChannel("key", times), cycle=2)
    assert mean.speed(middle) == pytest.approx(speed(middle), rel=1e-4)


def test_counts_and_speeds_agree_with_rota_order(times):
    tacho = pytest.importorskip("rota.speed").tacho_to_rpm
    rate = 5000.0
    at = np.arange(int(SECONDS * rate)) / rate
    after = at[:, None] - times[np.clip(np.searchsorted(times, at), 1, len(times) - 1)[:, None] + [-1, 0]]
    signal = np.clip(after * rate + 0.5, 0, 1).max(axis=1, initial=0, where=after < 10e-3)  # a flank of one sample
    theirs, found = tacho(signal, rate, return_info=True)
    assert (len(found["pulse_times"]), found["n_missing"], found["n_spurious"]) == (len(times), 0, 0)
    wheel = wheel_rotation(PulseChannel("key", times), Wheel(teeth=1))
    inside = np.flatnonzero((at > times[5]) & (at < times[-6]))[::50]
    assert np.abs(wheel.speed(at[inside]) / RPM - theirs[inside]).max() < 0.4  # parabolas through five pulses lag


@pytest.mark.parametrize("order", [0.5, 1, 6])
def test_no_order_of_torsional_vibration_is_told(times, order):
    wheel = wheel_rotation(PulseChannel("key", times), Wheel(teeth=1))
    with pytest.raises(UsageError, match=rf"order {order}: .* orders up to 0\.4167"):
        wheel.check_orders([order])

"""Complex orders of turning machines: averages over cycles and Vold-Kalman filters against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from torsionnet.response.measured.pulse_channel import PulseChannel
from torsionnet.response.recording import Recording, Signal
from torsionnet.signals import (
    CycleAverage,
    PhaseReference,
    VoldKalman,
    mean_rotation,
    track_orders,
)
from torsionnet.signals.orders.mean_rotation import MeanRotation
from torsionnet.signals.rotation.wheel import Wheel
from torsionnet.signals.rotation.wheel_rotation import WheelRotation, wheel_rotation

ORDERS = np.arange(1, 25) / 2
"""Orders 0.5 to 12 of a four-stroke inline six."""
TOP = PhaseReference(0.0, "tooth 0")


def six_cylinder(seed: int = 1) -> np.ndarray:
    """Complex amplitudes in rad of orders 0.5 to 12, falling with the order, the firing orders larger."""
    rng = np.random.default_rng(seed)
    sizes = np.radians(0.05) / ORDERS * np.where(ORDERS % 3 == 0, 5, 1)
    return sizes * np.exp(1j * rng.uniform(0, 2 * np.pi, len(ORDERS)))


def wave(orders: np.ndarray, values: np.ndarray, phi: np.ndarray) -> np.ndarray:
    return (np.exp(1j * np.outer(phi, orders)) @ values).real


def pulses_of(rpm: float, turns: int, values: np.ndarray, teeth: int = 60, positions: np.ndarray | float = 0.0):
    """Times of the pulses of a wheel that turns by omega t + vibration, by fixed-point iteration."""
    omega = rpm * np.pi / 30
    angles = 2 * np.pi * np.arange(teeth * turns) / teeth + np.resize(positions, teeth * turns)
    times = angles / omega
    for _ in range(60):
        times = (angles - wave(ORDERS, values, omega * times)) / omega
    return times


def wheel(times: np.ndarray, teeth: int = 60, name: str = "wheel", **more: float) -> WheelRotation:
    return wheel_rotation(PulseChannel(name, times), Wheel(teeth=teeth, **more))


def run_up(begin: float, end: float, seconds: float, rate: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, mean angle in rad and speed in rad/s of a run-up between two speeds in r/min."""
    time = np.arange(int(seconds * rate)) / rate
    first, slope = begin * np.pi / 30, (end - begin) * np.pi / 30 / seconds
    return time, first * time + slope * time**2 / 2, first + slope * time


@pytest.mark.parametrize("rpm", [600, 1800])
def test_clean_orders_of_a_six_cylinder_engine_are_exact(rpm):
    """0.00002 degrees and 0.014 degrees of phase, as an independent tracker reached (issue 32)."""
    values = six_cylinder()
    seen = wheel(pulses_of(rpm, 60, values))
    (found,) = track_orders(None, seen, wheels=[seen], orders=ORDERS, reference=TOP)
    assert np.degrees(np.abs(np.abs(found.values) - np.abs(values)[:, None])).max() < 2e-5
    assert np.degrees(np.abs(np.angle(found.values / values[:, None]))).max() < 0.014
    assert found.rpm == pytest.approx(rpm, rel=1e-6)


def test_vold_kalman_gives_the_same_orders_inside_the_record():
    values = six_cylinder()
    seen = wheel(pulses_of(1800, 120, values))
    (found,) = track_orders(None, seen, wheels=[seen], orders=ORDERS, reference=TOP, method=VoldKalman(2.0))
    inner = found.values[:, 4:-4]
    assert np.degrees(np.abs(np.abs(inner) - np.abs(values)[:, None])).max() < 2e-5
    assert np.degrees(np.abs(np.angle(inner / values[:, None]))).max() < 0.014


def test_orders_over_the_own_angle_of_the_wheel_differ():
    """Orders over the wheel's own angle put 0.3 degrees of order 0.5 into the phase of order 12 (issue 32)."""
    values = np.where(ORDERS == 0.5, np.radians(3.0), 0) + np.where(ORDERS == 12, np.radians(0.3), 0)
    omega, time = 20 * np.pi, np.arange(40_000) / 20_000
    theta = omega * time + wave(ORDERS, values, omega * time)
    torque = wave(ORDERS, values, omega * time)
    record = Recording((Signal("a", "angle", theta), Signal("T", "torque", torque)), sampling_rate=20_000.0)
    (found,) = track_orders(record, mean_rotation(record, "a"), ["T"], orders=[0.5, 12], reference=TOP)
    assert found.values[:, 0] == pytest.approx([np.radians(3.0), np.radians(0.3)], rel=2e-3)
    own = np.linspace(0, 4 * np.pi, 4001)[:-1] + 4 * np.pi
    over_own = np.interp(own, theta, torque)
    line = 2 * np.mean(over_own * np.exp(-12j * own))
    assert abs(np.abs(line) - np.radians(0.3)) > np.radians(0.02)


def test_a_run_up_does_not_leak():
    _, phi, speed = run_up(600, 1800, 20, 5000)
    torque = 1000 + 20 * speed + 50 * np.cos(3 * phi + 0.4)
    record = Recording((Signal("n", "velocity", speed), Signal("T", "torque", torque)), sampling_rate=5000.0)
    (found,) = track_orders(record, mean_rotation(record, "n"), ["T"], orders=[0.5, 2.5, 3, 3.5], reference=TOP)
    assert np.abs(found.along(3) - 50 * np.exp(0.4j)).max() < 0.02
    assert np.abs(found.values[[0, 1, 3]]).max() < 0.02
    assert found.half_range == pytest.approx(50, rel=2e-3)


def test_interval_covers_in_white_and_in_correlated_noise():
    rng = np.random.default_rng(3)
    time, phi, speed = run_up(1200, 1200, 60, 2000)
    hits = {}
    for name, pole in (("white", 0.0), ("slow", 0.995)):
        noise = rng.standard_normal(len(time))
        if pole:
            from scipy.signal import lfilter

            envelope = lfilter([np.sqrt(1 - pole**2)], [1, -pole], rng.standard_normal((2, len(time))))
            noise = envelope[0] * np.cos(3 * phi) + envelope[1] * np.sin(3 * phi)
        record = Recording(
            (Signal("n", "velocity", speed), Signal("T", "torque", 10 * np.cos(3 * phi) + noise)), sampling_rate=2000.0
        )
        settings = CycleAverage(cycles=12)
        (found,) = track_orders(record, mean_rotation(record, "n"), ["T"], orders=[3], method=settings, reference=TOP)
        error = found.values[0] - 10
        parts = np.concatenate([error.real, error.imag])
        hits[name] = np.mean(np.abs(parts) < np.tile(found.half_widths[0], 2))
    assert 0.88 < hits["white"] < 1.0
    assert 0.85 < hits["slow"] <= 1.0


def crossing(rate: float = 1000.0) -> tuple[Recording, MeanRotation, MeanRotation, np.ndarray]:
    """Order 2 of a shaft that stands at 50 Hz and order 1 of one that passes it at 5 Hz/s."""
    time = np.arange(int(10 * rate)) / rate
    one, other = 2 * np.pi * 25 * time, 2 * np.pi * (25 * time + 2.5 * time**2)
    values = 3 * np.cos(2 * one + 0.5) + 2 * np.cos(other - 1)
    signals = (Signal("a", "angle", one), Signal("b", "angle", other), Signal("T", "torque", values))
    record = Recording(signals, sampling_rate=rate)
    return record, mean_rotation(record, "a"), mean_rotation(record, "b"), time


def test_crossing_orders_of_two_shafts_within_two_percent():
    """Constant amplitudes, 5 Hz/s, bandwidth 1 Hz: within 2 %, 0.05 % was seen (issue 32)."""
    record, one, other, _ = crossing()
    first, second = track_orders(
        record, one, ["T"], orders=[2], method=VoldKalman(1.0), reference=TOP, further=[(other, [1])]
    )
    begin = other.angles[0]
    assert np.abs(first.along(2) / (3 * np.exp(0.5j)) - 1).max() < 0.02
    assert np.abs(second.along(1) / (2 * np.exp(1j * (begin - 1))) - 1).max() < 0.02

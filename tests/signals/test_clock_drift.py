"""Clocks of two measuring systems: drift and offset found from what both recorded, and removed with a note."""

import numpy as np
import pytest

from torsionnet.base.errors import UsageError
from torsionnet.signals import (
    Recording,
    Signal,
    on_first_clock,
    rotation_clocks,
    signal_clocks,
)
from torsionnet.signals.rotation.clock_drift import ClockDrift, clocks_of_delays, variance_factor
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import Wheel
from torsionnet.signals.rotation.wheel_rotation import wheel_rotation

PPM = 50e-6
RPM = np.pi / 30
ORDER = 6


def pulses(course, teeth, last, errors=0.0, seed=0):
    """Times at which a shaft of the angle ``course(t)`` passes the teeth, by interpolation on a fine grid."""
    grid = np.linspace(0, last, int(last * 50_000))
    angle = course(grid)
    count = int(angle[-1] * teeth / (2 * np.pi))
    places = 2 * np.pi * np.arange(1, count) / teeth
    pattern = np.random.default_rng(seed).uniform(-errors, errors, teeth)
    return np.interp(places + pattern[np.arange(1, count) % teeth], angle, grid)


def steady(times):
    """1500 rpm with 0.3 degrees of order 6."""
    turned = 1500 * RPM * times
    return turned + np.radians(0.3) * np.sin(ORDER * turned)


def run_up(times):
    """From 900 rpm on with 15 rpm/s, and 0.3 degrees of order 6."""
    turned = 900 * RPM * times + 15 * RPM * times**2 / 2
    return turned + np.radians(0.3) * np.sin(ORDER * turned)


def rotation(times, teeth, name="n"):
    return wheel_rotation(PulseChannel(name, times), Wheel(teeth=teeth))


def phase(signal, angle):
    """Phase in degrees of order 6 of a signal over the angle of the shaft."""
    return np.degrees(np.angle(np.mean(signal * np.exp(-1j * ORDER * angle))))


class TestFiftyPpm:
    """50 ppm are 162 degrees at order 6 after 60 s at 1500 rpm."""

    def test_closed_form(self):
        assert PPM * 60 * 1500 / 60 * ORDER * 360 == pytest.approx(162)
        assert 1e-4 * 1500 / 60 * ORDER * 360 == pytest.approx(5.4)

    @pytest.mark.slow
    def test_found_from_pulses_and_removed(self):
        """Torque of order 6 from a second system, whose clock is 50 ppm fast, against the angle of the first."""
        first = rotation(pulses(steady, 60, 61, np.radians(0.05)), 60, "flywheel")
        theirs = (1 + PPM) * pulses(steady, 60, 61, np.radians(0.05), seed=1)
        second = rotation(theirs, 60, "turbo")
        clocks = rotation_clocks(first, second, same_start=True)
        assert clocks.drift == pytest.approx(PPM, abs=max(clocks.drift_half_width, 1e-9))
        assert clocks.drift_half_width < 1e-7
        own = np.arange(0, 60.5, 1e-3)
        torque = Signal("T", "torque", np.cos(ORDER * 1500 * RPM * own / (1 + PPM)))
        record = Recording((torque,), 1000.0, pulses=(PulseChannel("turbo", theirs),))
        moved = on_first_clock(record, clocks)

        def at_end(record):
            late = (record.time > 59.9) & (record.time < 60.1)
            return phase(record["T"].values[late], 1500 * RPM * record.time[late])

        assert abs(at_end(record)) == pytest.approx(162, abs=1)
        assert abs(at_end(moved)) < 0.5
        assert any("60500 samples, " in note and "pulses of turbo" in note for note in moved.notes)
        assert moved.pulses[0].times[-1] == pytest.approx(theirs[-1] / (1 + PPM), abs=1e-6)

    @pytest.mark.parametrize(("offset", "last"), [(1e-4, 20), pytest.param(2.345, 40, marks=pytest.mark.slow)])
    def test_offset_of_a_run_up_is_found(self, offset, last):
        first = rotation(pulses(run_up, 60, last), 60)
        second = rotation(offset + (1 + PPM) * pulses(run_up, 48, last), 48)
        clocks = rotation_clocks(first, second)
        assert clocks.drift == pytest.approx(PPM, abs=2e-7)
        assert clocks.offset == pytest.approx(offset, abs=2e-5)
        assert (clocks.period, np.isfinite(clocks.offset_half_width)) == (0.0, True)

    def test_steady_speed_leaves_the_offset_open(self):
        first = rotation(pulses(steady, 60, 20), 60)
        second = rotation(3.0 + (1 + PPM) * pulses(steady, 60, 20), 60)
        clocks = rotation_clocks(first, second)
        assert clocks.drift == pytest.approx(PPM, abs=1e-7)
        assert (clocks.offset_half_width, clocks.period) == (float("inf"), pytest.approx(0.04, rel=1e-3))
        assert "the offset stays open by whole turns of 0.04 s" in clocks.remarks[1]

    @pytest.mark.slow
    def test_found_from_a_torque_that_both_recorded(self):
        """White noise below 200 Hz by a sum of tones, so that it is known exactly on either clock; other rates too."""
        chance = np.random.default_rng(3)
        tones, phases = chance.uniform(5, 200, 120), chance.uniform(0, 2 * np.pi, 120)

        def torque(times):
            return sum(np.cos(2 * np.pi * tone * times + turn) for tone, turn in zip(tones, phases, strict=True))

        ours, theirs = np.arange(0, 30, 1e-3), np.arange(0, 30, 1 / 1500)
        noise = 0.5 * chance.normal(size=(2, len(theirs)))
        first = Recording((Signal("T", "torque", torque(ours) + noise[0, : len(ours)]),), 1000.0)
        second = Recording((Signal("T", "torque", torque((theirs - 0.0123) / (1 + PPM)) + noise[1]),), 1500.0)
        clocks = signal_clocks(first, second, "T")
        assert clocks.drift == pytest.approx(PPM, abs=max(2 * clocks.drift_half_width, 1e-7))
        assert clocks.offset == pytest.approx(0.0123, abs=max(2 * clocks.offset_half_width, 1e-6))
        assert clocks.drift_half_width < 2e-6
        moved = on_first_clock(second, clocks, like=first)
        apart = moved["T"].values - torque(moved.time)
        # Of the noise up to 750 Hz, the filter passes what is below 450 Hz.
        assert np.std(apart[1000:-1000]) == pytest.approx(0.5 * np.sqrt(450 / 750), rel=0.05)


def test_times_go_from_one_clock_to_the_other_and_back():
    clocks = ClockDrift(0.25, 0.0, 2.0, 0.0)  # shows 2 + 1.25 t
    assert clocks.to_second([0.0, 2.0]).tolist() == [2.0, 4.5]
    assert clocks.to_first([2.0, 4.5]).tolist() == [0.0, 2.0]


def test_a_record_keeps_its_samples_at_the_rate_of_the_first_clock():
    """A clock that gains shows too much time between samples: their true rate is higher."""
    record = Recording((Signal("T", "torque", np.zeros(10_001)),), 1000.0, start=0.25)
    moved = on_first_clock(record, ClockDrift(1e-3, 0.0, 0.25, 0.0))
    assert moved.time[[0, -1]] == pytest.approx([0, 10 / 1.001], abs=1e-9)


def test_intervals_of_the_drift_are_those_of_its_scatter():
    """Errors of the times of pulses: the drift scatters over 30 records as its half widths say."""
    true, draw = pulses(steady, 12, 4), np.random.default_rng(6)
    first = rotation(true, 12)
    ratios = []
    for _ in range(30):
        clocks = rotation_clocks(first, rotation(true + 2e-5 * draw.normal(size=len(true)), 12), same_start=True)
        ratios.append(clocks.drift / clocks.drift_half_width)
    assert 0.35 < np.std(ratios) < 0.75  # 1/1.96 and its scatter


def test_intervals_of_clocks_from_a_signal_are_those_of_its_scatter():
    """Noise of each system: drift and offset scatter over 12 records as their half widths say."""
    chance, ratios = np.random.default_rng(5), []
    for _ in range(12):
        shared = np.convolve(chance.normal(size=3008), np.hanning(9), "valid")
        first, second = (Recording((Signal("T", "torque", shared + chance.normal(size=3000)),), 1000.0) for _ in "ab")
        clocks = signal_clocks(first, second, "T", seconds=0.2)
        ratios.append((clocks.drift / clocks.drift_half_width, clocks.offset / clocks.offset_half_width))
    assert np.std(ratios, axis=0) == pytest.approx(1 / 1.96, rel=0.5)


def test_windows_that_count_less_widen_the_interval_as_they_should():
    """Windows of half the weight beyond the middle, against the weighted covariance of numpy's polynomial fit."""
    chance = np.random.default_rng(3)
    times, weights = np.arange(40.0), np.where(np.arange(40) < 20, 1.0, 0.05)
    delays = 0.2 + 5e-5 * times + 1e-5 * chance.normal(size=40) / np.sqrt(weights)
    clocks = clocks_of_delays(times, delays, weights, 0.0, "T")
    (drift, offset), covariance = np.polyfit(times, delays, 1, w=np.sqrt(weights), cov=True)
    assert (clocks.drift, clocks.offset) == pytest.approx((drift, offset), rel=1e-9)
    following = variance_factor(delays - drift * times - offset)
    half = 1.96 * np.sqrt(np.diag(covariance) * following)
    assert (clocks.drift_half_width, clocks.offset_half_width) == pytest.approx(tuple(half), rel=1e-9)


class TestRefused:
    def test_a_periodic_signal_is_ambiguous(self):
        time = np.arange(0, 20, 1e-3)
        record = Recording((Signal("T", "torque", np.sin(2 * np.pi * 10 * time)),), 1000.0)
        clocks = signal_clocks(record, record, "T")
        assert (clocks.offset_half_width, clocks.period) == (float("inf"), pytest.approx(0.1))
        assert "is open by whole multiples of 0.1 s" in clocks.remarks[1]

    def test_nothing_in_common(self):
        chance = np.random.default_rng(0)
        first, second = (Recording((Signal("T", "torque", chance.normal(size=9000)),), 1000.0) for _ in range(2))
        with pytest.raises(UsageError, match="unlike-results"):
            signal_clocks(first, second, "T")

    def test_two_machines(self):
        first = rotation(pulses(run_up, 60, 20), 60, "n1")
        second = rotation(pulses(steady, 60, 20), 60, "n2")
        with pytest.raises(UsageError, match="unlike-results"):
            rotation_clocks(first, second)

    def test_too_few_turns(self):
        first = rotation(pulses(steady, 60, 0.3), 60)
        with pytest.raises(UsageError, match=r"(?s)16.*too-short"):
            rotation_clocks(first, first)

"""Decimation, detrending, calculus, spectrogram, harmonics and orders, against closed forms."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import scipy

from torsionnet import plot
from torsionnet.base.errors import UsageError
from torsionnet.signals.calculus import convert
from torsionnet.signals.order_tracking import order_map, sweep_harmonics
from torsionnet.signals.recording import QUANTITY_UNITS, Recording, Signal
from torsionnet.signals.resampling import anti_alias_taps, decimate, decimated, usable_up_to
from torsionnet.signals.spectra import spectrogram
from torsionnet.signals.welch import Welch, without_trend


def recorded(values, rate, quantity="torque", start=0.0):
    return Recording((Signal("x", quantity, np.asarray(values, dtype=float)),), rate, start)


def sampled(seconds, rate):
    return np.arange(round(seconds * rate)) / rate


def decibels(ratio):
    return 20 * np.log10(ratio)


class TestDecimation:
    def gain(self, frequency):
        """Measured on a sine, without the ends that the filter reaches into."""
        time = sampled(20, 10e3)
        out = decimate(recorded(np.sin(2 * np.pi * frequency * time + 0.4), 10e3), 50)["x"].values
        return decibels(np.sqrt(2 * np.mean(out[100:-100] ** 2)))

    @pytest.mark.parametrize(("frequency", "level"), [(1.0, 0.0), (50.0, 0.0), (usable_up_to(10e3, 50), 0.0)])
    def test_passband(self, frequency, level):
        assert self.gain(frequency) == pytest.approx(level, abs=0.03)

    @pytest.mark.parametrize(("frequency", "least"), [(120.0, 50), (157.3, 50), (1003.7, 60)])
    def test_stopband(self, frequency, least):
        assert self.gain(frequency) < -least

    def test_half_rate_is_6_db_down(self):
        _, (at_100, at_120) = scipy.signal.freqz(anti_alias_taps(50), 1, [100, 120], fs=10e3)
        assert decibels(abs(at_100)) == pytest.approx(-6.0, abs=0.1)
        assert decibels(abs(at_120)) == pytest.approx(-52, abs=1)

    def test_no_delay(self):
        time = sampled(10, 1000)
        out = decimate(recorded(np.sin(2 * np.pi * 7 * time), 1000, start=2.0), 10)
        assert out.start == 2.0
        expected = np.sin(2 * np.pi * 7 * (out.time - 2.0))
        np.testing.assert_allclose(out["x"].values[20:-20], expected[20:-20], atol=0.005)

    def test_mean_and_slope_make_no_step_at_the_ends(self):
        line = 1e3 + 5 * sampled(10, 1000)
        np.testing.assert_allclose(decimate(recorded(line, 1000), 10)["x"].values, line[::10], rtol=1e-9)

    @pytest.mark.parametrize("count", [101, 102, 999, 1000, 1001])
    def test_length(self, count):
        assert len(decimate(recorded(np.ones(count), 1000), 10)) == -(-count // 10)

    def test_blocks_join_without_seam(self):
        values = np.random.default_rng(0).normal(size=5003)
        edges = [0, 3, 50, 777, 778, 4990, 5003]
        blocks = [recorded(values[begin:end], 1000, start=1 + begin / 1000) for begin, end in pairwise(edges)]
        parts = list(decimated(blocks, 10))
        whole = decimate(recorded(values, 1000, start=1.0), 10)
        np.testing.assert_allclose(np.concatenate([p["x"].values for p in parts]), whole["x"].values, atol=1e-12)
        np.testing.assert_allclose(np.concatenate([p.time for p in parts]), whole.time, rtol=1e-12)

    def test_says_up_to_where_it_holds(self):
        note = decimate(recorded(np.ones(2000), 10e3), 50).notes[-1]
        assert note.startswith("decimated by 50 to 200 Hz")
        assert "holds up to 80 Hz, onto which what was above 120 Hz folds at least 50 dB weaker" in note

    def test_factor_of_one_changes_nothing(self):
        record = recorded(np.arange(5.0), 10)
        assert decimate(record, 1)["x"].values.tolist() == [0, 1, 2, 3, 4]
        assert decimate(record, 1).notes == ()

    @pytest.mark.parametrize("factor", [0, -3, 2.5])
    def test_wrong_factor(self, factor):
        with pytest.raises(UsageError, match="whole number from 1"):
            decimate(recorded(np.ones(1000), 100), factor)

    def test_too_short(self):
        with pytest.raises(UsageError, match=r"(?s)100.*10.*too-short"):
            decimate(recorded(np.ones(100), 1000), 10)


def test_a_straight_line_is_taken_out():
    time = sampled(4, 50)
    wave = np.cos(2 * np.pi * 5 * time)
    np.testing.assert_allclose(without_trend(wave + 3 - 2 * time, "linear"), scipy.signal.detrend(wave), atol=1e-12)


class TestCalculus:
    OMEGA = 2 * np.pi * 3
    TIME = sampled(2, 200)

    def motion(self, quantity):
        forms = {"angle": np.sin, "velocity": np.cos, "acceleration": lambda x: -np.sin(x)}
        order = ["angle", "velocity", "acceleration"].index(quantity)
        return self.OMEGA**order * forms[quantity](self.OMEGA * self.TIME)

    @pytest.mark.parametrize("given", ["angle", "velocity", "acceleration"])
    @pytest.mark.parametrize("wanted", ["angle", "velocity", "acceleration"])
    def test_whole_periods_are_exact(self, given, wanted):
        out = convert(recorded(self.motion(given), 200, given), "x", wanted, ends="periodic")["x"]
        np.testing.assert_allclose(out.values, self.motion(wanted), atol=1e-11 * self.OMEGA**2)
        assert (out.quantity, out.unit) == (wanted, QUANTITY_UNITS[wanted])

    def test_derivative_of_a_line_is_its_slope_up_to_the_ends(self):
        out = convert(recorded(4 + 3 * self.TIME, 200, "angle"), "x", "velocity")
        np.testing.assert_allclose(out["x"].values, 3, rtol=1e-9)

    def test_derivative_of_any_record_is_right_away_from_the_ends(self):
        angle = np.sin(8 * self.TIME) + self.TIME**2
        out = convert(recorded(angle, 200, "angle"), "x", "velocity")["x"].values
        np.testing.assert_allclose(out[40:-40], (8 * np.cos(8 * self.TIME) + 2 * self.TIME)[40:-40], atol=0.02)

    def test_integral_of_a_line_is_a_parabola_up_to_the_ends(self):
        out = convert(recorded(4 + 3 * self.TIME, 200, "velocity"), "x", "angle")["x"].values
        parabola = 4 * self.TIME + 1.5 * self.TIME**2
        np.testing.assert_allclose(out, parabola - parabola.mean(), atol=1e-9)

    def test_integral_of_any_record(self):
        out = convert(recorded(np.cos(8 * self.TIME + 1), 200, "velocity"), "x", "angle")["x"].values
        exact = np.sin(8 * self.TIME + 1) / 8
        np.testing.assert_allclose(out, exact - exact.mean(), atol=1e-4)

    def test_drift_below_a_limit_is_left_out(self):
        record = recorded(self.motion("velocity") + 0.5 + 0.2 * np.cos(np.pi * self.TIME), 200, "velocity")
        out = convert(record, "x", "angle", ends="periodic", lowest_frequency=2.0)["x"]
        np.testing.assert_allclose(out.values, self.motion("angle"), atol=1e-11)
        assert "nothing below 2 Hz" in out.notes[-1]

    def test_new_name_keeps_the_old_signal(self):
        out = convert(recorded(self.motion("angle"), 200, "angle"), "x", "velocity", new_name="speed")
        assert out.names == ("x", "speed")
        assert (out["x"].quantity, out["speed"].quantity) == ("angle", "velocity")

    @pytest.mark.parametrize(
        ("quantity", "wanted", "ends", "message"),
        [
            ("torque", "velocity", "mirror", "unfit-channel"),
            ("", "velocity", "mirror", "unfit-channel"),
            ("angle", "speed", "mirror", "unknown-word"),
            ("angle", "velocity", "taper", "unknown-word"),
        ],
    )
    def test_refusals(self, quantity, wanted, ends, message):
        with pytest.raises(UsageError, match=message):
            convert(recorded(self.TIME, 200, quantity), "x", wanted, ends=ends)


class TestSpectrogram:
    @pytest.mark.parametrize("count", [40, 41])
    def test_the_highest_line_is_the_amplitude_too(self, count):
        """Of an even window half the sampling rate, which has no other half; of an odd one a line below it."""
        highest = count // 2 / count
        values = 3 * np.cos(2 * np.pi * highest * np.arange(20 * count))
        seen = spectrogram(recorded(values, 100), "x", Welch("boxcar", count / 100, 0.5, detrend="none"))
        assert seen.frequencies[-1] == pytest.approx(100 * highest)
        assert seen.amplitude[-1] == pytest.approx(np.full(len(seen.times), 3.0))

    RATE = 200

    def test_amplitude_of_a_steady_sine(self):
        time = sampled(20, self.RATE)
        seen = spectrogram(recorded(5 * np.sin(2 * np.pi * 25 * time), self.RATE, start=100.0), "x")
        assert np.all(seen.ridge == 25)
        np.testing.assert_allclose(seen.decibels(5.0).max(axis=0), 0, atol=1e-3)
        np.testing.assert_allclose(seen.decibels().max(axis=0), decibels(5), atol=1e-3)

    def test_borders_are_left_out(self):
        seen = spectrogram(recorded(np.ones(20 * self.RATE), self.RATE), "x", Welch(detrend="none"))
        assert (seen.times[0], seen.times[-1]) == pytest.approx((1, 19))
        first = spectrogram(recorded(np.arange(20 * self.RATE) < 40, self.RATE), "x", Welch(detrend="none"))
        assert first.amplitude[0, 0] > 0.02
        assert np.max(first.amplitude[:, 1:]) < 1e-12  # the next segment begins at sample 80
        np.testing.assert_allclose(seen.amplitude[0], 1, rtol=1e-12)
        np.testing.assert_allclose(np.diff(seen.times), 0.4)

    @pytest.mark.parametrize("rate", [1.0, 3.0])
    def test_ridge_follows_a_chirp_at_the_level_the_window_leaves(self, rate):
        time = sampled(20, self.RATE)
        sweep = np.sin(2 * np.pi * (10 * time + rate / 2 * time**2))
        seen = spectrogram(recorded(7 * sweep, self.RATE), "x")
        assert np.max(np.abs(seen.ridge - (10 + rate * seen.times))) <= 0.5 * 1.01 + 0.2 * rate
        weights = scipy.signal.get_window("hamming", 2 * self.RATE)
        offset = np.arange(-self.RATE, self.RATE) / self.RATE
        at_line = np.flatnonzero(np.abs((10 + rate * seen.times) % 0.5) < 1e-9)  # no picket fence there
        smeared = abs(weights @ np.exp(1j * np.pi * rate * offset**2)) / weights.sum()
        line = np.round((10 + rate * seen.times[at_line]) / 0.5).astype(int)
        assert len(at_line) > 5
        np.testing.assert_allclose(seen.decibels(7)[line, at_line], decibels(smeared), atol=0.05)

    def test_decimates_where_asked(self):
        time = sampled(10, 2000)
        seen = spectrogram(recorded(np.sin(2 * np.pi * 20 * time), 2000), "x", Welch(decimation=10))
        assert seen.frequencies[-1] == 100
        assert np.all(seen.ridge == 20)

    def test_one_segment(self):
        assert spectrogram(recorded(np.ones(400), self.RATE), "x").amplitude.shape == (201, 1)

    def test_too_short(self):
        with pytest.raises(UsageError, match=r"(?s)1\.995.*too-short"):
            spectrogram(recorded(np.ones(399), self.RATE), "x")

    def test_picture_ends_where_nothing_is_left(self):
        """A tone of 20 Hz and one 54 dB below it at 60 Hz in a record up to 1000 Hz, with noise far below."""
        time = np.arange(20 * 2000) / 2000
        noise = 1e-6 * np.random.default_rng(1).standard_normal(len(time))
        tones = np.sin(2 * np.pi * 20 * time) + 2e-3 * np.sin(2 * np.pi * 60 * time)
        seen = spectrogram(recorded(tones + noise, 2000), "x")
        ends = [plot.spectrogram(seen, span=span).axes[0].get_ylim()[1] for span in (60.0, 40.0, 300.0)]
        assert 60 < ends[0] < 75
        assert 20 < ends[1] < 30
        assert ends[2] > 990
        assert plot.spectrogram(seen, up_to=500.0).axes[0].get_ylim()[1] == pytest.approx(500, abs=1)


class TestHarmonics:
    TIME = sampled(40, 1000)
    FREQUENCY = 2 + 0.5 * TIME
    SWEEP = 2 * np.pi * (2 * TIME + 0.25 * TIME**2)

    def test_amplitudes_and_phases(self):
        values = 4 + 10 * np.sin(self.SWEEP - 0.5) + 0.3 * np.sin(2 * self.SWEEP + 1) + 0.02 * np.sin(3 * self.SWEEP)
        found = sweep_harmonics(recorded(values, 1000), "x", self.FREQUENCY)
        np.testing.assert_allclose(found.amplitude, [[10, 0.3, 0.02]] * len(found.times), rtol=1e-3)
        np.testing.assert_allclose(found.phase[:, :2], [[-28.648, 57.296]] * len(found.times), atol=0.1)
        np.testing.assert_allclose(found.distortion[:, 1], 0.03, rtol=1e-3)
        np.testing.assert_allclose(found.frequencies, 2 + 0.5 * found.times, rtol=1e-12)
        assert found.frequencies[-1] > 21.5

    def test_follows_an_amplitude_that_changes(self):
        values = (1 + 0.1 * self.TIME) * np.sin(self.SWEEP)
        found = sweep_harmonics(recorded(values, 1000), "x", self.FREQUENCY, [1])
        np.testing.assert_allclose(found.amplitude[:, 0], 1 + 0.1 * found.times, rtol=0.01)

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            ((FREQUENCY[:-1],), r"(?s)40000.*out-of-range"),
            ((FREQUENCY - 2,), "out-of-range"),
            ((np.full(40_000, 0.1),), "too-short"),
        ],
    )
    def test_refusals(self, arguments, message):
        with pytest.raises(UsageError, match=message):
            sweep_harmonics(recorded(self.TIME, 1000), "x", *arguments)

    def test_one_point(self):
        found = sweep_harmonics(recorded(10 * np.sin(self.SWEEP), 1000), "x", self.FREQUENCY, points=1)
        np.testing.assert_allclose(found.amplitude, [[10, 0, 0]], atol=1e-3)

    def test_no_points(self):
        with pytest.raises(UsageError, match="at least one point"):
            sweep_harmonics(recorded(self.TIME, 1000), "x", self.FREQUENCY, points=0)


class TestOrders:
    TIME = sampled(20, 1000)
    SPEED = 2 * np.pi * (5 + TIME)
    ANGLE = 2 * np.pi * (5 * TIME + 0.5 * TIME**2)

    def test_orders_stay_where_they_are(self):
        values = 3 * np.sin(2 * self.ANGLE) + 0.5 * np.cos(4.5 * self.ANGLE) + 1
        seen = order_map(recorded(values, 1000, start=10.0), "x", self.SPEED, highest_order=6)
        np.testing.assert_allclose(seen.along(2), 3, rtol=2e-3)
        np.testing.assert_allclose(seen.along(4.5), 0.5, rtol=0.05)
        np.testing.assert_allclose(seen.along(0), 1, rtol=2e-3)
        assert np.max(seen.along(3)) < 2e-3
        assert seen.orders[-1] == 6
        np.testing.assert_allclose(seen.speeds, 2 * np.pi * (5 + seen.times - 10), rtol=0.01)

    def test_fixed_frequency_moves_through_the_orders(self):
        seen = order_map(recorded(np.sin(2 * np.pi * 40 * self.TIME), 1000), "x", self.SPEED)
        strongest = seen.orders[seen.amplitude.argmax(axis=0)]
        expected = 2 * np.pi * 40 / seen.speeds
        np.testing.assert_allclose(strongest, expected, atol=0.3)

    @pytest.mark.parametrize(
        ("speed", "message"),
        [
            (SPEED[1:], r"(?s)20000.*out-of-range"),
            (-SPEED, "positive number of rad/s"),
            (np.maximum(SPEED - 2 * np.pi * 5, 1e-3), "out-of-range"),
            (np.full(20_000, 1.0), r"(?s)3\.18.*too-short"),
        ],
    )
    def test_refusals(self, speed, message):
        with pytest.raises(UsageError, match=message):
            order_map(recorded(self.TIME, 1000), "x", speed)


@pytest.mark.parametrize(
    "process",
    [
        lambda record: decimate(record, 2),
        lambda record: convert(record, "x", "velocity"),
        lambda record: spectrogram(record, "x"),
        lambda record: sweep_harmonics(record, "x", np.ones(1000)),
        lambda record: order_map(record, "x", np.ones(1000)),
    ],
)
class TestUnfitRecords:
    RECORD = recorded(np.ones(1000), 100, "angle")

    def test_time_stamps(self, process):
        with pytest.raises(UsageError, match="resample it first"):
            process(replace(self.RECORD, times=np.arange(1000) / 100))

    def test_values_that_are_not_finite(self, process):
        holes = self.RECORD["x"].values.copy()
        holes[[3, 500]] = np.nan, np.inf
        with pytest.raises(UsageError, match="not-finite"):
            process(recorded(holes, 100, "angle"))

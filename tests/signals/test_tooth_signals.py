"""Signals of teeth: level and flank, pickups that grow with the speed, two tracks and the direction they tell."""

from itertools import product

import numpy as np
import pytest
from support.known_rotation import pulse_times as crossings
from support.known_rotation import shaft

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.signals.encoder import pulse_times
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.rotation.counter import PulseReading
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.rotations_of_wheels import iter_wheel_rotations
from torsionnet.signals.rotation.wheel import Wheel
from torsionnet.signals.rotation.wheel_channel import (
    DirectedPulses,
    ReversingRotation,
    WheelChannel,
    quadrature_pulses,
    refuse_turning_back,
    wheel_pulses,
)
from torsionnet.signals.rotation.wheel_rotation import wheel_rotation

RATE = 20_000.0
PITCH = 2 * np.pi / 60


def record(**signals):
    return Recording(tuple(Signal(name, "", values) for name, values in signals.items()), sampling_rate=RATE)


class TestInductive:
    """A magnetic pickup: a sine of the tooth whose height is that of the speed, sampled about 25 times a tooth."""

    time = np.arange(int(8 * RATE)) / RATE
    angle = staticmethod(shaft(10.0, {6: np.radians(0.1)}, acceleration=9.0)[1])

    def signal(self, noise=0.0):
        speed = np.gradient(self.angle(self.time), self.time)
        draw = np.random.default_rng(2)
        return speed * np.sin(60 * self.angle(self.time)) + noise * draw.normal(size=len(self.time))

    def true(self):
        last = self.angle(self.time[-1:])[0]
        return crossings(self.angle, np.arange(1, int(last / PITCH) + 1) * PITCH, 9.0)

    def test_every_tooth_is_found_between_the_samples(self):
        found = pulse_times(self.signal(), self.time, pickup="inductive")
        true = self.true()
        assert len(found) == len(true)
        error = (found - true) * 10.0
        # A straight line between samples is off by 60 times as much at the highest speed.
        assert np.abs(error).max() < np.radians(0.002)
        line = pulse_times(self.signal(), self.time, hysteresis=0.01)
        assert np.abs(line[-500:] - true[-500:]).max() > 5 * np.abs(found[-500:] - true[-500:]).max()

    def test_noise_makes_no_teeth(self):
        found = pulse_times(self.signal(0.3), self.time, pickup="inductive")
        assert len(found) == len(self.true())

    def test_read_as_one_that_switches_it_is_refused(self):
        with pytest.raises(UsageError, match="disturbed-signal"):
            wheel_pulses(record(n1=self.signal()), "n1", PulseReading())
        found = wheel_rotation(
            wheel_pulses(record(n1=self.signal()), "n1", PulseReading(pickup="inductive")), Wheel(teeth=60)
        )
        assert found.remarks == ()


class TestFlanks:
    values = np.where(np.arange(4000) % 40 < 12, 5.0, 0.0)
    time = np.arange(4000) / RATE

    def test_each_kind_is_even_and_both_are_not(self):
        rising, falling = (pulse_times(self.values, self.time, edge=one) for one in ("rising", "falling"))
        assert np.ptp(np.diff(rising)) < 1e-12
        assert np.ptp(np.diff(falling)) < 1e-12
        both = np.diff(pulse_times(self.values, self.time, edge="both"))
        assert both.max() / both.min() == pytest.approx(28 / 12)

    def test_a_level_of_its_own(self):
        ramp = np.abs((np.arange(4000) % 80) - 40) / 8.0
        for level, share in ((1.0, 0.2), (4.0, 0.8)):
            found = pulse_times(ramp, self.time, level=level, hysteresis=0.1)
            assert np.allclose((found * RATE) % 80, 40 + 40 * share)

    def test_a_level_that_the_signal_never_passes(self):
        with pytest.raises(UsageError, match="lost-pulses"):
            pulse_times(self.values, self.time, level=7.0)

    @pytest.mark.parametrize(("share", "wrong"), [(0.0, True), (0.49, False), (0.5, True)])
    def test_a_signal_passes_a_level_by_less_than_half_its_height(self, share, wrong):
        assert bool(PulseReading.read_entries({"hysteresis": share})[1]) is wrong

    def test_a_counter_has_no_level(self):
        with pytest.raises(ModelError, match=r"tick: .*needless-entry"):
            WheelChannel(teeth=60, tick="1 us", level=2)


class TestQuadrature:
    """Two tracks of 60 lines on a shaft that swings by 3 radians and so turns back 7 times in 4 seconds."""

    time = np.arange(int(4 * RATE)) / RATE

    @staticmethod
    def angle(t):
        return 3 * np.sin(2 * np.pi * t + 0.3)

    def tracks(self, angle, lag=np.pi / 2):
        return {
            "a": np.where(np.sin(60 * angle(self.time)) > 0, 5.0, 0.0),
            "b": np.where(np.sin(60 * angle(self.time) - lag) > 0, 5.0, 0.0),
        }

    def test_a_shaft_that_turns_back(self):
        pulses = wheel_pulses(record(**self.tracks(self.angle)), "a", PulseReading(second="b"))
        assert isinstance(pulses, DirectedPulses)
        assert pulses.turns_back == 8
        places = self.angle(pulses.times) / PITCH
        off = places - pulses.numbers
        # Pulses are found to half a sample, 0.0005 rad at the highest speed, and none is lost or counted twice.
        assert np.ptp(off) < 0.02
        found = wheel_rotation(pulses, Wheel(teeth=60))
        at = np.linspace(pulses.times[0], pulses.times[-1], 5000)
        away = found.angle(at) - self.angle(at)
        assert np.abs(away - away.mean()).max() < 0.03 * PITCH
        assert found.remarks[0] == "the shaft turns back 8 times: interpolated by cubic splines over time"

    def test_without_the_second_track_it_is_refused(self):
        with pytest.raises(UsageError, match="turning-back"):
            wheel_rotation(wheel_pulses(record(**self.tracks(self.angle)), "a", PulseReading()), Wheel(teeth=60))

    @pytest.mark.parametrize(("lag", "sign"), [(np.pi / 2, 1), (-np.pi / 2, -1)])
    def test_the_sense_of_a_shaft_that_does_not(self, lag, sign):
        def angle(t):
            return 20 * t + 0.3

        pulses = wheel_pulses(record(**self.tracks(angle, lag)), "a", PulseReading(second="b"))
        found = wheel_rotation(pulses, Wheel(teeth=60))
        assert found.speeds.mean() == pytest.approx(sign * 20, rel=1e-3)
        assert found.revolutions == pytest.approx(80 / (2 * np.pi), rel=0.01)

    @pytest.mark.parametrize("turning", [lambda t: 12.6 * t + 0.1, lambda t: 6 * np.sin(np.pi * t) + 0.13])
    def test_a_lost_edge_moves_no_pulse_that_is_not_beside_it(self, turning):
        fine = np.linspace(0, 1, 20_001)
        edges = []
        for lag in (0.0, 0.25):
            high = ((turning(fine) - lag) % 1 < 0.5).astype(int)
            edges += [fine[:-1][np.diff(high) == step] for step in (1, -1)]
        whole = quadrature_pulses("n", (edges[0], edges[1]), (edges[2], edges[3]))
        true = np.floor(turning(whole.times) + 1e-2)
        assert (whole.numbers.tolist(), whole.notes) == ((true - true[0]).tolist(), ())
        for place, lost in product(range(4), (3, -3)):
            some = [np.delete(one, lost) if number == place else one for number, one in enumerate(edges)]
            found = quadrature_pulses("n", (some[0], some[1]), (some[2], some[3]))
            beside = np.abs(found.times - edges[place][lost]) < 0.2
            kept = ~beside & np.isin(found.times, whole.times)
            assert kept.sum() > 5
            assert found.numbers[kept].tolist() == whole.numbers[np.isin(whole.times, found.times[kept])].tolist()
            assert found.notes == ("1 lost edges of two tracks counted",)

    def test_times_of_pulses_have_no_second_track(self):
        times = Recording((), RATE, pulses=(PulseChannel("a", np.arange(20.0)), PulseChannel("b", np.arange(20.0))))
        assert len(wheel_pulses(times, "a", PulseReading())) == 20
        with pytest.raises(UsageError, match="missing-data"):
            wheel_pulses(times, "a", PulseReading(second="b"))

    def test_tracks_that_are_not_of_one_wheel(self):
        one = self.tracks(self.angle)["a"]
        with pytest.raises(UsageError, match="unfit-wheel"):
            wheel_pulses(record(a=one, b=one), "a", PulseReading(second="b"))


@pytest.mark.parametrize("together", [7, 2**17])
@pytest.mark.parametrize("before", [10, 11, 33, 50])
def test_a_standstill_is_seen_wherever_it_is(monkeypatch, before, together):
    """From ten pulses on either side: at constant deceleration they come at the roots of whole numbers."""
    monkeypatch.setattr("torsionnet.signals.rotation.wheel_channel.INTERVALS_TOGETHER", together)
    places = np.r_[np.arange(-before, 0), 1:11].astype(float)
    with pytest.raises(UsageError, match=rf"(?s)n1: .* -1 s, pulse {before - 1}: .*turning-back"):
        refuse_turning_back(np.sign(places) * np.sqrt(np.abs(places)), "n1")
    refuse_turning_back(np.sqrt(np.arange(60.0)), "n1")


def test_splines_over_time_read_orders_up_to_their_band_within_0_2_percent():
    """Half the pulses of a turn are pi from pulse to pulse."""
    places, read = np.arange(200.0), 50 + np.arange(960) / 10  # 16 periods
    step = np.pi * ReversingRotation.kept_band
    found = ReversingRotation(places, places + 0.1 * np.cos(step * places)).at(read)
    assert 1e-3 < 1 - 2 * np.mean((found - read) * np.cos(step * read)) / 0.1 < 2.5e-3


class TestBlocks:
    def test_blocks_are_the_rotation_of_the_whole(self):
        _, angle = shaft(150.0, {6: np.radians(0.1)}, acceleration=1.0)
        numbers = np.arange(60, 12_060)
        numbers = np.delete(numbers[numbers % 60 < 58], [500, 4100, 7001])
        times = crossings(angle, numbers * PITCH, 9.0)
        channel = DirectedPulses("n1", times, numbers=numbers)
        wheel = Wheel(teeth=60, missing_teeth=2)
        whole = wheel_rotation(channel, wheel)
        blocks = list(iter_wheel_rotations(channel, wheel, pulses_per_block=3000))
        assert len(blocks) == 4
        for one in blocks:
            at = np.linspace(one.start, min(one.stop, times[-100]), 2000)
            assert np.abs(one.rotation.angle(at) - whole.angle(at)).max() < 3e-8

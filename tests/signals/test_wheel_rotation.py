"""Rotation of a shaft from the teeth of a wheel: how orders read, which tooth is which, what is refused."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.known_rotation import order_of, pulse_times, shaft

from torsionnet.base.errors import UsageError
from torsionnet.signals.pulses import _gaps_in_words
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import Wheel, WheelPattern
from torsionnet.signals.rotation.wheel_channel import WheelChannel
from torsionnet.signals.rotation.wheel_rotation import wheel_rotation

RPM = 2 * np.pi / 60
TENTH = np.radians(0.1)


def pulses(angle, teeth=60, turns=40, missing=0, positions=None, first=0, turn=2 * np.pi):
    """Times of the pulses of a wheel whose tooth ``first`` passes first; ``turn`` in rad of the shaft."""
    numbers = np.arange(teeth + first, teeth + first + turns * teeth)  # the first turn passes before the record
    numbers = numbers[numbers % teeth < teeth - missing]
    places = turn * numbers / teeth + (0 if positions is None else np.asarray(positions)[numbers % teeth])
    return pulse_times(angle, places, 1.2 * places[-1] / (angle(np.ones(1))[0] / 1.0))


def beyond_whole_turns(angle):
    return angle - 2 * np.pi * np.round(angle.mean() / (2 * np.pi))


def inner(found, count=20_000):
    """Times well inside of the pulses, at all places between them."""
    span = found.times[-1] - found.times[0]
    return np.linspace(found.times[0] + 0.05 * span, found.times[-1] - 0.05 * span, count)


class TestOrders:
    @pytest.mark.parametrize(("order", "straight"), [(6, 0.9675), (12, 0.8751), (15, 0.8106), (20, 0.6839)])
    def test_straight_lines_read_sinc_squared_of_60_teeth_and_the_rotation_does_not(self, order, straight):
        amplitude = TENTH / 50 * np.exp(0.3j)  # small, as twice order 20 is an image of it, too
        mean, angle = shaft(1500 * RPM, {order: amplitude})
        times = pulses(angle)
        found = wheel_rotation(PulseChannel("n1", times), Wheel(teeth=60))
        at = inner(found)
        assert abs(order_of(found.angle(at) - mean(at), mean(at), order) / amplitude - 1) < 2e-4
        lines = np.interp(at, times, np.arange(len(times)) * 2 * np.pi / 60)
        read = abs(order_of(lines - mean(at), mean(at), order)) / abs(amplitude)
        assert read == pytest.approx(straight, abs=4e-4)
        assert np.sinc(order / 60) ** 2 == pytest.approx(straight, abs=1e-4)

    @pytest.mark.parametrize("seed", range(12))
    def test_an_order_reads_as_least_squares_of_the_same_pulses_does(self, seed):
        """Sine and cosine of the mean rotation through the pulses; at 3 degrees of order 12 intervals go from 1 to 4."""
        draw = np.random.default_rng(seed)
        teeth, speed = int(draw.choice([30, 60, 90, 120])), float(draw.choice([600.0, 1200.0])) * RPM
        order, size = min(draw.uniform(0.5, 12), 8 * teeth / 30), np.radians(3.0 if seed % 3 else draw.uniform(0.05, 3))
        mean, angle = shaft(speed, {order: size * np.exp(1j * draw.uniform(0, 6))}, acceleration=10.0 * (seed % 2))
        times = pulses(angle, teeth, turns=int(draw.integers(12, 30)), first=int(draw.integers(teeth)))
        found = wheel_rotation(PulseChannel("n1", times), Wheel(teeth=teeth))

        def wave(times, turned):
            columns = [np.ones_like(times), mean(times), np.cos(order * mean(times)), np.sin(order * mean(times))]
            return np.linalg.lstsq(np.column_stack(columns), turned, rcond=None)[0][2:]

        right = wave(times, 2 * np.pi * np.arange(len(times)) / teeth)
        assert np.hypot(*right) == pytest.approx(size, rel=1e-6)
        inside = np.linspace(times[teeth], times[-teeth], 20_000)
        np.testing.assert_allclose(wave(inside, found.angle(inside)), right, atol=2e-3 * size)
        # The ends are marked; where the order is small, all between them is right.
        assert found.settled == (times[20], times[-21])
        if order * size < 0.2:
            inside = np.linspace(*found.settled, 20_000)
            assert np.abs(np.diff(found.angle(inside) - angle(inside))).max() < 2e-3 * size

    @pytest.mark.parametrize(
        ("teeth", "order", "degrees", "phase", "first"),
        [
            (60, 10, 2.97, 1.9, 0),
            (60, 12, 3.0, 2.1, 2),
            (60, 12, 3.0, 2.1, 8),
            (64, 12, 2.75, 5.6, 6),
            (72, 10, 2.74, 3.1, 0),
        ],
    )
    def test_the_strongest_vibration_is_right_between_the_pulses_too(self, teeth, order, degrees, phase, first):
        """The error of the iteration rises now and then before it falls: it falls all the same."""
        _, angle = shaft(700 * RPM, {order: np.radians(degrees) * np.exp(1j * phase)})
        times = pulses(angle, teeth, turns=9)[first:]
        found = wheel_rotation(PulseChannel("n1", times), Wheel(teeth=teeth))
        inside = np.linspace(times[teeth], times[-teeth], 3000)
        away = found.angle(inside) - angle(inside)
        assert np.abs(away - away.mean()).max() < 1e-3 * np.radians(degrees)

    def test_both_flanks_of_teeth_nearly_as_wide_as_gaps(self):
        _, angle = shaft(1500 * RPM, {6: TENTH})
        channel = PulseChannel("n1", pulses(angle, 120, positions=np.tile([0.0, 0.1], 60) * 2 * np.pi / 120))
        with pytest.raises(UsageError, match=r"(?s)0\.1.*unfit-wheel"):
            wheel_rotation(channel, Wheel(teeth=120))

    def test_order_54_of_60_teeth_reads_as_6_and_is_refused(self):
        mean, angle = shaft(1500 * RPM, {54: TENTH / 10})
        found = wheel_rotation(PulseChannel("n1", pulses(angle)), Wheel(teeth=60))
        at = inner(found)
        read = found.angle(at) - mean(at)
        assert abs(order_of(read, mean(at), 6)) == pytest.approx(TENTH / 10, rel=0.01)
        assert abs(order_of(read, mean(at), 54)) < 1e-3 * TENTH
        assert (found.aliased(54), found.alias_order, found.highest_order) == (6, 30, 25)
        found.check_orders([0.5, 12, 25])
        with pytest.raises(UsageError, match=r"(?s)54.*60.*beyond-sampling"):
            found.check_orders([6, 54])

    @pytest.mark.parametrize(
        ("teeth", "missing", "order", "limit"), [(60, 2, 12, 1e-4), (60, 2, 20, 3e-3), (36, 1, 12, 3e-3)]
    )
    def test_orders_of_a_wheel_with_a_gap(self, teeth, missing, order, limit):
        mean, angle = shaft(1500 * RPM, {order: TENTH * 1j})
        times = pulses(angle, teeth, missing=missing, first=7)
        found = wheel_rotation(PulseChannel("n1", times), Wheel(teeth=teeth, missing_teeth=missing))
        assert found.highest_order == pytest.approx(teeth / 3)
        at = inner(found)
        assert abs(order_of(found.angle(at) - mean(at), mean(at), order) / (TENTH * 1j) - 1) < limit

    @pytest.mark.parametrize(
        ("teeth", "missing", "order", "degrees"),
        [(60, 2, 3, 3.0), (60, 2, 6, 2.9), (60, 1, 8, 2.0), (120, 2, 12, 1.2), (36, 2, 4, 3.0), (36, 2, 12, 0.3)],
    )
    def test_strong_vibration_of_a_wheel_with_a_gap(self, teeth, missing, order, degrees):
        """Intervals swing as much as at a lost pulse; from any tooth on, to any tooth, also one beside the gap."""
        size, wheel = np.radians(degrees) * np.exp(2j), Wheel(teeth=teeth, missing_teeth=missing)
        mean, angle = shaft(1200 * RPM, {order: size})
        every = pulses(angle, teeth, turns=14, missing=missing)
        for begin, end in ((0, 1), (3, 2), (teeth - missing - 1, teeth - missing - 1), (10, teeth // 2)):
            found = wheel_rotation(PulseChannel("n1", every[begin:-end]), wheel)
            at = np.linspace(found.times[60], found.times[-60], 5000)
            assert abs(order_of(found.angle(at) - mean(at), mean(at), order) - size) < 2e-3 * abs(size)
            assert beyond_whole_turns(found.angle(at) - angle(at)).mean() == pytest.approx(0, abs=1e-4)  # by tooth 0
            left_out = len(every) - begin - end - len(found.times)
            assert [text.split(":")[0] for text in found.remarks] == (
                [f"{left_out} pulses at the ends left out"] if left_out else []
            )
            counted = wheel_rotation(PulseChannel("n1", every[begin:-end]), wheel, first=begin)
            np.testing.assert_allclose(beyond_whole_turns(counted.angle(at) - angle(at)).mean(), 0, atol=1e-4)

    def test_a_lost_pulse_beside_strong_vibration_and_a_gap_is_refused(self):
        _, angle = shaft(1200 * RPM, {6: np.radians(2.9)})
        every = pulses(angle, missing=2)
        for times, teeth, missing in ((np.delete(every, 900), 60, 2), (every, 60, 1), (every, 59, 1)):
            with pytest.raises(UsageError, match=r"lost-pulses|unfit-wheel"):
                wheel_rotation(PulseChannel("n1", times), Wheel(teeth=teeth, missing_teeth=missing))

    def test_speed_is_the_derivative_of_the_angle(self):
        _, angle = shaft(1500 * RPM, {6: TENTH, 12: TENTH / 2j})
        found = wheel_rotation(PulseChannel("n1", pulses(angle)), Wheel(teeth=60))
        at, step = inner(found, 500), 1e-6
        assert np.abs(found.speed(at) - (angle(at + step) - angle(at - step)) / (2 * step)).max() < 1e-5
        assert found.speeds.mean() / RPM == pytest.approx(1500, rel=5e-4)

    def test_a_wheel_behind_a_gear_that_turns_backwards(self):
        """1.5 turns of the shaft per turn of the wheel: in one turn of the shaft 20 of 30 teeth pass."""
        _, angle = shaft(1500 * RPM, {4: TENTH})
        times = pulses(angle, 30, turn=1.5 * 2 * np.pi)
        found = wheel_rotation(PulseChannel("n1", times), Wheel(teeth=30, ratio=1.5, reversed=True))
        at = inner(found)
        assert np.abs(beyond_whole_turns((found.angle(at) + angle(at)) / 1.5)).max() < 1e-6
        assert (found.alias_order, found.revolutions) == (10, pytest.approx(59.95))

    def test_the_pattern_of_a_wheel_is_removed(self):
        places = np.radians(0.05) * np.random.default_rng(3).normal(size=60)
        places -= places.mean()
        _, angle = shaft(1500 * RPM, {6: TENTH})
        times = pulses(angle, positions=places, missing=2, first=20)
        wheel, channel = Wheel(teeth=60, missing_teeth=2), PulseChannel("n1", times)
        pattern = WheelPattern(np.where(np.arange(60) < 58, places, 0), np.full(60, 1e-6), missing=2)
        plain, found = wheel_rotation(channel, wheel), wheel_rotation(channel, wheel, pattern)
        at = inner(found)
        assert np.abs(beyond_whole_turns(found.angle(at) - angle(at))).max() < 2e-7
        assert np.abs(beyond_whole_turns(plain.angle(at) - angle(at))).max() > np.radians(0.05)
        assert found.zero == "the first tooth after the gap"
        assert found.numbers[0] == 20


GAPS = "16 teeth, 2 missing, 10 teeth, 2 missing, 4 teeth, 2 missing"
GAPS_AT = np.flatnonzero(~np.isin(np.arange(36), [16, 17, 28, 29, 34, 35])) * 10.0
TWO_GAPS = "20 teeth, 1 missing, 38 teeth, 1 missing"
TWO_GAPS_AT = np.flatnonzero(~np.isin(np.arange(60), [20, 59])) * 6.0
LOBES = "0, 80, 180, 270 deg"


def seen_at(angle, degrees, turns=40, first=5):
    """Times of the pulses of edges at these angles of each turn, from one of them on."""
    places = np.add.outer(2 * np.pi * np.arange(2, 2 + turns), np.radians(degrees)).ravel()[first:]
    return pulse_times(angle, places, 1.2 * places[-1] / angle(np.ones(1))[0])


class TestStatedPatterns:
    @pytest.mark.parametrize(
        ("teeth", "pattern", "degrees", "order", "size", "highest"),
        [
            (36, GAPS, GAPS_AT, 4, 0.5, 6), (36, GAPS, GAPS_AT, 6, 0.3, 6), (60, TWO_GAPS, TWO_GAPS_AT, 9, 1.0, 10),
            (4, LOBES, [0, 80, 180, 270], 1.5, 0.5, 5 / 3),
            (7, "0, 15, 60, 120, 180, 240, 300 deg", [0, 15, 60, 120, 180, 240, 300], 1.5, 0.5, 3),
        ],
    )  # fmt: skip
    def test_several_gaps_and_uneven_lobes_are_read_by_the_pattern(self, teeth, pattern, degrees, order, size, highest):
        size = np.radians(size) * np.exp(0.3j)
        mean, angle = shaft(1200 * RPM, {order: size})
        found = wheel_rotation(PulseChannel("n1", seen_at(angle, degrees)), Wheel(teeth=teeth, pattern=pattern))
        at = inner(found)
        assert abs(order_of(found.angle(at) - mean(at), mean(at), order) / size - 1) < 2e-3
        assert beyond_whole_turns(found.angle(at) - angle(at)).mean() == pytest.approx(0, abs=1e-5)  # by tooth 0
        assert found.highest_order == pytest.approx(highest)
        assert found.gap == f"pattern of {len(degrees)} teeth on {found.wheel.teeth} places"

    @pytest.mark.parametrize("wheel", [Wheel(teeth=30), Wheel(teeth=36), Wheel(teeth=36, missing_teeth=2)])
    def test_gaps_are_named_in_a_question_and_not_counted_as_lost_pulses(self, wheel):
        _, angle = shaft(1200 * RPM, {4: TENTH})
        with pytest.raises(UsageError, match=f"(?s)pattern: {GAPS}.*unfit-wheel"):
            wheel_rotation(PulseChannel("n1", seen_at(angle, GAPS_AT, first=0)), wheel)

    @pytest.mark.parametrize(
        ("numbers", "counts", "told"),
        [
            ([10, 31, 70, 91], [1, 2, 1, 2], "; gaps return every 60 places"),
            ([10, 31, 45, 70], [1, 2, 1, 1], ""),  # two whole turns tell it, one gap that returns does not
        ],
    )
    def test_gaps_return_when_two_turns_have_them(self, numbers, counts, told):
        missing = SimpleNamespace(after=np.arange(4), counts=np.array(counts))
        text = _gaps_in_words(SimpleNamespace(numbers=np.array(numbers), missing=missing))
        assert text.partition(":")[0] == told

    def test_lobes_are_named_in_a_question(self):
        _, angle = shaft(1200 * RPM, {1: TENTH})
        with pytest.raises(UsageError, match=r"(?s)pattern: 0, (60|1[02]0|80), .*lost-pulses"):
            wheel_rotation(PulseChannel("n1", seen_at(angle, [0, 60, 180, 260], first=0)), Wheel(teeth=4))

    def test_every_sixth_tooth_that_is_missing_is_a_pattern_of_the_wheel(self):
        _, angle = shaft(1200 * RPM, {4: TENTH})
        channel = PulseChannel("n1", seen_at(angle, np.flatnonzero(np.arange(60) % 6) * 6.0))
        with pytest.raises(UsageError, match=r"(?s)60.*unfit-wheel") as refused:
            wheel_rotation(channel, Wheel(teeth=60))
        told = re.search(r"pattern: ([^:]*) if the wheel", str(refused.value))[1]
        wheel = Wheel(teeth=60, pattern=told)
        found = wheel_rotation(channel, wheel)
        at = inner(found)
        assert np.ptp(found.angle(at) - angle(at)) < 1e-3 * TENTH
        # The pattern returns ten times a turn: any of its first teeth may be tooth 0.
        assert found.zero == "one of the 10 first teeth of the pattern"
        assert not wheel.shows_tooth_0

    def test_a_pattern_of_even_teeth_is_that_of_a_plain_wheel(self):
        _, angle = shaft(1200 * RPM, {1: TENTH})
        even = Wheel(teeth=4, pattern="0, 90, 180, 270 deg")
        times = seen_at(angle, [0, 90, 180, 270])
        np.testing.assert_array_equal(
            wheel_rotation(PulseChannel("n1", times), even).angle(times),
            wheel_rotation(PulseChannel("n1", times), Wheel(teeth=4)).angle(times),
        )
        with pytest.raises(UsageError, match="every second pulse stands"):
            wheel_rotation(PulseChannel("n1", seen_at(angle, [0, 80, 180, 270])), even)

    @pytest.mark.parametrize(
        "text", ["0, 80, 180, 270", "0 80 180 270 deg", "0°, 80°, 180°, 270°", "0, 80..5, 270 deg"]
    )
    def test_words_that_are_nearly_a_pattern_are_no_name_of_a_file(self, text):
        (fault,) = WheelChannel.read({"teeth": 4, "pattern": text})[1]
        assert (fault.kind, fault.path) == ("wrong-form", ("pattern",))
        assert Wheel(teeth=4, pattern="4_teeth.yaml").pattern_file == "4_teeth.yaml"

    def test_what_does_not_follow_the_pattern_is_refused(self):
        _, angle = shaft(1200 * RPM)
        times, wheel = seen_at(angle, GAPS_AT), Wheel(teeth=36, pattern=GAPS)
        with pytest.raises(UsageError, match=r"(?s)299.*lost-pulses"):
            wheel_rotation(PulseChannel("n1", np.delete(times, 300)), wheel)
        with pytest.raises(UsageError, match="ambiguous-tooth"):
            wheel_rotation(PulseChannel("n1", times), replace(wheel, pattern="9 teeth, 9 missing, 9 teeth, 9 missing"))
        (fault,) = WheelChannel.read({"teeth": 30, "pattern": GAPS})[1]
        assert (fault.kind, fault.path) == ("wrong-count", ("pattern",))


class TestUncertainty:
    def test_a_counter_of_1_MHz_at_600_rpm_leaves_0_00104_degrees(self):
        _, angle = shaft(600.37 * RPM, {6: np.radians(0.2), 0.5: np.radians(0.1)})
        true = pulses(angle, turns=60)
        times = np.floor(true / 1e-6) * 1e-6
        seen = np.degrees(np.std((times - true) * 600 * RPM))
        assert seen == pytest.approx(0.00104, rel=0.03)
        found = wheel_rotation(PulseChannel("n1", times, tick=1e-6), Wheel(teeth=60))
        assert np.degrees(found.deviations.tick / np.sqrt(12) * 600 * RPM) == pytest.approx(0.00104, abs=5e-6)
        assert np.degrees(found.deviations.jitter * 600 * RPM) == pytest.approx(0.00104, rel=0.1)
        assert np.degrees(np.median(found.angle_deviation)) == pytest.approx(0.00104, rel=0.15)

    def test_jitter_and_tooth_errors_are_told_apart(self):
        draw = np.random.default_rng(11)
        places, turns = np.radians(0.05) * draw.normal(size=60), 100
        _, angle = shaft(900 * RPM, {3: TENTH, 6: 2 * TENTH, 7.5: TENTH / 2}, acceleration=2.0)
        jitter = 2e-6
        times = pulses(angle, positions=places, turns=turns)
        times = times + jitter * draw.normal(size=len(times))
        found = wheel_rotation(PulseChannel("n1", times, tick=1e-7), Wheel(teeth=60))
        assert found.deviations.jitter == pytest.approx(jitter, rel=0.1)
        assert found.deviations.places == pytest.approx(places.std(), rel=0.35)

    def test_tooth_errors_as_small_as_what_the_times_leave_are_not_doubled_by_it(self):
        draw, turns, jitter = np.random.default_rng(5), 20, 1e-5
        _, angle = shaft(900 * RPM, {3: TENTH})
        of_times, seen = jitter * 900 * RPM / np.sqrt(turns), []
        for _ in range(12):
            times = pulses(angle, positions=of_times * draw.normal(size=60), turns=turns)
            late = PulseChannel("n1", times + jitter * draw.normal(size=len(times)))
            seen.append(wheel_rotation(late, Wheel(teeth=60)).deviations.places)
        assert np.sqrt(np.mean(np.square(seen))) == pytest.approx(of_times, rel=0.25)

    def test_times_of_n_pulses_add_two_sigma_over_the_root_of_n_to_half_orders(self):
        draw, jitter, speed = np.random.default_rng(4), 1e-5, 900 * RPM
        _, angle = shaft(speed)
        places = 2 * np.pi * np.arange(120, 60 * 22 + 1) / 60  # whole cycles: other lines do not leak into order 1.5
        seen = [
            2 * np.mean(jitter * speed * draw.normal(size=1200) * np.exp(-1.5j * places[:1200])) for _ in range(400)
        ]
        times = pulse_times(angle, places, 3.0) + jitter * draw.normal(size=len(places))
        found = wheel_rotation(PulseChannel("n1", times), Wheel(teeth=60)).order_deviation(1.5)
        assert found == pytest.approx(np.sqrt(np.mean(np.abs(seen) ** 2)), rel=0.1)
        assert found == pytest.approx(2 * jitter * speed / np.sqrt(1200), rel=0.1)

    def test_what_independent_tooth_errors_add_to_whole_orders(self):
        """0.0129 degrees for 0.05 degrees at 60 teeth, as the mean square over wheels of their own Fourier lines."""
        draw = np.random.default_rng(5)
        wheels = np.radians(0.05) * draw.normal(size=(4000, 60))
        lines = 2 * np.abs(np.fft.fft(wheels, axis=1)[:, 6]) / 60
        rms = np.sqrt(np.mean(lines**2))
        _, angle = shaft(900 * RPM)
        times = pulses(angle, positions=wheels[0])
        found = wheel_rotation(PulseChannel("n1", times), Wheel(teeth=60))
        scale = np.radians(0.05) / found.deviations.places
        assert np.degrees(found.order_deviation(6) * scale) == pytest.approx(np.degrees(rms), rel=0.02)
        assert np.degrees(rms) == pytest.approx(0.0129, abs=2e-4)
        assert found.order_deviation(6.5) < 1e-3 * found.order_deviation(6)


class TestTooth0:
    def test_an_index_pulse_names_it(self):
        _, angle = shaft(1500 * RPM, {3: TENTH})
        times = pulses(angle, first=11)
        index = PulseChannel("cam", pulse_times(angle, 4 * np.pi * np.arange(1, 20) + 0.3, 2.0))
        found = wheel_rotation(PulseChannel("n1", times), Wheel(teeth=60), index=index)
        # The index is 0.3 rad, 2.86 pitches, behind tooth 0 of the shaft: tooth 3 comes next.
        assert found.numbers[0] == (11 - 3) % 60
        assert found.zero == "the first tooth at or after a pulse of cam"

    def test_an_index_that_does_not_fit_the_teeth(self):
        _, angle = shaft(1500 * RPM)
        index = PulseChannel("cam", pulse_times(angle, 2 * np.pi * np.arange(2, 39), 3.0))
        with pytest.raises(UsageError, match=r"(?s)60\.00.*60\.00.*unfit-wheel"):
            wheel_rotation(PulseChannel("n1", pulses(angle)), Wheel(teeth=59), index=index)

    def test_two_candidates_for_a_gap(self):
        _, angle = shaft(1500 * RPM)
        every = pulses(angle)
        twice = every[~np.isin(np.arange(len(every)) % 60, [10, 11, 45, 46])]
        channel, wheel = PulseChannel("n1", twice), Wheel(teeth=60, missing_teeth=2)
        with pytest.raises(
            UsageError,
            match=r"(?s)44.*23.*ambiguous-tooth",
        ):
            wheel_rotation(channel, wheel)
        assert wheel_rotation(channel, wheel, first=48).numbers[0] == 48

    @pytest.mark.parametrize(
        ("teeth", "missing", "message"),
        [
            (60, 0, r"(?s)60.*unfit-wheel"),
            (60, 1, r"(?s)60.*50.*unfit-wheel"),
            (58, 2, r"(?s)60.*unfit-wheel"),
        ],
    )
    def test_wheels_that_do_not_fit_their_gap(self, teeth, missing, message):
        _, angle = shaft(1500 * RPM)
        channel = PulseChannel("n1", pulses(angle, missing=2, first=7))
        with pytest.raises(UsageError, match=message):
            wheel_rotation(channel, Wheel(teeth=teeth, missing_teeth=missing))

    def test_repairs_beside_a_gap_are_said_and_the_gap_is_none(self):
        _, angle = shaft(1500 * RPM)
        times = np.delete(pulses(angle, missing=2), [300, 700])
        times = np.sort(np.append(times, times[500] + 2e-5))
        found = wheel_rotation(PulseChannel("n1", times), Wheel(teeth=60, missing_teeth=2))
        assert [one.split(":")[0] for one in found.remarks] == [
            "1 pulse too many left out", "2 pulses missing and counted",
        ]  # fmt: skip
        assert found.gap == "gap of 2 teeth found in 39 turns, first after pulse 57 of the record"


class TestRefused:
    @pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 0.9])
    def test_a_reversal_without_direction(self, share):
        """Constant deceleration through 0: pulses at the same places on the way back."""
        places = np.arange(300) + share
        half = np.sqrt(places / 1e3)
        times = np.concatenate([-half[::-1], half])[1 if share == 0 else 0 :]
        times = np.unique(times) + 1
        with pytest.raises(UsageError, match=r"(?s)(1|0\.9\d*) s.*turning-back"):
            wheel_rotation(PulseChannel("n1", times), Wheel(teeth=60))

    @pytest.mark.parametrize("slope", [-30.0, 30.0])
    def test_none_is_seen_where_the_shaft_turns_on(self, slope):
        _, angle = shaft(700 * RPM, {0.5: 10 * TENTH, 1: 10 * TENTH}, acceleration=slope)
        seconds = 2.0
        count = int(angle(np.array([seconds]))[0] / (2 * np.pi / 60))
        times = pulse_times(angle, np.arange(2, count) * 2 * np.pi / 60, seconds)
        assert wheel_rotation(PulseChannel("n1", times), Wheel(teeth=60)).remarks == ()

    def test_a_pattern_of_other_teeth(self):
        with pytest.raises(UsageError, match=r"(?s)36.*60.*unfit-wheel"):
            wheel_rotation(
                PulseChannel("n1", np.arange(9.0)), Wheel(teeth=60), WheelPattern(np.zeros(36), np.zeros(36))
            )

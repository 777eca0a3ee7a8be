"""What tells a wheel's pattern from vibration, what stays ambiguous, and which tooth is the first."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy
from support import campaigns
from support.turned_wheels import crossing_angles, position_amplitude, run_up, steady
from support.wheel_tests import DEGREE, ORDERS, RPM, VALUES, Z, record, teeth

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.identification.orders.parametric_orders import calculated_wheel_orders
from torsionnet.signals.rotation.pitch_order import CalculatedOrders, constant_part
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.turn_pattern import check_pattern
from torsionnet.signals.rotation.wheel import Wheel, WheelPattern
from torsionnet.signals.rotation.wheel_calibration import WheelTest, _over_windows, calibrate_wheel
from torsionnet.signals.rotation.wheel_rotation import wheel_rotation


class TestTwoPickups:
    def test_one_speed_is_enough(self):
        positions = teeth()
        found = calibrate_wheel(
            [record(positions, 100.0, angle=100 * DEGREE)], Wheel(teeth=Z), pickup_angle=101 * DEGREE
        )
        assert found.pattern.positions == pytest.approx(positions, abs=1e-5 * DEGREE)
        assert found.angle / DEGREE == pytest.approx(100, abs=1e-5)
        assert [row.by for row in found.orders[:3]] == ["two pickups"] * 3

    def test_at_180_degrees_even_orders_stay_ambiguous_with_their_amount(self):
        positions = teeth()
        found = calibrate_wheel([record(positions, 100.0, angle=np.pi)], Wheel(teeth=Z), pickup_angle=np.pi)
        assert found.pattern.unresolved == (2, 4, 6, 8, 10)
        for row in found.orders[:9:2]:
            assert row.value == pytest.approx(position_amplitude(positions, row.order), abs=1e-4 * DEGREE)
        # Order 2 of the pattern, less that of the vibration: an edge beyond its place reads as too small an angle.
        seen = position_amplitude(positions, 2) - VALUES[2]
        assert found.orders[1].value == pytest.approx(seen, abs=2e-3 * DEGREE)
        assert "blind" in found.orders[1].why
        assert any("not resolved: order 2 (" in note for note in found.notes)

    def test_a_run_up_in_one_record(self):
        positions, pickups = teeth(), []
        for name, at in (("A", 0.0), ("B", 100 * DEGREE)):
            phi = crossing_angles(ORDERS, VALUES, positions, 160, pickup=at)
            pickups.append(PulseChannel(name, run_up(phi, 600 * RPM, 10.0)))
        found = calibrate_wheel([WheelTest(*pickups)], Wheel(teeth=Z), pickup_angle=100 * DEGREE)
        assert found.pattern.positions == pytest.approx(positions, abs=2e-4 * DEGREE)
        assert "valid within that record only" in found.pattern.first

    def test_a_wheel_with_a_gap(self):
        positions = teeth(count=36, missing=2)
        test = record(positions, 100.0, angle=100 * DEGREE, missing=2, index=False)
        found = calibrate_wheel([test], Wheel(teeth=36, missing_teeth=2), pickup_angle=100 * DEGREE)
        assert found.pattern.positions == pytest.approx(positions, abs=1e-4 * DEGREE)
        assert found.known
        assert found.pattern.missing == 2

    def test_exchanged_pickups_of_a_wheel_with_a_gap_are_refused(self):
        test = record(teeth(count=36, missing=2), 100.0, angle=100 * DEGREE, missing=2, index=False)
        with pytest.raises(UsageError, match="are they exchanged"):
            calibrate_wheel(
                [WheelTest(test.second, test.first)], Wheel(teeth=36, missing_teeth=2), pickup_angle=100 * DEGREE
            )

    def test_an_angle_half_a_pitch_away_is_refused(self):
        test = record(teeth(), 100.0, angle=100 * DEGREE)
        with pytest.raises(UsageError, match="ambiguous-tooth"):
            calibrate_wheel([test], Wheel(teeth=Z), pickup_angle=107 * DEGREE)

    def test_records_are_aligned_by_the_pattern(self):
        positions = teeth()
        tests = [
            record(positions, 100.0, angle=100 * DEGREE, index=False),
            record(positions, 150.0, angle=100 * DEGREE, index=False, first=7),
        ]
        found = calibrate_wheel(tests, Wheel(teeth=Z), pickup_angle=100 * DEGREE)
        assert found.pattern.positions == pytest.approx(positions, abs=1e-4 * DEGREE)
        assert any("tooth 7 of the first record comes first" in note for note in found.notes)


class TestOnePickup:
    def test_a_rigid_response_to_inertia_torque_stays_with_its_amount(self):
        """Order 3 of engine_generator_set: the mass of six pistons, exact slider crank, on the inertia before the
        coupling; 0.057 degrees at every speed."""
        mass, radius, rod, inertia = 29.0, 0.16, 0.66, 6 * 4.2 + 58 + 1.6 + 7.5
        phi = np.arange(512) * 2 * np.pi / 512
        way = radius * (1 - np.cos(phi)) + rod - np.sqrt(rod**2 - (radius * np.sin(phi)) ** 2)
        spectrum, numbers = np.fft.fft(way), np.fft.fftfreq(512, 1 / 512)
        first, second = (np.fft.ifft((1j * numbers) ** power * spectrum).real for power in (1, 2))
        torque = 2 * np.fft.fft(-mass * first * second)[3] / 512  # over the square of the speed
        vibration = -6 * torque / (9 * inertia)
        assert abs(vibration) / DEGREE == pytest.approx(0.057, abs=5e-4)
        gas = 0.02 * DEGREE
        tests = [
            record(np.zeros(Z), rpm * RPM, values=np.array([0, 0, 0, vibration + gas * (600 / rpm) ** 2, 0]))
            for rpm in (600, 900, 1300, 1800)
        ]
        found = calibrate_wheel(tests, Wheel(teeth=Z))
        row = found.orders[2]
        assert 3 in found.pattern.unresolved
        assert row.value == pytest.approx(-vibration, abs=1e-4 * DEGREE)
        assert row.change / DEGREE == pytest.approx(gas * (1 - np.mean([1, 4 / 9, 36 / 169, 1 / 9])) / DEGREE, rel=0.01)
        assert found.pattern.positions == pytest.approx(np.zeros(Z), abs=1e-5)
        assert any("3 (0.057 degrees)" in note for note in found.notes)

    def test_orders_without_a_constant_part_are_resolved_by_the_speeds(self):
        positions = teeth()
        tests = [record(positions, rpm * RPM, values=VALUES * (600 / rpm) ** 2) for rpm in (600, 900, 1300, 1800)]
        found = calibrate_wheel(tests, Wheel(teeth=Z), constant_orders=[])
        assert found.pattern.unresolved == ()
        assert found.pattern.positions == pytest.approx(positions, abs=1e-4 * DEGREE)
        some = calibrate_wheel(tests, Wheel(teeth=Z), constant_orders=[3])
        assert some.pattern.unresolved == (3,)

    def test_poles_say_how_an_order_changes_through_a_resonance(self):
        positions = teeth()
        pole = 300.0 * (-0.05 + 1j * np.sqrt(1 - 0.05**2))
        speeds = np.linspace(600, 1800, 9) * RPM
        shapes = 1 / ((pole - 1j * 2 * speeds) * (np.conj(pole) - 1j * 2 * speeds))
        tests = [
            record(positions, speed, values=np.array([0, 0, size * 100.0, 0, 0]))
            for speed, size in zip(speeds, shapes, strict=True)
        ]
        found = calibrate_wheel(tests, Wheel(teeth=Z), constant_orders=[], poles=[pole])
        assert found.orders[1].value == pytest.approx(position_amplitude(positions, 2), abs=2e-4 * DEGREE)

    def test_one_speed_is_refused_and_what_helps_is_said(self):
        with pytest.raises(UsageError, match=r"(?s)954\.9.*unfit-order"):
            calibrate_wheel([record(teeth(), 100.0, turns=40)], Wheel(teeth=Z))

    def test_a_small_range_says_how_far_the_vibration_changes_against_the_scatter(self):
        tests = [
            record(teeth(), rpm * RPM, values=VALUES * (900 / rpm) ** 2, jitter=2e-5, seed=rpm, turns=20)
            for rpm in (870, 900, 930, 960, 990)
        ]
        found = calibrate_wheel(tests, Wheel(teeth=Z), constant_orders=[])
        assert 1 in found.pattern.unresolved
        assert "over 870 to 990 rpm the vibration changes by" in found.orders[0].why

    def test_records_without_an_index_are_refused(self):
        tests = [record(teeth(), speed, index=False) for speed in (60.0, 100.0)]
        with pytest.raises(UsageError, match="ambiguous-tooth"):
            calibrate_wheel(tests, Wheel(teeth=Z))

    def test_a_wheel_that_turns_at_another_ratio_shares_no_order_with_its_vibration(self):
        """Orders 0.8 and 1.6 per turn of a wheel: neither is a whole one, so that one speed is enough below order 4."""
        values = np.array([0.1, 0.05j]) * DEGREE
        positions = teeth()
        times = steady(crossing_angles([0.8, 1.6], values, positions, 40), 100.0)
        found = calibrate_wheel([WheelTest(PulseChannel("A", times))], Wheel(teeth=Z, ratio=0.8), cycle=1)
        assert [row.by for row in found.orders[:3]] == ["no vibration there"] * 3
        for row in found.orders[:3]:
            assert row.value == pytest.approx(position_amplitude(positions, row.order), abs=1e-4 * DEGREE)


class TestCalculated:
    def test_inertia_orders_of_a_rigid_engine_are_the_closed_form(self):
        engine = {
            "type": "reciprocating_engine", "speed_of": "a", "cycle": 4, "cylinders": dict.fromkeys((1, 2, 3), "a"),
            "firing_order": [1, 3, 2], "bore": "210 mm", "stroke": "320 mm", "rod_length": "660 mm",
            "reciprocating_mass": "29 kg",
        }  # fmt: skip
        elements = [tn.Inertia("disc", node="a", inertia=100)]
        plant = tn.Drivetrain(
            "engine", elements, speeds={"of": "a", "list": ["900 rpm"]}, excitations={"engine": engine}
        )
        found = calculated_wheel_orders(plant, "a", [60.0, 100.0])
        phi = np.arange(512) * 2 * np.pi / 512
        way = 0.16 * (1 - np.cos(phi)) + 0.66 - np.sqrt(0.66**2 - (0.16 * np.sin(phi)) ** 2)
        spectrum, numbers = np.fft.fft(way), np.fft.fftfreq(512, 1 / 512)
        first, second = (np.fft.ifft((1j * numbers) ** power * spectrum).real for power in (1, 2))
        torque = 2 * np.fft.fft(-29.0 * first * second)[3] / 512
        assert found.known[found.place(3)] == pytest.approx(np.full(2, -3 * torque / (9 * 100)), rel=1e-6)
        assert np.abs(found.shapes).max() == 0

    def test_the_wheel_may_turn_against_the_model(self):
        """The wheel's angle counts against the crank's: x_wheel(u) = -x(zero - u) at the wheel's mean angle u."""
        positions, zero, response = teeth(), 0.4, VALUES
        u = np.linspace(0, 4 * np.pi, 64, endpoint=False)
        seen = -(np.exp(1j * np.outer(zero - u, ORDERS)) @ response).real
        wheel_values = np.array([2 * np.mean(seen * np.exp(-1j * order * u)) for order in ORDERS])
        speeds = np.array([60.0, 100.0, 140.0])
        tests = [record(positions, speed, values=wheel_values) for speed in speeds]
        calculated = CalculatedOrders(
            speeds, ORDERS, np.repeat(response[:, None], 3, axis=1), np.zeros((0, 5, 3)), zero
        )
        found = calibrate_wheel(tests, Wheel(teeth=Z, reversed=True), calculated=calculated)
        assert [row.order for row in found.orders[:3] if row.resolved] == [1, 2, 3]
        assert found.pattern.reversed
        for row in found.orders[:3]:
            assert row.value == pytest.approx(position_amplitude(positions, row.order), abs=1e-4 * DEGREE)

    def test_orders_of_a_wheel_behind_a_gear_are_those_of_its_own_angle(self):
        """A wheel that turns once while the reference shaft turns twice: order 1 of the shaft is order 2 of the wheel."""
        positions, speeds = teeth(), np.array([60.0, 100.0, 140.0])
        response = np.array([0.2, 0.1j]) * DEGREE
        tests = []
        for speed in speeds:
            times = steady(crossing_angles([2, 4], response / 2, positions, 20), speed / 2)
            index = PulseChannel("I", 2 * np.pi * np.arange(21) / (speed / 2) - 1e-4)
            tests.append(WheelTest(PulseChannel("A", times), index=index))
        known = np.repeat(response[:, None], 3, axis=1)
        calculated = CalculatedOrders(speeds, np.array([1.0, 2.0]), known, np.zeros((0, 2, 3)), source="the engine")
        found = calibrate_wheel(tests, Wheel(teeth=Z, ratio=2), calculated=calculated, cycle=1)
        for row in found.orders[1:4:2]:
            assert row.by == "calculated orders"
            assert row.value == pytest.approx(position_amplitude(positions, row.order), abs=1e-4 * DEGREE)
        assert "vibration in orders 'calculated orders' is that of the engine" in found.notes

    def test_speeds_beyond_the_calculated_ones_are_refused(self):
        calculated = CalculatedOrders(np.array([50.0, 60.0]), ORDERS, np.zeros((5, 2)), np.zeros((0, 5, 2)))
        tests = [record(teeth(), speed) for speed in (60.0, 100.0)]
        with pytest.raises(UsageError, match=r"(?s)573.*954\.9.*beyond-table"):
            calibrate_wheel(tests, Wheel(teeth=Z), calculated=calculated)

    def test_a_cylinder_that_misfires_in_turn_is_refused(self):
        plant = tn.load("engine_generator_set").configured("firing=misfire,rubber=warm")
        with pytest.raises(UsageError, match="unsupported-law"):
            calculated_wheel_orders(plant, "fly", [90.0])
        with pytest.raises(UsageError, match='no node "flywheel"'):
            calculated_wheel_orders(plant, "flywheel", [90.0])


class TestIntervals:
    def test_the_scatter_of_the_speeds_counts_where_it_is_larger(self):
        random = np.random.default_rng(1)
        groups = np.repeat(np.arange(6), 5)
        noise = (random.standard_normal(30) + 1j * random.standard_normal(30)) * 0.01
        none = np.empty((30, 0), dtype=complex)
        alone = constant_part(1 + noise, none, groups)
        moved = constant_part(1 + noise + 0.1 * np.array([1, -1, 1j, -1j, 0.5, -0.5])[groups], none, groups)
        assert (alone.between, moved.between) == (False, True)
        assert moved.half_width > 5 * alone.half_width

    def test_the_half_width_of_a_mean_is_students(self):
        random = np.random.default_rng(2)
        values = 3 + random.standard_normal(12) + 1j * random.standard_normal(12)
        found = constant_part(values, np.empty((12, 0), dtype=complex), np.zeros(12, dtype=int))
        part = np.sqrt((np.abs(values - values.mean()) ** 2).sum() / (2 * 11))  # of real and of imaginary part
        assert found.half_width == pytest.approx(scipy.stats.t.ppf(0.975, 22) * part / np.sqrt(12))

    @pytest.mark.slow
    def test_means_of_teeth_are_of_the_windows_in_which_they_come(self):
        left = np.array([[0.1, 0.2, np.nan, 0.4], [0.3, np.nan, np.nan, 0.1], [0.2, np.nan, np.nan, np.nan]])
        windows = [SimpleNamespace(left=lambda _, row=row: row) for row in left]
        mean, half, variance = _over_windows(SimpleNamespace(first=windows), np.zeros(4))
        assert mean == pytest.approx([0.2, 0.2, 0, 0.25])
        low, high = scipy.stats.t.interval(0.95, [2, 1], scale=scipy.stats.sem(left[:, [0, 3]], nan_policy="omit"))
        assert half == pytest.approx([(high[0] - low[0]) / 2, 0, 0, (high[1] - low[1]) / 2])
        assert variance == pytest.approx([0.01, 0, 0, 0.045])

    def test_intervals_of_orders_and_teeth_cover_95_percent(self):
        """Wheels, 10 orders, real and imaginary part; two pickups at two speeds, jitter of 5 microseconds."""
        inside, of_teeth = [], []
        for seed in range(campaigns.examples(20, 40)):
            positions = teeth(seed)
            tests = [
                record(positions, speed, angle=100 * DEGREE, jitter=5e-6, seed=100 * seed + place, turns=50)
                for place, speed in enumerate((100.0, 160.0))
            ]
            found = calibrate_wheel(tests, Wheel(teeth=Z), pickup_angle=100 * DEGREE)
            for row in found.orders[:10]:
                away = row.value - position_amplitude(positions, row.order)
                inside += [abs(away.real) <= row.half_width, abs(away.imag) <= row.half_width]
            of_teeth += (np.abs(found.pattern.positions - positions) <= found.pattern.half_widths).tolist()
        assert 0.92 < np.mean(inside) < 0.98
        assert 0.92 < np.mean(of_teeth) < 0.99

    def test_steps_of_a_counter_that_return_with_every_turn_are_in_the_interval(self):
        """At 1200 rpm a turn takes 50 000 steps of 1 us: all windows are wrong alike, and their scatter is nothing."""
        inside, widths = [], []
        for seed in range(campaigns.examples(20, 40)):
            positions = teeth(seed)
            values = VALUES * np.exp(1j * np.random.default_rng(seed).uniform(0, 2 * np.pi, len(VALUES)))
            test = record(positions, 40 * np.pi, values=values, angle=100 * DEGREE, turns=50)
            stepped = [replace(one, times=np.round(one.times, 6)) for one in (test.first, test.second)]
            found = calibrate_wheel([WheelTest(*stepped, test.index)], Wheel(teeth=Z), pickup_angle=100 * DEGREE)
            for row in found.orders[:10]:
                away = row.value - position_amplitude(positions, row.order)
                inside += [abs(away.real) <= row.half_width, abs(away.imag) <= row.half_width]
                widths.append(row.half_width)
        assert 0.9 < np.mean(inside) < 0.99
        assert np.max(widths) < 0.01 * DEGREE


class TestStoredPattern:
    def test_its_first_tooth_is_found_by_its_shape(self):
        positions = teeth(count=60)
        pattern = WheelPattern(positions, np.zeros(60))
        times = steady(crossing_angles(ORDERS, VALUES, positions, 20, first=17), 100.0)
        found = wheel_rotation(PulseChannel("A", times), Wheel(teeth=60), pattern)
        assert found.numbers[0] == 17
        assert "17" in found.zero

    def test_a_pattern_that_says_not_which_tooth_is_first_is_refused(self):
        positions = 0.05 * DEGREE * np.cos(2 * np.pi * np.arange(60) / 60)
        times = steady(crossing_angles(ORDERS, VALUES, positions, 20, first=17), 100.0)
        with pytest.raises(UsageError, match="ambiguous-tooth"):
            wheel_rotation(PulseChannel("A", times), Wheel(teeth=60), WheelPattern(positions, np.zeros(60)))

    def test_a_pattern_of_another_wheel_is_refused_with_all_reasons(self):
        pattern = WheelPattern(np.zeros(60), np.zeros(60), missing=2, reversed=True)
        with pytest.raises(UsageError, match=r"(?s)60.*36.*unfit-wheel"):
            check_pattern("n1", Wheel(teeth=36), pattern)

"""The pitch pattern of a wheel: what it adds to orders, and how two pickups or a model find it."""

import numpy as np
import pytest
from support.turned_wheels import crossing_angles, position_amplitude, run_up, steady, tracked

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.identification.orders.parametric_orders import calculated_wheel_orders
from torsionnet.signals.rotation.pitch_order import pickup_gains
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import Wheel, WheelPattern
from torsionnet.signals.rotation.wheel_calibration import WheelTest, calibrate_wheel

RPM = np.pi / 30
DEGREE = np.pi / 180
TEETH = 60
TICK = 12.5e-9
"""Step in s of the counter that stamps the pulses, as of a clock of 80 MHz."""
FEW_SPEEDS, ALL_SPEEDS = (600, 900, 1300, 1800), range(600, 1801, 100)
HALF = np.arange(1, 25) / 2


@pytest.fixture(scope="module")
def plant():
    return tn.load("engine_generator_set").configured("firing=normal,rubber=warm")


@pytest.fixture(scope="module")
def engine_orders(plant):
    """Complex orders of the flywheel's angle at each speed in r/min, by the model."""
    run = plant.order_response("fly", speeds=np.array(ALL_SPEEDS) * RPM)
    assert [float(line.relative) for line in run.lines] == HALF.tolist()
    return dict(zip(ALL_SPEEDS, run.values[:, :, 0], strict=True))


def wheel_errors(seed=1, sigma=0.05, eccentric=0.0, teeth=TEETH):
    """Positions in rad of teeth with independent errors and an eccentricity, both in degrees."""
    found = sigma * np.random.default_rng(seed).standard_normal(teeth)
    found -= (
        2 * (position_amplitude(found, 1) * np.exp(2j * np.pi * np.arange(teeth) / teeth)).real / 2 * bool(eccentric)
    )
    found += eccentric * np.cos(2 * np.pi * np.arange(teeth) / teeth + 0.7)
    return (found - found.mean()) * DEGREE


def channel(name, times, jitter=0.0, seed=0):
    """Pulses as a counter stamps them, with a jitter in s."""
    moved = times + jitter * np.random.default_rng(seed).standard_normal(len(times))
    return PulseChannel(name, np.round(moved / TICK) * TICK, TICK)


def engine_test(values, rpm, positions, turns=18, angle=None, jitter=0.0):
    """Records of one steady speed, with an index pulse half a pitch before tooth 0, and a second pickup."""
    pickups = [
        channel(
            name, steady(crossing_angles(HALF, values, positions, turns, pickup=at), rpm * RPM), jitter, rpm + place
        )
        for place, (name, at) in enumerate((("A", 0.0), ("B", angle)))
        if at is not None
    ]
    index = PulseChannel("index", steady(2 * np.pi * np.arange(1, turns) - np.pi / TEETH, rpm * RPM))
    return WheelTest(pickups[0], pickups[1] if len(pickups) > 1 else None, index)


class TestWhatAPatternAdds:
    @pytest.mark.parametrize(
        ("errors", "orders", "added"),
        [
            (lambda random: 0.05 * random.standard_normal((4000, TEETH)), range(1, 30), 0.0129),
            (lambda random: 0.3 * random.uniform(-1, 1, (4000, TEETH)), range(1, 30), 0.045),
            (lambda random: 0.3 * random.standard_normal((4000, TEETH)), range(1, 30), 0.077),
            (lambda random: np.cumsum(0.05 * random.standard_normal((4000, TEETH)), axis=1), [1], 0.123),
        ],
        ids=["positions 0.05 degrees", "uniform 5 % of a pitch", "normal 5 % of a pitch", "intervals 0.05 degrees"],
    )
    def test_independent_errors_add_2_sigma_over_root_z_to_each_whole_order(self, errors, orders, added):
        wheels = errors(np.random.default_rng(1))
        wheels -= np.linspace(0, 1, TEETH) * (wheels[:, -1:] if list(orders) == [1] else 0)  # a turn closes
        turning = np.exp(-2j * np.pi * np.outer(np.arange(TEETH), list(orders)) / TEETH)
        rms = np.sqrt(np.mean(np.abs(2 / TEETH * wheels @ turning) ** 2, axis=0))
        assert rms == pytest.approx(added, rel=0.05)
        one = WheelPattern(wheels[0] * DEGREE, np.zeros(TEETH))
        assert one.order(orders[0]) / DEGREE == pytest.approx(-2 / TEETH * wheels[0] @ turning[:, 0])

    def test_pickups_at_114_degrees_see_orders_1_to_12_and_at_180_no_even_ones(self):
        assert pickup_gains(114 * DEGREE, range(1, 13)).min() == pytest.approx(0.31, abs=0.005)
        assert pickup_gains(180 * DEGREE, range(2, 13, 2)).max() < 1e-12
        assert pickup_gains(180 * DEGREE, range(1, 13, 2)).min() == pytest.approx(2)


def worst(engine_orders, speeds, positions, found, orders=HALF, turns=18):
    """Largest error of an order beyond 0.5 % of it in degrees, and of a phase above 0.01 degrees, after correction."""
    left, phases = [], []
    for rpm in speeds:
        times = engine_test(engine_orders[rpm], rpm, positions, turns).first.times
        true, seen = engine_orders[rpm], tracked(times, found, HALF)
        chosen = np.isin(HALF, orders)
        left.append((np.abs(seen - true) - 0.005 * np.abs(true))[chosen].max())
        large = chosen & (np.abs(true) > 0.01 * DEGREE)
        phases.append(np.abs(np.angle(seen[large] / true[large])).max())
    return max(left) / DEGREE, max(phases) / DEGREE


class TestEngineOrders:
    """Orders 0.5 to 12 of a four-stroke in-line six over 600 to 1800 r/min."""

    def two_pickups(self, engine_orders, speeds, turns):
        positions = wheel_errors(eccentric=0.048)
        tests = [engine_test(engine_orders[rpm], rpm, positions, turns, 114.3 * DEGREE) for rpm in speeds]
        found = calibrate_wheel(tests, Wheel(teeth=TEETH), pickup_angle=114 * DEGREE)
        assert found.pattern.unresolved == ()
        assert found.angle / DEGREE == pytest.approx(114.3, abs=1e-3)
        assert found.angle / DEGREE == pytest.approx(114.3, abs=3 * found.angle_half_width / DEGREE)
        return worst(engine_orders, speeds, positions, found.pattern.positions, turns=turns)

    def test_two_pickups_leave_0_002_degrees_and_half_a_degree_of_phase(self, engine_orders):
        amplitude, phase = self.two_pickups(engine_orders, FEW_SPEEDS[1:3], 18)
        assert amplitude < 0.002
        assert phase < 0.5

    @pytest.mark.parametrize("turns", [9, 16])
    def test_one_window_tells_no_order_and_two_tell_the_pattern(self, engine_orders, turns):
        """A pattern without its lower orders came out, 0.1 degrees off."""
        positions, angle = wheel_errors(), np.radians(114)
        short, long = (engine_test(engine_orders[900], 900, positions, n, angle) for n in (turns, 17))
        with pytest.raises(UsageError, match=r"(?s)17.*too-short"):
            calibrate_wheel([short], Wheel(teeth=TEETH), pickup_angle=angle)
        found = calibrate_wheel([long], Wheel(teeth=TEETH), pickup_angle=angle).pattern
        assert np.degrees(np.abs(found.positions - positions + positions.mean()).max()) < 1e-3

    @pytest.mark.nightly
    def test_two_pickups_at_all_speeds(self, engine_orders):
        amplitude, phase = self.two_pickups(engine_orders, ALL_SPEEDS, 34)
        assert amplitude < 0.0005
        assert phase < 0.5

    def known_inertia(self, plant, speeds, turns):
        positions = wheel_errors(eccentric=0.048)
        grid = np.array(sorted(speeds)) * RPM
        calculated = calculated_wheel_orders(plant, "fly", grid)
        # The test is of another load: the gas acts with 0.8 of the size, and a little later.
        factor = 0.8 * np.exp(0.2j)
        truth = {
            rpm: calculated.known[:, place] + factor * calculated.shapes[0][:, place]
            for place, rpm in enumerate(sorted(speeds))
        }
        tests = [engine_test(truth[rpm], rpm, positions, turns) for rpm in speeds]
        found = calibrate_wheel(tests, Wheel(teeth=TEETH), calculated=calculated)
        assert not set(found.pattern.unresolved) & set(range(1, 13))
        return worst(truth, speeds, positions, found.pattern.positions, turns=turns)

    def test_a_known_inertia_leaves_0_002_degrees_and_half_a_degree_of_phase(self, plant):
        amplitude, phase = self.known_inertia(plant, FEW_SPEEDS, 18)
        assert amplitude < 0.002
        assert phase < 0.5

    @pytest.mark.nightly
    def test_a_known_inertia_at_all_speeds(self, plant):
        amplitude, phase = self.known_inertia(plant, ALL_SPEEDS, 34)
        assert amplitude < 0.001
        assert phase < 0.5

    def test_two_pickups_of_a_wheel_with_a_gap_on_a_strongly_vibrating_shaft(self):
        """Intervals of 2.5 degrees of order 4 swing as lost pulses make them, at either pickup."""
        positions = wheel_errors(teeth=36)
        positions -= positions[:34].mean()
        passed = [
            crossing_angles([4], [2.5 * DEGREE], positions, 19, pickup=at * DEGREE, missing=2, first=first)
            for at, first in ((0, 36), (114, 25))
        ]
        pickups = [PulseChannel(name, steady(phi, 900 * RPM)) for name, phi in zip("AB", passed, strict=True)]
        found = calibrate_wheel([WheelTest(*pickups)], Wheel(teeth=36, missing_teeth=2), pickup_angle=114 * DEGREE)
        assert np.abs(found.pattern.positions - positions)[:34].max() < 1e-5 * DEGREE
        assert not found.pattern.unresolved

    def test_with_one_pickup_whole_orders_keep_the_pattern_and_half_orders_do_not(self, engine_orders):
        positions = wheel_errors(eccentric=0.048)
        assert abs(position_amplitude(positions, 1)) / DEGREE == pytest.approx(0.048)
        tests = [engine_test(engine_orders[rpm], rpm, positions) for rpm in FEW_SPEEDS]
        found = calibrate_wheel(tests, Wheel(teeth=TEETH))
        assert set(range(1, 13)) <= set(found.pattern.unresolved)
        corrected = found.pattern.positions
        for rpm in FEW_SPEEDS:
            times, true = engine_test(engine_orders[rpm], rpm, positions).first.times, engine_orders[rpm]
            error = np.abs(tracked(times, corrected, HALF) - true) / DEGREE
            own = np.array([abs(position_amplitude(positions, int(order))) for order in HALF[1::2]]) / DEGREE
            assert error[1] == pytest.approx(0.048, abs=0.002)
            assert error[1::2] == pytest.approx(own, abs=0.003)
            assert (error[::2] < 0.002 + 0.005 * np.abs(true[::2]) / DEGREE).all()


@pytest.mark.parametrize(
    ("teeth", "indexed", "doubted"), [(TEETH, False, False), (24, False, True), (TEETH, True, False)]
)
def test_a_wrong_number_of_teeth_shows_in_the_scatter(teeth, indexed, doubted):
    times = run_up(crossing_angles([1.5], [0.002], wheel_errors(), 150), 600 * RPM, 6.0)
    index = PulseChannel("index", times[::TEETH] - 1e-4) if indexed else None
    test = WheelTest(PulseChannel("A", times), None, index)
    found = calibrate_wheel([test], Wheel(teeth=teeth), constant_orders=[], widest=np.inf)
    assert any(f"another number than {teeth} teeth" in text for text in found.notes) == doubted

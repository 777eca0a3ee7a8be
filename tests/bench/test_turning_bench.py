"""Benches that turn against dense matrices and closed forms: motion, wheels, gauges, clocks, and their true faults."""

import time
from dataclasses import replace

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.bench.plan import (
    Acquisition,
    CoastDown,
    Encoder,
    Plan,
    RecordingSystem,
    RunDown,
    RunUp,
    SteadyPoints,
    StrainGauge,
    ToothedWheel,
    Transducer,
)
from torsionnet.bench.turning_motion import coast_down, turning_inertia
from torsionnet.bench.wheel_turning import counted_pulses, true_places, with_wheel_speeds
from torsionnet.signals.recording import PulseChannel, Recording

RPM = np.pi / 30
J_A, J_B, K, C = 1.0, 3.0, 4000.0, 6.0
M, DAMPING, STIFFNESS = (
    np.diag([J_A, J_B]),
    C * np.array([[1, -1], [-1, 1]]),
    K * np.array([[1, -1], [-1, 1]]),
)
ORDERS = {2: (50.0, 0.3), 3: (20.0, -1.0)}
"""Order: amplitude in N m, phase in rad, of the torque on a."""


def shafts(**entries):
    elements = [
        tn.Inertia("first", node="a", inertia=J_A),
        tn.Spring("shaft", nodes=("a", "b"), stiffness=K, damping=C),
        tn.Inertia("second", node="b", inertia=J_B),
    ]
    orders = {order: {"amplitude": size, "phase": phase} for order, (size, phase) in ORDERS.items()}
    given = {
        "speeds": {"of": "a", "range": "100..3000 rpm", "step": "100 rpm", "rated": "1500 rpm"},
        "excitations": {"engine": {"type": "harmonic", "node": "a", "orders": orders}},
        "load": {"absorbed_at": "b", "torque": "100 N*m", "torque_exponent": 2, "driven_by": {"a": 1}},
    }
    return tn.Drivetrain("two rotors", elements, **(given | entries))


WHEEL = ToothedWheel(sensor="angle(b)", teeth=24)
TORQUE = StrainGauge(sensor="torque(shaft)")
STEADY = SteadyPoints(speeds=["1500 rpm"], duration="4 s")


def bench(channels, motion=STEADY, rig=None, **entries):
    plan = Plan(motion=motion, channels=channels, acquisition=Acquisition(rate="2 kHz"), **entries)
    return tn.Bench(rig or shafts(), plan)


def steady_amplitudes(speed):
    """Complex amplitudes (2, n_orders) of both rotors in rad from the dense matrices."""
    found = []
    for order, (size, phase) in ORDERS.items():
        w = order * speed
        found.append(np.linalg.solve(STIFFNESS + 1j * w * DAMPING - w**2 * M, [size * np.exp(1j * phase), 0]))
    return np.array(found).T


# Motion


def test_a_run_up_is_that_of_the_dense_matrices_with_crossings_by_brentq():
    start, stop, length = 500 * RPM, 600 * RPM, 0.6
    slope = (stop - start) / length
    turned = lambda t: start * t + slope * t**2 / 2  # noqa: E731

    def rates(t, state):
        torque = sum(size * np.cos(order * turned(t) + phase) for order, (size, phase) in ORDERS.items())
        forces = np.array([torque, 0]) - DAMPING @ state[2:] - STIFFNESS @ state[:2]
        return np.concatenate([state[2:], np.linalg.solve(M, forces)])

    first = steady_amplitudes(start)
    speeds = first * 1j * np.array(list(ORDERS)) * start
    begin = np.concatenate([first.sum(axis=1).real, speeds.sum(axis=1).real])
    solved = scipy.integrate.solve_ivp(rates, (0, length), begin, "DOP853", rtol=1e-11, atol=1e-13, dense_output=True)
    test = bench({"b": WHEEL, "T": TORQUE}, RunUp(start="500 rpm", stop="600 rpm", duration="0.6 s")).turned()
    pulses, numbers = test.records[""].pulses_of("b").times, test.numbers[""]["b"]
    angle = lambda t: turned(t) + solved.sol(t)[1]  # noqa: E731
    # A free drivetrain drifts from its mean rotation along a straight line, which the bench leaves out.
    left = np.array([angle(t) for t in pulses]) - 2 * np.pi * numbers / 24
    line = np.polynomial.Polynomial.fit(pulses, left, 1)
    assert np.abs(left - line(pulses)).max() < 1e-7
    assert np.abs(line(pulses)).max() < np.radians(0.2)
    some = range(5, len(pulses) - 5, 20)
    exact = [
        scipy.optimize.brentq(lambda t, n=n: angle(t) - line(t) - 2 * np.pi * n / 24, 0, length, xtol=1e-14)
        for n in numbers[some]
    ]
    assert np.abs(pulses[some] - exact).max() < 3e-9
    at = test.records[""].time
    torque = K * (solved.sol(at)[0] - solved.sol(at)[1]) + C * (solved.sol(at)[2] - solved.sol(at)[3])
    mean = 100 * ((start + slope * at) / (1500 * RPM)) ** 2  # the torque of the load goes through the shaft
    read = test.records[""]["T"].values
    assert np.abs(read - torque - mean).max() < 2e-4 * np.abs(torque).max()


def test_steady_points_are_exactly_periodic_and_equal_the_dense_solution():
    test = bench({"b": WHEEL, "T": TORQUE}, SteadyPoints(speeds=["1500 rpm", "700 rpm"], duration="2 s")).turned()
    assert list(test.records) == ["1500rpm", "700rpm"]
    for name, rpm in (("1500rpm", 1500), ("700rpm", 700)):
        speed = rpm * RPM
        amplitudes, orders = steady_amplitudes(speed), np.array(list(ORDERS))
        times, numbers = test.records[name].pulses_of("b").times, test.numbers[name]["b"]
        vibration = (amplitudes[1] @ np.exp(1j * np.outer(orders, speed * times))).real
        assert np.abs(speed * times + vibration - 2 * np.pi * numbers / 24).max() < 1e-11
        across = (K + 1j * C * orders * speed) * (amplitudes[0] - amplitudes[1])
        at = test.records[name].time
        torque = 100 * (rpm / 1500) ** 2 + (across @ np.exp(1j * np.outer(orders, speed * at))).real
        assert np.abs(test.records[name]["T"].values - torque).max() < 1e-8


def test_universal_joint_at_10_degrees_gives_order_2_of_0_4386_degrees():
    elements = [
        tn.Inertia("motor", node="input", inertia=1e6),
        tn.Spring("joint", nodes=("input", "output"), stiffness=1e9, damping=1e3),
        tn.Inertia("yoke", node="output", inertia=1e-3),
    ]
    joint = {"type": "universal_joint", "joint": "joint", "speed_of": "input", "angle": "10 deg"}
    rig = tn.Drivetrain("joint", elements, excitations={"cross": joint})
    wheel = ToothedWheel(sensor="angle(output)", teeth=60)
    test = bench({"out": wheel}, SteadyPoints(speeds=["600 rpm"], duration="2 s", speed_of="input"), rig).turned()
    times, turned = test.records[""].pulses_of("out").times, 600 * RPM
    left = 2 * np.pi * test.numbers[""]["out"] / 60 - turned * times
    columns = [part(order * turned * times) for order in (2, 4) for part in (np.cos, np.sin)]
    found = np.linalg.lstsq(np.array(columns).T, left, rcond=None)[0]
    assert np.degrees(np.hypot(*found[:2])) == pytest.approx(0.4386, abs=5e-5)


@pytest.mark.parametrize("given", [{"time_constant": "2 s"}, {}])
def test_a_coast_down_falls_by_its_time_constant_or_by_the_load(given):
    motion = CoastDown(start="1500 rpm", stop="750 rpm", without=["engine"], **given)
    (turning,) = bench({"b": WHEEL}, motion).motions
    at = np.linspace(0, turning.mean.length, 50)
    # By the load: (J_A + J_B) dw/dt = -T0 (w/w0)^2.
    begin = 1500 * RPM
    exact = begin * np.exp(-at / 2) if given else begin / (1 + 100 * at / ((J_A + J_B) * begin))
    assert turning.mean.length == pytest.approx(2 * np.log(2) if given else 4 * begin / 100, rel=1e-5)
    assert np.abs(turning.mean.speed(at) / exact - 1).max() < 2e-5


def test_inertia_behind_a_gear_counts_with_the_square_of_the_ratio():
    rig = tn.load("marine_medium_speed")
    engine = 38 + 145 + 6 * 52 + 780 + 95 + 14
    shaft = 7850 * np.pi / 32 * (0.3**4 * 6.5 + 0.345**4 * 7.2)
    quill = 7850 * np.pi / 32 * 0.2**4 * 1.4
    behind = 640 + 22 + 6200 * 1.28 + shaft
    assert turning_inertia(rig, "fly") == pytest.approx(engine + quill + behind / 4.94**2, rel=0.01)


@pytest.mark.parametrize("ratio", [3, -3])
@pytest.mark.parametrize("node", ["a", "c"])
def test_a_coast_down_takes_one_time_at_whichever_shaft_it_is_told(node, ratio):
    """J dw/dt = -T0 (w/w0)^2 takes J w0/T0 down to half of w0: 4 kg m^2 and 100 N m at a, 36 and 300 at c."""
    elements = [
        tn.Inertia("first", node="a", inertia=J_A),
        tn.Spring("shaft", nodes=("a", "b"), stiffness=K, damping=C),
        tn.Gear("mesh", nodes=("b", "c"), ratio=ratio),
        tn.Inertia("second", node="c", inertia=9 * J_B),
    ]
    speeds = {"of": "a", "range": "100..3000 rpm", "step": "100 rpm", "rated": "1500 rpm"}
    load = {"absorbed_at": "c", "torque": "300 N*m", "torque_exponent": 2, "driven_by": {"a": 1}}
    begin = 1500 * RPM / {"a": 1, "c": 3}[node]
    times, _, notes = coast_down(tn.Drivetrain("geared", elements, speeds=speeds, load=load), node, begin, begin / 2)
    assert times[-1] == pytest.approx(4 * 1500 * RPM / 100, rel=1e-5)
    said = {"a": "100 N*m at first, with 4 kg*m^2", "c": "300 N*m at first, with 36 kg*m^2"}[node]
    assert notes == (f"braked by the load, {said}, both at {node}",)


@pytest.mark.slow
def test_a_load_that_absorbs_nothing_lets_nothing_coast_down():
    with pytest.raises(UsageError, match="missing-entry"):
        coast_down(tn.load("engine_generator_set"), "fly", 900 * RPM, 600 * RPM)


def test_a_run_down_goes_through_the_speeds_backwards_and_without_excitations_nothing_vibrates():
    motion = RunDown(start="900 rpm", stop="500 rpm", rate="100 rpm/s", without=["engine"])
    run = bench(
        {"b": WHEEL, "phi": Encoder(sensor="angle(a)", lines=1000), "w": Transducer(sensor="velocity(b)")}, motion
    )
    record = run.run()
    assert record.duration == pytest.approx(4)
    assert np.abs(record["w"].values - RPM * (900 - 100 * record.time)).max() < 1e-9
    t = record.pulses_of("b").times
    turned = RPM * (900 * t - 50 * t**2)
    assert np.abs(turned - 2 * np.pi / 24 * np.arange(len(t))).max() < 1e-9
    assert np.abs(run.truth["phi"].values - run.truth["mean_angle"].values).max() < 1e-12


def test_a_wheel_against_the_sense_of_the_model_has_rising_angles():
    wheel = {
        "w": ToothedWheel(sensor="angle(prop)", teeth=60),
        "c": ToothedWheel(sensor="angle(fly)", teeth=1, gearing=0.5),
    }
    rig = tn.load("marine_medium_speed")
    test = bench(wheel, SteadyPoints(speeds=["600 rpm"], duration="3 s"), rig).turned()
    assert len(test.records[""].pulses_of("w")) == pytest.approx(600 / 4.94 / 60 * 3 * 60, abs=1.01)
    assert len(test.records[""].pulses_of("c")) == pytest.approx(15, abs=1)
    assert (np.diff(test.numbers[""]["w"]) == 1).all()
    turned = test.truths[""]["w_angle"].values
    assert turned[-1] - turned[0] < 0


# Wheels


@pytest.mark.parametrize(("kind", "share", "degrees"), [("uniform", 0.05, 0.0447), ("normal", 0.05, 0.0775),
                                                        ("normal", 0.05 / 6, 0.0129)])  # fmt: skip
def test_errors_of_positions_add_two_sigma_over_the_root_of_the_teeth_to_every_order(kind, share, degrees):
    wheel = ToothedWheel(sensor="angle(b)", teeth=60, pitch_errors={kind: share})
    wheels = [true_places("w", wheel, lambda _, n=n: np.random.default_rng(n)) for n in range(400)]
    amplitudes = 2 * np.abs(np.fft.rfft(wheels, axis=1)[:, 1:13]) / 60
    assert np.degrees(np.sqrt((amplitudes**2).mean())) == pytest.approx(degrees, rel=0.03)


def test_each_tooth_passes_where_its_true_pattern_says_and_a_second_pickup_sees_it_later():
    wheel = replace(WHEEL, pitch_errors={"normal": "3 %", "eccentricity": "0.1 deg"}, missing_teeth=2, index=True)
    second = ToothedWheel(wheel="b", pickup_angle="114 deg")
    test = bench({"b": wheel, "b2": second}, replace(STEADY, without=("engine",))).turned()
    record, pattern = test.records[""], test.patterns["b"]
    assert pattern.missing == 2
    assert pattern.positions[:22].mean() == pytest.approx(0, abs=1e-15)
    for name, later in (("b", 0.0), ("b2", np.radians(114))):
        teeth = test.numbers[""][name]
        angle = 1500 * RPM * record.pulses_of(name).times
        assert not np.isin(teeth % 24, (22, 23)).any()
        assert np.abs(angle - 2 * np.pi * teeth / 24 - pattern.positions[teeth % 24] - later).max() < 1e-11
    assert np.abs(1500 * RPM * np.diff(record.pulses_of("b_index").times) - 2 * np.pi).max() < 1e-11


def test_radial_vibration_looks_opposite_at_the_opposite_pickup():
    radial = {"amplitude": "0.1 mm", "order": 1, "phase": "20 deg", "direction": "90 deg"}
    wheel = replace(WHEEL, radius=0.2, radial_vibration=radial)
    channels = {"b": wheel, "b2": ToothedWheel(wheel="b", pickup_angle="180 deg")}
    test = bench(channels, replace(STEADY, without=("engine",))).turned()
    for name, sign, later in (("b", 1, 0.0), ("b2", -1, np.pi)):
        angle = 1500 * RPM * test.records[""].pulses_of(name).times
        apparent = 2 * np.pi * test.numbers[""][name] / 24 + later - angle
        assert np.abs(apparent - sign * 0.1 / 200 * np.cos(angle + np.radians(20))).max() < 1e-11


def test_radial_vibration_towards_a_pickup_is_not_seen():
    """A centre that moves along 30 degrees is seen by sin(30 - 90) at a pickup at 90 degrees, and not by one at 30."""
    radial = {"amplitude": "0.1 mm", "order": 1, "direction": "30 deg"}
    wheel = replace(WHEEL, radius=0.2, radial_vibration=radial)
    channels = {"b": wheel, "b2": ToothedWheel(wheel="b", pickup_angle="30 deg"),
                "b3": ToothedWheel(wheel="b", pickup_angle="90 deg")}  # fmt: skip
    test = bench(channels, replace(STEADY, duration=1.0, without=("engine",))).turned()
    for name, later in (("b2", np.radians(30)), ("b3", np.radians(90))):
        angle = 1500 * RPM * test.records[""].pulses_of(name).times
        apparent = 2 * np.pi * test.numbers[""][name] / 24 + later - angle
        share = np.sin(np.radians(30) - later)
        assert np.abs(apparent - share * 0.1 / 200 * np.cos(angle)).max() < 1e-11


def test_a_counter_of_1_mhz_at_600_rpm_leaves_0_00104_degrees():
    wheel = replace(WHEEL, teeth=60, tick="1 us")
    motion = SteadyPoints(speeds=["601.37 rpm"], duration="20 s", without=["engine"])
    test = bench({"b": wheel}, motion).turned()
    left = 601.37 * RPM * test.records[""].pulses_of("b").times - 2 * np.pi * test.numbers[""]["b"] / 60
    assert np.degrees(left.std()) == pytest.approx(0.00104, rel=0.02)
    assert test.records[""].pulses_of("b").tick == 1e-6
    assert (left < 1e-12).all()  # rounded down


def test_speeds_of_wheels_reach_to_the_last_pulse_of_any():
    """24 teeth at 10 turns a second pass every 1/240 s: on b for 2 s, on a for one; drawn at 8 Hz."""
    pulses = tuple(PulseChannel(name, np.arange(240 * length + 1) / 240) for name, length in (("b", 2), ("a", 1)))
    channels = {"b": WHEEL, "a": replace(WHEEL, sensor="angle(a)")}
    plan = Plan(motion=STEADY, channels=channels, acquisition=Acquisition(rate="8 Hz"))
    for recorded in (pulses, pulses[::-1]):
        signals = with_wheel_speeds(Recording((), 8.0, pulses=recorded), plan).signals
        assert np.array([signal.values for signal in signals]) == pytest.approx(np.full((2, 17), 20 * np.pi))


def test_the_truth_of_a_bench_with_wheels_is_written_and_read(tmp_path):
    truth = bench({"b": WHEEL, "T": TORQUE}, SteadyPoints(speeds=["600 rpm"], duration="1 s")).truth
    tn.io.write_recording(truth, tmp_path / "truth.npz")
    again = tn.io.read_recording(tmp_path / "truth.npz")
    assert set(again.names) == {"mean_angle", "mean_speed", "b_angle", "T"}
    assert np.abs(again.pulses_of("b").times - truth.pulses_of("b").times).max() < 1e-12
    turned = np.interp(again.pulses_of("b").times[:-1], again.time, again["b_angle"].values)
    assert np.abs(np.diff(turned) - 2 * np.pi / 24).max() < 1e-4


def test_a_wheel_that_turns_back_is_refused():
    rig = shafts(excitations={"engine": {"type": "harmonic", "node": "a", "orders": {0.5: {"amplitude": "9 kN*m"}}}})
    with pytest.raises(UsageError, match="turning-back"):
        bench({"b": WHEEL}, SteadyPoints(speeds=["150 rpm"], duration="4 s"), rig).run()


# Analog channels and clocks


def test_clocks_50_ppm_apart_are_162_degrees_apart_at_order_6_after_60_s_at_1500_rpm():
    channels = {"b": WHEEL, "T": TORQUE, "T2": TORQUE}
    systems = {"telemetry": RecordingSystem(channels=["T2", "b"], drift="50 ppm", offset="0.3 s")}
    test = bench(channels, SteadyPoints(speeds=["1500 rpm"], duration="60 s"), systems=systems).turned()
    first, second = test.records[""], test.records["telemetry"]
    assert (first.names, second.names, first.pulses) == (("T",), ("T2",), ())
    true = test.truths[""].pulses_of("b").times
    late = second.pulses_of("b").times - (true[true >= 0.3] - 0.3)
    assert np.degrees(6 * 1500 * RPM * late[-1]) == pytest.approx(162, rel=0.006)  # of 59.7 s
    at = 0.3 + second.time / (1 + 50e-6)
    assert second["T2"].values[-1] == pytest.approx(100 + sum(
        ((K + 1j * C * order * 1500 * RPM) * np.subtract(*steady_amplitudes(1500 * RPM)[:, place])
         * np.exp(1j * order * 1500 * RPM * at[-1])).real for place, order in enumerate(ORDERS)), abs=1e-6)  # fmt: skip


def test_a_skew_of_0_1_ms_turns_order_6_at_1500_rpm_by_5_4_degrees():
    rig = shafts(excitations={"engine": {"type": "harmonic", "node": "a", "orders": {6: {"amplitude": "50 N*m"}}}})
    found = []
    for delay in ("0 s", "0.1 ms"):
        record = bench({"T": replace(TORQUE, delay=delay)}, rig=rig).run()
        found.append((record["T"].values[400:] * np.exp(-6j * 1500 * RPM * record.time[400:])).mean())
    assert np.degrees(np.angle(found[0] / found[1])) == pytest.approx(5.4, abs=1e-3)


ALL = {"b": replace(WHEEL, teeth=60), "a": ToothedWheel(sensor="angle(a)", teeth=60), "T": TORQUE,
       "T2": StrainGauge(sensor="torque(shaft)", noise="1 N*m")}  # fmt: skip
FAULTS = {
    "missing": ("b", {"missing_pulses": 0.01}),
    "double": ("b", {"double_pulses": 0.01}),
    "jitter": ("b", {"jitter": "2 us"}),
    "tick": ("b", {"tick": "1 us"}),
    "pitch": ("b", {"pitch_errors": {"normal": "2 %"}}),
    "gain": ("T", {"gain": 1.02}),
    "shunt": ("T", {"shunt": {"value": "200 N*m", "duration": "0.5 s", "at": "end"}}),
    "drift": ("T", {"zero_drift": {"change": "30 N*m"}}),
    "creep": ("T", {"creep": {"share": "-5 %", "time": "50 ms"}}),
    "noise": ("T", {"noise": "1 N*m"}),
    "hum": ("T", {"hum": {"amplitude": "5 N*m"}}),
    "drop-outs": ("T2", {"drop_outs": {"rate": "2 Hz", "duration": "20 ms", "reads": "zero"}}),
}


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_changes_its_own_channel_alone_and_by_what_it_says(name):
    channel, entries = FAULTS[name]
    clean = bench(ALL).turned()
    test = bench({**ALL, channel: replace(ALL[channel], **entries)}).turned()
    before, after, faults = clean.records[""], test.records[""], test.faults[""]
    for one in ALL:
        same = (np.array_equal(before[one].values, after[one].values) if one in before.names
                else np.array_equal(before.pulses_of(one).times, after.pulses_of(one).times))  # fmt: skip
        assert same == (one != channel), one
    assert not clean.faults[""]
    if channel == "b":
        old, new = before.pulses_of("b").times, after.pulses_of("b").times
        if name in ("missing", "double"):
            odd = np.setxor1d(old, new)
            assert len(odd) > 20
            assert [fault.kind for fault in faults] == [f"{name} pulse"] * len(odd)
            assert sorted(fault.time for fault in faults) == odd.tolist()
        assert len(test.numbers[""]["b"]) == len(new)
        if name == "double":  # behind their tooth, by 0.1 to 0.4 of a pitch
            behind = odd - old[np.searchsorted(old, odd) - 1]
            assert ((behind > 0.09 * np.diff(old).mean()) & (behind < 0.41 * np.diff(old).mean())).all()
            own = clean.numbers[""]["b"][np.searchsorted(old, new, side="right") - 1]
            assert np.array_equal(test.numbers[""]["b"], own)
        if name == "jitter":
            assert (new - old).std() == pytest.approx(2e-6, rel=0.05)
        return
    change = after[channel].values - before[channel].values
    clock = before.time
    if name == "gain":
        assert np.allclose(change, 0.02 * before["T"].values)
    if name == "shunt":
        assert np.array_equal(change != 0, clock >= 3.5)
        assert np.allclose(change[clock >= 3.5], 200)
        assert [(fault.kind, fault.time, fault.size) for fault in faults] == [("shunt calibration", 3.5, 200)]
    if name == "drift":
        assert np.allclose(change, 30 * clock / clock[-1])
    if name == "creep":  # 0.05 s x' + x = -0.05 T, settled at first
        values = before["T"].values
        _, followed, _ = scipy.signal.lsim(([-0.05], [0.05, 1]), values - values[0], clock - clock[0])
        assert np.allclose(change, followed - 0.05 * values[0], atol=2e-3 * np.abs(values).max())
    if name == "noise":
        assert change.std() == pytest.approx(1, rel=0.05)
    if name == "hum":
        basis = np.exp(2j * np.pi * 50 * clock)
        assert 2 * abs((change * basis).mean()) == pytest.approx(5)
    if name == "drop-outs":
        lost = np.zeros(len(clock), dtype=bool)
        for fault in faults:
            lost |= (clock >= fault.time - 1e-9) & (clock < fault.time + fault.size - 1e-9)
        assert np.array_equal(change != 0, lost)
        assert (after["T2"].values[lost] == 0).all()
        assert len(faults) > 2


def test_the_seed_of_a_run_changes_noise_but_not_the_wheel():
    channels = {"b": replace(WHEEL, jitter="1 us", pitch_errors={"normal": "2 %"}), "T": replace(TORQUE, noise="1 N*m")}
    rig = bench(channels, seed=4)
    first, second, again = rig.turned(), rig.turned(seed=9), rig.turned(seed=4)
    assert np.array_equal(first.patterns["b"].positions, second.patterns["b"].positions)
    assert not np.array_equal(first.records[""]["T"].values, second.records[""]["T"].values)
    assert np.array_equal(first.records[""].pulses_of("b").times, again.records[""].pulses_of("b").times)


def test_warming_up_and_held_telemetry():
    drift = {"change": "30 N*m", "warming": "1 s"}
    lost = {"rate": "1 Hz", "duration": "50 ms"}
    motion = replace(STEADY, without=("engine",))
    record = bench({"T": replace(TORQUE, zero_drift=drift, gain=0)}, motion).run()
    share = (1 - np.exp(-record.time)) / (1 - np.exp(-record.time[-1]))
    assert np.allclose(record["T"].values, 30 * share)
    test = bench({"T": replace(TORQUE, zero_drift=drift, gain=0, drop_outs=lost)}, motion).turned()
    held = test.records[""]["T"].values
    first = next(fault for fault in test.faults[""] if fault.time > 0)
    place = round(first.time * 2000)
    assert (held[place : place + 100] == held[place - 1]).all()


# Plans and their faults


class Doubling:
    """Chance by which every pulse is followed by a second one, as late as may be."""

    def random(self, count):
        return np.zeros(count)

    def uniform(self, *limits):
        _, high, count = limits
        return np.full(count, high)


def test_a_second_pulse_stands_near_its_tooth_also_behind_the_gap():
    """Evenly turning, 1 ms a tooth: the second pulse of a tooth comes before half of the time to the next."""
    numbers = np.delete(np.arange(61), [58, 59])
    counted = counted_pulses(
        "b", 1e-3 * numbers, numbers, ToothedWheel(teeth=60, missing_teeth=2, double_pulses=0.1),
        lambda _: Doubling(), lambda times: times,
    )  # fmt: skip
    assert counted.numbers[-2:].tolist() == [60, 60]
    assert np.diff(counted.channel.times)[::2] == pytest.approx(0.4e-3)


RIG = """\
torsionnet: 1
name: two rotors
elements:
  first: {type: inertia, node: a, inertia: 1}
  shaft: {type: spring, nodes: [a, b], stiffness: 4 kN*m/rad, damping: 6}
  second: {type: inertia, node: b, inertia: 3}
speeds: {of: a, range: 500..1500 rpm, step: 100 rpm}
excitations: {engine: {type: harmonic, node: a, orders: {2: {amplitude: 50 N*m}}}}
bench:
  motion: {type: run-up, start: 600 rpm, stop: 1200 rpm, duration: 5 s}
  channels:
    b: {type: toothed wheel, sensor: angle(b), teeth: 60, missing_teeth: 2}
    b2: {type: toothed wheel, wheel: b, pickup_angle: 114 deg}
    T: {type: strain gauge, sensor: torque(shaft), shunt: {value: 1 kN*m, duration: 1 s}}
  acquisition: {rate: 1 kHz}
  systems: {telemetry: {channels: [T], drift: 50 ppm}}
"""
WRONG = [
    ("stop: 1200 rpm", "stop: 1600 rpm", 10, "out-of-range"),
    ("stop: 1200 rpm", "stop: 500 rpm", 10, "contradicting-values"),
    ("duration: 5 s}", "duration: 5 s, rate: 1 rpm/s}", 10, "contradicting-entries"),
    ("type: run-up", "type: runup", 10, "unknown-word"),
    (
        "duration: 5 s}",
        "duration: 5 s, without: [engin]}",
        10,
        "unknown-name",
    ),
    ("duration: 5 s}", "duration: 500 h}", 15, "too-large"),
    (
        "excitations: {engine: {type: harmonic, node: a, orders: {2: {amplitude: 50 N*m}}}}\n",
        "",
        9,
        "missing-entry",
    ),
    ("sensor: angle(b)", "sensor: angle(ground)", 12, "grounded-node"),
    ("sensor: angle(b)", "sensor: velocity(b)", 12, "unfit-channel"),
    ("missing_teeth: 2", "missing_teeth: 59", 12, "contradicting-values"),
    ("teeth: 60, missing_teeth: 2", "index: true", 12, "missing-entry"),
    ("teeth: 60,", "teeth: 60, pitch_errors: {list: [0.1 deg]},", 12, "wrong-count"),
    ("teeth: 60,", "teeth: 60, radial_vibration: {amplitude: 1 mm, order: 1},", 12, "missing-entry"),
    ("teeth: 60,", "teeth: 60, gearing: 5000,", 12, "too-large"),
    ("wheel: b,", "wheel: T,", 13, "unknown-channel"),
    ("wheel: b,", "wheel: b, teeth: 60,", 13, "needless-entry"),
    ("value: 1 kN*m", "value: 1 kN", 14, "wrong-unit"),
    ("channels: [T]", "channels: [TT]", 16, "unknown-channel"),
    ("  motion: {type: run-up, start: 600 rpm, stop: 1200 rpm, duration: 5 s}\n", "", 9, "missing-entry"),
]


@pytest.mark.parametrize(("good", "bad", "line", "kind"), WRONG)
def test_faults_of_a_bench_that_turns_are_located(good, bad, line, kind):
    assert RIG.count(good) == 1
    with pytest.raises(ModelError) as caught:
        tn.loads(RIG.replace(good, bad), "rig.yaml")
    assert (line, kind) in [(fault.position.line, fault.kind) for fault in caught.value.faults], caught.value


def test_all_faults_of_a_bench_that_turns_at_once(tmp_path):
    text = RIG.replace("stop: 1200 rpm", "stop: 1600 rpm").replace("channels: [T]", "channels: [TT]")
    with pytest.raises(ModelError) as caught:
        tn.loads(text.replace("sensor: angle(b)", "sensor: angle(ground)"), "rig.yaml")
    assert len(caught.value.faults) == 3
    path = tmp_path / "rig.yaml"
    path.write_text(RIG)
    rig = tn.load_bench(path)
    assert list(rig.records()) == ["", "telemetry"]
    with pytest.raises(UsageError, match="wrong-count"):
        rig.run()
    again = Plan.read(rig.plan.to_data())[0]
    assert again == rig.plan


def test_a_bench_that_shakes_takes_no_wheel():
    excitation = tn.signals.LinearChirp(start=1, stop=20, duration=10, amplitude=15)
    with pytest.raises(ModelError, match=r"channels\.b: .*missing-entry"):
        Plan(excitation=excitation, channels={"b": WHEEL}, acquisition=Acquisition(rate="1 kHz"))
    with pytest.raises(ModelError, match="leave one out"):
        Plan(excitation=excitation, motion=STEADY, channels={"b": WHEEL}, acquisition=Acquisition(rate="1 kHz"))


# The library


def test_two_pickups_of_the_library_see_the_pattern_and_the_vibration_of_the_set():
    rig = tn.load_bench("engine_generator_bench")
    short = replace(rig.plan, motion=replace(rig.plan.motion, speeds=(900 * RPM,), duration=2.0))
    test = tn.Bench(rig.drivetrain, short).turned()
    steady = rig.drivetrain.order_response("angle(fly)", speeds=[900 * RPM])
    relative = np.array([float(line.relative) for line in steady.lines])
    start, pattern = np.radians(-30), test.patterns["flywheel"]
    for name, later in (("flywheel", 0.0), ("flywheel_114", np.radians(114))):
        times, teeth = test.records[""].pulses_of(name).times, test.numbers[""][name]
        angle = start + 900 * RPM * times
        vibration = (steady.values[0, :, 0] @ np.exp(1j * np.outer(relative, angle))).real
        place = 2 * np.pi * teeth / 60 + pattern.positions[teeth % 60] + later
        assert np.abs(angle + vibration - place).max() < 900 * RPM * 8e-7  # jitter of 0.1 us and a tick
    # Once per cycle, where the phases of the orders are counted from: the firing top dead centre of cylinder 1.
    camshaft = start + 900 * RPM * test.records[""].pulses_of("camshaft").times
    assert np.abs(np.remainder(camshaft + np.pi, 4 * np.pi) - np.pi).max() < np.radians(1.5)


@pytest.mark.nightly
def test_a_minute_of_run_up_of_the_marine_plant_takes_less_than_a_minute():
    rig = tn.load_bench("marine_run_up")
    begin = time.process_time()
    test = rig.turned()
    assert time.process_time() - begin < 60
    record = test.records[""]
    turns = 60 * (300 + 750) / 2 / 60
    assert len(record.pulses_of("engine_wheel")) == pytest.approx(60 * turns, abs=8)
    assert len(record.pulses_of("propeller_wheel")) == pytest.approx(60 * turns / 4.94, abs=8)
    assert record.duration == pytest.approx(60)
    assert {fault.kind for fault in test.faults[""]} >= {"shunt calibration", "drop-out"}

"""Motion over time with laws that are not straight pieces, exact torques, starts and checks, against closed forms and scipy."""

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.base.errors import SolveError, UsageError
from torsionnet.motion.contact_states import MotionStart
from torsionnet.motion.scenarios.time_history import HistoryPiece, TimeHistory, Wave, constant, straight
from torsionnet.motion.simulation import simulate_torques


def cosine(mean, amplitude, frequency):
    return TimeHistory((HistoryPiece(0.0, mean, 0.0, (Wave(amplitude, 2j * np.pi * frequency),)),))


def crest(values):
    """Largest value of a sampled vibration, on the parabola through the highest sample within and those beside it."""
    place = 1 + int(values[1:-1].argmax())
    before, top, after = values[place - 1 : place + 2]
    return top + (after - before) ** 2 / (8 * (2 * top - before - after))


def single(*elements, inertia=1.0):
    return tn.Drivetrain("single", [tn.Inertia("rotor", node="a", inertia=inertia), *elements])


def test_free_duffing_motion_has_the_period_of_the_elliptic_integral():
    w0, a, A = 2.0, 3.0, 1.7
    W2 = w0**2 + a * A**2
    period = 4 * scipy.special.ellipk(a * A**2 / (2 * W2)) / np.sqrt(W2)
    assert period == pytest.approx(1.95465730046, rel=1e-11)
    rig = single(tn.Spring("s", nodes=("a", "ground"), stiffness=w0**2, cubic=a))
    start = MotionStart(angles={"a": A})
    record = rig.simulate(["velocity(a)", "torque(s)"], {"a": np.zeros(41)}, 4 / period, initial_state=start)
    rates, torques = record["velocity(a)"].values, record["torque(s)"].values
    # through 10 periods: the rate is zero at whole ones, where the acceleration is -(w0^2 A + a A^3)
    late = -rates[40] / (w0**2 * A + a * A**3)
    assert abs(late) < 1e-8 * period
    assert torques[::4] == pytest.approx(np.full(11, w0**2 * A + a * A**3), rel=1e-9)
    assert np.abs(rates[1::4]).min() > 4.0
    assert abs(record.energy.left_over) < 1e-9 * (w0**2 * A**2 / 2 + a * A**4 / 4)


def test_cubic_spring_beside_a_clearance_follows_scipy():
    gap, k, c, cubic = 0.1, 4000.0, 3.0, 5e4
    rig = tn.Drivetrain(
        "two",
        [
            tn.Inertia("one", node="a", inertia=0.2),
            tn.Inertia("two", node="b", inertia=0.3),
            tn.Spring("s", nodes=("a", "ground"), stiffness=100, cubic=cubic),
            tn.Clearance("claw", nodes=("a", "b"), gap=gap, stiffness=k, damping=c),
        ],
    )
    start = MotionStart(speeds={"a": 2.0, "b": -1.0})
    record = rig.simulate(["angle(a)", "angle(b)"], {"a": np.full(101, 1.5)}, 200, initial_state=start)

    def rates(_, y):
        a, b, va, vb = y
        twist, rate = a - b, va - vb
        torque = 0.0
        if abs(twist) > gap / 2:
            side = np.sign(twist)
            torque = side * max(0.0, k * (abs(twist) - gap / 2) + c * rate * side)
        return [va, vb, (1.5 - 100 * a - cubic * a**3 - torque) / 0.2, torque / 0.3]

    found = scipy.integrate.solve_ivp(rates, (0, 0.5), [0, 0, 2.0, -1.0], "DOP853", rtol=1e-10, atol=1e-12, max_step=4e-4,
                      t_eval=np.arange(101) / 200)  # fmt: skip
    assert record["angle(a)"].values == pytest.approx(found.y[0], abs=2e-7)
    assert record["angle(b)"].values == pytest.approx(found.y[1], abs=2e-7)
    assert [event.what for event in record.events][:2] == ["closes", "opens"]
    assert abs(record.energy.left_over) < 1e-9
    assert record.energy.dissipated["claw"] > 0.01


def test_start_up_on_the_curve_of_kloss_follows_lsoda():
    breakdown, slip, load = 400.0, 0.1, 150.0
    J1, J2, k, c = 0.4, 1.1, 5000.0, 2.0
    rig = tn.Drivetrain(
        "start",
        [
            tn.InductionMachine("motor", node="m", inertia=J1, synchronous_speed=np.pi * 50,
                                breakdown_torque=breakdown, breakdown_slip=slip),
            tn.Spring("shaft", nodes=("m", "l"), stiffness=k, damping=c),
            tn.Inertia("load", node="l", inertia=J2),
        ],
    )  # fmt: skip
    n, rate = 401, 200.0
    record = rig.simulate(["velocity(m)", "torque(shaft)"], {"l": np.full(n, -load)}, rate)
    synchronous = 2 * np.pi * 50 / 2

    def rates(_, y):
        a, b, va, vb = y
        s = 1 - va / synchronous
        drive = 2 * breakdown / (s / slip + slip / s) if s else 0.0
        torque = k * (a - b) + c * (va - vb)
        return [va, vb, (drive - torque) / J1, (torque - load) / J2]

    found = scipy.integrate.solve_ivp(rates, (0, (n - 1) / rate), [0, 0, 0, 0], "LSODA", rtol=1e-11, atol=1e-12,
                      t_eval=np.arange(n) / rate)  # fmt: skip
    assert record["velocity(m)"].values == pytest.approx(found.y[2], abs=1e-6)
    torque = k * (found.y[0] - found.y[1]) + c * (found.y[2] - found.y[3])
    assert record["torque(shaft)"].values == pytest.approx(torque, abs=1e-4)
    assert "Runge-Kutta" in " ".join(record.notes)
    assert abs(record.energy.left_over) < 1e-7 * abs(record.energy.dissipated["motor"])


@pytest.mark.parametrize("clearance", [False, True])
def test_sinusoidal_and_decaying_torques_are_exact(clearance):
    k, c, J = 50.0, 0.3, 0.5
    history = TimeHistory((
        HistoryPiece(0.0, 2.0, 1.0, (Wave(3 - 1j, 6j), Wave(1 + 2j, -2 + 20j))),
        HistoryPiece(0.3137, -1.0, 0.0, (Wave(2.0, -5.0),)),
    ))  # fmt: skip
    far = [tn.Clearance("far", nodes=("a", "ground"), gap=100, stiffness=1)] if clearance else []
    rig = single(tn.Spring("s", nodes=("a", "ground"), stiffness=k, damping=c), *far, inertia=J)
    record = rig.simulate("angle(a)", {"a": history}, 40, duration=1.0)
    times = np.arange(41) / 40
    assert record["torque on a"].values == pytest.approx(history.samples(40, 41))
    x = np.zeros(2)
    exact = []
    pieces = [(history.pieces[0], 0.0, 0.3137), (history.pieces[1], 0.3137, 1.0)]
    for piece, begin, end in pieces:
        waves = piece.waves
        size = 4 + 2 * len(waves)
        A = np.zeros((size, size))
        A[0, 1], A[1, 0], A[1, 1] = 1, -k / J, -c / J
        A[1, 2], A[2, 3] = 1 / J, piece.slope
        z0 = [*x, piece.value, 1.0]
        for number, wave in enumerate(waves):
            own = slice(4 + 2 * number, 6 + 2 * number)
            s = complex(wave.exponent)
            A[own, own] = [[s.real, -s.imag], [s.imag, s.real]]
            A[1, own.start] = 1 / J
            z0 += [complex(wave.amplitude).real, complex(wave.amplitude).imag]
        exact += [
            (scipy.linalg.expm(A * (time - begin)) @ z0)[0]
            for time in times
            if begin <= time < end or time == end == 1.0
        ]
        x = (scipy.linalg.expm(A * (end - begin)) @ z0)[:2]
    assert record["angle(a)"].values == pytest.approx(np.array(exact), abs=1e-13)
    assert abs(record.energy.left_over) < 1e-9 * record.energy.supplied


@pytest.mark.slow
def test_dual_mass_flywheel_has_two_motions_at_one_frequency():
    flywheel = tn.Spring("dmf", nodes=("primary", "secondary"), damping=0.5,
                         stages=[{"stiffness": 460, "to": "0.12 rad"}, {"stiffness": 1500}])  # fmt: skip
    rig = tn.Drivetrain(
        "rig",
        [
            tn.Inertia("rotor", node="motor", inertia=0.078),
            tn.Damper("bearing", nodes=("motor", "ground"), damping=0.3),
            tn.Spring("torque_meter", nodes=("motor", "primary"), stiffness=13300, damping=0.1),
            tn.Inertia("flywheel", node="primary", inertia=0.152),
            tn.Damper("support", nodes=("primary", "ground"), damping=0.3),
            flywheel,
            tn.Lock("clamp", node="secondary"),
        ],
    )

    def swing(frequency, start):
        driven = {"motor": cosine(40, 60, frequency)}
        periods = 150
        record = rig.simulate(
            "angle(primary)", driven, 400 * frequency, initial_state=start, duration=periods / frequency
        )
        angle = record["angle(primary)"].values[-600:]
        return crest(angle) + crest(-angle)

    assert swing(10.0, "rest") == pytest.approx(0.7321389, abs=1e-6)
    assert swing(11.0, "rest") == pytest.approx(0.2833270, abs=1e-6)
    assert swing(11.0, MotionStart(angles={"motor": 0.6, "primary": 0.6})) == pytest.approx(1.0509184, abs=1e-6)


def test_start_at_the_operating_point_stands_still():
    rig = tn.Drivetrain(
        "driven",
        [
            tn.Inertia("one", node="a", inertia=0.2),
            tn.Inertia("two", node="b", inertia=0.5),
            tn.Spring("disc", nodes=("a", "b"), stages=[{"stiffness": 400, "to": "0.1 rad"}, {"stiffness": 2000}]),
            tn.Spring("shaft", nodes=("b", "ground"), stiffness=900, damping=1),
            tn.Friction("rub", nodes=("b", "ground"), torque=5),
        ],
    )
    torque = {"a": np.full(101, 70.0)}
    record = rig.simulate(["angle(a)", "torque(disc)"], torque, 100, initial_state="operating_point")
    assert np.ptp(record["angle(a)"].values) < 1e-12
    assert record["torque(disc)"].values == pytest.approx(np.full(101, 70.0), abs=1e-9)
    assert not record.events
    jump = rig.at(torque={"a": "70 N*m"}).simulate("torque(disc)", {"b": np.r_[0.0, np.full(20, 1.0)]}, 1000,
                                                  initial_state="operating_point")  # fmt: skip
    assert jump["torque(disc)"].values[0] == pytest.approx(70, abs=1e-9)  # the mean torque on a goes on acting


def test_start_with_torques_out_of_balance_accelerates_without_vibration():
    rig = tn.Drivetrain(
        "free",
        [
            tn.Inertia("one", node="a", inertia=0.2),
            tn.Inertia("two", node="b", inertia=0.6),
            tn.Spring("disc", nodes=("a", "b"), stages=[{"stiffness": 400, "to": "0.1 rad"}, {"stiffness": 2000}]),
        ],
    )
    record = rig.simulate(
        ["acceleration(b)", "torque(disc)"], {"a": np.full(201, 80.0)}, 100, initial_state="operating_point"
    )
    assert record["acceleration(b)"].values == pytest.approx(np.full(201, 100.0), rel=1e-8)
    assert record["torque(disc)"].values == pytest.approx(np.full(201, 60.0), rel=1e-8)
    assert "steady acceleration" in record.notes[0]


@pytest.mark.parametrize("drop", [0.0, 0.005])
def test_clutch_locks_under_a_rising_clamp_torque(drop):
    J1, J2, rise, slip = 0.25, 1.2, 400.0, 30.0
    rig = tn.Drivetrain(
        "launch",
        [
            tn.Inertia("engine", node="e", inertia=J1),
            tn.Inertia("car", node="v", inertia=J2),
            tn.Clutch(
                "clutch", nodes=("e", "v"), state="slipping", clamp_torque=300, friction=[[0, 1], [100, 1 - 100 * drop]]
            ),
        ],
    )
    scale = {("clutch", "clamp"): straight([(0, 0), (0.5, rise * 0.5)])}
    record = simulate_torques(rig, ["velocity(e)", "velocity(v)"], {"e": np.zeros(401)}, 1000,
                      MotionStart(speeds={"e": slip}), scales=scale)  # fmt: skip
    J = J1 * J2 / (J1 + J2)
    # J w' = -rise t (1 - drop w): w = 1/drop - (1/drop - slip) exp(drop rise t^2/(2 J)), without drop a parabola
    lock = np.sqrt(2 * J / rise * (np.log(1 / (1 - drop * slip)) / drop if drop else slip))
    (stuck,) = [event for event in record.events if event.what == "sticks"]
    assert stuck.time == pytest.approx(lock, rel=1e-9)
    assert record["velocity(e)"].values[-1] == pytest.approx(J1 * slip / (J1 + J2), rel=1e-9)
    assert record.energy.dissipated["clutch"] == pytest.approx(J * slip**2 / 2, rel=1e-9)


def test_runs_at_half_the_step_agree_until_chaos():
    rig = single(tn.Clearance("claw", nodes=("a", "ground"), gap=2, stiffness=1), inertia=1.0)
    start = MotionStart(speeds={"a": 1.3})
    record = rig.simulate("angle(a)", {"a": np.zeros(201)}, 10, initial_state=start, check=True)
    assert "all samples agree" in record.notes[-1]
    smooth = single(tn.Spring("s", nodes=("a", "ground"), stiffness=1, cubic=40), inertia=1.0)
    driven = {"a": cosine(0.0, 0.5, 1.2 / 2 / np.pi)}
    record = smooth.simulate("angle(a)", driven, 2, duration=4.0, initial_state=start, check=True)
    assert "agree to" in record.notes[-1]


def test_bad_requests_are_answered():
    rig = single(tn.Spring("s", nodes=("a", "ground"), stiffness=4, cubic=3))
    with pytest.raises(UsageError, match="give the duration"):
        rig.simulate("angle(a)", {"a": constant(1.0)}, 100)
    with pytest.raises(UsageError, match="starts from"):
        rig.simulate("angle(a)", {"a": np.zeros(3)}, 100, initial_state="rst")
    with pytest.raises(UsageError, match="unknown-node"):
        rig.simulate("angle(a)", {"a": np.zeros(3)}, 100, initial_state=MotionStart(angles={"b": 1.0}))
    with pytest.raises(UsageError, match="3 and 101 samples"):
        rig.simulate("angle(a)", {"a": np.zeros(3)}, 100, duration=1.0)
    loose = tn.Drivetrain("loose", [
        tn.Inertia("rotor", node="a", inertia=1), tn.Spring("stiff", nodes=("a", "m"), stiffness=100),
        tn.Spring("s", nodes=("m", "ground"), stiffness=4, cubic=3),
    ])  # fmt: skip
    with pytest.raises(UsageError, match="indeterminate-motion"):
        loose.simulate("angle(a)", {"a": np.zeros(3)}, 100)
    ends = single(tn.Spring("s", nodes=("a", "ground"), torque_over_twist=[[0, 0], [0.1, 5]]))
    with pytest.raises(SolveError, match=r"s: .*rows end"):
        ends.simulate("angle(a)", {"a": straight([(0, 0), (1, 500)])}, 100, duration=1.0)


def test_a_motion_of_too_many_steps_is_refused_as_soon_as_its_steps_become_short(monkeypatch):
    """A hardening spring vibrates at 10 rad/s until its torque rises after 1 s; it takes some 520 steps for 2 s."""
    monkeypatch.setattr("torsionnet.motion.smooth_system.STEPS_BETWEEN_REPORTS", 20)
    rig = single(tn.Spring("s", nodes=("a", "ground"), stiffness=100, cubic=1e4))
    driven, start = {"a": straight([(0, 0), (1, 0), (1.2, 2000), (2, 2000)])}, MotionStart(angles={"a": 0.01})
    monkeypatch.setattr("torsionnet.motion.smooth_system.MOST_STEPS", 400)
    with pytest.raises(SolveError, match="no-solution"):
        rig.simulate("angle(a)", driven, 100, duration=2.0, initial_state=start)
    monkeypatch.setattr("torsionnet.motion.smooth_system.MOST_STEPS", 700)
    rig.simulate("angle(a)", driven, 100, duration=2.0, initial_state=start)


def launched(torque, disc=1.2, shaft=0.0):
    """A clutch that closes from no clamp within half a second, with friction that falls with the slip."""
    elements = [
        tn.Inertia("engine", node="a", inertia=0.25),
        tn.Clutch("clutch", nodes=("a", "b"), state="slipping", clamp_torque=300, friction=[[0, 0.36], [62.8, 0.32]]),
        tn.Inertia("disc", node="b", inertia=disc),
        tn.Spring("shaft", nodes=("b", "c"), stiffness=shaft, damping=0.5 * (shaft > 0)),
        tn.Inertia("car", node="c", inertia=2),
    ]
    rig = tn.Drivetrain("launch", elements, sensors={"slip": {"velocity": ["a", "b"]}})
    clamp = {"clamp": {"0 s": 0, "0.5 s": 300}}
    scenario = {"type": "torques", "duration": 2, "rate": 1000, "torque": {"a": torque}, "clutch": clamp}
    return rig.simulate(scenario=scenario)


@pytest.mark.parametrize(("disc", "shaft"), [(1.2, 0.0), (0.02, 300.0)])
def test_a_clutch_that_closes_on_falling_friction_sticks_where_its_equation_says(disc, shaft):
    """The Runge-Kutta method ends at the slip zero, beyond which the friction jumps to the other side."""

    def rates(t, y):
        engine, hub, car, twist = y
        friction = min(600 * t, 300) * (0.36 - 0.04 / 62.8 * (engine - hub))
        drive = shaft * twist + 0.5 * (shaft > 0) * (hub - car)
        return [(80 - friction) / 0.25, (friction - drive) / disc, drive / 2, hub - car]

    def still(t, y):  # slips from the start
        return y[0] - y[1] - (1 if t < 0.05 else 0)

    still.terminal, still.direction = True, -1
    expected = scipy.integrate.solve_ivp(rates, (0, 2), [0.0] * 4, "DOP853", rtol=1e-12, atol=1e-12, events=still, dense_output=True,
                         max_step=0.01)  # fmt: skip
    record = launched({"0 s": 80, "2 s": 80}, disc, shaft)
    sticks = next(event for event in record.events if event.time > 0 and event.what == "sticks")
    assert sticks.time == pytest.approx(expected.t_events[0][0], rel=1e-8)
    engine, hub, *_ = expected.sol(np.arange(50, 500) / 1000)
    np.testing.assert_allclose(record["slip"].values[50:500], engine - hub, rtol=1e-8)


def test_a_clutch_whose_clamp_outruns_the_torque_never_slips():
    """The friction allows 216 N m/s and the car needs 1.2/1.45 of 200 N m/s, from zero on."""
    record = launched({"0 s": 0, "0.5 s": 100})
    assert np.abs(record["slip"].values).max() < 1e-12
    record = launched({"0 s": 0, "0.5 s": 150, "0.6 s": 20})  # 248 N m/s
    assert record["slip"].values[400] > 1


def test_a_blow_after_rest_on_a_spring_that_hardens():
    """The first step after a rest is as long as the rest, far beyond what floats hold: a shorter one follows."""
    plant = tn.Drivetrain(
        "blow", [tn.Inertia("J", node="a", inertia=1), tn.Spring("s", nodes=("a", "ground"), stiffness=1, cubic=1e4)]
    )
    torque = {"0 s": 0, "1 s": 0, "1.000000001 s": 100}
    angle = plant.simulate(
        "angle(a)", scenario={"type": "torques", "duration": 3, "torque": {"a": torque}}, sampling_rate=50.0
    )["angle(a)"].values
    # Energy: at the turning point 100 a = a^2/2 + 1e4 a^4/4.
    greatest = max(np.roots([2500, 0, 0.5, -100]).real)
    assert np.abs(angle[:51]).max() == 0
    assert 0.99 * greatest < angle.max() <= greatest * (1 + 1e-9)

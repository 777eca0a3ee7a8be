"""Motions over time with lags, sensed speeds, stiff plants and jumps against closed forms and scipy; energies and requests."""

import numpy as np
import pytest
import scipy
from support import campaigns
from support.random_motion_plants import moving_plant

import torsionnet as tn
from torsionnet.base.errors import SolveError, UsageError
from torsionnet.motion.contact_states import MotionStart
from torsionnet.motion.scenarios.time_history import HistoryPiece, TimeHistory, constant
from torsionnet.motion.smooth_system import SmoothMethod


def motor(**entries):
    return tn.InductionMachine("motor", node="m", inertia=0.4, synchronous_speed=100 * np.pi / 2, breakdown_torque=400,
                               breakdown_slip=0.1, **entries)  # fmt: skip


def kloss(speed):
    s = 1 - speed / (100 * np.pi / 2)
    return 2 * 400 * 0.1 * s / (s**2 + 0.1**2)


@pytest.mark.parametrize("start", ["rest", "moving"])
def test_torque_of_an_induction_machine_follows_its_curve_with_the_time_constant(start):
    tau, load, n, rate = 0.03, 60.0, 41, 100.0
    rig = tn.Drivetrain("start", [motor(time_constant=tau)])
    begins = MotionStart(speeds={"m": 140.0}) if start == "moving" else "rest"
    record = rig.simulate(["velocity(m)", "acceleration(m)"], {"m": np.full(n, -load)}, rate, initial_state=begins)

    def rates(_, y):
        speed, torque = y
        return [(torque - load) / 0.4, (kloss(speed) - torque) / tau]

    first = [140.0, kloss(140.0)] if start == "moving" else [0.0, 0.0]
    exact = scipy.integrate.solve_ivp(rates, (0, (n - 1) / rate), first, "DOP853", rtol=1e-11, atol=1e-9,
                      t_eval=np.arange(n) / rate).y  # fmt: skip
    assert record["velocity(m)"].values == pytest.approx(exact[0], abs=1e-7)
    assert record["acceleration(m)"].values == pytest.approx((exact[1] - load) / 0.4, abs=1e-6)
    text = "from zero at the first sample" if start == "rest" else "from that of its speed"
    assert any(text in note and "motor with 0.03 s" in note for note in record.notes)
    assert abs(record.energy.left_over) < 1e-8 * abs(record.energy.stored)


def test_lagging_machine_at_its_operating_point_stands_still_and_swings_as_its_tangent():
    rig = tn.Drivetrain("loaded", [motor(time_constant=0.03)]).at(torque={"m": "-240 N*m"})
    torque = np.full(81, -240.0)
    steady = rig.simulate("velocity(m)", {"m": torque}, 200, initial_state="operating_point")["velocity(m)"].values
    assert steady == pytest.approx(np.full(81, (1 - 0.1 / 3) * 50 * np.pi), rel=1e-10)
    torque[1:] -= 0.01
    moved = (
        rig.simulate("velocity(m)", {"m": torque}, 200, initial_state="operating_point")["velocity(m)"].values - steady
    )
    small = -0.01 * np.ones(81)
    small[0] = 0.0
    # J w'' tau + J w' + c w = f + tau f': the slope c of Kloss at s_k/3
    s, sk = 0.1 / 3, 0.1
    c = 2 * 400 * sk * (sk**2 - s**2) / (50 * np.pi * (s**2 + sk**2) ** 2)

    def rates(t, y):
        return [(np.interp(t, np.arange(81) / 200, small) + y[1]) / 0.4, (-c * y[0] - y[1]) / 0.03]

    exact = scipy.integrate.solve_ivp(rates, (0, 0.4), [0.0, 0.0], "RK45", rtol=1e-8, atol=1e-12, max_step=0.0025,
                      t_eval=np.arange(81) / 200).y[0]  # fmt: skip
    assert moved == pytest.approx(exact, abs=2e-3 * np.abs(exact).max())


def test_propeller_and_load_of_constant_power_follow_their_closed_forms():
    torque, inertia, speed = 500.0, 3.0, 40.0
    screw = tn.Propeller("screw", node="p", inertia=inertia, exponent=2, torque=200, speed=20)
    record = tn.Drivetrain("boat", [screw]).simulate(
        "velocity(p)", {"p": np.full(31, torque)}, 20, initial_state=MotionStart()
    )
    steady = 20 * np.sqrt(torque / 200)
    times = np.arange(31) / 20
    exact = steady * np.tanh(torque * times / (inertia * steady))
    assert record["velocity(p)"].values == pytest.approx(exact, rel=1e-10, abs=1e-12)
    long = tn.Drivetrain("boat", [screw]).simulate(
        "velocity(p)", {"p": np.full(2, torque)}, 0.2, initial_state=MotionStart()
    )
    assert long["velocity(p)"].values[-1] == pytest.approx(steady, rel=1e-9)
    linear = tn.Drivetrain("boat", [screw]).simulate("velocity(p)", {"p": np.full(2, torque)}, 0.2)
    assert linear["velocity(p)"].values[-1] == pytest.approx(500 / (2 * 200 / 20), rel=1e-6)
    assert any("linear about the working point in its entries: screw" in note for note in linear.notes)
    taken = tn.ConstantPowerLoad("load", node="p", power=2e3)
    rig = tn.Drivetrain("drawn", [tn.Inertia("rotor", node="p", inertia=inertia), taken])
    record = rig.simulate("velocity(p)", {"p": np.zeros(11)}, 20, initial_state=MotionStart(speeds={"p": speed}))
    assert record["velocity(p)"].values == pytest.approx(np.sqrt(speed**2 - 4e3 / inertia * times[:11]), rel=1e-10)
    assert record.energy.dissipated["load"] == pytest.approx(2e3 * 0.5, rel=1e-10)


@pytest.mark.parametrize("ratio", [1.0, 2.0])
def test_fluid_coupling_and_converter_of_constant_capacity_follow_their_closed_form(ratio):
    torque, pump, turbine, capacity = 300.0, 0.5, 9.0, 900 / 150**2
    rows = {"test_speed": 150, "pump_torque": [[0, 900], [1, 900]]}
    if ratio == 1.0:
        passing = tn.FluidCoupling("fluid", pump="p", turbine="t", **rows)
    else:
        passing = tn.TorqueConverter("fluid", pump="p", turbine="t", torque_ratio=[[0, ratio], [1, ratio]], **rows)
    masses = [tn.Inertia("engine", node="p", inertia=pump), tn.Inertia("car", node="t", inertia=turbine)]
    record = tn.Drivetrain("launch", [passing, *masses]).simulate(
        ["velocity(p)", "velocity(t)", "acceleration(t)"], {"p": np.full(21, torque)}, 40
    )
    times = np.arange(21) / 40
    steady = np.sqrt(torque / capacity)
    speed = steady * np.tanh(torque * times / (pump * steady))
    assert record["velocity(p)"].values == pytest.approx(speed, rel=1e-9, abs=1e-10)
    passed = ratio * (torque * times - pump * speed) / turbine
    assert record["velocity(t)"].values == pytest.approx(passed, rel=1e-9, abs=1e-10)
    assert record["acceleration(t)"].values == pytest.approx(ratio * capacity * speed**2 / turbine, rel=1e-9, abs=1e-9)
    assert abs(record.energy.left_over) < 1e-9 * record.energy.supplied


def test_long_run_over_a_fluid_coupling_ends_at_its_operating_point():
    fluid = tn.FluidCoupling("fluid", pump="p", turbine="t", test_speed=150, pump_torque=[[0, 900], [0.9, 300], [1, 0]])
    screw = tn.Propeller("screw", node="t", inertia=1.5, exponent=2, torque=200, speed=100)
    rig = tn.Drivetrain("drive", [fluid, tn.Inertia("engine", node="p", inertia=0.5), screw])
    record = rig.simulate(["velocity(p)", "velocity(t)"], {"p": np.full(2, 220.0)}, 1 / 12)
    turbine = 100 * np.sqrt(220 / 200)
    # on the first row the pump takes (900 - 6000/9 nu) (w/150)^2
    pump = max(np.roots([900, -6000 / 9 * turbine, -220.0 * 150**2]).real)
    assert turbine / pump < 0.9
    assert record["velocity(t)"].values[-1] == pytest.approx(turbine, rel=1e-8)
    assert record["velocity(p)"].values[-1] == pytest.approx(pump, rel=1e-8)


def test_stiff_motion_takes_the_implicit_method_and_follows_lsoda(monkeypatch):
    used = []
    look = SmoothMethod._look

    def seen(self, *given):
        look(self, *given)
        used.append(self.stiff)

    monkeypatch.setattr(SmoothMethod, "_look", seen)
    rig = tn.Drivetrain(
        "stiff",
        [
            tn.Inertia("one", node="a", inertia=1.0),
            tn.Inertia("small", node="b", inertia=1e-4),
            tn.Damper("film", nodes=("a", "b"), damping=1.0),
            tn.Spring("s", nodes=("a", "ground"), stiffness=4.0, cubic=3.0),
        ],
    )
    record = rig.simulate("angle(a)", {"b": np.full(6, 2.0)}, 100, initial_state=MotionStart(angles={"a": 0.5}))

    def rates(_, y):
        a, va, vb = y
        film = va - vb
        return [va, -film - 4 * a - 3 * a**3, (2 + film) / 1e-4]

    exact = scipy.integrate.solve_ivp(
        rates, (0, 0.05), [0.5, 0, 0], "LSODA", rtol=1e-11, atol=1e-13, t_eval=np.arange(6) / 100
    ).y[0]
    assert any(used)
    assert record["angle(a)"].values == pytest.approx(exact, abs=1e-8)
    assert abs(record.energy.left_over) < 1e-8 * record.energy.supplied


@pytest.mark.parametrize("cubic", [0.0, 40.0])
def test_spring_behind_friction_gives_heat_where_friction_lets_go(cubic):
    """A massless slider that sticks at 30 N m and slips at 20 N m loses (30^2 - 20^2)/(2 k) at once."""
    k, speed = 800.0, 5.0
    elements = [
        tn.Inertia("big", node="a", inertia=1e6),
        tn.Friction("rub", nodes=("a", "ground"), torque=20, stick=30, stiffness=k),
    ]
    if cubic:
        elements += [
            tn.Inertia("far", node="b", inertia=1),
            tn.Spring("s", nodes=("a", "b"), stiffness=1, cubic=cubic),
        ]
    rig = tn.Drivetrain("belt", elements)
    record = rig.simulate("angle(a)", {"a": np.zeros(11)}, 100, initial_state=MotionStart(speeds={"a": speed}))
    slid = speed * 0.1 - 20 / k
    assert [event.what for event in record.events] == ["slips"]
    assert record.energy.dissipated["rub"] == pytest.approx(20 * slid + (30 - 20) ** 2 / (2 * k), rel=3e-6)
    assert abs(record.energy.left_over) < 1e-9 * record.energy.dissipated["rub"]


@pytest.mark.parametrize("law", ["clearance", "cubic"])
def test_torque_that_jumps_on_a_node_without_inertia_does_work_at_once(law):
    more = {"clearance": tn.Clearance("far", nodes=("a", "ground"), gap=100, stiffness=1),
            "cubic": tn.Spring("far", nodes=("a", "ground"), stiffness=3.0, cubic=2.0)}[law]  # fmt: skip
    rig = tn.Drivetrain(
        "shaft end",
        [tn.Inertia("rotor", node="a", inertia=0.5), tn.Spring("end", nodes=("a", "e"), stiffness=50), more],
    )
    jumps = TimeHistory((HistoryPiece(0.0, 0.0), HistoryPiece(0.103, 7.0), HistoryPiece(0.25, -2.0)))
    record = rig.simulate(["torque(end)", "acceleration(a)"], {"e": jumps}, 20, duration=0.4)
    assert record["torque(end)"].values == pytest.approx([0, 0, 0, -7, -7, 2, 2, 2, 2], abs=1e-9)
    assert record["acceleration(a)"].values[:4] == pytest.approx([0, 0, 0, 14], abs=1.0)
    assert abs(record.energy.left_over) < 1e-9 * abs(record.energy.supplied)


def test_preload_that_catches_a_row_takes_the_energy_of_its_motion():
    spring = tn.Spring("s", nodes=("a", "ground"), stages=[{"stiffness": 100, "preload": "50 N*m"}], damping=5)
    rig = tn.Drivetrain("caught", [tn.Inertia("rotor", node="a", inertia=1.0), spring])
    record = rig.simulate("angle(a)", {"a": np.full(101, 1.0)}, 100, initial_state=MotionStart(speeds={"a": 0.4}))
    assert record.events[-1].what == "stands"
    assert abs(record.energy.left_over) < 1e-9 * 0.08
    assert record.energy.dissipated["s"] == pytest.approx(0.08, rel=1e-6)


def test_samples_need_not_divide_the_duration():
    rig = tn.Drivetrain("free", [tn.Inertia("rotor", node="a", inertia=2.0),
                                 tn.Friction("rub", nodes=("a", "ground"), torque=1)])  # fmt: skip
    record = rig.simulate("velocity(a)", {"a": constant(5.0)}, 3, duration=1.1)
    assert record["velocity(a)"].values == pytest.approx(np.arange(4) / 3 * 2, rel=1e-12)


def test_requests_that_no_motion_answers_are_refused():
    plain = tn.Drivetrain("plain", [tn.Inertia("rotor", node="a", inertia=2.0)])
    rubbing = tn.Drivetrain("rubbing", [tn.Inertia("rotor", node="a", inertia=2.0),
                                        tn.Friction("rub", nodes=("a", "ground"), torque=1)])  # fmt: skip
    for rig in (plain, rubbing):
        for rate in (0, -1.0, float("nan"), 1e300, "10"):
            with pytest.raises(UsageError, match="out-of-range"):
                rig.simulate("angle(a)", {"a": np.zeros(3)}, rate)
        for duration in (-1.0, float("nan"), float("inf"), "2 s"):
            with pytest.raises(UsageError, match="out-of-range"):
                rig.simulate("angle(a)", {"a": constant(1.0)}, 10, duration=duration)
        with pytest.raises(UsageError, match="more than 20000000 samples"):
            rig.simulate("angle(a)", {"a": constant(1.0)}, 1e6, duration=1e6)
        with pytest.raises(UsageError, match="3 and 101 samples"):
            rig.simulate("angle(a)", {"a": np.zeros(3)}, 100, duration=1.0)
        with pytest.raises(UsageError, match="starts from"):
            rig.simulate("angle(a)", {"a": np.zeros(3)}, 100, initial_state={"a": 1.0})
        with pytest.raises(UsageError, match="not-finite"):
            rig.simulate("angle(a)", {"a": np.zeros(3)}, 100, initial_state=MotionStart(angles={"a": float("nan")}))
        one = rig.simulate("angle(a)", {"a": constant(1.0)}, 10, duration=0)
        assert one["angle(a)"].values.tolist() == [0.0]


def test_generator_on_a_grid_is_noted_as_linear_in_time():
    generator = tn.GridGenerator("gen", node="a", rated_power="1 MW", speed="1500 rpm", grid_frequency="50 Hz",
                                 inertia_constant="2 s", emf=1.2, grid_voltage=1, reactance=0.5, power=0.8)  # fmt: skip
    rig = tn.Drivetrain("set", [generator, tn.Friction("rub", nodes=("a", "ground"), torque=1)])
    record = rig.simulate("angle(a)", {"a": np.zeros(3)}, 100)
    assert "linear about the working point in its entries: gen" in record.notes


def test_operating_point_without_torque_on_a_loaded_model_starts_unloaded():
    spring = tn.Spring("s", nodes=("a", "ground"), stages=[{"stiffness": 400, "to": "0.1 rad"}, {"stiffness": 2000}])
    rig = tn.Drivetrain("held", [tn.Inertia("rotor", node="a", inertia=2.0), spring]).at(torque={"a": "70 N*m"})
    record = rig.simulate("angle(a)", {"a": np.zeros(11)}, 100, initial_state="operating_point")
    assert np.abs(record["angle(a)"].values).max() < 1e-12


def test_integrators_start_from_zero_and_say_so():
    rig = tn.Drivetrain(
        "governed",
        [
            tn.Inertia("rotor", node="a", inertia=2.0),
            tn.Friction("rub", nodes=("a", "ground"), torque=1),
            tn.Controller("governor", sense={"angle": "a"}, act="a", law={"i": -1}),
        ],
    )
    record = rig.simulate("angle(a)", {"a": np.full(11, 0.5)}, 100, initial_state="operating_point")
    assert "the integrators of governor start from zero" in record.notes[0]
    assert np.abs(record["angle(a)"].values).max() < 1e-12


@pytest.mark.parametrize("law", ["friction", pytest.param("softening", marks=pytest.mark.nightly)])
def test_motion_that_grows_beyond_all_numbers_is_told(law):
    more = {"friction": tn.Friction("rub", nodes=("a", "ground"), torque=1),
            "softening": tn.Spring("soft", nodes=("a", "ground"), stiffness=1, cubic=-50)}[law]  # fmt: skip
    driven = [tn.Controller("feed", sense={"velocity": "a"}, act="a", law=900)] if law == "friction" else []
    rig = tn.Drivetrain("unstable", [tn.Inertia("rotor", node="a", inertia=1.0), more, *driven])
    with pytest.raises(SolveError, match=r"beyond all numbers|cannot be"):
        rig.simulate("angle(a)", {"a": np.full(11, 20.0)}, 5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", campaigns.by_day(range(10), 2, 5, 8))
def test_energies_of_random_plants_balance(seed):
    plant = moving_plant(seed, 6)
    times = np.linspace(0, 0.5, 501)
    record = plant.drivetrain.simulate(
        "angle(n0)", plant.samples(times), 1000.0, initial_state=MotionStart(speeds=plant.speeds)
    )
    balance = record.energy
    size = abs(balance.supplied) + abs(balance.stored) + sum(map(abs, balance.dissipated.values()))
    assert abs(balance.left_over) < 1e-9 * size
    assert min(balance.dissipated.values()) > -1e-9 * size


def test_lists_and_histories_act_together_as_on_a_linear_plant():
    masses = [tn.Inertia("one", node="a", inertia=0.5), tn.Inertia("two", node="b", inertia=0.8)]
    shaft = [
        tn.Spring("s", nodes=("a", "b"), stiffness=300, damping=0.4),
        tn.Damper("d", nodes=("b", "ground"), damping=1),
    ]
    far = tn.Clearance("far", nodes=("a", "b"), gap=100, stiffness=1)
    rough = np.random.default_rng(1).normal(size=61)
    ramp = TimeHistory((HistoryPiece(0.0, 1.0, 4.0), HistoryPiece(0.4, 2.6, -3.0)))
    wanted = ["angle(a)", "torque(s)", "twist(s)", "acceleration(b)"]
    linear = tn.Drivetrain("linear", [*masses, *shaft]).simulate(wanted, {"a": rough, "b": ramp.samples(50, 61)}, 50)
    for law in (far, tn.Spring("far", nodes=("a", "b"), stiffness=0, cubic="1e-12 N*m/rad^3")):
        record = tn.Drivetrain("both", [*masses, *shaft, law]).simulate(wanted, {"a": rough, "b": ramp}, 50)
        for name in wanted:
            values = linear[name].values
            assert record[name].values == pytest.approx(values, abs=1e-8 * np.abs(values).max())


def test_spring_that_starts_beyond_what_its_friction_holds_lets_go_at_once():
    """The slider slips and sticks again at the first moment; what the spring held beyond its friction is heat."""
    rub = tn.Friction("rub", nodes=("a", "ground"), torque=20, stick=30, stiffness=800)
    rig = tn.Drivetrain("wound", [tn.Inertia("rotor", node="a", inertia=2.0), rub])
    record = rig.simulate("angle(a)", {"a": np.zeros(21)}, 200, initial_state=MotionStart(angles={"a": 0.1}))
    assert [event.what for event in record.events[:2]] == ["slips", "sticks"]
    assert record.energy.stored + record.energy.dissipated["rub"] == pytest.approx(0, abs=1e-11)
    assert record.energy.dissipated["rub"] == pytest.approx((80**2 - 20**2) / 1600, rel=0.02)


@pytest.mark.parametrize("speed", [1.6, -3.0])
def test_friction_behind_a_spring_leaves_the_speeds_given_at_the_start(speed):
    """A slider without inertia between two rotors may stick at the first moment; it must not pull a rotor along."""
    rub = tn.Friction("rub", nodes=("a", "b"), torque=60, stick=90, stiffness=100)
    masses = [tn.Inertia("one", node="a", inertia=0.5), tn.Inertia("two", node="b", inertia=7.5)]
    rig = tn.Drivetrain("rotors", [*masses, rub])
    speeds = {"a": 14.0, "b": speed}
    record = rig.simulate(
        ["velocity(a)", "velocity(b)"], {"a": np.zeros(21)}, 2000, initial_state=MotionStart(speeds=speeds)
    )
    one, two = record["velocity(a)"].values, record["velocity(b)"].values
    assert (one[0], two[0]) == pytest.approx((14.0, speed))
    assert 0.5 * one + 7.5 * two == pytest.approx(np.full(21, 0.5 * 14 + 7.5 * speed), rel=1e-12)
    assert abs(record.energy.left_over) < 1e-9

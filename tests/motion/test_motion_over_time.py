"""Motion over time with clearances, stages and friction, against closed forms and an integrator with tight tolerances."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
import scipy
from support.controlled_plants import Plant

import torsionnet as tn
from torsionnet.base.errors import SolveError, UsageError
from torsionnet.model.element_base.laws import MotionLaw, Part, Values, WholePart, difference
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope
from torsionnet.motion.contact_states import MotionStart


@dataclass(frozen=True, eq=False, repr=False)
class Curved(tn.Spring):
    """Spring whose torque follows a curve that a test has made."""

    @property
    def has_motion_laws(self) -> bool:
        return True

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        del value
        return (MotionLaw(difference(*self.nodes), CURVES[self.name]),)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self.tangent_parts(value)


CURVES: dict[str, PieceCurve] = {}


def curved(name: str, nodes: tuple[str, str], curve: PieceCurve) -> Curved:
    CURVES[name] = curve
    return Curved(name, nodes=nodes, stiffness=1)


def rotor(inertia: float, *elements: tn.model.elements.Element) -> tn.Drivetrain:
    return tn.Drivetrain("rotor", [tn.Inertia("J", node="a", inertia=inertia), *elements])


J, K = 0.3, 2000.0


def test_free_rotor_in_a_clearance_has_the_period_of_flights_and_contacts():
    b, v = 0.05, 1.7
    plant = rotor(J, tn.Clearance("gap", nodes=("a", "ground"), gap=2 * b, stiffness=K))
    period = 4 * b / v + 2 * math.pi * math.sqrt(J / K)
    record = plant.simulate(
        ["a", "torque(gap)"], {"a": np.zeros(2000)}, 100.0, initial_state=MotionStart(speeds={"a": v})
    )
    closings = [event.time for event in record.events if event.what == "closes"]
    assert len(closings) > 200
    assert np.diff(closings[::2]) == pytest.approx(period, abs=1e-11)
    twist, torque = record["a"].values, record["torque(gap)"].values
    assert torque == pytest.approx(np.sign(twist) * K * np.maximum(np.abs(twist) - b, 0), abs=1e-9)


@pytest.mark.slow
def test_free_rotor_in_a_clearance_keeps_its_energy_for_a_thousand_periods():
    b, v = 0.05, 1.7
    plant = rotor(J, tn.Clearance("gap", nodes=("a", "ground"), gap=2 * b, stiffness=K))
    period = 4 * b / v + 2 * math.pi * math.sqrt(J / K)
    n = int(1000 * period * 20)
    record = plant.simulate("a", {"a": np.zeros(n)}, 20.0, initial_state=MotionStart(speeds={"a": v}))
    closings = [event.time for event in record.events if event.what == "closes"]
    assert (closings[-1] - closings[1]) / (len(closings) - 2) * 2 == pytest.approx(period, abs=1e-11)
    assert abs(record.energy.stored) < 1e-9 * J * v**2 / 2


def test_dry_friction_takes_four_torques_over_stiffness_a_cycle_and_stops():
    torque, start = 3.0, 0.05
    friction = tn.Friction("rub", nodes=("a", "ground"), torque=torque)
    plant = rotor(J, tn.Spring("spring", nodes=("a", "ground"), stiffness=K), friction)
    record = plant.simulate(
        ["a", "torque(rub)"], {"a": np.zeros(1000)}, 1000.0, initial_state=MotionStart(angles={"a": start})
    )
    half = math.pi * math.sqrt(J / K)
    turns = [event.time for event in record.events[1:]]
    assert turns == pytest.approx(half * np.arange(1, 18), abs=1e-12)
    assert [event.what for event in record.events] == ["slips", *16 * ["reverses"], "sticks"]
    end = start - 17 * 2 * torque / K
    assert record["a"].values[-1] == pytest.approx(-end, abs=1e-13)
    assert abs(end) <= torque / K
    assert record["torque(rub)"].values[-1] == pytest.approx(K * end, abs=1e-10)
    lost = K * (start**2 - end**2) / 2
    assert record.energy.dissipated["rub"] == pytest.approx(lost, rel=1e-12)
    assert abs(record.energy.left_over) < 1e-11 * lost


@pytest.mark.parametrize(
    ("driving", "braking", "time", "lost"), [(0.0, 0.0, 0.2873563, 6465.517), (60.0, 20.0, 0.4076087, 9171.196)]
)
def test_clutch_locks_when_the_slip_is_gone_and_the_torque_is_less_than_it_holds(driving, braking, time, lost):
    elements = [tn.Inertia("motor", node="a", inertia=0.25), tn.Inertia("load", node="b", inertia=1.2)]
    plant = tn.Drivetrain("clutch", [*elements, tn.Friction("clutch", nodes=("a", "b"), torque=180)])
    inputs = {"a": np.full(501, driving), "b": np.full(501, -braking)}
    record = plant.simulate(
        ["torque(clutch)", "velocity(b)"], inputs, 1000.0, initial_state=MotionStart(speeds={"a": 250})
    )
    (event,) = record.events
    assert (event.element, event.what) == ("clutch", "sticks")
    slowing = (180 - driving) / 0.25 + (180 - braking) / 1.2
    assert event.time == pytest.approx(250 / slowing, abs=1e-13)
    assert event.time == pytest.approx(time, abs=5e-8)
    assert record.energy.dissipated["clutch"] == pytest.approx(180 * 250 / 2 * event.time, rel=1e-12)
    assert record.energy.dissipated["clutch"] == pytest.approx(lost, abs=5e-4)
    both = (driving - braking) / 1.45
    assert record["torque(clutch)"].values[-1] == pytest.approx(driving - 0.25 * both, abs=1e-9)


@pytest.mark.parametrize("imposed", [True, False])
def test_stick_slip_over_a_moving_face(imposed):
    inertia, stiffness, slides, sticks, speed = 0.2, 800.0, 20.0, 30.0, 0.5
    spring = tn.Spring("spring", nodes=("a", "ground"), stiffness=stiffness)
    start = MotionStart(speeds={"a": speed})
    if imposed:  # a step of the curve at the speed of the face
        curve = PieceCurve(
            "rate", (Slope(-slides, upper=speed), Hold(speed, -sticks, sticks), Slope(slides, lower=speed))
        )
        plant = rotor(inertia, spring, curved("face", ("a", "ground"), curve))
    else:
        face = [
            tn.Inertia("wheel", node="f", inertia=1e12),
            tn.Friction("face", nodes=("a", "f"), torque=slides, stick=sticks),
        ]
        plant = rotor(inertia, spring, *face)
        start = MotionStart(speeds={"a": speed, "f": speed})
    record = plant.simulate("a", {"a": np.zeros(20001)}, 20e3, initial_state=start)
    sticking = [event.time for event in record.events if event.what == "sticks"]
    omega, step = math.sqrt(stiffness / inertia), (sticks - slides) / stiffness
    amplitude = math.hypot(step, speed / omega)
    period = (math.pi + 2 * math.atan2(speed / omega, step)) / omega + 2 * step / speed
    assert amplitude == pytest.approx(0.0147901995, abs=5e-11)
    assert period == pytest.approx(0.1175063735, abs=5e-11)
    assert np.diff(sticking)[1:] == pytest.approx(period, abs=1e-11)


@pytest.mark.parametrize(
    ("start", "speed", "low", "high"), [(1.1, 0.0, 1.0132279, 1.1867721), (0.8, 0.3, 0.7615701, 1.3330093)]
)
def test_gear_pair_has_two_motions(start, speed, low, high):
    period = 2 * math.pi / 0.8
    t = np.arange(0, 60 * period, period / 800)
    mesh = tn.Clearance("mesh", nodes=("a", "ground"), gap=2, stiffness=1)
    plant = rotor(1.0, mesh, tn.Damper("drag", nodes=("a", "ground"), damping=0.1))
    given = MotionStart(angles={"a": start}, speeds={"a": speed})
    record = plant.simulate("a", {"a": 0.1 + 0.032 * np.sin(0.8 * t)}, 1 / t[1], initial_state=given)
    last = record["a"].values[-800:]
    # straight pieces of the torque are 6e-6 of it too small
    assert last.min() == pytest.approx(low, abs=4e-6)
    assert last.max() == pytest.approx(high, abs=4e-6)


def test_contact_with_damping_pushes_but_never_pulls():
    inertia, b, k, c, n = 0.02, 0.01, 3e3, 5.0, 351
    mesh = tn.Clearance("mesh", nodes=("a", "ground"), gap=2 * b, stiffness=k, damping=c)
    t = np.arange(n) * 1e-3
    torque = 2 + 9 * np.sin(2 * math.pi * 11 * t)
    record = rotor(inertia, mesh).simulate(["a", "torque(mesh)"], {"a": torque}, 1e3)

    def contact(x, v):
        if x > b:
            return max(0.0, k * (x - b) + c * v)
        return min(0.0, k * (x + b) + c * v) if x < -b else 0.0

    state, found = np.zeros(2), [0.0]
    for i in range(n - 1):  # each straight piece of the torque by itself

        def rates(s, y, i=i):
            return [y[1], (torque[i] + (torque[i + 1] - torque[i]) * s / 1e-3 - contact(*y)) / inertia]

        state = scipy.integrate.solve_ivp(rates, (0, 1e-3), state, "DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
        found.append(state[0])
    assert {event.what for event in record.events} == {"closes", "opens"}
    assert len(record.events) > 10
    assert record["a"].values == pytest.approx(np.array(found), abs=2e-9)
    assert (record["torque(mesh)"].values * record["a"].values >= 0).all()
    energy = record.energy
    assert energy.dissipated["mesh"] > 0.03
    assert abs(energy.left_over) < 1e-10 * energy.supplied


def test_friction_behind_a_spring_slips_once_and_then_swings_without_loss():
    torque, speed = 30.0, 2.0
    record = rotor(J, tn.Friction("jenkins", nodes=("a", "ground"), torque=torque, stiffness=K)).simulate(
        ["a", "torque(jenkins)"], {"a": np.zeros(4001)}, 4e3, initial_state=MotionStart(speeds={"a": speed})
    )
    left = J * speed**2 / 2 - torque**2 / (2 * K)
    highest = torque / K + left / torque
    assert [event.what for event in record.events] == ["slips", "sticks"]
    twist = record["a"].values
    assert twist.max() == pytest.approx(highest, abs=2e-7)
    assert twist[2000:].min() == pytest.approx(highest - 2 * torque / K, abs=2e-7)
    assert record.energy.dissipated["jenkins"] == pytest.approx(left, rel=1e-12)
    omega, stops = math.sqrt(K / J), record.events[-1].time
    after = np.arange(4001) / 4e3 > stops
    swing = highest - torque / K + torque / K * np.cos(omega * (np.arange(4001) / 4e3 - stops))
    assert twist[after] == pytest.approx(swing[after], abs=1e-12)


def test_preload_holds_until_its_torque_is_exceeded():
    curve = PieceCurve("twist", (Slope(-5, 100, upper=0), Hold(0, -5, 5), Slope(5, 100, lower=0)))
    ramp = np.linspace(0, 10, 1001)  # within 1 s
    plant = rotor(J, curved("installed", ("a", "ground"), curve))
    record = plant.simulate(["a", "torque(installed)"], {"a": ramp}, 1e3)
    (event,) = record.events
    assert (event.time, event.what) == (pytest.approx(0.5, abs=1e-12), "moves on")
    assert record["torque(installed)"].values[:500] == pytest.approx(ramp[:500], abs=1e-12)
    omega, t = math.sqrt(100 / J), np.arange(501) / 1e3
    moved = 10 / 100 * (t - np.sin(omega * t) / omega)
    assert record["a"].values[500:] == pytest.approx(moved, abs=1e-12)


def test_bounces_on_a_preload_end_in_standing_still():
    curve = PieceCurve("twist", (Slope(-5, 100, upper=0), Hold(0, -5, 5), Slope(5, 100, lower=0)))
    elements = curved("installed", ("a", "ground"), curve), tn.Damper("drag", nodes=("a", "ground"), damping=8)
    record = rotor(J, *elements).simulate(
        "a", {"a": np.zeros(2001)}, 1e3, initial_state=MotionStart(angles={"a": 0.05})
    )
    assert record.events[-1].what == "stands"
    assert abs(record["a"].values[-1]) < 1e-15
    assert len(record.events) < 500


def test_twist_passes_a_preload_against_the_torque_as_its_speed_takes_it():
    """A ramp brings the torque to that of the preload while the twist still swings through it."""
    stages = [{"stiffness": 400, "to": "0.1 rad"}, {"stiffness": 1500, "preload": "20 N*m"}]
    spring = tn.Spring("dmf", nodes=("a", "ground"), stages=stages)
    ramp = 0.1 * np.arange(1001)
    plant = rotor(0.1, spring, tn.Damper("drag", nodes=("a", "ground"), damping=1))
    record = plant.simulate(["a", "torque(dmf)"], {"a": ramp}, 1e3)

    def rates(t, y):
        step = 400 * y[0] if y[0] < 0.1 else 60 + 1500 * (y[0] - 0.1)
        return [y[1], (100 * t - step - y[1]) / 0.1]

    def corner(_, y):
        return y[0] - 0.1

    corner.terminal = True
    t, state = 0.0, np.zeros(2)
    for _ in range(200):
        end = scipy.integrate.solve_ivp(rates, (t, 0.7), state, "DOP853", rtol=1e-12, atol=1e-14, events=corner)
        t, state = end.t[-1], end.y[:, -1]
        if t >= 0.7:
            break
        state[0] = 0.1 + math.copysign(1e-15, state[1])
    assert len(record.events) > 20
    assert record["a"].values[700] == pytest.approx(state[0], abs=1e-9)


def test_two_parts_that_stick_side_by_side_are_asked_for_a_stiffness():
    plant = rotor(J, *(tn.Friction(name, nodes=("a", "ground"), torque=1) for name in ("first", "second")))
    with pytest.raises(UsageError, match="indeterminate-torque"):
        plant.simulate("a", {"a": np.zeros(10)}, 1e3)


def test_parts_that_stick_one_behind_the_other_hand_on_the_same_torque():
    nodes = [("a", "b"), ("b", "ground")]
    parts = [tn.Inertia("K", node="b", inertia=0.1)]
    parts += [
        tn.Friction(f"f{i}", nodes=pair, torque=torque)
        for i, (pair, torque) in enumerate(zip(nodes, (3, 5), strict=True))
    ]
    ramp = np.linspace(0, 8, 1001)
    record = rotor(J, *parts).simulate(["torque(f0)", "torque(f1)", "velocity(a)"], {"a": ramp}, 1e3)
    assert [(event.element, event.what) for event in record.events] == [("f0", "slips")]
    assert record["torque(f1)"].values == pytest.approx(np.minimum(ramp, 3), abs=1e-12)
    late = ramp[376:]
    assert record["velocity(a)"].values[376:] == pytest.approx((late - 3) ** 2 / (2 * 8 * J), abs=1e-11)


def test_torque_that_changes_without_an_end_is_refused_with_time_and_rate():
    curve = PieceCurve("rate", (Slope(-5, upper=0), Slope(5, lower=0)))  # no step at which it could stick
    plant = rotor(J, curved("dry", ("a", "ground"), curve))
    with pytest.raises(SolveError, match=r"(?s)0\.3.*no-solution"):
        plant.simulate("a", {"a": np.zeros(1001)}, 1e3, initial_state=MotionStart(speeds={"a": 5.0}))


def test_delays_and_tables_over_frequency_are_refused_beside_laws_of_motion():
    gap = tn.Clearance("gap", nodes=("a", "ground"), gap=0.1, stiffness=K)
    rubber = tn.HystereticSpring("rubber", nodes=("a", "ground"), stiffness=10, loss_factor=0.1)
    with pytest.raises(UsageError, match="unsupported-law"):
        rotor(J, gap, rubber).simulate("a", {"a": np.zeros(10)}, 1e3)


def test_rotation_of_the_whole_leaves_the_twists_as_exact_as_without():
    """A spinning pair vibrates as one that stands, to rounding, after thousands of radians."""
    elements = [tn.Inertia("A", node="a", inertia=0.2), tn.Inertia("B", node="b", inertia=0.7)]
    plant = tn.Drivetrain("pair", [*elements, tn.Clearance("mesh", nodes=("a", "b"), gap=0.01, stiffness=5e3)])
    inputs = {"a": np.zeros(4001)}
    runs = [
        plant.simulate(
            "torque(mesh)", inputs, 200.0, initial_state=MotionStart(speeds={"a": base + 0.5, "b": base - 0.5})
        )
        for base in (0.0, 300.0)
    ]
    still, spinning = (run["torque(mesh)"].values for run in runs)
    assert np.abs(still).max() > 20
    assert spinning == pytest.approx(still, abs=1e-8)


@pytest.mark.parametrize("name", ["dmf_rig", "direct_drive_wind_turbine"])
def test_linear_plants_move_from_a_given_state_as_they_do_from_rest(name):
    """Two ways to one motion: filters for each mode, and steps with all that an event would need."""
    plant = tn.load(name)
    torque = {next(iter(plant.inputs)): np.cumsum(np.random.default_rng(1).normal(size=200))}
    outputs = list(plant.sensors)
    by_modes, by_steps = (
        plant.simulate(outputs, torque, 2e3, initial_state=start) for start in ("rest", MotionStart())
    )
    for one in outputs:
        size = np.abs(by_modes[one].values).max()
        assert by_steps[one].values == pytest.approx(by_modes[one].values, abs=1e-11 * size)
    assert abs(by_steps.energy.left_over) < 1e-12 * abs(by_steps.energy.supplied)


@pytest.mark.parametrize("seed", [0, 1])
def test_controllers_act_beside_laws_of_motion(seed):
    """A clearance that never closes changes nothing."""
    rig = Plant(seed, delay=False, forms=("polynomials", "roots")).rig
    wide = tn.Clearance("wide", nodes=("n0", "ground"), gap=1e3, stiffness=1)
    torque = {"n1": np.cumsum(np.random.default_rng(seed).normal(size=200))}
    outputs = ["n0", *(f"torque({name})" for name, one in rig.elements.items() if isinstance(one, tn.Controller))]
    without = rig.simulate(outputs, torque, 500.0)
    beside = tn.Drivetrain("rig", [*rig.elements.values(), wide], parameters=rig.parameters).simulate(
        outputs, torque, 500.0
    )
    for one in outputs:
        size = np.abs(without[one].values).max()
        assert beside[one].values == pytest.approx(without[one].values, abs=1e-11 * size)

"""Whole laws of motion of clutches, flywheels, machines, couplings and propellers, against their definitions."""

import math
from itertools import pairwise

import numpy as np
import pytest
import scipy
from support.models import sympy_algebra

import torsionnet as tn
from torsionnet.base.expressions import FLOAT
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness
from torsionnet.model.element_base.laws import MotionState
from torsionnet.model.elements import Action, Constraint, Law, MotionLaw, Values, make_element

STAGES = [
    {"stiffness": 300, "to": "150 N*m"},
    {"stiffness": 1000, "to": "250 N*m"},
    {"stiffness": 2000, "to": "400 N*m"},
]
FACES = [[0, 0.14], [10, 0.12], [30, 0.125]]
MOTOR = {"node": "a", "synchronous_speed": 150, "breakdown_torque": 400, "breakdown_slip": 0.1}
CONVERTER = {
    "pump": "a",
    "turbine": "b",
    "housing": "c",
    "pump_torque": [[0, "180 N*m"], [0.5, "170 N*m"], [1, "100 N*m"]],
    "test_speed": 200,
    "torque_ratio": [[0, 2.2], [0.9, 1], [1, 0.98]],
}
VALUES = Values({}, FLOAT)


def laws_of(element, value=VALUES):
    return [part for part in element.whole_parts(value) if isinstance(part, MotionLaw)]


def matrices(parts, order=("a", "b", "c")):
    """Damping and stiffness (n, n) of the linear parts of an element, written out by their definition."""
    damping, stiffness = np.zeros((3, 3)), np.zeros((3, 3))
    place = {node: number for number, node in enumerate(order)}

    def column(row):
        found = np.zeros(3)
        for node, share in row.items():
            found[place[node]] = float(share)
        return found

    for part in parts:
        if isinstance(part, Law):
            damping += float(part.damping) * np.outer(column(part.row), column(part.row))
            stiffness += float(part.stiffness) * np.outer(column(part.row), column(part.row))
        elif isinstance(part, Action):
            damping -= float(part.numerator[1]) * np.outer(column(part.row), column(part.sensed))
    return damping, stiffness


def torques(element, speeds):
    """Torque in N m on the nodes a, b, c that the laws over the rate of an element take at speeds in rad/s."""
    found = np.zeros(3)

    def rate(row):
        return sum(float(share) * speeds["abc".index(node)] for node, share in row.items())

    for law in laws_of(element):
        torque = law.torque(0.0, rate(law.row), *(rate(row) for row in law.sensed))
        for node, share in law.row.items():
            found["abc".index(node)] += float(share) * float(torque)
    return found


def slopes(function, at, step=1e-4):
    at = np.array(at, dtype=float)
    return np.array([(function(at + one) - function(at - one)) / (2 * step) for one in step * np.eye(len(at))]).T


class TestClutch:
    def clutch(self, **entries):
        given = {"nodes": ("a", "b"), "state": "slipping", "friction": FACES, "clamp_torque": 900}
        return tn.Clutch("e", **given | entries)

    @pytest.mark.parametrize("slip", [-25.0, -4.0, 0.5, 4.0, 12.0, 29.0])
    def test_its_torque_is_that_of_the_table_and_its_slope_that_of_a_slip_speed(self, slip):
        (law,) = laws_of(self.clutch())
        expected = 900 * np.interp(abs(slip), *np.array(FACES).T) * np.sign(slip)
        assert law.torque(0, slip) == pytest.approx(expected, rel=1e-14)
        (named,) = self.clutch(slip_speed=slip).parts(VALUES)
        (tangent,) = self.clutch().at_states([MotionState(rate=slip)]).parts(VALUES)
        assert tangent == named

    def test_at_rest_it_sticks_up_to_the_torque_at_slip_zero(self):
        clutch = self.clutch(stiffness=700, damping=2, disc_inertia=0.1)
        (law,) = laws_of(clutch)
        assert (law.scale, law.scaled_by) == (900, "clamp")
        (state,) = law.curve.states_at(100 / 900)
        assert (state.rate, law.curve.holds(state)) == (0, True)
        assert law.curve.states_at(0.1401) == ()
        assert clutch.parts(VALUES)[0] == Constraint({"a": 1, "e.disc": -1})
        assert (
            clutch.parts(VALUES)[1:]
            == self.clutch(slip_speed=3, stiffness=700, damping=2, disc_inertia=0.1).parts(VALUES)[1:]
        )

    def test_a_slip_speed_keeps_its_parts_and_has_the_law_too(self):
        named = self.clutch(slip_speed=4)
        assert named.has_own_working_point
        assert laws_of(named) == laws_of(self.clutch())
        assert isinstance(named.parts(VALUES)[0], Law)

    @pytest.mark.parametrize("state", ["closed", "open"])
    def test_closed_and_open_it_has_no_law_of_motion(self, state):
        clutch = self.clutch(state=state, drag=3)
        assert not clutch.has_motion_laws
        assert clutch.whole_parts(VALUES) == clutch.parts(VALUES)

    def test_rows_through_negative_slips_are_as_they_stand(self):
        clutch = self.clutch(friction=None, clamp_torque=None, torque=[[-10, -150], [0, 20], [10, 190]])
        (law,) = laws_of(clutch)
        assert [law.torque(0, slip) for slip in (-5, 0, 5)] == [-65, 20, 105]
        assert (law.scaled_by, clutch.parts(VALUES)[0].damping) == ("", 17)

    def test_symbols(self):
        import sympy

        given = {"nodes": ["a", "b"], "state": "slipping", "friction": FACES, "clamp_torque": "T_1"}
        value = Values({"T_1": sympy.Symbol("T_1")}, sympy_algebra())
        clutch = make_element("clutch", "e", given)
        (part,) = clutch.at_states([MotionState(rate=5.0, piece=3)]).parts(value)
        assert sympy.simplify(part.damping + sympy.Rational(1, 500) * sympy.Symbol("T_1")) == 0


class TestDualMassFlywheel:
    def flywheel(self, **entries):
        return tn.DualMassFlywheel("e", nodes=("a", "b"), **{"primary_inertia": 1, "secondary_inertia": 2} | entries)

    @pytest.mark.parametrize("torque", [-399.0, -200.0, 20.0, 149.0, 151.0, 260.0])
    def test_the_stage_at_a_torque_is_that_of_the_entry(self, torque):
        entries = {"stages": STAGES, "damping": 3, "blocked": 0.25, "loss_factor": 0.1}
        (law,) = laws_of(self.flywheel(**entries))
        (state,) = law.curve.states_at(torque)
        assert law.torque(state.twist, 0) == pytest.approx(torque, rel=1e-13)
        at_rest = self.flywheel(**entries).at_states([state]).parts(VALUES)
        assert at_rest == self.flywheel(**entries, torque=torque).parts(VALUES)

    def test_energy_is_the_work_of_the_torque(self):
        (law,) = laws_of(self.flywheel(stages=STAGES, blocked=0.2))
        corners = [0.8 * one for one in (0.5, 0.6)]
        work, _ = scipy.integrate.quad(lambda twist: law.torque(twist, 0), 0, 0.52, points=corners, epsabs=1e-12)
        assert law.energy(0.52) == pytest.approx(work, rel=1e-10)
        assert law.energy(-0.52) == pytest.approx(work, rel=1e-10)

    def test_friction_without_swing_holds_the_springs(self):
        flywheel = self.flywheel(stages=STAGES, friction=8)
        springs, friction = laws_of(flywheel)
        assert [friction.torque(0.3, rate) for rate in (-2, 2)] == [-8, 8]
        assert Constraint({"a": 1, "b": -1}) in flywheel.parts(VALUES)
        slipping = flywheel.at_states([springs.curve.states_at(200)[0], MotionState(rate=0.1)]).parts(VALUES)
        assert slipping == self.flywheel(stages=STAGES, torque=200).parts(VALUES)

    def test_a_swing_keeps_its_harmonic_balance_on_every_stage(self):
        entries = {"stages": STAGES, "friction": 8, "swing": 0.05}
        springs, _ = laws_of(self.flywheel(**entries))
        found = self.flywheel(**entries).at_states([springs.curve.states_at(200)[0], MotionState()]).parts(VALUES)
        assert found == self.flywheel(**entries, torque=200).parts(VALUES)

    def test_pressed_springs_rub_with_what_presses_them(self):
        pressed = {"friction_coefficient": 0.1, "spring_mass": 0.8, "spring_radius": 0.11, "speed": 200}
        (law,) = laws_of(self.flywheel(stiffness=900, friction=3, **pressed))
        assert law.torque(0, 1) == pytest.approx(3 + 0.1 * 0.8 * 0.11 * 200**2 * 0.11, rel=1e-14)

    def test_a_loss_factor_is_left_to_solvers_to_refuse(self):
        parts = self.flywheel(stages=STAGES, loss_factor=0.1).whole_parts(VALUES)
        assert [part.loss_factor for part in parts if isinstance(part, Law) and part.loss_factor] == [0.1]

    def test_linear_springs_have_no_law_of_motion(self):
        assert not self.flywheel(stiffness=900, damping=3).has_motion_laws


class TestInductionMachine:
    @pytest.mark.parametrize("slip", [-0.3, -0.05, 0.0, 0.02, 0.1, 1.0])
    def test_kloss(self, slip):
        (law,) = laws_of(tn.InductionMachine("e", **MOTOR))
        at = 150 * (1 - slip)
        expected = -2 * 400 / (slip / 0.1 + 0.1 / slip) if slip else 0
        assert law.torque(0, at) == pytest.approx(expected, rel=1e-12, abs=1e-9)
        named = tn.InductionMachine("e", **MOTOR, slip=slip).parts(VALUES)
        found = tn.InductionMachine("e", **MOTOR).at_states([MotionState(rate=at)]).parts(VALUES)
        assert float(found[0].damping) == pytest.approx(float(named[0].damping), rel=1e-9, abs=1e-9)
        differences = slopes(lambda one: np.array([law.torque(0, one[0])]), [at])
        assert float(named[0].damping) == pytest.approx(differences[0, 0], rel=1e-6, abs=1e-6)

    @pytest.mark.parametrize("share", [-1.0, -0.6, -0.01, 0.0, 0.3, 0.999999, 1.0])
    def test_all_speeds_of_a_torque_are_found(self, share):
        """By brackets between the extremes: a torque below the breakdown torque stands at s and at s_k^2/s."""
        (law,) = laws_of(tn.InductionMachine("e", **MOTOR))
        found = [state.rate for state in law.curve.states_at(400 * share)]
        assert found == sorted(found)
        if abs(share) == 1:
            assert found == pytest.approx([150 * (1 + math.copysign(0.1, share))])
            return
        ends = [150 - 1e6, *law.curve.corners(), 150 + 1e6]

        def over(rate):
            return law.torque(0, rate) - 400 * share

        expected = [scipy.optimize.brentq(over, *pair) for pair in pairwise(ends) if over(pair[0]) * over(pair[1]) < 0]
        assert found == pytest.approx(expected, rel=1e-9)

    def test_six_tenths_of_the_breakdown_torque(self):
        (law,) = laws_of(tn.InductionMachine("e", **MOTOR))
        unstable, stable = law.curve.states_at(-0.6 * 400)
        assert [1 - one.rate / 150 for one in (stable, unstable)] == pytest.approx([0.1 / 3, 0.3], rel=1e-12)
        assert law.curve.slopes(unstable)[1] < 0 < law.curve.slopes(stable)[1]
        assert law.curve.states_at(-400.001) == ()

    def test_without_a_slip_it_is_unloaded_and_with_rated_values_rated(self):
        idle = tn.InductionMachine("e", **MOTOR, time_constant=0.03)
        assert idle.parts(VALUES) == tn.InductionMachine("e", **MOTOR, time_constant=0.03, slip=0).parts(VALUES)
        assert not idle.has_own_working_point
        rated = {name: one for name, one in MOTOR.items() if name != "breakdown_slip"}
        machine = tn.InductionMachine("e", **rated, rated_torque=180, rated_slip=0.02)
        (law,) = laws_of(machine)
        assert law.torque(0, 150 * 0.98) == pytest.approx(-180, rel=1e-12)
        assert machine.has_own_working_point

    def test_symbols(self):
        import sympy

        parameters = {name: sympy.Symbol(name, positive=True) for name in ("T_k", "w", "s_k")}
        given = {"node": "a", "synchronous_speed": "w", "breakdown_torque": "T_k", "breakdown_slip": "s_k"}
        machine = make_element("induction_machine", "e", given)
        (part,) = machine.at_states([MotionState(rate=97.0)]).parts(Values(parameters, sympy_algebra()))
        number = part.damping.subs({parameters["T_k"]: 400, parameters["w"]: 100, parameters["s_k"]: 0.1})
        expected = 2 * 400 * 0.1 * (0.1**2 - 0.03**2) / (100 * (0.03**2 + 0.1**2) ** 2)
        assert float(number) == pytest.approx(expected, rel=1e-12)


class TestLoads:
    def test_constant_power(self):
        load = tn.ConstantPowerLoad("e", node="a", power=600)
        (law,) = laws_of(load)
        assert [law.torque(0, speed) for speed in (-20, 20, 50)] == [-30, 30, 12]
        assert load.at_states([MotionState(rate=20.0)]).parts(VALUES) == tn.ConstantPowerLoad(
            "e", node="a", power=600, speed=20
        ).parts(VALUES)
        assert [state.rate for state in law.curve.states_at(30)] == pytest.approx([20])
        assert law.curve.states_at(0) == ()
        assert "let it turn faster" in law.curve.left(0, 0)
        assert load.parts(VALUES)[0].damping == 0

    @pytest.mark.parametrize(
        "entries",
        [{"exponent": 2}, {"exponent": 1.7}, {"torque_slope": -0.2, "torque_coefficient": 0.03, "advance_ratio": 0.6}],
    )
    def test_a_propeller_follows_its_speed(self, entries):
        screw = tn.Propeller("e", node="a", inertia=2, torque=300, speed=15, **entries)
        (law,) = laws_of(screw)
        assert law.torque(0, 15) == pytest.approx(300, rel=1e-14)
        assert law.torque(0, -15) == pytest.approx(-300, rel=1e-14)
        (named,) = screw.parts(VALUES)
        (found,) = screw.at_states([MotionState(rate=15.0)]).parts(VALUES)
        assert (found.inertia, found.damping) == (named.inertia, pytest.approx(named.damping, rel=1e-14))
        for speed in (4.0, 15.0, 19.0):
            (state,) = law.curve.states_at(law.torque(0, speed)) or [None]
            if state is not None and law.torque(0, speed) > 0:
                assert state.rate == pytest.approx(speed, rel=1e-12)
            differences = slopes(lambda one: np.array([law.torque(0, one[0])]), [speed])
            assert law.curve.slopes(MotionState(rate=speed))[1] == pytest.approx(differences[0, 0], rel=1e-7)

    def test_open_water_is_the_line_of_its_coefficient(self):
        """K_Q(J_a) rho D^5 n^2 with the ship's speed held, worked out from the line itself."""
        (law,) = laws_of(
            tn.Propeller(
                "e",
                node="a",
                inertia=2,
                torque=300,
                speed=15,
                torque_slope=-0.2,
                torque_coefficient=0.03,
                advance_ratio=0.6,
            )
        )
        for speed in (9.0, 18.0):
            advance = 0.6 * 15 / speed
            expected = 300 / 0.03 * (0.03 - 0.2 * (advance - 0.6)) * (speed / 15) ** 2
            assert law.torque(0, speed) == pytest.approx(expected, rel=1e-12)


KINDS = {
    "converter": lambda **at: tn.TorqueConverter("e", **CONVERTER, **at),
    "performance": lambda **at: tn.TorqueConverter(
        "e",
        **{name: one for name, one in CONVERTER.items() if name not in ("pump_torque", "test_speed")},
        performance=[[0, 0.04], [1, 0.02]],
        diameter=0.26,
        **at,
    ),
    "k_factor": lambda **at: tn.FluidCoupling(
        "e", pump="a", turbine="b", housing="c", k_factor=[[0, 30], [0.9, 50], [1, 90]], **at
    ),
}


class TestCouplings:
    @pytest.mark.parametrize("kind", KINDS)
    @pytest.mark.parametrize("ratio", [0.01, 0.3, 0.7, 0.95])
    def test_slopes_are_those_of_its_torques_and_of_the_entries(self, kind, ratio):
        make, speeds = KINDS[kind], [153.0, 3.0 + 150 * ratio, 3.0]
        differences = slopes(lambda at: torques(make(), at), speeds)
        named, _ = matrices(make(speed=150, speed_ratio=ratio).parts(VALUES))
        np.testing.assert_allclose(named, differences, rtol=1e-6, atol=1e-6)
        laws = laws_of(make())
        states = [MotionState(0.0, 150.0 * (1 - ratio), (150.0,)), MotionState(0.0, 150.0 * ratio, (150.0,))]
        found, _ = matrices(make().at_states(states[: len(laws)]).parts(VALUES))
        np.testing.assert_allclose(found, named, rtol=1e-12, atol=1e-12)
        plain = [part for law, state in zip(laws, states, strict=False) for part in law.tangent(state)]
        np.testing.assert_allclose(matrices(plain)[0], named, rtol=1e-12, atol=1e-12)

    def test_torques_of_a_converter(self):
        """By the tables at nu = 0.7: 142 N m at 200 rad/s, and a torque ratio of 1.2667."""
        found = torques(KINDS["converter"](), [150.0, 105.0, 0.0])
        pump = 142 * (150 / 200) ** 2
        ratio = 2.2 - 1.2 / 0.9 * 0.7
        np.testing.assert_allclose(found, [pump, -ratio * pump, (ratio - 1) * pump], rtol=1e-12)

    @pytest.mark.parametrize("kind", KINDS)
    def test_turning_backwards_is_mirrored_and_standing_is_nothing(self, kind):
        element = KINDS[kind]()
        there, back = (torques(element, sign * np.array([150.0, 60.0, 0.0])) for sign in (1, -1))
        np.testing.assert_allclose(back, -there, rtol=1e-14)
        assert not torques(element, [0.0, 0.0, 0.0]).any()
        assert element.mean_speed_rows(VALUES) == ()
        assert not matrices(element.parts(VALUES))[0].any()

    @pytest.mark.parametrize("kind", KINDS)
    def test_ratios_of_a_torque(self, kind):
        law = laws_of(KINDS[kind]())[0]
        for ratio in (0.2, 0.8):
            torque = law.torque(0, 150 * (1 - ratio), 150.0)
            (state,) = law.curve.states_at(torque, 150.0)
            assert (150 - state.rate) / 150 == pytest.approx(ratio, rel=1e-9)
        assert law.curve.states_at(10) is None
        assert law.curve.states_at(1e6, 150.0) == ()

    def test_tables_end(self):
        coupling, stator = (law.curve for law in laws_of(KINDS["converter"]()))
        assert coupling.left(0, 15.0, 150.0) == ""
        assert "the ratio is 1.1" in coupling.left(0, -15.0, 150.0)
        assert "from speed ratio 0 to 1" in stator.left(0, 165.0, 150.0)

    def test_one_of_two_is_not_enough(self):
        with pytest.raises(tn.ModelError, match=r"elements\.e\.speed: .*missing-entry"):
            KINDS["converter"](speed=150)


class TestSynchronousMachine:
    def machine(self, **entries):
        return tn.SynchronousMachine("e", node="a", pull_out_torque=500, pole_pairs=3, **entries)

    @pytest.mark.parametrize("saliency", [0, 120, -80])
    @pytest.mark.parametrize("torque", [-450.0, 0.0, 20.0, 300.0])
    def test_all_angles_of_a_torque(self, saliency, torque):
        (law,) = laws_of(self.machine(reluctance_torque=saliency, load_angle="20 deg"))
        found = [state.twist for state in law.curve.states_at(torque)]
        grid = np.linspace(-math.pi / 3, math.pi / 3, 4002) + 1e-5

        def over(twist):
            return 500 * math.sin(3 * twist) + saliency * math.sin(6 * twist) - torque

        expected = [
            scipy.optimize.brentq(over, *pair, xtol=1e-14)
            for pair in pairwise(grid)
            if over(pair[0]) * over(pair[1]) < 0
        ]
        apart = np.abs(np.exp(3j * np.array(found))[:, None] - np.exp(3j * np.array(expected)))
        assert apart.shape == (len(expected), len(expected))
        assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-9

    def test_slope_and_energy(self):
        (law,) = laws_of(self.machine(reluctance_torque=120, load_angle="20 deg"))
        state = MotionState(twist=math.radians(20) / 3)
        (named,) = self.machine(reluctance_torque=120, load_angle="20 deg").parts(VALUES)
        assert law.curve.slopes(state)[0] == pytest.approx(float(named.stiffness), rel=1e-12)
        (found,) = self.machine(reluctance_torque=120, load_angle="70 deg").at_states([state]).parts(VALUES)
        assert float(found.stiffness) == pytest.approx(float(named.stiffness), rel=1e-12)
        work, _ = scipy.integrate.quad(lambda twist: law.torque(twist, 0), 0, 0.3, epsabs=1e-12)
        assert law.energy(0.3) == pytest.approx(work, rel=1e-11)

    def test_beyond_the_pull_out_torque_there_is_none(self):
        (law,) = laws_of(self.machine(torque=30))
        assert law.curve.states_at(501) == ()
        assert [3 * state.twist for state in law.curve.states_at(500)] == pytest.approx([math.pi / 2], abs=1e-6)

    def test_given_by_its_stiffness_it_has_no_law_of_motion(self):
        assert not tn.SynchronousMachine("e", node="a", stiffness=900).has_motion_laws


def rig(element, **more):
    bodies = [tn.Inertia("J_a", node="a", inertia=2), tn.Inertia("J_b", node="b", inertia=3)]
    return tn.Drivetrain("rig", [*bodies, element], inputs={"T": {"torque": "a"}}, **more)


class TestOperatingPoints:
    def test_a_clutch_slips_at_the_speeds_that_are_given(self):
        clutch = tn.Clutch("e", nodes=("a", "b"), state="slipping", friction=FACES, clamp_torque=1000)
        slips = rig(clutch).at(speed={"a": 105, "b": 100})
        assert max(slips.modes().eigenvalues.real) == pytest.approx(0.002 * 1000 * (1 / 2 + 1 / 3), rel=1e-12)
        assert len(rig(clutch).modes().eigenvalues) == 1  # it sticks: one free rotor
        assert len(rig(clutch).at(torque={"a": 139, "b": -139}).modes().eigenvalues) == 1

    def test_a_clutch_that_sticks_passes_the_speed_on(self):
        clutch = tn.Clutch("e", nodes=("a", "b"), state="slipping", friction=FACES, clamp_torque=1000)
        assert rig(clutch).ratio_between("a", "b") == 1
        point = {"speed": {"a": 90}}
        assert rig(clutch, operating_point=point).mean_speeds["b"] == pytest.approx(90)

    def test_a_machine_under_load_runs_at_the_stable_slip(self):
        motor = tn.InductionMachine("e", **MOTOR, time_constant=0.03)
        named = tn.InductionMachine("e", **MOTOR, time_constant=0.03, slip="1/30")
        shaft = tn.Spring("s", nodes=("a", "b"), stiffness=900)
        bodies = [tn.Inertia("J_a", node="a", inertia=2), tn.Inertia("J_b", node="b", inertia=3), shaft]
        found = tn.Drivetrain("rig", [*bodies, motor]).at(torque={"b": -240}, speed={"b": 145}).modes().eigenvalues
        expected = tn.Drivetrain("rig", [*bodies, named]).modes().eigenvalues
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10)

    @pytest.mark.parametrize("torque", [20.0, 200.0])
    def test_a_flywheel_takes_the_stage_of_the_torque(self, torque):
        entries = {"nodes": ("a", "b"), "primary_inertia": 1, "secondary_inertia": 1, "stages": STAGES}
        found = rig(tn.DualMassFlywheel("e", **entries)).at(torque={"a": torque, "b": -torque})
        named = rig(tn.DualMassFlywheel("e", **entries, torque=torque))
        responses = [one.frequency_response("b", "T", [1.0, 9.0]).values for one in (found, named)]
        np.testing.assert_array_equal(*responses)


def test_a_law_has_a_loss_factor_or_a_table():
    """Of both the solvers would take the table alone."""
    table = ComplexStiffness(500 + 20j)
    assert Law({"a": 1}, stiffness=400, table=table).acts
    with pytest.raises(ValueError, match="two laws"):
        Law({"a": 1}, stiffness=400, loss_factor=0.1, table=table)

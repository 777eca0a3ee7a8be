"""Laws of motion of springs, clearances, friction and backlash: torques, energies, tangents, and what is refused."""

import math
import pickle
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.base.expressions import FLOAT
from torsionnet.linear.assembly.symbolic import SymbolRecord, symbol_of
from torsionnet.linear.sensitivity.unknowns import DUALS, Dual
from torsionnet.model.element_base.laws import MotionState, ScaledCurve
from torsionnet.model.elements import Constraint, Law, MotionLaw, Values
from torsionnet.model.motion_laws.describing_functions import describing_function
from torsionnet.model.motion_laws.piece_curve import (
    Hold,
    PieceCurve,
    Slope,
    clearance_curve,
    friction_curve,
    symmetric_curve,
)
from torsionnet.model.motion_laws.smooth_curves import CubicCurve
from torsionnet.motion.balance.rate_states import returns_to_speeds, roots_along

ENDS = {"nodes": ("a", "b")}
STAGES = [
    {"stiffness": "100 N*m/rad", "to": "0.1 rad"},
    {"stiffness": "400 N*m/rad", "to": "40 N*m", "preload": "5 N*m"},
    {"stiffness": "900 N*m/rad"},
]
SPRINGS = {
    "stages": tn.Spring("e", **ENDS, stages=[STAGES[0], {**STAGES[1], "preload": 0}, STAGES[2]]),
    "preloaded stages": tn.Spring("e", **ENDS, stages=STAGES),
    "preload at zero": tn.Spring("e", **ENDS, stages=[{"stiffness": 100, "preload": 7}]),
    "rows both ways": tn.Spring("e", **ENDS, torque_over_twist=[[0, 0], ["0.1 rad", 10], ["0.3 rad", 90]]),
    "rows through zero": tn.Spring("e", **ENDS, torque_over_twist=[[-0.4, -30], [-0.1, 4], [0.2, 4], [0.5, 60]]),
    "cubic": tn.Spring("e", **ENDS, stiffness=100, cubic="300 N*m/rad^3"),
    "softening": tn.Spring("e", **ENDS, stiffness=100, cubic=-30),
    "clearance": tn.Clearance("e", **ENDS, gap="0.2 rad", stiffness=100, damping=3),
    "gear": tn.Gear("e", **ENDS, ratio=-3, stiffness=100, damping=3, backlash="0.2 rad"),
    "planetary": tn.Planetary("e", sun="a", ring="b", carrier="c", ratio=3, stiffness=100, backlash="0.2 rad"),
}
FRICTIONS = {
    "constant": tn.Friction("e", **ENDS, torque=20, stick=30),
    "over slip": tn.Friction("e", **ENDS, torque_over_slip=[[0, 20], [5, 12], [50, 15]]),
    "Jenkins": tn.Friction("e", **ENDS, torque=20, stiffness=400),
}
EVERY = SPRINGS | FRICTIONS


def law_of(element, algebra=FLOAT, values=()):
    (law,) = (part for part in element.whole_parts(Values(dict(values), algebra)) if isinstance(part, MotionLaw))
    return law


def by_hand(kind, x):
    """Torque at a twist as the definitions say it, each written out."""
    sign, size = math.copysign(1, x), abs(x)
    match kind:
        case "stages":
            first, second = 10 + 400 * (size - 0.1), 40 + 900 * (size - 0.175)
            return sign * (100 * size if size < 0.1 else first if first < 40 else second)
        case "preloaded stages":
            first, second = 15 + 400 * (size - 0.1), 40 + 900 * (size - 0.1625)
            return sign * (100 * size if size < 0.1 else first if first < 40 else second)
        case "preload at zero":
            return sign * (7 + 100 * size)
        case "rows both ways":
            return sign * np.interp(size, [0, 0.1, 0.3], [0, 10, 90])
        case "rows through zero":
            return np.interp(x, [-0.4, -0.1, 0.2, 0.5], [-30, 4, 4, 60])
        case "cubic":
            return 100 * x + 300 * x**3
        case "softening":
            return 100 * x - 30 * x**3
    return sign * 100 * max(0.0, size - 0.1)


@pytest.mark.parametrize("kind", SPRINGS)
class TestTorqueOverTwist:
    def test_is_that_of_its_definition(self, kind):
        law = law_of(SPRINGS[kind])
        for x in (-0.29, -0.17, -0.12, -0.05, 0.03, 0.09, 0.11, 0.17, 0.29):
            assert law.torque(x, 0.0) == pytest.approx(by_hand(kind, x), rel=1e-13, abs=1e-13)

    def test_energy_is_the_integral_of_the_torque(self, kind):
        law = law_of(SPRINGS[kind])
        corners = [-0.175, -0.1625, -0.1, 0, 0.1, 0.1625, 0.175, 0.2]
        for x in (-0.3, -0.15, -0.04, 0.06, 0.16, 0.29):
            found, error = scipy.integrate.quad(
                lambda at: by_hand(kind, at), 0, x, points=corners, epsabs=1e-12, limit=200
            )
            assert law.energy(x) == pytest.approx(found, rel=1e-10, abs=10 * error)

    def test_tangent_is_the_slope(self, kind):
        law, step = law_of(SPRINGS[kind]), 1e-6
        for x in (-0.25, -0.13, 0.03, 0.12, 0.27):
            (tangent,) = law.tangent(MotionState(x))
            slope = (law.torque(x + step, 0.0) - law.torque(x - step, 0.0)) / (2 * step)
            assert tangent.stiffness == pytest.approx(slope, abs=1e-5)
            rate_slope = (law.torque(x, step) - law.torque(x, -step)) / (2 * step)
            assert tangent.damping == pytest.approx(rate_slope, abs=1e-5)

    def test_states_at_a_torque_give_it_back(self, kind):
        curve = law_of(SPRINGS[kind]).curve
        for torque in (-23.7, -3.3, 0.0, 2.2, 11.4, 27.1):
            states = curve.states_at(torque)
            assert states
            for state in states:
                held = isinstance(curve, PieceCurve) and curve.holds(state)
                if held:
                    step = curve.pieces[state.piece]
                    assert step.low <= torque <= step.high
                else:
                    assert curve.torque(state.twist, 0.0) == pytest.approx(torque, abs=1e-9)

    def test_referred_torque_is_that_at_the_other_shaft(self, kind):
        """r T(r gamma, r gamma'), so that the energy is the same at the same position."""
        curve = law_of(SPRINGS[kind]).curve
        for r in (Fraction(5, 2), Fraction(-1, 3)):
            found, plain = curve.scaled(r), ScaledCurve(curve, r)
            for x in (-0.11, -0.02, 0.06, 0.13):
                twist = x / float(r)
                assert found.torque(twist, 0.7) == pytest.approx(float(r) * curve.torque(x, 0.7 * float(r)), rel=1e-12)
                assert found.energy(twist) == pytest.approx(curve.energy(x), rel=1e-12)
                for one in (found, plain):
                    expected = [float(r) ** 2 * slope for slope in curve.slopes(MotionState(x))]
                    assert one.slopes(MotionState(twist)) == pytest.approx(expected, rel=1e-12)
                assert plain.torque(twist, 0.7) == pytest.approx(found.torque(twist, 0.7), rel=1e-12)
            assert found.range() == pytest.approx(plain.range()) if curve.range()[0] else found.range() == (None, None)


class TestContact:
    def test_pushes_and_never_pulls(self):
        """max(0, k d + c d') with k 100, c 3 and half a gap of 0.1 rad, on both sides."""
        law = law_of(SPRINGS["clearance"])
        for penetration, rate in ((0.02, 0.3), (0.02, -0.3), (0.02, -0.7), (0.3, -9.0), (0.3, -11.0)):
            expected = max(0.0, 100 * penetration + 3 * rate)
            assert law.torque(0.1 + penetration, rate) == pytest.approx(expected, abs=1e-12)
            assert law.torque(-0.1 - penetration, -rate) == pytest.approx(-expected, abs=1e-12)

    def test_is_a_clearance_on_the_row_of_a_mesh(self):
        gear, planetary = law_of(SPRINGS["gear"]), law_of(SPRINGS["planetary"])
        assert gear.row == {"a": 1, "b": 3}
        assert planetary.row == {"a": 1, "b": 3, "c": -4}
        assert gear.curve == law_of(SPRINGS["clearance"]).curve

    def test_in_the_gap_nothing_acts(self):
        (law,) = SPRINGS["clearance"].parts(Values({}))
        assert not law.acts
        assert SPRINGS["clearance"].mean_speed_rows(Values({})) == ({"a": 1, "b": -1},)


class TestHolds:
    def test_twist_stands_until_the_preload_is_exceeded(self):
        curve = law_of(SPRINGS["preloaded stages"]).curve
        for torque in (10.5, 14.9, -10.5):
            (state,) = curve.states_at(torque)
            assert state.twist == math.copysign(0.1, torque)
            assert curve.holds(state)
        (above,), (below,) = curve.states_at(15.4), curve.states_at(9.9)
        assert (above.twist, below.twist) == pytest.approx((0.101, 0.099))

    def test_preload_at_zero_is_rigid_at_rest(self):
        assert SPRINGS["preload at zero"].parts(Values({})) == (Constraint({"a": 1, "b": -1}),)

    def test_torque_in_the_first_row_is_a_preload(self):
        spring = tn.Spring("e", **ENDS, torque_over_twist=[[0, 7], [1, 107]])
        assert law_of(spring).curve == replace(law_of(SPRINGS["preload at zero"]).curve, pieces=(
            Slope(-7, 100, 0, -1, 0), Hold(0, -7, 7), Slope(7, 100, 0, 0, 1)))  # fmt: skip

    def test_a_stage_ends_where_its_torque_does(self):
        """0.1 rad on 100 N m/rad, a preload of 5 N m, then 25 N m more on 400 N m/rad."""
        ends = [piece.upper for piece in law_of(SPRINGS["preloaded stages"], algebra=Values({}).algebra).curve.pieces
                if isinstance(piece, Slope)]  # fmt: skip
        assert ends == [Fraction(-13, 80), Fraction(-1, 10), Fraction(1, 10), Fraction(13, 80), None]


class TestFriction:
    def test_torque_opposes_the_slip(self):
        law = law_of(FRICTIONS["over slip"])
        for slip in (0.1, 3.0, 7.0, 49.0):
            expected = np.interp(slip, [0, 5, 50], [20, 12, 15])
            assert law.torque(0.0, slip) == pytest.approx(expected)
            assert law.torque(0.0, -slip) == pytest.approx(-expected)

    def test_sticks_up_to_its_stick_torque(self):
        for kind, greatest in (("constant", 30), ("over slip", 20), ("Jenkins", 20)):
            curve = law_of(FRICTIONS[kind]).curve
            assert curve.holds(MotionState())
            (hold,) = (piece for piece in curve.pieces if isinstance(piece, Hold))
            assert (hold.at, hold.low, hold.high) == (0, -greatest, greatest)

    def test_stores_nothing(self):
        assert law_of(FRICTIONS["constant"]).energy(0.7) == 0

    def test_stuck_it_is_rigid_or_its_spring(self):
        assert FRICTIONS["constant"].parts(Values({})) == (Constraint({"a": 1, "b": -1}),)
        spring, stuck = FRICTIONS["Jenkins"].parts(Values({}))
        assert spring == Law({"a": 1, "e.slider": -1}, stiffness=400)
        assert stuck == Constraint({"e.slider": 1, "b": -1})

    def test_slipping_it_has_the_slope_of_its_rows(self):
        (tangent,) = law_of(FRICTIONS["over slip"]).tangent(MotionState(rate=3.0))
        assert (tangent.stiffness, tangent.damping) == (0, pytest.approx(-1.6))
        slips = [state.rate for state in law_of(FRICTIONS["over slip"]).curve.states_at(14.0)]
        assert slips == pytest.approx([0, 3.75, 35])

    def test_to_ground_it_lets_a_shaft_turn(self):
        assert tn.Friction("e", nodes=("a", "ground"), torque=20).mean_speed_rows(Values({})) == ()


class TestEnds:
    @pytest.mark.parametrize(
        ("kind", "inside", "beyond", "said"),
        [
            ("rows both ways", {"twist": -0.3}, {"twist": 0.31}, "from -0.3 rad to 0.3 rad, and the twist is 0.31 rad"),
            ("rows through zero", {"twist": 0.5}, {"twist": -0.41}, "from -0.4 rad to 0.5 rad, and the twist is -0.41"),
            ("over slip", {"twist": 9, "rate": 50}, {"twist": 0, "rate": 51}, "and the slip speed is 51 rad/s"),
        ],
    )
    def test_beyond_the_last_row_the_torque_is_not_known(self, kind, inside, beyond, said):
        curve = law_of(EVERY[kind]).curve
        assert curve.left(**inside) == ""
        assert said in curve.left(**beyond)
        assert "extend the table" in curve.left(**beyond)

    def test_a_last_stage_may_have_an_end(self):
        spring = tn.Spring(
            "e", **ENDS, stages=[{"stiffness": 100, "to": "0.1 rad"}, {"stiffness": 300, "to": "40 N*m"}]
        )
        assert law_of(spring).curve.range() == pytest.approx((-0.2, 0.2))
        assert law_of(SPRINGS["stages"]).curve.range() == (None, None)
        assert law_of(SPRINGS["cubic"]).curve.left(1e9) == ""

    def test_states_end_with_the_table(self):
        assert law_of(SPRINGS["rows both ways"]).curve.states_at(91) == ()
        assert [state.twist for state in law_of(SPRINGS["rows both ways"]).curve.states_at(90)] == [0.3]


def test_of_a_level_piece_the_place_next_to_zero_counts():
    curve = law_of(SPRINGS["rows through zero"]).curve
    assert [state.twist for state in curve.states_at(4)] == [0]
    shifted = PieceCurve("twist", (Slope(4, 0, 0, 1, 2), Slope(-16, 10, 0, 2, 3)))
    assert [(state.twist, state.piece) for state in shifted.states_at(4)] == [(1, 0)]


def test_softening_spring_has_three_twists_for_a_torque():
    """100 x - 30 x^3 = 50."""
    found = [state.twist for state in CubicCurve(100, -30).states_at(50)]
    assert found == pytest.approx(sorted(np.roots([-30, 0, 100, -50]).real), rel=1e-12)
    assert len(found) == 3


def test_a_softening_spring_says_what_it_bears():
    """100 x - 30 x^3 rises up to x = sqrt(100/90): 200/3 sqrt(10)/3 N m."""
    rig = tn.Drivetrain(
        "rig",
        [tn.Inertia(node, node=node, inertia=1) for node in "ab"] + [tn.Spring("e", **ENDS, stiffness=100, cubic=-30)],
    )
    with pytest.raises(tn.ModelError, match=r"elements\.e: .*71.*70\.2728.*no-solution"):
        rig.at(torque={"a": 71, "b": -71}).modes()


def test_symmetric_curve_is_its_own_mirror_image():
    curve = symmetric_curve("twist", (Hold(0, -2, 2), Slope(2, 5, 0, 0, 1), Slope(-3, 10, 0, 1, None)))
    assert curve.scaled(-1) == curve
    assert curve.number_at(0, 0) == curve.rest == 2


class TestAlgebras:
    def test_symbols(self):
        """Torque and tangent of a clearance with symbols for all its entries, in contact."""
        import sympy

        b, k, c = sympy.symbols("b k c")
        record = SymbolRecord()
        values = {name: record.parameter(name, value) for name, value in {"b": 0.2, "k": 100, "c": 3}.items()}
        law = law_of(tn.Clearance("e", **ENDS, gap="b", stiffness="k", damping="c"), record.algebra, values)
        torque = law.torque(record.parameter("x", 0.3), record.parameter("v", 1))
        assert sympy.expand(symbol_of(torque) - (k * (sympy.Symbol("x") - b / 2) + c * sympy.Symbol("v"))) == 0
        (tangent,) = law.tangent(MotionState(0.3, piece=2))
        assert (symbol_of(tangent.stiffness), symbol_of(tangent.damping)) == (k, c)

    def test_derivatives(self):
        k, cubic = Dual(Fraction(100), np.array([1.0, 0.0])), Dual(Fraction(300), np.array([0.0, 1.0]))
        spring = tn.Spring("e", **ENDS, stiffness="k", cubic="k3")
        law = law_of(spring, DUALS, {"k": k, "k3": cubic})
        assert law.torque(Fraction(1, 2), 0).gradient == pytest.approx([0.5, 0.125])
        assert law.energy(Fraction(1, 2)).gradient == pytest.approx([0.125, 0.015625])
        (tangent,) = law.tangent(MotionState(0.5))
        assert tangent.stiffness.gradient == pytest.approx([1, 0.75])

    def test_symbolic_stiffness_of_a_drivetrain(self):
        import sympy

        rig = tn.Drivetrain(
            "rig",
            [
                tn.Inertia("j", node="a", inertia=2),
                tn.Spring("s", nodes=("a", "b"), stiffness="k", cubic="k3"),
                tn.Inertia("i", node="b", inertia=3),
                tn.Friction("rub", nodes=("b", "ground"), torque="T", stiffness="k_r"),
            ],
            {"k": 100, "k3": 300, "T": 4, "k_r": 70},
        )
        found = rig.symbolic().K
        k, k_r = (next(one for one in found.free_symbols if one.name == name) for name in ("k", "k_r"))
        assert found == sympy.Matrix([[k, -k], [-k, k + k_r]])


def test_tangents_about_states_are_in_the_order_of_the_laws():
    """A copy at states keeps its entries and its whole laws."""
    spring = SPRINGS["preloaded stages"]
    found = spring.at_states([MotionState(0.12, piece=5)])
    (law,) = found.parts(Values({}))
    assert law.stiffness == 400
    assert found.stages == spring.stages
    assert found.whole_parts(Values({})) == spring.whole_parts(Values({}))
    assert spring.at_states([MotionState(0.1, piece=4)]).parts(Values({})) == (Constraint({"a": 1, "b": -1}),)


def test_other_laws_go_with_an_element_into_its_pickle_but_not_to_other_entries():
    spring = SPRINGS["preloaded stages"]
    found = spring.at_states([MotionState(0.12, piece=5)])
    restored = pickle.loads(pickle.dumps(found))
    assert restored == found != spring
    assert hash(restored) == hash(found)
    assert restored.parts(Values({})) == found.parts(Values({}))
    assert replace(found, description="as written") == replace(spring, description="as written")


def test_damping_is_parallel_and_linear():
    """A measure of damping refers to the stiffness at rest: c = 2 zeta k/(2 pi f)."""
    spring = tn.Spring("e", **ENDS, stages=STAGES, damping={"zeta": 0.05, "at": "8 Hz"})
    law, damper = spring.whole_parts(Values({}, FLOAT))
    assert isinstance(law, MotionLaw)
    assert damper.damping == pytest.approx(2 * 0.05 * 100 / (2 * math.pi * 8))
    assert damper.row == law.row


class TestReferred:
    """A spring quoted at a shaft that turns r times as fast has r times the torque there, at r times the twist."""

    def rig(self, element):
        parts = [tn.Inertia("j", node="fast", inertia=1), tn.Gear("g", nodes=("fast", "slow"), ratio=-3), element]
        rig = tn.Drivetrain("rig", [*parts, tn.Inertia("i", node="end", inertia=2)])
        return next(one for one in rig.definition.active if one.name == "e")

    @pytest.mark.parametrize("kind", [*SPRINGS, *FRICTIONS])
    def test_law_and_tangents(self, kind):
        if kind in ("gear", "planetary"):
            pytest.skip("a mesh is on several shafts")
        element = replace(EVERY[kind], nodes=("slow", "end"), referred_to="fast")
        found, quoted = self.rig(element), law_of(element)
        law = law_of(found)
        for twist, rate in ((0.03, 0.4), (-0.05, -2.0)):
            expected = -3 * quoted.torque(-3 * twist, -3 * rate)
            assert law.torque(twist, rate) == pytest.approx(expected, rel=1e-12)
        state = MotionState(0.03, 0.4)
        expected = [part.tangent(MotionState(-0.09, -1.2)) if isinstance(part, MotionLaw) else (part,)
                    for part in element.whole_parts(Values({}, FLOAT))]  # fmt: skip
        for one, given in zip(found.at_states([state]).parts(Values({}, FLOAT)), sum(expected, ()), strict=True):
            assert (one.stiffness, one.damping) == pytest.approx((9 * given.stiffness, 9 * given.damping))


@pytest.mark.parametrize("kind", EVERY)
def test_survives_the_way_through_a_file(kind, tmp_path):
    element = EVERY[kind]
    nodes = [node for node in element.ports.values() if node != "ground"]
    rig = tn.Drivetrain("rig", [element, *(tn.Inertia(f"j_{node}", node=node, inertia=1) for node in nodes)])
    rig.to_yaml(tmp_path / "rig.yaml")
    again = tn.load(tmp_path / "rig.yaml")
    assert again.definition.elements["e"] == element
    assert law_of(again.definition.elements["e"]) == law_of(element)


@pytest.mark.parametrize(("torque", "rates"), [(-15.0, [0.0]), (4.0, [0.0]), (15.0, [0.0]), (15.1, [])])
def test_friction_under_its_own_torque_stands(torque, rates):
    """5 N m of one, and of one that turns twice as fast: 5 + 2 * 5 hold at any speed, of which rest is the one told."""
    law = MotionLaw({"a": 1.0}, friction_curve(5.0, 5.0))
    assert roots_along([law, law], [1.0, 2.0], torque) == rates


def test_twists_next_to_the_greatest_torque_of_a_softening_spring():
    """Two roots run together where the spring is softest, and a polynomial's roots have half the digits there."""
    curve = CubicCurve(100, -30)
    greatest = 200 / 3 * math.sqrt(10) / 3
    for state in curve.states_at(greatest * (1 - 1e-10)):
        assert curve.torque(state.twist, 0) == pytest.approx(greatest * (1 - 1e-10), rel=1e-15)


class Coupling:
    """Law between two free masses whose torque has slopes over its own rate and over the speed of the first."""

    def __init__(self, over_rate, over_first):
        self.law = self.curve = self
        self.scale, self.sensed = 1.0, ({"p": 1},)
        self.slopes = lambda _: (0.0, over_rate, over_first)
        self.holds = lambda _: False


@pytest.mark.parametrize(("over_rate", "over_first"), [(1, 3), (1, -1.9), (1, -2.1), (-1, 2.1), (-1, 1.9), (1, -3)])
def test_speeds_return_by_the_slopes_over_the_rate_and_over_a_sensed_speed(over_rate, over_first):
    """D = [[a + b, -a], [-a - b, a]] of equal masses has the eigenvalues 0 and 2 a + b."""
    from types import SimpleNamespace

    network = SimpleNamespace(
        free_motions=["p", "t"],
        linear=[],
        free=SimpleNamespace(in_floats=lambda row: {k: float(v) for k, v in row.items()}),
    )
    law = Coupling(over_rate, over_first)
    returns = returns_to_speeds(network, {law: np.array([1.0, -1.0])}, {law: SimpleNamespace(state=None)})
    assert returns == (2 * over_rate + over_first > 0)


@pytest.mark.parametrize(("amplitude", "mean", "omega"), [(0.02, 0.0, 50.0), (0.02, 0.004, 100.0), (0.005, 0.016, 3e3)])
def test_contact_with_damping_over_one_harmonic(amplitude, mean, omega):
    """Closed form against the mean over 1e6 phases of max(0, k d + c d') on either side."""
    gap, k, c = 0.02, 8000.0, 3.0
    phases = 2 * np.pi * (np.arange(1_000_000) + 0.5) / 1_000_000
    twist, rate = mean + amplitude * np.cos(phases), -amplitude * omega * np.sin(phases)
    torque = np.zeros_like(twist)
    for side in (1, -1):
        depth = side * twist - gap / 2
        torque += side * np.where(depth > 0, np.maximum(0.0, k * depth + c * side * rate), 0.0)
    found = describing_function(clearance_curve(gap, k, c), amplitude, mean, omega)
    assert found.stiffness == pytest.approx(2 * np.mean(torque * np.exp(-1j * phases)) / amplitude, rel=1e-6)
    assert found.mean_torque == pytest.approx(np.mean(torque), rel=1e-6, abs=1e-6)

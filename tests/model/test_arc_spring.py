"""Arc springs in a flywheel and as an element: linear results at a swing, a mean torque and a speed."""

import math

import numpy as np
import pytest
from support.faults import faults_of

import torsionnet as tn
from torsionnet.linear.sensitivity import mode_sensitivities
from torsionnet.model.elements import Values

ARC = {
    "stiffness": 700, "arc_angle": 2.6, "friction_coefficient": 0.12, "spring_mass": 0.9, "spring_radius": 0.11,
    "speed": "3000 rpm", "torque": 276.2278014, "swing": "2 deg",
}  # fmt: skip
MASSES = {"primary_inertia": 0.15, "secondary_inertia": 0.06}
RIG = """torsionnet: 1
parameters:
  T_m: {by: mean_torque, of: dmf}
  W: {by: speed, of: crank}
  a: 2 deg
elements:
  dmf: {type: dual_mass_flywheel, nodes: [crank, sec], primary_inertia: 0.15, secondary_inertia: 0.06, stiffness: 700,
    arc_angle: 2.6 rad, friction_coefficient: 0.12, spring_mass: 0.9, spring_radius: 110 mm, speed: W, torque: T_m,
    swing: a}
  shaft: {type: spring, nodes: [sec, veh], stiffness: 3000, damping: 1}
  vehicle: {type: inertia, node: veh, inertia: 3}
speeds: {of: crank, rated: 3000 rpm, range: [1500 rpm, 3500 rpm], step: 500 rpm}
operating_point: {torque: {crank: 276.2278014, veh: -276.2278014}}
inputs: {T: {torque: crank}}
sensors: {twist: {twist: dmf}}
"""


def flywheel(**given):
    return tn.DualMassFlywheel("dmf", nodes=("a", "b"), **MASSES | ARC | given)


def arcs(**given):
    return tn.ArcSpring("arcs", nodes=("a", "b"), **ARC | given)


def law(element):
    return element.parts(Values({}))[0]


class TestLinearLaw:
    def test_is_the_first_harmonic_of_the_slow_loop(self):
        """k' 2490.37 at 20 deg +- 2 deg, the mean torque of which over a sine is 276.2278 N m; eta_1 1/2."""
        for element in (arcs(), flywheel()):
            assert law(element).stiffness == pytest.approx(2490.3706, rel=1e-7)
            assert law(element).loss_factor == 0.5

    def test_at_standstill_too(self):
        """Friction of the spring force alone: ±10 deg about 20 deg lose 23.530755 J."""
        found = law(arcs(speed=0, swing="10 deg", torque=252.4414689))
        assert math.pi * found.stiffness * found.loss_factor * math.radians(10) ** 2 == pytest.approx(
            23.530755, rel=1e-6
        )

    def test_basic_friction_and_a_loss_factor_add_to_it(self):
        """4 M/(pi a) and eta k'."""
        found, alone = law(flywheel(friction=3, loss_factor=0.04)), law(flywheel())
        more = 4 * 3 / (math.pi * math.radians(2)) + 0.04 * alone.stiffness
        assert found.stiffness * found.loss_factor == pytest.approx(alone.stiffness * 0.5 + more, rel=1e-12)

    def test_without_an_arc_the_lumped_friction_is_as_before(self):
        """M = mu C: 4 M a is 0 J at rest, and of ±.5 and ±10 deg at 3000 rpm 4.50 and 90.0 J: arc springs lose .366 and
        23.5 J at rest, .609 and 51.7 J then.
        """
        given = {name: value for name, value in ARC.items() if name not in ("arc_angle", "torque")}
        for speed, swing, loss in (("3000 rpm", 10, 90.04), ("3000 rpm", 0.5, 4.502), (0, 10, 0.0)):
            a = math.radians(swing)
            one = law(tn.DualMassFlywheel("dmf", nodes=("a", "b"), **MASSES | given | {"speed": speed, "swing": a}))
            assert one.stiffness == 700
            assert math.pi * 700 * one.loss_factor * a**2 == pytest.approx(loss, abs=0.01)

    def test_the_flange_may_leave_the_springs(self):
        """Without mean torque nothing locks; at standstill k' is between the slopes of loading and unloading."""
        found = law(arcs(speed=0, torque=0))
        e = 0.12 * 2.6
        assert 700 * e / math.expm1(e) < found.stiffness < 700 * e / -math.expm1(-e)
        assert 0 < found.loss_factor < 0.5


class TestOperatingPoint:
    def test_torque_and_speed_follow_it(self):
        found = tn.loads(RIG)
        plain = tn.loads(RIG.replace("speed: W", "speed: 3000 rpm").replace("torque: T_m", "torque: 276.2278014"))
        f = [3.0, 8.0, 30.0]
        expected = plain.frequency_response("twist", "T", f).values
        np.testing.assert_allclose(found.frequency_response("twist", "T", f).values, expected, rtol=1e-9)

    def test_stiffness_rises_with_the_speed_and_falls_with_the_swing(self):
        rig = tn.loads(RIG.replace("speed: W", "speed: w").replace("  a: 2 deg", "  a: 2 deg\n  w: 3000 rpm"))
        first = [
            rig.configured(**given).modes().undamped_natural_frequencies[1]
            for given in ({"w": 157.08}, {}, {"a": math.radians(0.5)})
        ]
        assert first[0] < first[1] < first[2]

    def test_its_formula_holds_while_coils_are_locked(self):
        """k' = 8/(3 pi) sqrt(2 k e (u - (3/4 - 2/pi) 2 k e a)/a) with u = T + C/psi."""
        K = tn.loads(RIG).symbolic().K
        values = {"T_m": 300.0, "W": 200.0, "a": 0.02}
        u, ke = 300 + 0.9 * 0.11**2 * 200**2 / 2.6, 700 * 0.12 * 2.6
        expected = 8 / (3 * math.pi) * math.sqrt(2 * ke * (u - (0.75 - 2 / math.pi) * 2 * ke * 0.02) / 0.02)
        assert float(K[0, 0].subs(values)) == pytest.approx(expected, rel=1e-9)

    @pytest.mark.parametrize("swing", ["2 deg", "10 deg"])
    def test_derivatives_are_those_of_differences(self, swing):
        """Locked coils by the formula, beyond by tangents of the loop."""
        rig = tn.loads(RIG.replace("a: 2 deg", f"a: {swing}"))
        at = math.radians(float(swing.split()[0]))
        found = mode_sensitivities(rig, ["a"]).pole_slopes[:, 0]
        low, high = (rig.configured(a=at * (1 + step)).modes().eigenvalues for step in (-1e-4, 1e-4))
        np.testing.assert_allclose(found[-2:], ((high - low) / (2e-4 * at))[-2:], rtol=1e-4)


class TestInTime:
    def test_a_linear_drivetrain_says_that_it_stays_at_the_swing(self):
        record = tn.loads(RIG).simulate("twist", {"T": [0.0] * 50}, 1000.0)
        assert any("dmf" in note and "linear about the working point" in note for note in record.notes)

    def test_beside_laws_of_motion_its_friction_acts_in_full(self):
        rig = tn.loads(RIG.replace("stiffness: 3000", "stiffness: 3000, cubic: 100"))
        record = rig.simulate("twist", {"T": [0.0] * 10 + [5.0] * 40}, 1000.0)
        assert record.energy.dissipated["dmf"] > 0
        assert not any("dmf" in note and "linear" in note for note in record.notes)


class TestBadInput:
    @pytest.mark.parametrize("left_out", ["torque", "swing", "speed", "spring_mass", "spring_radius"])
    def test_an_arc_names_what_it_lacks(self, left_out):
        with pytest.raises(tn.ModelError, match=f"(?s)here is no {left_out}.*missing-entry"):
            flywheel(**{left_out: None})

    def test_blocked_coils_follow_from_the_swing(self):
        assert faults_of(lambda: flywheel(blocked=0.2)) == [("contradicting-entries", ("elements", "dmf", "blocked"))]

    def test_numbers_without_sense(self):
        text = RIG.replace("arc_angle: 2.6 rad, friction_coefficient: 0.12", "arc_angle: 0, friction_coefficient: -0.1")
        assert faults_of(lambda: tn.loads(text.replace("a: 2 deg", "a: 0 deg"))) == [
            ("out-of-range", ("elements", "dmf", "arc_angle")),
            ("out-of-range", ("elements", "dmf", "friction_coefficient")),
            ("out-of-range", ("elements", "dmf", "swing")),
        ]

    def test_without_a_swing_there_is_no_loop(self):
        parts = [tn.Inertia("J", node="a", inertia=1), arcs(swing=0)]
        assert faults_of(lambda: tn.Drivetrain("rig", parts)) == [("out-of-range", ("elements", "arcs", "swing"))]

    def test_stages_have_no_arc(self):
        stages = [{"stiffness": 300}]
        with pytest.raises(tn.ModelError, match="missing-entry"):
            flywheel(stiffness=None, stages=stages)


class TestLowFrequencyPhase:
    """Lag of theta_1 behind T_T on the flywheel rig at .4 Hz, where a test shows about 15 deg."""

    @staticmethod
    def lag(dmf):
        rig = tn.load("dmf_rig")
        elements = [dmf if one.name == "dmf" else one for one in rig.elements.values()]
        changed = tn.Drivetrain(
            "rig", elements, parameters=dict(rig.definition.parameters), inputs=rig.inputs, sensors=rig.sensors
        )
        return -float(changed.frequency_response("theta_1", "T_T", [0.4]).phase[0, 0, 0])

    def test_viscous_damping_leaves_almost_none(self):
        assert self.lag(tn.load("dmf_rig").elements["dmf"]) == pytest.approx(1.5, abs=0.5)

    def test_friction_of_arc_springs_makes_it(self):
        """At standstill, +-2 deg: atan(eta_1) and the little of inertia and bearings, by a mean torque of 50 N m."""
        found = self.lag(
            tn.ArcSpring(
                "dmf", nodes=("primary", "secondary"), stiffness=400, arc_angle=2.6, friction_coefficient=0.12,
                spring_mass=0.9, spring_radius=0.11, speed=0, torque=50, swing="2 deg",
            )
        )  # fmt: skip
        assert 12 < found < 27

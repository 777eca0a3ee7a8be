"""A dual mass flywheel against the same thing built of parts, and friction against its loop of torque over twist."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.elements import Values

GIVEN = {"primary_inertia": 0.09, "secondary_inertia": 0.05}
STAGES = [{"stiffness": 300, "to": "0.5 rad"}, {"stiffness": 1000, "to": "250 N*m"}, {"stiffness": 2000}]


def dmf(**given):
    return tn.DualMassFlywheel("dmf", nodes=("primary", "secondary"), **GIVEN | given)


def springs(**given):
    return dmf(**given).parts(Values({}))[0]


def test_in_the_rig_of_the_library_it_is_its_flywheel_and_spring():
    """Secondary side locked there: primary mass, arc springs and their damping become one element."""
    rig = tn.load("dmf_rig")
    kept = [element for name, element in rig.elements.items() if name not in ("flywheel", "dmf")]
    one = tn.DualMassFlywheel(
        "dmf", nodes=("primary", "secondary"), primary_inertia="I_2", secondary_inertia=0.05, stiffness="k_2",
        damping="c_2",
    )  # fmt: skip
    changed = tn.Drivetrain(
        "one", [*kept, one], parameters=dict(rig.definition.parameters), inputs=rig.inputs, sensors=rig.sensors
    )
    f = [0.5, 7.0, 60.0]
    np.testing.assert_allclose(
        changed.frequency_response("theta_1", "T_T", f).values,
        rig.frequency_response("theta_1", "T_T", f).values,
        rtol=1e-12,
    )
    np.testing.assert_allclose(changed.modes().eigenvalues, rig.modes().eigenvalues, rtol=1e-10)
    soft = [one.configured(k_2=300, c_2=1).modes().eigenvalues for one in (changed, rig)]
    np.testing.assert_allclose(*soft, rtol=1e-10)


def test_is_two_inertias_and_a_hysteretic_spring():
    ends = {"inputs": {"T": {"torque": "primary"}}, "sensors": {"out": {"angle": "secondary"}}}
    one = tn.Drivetrain("one", [dmf(stiffness=900, loss_factor=0.2)], **ends)
    parts = tn.Drivetrain(
        "parts",
        [
            tn.Inertia("first", node="primary", inertia=0.09),
            tn.Inertia("second", node="secondary", inertia=0.05),
            tn.HystereticSpring("arcs", nodes=("primary", "secondary"), stiffness=900, loss_factor=0.2),
        ],
        **ends,
    )
    f = [1.0, 20.0, 90.0]
    found, expected = (rig.frequency_response("out", "T", f).values for rig in (one, parts))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


class TestStages:
    @pytest.mark.parametrize(
        ("torque", "stiffness"), [(0, 300), (150, 300), (151, 1000), (-200, 1000), (250, 1000), (251, 2000)]
    )
    def test_the_mean_torque_tells_the_stage(self, torque, stiffness):
        """The first ends at 0.5 rad, which is 150 N m; drive and coast alike."""
        assert springs(stages=STAGES, torque=torque).stiffness == stiffness

    def test_angles_after_torques(self):
        """100 N m at 0.2 rad, then 400 N m/rad to 0.7 rad: 300 N m."""
        stages = [{"stiffness": 500, "to": "100 N*m"}, {"stiffness": 400, "to": "0.7 rad"}, {"stiffness": 900}]
        assert [springs(stages=stages, torque=one).stiffness for one in (299, 301)] == [400, 900]

    def test_a_configuration_overrides_the_torque(self):
        text = """torsionnet: 1
elements:
  dmf: {type: dual_mass_flywheel, nodes: [a, b], primary_inertia: 0.1, secondary_inertia: 0.1, torque: 20 N*m,
    stages: [{stiffness: 6 N*m/deg, to: 120 N*m}, {stiffness: 14 N*m/deg}]}
configurations: {load: {part: {}, full: {dmf.torque: 200 N*m}}}
"""
        rig = tn.loads(text)
        found = [rig.configured(name).modes().natural_frequencies[-1] for name in ("part", "full")]
        assert found[1] / found[0] == pytest.approx(np.sqrt(14 / 6), rel=1e-12)


class TestFriction:
    def test_loses_what_a_loop_of_friction_loses(self):
        """Of one cycle: integral of M sign(dphi/dt) dphi, by sums over the cycle; that of the law is pi k eta alpha^2."""
        friction, swing = 8.0, 0.05
        law = springs(stiffness=900, friction=friction, swing=swing)
        phi = swing * np.sin(np.linspace(0, 2 * np.pi, 4001))
        loop = np.sum(friction * np.sign(np.diff(phi)) * np.diff(phi))
        assert np.pi * law.stiffness * law.loss_factor * swing**2 == pytest.approx(loop, rel=1e-9)

    def test_springs_are_pressed_outward(self):
        """mu m r omega^2 on the radius r."""
        pressed = {"friction_coefficient": 0.1, "spring_mass": 0.8, "spring_radius": 0.11, "speed": 200}
        both = springs(stiffness=900, friction=3, swing=0.05, **pressed).loss_factor
        one = springs(stiffness=900, friction=3 + 0.1 * 0.8 * 0.11 * 200**2 * 0.11, swing=0.05).loss_factor
        assert both == pytest.approx(one, rel=1e-12)

    def test_blocked_coils_leave_a_stiffer_spring(self):
        """Half of the coils: twice the stiffness."""
        assert springs(stiffness=900, blocked=0.5).stiffness == 1800


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, r"elements\.dmf: .*missing-entry"),
        ({"stiffness": 1, "stages": STAGES, "torque": 1}, "not both"),
        ({"stages": STAGES[:2], "torque": 300}, r"elements\.dmf\.torque: .*250.*contradicting-values"),
        ({"stages": [{"stiffness": 300}, {"stiffness": 400}], "torque": 1}, "give it as to:"),
        ({"stages": [{"stiffness": 300, "to": 20}], "torque": 1}, "with its unit"),
        ({"stages": [*STAGES[:2], {"stiffness": 9, "to": "240 N*m"}], "torque": 1}, "rising torques"),
        ({"stages": [{"stifness": 300}], "torque": 1}, 'did you mean "stiffness"'),
        ({"stiffness": 1, "speed": 3, "swing": 1}, r"elements\.dmf: .*missing-entry"),
        ({"stiffness": 1, "blocked": 1}, "below 1"),
    ],
)
def test_contradictions_are_named(given, words):
    with pytest.raises(tn.ModelError, match=words):
        dmf(**given)

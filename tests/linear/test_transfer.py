"""Transfer functions: names, torque at ports, measured inputs, limits."""

import numpy as np
import pytest
from support.models import geared_line

import torsionnet as tn
from torsionnet.model.channels import Sensor

F = np.array([0.5, 3.0, 12.0, 40.0])


def value(model, output, input="T_M", f=F, **options):
    return model.frequency_response(output, input, f, **options).values[:, 0, 0]


class TestTorques:
    def test_a_gear_multiplies_the_torque(self):
        rig = geared_line()
        into, out = value(rig, "torque(stage)"), value(rig, "torque(stage, o)")
        np.testing.assert_allclose(out, 3 * into, rtol=1e-13)

    def test_a_clamp_takes_what_the_spring_before_it_carries(self):
        rig = geared_line()
        np.testing.assert_allclose(value(rig, "torque(brake)"), value(rig, "torque(stiff)"), rtol=1e-12)
        np.testing.assert_allclose(value(rig, "torque(stiff)"), value(rig, "torque(stage, o)"), rtol=1e-12)

    def test_a_torque_meter_reads_what_the_motor_does_not_keep(self):
        rig = geared_line()
        s = 2j * np.pi * F
        kept = 0.2 * s**2 * value(rig, "angle")
        np.testing.assert_allclose(value(rig, "T"), 1 - kept, rtol=1e-12)

    def test_ports_by_node_or_by_name(self):
        rig = geared_line()
        np.testing.assert_array_equal(value(rig, "torque(stage, o)"), value(rig, "torque(stage, second)"))

    def test_sensor_objects_and_text_are_the_same(self):
        rig = geared_line()
        sensor = Sensor("torque", "stage", at="o")
        np.testing.assert_array_equal(value(rig, sensor), value(rig, "torque(stage, o)"))

    def test_spring_to_ground_hands_its_torque_over(self):
        rig = tn.Drivetrain(
            "x", [tn.Inertia("j", node="a", inertia=1), tn.Spring("k", nodes=("a", "ground"), stiffness=50, damping=2)]
        )
        s = 2j * np.pi * F
        expected = (50 + 2 * s) / (s**2 + 2 * s + 50)
        for text in ("torque(k)", "torque(k, ground)"):
            np.testing.assert_allclose(value(rig, text, "a"), expected, rtol=1e-13)

    def test_indeterminate_torque_is_refused(self):
        model = tn.Drivetrain(
            "loop",
            [
                tn.Inertia("j", node="a", inertia=1),
                tn.Gear("g1", nodes=("a", "b"), ratio=2),
                tn.Gear("g2", nodes=("b", "c"), ratio=3),
                tn.Gear("g3", nodes=("a", "c"), ratio=6),
                tn.RigidCoupling("out", nodes=("c", "d")),
                tn.Spring("k", nodes=("d", "ground"), stiffness=5),
            ],
        )
        with pytest.raises(tn.UsageError, match="indeterminate-torque"):
            model.frequency_response("torque(g2)", "a", F)
        np.testing.assert_allclose(value(model, "torque(out)", "a"), value(model, "torque(k)", "a"), rtol=1e-13)


class TestPorts:
    def test_a_name_that_is_a_port_and_the_node_of_another_is_refused(self):
        model = tn.Drivetrain(
            "simpson",
            [
                tn.Planetary("p2", sun="sun", ring="r2", carrier="ring", ratio=2),
                *(tn.Inertia(f"j{node}", node=node, inertia=1) for node in ("sun", "r2", "ring")),
            ],
        )
        with pytest.raises(tn.UsageError, match="unknown-port"):
            model.frequency_response("torque(p2, ring)", "sun", F)
        assert len(value(model, "torque(p2, carrier)", "sun")) == 4

    def test_an_open_clutch_carries_nothing(self):
        rig = geared_line(k_1=0, c=0)
        np.testing.assert_array_equal(value(rig, "torque(soft)"), 0)


class TestMeasuredInputs:
    def test_chain_rule(self):
        rig = geared_line()
        np.testing.assert_allclose(value(rig, "angle", "T") * value(rig, "T"), value(rig, "angle"), rtol=1e-12)

    def test_several_measured_inputs_invert_the_matrix(self):
        rig = tn.Drivetrain(
            "two motors",
            [
                tn.Inertia("a", node="a", inertia=1),
                tn.RigidCoupling("m1", nodes=("a", "b")),
                tn.Spring("k1", nodes=("b", "c"), stiffness=900),
                tn.Inertia("c", node="c", inertia=2),
                tn.Spring("k2", nodes=("c", "d"), stiffness=700, damping=3),
                tn.RigidCoupling("m2", nodes=("d", "e")),
                tn.Inertia("e", node="e", inertia=3),
            ],
            inputs={"T_a": {"torque": "a"}, "T_e": {"torque": "e"}},
        )
        H = rig.frequency_response(["c", "b"], ["torque(m1)", "torque(m2)"], F, driven_by=["T_a", "T_e"])
        outputs = rig.frequency_response(["c", "b"], ["T_a", "T_e"], F).values
        measured = rig.frequency_response(["torque(m1)", "torque(m2)"], ["T_a", "T_e"], F).values
        np.testing.assert_allclose(H.values @ measured, outputs, rtol=1e-10)
        # Against cut torques the middle part stands alone: k1 and k2 carry the torques into the inertia c.
        s = 2j * np.pi * F
        np.testing.assert_allclose(H.values[:, 0, 0], 1 / (2 * s**2), rtol=1e-10)
        np.testing.assert_allclose(H.values[:, 0, 1], -1 / (2 * s**2), rtol=1e-10)

    def test_cancelled_measured_input_is_reported(self):
        """At the resonance of the far side alone its torque at the meter vanishes without losses."""
        model = tn.Drivetrain(
            "absorber",
            [
                tn.Inertia("m", node="a", inertia=1),
                tn.RigidCoupling("meter", nodes=("a", "b")),
                tn.Inertia("j", node="b", inertia=1),
                tn.Spring("k", nodes=("b", "ground"), stiffness=(2 * np.pi) ** 2),
            ],
        )
        with pytest.warns(tn.TorsionnetWarning, match=r"torque\(meter\).*first 1 Hz"):
            H = model.frequency_response("a", "torque(meter)", [0.5, 1.0], driven_by="a")
        assert H.conditioning[1] < 1e-10 < H.conditioning[0]


class TestZeroFrequency:
    def test_static_gain_is_the_compliance(self):
        rig = geared_line()
        assert value(rig, "angle", f=[0.0])[0] == pytest.approx(1 / 900 + 9 / 4000, rel=1e-14)

    def test_free_drivetrain_splits_the_torque_by_inertia(self):
        rig = geared_line().switched(off=["brake", "stiff"])
        assert value(rig, "torque(soft)", f=[0.0])[0] == pytest.approx(0.5 / 0.7, rel=1e-14)
        with pytest.warns(tn.TorsionnetWarning, match="turns freely"):
            assert value(rig, "angle", f=[0.0])[0] == np.inf

    def test_drag_alone_makes_the_speed_finite(self):
        model = tn.Drivetrain(
            "drag", [tn.Inertia("j", node="a", inertia=3), tn.Damper("c", nodes=("a", "ground"), damping=4)]
        )
        assert value(model, "velocity(a)", "a", f=[0.0])[0] == pytest.approx(0.25, rel=1e-14)
        assert value(model, "acceleration(a)", "a", f=[0.0])[0] == 0

    def test_compliant_loop_that_closes_only_in_exact_numbers(self):
        """10 * 0.1 is 1: the loop turns freely, though not in binary."""
        gears = [
            tn.Gear("g1", nodes=("a", "b"), ratio=0.1, stiffness=100),
            tn.Gear("g2", nodes=("b", "a"), ratio=10, stiffness=100),
        ]
        loop = tn.Drivetrain("l", [*(tn.Inertia(f"j{n}", node=n, inertia=1) for n in "ab"), *gears])
        with pytest.warns(tn.TorsionnetWarning, match="turns freely"):
            assert value(loop, "a", "a", f=[0.0])[0] == np.inf

    def test_table_without_stiffness_at_rest(self):
        bush = tn.TabulatedSpring("b", nodes=("a", "ground"), table=[[0, 0, 1.0], [50, 100, 1.0]])
        model = tn.Drivetrain("t", [tn.Inertia("i", node="a", inertia=1), bush])
        with pytest.warns(tn.TorsionnetWarning, match="turns freely"):
            assert value(model, "a", "a", f=[0.0])[0] == np.inf

    def test_undamped_resonance_is_infinite_not_a_traceback(self):
        model = tn.Drivetrain(
            "r", [tn.Inertia("j", node="a", inertia=1), tn.Spring("k", nodes=("a", "ground"), stiffness=1)]
        )
        exact = 1 / (2 * np.pi)
        with np.errstate(all="ignore"):
            peak = abs(model.frequency_response("a", "a", [exact]).values[0, 0, 0])
        assert peak > 1e14


class TestImposedAngle:
    def model(self):
        return tn.Drivetrain(
            "shaker",
            [
                tn.Spring("k", nodes=("foot", "a"), stiffness=500, damping=3),
                tn.Inertia("j", node="a", inertia=2),
                tn.Inertia("f", node="foot", inertia=9),
            ],
            inputs={"x": {"angle": "foot"}},
        )

    def test_transmissibility(self):
        s = 2j * np.pi * F
        expected = (500 + 3 * s) / (2 * s**2 + 3 * s + 500)
        np.testing.assert_allclose(value(self.model(), "a", "x"), expected, rtol=1e-13)
        np.testing.assert_allclose(value(self.model(), "foot", "x"), np.ones(4), rtol=1e-15)

    def test_torque_into_the_spring(self):
        s = 2j * np.pi * F
        expected = (500 + 3 * s) * 2 * s**2 / (2 * s**2 + 3 * s + 500)
        np.testing.assert_allclose(value(self.model(), "torque(k)", "x"), expected, rtol=1e-12)

    def test_a_torque_on_the_driven_node_is_refused(self):
        with pytest.raises(tn.UsageError, match="imposed by x"):
            value(self.model(), "a", "foot")

    def test_the_driven_node_stands_still_in_modes(self):
        modes = self.model().modes()
        assert modes.natural_frequencies == pytest.approx([np.sqrt(500 / 2) / 2 / np.pi], rel=1e-12)
        assert modes.shape_at("foot") == 0

    def test_dynamic_stiffness_is_the_kind_of_torque_over_angle(self):
        H = self.model().frequency_response("torque(k)", "x", F)
        assert (H.kind(), H.unit()) == ("dynamic stiffness", "N*m/rad")


class TestQuestions:
    @pytest.mark.parametrize(
        ("output", "input", "options", "words"),
        [
            ("angel", "T_M", {}, 'did you mean "angle"'),
            ("angle", "T_N", {}, "unknown-channel"),
            ("torque(sof)", "T_M", {}, 'did you mean "soft"'),
            ("torque(stage, q)", "T_M", {}, "attached to g"),
            ("velocity(q)", "T_M", {}, "no node"),
            ("angle", "T", {"driven_by": "nobody"}, "no input or node"),
            ("angle", ["T", "T_M"], {}, "T_M is an excitation"),
            ("angle", ["T", "twist(soft)"], {}, "2 measured"),
            ("angle", "T_M", {"driven_by": "g"}, "wrong-count"),
            ([], "T_M", {}, "at least one"),
            ("angle", "h", {}, "no-effect"),
        ],
    )
    def test_wrong_names_are_answered(self, output, input, options, words):
        with pytest.raises(tn.UsageError, match=words.replace("(", r"\(")):
            geared_line().frequency_response(output, input, F, **options)

    @pytest.mark.parametrize("frequencies", [[-1.0], [np.nan], [[1.0]], [np.inf]])
    def test_wrong_frequencies(self, frequencies):
        with pytest.raises(tn.UsageError, match="in Hz"):
            geared_line().frequency_response("angle", "T_M", frequencies)

    def test_excitation_must_be_named_among_several(self):
        rig = geared_line()
        two = tn.Drivetrain(
            "two", rig.elements.values(), rig.parameters, {"T_M": {"torque": "m"}, "T_W": {"torque": "g"}}, rig.sensors
        )
        with pytest.raises(tn.UsageError, match="T_M, T_W"):
            two.frequency_response("angle", "T", F)
        assert value(two, "angle", "T", driven_by="T_M") == pytest.approx(value(rig, "angle", "T"))

    def test_switched_off_parts_are_named(self):
        rig = geared_line().switched(off=["stiff", "brake"])
        with pytest.raises(tn.UsageError, match="switched-off"):
            rig.frequency_response("torque(stiff)", "T_M", F)

"""Excitations by machines, meshes, joints and imposed motions: against dense solves, closed forms and published cases."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from support.command_line import run
from validation.build import build, damper_matrix, read_case, spring_name

import torsionnet as tn
from torsionnet.machinery.excitations.electric_machine import ElectricMachine
from torsionnet.machinery.excitations.harmonic_torque import PropellerTorque
from torsionnet.machinery.excitations.twist_excitation import GearMesh, UniversalJoint
from torsionnet.model.channels import Input
from torsionnet.model.files.reader import read_text

RPM = np.pi / 30
TAU = -61 / 17
NODES = ("motor", "pinion", "wheel")
INERTIA = np.array([1.0, 0.3, 5.0])
SHAFT, SHAFT_ROW = (1e4, 3.0), np.array([1, -1, 0])
MESH, MESH_ROW = (1e7, 50.0), np.array([0, 1, -TAU])
DRAG = 2.0
ELEMENTS = [
    *(tn.Inertia(f"J_{node}", node=node, inertia=J) for node, J in zip(NODES, INERTIA, strict=True)),
    tn.Spring("shaft", nodes=("motor", "pinion"), stiffness=SHAFT[0], damping=SHAFT[1]),
    tn.Gear("stage", nodes=("pinion", "wheel"), teeth=(17, -61), stiffness=MESH[0], damping=MESH[1]),
    tn.Damper("oil", nodes=("wheel", "ground"), damping=DRAG),
]


def kappa(law, omega):
    return law[0] + 1j * omega * law[1]


def dynamic_stiffness(omega):
    """Of motor, pinion and wheel, by hand; omega of either sign."""
    elastic = kappa(SHAFT, omega) * np.outer(SHAFT_ROW, SHAFT_ROW) + kappa(MESH, omega) * np.outer(MESH_ROW, MESH_ROW)
    return elastic + np.diag(-INERTIA * omega**2) + np.diag([0, 0, 1j * omega * DRAG])


def geared(speeds, **excitations):
    return tn.Drivetrain(
        "geared",
        ELEMENTS,
        speeds={"of": "motor", "list": [f"{speed} rpm" for speed in speeds]},
        excitations=excitations,
    )


class TestImposedTwist:
    @pytest.mark.parametrize("method", ["auto", "dense"])
    def test_torque_of_the_mesh_has_the_imposed_part_in_it(self, method):
        f = np.array([1.0, 17.0, 300.0])
        outputs = [*NODES, "torque(stage)", "torque(stage, wheel)", "twist(stage)", "torque(shaft)"]
        rig = tn.Drivetrain("geared", ELEMENTS)
        found = rig.frequency_response(outputs, [Input("twist", "stage"), Input("torque", "motor")], f, method=method)
        for number, omega in enumerate(2 * np.pi * f):
            theta = np.linalg.solve(dynamic_stiffness(omega), kappa(MESH, omega) * MESH_ROW)
            torque = kappa(MESH, omega) * (MESH_ROW @ theta - 1)
            expected = [*theta, torque, TAU * torque, MESH_ROW @ theta, kappa(SHAFT, omega) * (SHAFT_ROW @ theta)]
            assert found.values[number, :, 0] == pytest.approx(np.array(expected), rel=1e-9)
            plain = np.linalg.solve(dynamic_stiffness(omega), [1, 0, 0])
            assert found.values[number, :3, 1] == pytest.approx(plain, rel=1e-9)

    def test_what_gives_no_way_is_refused(self):
        rig = tn.Drivetrain(
            "rigid", [tn.Inertia("A", node="a", inertia=1), tn.RigidCoupling("flange", nodes=("a", "b")),
                      tn.Shaft("long", nodes=("b", "c"), outer_diameter=0.1, length=1, segments=3)]
        )  # fmt: skip
        for element, text in (("flange", "flange is rigid"), ("long", "several springs"), ("flang", "did you mean")):
            with pytest.raises(tn.UsageError, match=text):
                rig.frequency_response("a", Input("twist", element), [1.0])

    def test_a_model_has_no_twist_among_its_inputs(self):
        with pytest.raises(tn.ModelError, match="inputs"):
            tn.Drivetrain("geared", ELEMENTS, inputs={"e": Input("twist", "stage")})


class TestGearMesh:
    @pytest.mark.parametrize("wheel", ["pinion", "wheel"])
    def test_errors_of_either_wheel_against_a_dense_solve(self, wheel):
        """e is how far the wheel runs ahead: on the row theta_p - tau theta_w by 1, or by -tau in the wheel's sense."""
        own, mate = (17, 61) if wheel == "pinion" else (61, 17)
        mesh = {"type": "gear_mesh", "mesh": "stage", "speed_of": wheel, "base_radius": "40 mm",
                "transmission_error": {1: {"way": "4 um", "phase": "30 deg"}, 2: {"angle": "20 urad"}},
                "run_out": {"way": "10 um"}, "mate_run_out": {"way": "6 um", "phase": "90 deg"}}  # fmt: skip
        found = geared([300, 900], mesh=mesh).order_response(["torque(stage)", "velocity(wheel)"])
        orders = [own, 2 * own, 1, own / mate]
        errors = np.array([1e-4 * np.exp(1j * np.pi / 6), 20e-6, 2.5e-4, 1.5e-4j])
        ahead = errors if wheel == "pinion" else errors * -TAU * -1  # the wheel turns backwards
        shaft = 1 if wheel == "pinion" else 17 / 61
        assert [line.order for line in found.lines] == pytest.approx(orders)
        for at, rpm in enumerate((300, 900)):
            for number, order in enumerate(orders):
                omega = rpm * RPM * shaft * order
                theta = np.linalg.solve(dynamic_stiffness(omega), kappa(MESH, omega) * MESH_ROW * ahead[number])
                torque = kappa(MESH, omega) * (MESH_ROW @ theta - ahead[number])
                assert found.values[at, number] == pytest.approx(np.array([torque, 1j * omega * theta[2]]), rel=1e-9)

    def test_tooth_frequencies_of_both_wheels_are_one(self):
        meshes = [
            GearMesh(mesh="stage", speed_of=wheel, transmission_error={1: {"angle": 1e-5}}) for wheel in NODES[1:]
        ]
        rig = geared([600], one=meshes[0], two=meshes[1])
        lines = rig.order_response("torque(stage)").lines
        assert [line.relative for line in lines] == [17, 17]


class TestUniversalJoint:
    def test_orders_are_those_of_the_exact_motion(self):
        """Harmonics of atan2(sin in / cos beta, cos in) - in over a revolution, and the printed numbers at 10 deg."""
        beta, turn = math.radians(35), 2 * np.pi * np.arange(4096) / 4096
        ahead = np.unwrap(np.arctan2(np.sin(turn) / np.cos(beta), np.cos(turn))) - turn
        expected = np.fft.fft(ahead)[[2, 4, 6, 8]] * 2 / 4096
        joint = UniversalJoint(joint="shaft", speed_of="motor", angle=beta, multiples=4)
        found = joint.torques(np.array([10.0]))
        assert -found.amplitudes[0, :, 0] == pytest.approx(expected, rel=1e-9)
        small = UniversalJoint(joint="shaft", speed_of="motor", angle="10 deg").torques(np.array([10.0]))
        assert abs(small.amplitudes[0, :, 0]) == pytest.approx([7.6543e-3, 2.929e-5], rel=2e-4)

    @pytest.mark.parametrize("input", ["motor", "pinion"])
    def test_torque_against_a_dense_solve(self, input):
        joint = {"type": "universal_joint", "joint": "shaft", "speed_of": input, "angle": "12 deg", "phase": "20 deg"}
        found = geared([450], joint=joint).order_response(["torque(shaft)", "wheel"])
        t = math.tan(math.radians(6)) ** 2
        for number, (order, size) in enumerate(((2, t), (4, t * t / 2))):
            omega, forward = order * 450 * RPM, 1 if input == "motor" else -1
            lead = -forward * size * -1j * np.exp(1j * order * math.radians(20))  # of the input over the output
            theta = np.linalg.solve(dynamic_stiffness(omega), kappa(SHAFT, omega) * SHAFT_ROW * lead)
            torque = kappa(SHAFT, omega) * (SHAFT_ROW @ theta - lead)
            assert found.values[0, number] == pytest.approx(np.array([torque, theta[2]]), rel=1e-9)

    def test_two_joints_with_yokes_in_line_undo_each_other(self):
        elements = [
            tn.Inertia("engine", node="a", inertia=1), tn.Inertia("tube", node="b", inertia=1e-9),
            tn.Inertia("axle", node="c", inertia=2), tn.Spring("front", nodes=("a", "b"), stiffness=1e4),
            tn.Spring("rear", nodes=("b", "c"), stiffness=1e4),
        ]  # fmt: skip

        def torque(phase):
            joints = {
                name: {"type": "universal_joint", "joint": name, "angle": "8 deg", "phase": value}
                for name, value in (("front", 0), ("rear", phase))
            }
            rig = tn.Drivetrain("shaft", elements, speeds={"of": "a", "list": [100]}, excitations=joints)
            found = rig.order_response("torque(rear)")
            return abs(found.of_order(2)[0]), abs(found.of_order(2, excitation="front")[0])

        together, alone = torque("90 deg")
        assert together < 1e-6 * alone
        together, alone = torque(0)
        assert together == pytest.approx(2 * alone, rel=1e-6)


class TestImposedMotion:
    def test_two_imposed_motions_and_a_torque_are_held_together(self):
        """Motor and wheel are driven, the pinion feels a torque: against a dense solve for the pinion alone."""
        rig = geared(
            [300, 700],
            shaker={"type": "harmonic", "node": "motor", "orders": {3: {"angle": "0.2 deg", "phase": "40 deg"}}},
            belt={"type": "harmonic", "node": "wheel", "speed_of": "motor", "orders": {3: {"angle": 1e-3}, 5: {"angle": 2e-3}}},
            teeth={"type": "harmonic", "node": "pinion", "orders": {3: {"amplitude": 50}}},
        )  # fmt: skip
        found = rig.order_response(["pinion", "motor", "torque(stage)"])
        drives = [
            ("motor", 3, math.radians(0.2) * np.exp(1j * math.radians(40))),
            ("wheel", 3, -1e-3),
            ("wheel", 5, -2e-3),
        ]
        for at, rpm in enumerate((300, 700)):
            for number, (node, order, size) in enumerate(drives):
                omega = order * rpm * RPM
                given = np.zeros(3, dtype=complex)
                given[NODES.index(node)] = size
                D = dynamic_stiffness(omega)
                given[1] = -(D[1, [0, 2]] @ given[[0, 2]]) / D[1, 1]
                expected = [given[1], given[0], kappa(MESH, omega) * (MESH_ROW @ given)]
                assert found.values[at, number] == pytest.approx(np.array(expected), rel=1e-9)
            omega = 3 * rpm * RPM
            assert found.values[at, 3, :2] == pytest.approx([50 / dynamic_stiffness(omega)[1, 1], 0], rel=1e-9)

    def test_velocity_and_acceleration_are_angles_divided_by_time(self):
        motions = {"a": {"velocity": 3}, "b": {"acceleration": "90 rad/s^2", "phase": "1 rad"}}
        rigs = [
            geared([600], x={"type": "harmonic", "node": "motor", "orders": {2: given}}) for given in motions.values()
        ]
        slow, quick = (rig.order_response(["velocity(motor)", "acceleration(motor)"]).values[0, 0] for rig in rigs)
        assert slow[0] == pytest.approx(3)
        assert quick[1] == pytest.approx(90 * np.exp(1j))

    def test_a_torque_on_what_is_imposed_is_told(self):
        with pytest.raises(tn.ModelError, match=r"excitations\.fan\.node: .*no-effect"):
            geared(
                [300],
                shaker={"type": "harmonic", "node": "motor", "orders": {3: {"angle": 1}}},
                fan={"type": "harmonic", "node": "motor", "orders": {3: {"amplitude": 1}}},
            )


class TestElectricMachine:
    def test_published_wind_turbine(self):
        """Ripple by the generator's torque, cogging apart, 60 pole pairs: every harmonic and their sum of magnitudes."""
        case = read_case("forced_sopanen_windmill")
        base, given, points = read_case(case["model"]), case["excitation"], case["reference_from_openTorsion_0.3.2"]
        rated = given["rated_torque_Nm"]
        first = given["fractions_of_generator_torque"][0] * rated
        share = [[point["rpm"] * RPM, point["amplitude_Nm"][0] / first] for point in points]
        pulsations = {
            order: {"share": fraction, "amplitude": given["cogging_added_to_order_12"] * rated * (order == 12)}
            for order, fraction in zip(given["orders"], given["fractions_of_generator_torque"], strict=True)
        }
        rig = build(base, damper_matrix([node["name"] for node in base["nodes"]], case["damping_matrix_C"]))
        generator = {"type": "electric_machine", "node": given["node"], "pole_pairs": 60, "rated_torque": rated,
                     "torque": share, "electrical_orders": pulsations}  # fmt: skip
        plant = tn.Drivetrain(
            "turbine", rig.elements.values(), excitations={"generator": generator},
            speeds={"of": "n2", "list": [f"{point['rpm']} rpm" for point in points]},
        )  # fmt: skip
        found = plant.order_response([f"torque({spring_name(spring)})" for spring in base["springs"]])
        for at, point in enumerate(points):
            sizes = np.abs(found.values[at]).T
            np.testing.assert_allclose(sizes, point["per_harmonic_abs_Nm"], rtol=1e-8, atol=1e-9)
            np.testing.assert_allclose(sizes.sum(axis=1), point["vibratory_torque_sum_Nm"], rtol=1e-8)

    def test_published_chain_with_four_harmonics(self):
        case = read_case("forced_ot_docs_chain5")
        base = read_case(case["model"])
        orders = {order: {"amplitude": size} for order, size in enumerate((200, 50, 5, 2), 1)}
        plant = tn.Drivetrain(
            "chain", build(base).elements.values(), speeds={"of": "n0", "list": ["3600 rpm"]},
            excitations={"ripple": {"type": "harmonic", "node": "n0", "orders": orders}},
        )  # fmt: skip
        torques = [f"torque({spring_name(spring)})" for spring in base["springs"]]
        found = plant.order_response([*(f"n{number}" for number in range(5)), *torques]).values[0].T
        np.testing.assert_allclose(found[:5], case["response_rad"], rtol=1e-8)
        np.testing.assert_allclose(found[5:], -np.array(case["shaft_torque_Nm"]), rtol=1e-8)

    def test_lines_of_the_grid_do_not_follow_the_speed(self):
        """Rotor and stator on one shaft: 300 Hz, 600 Hz and an interharmonic, whatever the speed, behind a gear too."""
        machine = {"type": "electric_machine", "node": "wheel", "stator": "pinion", "rated_torque": "2 kN*m",
                   "line": {"frequency": "50 Hz", "multiples": {6: {"share": "2 %"}, 12: {"amplitude": 7, "phase": 1}}},
                   "frequencies": {"287 Hz": {"amplitude": 5}}}  # fmt: skip
        run = geared([400, 1200], drive=machine).order_response(["motor", "torque(stage)"])
        for hertz, size in ((300, 40), (600, 7 * np.exp(1j)), (287, 5)):
            omega = 2 * np.pi * hertz
            theta = np.linalg.solve(dynamic_stiffness(omega), np.array([0, 1, -1]) * size)  # the wheel turns backwards
            for output, expected in (("motor", theta[0]), ("torque(stage)", kappa(MESH, omega) * (MESH_ROW @ theta))):
                assert run.of_frequency(hertz, output) == pytest.approx([expected, expected], rel=1e-9)
        assert run.revolutions is None
        assert [str(line) for line in run.lines] == ["drive 287 Hz", "drive 300 Hz", "drive 600 Hz"]
        with pytest.raises(tn.UsageError, match=r"(?s)100.*unknown-order"):
            run.of_frequency(100)

    def test_slip_of_a_starting_synchronous_motor(self):
        """Twice the slip frequency: 100 Hz at rest, 0 at 1500 rpm of two pole pairs, and the other way round above."""
        motor = {"type": "electric_machine", "node": "motor", "pole_pairs": 2,
                 "slip": {"frequency": "50 Hz", "amplitude": [["150 rpm", 60], ["1650 rpm", 40]], "phase": "30 deg"}}  # fmt: skip
        run = geared([150, 900, 1500, 1650], motor=motor).order_response(["pinion", "velocity(pinion)"])
        frequencies = [90, 40, 0, -10]
        assert run.lines[0].frequency(run.speeds) == pytest.approx(frequencies, abs=1e-9)
        for at, (hertz, size) in enumerate(zip(frequencies, (60, 50, 42, 40), strict=True)):
            if not hertz:
                assert not run.values[at].any()  # a constant torque is no vibration
                continue
            omega = 2 * np.pi * hertz
            theta = np.linalg.solve(dynamic_stiffness(omega), [size * np.exp(1j * np.pi / 6), 0, 0])[1]
            assert run.values[at, 0] == pytest.approx(np.array([theta, 1j * omega * theta]), rel=1e-9)
        assert run.half_range[:, 0] == pytest.approx(abs(run.values[:, 0, 0]))
        assert "motor 100 Hz - order 4" in run.table("pinion").to_text()

    @pytest.mark.parametrize("pairs", range(1, 20))
    def test_at_synchronous_speed_nothing_vibrates(self, pairs):
        """However the speed is rounded."""
        slip = {"frequency": "60 Hz", "amplitude": [[0, 60], [400, 40]]}
        rig = geared([100], motor={"type": "electric_machine", "node": "motor", "pole_pairs": pairs, "slip": slip})
        speed = 3600 * RPM / pairs * 17 / 61
        assert not rig.order_response("pinion", speeds=[speed], speed_of="wheel").values.any()

    @pytest.mark.parametrize(("phases", "twice", "lines"), [(3, {}, [50]), (2, {"twice": 45}, [50, 100])])
    def test_short_circuit(self, phases, twice, lines):
        fault = {"frequency": "50 Hz", "phases": phases, "once": 90, **twice}
        found = ElectricMachine(node="motor", short_circuit=fault).torques(np.array([100.0]))
        assert found.fixed.tolist() == lines
        assert abs(found.amplitudes[0, :, 0]) == pytest.approx([90, 45][: len(lines)])

    def test_a_switched_off_machine_does_nothing(self):
        one = {"type": "electric_machine", "node": "motor", "orders": {6: {"amplitude": 5}}}
        rig = geared([600], one=one, two=one | {"enabled": False})
        assert {line.excitation for line in rig.order_response("motor").lines} == {"one"}
        assert rig.order_response("motor", excitation=["two"]).values.any()


class TestSums:
    def test_extremes_by_synthesis_and_with_the_mean(self):
        """2 cos x + cos 2x lies between -1.5 and 3: closed form."""
        plant = tn.Drivetrain(
            "disc", [tn.Inertia("J", node="a", inertia=1)], speeds={"of": "a", "list": [1.0]},
            excitations={"x": {"type": "harmonic", "node": "a", "orders": {1: {"angle": 2}, 2: {"angle": 1}}}},
        )  # fmt: skip
        run = plant.order_response("a")
        assert run.bounds[:, 0, 0] == pytest.approx([3, -1.5], rel=1e-4)
        assert (run.peak_to_peak[0, 0], run.peak[0, 0]) == pytest.approx((4.5, 3), rel=1e-4)
        high, low = run.extremes([10])
        assert (high[0, 0], low[0, 0]) == pytest.approx((13, 8.5), rel=1e-4)
        high, _ = run.extremes(SimpleNamespace(speeds=run.speeds, values=np.array([[20.0]]), outputs=run.outputs))
        assert high[0, 0] == pytest.approx(23, rel=1e-4)
        with pytest.raises(tn.UsageError, match="wrong-count"):
            run.extremes([1, 2])
        with pytest.raises(tn.UsageError, match="unlike-results"):
            run.extremes(SimpleNamespace(speeds=run.speeds + 1, values=np.array([[20.0]]), outputs=run.outputs))

    def test_speed_and_line_are_bounded_by_the_sum_of_their_extremes(self):
        """cos x + cos 3x at orders, cos y - cos 2y at 300 and 600 Hz: no common cycle, so extremes of both add up."""
        plant = tn.Drivetrain(
            "disc", [tn.Inertia("J", node="a", inertia=1)], speeds={"of": "a", "list": [10.0]},
            excitations={"x": {"type": "harmonic", "node": "a", "orders": {1: {"angle": 1}, 3: {"angle": 1}}},
                         "y": {"type": "harmonic", "node": "a", "frequencies": {
                             "300 Hz": {"angle": 1}, "600 Hz": {"angle": 1, "phase": "180 deg"}}}},
        )  # fmt: skip
        run = plant.order_response("a")
        y = np.linspace(0, 2 * np.pi, 100_001)
        second = np.cos(y) - np.cos(2 * y)
        assert run.bounds[:, 0, 0] == pytest.approx([2 + second.max(), -2 + second.min()], rel=1e-4)
        assert run.rms[0, 0] == pytest.approx(np.sqrt(2))
        assert "half ranges of speed and fixed frequencies, added" in run.table().to_text()
        assert "do not follow the speed" in run.table().to_text()
        with pytest.raises(tn.UsageError, match="have no common cycle"):
            run.waveform()


SCREW_DATA = {"node": "prop", "blades": 4, "torque": 1000, "rated": 10.0}


class TestPropeller:
    def test_conditions(self):
        zero = {"torque": "20 %", "blade_orders": {1: {"share": "10 %"}, 2: {"share": "5 %", "phase": "90 deg"}}}
        screw = PropellerTorque(
            **SCREW_DATA, blade_orders={1: {"share": "6 %"}}, pitch="controllable", conditions={"zero_pitch": zero},
            condition="zero_pitch",
        )  # fmt: skip
        found = screw.torques(np.array([5.0]))
        assert found.orders.tolist() == [4, 8]
        assert found.amplitudes[0, :, 0] == pytest.approx(
            np.array([-5, -2.5j])
        )  # a quarter of the torque at half speed

    def test_phase_from_an_upright_blade(self):
        """A blade 15 degrees past upright: order 4 is 60 degrees on."""
        share = {1: {"share": "10 %", "phase": "20 deg"}}
        blade = PropellerTorque(**SCREW_DATA, blade_orders=share, phase_zero="blade", blade_angle="15 deg")
        found = blade.torques(np.array([10.0])).amplitudes[0, 0, 0]
        assert found == pytest.approx(-100 * np.exp(1j * math.radians(80)))


class TestMeasured:
    def test_orders_over_speed_are_those_recorded(self):
        """RMS in kN m with phases, at 600 and 900 rpm; between them magnitude and phase run straight."""
        table = {"columns": ["speed [rpm]", "order", "rms [kN*m]", "phase [deg]"],
                 "rows": [[900, 3, 0.04, 200], [600, 3, 0.02, 160], [600, 1, 0.01, 0], [900, 1, 0.01, 0]]}  # fmt: skip
        pump = {"type": "measured", "node": "motor", "table": table}
        found = geared([600, 750], pump=pump).order_response("wheel")
        for at, (rpm, size) in enumerate(((600, 20 * np.exp(1j * math.radians(160))), (750, -30))):
            receptance = np.linalg.solve(dynamic_stiffness(3 * rpm * RPM), [1, 0, 0])[2]
            assert found.of_order(3)[at] == pytest.approx(np.sqrt(2) * size * receptance, rel=1e-9)

    @pytest.mark.parametrize(
        "text",
        [
            "# recorder 7\norder;rms [N*m];phase [deg]\n2;30;90\n4;3;0\n",
            "order\trms\tphase\n-\tN*m\tdeg\n2\t30,0\t90,0\n4\t3,0\t0,0\n",
        ],
    )
    def test_a_table_in_a_file_beside_the_model(self, tmp_path, text):
        (tmp_path / "orders.csv").write_text(text)
        (tmp_path / "plant.yaml").write_text(FILE.replace("WHAT", "{type: measured, node: m, table: orders.csv}"))
        rig = tn.load(tmp_path / "plant.yaml")
        found = rig.definition.excitations["x"].torques(np.array([50.0]))
        assert found.orders.tolist() == [2, 4]
        assert found.amplitudes[0, :, 0] == pytest.approx(np.sqrt(2) * np.array([30j, 3]))
        assert tn.loads(rig.to_yaml()) == rig

    @pytest.mark.parametrize(
        ("text", "where", "kind"),
        [
            ("order;rms\n2;30\n4;3\n", "orders.csv:1:7", "wrong-unit"),
            ("order;rmss [N*m]\n2;30\n4;3\n", "orders.csv:1:7", "unknown-entry"),
            ("2;30\n4;3\n", "orders.csv:1:1", "missing-column"),
            ("# nothing\n", "orders.csv:1:1", "wrong-file"),
            ("order;rms [N*m]\n2;30\n4;x\n5;1\n6;2\n", "orders.csv:3:", "not-a-number"),
            (None, "plant.yaml:10:", "missing-file"),
        ],
    )
    def test_faults_of_a_file_have_their_line(self, tmp_path, text, where, kind):
        if text is not None:
            (tmp_path / "orders.csv").write_text(text)
        (tmp_path / "plant.yaml").write_text(FILE.replace("WHAT", "{type: measured, node: m, table: orders.csv}"))
        with pytest.raises(tn.ModelError, match=f"{where}.*{kind}"):
            tn.load(tmp_path / "plant.yaml")

    def test_a_recorded_motion_is_imposed(self):
        table = {"columns": ["frequency [Hz]", "real [deg/s]", "imag [deg/s]"], "rows": [[17, 3, -4]]}
        found = geared([600], shaker={"type": "measured", "node": "motor", "table": table})
        velocity = found.order_response("velocity(motor)").of_frequency(17)[0]
        assert velocity == pytest.approx((3 - 4j) * math.pi / 180)


MACHINE = "{type: electric_machine, node: m, pole_pairs: 2, rated_torque: 1 kN*m, orders: {6: {share: 2 %}}}"
MESHED = "{type: gear_mesh, mesh: stage, base_radius: 40 mm, transmission_error: {1: {way: 4 um}}}"
TABLE = "{type: measured, node: m, table: {columns: [order, 'rms [N*m]'], rows: [[2, 30], [4, 3]]}}"
SCREW = "{type: propeller, node: w, blades: 4, torque: 9, rated: 10, blade_orders: {1: {share: 5 %}}}"
FILE = """torsionnet: 1
name: plant
elements:
  J_m: {type: inertia, node: m, inertia: 1}
  shaft: {type: spring, nodes: [m, p], stiffness: 10 kN*m/rad}
  stage: {type: gear, nodes: [p, w], teeth: [17, -61], stiffness: 10 MN*m/rad}
  J_w: {type: inertia, node: w, inertia: 5}
speeds: {of: m, list: [300 rpm, 600 rpm]}
excitations:
  x: WHAT
"""


@pytest.mark.parametrize("driven", [
    "{type: gearbox, input: p, output: w, ratios: {I: -3}, engaged: I, stiffness: {I: 10 MN*m/rad}}",
    "{type: final_drive, pinion: p, left: w, right: right, ratio: 3, stiffness: 10 MN*m/rad}",
])  # fmt: skip
def test_an_assembly_with_teeth_is_refused_with_what_to_write_instead(driven):
    stage = "{type: gear, nodes: [p, w], teeth: [17, -61], stiffness: 10 MN*m/rad}"
    text = FILE.replace("WHAT", MESHED).replace(stage, driven)
    _, faults = read_text(text, "plant.yaml")
    said = [fault.message for fault in faults if fault.path == ("excitations", "x", "mesh")]
    assert len(said) == 1
    assert "write the pair in question as an element of its own, {type: gear, teeth: ..., stiffness: ...}" in said[0]


class TestFiles:
    @pytest.mark.parametrize("given", [
        MACHINE, MESHED, SCREW, TABLE, "{type: universal_joint, joint: shaft, angle: 9 deg}",
        "{type: harmonic, node: m, frequencies: {50 Hz: {velocity: 2 rad/s}}, factor: [[0 rpm, 1], [900 rpm, 2]]}",
        MACHINE.replace("orders:", "slip: {frequency: 50 Hz, amplitude: [[0 rpm, 9], [900 rpm, 8]]}, orders:"),
        MACHINE.replace("orders:", "line: {frequency: 50 Hz, multiples: {6: {amplitude: 3}}}, enabled: false, orders:"),
    ])  # fmt: skip
    def test_what_is_written_can_be_read_again(self, given):
        rig = tn.loads(FILE.replace("WHAT", given))
        assert tn.loads(rig.to_yaml()) == rig
        assert rig.order_response("torque(stage)", excitation=["x"]).values.any()

    @pytest.mark.parametrize(
        ("given", "old", "new", "where", "kind"),
        [
            (MESHED, "stiffness: 10 MN*m/rad}", "}", "stage, base_radius", "not-applicable"),
            (MESHED, "mesh: stage", "mesh: stagg", "stagg", "unknown-element"),
            (MESHED, "mesh: stage", "mesh: shaft", "shaft, base_radius", "not-applicable"),
            (MESHED, "base_radius: 40 mm, ", "", "4 um", "missing-entry"),
            (MESHED, "{way: 4 um}", "{way: 4 um, angle: 1}", "angle: 1", "contradicting-entries"),
            (MESHED, "{way: 4 um}", "{way: 4 urad}", "4 urad", "wrong-unit"),
            (MESHED, "mesh: stage", "mesh: stage, teeth: 18", "18", "contradicting-values"),
            (MESHED, "mesh: stage", "mesh: stage, speed_of: m", "m, base_radius", "unknown-node"),
            (MESHED, "teeth: [17, -61]", "ratio: -3.5", "x: ", "missing-entry"),
            (MESHED, ", transmission_error: {1: {way: 4 um}}", "", "x: ", "missing-entry"),
            (MESHED, "{1: {way", "{first: {way", "first", "expression-not-allowed"),
            (MACHINE, "rated_torque: 1 kN*m, ", "", "2 %", "missing-entry"),
            (MACHINE, "pole_pairs: 2, rated_torque: 1 kN*m, orders", "rated_torque: 1, electrical_orders", "electrical_orders", "missing-entry"),
            (MACHINE, "rated_torque: 1 kN*m, orders: {6: {share: 2 %}}", "torque: [[300 rpm, 1], [600 rpm, 1]], orders: {6: {amplitude: 3}}", "torque", "missing-entry"),
            (MACHINE, "orders: {6: {share: 2 %}}", "stator: w", "x: ", "missing-entry"),
            (MACHINE, "{share: 2 %}", "{phase: 2 deg}", "6: {phase", "missing-entry"),
            (MACHINE, "orders", "torque: [[300 rpm, 1], [500 rpm, 1]], orders", "[[300 rpm", "beyond-table"),
            (MACHINE, "orders", "torque: [[300 rpm, 1], [200 rpm, 1]], orders", "[200 rpm", "unordered-rows"),
            (MACHINE, "orders", "frequencies: {50: {share: 1 %}}, line: {frequency: 50 rpm, multiples: {6: {share: 1 %}}}, orders", "50 rpm", "wrong-unit"),
            (MACHINE, "orders", "short_circuit: {frequency: 50 Hz, phases: 3, once: 9, twice: 8}, orders", "8}", "needless-entry"),
            (MACHINE, "machine, node: m", "machine, node: mm", "mm", "unknown-node"),
            (MACHINE, "machine, node: m", "machine, node: m, stator: m", "m, pole", "same-node"),
            (SCREW, "blades: 4", "blades: 4, phase_zero: blade", "blade, torque", "missing-entry"),
            (SCREW, "blades: 4", "blades: 4, condition: astern", "astern", "unknown-word"),
            (SCREW, "blades: 4", "blades: 4, conditions: {zero_pitch: {blade_orders: {1: {share: 9 %}}}}", "zero_pitch", "needless-entry"),
            ("{type: universal_joint, joint: shaft, angle: 10}", "", "", "10}", "missing-unit"),
            ("{type: universal_joint, joint: stage, angle: 1 deg}", "", "", "stage, angle", "not-applicable"),
            ("{type: universal_joint, joint: shaft, angle: 1 deg, speed_of: w}", "", "", "w}", "no-ratio"),
            (TABLE, "'rms [N*m]'", "rms", "columns", "wrong-unit"),
            (TABLE, "'rms [N*m]'", "'rms [kg]'", "columns", "wrong-unit"),
            (TABLE, "'rms [N*m]'", "'rmss [N*m]'", "columns", "unknown-entry"),
            (TABLE, "order, ", "'phase [deg]', ", "columns", "missing-column"),
            (TABLE, "[4, 3]", "[4, 3, 1]", "[4, 3", "wrong-count"),
            (TABLE, "[4, 3]", "[2, 3]", "columns", "repeated-name"),
            (TABLE, "[4, 3]", "[0, 3]", "columns", "needless-entry"),
            (TABLE, "order, 'rms [N*m]'], rows: [[2, 30], [4, 3]]", "order, 'rms [N*m]', 'speed [rpm]'], rows: [[2, 30, 300], [2, 3, 400]]", "rows", "beyond-table"),
            ("{type: harmonic, node: m}", "", "", "x: ", "missing-entry"),
            ("{type: harmonic, node: m, orders: {2: {amplitude: 1, angle: 2}}}", "", "", "2: {amplitude", "contradicting-entries"),
            ("{type: harmonic, node: m, orders: {2: {amplitude: 1}, 3: {angle: 2}}}", "", "", "orders", "contradicting-entries"),
            ("{type: harmonic, node: m, frequencies: {fast: {amplitude: 1}}}", "", "", "fast", "expression-not-allowed"),
        ],
    )  # fmt: skip
    def test_faults_have_their_place(self, given, old, new, where, kind):
        text = FILE.replace("WHAT", given)
        assert old in text
        text = text.replace(old, new, 1) if old else text
        with pytest.raises(tn.ModelError) as caught:
            tn.loads(text)
        places = [(fault.position.line, fault.position.column, fault.kind) for fault in caught.value.faults]
        assert (10, text.splitlines()[9].index(where) + 1, kind) in places, caught.value

    def test_json_says_what_does_not_follow_the_speed(self, tmp_path):
        (tmp_path / "plant.yaml").write_text(
            FILE.replace("WHAT", "{type: harmonic, node: m, frequencies: {50 Hz: {amplitude: 1}}}")
        )
        text = run("orders", tmp_path / "plant.yaml", "--output", "w", "--json").stdout
        assert '"fixed_Hz": 50' in text

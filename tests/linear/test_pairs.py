"""Torques between two nodes and motion of one relative to another, against M, C, K written down by hand."""

import json
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
import scipy
from click.testing import CliRunner
from support.modelica_reader import Model as ModelicaModel

import torsionnet as tn
import torsionnet.plot as plot
from torsionnet.app.cli.app import app
from torsionnet.app.explore.session import choices
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.io import to_modelica
from torsionnet.io.matlab import matrices
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.files.model_schema import json_schema
from torsionnet.model.files.reader import read_text
from torsionnet.model.files.writer import dump
from torsionnet.model.overview import channels_table

CAR = Path(__file__).parents[1] / "plants" / "front_wheel_drive_car.yaml"
F = np.array([0.3, 2.0, 5.5, 9.0, 14.0, 40.0])
RATIO = -3.0
VALUES = {"J_c": 0.4, "J_w": 0.2, "J_o": 1.1, "J_b": 6.0, "J_v": 9.0, "k": 5000.0, "k_o": 800.0, "k_m": 30000.0}
DAMPING = {"c": 1.5, "c_o": 2.0, "c_m": 40.0}
NODES = ("crank", "wheel", "out", "block", "load")


def plant(inputs=None, sensors=None, **more):
    """Crank, spring, wheel, a gear in a block on mounts, its output, a spring, a load."""
    elements = [
        tn.Inertia("crank_J", node="crank", inertia="J_c"),
        tn.Spring("shaft", nodes=("crank", "wheel"), stiffness="k", damping="c"),
        tn.Inertia("wheel_J", node="wheel", inertia="J_w"),
        tn.Gear("stage", nodes=("wheel", "out"), ratio=RATIO, housing="block"),
        tn.Inertia("out_J", node="out", inertia="J_o"),
        tn.Inertia("block_J", node="block", inertia="J_b"),
        tn.Spring("mount", nodes=("block", "ground"), stiffness="k_m", damping="c_m"),
        tn.Spring("drive", nodes=("out", "load"), stiffness="k_o", damping="c_o"),
        tn.Inertia("load_J", node="load", inertia="J_v"),
        *more.pop("elements", ()),
    ]
    return tn.Drivetrain(
        "housing", elements, parameters={**VALUES, **DAMPING}, inputs=inputs or {}, sensors=sensors or {}, **more
    )


ENGINE = {"T_E": {"torque": ["crank", "block"]}}
READ = {
    "T_d": {"torque": "drive"},
    "T_m": {"torque": "mount"},
    "roll": {"angle": "block"},
    "rel": {"angle": ["crank", "block"]},
    "speed": {"velocity": ["out", "load"]},
}


def row(*weights):
    return np.array([dict(weights).get(node, 0.0) for node in NODES])


def dense(f, held=(), loads=(), given=None):
    """Angles of NODES and multipliers: all node angles and all conditions as unknowns, one solve."""
    p, s = {**VALUES, **DAMPING}, 2j * np.pi * f
    D = np.zeros((5, 5), dtype=complex)
    for value, a in (
        (p["J_c"] * s**2, row(("crank", 1))), (p["J_w"] * s**2, row(("wheel", 1))), (p["J_o"] * s**2, row(("out", 1))),
        (p["J_b"] * s**2, row(("block", 1))), (p["J_v"] * s**2, row(("load", 1))),
        (p["k"] + p["c"] * s, row(("crank", 1), ("wheel", -1))), (p["k_m"] + p["c_m"] * s, row(("block", 1))),
        (p["k_o"] + p["c_o"] * s, row(("out", 1), ("load", -1))),
    ):  # fmt: skip
        D += value * np.outer(a, a)
    gear = row(("wheel", 1), ("out", -RATIO), ("block", RATIO - 1))
    A = np.array([gear, *held])
    n = len(A)
    b = np.concatenate([np.sum(loads, axis=0) if len(loads) else np.zeros(5), np.zeros(n)])
    if given is not None:
        b[5 + given] = 1
    return np.linalg.solve(np.block([[D, A.T], [A, np.zeros((n, n))]]), b)


def readings(x, f):
    s = 2j * np.pi * f
    q = x[:5]
    return np.array([
        (VALUES["k_o"] + DAMPING["c_o"] * s) * (row(("out", 1), ("load", -1)) @ q),
        (VALUES["k_m"] + DAMPING["c_m"] * s) * (row(("block", 1)) @ q),
        row(("block", 1)) @ q,
        row(("crank", 1), ("block", -1)) @ q,
        s * (row(("out", 1), ("load", -1)) @ q),
    ])  # fmt: skip


PAIR = row(("crank", 1), ("block", -1))


class TestTorque:
    EXPECTED = np.array([readings(dense(f, loads=[PAIR]), f) for f in F])

    @pytest.mark.parametrize("source", ["T_E", "crank-block", " crank - block ", Input("torque", "crank", "block")])
    def test_against_matrices_by_hand(self, source):
        found = plant(ENGINE, READ).frequency_response(list(READ), source, F).values[:, :, 0]
        assert found == pytest.approx(self.EXPECTED, rel=1e-10)

    @pytest.mark.parametrize("method", ["dense", "graph"])
    def test_whatever_solves_it(self, method):
        found = plant(ENGINE, READ).frequency_response(list(READ), "T_E", F, method=method).values[:, :, 0]
        assert found == pytest.approx(self.EXPECTED, rel=1e-9)

    def test_is_the_difference_of_two_torques(self):
        rig = plant(ENGINE, READ)
        both = rig.frequency_response(list(READ), ["crank", "block"], F).values
        assert both[:, :, 0] - both[:, :, 1] == pytest.approx(self.EXPECTED, rel=1e-9)

    def test_reciprocal(self):
        """The relative angle of one pair under a torque in another, and the other way round."""
        rig = plant()
        there = rig.frequency_response("angle(out, load)", "crank-block", F).values
        back = rig.frequency_response("angle(crank, block)", "out-load", F).values
        assert there == pytest.approx(back, rel=1e-11)

    def test_over_a_spring_is_what_an_imposed_twist_does(self):
        """A pair of torques kappa e at the ends of a spring moves nodes as a twist e imposed in it."""
        rig = plant()
        kappa = VALUES["k"] + DAMPING["c"] * 2j * np.pi * F
        pair = rig.frequency_response("load", "crank-wheel", F).values[:, 0, 0] * kappa
        assert pair == pytest.approx(
            rig.frequency_response("load", Input("twist", "shaft"), F).values[:, 0, 0], rel=1e-10
        )

    def test_through_a_rigid_gear(self):
        """The torque the gear takes at its input is what the shaft brings less the inertia of the wheel."""
        found = plant(ENGINE).frequency_response("torque(stage)", "T_E", F).values[:, 0, 0]
        s = 2j * np.pi * F
        q = np.array([dense(f, loads=[PAIR])[:5] for f in F])
        kappa = VALUES["k"] + DAMPING["c"] * s
        assert found == pytest.approx(kappa * (q[:, 0] - q[:, 1]) - VALUES["J_w"] * s**2 * q[:, 1], rel=1e-9)

    def test_front_wheel_drive_car(self):
        """Half-shaft torque per engine torque in gear III at 10 Hz: what the block takes matters."""
        car = tn.load(CAR).configured("gear=III,clutch=closed")
        pair = abs(car.frequency_response("T_hl", "pulley-block", [10.0]).values.item())
        alone = abs(car.frequency_response("T_hl", "T_E", [10.0]).values.item())
        assert (pair, alone) == (pytest.approx(1.24, abs=0.005), pytest.approx(1.64, abs=0.005))

    def test_as_measured_input(self):
        """Against a measured torque or motion: the quotient of both responses."""
        rig = plant(ENGINE, READ)
        for measured, place in (("T_m", 1), ("rel", 3)):
            found = rig.frequency_response("T_d", measured, F).values[:, 0, 0]
            assert found == pytest.approx(self.EXPECTED[:, 0] / self.EXPECTED[:, place], rel=1e-9)
            again = rig.frequency_response("T_d", measured, F, driven_by="crank-block").values[:, 0, 0]
            assert again == pytest.approx(found, rel=1e-12)

    def test_poles_against_a_measured_input(self):
        """A pair on both sides of a torque transducer leaves nothing out: there the reading is zero."""
        elements = [tn.Inertia("a_J", node="a", inertia=1), tn.Spring("t", nodes=("a", "b"), stiffness=100),
                    tn.Inertia("b_J", node="b", inertia=2), tn.Spring("u", nodes=("b", "c"), stiffness=300),
                    tn.Inertia("c_J", node="c", inertia=5)]  # fmt: skip
        rig = tn.Drivetrain("chain", elements)
        # T = k (a - b) stays zero under T on a, -T on c: 1 s^2 a = T, 2 s^2 a = 300 (c - a), 5 s^2 c = 300 (a - c) - T.
        found = rig.modes(measured_input="torque(t)", driven_by="a-c")
        vibrating = found.damped_frequencies[found.damped_frequencies > 0]
        # c = a (1 + 2 s^2/300); 5 s^2 c + 2 s^2 a + s^2 a = 0: 8 + 10 s^2 / 300 = 0.
        assert vibrating == pytest.approx([np.sqrt(240) / 2 / np.pi], rel=1e-9)
        alone = rig.modes(measured_input="torque(t)", driven_by="a")
        kept = alone.damped_frequencies[alone.damped_frequencies > 0]
        assert kept == pytest.approx([np.sqrt(300 * (1 / 2 + 1 / 5)) / 2 / np.pi], rel=1e-9)

    def test_both_on_one_side_of_a_cut(self):
        """Then the drivetrain is cut as for a torque on one node."""
        rig = plant(ENGINE, READ)
        found = rig.modes(measured_input="T_d")
        assert found.damped_frequencies[found.damped_frequencies > 0].size == 0
        assert "cut at T_d" in found.title


class TestImposedMotion:
    INPUTS: ClassVar = {"phi": {"angle": ["crank", "block"]}}
    EXPECTED = np.array([readings(dense(f, held=[PAIR], given=1), f) for f in F])

    def test_against_matrices_by_hand(self):
        found = plant(self.INPUTS, READ).frequency_response(list(READ), "phi", F).values[:, :, 0]
        assert found == pytest.approx(self.EXPECTED, rel=1e-9, abs=1e-14)
        assert found[:, 3] == pytest.approx(1, rel=1e-12)

    def test_is_held_while_something_else_drives(self):
        found = plant(self.INPUTS).frequency_response("load", "out", F).values[:, 0, 0]
        expected = [dense(f, held=[PAIR], loads=[row(("out", 1))])[4] for f in F]
        assert found == pytest.approx(expected, rel=1e-9)

    def test_modes_are_those_with_both_rigidly_connected(self):
        found = plant(self.INPUTS).modes()
        joined = plant(elements=[tn.RigidCoupling("held", nodes=("crank", "block"))]).modes()
        assert found.natural_frequencies == pytest.approx(joined.natural_frequencies, rel=1e-9)

    def test_in_symbols(self):
        rig = plant(self.INPUTS, READ)
        for place, output in enumerate(READ):
            found = rig.symbolic().transfer_function(output, "phi").evaluate(F).values[:, 0, 0]
            assert found == pytest.approx(self.EXPECTED[:, place], rel=1e-9)

    def test_measured_with_a_relative_motion_as_excitation(self):
        rig = plant(self.INPUTS, READ)
        expected = self.EXPECTED[:, 0] / self.EXPECTED[:, 1]
        assert rig.frequency_response("T_d", "T_m", F).values[:, 0, 0] == pytest.approx(expected, rel=1e-9)
        function = rig.symbolic().transfer_function("T_d", "T_m")
        assert function.evaluate(F).values[:, 0, 0] == pytest.approx(expected, rel=1e-9)

    def test_cut_goes_not_between_what_an_imposed_motion_ties(self):
        """A transducer beside a relative motion that is imposed around it does not separate anything."""
        rig = plant({**self.INPUTS, "T": {"torque": "wheel"}}, READ)
        got = rig.frequency_response("load", "torque(shaft)", F, driven_by="T").values[:, 0, 0]
        each = [dense(f, held=[PAIR], loads=[row(("wheel", 1))]) for f in F]
        kappa = VALUES["k"] + DAMPING["c"] * 2j * np.pi * F
        assert got == pytest.approx([x[4] / (k * (x[0] - x[1])) for x, k in zip(each, kappa, strict=True)], rel=1e-8)
        rig.modes(measured_input="torque(drive)", driven_by="T")

    def test_gear_ratio_free_of_ground(self):
        """The torque that imposes it is what acts between both: angle under angle times that torque is reciprocal."""
        rig = plant(self.INPUTS)
        free = plant()
        angle = free.frequency_response("angle(crank, block)", "crank-block", F).values[:, 0, 0]
        moved = free.frequency_response("load", "crank-block", F).values[:, 0, 0]
        assert rig.frequency_response("load", "phi", F).values[:, 0, 0] == pytest.approx(moved / angle, rel=1e-8)


class TestSymbols:
    @pytest.mark.parametrize("output", list(READ))
    def test_transfer_functions(self, output):
        rig = plant(ENGINE, READ)
        found = rig.symbolic().transfer_function(output, "T_E").evaluate(F).values[:, 0, 0]
        assert found == pytest.approx(rig.frequency_response(output, "T_E", F).values[:, 0, 0], rel=1e-9)

    def test_ad_hoc_and_measured(self):
        rig = plant(sensors=READ)
        made = rig.symbolic().transfer_function("T_d", "roll", "crank-block").evaluate(F).values[:, 0, 0]
        assert made == pytest.approx(TestTorque.EXPECTED[:, 0] / TestTorque.EXPECTED[:, 2], rel=1e-9)

    def test_matrix(self):
        rig = plant({**ENGINE, "T_l": {"torque": ["load", "out"]}}, READ)
        found = rig.symbolic().transfer_matrix(["roll", "T_d"], ["T_E", "T_l"]).evaluate(F).values
        assert found == pytest.approx(rig.frequency_response(["roll", "T_d"], ["T_E", "T_l"], F).values, rel=1e-9)
        excitations = ["T_E", "T_l"]
        measured = rig.symbolic().transfer_matrix(["rel"], ["roll", "T_d"], excitations).evaluate(F).values
        numbers = rig.frequency_response(["rel"], ["roll", "T_d"], F, driven_by=excitations).values
        assert measured == pytest.approx(numbers, rel=1e-8)

    def test_equations_and_latex(self):
        elements = [tn.Inertia("a_J", node="a", inertia="J"), tn.Spring("t", nodes=("a", "b"), stiffness="k"),
                    tn.Inertia("b_J", node="b", inertia="I")]  # fmt: skip
        rig = tn.Drivetrain(
            "two", elements, parameters={"J": 1, "I": 2, "k": 100}, inputs={"T": {"torque": ["a", "b"]}}
        )
        system = rig.symbolic()
        assert system.B.tolist() == [[1], [-1]]
        assert [line.split(" = ")[1] for line in system.equations()] == ["T", "- T"]
        assert "- 1" in system.to_latex("B") or "-1" in system.to_latex("B")
        assert str(system.transfer_function("angle(a, b)", "T").static_gain) == "1/k"

    def test_continued_fraction_form_falls_back(self):
        """Two loaded coordinates: the mechanical form is another one, and as right."""
        function = plant(ENGINE, READ).symbolic().transfer_function("T_d", "T_E")
        assert function.to_latex("mechanical")


class TestDerivatives:
    NAMES = ("k", "J_b", "c_m", "k_o")

    @pytest.mark.parametrize("inputs", [ENGINE, {"T_E": {"angle": ["crank", "block"]}}])
    def test_against_differences(self, inputs):
        rig = plant(inputs, READ)
        response = parametric_response(rig, list(READ), "T_E", F, self.NAMES)
        start = response.start
        found = response.evaluation(start)
        assert found.values == pytest.approx(rig.frequency_response(list(READ), "T_E", F).values, rel=1e-9)
        for place, name in enumerate(self.NAMES):
            h = 1e-5 * start[place]
            ends = [
                rig.configured(**{name: start[place] + step}).frequency_response(list(READ), "T_E", F).values
                for step in (h, -h)
            ]
            slope = (ends[0] - ends[1]) / (2 * h)
            scale = np.abs(slope).max(axis=0)
            assert np.all(np.abs(found.jacobian[..., place] - slope) <= 1e-6 * scale + 1e-15)

    def test_fit_of_a_response(self):
        rig = plant(ENGINE, READ)
        truth = rig.configured(k_o=950.0).frequency_response(["T_d", "rel"], "T_E", np.linspace(0.5, 20, 60))
        found = tn.identify(rig, tn.Measurement(truth, "T_d", "T_E"), {"k_o": 900.0})
        assert found.values["k_o"] == pytest.approx(950, rel=1e-6)


class TestOverTime:
    def test_as_lsim(self):
        rig = plant(ENGINE, READ)
        names = ["T_d", "roll", "rel"]
        torque = np.random.default_rng(1).standard_normal(2000)
        record = rig.simulate(names, {"T_E": torque}, 500.0)
        S = rig.to_control()
        wanted = [list(READ).index(name) for name in names]
        _, expected, _ = scipy.signal.lsim((S.A, S.B, S.C[wanted], S.D[wanted]), torque, np.arange(2000) / 500.0)
        for column, name in enumerate(names):
            got = record[name].values
            assert got == pytest.approx(expected[:, column], abs=1e-9 * np.abs(expected[:, column]).max())

    def test_ad_hoc_has_a_name(self):
        record = plant().simulate("block", {"crank-block": np.ones(10)}, 100.0)
        assert record.names[0] == "torque on crank against block"

    def test_state_space_and_matrices_have_the_responses(self):
        rig = plant(ENGINE, READ)
        S, m = rig.to_control(), matrices(rig)
        for f, expected in zip(F, TestTorque.EXPECTED, strict=True):
            s = 2j * np.pi * f
            gain = S.C @ np.linalg.solve(s * np.eye(len(S.A)) - S.A, S.B) + S.D
            assert gain[:, 0] == pytest.approx(expected, rel=1e-7)
            q = np.linalg.solve(m.M * s**2 + m.C * s + m.K, m.F)
            y = (m.Y0 + m.Y1 * s + m.Y2 * s**2) @ q + m.Yu
            assert y[:, 0] == pytest.approx(expected, rel=1e-9)

    def test_direct_share_in_a_rigid_torque_meter(self):
        """A meter between both nodes carries its share of the torque at once."""
        elements = [tn.Inertia("a_J", node="a", inertia=1), tn.RigidCoupling("meter", nodes=("a", "b")),
                    tn.Inertia("b_J", node="b", inertia=3), tn.Spring("u", nodes=("b", "c"), stiffness=10, damping=1),
                    tn.Inertia("c_J", node="c", inertia=2)]  # fmt: skip
        rig = tn.Drivetrain("meter", elements, inputs={"T": {"torque": ["a", "c"]}}, sensors={"M": {"torque": "meter"}})
        found = rig.frequency_response("M", "T", F).values[:, 0, 0]
        s = 2j * np.pi * F
        # a: s^2 a = T - M, a = b: (1 + 3) s^2 a + (10 + s) (a - c) = T, 2 s^2 c + (10 + s)(c - a) = -T
        k = 10 + s
        twist = (1 / 4 + 1 / 2) / (s**2 + k * (1 / 4 + 1 / 2))
        expected = 1 - s**2 * ((1 - k * twist) / (4 * s**2))
        assert found == pytest.approx(expected, rel=1e-10)
        S = rig.to_control()
        assert S.D.item() == pytest.approx(3 / 4, rel=1e-12)
        assert matrices(rig).Yu.item() + 0 == pytest.approx(matrices(rig).Yu.item())
        poles = rig.symbolic().transfer_function("M", "T").evaluate(F).values[:, 0, 0]
        assert poles == pytest.approx(expected, rel=1e-9)


class TestFiles:
    TEXT = """torsionnet: 1
name: pair
elements:
  a_J: {type: inertia, node: a, inertia: 1 kg*m^2}
  t: {type: spring, nodes: [a, b], stiffness: 100 N*m/rad}
  b_J: {type: inertia, node: b, inertia: 2 kg*m^2}
inputs: {T: {torque: [a, b]}}
sensors: {rel: {angle: [a, b]}, slip: {velocity: [b, a]}}
"""

    def faults(self, old, new):
        _, faults = read_text(self.TEXT.replace(old, new), "pair.yaml")
        return [fault for fault in faults if fault.severity in ("error", "warning")]

    def test_round_trip(self):
        definition, faults = read_text(self.TEXT, "pair.yaml")
        assert not [fault for fault in faults if fault.severity != "note"]
        again, _ = read_text(dump(definition), "again.yaml")
        assert again.to_data() == definition.to_data()
        assert definition.to_data()["inputs"] == {"T": {"torque": ["a", "b"]}}
        assert definition.to_data()["sensors"] == {"rel": {"angle": ["a", "b"]}, "slip": {"velocity": ["b", "a"]}}

    def test_ground_as_second_node_is_the_node_alone(self):
        definition, faults = read_text(self.TEXT.replace("torque: [a, b]", "torque: [a, ground]"), "pair.yaml")
        assert not [fault for fault in faults if fault.severity == "error"]
        assert definition.inputs["T"] == Input("torque", "a")
        assert definition.to_data()["inputs"] == {"T": {"torque": "a"}}

    @pytest.mark.parametrize(
        ("old", "new", "kind"),
        [
            ("{torque: [a, b]}", "{torque: [a, bb]}", "unknown-node"),
            ("{torque: [a, b]}", "{torque: [x, b]}", "unknown-node"),
            ("{torque: [a, b]}", "{torque: [a, a]}", "same-node"),
            ("{torque: [a, b]}", "{torque: [ground, a]}", "grounded-node"),
            ("{torque: [a, b]}", "{torque: [a]}", "not-a-node"),
            ("{torque: [a, b]}", "{torque: [a, 3]}", "not-a-node"),
            ("{angle: [a, b]}", "{twist: [a, b]}", "not-a-node"),
            ("{angle: [a, b]}", "{angle: [a, c]}", "unknown-node"),
        ],
    )
    def test_faults(self, old, new, kind):
        (fault,) = [one for one in self.faults(old, new) if one.severity == "error"]
        assert fault.kind == kind
        assert fault.position.line in (7, 8)

    def test_pair_that_is_rigidly_connected_does_nothing(self):
        stiff = "{type: rigid_coupling, nodes: [a, b]}"
        faults = self.faults("{type: spring, nodes: [a, b], stiffness: 100 N*m/rad}", stiff)
        texts = [fault.message for fault in faults]
        assert 'input T does nothing: "a" against "b" is held rigidly' in texts
        assert 'sensor rel reads zero: "a" against "b" is held rigidly' in texts

    def test_motion_imposed_between_rigidly_connected_nodes(self):
        text = self.TEXT.replace("{torque: [a, b]}", "{angle: [a, b]}").replace(
            "{type: spring, nodes: [a, b], stiffness: 100 N*m/rad}", "{type: rigid_coupling, nodes: [a, b]}"
        )
        _, faults = read_text(text, "pair.yaml")
        assert any("does nothing" in fault.message for fault in faults)

    def test_torque_where_the_relative_angle_is_imposed(self):
        faults = self.faults("{T: {torque: [a, b]}}", "{T: {torque: [b, a]}, phi: {angle: [a, b]}}")
        assert any('against "a" is imposed' in fault.message for fault in faults)

    def test_schema(self):
        import jsonschema

        validator = jsonschema.Draft202012Validator(json_schema())
        good, _ = read_text(self.TEXT, "pair.yaml")
        validator.validate(json.loads(json.dumps(good.to_data())))
        for wrong in ({"torque": ["a", "b", "c"]}, {"torque": ["a"]}, {"twist": ["a", "b"]}):
            with pytest.raises(jsonschema.ValidationError):
                validator.validate({**good.to_data(), "inputs": {"T": wrong}})

    @pytest.mark.parametrize(
        "make",
        [
            lambda: Input("torque", "a", "a"),
            lambda: Input("twist", "a", "b"),
            lambda: Input("torque", "ground", "a"),
            lambda: Sensor("torque", "a", against="b"),
            lambda: Sensor("angle", "a", against="a"),
        ],
    )
    def test_objects_that_mean_nothing(self, make):
        with pytest.raises(UsageError):
            make()

    def test_names_that_mean_nothing(self):
        rig = plant(ENGINE)
        for name, message in (("crank-blok", "unknown-node"), ("crank-crank", "both nodes")):
            with pytest.raises(UsageError, match=message):
                rig.frequency_response("load", name, F)
        rigid = plant(elements=[tn.RigidCoupling("stuck", nodes=("crank", "block"))])
        with pytest.raises(UsageError, match="no-effect"):
            rigid.frequency_response("load", "crank-block", F)
        with pytest.raises(UsageError, match="imposed by phi"):
            plant({"phi": {"angle": ["crank", "block"]}}).frequency_response("load", "crank-block", F)

    def test_switched_off_in_a_configuration(self):
        rig = plant(ENGINE, configurations={"mounted": {"yes": {}, "no": {"off": ["stage", "block_J", "mount"]}}})
        assert any("block is switched off" in str(fault) for fault in rig.configured("no").check())
        with pytest.raises(UsageError, match="no-effect"):
            rig.configured("no").frequency_response("load", "T_E", F)

    def test_model_in_python_is_checked(self):
        with pytest.raises(ModelError, match="unknown-node"):
            plant({"T": {"torque": ["crank", "blok"]}})


class TestElsewhere:
    def test_modelica_text(self):
        rig = plant(ENGINE, {"T_d": READ["T_d"], "rel": READ["rel"]})
        model = ModelicaModel(to_modelica(rig))
        for f, expected in zip(F, TestTorque.EXPECTED, strict=True):
            assert model.responses(2j * np.pi * f)[:, 0] == pytest.approx(expected[[0, 3]], rel=1e-8)
        imposed = ModelicaModel(
            to_modelica(plant(TestImposedMotion.INPUTS, {"T_d": READ["T_d"], "speed": READ["speed"]}))
        )
        for f, expected in zip(F, TestImposedMotion.EXPECTED, strict=True):
            assert imposed.responses(2j * np.pi * f)[:, 0] == pytest.approx(expected[[0, 4]], rel=1e-8)

    def test_command_line(self):
        words = ["frf", str(CAR), "-c", "gear=III,clutch=closed", "--output", "T_hl", "--input", "pulley-block"]
        result = CliRunner().invoke(app, [*words, "--frequencies", "10", "--full"])
        assert result.exit_code == 0, result.output
        assert "1.2376" in result.output
        shown = CliRunner().invoke(app, ["show", str(CAR)])
        assert shown.exit_code == 0

    def test_schematic_has_both_arrows(self):
        from matplotlib.text import Text

        plan = plot.schematic(plant(ENGINE, READ))
        texts = [text.get_text() for text in plan.findobj(match=Text)]
        assert any("against block" in text for text in texts)
        assert any(text.startswith("\u2212$T_") for text in texts)

    def test_overview_and_explore_name_it(self):
        rig = plant(ENGINE, READ)
        assert "torque on crank against block" in [row[2] for row in channels_table(rig).rows]
        offered = choices(rig, [])
        assert {"name": "T_E", "what": "torque on crank against block"} in offered["inputs"][0]["entries"]


SPEEDS = {"of": "crank", "range": "400..1200 rpm", "step": "100 rpm"}


def running(excitation, **more):
    return plant(sensors=READ, speeds=SPEEDS, excitations={"it": excitation}, **more)


def by_superposition(rig, lines):
    """Responses (n_speeds, n_lines, n_out) to torques on crank against block, from frequency responses."""
    at = np.array(rig.definition.speeds.values)
    found = []
    for order, amplitude in lines.items():
        f = at * order / 2 / np.pi
        gain = rig.frequency_response(list(READ), ["crank", "block"], f).values
        found.append((gain[:, :, 0] - gain[:, :, 1]) * amplitude)
    return np.stack(found, axis=1)


class TestExcitations:
    def test_harmonic_torque(self):
        orders = {2: {"amplitude": "10 N*m"}, 4: {"amplitude": "4 N*m", "phase": "90 deg"}}
        rig = running({"type": "harmonic", "node": "crank", "reaction": "block", "orders": orders})
        found = rig.order_response(list(READ))
        assert found.values == pytest.approx(by_superposition(rig, {2: 10, 4: 4j}), rel=1e-8)

    def test_engine_on_its_block(self):
        """The block takes the opposite of all cylinders; also of a misfire, whichever is worst."""
        engine = {
            "type": "reciprocating_engine", "speed_of": "crank", "cycle": 4, "cylinders": {1: "crank", 2: "crank"},
            "firing_order": [1, 2], "bore": "90 mm", "stroke": "90 mm", "rod_length": "150 mm",
            "reciprocating_mass": "1 kg", "orders": [1, 2],
        }  # fmt: skip
        free, held = running(engine), running({**engine, "reaction": "block"})
        excitation = held.definition.excitations["it"]
        torques = excitation.torques(np.array(held.definition.speeds.values))
        assert torques.nodes == ("crank",)
        found = held.order_response(list(READ)).values
        orders = torques.orders.tolist()
        unit = by_superposition(held, dict.fromkeys(orders, 1.0))
        assert found == pytest.approx(unit * torques.amplitudes, rel=1e-8)
        assert not np.allclose(found, free.order_response(list(READ)).values, rtol=0.01)

    def test_measured_torque(self):
        table = {"columns": ["order", "amplitude [N*m]"], "rows": [[2, 7]]}
        rig = running({"type": "measured", "node": "crank", "reaction": "block", "table": table})
        assert rig.order_response(list(READ)).values == pytest.approx(by_superposition(rig, {2: 7}), rel=1e-8)

    def test_machine_and_its_stator_as_before(self):
        machine = {
            "type": "electric_machine",
            "node": "crank",
            "stator": "block",
            "orders": {6: {"amplitude": "3 N*m"}},
        }
        rig = running(machine)
        assert rig.order_response(list(READ)).values == pytest.approx(by_superposition(rig, {6: 3}), rel=1e-8)

    def test_relative_motion(self):
        """Imposed at order 2: what an imposed relative angle does at that frequency."""
        motion = {"type": "harmonic", "node": "crank", "reaction": "block", "orders": {2: {"angle": "0.1 deg"}}}
        rig = running(motion)
        at = np.array(rig.definition.speeds.values)
        expected = [readings(dense(w / np.pi, held=[PAIR], given=1), w / np.pi) * np.radians(0.1) for w in at]
        assert rig.order_response(list(READ)).values[:, 0] == pytest.approx(np.array(expected), rel=1e-8)

    def test_generalised_force_is_on_the_relative_motion(self):
        rig = running(
            {"type": "harmonic", "node": "crank", "reaction": "block", "orders": {2: {"amplitude": "10 N*m"}}}
        )
        found = rig.critical_speeds(speeds=np.array([10.0, 400.0]))
        assert found.crossings
        for one in found.crossings:
            shape = dict(zip(found.nodes, one.mode.shape, strict=True))
            assert one.generalised_force == pytest.approx(10 * abs(shape["crank"] - shape["block"]))

    @pytest.mark.parametrize(
        ("reaction", "message"),
        [("blok", "unknown-node"), ("crank", r"excitations\.it\.reaction: .*same-node")],
    )
    def test_faults(self, reaction, message):
        with pytest.raises(ModelError, match=message):
            running({"type": "harmonic", "node": "crank", "reaction": reaction, "orders": {2: {"amplitude": "1 N*m"}}})

    def test_locked_on_both_sides(self):
        rig = running(
            {"type": "harmonic", "node": "crank", "reaction": "block", "orders": {2: {"amplitude": "1 N*m"}}},
            elements=[tn.RigidCoupling("stuck", nodes=("crank", "block"), enabled=False)],
        )
        with pytest.raises(UsageError, match="no-effect"):
            rig.switched(on=["stuck"]).order_response("T_d")
        # A shaft that does not turn has no orders: nothing says how fast its torque goes round.
        fixed = running(
            {"type": "harmonic", "node": "crank", "reaction": "block", "orders": {2: {"amplitude": "1 N*m"}}},
            elements=[tn.Lock("stop", node="crank")],
        )
        with pytest.raises(UsageError, match="no-effect"):
            fixed.order_response("T_d")

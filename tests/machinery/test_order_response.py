"""Excitation by orders: against a dense solve made elsewhere, closed forms, and what a user may write wrong."""

import csv
import json
import re
from fractions import Fraction

import numpy as np
import pytest
from support.command_line import run
from support.forced_plants import NAMES, plant, reference
from support.written_models import TWO_FANS

import torsionnet as tn
from torsionnet.linear.responses import shared_response
from torsionnet.machinery.excitations.pressure_trace import piston_curvature, piston_rate
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.orders import order_solution as solver
from torsionnet.machinery.orders.order_line import OrderLine
from torsionnet.machinery.orders.order_response import OrderResponse

CASES = {"normal": lambda data: data["normal"], "motored": lambda data: data["misfire"]["motored"],
         "gas_off": lambda data: data["misfire"]["gas_off"]}  # fmt: skip
RPM = np.pi / 30


def line_of(run, key, output):
    """The amplitudes over speed of a line as the references name it: ``1.5`` or ``propeller 4``."""
    excitation, _, order = key.rpartition(" ")
    return run.of_order(float(order), output, excitation or "engine")


class TestAgainstADenseSolve:
    @pytest.mark.parametrize("firing", CASES)
    @pytest.mark.parametrize("name", NAMES)
    def test_every_order_of_torque_and_angle(self, name, firing):
        data = reference(name)
        cases = CASES[firing](data)
        stiffness = {spring["name"]: spring["stiffness"] for spring in data["model"]["springs"]}
        run = plant(data).configured(firing).order_response(
            [f"twist({spring})" for spring in cases[0]["torque"]] + [f"angle({node})" for node in cases[0]["angle"]]
        )  # fmt: skip
        assert run.rpm == pytest.approx([case["rpm"] for case in cases])
        for at, case in enumerate(cases):
            quantities = [(f"twist({name})", stiffness[name], found) for name, found in case["torque"].items()]
            quantities += [(f"angle({node})", 1.0, found) for node, found in case["angle"].items()]
            for output, factor, expected in quantities:
                for key, parts in expected.items():
                    assert factor * line_of(run, key, output)[at] == pytest.approx(complex(*parts), rel=1e-8)

    @pytest.mark.parametrize("firing", CASES)
    @pytest.mark.parametrize("name", NAMES)
    def test_half_ranges(self, name, firing):
        data = reference(name)
        cases = CASES[firing](data)
        stiffness = {spring["name"]: spring["stiffness"] for spring in data["model"]["springs"]}
        springs = list(cases[0]["torque"])
        run = plant(data).configured(firing).order_response([f"twist({spring})" for spring in springs])
        for at, case in enumerate(cases):
            found = {spring: run.half_range[at, place] * stiffness[spring] for place, spring in enumerate(springs)}
            assert {key: found[key] for key in case["half_range"]} == pytest.approx(case["half_range"], rel=1e-4)


class TestManySpeeds:
    def test_speeds_do_not_depend_on_those_solved_with_them(self, monkeypatch):
        rig = plant(reference("forced_two_stroke_propulsion"))
        whole = rig.order_response("twist(thrust)")
        monkeypatch.setattr("torsionnet.machinery.orders.operating_groups.SPEEDS_PER_BLOCK", 2)
        monkeypatch.setattr("torsionnet.machinery.orders.synthesis.MOST_WAVEFORM_POINTS", 1)
        parts = rig.order_response("twist(thrust)")
        assert parts.values == pytest.approx(whole.values, rel=1e-13)
        assert parts.half_range == pytest.approx(whole.half_range, rel=1e-12)


FOLLOWING = {"by": "speed", "of": "a", "table": {"50 rpm": "700 N*m/rad", "400 rpm": "1200 N*m/rad"}}
BY_VIBRATION = {"by": "vibratory_torque", "of": "k_1", "table": {"0 N*m": "700 N*m/rad", "100 N*m": "1200 N*m/rad"}}


class TestConditionsOfOnePlant:
    """They share one solution where nothing but torques differs, and only there."""

    CHANGES = (
        "firing=normal", "coupling=soft", "firing=misfire,coupling=soft", "damping=heavy", "firing=misfire",
        "firing=weak", "firing=normal",
    )  # fmt: skip

    @staticmethod
    def model():
        harmonic = {"type": "harmonic", "node": "a", "orders": {2: {"amplitude": "10 N*m"}}}
        return {
            "torsionnet": 1,
            "parameters": {"k": "300 N*m/rad", "k_b": "900 N*m/rad"},
            "elements": {
                **{f"J_{node}": {"type": "inertia", "node": node, "inertia": "0.4 kg*m^2"} for node in "abc"},
                "k_1": {"type": "spring", "nodes": ["a", "b"], "stiffness": "k", "damping": 2},
                "k_2": {"type": "spring", "nodes": ["b", "c"], "stiffness": "k_b", "damping": 1},
            },
            "speeds": {"of": "a", "list": ["80 rpm", "200 rpm", "310 rpm"]},
            "excitations": {"motor": harmonic},
            "configurations": {
                "firing": {"normal": {}, "weak": {"motor.orders": {2: {"amplitude": "6 N*m"}}}, "misfire": {"motor.orders": {2: {"amplitude": "10 N*m"}, 0.5: {"amplitude": 4}}}},
                "coupling": {"stiff": {}, "soft": {"k": "100 N*m/rad"}},
                "damping": {"light": {}, "heavy": {"k_2.damping": 9}},
            },
        }  # fmt: skip

    @pytest.mark.few(1)
    @pytest.mark.parametrize(
        "k_b", ["900 N*m/rad", FOLLOWING, BY_VIBRATION], ids=["constant", "by speed", "by vibratory torque"]
    )
    def test_each_has_its_own_values(self, k_b):
        model = self.model()
        model["parameters"]["k_b"] = k_b
        model["operating_point"] = {"speed": {"a": "100 rpm"}}
        text = json.dumps(model)
        shared = tn.loads(text)
        for change in self.CHANGES:
            fresh = tn.loads(text).configured(change)
            found = shared.configured(change).order_response(["twist(k_1)", "a"])
            expected = fresh.order_response(["twist(k_1)", "a"])
            assert found.values == pytest.approx(expected.values, rel=1e-12)

    def test_a_misfire_is_not_solved_again(self, monkeypatch):
        solved = []
        original = shared_response.frequency_response
        monkeypatch.setattr(shared_response, "frequency_response", lambda *args: solved.append(args) or original(*args))
        rig = tn.loads(json.dumps(self.model()))
        for change in ("firing=normal", "firing=normal,coupling=stiff"):
            rig.configured(change).order_response("a")
        assert len(solved) == 1
        rig.configured("coupling=soft").order_response("a")
        assert len(solved) == 2

    def test_a_misfire_is_not_solved_again_where_parameters_follow_the_speed(self, monkeypatch):
        solved = []
        original = solver.responses_at_own_frequencies
        monkeypatch.setattr(
            solver, "responses_at_own_frequencies", lambda *args: solved.append(args) or original(*args)
        )
        model = self.model()
        model["parameters"]["k_b"] = FOLLOWING
        model["operating_point"] = {"speed": {"a": "100 rpm"}}
        rig = tn.loads(json.dumps(model))
        for change in ("firing=normal", "firing=normal,coupling=stiff"):
            rig.configured(change).order_response("a")
        assert len(solved) == 1
        rig.configured("coupling=soft").order_response("a")
        assert len(solved) == 2


class TestCylinders:
    def test_motion_of_the_piston_is_the_derivative_of_its_way(self):
        """x = 1 - cos phi + (1 - sqrt(1 - (ratio sin phi)^2))/ratio, differentiated by complex steps."""
        ratio, angle = 0.31, np.linspace(0, 2 * np.pi, 37)

        def way(phi):
            return 1 - np.cos(phi) + (1 - np.sqrt(1 - (ratio * np.sin(phi)) ** 2)) / ratio

        assert piston_rate(angle, ratio) == pytest.approx(way(angle + 1e-20j).imag / 1e-20, abs=1e-14)
        step = 1e-4
        second = (way(angle + step) - 2 * way(angle) + way(angle - step)) / step**2
        assert piston_curvature(angle, ratio) == pytest.approx(second, abs=1e-6)

    @pytest.mark.parametrize(
        ("misfire", "order", "size"), [([], 3, 6), ([], 6, 6), ([], 1.5, 0), ([], 0.5, 0), ([3], 3, 5), ([3], 0.5, 1), ([3], 1, 1)]
    )  # fmt: skip
    def test_phase_vector_sum_of_a_rigid_crankshaft(self, misfire, order, size):
        """A four-stroke inline six 1-5-3-6-2-4: 6 at multiples of 3, else 0; without one cylinder 5 and 1."""
        phi = 4 * np.pi * np.arange(720) / 720
        pressure = 5e6 + 4e6 * np.cos(phi - 0.3) + 3e6 * np.cos(phi / 2) + 2e6 * np.cos(1.5 * phi - 1)
        engine = engine_of(
            6, [1, 5, 3, 6, 2, 4], orders=[order], mass=0, gas={"fired": pressure.tolist()}, gas_off=misfire
        )
        single = engine_of(1, [1], orders=[order], mass=0, gas={"fired": pressure.tolist()})
        found, one = (each.torques(np.array([100.0])).amplitudes[0, 0] for each in (engine, single))
        assert abs(found.sum()) == pytest.approx(size * abs(one[0]), abs=1e-9 * abs(one[0]))

    def test_phase_vector_sum_of_a_mode(self):
        """Shape 1, .9, .7, .45, .15, -.1: order 0.5 -> 0.7399, 1.5 -> 2.1, 3 -> 3.1 (of the amplitude of a cylinder)."""
        shape = np.array([1, 0.9, 0.7, 0.45, 0.15, -0.1])
        engine = engine_of(6, [1, 5, 3, 6, 2, 4])
        phases = np.array([engine.firing_phases[number] for number in range(1, 7)])
        sums = [abs((shape * np.exp(-1j * order * phases)).sum()) for order in (0.5, 1.5, 3)]
        assert sums == pytest.approx([0.7399, 2.1, 3.1], abs=5e-5)

    def test_two_cylinders_on_one_throw_add_up(self):
        """A V engine: angles instead of an order, several cylinders on a node."""
        engine = ReciprocatingEngine(
            speed_of="a", cycle=2, cylinders={1: "a", 2: "a"}, firing_angles={1: 0, 2: "90 deg"}, orders=[2],
            bore=0.1, stroke=0.1, rod_length=0.2, reciprocating_mass=1.0,
        )  # fmt: skip
        assert abs(engine.torques(np.array([50.0])).amplitudes[0, 0, 0]) < 1e-12  # half a period apart


def engine_of(count, order, *, orders=(), mass=1.0, gas=None, gas_off=()):
    return ReciprocatingEngine(
        speed_of="c1", cycle=4, cylinders={number: f"c{number}" for number in range(1, count + 1)}, firing_order=order,
        orders=list(orders), bore=0.1, stroke=0.12, rod_length=0.24, reciprocating_mass=mass, gas=gas, gas_off=list(gas_off),
    )  # fmt: skip


class TestSumOverOrders:
    def test_two_orders_with_their_phases(self):
        """cos(phi) and cos(3 phi), in phase and against each other, on a fine grid."""
        both = response(two_lines(), [[1, 1], [1, -1]])
        phi = np.linspace(0, 2 * np.pi, 200_001)
        expected = [np.max(np.cos(phi) + sign * np.cos(3 * phi)) for sign in (1, -1)]
        assert both.half_range[:, 0] == pytest.approx(expected, rel=1e-5)
        assert both.rms[:, 0] == pytest.approx([1, 1])

    def test_excitations_without_a_common_cycle_are_bounded(self):
        lines = (OrderLine("a", 1, Fraction("1")), OrderLine("b", 1, Fraction("1000003/1000000")))
        both = response(lines, [[3, 4]])
        assert both.revolutions is None
        assert both.half_range[0, 0] == pytest.approx(7)
        assert both.rms[0, 0] == pytest.approx(np.sqrt(12.5))
        assert "no short common cycle" in both.table().to_text()
        with pytest.raises(tn.UsageError, match="no short common cycle"):
            both.waveform()

    def test_shafts_without_a_common_cycle_keep_the_phases_of_their_own_orders(self):
        """Two orders of one shaft and one of another, against the sum over a long time."""
        ratio = Fraction(1618033, 1000000)
        lines = (OrderLine("a", 1, Fraction(1)), OrderLine("a", 3, Fraction(1)), OrderLine("b", 2, ratio))
        both = response(lines, [[1, -1, 0.5]])
        phi = np.linspace(0, 2 * np.pi * 400, 1_000_001)
        total = np.cos(phi) - np.cos(3 * phi) + 0.5 * np.cos(2 * float(ratio) * phi)
        assert both.revolutions is None
        assert both.half_range[0, 0] == pytest.approx((total.max() - total.min()) / 2, rel=2e-4)

    @pytest.mark.slow
    def test_long_common_cycle(self):
        """Orders that all crest at one angle, between any points; odd counts, so that the trough is as deep."""
        counts, sizes, angle = np.array([175, 333, 611, 1777]), np.array([1.0, 0.4, 0.2, 0.03]), 1.234567
        lines = tuple(OrderLine("a", float(count), Fraction(1, 7)) for count in counts)
        run = response(lines, [sizes * np.exp(-1j * counts * angle), 2j * sizes * np.exp(-1j * counts * angle)])
        assert run.revolutions == 7
        assert run.half_range[0, 0] == pytest.approx(sizes.sum(), rel=1e-12)
        phi = np.linspace(0, 2 * np.pi, 2_000_001)
        turned = (2 * sizes[:, None] * np.cos(np.outer(counts, phi - angle) + np.pi / 2)).sum(axis=0)
        assert run.half_range[1, 0] == pytest.approx((turned.max() - turned.min()) / 2, rel=1e-5)

    def test_long_common_cycle_of_equal_crests(self):
        """More of them than are followed one by one."""
        lines = (OrderLine("a", 1001.0, Fraction(1, 2)), OrderLine("b", 1.0, Fraction(1)))
        assert response(lines, [[1, 1e-9j]]).half_range[0, 0] == pytest.approx(1, rel=1e-6)

    def test_lines_of_one_frequency_add_up_with_their_phases(self):
        lines = (OrderLine("a", 2, Fraction(1)), OrderLine("b", 1, Fraction(2)))
        assert response(lines, [[1, -1]]).half_range[0, 0] == pytest.approx(0, abs=1e-12)

    def test_one_order_of_two_shafts_is_not_added(self):
        """Order 4 of the engine and of the propeller are different frequencies: which is meant has to be said."""
        run = response((OrderLine("engine", 4, Fraction(1)), OrderLine("screw", 4, Fraction(1, 5))), [[1, 2]])
        with pytest.raises(tn.UsageError, match="ambiguous-name"):
            run.of_order(4)
        assert run.of_order(4, excitation="screw") == pytest.approx([2])


def two_lines():
    return OrderLine("e", 1, Fraction(1)), OrderLine("e", 3, Fraction(1))


def response(lines, values):
    values = np.array(values, dtype=complex)[:, :, None]
    return OrderResponse(np.arange(1.0, len(values) + 1), "a", lines, values, (tn.Channel("x", "rad"),), "made up")


class TestGearedShafts:
    @pytest.mark.parametrize("ratio", [2.5, -2.5])
    def test_order_of_a_shaft_behind_a_gear(self, ratio):
        """A rigid drive: the angle is the torque over inertia and frequency squared, whichever way the wheel turns."""
        plant = tn.Drivetrain(
            "geared",
            [tn.Inertia("fast", node="a", inertia=1), tn.Gear("stage", nodes=("a", "b"), ratio=ratio),
             tn.Inertia("slow", node="b", inertia=3)],
            speeds={"of": "a", "list": ["600 rpm"]},
            excitations={"fan": {"type": "harmonic", "node": "b", "orders": {5: {"amplitude": 7, "phase": "30 deg"}}}},
        )  # fmt: skip
        run = plant.order_response("a")
        assert run.lines[0].relative == 2
        omega = 2 * 600 * RPM
        driving = 7 / 2.5 * np.exp(1j * np.pi / 6)  # a torque that drives b drives a, too
        assert run.values[0, 0, 0] == pytest.approx(-driving / ((1 + 3 / 2.5**2) * omega**2))

    def test_a_shaft_without_a_fixed_ratio_is_refused(self):
        elements = [
            tn.Inertia("sun_body", node="s", inertia=1),
            tn.Inertia("ring_body", node="r", inertia=1),
            tn.Inertia("arm", node="c", inertia=1),
            tn.Planetary("set", sun="s", ring="r", carrier="c", ratio=2),
        ]
        fan = {"type": "harmonic", "node": "r", "orders": {2: {"amplitude": 1}}}
        with pytest.raises(tn.ModelError, match=r"excitations\.fan\.speed_of: .*no-ratio"):
            tn.Drivetrain("free", elements, speeds={"of": "s", "list": [100]}, excitations={"fan": fan})


class TestCommand:
    @pytest.fixture(autouse=True)
    def folder(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "plant.yaml").write_text(TWO_FANS)
        return tmp_path

    def test_worst_speed_is_that_of_the_resonance(self):
        """sqrt(k (1/J_m + 1/J_f)) is 50.33 Hz: 503 rpm for order 6."""
        text = run("orders", "plant.yaml", "-c", "rough", "--output", "torque(shaft)").stdout
        assert re.search(r"^motor 6 +500\.\d+ ", text, re.MULTILINE)
        assert "common cycle: 1 revolution of m" in text

    def test_an_alternative_changes_an_excitation(self, folder):
        rows = read_csv_of(folder, "-c", "all")
        sizes = {
            name: max(
                abs(complex(float(row["f real [rad]"]), float(row["f imag [rad]"])))
                for row in rows
                if (row["configuration"], row["excitation"]) == (name, "motor")
            )
            for name in ("smooth", "rough")
        }
        assert sizes["rough"] == pytest.approx(4 * sizes["smooth"])
        assert "motor.orders = {'6': {'amplitude': '5 N*m'}}" in run("show", "plant.yaml").stdout

    def test_only_one_excitation(self, folder):
        assert {row["excitation"] for row in read_csv_of(folder, "--excitation", "fan")} == {"fan"}

    @pytest.mark.parametrize(
        ("options", "code", "text"),
        [
            (["plant.yaml", "--output", "g"], 2, "unknown-channel"),
            (["plant.yaml", "--output", "f", "--excitation", "fun"], 2, 'did you mean "fan"? there are motor, fan'),
            (["dmf_rig", "--output", "theta_1"], 2, "missing-entry"),
            (["plant.yaml"], 2, "Missing option '--output'"),
        ],
    )
    def test_what_is_wrong_is_told(self, options, code, text):
        assert text in run("orders", *options, code=code).stderr


def read_csv_of(folder, *options):
    run("orders", "plant.yaml", "--output", "f", "--csv", folder / "orders.csv", *options)
    lines = (folder / "orders.csv").read_text().splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


ENGINE = """
    type: reciprocating_engine
    speed_of: c1
    cycle: 4
    cylinders: {1: c1, 2: c2}
    firing_order: [1, 2]
    bore: 100 mm
    stroke: 120 mm
    rod_length: 240 mm
    reciprocating_mass: 1 kg
"""
FILE = """torsionnet: 1
name: two cylinders
elements:
  throw_1: {{type: inertia, node: c1, inertia: 0.1}}
  crank: {{type: spring, nodes: [c1, c2], stiffness: 1 MN*m/rad}}
  throw_2: {{type: inertia, node: c2, inertia: 0.1}}
speeds: {{of: c1, range: 600..1200 rpm, step: 100 rpm}}
excitations:
  engine:{engine}"""


class TestFiles:
    def test_what_is_written_can_be_read_again(self):
        rig = tn.loads(FILE.format(engine=ENGINE + "configurations: {idle: {engine.gas_off: [2]}}\n"))
        again = tn.loads(rig.to_yaml())
        assert again == rig
        assert again.configured("idle").definition.excitations["engine"].gas_off == (2,)
        assert rig.order_response("torque(crank)").rpm == pytest.approx(np.arange(600, 1201, 100))

    def test_an_alternative_changes_entries_that_belong_together(self):
        """Each of the two alone would contradict the engine."""
        change = "{engine.cylinders: {1: c1, 2: c2, 3: c2}, engine.firing_order: [1, 3, 2]}"
        rig = tn.loads(FILE.format(engine=f"{ENGINE}configurations: {{three: {change}}}\n"))
        assert rig.configured("three").definition.excitations["engine"].firing_order == (1, 3, 2)

    @pytest.mark.parametrize(
        ("old", "new", "where", "kind"),
        [
            ("firing_order: [1, 2]", "firing_order: [1, 1]", "14:5", "unknown-name"),
            ("firing_order: [1, 2]", "firing_order: [1, 2, 3]", "14:5", "unknown-name"),
            ("cycle: 4", "cycle: 3", "12:12", "out-of-range"),
            ("rod_length: 240 mm", "rod_length: 24 mm", "17:17", "contradicting-values"),
            ("rod_length: 240 mm", "rod_length: 240", "17:17", "implausible-size"),
            ("speed_of: c1", "speed_of: c7", "11:15", "unknown-node"),
            ("2: c2}", "2: c9}", "13:27", "unknown-node"),
            ("mass: 1 kg", "mass: 1 kg\n    orders: [0.5, 0.75]", "19:13", "contradicting-values"),
            ("mass: 1 kg", "mass: 1 kg\n    misfire: [2]", "19:5", "missing-entry"),
            ("mass: 1 kg", "mass: 1 kg\nconfigurations: {a: {engin.misfire: [2]}}", "19:22", "unknown-element"),
            ("mass: 1 kg", "mass: 1 kg\nconfigurations: {a: {engine.misfir: [2]}}", "19:22", "unknown-name"),
            ("mass: 1 kg", "mass: 1 kg\nconfigurations: {a: {engine.gas_off: [7]}}", "19:38", "unknown-name"),
            ("mass: 1 kg", "mass: 1 kg\nconfigurations: {a: {engine.speed_of: c7}}", "19:39", "unknown-node"),
            (
                "mass: 1 kg",
                "mass: 1 kg\nconfigurations: {a: {engine.cylinders: {1: c1, 2: c2, 3: c2}, engine.bore: 1 m}}",
                "19:22",
                "unknown-name",
            ),
            ("type: reciprocating_engine", "type: recipro_engine", "10:11", "unknown-word"),
            ("step: 100 rpm", "list: [600 rpm]", "7:", "contradicting-entries"),
            ("600..1200 rpm", "1200..600 rpm", "7:", "unordered-rows"),
            ("cylinders: {1: c1", "cylinders: {front: c1", "13:17", "invalid-name"),
            ("mass: 1 kg", "mass: 1 kg\n    orders: [1e9]", "19:14", "out-of-range"),
            ("mass: 1 kg", "mass: 1 kg\n    gas: {fired: [1, 2]}", "19:", "unfit-curve"),
        ],
    )
    def test_faults_have_their_place(self, old, new, where, kind):
        text = FILE.format(engine=ENGINE)
        assert old in text
        with pytest.raises(tn.ModelError) as caught:
            tn.loads(text.replace(old, new, 1))
        places = [str(fault).partition("\n")[0] for fault in caught.value.faults if fault.kind == kind]
        assert any(place.startswith(f"<text>:{where}") for place in places), caught.value

    def test_two_axes_may_not_change_one_entry(self):
        text = FILE.format(engine=ENGINE + "configurations: {a: {x: {engine.bore: 0.1}}, b: {y: {engine.bore: 0.2}}}\n")
        with pytest.raises(tn.ModelError, match=r":19:54: .*repeated-name"):
            tn.loads(text)

    def test_a_section_that_configurations_do_not_change_is_called_by_its_name(self):
        text = TWO_FANS.replace("smooth: {", "smooth: {report.title: f, ")
        with pytest.raises(tn.ModelError, match=r":11:35: .*fixed-entry"):
            tn.loads(text, file="plant.yaml")

    def test_an_excitation_on_what_is_locked_is_refused(self):
        text = FILE.format(engine=ENGINE).replace("speeds:", "  brake: {type: lock, node: c2}\nspeeds:")
        with pytest.raises(tn.ModelError, match=r":14:27: .*no-effect"):
            tn.loads(text)
        either = tn.loads(text + "configurations: {free: {off: [brake]}, held: {}}\n")
        assert either.configured("free").order_response("c1").values.any()
        with pytest.raises(tn.UsageError, match="no-effect"):
            either.configured("held").order_response("c1")

    def test_a_trace_that_does_not_close(self):
        pressure = list(np.linspace(1e5, 9e6, 721))
        with pytest.raises(tn.ModelError, match=r"gas\.fired: .*100000.*unfit-curve"):
            engine_of(1, [1], gas={"fired": pressure})

    def test_a_trace_with_both_ends_is_that_with_one(self):
        pressure = 3e6 + 2e6 * np.cos(2 * np.pi * np.arange(721) / 720)
        one, both = (engine_of(1, [1], gas={"fired": pressure[:count].tolist()}) for count in (720, 721))
        assert one.torques(np.array([9.0])).amplitudes == pytest.approx(both.torques(np.array([9.0])).amplitudes)

    def test_pressures_in_bar_without_unit_are_told(self):
        with pytest.raises(tn.ModelError, match="write 90 bar"):
            engine_of(1, [1], gas={"fired": (50 + 40 * np.cos(2 * np.pi * np.arange(72) / 72)).tolist()})

    def test_without_excitations_or_speeds(self):
        rig = tn.load("dmf_rig")
        with pytest.raises(tn.UsageError, match="missing-entry"):
            rig.order_response("theta_1")
        with pytest.raises(tn.UsageError, match="missing-entry"):
            rig.order_response("theta_1", speeds=[10.0], speed_of="motor")


class TestPictures:
    def test_axes_and_lines(self):
        from torsionnet.plot import order_response as drawn

        data = reference("forced_inline_six")
        run = plant(data).order_response(["torque(crank3)", "angle(hub)"])
        figure = drawn(run, conventions=tn.Conventions(angle="deg"))
        assert [axes.get_ylabel() for axes in figure.axes] == ["torque(crank3) [kN·m]", "angle(hub) [deg]"]
        assert figure.axes[-1].get_xlabel() == "speed of cyl1 [rpm]"
        total = figure.axes[0].lines[0]
        assert total.get_ydata() == pytest.approx(run.half_range[:, 0] / 1e3)
        assert all((line.get_ydata() <= 2 * total.get_ydata()).all() for line in figure.axes[0].lines)

    def test_waveform_over_two_revolutions(self):
        from torsionnet.plot import waveform

        run = plant(reference("forced_inline_six")).order_response("torque(crank3)")
        (axes,) = waveform(run, speed=run.speeds[1]).axes
        values = axes.lines[0].get_ydata()
        assert "[kN·m]" in axes.get_ylabel()
        assert axes.get_xlim() == pytest.approx((0, 720))
        assert (values.max() - values.min()) / 2 == pytest.approx(run.half_range[1, 0] / 1e3, rel=1e-3)
        with pytest.raises(tn.UsageError, match="outside the speeds calculated"):
            waveform(run, speed=1)

    def test_waterfall_has_a_spectrum_at_the_height_of_every_speed(self):
        from torsionnet.plot import waterfall

        run_ = (
            tn.loads(TWO_FANS)
            .configured("rough")
            .order_response("torque(shaft)", speeds=np.array([40, 60, 100]) * RPM * 10)
        )
        axes = waterfall(run_).axes[0]
        spectra = axes.lines[:3]
        assert [line.get_ydata()[0] for line in spectra] == pytest.approx([1000, 600, 400])  # the one in front last
        sizes = np.abs(run_.values[2, :, 0])
        highest = spectra[0].get_xdata()[np.argmax(spectra[0].get_ydata())]
        assert highest == pytest.approx([6, 5][int(np.argmax(sizes))] * 1000 / 60)
        assert {text.get_text() for text in axes.texts} >= {"motor 6"}
        # The bar beside them is so high as its value in their scale.
        value, unit = next(text.get_text() for text in axes.texts if "N·m" in text.get_text()).split()
        rise = max(np.ptp(line.get_ydata()) for line in spectra)
        scale = {"N·m": 1.0, "kN·m": 1e-3}[unit] * np.abs(run_.values).max()
        assert np.ptp(axes.lines[3].get_ydata()) / rise == pytest.approx(float(value) / scale, rel=1e-6)
        # The highest line has 0.15 of the range of speeds; names stand at the ends of rays, on the top of the last line.
        assert rise == pytest.approx(0.15 * 600)
        top = max(line.get_ydata().max() for line in spectra)
        assert axes.get_ylim() == pytest.approx((400 - 0.02 * 600, top + 0.12 * 600))
        (name,) = (text for text in axes.texts if text.get_text() == "motor 6")
        size = sizes[[str(line) for line in run_.lines].index("motor 6")] / np.abs(run_.values).max()
        assert name.xy == pytest.approx((6 * 1000 / 60, 1000 + 0.15 * 600 * size))
        low, high = axes.get_xlim()
        assert axes.lines[3].get_xdata() == pytest.approx([low + 0.99 * (high - low)] * 2)

    def test_waterfall_of_what_does_not_vibrate(self):
        """Two equal discs driven alike do not twist the shaft between them."""
        from torsionnet.plot import waterfall

        still = response((OrderLine("motor", 2, Fraction(1)),), [[0.0], [0.0]])
        assert waterfall(still).axes[0].lines

    @pytest.mark.few(1)
    @pytest.mark.parametrize("picture", ["waterfall", "waveform"])
    def test_command_draws_one_for_each_output(self, tmp_path, monkeypatch, picture):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "plant.yaml").write_text(TWO_FANS)
        outputs = ["--output", "torque(shaft)", "--output", "f"]
        run("orders", "plant.yaml", "-c", "rough", *outputs, "--picture", picture, "--plot", "p.svg")
        assert len(list(tmp_path.glob("p*.svg"))) == 2

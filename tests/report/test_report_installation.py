"""Sections of the document for approval on conditions, installation and mass-elastic data, against the model files."""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.document_tree import Listing, Paragraph, TableBlock
from torsionnet.report.sections.conditions import _is_long, alternative_words

PLANT = """
torsionnet: 1
name: Boat
source: sheet of the yard
parameters:
  k_c: {value: 20 kN*m/rad, description: rubber of the coupling}
elements:
  crank: {type: inertia, node: c, inertia: 12 kg*m^2, description: all throws}
  rubber: {type: hysteretic_spring, nodes: [c, pin], stiffness: k_c, loss_factor: 0.2}
  mesh: {type: gear, nodes: [pin, w], teeth: [20, -50]}
  line: {type: shaft, nodes: [w, p], outer_diameter: 100 mm, inner_diameter: 40 mm, length: 3 m, inertia: none,
    shear_modulus: 80 GPa, damping: 30 N*m*s/rad}
  screw: {type: propeller, node: p, inertia: 50 kg*m^2, damping: 700 N*m*s/rad}
  ring: {type: viscous_damper, node: c, ring_inertia: 3 kg*m^2, damping: 90 N*m*s/rad}
  pump: {type: spring, nodes: [w, pto], stiffness: 5 kN*m/rad}
  rotor: {type: inertia, node: pto, inertia: 2 kg*m^2}
speeds: {of: c, range: 500..1500 rpm, step: 10 rpm, rated: 1500 rpm}
load: {absorbed_at: p, power: 300 kW, torque_exponent: 2, driven_by: {c: 1}}
excitations:
  motor: {type: harmonic, node: c, orders: {3: {amplitude: 40 N*m}}}
limits:
  rubber: {rule: coupling, element: rubber, T_KN: 4 kN*m, T_KW: 900 N*m, source: data sheet 7}
configurations:
  rubber:
    cold: {k_c: 26 kN*m/rad}
    warm: {}
  pump:
    clutched: {}
    "off": {off: [pump]}
report:
  not_examined: {Astern: the propeller brakes less than ahead}
  idling: [600 rpm]
"""


def section(model, name, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return make_report(model, kind="approval", sections=[name], **options)


def words(report, name):
    return " ".join(str(one.text) for one in of(Paragraph, blocks(report, name)))


ENGINE = """torsionnet: 1
name: one cylinder
elements:
  crank: {type: inertia, node: c, inertia: 2 kg*m^2}
  shaft: {type: spring, nodes: [c, w], stiffness: 1 MN*m/rad}
  wheel: {type: inertia, node: w, inertia: 20 kg*m^2}
speeds: {of: c, range: 500..1500 rpm, step: 50 rpm}
excitations:
  engine: {type: reciprocating_engine, speed_of: c, cycle: 4, cylinders: {1: c}, firing_order: [1], bore: 100 mm,
    stroke: 100 mm, rod_length: 200 mm, reciprocating_mass: 1 kg, gas: GAS}
"""


@pytest.fixture(scope="module")
def found():
    # Of the other sense, with a damper more: the table has no senses.
    brake = "  brake: {type: damper, nodes: [ground, p], damping: 100 N*m*s/rad}\n  ring:"
    text = PLANT.replace("[c, pin]", "[pin, c]").replace("  ring:", brake)
    return tn.loads(text).configured("rubber=cold,pump=clutched").mass_elastic_table()


@pytest.fixture(scope="module")
def installation():
    return section(tn.loads(PLANT), "installation")


@pytest.fixture(scope="module")
def conditions():
    return section(tn.loads(PLANT), "conditions")


class TestMassElastic:
    def test_values_are_those_of_the_file(self, found):
        by_node = {row.node: row for row in found.rows}
        assert [row.number for row in found.rows] == [1, 2, 3, 4, 5, 6]
        inertias = {"c": 12, "pin": 0, "w": 0, "p": 50, "ring.ring": 3, "pto": 2}
        assert {node: row.inertia for node, row in by_node.items()} == inertias
        assert by_node["p"].damping == 800

    def test_shafts_by_hand(self, found):
        by_name = {row.shaft.elements: (row.node, row.shaft) for row in found.rows if row.shaft}
        node, line = by_name["line",]
        polar = math.pi * (0.1**4 - 0.04**4) / 32
        assert line.stiffness == pytest.approx(80e9 * polar / 3, rel=1e-12)
        assert (line.section.outer, line.section.inner) == (0.1, 0.04)
        assert line.section.modulus == pytest.approx(polar / 0.05, rel=1e-12)
        assert line.damping == 30
        rubber = by_name["rubber",][1]
        assert (rubber.stiffness, rubber.loss_factor) == (26e3, pytest.approx(0.2))
        elastic = [replace(rubber, stiffness=stiffness).is_elastic for stiffness in (0.0, 0.5, math.inf)]
        assert elastic == [False, True, False]
        assert {node, line.to} == {"w", "p"}

    def test_referred_to_the_engine_by_the_square_of_the_ratio(self, found):
        """Wheel and screw turn 20/50 as fast: J and k count 0.16 times."""
        by_node = {row.node: row for row in found.rows}
        assert by_node["p"].ratio == pytest.approx(-0.4)
        assert by_node["p"].referred_inertia == pytest.approx(50 * 0.16)
        assert found.total_inertia == pytest.approx(12 + 3 + (50 + 2) * 0.16, rel=1e-12)
        polar = math.pi * (0.1**4 - 0.04**4) / 32
        flexibility = {line.title.partition(",")[0]: line.flexibility for line in found.lines}
        assert flexibility["c to pto"] == pytest.approx(1 / 26e3 + 1 / (5e3 * 0.16), rel=1e-12)
        assert flexibility["p to w"] == pytest.approx(1 / (80e9 * polar / 3 * 0.16), rel=1e-12)

    def test_a_film_and_a_branch_have_lines_of_their_own(self, found):
        assert {line.rows[0].node: line.joins for line in found.lines} == {"c": None, "p": "w", "ring.ring": "c"}
        ring = next(row for row in found.rows if row.node == "ring.ring")
        assert (ring.shaft.stiffness, ring.shaft.damping) == (0, 90)

    def test_modes_are_those_of_the_rows(self):
        """Masses and springs of the table, put together again by hand, vibrate as the plant does."""
        ship = tn.load("two_stroke_ship")
        found = ship.mass_elastic_table().rows
        mass = np.diag([row.inertia for row in found])
        stiff = np.zeros_like(mass)
        places = {row.node: place for place, row in enumerate(found)}
        for row in found:
            if row.shaft:
                one, other = places[row.node], places[row.shaft.to]
                stiff[np.ix_([one, other], [one, other])] += row.shaft.stiffness * np.array([[1, -1], [-1, 1]])
        squares = np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiff)).real)
        assert np.sqrt(squares[1]) / 2 / np.pi == pytest.approx(ship.holzer_table(1).frequency, rel=1e-9)

    def test_a_divided_shaft_is_one_row(self):
        """Five equal segments in series: k = G I_p/L as one spring, half of J = rho I_p L at each end, the sums stay."""
        shaft = {"outer_diameter": 0.3, "inner_diameter": 0.1, "length": 6.0, "shear_modulus": 79.3e9, "density": 7850}
        ends = [tn.Inertia("a", node="a", inertia=400), tn.Inertia("b", node="b", inertia=900)]
        line = tn.Shaft("line", nodes=("a", "b"), segments=5, damping=30, **shaft)
        found = tn.Drivetrain("plant", [*ends, line]).mass_elastic_table()
        polar = math.pi * (0.3**4 - 0.1**4) / 32
        own = 7850 * polar * 6
        assert [(row.node, row.inertia) for row in found.rows] == [
            ("a", pytest.approx(400 + own / 2, rel=1e-12)),
            ("b", pytest.approx(900 + own / 2, rel=1e-12)),
        ]
        (whole,) = [row.shaft for row in found.rows if row.shaft]
        assert (whole.elements, whole.to, whole.length, whole.segments) == (("line",), "b", 6.0, 5)
        assert whole.stiffness == pytest.approx(79.3e9 * polar / 6, rel=1e-12)
        assert whole.damping == pytest.approx(30, rel=1e-12)
        assert found.total_inertia == pytest.approx(1300 + own, rel=1e-12)
        assert found.lines[0].flexibility == pytest.approx(6 / (79.3e9 * polar), rel=1e-12)
        assert "line divided into 5" in " ".join(found.table().notes)
        assert found.table().rows[0][-5:-3] == (6.0, pytest.approx(1e6 * polar / 0.15))

    def test_numbers_of_the_report_are_those_of_the_table(self, found):
        shown = of(TableBlock, blocks(section(tn.loads(PLANT), "mass_elastic"), "mass_elastic"))[0]
        lines = rows(shown)
        assert len(lines) == len(found.rows) + 1
        assert [row[1] for row in lines[:-1]] == [row.node.replace("_", " ") for row in found.rows]
        assert f"{found.total_inertia:.5g}" in lines[-1]
        notes = " ".join(str(note) for note in shown.notes)
        assert "k of rubber: 20 kN·m/rad in warm." in notes
        assert "Without pump in pump off." in notes

    def test_values_of_another_condition_are_one_note(self):
        """Behind a smaller wheel three masses turn 20/40 as fast, which is one sentence with the other loss factor.

        Referred to the engine they count 0.25 times in the sum.
        """
        plant = PLANT.replace('"off": {off: [pump]}', "small: {mesh.teeth: [20, -40], rubber.loss_factor: 0.1}")
        (shown,) = of(TableBlock, blocks(section(tn.loads(plant), "mass_elastic"), "mass_elastic"))
        notes = ["".join(map(str, note)) for note in shown.notes]
        total, note = [one for one in notes if one.endswith(" in small.")]
        assert total == f"Sum of J: {12 + 3 + (50 + 2) * 0.25:g} kg·m² in small."
        assert note == "Loss factor of rubber: 0.1; speed ratio of w, pto, p: −0.5 in small."

    @pytest.mark.slow
    def test_a_brake_changes_no_value_of_the_turbine(self):
        """Speed ratios are those of the turbine that runs; what the brake locks has no orders, but the same masses."""
        (shown,) = of(TableBlock, blocks(section("wind_turbine_3mw", "mass_elastic"), "mass_elastic"))
        notes = ["".join(map(str, note)) for note in shown.notes]
        assert not [one for one in notes if "locked" in one]
        assert len(notes) < 16

    def test_legend_explains_the_columns_that_are_shown(self):
        damped, plain = (
            of(TableBlock, blocks(section(model, "mass_elastic"), "mass_elastic"))[0]
            for model in ("marine_medium_speed", "bulk_carrier")
        )
        legends = ["".join(map(str, table.notes[0])) for table in (damped, plain)]
        assert ["its loss factor" in one for one in legends] == [True, False]
        assert ["speed over that of fly" in one for one in legends] == [True, False]
        assert all(one.endswith(".") for one in legends)

    def test_columns_of_speed_only_where_speeds_differ(self):
        shown = of(TableBlock, blocks(section("two_stroke_ship", "mass_elastic"), "mass_elastic"))[0]
        assert "J referred" not in str(shown.columns)
        assert "referred" not in str(shown.columns)
        assert rows(shown)[-1][1:3] == ("Sum", "103600")  # six throws of 9600, 6200, 800 and 39000 kg*m^2

    def test_unknown_node(self):
        with pytest.raises(tn.UsageError, match="unknown-node"):
            tn.loads(PLANT).mass_elastic_table(referred_to="crnk")


class TestPowers:
    def test_power_is_torque_times_speed_and_balances(self):
        found = tn.loads(PLANT).configured("pump=off").power_balance(1500 * math.pi / 30)
        assert found.given == pytest.approx(300e3)
        assert found.taken == pytest.approx(300e3)
        assert found.torque == pytest.approx(300e3 / (1500 * math.pi / 30))
        for load in found.state.loads:
            if load.torque:
                assert abs(load.power) == pytest.approx(300e3), load.element
        assert found.largest_loss == pytest.approx(0, abs=1e-6)
        assert abs(found.state.of("line").torque) == pytest.approx(300e3 / (600 * math.pi / 30))

    def test_a_loss_in_a_gear_is_seen(self):
        found = tn.loads(PLANT).configured("pump=off").power_balance(1500 * math.pi / 30)
        loads = [replace(one, torque=0.9 * one.torque) if one.port == "w" else one for one in found.state.loads]
        lossy = replace(found, state=replace(found.state, loads=tuple(loads)))
        assert lossy.largest_loss == pytest.approx(30e3)

    @pytest.mark.parametrize(
        ("name", "torque", "power"), [("two_stroke_ship", "1280 kN·m", "14074 kW"), ("bulk_carrier", "636.62 kN·m", "7000 kW")]
    )  # fmt: skip
    def test_rated_torque_is_said(self, name, torque, power):
        report = section(tn.load(name), "installation")
        text = words(report, "installation")
        assert f"torque there {torque}" in text
        assert f"{power} at 105 rpm" in text
        assert "in balance" in text


class TestInstallation:
    def test_machines_with_values_and_sources(self, installation):
        machines = {row[0]: row[1:] for row in rows(of(TableBlock, blocks(installation, "installation"))[0])}
        assert set(machines) == {"Propeller screw", "Gear mesh", "Coupling rubber", "Viscous damper ring", "Crank"}
        data, source = machines["Coupling rubber"]
        assert "Stiffness 20 kN·m/rad" in data
        assert "4 kN·m" in data
        assert "900 N·m" in data
        assert source == "rubber of the coupling; data sheet 7"
        assert machines["Crank"] == ("Inertia 12 kg·m²", "all throws")
        assert "Teeth 20 : −50" in machines["Gear mesh"][0]

    def test_line_has_the_torques_of_the_static_state(self, installation):
        line = rows(of(TableBlock, blocks(installation, "installation"))[1])
        assert [row[0] for row in line] == ["rubber", "mesh", "mesh", "line"]
        assert line[0][2:4] == ("1500.0", "1.910")  # 300 kW / (1500 pi/30 rad/s)
        assert line[3][2:4] == ("-600.0", "-4.775")

    def test_each_load_has_its_line_once(self):
        """Behind a smaller wheel the shaft turns 20/40 as fast with as much power; the rubber changes no mean torque."""
        plant = PLANT.replace('"off": {off: [pump]}', "small: {mesh.teeth: [20, -40]}")
        tables = of(TableBlock, blocks(section(tn.loads(plant), "installation"), "installation"))
        lines = [rows(one)[-1] for one in tables if "along the line" in str(one.caption)]
        assert [row[2:4] for row in lines] == [("-600.0", "-4.775"), ("-750.0", "-3.820")]


class TestConditions:
    def test_speeds_and_idling(self, conditions):
        text = words(conditions, "conditions")
        assert "500 to 1500 rpm of c; rated speed 1500 rpm" in text
        assert "Longer idling at 600 rpm" in text
        assert "All conditions of the model (4) were examined" in text

    def test_what_each_alternative_sets(self, conditions):
        found = rows(of(TableBlock, blocks(conditions, "conditions"))[0])
        assert [row[1:] for row in found] == [
            ("cold", "Rubber: stiffness 26 kN·m/rad instead of 20 kN·m/rad (+30 %)"),
            ("warm", "As the model is written"),
            ("clutched", "As the model is written"),
            ("pump off", "Pump switched off"),
        ]

    def test_a_measure_of_damping_is_called_what_it_is(self):
        """psi = 2 pi eta: 0.9 is a loss factor of 0.1432; what a condition sets is the relative damping."""
        text = PLANT.replace("loss_factor: 0.2", "loss_factor: {psi: psi}").replace(
            "parameters:", "parameters:\n  psi: 0.9", 1
        )
        model = tn.loads(text.replace("cold: {k_c: 26 kN*m/rad}", "cold: {psi: 0.7}"))
        found = rows(of(TableBlock, blocks(section(model, "conditions"), "conditions"))[0])
        assert found[0][2] == "Rubber: relative damping 0.7 instead of 0.9 (−22 %)"
        listed = of(TableBlock, blocks(section(model, "installation"), "installation"))[0]
        machines = {row[0]: row[1] for row in rows(listed)}
        assert "relative damping 0.9 (loss factor 0.1432)" in machines["Coupling rubber"]

    def test_a_pressure_trace_is_told_by_its_file_and_length(self, tmp_path):
        """720 pressures of a file are no text of a table."""
        angles = np.arange(0, 720, 2.0)
        lines = [f"{angle},{5 + 40 * math.exp(-(((angle - 360) / 60) ** 2))}" for angle in angles]
        (tmp_path / "idle.csv").write_text("\n".join(["angle [deg],p [bar]", *lines]), encoding="utf-8")
        gas = "{fired: idle.csv, crankcase: 1 bar, reference: absolute}"
        listed = str([5e5, *[6e5] * 25])
        (tmp_path / "engine.yaml").write_text(
            ENGINE.replace("GAS", gas) + f"configurations:\n  own: {{}}\n  idle: {{engine.gas: {gas}}}\n"
            f"  list: {{engine.gas: {gas.replace('idle.csv', listed)}}}\n",
            encoding="utf-8",
        )
        model = tn.load(tmp_path / "engine.yaml")
        (alternatives,) = model.definition.configurations.values()
        trace = "Engine: gas fired: pressure trace of idle.csv, 360 points"
        assert alternative_words(model, alternatives["idle"]) == trace
        assert "fired: pressure trace of 26 points" in alternative_words(model, alternatives["list"])

    def test_a_dozen_values_are_written_out(self):
        assert [_is_long([1.0] * count) for count in (12, 13)] == [False, True]

    def test_verdicts_are_those_of_the_limits(self, conditions):
        found = rows(of(TableBlock, blocks(conditions, "conditions"))[1])
        plant = tn.loads(PLANT)
        for name in plant.configurations:
            verdict = plant.configured(name).check_limits().verdict
            title = ", ".join(part.partition("=")[2] for part in name.split(",")).replace("off", "pump off")
            (row,) = [one for one in found if one[0] == title.capitalize()]
            assert row[1].startswith(verdict)

    def test_reasons_of_the_author_and_of_the_choice(self):
        report = section(tn.loads(PLANT), "conditions", configurations=["rubber=cold,pump=off"])
        missing = " ".join(str(item) for one in of(Listing, blocks(report, "conditions")) for item in one.items)
        assert "Astern" in missing
        assert "the propeller brakes less than ahead" in missing
        assert "this document is on chosen conditions" in missing
        assert "In no condition examined: warm, clutched." in missing

    @pytest.mark.parametrize(
        ("entry", "told"),
        [
            ("idling: [400 rpm]", r":30:19: .*400.*500.*out-of-range"),
            ("idling: 600 rpm", r":30:18: .*wrong-form"),
            ("not_examined: [Astern]", r":30:24: .*wrong-form"),
            ("not_examined: {Astern: 3}", r":30:33: .*wrong-form"),
        ],
    )
    def test_wrong_entries_are_told(self, entry, told):
        text = PLANT[: PLANT.index("report:")] + f"report: {{{entry}}}\n"
        with pytest.raises(tn.ModelError, match=told):
            tn.loads(text)


@pytest.mark.parametrize("name", ["conditions", "installation", "mass_elastic"])
def test_rigs_have_none_of_these_sections(name):
    assert section("amt_rig", name).sections == ()


@pytest.mark.nightly
def test_every_condition_of_the_marine_plant_has_its_verdict():
    report = section("marine_medium_speed", "conditions")
    found = of(TableBlock, blocks(report, "conditions"))[1]
    titles = [row[0] for row in rows(found)]
    assert len(titles) == len(set(titles)) == 18
    assert all(row[1] for row in rows(found))

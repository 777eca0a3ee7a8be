"""Rules of societies: their formulas worked out by hand, generating sets, separation margins, and words of a form."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.limit_cases import hump, m68, stressed

import torsionnet as tn
from torsionnet.base.phrases import phrase
from torsionnet.machinery.checks.section_checks import limit_subject, unfit_limits
from torsionnet.machinery.limits.class_rule_shaft import GeneratingSetShaft
from torsionnet.machinery.limits.shaft_limit import NOT_AT_HAND, SHAFT_SOCIETIES, SOCIETIES
from torsionnet.machinery.verdicts.shaft_margins import shaft_margins
from torsionnet.report import make_report
from torsionnet.report.document_tree import Heading, Math, TableBlock, TableGroup
from torsionnet.report.plan.report_plan import SECTIONS, ReportPlan
from torsionnet.report.report_data import ReportData, cases_of
from torsionnet.report.report_request import ReportRequest
from torsionnet.report.sections.conditions import society_form
from torsionnet.report.sections.resonances import separation_margins
from torsionnet.report.template_reading import in_society_words

RPM = np.arange(20.0, 104.01, 0.5)


def generator_set(**more):
    return {"rule": "generating_set_shaft", "element": "shaft", "shaft": "generator", "material": "carbon",
            "tensile_strength": "440 MPa", **more}  # fmt: skip


SHAFTING = """torsionnet: 1
name: two stages and a line
elements:
  motor: {type: inertia, node: a, inertia: 20}
  fast: {type: gear, nodes: [a, b], ratio: -3}
  lay: {type: shaft, nodes: [b, c], outer_diameter: 200 mm, length: 0.5 m}
  slow: {type: gear, nodes: [c, d], ratio: -3}
  line: {type: shaft, nodes: [d, p], outer_diameter: 300 mm, length: 6 m}
  screw: {type: inertia, node: p, inertia: 3000}
  water: {type: damper, nodes: [p, ground], damping: 9000}
speeds: {of: p, range: 60..110 rpm, step: 2 rpm, rated: 100 rpm}
excitations: {screw: {type: propeller, node: p, blades: 4, torque: 60 kN*m, rated: 100 rpm, blade_orders: {1: {share: 8 %}}}}
limits: {line: {rule: iacs_m68, element: line, shaft: intermediate, feature: integral_flange, material: carbon, tensile_strength: 500 MPa}}
"""


class TestPropulsionShafts:
    """KR Part 5 Chapter 4 (2025), 202: tau_1 = (T_s + 160)/18 C_k C_d (3 - 2 lambda^2), tau_2 = 1.7 tau_1/sqrt(C_k)."""

    @pytest.mark.parametrize("rules", SHAFT_SOCIETIES)
    @pytest.mark.parametrize(
        ("feature", "shaft", "c_k"), [("tapered_keyway", "intermediate", 0.6), ("keyless", "propeller", 0.55)]
    )
    def test_formula(self, rules, feature, shaft, c_k):
        found = stressed(hump(10, 50), m68(rules=rules, feature=feature, shaft=shaft), diameter=0.5)
        continuous, passing = ("tau_1", "tau_2") if rules == "kr" else ("tau_C", "tau_T")
        c_d = 0.35 + 0.93 * 500**-0.2
        for rpm in (30.0, 60.0, 80.0):
            at = int(np.argmin(abs(RPM - rpm)))
            tau = (600 + 160) / 18 * c_k * c_d * (3 - 2 * (rpm / 100) ** 2)
            assert found[continuous].allowed[at] / 1e6 == pytest.approx(tau, rel=1e-9)
            assert found[passing].allowed[at] / 1e6 == pytest.approx(1.7 * tau / math.sqrt(c_k), rel=1e-9)
        flat = 1.38 * (600 + 160) / 18 * c_k * c_d
        assert found[continuous].allowed[int(np.argmin(abs(RPM - 95)))] / 1e6 == pytest.approx(flat, rel=1e-9)

    def test_symbols_and_source_are_those_of_the_society(self):
        text = stressed(hump(10, 50), m68(rules="kr"))["tau_1"].text
        assert text.source.startswith("KR Rules")
        assert text.source.endswith("C_k by Table 5.4.1")
        assert "tau_1 = (T_s + 160)/18 C_k C_d" in text.formula
        assert "204" in text.not_covered

    def test_verdicts_do_not_depend_on_the_symbols(self):
        ours, theirs = (stressed(hump(90, 50), m68(rules=rules)) for rules in SHAFT_SOCIETIES)
        for one, other in zip(ours.values(), theirs.values(), strict=True):
            assert (one.verdict, one.barred, one.in_passing) == (other.verdict, other.barred, other.in_passing)

    @pytest.mark.parametrize("rules", SHAFT_SOCIETIES)
    def test_the_stress_is_a_half_range_of_vibration_by_any_symbol(self, rules):
        """What a test measures is set beside tau_1 of KR as beside tau_C of M68; a passage is judged by tau_2, tau_T."""
        model = tn.loads(SHAFTING.replace("rule: iacs_m68", f"rule: iacs_m68, rules: {rules}"))
        limit, view = model.definition.limits["line"], limit_subject(model.definition, model.exact_values)
        continuous, passing = ("tau_1", "tau_2") if rules == "kr" else ("tau_C", "tau_T")
        sensors, factor = limit.vibratory_sensors(continuous, view)
        assert {one.of for one in sensors} == {"line"}
        assert factor == pytest.approx(16 / (math.pi * 0.3**3))
        assert limit.vibratory_sensors(passing, view) is None

    @pytest.mark.parametrize("rules", SHAFT_SOCIETIES)
    def test_documents_have_the_factors_of_propulsion_shafts(self, rules):
        text = SHAFTING.replace("rule: iacs_m68", f"rule: iacs_m68, rules: {rules}")
        report = make_report(tn.loads(text), kind="approval", sections=["components"], date=None)
        factors, components = (one for one in report.sections[0].blocks if isinstance(one, TableBlock))
        assert "factors and where they come from" in str(factors.caption)
        (group,) = components.groups
        assert group.title == "Shafts"
        assert [row[1][0] for row in group.rows] == ["Stress, continuous operation", "Stress, quick passage"]

    def test_a_shaft_between_two_gears_is_none_of_them(self):
        """M68.1: shafts that are integral to gear boxes have rules of their own; the shaft behind the wheel has M68."""
        model = tn.loads(SHAFTING)
        (fault,) = unfit_limits(tn.loads(SHAFTING.replace("element: line", "element: lay")).definition)
        assert fault.severity == "warning"
        assert "integral to gearing" in fault.message
        assert unfit_limits(model.definition) == []

    @pytest.mark.parametrize("society", sorted(NOT_AT_HAND))
    def test_no_numbers_of_societies_whose_text_was_not_at_hand(self, society):
        with pytest.raises(tn.ModelError, match=r"limits\.shaft\.rules: .*unknown-word"):
            stressed(hump(10, 50), m68(rules=society))


class TestGeneratingSets:
    """KR Part 5 Chapter 4 (2025), 203: 31 and 118 N/mm^2 of generator shafts, f_m by 201.4."""

    @pytest.mark.parametrize(
        ("more", "tau_1", "tau_2"),
        [
            ({}, 31, 118),
            ({"tensile_strength": "400 MPa", "yield_strength": "200 MPa"}, 31, 118),
            ({"tensile_strength": "560 MPa", "yield_strength": "280 MPa"}, 31 * (1 + 2 / 3 * 120 / 440), 118 * 280 / 225),
            ({"tensile_strength": "700 MPa"}, 31 * (1 + 2 / 3 * 150 / 440), 118),
            ({"tensile_strength": "900 MPa", "material": "alloy"}, 31 * (1 + 2 / 3 * 395 / 440), 118),
            ({"tensile_strength": "700 MPa", "material": "carbon_manganese"}, 31 * (1 + 2 / 3 * 150 / 440), 118),
            ({"shaft": "crankshaft_in_line"}, 21, 90),
            ({"shaft": "crankshaft_other"}, 16, 90),
        ],
    )  # fmt: skip
    def test_stresses(self, more, tau_1, tau_2):
        found = stressed(hump(10, 50), generator_set(**more))
        at = {rpm: int(np.argmin(abs(RPM - rpm))) for rpm in (50.0, 90.0, 90.5, 104.0)}
        assert found["tau_1"].allowed[list(at.values())] / 1e6 == pytest.approx(tau_1, rel=1e-9)
        assert found["tau_2"].allowed[[at[50.0], at[90.0]]] / 1e6 == pytest.approx(tau_2, rel=1e-9)
        assert np.isnan(found["tau_2"].allowed[[at[90.5], at[104.0]]]).all()

    def test_nothing_is_said_above_1_1(self):
        found = stressed(hump(10, 50), generator_set(), rated=90.0)["tau_1"]
        assert np.isnan(found.allowed[RPM > 99]).all()
        assert np.isfinite(found.allowed[RPM <= 99]).all()
        assert "lambda above 1.1 is not covered" in found.remarks

    def test_a_lower_speed_is_passed(self):
        found = stressed(hump(60, 50), generator_set())["tau_1"]
        (span,) = found.barred
        assert found.verdict == "barred range"
        n, ratio = 50.0, 0.5
        assert span.low * 30 / math.pi == pytest.approx(16 * n / (18 - ratio), abs=1e-3)
        assert span.high * 30 / math.pi == pytest.approx((18 - ratio) * n / 16, abs=1e-3)

    @pytest.mark.parametrize("misfire", [False, True])
    def test_a_set_cannot_run_slower(self, misfire):
        """A ship with a cylinder out may; a set that is not at rated speed makes no current."""
        found = stressed(hump(60, 95), generator_set(), misfire=misfire)["tau_1"]
        assert found.verdict == "fail"
        assert found.highest is None
        assert "tau_1 is exceeded above lambda = 0.9, where no range may be barred" in found.remarks[0]

    def test_too_much_for_passing(self):
        assert stressed(hump(130, 50), generator_set())["tau_2"].verdict == "fail"

    def test_speeds_that_nobody_examined_are_named(self):
        found = stressed(hump(10, 98), generator_set(), rpm=np.arange(96.0, 104.1, 0.5))
        assert list(found) == ["tau_1"]
        assert any("begin at lambda = 0.96; the set runs from 0.9 to 1.1" in text for text in found["tau_1"].remarks)

    @pytest.mark.parametrize(
        ("more", "message"),
        [
            ({"tensile_strength": 440}, "100 N/mm^2 or more; got 0.00044"),
            ({"yield_strength": "500 MPa"}, "not above the tensile strength"),
            ({"rules": "m68"}, "expected kr, got 'm68'"),
            ({"rules": "dnv"}, "DNV"),
        ],
    )
    def test_faults(self, more, message):
        with pytest.raises(tn.ModelError) as caught:
            stressed(hump(10, 50), generator_set(**more))
        assert message in str(caught.value)


SET = """\
torsionnet: 1
elements:
  engine: {type: inertia, node: c1, inertia: 60}
  rubber: {type: hysteretic_spring, nodes: [c1, rotor], stiffness: 60 kN*m/rad, loss_factor: {psi: 1}}
  rotor: {type: inertia, node: rotor, inertia: 90}
  shaft: {type: shaft, nodes: [rotor, e], outer_diameter: 110 mm, length: 0.9 m}
  exciter: {type: inertia, node: e, inertia: 2}
speeds: {of: c1, range: 600..1000 rpm, step: 10 rpm, rated: 900 rpm}
excitations:
  engine: {type: reciprocating_engine, speed_of: c1, cycle: 4, cylinders: {1: c1}, firing_order: [1], bore: 0.2, stroke: 0.3, rod_length: 0.6, reciprocating_mass: 30}
limits:
"""
M68_LIMIT = (
    "  tail: {rule: iacs_m68, element: shaft, shaft: intermediate, feature: integral_flange, material: carbon, "
    "tensile_strength: 560 MPa}\n"
)
ANGLE = "  flicker: {rule: machine_angle, node: rotor, pole_pairs: 4, angle: ANGLE deg, speed_band: BAND}\n"


def flicker(angle, band):
    return ANGLE.replace("ANGLE", f"{angle}").replace("BAND", band)


class TestM68IsNotForThem:
    def test_a_generating_set_is_not_judged_by_it(self):
        set_ = tn.loads(SET + M68_LIMIT + flicker(3, "95..105 %"))
        (fault,) = unfit_limits(set_.definition)
        assert (fault.severity, fault.path) == ("warning", ("limits", "tail", "rule"))
        assert "generator shafts (M68.1)" in fault.message
        found = set_.check_limits().of("tail")
        assert found.verdict == "not judged"
        assert "generating_set_shaft" in found.remarks[0]

    def test_a_ship_with_a_shaft_generator_is(self):
        """Its propeller is an element of that type."""
        ship = SET.replace("elements:\n", "elements:\n  screw: {type: propeller, node: e, inertia: 3}\n")
        found = tn.loads(ship + M68_LIMIT + flicker(3, "95..105 %")).check_limits()
        assert found.of("tail", "tau_C").verdict != "not judged"

    def test_a_crankshaft_is_not(self):
        """The web between two cylinders bears what the maker of the engine says, also in a ship."""
        web = "  web: {type: shaft, nodes: [c1, c2], outer_diameter: 200 mm, length: 400 mm}\n"
        throw = "  throw: {type: inertia, node: c2, inertia: 60}\nspeeds:"
        two = SET.replace("elements:\n", f"elements:\n{web}").replace("speeds:", throw, 1)
        two = two.replace("cylinders: {1: c1}, firing_order: [1]", "cylinders: {1: c1, 2: c2}, firing_order: [1, 2]")
        engine = tn.loads(two + M68_LIMIT.replace("element: shaft", "element: web"))
        (fault,) = unfit_limits(engine.definition)
        assert (fault.severity, fault.path) == ("warning", ("limits", "tail", "rule"))
        found = engine.check_limits().of("tail")
        assert (found.verdict, found.remarks) == ("not judged", (fault.message,))
        assert "crankshafts (M68.1), and web" in fault.message

    def test_a_machine_without_generator_is(self):
        assert tn.loads(SET + M68_LIMIT).check_limits().of("tail", "tau_C").verdict != "not judged"


class TestSpeedBand:
    def angle_check(self, angle, band="95..105 %", **changes):
        text = SET
        for old, new in changes.items():
            text = text.replace({"range": "600..1000 rpm"}[old], new)
        return tn.loads(text + flicker(angle, band)).check_limits()

    def test_it_holds_in_the_band_alone(self):
        check = self.angle_check(90)
        found = check.of("flicker")
        judged = check.rpm[np.isfinite(found.allowed)]
        assert judged[[0, -1]] == pytest.approx([855, 945])
        assert "holds from 855 to 945 rpm, where the machine runs" in found.remarks[0]

    def test_what_exceeds_it_in_the_band_fails_and_is_passed_alone(self):
        wide = self.angle_check(90)
        worst = math.degrees(np.nanmax(wide.of("flicker").values[np.isfinite(wide.of("flicker").allowed)]))
        least = math.degrees(wide.of("flicker").values.max())
        assert least > 1.05 * worst  # the mode of the rubber is below the band
        assert self.angle_check(1.02 * worst).of("flicker").verdict == "pass"
        found = self.angle_check(0.98 * worst).of("flicker")
        (span,) = found.barred
        assert (found.verdict, found.refused) == ("fail", ())
        assert 855 <= span.rpm_outward[0] < span.rpm_outward[1] <= 945
        assert "not to be run there, passing does no harm" in found.remarks[0]

    def test_band_that_is_not_examined(self):
        found = self.angle_check(90, range="600..800 rpm").of("flicker")
        assert found.verdict == "not judged"
        part = self.angle_check(90, range="600..900 rpm").of("flicker")
        assert "examined from 855 to 900 rpm" in part.remarks[0]

    def test_coupling_torque_that_no_speed_may_exceed_is_judged_everywhere(self):
        limit = "  rubber: {rule: coupling, element: rubber, T_Kmax: 40 kN*m, T_KW: 5 kN*m, speed_band: [0.95, 1.05]}\n"
        load = "load: {absorbed_at: rotor, over_speed: {500 rpm: 1 kN*m, 1100 rpm: 1 kN*m}}\n"
        check = tn.loads(SET + limit + load).check_limits()
        assert np.isfinite(check.of("rubber", "T_Kmax").allowed).all()
        assert not np.isfinite(check.of("rubber", "T_KW").allowed).all()

    @pytest.mark.parametrize("band", ["95 %", "105..95 %", "[0.9]", "95..105", "[1, 2, 3]", "-1..1"])
    def test_faults(self, band):
        with pytest.raises(tn.ModelError, match=r":\d+:\d+: .*(wrong-form|unordered-rows|out-of-range|missing-unit)"):
            tn.loads(SET + flicker(3, f'"{band}"' if band[0] != "[" else band))

    def test_it_is_written_as_it_was_read(self):
        rig = tn.loads(SET + flicker(3, "95..105 %"))
        again = tn.loads(rig.to_yaml())
        assert again.definition.limits["flicker"] == rig.definition.limits["flicker"]
        assert rig.definition.limits["flicker"].speed_band == (0.95, 1.05)


class TestSeparationMargins:
    """Two masses, a gear and a mass behind it that turns three times slower; margins by hand."""

    def train(self, **more):
        elements = [
            tn.Inertia("rotor", node="motor", inertia=2),
            tn.Spring("coupling", nodes=("motor", "pin"), stiffness=3e4),
            tn.Gear("gear", nodes=("pin", "slow"), ratio=3),
            tn.Inertia("fan", node="slow", inertia=36),
        ]
        speeds = {"of": "motor", "list": ["1500 rpm", "1700 rpm"]}
        return tn.Drivetrain("train", elements, speeds=speeds, **more)

    def test_numbers(self):
        found = shaft_margins(self.train(operating_point={"speed": {"motor": "1600 rpm"}}), "api684")
        frequency = math.sqrt(3e4 * (1 / 2 + 1 / (36 / 9))) / (2 * math.pi)  # 23.87 Hz
        assert frequency == pytest.approx(23.87, abs=0.01)
        expected = {
            ("motor", "1"): 1 - frequency / 25,
            ("motor", "2"): 1 - frequency / 50,
            ("slow", "1"): frequency / (1700 / 180) - 1,
            ("slow", "2"): frequency / (1700 / 90) - 1,
        }
        got = {(one.excitation, one.line): one.margin for one in found.crossings}
        assert got == pytest.approx(expected, rel=1e-9)
        kept = {key: one.passes for key, one in zip(got, found.crossings, strict=True)}
        assert kept == {("motor", "1"): False, ("motor", "2"): True, ("slow", "1"): True, ("slow", "2"): True}

    def test_electrical_frequencies(self):
        pulse = {
            "type": "electric_machine",
            "node": "motor",
            "pole_pairs": 2,
            "electrical_orders": {6: {"amplitude": 5}},
        }
        found = shaft_margins(self.train(excitations={"m": pulse}), "api684")
        inverter = [line for line in found.lines if line.excitation == "m, electrical"]
        assert [line.frequency(np.array([50 * math.pi]))[0] for line in inverter] == pytest.approx([50, 100])
        # API 618: 10 % from 1x and 2x line frequency; 5 % is for multiples of a shaft's speed.
        reciprocating = shaft_margins(self.train(excitations={"m": pulse}), "api618").crossings
        assert {one.required for one in reciprocating if one.excitation == "m, electrical"} == {0.1}
        assert {one.required for one in reciprocating if (one.excitation, one.line) == ("motor", "2")} == {0.05}
        line = {
            "type": "electric_machine",
            "node": "motor",
            "line": {"frequency": "60 Hz", "multiples": {6: {"amplitude": 5}}},
        }
        found = shaft_margins(self.train(excitations={"m": line}), "api684")
        assert [one.fixed for one in found.lines if one.excitation == "m"] == [60, 120, 360]

    def test_every_order_of_an_excitation_is_compared(self):
        """Order 0.9 of the motor, 22.5 to 25.5 Hz, meets 23.87 Hz, which 1 and 2 times all speeds leave alone."""
        meshing = {"type": "harmonic", "node": "motor", "orders": {0.9: {"amplitude": 5}, 2: {"amplitude": 1}}}
        found = shaft_margins(self.train(excitations={"m": meshing}), "api684")
        assert [line.order for line in found.lines if line.excitation == "m"] == [0.9]  # 2 x is a line already
        (met,) = [one for one in found.crossings if one.excitation == "m"]
        assert (met.margin, met.passes) == (0, False)

    def test_api_618_compares_multiples_to_the_tenth(self):
        found = shaft_margins(self.train(), "api618")
        slow = [one for one in found.crossings if one.excitation == "slow"]
        assert [one.order for one in slow] == [*range(1, 11)]
        assert [one.required for one in slow] == [0.10, *[0.05] * 9]
        frequency = math.sqrt(3e4 * (1 / 2 + 1 / (36 / 9))) / (2 * math.pi)
        assert slow[4].margin == pytest.approx(1 - frequency / (1500 / 36), rel=1e-9)
        assert slow[-1].margin == pytest.approx(1 - frequency / (1500 / 18), rel=1e-9)

    def test_table_of_the_compressor_train(self):
        subject = data("reciprocating_compressor_train")
        (block,) = separation_margins(subject)
        assert isinstance(block, TableBlock)
        found = shaft_margins(subject.model, "api684")
        rows = block.groups[0].rows
        failed = [one for one in found.crossings if one.passes is False]
        assert sum(row[-1] == "no" for row in rows) == len(failed)
        # 14.5 Hz of the coupling is met by 1 x motor (10 to 25 Hz) and by 2, 3 and 4 x compressor, 6.8 to 33.8 Hz.
        first = rows[: next(place for place, row in enumerate(rows) if row[0] == "2")]
        missed = ["1 x motor", "2 x wheel", "3 x compressor", "4 x compressor"]
        assert [row[2] for row in first if row[-1] == "no"] == missed
        assert [row[-1] for row in first].count("yes") == 1
        for row in rows:  # the margin required of API 684 is 10 % of all lines
            assert (row[5].value < 10) == (row[-1] == "no")
        assert "Compared are" in block.notes[0][0]
        assert "API RP 684" in block.notes[2][0]

    def test_only_lines_with_a_required_margin_are_counted_as_compared(self):
        """API 618 requires nothing of half orders: 10 multiples of each of two shafts are left, of 1 to 10."""
        half = {"type": "harmonic", "node": "motor", "orders": {0.5: {"amplitude": 5}, 2.5: {"amplitude": 1}}}
        model = self.train(excitations={"half": half})
        for rule, count in (("api618", 20), ("api684", 6)):
            plan = ReportPlan(kind="approval", rules=rule)
            (block,) = separation_margins(ReportData(model, cases_of(model, ()), ReportRequest(plan)))
            assert f"Compared are {count} lines" in block.notes[0][0]

    def test_ships_have_none(self):
        assert separation_margins(data("two_stroke_ship")) == []


def data(name, **more):
    model = tn.load(name)
    plan = model.definition.report or ReportPlan()
    return ReportData(model, cases_of(model, ()), ReportRequest(replace(plan, kind="approval", **more)))


class TestForms:
    def test_every_row_says_where_it_comes_from(self):
        for row in SOCIETIES.values():
            assert row.name
            assert row.edition
            assert bool(row.shafts) or row.remark
            assert {section for _, _, section in row.asked_for} <= set(SECTIONS)

    def test_particulars_and_speeds_that_are_missing(self):
        (block,) = society_form(data("engine_generator_set"))
        assert [row[0] for row in block.groups[0].rows][:2] == ["102.1(1)", "102.1(2)"]
        notes = " ".join(note[0] for note in block.notes)
        assert "up to lambda = 1.1, critical speeds are asked for up to 1.2" in notes
        assert society_form(data("reciprocating_compressor_train")) == []

    def test_words_replace_words_and_no_names_or_formulas(self):
        society = SOCIETIES["lr"]
        assert society.in_words("tau_C, tau T; my_tau_C") == "tau_c, tau t; my_tau_C"
        assert society.in_words("barred speed ranges") == "restricted speed ranges"
        block = TableBlock((Math("tau_C"),), (Heading("tau_C", "N"),), (TableGroup((("barred range",),)),))
        found = in_society_words(block, society)
        assert found.caption == (Math("tau_C"),)
        assert found.columns[0].text == "tau_c"
        assert found.groups[0].rows == (("restricted speed range",),)

    @pytest.mark.slow
    def test_report_in_the_words_of_lr(self):
        text = (Path(__file__).parents[2] / "library" / "two_stroke_ship.yaml").read_text(encoding="utf-8")
        ship = tn.loads(text.replace("report:\n", "report:\n  rules: lr\n"))
        report = make_report(ship, sections=["conclusion"], date=None, configurations=["normal"])
        text = repr(report.sections)
        assert "tau c" in text
        assert "tau C" not in text


def test_phrases_in_words_of_a_society_keep_their_places():
    """A place of the template may be called as a word of the society; names from the model stay."""
    text = phrase(
        "barred range of {lambda}: {where}", **{"lambda": "lambda_pump", "where": phrase("tau_C in {a}", a="b")}
    )
    said = in_society_words(text, SOCIETIES["lr"])
    assert said == "restricted speed range of lambda_pump: tau_c in b"
    assert said.template == "restricted speed range of {lambda}: {where}"
    assert said.values["where"].template == "tau_c in {a}"


def test_generator_shaft_by_hand():
    """The number in the docstring of the class: alloy steel of 660 and 450 N/mm^2."""
    shaft = GeneratingSetShaft(
        element="s", shaft="generator", material="alloy", tensile_strength=660e6, yield_strength=450e6
    )
    assert shaft.permitted == pytest.approx((31e6 * 4 / 3, 236e6))


def test_reports_know_every_society():
    from torsionnet.machinery.limits.shaft_limit import SOCIETIES
    from torsionnet.report.plan.report_plan import SOCIETY_NAMES

    assert tuple(SOCIETIES) == SOCIETY_NAMES

"""The report as a tree: what is in it, taken from independent sources where there are any."""

import datetime as dt
import hashlib
import inspect
import re

import numpy as np
import pytest
from support import campaigns
from support.report_blocks import blocks, of, rows, words
from support.report_phrases import unphrased

import torsionnet as tn
from torsionnet.app.cli.commands.report_command import ReportCommand
from torsionnet.base.number_text import aligned_numbers
from torsionnet.report import make_report
from torsionnet.report.build import BUILDERS
from torsionnet.report.document_tree import (
    BreakableMath,
    Details,
    Equations,
    Formula,
    NumberText,
    Paragraph,
    Picture,
    Remark,
    TableBlock,
    inlines,
)
from torsionnet.report.plan.report_plan import SECTIONS
from torsionnet.report.report_data import document_kind
from torsionnet.report.report_request import Measured

RUNNING = ("excitations", "mean_torques", "critical_speeds", "orders", "periodic_motions", "limits")
"""Sections of models in which machinery runs."""


def report(model="amt_rig", **options):
    return make_report(model, date=None, **options)


def chain(n):
    elements = [tn.Inertia(f"disc_{i}", node=f"n_{i}", inertia=0.1) for i in range(n)]
    elements += [
        tn.Spring(f"shaft_{i}", nodes=(f"n_{i - 1}", f"n_{i}"), stiffness="k", damping=0.5) for i in range(1, n)
    ]
    inputs, sensors = {"T_1": {"torque": "n_0"}}, {"theta_1": {"angle": "n_0"}}
    return tn.Drivetrain(f"Chain of {n}", elements, {"k": 2e5}, inputs=inputs, sensors=sensors)


@pytest.fixture(scope="module")
def amt():
    return report()


@pytest.fixture(scope="module")
def large():
    return report(chain(120))


@pytest.fixture(scope="module")
def measured():
    rig = tn.load("dmf_rig").configured(c_2=5)
    return rig.frequency_response("theta_1", "T_T", np.linspace(1, 20, 60))


class TestTitle:
    def test_facts(self, amt):
        facts = {word: words(text) for word, text in amt.facts.rows}
        path = tn.library_models()["amt_rig"]
        assert amt.title == "Torsional model of the AMT test rig"
        assert facts["SHA-256"] == hashlib.sha256(path.read_bytes()).hexdigest()
        assert facts["Model file"] == "amt_rig.yaml"
        assert facts["Configurations"] == "II, III, IV, V, V_c_O_360"
        assert facts["Calculated with"] == f"torsionnet {tn.__version__}"
        assert "Date" not in facts

    @pytest.mark.parametrize(("date", "shown"), [("2025-03-31", "2025-03-31"), (dt.date(2024, 2, 29), "2024-02-29")])
    def test_date(self, date, shown):
        facts = dict(make_report("dmf_rig", date=date, sections=["validity"]).facts.rows)
        assert facts["Date"] == (shown,)

    def test_today(self):
        facts = dict(make_report("dmf_rig", sections=["validity"]).facts.rows)
        assert abs(dt.date.fromisoformat(facts["Date"][0]) - dt.datetime.now().astimezone().date()) <= dt.timedelta(
            days=1
        )

    def test_wrong_date(self):
        with pytest.raises(tn.UsageError, match="year-month-day"):
            make_report("dmf_rig", date="31.3.2025")

    def test_changed_parameters_are_told(self):
        found = report("dmf_rig", settings={"c_2": "8 N*m*s/rad"}, sections=["parameters"])
        assert ("Changed", ("c_2 = 8 N*m*s/rad",)) in found.facts.rows
        row = next(row for row in rows(of(TableBlock, blocks(found, "parameters"))[0]) if row[0] == "c_{2}")
        assert row[2] == "8"
        assert row[-1].endswith("changed for this report")

    def test_a_drivetrain_without_file_is_hashed_by_its_text(self):
        rig = tn.load("dmf_rig")
        facts = dict(report(rig, sections=["validity"]).facts.rows)
        assert facts["SHA-256"] == (hashlib.sha256(rig.to_yaml().encode()).hexdigest(),)


class TestSections:
    def test_all_that_apply_in_order(self, amt):
        assert [section.name for section in amt.sections] == [
            name
            for name, content in SECTIONS.items()
            if "rig" in content.kinds
            and name not in ("simplified", "scenarios", "test", "loops", "fit", "study", *RUNNING)
        ]

    def test_chosen(self):
        found = report("dmf_rig", sections=["validity", "modes"])
        assert [section.name for section in found.sections] == ["modes", "validity"]

    def test_unknown(self):
        with pytest.raises(tn.UsageError, match='did you mean "modes"'):
            report(sections=["mods"])

    def test_wrong_names_of_transfer_functions_all_at_once(self):
        with pytest.raises(tn.UsageError, match=r"(?s)thet/T_T.*theta_1/b"):
            report(transfer_functions=["thet/T_T", "theta_1/b"])

    def test_every_configuration_or_those_named(self):
        found = report(configurations=["V"], sections=["modes"])
        assert [group.title for group in of(TableBlock, blocks(found, "modes"))[0].groups] == [""]


class TestValues:
    def test_natural_frequencies_and_damping_are_those_of_the_modes(self, amt):
        first, _, _, _, others, *_ = of(TableBlock, blocks(amt, "modes"))
        rig = tn.load("amt_rig")
        assert words(first.caption) == "Modes, configuration II"
        assert [words(group.title) for group in others.groups] == [f"Configuration {n}" for n in rig.configurations[1:]]
        for group, name in zip((*first.groups, *others.groups), rig.configurations, strict=True):
            modes = rig.configured(name).modes()
            for index, row in enumerate(group.rows):
                if modes.kinds[index] == "oscillatory":
                    assert row[2].value == pytest.approx(modes.natural_frequencies[index])
                    assert row[4].value == pytest.approx(100 * modes.damping_ratios[index])
                else:
                    assert (row[2].value, row[4].value) == (None, None)

    def test_summary_has_the_papers_peak(self):
        """8.116 Hz, 0.2519 deg/(N m), -72.6 deg: the validation page's numbers for theta_1/T_T of the DMF rig."""
        table = of(TableBlock, blocks(report("dmf_rig"), "summary"))[1]
        static, peak, frequency, phase = rows(table)[0]
        assert (static, peak, frequency, phase) == ("0.1289", "0.2519", "8.116", "-72.6")

    def test_poles_of_the_cut_rig(self):
        found = of(TableBlock, blocks(report("dmf_rig"), "modes"))
        cut = next(table for table in found if "cut at" in words(table.caption))
        assert rows(cut)[0][2] == "8.7554"

    def test_elements(self, amt):
        table = of(TableBlock, blocks(amt, "elements"))[0]
        assert ("dmf", "spring", "primary – input shaft", "stiffness", "k_{1}", "460", "N·m/rad") in rows(table)
        assert ("", "", "", "damping", "c_{1}", "4", "N·m·s/rad") in rows(table)

    def test_signs_are_those_of_torques_in_elements(self):
        """A node of the name of an element has none."""
        rig = tn.Drivetrain(
            "fan",
            [tn.Inertia("rotor", node="rotor", inertia=1), tn.Inertia("wheel", node="hub", inertia=2),
             tn.Spring("shaft", nodes=("rotor", "hub"), stiffness=1e4)],
            inputs={"T": {"torque": "rotor"}},
            sensors={"M": {"torque": "shaft"}, "M_hub": {"torque": "shaft", "at": "hub"}, "phi": {"angle": "rotor"}},
        )  # fmt: skip
        found = of(TableBlock, blocks(report(rig, sections=["elements"]), "elements"))
        table = next(one for one in found if words(one.caption) == "Inputs and sensors")
        signs = [row[-1] for row in rows(table)]
        assert signs == ["", rig.elements["shaft"].sign, "positive when it drives out of the element into hub", ""]
        assert signs[1]

    def test_configurations_differ_by(self, amt):
        table = of(TableBlock, blocks(amt, "parameters"))[1]
        assert rows(table)[-1] == ("V_c_O_360", "360", "3.26")

    def test_kinematics(self, amt):
        table = of(TableBlock, blocks(amt, "kinematics"))[0]
        row = next(row for row in rows(table) if row[0] == "output shaft")
        assert row[1] == r"\theta_{\mathrm{output~shaft}} = \frac{1}{\tau} \theta_{\mathrm{input~shaft}}"
        assert row[2] == "gearbox"
        assert [float(cell) for cell in row[3:]] == pytest.approx(
            [1 / 7.96, 1 / 5.42, 1 / 4.14, 1 / 3.26, 1 / 3.26], 1e-4
        )

    def test_reflected_terms_are_visible(self, amt):
        found = blocks(amt, "equations")
        assert any(r"k_{1} + \frac{k_{2}}{\tau^{2}}" in formula.latex for formula in of(Formula, found))
        equation = of(Equations, found)[0].rows[1]
        assert isinstance(equation, BreakableMath)
        assert equation.parts[0] == r"I_{2} \ddot{\theta}_{\mathrm{input~shaft}}"

    def test_numeric_matrices(self, amt):
        table = of(TableBlock, blocks(amt, "equations"))[0]
        by = {(row[0], row[2]): row[3] for row in rows(table)}
        assert by[r"\mathbf{M}", "all"] == r"\begin{bmatrix} 0.23 & 0 \\ 0 & 0.13 \end{bmatrix}"
        assert "654.12" in by[r"\mathbf{K}", "II"]  # 460 + 12300/7.96^2

    def test_equation_20(self, amt):
        found = blocks(amt, "formulas")
        mechanical, polynomial = of(Formula, found)
        assert r"\frac{k_{2}}{\tau^{2}}" in mechanical.latex
        assert "a_{4} s^{4}" in polynomial.latex
        limits = of(TableBlock, found)[-1]
        assert rows(limits)[0] == ("Static value", r"\frac{k_{1} \tau^{2} + k_{2}}{k_{1} k_{2}}")

    def test_numbers_of_the_coefficients(self, amt):
        table = of(TableBlock, blocks(amt, "formulas"))[1]
        first = table.groups[0].rows[0]
        assert [cell.value for cell in first[1:]] == pytest.approx(
            [460 + 12300 / tau**2 for tau in (7.96, 5.42, 4.14, 3.26, 3.26)]
        )

    def test_two_solutions_agree(self, amt):
        table = of(TableBlock, blocks(amt, "checks"))[0]
        assert table.groups[0].rows[0][1].value < 1e-9

    def test_findings_are_shown(self):
        found = of(Remark, blocks(report("planetary_set", sections=["checks"]), "checks"))
        assert [remark.kind for remark in found] == ["note"]
        assert "can turn freely" in words(found[0].text)


class TestValidity:
    def notes(self, model, **options):
        (listing,) = blocks(report(model, sections=["validity"], **options), "validity")
        return " ".join(words(item) for item in listing.items)

    def test_only_what_applies(self):
        amt, turbine = self.notes("amt_rig"), self.notes("turbine_generator_ssr")
        assert "Viscous damping" in amt
        assert "Clamps (brake)" in amt
        assert "cut at T_{T}" in amt
        assert "turn freely" not in amt
        assert "turn freely" in turbine
        assert "Clamps" not in turbine
        assert "Gears" not in turbine

    def test_hysteresis(self):
        assert "Hysteretic damping" in self.notes("six_cylinder_diesel")


class TestLarge:
    @pytest.mark.slow
    def test_no_large_matrix(self, large):
        (table,) = of(TableBlock, blocks(large, "equations"))
        assert (len(rows(table)), table.more) == (200, 39)
        (folded,) = (block for one in large.sections for block in one.blocks if isinstance(block, Details))
        assert "export" in words(folded.instead)

    @pytest.mark.slow
    def test_tables_are_cut(self, large):
        table = of(TableBlock, blocks(large, "elements"))[0]
        assert words(table.groups[0].rows[0][0]).endswith("and 80 more")

    def test_first_modes_only(self, large):
        assert len(rows(of(TableBlock, blocks(large, "modes"))[0])) == 10
        assert "the lowest 10 modes" in words(blocks(large, "modes")[0].text)

    def test_closed_form_of_the_first_vibration(self, large):
        """A free chain of n equal discs: omega_1 = 2 sqrt(k/J) sin(pi/(2n))."""
        row = next(row for row in of(TableBlock, blocks(large, "modes"))[0].groups[0].rows if row[1] == "vibration")
        expected = 2 * np.sqrt(2e5 / 0.1) * np.sin(np.pi / 240) / (2 * np.pi)
        assert row[2].value == pytest.approx(expected, 1e-4)


class TestForms:
    def test_configurations_with_other_elements_have_equations_of_their_own(self):
        switched = tn.loads(
            """
torsionnet: 1
name: two ways
parameters: {k: 1000 N*m/rad}
elements:
  a: {type: inertia, node: a, inertia: 1}
  b: {type: inertia, node: b, inertia: 2}
  s: {type: spring, nodes: [a, b], stiffness: k}
  d: {type: damper, nodes: [a, b], damping: 1}
inputs: {T: {torque: a}}
sensors: {S: {torque: s}}
configurations: {way: {dry: {off: [d]}, stiff: {off: [d], k: 2000 N*m/rad}, wet: {on: [d]}}}
"""
        )
        found = report(switched, sections=["equations"])
        heads = [words(block.text) for block in of(Paragraph, blocks(found, "equations"))]
        assert "Configuration dry, stiff" in heads  # which differ in a value alone
        assert "Configuration wet" in heads

    @pytest.mark.slow
    def test_long_formulas_are_not_written_unasked(self):
        assert of(TableBlock, blocks(report("planetary_set", sections=["formulas"]), "formulas")) == []
        asked = report("planetary_set", sections=["formulas"], transfer_functions=["theta_S/T_S"])
        steps = of(TableBlock, blocks(asked, "formulas"))[0]
        assert rows(steps)[-1][0] == "D"

    def test_simplified_transfer_functions_with_their_error(self):
        """Held against modes and responses of a rig with the same elements left out, solved in numbers."""
        found = report(
            "dmf_rig", simplify="2 %", band=(0.5, 20), transfer_functions=["theta_1/T_M"], sections=["modes"]
        )
        assert [section.name for section in found.sections] == ["modes", "simplified"]
        inside = blocks(found, "simplified")
        (row,) = rows(of(TableBlock, inside)[0])
        assert row[0] == "torque_meter rigid"
        rig = tn.load("dmf_rig")
        elements = [
            tn.RigidCoupling("torque_meter", nodes=element.nodes) if element.name == "torque_meter" else element
            for element in rig.elements.values()
        ]
        short = tn.Drivetrain(
            "short", elements, parameters=dict(rig.parameters), inputs=dict(rig.inputs), sensors=dict(rig.sensors)
        )
        mode, near = (model.modes() for model in (rig, short))
        f = np.geomspace(0.5, 20, 400)
        whole, rest = (np.abs(model.frequency_response("theta_1", "T_M", f).values[:, 0, 0]) for model in (rig, short))
        errors = (
            100 * abs(near.natural_frequencies[0] / mode.natural_frequencies[0] - 1),
            100 * abs(near.damping_ratios[0] / mode.damping_ratios[0] - 1),
            np.abs(20 * np.log10(rest / whole)).max(),
        )
        assert [float(text) for text in row[1:]] == pytest.approx(errors, abs=6e-4)
        assert "I_{1} + I_{2}" in of(Formula, inside)[0].latex

    def test_a_tolerance_of_100_percent_is_a_slip(self):
        with pytest.raises(tn.ModelError, match=r"simplify: .*100.*out-of-range"):
            report(simplify="1")

    def test_steps_give_the_transfer_function(self):
        """The table of steps, worked through in numbers, against the frequency response."""
        import sympy

        rig = tn.load("planetary_set")
        H = rig.symbolic().transfer_function("theta_S", "T_S")
        names, result = H.program.where()
        known = {sympy.Symbol(name): float(value) for name, value in rig.parameters.items()}
        known[sympy.Symbol("s")] = 2j * np.pi * 0.3
        for name, expression in names.items():
            known[name] = complex(expression.xreplace(known))
        expected = rig.frequency_response("theta_S", "T_S", [0.3]).values.item()
        assert complex(result.xreplace(known)) == pytest.approx(expected, 1e-9)


class TestGiven:
    def test_test_over_model(self, measured):
        found = report("dmf_rig", sections=["test"], tests=[measured])
        table = of(TableBlock, blocks(found, "test"))[0]
        values = {row[0]: row[2] for row in rows(table)}
        model = tn.load("dmf_rig").frequency_response("theta_1", "T_T", measured.frequencies)
        decibels = 20 * np.log10(np.abs(measured.values / model.values)).ravel()
        assert float(values["RMS difference in magnitude"]) == pytest.approx(np.sqrt(np.mean(decibels**2)), 1e-3)

    def test_configuration_of_a_test(self, measured):
        with pytest.raises(tn.UsageError, match="unknown-configuration"):
            report("amt_rig", sections=["test"], tests=[measured])
        found = report("amt_rig", sections=["test"], tests={"V": measured})
        assert "configuration V" in words(of(Picture, blocks(found, "test"))[0].caption)
        assert Measured(measured, "V").configuration == "V"

    def test_fit(self, measured):
        fit = tn.identify(tn.load("dmf_rig"), tn.Measurement(measured, "theta_1", "T_T"), ["c_2"])
        found = report("dmf_rig", sections=["fit"], fits=[fit])
        (row,) = rows(of(TableBlock, blocks(found, "fit"))[0])
        assert row[:3] == ("c_{2}", "4", "5")

    def test_without_data_there_is_no_section(self):
        assert blocks(report("dmf_rig", sections=["fit", "test", "validity"]), "fit") == []


class TestNumbers:
    @pytest.mark.parametrize(
        ("value", "shown"),
        [(0.0, "0"), (-0.00004, "-4"), (123456.0, "123500"), (None, "–"), (float("inf"), "∞"), (0.1 + 0.2, "0.3")],
    )
    def test_mantissa(self, value, shown):
        assert NumberText(value).mantissa == shown

    def test_exponent_after_rounding(self):
        assert (NumberText(9.99996e6).mantissa, NumberText(9.99996e6).exponent) == ("1", 7)

    def test_column(self):
        assert [number.mantissa for number in aligned_numbers([3.6909, 40.535, 0.0])] == ["3.691", "40.535", "0"]
        assert [number.exponent for number in aligned_numbers([2e-8, 3.0])] == [-8, None]

    def test_no_raw_names(self, amt):
        """Names with underscores are for programs; configurations keep theirs, which are typed on the command line."""
        shown = " ".join(
            cell
            for section in amt.sections
            for table in of(TableBlock, blocks(amt, section.name))
            for row in rows(table)
            for cell in row
            if "\\" not in cell and "{" not in cell
        )
        assert set(re.findall(r"\b\w+_\w+\b", shown)) == {"V_c_O_360", "I_M", "I_T"}


HARD_MODELS = ("marine_steam_turbine", "planetary_set", "six_cylinder_diesel", "two_stroke_ship")
"""Of many branches, with long formulas, with tables over frequency, for approval."""


@pytest.mark.slow
@pytest.mark.parametrize("name", campaigns.by_day(tn.library_models(), *HARD_MODELS))
def test_every_library_model_has_a_report(name):
    found = report(name)
    of_kind = {"rig": {"summary", "modes"}, "approval": {"conclusion", "natural_frequencies", "forced_response"}}
    wanted = of_kind[document_kind(tn.load(name))] | {"schematic", "validity"}
    assert wanted <= {section.name for section in found.sections}
    assert unphrased(found) == {}
    for picture in found.pictures:
        assert inlines(picture.caption)
        assert picture.alt


def test_every_section_has_its_builder_and_stands_in_the_help():
    """A section is a line in SECTIONS, a line in BUILDERS and a module in torsionnet/report/sections/."""
    assert list(BUILDERS) == list(SECTIONS)
    shown = " ".join(inspect.getdoc(ReportCommand).split())
    assert f"Sections: {', '.join(SECTIONS)}." in shown

"""Kinds of document: which a model has by itself, which sections stand in each, and the appendix."""

import pytest
from support.command_line import run
from support.written_models import FAN

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.plan.report_plan import KINDS, SECTIONS
from torsionnet.report.report_data import document_kind

APPROVAL = {
    "bulk_carrier",
    "engine_generator_set",
    "marine_medium_speed",
    "reciprocating_compressor_train",
    "two_stroke_ship",
}
"""Models of the library with speeds, excitations and limits, as their files are read by a person."""


def names(report):
    return [section.name for section in report.sections]


@pytest.mark.parametrize("model", tn.library_models())
def test_what_runs_within_limits_is_for_approval(model):
    assert document_kind(tn.load(model)) == ("approval" if model in APPROVAL else "rig")


@pytest.mark.parametrize("kind", KINDS)
def test_sections_are_those_of_the_kind(kind):
    found = make_report(tn.loads(FAN), kind=kind, date=None)
    assert found.sections
    assert all(kind in SECTIONS[name].kinds for name in names(found))
    assert ("equations" in names(found)) == (kind == "rig")
    assert ("conclusion" in names(found)) == (kind == "approval")


def test_the_file_says_the_kind_and_a_call_replaces_it():
    plan = tn.loads(f"{FAN}report: {{kind: approval}}\n")
    assert make_report(plan, date=None).subtitle == "Torsional vibration calculation"
    assert make_report(plan, kind="rig", date=None).subtitle == "Torsional vibration report"


def test_an_appendix_holds_the_sections_of_the_other_kind():
    found = make_report(tn.loads(FAN), kind="approval", appendix=True, date=None)
    assert names(found)[-1] == "appendix"
    inner = [section.name for section in found.sections[-1].blocks]
    assert {"elements", "equations", "modes"} <= set(inner)
    assert not set(inner) & set(names(found))


def test_a_section_of_the_other_kind_may_be_asked_for():
    found = make_report(tn.loads(FAN), kind="approval", sections=["modes", "conclusion"], date=None)
    assert names(found) == ["conclusion", "modes"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rows", ["[0.01, 0, 20], [1000, 0, 20]", "[0, 0, 20], [5, 2, 19], [50, 30, 15]"])
def test_a_film_without_stiffness_at_rest_is_reported(kind, rows):
    rig = f"""torsionnet: 1
name: ring in a film
elements:
  J: {{type: inertia, node: a, inertia: 1}}
  k: {{type: spring, nodes: [a, ground], stiffness: 400}}
  d: {{type: viscous_damper, node: a, ring_inertia: 1, table: [{rows}]}}
sensors: {{th: {{angle: a}}}}
inputs: {{T: {{torque: a}}}}
"""
    found = make_report(tn.loads(rig), kind=kind, appendix=True, date=None)
    formulas = [section.name for section in found.sections if section.name == "formulas"]
    assert formulas == ["formulas"] * (kind == "rig")


def test_no_limits_is_said():
    found = make_report(tn.loads(FAN), kind="approval", sections=["conclusion"], date=None)
    assert "No limits are given" in str(found.sections[0].blocks)


class TestCommand:
    @pytest.fixture(autouse=True)
    def file(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "fan.yaml").write_text(FAN, encoding="utf-8")

    def test_kind_and_appendix(self, tmp_path):
        assert run("report", "fan.yaml", "--kind", "approval", "--appendix", "-o", "fan.md").exit_code == 0
        text = (tmp_path / "fan.md").read_text(encoding="utf-8")
        assert "Torsional vibration calculation" in text
        assert text.index("Conclusion and operating instructions") < text.index("Appendix") < text.index("Equations")

    def test_wrong_kind(self):
        run("report", "fan.yaml", "--kind", "aproval", code=2)
        with pytest.raises(tn.ModelError, match=r":\d+:\d+: .*rig or approval.*unknown-word"):
            tn.loads(f"{FAN}report: {{kind: aproval}}\n")
        with pytest.raises(tn.UsageError, match="expected rig or approval"):
            make_report(tn.loads(FAN), kind="aproval")

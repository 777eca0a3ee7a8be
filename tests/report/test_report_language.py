"""Reports in German: every text is translated, names of the model stay, a template's words go before."""

import math
import re
from types import SimpleNamespace

import pytest
import yaml
from support.command_line import run
from support.tanker import TANKER
from support.written_models import FAN

import torsionnet as tn
from torsionnet.machinery.holzer.holzer import natural_frequencies
from torsionnet.report import make_report
from torsionnet.report.critical_remarks import places_words
from torsionnet.report.plan.report_plan import LANGUAGES
from torsionnet.report.template_reading import in_language, words_of
from torsionnet.report.wording import Wording, Words, replaceable_texts
from torsionnet.report.writers.html import html_page

TEXTS = [text for texts in replaceable_texts().values() for text in texts]
OTHERS = [language for language in LANGUAGES if language != "en"]

ENGINE = """torsionnet: 1
name: two cylinders
elements:
  one: {type: inertia, node: c1, inertia: 1 kg*m^2}
  crank: {type: spring, nodes: [c1, c2], stiffness: 1 MN*m/rad, damping: 20}
  two: {type: inertia, node: c2, inertia: 1 kg*m^2}
  rubber: {type: hysteretic_spring, nodes: [c2, b], stiffness: 50 kN*m/rad, loss_factor: 0.1}
  fan: {type: inertia, node: b, inertia: 3 kg*m^2}
speeds: {of: c1, range: 600..3000 rpm, step: 20 rpm}
excitations:
  engine:
    {type: reciprocating_engine, speed_of: c1, cycle: 2, cylinders: {1: c1, 2: c2}, firing_angles: {1: 0 deg, 2: 180 deg},
     bore: 200 mm, stroke: 200 mm, rod_length: 400 mm, reciprocating_mass: 10 kg, orders: [1, 2],
     gas: {fired: [9e5, 8e5, 7e5, 6e5, 5e5, 4e5, 3e5, 3e5, 2e5, 2e5, 2e5, 2e5, 2e5, 2e5, 2e5, 3e5, 3e5, 4e5, 4e5, 5e5, 6e5, 7e5, 8e5, 9e5]}}
limits:
  crank: {rule: curve, output: torque(crank), value: 90 kN*m, source: maker}
  rubber: {rule: coupling, element: rubber, T_KW: 0.2 kN*m, source: maker}
report: {kind: approval}
"""


ENGLISH = re.compile(r"\b(?:the|of|is|are|at|with|and|which|where|each|from|to|no|not|by)\b")


def english(page):
    """What a page says in English: lines between its tags, and what it says instead of pictures."""
    page = re.sub(r"<(svg|style|script)\b.*?</\1>", "", page, flags=re.DOTALL)  # pictures are in English
    told = [*re.sub("<[^>]*>", "\n", page).splitlines(), *re.findall('aria-label="([^"]*)"', page)]
    return [one for one in told if ENGLISH.search(one)]


@pytest.mark.parametrize("language", OTHERS)
class TestWords:
    def test_the_file_is_read_without_faults(self, language):
        words, faults = Words.read({"language": language, "texts": dict(words_of(language).texts)})
        assert words is not None
        assert faults == []


def test_page_in_german():
    page = html_page(make_report(tn.loads(FAN), language="de", date=None))
    assert "<html lang=de>" in page
    assert "Eigenformen" in page
    assert "Natural freq" not in page
    assert "shaft" in page, "names of elements are the model's"


def test_words_of_a_template_go_before(tmp_path):
    (tmp_path / "words.yaml").write_text(yaml.safe_dump({"texts": {"Validity": "Geltung"}}), encoding="utf-8")
    page = html_page(make_report(tn.loads(FAN), language="de", template=tmp_path, date=None))
    assert "Geltung" in page
    assert "<html lang=de>" in page
    assert "Eigenformen" in page


def test_command_and_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fan.yaml").write_text(FAN + "report: {language: de}\n", encoding="utf-8")
    run("report", "fan.yaml", "-o", "de.md")
    run("report", "fan.yaml", "-o", "en.md", "--language", "en")
    assert re.search("^## .*Elemente$", (tmp_path / "de.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert re.search("^## .*Elements$", (tmp_path / "en.md").read_text(encoding="utf-8"), re.MULTILINE)
    with pytest.raises(tn.UsageError, match="unknown-word"):
        make_report(tn.loads(FAN), language="fr")


def test_labels_of_data_places_and_groups_are_translated():
    """A word that begins a cell has a capital letter, and is the word of the list all the same."""
    report = make_report(
        tn.loads(ENGINE), language="de", sections=["installation", "forced_response", "components"], date=None
    )
    page = html_page(report)
    for word in ("Zylinder; Bohrung 200", "Steifigkeit 50", ">Spitze<", "Kurbelwelle", "Wechseldrehmoment, "):
        assert word in page, word
    for word in ("Stiffness", ">peak<", "bore 200", "Couplings", "Vibratory torque, "):
        assert word not in page, word


def test_words_of_nodes_of_vibration_are_replaced():
    """Words between names are said in the language, and the names stay."""
    first, second = natural_frequencies(tn.loads(ENGINE))[:2]
    assert (first.node_places, second.node_places) == ("in rubber", "in crank, in rubber")
    words = Wording({"in {element}": "mitten in {element}"})
    assert words(second.node_places) == "mitten in crank, mitten in rubber"


def test_what_rules_do_not_cover_is_translated_by_clauses():
    page = html_page(make_report(tn.loads(ENGINE), language="de", sections=["limits"], date=None))
    assert "Nicht erfasst: Anfahren, Kurzschlüsse und andere Übergänge; radiale und axiale Lasten; " in page
    assert "radial and axial loads" not in page


def test_lists_of_critical_speeds_are_said_in_other_words():
    critical = SimpleNamespace(mode=SimpleNamespace(number=4), natural_speed=10 * math.pi)
    told = places_words([SimpleNamespace(name="engine 3", critical=critical)] * 42)
    assert told.startswith("engine 3, mode 4 at 300.0, engine 3, ")
    said = in_language("de", None).wording(told)
    assert said.startswith("engine 3, Eigenform 4 bei 300.0, engine 3, Eigenform 4")
    assert said.endswith("… und 2 weitere")


GENERATOR = "{rule: generating_set_shaft, element: tail, shaft: generator, material: carbon, tensile_strength: 560 MPa}"


def test_factors_of_class_rules_are_explained_in_german():
    rule = "{rule: iacs_m68, element: tail, shaft: intermediate, feature: integral_flange, material: carbon, tensile_strength: 500 MPa}"
    text = TANKER.replace(
        "  tail: {rule: curve, output: T_tail, value: 60 kN*m, transient_factor: 2, source: own}",
        f"  line: {rule}\n  set: {GENERATOR}",
    ).replace("propeller at zero pitch", "none")
    page = html_page(make_report(tn.loads(text), language="de", sections=["components"], date=None))
    for word in ("Welle des Modells", "Zulässig bei ", " = 0.9 bis 1.05", "Beim raschen Durchfahren bei "):
        assert word in page, word
    title = "KR Rules for the Classification of Steel Ships, Part 5 Chapter 4 (2025), 203 and 206, f_m by 201.4. Generator: "
    assert title in page
    assert not english(page.replace(title, ""))


class TestUnitsAndCases:
    """One spelling of revolutions per minute in each language; cases of excitation and criteria in its words."""

    OUT = "configurations: {firing: {normal: {}, out: {engine.misfire: each}}}"
    TEXT = ENGINE.replace("gas: {", f"gas: {{motored: [{', '.join(['2e5'] * 24)}], ").replace(
        "report:", f"{OUT}\nreport:"
    )

    def page(self, language):
        sections = [
            "conclusion",
            "conditions",
            "installation",
            "harmonics",
            "resonances",
            "forced_response",
            "components",
        ]
        page = html_page(make_report(tn.loads(self.TEXT), language=language, sections=sections, date=None))
        return re.sub("<svg.*?</svg>", "", page, flags=re.DOTALL)

    def test_german(self):
        page = self.page("de")
        for word in (
            "Zündaussetzer von Zylinder 1",
            "jeder Zylinder einzeln entlastet, die anderen belastet",
            "min⁻¹",
            "Dauerbetrieb",
        ):
            assert word in page, word
        assert "auch beim Durchfahren; T_v S_theta &lt;= T_KW; P &lt;= P_KV mal Temperaturfaktor" in page
        assert not english(page)
        for word in ("half range", "without ignition", "rpm", "r/min", "1/min", "continuous"):
            assert word not in page, word

    def test_english(self):
        page = self.page("en")
        assert "rpm" in page
        assert "r/min" not in page

"""A report in other words and under another letterhead: the worked example, and everything that a folder can have wrong."""

import ast
import base64
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from support.command_line import run
from support.models import EVERY_ELEMENT

import torsionnet as tn
from torsionnet.base.phrases import PLACEHOLDER, joined, phrase
from torsionnet.machinery.excitations.gas_torque import GasPressure
from torsionnet.machinery.limits.class_rule_shaft import SHAFTS
from torsionnet.machinery.limits.m68_factors import FEATURES, STRENGTHS
from torsionnet.machinery.verdicts.margin_rules import PRESETS
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, restriction_words
from torsionnet.model.element_base.viscoelastic import RUBBER_SHAPES, FilmGap, Viscoelastic
from torsionnet.model.elements import ELEMENT_TYPES
from torsionnet.report import make_report
from torsionnet.report.document_tree import (
    Facts,
    Heading,
    Math,
    NumberText,
    Picture,
    Report,
    Section,
    TableBlock,
    TableGroup,
)
from torsionnet.report.report_text import as_words, capital, sentence
from torsionnet.report.template_reading import Rewording, in_language, read_template
from torsionnet.report.wording import Wording, replaceable_texts
from torsionnet.report.writers import templating
from torsionnet.report.writers.html import html_page
from torsionnet.report.writers.latex import LatexWriter
from torsionnet.report.writers.markdown import MarkdownWriter

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "letterhead"
SHORT = {"sections": ["summary", "elements"], "date": "2025-03-31"}
TEXTS = [text for texts in replaceable_texts().values() for text in texts]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "house").mkdir()
    return tmp_path / "house"


def fill(folder, **files):
    for name, text in files.items():
        stem, _, ending = name.rpartition("_")
        (folder / f"{stem}.{ending}").write_text(text, encoding="utf-8")
    return folder


def faults(folder):
    with pytest.raises(tn.ModelError) as caught:
        read_template(folder)
    assert caught.value.exit_code == 1
    return str(caught.value).replace(str(folder), "house")


def page(folder, **options):
    return html_page(make_report("dmf_rig", template=folder, **{**SHORT, **options}))


class TestExample:
    """What the page "A report in your own words" shows."""

    def test_page_has_letterhead_words_and_language(self):
        text = page(EXAMPLE, author="A. Engineer")
        logo = base64.b64encode((EXAMPLE / "logo.svg").read_bytes()).decode()
        assert f'<img src="data:image/svg+xml;base64,{logo}" alt="Nordwelle Antriebe">' in text
        assert "Geprüft: A. Engineer, Kiel, 2025-03-31." in text
        assert "<html lang=de>" in text
        assert re.findall(r"<span class=no>\d</span> ([^<]*)", text) == [
            "Ergebnisse auf einen Blick",
            "Elemente",
        ]
        assert "<b>Tabelle 1</b> Niedrigste Eigenfrequenzen" in text
        assert "<td>Steifigkeit</td>" in text
        assert text.index("--accent:#0b5394") < text.index("--accent:#0a5c36")

    def test_no_english_heading_is_left_in_what_it_translates(self):
        text = page(EXAMPLE)
        for english in ("Contents", "Results at a glance", "Lowest natural frequencies", "Configuration"):
            assert english not in text

    def test_names_of_the_model_stay(self, folder):
        """An element and a parameter's description that are called like a text of the report."""
        fill(folder, words_yaml="texts: {Modes: Formen, shaft: Welle, spring: Feder, Unit: Einheit, Node: Knoten}")
        rig = tn.Drivetrain(
            "Modes",
            [tn.Inertia("Modes", node="Node", inertia=1, description="Modes"), tn.Spring("shaft", nodes=("Node", "b"), stiffness=5, damping=1), tn.Inertia("spring", node="b", inertia=2)],
            inputs={"T": {"torque": "Node"}}, sensors={"phi": {"angle": "b"}},
        )  # fmt: skip
        report = make_report(
            rig, template=folder, sections=["elements", "modes"], date=None, title="Modes", author="Unit"
        )
        (elements, *_) = report.sections[0].blocks
        assert report.title == "Modes"
        assert ("Author", ("Unit",)) in report.facts.rows
        rows = elements.groups[0].rows
        assert [row[0] for row in rows if row[0]] == ["Modes", "shaft", "spring"]
        assert [row[1] for row in rows if row[1]] == ["inertia", "Feder", "inertia"]
        assert rows[0][-1] == "Modes"
        assert [column.text for column in elements.columns] == [
            "Element",
            "Type",
            "Between",
            "Property",
            "Value",
            "Einheit",
            "Remark",
        ]
        assert report.sections[1].title == ("Formen",)

    def test_a_name_that_heads_a_column_stays(self):
        """Configurations and elements stand in headings of their own."""
        reworded = Rewording(Wording({"Value": "Wert", "Ratio": "Verhältnis"}, frozenset({"Value"})))
        assert [reworded.reworded(Heading(text)).text for text in ("Value", "Ratio")] == ["Value", "Verhältnis"]

    def test_without_a_template_nothing_changes(self, folder):
        assert page(folder) == html_page(make_report("dmf_rig", **SHORT))

    @pytest.mark.slow
    def test_latex_and_markdown(self, tmp_path):
        for ending in (".tex", ".md"):
            files = tn.write_report(
                "dmf_rig", tmp_path / f"r{ending}", template=EXAMPLE, **{**SHORT, "sections": ["schematic"]}
            )
            text = files[0].read_text(encoding="utf-8")
            assert "Antriebsstrang" in text
            assert ending == ".tex" or "**Bild 1** Der Antriebsstrang." in text
            names = [file.name for file in files]
            assert ("template_logo.pdf" in names) == (ending == ".tex")
        assert r"\renewcommand{\figurename}{Bild}" in (tmp_path / "r.tex").read_text(encoding="utf-8")
        assert (tmp_path / "r_figures" / "template_logo.pdf").read_bytes() == (EXAMPLE / "logo.pdf").read_bytes()

    @pytest.mark.slow
    @pytest.mark.skipif(shutil.which("pdflatex") is None, reason="pdflatex is not installed")
    def test_latex_compiles(self, tmp_path):
        tn.write_report("dmf_rig", tmp_path / "r.tex", template=EXAMPLE, **SHORT)
        done = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "r.tex"], cwd=tmp_path, capture_output=True, check=False)  # fmt: skip
        assert done.returncode == 0, done.stdout.decode(errors="replace")[-2000:]

    @pytest.mark.usefixtures("folder")
    def test_command(self):
        run("report", "dmf_rig", "--template", str(EXAMPLE), "--section", "validity", "-o", "r.html", "--date", "none")
        assert "Gültigkeit" in Path("r.html").read_text(encoding="utf-8")

    def test_entry_of_a_file_is_seen_from_the_file(self, folder, monkeypatch):
        fill(folder, words_yaml="texts: {Validity: Gilt}")
        model = folder.parent / "m.yaml"
        text = tn.load("dmf_rig").to_yaml()
        assert "report: {" in text
        model.write_text(text.replace("report: {", "report: {template: house, "), encoding="utf-8")
        monkeypatch.chdir("/")
        report = make_report(model, sections=["validity"], date=None)
        assert report.sections[0].title == ("Gilt",)
        assert tn.loads(tn.load(model).to_yaml()).definition.report.template == "house"
        other = fill(folder.parent, words_yaml="texts: {Validity: Anders}")
        (other / "m.yaml").rename(other / "house" / "README.yaml")
        assert make_report(other / "house" / "README.yaml", template=other / "house", sections=["validity"], date=None).sections[0].title == ("Gilt",)  # fmt: skip


class TestWords:
    def test_phrases_are_replaced_with_those_inserted_into_them(self):
        wording = Wording({"Modes of {a}{by}": "1 {a}{by}", ", by {a}": ", nach {a}", "x": "y", "in balance": "gleich"})
        assert wording(phrase("Modes of {a}{by}", a="x", by=phrase(", by {a}", a="x"))) == "1 x, nach x"
        assert wording(phrase("Modes of {a}{by}", a="in balance", by="")) == "1 in balance", "a name"
        assert wording(phrase("Modes of {a}{by}", a=phrase("in balance"), by="")) == "1 gleich"
        assert wording(joined("; ", (phrase("in balance"), "x"))) == "gleich; x"
        assert wording("Modes of x") == "Modes of x", "prose that looks like a phrase"
        assert wording("x") == "y"

    def test_words_of_names_and_first_letters_change_in_a_phrase(self):
        """A sentence goes through several hands before it is said in other words."""
        wording = Wording({"Torque of {a}": "Moment {a}", "{a} % of {b}": "{b}: {a} %"})
        assert wording(capital(as_words(phrase("torque of {a}", a="half_shaft")))) == "Moment half shaft"
        first = capital(joined("; ", (phrase("torque of {a}", a="half_shaft"), "else")))
        assert (first, wording(first)) == ("Torque of half_shaft; else", "Moment half_shaft; else")
        (text,) = sentence(phrase("{a} % of {b}", a=3, b="half_shaft"), tn.load("amt_rig"))
        assert (text, wording(text)) == ("3\N{NO-BREAK SPACE}% of half shaft", "half shaft: 3 %")

    @pytest.mark.parametrize(
        ("configuration", "said"),
        [
            ("normal", "halten 20 110 flywheel"),
            ("misfire", "aus 97 flywheel"),
        ],
    )
    def test_findings_on_limits_are_said_in_other_words(self, configuration, said):
        wording = Wording({
            "All limits hold{where} at the speeds examined, {low} to {high} rpm of {shaft}": "halten{where} {low} {high} {shaft}",
            "At most {speed} rpm": "aus {speed}",
            " of {shaft}": " {shaft}",
        })  # fmt: skip
        check = tn.load("two_stroke_ship").configured(configuration).check_limits()
        assert wording(capital(check.finding())) == said

    def test_a_highest_speed_with_a_barred_range_is_said_in_german(self):
        shaft = phrase(" of {shaft}", shaft="crank")
        wording = in_language("de", None).wording
        text = restriction_words([SpeedSpan(4.0, 4.5)], 10.25, shaft)
        assert wording(capital(text)) == "Höchstens 97 min⁻¹ von crank, 38 bis 43 min⁻¹ gesperrt"

    @pytest.mark.slow
    def test_every_text_stands_in_the_code(self):
        """What is fixed in each text, between what is inserted, is a part of a string of the program."""
        package = ROOT / "torsionnet"
        files = package.rglob("*.py")
        strings = "\0".join(text.lower() for file in files for text in _strings(file))
        shown = "".join(
            file.read_text(encoding="utf-8") for file in (package / "report" / "writers" / "templates").glob("page.*")
        )
        words = {as_words(kind) for kind in ELEMENT_TYPES} | {
            as_words(name).lower() for cls in ELEMENT_TYPES.values() for name, _ in cls.specs()
        }
        words |= {f"{word} " for word in words} | {"input", "sensor", "rigid body", "real pole", "error", "warning", "note", *(f"{q} {o} " for q in ("torque", "angle", "velocity", "acceleration", "twist") for o in ("on", "of", "through"))}  # fmt: skip
        words |= {piece.lower() for rule in PRESETS.values() for piece in str(rule).split("; ")}
        words |= {f"{as_words(shaft)} shaft" for shaft in FEATURES} | {as_words(shaft) for shaft in SHAFTS}
        words |= {f"{material.replace('_', '-')} steel" for material in STRENGTHS}
        nested = (Viscoelastic, FilmGap, *RUBBER_SHAPES.values())
        words |= {as_words(name).lower() for cls in nested for name, _ in cls.specs()}
        words |= {f"gas: {as_words(name).lower()}" for name, _ in GasPressure.specs()}
        for text in TEXTS:
            for piece in re.split(r"\{\w+\}|; (?=[a-z])", text.removeprefix("; ")):
                if (
                    "of vibration" in piece
                ):  # put together of many parts; descriptions of modes have a test of their own
                    continue
                low = piece.lower().rpartition(".")[2]  # of a nested entry the last name
                assert low in words or f'"{piece}"' in shown or low in strings, (text, piece)

    @pytest.mark.parametrize("model", ["amt_rig", "planetary_set", "marine_steam_turbine"])
    def test_descriptions_of_modes_are_replaced(self, model):
        """A chain without any word of the original left: only names of elements, numbers and signs."""
        blank = Wording({text: "".join(f" {{{name}}}" for name in PLACEHOLDER.findall(text)) for text in TEXTS})
        rig = tn.load(model)
        for description in rig.modes().descriptions:
            left = set(re.findall(r"[A-Za-z]\w*", blank(capital(description))))
            assert left <= {
                *rig.elements,
                *rig.nodes,
                "in",
                "at",
                *re.findall(r"\w+", " ".join([*rig.elements, *rig.nodes])),
            }, description

    @pytest.mark.slow
    def test_everything_reported_in_reports_of_the_library_is_replaced(self):
        """All texts marked: what is left unmarked in headings, captions and notes is not the report's own."""
        marked = Wording({text: "@" + text for text in TEXTS})
        report = make_report("amt_rig", date=None, template=None)
        for section in Rewording(marked).reworded(report).sections:
            assert section.title[0].startswith("@")
            for block in section.blocks:
                if isinstance(block, TableBlock | Picture):
                    assert all(
                        part.startswith("@") for part in block.caption if isinstance(part, str) and part != "."
                    ), block.caption
                if isinstance(block, TableBlock):
                    heads = {
                        column.text
                        for column in block.columns
                        if isinstance(column.text, str) and column.text[0] != "@"
                    }
                    assert heads <= set(tn.load("amt_rig").configurations), heads

    def test_types_and_properties_of_elements_are_listed(self):
        kinds, names = replaceable_texts()["types of elements"], replaceable_texts()["properties of elements"]
        assert set(kinds) == {as_words(kind) for kind in ELEMENT_TYPES}
        every = {as_words(name) for cls in ELEMENT_TYPES.values() for name, _ in cls.specs()}
        outer = {name.removesuffix(" {key}").partition(".")[0] for name in names}
        assert outer <= every - {"description", "enabled", "nodes", "node"}

    @pytest.mark.parametrize("kind", sorted(EVERY_ELEMENT.keys() - {"mass_elastic"}))
    def test_properties_of_every_element_are_replaced(self, kind):
        """A report on each: what stands in the column of properties is one of the texts, or a measure of damping."""
        marked = Wording({text: "@" + text for texts in replaceable_texts().values() for text in texts})
        element = EVERY_ELEMENT[kind]
        discs = [tn.Inertia(f"J_{node}", node=node, inertia=1) for node in element.ports.values() if node != "ground"]
        oil = [tn.Damper(f"c_{disc.node}", nodes=("x", disc.node), damping=1) for disc in discs]
        rig = tn.Drivetrain("rig", [element, *discs, *oil, tn.Inertia("J_x", node="x", inertia=1)])
        section = make_report(rig, date=None, template=None, sections=["elements"]).sections[0]
        rows = [
            row for block in Rewording(marked).reworded(section).blocks for group in block.groups for row in group.rows
        ]
        own = [row for row in rows if row[3]]
        assert own
        assert all(row[3].startswith("@") for row in own), [row[3] for row in own]

    def test_faults(self, folder):
        fill(
            folder,
            words_yaml="language: 3\ntexts:\n  Mods: Formen\n  Value: [1]\n  Configuration {name}: K {nam}\n  Peak {number}: Spitze\n  Modes: {a}\n",
        )
        text = faults(folder)
        for line, what in (
            ("1:11", "3.*wrong-form"),
            ("3:3", '"Mods".*"Modes".*invalid-name'),
            ("4:10", "wrong-form"),
            ("7:10", "wrong-form"),
        ):
            assert re.search(rf"words\.yaml:{line}: error: .*{what}", text), (line, text)
        fill(folder, words_yaml="texts:\n  Configuration {name}: K {nam}\n  Peak {number}: Spitze\n  Modes: x {y}\n")
        text = faults(folder)
        assert re.search(r'words\.yaml:2:25: .* \{nam\}; .*"name"\?', text), text
        assert re.search(r"words\.yaml:3:18: .*\{number\}", text)
        assert re.search(r"words\.yaml:4:10: .* \{y\}", text)

    @pytest.mark.parametrize(
        "text", ["- a", "3", "texts: 3", "lang: de", "texts: {Modes: a\n", "texts: {Modes: a, Modes: b}", "a: &b [*b]"]
    )
    def test_broken_files(self, folder, text):
        fill(folder, words_yaml=text)
        assert re.search(r"words\.yaml:\d+:\d+: error: ", faults(folder))

    @pytest.mark.slow
    def test_markup_in_words_is_text(self, folder):
        evil = "x' onclick=alert(1) \\\\newpage <script>"
        listed = "".join(
            f'  {text}: "{evil}"\n'
            for text in ("Contents", "Table", "Figure", "Modes", "Mode", "Results at a glance", "Author")
        )
        fill(folder, words_yaml=f"texts:\n{listed}")
        report = make_report(
            "dmf_rig", template=folder, sections=["summary", "schematic", "modes"], date=None, author="A"
        )
        text = html_page(report)
        assert "<script>" not in text
        assert re.search(r"<[^>]*=[^\"'>]* onclick", text) is None
        assert "\\newpage" not in LatexWriter(report, "f").page()


def _strings(file):
    """Strings of a program, those of formatted ones in pieces, without its docstrings and LaTeX."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    documentation = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in documentation:
            yield from PLACEHOLDER.split(node.value)[::2]


class TestFolder:
    def test_no_folder(self, folder):
        fill(folder.parent, file_txt="")
        missing = run("report", "dmf_rig", "--template", "hous", code=2).stderr
        assert re.search(r'(?s)"house".*missing-file', missing)
        assert "wrong-file" in run("report", "dmf_rig", "--template", "file.txt", code=2).stderr

    def test_unknown_files(self, folder):
        fill(folder, pages_html="", README_md="", words_yml="")
        (folder / ".hidden").mkdir()
        (folder / "sub").mkdir()
        (folder / "big.png").mkdir()
        (folder / "a b.svg").write_text("x", encoding="utf-8")
        text = faults(folder)
        assert re.search(r'house/pages\.html:1:1: error: .*"page\.html".*unknown-name', text)
        assert re.search(r'house/words\.yml:1:1: error: .*"words\.yaml".*unknown-name', text)
        assert re.search(r"house/sub:1:1: error: .*unknown-name", text)
        assert re.search(r"house/big\.png:1:1: error: .*wrong-file", text)
        assert re.search(r"house/a b\.svg:1:1: error: .*invalid-name", text)
        assert "5 errors in house. Nothing was written." in text

    @pytest.mark.skipif(os.name == "nt", reason="links need rights there")
    def test_nothing_leads_out_of_it(self, folder):
        (folder.parent / "secret.svg").write_text("secret", encoding="utf-8")
        (folder / "logo.svg").symlink_to(folder.parent / "secret.svg")
        (folder / "page.html").symlink_to("/etc/passwd")
        text = faults(folder)
        assert re.search(r"house/logo\.svg:1:1: error: .*forbidden-file", text)
        assert re.search(r"house/page\.html:1:1: error: .*forbidden-file", text)
        assert "root:" not in text

    @pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names there")
    def test_a_pipe_is_not_waited_for(self, folder):
        os.mkfifo(folder / "page.html")
        assert re.search(r"house/page\.html:1:1: error: .*wrong-file", faults(folder))

    def test_too_large_or_no_text(self, folder):
        (folder / "logo.png").write_bytes(b"0" * 4_000_001)
        (folder / "style.css").write_bytes(b"a{}\n\xff")
        text = faults(folder)
        assert re.search(r"logo\.png:1:1: error: .*too-large", text)
        assert re.search(r"style\.css:2:1: error: .*0xff.*unreadable-file", text)

    def test_all_faults_before_anything_is_calculated(self, folder, monkeypatch):
        fill(
            folder,
            page_html="{% block leterhead %}{% endblock %}",
            page_tex="<% block title %>",
            style_css="@import 'x'",
        )
        monkeypatch.setattr(tn.Drivetrain, "modes", None)
        result = run("report", "dmf_rig", "--template", "house", "-o", "r.html", code=1)
        assert result.stderr.count("error: ") == 3
        assert not Path("r.html").exists()


class TestPage:
    @pytest.mark.parametrize(
        ("text", "line", "what"),
        [
            ("\n{% block leterhead %}{% endblock %}", 2, '"leterhead".*"letterhead".*unknown-name'),
            ("{% blok letterhead %}", 1, '"blok".*"block".*unknown-name'),
            ("{% block title %}\n{{ title }\n{% endblock %}", 2, "'}'.*wrong-form"),
            ("{% block title %}\n", 1, "endblock.*wrong-form"),
            ("{% block title %}{% endblock %}\n\n<p>lost</p>", 3, "wrong-form"),
            ("{{ title }}", 1, "wrong-form"),
            ("{% if title %}x{% endif %}", 1, "wrong-form"),
            ("{% extends 'page.html' %}", 1, "forbidden-file"),
            ("{% block title %}\n{% include '/etc/passwd' %}{% endblock %}", 2, "forbidden-file"),
            ("{% import 'x' as y %}", 1, "forbidden-file"),
            ("{% block title %}{{ x|safe }}{% endblock %}", 1, "'safe'.*wrong-form"),
            ("{% block title %}{{ x|e }}{% endblock %}", 1, "'e'.*wrong-form"),
            ("{% block title %}\n{{ facts ~ title }}{% endblock %}", 2, "~.*wrong-form"),
            ("{% block title %}{% endblock %}{% block title %}{% endblock %}", 1, "'title'.*wrong-form"),
            ("{% block title %}\n<script>alert(1)</script>{% endblock %}", 2, "<script.*wrong-form"),
            ("{% block title %}\n<img src='logo.svg'>{% endblock %}", 2, r"image\('logo\.svg'\).*wrong-form"),
            ("{% block title %}\n<img src=https://x.org/a.png>{% endblock %}", 2, "wrong-form"),
            ("{% block title %}\n<p style='background:url(a.png)'>{% endblock %}", 2, r"image\('a\.png'\).*wrong-form"),
        ],
    )  # fmt: skip
    def test_faults(self, folder, text, line, what):
        fill(folder, page_html=text)
        found = faults(folder)
        assert re.search(rf"house/page\.html:{line}:\d+: error: .*{what}", found), found

    @pytest.mark.few(5)
    @pytest.mark.parametrize(
        ("text", "what"),
        [
            ("{{ titel }}", '"titel".*"title".*unknown-name'),
            ("{{ title.__class__.__mro__ }}", "unsafe"),
            ("{{ image.__globals__ }}", "unsafe"),
            ("{{ ''['__class__'] }}", "unsafe"),
            ("{{ '{0.__class__.__init__.__globals__}'.format(title) }}", "unsafe"),
            ("{{ facts.replace('a', title) }}", "not safely callable"),
            ("{{ 'a' * 1000000000 }}", "wrong-form"),
            ("{{ facts + title }}", "wrong-form"),
            ("{{ '%s' % facts }}", "wrong-form"),
            ("{{ contents.append(1) }}", "unsafe"),
            ("{{ range(3) }}", '"range".*unknown-name'),
            ("{{ lipsum() }}", '"lipsum".*unknown-name'),
            ("{{ self.__init__ }}", "unsafe"),
            ("{{ 1/0 }}", "division by zero"),
            ("{{ title + 1 }}", "wrong-form"),
            ("{{ image('lgo.svg') }}", r'"lgo\.svg".*"logo\.svg".*unknown-name'),
            ("{{ image('../secret.svg') }}", r"\.\./secret\.svg.*unknown-name"),
            ("{{ image('plan.pdf') }}", r'"plan\.pdf".*wrong-form'),
            ("{{ sections.blocks }}", '"blocks".*unknown-name'),
            ("{{ contents[0].title.drawn }}", '"drawn".*unknown-name'),
            ("{% macro f() %}{{ f() }}{% endmacro %}{{ f() }}", "recursion"),
        ],
    )  # fmt: skip
    def test_faults_found_on_the_way(self, folder, text, what):
        fill(folder, page_html=f"{{% block letterhead %}}\n{text}\n{{% endblock %}}", logo_svg="<svg/>", plan_pdf="x")
        fill(folder.parent, secret_svg="secret")
        result = run("report", "dmf_rig", "--template", "house", "--section", "validity", "-o", "r.html", code=1)
        assert re.search(rf"house/page\.html:2:\d+: error: .*{what}", result.stderr), result.stderr
        assert not Path("r.html").exists()

    def test_texts_are_escaped_in_every_format(self, folder):
        evil = "<b>50 % & $x_1$</b>"
        block = "block letterhead %}>{{ title }}{% set a = title %}{{ a|upper }}{% endblock"
        fill(
            folder,
            page_html="{% " + block + " %}",
            page_md="{% " + block + " %}",
            page_tex="<% block letterhead %>><< title >><% endblock %>",
        )
        report = make_report("dmf_rig", template=folder, sections=["validity"], date=None, title=evil)
        assert "&lt;b&gt;50 % &amp; $x_1$&lt;/b&gt;&lt;B&gt;50" in html_page(report)
        assert r"\textless{}b\textgreater{}50 \% \& \$x\_1\$" in LatexWriter(report, "f").page()
        assert r">\<b\>50 % \& \$x\_1\$\</b\>" in MarkdownWriter(report, "f").page()
        off = "{% autoescape false %}{{ title }}{% endautoescape %}"
        fill(folder, page_html="{% block letterhead %}" + off + "{% endblock %}")
        assert "<b>" not in html_page(make_report("dmf_rig", template=folder, sections=["validity"], date=None, title=evil)).partition("<nav")[0].partition("<header")[0]  # fmt: skip

    def test_super_and_parts(self, folder):
        fill(folder, page_html="{% block title %}<hr>{{ super() }}{{ word('Contents') }}{% for entry in contents %}[{{ entry.title }}]{% endfor %}{% endblock %}")  # fmt: skip
        text = page(folder)
        assert text.index("<hr>") < text.index("<header>") < text.index("[Results at a glance][Elements]")

    def test_policy_stands_before_everything_of_the_folder(self, folder):
        fill(
            folder,
            page_html="".join(
                f"{{% block {name} %}}HERE{{% endblock %}}" for name in templating.shipped_blocks("page.html")
            ),
        )
        text = page(folder)
        assert text.index("Content-Security-Policy") < text.index("HERE")
        assert text.count("HERE") == 5

    def test_style_cannot_leave_its_place(self, folder):
        fill(folder, style_css="a{}\n</style><p>")
        assert re.search(r"style\.css:2:1: error: .*wrong-form", faults(folder))
        fill(folder, style_css="a{background:url('x.png')}")
        assert re.search(r"style\.css:1:14: error: .*x\.png.*wrong-form", faults(folder))

    def test_blocks_are_those_of_the_page_about_it(self):
        shown = (ROOT / "docs" / "how_to" / "report_template.md").read_text(encoding="utf-8")
        for name in ("page.html", "page.tex", "page.md"):
            assert all(f"| `{block}`" in shown for block in templating.shipped_blocks(name))
        assert all(re.search(rf"`{name}[`(]", shown) for name in templating.PAGE_NAMES)

    def test_message_on_the_page_about_it_is_the_real_one(self, folder):
        shown = (ROOT / "docs" / "how_to" / "report_template.md").read_text(encoding="utf-8")
        fill(folder, page_html="{% block leterhead %}\n{% endblock %}")
        assert faults(folder).replace("house", "letterhead") in shown


def test_numbers_of_what_is_folded_away_count_for_themselves():
    from torsionnet.report.document_tree import Details, Formula

    one = TableBlock(("t",), (Heading("a"),), (TableGroup(((NumberText(1.0),),)),))
    blocks = (one, Details(("more",), (one, Formula("x")), ("less",)), Section("s", ("s",), (one, Formula("y"))))
    report = Report("r", "", Facts(()), (Math("x"),), (Section("r", ("r",), blocks),))
    counted = r"<b>(Table \w+)</b>|<span>(\(\w+\))</span>|<span class=no>([\d.]+)</span>"
    page, paper = (
        ["".join(found) for found in re.findall(counted, html_page(report, folds=folds))] for folds in (True, False)
    )
    assert page == ["1", "Table 1", "Table S1", "(S1)", "1.1", "Table 2", "(1)"]
    assert paper == ["1", "Table 1", "1.1", "Table 2", "(1)"]

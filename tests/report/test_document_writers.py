"""The report as HTML, LaTeX, Markdown and PDF."""

import base64
import io
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from fontTools.ttLib import TTFont
from support.command_line import run

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.document_tree import (
    Facts,
    Heading,
    Math,
    NumberText,
    Report,
    Section,
    TableBlock,
    TableGroup,
)
from torsionnet.report.report_tables import table
from torsionnet.report.writers import html, markdown, pdf
from torsionnet.report.writers import pdf as browser
from torsionnet.report.writers.html import html_page
from torsionnet.report.writers.latex import LatexWriter
from torsionnet.report.writers.latex import escaped as latex_escaped
from torsionnet.report.writers.markdown import MarkdownWriter
from torsionnet.symbolic.symbol_names import GREEK

HOSTILE = '<b>A & "B"</b> $x_1$ 100% #~^\\{} <script>alert(1)</script> 中 Ω `c` *d* | é'
DATE = "2025-03-31"
CHROMIUM = next((found for name in browser.BROWSER_COMMANDS if (found := shutil.which(name))), None)
needs_browser = pytest.mark.skipif(
    CHROMIUM is None, reason="no Chromium, Chrome or Edge on the path to open pages with"
)
needs_latex = pytest.mark.skipif(shutil.which("pdflatex") is None, reason="pdflatex is not installed")


def hostile():
    elements = [
        tn.Inertia("r", node="a", inertia=1, description=HOSTILE),
        tn.Spring("s", nodes=("a", "b"), stiffness="k", damping=0.1),
        tn.Inertia("q", node="b", inertia=2),
    ]
    channels = {"inputs": {"T": {"torque": "a"}}, "sensors": {"S": {"torque": "s"}}}
    return tn.Drivetrain(HOSTILE, elements, {"k": 100}, source=HOSTILE, description=HOSTILE, **channels)


class Page(HTMLParser):
    """Tags, ids, references and text of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.ids, self.links, self.texts, self.open = [], [], [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        attributes = dict(attrs)
        self.ids += [attributes["id"]] if "id" in attributes else []
        self.links += [value for key, value in attrs if key in ("href", "src", "xlink:href")]
        if tag not in ("meta", "link", "br", "img", "mspace"):
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if self.open and self.open[-1] == tag:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The file of the report on a model, which is written once."""

    @cache
    def write(model):
        path = tmp_path_factory.mktemp(model) / "r.html"
        tn.write_report(hostile() if model == "hostile" else model, path, date=DATE)
        return path

    return write


def formula_font():
    """The font that a page with formulas holds."""
    return TTFont(io.BytesIO(base64.b64decode(re.search(r"base64,([^)]*)", html.font_face())[1])))


@pytest.fixture(scope="module")
def amt(written):
    return written("amt_rig").read_text(encoding="utf-8")


class TestHtml:
    @pytest.mark.slow
    def test_is_well_formed_and_its_names_are_unique(self, amt):
        page = Page(amt)
        assert len(page.ids) == len(set(page.ids))
        assert {link[1:] for link in page.links if link.startswith("#")} <= set(page.ids)

    def test_needs_nothing_from_elsewhere(self, amt):
        page = Page(amt)
        assert all(link.startswith("#") for link in page.links)
        assert "script" not in page.tags
        assert "@import" not in amt
        assert not re.findall(r"url\((?!#|data:font/woff;base64,)", amt)

    def test_is_small(self, amt):
        assert len(amt.encode()) < 1_500_000
        assert "--size:1>" not in amt  # only small tables say their size

    @pytest.mark.slow
    def test_markup_in_texts_is_text(self):
        page = Page(html_page(make_report(hostile(), title=HOSTILE, author=HOSTILE, notes=HOSTILE, date=None)))
        assert "script" not in page.tags
        assert "img" not in page.tags
        text = "".join(page.texts)
        assert text.count("<script>alert(1)</script>") >= 6

    @pytest.mark.slow
    def test_same_input_same_bytes(self, amt):
        assert html_page(make_report("amt_rig", date=DATE)) == amt

    def test_bytes_depend_on_the_date(self):
        short = [html_page(make_report("amt_rig", date=date, sections=["validity"])) for date in (DATE, "2025-04-01")]
        assert short[0] != short[1]

    @pytest.mark.slow
    def test_bytes_do_not_depend_on_the_hash_seed(self, written, tmp_path):
        program = f"import sys, torsionnet as tn; tn.write_report('dmf_rig', sys.argv[1], date='{DATE}')"
        here, there = written("dmf_rig"), tmp_path / "there.html"
        seed = "2" if os.environ.get("PYTHONHASHSEED") == "1" else "1"
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(Path(tn.__file__).parents[1])}
        subprocess.run([sys.executable, "-c", program, str(there)], check=True, env=environment)
        assert here.read_bytes() == there.read_bytes()

    def test_every_formula_became_mathml(self, amt):
        assert "\\frac" not in amt
        assert "\\mathrm" not in amt
        assert amt.count("<math>") > 50  # inside lines
        assert amt.count('<math display="block">') > 1

    def test_font_of_formulas_is_in_a_page_with_formulas(self, amt):
        assert amt.count("@font-face") == 1
        assert "font-src data:" in amt
        assert "@font-face" not in html_page(Report("r", "", Facts(()), (), ()))

    def test_font_has_all_signs_of_formulas(self, amt):
        """A sign that it lacks is an empty box on a system without such a font."""
        formulas = " ".join(re.findall(r"<math.*?</math>", amt, re.DOTALL))
        greek = "".join(html.mathml(rf"\{name}") for name in GREEK)
        signs = html.mathml(r"\int \sqrt{a} \le \ge \ne \approx \cdot \times \pm \infty \to \partial \ldots")
        shown = set(unescape(re.sub(r"<[^>]*>", "", formulas + greek + signs)))
        letters = set(map(chr, range(0x1D434, 0x1D468))) - {"\U0001d455"} | {"ℎ"}  # italic; h has its own place
        assert {chr(code) for code in formula_font()["cmap"].getBestCmap()} >= shown | letters

    def test_brackets_of_the_font_grow(self):
        font = formula_font()
        variants = font["MATH"].table.MathVariants
        growing = dict(zip(variants.VertGlyphCoverage.glyphs, variants.VertGlyphConstruction, strict=True))
        for sign in "()[]|√":
            assert growing[font["cmap"].getBestCmap()[ord(sign)]].VariantCount > 3 or sign == "|"

    def test_dots_are_accents(self):
        assert html.mathml(r"\ddot{\theta}_{1}").count('<mover accent="true"><mrow><mi>') == 1
        both = html.mathml(r"\dot{\mathbf{q}} + \bar{x} + \ddot{q}")
        assert [tag.count("accent") for tag in re.findall("<mover[^>]*>", both)] == [1, 0, 1]

    def test_columns_are_aligned_at_the_decimal_point(self):
        columns = (Heading("x", numeric=True), Heading("y", "kN·m", numeric=True), Heading("z", numeric=True))
        numbers = [(*(NumberText(value),) * 2, NumberText(round(value))) for value in (13300.0, 0.078, 4.0)]
        found = table("t", columns, numbers)
        report = Report("r", "", Facts(()), (), (Section("s", ("s",), (found,)),))
        page = html_page(report)
        assert '13300<span class="pad" aria-hidden="true">.000</span>' in page
        assert page.count('<span class="pad" aria-hidden="true">.000</span>') == page.count('class="pad"') == 4
        assert re.findall(r"<th\b[^>]* scope=col>(.*?)</th>", page) == ["x", "y <span class=unit>kN·m</span>", "z"]

    def test_missing_package_is_named(self, monkeypatch):
        html.mathml.cache_clear()
        monkeypatch.setitem(sys.modules, "latex2mathml.converter", None)
        with pytest.raises(tn.MissingExtraError, match="pip install latex2mathml"):
            html_page(make_report("dmf_rig", sections=["equations"], date=None))
        html.mathml.cache_clear()

    def test_write_leaves_an_old_file_alone_if_it_fails(self, tmp_path):
        path = tmp_path / "r.html"
        path.write_text("old", encoding="utf-8")
        with pytest.raises(tn.UsageError):
            tn.write_report("dmf_rig", path, transfer_functions=["no/such"])
        assert path.read_text(encoding="utf-8") == "old"

    def test_unknown_ending(self, tmp_path):
        with pytest.raises(tn.UsageError, match=r"\.html"):
            tn.write_report("dmf_rig", tmp_path / "r.odt")


@needs_browser
class TestInBrowser:
    @pytest.mark.slow
    @pytest.mark.parametrize("width", [400, pytest.param(1200, marks=pytest.mark.slow)])
    @pytest.mark.parametrize("model", ["amt_rig", pytest.param("planetary_set", marks=pytest.mark.slow), "hostile"])
    def test_opens_without_error_request_or_overflow(self, chromium, written, model, width):
        path = written(model)
        messages, requests = [], []
        with chromium.new({"width": width, "height": 900}) as page:
            page.on("console", lambda message: messages.append(message.text))
            page.on("pageerror", lambda error: messages.append(str(error)))
            page.on("dialog", lambda dialog: messages.append(dialog.message))
            page.on("request", lambda request: requests.append(request.url))
            page.goto(path.as_uri())
            assert messages == []
            assert requests == [path.as_uri()]
            assert page.evaluate("document.documentElement.scrollWidth") <= width
            assert page.evaluate("document.querySelectorAll('merror').length") == 0

    @pytest.mark.slow
    @pytest.mark.parametrize(
        "model", ["amt_rig", "dmf_rig", pytest.param("six_cylinder_diesel", marks=pytest.mark.slow)]
    )
    def test_fits_an_a4_page(self, chromium, written, model):
        """174 mm of text at 96 px to the inch; nothing may be wider when printed."""
        path = written(model)
        with chromium.new({"width": 664, "height": 1000}) as page:
            page.emulate_media(media="print")
            page.goto(path.as_uri())
            wide = page.evaluate(
                "[...document.querySelectorAll('table, .formula, figure svg, p')]"
                ".filter(e => e.getBoundingClientRect().right > 665).map(e => e.outerHTML.slice(0, 200))"
            )
            assert wide == []

    @pytest.mark.slow
    def test_pdf(self, tmp_path, monkeypatch):
        """The browser's own date is taken out; how it numbers its tags is its own affair."""
        monkeypatch.setenv(browser.BROWSER_ENV, CHROMIUM)
        path = tmp_path / "a.pdf"
        assert tn.write_report("dmf_rig", path, sections=["summary", "modes"], date=DATE) == (path,)
        data = path.read_bytes()
        assert data.startswith(b"%PDF")
        assert data.rstrip().endswith(b"%%EOF")
        assert set(re.findall(rb"Date \(D:(\d{14})", data)) == {b"20000101000000"}
        assert [entry.name for entry in tmp_path.iterdir()] == ["a.pdf"]


class TestPdf:
    def test_no_browser(self, monkeypatch, tmp_path):
        monkeypatch.delenv(browser.BROWSER_ENV, raising=False)
        monkeypatch.setattr(browser.shutil, "which", lambda _: None)
        with pytest.raises(tn.MissingExtraError, match=r"-o report\.html") as caught:
            tn.write_report("dmf_rig", tmp_path / "r.pdf", sections=["validity"])
        assert caught.value.exit_code == 4
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize("ending", ["pdf", "docx"])
    def test_what_is_missing_is_told_before_the_calculation(self, monkeypatch, tmp_path, ending):
        calculated = []
        monkeypatch.setattr("torsionnet.report.report.make_report", lambda *_, **__: calculated.append("report"))
        monkeypatch.setattr(browser, "_candidates", lambda: iter(()))
        monkeypatch.delenv(browser.BROWSER_ENV, raising=False)
        monkeypatch.setitem(sys.modules, "docx", None)
        with pytest.raises(tn.MissingExtraError):
            tn.write_report("dmf_rig", tmp_path / f"r.{ending}")
        assert calculated == []

    def test_campaign_tells_it_before_it_reads_records(self, monkeypatch, tmp_path):
        """The records of the campaign do not exist here."""
        monkeypatch.chdir(tmp_path)
        monkeypatch.setenv(browser.BROWSER_ENV, "/no/such/program")
        assert "/no/such/program" in run("campaign", "marine_campaign", "-o", "r.pdf", code=4).stderr

    def test_wrong_variable(self, monkeypatch):
        monkeypatch.setenv(browser.BROWSER_ENV, "/no/such/program")
        with pytest.raises(tn.MissingExtraError, match="/no/such/program"):
            browser.find_browser()

    def test_a_program_that_is_named_is_on_the_path_or_a_file(self, monkeypatch, tmp_path):
        monkeypatch.setattr(browser.shutil, "which", lambda name: "/opt/mine" if name == "mine" else None)
        file = tmp_path / "own"
        file.touch()
        for given, taken in (("mine", "/opt/mine"), (str(file), str(file))):
            monkeypatch.setenv(browser.BROWSER_ENV, given)
            assert browser.find_browser() == taken

    @pytest.mark.parametrize("is_root", [True, False])
    def test_root_prints_without_the_sandbox_that_it_cannot_have(self, monkeypatch, tmp_path, is_root):
        page, printed, called = tmp_path / "r.html", tmp_path / "r.pdf", []

        def run(command, **_):
            called.extend(command)
            printed.write_bytes(b"%PDF-1.4")
            return subprocess.CompletedProcess(command, 0, b"", b"")

        monkeypatch.setattr(browser.subprocess, "run", run)
        monkeypatch.setattr(browser, "_is_root", lambda: is_root)
        browser._print("mine", page, printed)
        assert (called[0], called[-1], "--no-sandbox" in called) == ("mine", page.as_uri(), is_root)

    def test_usual_places_on_windows(self, monkeypatch):
        monkeypatch.delenv(browser.BROWSER_ENV, raising=False)
        monkeypatch.setenv("PROGRAMFILES", "C:/Program Files")
        monkeypatch.setattr(browser.shutil, "which", lambda name: name if "msedge.exe" in name else None)
        assert "Edge" in browser.find_browser()

    def test_a_browser_that_fails(self, monkeypatch, tmp_path):
        monkeypatch.setenv(browser.BROWSER_ENV, shutil.which("false") or "false")
        with pytest.raises(tn.SolveError, match="did not print"):
            pdf.write(make_report("dmf_rig", sections=["validity"], date=None), tmp_path / "r.pdf")


class TestLatex:
    def test_special_characters(self):
        assert latex_escaped("50 % of a_b & c\\d {e} $f$ #g ~h ^i") == (
            r"50 \% of a\_b \& c\textbackslash{}d \{e\} \$f\$ \#g \textasciitilde{}h \textasciicircum{}i"
        )
        assert latex_escaped("Ω é 中 \x07") == r"$\Omega$ é [U+4E2D] [U+0007]"

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("ending", "sections"),
        [
            ("md", ["equations", "responses"]),
            ("tex", ["modes"]),
            *(pytest.param(ending, (), marks=pytest.mark.nightly) for ending in ("md", "tex")),
        ],
    )
    def test_same_bytes(self, tmp_path, ending, sections):
        texts = []
        for name in ("a", "b"):
            folder = tmp_path / name
            folder.mkdir()
            files = tn.write_report("dmf_rig", folder / f"r.{ending}", date=DATE, sections=sections)
            texts.append([file.read_bytes() for file in files])
        assert texts[0] == texts[1]

    @pytest.mark.slow
    @needs_latex
    @pytest.mark.parametrize(
        "model", [*(pytest.param(name, marks=pytest.mark.slow) for name in ("amt_rig", "planetary_set")), "hostile"]
    )
    def test_compiles(self, tmp_path, model):
        options = {"transfer_functions": ["theta_S/T_S"]} if model == "planetary_set" else {}
        tn.write_report(hostile() if model == "hostile" else model, tmp_path / "my report.tex", date=DATE, **options)
        done = subprocess.run(
            ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "my report.tex"],
            cwd=tmp_path,
            capture_output=True,
            check=False,
        )
        log = done.stdout.decode(errors="replace")
        assert done.returncode == 0, log[-2000:]
        wide = [float(found) for found in re.findall(r"Overfull \\hbox \((\d+\.\d+)pt", log)]
        assert max(wide, default=0) < 12, log

    def test_captions_are_in_the_document(self):
        text = LatexWriter(make_report("dmf_rig", date=None), "figures").page()
        assert text.count(r"\begin{longtable}") == text.count(r"\caption{")
        assert r"\drawing{figures/schematic.pdf}" in text


class TestMarkdown:
    @pytest.mark.slow
    def test_formulas_and_figures(self, tmp_path):
        path = tmp_path / "my rig.md"
        files = tn.write_report("dmf_rig", path, date=DATE)
        text = path.read_text(encoding="utf-8")
        links = re.findall(r"\]\(([^)]+)\)", text)
        assert {tmp_path / link for link in links} == set(files[1:])
        assert all(" " not in link for link in links)
        assert "$\\theta_{1} / T_{T}$" in text
        assert text.count("$$") % 2 == 0

    @pytest.mark.slow
    def test_no_escape_that_markdown_eats(self):
        text = MarkdownWriter(make_report("amt_rig", date=None), "f").page()
        for formula in re.findall(r"\$\$?(.+?)\$\$?", text, re.DOTALL):
            assert "\\\\" not in formula
            assert "\\," not in formula

    def test_tables_have_equal_rows(self):
        text = MarkdownWriter(make_report(hostile(), date=None), "f").page()
        lines = [re.sub(r"\\.", "", line) for line in text.splitlines()]
        tables = [list(group) for group in _runs(lines)]
        assert len(tables) > 8
        for found in tables:
            assert len({line.count("|") for line in found}) == 1, found

    def test_a_table_has_its_rule_units_and_headings_of_groups(self):
        groups = (TableGroup((("one", NumberText(2.0)),)), TableGroup((("two", NumberText(7.5)),), "Others"))
        found = TableBlock(("Values",), (Heading("Name"), Heading("x", "kN·m", numeric=True)), groups)
        text = MarkdownWriter(Report("r", "", Facts(()), (), (Section("s", ("s",), (found,)),)), "f").page()
        lines = [line.replace("\\", "") for line in text.splitlines() if line.startswith("|")]
        assert lines[-5:] == ["| Name | x [kN·m] |", "|---|---:|", "| one | 2 |", "| **Others** | |", "| two | 7.5 |"]

    def test_math_with_bars(self):
        assert (
            markdown.MarkdownInline()(Math(r"\left|\lambda\right| a_{1} \\ b"))
            == r"$\left\vert \lambda\right\vert  a_{1} \cr b$"
        )


def _runs(lines):
    """Lines of tables that follow each other."""
    found = []
    for line in [*lines, ""]:
        if line.startswith("|"):
            found.append(line)
        elif found:
            yield found
            found = []


@pytest.mark.slow
def test_names_in_svg_are_unique_and_all_used():
    from torsionnet.plot.drawing.save import inline_svg

    rig = tn.load("dmf_rig")
    figure = tn.plot.bode(rig.frequency_response("theta_1", "T_T", np.linspace(1, 20, 30)))
    figure.set_dpi(130)
    first, second = inline_svg(figure, "a-"), inline_svg(figure, "b-")
    assert figure.dpi == 130
    ids, used = (
        set(re.findall(r'\bid="([^"]+)"', first)),
        set(re.findall(r"#([\w-]+)", re.sub(r"#[0-9a-f]{6}", "", first))),
    )
    assert ids == used
    assert ids.isdisjoint(re.findall(r'\bid="([^"]+)"', second))
    assert "<style" not in first
    assert "<metadata" not in first

"""LaTeX reports: nothing beyond the margin, no heading alone, one run; without TeX, what the text itself shows."""

import math
import re
import shutil
import subprocess
from itertools import pairwise

import pytest
from support import campaigns

import torsionnet as tn
from torsionnet.model.operating_point import OperatingPoint
from torsionnet.report import make_report
from torsionnet.report.document_tree import (
    Details,
    Formula,
    Heading,
    Math,
    NumberText,
    Paragraph,
    Report,
    Section,
    TableBlock,
)
from torsionnet.report.report_tables import merge_equal_rows, table
from torsionnet.report.writers.html import html_page
from torsionnet.report.writers.latex import LatexInline, LatexWriter, lines_needed, table_latex
from torsionnet.report.writers.table_layout import GAP_LETTERS, PAGE_LETTERS, TableColumn, TableLayout

needs_latex = pytest.mark.skipif(
    shutil.which("pdflatex") is None or shutil.which("pdftotext") is None, reason="pdflatex is not installed"
)
DATE = "2025-03-31"
SHORT_MODELS = ("amt_rig", "six_cylinder_diesel", "two_stroke_ship")
"""With long formulas of many configurations, with tables over frequency, and a calculation for approval."""


def crank_engine():
    """Six equal throws, a coupling and a propeller, in several configurations: many coordinates and long formulas."""
    nodes = [f"c{number}" for number in range(1, 15)]
    parts = [tn.Inertia(f"m{number}", node=node, inertia="J") for number, node in enumerate(nodes, 1)]
    parts += [
        tn.Spring(f"k{number}", nodes=pair, stiffness="k", damping={"zeta": 0.01, "at": "20 Hz"})
        for number, pair in enumerate(pairwise(nodes), 1)
    ]
    return tn.Drivetrain(
        "crank engine",
        [*parts, tn.Damper("water", nodes=("c14", "ground"), damping="c")],
        {"J": 50, "k": 3e6, "c": 4e4},
        inputs={"T": {"torque": "c1"}},
        sensors={"phi": {"angle": "c14"}, "T_s": {"torque": "k5"}},
        configurations={"coupling": {"soft": {"k": 2e6}, "same": {}, "stiff": {"k": 4e6}, "stiffer": {"k": 5e6}}},
        operating_point=OperatingPoint(speed={"c1": "750 rpm"}),
    )


@pytest.fixture(scope="module")
def engine():
    return make_report(crank_engine(), date=DATE, transfer_functions=["phi/T"])


def blocks_of(blocks, kind):
    for block in blocks:
        if isinstance(block, kind):
            yield block
        if isinstance(block, (Section, Details)):
            yield from blocks_of(block.blocks, kind)


def section(report, name):
    return next(one for one in report.sections if one.name == name)


def wide_table(columns=14, letters=14):
    heads = [
        Heading("Configuration"),
        *(Heading(f"Value of quantity {n}", "N·m/rad", numeric=True) for n in range(columns)),
    ]
    row = tuple(NumberText(float(f"1.{'23456789' * 3}"[:letters]) * 1e5, letters) for _ in range(columns))
    return table(
        "Wide", heads, [("gear=first,clutch=open", *row), ("gear=second,clutch=open", *(NumberText(2.0),) * columns)]
    )


class TestEqualRows:
    def test_equal_rows_that_follow_each_other_are_one(self):
        rows = [("a", NumberText(1.0)), ("b", NumberText(1.0 + 1e-12)), ("c", NumberText(2.0)), ("d", NumberText(1.0))]
        assert merge_equal_rows(rows) == (("a, b", NumberText(1.0)), ("c", NumberText(2.0)), ("d", NumberText(1.0)))

    def test_rows_that_go_on_with_the_one_above_stay(self):
        rows = [("a", "1"), ("", "1"), ("", "1")]
        assert merge_equal_rows(rows) == tuple(rows)

    @pytest.mark.slow
    def test_six_throws_are_one_row_that_names_all(self, engine):
        elements = next(blocks_of([section(engine, "elements")], TableBlock))
        names = [row[0] for row in elements.groups[0].rows if row[0]]
        assert names == [", ".join(f"m{n}" for n in range(1, 15)), ", ".join(f"k{n}" for n in range(1, 14)), "water"]
        assert elements.groups[0].rows[0][2].split("; ") == [f"c{n}" for n in range(1, 15)]

    def test_nodes_of_one_speed_and_configurations_with_equal_results_are_one_row(self, engine):
        (point,) = (
            one for one in blocks_of([section(engine, "parameters")], TableBlock) if "Operating" in one.caption[0]
        )
        assert [row[0] for row in point.groups[0].rows] == [", ".join(f"c{n}" for n in range(1, 15))]


class TestTooLong:
    @pytest.mark.slow
    def test_many_steps_are_folded_away_on_a_page_and_left_out_on_paper(self, engine):
        page, paper, text = html_page(engine), html_page(engine, folds=False), LatexWriter(engine, "f").page()
        assert "<details><summary>" in page
        assert "<details>" not in paper
        assert "z_{20}" not in text
        said = next(blocks_of([section(engine, "formulas")], Details)).instead
        assert said[0].startswith("Written in symbols it takes")
        assert said[0] in text
        assert said[0] in paper

    def test_matrices_of_many_coordinates_are_given_by_their_entries(self, engine):
        (found,) = blocks_of([section(engine, "equations")], TableBlock)
        rows = {(row[0], row[1]): [cell.value if cell != "" else 0 for cell in row[2:]] for row in found.groups[0].rows}
        damping = 2 * 0.01 * 2e6 / (2 * math.pi * 20)
        assert len(rows) == 14 + 13
        assert rows["c2", "c2"] == pytest.approx([50, 2 * damping, 4e6])
        assert rows["c2", "c3"] == pytest.approx([0, -damping, -2e6])
        assert rows["c14", "c14"] == pytest.approx([50, damping + 4e4, 2e6])

    def test_modes_of_many_configurations_stand_beside_each_other(self, engine):
        tables = [one for one in section(engine, "modes").blocks if isinstance(one, TableBlock)]
        assert [len(one.groups) for one in tables] == [1, 1, 1, 1]
        soft, stiffer = tables[2].groups[0].rows[0], tables[2].groups[0].rows[-1]
        assert (soft[0], stiffer[0]) == ("soft", "stiffer")
        # The damper is so strong that it holds its end: 13 free inertias between a wall and a free end.
        held = [200 / math.pi * math.sin((2 * k - 1) * math.pi / 54) for k in (2, 3)]
        assert [soft[2].value, soft[3].value] == pytest.approx(held, rel=0.01)

    @pytest.mark.slow
    def test_numbers_of_tables_are_those_of_the_page(self, engine):
        page, text = html_page(engine), LatexWriter(engine, "f").page()
        open_page = re.sub(r"<details>.*?</details>", "", page, flags=re.DOTALL)
        captions = re.findall(r"<p class=caption id=table-(\w+)>", open_page)
        assert captions == [str(number) for number in range(1, text.count(r"\caption{") + 1)]


class TestWidths:
    def test_a_table_that_fits_stays_in_one_piece(self):
        small = table("Small", [Heading("A"), Heading("B", numeric=True)], [("a", NumberText(1.0))])
        (piece,) = TableLayout(small).pieces
        assert [placed.width for placed in piece] == [None, None]

    def test_a_table_too_wide_goes_on_below_with_its_first_column(self):
        layout = TableLayout(wide_table())
        parts = layout.pieces
        assert len(parts) > 1
        assert all(part[0].index == 0 for part in parts)
        assert [placed.index for part in parts for placed in part[1:]] == list(range(1, 15))
        assert table_latex(layout).count(r"\caption*{(continued)}") == len(parts) - 1
        assert table_latex(layout).count(r"\caption{") == 1

    def test_texts_share_the_page(self):
        block = table(
            "Texts", [Heading("A"), Heading("B"), Heading("C")], [("word " * 30, "word " * 60, NumberText(1.0))]
        )
        (piece,) = TableLayout(block).pieces
        widths = [placed.width or placed.column.natural_letters for placed in piece]
        assert sum(widths) + 3 * GAP_LETTERS <= PAGE_LETTERS + 1e-9
        assert widths[0] < widths[1]

    def test_headings_break_at_spaces_and_before_the_unit(self):
        column = TableColumn(Heading("Largest relative difference", "%", numeric=True), ())
        assert column.heading_lines(10) == ("Largest", "relative", "difference", "[%]")
        assert column.heading_lines(17) == ("Largest relative", "difference [%]")
        with_formula = TableColumn(Heading(("rubber coupling ", Math("T_{KW}"), ", N"), numeric=True), ())
        assert with_formula.heading_lines(10) == ("rubber", "coupling", (Math("T_{KW}"), ",", " ", "N"))


def test_words_of_more_than_twenty_letters_may_break_behind_signs():
    from torsionnet.report.writers.docx_text import DocxInline

    whole, long = "a" * 9 + "=" + "b" * 10, "a" * 9 + "=" + "b" * 11
    for write in (LatexInline(), DocxInline(breaks=True)):
        assert whole in write(whole)
        assert long not in write(long)


class TestRoom:
    def test_every_heading_and_table_asks_for_room(self, engine):
        text = LatexWriter(engine, "f").page()
        for command in (r"\section{", r"\subsection{"):
            places = [place.start() for place in re.finditer(re.escape(command), text)]
            assert all(re.search(r"\\room\{\d+\\baselineskip\}\n$", text[:place]) for place in places)

    def test_a_heading_takes_the_beginning_of_what_follows_along(self):
        long = table("T", [Heading("A")], [(f"row {number}",) for number in range(60)])
        alone = lines_needed(Section("s", ("S",), ()))
        assert alone + 5 < lines_needed(Section("s", ("S",), (long,))) < alone + 20
        assert lines_needed(Section("s", ("S",), (Paragraph(("Lead:",)), long))) > lines_needed(
            Section("s", ("S",), (long,))
        )
        assert (
            lines_needed(long)
            < lines_needed(table("T", [Heading("A")], [(f"row {number}",) for number in range(14)]))
            < 30
        )

    def test_a_formula_takes_two_paragraphs(self):
        assert lines_needed(Formula("x")) == 2 * lines_needed(Paragraph(("a",)))

    def test_a_heading_of_one_line_is_no_table_of_its_own(self):
        text = table_latex(TableLayout(table("T", [Heading("A")], [("x",)])))
        assert r"\textbf{A} \\" in text
        assert r"\begin{tabular}" not in text

    def test_a_text_that_breaks_needs_its_lines(self):
        """Half a line of the page is 50 letters; 175 are four lines of it, each 1.15 lines high."""
        short, long = (lines_needed(table("T", [Heading("A")], [("x" * letters,)])) for letters in (10, 175))
        assert long - short == pytest.approx(3 * 1.15)

    def test_rows_of_matrices_with_fractions_stand_apart(self):
        text = LatexWriter(make_report("amt_rig", date=None, sections=["equations"]), "f").page()
        matrices = [found for found in re.findall(r"\\begin{bmatrix}.*?\\end{bmatrix}", text) if "dfrac" in found]
        assert matrices
        assert all(r" \\[5pt] " in found for found in matrices if r"\\" in found)


def compiled(folder, stem):
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", f"{stem}.tex"],
        cwd=folder, capture_output=True, check=False,
    )  # fmt: skip
    log = (folder / f"{stem}.log").read_text(encoding="utf-8", errors="replace")
    assert done.returncode == 0, log[-2000:]
    shown = subprocess.run(["pdftotext", "-layout", f"{stem}.pdf", "-"], cwd=folder, capture_output=True, check=True)
    return log, shown.stdout.decode()


MOST_OVER = 1
"""Points by which a line may be too long: nobody sees a third of a millimetre."""


def overfull(log):
    log = log.replace("\n", "")
    return [float(found) for found in re.findall(r"Overfull \\hbox \((\d+\.\d+)pt", log)]


def headings_alone(text):
    """Pages whose last line above the page number is a heading; the contents, line below line, are none."""
    pages = [[line for line in page.splitlines() if line.strip()] for page in text.split("\f")]
    heads = [[re.match(r"\d{1,2}(\.\d{1,2})?\s{2,}[A-Z]", line) for line in page[-3:-1]] for page in pages]
    return [page[-2] for page, head in zip(pages, heads, strict=True) if head and head[-1] and not all(head)]


@needs_latex
class TestCompiled:
    @pytest.mark.slow
    @pytest.mark.parametrize("model", campaigns.by_day(tn.library_models(), "amt_rig"))
    def test_models_of_the_library(self, tmp_path, model):
        tn.write_report(model, tmp_path / "r.tex", date=DATE)
        log, text = compiled(tmp_path, "r")
        assert max(overfull(log), default=0) <= MOST_OVER
        assert headings_alone(text) == []
        assert compiled(tmp_path, "r")[1] == text

    @pytest.mark.slow
    def test_one_run_does_for_long_tables_and_many_configurations(self, tmp_path, engine):
        (tmp_path / "r.tex").write_text(
            re.sub(r"\\drawing\{[^}]*\}", "", LatexWriter(engine, "f").page()), encoding="utf-8"
        )
        log, text = compiled(tmp_path, "r")
        assert max(overfull(log), default=0) <= MOST_OVER
        assert headings_alone(text) == []
        assert compiled(tmp_path, "r")[1] == text

    @pytest.mark.slow
    def test_a_table_far_too_wide(self, tmp_path):
        long = "angularvelocityofthegeneratorrotor_" * 4
        blocks = (wide_table(), table("Words", [Heading("A"), Heading("B")], [(long, Math("x")), (long + "b", "y")]))
        report = Report("T", "S", make_report("dmf_rig", date=None, sections=["validity"]).facts, (),
                        (Section("s", ("S",), blocks),))  # fmt: skip
        (tmp_path / "r.tex").write_text(LatexWriter(report, "f").page(), encoding="utf-8")
        log, text = compiled(tmp_path, "r")
        assert max(overfull(log), default=0) <= MOST_OVER
        assert compiled(tmp_path, "r")[1] == text

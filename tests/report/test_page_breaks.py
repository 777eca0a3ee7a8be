"""Where tables of a report may be split between two pages, and how wide the columns of a Word table are."""

import re
import shutil
from pathlib import Path

import pytest

import torsionnet.report.writers as writers
from torsionnet.report import make_report
from torsionnet.report.document_tree import (
    Facts,
    Heading,
    NumberText,
    Paragraph,
    Picture,
    Report,
    Section,
    TableBlock,
    TableGroup,
)
from torsionnet.report.writers import pdf
from torsionnet.report.writers.docx_text import table_xml
from torsionnet.report.writers.html import HtmlWriter, html_page
from torsionnet.report.writers.table_layout import TableColumn, TableLayout

CSS = (Path(writers.__file__).parent / "templates" / "style.css").read_text(encoding="utf-8")
TWIPS_OF_A_LETTER = 0.56 * 8.5 * 20
"""Width in twentieths of a point of a bold letter of Arial at 8.5 points: half an em and a little, on average."""


def table(*counts, titled=False):
    groups = tuple(
        TableGroup(tuple((f"{group}.{row}",) for row in range(count)), f"group {group}" if titled else "")
        for group, count in enumerate(counts)
    )
    return TableBlock(("Rows",), (Heading("No."),), groups)


def margins(text):
    """Sum of the left and the right margin of the cells of a Word table, in twentieths of a point."""
    inner = re.search(r"<w:tblCellMar>(.*?)</w:tblCellMar>", text)[1]
    return sum(int(re.search(rf'<w:{side} w:w="(\d+)"', inner)[1]) for side in ("left", "right"))


def kept_in_word(block):
    """Texts of the rows in a Word table that stay on the page of the row below, the head left out."""
    rows = re.findall(r"<w:tr>.*?</w:tr>", table_xml(TableLayout(block), "", "continued"), re.DOTALL)[1:]
    return [re.findall(r"<w:t[^>]*>([^<]+)</w:t>", row)[0] for row in rows if "<w:keepNext/>" in row]


class TestBreaks:
    @pytest.mark.parametrize(
        ("block", "whole"),
        [(table(6), True), (table(7), False), (table(2, 2, titled=True), True), (table(3, 2, titled=True), False)],
    )
    def test_short_tables_stay_whole_in_html_titles_of_groups_counted(self, block, whole):
        page = html_page(Report("T", "Kind", Facts(()), (), (Section("s", ("S",), (block,)),)))
        assert ("<div class=keep>" in page) == whole
        assert re.search(r"[,}][^}]*\.keep[^{]*\{break-inside:avoid\}", CSS)

    def test_two_rows_at_either_end_in_html(self):
        (rule,) = re.findall(r"^(tbody:first-of-type.*)\{break-after:avoid\}$", CSS, re.MULTILINE)
        first, *titles, last = rule.split(",")
        assert first == "tbody:first-of-type tr:first-child"
        assert titles == ["tr.group", "tr.group+tr:not(:last-child)"]
        assert last == "tbody:last-of-type tr:nth-last-child(2)"

    def test_short_tables_stay_whole_in_word(self):
        assert kept_in_word(table(6)) == [f"0.{row}" for row in range(5)]

    def test_two_rows_at_either_end_in_word(self):
        assert kept_in_word(table(9)) == ["0.0", "0.7"]

    def test_two_rows_below_the_title_of_a_group_in_word(self):
        assert kept_in_word(table(4, 5, titled=True)) == ["group 0", "0.0", "group 1", "1.0", "1.3"]

    def test_groups_of_one_row_do_not_make_a_table_one_piece_in_word(self):
        titles = [f"group {place}" for place in range(5)]
        assert kept_in_word(table(1, 1, 1, 1, 1, titled=True)) == ["group 0", "0.0", *titles[1:4], "3.0", "group 4"]


@pytest.mark.parametrize(("height", "low"), [(4.3, True), (6.2, False)])
def test_figures_wider_than_high_leave_room_on_a_printed_page(height, low):
    """Two of them and their captions fit on a page of 261 mm; one that is nearly square keeps its size."""
    from matplotlib.figure import Figure

    blocks = (Picture("grey", Figure(figsize=(7.2, height)), ("A grey square.",), "grey"),)
    page = html_page(Report("T", "Kind", Facts(()), (), (Section("s", ("S",), blocks),)))
    assert ("<figure class=low>" in page) == low
    (most,) = re.findall(r"^figure\.low svg\{max-height:(\d+)mm\}$", CSS, re.MULTILINE)
    assert 2 * (int(most) + 20) < 261


@pytest.mark.slow
@pytest.mark.skipif(not any(map(shutil.which, pdf.BROWSER_COMMANDS)), reason="no browser on the path to print with")
def test_text_goes_on_where_a_figure_does_not_fit(tmp_path):
    """Text of 60 % of a page, a figure of 60 % and text of 60 % are two pages, if the figure makes way for the text."""
    text = tuple(Paragraph(("A line of text.",)) for _ in range(22))
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.8, 6.2), facecolor="grey")
    blocks = (*text, Picture("grey", figure, ("A grey square.",), "grey"), *text)
    pdf.write(Report("T", "Kind", Facts(()), (), (Section("s", ("S",), blocks),)), tmp_path / "r.pdf")
    data = (tmp_path / "r.pdf").read_bytes()
    assert len(re.findall(rb"/Type /Page\b", data)) == 2


def numbered(columns, unit="N·m/rad"):
    return tuple(Heading(f"Quantity {place}", unit=unit, numeric=True) for place in range(columns))


def rows_of(columns, *keys):
    return tuple((*key, *(NumberText(1.5 * place) for place in range(columns))) for key in keys)


class TestWideTables:
    """A column of numbers below Quantity, 8 bold letters, is as wide as 9, with its gap 11; the page has 98."""

    KEYS = (("gear", "first"), ("", "second"), ("clutch", "first"), ("", "second"))

    def layout(self, columns):
        headings = (Heading("Part"), Heading("State"), *numbered(columns, "N·m"))
        return TableLayout(TableBlock(("Wide",), headings, (TableGroup(rows_of(columns, *self.KEYS)),)))

    @pytest.mark.parametrize(("columns", "size"), [(7, 1.0), (8, 0.9), (9, 0.86)])
    def test_letters_are_smaller_before_a_table_is_split(self, columns, size):
        layout = self.layout(columns)
        assert (len(layout.pieces), layout.size) == (1, size)
        style = {1.0: "TableText", 0.9: "SmallTableText", 0.86: "SmallestTableText"}[size]
        assert set(re.findall(r'w:pStyle w:val="(\w*TableText)"', table_xml(layout, "", ""))) == {style}

    def test_split_tables_repeat_the_columns_that_tell_rows_apart(self):
        layout = self.layout(11)
        assert layout.size == 1.0
        assert [[placed.index for placed in piece] for piece in layout.pieces] == [
            [0, 1, 2, 3, 4, 5, 6, 7],
            [0, 1, 8, 9, 10, 11, 12],
        ]

    def test_a_blank_first_cell_is_said_again_below(self):
        keys = [row[:2] for row in self.layout(11).continued[0].rows]
        assert keys == [("gear", "first"), ("gear", "second"), ("clutch", "first"), ("clutch", "second")]
        assert len(set(keys)) == len(keys)

    def test_a_sum_at_the_end_gets_no_name_of_the_row_above(self):
        headings = (Heading("No."), Heading("Mass"), *numbered(11))
        rows = rows_of(11, ("1", "hub"), ("2", "hub"), ("", "Sum"))
        layout = TableLayout(TableBlock(("Sum",), headings, (TableGroup(rows),)))
        assert layout.keys == (0,)
        assert layout.continued[0].rows[-1][:2] == ("", "Sum")

    def test_printed_page_has_the_pieces_and_a_screen_the_whole(self):
        report = Report("T", "Kind", Facts(()), (), (Section("s", ("S",), (self.layout(11).block,)),))
        printed, screen = (HtmlWriter(report, folds=folds).page() for folds in (False, True))
        assert [page.count("<table") for page in (printed, screen)] == [2, 1]
        assert printed.count("<td>clutch</td>") == 3
        assert screen.count("<td>clutch</td>") == 1

    def test_a_number_and_its_unit_are_not_parted(self):
        cells = ((NumberText(0.0981), "\N{NO-BREAK SPACE}kN·m"),)
        assert TableColumn(Heading("Peak"), cells).least_letters == len("0.0981 kN·m")


class TestWidthsInWord:
    def test_headings_of_a_wide_table_break_between_words_only(self):
        heads = [("Mode", "", True), *((f"Undamped frequency {i}", "Hz", True) for i in range(6)), ("Nodes", "", True)]
        columns = tuple(Heading(text, unit=unit, numeric=numeric) for text, unit, numeric in heads)
        columns += (Heading("What swings"),)
        row = (*(NumberText(float(i)) for i in range(8)), "flywheel and wheel against propeller " * 3)
        text = table_xml(TableLayout(TableBlock(("Wide",), columns, (TableGroup((row,)),))), "", "continued")
        widths = [int(one) for one in re.findall(r'gridCol w:w="(\d+)"', text)]
        assert len(widths) == len(columns)
        assert sum(widths) <= 9864 + len(widths)
        for width, column in zip(widths, columns, strict=True):
            assert width - margins(text) >= TWIPS_OF_A_LETTER * max(map(len, column.text.split())), column.text

    @pytest.mark.slow
    def test_a_ship(self):
        report = make_report("two_stroke_ship")
        for block in [one for part in report.sections for one in part.blocks if isinstance(one, TableBlock)]:
            for piece in table_xml(TableLayout(block), "", "").split("<w:tbl>")[1:]:
                widths = [int(one) for one in re.findall(r'gridCol w:w="(\d+)"', piece)]
                cells = re.findall(r"<w:tc>.*?</w:tc>", piece.partition("</w:tr>")[0], re.DOTALL)
                for width, cell in zip(widths, cells, strict=True):
                    words = " ".join(re.findall(r"<w:t[^>]*>([^<]+)</w:t>", cell)).split()
                    longest = max(map(len, words), default=0)
                    assert width - margins(piece) >= TWIPS_OF_A_LETTER * longest, (block.caption, words)


@pytest.mark.parametrize(("count", "size"), [(6, 1.0), (7, 0.9), (8, 0.86)])
def test_smaller_letters_make_room_for_long_texts(count, size):
    """Numbers of ten letters with gaps of 1.5 leave 29, 18 and 6 of 98 letters; a column of texts has 18 at least."""
    heads = (*[Heading("Allowed", numeric=True)] * count, Heading("Largest orders there", wide=True))
    row = (*[NumberText(123456.789, 9)] * count, "engine 4: 52.8; engine 2.5: 18.4; engine 4.5: 15.5")
    layout = TableLayout(TableBlock(("Wide",), heads, (TableGroup((row,)),)))
    assert layout.size == size
    (piece,) = layout.pieces
    assert piece[-1].width is None or piece[-1].width >= 16

"""The report as a Word document, read back with python-docx and as XML."""

import io
import re
import sys
import zipfile
from dataclasses import replace

import pytest

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.document_tree import (
    BreakableMath,
    Code,
    Details,
    Equations,
    Facts,
    Formula,
    Heading,
    Listing,
    Math,
    NumberText,
    Paragraph,
    Picture,
    Remark,
    Report,
    Section,
    Strong,
    TableBlock,
    TableGroup,
)
from torsionnet.report.writers.docx_text import FIGURE_SPACE, POINT_SPACE, omml, table_xml
from torsionnet.report.writers.table_layout import TableLayout

docx = pytest.importorskip("docx")
from torsionnet.report.writers.docx import docx_bytes  # noqa: E402

DATE = "2025-03-31"
HOSTILE = '<b>A & "B"</b> $x_1$ \x07 \ufffe 中 Ω'


def opened(report):
    return docx.Document(io.BytesIO(docx_bytes(report)))


def xml(report, name="word/document.xml"):
    with zipfile.ZipFile(io.BytesIO(docx_bytes(report))) as file:
        return file.read(name).decode()


def rows(table):
    return [[cell.text for cell in row.cells] for row in table.rows]


def of(*blocks, **options):
    return Report("Title", "Kind", Facts(()), (), (Section("s", ("First",), blocks),), **options)


NUMBERS = TableBlock(
    ("Values",),
    (Heading("Name"), Heading("x", unit="kN m", numeric=True)),
    (
        TableGroup((("one", NumberText(13300.0)), ("two", NumberText(0.078)))),
        TableGroup((("three", NumberText(1.2e-9)),), "Group"),
    ),
    notes=(("A note.",),),
    more=5,
)


def picture(size=(2, 1)):
    from matplotlib.figure import Figure

    figure = Figure(figsize=size)
    figure.add_subplot().plot([0, 1])
    return Picture("line", figure, ("A line.",), "a line that rises")


class TestBlocks:
    def test_headings_are_counted_by_word(self):
        inner = Section("inner", ("Second",), ())
        document = opened(of(inner))
        found = [(one.style.name, one.text) for one in document.paragraphs if one.style.name.startswith("Heading")]
        assert found == [("Heading 1", "First"), ("Heading 2", "Second")]
        for level, name in enumerate(("Heading 1", "Heading 2")):
            numbered = document.styles[name].element.pPr.numPr
            assert (numbered.ilvl.val if numbered.ilvl is not None else 0, numbered.numId.val) == (level, 90)
        lists = document.part.numbering_part.element.xml
        assert '<w:lvlText w:val="%1.%2"/>' in lists
        assert lists.index("<w:abstractNum ") < lists.index("<w:num ")

    def test_kind_title_and_what_is_to_be_heeded_stand_before_the_contents(self):
        document = opened(replace(of(), notes=("Said first.",)))
        begin = [(one.style.name, one.text) for one in document.paragraphs][:4]
        assert begin[:2] == [("Subtitle", "Kind"), ("Title", "Title")]
        assert [text for _, text in begin[2:]] == ["Said first.", "Contents"]

    def test_contents_are_a_field_with_links_to_the_headings(self):
        text = xml(of())
        assert re.search(r'<w:instrText xml:space="preserve"> TOC ', text)
        links, marks = (re.findall(rf'{name}="(_Toc_\w+)"', text) for name in ("w:anchor", "w:name"))
        assert links == marks == ["_Toc_1"]
        assert [text.count(f'fldCharType="{kind}"') for kind in ("begin", "separate", "end")] == [1, 1, 1]

    def test_table(self):
        document = opened(of(NUMBERS))
        (table,) = document.tables
        pad = POINT_SPACE + FIGURE_SPACE * 3
        assert rows(table) == [
            ["Name", "x [kN m]"],
            ["one", f"13300{pad}"],
            ["two", "0.078"],
            ["Group", "Group"],
            ["three", "1.2·10−9"],
        ]
        text = table._tbl.xml
        assert text.count("<w:tblHeader/>") == 1
        assert "<w:trHeight" not in text  # rows are as high as their texts
        assert "<w:tblHeader/>" in text[: text.index("</w:tr>")]
        texts = [one.text for one in document.paragraphs]
        assert "A note." in texts
        assert "… and 5 more" in texts

    def test_caption_has_a_number_that_word_counts(self):
        text = xml(of(NUMBERS, NUMBERS))
        found = re.findall(r'<w:fldSimple w:instr=" SEQ Table \\\* ARABIC ">.*?<w:t[^>]*>(\w+)</w:t>', text)
        assert found == ["1", "2"]

    def test_wide_table_goes_on_below(self):
        columns = tuple(Heading(f"heading number {i}") for i in range(14))
        wide = TableBlock(("Wide",), columns, (TableGroup((tuple(f"cell{i:015d}" for i in range(14)),)),))
        document = opened(of(wide))
        assert len(document.tables) > 1
        assert "(continued)" in [one.text for one in document.paragraphs]
        text = table_xml(TableLayout(wide), "", "")
        assert text.count('w:val="TableNote"') == text.count("<w:tbl>")  # two tables without one between would be one
        cells = {text for table in document.tables for row in rows(table) for text in row}
        assert all(f"cell{i:015d}" in cells for i in range(14))
        for table in document.tables:
            assert sum(int(width) for width in re.findall(r'gridCol w:w="(\d+)"', table._tbl.xml)) <= 9880

    def test_texts_lists_remarks_and_what_is_folded_away(self):
        blocks = (
            Paragraph(("plain ", Strong("bold"), " ", Code("a_b"))),
            Listing((("point",),)),
            Remark("warning", ("Mind this.",)),
            Facts((("Term", ("said",)),)),
            Details(("more",), (Paragraph(("long",)),), ("shorter",)),
        )
        document = opened(of(*blocks))
        texts = {one.text: one.style.name for one in document.paragraphs}
        assert texts["plain bold a_b"] == "Normal"
        assert document.styles["Code Text"].font.name.startswith("Courier")
        assert texts["point"] == "List Bullet"
        assert texts["Warning: Mind this."] == "Remark"
        assert "shorter" in texts
        assert "long" not in texts
        assert rows(document.tables[0]) == [["Term", "said"]]

    def test_markup_and_control_characters_are_text(self):
        document = opened(
            Report(
                HOSTILE, HOSTILE, Facts(()), (), (Section("s", ("First",), (Paragraph((HOSTILE,)),)),), author=HOSTILE
            )
        )
        assert '<b>A & "B"</b> $x_1$ � � 中 Ω' in [one.text for one in document.paragraphs]


class TestFormulas:
    @pytest.mark.parametrize(
        ("latex", "parts"),
        [
            (r"\frac{a}{b}", r"<m:f><m:num>.*a.*</m:num><m:den>.*b.*</m:den></m:f>"),
            (r"\theta_{1}^{2}", r"<m:sSubSup><m:e>.*θ.*</m:e><m:sub>.*1.*</m:sub><m:sup>.*2.*</m:sup></m:sSubSup>"),
            (r"\ddot{q}", '<m:acc><m:accPr><m:chr m:val="\u0308"/></m:accPr><m:e>.*q.*</m:e></m:acc>'),
            (r"\sqrt{x}", r"<m:rad>.*<m:deg/><m:e>.*x.*</m:e></m:rad>"),
            (
                r"\begin{bmatrix} a & b \\ c & d \end{bmatrix}",
                r'<m:begChr m:val="\["/><m:endChr m:val="\]"/>.*<m:m>.*<m:count m:val="2"/>.*(<m:mr>.*){2}</m:m>',
            ),
            (r"\left|\lambda\right|", r'<m:d><m:dPr><m:begChr m:val="\|"/><m:endChr m:val="\|"/></m:dPr>.*λ.*</m:d>'),
            (r"12", '<m:sty m:val="p"/></m:rPr>.*12'),
            (r"x", '<m:sty m:val="i"/></m:rPr>.*x'),
            (r"\sin x", '<m:sty m:val="p"/></m:rPr>.*sin.*<m:sty m:val="i"/></m:rPr>.*x'),
            (r"\mathrm{input~shaft}", r"<m:nor/></m:rPr>.*input\sshaft"),
        ],
    )
    def test_omml(self, latex, parts):
        assert re.fullmatch(f"<m:oMath>.*{parts}.*</m:oMath>", omml(latex)), omml(latex)

    def test_no_latex_code_is_left(self):
        blocks = (
            Formula(r"J \ddot{\theta} = \frac{T}{2}"),
            Equations((BreakableMath(("a", "+ b")),)),
            Paragraph(("in ", Math(r"\theta_{1}"))),
        )
        text = xml(of(*blocks))
        assert "\\" not in text.replace(r' TOC \o "1-1" \n \h \z \u ', "")
        assert text.count("<m:oMath>") == 3
        assert "(1)" in text


class TestFile:
    def test_same_bytes_and_fixed_dates(self):
        first, second = (docx_bytes(of(NUMBERS, picture(), date=DATE)) for _ in range(2))
        assert first == second
        with zipfile.ZipFile(io.BytesIO(first)) as file:
            assert {entry.date_time for entry in file.infolist()} == {(1980, 1, 1, 0, 0, 0)}
            assert any(name.endswith(".png") for name in file.namelist())
            assert not any("thumbnail" in name for name in file.namelist())

    def test_properties(self):
        about = opened(of(date=DATE, author="A. Engineer")).core_properties
        assert (about.title, about.author, str(about.created)[:10]) == ("Title", "A. Engineer", DATE)
        assert about.comments == ""

    def test_figure_has_200_dots_per_inch_a_caption_and_a_description(self):
        drawn = picture(size=(8, 2))
        document = opened(of(drawn))
        (shape,) = document.inline_shapes
        (image,) = document.part.package.image_parts
        assert (image.image.horz_dpi, image.image.vert_dpi) == (200, 200)
        assert (image.image.px_width, image.image.px_height) == (1600, 400)
        assert (shape.width.mm, shape.height.mm) == pytest.approx((174, 43.5), abs=0.1)
        assert shape._inline.docPr.get("descr") == drawn.alt
        captions = [one.text for one in document.paragraphs if one.style.name == "Caption"]
        assert any("A line." in text for text in captions)

    def test_title_block(self):
        block = {"hull": "4711", "revisions": [{"revision": "A", "date": DATE, "description": "first issue"}]}
        report = make_report("dmf_rig", kind="approval", sections=["validity"], date=DATE, title_block=block)
        fields, revisions, lines = (rows(table) for table in opened(report).tables[:3])
        assert fields[0] == ["Project", "", "Document number", ""]
        assert fields[1] == ["Hull", "4711", "Revision", "A"]
        assert fields[-1][1].startswith("dmf_rig.yaml, SHA-256 ")
        assert revisions[1] == ["A", DATE, "first issue", "", "", ""]
        cells = [row._tr.tc_lst for row in opened(report).tables[0].rows]
        assert len({sum(one.width for one in row) for row in cells}) == 1
        assert [one.grid_span for one in cells[-1]] == [1, 3]
        assert lines[1:] == [["Prepared", "", "", ""], ["Checked", "", "", ""], ["Approved", "", "", ""]]

    def test_words_language_and_logo_of_a_template(self, tmp_path):
        from torsionnet.plot.drawing.save import figure_bytes

        (tmp_path / "words.yaml").write_text("language: de\ntexts: {Table: Tabelle, Contents: Inhalt, Name: Wer}\n")
        (tmp_path / "logo.png").write_bytes(figure_bytes(picture().figure, "png"))
        report = make_report("dmf_rig", sections=["elements"], date=DATE, template=tmp_path)
        document = opened(report)
        assert "Inhalt" in [one.text for one in document.paragraphs]
        assert "Tabelle " in xml(report)
        assert 'w:lang w:val="de"' in document.styles.element.xml
        assert "pic:pic" in document.sections[0].header._element.xml

    def test_missing_package_is_named(self, monkeypatch, tmp_path):
        for name in ["docx", *(name for name in sys.modules if name.startswith("docx."))]:
            monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(tn.MissingExtraError, match=r'pip install "torsionnet\[docx\]"'):
            tn.write_report("dmf_rig", tmp_path / "r.docx", sections=["validity"], date=None)
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.slow
    def test_whole_reports_have_no_latex_code(self):
        for model in ("amt_rig", "two_stroke_ship"):
            text = "".join(re.findall(r"<[wm]:t[^>]*>([^<]*)<", xml(make_report(model, date=DATE))))
            assert not re.search(r"\\[a-z]+|[_^]\{", text)

"""Writing of a report as a Word document, with headings that Word counts, formulas, and figures inside it."""

from __future__ import annotations

import datetime as dt
import io
import itertools
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsionnet.base.atomic import write_bytes
from torsionnet.base.errors import MissingExtraError
from torsionnet.report.document_tree import BreakableMath, Picture, Report, Section, Text, TitleTable
from torsionnet.report.wording import TemplateFolder, Wording
from torsionnet.report.writers.blocks import BlockWriter, CountedLabel
from torsionnet.report.writers.docx_text import (
    HEADINGS,
    TEXT_WIDTH,
    bold,
    counted,
    facts_xml,
    inline,
    number_headings,
    omml,
    paragraph,
    run,
    set_styles,
    table_xml,
    title_block_xml,
    with_names,
)
from torsionnet.report.writers.html import without_controls
from torsionnet.report.writers.table_layout import TableLayout

if TYPE_CHECKING:
    from docx.document import Document


# Word document with its page and properties, into which a report is written, and its bytes.

UNDATED = dt.datetime(2000, 1, 1)  # noqa: DTZ001  (a file says no time zone)
"""Time that a document says it was made at, where the report has no date."""
LONGEST_PROPERTY = 255
"""Largest number of letters that a property of a Word document, such as its title, may have."""
ZIP_DATE = (1980, 1, 1, 0, 0, 0)
"""Date of the files inside the document, the earliest that a zip file can hold: equal reports have equal bytes."""
LOGOS = ("logo.png", "logo.jpg", "logo.jpeg")
"""Names of the image of a template folder that stands at the head of the pages, the first that is there."""
LOGO_HEIGHT = 12
"""Height of the logo in mm."""


def require_docx() -> None:
    """Refuse to go on without python-docx.

    Raises
    ------
    MissingExtraError
        python-docx is not installed.
    """
    try:
        import docx  # noqa: F401
    except ImportError:
        raise MissingExtraError(
            'Word files need the package python-docx: pip install "torsionnet[docx]" (or write -o report.html)'
        ) from None


def empty_document(report: Report) -> Document:
    """Word document without content, with the page, styles and properties of a report.

    Raises
    ------
    MissingExtraError
        python-docx is not installed.
    """
    require_docx()
    import docx

    document = docx.Document()
    template = report.template or TemplateFolder()
    _set_page(document, report, template)
    set_styles(document, template.language)
    number_headings(document)
    _set_properties(document, report)
    return document


def _set_page(document: Any, report: Report, template: TemplateFolder) -> None:
    from docx.oxml.parser import parse_xml
    from docx.shared import Mm

    page = document.sections[0]
    page.page_width, page.page_height = Mm(210), Mm(297)
    page.left_margin, page.right_margin, page.top_margin, page.bottom_margin = Mm(18), Mm(18), Mm(18), Mm(18)
    page.header_distance = page.footer_distance = Mm(9)
    fields = (f'<w:fldSimple w:instr=" {name} ">{run("1")}</w:fldSimple>' for name in ("PAGE", "NUMPAGES"))
    cleared = "".join(f'<w:tab w:val="clear" w:pos="{place}"/>' for place in (4680, 9360))  # those of the style
    footer = paragraph(
        run(report.title) + "<w:r><w:tab/></w:r>" + run(" / ").join(fields),
        "Footer",
        properties=f"<w:tabs>{cleared}<w:tab w:val='right' w:pos='{TEXT_WIDTH}'/></w:tabs>",
    )
    place = page.footer.paragraphs[0]._p  # noqa: SLF001  (python-docx has no fields)
    place.getparent().replace(place, parse_xml(with_names(footer)))
    logo = next((template.images[name] for name in LOGOS if name in template.images), None)
    if logo is not None:
        page.header.paragraphs[0].add_run().add_picture(io.BytesIO(logo), height=Mm(LOGO_HEIGHT))


def _set_properties(document: Any, report: Report) -> None:
    made = dt.datetime.fromisoformat(report.date) if report.date else UNDATED
    about = document.core_properties
    author = without_controls(report.author)[:LONGEST_PROPERTY]
    about.title = without_controls(report.title)[:LONGEST_PROPERTY]
    about.subject = without_controls(report.subtitle)[:LONGEST_PROPERTY]
    about.author, about.last_modified_by, about.comments, about.keywords = author, author, "", ""
    about.created = about.modified = made
    about.revision = 1
    package = document.part.package
    for name in [name for name, relation in package.rels.items() if relation.reltype.endswith("/thumbnail")]:
        del package.rels[name]


def packed(document: Document) -> bytes:
    """Bytes of a Word document; equal documents give equal bytes."""
    saved, fixed = io.BytesIO(), io.BytesIO()
    document.save(saved)
    with zipfile.ZipFile(saved) as source, zipfile.ZipFile(fixed, "w") as target:
        for name in source.namelist():
            entry = zipfile.ZipInfo(name, ZIP_DATE)
            entry.create_system, entry.compress_type = 3, zipfile.ZIP_DEFLATED  # as on Unix, on any system
            target.writestr(entry, source.read(name))
    return fixed.getvalue()


FIGURE_DPI = 200
"""Dots per inch of the figures, which are pictures of dots in a Word document: enough for print."""
LARGEST_FIGURE = (6.85, 9.0)
"""Largest width and height of a figure in inches: the text of a page, less its caption."""
ONE_PANEL_HEIGHT = 2.9
"""Largest height in inches of a figure of one panel: with its caption a third of a page, all that Word leaves blank
above a figure that has no room."""


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write a report as a Word document and return its path."""
    write_bytes(path, docx_bytes(report))
    return (path,)


def docx_bytes(report: Report) -> bytes:
    """Bytes of the Word document of a report; equal reports with equal dates give equal bytes.

    Raises
    ------
    MissingExtraError
        python-docx is not installed.
    """
    document = empty_document(report)  # tells which package is missing, before anything of it is imported
    from docx.oxml.parser import parse_xml

    content = "".join(_content(report, DocxWriter(report, document)))
    page = document.element.body[-1]
    for element in list(parse_xml(with_names(f"<w:body>{content}</w:body>"))):
        page.addprevious(element)
    return packed(document)


def _content(report: Report, writer: DocxWriter) -> Iterator[str]:
    yield paragraph(run(report.subtitle), "Subtitle")
    yield paragraph(run(report.title), "Title")
    if report.title_block:
        yield writer.title_block(report.title_block)
    yield writer.facts(report.facts.rows)
    if any(report.notes):
        yield writer.paragraph(report.notes)
    yield from _contents(report.sections, writer.word)
    yield writer.blocks(report.sections)


def _contents(sections: Sequence[Section], word: Wording) -> Iterator[str]:
    r"""Table of contents: a field that Word can make anew, and its present result, links without pages (\n)."""
    yield paragraph(run(word("Contents")), "ContentsHeading")
    begin = '<w:r><w:fldChar w:fldCharType="begin"/></w:r>'
    begin += r'<w:r><w:instrText xml:space="preserve"> TOC \o "1-1" \n \h \z \u </w:instrText></w:r>'
    begin += '<w:r><w:fldChar w:fldCharType="separate"/></w:r>'
    for place, section in enumerate(sections, 1):
        link = f'<w:hyperlink w:anchor="{_mark(str(place))}">{run(f"{place}  ")}{inline(section.title)}</w:hyperlink>'
        yield paragraph((begin if place == 1 else "") + link, "TableText")
    if sections:
        yield paragraph('<w:r><w:fldChar w:fldCharType="end"/></w:r>', "TableNote")


def _mark(number: str) -> str:
    """Name of the bookmark at the heading of a section."""
    return f"_Toc_{number.replace('.', '_')}"


class DocxWriter(BlockWriter):
    """Writer of the blocks of a report as XML of a Word document, of which the figures become parts."""

    inline = inline

    def __init__(self, report: Report, document: Any) -> None:
        super().__init__((report.template or TemplateFolder()).wording)
        self.document, self.marks, self.drawings = document, itertools.count(1), itertools.count(1)

    def joined(self, written: Sequence[str]) -> str:
        return "".join(written)

    def heading(self, block: Section, number: str, level: int) -> str:
        mark = next(self.marks)
        begin = f'<w:bookmarkStart w:id="{mark}" w:name="{_mark(number)}"/>'
        style = f"Heading{min(level + 1, len(HEADINGS))}"
        return paragraph(f'{begin}{inline(block.title)}<w:bookmarkEnd w:id="{mark}"/>', style)

    def paragraph(self, text: Text) -> str:
        return paragraph(inline(text))

    def listing(self, items: Sequence[Text]) -> str:
        return "".join(paragraph(inline(item), "ListBullet") for item in items)

    def facts(self, rows: Sequence[tuple[str, Text]]) -> str:
        return facts_xml(rows)

    def remark(self, _kind: str, word: str, text: Text) -> str:
        return paragraph(bold(f"{word}: ") + inline(text), "Remark")

    def formula(self, latex: str, number: str) -> str:
        places = (("center", TEXT_WIDTH // 2), ("right", TEXT_WIDTH))
        stops = "".join(f'<w:tab w:val="{side}" w:pos="{place}"/>' for side, place in places)
        tab = "<w:r><w:tab/></w:r>"
        content = f"{tab}{omml(latex)}{tab}{run(f'({number})')}"
        return paragraph(content, "Equation", properties=f"<w:tabs>{stops}</w:tabs>")

    def equations(self, rows: Sequence[BreakableMath]) -> str:
        return "".join(paragraph(inline(row), "Equation") for row in rows)

    def table(self, layout: TableLayout, label: CountedLabel) -> str:
        return table_xml(layout, counted(label) + inline(layout.block.caption), self.word("(continued)"))

    def picture(self, block: Picture, label: CountedLabel) -> str:
        drawing = paragraph(_drawing(self.document, block, next(self.drawings)), properties="<w:keepNext/>")
        return drawing + paragraph(counted(label) + inline(block.caption), "Caption")

    def title_block(self, block: TitleTable) -> str:
        return title_block_xml(block)


def _drawing(document: Any, picture: Picture, number: int) -> str:
    """XML of a figure, which becomes part of the document; one larger than the page is made smaller."""
    from docx.shared import Inches

    from torsionnet.plot.drawing.save import figure_bytes

    size = given = picture.figure.get_size_inches()
    # A figure of one panel is drawn anew at another height, its letters as large as before.
    if len(picture.figure.axes) == 1 and picture.figure.get_layout_engine() is not None:
        size = np.minimum(given, (given[0], ONE_PANEL_HEIGHT))
    picture.figure.set_size_inches(*size)
    data = figure_bytes(picture.figure, "png", FIGURE_DPI)
    picture.figure.set_size_inches(*given)
    scale = min(1.0, *(most / length for most, length in zip(LARGEST_FIGURE, size, strict=True)))
    shown = document.part.new_pic_inline(io.BytesIO(data), *(Inches(float(length) * scale) for length in size))
    shown.docPr.set("id", str(number))
    shown.docPr.set("name", without_controls(picture.name))
    shown.docPr.set("descr", without_controls(picture.alt))
    return f"<w:r><w:drawing>{shown.xml}</w:drawing></w:r>"

"""Word document with page, styles and numbered headings, into which a report is written, and its bytes."""

from __future__ import annotations

import datetime as dt
import io
import zipfile
from typing import TYPE_CHECKING, Any

from torsionnet.core.errors import MissingExtraError
from torsionnet.report.document_tree import Report
from torsionnet.report.template_folder import TemplateFolder
from torsionnet.report.writers.docx_table import TEXT_WIDTH
from torsionnet.report.writers.docx_text import paragraph, run

if TYPE_CHECKING:
    from docx.document import Document

FONT = "Arial"
"""Font of the texts, which Word has and other programs replace by one of the same widths."""
HEADING_SIZES = {"Heading 1": 13, "Heading 2": 11, "Heading 3": 10, "Heading 4": 10}
"""Size of headings in points by the name of their style."""
HEADING_GAPS = (("Heading 1", 14, 4), ("Heading 2", 10, 3), ("Heading 3", 8, 2), ("Heading 4", 6, 2))
"""Name of the style of headings with the room above and below in points."""
HEADING_LIST = 90
"""Number of the list that counts the headings, above those of the document's other lists."""
UNDATED = dt.datetime(2000, 1, 1)  # noqa: DTZ001  (a file says no time zone)
"""Time that a document says it was made at, where the report has no date."""
ZIP_DATE = (1980, 1, 1, 0, 0, 0)
"""Date of the files inside the document, the earliest that a zip file can hold, so that equal reports have equal bytes."""
LOGOS = ("logo.png", "logo.jpg", "logo.jpeg")
"""Names of the image of a template folder that stands at the head of the pages, the first that is there."""
LOGO_HEIGHT = 12
"""Height of the logo in mm."""


def empty_document(report: Report) -> Document:
    """Word document without content, with the page, styles and properties of a report.

    Raises
    ------
    MissingExtraError
        python-docx is not installed.
    """
    try:
        import docx
    except ImportError:
        raise MissingExtraError(
            'Word files need the package python-docx: pip install "torsionnet[docx]" (or write -o report.html)'
        ) from None
    document = docx.Document()
    template = report.template or TemplateFolder()
    _set_page(document, report, template)
    _set_styles(document, template.language)
    _number_headings(document)
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


def _set_styles(document: Any, language: str) -> None:
    from docx.enum.style import WD_STYLE_TYPE
    from docx.oxml.ns import qn
    from docx.oxml.parser import parse_xml
    from docx.shared import Pt, RGBColor

    styles = document.styles
    for lang in styles.element.iter(qn("w:lang")):
        lang.set(qn("w:val"), language)
    ink = RGBColor(0x1D, 0x21, 0x26)
    sizes = {"Normal": 10, "Title": 18, "Subtitle": 9, "Caption": 9, "Footer": 8, **HEADING_SIZES}
    for name, size in sizes.items():
        style = styles[name]
        _set_font(style, FONT)
        style.font.size, style.font.color.rgb = Pt(size), ink
        style.font.bold, style.font.italic = name.startswith(("Heading", "Title")), False
        for spread in list(style.element.iter(qn("w:spacing"), qn("w:pBdr"))):
            spread.getparent().remove(spread)  # letters apart and lines below, as the styles of Word have
    styles["Subtitle"].font.color.rgb = styles["Footer"].font.color.rgb = RGBColor(0x5B, 0x64, 0x70)
    for name, base, size, gap in (
        ("Table Text", "Normal", 8.5, 1),
        ("Table Note", "Normal", 7.5, 3),
        ("Contents Heading", "Normal", 11, 3),
        ("Remark", "Normal", 10, 5),
        ("Equation", "Normal", 10, 6),
    ):
        style = styles.add_style(name, WD_STYLE_TYPE.PARAGRAPH)
        style.base_style, style.font.size = styles[base], Pt(size)
        style.paragraph_format.space_before, style.paragraph_format.space_after = Pt(gap if size != 8.5 else 1), Pt(gap)
    for name, before, after in (
        ("Normal", 0, 5),
        ("Caption", 8, 3),
        ("Title", 0, 6),
        ("Subtitle", 0, 2),
        *HEADING_GAPS,
    ):
        form = styles[name].paragraph_format
        form.space_before, form.space_after, form.line_spacing = Pt(before), Pt(after), 1.0
    styles["Contents Heading"].font.bold = True
    code = styles.add_style("Code Text", WD_STYLE_TYPE.CHARACTER)
    _set_font(code, "Courier New")
    look = styles["Remark"].element.get_or_add_pPr()
    line = '<w:pBdr><w:left w:val="single" w:sz="18" w:space="6" w:color="0B5394"/></w:pBdr>'
    for text in (line, '<w:shd w:val="clear" w:color="auto" w:fill="F3F5F7"/>'):
        look.insert_element_before(parse_xml(with_names(text)), "w:spacing")


def _set_font(style: Any, name: str) -> None:
    """Set the font of a style for all scripts, in place of those of the theme."""
    from docx.oxml.ns import qn

    fonts = style.element.get_or_add_rPr().get_or_add_rFonts()
    fonts.attrib.clear()
    for script in ("ascii", "hAnsi", "cs", "eastAsia"):
        fonts.set(qn(f"w:{script}"), name)


def _number_headings(document: Any) -> None:
    """Let the headings of all levels be counted by one list, as 2.1."""
    from docx.oxml.parser import parse_xml

    levels = "".join(
        f'<w:lvl w:ilvl="{level}"><w:start w:val="1"/><w:numFmt w:val="decimal"/><w:pStyle w:val="Heading{level + 1}"/>'
        f'<w:suff w:val="space"/><w:lvlText w:val="{".".join(f"%{i + 1}" for i in range(level + 1))}"/>'
        '<w:lvlJc w:val="left"/><w:pPr><w:ind w:left="0" w:firstLine="0"/></w:pPr></w:lvl>'
        for level in range(len(HEADING_SIZES))
    )
    kind = f'<w:abstractNum w:abstractNumId="{HEADING_LIST}"><w:multiLevelType w:val="multilevel"/>{levels}</w:abstractNum>'
    lists = document.part.numbering_part.element
    lists.insert(0, parse_xml(with_names(kind)))
    used = f'<w:num w:numId="{HEADING_LIST}"><w:abstractNumId w:val="{HEADING_LIST}"/></w:num>'
    lists.append(parse_xml(with_names(used)))
    for level, name in enumerate(HEADING_SIZES):
        counted = document.styles[name].element.get_or_add_pPr().get_or_add_numPr()
        counted.get_or_add_ilvl().val, counted.get_or_add_numId().val = level, HEADING_LIST


def _set_properties(document: Any, report: Report) -> None:
    made = dt.datetime.fromisoformat(report.date) if report.date else UNDATED
    about = document.core_properties
    about.title, about.subject, about.author = report.title[:255], report.subtitle[:255], report.author[:255]
    about.last_modified_by, about.comments, about.keywords = report.author[:255], "", ""
    about.created = about.modified = made
    about.revision = 1
    package = document.part.package
    for name in [name for name, one in package.rels.items() if one.reltype.endswith("/thumbnail")]:
        del package.rels[name]


def with_names(xml: str) -> str:
    """XML of one element with the namespaces of Word documents declared."""
    from docx.oxml.ns import nsdecls

    end = min(place for place in (xml.find(" "), xml.find(">"), xml.find("/>")) if place > 0)
    math = 'xmlns:m="http://schemas.openxmlformats.org/officeDocument/2006/math"'
    return f"{xml[:end]} {nsdecls('w', 'r', 'wp', 'a', 'pic')} {math}{xml[end:]}"


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

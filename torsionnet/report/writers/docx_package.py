"""Word document with its page and properties, into which a report is written, and its bytes."""

from __future__ import annotations

import datetime as dt
import io
import zipfile
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import MissingExtraError
from torsionnet.report.document_tree import Report
from torsionnet.report.template_folder import TemplateFolder
from torsionnet.report.writers.docx_styles import number_headings, set_styles, with_names
from torsionnet.report.writers.docx_table import TEXT_WIDTH
from torsionnet.report.writers.docx_text import paragraph, run
from torsionnet.report.writers.html_text import without_controls

if TYPE_CHECKING:
    from docx.document import Document

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
    for name in [name for name, one in package.rels.items() if one.reltype.endswith("/thumbnail")]:
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

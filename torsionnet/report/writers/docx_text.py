"""XML of paragraphs, texts and numbers in a Word document.

Every text passes :func:`~torsionnet.report.writers.html_text.escaped`; nothing else reaches the document.
"""

from __future__ import annotations

import re

from torsionnet.report.document_tree import BreakableMath, Cell, Code, Inline, Math, NumberText, Strong, inlines
from torsionnet.report.writers.docx_math import omml
from torsionnet.report.writers.html_text import escaped

FIGURE_SPACE, POINT_SPACE = "\u2007", "\u2008"
"""Blanks as wide as a digit and as a decimal point, which put the points of a column below each other."""
LONGEST_WORD = 20
"""Largest number of letters of a word that stays in one piece; a longer one may break after its signs."""


def run(text: str, *, properties: str = "") -> str:
    """Run of text with the same look, which ``properties`` (XML) gives.

    >>> run("A & B")
    '<w:r><w:t xml:space="preserve">A &amp; B</w:t></w:r>'
    """
    look = f"<w:rPr>{properties}</w:rPr>" if properties else ""
    return f'<w:r>{look}<w:t xml:space="preserve">{escaped(text)}</w:t></w:r>' if text else ""


def inline(cell: Cell, *, bold: bool = False, breaks: bool = False) -> str:
    """XML of a cell, caption or paragraph of a report; with ``breaks`` long words may break after their signs."""
    return "".join(_part(part, bold=bold, breaks=breaks) for part in inlines(cell))


def _part(part: Inline, *, bold: bool, breaks: bool) -> str:
    look = "<w:b/>" if bold else ""
    match part:
        case Math(latex):
            return omml(latex)
        case BreakableMath(parts):
            return omml(" ".join(parts))
        case Strong(text):
            return run(text, properties="<w:b/>")
        case Code(text):
            return run(_breakable(text) if breaks else text, properties='<w:rStyle w:val="CodeText"/>' + look)
        case NumberText():
            return number(part, bold=bold)
    return run(_breakable(part) if breaks else part, properties=look)


def _breakable(text: str) -> str:
    words = (
        re.sub(r"(?<=[=,/_+])(?=.)", "\u200b", word) if len(word) > LONGEST_WORD else word for word in text.split(" ")
    )
    return " ".join(words)


def number(value: NumberText, decimals: int = 0, *, bold: bool = False) -> str:
    """XML of a number; blanks make up for the decimals that others in its column have."""
    text, look = value.mantissa.replace("-", "−"), "<w:b/>" if bold else ""
    if value.exponent is not None:
        power = str(value.exponent).replace("-", "−")
        return run(f"{text}·10", properties=look) + run(power, properties=look + '<w:vertAlign w:val="superscript"/>')
    missing = decimals - value.decimals_shown
    if missing > 0 and text[-1:].isdigit():
        text += ("" if value.decimals_shown else POINT_SPACE) + FIGURE_SPACE * missing
    return run(text, properties=look)


def paragraph(content: str, style: str = "", *, properties: str = "") -> str:
    """Paragraph of XML content in a style of the document; ``properties`` (XML) follow the style."""
    look = (f'<w:pStyle w:val="{style}"/>' if style else "") + properties
    return f"<w:p><w:pPr>{look}</w:pPr>{content}</w:p>" if look else f"<w:p>{content}</w:p>"


def counted(word: str, number_: str, name: str) -> str:
    """Label such as ``Table 3`` in bold, whose number is a field that Word counts on if tables are added."""
    field = f'<w:fldSimple w:instr=" SEQ {name} \\* ARABIC ">{run(number_, properties="<w:b/>")}</w:fldSimple>'
    return run(f"{word} ", properties="<w:b/>") + field + run("  ")

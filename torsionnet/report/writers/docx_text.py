"""XML of paragraphs, texts and numbers in a Word document.

Every text passes :func:`~torsionnet.report.writers.html_text.escaped`; nothing else reaches the document.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from xml.etree import ElementTree as ET

from torsionnet.report.document_tree import BreakableMath, Cell, Code, Inline, Math, NumberText, Strong, inlines
from torsionnet.report.writers.html_text import escaped, mathml

# Formulas of Word documents (OMML), from the MathML of formulas that are written in LaTeX.

_SCRIPTS = {
    "msub": ("sSub", ("e", "sub")),
    "msup": ("sSup", ("e", "sup")),
    "msubsup": ("sSubSup", ("e", "sub", "sup")),
    "munder": ("limLow", ("e", "lim")),
    "mover": ("limUpp", ("e", "lim")),
    "mfrac": ("f", ("num", "den")),
}
"""Name in OMML of elements of MathML, and the names of what stands inside them in its order."""
_ACCENTS = {"˙": "\u0307", "¨": "\u0308", "^": "\u0302", "ˆ": "\u0302", "~": "\u0303", "˜": "\u0303", "¯": "\u0305"}
"""Combining character that OMML puts over a letter, by the sign above it in MathML."""
_FONT = '<w:rPr><w:rFonts w:ascii="Cambria Math" w:hAnsi="Cambria Math"/></w:rPr>'
EM_SPACE, THIN_SPACE, NOTHING = "\u2003", "\u2009", "\u200b"
"""Characters for a wide and a narrow gap in a formula, and for an empty place that Word shall not mark as missing."""


@lru_cache(maxsize=4096)
def omml(latex: str) -> str:
    r"""OMML element ``<m:oMath>`` of a formula in LaTeX.

    Examples
    --------
    >>> omml("2").replace(_FONT, "")
    '<m:oMath><m:r><m:rPr><m:sty m:val="p"/></m:rPr><m:t xml:space="preserve">2</m:t></m:r></m:oMath>'
    """
    return f"<m:oMath>{_row(ET.fromstring(mathml(latex)))}</m:oMath>"


def _row(parent: ET.Element) -> str:
    """OMML of all that stands in an element of MathML; brackets around it or around a matrix grow with it."""
    inner = list(parent)
    if len(inner) > 1 and inner[0].get("form") == "prefix" and inner[-1].get("form") == "postfix":
        return _bracketed(inner[0], "".join(map(_math_part, inner[1:-1])), inner[-1])
    parts: list[str] = []
    while inner:
        if [one.tag for one in inner[:3]] == ["mo", "mtable", "mo"]:
            parts.append(_bracketed(inner[0], _math_part(inner[1]), inner[2]))
            del inner[:3]
        else:
            parts.append(_math_part(inner.pop(0)))
    return "".join(parts)


def _bracketed(begin: ET.Element, inside: str, end: ET.Element) -> str:
    signs = "".join(
        f'<m:{key} m:val="{escaped(one.text or "")}"/>' for key, one in (("begChr", begin), ("endChr", end))
    )
    return f"<m:d><m:dPr>{signs}</m:dPr><m:e>{inside}</m:e></m:d>"


def _math_part(node: ET.Element) -> str:
    match node.tag:
        case "mi" | "mn" | "mo" | "mtext":
            return _run(node)
        case "mspace":
            return _text(EM_SPACE if float(node.get("width", "0em").removesuffix("em")) >= 1 else THIN_SPACE, "nor")
        case "mover" if (node[1].text or "") in _ACCENTS:
            sign = f'<m:accPr><m:chr m:val="{_ACCENTS[node[1].text or ""]}"/></m:accPr>'
            return f"<m:acc>{sign}{_held('e', node[0])}</m:acc>"
        case "munderover":
            under = f"<m:limLow>{_named(node[:2], ('e', 'lim'))}</m:limLow>"
            return f"<m:limUpp><m:e>{under}</m:e>{_held('lim', node[2])}</m:limUpp>"
        case "msqrt":
            return f'<m:rad><m:radPr><m:degHide m:val="1"/></m:radPr><m:deg/><m:e>{_row(node)}</m:e></m:rad>'
        case "mtable":
            return _matrix(node)
    if node.tag in _SCRIPTS:
        name, parts = _SCRIPTS[node.tag]
        return f"<m:{name}>{_named(list(node), parts)}</m:{name}>"
    return _row(node)


def _named(nodes: Sequence[ET.Element], names: Sequence[str]) -> str:
    return "".join(_held(name, node) for name, node in zip(names, nodes, strict=True))


def _held(name: str, node: ET.Element) -> str:
    return f"<m:{name}>{_math_part(node) or _text(NOTHING, 'nor')}</m:{name}>"


def _matrix(node: ET.Element) -> str:
    columns = max((len(row) for row in node), default=1)
    head = (
        '<m:mPr><m:plcHide m:val="1"/><m:mcs><m:mc><m:mcPr>'
        f'<m:count m:val="{columns}"/><m:mcJc m:val="center"/></m:mcPr></m:mc></m:mcs></m:mPr>'
    )
    rows = "".join("<m:mr>" + "".join(f"<m:e>{_row(cell)}</m:e>" for cell in row) + "</m:mr>" for row in node)
    return f"<m:m>{head}{rows}</m:m>"


def _run(node: ET.Element) -> str:
    text = node.text or ""
    upright = node.tag in ("mn", "mo") or len(text) > 1 or node.get("mathvariant") == "normal"
    return _text(text, "nor" if node.tag == "mtext" else "p" if upright else "i")


def _text(text: str, style: str) -> str:
    """OMML of a text, which is upright (p), slanted (i), or words (nor)."""
    look = "<m:nor/>" if style == "nor" else f'<m:sty m:val="{style}"/>'
    return f'<m:r><m:rPr>{look}</m:rPr>{_FONT}<m:t xml:space="preserve">{escaped(text)}</m:t></m:r>' if text else ""


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

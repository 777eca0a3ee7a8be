"""XML of paragraphs, texts and numbers in a Word document.

Every text passes :func:`~torsionnet.report.writers.html.escaped`; nothing else reaches the document.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from xml.etree import ElementTree as ET

from torsionnet.report.writers.blocks import CountedLabel
from torsionnet.report.writers.html import escaped, mathml
from torsionnet.report.writers.inline import LONGEST_WORD, InlineWriter, signed_pieces

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
BREAK = "\u200b"
"""Place in a word at which a line may end."""
BOLD, SOFT = "<w:b/>", '<w:color w:val="5B6470"/>'
"""Properties of a run in bold, and in grey."""


def run(text: str, *, properties: str = "") -> str:
    """Run of text with the same look, which ``properties`` (XML) gives.

    >>> run("A & B")
    '<w:r><w:t xml:space="preserve">A &amp; B</w:t></w:r>'
    """
    look = f"<w:rPr>{properties}</w:rPr>" if properties else ""
    return f'<w:r>{look}<w:t xml:space="preserve">{escaped(text)}</w:t></w:r>' if text else ""


class DocxInline(InlineWriter):
    """Writer of the texts, formulas and numbers inside a line of a Word document.

    With ``breaks`` long words may break after their signs.
    """

    def __init__(self, *, bold: bool = False, breaks: bool = False) -> None:
        self.look, self.breaks = BOLD if bold else "", breaks

    def text(self, text: str) -> str:
        return run(self._breakable(text), properties=self.look)

    def math(self, latex: str) -> str:
        return omml(latex)

    def terms(self, terms: tuple[str, ...]) -> str:
        return omml(" ".join(terms))

    def strong(self, text: str) -> str:
        return run(text, properties=BOLD)

    def code(self, text: str) -> str:
        return run(self._breakable(text), properties='<w:rStyle w:val="CodeText"/>' + self.look)

    def _breakable(self, text: str) -> str:
        if not self.breaks:
            return text
        words = (BREAK.join(signed_pieces(word)) if len(word) > LONGEST_WORD else word for word in text.split(" "))
        return " ".join(words)

    def digits(self, digits: str, gap: str) -> str:
        room = gap.replace(".", POINT_SPACE).replace("0", FIGURE_SPACE)
        return run(digits.replace("-", "−") + room, properties=self.look)

    def power(self, digits: str, exponent: str) -> str:
        raised = run(exponent.replace("-", "−"), properties=self.look + '<w:vertAlign w:val="superscript"/>')
        return run(f"{digits}·10".replace("-", "−"), properties=self.look) + raised


inline, bold, breaking = DocxInline(), DocxInline(bold=True), DocxInline(breaks=True)
"""Writers of plain lines, of those in bold, and of lines in which long words may break."""


def paragraph(content: str, style: str = "", *, properties: str = "") -> str:
    """Paragraph of XML content in a style of the document; ``properties`` (XML) follow the style."""
    look = (f'<w:pStyle w:val="{style}"/>' if style else "") + properties
    return f"<w:p><w:pPr>{look}</w:pPr>{content}</w:p>" if look else f"<w:p>{content}</w:p>"


def counted(label: CountedLabel) -> str:
    """Label such as ``Table 3`` in bold, whose number is a field that Word counts on if tables are added."""
    number = run(label.number, properties=BOLD)
    field = f'<w:fldSimple w:instr=" SEQ {label.kind} \\* ARABIC ">{number}</w:fldSimple>'
    return run(f"{label.word} ", properties=BOLD) + field + run("  ")

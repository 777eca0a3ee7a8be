"""Formulas of Word documents (OMML), from the MathML of formulas that are written in LaTeX."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from xml.etree import ElementTree as ET

from torsionnet.report.writers.html_text import escaped
from torsionnet.report.writers.mathml import mathml

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

"""XML of paragraphs, texts and numbers in a Word document.

Every text passes :func:`~torsionnet.report.writers.html.escaped`; nothing else reaches the document.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any
from xml.etree import ElementTree as ET

from torsionnet.report.document_tree import TableGroup, Text, TitleTable
from torsionnet.report.writers.blocks import CountedLabel
from torsionnet.report.writers.html import escaped, mathml
from torsionnet.report.writers.table_layout import (
    LONGEST_WORD,
    SIZES,
    InlineWriter,
    Piece,
    TableLayout,
    piece_letters,
    signed_pieces,
)

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
    return f"<m:oMath>{_omml_row(ET.fromstring(mathml(latex)))}</m:oMath>"


def _omml_row(parent: ET.Element) -> str:
    """OMML of all that stands in an element of MathML; brackets around it or around a matrix grow with it."""
    inner = list(parent)
    if len(inner) > 1 and inner[0].get("form") == "prefix" and inner[-1].get("form") == "postfix":
        return _bracketed(inner[0], "".join(map(_math_part, inner[1:-1])), inner[-1])
    parts: list[str] = []
    while inner:
        if [element.tag for element in inner[:3]] == ["mo", "mtable", "mo"]:
            parts.append(_bracketed(inner[0], _math_part(inner[1]), inner[2]))
            del inner[:3]
        else:
            parts.append(_math_part(inner.pop(0)))
    return "".join(parts)


def _bracketed(begin: ET.Element, inside: str, end: ET.Element) -> str:
    signs = "".join(
        f'<m:{key} m:val="{escaped(bracket.text or "")}"/>' for key, bracket in (("begChr", begin), ("endChr", end))
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
            return f'<m:rad><m:radPr><m:degHide m:val="1"/></m:radPr><m:deg/><m:e>{_omml_row(node)}</m:e></m:rad>'
        case "mtable":
            return _matrix(node)
    if node.tag in _SCRIPTS:
        name, parts = _SCRIPTS[node.tag]
        return f"<m:{name}>{_named(list(node), parts)}</m:{name}>"
    return _omml_row(node)


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
    rows = "".join("<m:mr>" + "".join(f"<m:e>{_omml_row(cell)}</m:e>" for cell in row) + "</m:mr>" for row in node)
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


# Tables of a Word document: those of sections, lists of facts, and the title block.

TEXT_WIDTH = 9864
"""Width of the text on a page in twentieths of a point: 174 mm of A4."""
SIGNATURE_HEIGHT = 400
"""Height of a line to sign in twentieths of a point: 7 mm, enough for a signature."""
RULES = (
    '<w:top w:val="single" w:sz="10" w:color="1D2126"/><w:bottom w:val="single" w:sz="10" w:color="1D2126"/>'
    '<w:insideH w:val="single" w:sz="4" w:color="C9CED6"/>'
)
"""Lines of a section's table: over it, under it, and between its rows."""
_SIDES = ("top", "left", "bottom", "right", "insideH", "insideV")
GRID = "".join(f'<w:{side} w:val="single" w:sz="4" w:color="5B6470"/>' for side in _SIDES)
"""Lines of the title block: around each cell."""
_KEEP = "<w:keepNext/>"
TABLE_STYLES = ("TableText", "SmallTableText", "SmallestTableText")
"""Styles of paragraphs in tables, by the sizes of letters."""


def table_xml(layout: TableLayout, caption: str, continued: str) -> str:
    """Table with caption above, head repeated on each page and notes below.

    One that is too wide for the page goes on below, where ``continued`` stands instead of the caption.
    """
    pieces = []
    for place, piece in enumerate(layout.pieces):
        above = paragraph(run(continued) if place else caption, "Caption", properties=_KEEP)
        pieces.append(above + _piece(layout, piece, layout.continued if place else layout.block.groups))
    notes = [paragraph(inline(note), "TableNote") for note in layout.block.foot_notes]
    # Two tables without a paragraph between them would be one.
    gap = paragraph("", "TableNote")
    return gap.join(pieces) + ("".join(notes) or gap)


def _piece(layout: TableLayout, piece: Piece, groups: Sequence[TableGroup]) -> str:
    letters = piece_letters(piece, layout.page_letters)
    widths = [round(TEXT_WIDTH * width / max(sum(letters), layout.page_letters)) for width in letters]
    style = TABLE_STYLES[SIZES.index(layout.size)]
    head = [
        "".join(_line(bold(line), style, right=placed.numeric, keep=True) for line in placed.lines) for placed in piece
    ]
    rows, kept = [table_row(head, widths, head=True)], layout.rows_kept
    for group in groups:
        rows += _group(group, piece, widths, kept, style)
    return _table(rows, widths, RULES)


def _group(group: TableGroup, piece: Piece, widths: Sequence[int], kept: Iterator[bool], style: str) -> list[str]:
    """Rows of a group, its title first; ``kept``: whether each of the rows stays with the next one."""
    rows = []
    if group.title:
        rows.append(table_row([_line(bold(group.title), style, keep=True)], [sum(widths)], spans=[len(widths)]))
    for row, stays in zip(group.rows, kept, strict=False):
        cells = [
            _line(breaking.cell(row[placed.index], placed.column.decimals), style, right=placed.numeric, keep=stays)
            for placed in piece
        ]
        rows.append(table_row(cells, widths))
    return rows


def facts_xml(facts: Sequence[tuple[str, Text]]) -> str:
    """List of terms with what is said on each, as a table without lines."""
    if not facts:
        return ""
    widths = [TEXT_WIDTH // 5, TEXT_WIDTH - TEXT_WIDTH // 5]
    rows = [table_row([_line(run(word, properties=SOFT)), _line(inline(text))], widths) for word, text in facts]
    return _table(rows, widths, "") + paragraph("", "TableNote")


def title_block_xml(block: TitleTable) -> str:
    """Title block with its fields, its revisions and the lines to sign; blank cells are left to be filled in."""
    fields = _shares(17, 33, 17, 33)
    rows = []
    for row in block.rows:
        cells = [_line(part) for label, text in row for part in (run(label, properties=SOFT), breaking(text))]
        # A field alone in its row, as a long file name, takes all its width.
        whole = len(row) == 1
        rows.append(table_row(cells, [fields[0], sum(fields[1:])] if whole else fields, spans=[1, 3] if whole else ()))
    revisions, lines = _shares(10, 12, 33, 15, 15, 15), _shares(17, 33, 17, 33)
    tables = [
        _table(rows, fields, GRID),
        _table(
            [_heads(block.revision_heads, revisions), *(_texts(row, revisions) for row in block.revisions)],
            revisions,
            GRID,
        ),
        _table(
            [
                _heads(block.signature_heads, lines),
                *(_texts((done, name, "", ""), lines, height=SIGNATURE_HEIGHT) for done, name in block.signatures),
            ],
            lines,
            GRID,
        ),
    ]
    gap = paragraph("", "TableNote")
    return gap.join(tables) + gap


def _shares(*percent: int) -> list[int]:
    return [TEXT_WIDTH * share // 100 for share in percent]


def _heads(texts: Sequence[str], widths: Sequence[int]) -> str:
    return table_row([_line(run(text, properties=SOFT), keep=True) for text in texts], widths, head=True)


def _texts(texts: Sequence[str], widths: Sequence[int], *, height: int = 0) -> str:
    return table_row([_line(breaking(text)) for text in texts], widths, height=height)


def _line(content: str, style: str = TABLE_STYLES[0], *, right: bool = False, keep: bool = False) -> str:
    look = (_KEEP if keep else "") + ('<w:jc w:val="right"/>' if right else "")
    return paragraph(content, style, properties=look)


def table_row(
    cells: Sequence[str], widths: Sequence[int], *, head: bool = False, spans: Sequence[int] = (), height: int = 0
) -> str:
    look = "<w:cantSplit/>" + (f'<w:trHeight w:val="{height}" w:hRule="atLeast"/>' if height else "")
    parts = []
    for place, (cell, width) in enumerate(zip(cells, widths, strict=True)):
        span = f'<w:gridSpan w:val="{spans[place]}"/>' if spans and spans[place] > 1 else ""
        side = '<w:vAlign w:val="bottom"/>' if head else ""
        parts.append(f'<w:tc><w:tcPr><w:tcW w:w="{width}" w:type="dxa"/>{span}{side}</w:tcPr>{cell}</w:tc>')
    return f"<w:tr><w:trPr>{look}{'<w:tblHeader/>' if head else ''}</w:trPr>{''.join(parts)}</w:tr>"


def _table(rows: Sequence[str], widths: Sequence[int], borders: str) -> str:
    grid = "".join(f'<w:gridCol w:w="{width}"/>' for width in widths)
    margins = '<w:left w:w="60" w:type="dxa"/><w:right w:w="60" w:type="dxa"/>'
    look = (
        f'<w:tblW w:w="{sum(widths)}" w:type="dxa"/><w:tblBorders>{borders}</w:tblBorders>'
        f'<w:tblLayout w:type="fixed"/><w:tblCellMar>{margins}</w:tblCellMar>'
    )
    return f"<w:tbl><w:tblPr>{look}</w:tblPr><w:tblGrid>{grid}</w:tblGrid>{''.join(rows)}</w:tbl>"


# Styles of a Word document and the list that counts its headings.

FONT = "Arial"
"""Font of the texts, which Word has and other programs replace by one of the same widths."""
STYLES = {
    "Normal": (10, 0, 5),
    "Title": (18, 0, 6),
    "Subtitle": (9, 0, 2),
    "Caption": (9, 8, 3),
    "Footer": (8, 0, 0),
    "Heading 1": (13, 14, 4),
    "Heading 2": (11, 10, 3),
    "Heading 3": (10, 8, 2),
    "Heading 4": (10, 6, 2),
    "Table Text": (8.5, 1, 1),
    "Small Table Text": (8.5 * SIZES[1], 1, 1),
    "Smallest Table Text": (8.5 * SIZES[2], 1, 1),
    "Table Note": (7.5, 3, 3),
    "Contents Heading": (11, 3, 3),
    "Remark": (10, 5, 5),
    "Equation": (10, 6, 6),
}
"""Size of the letters, and room above and below a paragraph in points, by the name of its style."""
HEADINGS = tuple(name for name in STYLES if name.startswith("Heading"))
"""Names of the styles of headings, from the highest level down."""
BOLD_STYLES = (*HEADINGS, "Title", "Contents Heading")
SOFT_STYLES = ("Subtitle", "Footer")
"""Names of the styles in bold, and of those in grey."""
INK, SOFT_INK = (0x1D, 0x21, 0x26), (0x5B, 0x64, 0x70)
"""Colours of the letters in red, green and blue: nearly black, and grey, as on the page in HTML."""
HEADING_LIST = 90
"""Number of the list that counts the headings, above those of the document's other lists."""


def set_styles(document: Any, language: str) -> None:
    """Set fonts, sizes and distances of a Word document's styles, and the language of its texts."""
    from docx.enum.style import WD_STYLE_TYPE
    from docx.oxml.ns import qn
    from docx.oxml.parser import parse_xml
    from docx.shared import Pt, RGBColor

    styles = document.styles
    for lang in styles.element.iter(qn("w:lang")):
        lang.set(qn("w:val"), language)
    known = {style.name for style in styles}
    for name, (size, before, after) in STYLES.items():
        style = styles[name] if name in known else styles.add_style(name, WD_STYLE_TYPE.PARAGRAPH)
        for spread in list(style.element.iter(qn("w:spacing"), qn("w:pBdr"))):
            spread.getparent().remove(spread)  # letters apart and lines below, as the styles of Word have
        _set_font(style, FONT)
        style.font.size, style.font.bold, style.font.italic = Pt(size), name in BOLD_STYLES, False
        style.font.color.rgb = RGBColor(*(SOFT_INK if name in SOFT_STYLES else INK))
        form = style.paragraph_format
        form.space_before, form.space_after, form.line_spacing = Pt(before), Pt(after), 1.0
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


def number_headings(document: Any) -> None:
    """Let the headings of all levels be counted by one list, as 2.1."""
    from docx.oxml.parser import parse_xml

    levels = "".join(
        f'<w:lvl w:ilvl="{level}"><w:start w:val="1"/><w:numFmt w:val="decimal"/><w:pStyle w:val="Heading{level + 1}"/>'
        f'<w:suff w:val="space"/><w:lvlText w:val="{".".join(f"%{i + 1}" for i in range(level + 1))}"/>'
        '<w:lvlJc w:val="left"/><w:pPr><w:ind w:left="0" w:firstLine="0"/></w:pPr></w:lvl>'
        for level in range(len(HEADINGS))
    )
    kind = f'<w:abstractNum w:abstractNumId="{HEADING_LIST}"><w:multiLevelType w:val="multilevel"/>'
    lists = document.part.numbering_part.element
    lists.insert(0, parse_xml(with_names(f"{kind}{levels}</w:abstractNum>")))
    used = f'<w:num w:numId="{HEADING_LIST}"><w:abstractNumId w:val="{HEADING_LIST}"/></w:num>'
    lists.append(parse_xml(with_names(used)))
    for level, name in enumerate(HEADINGS):
        counted = document.styles[name].element.get_or_add_pPr().get_or_add_numPr()
        counted.get_or_add_ilvl().val, counted.get_or_add_numId().val = level, HEADING_LIST


def with_names(xml: str) -> str:
    """XML of one element with the namespaces of Word documents declared."""
    from docx.oxml.ns import nsdecls

    end = min(place for place in (xml.find(" "), xml.find(">"), xml.find("/>")) if place > 0)
    math = 'xmlns:m="http://schemas.openxmlformats.org/officeDocument/2006/math"'
    return f"{xml[:end]} {nsdecls('w', 'r', 'wp', 'a', 'pic')} {math}{xml[end:]}"

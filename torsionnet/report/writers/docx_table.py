"""Tables of a Word document: those of sections, lists of facts, and the title block."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from torsionnet.report.document_tree import TableGroup, Text, TitleTable
from torsionnet.report.writers.docx_text import SOFT, bold, breaking, inline, paragraph, run
from torsionnet.report.writers.table_layout import SIZES, Piece, TableLayout, piece_letters

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
    rows, kept = [_row(head, widths, head=True)], layout.rows_kept
    for group in groups:
        rows += _group(group, piece, widths, kept, style)
    return _table(rows, widths, RULES)


def _group(group: TableGroup, piece: Piece, widths: Sequence[int], kept: Iterator[bool], style: str) -> list[str]:
    """Rows of a group, its title first; ``kept``: whether each of the rows stays with the next one."""
    rows = []
    if group.title:
        rows.append(_row([_line(bold(group.title), style, keep=True)], [sum(widths)], spans=[len(widths)]))
    for row, stays in zip(group.rows, kept, strict=False):
        cells = [
            _line(breaking.cell(row[placed.index], placed.column.decimals), style, right=placed.numeric, keep=stays)
            for placed in piece
        ]
        rows.append(_row(cells, widths))
    return rows


def facts_xml(facts: Sequence[tuple[str, Text]]) -> str:
    """List of terms with what is said on each, as a table without lines."""
    if not facts:
        return ""
    widths = [TEXT_WIDTH // 5, TEXT_WIDTH - TEXT_WIDTH // 5]
    rows = [_row([_line(run(word, properties=SOFT)), _line(inline(text))], widths) for word, text in facts]
    return _table(rows, widths, "") + paragraph("", "TableNote")


def title_block_xml(block: TitleTable) -> str:
    """Title block with its fields, its revisions and the lines to sign; blank cells are left to be filled in."""
    fields = _shares(17, 33, 17, 33)
    rows = []
    for row in block.rows:
        cells = [_line(one) for label, text in row for one in (run(label, properties=SOFT), breaking(text))]
        whole = len(row) == 1
        rows.append(_row(cells, [fields[0], sum(fields[1:])] if whole else fields, spans=[1, 3] if whole else ()))
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
    return _row([_line(run(text, properties=SOFT), keep=True) for text in texts], widths, head=True)


def _texts(texts: Sequence[str], widths: Sequence[int], *, height: int = 0) -> str:
    return _row([_line(breaking(text)) for text in texts], widths, height=height)


def _line(content: str, style: str = TABLE_STYLES[0], *, right: bool = False, keep: bool = False) -> str:
    look = (_KEEP if keep else "") + ('<w:jc w:val="right"/>' if right else "")
    return paragraph(content, style, properties=look)


def _row(
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

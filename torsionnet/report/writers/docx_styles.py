"""Styles of a Word document and the list that counts its headings."""

from __future__ import annotations

from typing import Any

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

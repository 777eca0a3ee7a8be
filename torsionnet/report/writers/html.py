"""Writing of a report as one HTML page that holds all its pictures and formulas.

Every text passes :func:`escaped`; nothing else reaches the page.
"""

from __future__ import annotations

import base64
import html
import re
import unicodedata
from collections.abc import Sequence
from functools import cache, lru_cache
from pathlib import Path

from torsionnet.base.atomic import write_text
from torsionnet.base.errors import MissingExtraError
from torsionnet.report.document_tree import (
    BreakableMath,
    Cell,
    Details,
    Heading,
    Picture,
    Report,
    Section,
    TableGroup,
    Text,
    TitleTable,
)
from torsionnet.report.writers.blocks import CountedLabel
from torsionnet.report.writers.table_layout import InlineWriter, Piece, PlacedColumn, TableLayout
from torsionnet.report.writers.templating import SHIPPED, PageWriter

MEDIA_TYPES = {".svg": "image/svg+xml", ".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
"""Media type of an image by the ending of its file."""


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write a report as an HTML page and return its path."""
    write_text(path, html_page(report))
    return (path,)


def html_page(report: Report, *, folds: bool = True) -> str:
    """Text of the HTML page of a report; a page for printing has ``folds=False``, so that nothing is folded away."""
    return HtmlWriter(report, folds=folds).page()


# MathML of formulas that are written in LaTeX.

LOW = 1.3
"""Width over height from which a figure is printed no higher than two fifths of a page."""
FORMULA_FONT = "formulas.woff"
"""Name of the font of formulas, whose brackets grow with what they hold: many systems have none of this kind."""
_MATHRM = re.compile(r"\\mathrm\{([^{}\\]{2,})\}")
_DOTTED = re.compile(r"<mover>(<mrow>(?:(?!<mover>).)*?</mrow><mo>&#x00(?:2D9|0A8);</mo></mover>)")


@lru_cache(maxsize=4096)
def mathml(latex: str, *, block: bool = False) -> str:
    r"""MathML element ``<math>`` of a formula in LaTeX.

    Raises
    ------
    MissingExtraError
        latex2mathml is not installed.

    Examples
    --------
    >>> mathml(r"k_{1}")
    '<math><mrow><msub><mi>k</mi><mrow><mn>1</mn></mrow></msub></mrow></math>'
    """
    try:
        from latex2mathml.converter import convert
    except ImportError:
        raise MissingExtraError(
            "formulas in HTML and PDF need latex2mathml: pip install latex2mathml (or write -o report.md, report.tex)"
        ) from None
    whole = _MATHRM.sub(lambda match: rf"\text{{{match[1].replace('~', ' ')}}}", latex)  # one word, not its letters
    text = convert(whole, display="block" if block else "inline")
    text = _DOTTED.sub(r'<mover accent="true">\1', text)  # dots in the size of the letter, close above it
    text = re.sub(r'<math xmlns="[^"]*" display="(\w+)">', r'<math display="\1">', text)
    return text.replace(' display="inline"', "").replace(' stretchy="true" fence="true"', "")


@cache
def font_face() -> str:
    """Rule of a style sheet that holds the font of formulas."""
    font = base64.b64encode((SHIPPED / FORMULA_FONT).read_bytes()).decode()
    return f'@font-face{{font-family:"Report Formulas";src:url(data:font/woff;base64,{font}) format("woff")}}\n'


def escaped(text: str) -> str:
    """Text with the characters of HTML markup escaped, and control characters replaced.

    >>> escaped('<b>A & "B"</b>')
    '&lt;b&gt;A &amp; &quot;B&quot;&lt;/b&gt;'
    """
    return html.escape(without_controls(text))


def without_controls(text: str) -> str:
    """Text with its control characters replaced, which neither a page nor XML can hold."""
    return "".join("\N{REPLACEMENT CHARACTER}" if _is_control(char) else char for char in text)


def _is_control(char: str) -> bool:
    return (unicodedata.category(char) in ("Cc", "Cs") and char not in "\n\t") or char in "\ufffe\uffff"


class HtmlInline(InlineWriter):
    """Writer of the texts, formulas and numbers inside a line of an HTML page."""

    def text(self, text: str) -> str:
        return escaped(text)

    def math(self, latex: str) -> str:
        return mathml(latex)

    def terms(self, terms: tuple[str, ...]) -> str:
        # A leading sign stands between two terms, and keeps its distance from both.
        infix = (("<mo>", "<mo form=infix>", 1) if term[:1] in ("+", "-", "=") else ("", "", 0) for term in terms)
        return " ".join(mathml(term).replace(*sign) for term, sign in zip(terms, infix, strict=True))

    def strong(self, text: str) -> str:
        return f"<strong>{escaped(text)}</strong>"

    def code(self, text: str) -> str:
        return f"<code>{escaped(text)}</code>"

    def digits(self, digits: str, gap: str) -> str:
        text = digits.replace("-", "−")
        return f'{text}<span class="pad" aria-hidden="true">{gap}</span>' if gap else text

    def power(self, digits: str, exponent: str) -> str:
        return f"{digits}·10<sup>{exponent}</sup>".replace("-", "−")


class HtmlWriter(PageWriter):
    """Writer of a report as an HTML page."""

    ending = ".html"
    images = tuple(MEDIA_TYPES)
    inline = HtmlInline()

    def __init__(self, report: Report, *, folds: bool) -> None:
        super().__init__(report)
        self.folds = folds

    def page(self) -> str:
        """Text of the whole report, with the font of formulas where it has any."""
        text = super().page()
        return text.replace("<style>\n", f"<style>\n{font_face()}", 1) if "<math" in text else text

    def image(self, name: str, data: bytes) -> str:
        return f"data:{MEDIA_TYPES[Path(name).suffix.lower()]};base64,{base64.b64encode(data).decode()}"

    def joined(self, written: Sequence[str]) -> str:
        return "".join(f"{block}\n" for block in written)

    def section(self, block: Section, heading: str, inner: str) -> str:
        return f'<section id="{escaped(block.name)}">\n{heading}{inner}</section>'

    def heading(self, block: Section, number: str, level: int) -> str:
        tag = f"h{min(level + 2, 6)}"
        return f"<{tag}><span class=no>{number}</span> {self.inline(block.title)}</{tag}>\n"

    def paragraph(self, text: Text) -> str:
        return f"<p>{self.inline(text)}</p>"

    def listing(self, items: Sequence[Text]) -> str:
        return f"<ul>{''.join(f'<li>{self.inline(item)}</li>' for item in items)}</ul>"

    def facts(self, rows: Sequence[tuple[str, Text]]) -> str:
        return f"<dl>{''.join(f'<dt>{escaped(word)}</dt><dd>{self.inline(text)}</dd>' for word, text in rows)}</dl>"

    def remark(self, kind: str, word: str, text: Text) -> str:
        return f"<p class='remark {kind}'><b>{escaped(word)}:</b> {self.inline(text)}</p>"

    def formula(self, latex: str, number: str) -> str:
        return f"<div class=formula><div class=scroll>{mathml(latex, block=True)}</div><span>({number})</span></div>"

    def equations(self, rows: Sequence[BreakableMath]) -> str:
        return "".join(f"<p class=equation>{self.inline(row)}</p>" for row in rows)

    def details(self, block: Details) -> str:
        if not (self.folds and block.blocks):
            return super().details(block)
        return f"<details><summary>{self.inline(block.title)}</summary>\n{self.folded(block)}</details>"

    def picture(self, block: Picture, label: CountedLabel) -> str:
        from torsionnet.plot.drawing.save import inline_svg

        svg = inline_svg(block.figure, f"f{label.number}-")
        drawing = svg.replace("<svg ", f'<svg role=img aria-label="{escaped(block.alt)}" ', 1)
        caption = f"<figcaption><b>{escaped(str(label))}</b> {self.inline(block.caption)}</figcaption>"
        # In print a figure that is wider than high may be a little smaller, so that pages are filled.
        width, height = block.figure.get_size_inches()
        kind = " class=low" if width > LOW * height else ""
        return f"<figure{kind}><div class=scroll>{drawing}</div>{caption}</figure>"

    def table(self, layout: TableLayout, label: CountedLabel) -> str:
        # On a screen a wide table scrolls; on paper it goes on below, as in the other formats.
        whole = (tuple(PlacedColumn(index, column, None, ()) for index, column in enumerate(layout.columns)),)
        pieces = whole if self.folds else layout.pieces
        name = f"table-{label.number.lower()}"
        caption = f"<p class=caption id={name}><b>{escaped(str(label))}</b> {self.inline(layout.block.caption)}</p>"
        # A page may end between the parts of a short table, and within its notes.
        part = f"<div{' class=keep' if layout.stays_whole else ''}>"
        parts = [f"{part}{caption}{self._columns_in_box(pieces[0], layout.block.groups, name)}</div>"]
        for place, piece in enumerate(pieces[1:], 2):
            above = f"<p class=caption id={name}-{place}>{escaped(self.word('(continued)'))}</p>"
            parts.append(f"{part}{above}{self._columns_in_box(piece, layout.continued, f'{name}-{place}')}</div>")
        notes = "".join(f"<p class=note>{self.inline(note)}</p>" for note in layout.block.foot_notes)
        size = f" style=--size:{layout.size:g}" if layout.size < 1 else ""
        return f"<div class=table{size}>{''.join(parts)}{notes}</div>"

    def _columns_in_box(self, piece: Piece, groups: Sequence[TableGroup], name: str) -> str:
        """Columns of a table, all or those of a piece, in a box that scrolls where the screen is narrow."""
        headings = [placed.column.heading for placed in piece]
        head = "".join(f"<th{_class(heading)} scope=col>{self._heading(heading)}</th>" for heading in headings)
        body = "".join(self._group(group, piece) for group in groups)
        return (
            f"<div class=scroll tabindex=0 role=region aria-labelledby={name}>"
            f"<table aria-labelledby={name}><thead><tr>{head}</tr></thead>{body}</table></div>"
        )

    def _heading(self, column: Heading) -> str:
        unit = f" <span class=unit>{escaped(column.unit)}</span>" if column.bracket else ""
        return f"{self.inline(column.text)}{unit}"

    def _group(self, group: TableGroup, piece: Piece) -> str:
        title = f"<tr class=group><th colspan={len(piece)} scope=rowgroup>{self.inline(group.title)}</th></tr>"
        return f"<tbody>{title if group.title else ''}{''.join(self._row(row, piece) for row in group.rows)}</tbody>\n"

    def _row(self, row: tuple[Cell, ...], piece: Piece) -> str:
        cells = "".join(
            f"<td{_class(placed.column.heading)}>{self.inline.cell(row[placed.index], placed.column.decimals)}</td>"
            for placed in piece
        )
        # A row that continues what the row above is about has no line over it.
        return f"<tr{' class=on' if row and row[0] == '' else ''}>{cells}</tr>"

    def title_block(self, block: TitleTable) -> str:
        def cells(texts: Sequence[str], tag: str = "td") -> str:
            return "".join(f"<{tag}>{escaped(text)}</{tag.partition(' ')[0]}>" for text in texts)

        fields = "".join(
            f"<tr>{''.join(cells([label], 'th scope=row') + cells([text], _wide(row)) for label, text in row)}</tr>\n"
            for row in block.rows
        )
        revisions = "".join(f"<tr>{cells(row)}</tr>\n" for row in block.revisions)
        lines = "".join(
            f"<tr>{cells([done], 'th scope=row')}{cells([name, '', ''])}</tr>\n" for done, name in block.signatures
        )
        widths = "<colgroup><col class=label><col><col class=label><col></colgroup>"
        heads = [cells(texts, "th scope=col") for texts in (block.revision_heads, block.signature_heads)]
        return (
            f"<div class=titleblock>\n<table>{widths}<tbody>\n{fields}</tbody></table>\n"
            f"<table class=revisions><thead><tr>{heads[0]}</tr></thead><tbody>\n{revisions}</tbody></table>\n"
            f"<table class=signatures><thead><tr>{heads[1]}</tr></thead><tbody>\n{lines}</tbody></table>\n</div>\n"
        )


def _wide(row: Sequence[object]) -> str:
    """Tag of a field of the title block, which takes the whole row where it is the only one."""
    return "td colspan=3" if len(row) == 1 else "td"


def _class(column: Heading) -> str:
    return " class=num" if column.numeric else " class=wide" if column.wide else ""

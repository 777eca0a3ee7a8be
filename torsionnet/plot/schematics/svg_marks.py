"""Strokes and labels of a schematic as SVG text, with classes and colours for light and dark pages."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import groupby
from xml.sax.saxutils import escape

from torsionnet.plot.drawing.palette import INK, PAPER
from torsionnet.plot.drawing.pieces import ROLES, Label, Stroke, is_math
from torsionnet.plot.drawing.symbol_runs import INDEX_SIZE, symbol_runs
from torsionnet.plot.schematics.outlines import BODY, BOX, WHEEL
from torsionnet.plot.schematics.pens import DASHES, PENS, is_behind

FILLS = {BODY: "body", WHEEL: "wheel", BOX: "box", PAPER: "paper", "#d9d9d9": "pad", INK: "ink"}
"""Names of the colours with which symbols are filled, by the colour on white paper."""

INDEX_DROP = 0.16
"""Distance by which an index stands below its symbol as a multiple of the size of the font."""
ILLEGAL = dict.fromkeys((*range(9), 11, 12, *range(14, 32), 65534, 65535, *range(55296, 57344)), "�")
"""Replacement of the characters that XML does not allow, by code."""

_MARKUP = re.compile("[&<>\"'\x00-\x1f\ud800-\udfff\ufffe\uffff]")


def number(value: float) -> str:
    """Text of a coordinate in points with six digits.

    >>> number(12.0), number(-123.4567)
    ('12', '-123.457')
    """
    return f"{value:.6g}"


def content_text(text: str) -> str:
    """Text as content of an XML element, with replacements for what XML does not allow."""
    return escape(text.translate(ILLEGAL)) if _MARKUP.search(text) else text


def attribute_text(text: str) -> str:
    """Text as value of an XML attribute between double quotes."""
    if not _MARKUP.search(text):
        return text
    quoted = escape(text.translate(ILLEGAL), {'"': "&quot;", "'": "&#39;"})
    return quoted.replace("\n", "&#10;").replace("\t", "&#9;").replace("\r", "&#13;")


def strokes_svg(strokes: Iterable[Stroke]) -> str:
    """Text of strokes as paths, those that lie behind the symbols first; strokes of one look become one path."""
    ordered = sorted(strokes, key=lambda one: not is_behind(one))
    found = []
    for (look, fill), some in groupby(ordered, lambda one: (one.look, one.fill)):
        if fill:  # each of them covers what lies behind it
            found += [_path(_outline(one), look, fill) for one in some]
        else:
            found.append(_path("".join(map(_outline, some)), look, fill))
    return "".join(found)


def _outline(stroke: Stroke) -> str:
    points = " ".join([f"{x:.6g},{-y:.6g}" for x, y in stroke.points])
    return f"M{points}{'Z' if stroke.closed else ''}"


def _path(outline: str, look: str, fill: str) -> str:
    color, width = PENS[look]
    words, more = f"pen-{look}", ""
    if color != INK:
        more += f' stroke="{_pen_color(look)}"'
    if width != PENS["part"][1]:
        more += f' stroke-width="{number(width)}"'
    if look in DASHES:
        more += f' stroke-dasharray="{" ".join(number(width * one) for one in DASHES[look])}"'
    if fill:
        words += f" fill-{FILLS.get(fill, fill)}"
        more += f' fill="{_fill_color(fill)}"'
    return f'<path class="{words}"{more} d="{outline}"/>'


def _pen_color(look: str) -> str:
    color, _ = PENS[look]
    name = {"wire": "muted", "carrier": "muted", "housing": "muted", "leader": "input", "blank": "paper"}.get(
        look, look
    )
    return f"var(--schematic-{name}, {color})"


def _fill_color(fill: str) -> str:
    if fill in PENS:
        return "currentColor" if PENS[fill][0] == INK else _pen_color(fill)
    name = FILLS.get(fill)
    if name == "ink":
        return "currentColor"
    return f"var(--schematic-{name}, {fill})" if name else fill


def labels_svg(labels: Iterable[Label]) -> str:
    """Text of labels as SVG texts, an index as a smaller text that stands lower."""
    return "".join(map(_label, labels))


def _label(label: Label) -> str:
    role = ROLES[label.role]
    color = {"input": "input", "sensor": "sensor"}.get(label.role, "muted")
    fill = "currentColor" if role.color == INK else f"var(--schematic-{color}, {role.color})"
    more = ' text-anchor="start"' if label.left else ""
    more += ' font-style="italic"' if role.italic else ""
    more += ' font-weight="bold"' if role.bold else ""
    content = _runs(label.text, role.size) if is_math(label.text, label.role) else content_text(label.text)
    return (
        f'<text class="text-{label.role}" x="{number(label.x)}" y="{number(-label.y)}" font-size="{number(role.size)}" '
        f'stroke="none" fill="{fill}"{more}>{content}</text>'
    )


def _runs(text: str, size: float) -> str:
    found, low = "", False
    for run in symbol_runs(text):
        is_index = run.style == "index"
        more = f' font-size="{number(INDEX_SIZE * size)}"' if is_index else ""
        more += ' font-style="italic"' if run.is_italic else ""
        if is_index != low:
            more += f' dy="{number(INDEX_DROP * size if is_index else -INDEX_DROP * size)}"'
        low = is_index
        content = content_text(run.text)
        found += f"<tspan{more}>{content}</tspan>" if more else content
    return found

"""Schematic of a drivetrain as SVG text, with a group for each element and node, in the layout of the reports."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import groupby
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape

from torsionnet.model.elements import GROUND, Element
from torsionnet.plot.drawing.labels import value_lines
from torsionnet.plot.drawing.pieces import (
    INDEX_SIZE,
    INK,
    PAPER,
    ROLES,
    Label,
    Owner,
    Piece,
    Stroke,
    is_math,
    plain_symbols,
    symbol_runs,
)
from torsionnet.plot.schematics.arrangement import PAPER_WIDTH, arranged_drawing, framed, page_width
from torsionnet.plot.schematics.outlines import BODY, BOX, DASHES, PENS, WHEEL, is_behind
from torsionnet.plot.schematics.topology import epicyclic_sets

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


# Groups of a schematic in SVG, one for each part of a drivetrain, with ids and titles for screen readers.


@dataclass
class SvgGroup:
    """Group of a schematic in SVG with what it draws and the groups of parts that its symbol hides.

    Its kind is ``element``, ``node``, ``input`` or ``sensor``.
    """

    kind: str
    name: str
    id: str
    words: str
    """Classes of the group: its kind, and the type of an element."""
    title: str
    strokes: list[Stroke] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    hides: list[Owner] = field(default_factory=list)
    """Owners whose symbol this one is too, as the planets in the box of a planetary set."""
    within: Owner | None = None
    """Owner in whose symbol this one is hidden."""


def drawn_groups(model: Drivetrain, whole: Piece) -> dict[Owner, SvgGroup]:
    """Groups of a drawing by kind and name, nodes first so that symbols of elements lie over shafts."""
    ids: set[str] = set()
    groups = {
        Owner(kind, name): SvgGroup(kind, name, _id(kind, name, ids), words, title)
        for kind, name, words, title in _parts(model)
    }
    _hide(model, groups)
    for stroke in whole.strokes:
        if stroke.owner in groups:
            groups[stroke.owner].strokes.append(stroke)
    for label in whole.labels:
        if label.owner in groups:
            groups[label.owner].labels.append(label)
    return groups


def _parts(model: Drivetrain) -> list[tuple[str, str, str, str]]:
    """Rows (kind, name, classes, title) of all parts of a drivetrain."""
    values = model.exact_values
    return [
        *(("node", name, "node", f"node {name}") for name in model.nodes),
        *(
            ("element", name, f"element {element.kind}", _element_title(element, values))
            for name, element in model.elements.items()
        ),
        *(
            ("input", name, "input", f"input {name}: {channel.quantity} on {channel.of}")
            for name, channel in model.inputs.items()
        ),
        *(
            ("sensor", name, "sensor", f"sensor {name}: {sensor.quantity} of {sensor.of}")
            for name, sensor in model.sensors.items()
        ),
    ]


def _element_title(element: Element, values: Any) -> str:
    """Title of an element, as "shaft_1, spring, gearbox to car: k_1 = 460 N·m/rad"."""
    ends = [node for node in dict.fromkeys(element.ports.values()) if node != GROUND]
    joined = " to ".join(ends) + (" to ground" if GROUND in element.ports.values() and ends else "")
    lines = ", ".join(map(plain_symbols, value_lines(element, values)))
    return f"{element.name}, {element.kind.replace('_', ' ')}, {joined}{': ' if lines else ''}{lines}"


def _id(kind: str, name: str, taken: set[str]) -> str:
    """Id of a group, in which other characters than letters, digits, dots and lines stand as their codes."""
    plain = re.sub(r"[^A-Za-z0-9_.-]", lambda match: f"_{ord(match[0]):x}_", name)
    candidate, number = f"{kind}-{plain}", 1
    while candidate in taken:
        number += 1
        candidate = f"{kind}-{plain}-{number}"
    taken.add(candidate)
    return candidate


def _hide(model: Drivetrain, groups: dict[Owner, SvgGroup]) -> None:
    """Note which elements and nodes have no symbol of their own: those in a planetary set, nodes within an element."""
    hidden: list[tuple[Owner, Owner]] = []
    for drawn in epicyclic_sets(model):
        box = Owner("element", drawn.name)
        hidden += [(Owner("element", element.name), box) for element in drawn.elements if element.name != drawn.name]
        hidden += [(Owner("node", node), box) for node in drawn.planets]
    for name, element in model.elements.items():
        hidden += [(Owner("node", node), Owner("element", name)) for node in element.internal_nodes]
    for inner, outer in hidden:
        if inner in groups and groups[inner].within is None:
            drawn_in = outer
            while (further := groups[drawn_in].within) is not None:
                drawn_in = further
            groups[inner].within = drawn_in
            groups[drawn_in].hides.append(inner)


# Strokes and labels of a schematic as SVG text, with classes and colours for light and dark pages.

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
    ordered = sorted(strokes, key=lambda stroke: not is_behind(stroke))
    paths = []
    for (look, fill), some in groupby(ordered, lambda stroke: (stroke.look, stroke.fill)):
        if fill:  # each of them covers what lies behind it
            paths += [_path(_outline(stroke), look, fill) for stroke in some]
        else:
            paths.append(_path("".join(map(_outline, some)), look, fill))
    return "".join(paths)


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
        more += f' stroke-dasharray="{" ".join(number(width * dash) for dash in DASHES[look])}"'
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
    markup, low = "", False
    for run in symbol_runs(text):
        is_index = run.style == "index"
        more = f' font-size="{number(INDEX_SIZE * size)}"' if is_index else ""
        more += ' font-style="italic"' if run.is_italic else ""
        if is_index != low:
            more += f' dy="{number(INDEX_DROP * size if is_index else -INDEX_DROP * size)}"'
        low = is_index
        content = content_text(run.text)
        markup += f"<tspan{more}>{content}</tspan>" if more else content
    return markup


@dataclass(frozen=True)
class SchematicDrawing:
    """Schematic as SVG text with the ids of the groups of elements and nodes.

    Attributes
    ----------
    svg : str
    elements, nodes : mapping
        Name -> id of the group with its drawing; each name of the model has an id of its own.
    size : (float, float)
        Width and height in points.
    """

    svg: str
    elements: Mapping[str, str]
    nodes: Mapping[str, str]
    size: tuple[float, float]


def schematic_svg(model: Drivetrain, *, width: float = PAPER_WIDTH) -> SchematicDrawing:
    """Schematic of a drivetrain as SVG text, as a page shows it, in the layout of :func:`torsionnet.plot.schematic`.

    Texts are texts. Each element and each node is a group with an id and a title for screen readers, which says its
    type and main values. Colours are variables of CSS with those of a white page as defaults, lines have the colour of
    the text around the picture; there is no style attribute.

    Parameters
    ----------
    model : Drivetrain
        Only elements that are switched on are drawn.
    width : float, optional
        Width of a page in mm for which lines are broken, at least 100.

    Raises
    ------
    UsageError
        The page is narrower than 100 mm.

    Examples
    --------
    >>> import torsionnet as tn
    >>> drawing = schematic_svg(tn.load("amt_rig"))
    >>> drawing.nodes["hub"], 'data-node="hub"' in drawing.svg
    ('node-hub', True)
    """
    whole = arranged_drawing(model, page_width(width))
    x0, x1, y0, y1 = framed(whole.extent)
    groups = drawn_groups(model, whole)
    body = [_loose(whole), *(_group_text(group, groups) for group in groups.values() if not group.within)]
    box = " ".join(map(number, (x0, -y1, x1 - x0, y1 - y0)))
    name = attribute_text(f"schematic of {model.title}")
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="schematic" viewBox="{box}" width="{number(x1 - x0)}pt" '
        f'height="{number(y1 - y0)}pt" role="group" aria-label="{name}" fill="none" stroke="currentColor" '
        'stroke-width="1.2" stroke-linecap="round" stroke-linejoin="round" text-anchor="middle" '
        f"font-family=\"'DejaVu Sans', Verdana, sans-serif\">\n{''.join(body)}</svg>\n"
    )
    ids = {
        kind: {group.name: group.id for group in groups.values() if group.kind == kind} for kind in ("element", "node")
    }
    return SchematicDrawing(svg, ids["element"], ids["node"], (x1 - x0, y1 - y0))


def _loose(whole: Piece) -> str:
    """Text of the group of what belongs to no part of the drivetrain, as the wires of cut lines and notes."""
    strokes = [stroke for stroke in whole.strokes if stroke.owner is None]
    labels = [label for label in whole.labels if label.owner is None]
    return f'<g class="rest">{strokes_svg(strokes)}{labels_svg(labels)}</g>\n'


def _group_text(group: SvgGroup, groups: Mapping[Owner, SvgGroup]) -> str:
    """Text of a group, with the groups of parts that are drawn within it around its strokes.

    Strokes of hidden parts are those of the symbol that hides them, so that either marks the same symbol.
    """
    drawn = strokes_svg(group.strokes) + labels_svg(group.labels)
    opening = closing = ""
    for part in (group, *(groups[key] for key in group.hides)):
        text = (
            f'<g id="{attribute_text(part.id)}" class="{attribute_text(part.words)}" '
            f'data-{part.kind}="{attribute_text(part.name)}" role="img"><title>{content_text(part.title)}</title>'
        )
        opening = text + opening if part.kind == "node" else opening + text
        closing += "</g>"
    return f"{opening}{drawn}{closing}\n"

"""Schematic of a drivetrain as SVG text, with a group for each element and node, in the layout of the reports."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from torsionnet.plot.drawing.pieces import Owner, Piece
from torsionnet.plot.schematics.arrangement import PAPER_WIDTH, arranged, framed, page_width, titled
from torsionnet.plot.schematics.svg_groups import SvgGroup, drawn_groups
from torsionnet.plot.schematics.svg_marks import attribute_text, content_text, labels_svg, number, strokes_svg

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


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


def schematic_svg(model: Drivetrain, *, title: str = "", width: float = PAPER_WIDTH) -> SchematicDrawing:
    """Schematic of a drivetrain as SVG text, as a page shows it, in the layout of :func:`torsionnet.plot.schematic`.

    Texts are texts. Each element and each node is a group with an id and a title for screen readers, which says its
    type and main values. Colours are variables of CSS with those of a white page as defaults, lines have the colour of
    the text around the picture; there is no style attribute.

    Parameters
    ----------
    model : Drivetrain
        Only elements that are switched on are drawn.
    title : str, optional
        Written above the drawing; the name of the model for screen readers is there in any case.
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
    page = page_width(width)
    whole = arranged(model, page)
    x0, x1, y0, y1 = framed(titled(whole, title, page) if title else whole.extent)
    groups = drawn_groups(model, whole)
    body = [_loose(whole), *(_written(group, groups) for group in groups.values() if not group.within)]
    box = " ".join(map(number, (x0, -y1, x1 - x0, y1 - y0)))
    name = attribute_text(f"schematic of {model.title}")
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="schematic" viewBox="{box}" width="{number(x1 - x0)}pt" '
        f'height="{number(y1 - y0)}pt" role="group" aria-label="{name}" fill="none" stroke="currentColor" '
        'stroke-width="1.2" stroke-linecap="round" stroke-linejoin="round" text-anchor="middle" '
        f"font-family=\"'DejaVu Sans', Verdana, sans-serif\">\n{''.join(body)}</svg>\n"
    )
    ids = {kind: {one.name: one.id for one in groups.values() if one.kind == kind} for kind in ("element", "node")}
    return SchematicDrawing(svg, ids["element"], ids["node"], (x1 - x0, y1 - y0))


def _loose(whole: Piece) -> str:
    """Text of the group of what belongs to no part of the drivetrain, as the wires of cut lines and notes."""
    strokes = [one for one in whole.strokes if one.owner is None]
    labels = [one for one in whole.labels if one.owner is None]
    return f'<g class="rest">{strokes_svg(strokes)}{labels_svg(labels)}</g>\n'


def _written(group: SvgGroup, groups: Mapping[Owner, SvgGroup]) -> str:
    """Text of a group, with the groups of parts that are drawn within it around its strokes.

    Strokes of hidden parts are those of the symbol that hides them, so that either marks the same symbol.
    """
    drawn = strokes_svg(group.strokes) + labels_svg(group.labels)
    opening = closing = ""
    for one in (group, *(groups[key] for key in group.hides)):
        text = (
            f'<g id="{attribute_text(one.id)}" class="{attribute_text(one.words)}" '
            f'data-{one.kind}="{attribute_text(one.name)}" role="img"><title>{content_text(one.title)}</title>'
        )
        opening = text + opening if one.kind == "node" else opening + text
        closing += "</g>"
    return f"{opening}{drawn}{closing}\n"

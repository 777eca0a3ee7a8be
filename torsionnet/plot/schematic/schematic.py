"""Schematic of a drivetrain as a matplotlib figure, with its connected parts beside each other on a page."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from torsionnet.core.errors import UsageError
from torsionnet.plot.drawing.pieces import LEADING, ROLES, Box, Label, Piece, text_width
from torsionnet.plot.schematic.canvas import POINTS_PER_INCH, figure_of_drawing
from torsionnet.plot.schematic.drawing_parts import cut_heights, part_between
from torsionnet.plot.schematic.drawing_plan import MOST_NAMED_NODES
from torsionnet.plot.schematic.layout import layout_bands
from torsionnet.plot.schematic.part_boxes import with_part_boxes
from torsionnet.plot.schematic.texts import wrap_text
from torsionnet.plot.schematic.wiring import draw_loops

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

EDGE, BETWEEN, BESIDE = 10.0, 26.0, 40.0  # points: margin, gap between rows of parts, gap between parts
MILLIMETRES_PER_INCH = 25.4
PAPER_WIDTH, LEGIBLE = 170.0, 6.0
"""Text width of an A4 page in mm, and size in points of the smallest text when printed at the page's width."""

NARROWEST_PAGE = 100.0
"""Least width of a page in mm; on a narrower one single symbols with their texts would not fit."""


def schematic(
    drivetrain: Drivetrain, *, title: str | None = None, width: float = PAPER_WIDTH, boxes: bool = False
) -> Figure:
    r"""Figure of the schematic of a drivetrain, with shafts from left to right, inertias as discs, inputs and sensors.

    Shafts run from left to right in the order of the model's nodes, whose names stand above them. Inertias are discs
    whose height grows with the logarithm of the inertia; gear stages and branches go on on lines of their own, and an
    element that closes a loop is led back to its node. Curved arrows are inputs, dots and diamonds are sensors of
    motion and of torque. Lines wider than the page go on below, a branch without room begins a line of its own, with
    flags at both ends. Gears on one moving housing that make up sun, planets and ring are drawn as a planetary set.

    Parameters
    ----------
    drivetrain : Drivetrain
        Only elements that are switched on are drawn. With more than 40 nodes only the nodes are named.
    title : str, optional
        By default name and configuration of the drivetrain.
    width : float, optional
        Width of the page in mm, at least 100: lines are broken so that the smallest text has 6 points when the figure
        is printed that wide. By default the text width of an A4 page.

    boxes : bool, optional
        Draw each part that the model uses as one box; else all that is in it.

    Returns
    -------
    matplotlib.figure.Figure
        One axes without ticks; a unit is a point. Its own width is at most 7/6 of the page's.

    Raises
    ------
    UsageError
        The page is narrower than 100 mm.

    Examples
    --------
    >>> import torsionnet as tn
    >>> figure = schematic(tn.load("amt_rig"))
    >>> [text.get_text() for text in figure.axes[0].texts if "460" in text.get_text()]
    ['$k_{\\mathrm{1}}$ = 460 N·m/rad']
    """
    page = _page(width)
    whole = _arranged(with_part_boxes(drivetrain) if boxes else drivetrain, page)
    x0, x1, y0, y1 = whole.extent
    shown = drivetrain.title if title is None else title
    for line in reversed(wrap_text(shown, "title", page)):
        whole.labels.append(Label(x0, y1 + 16, line, "title", left=True))
        y1 += LEADING * ROLES["title"].size
        x1 = max(x1, x0 + text_width(line, "title"))
    y1 += 16 if shown else 0
    return figure_of_drawing(whole, _framed((x0, x1, y0, y1)))


def schematic_parts(drivetrain: Drivetrain, tallest: float, *, width: float = PAPER_WIDTH) -> tuple[Figure, ...]:
    """Figures of the parts of a drivetrain's schematic, from top to bottom, each at most ``tallest`` mm high in print.

    Parameters
    ----------
    drivetrain : Drivetrain
    tallest : float
        mm, at the size in which a part as wide as the page is printed.
    width : float, optional
        Width of the page in mm.

    Examples
    --------
    >>> import torsionnet as tn
    >>> len(schematic_parts(tn.load("wind_turbine_3mw").configured("free"), 235))
    2
    """
    whole = _arranged(drivetrain, _page(width))
    x0, x1, y0, y1 = _framed(whole.extent)
    printed = min(1.0, width / MILLIMETRES_PER_INCH * POINTS_PER_INCH / (x1 - x0))
    most = tallest / MILLIMETRES_PER_INCH * POINTS_PER_INCH / printed
    edges = [y1, *cut_heights(whole, (x0, x1, y0, y1), most), y0]
    return tuple(
        figure_of_drawing(part_between(whole, low, high), (x0, x1, low, high)) for high, low in pairwise(edges)
    )


def _framed(extent: Box) -> Box:
    x0, x1, y0, y1 = extent
    return x0 - EDGE, x1 + EDGE, y0 - EDGE, y1 + EDGE


def _page(width: float) -> float:
    """Width in points of a drawing for a page width in mm."""
    if not width >= NARROWEST_PAGE:
        raise UsageError(f"a schematic needs a page at least {NARROWEST_PAGE:g} mm wide; got {width:g}")
    smallest = min(role.size for role in ROLES.values())
    return width / MILLIMETRES_PER_INCH * POINTS_PER_INCH * smallest / LEGIBLE - 2 * EDGE


def _arranged(drivetrain: Drivetrain, page: float) -> Piece:
    """Drawing of all connected parts of a drivetrain for a page width in points, with the wires that close loops."""
    parts = []
    for bands in layout_bands(drivetrain, page):
        part = _packed(bands, page)
        draw_loops(part)
        parts.append(part)
    whole = _packed(parts, page)
    if len(drivetrain.nodes) > MOST_NAMED_NODES:
        note = f"{len(drivetrain.nodes)} nodes: elements are drawn without names and values"
        x0, _, y0, _ = whole.extent
        whole.labels.append(Label(x0, y0 - 14, note, "note", left=True))
        whole.boxes.append((x0, x0 + text_width(note, "note"), y0 - 18, y0 - 4))
    return whole


def _packed(given: Sequence[Piece], page: float) -> Piece:
    """Drawing of pieces placed from left to right and top to bottom, like words on a page ``page`` points wide."""
    whole = Piece()
    x = top = bottom = 0.0
    for block in given:
        x0, x1, y0, y1 = block.extent
        if x and x + x1 - x0 > page:
            x, top = 0.0, bottom - BETWEEN
        whole.add(block.shifted(x - x0, top - y1))
        bottom = min(bottom, top + y0 - y1)
        x += x1 - x0 + BESIDE
    return whole

"""Schematic of a drivetrain as a matplotlib figure, with its connected parts beside each other on a page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from torsionnet.plot.drawing.pieces import PAPER, ROLES, Box, Label, Piece, Stroke, is_math
from torsionnet.plot.drawing.style import bare_figure, grid_panels
from torsionnet.plot.schematics.arrangement import (
    MILLIMETRES_PER_INCH,
    PAPER_WIDTH,
    arranged_drawing,
    edges_under_title,
    framed,
    page_width,
)
from torsionnet.plot.schematics.drawing_plan import with_part_boxes
from torsionnet.plot.schematics.outlines import DASHES, PENS, POINTS_PER_INCH, is_behind

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


# Matplotlib figures of drawings made of strokes and labels, on one axes whose unit is a point of 1/72 inch.

TALLEST_FIGURE = 24.0
"""Height in inches above which a drawing is scaled down, its texts with it."""


def figure_of_drawing(block: Piece, extent: Box) -> Figure:
    """Figure of a drawing, as large as the drawing's extent, whose edges are x0, x1, y0, y1 in points.

    One axes without ticks whose unit is a point.
    """
    width, height = extent[1] - extent[0], extent[3] - extent[2]
    scale = min(1.0, TALLEST_FIGURE * POINTS_PER_INCH / height)
    figure = bare_figure(width * scale / POINTS_PER_INCH, height * scale / POINTS_PER_INCH)
    _draw_all(figure.add_axes((0.0, 0.0, 1.0, 1.0)), block, extent, scale)
    return figure


def draw_into(axes: Axes, block: Piece, extent: Box) -> None:
    """Draw strokes and labels in the middle of given axes, as large as there is room, at most in their size."""
    room, dots = axes.get_window_extent(), axes.get_figure(root=True).dpi / POINTS_PER_INCH  # type: ignore[union-attr]
    scale = min(1.0, room.width / dots / (extent[1] - extent[0]), room.height / dots / (extent[3] - extent[2]))
    (x, y), (width, height) = (
        ((extent[0] + extent[1]) / 2, (extent[2] + extent[3]) / 2),
        (room.width / dots / scale, room.height / dots / scale),
    )
    axes.set_aspect("equal")
    _draw_all(axes, block, (x - width / 2, x + width / 2, y - height / 2, y + height / 2), scale)


def _draw_all(axes: Axes, block: Piece, extent: Box, scale: float) -> None:
    axes.set_axis_off()
    axes.set_xlim(extent[0], extent[1])
    axes.set_ylim(extent[2], extent[3])
    for order, stroke in enumerate(block.strokes):
        _draw(axes, stroke, scale, order)
    for label in block.labels:
        _write(axes, label, scale)


def _draw(axes: Axes, stroke: Stroke, scale: float, order: int) -> None:
    color, width = PENS[stroke.look]
    path = Path([*stroke.points, stroke.points[0]] if stroke.closed else stroke.points, closed=stroke.closed)
    fill = PENS[stroke.fill][0] if stroke.fill in PENS else stroke.fill
    depth = 1.0 if is_behind(stroke) else 2.0
    patch = PathPatch(
        path,
        edgecolor=color,
        facecolor=fill or PAPER,
        fill=bool(fill),
        linewidth=width * scale,
        linestyle=(0, DASHES[stroke.look]) if stroke.look in DASHES else "-",
        zorder=depth + order * 1e-5,
        capstyle="round",
        joinstyle="round",
    )
    axes.add_patch(patch)


def _write(axes: Axes, label: Label, scale: float) -> None:
    role = ROLES[label.role]
    axes.text(
        label.x,
        label.y,
        label.text,
        ha="left" if label.left else "center",
        va="baseline",
        color=role.color,
        fontproperties=_font(label.role, role.size * scale),
        parse_math=is_math(label.text, label.role),
        zorder=4,
    )


def _font(role: str, size: float) -> FontProperties:
    """Font of matplotlib for the texts of a role, a name in ``ROLES``, in a size in points."""
    look = ROLES[role]
    return FontProperties(
        family="DejaVu Sans",
        size=size,
        style="italic" if look.italic else "normal",
        weight="bold" if look.bold else "normal",
    )


# Parts of a drawing that is too tall for a page, cut where no symbol and no text stands.

LEAST_SHARE = 0.5
"""Least height of a part as a share of that of even parts: a lower one would be a strip without sense of its own."""
STEP = 2.0
"""Distance in points between the heights that are tried for a cut, less than the gap between two symbols."""
EDGE = 4.0
"""Room in points between a cut and what stands beside it."""
OVERSIZE = 1.5
"""Height of a part, as a multiple of the tallest one wanted, up to which fewer cut lines count more than the height."""
LINE_THICKNESS = 6.0
"""Height in points that a level line occupies among the wires of a drawing."""


def cut_heights(block: Piece, extent: Box, tallest: float) -> list[float]:
    """List of the y in points, from the top, at which a drawing is cut into parts of at most ``tallest`` points.

    A cut meets upright lines only, as few as can be; for that a part may be half as tall again, or more where there is
    no place for a cut.

    Parameters
    ----------
    block : Piece
    extent : tuple of float
        Edges x0, x1, y0, y1 of the drawing.
    tallest : float

    Examples
    --------
    >>> discs = Piece(boxes=[(0, 10, 0, 80), (0, 10, 120, 200)])
    >>> cut_heights(discs, (0, 10, 0, 200), 150)
    [100.0]
    """
    _, _, bottom, top = extent
    level = [wire for wire in block.wires if wire[3] - wire[2] <= LINE_THICKNESS + STEP]
    upright = [wire for wire in block.wires if wire[3] - wire[2] > LINE_THICKNESS + STEP]
    cuts: list[float] = []
    while top - bottom > tallest:
        even = (top - bottom) / math.ceil((top - bottom) / tallest)
        solid, least = [*block.boxes, *level], top - LEAST_SHARE * even
        cut = _best_cut(solid, upright, (top - OVERSIZE * tallest, least), top - even)
        if cut is None:
            cut = _best_cut(solid, [], (bottom + LEAST_SHARE * even, least), top - tallest)
        if cut is None:
            break
        cuts.append(cut)
        top = cut
    return cuts


def _best_cut(solid: Sequence[Box], upright: Sequence[Box], span: tuple[float, float], wanted: float) -> float | None:
    """Height in a span where nothing solid stands, with the fewest lines across and nearest to the one wanted."""
    low, high = span
    count = int((high - low) / STEP) + 1
    tried = sorted((low + number * STEP for number in range(count)), key=lambda y: abs(y - wanted))
    free = [y for y in [wanted, *tried] if not _crossed(solid, y, EDGE)]
    return min(free, key=lambda y: max(len(_crossed(upright, y, 0.0)), 1), default=None)  # one: the line goes on below


def _crossed(boxes: Iterable[Box], y: float, room: float) -> list[Box]:
    return [box for box in boxes if box[2] - room < y < box[3] + room]


def part_between(block: Piece, low: float, high: float) -> Piece:
    """Part of a drawing between two heights in points: the strokes that reach into it, and the labels inside of it."""
    strokes = [
        stroke
        for stroke in block.strokes
        if max(y for _, y in stroke.points) > low and min(y for _, y in stroke.points) < high
    ]
    return Piece(strokes, [label for label in block.labels if low <= label.y <= high])


def schematic(
    drivetrain: Drivetrain,
    *,
    title: str | None = None,
    width: float = PAPER_WIDTH,
    boxes: bool = False,
    ax: Axes | None = None,
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
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

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
    page = page_width(width)
    whole = arranged_drawing(with_part_boxes(drivetrain) if boxes else drivetrain, page)
    title = drivetrain.title if title is None else title
    if ax is not None:
        sheet, ((axes,),) = grid_panels(page, page, [""], ax)
        draw_into(axes, whole, framed(whole.extent))
        return sheet.titled(title)
    return figure_of_drawing(whole, framed(edges_under_title(whole, title, page)))


def schematic_parts(drivetrain: Drivetrain, tallest: float) -> tuple[Figure, ...]:
    """Figures of the parts of a drivetrain's schematic, from top to bottom, each at most ``tallest`` mm high in print.

    Parameters
    ----------
    drivetrain : Drivetrain
    tallest : float
        mm, at the size in which a part as wide as the page is printed.

    Examples
    --------
    >>> import torsionnet as tn
    >>> len(schematic_parts(tn.load("wind_turbine_3mw").configured("free"), 235))
    2
    """
    whole = arranged_drawing(drivetrain, page_width(PAPER_WIDTH))
    x0, x1, y0, y1 = framed(whole.extent)
    printed = min(1.0, PAPER_WIDTH / MILLIMETRES_PER_INCH * POINTS_PER_INCH / (x1 - x0))
    most = tallest / MILLIMETRES_PER_INCH * POINTS_PER_INCH / printed
    edges = [y1, *cut_heights(whole, (x0, x1, y0, y1), most), y0]
    return tuple(
        figure_of_drawing(part_between(whole, low, high), (x0, x1, low, high)) for high, low in pairwise(edges)
    )

"""Matplotlib figures of drawings made of strokes and labels, on one axes whose unit is a point of 1/72 inch."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from torsionnet.plot.drawing.palette import PAPER
from torsionnet.plot.drawing.pieces import ROLES, Box, Label, Piece, Stroke, is_math
from torsionnet.plot.drawing.style import bare_figure
from torsionnet.plot.schematics.pens import DASHES, PENS, POINTS_PER_INCH, is_behind

TALLEST_FIGURE = 24.0
"""Height in inches above which a drawing is scaled down, its texts with it."""


def figure_of_drawing(block: Piece, extent: Box) -> Figure:
    """Figure of a drawing, as large as the drawing's extent, whose edges are x0, x1, y0, y1 in points.

    One axes without ticks whose unit is a point.
    """
    figure, axes, scale = _canvas(extent)
    for order, stroke in enumerate(block.strokes):
        _draw(axes, stroke, scale, order)
    for label in block.labels:
        _write(axes, label, scale)
    return figure


def _canvas(extent: Box) -> tuple[Figure, Axes, float]:
    width, height = extent[1] - extent[0], extent[3] - extent[2]
    scale = min(1.0, TALLEST_FIGURE * POINTS_PER_INCH / height)
    size = (width * scale / POINTS_PER_INCH, height * scale / POINTS_PER_INCH)
    figure = bare_figure(*size)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(extent[0], extent[1])
    axes.set_ylim(extent[2], extent[3])
    return figure, axes, scale


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

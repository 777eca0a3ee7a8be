"""Matplotlib figures of drawings made of strokes and labels, on one axes whose unit is a point of 1/72 inch."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

import torsionnet.plot.drawing.style as style
from torsionnet.plot.drawing.pieces import ROLES, Box, Label, Piece, Stroke, font, is_math

PENS: dict[str, tuple[str, float]] = {
    "part": (style.INK, 1.2),
    "thin": (style.INK, 0.7),
    "shaft": (style.INK, 1.8),
    "wire": (style.MUTED, 1.2),
    "faint": ("#b5b5b5", 0.7),
    "carrier": (style.MUTED, 2.0),
    "housing": (style.MUTED, 0.9),
    "input": (style.PALETTE[1], 1.6),
    "leader": (style.PALETTE[1], 1.0),
    "blank": (style.PAPER, 1.2),
    "sensor": (style.PALETTE[2], 1.2),
}
DASHED = {"housing": (0, (4, 2.5))}

POINTS_PER_INCH = 72
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
    figure = style.bare_figure(*size)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(extent[0], extent[1])
    axes.set_ylim(extent[2], extent[3])
    return figure, axes, scale


def _draw(axes: Axes, stroke: Stroke, scale: float, order: int) -> None:
    color, width = PENS[stroke.look]
    path = Path([*stroke.points, stroke.points[0]] if stroke.closed else stroke.points, closed=stroke.closed)
    fill = PENS[stroke.fill][0] if stroke.fill in PENS else stroke.fill
    # Shafts run through discs and behind them; everything else lies as it was drawn.
    depth = 1.0 if stroke.look in ("shaft", "wire", "faint") and not stroke.closed else 2.0
    patch = PathPatch(
        path,
        edgecolor=color,
        facecolor=fill or style.PAPER,
        fill=bool(fill),
        linewidth=width * scale,
        linestyle=DASHED.get(stroke.look, "-"),
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
        fontproperties=font(label.role, role.size * scale),
        parse_math=is_math(label.text, label.role),
        zorder=4,
    )

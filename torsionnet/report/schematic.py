"""The picture of a drivetrain: what is on which shaft, and what joins the shafts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from torsionnet.report import style
from torsionnet.report.blocks import LEADING, ROLES, Block, Label, Stroke, font, is_math
from torsionnet.report.layout import COMPACT, blocks
from torsionnet.report.wiring import connect

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

PENS: dict[str, tuple[str, float]] = {
    "part": (style.INK, 1.2),
    "thin": (style.INK, 0.7),
    "shaft": (style.INK, 1.8),
    "wire": (style.MUTED, 1.2),
    "faint": ("#b5b5b5", 0.7),
    "input": (style.PALETTE[1], 1.6),
    "sensor": (style.PALETTE[2], 1.2),
}
EDGE, BETWEEN = 14.0, 26.0
POINTS_PER_INCH = 72
LARGEST = 24.0
"""Inches: a drawing that would be larger is made smaller, its texts with it."""


def schematic(drivetrain: Drivetrain, *, title: str | None = None) -> Figure:
    r"""Draw a drivetrain.

    Shafts run from left to right in the order of the model's nodes, whose names stand above them. Inertias are discs
    whose height grows with the logarithm of the inertia; gear stages and branches go on on lines of their own, and an
    element that closes a loop is led back to its node. Curved arrows are inputs, dots and diamonds are sensors of
    motion and of torque.

    Parameters
    ----------
    drivetrain : Drivetrain
        Only elements that are switched on are drawn. With more than 40 nodes only the nodes are named.
    title : str, optional
        By default name and configuration of the drivetrain.

    Returns
    -------
    matplotlib.figure.Figure
        One axes without ticks; a unit is a point.

    Examples
    --------
    >>> import torsionnet as tn
    >>> figure = schematic(tn.load("amt_rig"))
    >>> [text.get_text() for text in figure.axes[0].texts if "460" in text.get_text()]
    ['$k_{\\mathrm{1}}$ = 460 N·m/rad']
    """
    whole = _arranged(drivetrain)
    x0, x1, y0, y1 = whole.extent
    shown = drivetrain.title if title is None else title
    if shown:
        whole.labels.append(Label(x0, y1 + 16, shown, "title", left=True))
        y1 += 16 + LEADING * ROLES["title"].size
    figure, axes, scale = _canvas((x0 - EDGE, x1 + EDGE, y0 - EDGE, y1 + EDGE))
    for order, stroke in enumerate(whole.strokes):
        _draw(axes, stroke, scale, order)
    for label in whole.labels:
        _write(axes, label, scale)
    return figure


def _arranged(drivetrain: Drivetrain) -> Block:
    """All parts below each other, with the lines that close loops."""
    whole = Block()
    bottom = 0.0
    for part in blocks(drivetrain):
        connect(part)
        x0, _, y0, y1 = part.extent
        whole.add(part.shifted(-x0, bottom - y1))
        bottom += y0 - y1 - BETWEEN
    if len(drivetrain.nodes) > COMPACT:
        note = f"{len(drivetrain.nodes)} nodes: elements are drawn without names and values"
        whole.labels.append(Label(0, bottom + BETWEEN - 14, note, "note", left=True))
        whole.boxes.append((0, 200, bottom + BETWEEN - 18, bottom + BETWEEN))
    return whole


def _canvas(extent: tuple[float, float, float, float]) -> tuple[Figure, Axes, float]:
    width, height = extent[1] - extent[0], extent[3] - extent[2]
    scale = min(1.0, LARGEST * POINTS_PER_INCH / max(width, height))
    size = (width * scale / POINTS_PER_INCH, height * scale / POINTS_PER_INCH)
    figure = Figure(figsize=size, facecolor=style.PAPER)
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

"""The picture of a drivetrain: what is on which shaft, and what joins the shafts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from torsionnet.errors import UsageError
from torsionnet.report import style
from torsionnet.report.blocks import LEADING, ROLES, Block, Label, Stroke, font, is_math, text_width
from torsionnet.report.layout import blocks
from torsionnet.report.plan import COMPACT
from torsionnet.report.texts import wrapped
from torsionnet.report.wiring import connect

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

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
    "sensor": (style.PALETTE[2], 1.2),
}
DASHED = {"housing": (0, (4, 2.5))}
EDGE, BETWEEN, BESIDE = 10.0, 26.0, 40.0
POINTS_PER_INCH, MILLIMETRES_PER_INCH = 72, 25.4
PAPER_WIDTH, LEGIBLE = 170.0, 6.0
"""Millimetres between the margins of an A4 page; points that the smallest text still has at that width."""

NARROWEST_PAGE = 100.0
HIGHEST = 24.0
"""Inches: a drawing that would be higher is made smaller, its texts with it."""


def schematic(drivetrain: Drivetrain, *, title: str | None = None, width: float = PAPER_WIDTH) -> Figure:
    r"""Draw a drivetrain.

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
    whole = _arranged(drivetrain, page)
    x0, x1, y0, y1 = whole.extent
    shown = drivetrain.title if title is None else title
    for line in reversed(wrapped(shown, "title", page)):
        whole.labels.append(Label(x0, y1 + 16, line, "title", left=True))
        y1 += LEADING * ROLES["title"].size
        x1 = max(x1, x0 + text_width(line, "title"))
    y1 += 16 if shown else 0
    figure, axes, scale = _canvas((x0 - EDGE, x1 + EDGE, y0 - EDGE, y1 + EDGE))
    for order, stroke in enumerate(whole.strokes):
        _draw(axes, stroke, scale, order)
    for label in whole.labels:
        _write(axes, label, scale)
    return figure


def _page(width: float) -> float:
    """Points that a drawing may be wide."""
    if not width >= NARROWEST_PAGE:
        msg = f"a schematic needs a page at least {NARROWEST_PAGE:g} mm wide; got {width:g}"
        raise UsageError(msg)
    smallest = min(role.size for role in ROLES.values())
    return width / MILLIMETRES_PER_INCH * POINTS_PER_INCH * smallest / LEGIBLE - 2 * EDGE


def _arranged(drivetrain: Drivetrain, page: float) -> Block:
    """All parts below each other, with the lines that close loops."""
    parts = []
    for bands in blocks(drivetrain, page):
        part = _packed(bands, page)
        connect(part)
        parts.append(part)
    whole = _packed(parts, page)
    if len(drivetrain.nodes) > COMPACT:
        note = f"{len(drivetrain.nodes)} nodes: elements are drawn without names and values"
        x0, _, y0, _ = whole.extent
        whole.labels.append(Label(x0, y0 - 14, note, "note", left=True))
        whole.boxes.append((x0, x0 + text_width(note, "note"), y0 - 18, y0 - 4))
    return whole


def _packed(given: Sequence[Block], page: float) -> Block:
    """Blocks from left to right and from top to bottom, like words on a page."""
    whole = Block()
    x = top = bottom = 0.0
    for block in given:
        x0, x1, y0, y1 = block.extent
        if x and x + x1 - x0 > page:
            x, top = 0.0, bottom - BETWEEN
        whole.add(block.shifted(x - x0, top - y1))
        bottom = min(bottom, top + y0 - y1)
        x += x1 - x0 + BESIDE
    return whole


def _canvas(extent: tuple[float, float, float, float]) -> tuple[Figure, Axes, float]:
    width, height = extent[1] - extent[0], extent[3] - extent[2]
    scale = min(1.0, HIGHEST * POINTS_PER_INCH / height)
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

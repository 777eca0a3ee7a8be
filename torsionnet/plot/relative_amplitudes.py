"""Plot of the relative amplitudes of modes along the lines of their Holzer tables, with the nodes of vibration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.errors import UsageError
from torsionnet.base.number_text import NumberText
from torsionnet.machinery.holzer.holzer_table import HolzerTable
from torsionnet.machinery.holzer.vibration_nodes import vibration_nodes

PANEL_HEIGHT, NAMES_HEIGHT = 1.15, 0.75
"""Height in inches of the panel of a mode, and of the names of the masses below the last panel."""
BRANCH_STEP = 1.6
"""Distance along the axis of a branch from the line before it, as a multiple of the distance of two masses."""
MOST_NAMES = 40
"""Largest number of masses with which each mass has its name below the panels; of more every second or third has."""
NODE_COLOR = style.PALETTE[1]


@dataclass
class _Line:
    """Masses on one line of a Holzer table, with their places, names, amplitudes, and flags of rigid links behind."""

    x: list[float] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    theta: list[float] = field(default_factory=list)
    rigid: list[bool] = field(default_factory=list)


def relative_amplitudes(tables: Sequence[HolzerTable], *, title: str = "") -> Figure:
    """Figure of relative amplitudes of the masses, a panel per mode, the first mass at 1, nodes of vibration marked.

    Lines follow each other as in the Holzer table; a branch ends with the mass it joins, in brackets. Amplitudes are
    referred to one shaft, so that a gear (dotted) makes no step. The number at a node of vibration says how much of the
    twist between the two masses lies before it, in percent; a ring without number is a mass at rest.

    Parameters
    ----------
    tables : sequence of HolzerTable
        Of one drivetrain.
    title : str, optional

    Raises
    ------
    UsageError
        There are none.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("two_stroke_ship")
    >>> len(relative_amplitudes([ship.holzer_table(1), ship.holzer_table(2)]).axes)
    2
    """
    if not tables:
        raise UsageError("there is no Holzer table to draw: give those of the modes")
    figure = style.new_figure(style.WIDTH, 0.2 + PANEL_HEIGHT * len(tables) + NAMES_HEIGHT)
    panels = figure.subplots(len(tables), 1, sharex=True, squeeze=False)[:, 0]
    for panel, holzer in zip(panels, tables, strict=True):
        _draw(panel, holzer)
    places = [(x, name) for line in _lines(tables[0]) for x, name in zip(line.x, line.names, strict=True)]
    shown = places[:: -(-len(places) // MOST_NAMES)]
    panels[-1].set_xticks([x for x, _ in shown], [name.replace("_", " ") for _, name in shown])
    panels[-1].tick_params(axis="x", labelrotation=45)
    for label in panels[-1].get_xticklabels():
        label.set(ha="right", rotation_mode="anchor", fontsize=style.SMALL - 1)
    if title:
        style.set_title(figure, title)
    return figure


def _lines(holzer: HolzerTable) -> list[_Line]:
    lines = []
    x = 0.0
    for branch in holzer.branches:
        line = _Line()
        stations = [*branch.stations, *([holzer.station(branch.joins)] if branch.joins else [])]
        for place, one in enumerate(stations):
            again = bool(branch.joins) and place == len(branch.stations)
            line.x.append(x)
            line.names.append(f"({one.node})" if again else one.node)
            line.theta.append(one.amplitude / one.ratio if one.ratio == one.ratio else one.amplitude)
            line.rigid.append(one.link is not None and one.link.rigid)
            x += 1.0
        x += BRANCH_STEP - 1.0
        lines.append(line)
    return lines


def _draw(axes: Axes, holzer: HolzerTable) -> None:
    style.style_axes(axes)
    axes.axhline(0, color=style.MUTED, linewidth=0.8)
    lines = _lines(holzer)
    place: dict[tuple[str, str], tuple[float, float]] = {}
    for line in lines:
        for index, rigid in enumerate(line.rigid[:-1]):
            ends = slice(index, index + 2)
            look = (0, (1, 1.5)) if rigid else "-"
            axes.plot(line.x[ends], line.theta[ends], color=style.PALETTE[0], linewidth=1.4, linestyle=look)
            first, second = (name.strip("()") for name in line.names[ends])
            place[first, second] = line.x[index], line.x[index + 1]
        axes.plot(line.x, line.theta, "o", color=style.PALETTE[0], markersize=3)
        axes.vlines(line.x, 0, line.theta, color=style.PALETTE[0], linewidth=0.6, alpha=0.5)
        place |= {(name, name): (x, x) for x, name in zip(line.x, line.names, strict=True)}
    for node in vibration_nodes(holzer):
        start, end = place[node.first, node.second]
        x = start + node.position * (end - start)
        axes.plot([x], [0], "o", color=NODE_COLOR, markerfacecolor=style.PAPER, markersize=5.5, zorder=4)
        if node.elements:
            axes.annotate(
                f"{100 * node.position:.0f}", (x, 0), xytext=(0, 6), textcoords="offset points", ha="center",
                fontsize=style.SMALL - 1, color=NODE_COLOR,
            )  # fmt: skip
    axes.margins(x=0.02, y=0.18)
    number = f"Mode {holzer.mode}: " if holzer.mode else ""
    per_minute = f"{NumberText(60 * holzer.frequency, 4)} per minute"
    axes.set_title(f"{number}{holzer.frequency:.4g} Hz, {per_minute}", fontsize=style.SMALL, loc="left", pad=3)

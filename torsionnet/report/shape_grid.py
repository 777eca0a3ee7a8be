"""Mode shapes of several configurations: one row of small panels for each, one column for each mode."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from torsionnet.report import style
from torsionnet.report.shapes import MANY_NODES, edges_of

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.response import Modes

MOST_COLUMNS = 4
"""Modes of a configuration side by side."""
WIDEST_WRAPPED = 3
"""Panels in a row where the modes of a single configuration are wrapped."""
PANEL, TITLES, LETTER = 1.05, 0.42, 0.062
LEFT, RIGHT, BETWEEN = 0.42, 0.1, 0.28


def shape_grid(modes: Sequence[Modes], drivetrains: Sequence[Drivetrain], labels: Sequence[str]) -> Figure:
    """Relative angles of the nodes in the modes of several configurations.

    Parameters
    ----------
    modes : sequence of Modes
    drivetrains : sequence of Drivetrain
        Say which nodes share an element.
    labels : sequence of str
        Name of each row; empty where there is one only.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> len(shape_grid([rig.modes()], [rig], [""]).axes)
    2
    """
    places = _places(modes)
    rows, columns = 1 + max(row for row, *_ in places), 1 + max(column for _, column, *_ in places)
    nodes = max((one.nodes for one in modes), key=len)
    below = 0.25 + LETTER * min(max(len(node) for node in nodes), 18)
    height = rows * (PANEL + TITLES) + below + 0.05
    width = style.WIDTH if columns > 1 else 0.6 * style.WIDTH
    figure = Figure(figsize=(width, height), facecolor=style.PAPER)
    step = (width - LEFT - RIGHT + BETWEEN) / columns
    lowest = {column: max(row for row, c, *_ in places if c == column) for _, column, *_ in places}
    for row, column, case, index in places:
        left, bottom = LEFT + column * step, below + (rows - 1 - row) * (PANEL + TITLES)
        axes = figure.add_axes(
            (left / width, bottom / height, (step - BETWEEN) / width, PANEL / height), xlim=_limits(modes[case])
        )
        _panel(axes, modes[case], index, edges_of(modes[case], drivetrains[case]))
        axes.set_title(_title(modes[case], index, labels[case]), fontsize=style.SMALL, color=style.INK, loc="left", pad=4)
        _ticks(axes, modes[case].nodes, named=row == lowest[column], numbered=column == 0)
    return figure


def _places(modes: Sequence[Modes]) -> list[tuple[int, int, int, int]]:
    """Row, column, number of the configuration and of the mode of each panel."""
    if len(modes) == 1:
        count = max(1, len(modes[0]))
        across = count if count <= MOST_COLUMNS else WIDEST_WRAPPED
        return [(index // across, index % across, 0, index) for index in range(len(modes[0]))]
    return [(row, index, row, index) for row, one in enumerate(modes) for index in range(min(MOST_COLUMNS, len(one)))]


def _limits(modes: Modes) -> tuple[float, float]:
    return -0.4, len(modes.nodes) - 0.6


def _panel(axes: Axes, modes: Modes, index: int, edges: Sequence[tuple[int, int]]) -> None:
    shape, x = modes.shapes[:, index], np.arange(len(modes.nodes))
    size = 3.5 if len(x) <= MANY_NODES else 1.8
    axes.axhline(0, color=style.MUTED, linewidth=0.7)
    parts = ((shape.imag, style.PALETTE[5], 0.9, style.PAPER), (shape.real, style.PALETTE[0], 1.3, style.PALETTE[0]))
    for part, color, width, face in parts:
        lines = [[(a, part[a]), (b, part[b])] for a, b in edges]
        axes.add_collection(LineCollection(lines, colors=color, linewidths=width), autolim=False)
        axes.plot(x, part, "o", color=color, markerfacecolor=face, markersize=size, zorder=3)
    axes.set_ylim(-1.15, 1.15)


def _ticks(axes: Axes, nodes: Sequence[str], *, named: bool, numbered: bool) -> None:
    for side, spine in axes.spines.items():
        spine.set_visible(side == "left")
        spine.set_color(style.MUTED)
    axes.set_yticks([-1, 0, 1], ["−1", "0", "1"] if numbered else ["", "", ""])
    step = -(-len(nodes) // MANY_NODES)
    shown = list(range(0, len(nodes), step))
    labels = [nodes[i].replace("_", " ") for i in shown] if named else [""] * len(shown)
    axes.set_xticks(shown, labels, rotation=45, ha="right", rotation_mode="anchor")
    axes.tick_params(labelsize=style.SMALL - 1, color=style.MUTED, labelcolor=style.INK, length=2)


def _title(modes: Modes, index: int, label: str) -> str:
    where = f"{label}, mode {index + 1}" if label else f"Mode {index + 1}"
    if modes.kinds[index] == "rigid body":
        return f"{where}: rigid body"
    if modes.kinds[index] == "real pole":
        return f"{where}: overdamped"
    return f"{where}: {modes.natural_frequencies[index]:.4g} Hz"

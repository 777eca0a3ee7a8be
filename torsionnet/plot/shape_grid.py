"""Plot of the mode shapes of several configurations, a row of small panels for each, a column for each mode.

All panels are drawn into one axes, in inches, which is ten times as fast as a dozen axes with ticks of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.linear.modes.modes import OSCILLATORY
from torsionnet.plot.shapes import (
    IMAGINARY,
    JOINS,
    MANY_NODES,
    OUT_OF_PHASE,
    REAL,
    ShapeView,
    phase_scatter,
    shape_view,
    station_shape,
)

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.linear.modes.modes import Modes

MOST_COLUMNS, WRAPPED = 4, 3
"""Largest number of panels side by side, and number in a row if the modes of one configuration fill several rows."""
TALL, LOW, TITLES, LABEL, LETTER, NAME = 0.5, 0.36, 0.42, 0.2, 0.062, 0.17
"""Sizes in inches of half a tall and half a low panel, title of a panel, label of a row, letter, and node's name."""
MOST_TALL_ROWS = 3
"""Largest number of rows of panels with which the panels are tall; more low ones still fit a page."""
LEFT, RIGHT, BETWEEN, EDGE = 0.32, 0.1, 0.22, 0.2
"""Left and right margins of the figure, gap of panels, and gap from a panel's edge to its first node, in inches."""
TINY = style.SMALL - 1  # points


@dataclass(frozen=True)
class Panel:
    """Panel of one mode shape, with indices of configuration and mode, row and column, and place and size in inches."""

    case: int
    mode: int
    row: int
    column: int
    x: float
    y: float
    width: float
    half: float


def shape_grid(modes: Sequence[Modes], drivetrains: Sequence[Drivetrain], labels: Sequence[str]) -> Figure:
    """Figure of mode shapes, relative angles of the nodes referred to one shaft, a row of panels per configuration.

    Parameters
    ----------
    modes : sequence of Modes
        At least one of which has modes.
    drivetrains : sequence of Drivetrain
        Give order, lines and ratios.
    labels : sequence of str
        Name of each row; empty where there is one only.

    Returns
    -------
    matplotlib.figure.Figure
        One axes without ticks, in inches.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> texts = [text.get_text() for text in shape_grid([rig.modes()], [rig], [""]).axes[0].texts]
    >>> [text for text in texts if "Hz" in text]
    ['Mode 1: 7.105 Hz', 'Mode 2: 80.98 Hz']
    """
    longest = max(len(node) for case in modes for node in case.nodes)
    below = 0.2 + LETTER * min(longest, 18)
    views = [shape_view(case, rig) for case, rig in zip(modes, drivetrains, strict=True)]
    panels, height = _panels(modes, below)
    figure = style.bare_figure(style.WIDTH, height)
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, style.WIDTH), ylim=(0, height))
    axes.set_axis_off()
    lowest = {panel.column: max(other.row for other in panels if other.column == panel.column) for panel in panels}
    for panel in panels:
        case = modes[panel.case]
        _frame(axes, panel)
        _shape(axes, panel, case, views[panel.case])
        axes.text(panel.x, panel.y + panel.half + 0.1, _title(case, panel.mode), fontsize=style.SMALL, color=style.INK)
        if panel.column == 0 and len(modes) > 1:
            _label(axes, panel, labels[panel.case])
        if panel.row == lowest[panel.column]:
            _names(axes, panel, views[panel.case])
    return figure


def _panels(modes: Sequence[Modes], below: float) -> tuple[list[Panel], float]:
    """List of the panels of a grid of mode shapes, and height of the figure in inches."""
    drawn = _drawn(modes)
    if len(modes) == 1:
        count = len(drawn[0])
        across = count if count <= MOST_COLUMNS else WRAPPED
        places = [(0, index, place // across, place % across) for place, index in enumerate(drawn[0])]
    else:
        places = [
            (row, index, row, column)
            for row, indices in enumerate(drawn)
            for column, index in enumerate(indices[:MOST_COLUMNS])
        ]
    rows, columns = 1 + max(place[2] for place in places), max(2, 1 + max(place[3] for place in places))
    step = (style.WIDTH - LEFT - RIGHT + BETWEEN) / columns
    half = TALL if rows <= MOST_TALL_ROWS else LOW
    rise = 2 * half + TITLES + (LABEL if len(modes) > 1 else 0)
    panels = [
        Panel(*place, LEFT + place[3] * step, below + half + (rows - 1 - place[2]) * rise, step - BETWEEN, half)
        for place in places
    ]
    return panels, below + rows * rise


def _drawn(modes: Sequence[Modes]) -> list[list[int]]:
    """Lists of the indices, from 0, of the oscillatory modes, one list for each configuration.

    Of all modes if none oscillates.
    """
    vibrations = [[index for index, kind in enumerate(case.kinds) if kind == OSCILLATORY] for case in modes]
    return vibrations if any(vibrations) else [list(range(len(case))) for case in modes]


def _frame(axes: Axes, panel: Panel) -> None:
    """Draw in a grid of mode shapes the zero line of a panel, and a scale from -1 to 1 on its left."""
    x, y, half = panel.x, panel.y, panel.half
    ticks = [[(x - 0.03, y + level), (x, y + level)] for level in (-half, 0.0, half)]
    lines = [[(x, y - half), (x, y + half)], [(x, y), (x + panel.width, y)], *ticks]
    axes.add_collection(LineCollection(lines, colors=style.MUTED, linewidths=0.7), autolim=False)
    if panel.column == 0:
        for level, text in ((-half, "−1"), (0.0, "0"), (half, "1")):
            axes.text(x - 0.06, y + level, text, fontsize=TINY, ha="right", va="center", color=style.INK)


def _places(panel: Panel, view: ShapeView) -> FloatArray:
    """Horizontal places in inches of the stations (nodes along the axis) of a panel, shape (n_stations,)."""
    edge = min(EDGE, panel.width / 4)
    x = np.array([station.x for station in view.axis.stations])
    return np.asarray(panel.x + edge + x * (panel.width - 2 * edge) / max(view.axis.end, 1.0))


def _shape(axes: Axes, panel: Panel, modes: Modes, view: ShapeView) -> None:
    shape, x = station_shape(modes, panel.mode, view), _places(panel, view)
    size = 3.5 if len(x) <= MANY_NODES else 1.8
    parts = [(shape.real, REAL, 1.3, REAL)]
    if phase_scatter(shape) > OUT_OF_PHASE:
        parts.insert(0, (shape.imag, IMAGINARY, 0.9, style.PAPER))
    for part, color, width, face in parts:
        y = panel.y + panel.half * part
        for kind, look in JOINS.items():
            lines = [
                [(x[join.first], y[join.first]), (x[join.second], y[join.second])]
                for join in view.axis.joins
                if join.kind == kind
            ]
            drawn = LineCollection(lines, colors=color, linewidths=width, linestyles=[look], zorder=2)
            axes.add_collection(drawn, autolim=False)
        again = np.array([station.again for station in view.axis.stations], dtype=bool)
        axes.plot(x[again], y[again], "o", color=color, markerfacecolor=style.PAPER, markersize=size - 1, zorder=3)
        axes.plot(x[~again], y[~again], "o", color=color, markerfacecolor=face, markersize=size, zorder=3)


def _names(axes: Axes, panel: Panel, view: ShapeView) -> None:
    x = _places(panel, view)
    y = panel.y - panel.half - 0.08
    look: dict[str, Any] = {"fontsize": TINY, "rotation": 45, "ha": "right", "va": "top", "rotation_mode": "anchor"}
    most = max(2, int(panel.width / NAME))
    for index in range(0, len(x), -(-len(x) // most)):
        station = view.axis.stations[index]
        name = station.node.replace("_", " ")
        text = f"({name})" if station.again else name
        axes.text(x[index] + 0.03, y, text, color=style.INK, parse_math=False, **look)


def _label(axes: Axes, panel: Panel, text: str) -> None:
    """Write the name of a configuration above its row of panels."""
    y = panel.y + panel.half + 0.1 + LABEL
    axes.text(panel.x, y, text, fontsize=style.SMALL, color=style.INK, fontweight="bold", parse_math=False)


def _title(modes: Modes, index: int) -> str:
    name = modes.names[index]
    if modes.numbers[index] is None:
        return name[:1].upper() + name[1:]
    return f"Mode {name}: {modes.natural_frequencies[index]:.4g} Hz"

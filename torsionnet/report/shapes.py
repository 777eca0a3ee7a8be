"""Mode shapes: one small panel for each mode, the nodes of the drivetrain along it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from torsionnet.errors import UsageError
from torsionnet.report import style
from torsionnet.response import SI, Conventions, Modes

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

MOST = 12
"""Modes shown unless others are asked for."""

COLUMNS = 2
MANY_NODES, FEW_LETTERS = 24, 22


def mode_shapes(
    modes: Modes,
    drivetrain: Drivetrain | None = None,
    *,
    which: Sequence[int] | None = None,
    conventions: Conventions = SI,
    title: str | None = None,
) -> Figure:
    """Relative angles of the nodes in each mode.

    Filled dots are the real part of the shape, turned so that the node that moves most is real; open dots are the
    imaginary part, which is zero where all nodes move in phase or against each other. Lines join nodes that share an
    element.

    Parameters
    ----------
    modes : Modes
    drivetrain : Drivetrain, optional
        Says which nodes share an element; without it no lines are drawn.
    which : sequence of int, optional
        Modes by their number in the table, from 1; by default the first twelve.
    conventions : Conventions, optional
        Unit of the frequencies.
    title : str, optional
        By default the title of the modes.

    Raises
    ------
    UsageError
        There is no such mode.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> [panel.get_title() for panel in mode_shapes(rig.modes(), rig).axes]
    ['1: 7.105 Hz, zeta = 22.3 %', '2: 80.98 Hz, zeta = 1.39 %']
    """
    chosen = _chosen(modes, which)
    columns = min(COLUMNS, max(1, len(chosen)))
    rows = -(-len(chosen) // columns)
    longest = max((len(node) for node in modes.nodes), default=1)
    figure = style.new_figure(style.WIDTH, 0.9 + rows * (1.5 + 0.05 * min(longest, 16)))
    if chosen:
        grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for index, axes in zip(chosen, grid.flat, strict=False):
            _panel(axes, modes, index, edges_of(modes, drivetrain), conventions)
        for axes in list(grid.flat)[len(chosen) :]:
            axes.remove()
        for axes in grid[-1, :] if len(chosen) % columns == 0 else [*grid[-1, :1], *grid[-2:-1, 1]]:
            axes.tick_params(labelbottom=True)
        figure.supylabel("relative angle [-]", fontsize=style.FONT)
    style.heading(figure, modes.title if title is None else title)
    _legend(figure, len(modes), chosen)
    return figure


def _chosen(modes: Modes, which: Sequence[int] | None) -> list[int]:
    if which is None:
        return list(range(min(MOST, len(modes))))
    for number in which:
        if not 1 <= number <= len(modes):
            msg = f"there is no mode {number}; the modes are numbered 1 to {len(modes)}"
            raise UsageError(msg)
    return [number - 1 for number in which]


def edges_of(modes: Modes, drivetrain: Drivetrain | None) -> list[tuple[int, int]]:
    """Positions of the nodes that share an element."""
    if drivetrain is None:
        return []
    place = {node: index for index, node in enumerate(modes.nodes)}
    pairs = {
        (min(place[a], place[b]), max(place[a], place[b]))
        for a, b in drivetrain.graph().edges()
        if a in place and b in place
    }
    return sorted(pairs)


def _panel(axes: Axes, modes: Modes, index: int, edges: Sequence[tuple[int, int]], conventions: Conventions) -> None:
    shape = modes.shapes[:, index]
    x = np.arange(len(modes.nodes))
    style.dress(axes)
    axes.axhline(0, color=style.MUTED, linewidth=0.8)
    for part, color, width, face in (
        (shape.imag, style.PALETTE[5], 1.0, style.PAPER),
        (shape.real, style.PALETTE[0], 1.6, style.PALETTE[0]),
    ):
        for a, b in edges:
            axes.plot([a, b], [part[a], part[b]], color=color, linewidth=width, label="_edge")
        axes.plot(
            x, part, "o", color=color, markerfacecolor=face, markersize=4.5 if len(x) <= MANY_NODES else 2.5, zorder=3
        )
    axes.vlines(x, 0, shape.real, color=style.PALETTE[0], linewidth=0.6, alpha=0.5)
    axes.set_ylim(-1.15, 1.15)
    axes.set_xlim(-0.5, len(x) - 0.5)
    axes.set_title(_title(modes, index, conventions), fontsize=style.FONT, color=style.INK)
    _name_nodes(axes, modes.nodes)


def _name_nodes(axes: Axes, nodes: Sequence[str]) -> None:
    step = -(-len(nodes) // MANY_NODES)
    shown = range(0, len(nodes), step)
    crowded = len(shown) * max(len(node) for node in nodes) > FEW_LETTERS
    turned: dict[str, Any] = {"rotation": 45, "ha": "right", "rotation_mode": "anchor"} if crowded else {}
    axes.set_xticks(list(shown), [nodes[i] for i in shown], fontsize=style.SMALL - 1, **turned)


def _title(modes: Modes, index: int, conventions: Conventions) -> str:
    if modes.kinds[index] == "rigid body":
        return f"{index + 1}: rigid body"
    if modes.kinds[index] == "real pole":
        return f"{index + 1}: real pole, {modes.eigenvalues[index].real:.4g} rad/s"
    frequency = modes.natural_frequencies[index] * conventions.frequency_scale
    return f"{index + 1}: {frequency:.4g} {conventions.frequency}, zeta = {100 * modes.damping_ratios[index]:.3g} %"


def _legend(figure: Figure, total: int, chosen: Sequence[int]) -> None:
    real = Line2D([], [], color=style.PALETTE[0], marker="o", markersize=4.5, linewidth=1.6)
    imaginary = Line2D([], [], color=style.PALETTE[5], marker="o", markerfacecolor=style.PAPER, markersize=4.5)
    names = ["real part", "imaginary part"]
    handles = [real, imaginary]
    if len(chosen) < total:
        handles.append(Line2D([], [], linestyle=""))
        names.append(f"{len(chosen)} of {total} modes shown")
    figure.legend(handles, names, loc="outside lower center", ncols=3, frameon=False, fontsize=style.SMALL)

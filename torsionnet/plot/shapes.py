"""Plot of mode shapes, a panel for each mode with the relative angles of the drivetrain's nodes, branch by branch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions, index_of_mode
from torsionnet.base.errors import UsageError, comma_list, did_you_mean
from torsionnet.base.number_text import NumberText
from torsionnet.base.phrases import phrase
from torsionnet.linear.modes.modes import OSCILLATORY, Modes
from torsionnet.machinery.holzer.holzer_table import HolzerTable, vibration_nodes
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.plot.schematics.line_routes import Axis, idle_nodes, node_axis, plain_axis, ratios

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


MODES_SHOWN = 12
"""Largest number of mode shapes drawn unless others are asked for: as many panels as fit a page."""

COLUMNS, PAGE_HEIGHT = 2, 10.0
"""Number of panels of mode shapes side by side, and largest height of the figure in inches."""

MOST_LETTERS, HANDLE = 105, 8
"""Largest number of letters in a row of the legend, and number of letters as wide as the sample of a curve in it."""
MANY_NODES, FEW_LETTERS, FEW_NAMES = 24, 22, 4
"""Largest number of nodes that all have names, of letters of names that are set level, and of names in a remark of the
legend."""
STANDING_AMPLITUDE = 1e-9
"""Amplitude, relative to the largest of the mode, up to which a node counts as standing still: rounding errors are
smaller."""
LIMIT, CLOSE_GEARS = 1.45, 2.2
"""End of the amplitude axis, on which the largest amplitude is 1, and distance of gears, in distances of nodes, below
which their labels alternate in height."""
OUT_OF_PHASE = 10.0
"""Scatter of the phase of the nodes in degrees, weighted by amplitude, from which imaginary parts are shown."""

REAL, IMAGINARY = style.PALETTE[0], style.PALETTE[5]
JOINS: dict[str, Any] = {"shaft": "-", "gear": (0, (1, 1.2)), "box": (0, (4, 2))}


@dataclass(frozen=True)
class ShapeView:
    """Axis of the nodes of a mode shape plot, and factors by which the nodes' angles are referred to one shaft."""

    axis: Axis
    factors: NDArray[np.float64]
    """Factors by which the angles of the nodes are multiplied to refer them to one shaft, shape (n_nodes,)."""
    label: str
    free: tuple[str, ...] = ()
    """Names of the moving nodes without a fixed ratio of speed to the reference node."""
    standing: tuple[str, ...] = ()
    """Names of the moving nodes of shafts that stand still on average, whose own angle is shown."""
    idle: tuple[str, ...] = ()
    """Names of the nodes of idle gear wheels, which the plot leaves out."""


def mode_shapes(
    modes: Modes,
    drivetrain: Drivetrain | None = None,
    *,
    mode: Sequence[int] | None = None,
    conventions: Conventions = SI,
    title: str | None = None,
    referred_to: str | None = None,
    own_angles: bool = False,
    idle: bool = False,
    ax: GivenAxes = None,
) -> Figure:
    """Figure of mode shapes, the relative angles of the nodes referred to one shaft, a panel for each mode.

    The nodes stand in the order of the schematic: the main line, then its branches, each beginning with the node it
    leaves (in brackets). Angles are multiplied by the ratio to one shaft, so that a rigid gear, marked by a dotted
    line and its ratio, makes no jump and a slow shaft does not look as if it stood still; the label of the axis names
    that shaft. Each shape is turned and scaled so that its largest value is 1. Dots are the real part; where the nodes
    do not pass through zero together, open dots are the imaginary part and the panel gives the scatter of the phase.

    Parameters
    ----------
    modes : Modes
    drivetrain : Drivetrain, optional
        Gives order, lines and ratios; without it own angles are shown in the order of ``modes.nodes``.
    mode : sequence of int, optional
        Modes by their number in the table, from 1; by default the first twelve that oscillate.
    conventions : Conventions, optional
        Unit of the frequencies.
    title : str, optional
        By default the title of the modes.
    referred_to : str, optional
        The node to whose speed angles are referred; by default the first one. Ratios are those of the mean speeds: of
        the operating point where it tells them, else with housings on springs at rest and the outputs of an open
        differential alike. Behind a planetary set that leaves them open the ratio of the shaft in front is kept, and
        what stands still on average shows its own angle; the legend says so.
    own_angles : bool, optional
        Each node's own angle instead; gears then jump by their ratio.
    idle : bool, optional
        Also gear wheels that only run along: behind a rigid gear beside others, with nothing further on.
    ax : sequence of Axes, optional
        Axes to draw into, one for each mode; by default those of a new figure.

    Raises
    ------
    UsageError
        There is no such mode or node, or angles are to be referred without a drivetrain.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> [panel.get_title() for panel in mode_shapes(rig.modes(), rig).axes]
    ['1: 7.105 Hz, zeta = 22.3 %', '2: 80.98 Hz, zeta = 1.39 %']
    """
    chosen = _chosen(modes, mode)
    view = shape_view(modes, drivetrain, referred_to, own=own_angles, idle=idle)
    return _panels(modes, chosen, view, conventions, ax).titled(modes.title if title is None else title)


def shape_view(
    modes: Modes,
    drivetrain: Drivetrain | None,
    referred_to: str | None = None,
    *,
    own: bool = False,
    idle: bool = False,
) -> ShapeView:
    """Axis of the nodes, and factors that refer their angles to one shaft, or factors 1 for each node's own angle."""
    if referred_to is not None and referred_to not in modes.nodes:
        raise UsageError(
            f'no node is named "{referred_to}"{did_you_mean(referred_to, modes.nodes)}', kind="unknown-node"
        )
    ones = np.ones(len(modes.nodes))
    if drivetrain is None:
        if referred_to is not None:
            raise UsageError(
                "angles can be referred to a node only where the drivetrain is given too", kind="missing-data"
            )
        return ShapeView(plain_axis(modes.nodes), ones, "angle of each node [-]")
    idlers = set() if idle else idle_nodes(drivetrain)
    left_out = tuple(node for node in drivetrain.nodes if node in idlers)
    axis = node_axis(drivetrain, left_out)
    if own or not axis.stations:
        return ShapeView(axis, ones, "angle of each node [-]", idle=left_out)
    reference = referred_to or axis.stations[0].node
    turning = ratios(drivetrain, reference)
    factors = np.array([turning.of[node] for node in modes.nodes])
    # Without any ratio a referred angle is the angle itself.
    plain = np.allclose(factors, 1.0, rtol=1e-12)
    label = phrase("angle") if plain else phrase("angle referred to {node}", node=reference)
    # What cannot turn stays at zero whatever its ratio.
    seen = {station.node for station in axis.stations}
    seen = {node for node in seen if np.any(np.abs(modes.shapes[modes.nodes.index(node)]) > STANDING_AMPLITUDE)}
    free, standing = (tuple(node for node in some if node in seen) for some in (turning.free, turning.standing))
    return ShapeView(axis, factors, label, free, standing, left_out)


def _panels(
    modes: Modes, chosen: Sequence[int], view: ShapeView, conventions: Conventions, ax: GivenAxes
) -> style.Sheet:
    columns = min(COLUMNS, max(1, len(chosen)))
    rows = -(-len(chosen) // columns)
    longest = max((len(node) for node in modes.nodes), default=1)
    height = min(PAGE_HEIGHT, 0.9 + rows * (1.5 + 0.05 * min(longest, 16)))
    shows = [f"mode {modes.names[index]}" for index in chosen]
    sheet, grid = style.grid_panels(style.WIDTH, height, shows, ax, columns=columns, sharex=True, sharey=True)
    scattered = False
    if chosen:
        for index, axes in zip(chosen, sheet.panels, strict=True):
            scattered |= _panel(axes, modes, index, view, conventions)
        for axes in grid[-1, :] if len(chosen) % columns == 0 else [*grid[-1, :1], *grid[-2:-1, 1]]:
            axes.tick_params(labelbottom=True)
        sheet.label_all(y=f"{view.label} [-]", fontsize=style.FONT)
    _legend(sheet, len(modes), chosen, view, scattered=scattered)
    return sheet


def _chosen(modes: Modes, which: Sequence[int] | None) -> list[int]:
    if which is None:
        vibrations = [index for index, kind in enumerate(modes.kinds) if kind == OSCILLATORY]
        return (vibrations or list(range(len(modes))))[:MODES_SHOWN]
    return [index_of_mode(number, modes.kinds) for number in which]


def station_shape(modes: Modes, index: int, view: ShapeView) -> NDArray[np.complex128]:
    """Complex mode shape at the stations (nodes along the axis), shape (n_stations,), its largest value turned to 1."""
    place = {node: index for index, node in enumerate(modes.nodes)}
    referred = modes.shapes[:, index] * view.factors
    shape = np.array([referred[place[station.node]] for station in view.axis.stations], dtype=complex)
    largest = shape[np.argmax(np.abs(shape))] if shape.size else 1.0
    return np.asarray(shape / largest if largest else shape, dtype=complex)


def phase_scatter(shape: NDArray[np.complex128]) -> float:
    """Mean distance in degrees of the nodes' phases from 0 or 180, weighted by amplitude.

    Parameters
    ----------
    shape : array of complex, (stations,)
        Real where it is largest.

    Examples
    --------
    >>> phase_scatter(np.array([1, -1, 0.5j])), phase_scatter(np.array([1, 1j]))
    (18.0, 45.0)
    """
    size = np.abs(shape)
    if not size.any():
        return 0.0
    off = np.abs(np.degrees(np.arctan2(shape.imag, np.abs(shape.real))))
    return float(np.average(off, weights=size))


def _panel(axes: Axes, modes: Modes, index: int, view: ShapeView, conventions: Conventions) -> bool:
    """Draw one mode shape in its panel, and return whether its imaginary part is shown."""
    shape = station_shape(modes, index, view)
    x = np.array([station.x for station in view.axis.stations])
    out = phase_scatter(shape)
    style.style_axes(axes)
    axes.axhline(0, color=style.MUTED, linewidth=0.8)
    _marks(axes, view.axis)
    if out > OUT_OF_PHASE:
        _curve(axes, view.axis, x, shape.imag, IMAGINARY, style.PAPER, 0.9)
        axes.text(0.5, 0.03, f"phases scatter by {out:.0f}°", transform=axes.transAxes, ha="center",
                  fontsize=style.SMALL - 1, color=style.MUTED)  # fmt: skip
    _curve(axes, view.axis, x, shape.real, REAL, REAL, 1.6)
    axes.vlines(x, 0, shape.real, color=REAL, linewidth=0.6, alpha=0.5)
    axes.set_ylim(-LIMIT, LIMIT)
    axes.set_xlim(-0.5, view.axis.end + 0.5)
    axes.set_title(_title(modes, index, conventions), fontsize=style.FONT, color=style.INK)
    _name_nodes(axes, view.axis)
    return out > OUT_OF_PHASE


def _curve(
    axes: Axes, axis: Axis, x: NDArray[np.float64], part: NDArray[np.float64], color: str, face: str, width: float
) -> None:
    for join in axis.joins:
        ends = [join.first, join.second]
        axes.plot(x[ends], part[ends], color=color, linewidth=width, linestyle=JOINS[join.kind], label="_join")
    again = np.array([station.again for station in axis.stations], dtype=bool)
    size = 4.5 if len(x) <= MANY_NODES else 2.5
    axes.plot(x[again], part[again], "o", color=color, markerfacecolor=style.PAPER, markersize=size - 1, zorder=3)
    axes.plot(x[~again], part[~again], "o", color=color, markerfacecolor=face, markersize=size, zorder=3)


def _marks(axes: Axes, axis: Axis) -> None:
    """Draw in the panel of a mode shape the borders between branches, and the gears with their ratios."""
    for border in axis.borders:
        axes.axvline(border, color=style.FAINT, linewidth=4.0, zorder=0.5)
    before, low = -CLOSE_GEARS, False
    for join in (join for join in axis.joins if join.kind == "gear"):
        middle = (axis.stations[join.first].x + axis.stations[join.second].x) / 2
        # Texts of gears beside each other stand at two heights.
        low = middle - before < CLOSE_GEARS and not low
        before = middle
        axes.axvline(middle, color=style.MUTED, linewidth=0.8, linestyle=(0, (1, 2)), zorder=0.6)
        text = axes.text(middle, LIMIT - (0.22 if low else 0.02), f"$\\tau$ = {join.label}", ha="center", va="top")
        text.set(fontsize=style.SMALL - 1.5, color=style.MUTED)
        text.set_bbox({"facecolor": style.PAPER, "edgecolor": "none", "pad": 0.6})


def _name_nodes(axes: Axes, axis: Axis) -> None:
    stations = axis.stations[:: -(-len(axis.stations) // MANY_NODES) or 1]
    names = [f"({station.node})" if station.again else station.node for station in stations]
    crowded = len(names) * max((len(name) for name in names), default=0) > FEW_LETTERS
    turned: dict[str, Any] = {"rotation": 45, "ha": "right", "rotation_mode": "anchor"} if crowded else {}
    axes.set_xticks([station.x for station in stations], names, fontsize=style.SMALL - 1, **turned)


def _title(modes: Modes, index: int, conventions: Conventions) -> str:
    if modes.kinds[index] == "rigid body":
        return modes.names[index]
    if modes.kinds[index] == "real pole":
        return f"{modes.names[index]}, {modes.eigenvalues[index].real:.4g} rad/s"
    frequency = modes.natural_frequencies[index] * conventions.frequency_scale
    ratio = 100 * modes.damping_ratios[index]
    return f"{modes.names[index]}: {frequency:.4g} {conventions.frequency}, zeta = {ratio:.3g} %"


def _legend(sheet: style.Sheet, total: int, chosen: Sequence[int], view: ShapeView, *, scattered: bool) -> None:
    handles = [Line2D([], [], color=REAL, marker="o", markersize=4.5, linewidth=1.6)]
    names = ["real part" if scattered else "shape"]
    if scattered:
        handles.append(Line2D([], [], color=IMAGINARY, marker="o", markerfacecolor=style.PAPER, markersize=4.5))
        names.append("imaginary part")
    words = {"gear": "gear", "box": "planetary set, differential"}
    for kind in sorted({join.kind for join in view.axis.joins} & set(words), reverse=True):
        handles.append(Line2D([], [], color=REAL, linestyle=JOINS[kind], linewidth=1.6))
        names.append(words[kind])
    remarks = [f"no fixed ratio to {comma_list(view.free, FEW_NAMES)}"] if view.free else []
    remarks += [f"own angle of {comma_list(view.standing, FEW_NAMES)}"] if view.standing else []
    remarks += [f"{len(view.idle)} idle gear wheels not shown"] if view.idle else []
    remarks += [f"{len(chosen)} of {total} modes shown"] if len(chosen) < total else []
    handles += [Line2D([], [], linestyle="") for _ in remarks]
    names += remarks
    columns = max(1, min(5, int(MOST_LETTERS / (max(map(len, names)) + HANDLE))))
    sheet.legend(columns, handles, names)


# Plot of the relative amplitudes of modes along the lines of their Holzer tables, with the nodes of vibration.

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


def relative_amplitudes(tables: Sequence[HolzerTable]) -> Figure:
    """Figure of relative amplitudes of the masses, a panel per mode, the first mass at 1, nodes of vibration marked.

    Lines follow each other as in the Holzer table; a branch ends with the mass it joins, in brackets. Amplitudes are
    referred to one shaft, so that a gear (dotted) makes no step. The number at a node of vibration says how much of the
    twist between the two masses lies before it, in percent; a ring without number is a mass at rest.

    Parameters
    ----------
    tables : sequence of HolzerTable
        Of one drivetrain.

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
        raise UsageError("there is no Holzer table to draw: give those of the modes", kind="missing-data")
    sheet, panels = style.stacked_panels(0.2 + PANEL_HEIGHT * len(tables) + NAMES_HEIGHT, [""] * len(tables))
    for panel, holzer in zip(panels, tables, strict=True):
        _draw(panel, holzer)
    places = [(x, name) for line in _lines(tables[0]) for x, name in zip(line.x, line.names, strict=True)]
    shown = places[:: -(-len(places) // MOST_NAMES)]
    panels[-1].set_xticks([x for x, _ in shown], [name.replace("_", " ") for _, name in shown])
    panels[-1].tick_params(axis="x", labelrotation=45)
    for label in panels[-1].get_xticklabels():
        label.set(ha="right", rotation_mode="anchor", fontsize=style.SMALL - 1)
    return sheet.figure


def _lines(holzer: HolzerTable) -> list[_Line]:
    lines = []
    x = 0.0
    for branch in holzer.branches:
        line = _Line()
        stations = [*branch.stations, *([holzer.station(branch.joins)] if branch.joins else [])]
        for place, mass in enumerate(stations):
            again = bool(branch.joins) and place == len(branch.stations)
            line.x.append(x)
            line.names.append(f"({mass.node})" if again else mass.node)
            line.theta.append(mass.amplitude / mass.ratio if mass.ratio == mass.ratio else mass.amplitude)
            line.rigid.append(mass.link is not None and mass.link.rigid)
            x += 1.0
        x += BRANCH_STEP - 1.0
        lines.append(line)
    return lines


def _draw(axes: Axes, holzer: HolzerTable) -> None:
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
    # theta is straight over the compliance of a link: at a share of it the line drawn is at that share, too.
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

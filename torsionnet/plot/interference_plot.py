"""Interference (Campbell) diagram of natural frequencies and orders over speed, and star diagrams of the orders."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

import torsionnet.plot.drawing.style as style
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.linear.modes.mode_pairs import VibrationMode
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed, CriticalSpeeds
from torsionnet.machinery.orders.vector_sums import StarDiagram, VectorSums, order_names
from torsionnet.plot.drawing.labels import speed_label
from torsionnet.plot.drawing.style import GivenAxes

# Interference (Campbell) diagram with natural frequencies and orders over speed, and marks at their crossings.

SMALLEST_DOT, LARGEST_DOT = 14.0, 150.0
"""Areas in square points (1/72 inch) of the marks of crossings with the smallest and the largest generalised force."""
HALO = withStroke(linewidth=2.5, foreground=style.PAPER)
LEADER = {"arrowstyle": "-", "color": style.MUTED, "linewidth": 0.6, "relpos": (0, 0.4), "shrinkA": 0, "shrinkB": 0}
"""Arrow style of matplotlib for the thin line that joins a label standing apart with the line of its mode."""
HEIGHT = 4.6
"""Height of the figure in inches."""
FARTHEST_LABEL = 2.0
"""Heights of a label by which one may stand above the line of its mode on linear axes; where one has to stand farther
above, many modes lie in a small part of the axis, and both axes are logarithmic."""
BELOW = 0.7
"""Ratio of the lower end of a logarithmic axis to the lowest mode or speed on it."""
MOST_EVEN_TICKS = 8.0
"""Ratio of the ends of a logarithmic axis of speeds up to which its ticks are evenly spaced in speed."""
SPEED_POINTS = 601
"""Number of speeds at which the frequency of an order is calculated to draw its line: steps well below the width of a
line on paper."""
HEADROOM, NEAREST, NARROWEST = 1.12, 0.036, 0.036
"""Factor from the highest crossing to the end of the frequency axis, and least distances of two labels, upright as a
share of the axes' height and sideways of their width."""
INDENT = 0.035
"""Distance from the left edge, as a share of the axes' width, of a label that stands apart from its mode's line."""
GROUND = {"boxstyle": "square,pad=0.1", "facecolor": style.PAPER, "edgecolor": "none"}
"""Box of matplotlib behind a label that stands apart, so that no line of another mode crosses its letters."""


def interference_diagram(
    result: CriticalSpeeds, *, up_to: float | None = None, title: str | None = None, ax: Axes | None = None
) -> Figure:
    """Interference (Campbell) diagram, frequency over speed, modes as level lines, orders as rays, crossings marked.

    The area of a mark grows with the generalised force of that crossing over the largest one; a cross is a crossing
    that is not excited in this condition. The operating range is shaded, its margins in another colour. Where most
    modes lie at the foot of the frequency axis, both axes are logarithmic, and orders parallel lines.

    Parameters
    ----------
    result : CriticalSpeeds
    up_to : float, optional
        Upper end of the frequencies, Hz; by default above the highest mode that an order meets in the range.
    title : str, optional
        By default that of the result.
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    sheet, axes = style.one_panel(HEIGHT, ax)
    low, high = (speed * RPM for speed in result.speed_range)
    # Crossings that are neither excited nor in the range or its margin do not lengthen the axes.
    near = [
        crossing
        for crossing in result.crossings
        if crossing.excited is not False or crossing.margin <= (crossing.required or 0.0)
    ]
    counted = near or result.crossings
    speeds = [speed for crossing in counted if math.isfinite(speed := _speed(crossing))]
    end = 1.06 * max([high, *speeds])
    met = {crossing.mode.number for crossing in counted}
    # Modes that follow the speed have other frequencies at their crossings than at the operating point.
    tops = [_natural(crossing.mode) for crossing in counted]
    tops += [_natural(mode) for mode in result.modes if mode.number in met or (mode is result.modes[0] and not met)]
    if not tops:  # nothing vibrates: the lines of the orders alone
        tops = [float(np.abs(line.frequency(np.array(result.speed_range))).max()) for line in result.lines] or [1.0]
    top = up_to or HEADROOM * max(tops)
    axes.set(xlim=(0, end), ylim=(0, top))
    if _is_crowded(result, top):
        _set_logarithmic(axes, BELOW * min([low, *speeds]), BELOW * min(filter(None, map(_natural, result.modes))))
    _shade(axes, result, low, high)
    _modes(axes, result, top)
    _orders(axes, result, top, end)
    _marks(axes, [crossing for crossing in result.crossings if _natural(crossing.mode) <= top], _names(result))
    axes.set_xlabel(speed_label(result.reference))
    axes.set_ylabel("frequency [Hz]")
    sheet.legend(3)
    return sheet.titled(result.title if title is None else title)


def _is_crowded(result: CriticalSpeeds, top: float) -> bool:
    """Whether names of modes would stand far above their lines on linear axes with this upper end."""
    shown = sorted(frequency for mode in result.modes if (frequency := mode.natural_frequency) <= top)
    gap = NEAREST * top
    return any(height - value > FARTHEST_LABEL * gap for value, height in zip(shown, _apart(shown, gap), strict=True))


def _set_logarithmic(axes: Axes, slowest: float, lowest: float) -> None:
    """Make both axes logarithmic, from a speed in r/min and a frequency in Hz on, with plain numbers at their ticks."""
    axes.set(xscale="log", yscale="log", xlim=(slowest, axes.get_xlim()[1]), ylim=(lowest, axes.get_ylim()[1]))
    style.log_ticks(axes.xaxis, *axes.get_xlim())
    style.log_ticks(axes.yaxis, *axes.get_ylim())
    if axes.get_xlim()[1] < MOST_EVEN_TICKS * slowest:
        axes.xaxis.set_major_locator(MaxNLocator(7))


def _share(axes: Axes, speed: float, frequency: float) -> tuple[float, float]:
    """Place of a speed and a frequency as shares of the axes' width and height, whatever their scales."""
    x, y = axes.transAxes.inverted().transform(axes.transData.transform((speed, frequency)))
    return float(x), float(y)


def _names(result: CriticalSpeeds) -> list[str]:
    """List of the names of the excitations of an interference diagram, in the order of their colours."""
    return list(dict.fromkeys(line.excitation for line in result.lines))


def _natural(mode: VibrationMode) -> float:
    """Natural frequency in Hz of a mode as it is marked: with damping if it is known."""
    return mode.undamped_frequency if math.isnan(mode.natural_frequency) else mode.natural_frequency


def _speed(crossing: CriticalSpeed) -> float:
    overdamped = math.isnan(crossing.mode.natural_frequency)
    return (crossing.undamped_speed if overdamped else crossing.natural_speed) * RPM


def _shade(axes: Axes, result: CriticalSpeeds, low: float, high: float) -> None:
    margins = [crossing.required for crossing in result.crossings if crossing.required]
    axes.axvspan(low, high, color=style.PALETTE[5], alpha=0.18, linewidth=0, label="operating range")
    if margins:
        widest = max(margins)
        label = f"margin, up to {100 * widest:g} %"
        axes.axvspan(low * (1 - widest), low, color=style.PALETTE[6], alpha=0.16, linewidth=0, label=label)
        axes.axvspan(high, high * (1 + widest), color=style.PALETTE[6], alpha=0.16, linewidth=0)


def _modes(axes: Axes, result: CriticalSpeeds, top: float) -> None:
    first = True
    for mode in result.modes:
        if mode.undamped_frequency <= top:
            axes.axhline(mode.undamped_frequency, color=style.MUTED, linewidth=0.9, linestyle=(0, (5, 3)), zorder=1.5,
                         label="undamped natural frequency" if first else None)  # fmt: skip
            first = False
    shown = sorted(
        (mode for mode in result.modes if mode.natural_frequency <= top), key=lambda mode: mode.natural_frequency
    )
    for number, mode in enumerate(shown):
        axes.axhline(mode.natural_frequency, color=style.INK, linewidth=1.4, zorder=1.6,
                     label=r"damped, $|\lambda|/2\pi$" if not number else None)  # fmt: skip
    start = axes.get_xlim()[0]
    places = _label_places([_share(axes, start, mode.natural_frequency)[1] for mode in shown], NEAREST)
    for mode, (height, moved) in zip(shown, places, strict=True):
        axes.annotate(f"mode {mode.number}: {mode.natural_frequency:.4g} Hz", (start, mode.natural_frequency),
                      xytext=(INDENT if moved else 0.004, height + 0.1 * NEAREST), textcoords="axes fraction",
                      fontsize=style.SMALL - 1, color=style.INK, path_effects=[HALO], va="bottom", zorder=4,
                      bbox=GROUND if moved else None, arrowprops=LEADER if moved else None)  # fmt: skip


def _label_places(values: Sequence[float], gap: float) -> list[tuple[float, bool]]:
    """List of label positions in the unit of rising values, and whether each stands apart from its own level line.

    A label stands apart that had to move up, and one whose letters the next level line would cross.
    """
    heights = _apart(values, gap)
    above = (*values, math.inf)[1:]
    return [
        (height, height > value or height < next_line < height + gap)
        for value, height, next_line in zip(values, heights, above, strict=True)
    ]


def _apart(values: Sequence[float], gap: float) -> list[float]:
    """List of label positions in the unit of rising values, moved up until neighbours are at least ``gap`` apart."""
    places: list[float] = []
    for value in values:
        places.append(max(value, places[-1] + gap) if places else value)
    return places


def _orders(axes: Axes, result: CriticalSpeeds, top: float, end: float) -> None:
    """Draw the line of each order over speed in its excitation's colour, and its name where it leaves the axes."""
    names = _names(result)
    labelled: list[tuple[float, float]] = []
    speeds = np.linspace(axes.get_xlim()[0], end, SPEED_POINTS)
    # Whole orders come first, fixed frequencies last: who comes first has a name where names are close.
    for line in sorted(result.lines, key=lambda line: (line.order <= 0, line.order != round(line.order), line.order)):
        frequencies = np.abs(line.frequency(speeds / RPM))
        seen = np.flatnonzero(frequencies <= top)
        if not len(seen):
            continue
        color = style.PALETTE[names.index(line.excitation) % len(style.PALETTE)]
        shown = np.where(frequencies <= top, frequencies, np.nan)
        axes.plot(speeds, shown, color=color, linewidth=0.7, alpha=0.75, zorder=1.4)
        last = (float(speeds[seen[-1]]), float(frequencies[seen[-1]]))
        at = _share(axes, *last)
        if all(abs(at[0] - x) > NARROWEST or abs(at[1] - y) > NEAREST for x, y in labelled):
            labelled.append(at)
            above = last[0] < end
            axes.annotate(line.words, last, xytext=(0, 2) if above else (2, 0), textcoords="offset points",
                          fontsize=style.SMALL - 1, color=color, clip_on=False,
                          ha="center" if above else "left", va="bottom" if above else "center")  # fmt: skip
    for number, name in enumerate(names):
        axes.plot([], [], color=style.PALETTE[number % len(style.PALETTE)], linewidth=1.2, label=_label(result, name))


def _label(result: CriticalSpeeds, name: str) -> str:
    ordered = any(line.order for line in result.lines if line.excitation == name)
    return f"orders of {name}" if ordered else name


def _marks(axes: Axes, crossings: list[CriticalSpeed], names: list[str]) -> None:
    shown = [crossing for crossing in crossings if math.isfinite(_speed(crossing))]
    largest = max(
        (speed.generalised_force for speed in shown if speed.excited and speed.generalised_force > 0), default=1.0
    )
    for excited, marker in ((True, "o"), (False, "x")):
        here = [crossing for crossing in shown if bool(crossing.excited) is excited]
        if not here:
            continue
        sizes = [np.nan_to_num(crossing.generalised_force) / largest for crossing in here]
        areas = [SMALLEST_DOT + (LARGEST_DOT - SMALLEST_DOT) * size * excited for size in sizes]
        colors = [style.PALETTE[names.index(crossing.excitation) % len(style.PALETTE)] for crossing in here]
        speeds, frequencies = map(_speed, here), (_natural(crossing.mode) for crossing in here)
        axes.scatter([*speeds], [*frequencies], s=areas, marker=marker, c=colors, linewidths=0.9, alpha=0.8, zorder=3)
        label = "excited; area: generalised force" if excited else "not excited in this condition"
        axes.scatter([], [], s=36, marker=marker, color=style.INK, linewidths=0.9, label=label)


# Plot of phase-vector (star) diagrams of the orders that excite a mode.

PANELS_PER_ROW = 4
"""Number of star diagrams side by side; more would be too small for the numbers of the cylinders."""
LONGEST_TITLE = 80
"""Largest number of letters in a line of the title above star diagrams."""
COVERING_COSINE = 0.95
"""Cosine of the angle between a cylinder's vector and the sum, above which the sum would cover that vector's label."""


def star_diagrams(stars: Sequence[StarDiagram], *, title: str | None = None, ax: GivenAxes = None) -> Figure:
    """Figure of the cylinders' phase vectors in colour and their sum in black, a diagram for orders of equal vectors.

    Orders with equal vectors share a diagram. Angles are those of the torques, zero to the right, counter-clockwise;
    the circle is one cylinder at the largest amplitude.

    Parameters
    ----------
    stars : sequence of StarDiagram
    title : str, optional
        By default that of the first.
    ax : sequence of Axes, optional
        Axes to draw into, one for each group of orders with equal vectors; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        There are none.
    """
    if not stars:
        raise UsageError(
            "there is no star diagram to draw: no order meets this mode in or near the operating range",
            kind="missing-data",
        )
    groups = _alike(stars)
    across = min(PANELS_PER_ROW, len(groups))
    height = 0.6 + math.ceil(len(groups) / across) * style.WIDTH / PANELS_PER_ROW * 1.16
    orders_of = [", ".join(f"{star.order:g}" for star in group) for group in groups]
    shows = [f"orders {orders}" for orders in orders_of]
    sheet, _ = style.grid_panels(style.WIDTH, height, shows, ax, columns=across)
    for panel, group, orders in zip(sheet.panels, groups, orders_of, strict=True):
        draw_star(panel, group[0])
        text = f"{group[0].excitation} {orders}\nsum {abs(group[0].sum):.3g}"
        panel.set_title(text, fontsize=style.SMALL, color=style.INK, pad=3)
    words = "numbers: cylinders; black: their sum; circle: one cylinder"
    sheet.label_all(x=words, fontsize=style.SMALL, color=style.MUTED)
    return sheet.titled(textwrap.fill(stars[0].title if title is None else title, LONGEST_TITLE))


def _alike(stars: Sequence[StarDiagram]) -> list[list[StarDiagram]]:
    """Lists of star diagrams, each of the diagrams of one excitation with equal vectors."""
    groups: list[list[StarDiagram]] = []
    for star in stars:
        for group in groups:
            same = group[0].excitation == star.excitation and group[0].labels == star.labels
            if same and np.allclose(group[0].vectors, star.vectors, atol=1e-6):
                group.append(star)
                break
        else:
            groups.append([star])
    return groups


def draw_star(axes: Axes, star: StarDiagram) -> None:
    """Draw in the axes the phase vectors of one star diagram with the cylinders' numbers, and the sum in black."""
    limit = 1.3 * max(1.0, abs(star.sum))
    axes.set(xlim=(-limit, limit), ylim=(-limit, limit), aspect="equal", xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)
    turn = np.linspace(0, 2 * np.pi, 181)
    axes.plot(np.cos(turn), np.sin(turn), color=style.FAINT, linewidth=0.8, zorder=1)
    together: dict[float, list[str]] = {}
    for number, (label, vector) in enumerate(zip(star.labels, star.vectors, strict=True)):
        if vector:
            _arrow(axes, vector, style.PALETTE[number % len(style.PALETTE)], 1.3)
            together.setdefault(round(float(np.angle(vector)), 4) % round(2 * math.pi, 4), []).append(label)
    for angle, labels in together.items():
        x, y = math.cos(angle), math.sin(angle)
        # The sum's arrow would cover a text that lies in its direction.
        covered = abs(star.sum) > 1 and math.cos(angle - float(np.angle(star.sum))) > COVERING_COSINE
        beside = (-9 * y, -9 * abs(x)) if covered else (7 * x, 7 * y)
        axes.annotate(",".join(labels), (x, y), xytext=beside, textcoords="offset points", ha="left" if covered else
                      "center", va="center", fontsize=style.SMALL - 1)  # fmt: skip
    if abs(star.sum) > 1e-9:
        _arrow(axes, star.sum, style.INK, 2.0)


def _arrow(axes: Axes, vector: complex, color: str, width: float) -> None:
    properties = {"arrowstyle": "-|>", "color": color, "linewidth": width, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (vector.real, vector.imag), xytext=(0, 0), arrowprops=properties, zorder=3)


# Plot of the phase stars of an engine, a row for each mode and a column for each group of orders.

PANEL = 1.05
"""Height in inches of the panel of one phase star."""
MOST_ORDERS_NAMED = 3
"""Largest number of orders of a group that are named above its column; the others are in the table."""


def phase_stars(
    sums: VectorSums, *, modes: Sequence[int] | None = None, groups: Sequence[Sequence[float]] | None = None
) -> Figure:
    """Figure of the cylinders' phase vectors and, in black, their sum, a row per mode, a column per group of orders.

    Angles are those of the torques, zero to the right, counter-clockwise; the circle is one cylinder at the largest
    amplitude of the mode. Of a group the star of its first order is drawn.

    Parameters
    ----------
    sums : VectorSums
    modes : sequence of int, optional
        By default all.
    groups : sequence of sequences of float, optional
        By default all groups.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.machinery.orders.vector_sums import vector_sums
    >>> ship = tn.load("two_stroke_ship").configured("normal")
    >>> len(phase_stars(vector_sums(ship, "engine", modes=[1, 2])).axes)
    8
    """
    rows, columns = tuple(modes or sums.modes), tuple(groups or sums.groups())
    figure = style.new_figure(style.WIDTH, 0.3 + (PANEL + 0.2) * len(rows))
    panels = figure.subplots(len(rows), len(columns), squeeze=False)
    for line, mode in zip(panels, rows, strict=True):
        for panel, group in zip(line, columns, strict=True):
            star = sums.stars[mode, group[0]]
            draw_star(panel, star)
            more = ", …" if len(group) > MOST_ORDERS_NAMED else ""
            orders = order_names(group[:MOST_ORDERS_NAMED]) + more
            head = f"order {orders}\n" if mode == rows[0] else ""
            panel.set_title(f"{head}mode {mode}: {abs(star.sum):.3g}", fontsize=style.SMALL - 1, pad=2)
    return figure

"""Plots of designs: dampers, optima, best compromises and robust optima."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.number_text import typeset_unit
from torsionnet.machinery.design.damper_optimum import DamperOptimum, DesignParameter
from torsionnet.plot.drawing.labels import axis_unit
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.plot.study.study_axes import axis_label, is_wide, legend_below, log_axis, parameter_rows, text_rows
from torsionnet.study.design.best_damper import DamperOverConditions
from torsionnet.study.design.design_goals import DesignObjective, DesignOptimum
from torsionnet.study.design.pareto import ParetoFront
from torsionnet.study.design.robust_optimum import RobustOptimum
from torsionnet.study.study import IN_SI, ShownUnits

# Plots of design optima, parameters within bounds, dampers over conditions, Pareto fronts and robust optima.

WIDE_BOUNDS = 3.0
"""Ratio of a parameter's upper to its lower bound above which its place between them is logarithmic."""
LABEL_WIDTH = 2.6
"""Largest width in inches of a line of an axis label."""
NEAR_BOUND = 0.2
"""Distance of a value from a bound, as a share of the range, below which its text is moved inwards."""
LABELLED: dict[str, Any] = {"fontsize": style.SMALL, "color": style.INK}


def design_optimum(
    result: DesignOptimum, *, units: ShownUnits = IN_SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of parameters within their bounds, as given and optimal, and of the best objective over the designs tried.

    Parameters
    ----------
    result : DesignOptimum
    units : ShownUnits, optional
        By default SI.
    title : str, optional
        By default that of the result.
    ax : sequence of Axes, optional
        Axes to draw into, for parameters and objective; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    height, shows = 1.6 + max(1.4, 0.4 * len(result.parameters)), [["parameters", "best objective"]]
    sheet = style.mosaic_panels(height, shows, ax, width_ratios=(1.6, 1))
    places, course = sheet.panels
    _draw_places(places, result.parameters, units)
    calculated, merits = result.history.T
    scale, label = (
        (1.0, "squared deviations [-]") if result.goals.targets else _shown(result.goals.objectives[0], units)
    )
    sign = 1.0 if result.goals.targets else result.goals.objectives[0].sign
    course.step(calculated, sign * scale * merits, where="post", **style.line_style(0))
    course.set_xlabel("designs calculated")
    course.set_ylabel(label)
    if result.goals.targets and is_wide(merits[np.isfinite(merits)]):
        log_axis(course, "y", merits.min(), merits.max())
    return sheet.titled(f"{result.title}: optimum".removeprefix(": ") if title is None else title)


def _draw_places(axes: Axes, parameters: tuple[DesignParameter, ...], units: ShownUnits) -> None:
    """Draw in a panel each parameter, as given and optimal, on a line from its lower to its upper bound."""
    style.style_axes(axes)
    for row, parameter in enumerate(parameters):
        axes.plot([0, 1], [row, row], color=style.FAINT, linewidth=5, solid_capstyle="round", zorder=1)
        given, best = ("as given", "found") if row == 0 else ("", "")
        axes.plot(
            [_place(parameter, parameter.start)], [row], "o", color=style.MUTED, mfc=style.PAPER, label=given, zorder=2
        )
        axes.plot([_place(parameter, parameter.value)], [row], "o", color=style.PALETTE[1], label=best, zorder=3)
        text = _value(parameter, units)
        side = (
            "left"
            if _place(parameter, parameter.value) < NEAR_BOUND
            else "right"
            if _place(parameter, parameter.value) > 1 - NEAR_BOUND
            else "center"
        )
        axes.annotate(
            text, (_place(parameter, parameter.value), row), (0, 6), textcoords="offset points", ha=side, **LABELLED
        )
    parameter_rows(axes, [parameter.name for parameter in parameters], style.WIDTH / 3)
    axes.set_ylim(len(parameters) - 0.4, -0.8)
    axes.set_xticks([0, 1], ["lower bound", "upper bound"])
    axes.set_xlim(-0.06, 1.06)
    axes.legend(fontsize=style.SMALL, frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))


def _value(parameter: DesignParameter, units: ShownUnits) -> str:
    value = parameter.value * units.scale(parameter.name, parameter.unit)
    unit = units.unit(parameter.name, parameter.unit)
    return f"{style.tick_text(float(f'{value:.4g}'))} {typeset_unit(unit)}".strip()


def _shown(objective: DesignObjective, units: ShownUnits) -> tuple[float, str]:
    """Factor from SI to the unit shown, and text of the axis label, of an objective of a design."""
    first = objective.quantities[0]
    return units.scale(first), axis_label(objective.name, units.unit(first), LABEL_WIDTH)


def _place(parameter: DesignParameter, value: float) -> float:
    """Place of a value between the bounds of its parameter, from 0 at the lower to 1 at the upper one."""
    is_log = parameter.lower > 0 and parameter.upper > WIDE_BOUNDS * parameter.lower
    low, high, at = (
        np.log([parameter.lower, parameter.upper, value]) if is_log else (parameter.lower, parameter.upper, value)
    )
    return float(np.clip((at - low) / (high - low), -0.04, 1.04))


def damper_over_conditions(
    result: DamperOverConditions, *, units: ShownUnits = IN_SI, title: str | None = None, ax: Axes | None = None
) -> Figure:
    """Figure of the largest vibration level in every condition, the damper as given, best for all, and best for each.

    Parameters
    ----------
    result : DamperOverConditions
    units : ShownUnits, optional
        By default SI.
    title : str, optional
        By default that of the result.
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    sheet, axes = style.one_panel(1.4 + 0.45 * len(result.conditions), ax)
    rows = np.arange(len(result.conditions))
    marks = (("as given", "before", "s"), ("best for all", "after", "o"), ("best alone", "alone", "|"))
    scale, unit = (
        units.scale(result.channel.name, result.channel.unit),
        units.unit(result.channel.name, result.channel.unit),
    )
    for number, (label, what, mark) in enumerate(marks):
        levels = [scale * getattr(condition, what).level for condition in result.conditions]
        axes.plot(levels, rows, mark, markersize=7, color=style.PALETTE[(4, 1, 0)[number]], label=label)
    axes.axvline(scale * result.worst.after.level, color=style.MUTED, linewidth=0.8)
    text_rows(axes, [condition.condition or result.title for condition in result.conditions], style.WIDTH)
    axes.set_xlabel(f"largest {axis_label(result.channel.name, unit)}")
    legend_below(sheet, *axes.get_legend_handles_labels())
    best = ", ".join(f"{parameter.name} = {_value(parameter, units)}" for parameter in result.parameters)
    return sheet.titled(f"{result.title}: {best}" if title is None else title)


def pareto_front(
    result: ParetoFront, *, units: ShownUnits = IN_SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of the objectives of the designs of a Pareto front, each over the one before, a panel for each pair.

    Parameters
    ----------
    result : ParetoFront
    units : ShownUnits, optional
        By default SI.
    title : str, optional
        By default that of the result.
    ax : sequence of Axes, optional
        Axes to draw into, one for each pair of objectives; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = [objective.name for objective in result.objectives]
    shows = [f"{up} over {across}" for across, up in pairwise(names)]
    sheet, _ = style.grid_panels(style.WIDTH, 3.6, shows, ax, columns=len(shows))
    for number, axes in enumerate(sheet.panels):
        style.style_axes(axes)
        (x, across_label), (y, up_label) = (
            _shown(objective, units) for objective in result.objectives[number : number + 2]
        )
        across, up = result.values[:, number] * x, result.values[:, number + 1] * y
        axes.plot(across, up, "o", markersize=4, color=style.PALETTE[0], label="best compromises")
        middle = result.compromise
        axes.plot(across[middle], up[middle], "D", color=style.PALETTE[1], label="near the best of all")
        if np.isfinite(result.given[number : number + 2]).all():
            given = result.given[number : number + 2] * (x, y)
            axes.plot(*given, "s", color=style.MUTED, mfc=style.PAPER, label="as given")
        axes.set_xlabel(f"{across_label}, {result.objectives[number].sense}d")
        axes.set_ylabel(f"{up_label}, {result.objectives[number + 1].sense}d")
    legend_below(sheet, *sheet.panels[0].get_legend_handles_labels())
    return sheet.titled(f"{result.title}: best compromises".removeprefix(": ") if title is None else title)


def robust_optimum(
    result: RobustOptimum, *, units: ShownUnits = IN_SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of each design's mean and standard deviation under tolerances, and percent of variants within the limits.

    Parameters
    ----------
    result : RobustOptimum
    units : ShownUnits, optional
        By default SI.
    title : str, optional
        By default that of the result.
    ax : sequence of Axes, optional
        Axes to draw into, one for each quantity and, with limits, the share of variants; by default those of a new
        figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    shown = list(result.designs[0].mean)
    shows = [*shown, *(["share that keeps all limits"] if result.limited else [])]
    sheet, _ = style.grid_panels(style.WIDTH, 3.2, shows, ax, columns=len(shows))
    every = sheet.panels
    labels = [design.label for design in result.designs]
    for name, axes in zip(shown, every, strict=False):
        means, deviations = (
            [getattr(design, what)[name] for design in result.designs] for what in ("mean", "deviation")
        )
        scale = units.scale(name)
        axes.errorbar(
            range(len(labels)), scale * np.array(means), scale * np.array(deviations), fmt="o", capsize=5,
            color=style.PALETTE[0],
        )  # fmt: skip
        axes.set_ylabel(f"{axis_label(name, units.unit(name), LABEL_WIDTH)}\nmean and standard deviation")
    if result.limited:
        shares = 100 * np.array([design.share_kept for design in result.designs])
        ends = np.abs(shares[:, 1:].T - shares[:, 0])
        every[-1].errorbar(range(len(labels)), shares[:, 0], ends, fmt="o", capsize=5, color=style.PALETTE[2])
        every[-1].set_ylabel("keep all limits [%]\n95 % confidence")
    for axes in every:
        style.style_axes(axes)
        axes.set_xticks(range(len(labels)), labels)
        axes.set_xlim(-0.5, len(labels) - 0.5)
    return sheet.titled(f"{result.title}: robust optimum".removeprefix(": ") if title is None else title)


# Plot of a damper design, the vibration level over frequency or speed, and its maximum over each damper value.

TOP_FACTOR, BOTTOM_FACTOR = 3.0, 300.0
"""Ratio of the top of the level axis to the largest vibration level, and largest ratio of that level to the bottom."""
WIDE_RANGE = 3.0
"""Ratio of the largest to the smallest value on an axis of a damper plot above which the axis is logarithmic."""


MARK: dict[str, Any] = {"markersize": 6, "zorder": 5, "clip_on": False}


def damper_design(
    result: DamperOptimum, *, conventions: Conventions = SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of vibration levels over frequency or speed with the damper as given, optimal, undamped and locked.

    Below, the largest level over each value.

    Parameters
    ----------
    result : DamperOptimum
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the result.
    ax : sequence of Axes, optional
        Axes to draw into, for the levels, then one for each damper value; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    largest = max(result.before.level, result.after.level)
    scale, unit = axis_unit(result.channel.unit, largest, conventions)
    below = [f"maximum over {parameter.name}" for parameter in result.parameters]
    sheet = style.mosaic_panels(6.4, [["levels"] * len(below), below], ax, height_ratios=(1.5, 1))
    levels, *effects = sheet.panels
    _draw_levels(levels, result, scale, unit)
    for number, axes in enumerate(effects):
        style.share_axis(axes, effects[0], "sharey")
        _draw_effect(axes, result, number, scale)
    effects[0].set_ylabel(f"its maximum [{unit}]")
    return sheet.titled(result.title if title is None else title)


def _draw_levels(axes: Axes, result: DamperOptimum, scale: float, unit: str) -> None:
    for number, curve in enumerate(result.curves):
        axes.plot(curve.points, curve.levels * scale, label=curve.label, **style.line_style(number))
    for label, mark, points in (("maximum", "o", result.peaks), ("all films meet", "x", result.fixed_points)):
        if points:
            sizes = [point.level * scale for point in points]
            axes.plot([point.point for point in points], sizes, mark, color=style.INK, label=label, **MARK)
    top = max(result.before.level, result.after.level) * scale
    lowest = min(curve.levels.min() for curve in result.curves[:2]) * scale
    low, high = max(0.8 * lowest, top / BOTTOM_FACTOR), TOP_FACTOR * top
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    style.log_ticks(axes.yaxis, low, high)
    along = result.curves[0].points
    if along[-1] > 10 * along[0]:
        axes.set_xscale("log")
        style.log_ticks(axes.xaxis, along[0], along[-1])
    if len(along) > 1:
        axes.set_xlim(along[0], along[-1])
    axes.set_xlabel(f"{result.of[0]} [{result.of[1]}]")
    axes.set_ylabel(f"{result.channel.name} [{unit}]")
    style.legend_beside(axes)


def _draw_effect(axes: Axes, result: DamperOptimum, number: int, scale: float) -> None:
    """Draw the largest vibration level over one damper value, with a line at the value given."""
    parameter = result.parameters[number]
    axes.plot(parameter.values, parameter.largest * scale, color=style.INK, linewidth=1.6)
    axes.plot([parameter.value], [result.after.level * scale], "o", color=style.INK, **MARK)
    if parameter.lower <= parameter.start <= parameter.upper:
        axes.axvline(parameter.start, label="as given", **style.line_style(0))
    if parameter.lower > 0 and parameter.upper > WIDE_RANGE * parameter.lower:
        axes.set_xscale("log")
        style.log_ticks(axes.xaxis, parameter.lower, parameter.upper)
    every = np.concatenate([each.largest for each in result.parameters]) * scale
    lowest, highest = every.min(), every.max()
    if highest > WIDE_RANGE * lowest:
        axes.set_yscale("log")
        style.log_ticks(axes.yaxis, lowest, highest)
    axes.set_xlim(parameter.lower, parameter.upper)
    axes.set_xlabel(f"{parameter.name} [{typeset_unit(parameter.unit or '1')}]")

"""Pictures of designs: an optimum within its bounds, a damper for all conditions, a front, designs under tolerances."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.core.number_text import typeset_unit
from torsionnet.response.damper_optimum import DesignParameter
from torsionnet.study.optimum.conditions_damper import DamperOverConditions
from torsionnet.study.optimum.design_optimum import DesignOptimum
from torsionnet.study.optimum.pareto_front import ParetoFront
from torsionnet.study.optimum.robust_design import RobustOptimum

WIDE = 3.0
"""Bounds whose ratio is larger are shown by equal factors."""
LABELLED: dict[str, Any] = {"fontsize": style.SMALL, "color": style.INK}


def design_optimum(found: DesignOptimum, *, title: str | None = None) -> Figure:
    """Parameters within their bounds as given and as found, and the best by the number of designs calculated.

    Parameters
    ----------
    found : DesignOptimum
    title : str, optional
        By default that of the result.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = style.new_figure(style.WIDTH, 1.6 + max(1.4, 0.4 * len(found.parameters)))
    places, course = figure.subplots(1, 2, width_ratios=(1.6, 1))
    _draw_places(places, found.parameters)
    style.dress(course)
    calculated, merits = found.history.T
    sign = 1.0 if found.goals.targets else found.goals.objectives[0].sign
    course.step(calculated, sign * merits, where="post", **style.line_style(0))
    course.set_xlabel("designs calculated")
    course.set_ylabel("squared deviations" if found.goals.targets else found.goals.objectives[0].name)
    if found.goals.targets and (merits > 0).all():
        course.set_yscale("log")
    style.heading(figure, f"{found.title}: optimum".removeprefix(": ") if title is None else title)
    return figure


def _draw_places(axes: Axes, parameters: tuple[DesignParameter, ...]) -> None:
    """Each parameter on a line from its lower to its upper bound."""
    style.dress(axes)
    for row, one in enumerate(parameters):
        axes.plot([0, 1], [row, row], color=style.FAINT, linewidth=5, solid_capstyle="round", zorder=1)
        given, best = ("as given", "found") if row == 0 else ("", "")
        axes.plot([_place(one, one.start)], [row], "o", color=style.MUTED, mfc=style.PAPER, label=given, zorder=2)
        axes.plot([_place(one, one.value)], [row], "o", color=style.PALETTE[1], label=best, zorder=3)
        text = f"{style.plain(float(f'{one.value:.4g}'))} {typeset_unit(one.unit)}".strip()
        axes.annotate(text, (_place(one, one.value), row), (0, 6), textcoords="offset points", ha="center", **LABELLED)
    axes.set_yticks(range(len(parameters)), [one.name for one in parameters])
    axes.set_ylim(len(parameters) - 0.4, -0.8)
    axes.set_xticks([0, 1], ["lower bound", "upper bound"])
    axes.set_xlim(-0.06, 1.06)
    axes.legend(fontsize=style.SMALL, frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))


def _place(one: DesignParameter, value: float) -> float:
    """Of a value between its bounds, 0 to 1."""
    by_factors = one.lower > 0 and one.upper > WIDE * one.lower
    low, high, at = np.log([one.lower, one.upper, value]) if by_factors else (one.lower, one.upper, value)
    return float(np.clip((at - low) / (high - low), -0.04, 1.04))


def damper_over_conditions(found: DamperOverConditions, *, title: str | None = None) -> Figure:
    """The largest level in every condition: as given, with one damper for all, with one for this condition alone.

    Parameters
    ----------
    found : DamperOverConditions
    title : str, optional
        By default that of the result.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = style.new_figure(style.WIDTH, 1.4 + 0.45 * len(found.conditions))
    axes = figure.subplots()
    style.dress(axes)
    rows = np.arange(len(found.conditions))
    marks = (("as given", "before", "s"), ("best for all", "after", "o"), ("best alone", "alone", "|"))
    for number, (label, what, mark) in enumerate(marks):
        levels = [getattr(one, what).level for one in found.conditions]
        axes.plot(levels, rows, mark, markersize=7, color=style.PALETTE[(4, 1, 0)[number]], label=label)
    axes.axvline(found.worst.after.level, color=style.MUTED, linewidth=0.8)
    axes.set_yticks(rows, [one.condition or found.title for one in found.conditions])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlabel(f"largest {found.channel.name} [{typeset_unit(found.channel.unit)}]")
    axes.legend(fontsize=style.SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    best = ", ".join(f"{one.name} = {one.value:.4g} {typeset_unit(one.unit)}" for one in found.parameters)
    style.heading(figure, f"{found.title}: {best}" if title is None else title)
    return figure


def pareto_front(found: ParetoFront, *, title: str | None = None) -> Figure:
    """The first two objectives of every design of the front, further ones one against the next.

    Parameters
    ----------
    found : ParetoFront
    title : str, optional
        By default that of the result.

    Returns
    -------
    matplotlib.figure.Figure
    """
    count = len(found.objectives) - 1
    figure = style.new_figure(style.WIDTH, 3.6)
    for number, axes in enumerate(np.atleast_1d(figure.subplots(1, count)).tolist()):
        style.dress(axes)
        across, up = found.values[:, number], found.values[:, number + 1]
        axes.plot(across, up, "o", markersize=4, color=style.PALETTE[0], label="best compromises")
        middle = found.compromise
        axes.plot(across[middle], up[middle], "D", color=style.PALETTE[1], label="near the best of all")
        if np.isfinite(found.given[number : number + 2]).all():
            axes.plot(*found.given[number : number + 2], "s", color=style.MUTED, mfc=style.PAPER, label="as given")
        axes.set_xlabel(_sought(found, number))
        axes.set_ylabel(_sought(found, number + 1))
    figure.axes[-1].legend(fontsize=style.SMALL, frameon=False)
    style.heading(figure, f"{found.title}: best compromises".removeprefix(": ") if title is None else title)
    return figure


def _sought(found: ParetoFront, number: int) -> str:
    one = found.objectives[number]
    return f"{one.name} ({one.sense}d)"


def robust_optimum(found: RobustOptimum, *, title: str | None = None) -> Figure:
    """Mean and standard deviation under tolerances of each design, and the share that keeps the limits.

    Parameters
    ----------
    found : RobustOptimum
    title : str, optional
        By default that of the result.

    Returns
    -------
    matplotlib.figure.Figure
    """
    shown = list(found.designs[0].mean)
    panels = len(shown) + found.limited
    figure = style.new_figure(style.WIDTH, 3.2)
    every = np.atleast_1d(figure.subplots(1, panels)).tolist()
    labels = [one.label for one in found.designs]
    for name, axes in zip(shown, every, strict=False):
        means, deviations = ([getattr(one, what)[name] for one in found.designs] for what in ("mean", "deviation"))
        axes.errorbar(range(len(labels)), means, deviations, fmt="o", capsize=5, color=style.PALETTE[0])
        axes.set_ylabel(f"{name}, mean and standard deviation")
    if found.limited:
        shares = 100 * np.array([one.share_kept for one in found.designs])
        ends = np.abs(shares[:, 1:].T - shares[:, 0])
        every[-1].errorbar(range(len(labels)), shares[:, 0], ends, fmt="o", capsize=5, color=style.PALETTE[2])
        every[-1].set_ylabel("keep all limits [%], 95 % confidence")
    for axes in every:
        style.dress(axes)
        axes.set_xticks(range(len(labels)), labels)
        axes.set_xlim(-0.5, len(labels) - 0.5)
    style.heading(figure, f"{found.title}: robust optimum".removeprefix(": ") if title is None else title)
    return figure

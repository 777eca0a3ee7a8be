"""Quantities against parameters: points, or their density where there are many."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.core.errors import UsageError
from torsionnet.plot.study_axes import axis_label

if TYPE_CHECKING:
    from torsionnet.study.answers.scatter_of_study import ScatterFound

MANY = 3000
"""Points from which their density is drawn."""
CELLS = 40
LARGEST = 8
"""Parameters, those with the largest rank correlations, beyond which a picture would be too small."""


def scatter_matrix(found: ScatterFound, configuration: str | None = None, *, title: str | None = None) -> Figure:
    """Every quantity over every parameter, the rank correlation in the corner.

    Parameters
    ----------
    found : ScatterFound
        What the answer ``scatter`` of a study found.
    configuration : str, optional
        By default all, told apart by colours; densities are drawn of all together.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No such configuration.
    """
    cases = list(found.points) if configuration is None else [configuration]
    if not set(cases) <= set(found.points):
        raise UsageError(f'there is no configuration "{configuration}"; there are {", ".join(found.points)}')
    shown = _strongest(found, cases)
    figure = style.new_figure(max(style.WIDTH, 1.4 * len(shown)), 0.9 + 1.6 * len(found.units))
    panels = figure.subplots(len(found.units), len(shown), squeeze=False, sharex="col", sharey="row")
    for row, (quantity, unit) in zip(panels, found.units.items(), strict=True):
        for axes, parameter in zip(row, shown, strict=True):
            _points(axes, found, cases, parameter, quantity)
            _coefficient(axes, found, cases, parameter, quantity)
            style.dress(axes)
            axes.locator_params(nbins=4)
        row[0].set_ylabel(axis_label(quantity, unit))
    for axes, parameter in zip(panels[-1], shown, strict=True):
        axes.set_xlabel(axis_label(parameter, found.parameter_units[parameter]))
    if len(cases) > 1 and _count(found, cases) < MANY:
        handles, labels = panels[0][0].get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="outside lower center", ncols=6, fontsize=style.SMALL, frameon=False, markerscale=3
        )
    style.heading(figure, found.title if title is None else title)
    return figure


def _strongest(found: ScatterFound, cases: list[str]) -> list[str]:
    sizes = np.nan_to_num(
        np.max([np.abs(one.coefficients) for (case, _), one in found.correlations.items() if case in cases], axis=0)
    )
    kept = sorted(np.argsort(-sizes, kind="stable")[:LARGEST].tolist())
    return [list(found.parameter_units)[place] for place in kept]


def _count(found: ScatterFound, cases: list[str]) -> int:
    return sum(len(next(iter(found.points[case].values()))) for case in cases)


def _points(axes: Axes, found: ScatterFound, cases: list[str], parameter: str, quantity: str) -> None:
    if _count(found, cases) < MANY:
        for number, case in enumerate(cases):
            columns = found.points[case]
            color = style.PALETTE[number % len(style.PALETTE)]
            axes.plot(
                columns[parameter], columns[quantity], ".", markersize=2.5, alpha=0.6, color=color, label=case,
                markeredgewidth=0, rasterized=True,
            )  # fmt: skip
        return
    x, y = (np.concatenate([found.points[case][name] for case in cases]) for name in (parameter, quantity))
    known = np.isfinite(x) & np.isfinite(y)
    axes.hist2d(x[known], y[known], bins=CELLS, cmap="Blues", cmin=1, rasterized=True)


def _coefficient(axes: Axes, found: ScatterFound, cases: list[str], parameter: str, quantity: str) -> None:
    place = list(found.parameter_units).index(parameter)
    values = [found.correlations[case, quantity].coefficients[place] for case in cases]
    low, high = (round(value, 2) + 0.0 for value in (min(values), max(values)))
    text = "" if np.isnan(low) else f"{low:.2f}" if high - low < 0.01 else f"{low:.2f} to {high:.2f}"
    axes.text(
        0.97, 0.97, text, transform=axes.transAxes, ha="right", va="top", fontsize=style.SMALL,
        bbox={"facecolor": style.PAPER, "alpha": 0.75, "edgecolor": "none", "pad": 1.0},
    )  # fmt: skip

"""Matrices of colours with effects of parameters (rows) in configurations (columns), where bars need more room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.plot.study.study_axes import break_text, panel_title, parameter_rows

FIELD_WIDTH, FIELD_HEIGHT = 0.3, 0.24
"""Width and height in inches of a field of the matrix, for one parameter in one configuration."""
NAMES_WIDTH = 2.6
"""Width in inches of the names of parameters and the bar of colours together."""


@dataclass(frozen=True)
class ColourScale:
    """Scale of the colours of a matrix, with its label, name of matplotlib's colour map, and values at the ends."""

    label: str
    colours: str
    low: float
    high: float


def parameter_matrix(
    values: Mapping[str, FloatArray],
    parameters: Sequence[str],
    cases: Sequence[str],
    scales: Mapping[str, ColourScale],
) -> Figure:
    """Figure with a matrix for each quantity, effects in colours, parameters in rows, configurations in columns.

    Parameters
    ----------
    values : mapping
        Quantity -> effects, (n_parameters, n_cases); NaN fields stay grey.
    parameters, cases : sequence of str
    scales : mapping
        By quantity.
    """
    width = max(style.WIDTH, NAMES_WIDTH + FIELD_WIDTH * len(cases))
    figure = style.new_figure(width, 1.6 + len(values) * (0.9 + FIELD_HEIGHT * len(parameters)))
    panels = figure.subplots(len(values), 1, squeeze=False, sharex=True)[:, 0]
    for axes, (quantity, found) in zip(panels, values.items(), strict=True):
        scale = scales[quantity]
        order = np.argsort(-np.nan_to_num(np.abs(found)).max(axis=1), kind="stable")
        axes.set_facecolor(style.FAINT)
        shown = axes.imshow(found[order], cmap=scale.colours, vmin=scale.low, vmax=scale.high, aspect="auto")
        parameter_rows(axes, [parameters[place] for place in order], width)
        axes.set_ylim(len(parameters) - 0.5, -0.5)
        axes.tick_params(labelsize=style.SMALL)
        panel_title(axes, quantity)
        bar = figure.colorbar(shown, ax=axes)
        bar.set_label(break_text(scale.label, max(1.2, FIELD_HEIGHT * len(parameters))), fontsize=style.SMALL)
        bar.ax.tick_params(labelsize=style.SMALL)
    panels[-1].set_xticks(range(len(cases)), cases, rotation=90, fontsize=style.SMALL)
    return figure

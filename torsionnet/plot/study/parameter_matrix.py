"""What parameters do in many configurations: fields of colour, where bars would take too much room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.plot.study.study_axes import broken, named_rows, titled
from torsionnet.response.frequency_response import FloatArray

FIELD = 0.3, 0.24
"""Inches."""
NAMES = 2.6
"""Inches of the names of parameters and of the bar of colours, together."""


@dataclass(frozen=True)
class ColourScale:
    """What colours mean: their label, their map, and the ends of it."""

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
    """A panel for each quantity: parameters below each other, configurations side by side.

    Parameters
    ----------
    values : mapping
        Quantity -> (n_parameters, n_cases); NaN fields stay grey.
    parameters, cases : sequence of str
    scales : mapping
        By quantity.
    """
    width = max(style.WIDTH, NAMES + FIELD[0] * len(cases))
    figure = style.new_figure(width, 1.6 + len(values) * (0.9 + FIELD[1] * len(parameters)))
    panels = figure.subplots(len(values), 1, squeeze=False, sharex=True)[:, 0]
    for axes, (quantity, found) in zip(panels, values.items(), strict=True):
        scale = scales[quantity]
        order = np.argsort(-np.nan_to_num(np.abs(found)).max(axis=1), kind="stable")
        axes.set_facecolor(style.FAINT)
        shown = axes.imshow(found[order], cmap=scale.colours, vmin=scale.low, vmax=scale.high, aspect="auto")
        named_rows(axes, [parameters[place] for place in order], width)
        axes.set_ylim(len(parameters) - 0.5, -0.5)
        axes.tick_params(labelsize=style.SMALL)
        titled(axes, quantity)
        bar = figure.colorbar(shown, ax=axes)
        bar.set_label(broken(scale.label, max(1.2, FIELD[1] * len(parameters))), fontsize=style.SMALL)
        bar.ax.tick_params(labelsize=style.SMALL)
    panels[-1].set_xticks(range(len(cases)), cases, rotation=90, fontsize=style.SMALL)
    return figure

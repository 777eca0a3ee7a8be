"""Plot of the coherence, from 0 to 1, of estimated frequency responses over frequency."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import FrequencyResponse


def coherence(
    responses: FrequencyResponse | Sequence[FrequencyResponse],
    *,
    labels: Sequence[str] | None = None,
    conventions: Conventions = SI,
    x_log: bool = False,
    title: str = "",
) -> Figure:
    """Figure of the coherence (0 to 1) of the first output with the first input of each response, over frequency.

    Parameters
    ----------
    responses : FrequencyResponse or sequence of these
        Estimates.
    labels : sequence of str, optional
        One for each; by default their titles.
    conventions : Conventions, optional
        Unit of frequency.
    x_log : bool, optional
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
        A dot marks the frequency up to which an estimate can be used.

    Raises
    ------
    UsageError
        A response has no coherence.
    """
    given = [responses] if isinstance(responses, FrequencyResponse) else list(responses)
    names = [response.title for response in given] if labels is None else list(labels)
    figure = style.new_figure(style.WIDTH, 2.6)
    axes = figure.subplots()
    style.style_axes(axes)
    for number, (response, name) in enumerate(zip(given, names, strict=True)):
        if response.coherence is None:
            raise UsageError(
                f"{response.title or 'a response'} has no coherence: only estimates from recorded signals have"
            )
        f, values = response.frequencies * conventions.frequency_scale, response.coherence[:, 0, 0]
        look = style.line_style(number)
        axes.plot(f, values, label=name, **look)
        if response.usable_up_to is not None and response.usable_up_to <= response.frequencies[-1]:
            limit = response.usable_up_to * conventions.frequency_scale
            axes.plot(limit, np.interp(limit, f, values), marker="o", markersize=5, color=look["color"])
    axes.set_ylim(0, 1.05)
    axes.set_ylabel("coherence [-]")
    axes.set_xlabel(f"frequency [{conventions.frequency}]")
    if x_log:
        axes.set_xscale("log")
        style.log_ticks(axes.xaxis, *axes.get_xlim())
    style.set_title(figure, title)
    figure.legend(loc="outside lower center", ncols=5, frameon=False, fontsize=style.SMALL)
    return figure

"""Plot of a test against a model, both frequency responses, and their differences in dB and degrees over frequency."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.number_text import typeset_unit
from torsionnet.linear.frequency_response import FloatArray, FrequencyResponse
from torsionnet.linear.phase import unwrapped_phase
from torsionnet.plot.bode_plot import AXIS_BEYOND_COHERENCE
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.signals.comparison import difference
from torsionnet.signals.uncertainty import LEAST_COHERENCE

TEST, MODEL = style.PALETTE[1], style.PALETTE[0]
SHOWN = {name: name for name in ("magnitude", "phase", "coherence")}
SHOWN |= {"dB": "difference in dB", "deg": "difference in degrees"}
"""What the panels of a comparison show, by their names."""


def comparison(
    test: FrequencyResponse,
    model: FrequencyResponse,
    *,
    output: str | None = None,
    input: str | None = None,
    conventions: Conventions = SI,
    x_log: bool = True,
    title: str | None = None,
    ax: GivenAxes = None,
) -> Figure:
    """Figure of a transfer function of a test and of a model over frequency, with coherence and their differences.

    Points at which the coherence is under 0.8 are hollow. Beyond the frequency up to which the test is usable, the
    background is grey. The axis ends a little beyond the last usable or coherent frequency.

    Parameters
    ----------
    test, model : FrequencyResponse
        At the same frequencies: ask the model at those of the test.
    output, input : str, optional
        Which transfer function; by default the first.
    conventions : Conventions, optional
    x_log : bool, optional
    title : str, optional
        By default that of the model.
    ax : sequence of Axes, optional
        Axes to draw into, for magnitude, phase, coherence if there is one, differences in dB and in degrees; by default
        those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        The two have other frequencies, names or units.

    Examples
    --------
    >>> import torsionnet as tn
    >>> model = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [1, 2, 5, 10, 20])
    >>> len(comparison(model, model).axes)
    4
    """
    first = (output or test.outputs[0].name, input or test.inputs[0].name)
    test, model = (
        _nonzero(response.select(*first)) if x_log else response.select(*first) for response in (test, model)
    )
    difference(test, model)  # refuses what cannot be compared
    test, model = (response.between(0, _end(test)) for response in (test, model))
    apart = difference(test, model)
    rows = ["magnitude", "phase", *(["coherence"] if test.coherence is not None else []), "dB", "deg"]
    heights = {"magnitude": 3.0, "phase": 2.2, "coherence": 1.0, "dB": 1.2, "deg": 1.2}
    shares = [heights[row] for row in rows]
    sheet, stacked = style.stacked_panels(1.2 + 0.72 * sum(shares), [SHOWN[row] for row in rows], ax, shares=shares)
    panels = dict(zip(rows, stacked, strict=True))
    _responses(panels, test, model, conventions)
    f = test.frequencies * conventions.frequency_scale
    good = _is_coherent(test)
    for name, values in (("dB", apart.decibels[:, 0, 0]), ("deg", apart.degrees[:, 0, 0])):
        _points(panels[name], f, values, good, "")
        panels[name].axhline(0, color=style.MUTED, linewidth=0.8)
        panels[name].set_ylabel(f"test - model\n[{name}]")
        _limit_to(panels[name], values[_is_usable(test) & good])
    _dress(panels, test, conventions, x_log=x_log)
    sheet.figure.align_ylabels(stacked)
    handles, names = panels["magnitude"].get_legend_handles_labels()
    sheet.legend(2, handles, names)
    return sheet.titled(model.title if title is None else title)


def _nonzero(response: FrequencyResponse) -> FrequencyResponse:
    return response.between(float(np.nextafter(0, 1)), np.inf)


def _end(test: FrequencyResponse) -> float:
    """Highest frequency in Hz on the axis of a comparison of a test with a model.

    Inf, for all frequencies, if the test is nowhere usable or coherent.
    """
    meant = _is_coherent(test) if test.usable_up_to is None else _is_coherent(test) | _is_usable(test)
    return AXIS_BEYOND_COHERENCE * float(test.frequencies[meant].max()) if meant.any() else np.inf


def _is_coherent(test: FrequencyResponse) -> NDArray[np.bool_]:
    if test.coherence is None:
        return np.ones(len(test.frequencies), dtype=bool)
    return np.asarray(test.coherence[:, 0, 0] >= LEAST_COHERENCE)


def _is_usable(test: FrequencyResponse) -> NDArray[np.bool_]:
    limit = np.inf if test.usable_up_to is None else test.usable_up_to
    return np.asarray(test.frequencies <= limit)


def _reliable(test: FrequencyResponse) -> FloatArray:
    """Magnitudes of a test's transfer function in SI units at usable, coherent frequencies, shape (n,)."""
    return np.asarray(test.magnitude[_is_usable(test) & _is_coherent(test), 0, 0])


def _responses(
    panels: dict[str, Axes], test: FrequencyResponse, model: FrequencyResponse, conventions: Conventions
) -> None:
    f, good = test.frequencies * conventions.frequency_scale, _is_coherent(test)
    scale = test.scale(conventions)
    size, phase = panels["magnitude"], panels["phase"]
    size.plot(f, model.magnitude[:, 0, 0] * scale, color=MODEL, linewidth=1.6, label="model")
    _points(size, f, test.magnitude[:, 0, 0] * scale, good, "test")
    calculated = unwrapped_phase(model.values[:, 0, 0])
    # The measured phase is drawn in the turn of the calculated one, within 180 degrees of it.
    apart = np.degrees(np.angle(test.values[:, 0, 0] / model.values[:, 0, 0]))
    measured = calculated + (apart if test.has_phase else np.nan)
    phase.plot(f, calculated, color=MODEL, linewidth=1.6)
    _points(phase, f, measured, good, "")
    reliable = measured[_is_usable(test) & good]
    every = np.concatenate([curve[np.isfinite(curve)] for curve in (calculated, reliable)])
    style.phase_ticks(phase, *((every.min(), every.max()) if every.size else (-180.0, 0.0)))
    phase.set_ylabel("phase [deg]")
    if test.coherence is not None:
        panels["coherence"].plot(f, test.coherence[:, 0, 0], color=TEST, linewidth=1.2)
        panels["coherence"].axhline(LEAST_COHERENCE, color=style.MUTED, linewidth=0.8, linestyle=":")
        panels["coherence"].set_ylim(0, 1.05)
        panels["coherence"].set_ylabel("coherence\n[-]")


def _points(panel: Axes, f: FloatArray, values: FloatArray, good: NDArray[np.bool_], label: str) -> None:
    look: dict[str, Any] = {
        "color": TEST,
        "markersize": 3.0,
        "linestyle": "none",
        "marker": "o",
        "markeredgewidth": 0.7,
    }
    panel.plot(f, np.where(good, values, np.nan), label=label, **look)
    if not good.all():
        hollow = {**look, "markerfacecolor": "none", "alpha": 0.5}
        panel.plot(f, np.where(good, np.nan, values), label=f"{label}, coherence under 0.8" if label else "", **hollow)


def _limit_to(panel: Axes, values: FloatArray) -> None:
    """Set the vertical limits of a panel of differences, equal above and below 0, so that the reliable values fit."""
    finite = values[np.isfinite(values)]
    limit = max(1.25 * float(np.abs(finite).max()) if finite.size else 1.0, 1e-3)
    panel.set_ylim(-limit, limit)


def _dress(panels: dict[str, Axes], test: FrequencyResponse, conventions: Conventions, *, x_log: bool) -> None:
    f = test.frequencies * conventions.frequency_scale
    axes, last = list(panels.values()), list(panels.values())[-1]
    size = panels["magnitude"]
    size.set_yscale("log")
    shown = np.concatenate([line.get_ydata() for line in size.lines[:1]] + [_reliable(test) * test.scale(conventions)])
    low, high = 0.6 * float(shown.min()), 1.7 * float(shown.max())
    size.set_ylim(low, high)
    style.log_ticks(size.yaxis, low, high)
    unit = test.unit(conventions=conventions)
    size.set_ylabel(f"|{test.outputs[0].name}/{test.inputs[0].name}| [{typeset_unit(unit) if unit != '1' else '-'}]")
    last.set_xlabel(f"frequency [{conventions.frequency}]")
    if x_log:
        last.set_xscale("log")
        style.log_ticks(last.xaxis, float(f.min()), float(f.max()))
    last.set_xlim(f.min(), f.max())
    if not _is_usable(test).all() and test.usable_up_to is not None:
        for number, panel in enumerate(axes):
            label = "test beyond the resolution of its sensor" if number == 0 else ""
            start = test.usable_up_to * conventions.frequency_scale
            panel.axvspan(start, f.max(), color=style.FAINT, alpha=0.6, linewidth=0, zorder=0.5, label=label)


# Plot of the coherence, from 0 to 1, of estimated frequency responses over frequency.


def coherence(
    responses: FrequencyResponse | Sequence[FrequencyResponse],
    *,
    labels: Sequence[str] | None = None,
    conventions: Conventions = SI,
    x_log: bool = False,
    title: str = "",
    ax: Axes | None = None,
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
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

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
    sheet, axes = style.one_panel(2.6, ax)
    for number, (response, name) in enumerate(zip(given, names, strict=True)):
        if response.coherence is None:
            raise UsageError(
                f"{response.title or 'a response'} has no coherence: only estimates from recorded signals have",
                kind="missing-data",
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
    sheet.legend(5)
    return sheet.titled(title)

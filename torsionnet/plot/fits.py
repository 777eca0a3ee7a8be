"""Plots of a model fitted to measurements, with residuals over frequency, and of the correlations of its parameters.

Test, fitted model and residuals, and the correlation of the parameters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.number_text import typeset_unit
from torsionnet.base.units import RPM
from torsionnet.plot.drawing.labels import symbol
from torsionnet.plot.drawing.style import GivenAxes, curve_mark, fit_speeds

if TYPE_CHECKING:
    from torsionnet.identification import Fit
    from torsionnet.identification.fit_result import Compared


# Panels of a fit to measured orders: amplitude, phase and residuals over speed, in a colour for each order.

MOST_ORDERS = 6
"""Largest number of orders drawn in a panel, those with the largest amplitudes; more lines hide each other."""
HALF_WIDTH = 1.96
"""Half of a 95 % interval in standard deviations of a normal distribution."""


def order_column(panels: list[Axes], one: Compared, conventions: Conventions, colours: Mapping[float, str]) -> None:
    """Draw measured orders with intervals and the fitted curves over speed, phases and residuals in three panels."""
    assert one.orders is not None
    assert one.speeds is not None
    size, phase, left = panels
    scale = conventions.scale("rad") if one.unit.startswith("rad") else 1.0
    left.axhspan(-2, 2, color=style.FAINT, alpha=0.6, linewidth=0)
    for order in drawn_orders(one):
        mine, colour = one.orders == order, colours[order]
        rpm, measured, fitted = one.speeds[mine] * RPM, one.measured[mine], one.fitted[mine]
        spread = HALF_WIDTH * one.deviation[mine] * scale
        points: dict[str, Any] = {"color": colour, "marker": "o", "markersize": 2.5, "linestyle": "none"}
        size.errorbar(
            rpm, np.abs(measured) * scale, yerr=spread, label=f"test, order {order:g}", elinewidth=0.8, **points
        )
        curve: dict[str, Any] = {"color": colour, "linewidth": 1.3, **curve_mark(rpm)}
        size.plot(rpm, np.abs(fitted) * scale, **curve)
        phase.plot(rpm, _degrees(fitted), **curve)
        if one.has_phase:
            phase.plot(rpm, _degrees(measured), color=colour, marker="o", markersize=2.5, linestyle="none")
            rest = (measured - fitted) / one.deviation[mine]
            left.plot(rpm, rest.real, color=colour, marker=".", linewidth=0.7)
            left.plot(rpm, rest.imag, color=colour, marker="x", markersize=3, linewidth=0.7, linestyle=":")
        else:
            rest = (np.abs(measured) - np.abs(fitted)) / one.deviation[mine]
            left.plot(rpm, rest, color=colour, marker=".", linewidth=0.7)
    size.set_title(one.name, fontsize=style.FONT)
    size.set_ylim(bottom=0)
    left.set_xlabel("speed [rpm]")
    fit_speeds(left, one.speeds * RPM)
    for panel in panels:
        style.style_axes(panel)


def order_colours(shown: Sequence[Compared]) -> dict[float, str]:
    """Colour of each order that is drawn for any measurement, the same in all panels."""
    orders = sorted({order for one in shown if one.orders is not None for order in drawn_orders(one)})
    return {order: style.PALETTE[number % len(style.PALETTE)] for number, order in enumerate(orders)}


def drawn_orders(one: Compared) -> list[float]:
    """Orders of a measurement that are drawn, rising: those with the largest amplitudes in the test."""
    assert one.orders is not None
    peaks = {order: float(np.abs(one.measured[one.orders == order]).max()) for order in np.unique(one.orders).tolist()}
    return sorted(sorted(peaks, key=lambda order: -peaks[order])[:MOST_ORDERS])


def _degrees(values: np.ndarray) -> np.ndarray:
    """Phases in degrees between -180 and 180, not unwrapped: neighbouring speeds of an order may lie far apart."""
    return np.asarray(np.degrees(np.angle(values)))


MOST_MEASUREMENTS = 6
"""Largest number of measurements drawn side by side in the plot of a fit; with more, the panels would be too narrow to
read."""
HEIGHTS = (3.0, 2.2, 1.5)  # ratios of magnitude, phase and residuals


def fit(result: Fit, *, conventions: Conventions = SI, title: str | None = None, ax: GivenAxes = None) -> Figure:
    """Figure of a test and the fitted model over frequency, magnitude, phase and residuals divided by the noise.

    A column of panels for each measurement; orders are drawn over speed, with their 95 % intervals.

    The model explains the test if the residuals scatter about zero within two; a pattern in them shows what the model
    lacks.

    Parameters
    ----------
    result : Fit
    conventions : Conventions, optional
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, for magnitudes, phases and residuals, each of all measurements; by default those of a new
        figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> test = rig.frequency_response("theta_1", "T_T", np.linspace(1, 20, 40))
    >>> result = tn.identify(rig.configured(c_2=10), tn.Measurement(test, "theta_1", "T_T"), ["c_2"])
    >>> len(fit(result).axes)
    3
    """
    shown = result.comparisons[:MOST_MEASUREMENTS]
    if not shown:
        raise UsageError("the fit holds no measurement to plot", kind="missing-data")
    width = max(style.WIDTH, 2.6 * len(shown))
    # Outputs of orders differ in size and unit, responses of one sensor do not.
    alike = len(shown) == 1 or all(one.orders is None for one in shown)
    colours = order_colours(shown)
    shows = [f"{what} of {one.name}" for what in ("magnitude", "phase", "residuals") for one in shown]
    sheet, panels = style.grid_panels(
        width, 5.6, shows, ax, columns=len(shown), sharex="col", sharey="row" if alike else False,
        gridspec_kw={"height_ratios": HEIGHTS},
    )  # fmt: skip
    for column, one in enumerate(shown):
        if one.orders is None:
            _column([row[column] for row in panels], one, conventions)
        else:
            order_column([row[column] for row in panels], one, conventions, colours)
    for column, one in enumerate(shown if not alike else shown[:1]):
        for row, label in zip(panels, _labels(one, conventions), strict=True):
            row[column].set_ylabel(label)
        size = panels[0][column]
        if one.orders is None:
            style.log_ticks(size.yaxis, *size.get_ylim())
        drawn = shown if alike else [one]
        every = np.concatenate([_shown_phases(each) for each in drawn])
        style.phase_ticks(panels[1][column], float(every.min()), float(every.max()))
    handles, names = _legend([axes for row in (panels[0], panels[2]) for axes in row])
    sheet.legend(4, handles, names)
    values = ", ".join(f"{name} = {value:.4g}" for name, value in list(result.values.items())[:4])
    return sheet.titled(f"{result.title}: {values}" if title is None else title)


def correlation(result: Fit, *, title: str | None = None, ax: Axes | None = None) -> Figure:
    """Figure of the correlations of fitted parameters in colours from -1 to 1, parameters on rows and on columns.

    Near 1 or -1 the data cannot tell two parameters apart.

    Parameters
    ----------
    result : Fit
    title : str, optional
        By default that of the result.
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.
    """
    names = list(result.values)
    side = max(3.0, 0.55 * len(names) + 1.6)
    sheet, ((axes,),) = style.grid_panels(side + 0.8, side, [""], ax)
    shown_names = [symbol(name) for name in names]
    shown = axes.imshow(result.correlation, cmap="RdBu_r", vmin=-1, vmax=1, aspect="auto")
    axes.set_xticks(range(len(names)), shown_names, rotation=45, ha="right", fontsize=style.SMALL)
    axes.set_yticks(range(len(names)), shown_names, fontsize=style.SMALL)
    for i in range(len(names)):
        for j in range(len(names)):
            value = float(result.correlation[i, j])
            colour = style.PAPER if abs(value) > 0.6 else style.INK
            axes.text(j, i, f"{value:.2f}", ha="center", va="center", fontsize=style.SMALL, color=colour)
    bar = sheet.figure.colorbar(shown, ax=axes)
    bar.set_label("correlation [-]", fontsize=style.FONT)
    bar.ax.tick_params(labelsize=style.SMALL)
    return sheet.titled(result.title if title is None else title)


def _column(panels: list[Axes], one: Compared, conventions: Conventions) -> None:
    size, phase, left = panels
    scale = conventions.scale("rad") ** (("rad" in one.unit.partition("/")[0]) - ("rad" in one.unit.partition("/")[2]))
    f = one.frequencies * conventions.frequency_scale
    test = {"color": style.PALETTE[1], "marker": "o", "markersize": 3.0, "linestyle": "none"}
    size.plot(f, np.abs(one.measured) * scale, label="test", **test)  # type: ignore[arg-type]
    size.plot(f, np.abs(one.fitted) * scale, label="model, estimated alike", color=style.PALETTE[0], linewidth=1.4)
    phase.plot(f, _phase(one.fitted), color=style.PALETTE[0], linewidth=1.4)
    left.axhspan(-2, 2, color=style.FAINT, alpha=0.6, linewidth=0)
    if one.has_phase:
        phase.plot(f, _phase(one.measured), **test)  # type: ignore[arg-type]
        rest = (one.measured - one.fitted) / one.deviation
        left.plot(f, rest.real, color=style.PALETTE[2], marker=".", linewidth=0.8, label="residual, real part")
        left.plot(f, rest.imag, color=style.PALETTE[3], marker=".", linewidth=0.8, label="imaginary part")
    else:
        larger = (np.abs(one.measured) - np.abs(one.fitted)) / one.deviation
        left.plot(f, larger, color=style.PALETTE[2], marker=".", linewidth=0.8, label="residual of the magnitude")
    size.set_yscale("log")
    size.set_title(one.name, fontsize=style.FONT)
    left.set_xlabel(f"frequency [{conventions.frequency}]")
    for panel in panels:
        style.style_axes(panel)


def _shown_phases(one: Compared) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Phases in degrees that the panel of a measurement shows; those of orders are not unwrapped."""
    values = one.measured if one.has_phase else one.fitted
    return _phase(values) if one.orders is None else np.array([-180.0, 180.0])


def _legend(axes: list[Axes]) -> tuple[list[Any], list[str]]:
    """Handles and texts of a legend for all panels, each text once."""
    found: dict[str, Any] = {}
    for one in axes:
        for handle, name in zip(*one.get_legend_handles_labels(), strict=True):
            found.setdefault(name, handle)
    return list(found.values()), list(found)


def _phase(values: np.ndarray[tuple[int], np.dtype[np.complex128]]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.unwrap(np.degrees(np.angle(values)), period=360)


def _labels(one: Compared, conventions: Conventions) -> tuple[str, str, str]:
    unit = typeset_unit(one.unit.replace("rad", conventions.angle)) if one.unit != "1" else "-"
    if one.orders is not None:
        return f"peak amplitude [{unit}]", "phase [deg]", "(test - model)\nover noise [-]"
    return f"magnitude [{unit}]", "phase [deg]", "(test - model)\nover noise [-]"

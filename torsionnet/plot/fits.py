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


def order_column(
    panels: list[Axes], compared: Compared, conventions: Conventions, colours: Mapping[float, str]
) -> None:
    """Draw measured orders with intervals and the fitted curves over speed, phases and residuals in three panels."""
    assert compared.orders is not None
    assert compared.speeds is not None
    size, phase, left = panels
    scale = conventions.scale("rad") if compared.unit.startswith("rad") else 1.0
    # Residuals over the standard deviation of their noise: 95 % of them are within +-2.
    left.axhspan(-2, 2, color=style.FAINT, alpha=0.6, linewidth=0)
    for order in drawn_orders(compared):
        mine, colour = compared.orders == order, colours[order]
        rpm, measured, fitted = compared.speeds[mine] * RPM, compared.measured[mine], compared.fitted[mine]
        spread = HALF_WIDTH * compared.deviation[mine] * scale
        points: dict[str, Any] = {"color": colour, "marker": "o", "markersize": 2.5, "linestyle": "none"}
        size.errorbar(
            rpm, np.abs(measured) * scale, yerr=spread, label=f"test, order {order:g}", elinewidth=0.8, **points
        )
        curve: dict[str, Any] = {"color": colour, "linewidth": 1.3, **curve_mark(rpm)}
        size.plot(rpm, np.abs(fitted) * scale, **curve)
        phase.plot(rpm, _degrees(fitted), **curve)
        if compared.has_phase:
            phase.plot(rpm, _degrees(measured), color=colour, marker="o", markersize=2.5, linestyle="none")
            rest = (measured - fitted) / compared.deviation[mine]
            left.plot(rpm, rest.real, color=colour, marker=".", linewidth=0.7)
            left.plot(rpm, rest.imag, color=colour, marker="x", markersize=3, linewidth=0.7, linestyle=":")
        else:
            rest = (np.abs(measured) - np.abs(fitted)) / compared.deviation[mine]
            left.plot(rpm, rest, color=colour, marker=".", linewidth=0.7)
    size.set_title(compared.name, fontsize=style.FONT)
    size.set_ylim(bottom=0)
    left.set_xlabel("speed [rpm]")
    fit_speeds(left, compared.speeds * RPM)
    for panel in panels:
        style.style_axes(panel)


def order_colours(shown: Sequence[Compared]) -> dict[float, str]:
    """Colour of each order that is drawn for any measurement, the same in all panels."""
    orders = sorted({order for compared in shown if compared.orders is not None for order in drawn_orders(compared)})
    return {order: style.PALETTE[number % len(style.PALETTE)] for number, order in enumerate(orders)}


def drawn_orders(compared: Compared) -> list[float]:
    """Orders of a measurement that are drawn, rising: those with the largest amplitudes in the test."""
    assert compared.orders is not None
    peaks = {
        order: float(np.abs(compared.measured[compared.orders == order]).max())
        for order in np.unique(compared.orders).tolist()
    }
    return sorted(sorted(peaks, key=lambda order: -peaks[order])[:MOST_ORDERS])


def _degrees(values: np.ndarray) -> np.ndarray:
    """Phases in degrees between -180 and 180, not unwrapped: neighbouring speeds of an order may lie far apart."""
    return np.asarray(np.degrees(np.angle(values)))


MOST_MEASUREMENTS = 6
"""Largest number of measurements drawn side by side in the plot of a fit; with more, the panels would be too narrow to
read."""
HEIGHTS = (3.0, 2.2, 1.5)  # ratios of magnitude, phase and residuals
OVER_TIME = (4.0, 0.01, 2.0)  # the same of equations of motion over time, without a phase


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
    alike = len(shown) == 1 or all(compared.orders is None and compared.times is None for compared in shown)
    colours = order_colours(shown)
    shows = [f"{what} of {compared.name}" for what in ("magnitude", "phase", "residuals") for compared in shown]
    sheet, panels = style.grid_panels(
        width, 5.6, shows, ax, columns=len(shown), sharex="col", sharey="row" if alike else False,
        gridspec_kw={"height_ratios": OVER_TIME if all(part.times is not None for part in shown) else HEIGHTS},
    )  # fmt: skip
    for column, compared in enumerate(shown):
        if compared.times is not None:
            _time_column([row[column] for row in panels], compared)
        elif compared.orders is None:
            _column([row[column] for row in panels], compared, conventions)
        else:
            order_column([row[column] for row in panels], compared, conventions, colours)
    for column, compared in enumerate(shown if not alike else shown[:1]):
        for row, label in zip(panels, _labels(compared, conventions), strict=True):
            row[column].set_ylabel(label)
        size = panels[0][column]
        if compared.times is not None:
            continue
        if compared.orders is None:
            style.log_ticks(size.yaxis, *size.get_ylim())
        drawn = shown if alike else [compared]
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


def _column(panels: list[Axes], compared: Compared, conventions: Conventions) -> None:
    size, phase, left = panels
    # The unit of angles counts by its power: 1 above the bar, -1 below it.
    scale = conventions.scale("rad") ** (
        ("rad" in compared.unit.partition("/")[0]) - ("rad" in compared.unit.partition("/")[2])
    )
    f = compared.frequencies * conventions.frequency_scale
    test = {"color": style.PALETTE[1], "marker": "o", "markersize": 3.0, "linestyle": "none"}
    size.plot(f, np.abs(compared.measured) * scale, label="test", **test)  # type: ignore[arg-type]
    size.plot(f, np.abs(compared.fitted) * scale, label="model, estimated alike", color=style.PALETTE[0], linewidth=1.4)
    phase.plot(f, _phase(compared.fitted), color=style.PALETTE[0], linewidth=1.4)
    left.axhspan(-2, 2, color=style.FAINT, alpha=0.6, linewidth=0)
    if compared.has_phase:
        phase.plot(f, _phase(compared.measured), **test)  # type: ignore[arg-type]
        rest = (compared.measured - compared.fitted) / compared.deviation
        left.plot(f, rest.real, color=style.PALETTE[2], marker=".", linewidth=0.8, label="residual, real part")
        left.plot(f, rest.imag, color=style.PALETTE[3], marker=".", linewidth=0.8, label="imaginary part")
    else:
        larger = (np.abs(compared.measured) - np.abs(compared.fitted)) / compared.deviation
        left.plot(f, larger, color=style.PALETTE[2], marker=".", linewidth=0.8, label="residual of the magnitude")
    size.set_yscale("log")
    size.set_title(compared.name, fontsize=style.FONT)
    left.set_xlabel(f"frequency [{conventions.frequency}]")
    for panel in panels:
        style.style_axes(panel)


def _time_column(panels: list[Axes], compared: Compared) -> None:
    """Draw torques of laws of motion by the test and by the fitted model over time, and what is left over."""
    assert compared.times is not None
    torque, idle, left = panels
    idle.set_visible(False)
    points: dict[str, Any] = {"color": style.PALETTE[1], "marker": "o", "markersize": 2.5, "linestyle": "none"}
    torque.plot(compared.times, compared.measured.real, label="test", **points)
    torque.plot(compared.times, compared.fitted.real, color=style.PALETTE[0], linewidth=1.2, label="model")
    left.axhspan(-2, 2, color=style.FAINT, alpha=0.6, linewidth=0)
    rest = (compared.measured - compared.fitted).real / compared.deviation
    left.plot(compared.times, rest, color=style.PALETTE[2], marker=".", linewidth=0.8, label="residual")
    torque.set_title(compared.name, fontsize=style.FONT)
    left.set_xlabel("time [s]")
    for panel in panels:
        style.style_axes(panel)


def _shown_phases(compared: Compared) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Phases in degrees that the panel of a measurement shows; those of orders are not unwrapped."""
    values = compared.measured if compared.has_phase else compared.fitted
    return _phase(values) if compared.orders is None else np.array([-180.0, 180.0])


def _legend(axes: list[Axes]) -> tuple[list[Any], list[str]]:
    """Handles and texts of a legend for all panels, each text once."""
    by_text: dict[str, Any] = {}
    for panel in axes:
        for handle, name in zip(*panel.get_legend_handles_labels(), strict=True):
            by_text.setdefault(name, handle)
    return list(by_text.values()), list(by_text)


def _phase(values: np.ndarray[tuple[int], np.dtype[np.complex128]]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.unwrap(np.degrees(np.angle(values)), period=360)


def _labels(compared: Compared, conventions: Conventions) -> tuple[str, str, str]:
    unit = typeset_unit(compared.unit.replace("rad", conventions.angle)) if compared.unit != "1" else "-"
    if compared.times is not None:
        return f"torque of the laws [{unit}]", "", "(test - model)\nover noise [-]"
    if compared.orders is not None:
        return f"peak amplitude [{unit}]", "phase [deg]", "(test - model)\nover noise [-]"
    return f"magnitude [{unit}]", "phase [deg]", "(test - model)\nover noise [-]"

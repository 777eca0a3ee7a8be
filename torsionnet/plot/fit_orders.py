"""Panels of a fit to measured orders: amplitude, phase and residuals over speed, in a colour for each order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import Conventions
from torsionnet.base.units import RPM
from torsionnet.plot.drawing.speed_axis import curve_mark, fit_speeds

if TYPE_CHECKING:
    from torsionnet.identification import Compared  # loads scipy.optimize, which pictures can do without

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

"""Orders derived from tracked ones: stress from torque, and slices over speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.signals.orders.tracked_orders import TrackedOrders
from torsionnet.signals.recording import FloatArray

FEWEST_VALUES = 3
"""Fewest values in a bin of speeds from whose scatter an interval is made."""
LEVEL = 0.975
"""Quantile of Student's distribution for the half width of a 95 % interval."""


def stress_orders(torque: TrackedOrders, diameter: float) -> TrackedOrders:
    """Orders of the shear stress in Pa at the surface of a round shaft, 16 T/(pi d^3), from its torque.

    Parameters
    ----------
    torque : TrackedOrders
        Orders of a torque, N m.
    diameter : float
        m.

    Raises
    ------
    UsageError
        The channel is no torque, or the diameter is not positive.

    Examples
    --------
    >>> one = TrackedOrders(
    ...     "T", "torque", np.array([6.0]), np.zeros(1), np.ones(1), np.array([[np.pi / 16 + 0j]]), np.zeros((1, 1))
    ... )
    >>> stress_orders(one, 0.1).along(6).round(6).tolist()
    [(1000+0j)]
    """
    if torque.quantity != "torque":
        raise UsageError(
            f"{torque.name} is {torque.quantity or 'of no known quantity'}: a stress needs a torque",
            kind="unfit-channel",
        )
    if not diameter > 0:
        raise UsageError(f"the diameter of a shaft is positive, got {diameter:g} m", kind="out-of-range")
    factor = 16 / (np.pi * diameter**3)
    return replace(
        torque,
        name=f"stress({torque.name})",
        quantity="stress",
        values=torque.values * factor,
        half_widths=torque.half_widths * factor,
        half_range=None if torque.half_range is None else torque.half_range * factor,
        notes=(*torque.notes, f"stress of a diameter of {1e3 * diameter:.6g} mm"),
    )


def order_slices(tracked: TrackedOrders, step: float) -> TrackedOrders:
    """Complex orders in SI averaged in bins of speed, over rising speed.

    The half width of a bin is that of its values (root mean square: what the values share does not average out), or
    that which their scatter about a straight line over speed leaves in their mean, if that is larger.

    Parameters
    ----------
    tracked : TrackedOrders
        Orders over time, of one run or of several one after the other.
    step : float
        Width of a bin, rad/s.

    Raises
    ------
    UsageError
        The step is not positive.

    Examples
    --------
    >>> one = TrackedOrders(
    ...     "T", "torque", np.array([6.0]), np.arange(4.0), np.array([10.0, 11.0, 20.0, 21.0]),
    ...     np.array([[1, 3, 5, 7 + 0j]]), np.full((1, 4), 0.1), reference="tooth 0",
    ... )
    >>> order_slices(one, 10.0).along(6).tolist()
    [(2+0j), (6+0j)]
    """
    if not step > 0:
        raise UsageError(f"the step of speed must be positive, got {step * RPM:g} rpm", kind="out-of-range")
    bins = np.floor(tracked.speeds / step).astype(np.intp)
    numbers = np.unique(bins)
    members = [np.flatnonzero(bins == number) for number in numbers]
    values = np.array([tracked.values[:, one].mean(axis=1) for one in members]).T
    widths = np.array([_half_width(tracked, one) for one in members]).T
    half = tracked.half_range
    return replace(
        tracked,
        times=np.array([tracked.times[one].mean() for one in members]),
        speeds=np.array([tracked.speeds[one].mean() for one in members]),
        values=values,
        half_widths=widths,
        half_range=None if half is None else np.array([half[one].max() for one in members]),
        notes=(*tracked.notes, f"averaged in bins of {step * RPM:.4g} rpm; of half ranges the largest"),
    )


def _half_width(tracked: TrackedOrders, places: NDArray[np.intp]) -> FloatArray:
    """Half width of each order in one bin of speeds, SI, shape (n_orders,)."""
    from scipy.stats import t

    own = np.sqrt(np.mean(tracked.half_widths[:, places] ** 2, axis=1))
    count = len(places)
    if count < FEWEST_VALUES:
        return np.asarray(own)
    # An order changes with speed within its bin: only what a straight line over speed leaves is scatter.
    speeds = tracked.speeds[places] - tracked.speeds[places].mean()
    values = tracked.values[:, places]
    rest = values - values.mean(axis=1, keepdims=True)
    if (speeds**2).sum() > 0:
        rest = rest - np.outer((rest * speeds).sum(axis=1) / (speeds**2).sum(), speeds)
    # Half of the variance for the real part, with two of the values used up by mean and slope.
    spread = (np.abs(rest) ** 2).sum(axis=1) / (2 * (count - 2))
    scatter = t.ppf(LEVEL, 2 * (count - 2)) * np.sqrt(spread / count)
    return np.asarray(np.fmax(own, scatter))

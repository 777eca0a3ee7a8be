"""Tracked orders prepared for the fit of a swept response, with the smear of their tracking."""

from __future__ import annotations

import numpy as np

from torsionnet.core.errors import SolveError, UsageError
from torsionnet.modal.operational.operational_modes import NORMAL_95
from torsionnet.modal.operational.order_windows import FEWEST_WINDOWS, OrderWindows
from torsionnet.modal.spectral_lines import FloatArray
from torsionnet.response.measured.tracked_orders import TrackedOrders

STEPS_PER_RADIAN = 16
"""Steps in time per radian of the order at its highest frequency, at which the response is followed."""
MOST_STEPS = 500_000
"""Largest number of steps in time, as more would take too much memory."""
KERNEL_TAILS = 3.0
"""Reach of the kernel of a Vold-Kalman filter over its inverse bandwidth: further out lies under 0.1 %."""


def tracked_windows(
    tracked: TrackedOrders,
    order: float,
    amplitudes_only: bool | None,
    revolutions: float | None,
    bandwidth: float | None,
) -> OrderWindows:
    """Tracked order as values over a fine time, each a mean of the response with the weights of its tracking."""
    from scipy.interpolate import CubicSpline
    from scipy.sparse import csr_matrix

    if revolutions is not None and bandwidth is not None:
        raise UsageError("an order is tracked in windows of revolutions or with a bandwidth: give one of them")
    values = tracked.along(order)
    known = np.isfinite(values) & np.isfinite(tracked.speeds)
    times, speeds, values = tracked.times[known], np.abs(tracked.speeds[known]), values[known]
    if len(times) < FEWEST_WINDOWS:
        raise SolveError(f"order {order:g} has {len(times)} values; a fit needs {FEWEST_WINDOWS} or more")
    if (np.diff(times) <= 0).any():
        raise UsageError("the times of a tracked order must rise: steady points are no run-up")
    steps = int((times[-1] - times[0]) * order * speeds.max() * STEPS_PER_RADIAN) + 2
    if steps > MOST_STEPS:
        raise UsageError(f"{steps} steps in time are too many: cut the run-up to the passage through the resonance")
    fine = np.linspace(times[0], times[-1], steps)
    angle = np.asarray(CubicSpline(times, speeds).antiderivative()(fine))
    step = fine[1] - fine[0]
    rows, columns, parts = [], [], []
    for row, (time, speed) in enumerate(zip(times, speeds, strict=True)):
        reach = _reach(speed, revolutions, bandwidth) or step
        first, last = np.searchsorted(fine, [time - reach, time + reach])
        one = _kernel(fine[first:last] - time, reach, bandwidth)
        rows.append(np.full(last - first, row))
        columns.append(np.arange(first, last))
        parts.append(one / one.sum())
    weights = csr_matrix((np.concatenate(parts), (np.concatenate(rows), np.concatenate(columns))), (len(times), steps))
    place = int(np.abs(tracked.orders - order).argmin())
    half = tracked.half_widths[place, known] / NORMAL_95
    usable = np.isfinite(half).all() and (half > 0).all()
    scale = np.sqrt(np.mean(half**2)) / half if usable else np.ones(len(times))
    real = not np.iscomplexobj(values) or not np.abs(values.imag).any()
    return OrderWindows(
        (order,), fine, angle, weights, values[None].astype(complex), order * speeds / (2 * np.pi), np.diag(scale), 0.0,
        real if amplitudes_only is None else amplitudes_only,
    )  # fmt: skip


def _reach(speed: float, revolutions: float | None, bandwidth: float | None) -> float:
    """Half the length in s of what one value is a mean over, 0 where it is not known."""
    if bandwidth is not None:
        return KERNEL_TAILS / bandwidth
    return 0.0 if revolutions is None else revolutions * np.pi / speed


def _kernel(times: FloatArray, reach: float, bandwidth: float | None) -> FloatArray:
    """Weights over time in s from the middle: Hann's, a triangle's over one step, or a Vold-Kalman filter's."""
    if bandwidth is None:
        return np.asarray(0.5 + 0.5 * np.cos(np.pi * times / reach))
    # two poles: 1/(1 + (f/fc)^4) with 1/sqrt(2) at half the bandwidth; its inverse transform is this decaying wave
    corner = np.pi * bandwidth / (np.sqrt(2) - 1) ** 0.25 / np.sqrt(2)
    late = corner * np.abs(times)
    return np.asarray(np.exp(-late) * (np.cos(late) + np.sin(late)))

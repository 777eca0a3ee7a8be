"""Tracked orders prepared for the fit of a swept response, with the smear of their tracking."""

from __future__ import annotations

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.modal.operational.operational_modes import NORMAL_95
from torsionnet.modal.operational.passage_windows import FEWEST_WINDOWS, PassageWindows
from torsionnet.modal.spectral_lines import FloatArray
from torsionnet.signals.orders.tracked_orders import TrackedOrders
from torsionnet.signals.orders.tracking_kernel import TrackingKernel

STEPS_PER_RADIAN = 4
"""Steps in time per radian of the order at its highest frequency, at which the response is followed."""
MOST_VALUES = 400
"""Values of an order that are kept where the noise of neighbours may be common: more of them say no more."""
MOST_STEPS = 500_000
"""Largest number of steps in time, as more would take too much memory."""


def tracked_windows(
    tracked: TrackedOrders, order: float, kernel: TrackingKernel, amplitudes_only: bool | None
) -> PassageWindows:
    """Tracked order as values over a fine time, each a mean of the response with the weights of its tracking."""
    from scipy.interpolate import CubicSpline
    from scipy.sparse import csr_matrix

    values = tracked.along(order)
    known = np.flatnonzero(np.isfinite(values) & np.isfinite(tracked.speeds))
    if (np.diff(tracked.times[known]) <= 0).any():
        raise UsageError("the times of a tracked order must rise: steady points are no run-up")
    if len(known) < 4:
        raise SolveError(f"order {order:g} has {len(known)} values; a fit needs {FEWEST_WINDOWS} or more")
    spline = CubicSpline(tracked.times[known], np.abs(tracked.speeds[known]))
    first, last = tracked.times[known[0]], tracked.times[known[-1]]
    kept = _independent(known, tracked, order, kernel)
    if len(kept) < FEWEST_WINDOWS:
        raise SolveError(
            f"order {order:g} has {len(kept)} independent values; a fit needs {FEWEST_WINDOWS} or more: track it with "
            "shorter blocks or a larger bandwidth, or fit the signal itself"
        )
    times, speeds, values = tracked.times[kept], np.abs(tracked.speeds[kept]), values[kept]
    steps = int((last - first) * order * np.abs(tracked.speeds[known]).max() * STEPS_PER_RADIAN) + 2
    if steps > MOST_STEPS:
        raise UsageError(f"{steps} steps in time are too many: cut the run-up to the passage through the resonance")
    fine = np.linspace(first, last, steps)
    rows, columns, parts = [], [], []
    for row, (time, speed) in enumerate(zip(times, speeds, strict=True)):
        reach = kernel.reach(speed, order) or fine[1] - fine[0]
        begin, end = np.searchsorted(fine, [time - reach, time + reach])
        near = fine[begin:end] - time
        one = kernel.weights(near, speed, order) if kernel.known else 1 - np.abs(near) / reach
        rows.append(np.full(end - begin, row))
        columns.append(np.arange(begin, end))
        parts.append(one / one.sum())
    weights = csr_matrix((np.concatenate(parts), (np.concatenate(rows), np.concatenate(columns))), (len(times), steps))
    alone = not np.abs(values.imag).any() if amplitudes_only is None else amplitudes_only
    return PassageWindows(
        (order,), fine, np.asarray(spline.antiderivative()(fine)), weights, values[None].astype(complex),
        order * speeds / (2 * np.pi), _noise(tracked, order, kept), 0.0, alone,
    )  # fmt: skip


def _independent(known: np.ndarray, tracked: TrackedOrders, order: float, kernel: TrackingKernel) -> np.ndarray:
    """Places of values that are so far apart that their noise is nearly independent."""
    kept: list[int] = []
    for place in known:
        distance = kernel.distance(float(abs(tracked.speeds[place])), order)
        if not kept or tracked.times[place] - tracked.times[kept[-1]] >= 0.99 * distance:
            kept.append(int(place))
    if not kernel.known:
        kept = kept[:: len(kept) // MOST_VALUES + 1]
    if kernel.revolutions:
        kept.pop()  # the last block holds the cycles that are left over
    return np.array(kept)


def _noise(tracked: TrackedOrders, order: float, kept: np.ndarray) -> FloatArray:
    """Factors that make the noise of the values one of one size, by their half widths where known, (n,)."""
    place = int(np.abs(tracked.orders - order).argmin())
    half = tracked.half_widths[place, kept] / NORMAL_95
    usable = np.isfinite(half).all() and (half > 0).all()
    return np.sqrt(np.mean(half**2)) / half if usable else np.ones(len(kept))

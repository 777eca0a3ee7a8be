"""Complex orders of a passage through a resonance in windows of angle, with the weights that made them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.modal.operational.ambient_modes import NORMAL_95
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray
from torsionnet.signals.orders.tracked_orders import TrackedOrders, TrackingKernel

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


WINDOWS_WANTED = 40
"""Windows wanted over a passage: a mode and its background have four complex unknowns, and intervals need many more
values than unknowns."""
FEWEST_WINDOWS = 10
"""Windows below which a passage is too short for a fit."""
FEWEST_CYCLES = 3.0
"""Shortest window in cycles of the order: Hann's window then suppresses the mean and the order's mirror image."""
LONGEST_WINDOW = 4.0
"""Longest window in revolutions: Hann's window then keeps orders half apart, those of a four-stroke engine."""


@dataclass(frozen=True, eq=False)
class PassageWindows:
    """Complex amplitudes of orders in windows over a passage, and how each follows from the amplitude over time.

    Attributes
    ----------
    orders : tuple of float
        Vibrations per revolution of the reference shaft; the first is the one whose frequency names the places.
    times : (n,) array
        s, at equal steps.
    angle : (n,) array
        Mean angle of rotation of the reference shaft, rad.
    weights : (n_windows, n) sparse matrix
        Share of each time in each window.
    values : (n_orders, n_windows) complex array
        Peak amplitudes, SI.
    frequencies : (n_windows,) array
        Frequency of the first order in the middle of each window, Hz.
    whitening : (n_windows, n_windows) or (n_windows,) array
        Matrix, or its diagonal alone, that makes noise of the values uncorrelated and of one size.
    revolutions : float
        Length of a window; 0 where the values were tracked elsewhere.
    amplitudes_only : bool
        Whether phases are not known.
    """

    orders: tuple[float, ...]
    times: FloatArray
    angle: FloatArray
    weights: csr_matrix
    values: ComplexArray
    frequencies: FloatArray
    whitening: FloatArray
    revolutions: float
    amplitudes_only: bool = False

    def within(self, low: float, high: float) -> PassageWindows:
        """Windows in whose middle the frequency of the first order lies between two frequencies in Hz."""
        inside = np.flatnonzero((self.frequencies >= low) & (self.frequencies <= high))
        if len(inside) < FEWEST_WINDOWS:
            raise SolveError(
                f"only {len(inside)} values of order {self.orders[0]:g} lie between {low:.4g} and {high:.4g} Hz; take "
                "a wider band, shorter windows or a slower run-up",
                kind="too-short",
            )
        rows = self.weights[inside]
        whitening = self.whitening[inside] if self.whitening.ndim == 1 else _whitening(rows)
        return PassageWindows(
            self.orders, self.times, self.angle, rows, self.values[:, inside], self.frequencies[inside], whitening,
            self.revolutions, self.amplitudes_only,
        )  # fmt: skip


def passage_windows(
    times: FloatArray, values: FloatArray, angle: FloatArray, orders: Sequence[float], revolutions: float | None = None
) -> PassageWindows:
    """Complex amplitudes of orders of a signal in Hann windows of angle that overlap by half.

    Parameters
    ----------
    times, values : (n,) arrays
        s, at equal steps, and SI.
    angle : (n,) array
        Mean angle of rotation of the reference shaft, rad, rising or falling.
    orders : sequence of float
    revolutions : float, optional
        Length of a window; by default four revolutions, or less where the passage is quick.
    """
    turned = np.asarray(np.abs(angle - angle[0]) / (2 * np.pi), dtype=np.float64)
    if (np.diff(turned) <= 0).any():
        raise UsageError(
            "the shaft must turn in one sense all the time: its mean angle of rotation stands or turns back",
            kind="wrong-sense",
        )
    shortest = FEWEST_CYCLES / min(orders)
    if revolutions is None:
        revolutions = max(shortest, min(LONGEST_WINDOW, 2 * turned[-1] / WINDOWS_WANTED))
    elif revolutions < shortest * (1 - 1e-9):
        raise UsageError(
            f"windows of {revolutions:g} revolutions are shorter than {FEWEST_CYCLES:g} cycles of order "
            f"{min(orders):g}; take {shortest:.3g} or more",
            kind="too-short",
        )
    count = int((turned[-1] - revolutions) / (revolutions / 2)) + 1
    if count < FEWEST_WINDOWS:
        raise SolveError(
            f"{turned[-1]:.3g} revolutions hold {max(count, 0)} windows of {revolutions:.3g} revolutions, too few for "
            "a fit; record a longer or slower run-up",
            kind="too-short",
        )
    middles = revolutions / 2 * (1 + np.arange(count))
    weights = _hann(turned, middles, revolutions)
    # Without mean and drift; the amplitude of order o is twice the weighted mean of x exp(-j o phi).
    straight = values - np.polynomial.Polynomial.fit(times, values, 1)(times)
    amplitudes = np.array([2 * (weights @ (straight * np.exp(-1j * order * angle))) for order in orders])
    rate = np.gradient(turned, times)
    frequencies = orders[0] * np.asarray(weights @ rate)
    noise = _whitening(weights)
    return PassageWindows(tuple(orders), times, angle, weights, amplitudes, frequencies, noise, revolutions)


def _hann(turned: FloatArray, middles: NDArray[np.floating[Any]], length: float) -> csr_matrix:
    from scipy.sparse import csr_matrix

    # The window is over angle: a sample counts by the angle it stands for, fewer of them at high speed.
    share = np.gradient(turned)
    rows, columns, parts = [], [], []
    for row, middle in enumerate(middles):
        first, last = np.searchsorted(turned, [middle - length / 2, middle + length / 2])
        window = (0.5 + 0.5 * np.cos(2 * np.pi * (turned[first:last] - middle) / length)) * share[first:last]
        rows.append(np.full(last - first, row))
        columns.append(np.arange(first, last))
        parts.append(window / window.sum())
    places = (np.concatenate(rows), np.concatenate(columns))
    return csr_matrix((np.concatenate(parts), places), shape=(len(middles), len(turned)))


def _whitening(weights: csr_matrix) -> FloatArray:
    """Inverse of the Cholesky factor of the values' covariance for white noise of the signal, over its mean size."""
    covariance = (weights @ weights.T).toarray()
    factor = np.linalg.cholesky(covariance / np.mean(np.diag(covariance)))
    return np.asarray(np.linalg.inv(factor))


# Tracked orders prepared for the fit of a swept response, with the smear of their tracking.

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
        raise UsageError("the times of a tracked order must rise: steady points are no run-up", kind="unordered-rows")
    if len(known) < 4:
        raise SolveError(
            f"order {order:g} has {len(known)} values; a fit needs {FEWEST_WINDOWS} or more", kind="too-short"
        )
    spline = CubicSpline(tracked.times[known], np.abs(tracked.speeds[known]))
    first, last = tracked.times[known[0]], tracked.times[known[-1]]
    kept = _independent(known, tracked, order, kernel)
    if len(kept) < FEWEST_WINDOWS:
        raise SolveError(
            f"order {order:g} has {len(kept)} independent values; a fit needs {FEWEST_WINDOWS} or more: track it with "
            "shorter blocks or a larger bandwidth, or fit the signal itself",
            kind="too-short",
        )
    times, speeds, values = tracked.times[kept], np.abs(tracked.speeds[kept]), values[kept]
    steps = int((last - first) * order * np.abs(tracked.speeds[known]).max() * STEPS_PER_RADIAN) + 2
    if steps > MOST_STEPS:
        raise UsageError(
            f"{steps} steps in time are too many: cut the run-up to the passage through the resonance", kind="too-large"
        )
    # The angle of rotation from the speeds: their spline integrated over steps that resolve the order.
    fine = np.linspace(first, last, steps)
    rows, columns, parts = [], [], []
    for row, (time, speed) in enumerate(zip(times, speeds, strict=True)):
        reach = kernel.reach(speed, order) or fine[1] - fine[0]
        begin, end = np.searchsorted(fine, [time - reach, time + reach])
        near = fine[begin:end] - time
        window = kernel.weights(near, speed, order) if kernel.known else 1 - np.abs(near) / reach
        rows.append(np.full(end - begin, row))
        columns.append(np.arange(begin, end))
        parts.append(window / window.sum())
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

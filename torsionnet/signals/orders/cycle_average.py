"""Complex orders by angular resampling and synchronous averaging over blocks of whole cycles.

Each signal is read at equal steps of the mean angle of rotation. Two neighbouring cycles under a Hann window as long as
both give one estimate of every multiple of 1/cycle at once: the window has its zeros there, and an order that grows
leaks less into its neighbours than through the edges of a single cycle. A block averages its estimates, under a window
that is flat but for half a Hann window on either side.

Intervals of averaged orders, from the scatter between cycles and from the bend of their course over speed. A pair of
cycles under a Hann window shares a cycle with the next pair, so that their estimates correlate by 1/6 even where the
noise does not; slow fluctuations correlate more. The correlation of neighbours, rho, is taken over all blocks of a
record, without the share that the straight line of each block adds; the mean of n estimates then has the variance s^2/n
(1 + rho)/(1 - rho) and n (1 - rho)/(1 + rho) - 2 degrees of freedom for each of two parts, as of a first-order
autoregression.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.orders.mean_rotation import MeanRotation
from torsionnet.signals.recording import FloatArray

FINER = 4
"""Factor by which an averaged wave is interpolated for its half range; a sine's peak is then missed by 2 % at most at
the highest order that the samples hold."""
FEWEST_PAIRS = 3
"""Fewest estimates of a block from whose scatter about a straight line an interval is made."""

Reader = Callable[[FloatArray], FloatArray]
"""Function that gives signals, shape (n_signals, n), at times in s that only move on."""


@dataclass(frozen=True)
class CycleAverage:
    """Averaging of orders over blocks of whole cycles.

    Attributes
    ----------
    cycles : int
        Cycles of a block, 2 or more.
    step : float
        Change of speed in rad/s that a block may hold, instead of a number of cycles; 0 where the number counts.
    """

    cycles: int = 8
    step: float = 0.0

    def __post_init__(self) -> None:
        if self.cycles < 2 or self.step < 0:
            raise UsageError(
                "a block has two cycles or more, and its step of speed is not negative", kind="out-of-range"
            )

    def blocks(self, mean: MeanRotation) -> NDArray[np.intp]:
        """Numbers of the cycles at which blocks begin, and that at which the last one ends, shape (n_blocks + 1,)."""
        count = len(mean.ends) - 1
        if not self.step:
            whole = max(count // self.cycles, 1)
            return np.array([*range(0, whole * self.cycles, self.cycles), count], dtype=np.intp)
        # Mean speed of each cycle, and the step of speed in which it lies.
        speeds = np.diff(mean.angles) / np.diff(mean.ends)
        bins = np.floor(speeds / self.step)
        begins, last = [0], bins[0]
        for at in range(2, count):
            if bins[at] != last and at - begins[-1] >= FEWEST_PAIRS + 1:
                begins.append(at)
                last = bins[at]
        # A last block too short for a scatter joins the one before.
        if count - begins[-1] < FEWEST_PAIRS + 1 and len(begins) > 1:
            begins.pop()
        return np.array([*begins, count], dtype=np.intp)


@dataclass(frozen=True, eq=False)
class AveragedBlock:
    """Orders of the signals in one block of cycles.

    Attributes
    ----------
    values : (n_signals, n_orders) complex array
        NaN where a signal dropped out for so long that too few estimates are left.
    scatter : (n_signals, n_orders) array
        Sum over the estimates of |estimate - straight line|^2.
    next_scatter : (n_signals, n_orders) array
        Real part of the sum of the products of that difference with that of the next estimate.
    count : (n_signals,) int array
        Estimates, one fewer than cycles; fewer where a signal dropped out.
    half_range : (n_signals,) array
        (max - min)/2 of the wave averaged over the cycles.
    """

    values: ComplexArray
    scatter: FloatArray
    next_scatter: FloatArray
    count: NDArray[np.intp]
    half_range: FloatArray


def averaged_blocks(
    read: Reader,
    mean: MeanRotation,
    orders: FloatArray,
    begins: NDArray[np.intp],
    per_cycle: Callable[[float], int],
    transmitted: Callable[[float], FloatArray],
    zero: float,
    lost: Callable[[FloatArray], NDArray[np.bool_]] | None = None,
) -> Iterator[AveragedBlock]:
    """Yield the orders of each block of whole cycles.

    Parameters
    ----------
    read : callable
        Signals at times.
    mean : MeanRotation
    orders : (n_orders,) array
        Multiples of 1/cycle.
    begins : (n_blocks + 1,) int array
        Cycles at which blocks begin.
    per_cycle : callable
        Samples of a cycle by its duration in s.
    transmitted : callable
        Share of each order that the interpolation between samples keeps, by the mean speed in rad/s.
    zero : float
        Mean angle of rotation, rad, that counts as 0.
    lost : callable, optional
        Whether each signal dropped out in each of the cycles with these ends, (n_signals, n_cycles): these are left
        out.
    """
    turn = 2 * np.pi * mean.cycle
    places = np.rint(orders * mean.cycle).astype(np.intp)
    for begin, end in pairwise(begins.tolist()):
        bounds = mean.ends[begin : end + 1]
        count, cycles = per_cycle(float(np.diff(bounds).max())), end - begin
        # Even steps of the mean angle, over which orders are lines even where the speed changes.
        first = mean.angles[begin] + turn * np.arange(cycles * count) / count
        last = min(first[-1], mean.angles[-1])
        waves = read(mean.times_at(np.minimum(first, last)))
        waves = waves.reshape(len(waves), cycles, count)
        whole = np.ones(waves.shape[:2], dtype=bool) if lost is None else ~lost(bounds)
        waves = without_drift(waves, whole)
        # Turned to the phase mark, and over what interpolation between samples lets pass at the mean speed.
        turned = np.exp(-1j * orders * (mean.angles[begin] - zero)) / transmitted(
            (mean.angles[end] - mean.angles[begin]) / (bounds[-1] - bounds[0])
        )
        yield _averaged(waves, places, turned, whole)


def without_drift(waves: FloatArray, whole: NDArray[np.bool_]) -> FloatArray:
    """Waves (n_signals, n_cycles, n) of cycles without their mean and without the slope of the means, in their unit.

    The means of cycles that are not ``whole``, (n_signals, n_cycles), are taken from their neighbours for the slope.
    """
    means = waves.mean(axis=2)
    courses = means.copy()
    at = np.arange(means.shape[1])
    # The mean of a lost cycle, which would bend the slope, comes from the cycles around.
    for course, kept in zip(courses, whole, strict=True):
        if kept.any() and not kept.all():
            course[~kept] = np.interp(at[~kept], at[kept], course[kept])
    slopes = np.gradient(courses, axis=1) if means.shape[1] > 1 else np.zeros_like(means)
    ramp = (np.arange(waves.shape[2]) - (waves.shape[2] - 1) / 2) / waves.shape[2]
    return np.asarray(waves - means[:, :, None] - slopes[:, :, None] * ramp)


def _averaged(
    waves: FloatArray, places: NDArray[np.intp], turned: ComplexArray, whole: NDArray[np.bool_]
) -> AveragedBlock:
    """Orders of signals from the pairs of cycles (n_signals, n_cycles, n) that are whole, NaN where too few are."""
    size, many = waves.shape[2], waves.shape[1] - 1
    # Hann window over two cycles, folded onto one: lines at multiples of 1/cycle stay whole, others leak less.
    rising = 0.5 - 0.5 * np.cos(np.pi * (np.arange(size) + 0.5) / size)
    pairs = waves[:, :-1] * rising + waves[:, 1:] * rising[::-1]
    lines = 2 * np.fft.rfft(pairs, axis=2)[:, :, places] / size * turned
    kept = (whole[:, 1:] & whole[:, :-1])[:, :, None].astype(float)
    count = kept.sum(axis=1)
    missed = count[:, 0] < min(FEWEST_PAIRS, many)
    divisor = np.maximum(count, 1)
    values = (kept * lines).sum(axis=1) / divisor
    rest = kept * (lines - values[:, None])
    if many >= FEWEST_PAIRS:
        # A straight line over the block is taken out: in a run-up orders change by it, which is not scatter.
        place = np.arange(many)[:, None] - (many - 1) / 2
        centre = (kept * place).sum(axis=1) / divisor
        line = kept * (place - centre[:, None])
        square = np.maximum((line**2).sum(axis=1), 1)
        slope = (rest * line).sum(axis=1) / square
        rest = rest - slope[:, None] * line
        # Where cycles are missing on one side, the mean of the others is that of another speed: the line goes on to the
        # middle of the block, with the larger variance that it has there.
        values = values - slope * centre
        farther = 1 + count * centre**2 / square
    else:
        farther = np.ones(count.shape)
    scatter = (np.abs(rest) ** 2).sum(axis=1) * farther
    following = (rest[:, 1:] * rest[:, :-1].conj()).real.sum(axis=1) * farther
    share = whole / np.maximum(whole.sum(axis=1, keepdims=True), 1)
    half_range = _half_range((share[:, :, None] * waves).sum(axis=1))
    values[missed], half_range[missed] = np.nan, np.nan
    return AveragedBlock(values, scatter, following, count[:, 0].astype(np.intp), half_range)


def _half_range(waves: FloatArray) -> FloatArray:
    """Half of (max - min) of periodic waves (n_signals, n), interpolated between their samples."""
    size = waves.shape[-1]
    fine = np.fft.irfft(np.fft.rfft(waves, axis=-1), FINER * size, axis=-1) * FINER
    return np.asarray((fine.max(axis=-1) - fine.min(axis=-1)) / 2)


def whole_multiples(orders: Sequence[float] | FloatArray, cycle: int) -> FloatArray:
    """Orders as an array, all of them multiples of 1/cycle.

    Raises
    ------
    UsageError
        One is no multiple.
    """
    wanted = np.asarray(orders, dtype=np.float64)
    odd = wanted[np.abs(wanted * cycle - np.rint(wanted * cycle)) > 1e-9]
    if len(odd):
        raise UsageError(
            f"order {odd[0]:g} is no multiple of 1/{cycle}: an average over whole cycles cannot tell it; take "
            "--method vold-kalman, or a longer cycle",
            kind="unfit-order",
        )
    return wanted


# Intervals of averaged orders, from the scatter between cycles and from the bend of their course over speed.

OVERLAP_CORRELATION = 1 / 6
"""Correlation of white noise under Hann windows that overlap by half."""
LARGEST_CORRELATION = 0.95
"""Largest correlation of neighbouring cycles reckoned with: beyond it a block has no two cycles that tell anything
new."""
LEVEL = 0.975
"""Quantile of Student's distribution for the half width of a 95 % interval."""
BEND_SHARE = 1 / 12
"""Share of the second difference of neighbouring blocks that counts as error: the mean over a block is off by 1/24 of
it where the course is a parabola; twice that, since at a peak it is not."""


def half_widths(blocks: Sequence[AveragedBlock]) -> FloatArray:
    """Half widths of the 95 % intervals of real and imaginary part, SI, shape (n_signals, n_orders, n_blocks)."""
    from scipy.stats import t

    counts = np.array([block.count for block in blocks])[:, :, None]
    scatter = np.array([block.scatter for block in blocks])
    rho = _correlation(blocks, counts)
    # n estimates that correlate by rho with their neighbours are worth n (1 - rho)/(1 + rho) independent ones.
    worth = np.maximum(counts * (1 - rho) / (1 + rho), 1.0)
    freedom = np.maximum(2 * (worth - 2), 1.0)
    # Real and imaginary part have half the variance each; mean and slope take two of the estimates.
    spread = scatter / (2 * np.maximum(counts - 2, 1))
    widths = t.ppf(LEVEL, freedom) * np.sqrt(spread / worth)
    widths = np.where(counts < FEWEST_PAIRS, np.nan, widths)
    values = np.array([block.values for block in blocks])
    bend = np.zeros(values.shape)
    if len(blocks) > 2:
        # Second difference over blocks: where an order bends, as in a resonance, a block's mean misses its middle.
        inner = np.nan_to_num(np.abs(values[2:] - 2 * values[1:-1] + values[:-2])) * BEND_SHARE
        bend = np.concatenate([inner[:1], inner, inner[-1:]])
    return np.asarray(np.moveaxis(np.hypot(widths, bend), 0, -1))


def _correlation(blocks: Sequence[AveragedBlock], counts: NDArray[np.intp]) -> FloatArray:
    """Correlation of neighbouring estimates, shape (n_signals, n_orders), without that which a straight line leaves."""
    enough = counts >= FEWEST_PAIRS
    if not enough.any():
        return np.full(blocks[0].values.shape, OVERLAP_CORRELATION)
    total = sum(np.where(kept, block.scatter, 0) for block, kept in zip(blocks, enough, strict=True))
    following = sum(np.where(kept, block.next_scatter, 0) for block, kept in zip(blocks, enough, strict=True))
    # White noise of unit variance keeps n - 2 of n squares after a straight line, and -2 (n - 2)/n products of
    # neighbours.
    freedom = np.where(enough, counts - 2, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = np.nan_to_num((-2 * freedom / np.maximum(counts, 1)).sum(axis=0) / freedom.sum(axis=0))
        rho = np.nan_to_num(np.asarray(following / total)) - left
    return np.asarray(np.clip(rho, OVERLAP_CORRELATION, LARGEST_CORRELATION))

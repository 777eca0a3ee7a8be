"""Orders of signals by Vold-Kalman filters, segment by segment with overlap, and their intervals.

Half widths join two parts. Noise: the residual around the frequency of each order, as the white noise that would have
the same density there, times what the filter passes of white noise, which is drawn; so that crossing orders, ends of
the record and coloured noise count. Bias: what the filter takes from its own envelopes when they are filtered once
more, doubled, since at the edge of its band it took twice as much from the true ones; plus what it left of them in the
residual around the order, as far as that is more than noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, comma_list
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.orders.mean_rotation import MeanRotation, PhaseReference
from torsionnet.signals.orders.tracked_orders import TrackedOrders
from torsionnet.signals.orders.tracked_signals import NORMAL_HALF_WIDTH, Tracked, tracked_values
from torsionnet.signals.orders.vold_kalman import COEFFICIENTS_PER_BANDWIDTH, EnvelopeFilter, VoldKalman
from torsionnet.signals.recording import FloatArray

# Orders of different shafts that cross within a record: where, and what the intervals of filters do not know there.

MOST_LISTED = 3
"""Most crossings that are named, so that the note stays short."""
LEAST_APART = 1e-6
"""Share of a frequency below which two orders run together, apart by rounding, and do not cross."""


def crossing_notes(shafts: Sequence[tuple[MeanRotation, FloatArray]], times: FloatArray) -> tuple[str, ...]:
    """Note on the orders of different shafts that cross at times in s, or none where they do not.

    While two orders are closer than the bandwidth, the signal does not say how they share it: a filter continues what
    was before and after. Its own envelopes are as smooth as it allows, so that they do not show what it missed where an
    amplitude changes within the crossing. A filter that is wider than the square root of the rate at which the two
    frequencies part has a memory shorter than the crossing.
    """
    crossings, rates = [], []
    for number, (first, own) in enumerate(shafts):
        for second, other in shafts[number + 1 :]:
            here, there = first.speed(times) / (2 * np.pi), second.speed(times) / (2 * np.pi)
            for o in own:
                for second_order in other:
                    # The orders cross where the difference of their frequencies changes its sign.
                    apart = o * here - second_order * there
                    if np.abs(apart).max() < LEAST_APART * np.abs(o * here).max():
                        continue
                    above = apart >= 0
                    for at in np.flatnonzero(above[1:] != above[:-1]):
                        share = apart[at] / (apart[at] - apart[at + 1])
                        time = times[at] + share * (times[at + 1] - times[at])
                        rates.append(abs((apart[at + 1] - apart[at]) / (times[at + 1] - times[at])))
                        crossings.append(f"{o:g} of {first.name} and {second_order:g} of {second.name} at {time:.4g} s")
    if not crossings:
        return ()
    return (
        f"orders cross: {comma_list(crossings, MOST_LISTED)}; where an amplitude changes within a crossing, as in a "
        "resonance, its interval is too narrow, the more so above a bandwidth of "
        f"{np.sqrt(min(rates)):.2g} Hz, the square root of the rate at which the frequencies part",
    )


MOST_UNKNOWNS, MOST_SAMPLES = 16_000, 150_000
"""Unknowns and samples of a segment without its overlap, which limit the memory to about 100 MB each."""
OVERLAP = 4.0
"""Overlap of segments on either side, in times 1/bandwidth: the filter's memory of an end falls by e^-2 in each."""
VALUES_PER_BANDWIDTH = 2
"""Values of an order in the time 1/bandwidth, enough to draw its course."""
NOISE_DRAWS, NOISE_SEED = 12, 11
"""Draws of white noise from which its share in each envelope is taken, 24 parts each, smoothed over the time
1/bandwidth; with a seed, so that the same record gives the same interval."""
BIAS_FACTOR = 2.0
"""True over apparent loss of an envelope's fluctuation at half of the filter's response: a (1 - H) over a H (1 - H)."""
LEFT_INTERVALS, NOISE_MULTIPLE = 3, 4.0
"""Intervals between knots over which the residual around an order is averaged, so that what the filter left of its
envelope shows, and the multiple of the mean square of noise that counts as noise: it exceeds that in 2 % of times."""
LEAST_INTERVALS = 4
"""Fewest intervals between knots of a segment, so that there is a spline."""


@dataclass(frozen=True, eq=False)
class _Part:
    """Envelopes of one segment at the times asked for, with half widths, each (n_signals, n_orders, n)."""

    values: ComplexArray
    widths: FloatArray


def filtered_orders(
    tracked: Tracked,
    shafts: Sequence[tuple[MeanRotation, FloatArray]],
    settings: VoldKalman,
    zero: PhaseReference,
) -> list[list[TrackedOrders]]:
    """Complex orders of signals in SI by Vold-Kalman filters, a list for each shaft with one entry for each signal.

    Raises
    ------
    UsageError
        The record is shorter than 1/bandwidth.
    """
    mean = shafts[0][0]
    begin = max(tracked.begin, *(shaft.ends[0] for shaft, _ in shafts))
    end = min(tracked.end, *(shaft.ends[-1] for shaft, _ in shafts))
    lowest, highest = _extreme_bandwidths(shafts, settings, begin, end)
    if not (end - begin) * lowest > 1:
        raise UsageError(
            f"{max(end - begin, 0):.4g} s are too short for a bandwidth of {lowest:.3g} Hz, which needs more than "
            f"{1 / lowest:.3g} s: take a larger one",
            kind="too-short",
        )
    # Knots as the widest filter needs them, margins as the narrowest one remembers its ends.
    step = 1 / (COEFFICIENTS_PER_BANDWIDTH * highest)
    lines = 1 + 2 * sum(len(orders) for _, orders in shafts)
    margin = int(np.ceil(OVERLAP / lowest / step))
    fastest = float(mean.speed(mean.ends).max())
    inside = int(min(MOST_UNKNOWNS / lines, MOST_SAMPLES / (tracked.rate(fastest) * step)))
    inside = max(inside, LEAST_INTERVALS, margin)
    total = max(int(np.ceil((end - begin) / step)), LEAST_INTERVALS)
    step = (end - begin) / total
    count = max(int((end - begin) * highest * VALUES_PER_BANDWIDTH), 1)
    times = begin + (end - begin) * (np.arange(count) + 0.5) / count
    parts = []
    for first in range(0, total, inside):
        last = min(first + inside, total)
        knots = begin + step * np.arange(max(first - margin, 0), min(last + margin, total) + 1)
        upper = begin + step * last
        own = times[(times >= begin + step * first) & ((times < upper) | (last == total))]
        parts.append(_segment(tracked, shafts, settings, zero, knots, own))
    values = np.concatenate([part.values for part in parts], axis=2)
    widths = np.concatenate([part.widths for part in parts], axis=2)
    return _results(tracked, shafts, settings, zero, times, values, widths)


def _results(
    tracked: Tracked, shafts: Sequence[tuple[MeanRotation, FloatArray]], settings: VoldKalman, zero: PhaseReference,
    times: FloatArray, values: ComplexArray, widths: FloatArray,
) -> list[list[TrackedOrders]]:  # fmt: skip
    said = f"{settings.words}; intervals from the residual and from the bend of the envelopes"
    crossing = crossing_notes(shafts, times)
    by_shaft, at = [], 0
    for number, (shaft, orders) in enumerate(shafts):
        mine = slice(at, at + len(orders))
        at += len(orders)
        speeds = shaft.speed(times)
        mark = zero if number == 0 else PhaseReference(float(shaft.angles[0]), "")
        kept = values[:, mine]
        within = settings.bandwidths(np.outer(orders, speeds / (2 * np.pi)))
        # A value averages over the time 1/bandwidth: single cycles scatter by the root of their number more.
        cycles = np.maximum(speeds / (2 * np.pi * shaft.cycle) / within, 1)
        seen = np.sqrt(cycles) * widths[:, mine]
        wide = np.hypot(widths[:, mine], tracked.uncertain(orders, speeds, seen) if number == 0 else 0.0)
        ranges = half_ranges(kept, orders, shaft.cycle)
        notes = (*shaft.notes, said, *crossing, *tracked.notes)
        related = tuple((settings.related_bandwidths / within.mean(axis=1)).tolist())
        if number:
            notes = (*notes, f"orders of {shaft.name}")
        by_shaft.append([
            tracked_values(signal, orders, times, speeds, kept[place], wide[place], ranges[place], mark,
                           (*notes, *_remarks(tracked, signal.name)), settings.kernel, related)
            for place, signal in enumerate(tracked.signals)
        ])  # fmt: skip
    return by_shaft


def _remarks(tracked: Tracked, name: str) -> tuple[str, ...]:
    """Words on what a signal lost, and on what it lacks as others lost it: all are filtered with the same samples."""
    others = [signal.name for signal in tracked.signals if signal.name != name and tracked.remarks(signal.name)]
    lacks = (f"samples left out with those that {comma_list(others)} lost, as they are filtered together",)
    return (*tracked.remarks(name), *(lacks if others else ()))


def half_ranges(values: ComplexArray, orders: FloatArray, cycle: int) -> FloatArray:
    """Half of (max - min) of the sum of orders over a cycle, (n_signals, n_times), in the unit of the orders."""
    # Sixteen points per period of the highest order miss its extremes by 2 % at most.
    points = int(np.ceil(16 * max(orders.max(), 1) * cycle))
    angles = 2 * np.pi * cycle * np.arange(points) / points
    turning = np.exp(1j * np.outer(orders, angles))
    ranges = np.empty(values.shape[::2])
    for signal, lines in enumerate(values):
        # Some hundred times at once: sums of all orders at all angles would not fit into memory.
        for begin in range(0, lines.shape[1], 256):
            wave = (lines[:, begin : begin + 256].T @ turning).real
            ranges[signal, begin : begin + 256] = np.ptp(wave, axis=1) / 2
    return ranges


def _extreme_bandwidths(
    shafts: Sequence[tuple[MeanRotation, FloatArray]], settings: VoldKalman, begin: float, end: float
) -> tuple[float, float]:
    widths = []
    for mean, orders in shafts:
        kept = (mean.ends >= begin) & (mean.ends <= end)
        if not kept.any():
            raise UsageError(
                f"{mean.name} does not turn while the record lasts: are both on one clock?", kind="turning-back"
            )
        speeds = mean.speed(mean.ends[kept]) / (2 * np.pi)
        widths += [settings.bandwidths(np.outer(orders, [speeds.min(), speeds.max()]))]
    both = np.concatenate([width.ravel() for width in widths])
    return float(both.min()), float(both.max())


def _segment(
    tracked: Tracked, shafts: Sequence[tuple[MeanRotation, FloatArray]], settings: VoldKalman, zero: PhaseReference,
    knots: FloatArray, times: FloatArray,
) -> _Part:  # fmt: skip
    at, values = tracked.samples(float(knots[0]), float(knots[-1]))
    phases, widths = [], []
    middles = (knots[1:] + knots[:-1]) / 2
    for number, (mean, orders) in enumerate(shafts):
        start = zero.angle if number == 0 else mean.angles[0]
        phases.append(np.outer(orders, mean.angle(at) - start))
        widths.append(settings.bandwidths(np.outer(orders, mean.speed(middles) / (2 * np.pi))))
    phase, width = np.concatenate(phases), np.concatenate(widths)
    least = width.min(axis=0, keepdims=True)
    filtered = EnvelopeFilter(at, phase, knots, np.concatenate([least, width]), settings.poles)
    # White noise goes through the same filter, so that crossings, ends and a change of speed count as they are.
    noise = np.random.default_rng(NOISE_SEED).standard_normal((NOISE_DRAWS, len(at)))
    solved = filtered.solve(np.concatenate([values, noise]))
    own, drawn = solved[:, :, : len(values)], solved[:, :, len(values) :]
    _, envelopes = filtered.envelopes(own, times)
    # What a second filtering takes from the envelopes stands for what the first one took: the bias.
    lost = np.abs(filtered.envelopes(filtered.lost(own), times)[1])
    passed = (np.abs(filtered.envelopes(drawn, middles)[1]) ** 2).mean(axis=0) / 2
    residual = _Residual.around(filtered, filtered.residual(own, values), phase, knots)
    reach = COEFFICIENTS_PER_BANDWIDTH
    # Density of the noise: the power around an order in the residual, over the share that the filter leaves there.
    density = _mean_around(residual.power, 5 * reach) / _kept_of_noise(settings.poles)
    noise_width = np.sqrt(_at(np.maximum(_mean_around(passed, reach) * density, 0), middles, times))
    left = _at(residual.left(density), middles, times)
    bias = _largest_around(BIAS_FACTOR * lost + left, VALUES_PER_BANDWIDTH // 2)
    envelopes[:, :, _without_samples(at, times, float(width.max()))] = np.nan
    return _Part(envelopes, np.hypot(NORMAL_HALF_WIDTH * noise_width, bias))


def _without_samples(at: FloatArray, times: FloatArray, bandwidth: float) -> NDArray[np.bool_]:
    """Whether all samples of the time that each value stands for dropped out, shape (n_times,)."""
    reach = 0.5 / (VALUES_PER_BANDWIDTH * bandwidth)
    return np.asarray(np.searchsorted(at, times + reach) == np.searchsorted(at, times - reach))


@dataclass(frozen=True, eq=False)
class _Residual:
    """Residual turned back by the phase of each order, in each interval between knots.

    Attributes
    ----------
    sums : (n_signals, n_orders, n_intervals) complex array
        Sum over the samples of the interval.
    counts : (n_intervals,) array
        Samples of each interval.
    """

    sums: ComplexArray
    counts: FloatArray

    @staticmethod
    def around(filtered: EnvelopeFilter, residual: FloatArray, phases: FloatArray, knots: FloatArray) -> _Residual:
        starts = np.searchsorted(filtered.times, knots[:-1])
        counts = np.diff([*starts, len(filtered.times)])
        filled = np.flatnonzero(counts)
        sums = np.zeros((len(residual), len(phases), len(counts)), dtype=complex)
        for order, phase in enumerate(phases):
            turned = residual * np.exp(-1j * phase)
            sums[:, order, filled] = np.add.reduceat(turned, starts[filled], axis=1)
        return _Residual(sums, counts.astype(float))

    @property
    def power(self) -> FloatArray:
        """Variance of white noise as dense as the residual around each order, (n_signals, n_orders, n_intervals)."""
        return np.asarray(np.abs(self.sums) ** 2 / np.maximum(self.counts, 1))

    def left(self, density: FloatArray) -> FloatArray:
        """Part of the envelope that is left in the residual, where it is larger than noise of the density leaves."""
        reach = LEFT_INTERVALS // 2
        samples = np.maximum(_mean_around(self.counts, reach), 1 / LEFT_INTERVALS)
        # Twice the mean of residual times exp(-j phase) is the envelope that is left.
        mean = 2 * (_mean_around(self.sums.real, reach) + 1j * _mean_around(self.sums.imag, reach)) / samples
        # Noise alone leaves a squared mean of 4 S/n from n samples of variance S.
        noise = 4 * density / (LEFT_INTERVALS * samples)
        return np.asarray(np.sqrt(np.maximum(np.abs(mean) ** 2 - NOISE_MULTIPLE * noise, 0)))


def _kept_of_noise(poles: int) -> float:
    """Share of white noise around an order that the residual keeps, over the band of one interval between knots."""
    place = np.linspace(0, COEFFICIENTS_PER_BANDWIDTH, 2001)[1:]
    # The residual has 1 - H of the noise: its power is the mean of (1 - H)^2.
    response = 1 / (1 + (np.sqrt(2) - 1) * place ** (2.0 * poles))
    return float(((1 - response) ** 2).mean())


def _mean_around(values: FloatArray, reach: int) -> FloatArray:
    """Mean of values over neighbours on both sides along the last axis, in their unit.

    It is a running sum, whose rounding leaves a little of large values, of either sign, where small ones follow.
    """
    from scipy.ndimage import uniform_filter1d

    return np.asarray(uniform_filter1d(values, 2 * reach + 1, axis=-1, mode="nearest"))


def _largest_around(values: FloatArray, reach: int) -> FloatArray:
    """Largest of values among neighbours on both sides along the last axis, in their unit."""
    from scipy.ndimage import maximum_filter1d

    return np.asarray(maximum_filter1d(values, 2 * reach + 1, axis=-1, mode="nearest"))


def _at(values: FloatArray, places: FloatArray, times: FloatArray) -> FloatArray:
    """Values (n_signals, n_orders, n) between their places, in their unit."""
    wide = np.broadcast_to(values, (*values.shape[:-1], len(places)))
    flat = wide.reshape(-1, len(places))
    return np.array([np.interp(times, places, line) for line in flat]).reshape(*wide.shape[:-1], len(times))

"""Search of the angles between engines of unknown phase that give the largest half range of the sum of orders.

Between two instants tau apart each engine rises as it would alone, and as the angles are free, it may be at any of its
own instants. So the largest range is the maximum over tau of the sum of the largest rises of all engines within tau:
one search, however many engines there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.engine_blocks import BlockGrid
from torsionnet.machinery.orders.order_line import OrderLine

REFINED_MAXIMA = 4
"""Number of the highest maxima that Newton's method refines, of a wave's largest rise as a function of the time it
takes."""
NEWTON_STEPS = 5
"""Number of steps of Newton's method to a maximum, enough from within a sixteenth of a period."""
EQUAL_SHARE = 1e-9
"""Relative difference up to which maxima of vibration count as equal, so that the first is taken on every machine."""

Shares: TypeAlias = Sequence[tuple[slice, ComplexArray]]
"""Pairs of a slice of order lines and contributions to their amplitudes (SI), shape (n_shares, n_speeds, n_lines,
n_out), each of which may count from -1 to 1 times."""
IntArray: TypeAlias = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class WorstAngles:
    """Delays in rad by engine, and signs of scattered contributions, with the largest half range of the sum of orders.

    Attributes
    ----------
    delays : tuple of (n_speeds, n_out) arrays
        By block, delay after the first block, rad of the reference shaft.
    signs : tuple of (n_speeds, n_out, n_shares) arrays of int
        For each set of shares, 1 where a share is up and -1 where it is down.
    """

    delays: tuple[FloatArray, ...]
    signs: tuple[NDArray[np.int8], ...]


def worst_angles(values: ComplexArray, lines: Sequence[OrderLine], grid: BlockGrid, shares: Shares = ()) -> WorstAngles:
    """Engine delays in rad, and signs of contributions, with the largest half range of the sum of all order lines."""
    motions = [_Motion.of(values, lines, grid, number, shares) for number in range(len(grid.places))]
    rises = sum(np.tile(one.rises, grid.points // one.rises.shape[2]) for one in motions)
    best: _Found | None = None
    for lag in highest_maxima(np.asarray(rises)):
        found = _followed(motions, lag, 2 * np.pi * float(grid.cycle) / grid.points)
        best = found if best is None else best.or_if_larger(found)
    assert best is not None
    signs: list[NDArray[np.int8]] = [np.zeros(0, dtype=np.int8)] * len(shares)
    for one, own in zip(motions, best.signs, strict=True):
        first = 0
        for place in one.of_shares:
            count = len(shares[place][1])
            signs[place] = own[:, :, first : first + count]
            first += count
    return WorstAngles(tuple(best.starts[0] - start for start in best.starts), tuple(signs))


@dataclass(frozen=True, eq=False)
class _Motion:
    """Order lines of one engine block, with their amplitudes, their sum along the cycle and its largest rises, in SI.

    ``amplitudes`` (n_speeds, n_own, n_out) and ``rates``, vibrations per revolution of the reference shaft; ``free``
    has contributions (n_free, n_speeds, n_own, n_out) of either sign. ``wave`` (n_speeds, n_out, period) and ``waves``
    (n_free, n_speeds, n_out, period) are on the grid, ``rises`` the largest rises by the number of steps in between.
    """

    amplitudes: ComplexArray
    free: ComplexArray
    rates: FloatArray
    wave: FloatArray
    waves: FloatArray
    rises: FloatArray
    of_shares: tuple[int, ...]

    @classmethod
    def of(
        cls, values: ComplexArray, lines: Sequence[OrderLine], grid: BlockGrid, number: int, shares: Shares
    ) -> _Motion:
        places, period = list(grid.places[number]), grid.periods[number]
        rates = np.array([float(lines[at].relative) for at in places])
        amplitudes = values[:, places]
        of_shares = tuple(at for at, (own, _) in enumerate(shares) if set(range(own.start, own.stop)) & set(places))
        free = np.zeros((sum(len(shares[at][1]) for at in of_shares), *amplitudes.shape), dtype=complex)
        first = 0
        for at in of_shares:
            own, contributions = shares[at]
            for line in range(own.start, own.stop):
                if line in places:
                    free[first : first + len(contributions), :, places.index(line)] = contributions[
                        :, :, line - own.start
                    ]
            first += len(contributions)
        angles = 2 * np.pi * float(grid.cycle) / grid.points * np.arange(period)
        basis = np.exp(1j * np.outer(rates, angles))
        wave = np.einsum("slo,lm->som", amplitudes, basis).real
        waves = np.einsum("kslo,lm->ksom", free, basis).real
        return cls(amplitudes, free, rates, wave, waves, _rises(wave, waves), of_shares)

    def at(self, lag: IntArray) -> tuple[IntArray, NDArray[np.int8]]:
        """Index (n_speeds, n_out) of the grid step where the largest rise over ``lag`` steps begins, and signs."""
        period = self.wave.shape[2]
        later = (np.arange(period) + lag[..., None]) % period
        changes = [np.take_along_axis(one, later, axis=2) - one for one in self.waves]
        rise = np.take_along_axis(self.wave, later, axis=2) - self.wave + sum(map(np.abs, changes))
        start = _first_of_largest(rise)
        signs = [np.take_along_axis(one, start[..., None], axis=2)[..., 0] >= 0 for one in changes]
        up = np.array(signs, dtype=np.int8).reshape(-1, *start.shape)
        return start, np.moveaxis(2 * up - 1, 0, -1)

    def with_signs(self, signs: NDArray[np.int8]) -> ComplexArray:
        return np.asarray(self.amplitudes + np.einsum("kslo,sok->slo", self.free, signs))


@dataclass(frozen=True, eq=False)
class _Found:
    """Largest range (max - min) of the sum of orders (SI), its start angles in rad by engine, and signs."""

    size: FloatArray
    starts: tuple[FloatArray, ...]
    signs: tuple[NDArray[np.int8], ...]

    def or_if_larger(self, other: _Found) -> _Found:
        better = other.size > self.size * (1 + EQUAL_SHARE)
        return _Found(
            np.where(better, other.size, self.size),
            tuple(np.where(better, new, old) for new, old in zip(other.starts, self.starts, strict=True)),
            tuple(np.where(better[..., None], new, old) for new, old in zip(other.signs, self.signs, strict=True)),
        )


def _rises(wave: FloatArray, waves: FloatArray) -> FloatArray:
    """Largest rise of a periodic wave, in its unit, over each number of grid steps, shape (n_speeds, n_out, period)."""
    period = wave.shape[2]
    found = np.empty_like(wave)
    twice = np.concatenate([wave, wave], axis=2)
    others = np.concatenate([waves, waves], axis=3)
    for lag in range(period):
        rise = twice[:, :, lag : lag + period] - wave
        for one, doubled in zip(waves, others, strict=True):
            rise += np.abs(doubled[:, :, lag : lag + period] - one)
        found[:, :, lag] = rise.max(axis=2)
    return found


def highest_maxima(rises: FloatArray) -> list[IntArray]:
    """List of the grid steps (n_speeds, n_out) of highest local maxima of rises along the last axis, highest first."""
    top = rises.max(axis=2, keepdims=True)
    level = np.round(rises / np.where(top > 0, top, 1) / EQUAL_SHARE) * EQUAL_SHARE
    is_crest = (level >= np.roll(level, 1, axis=2)) & (level >= np.roll(level, -1, axis=2))
    order = np.argsort(-np.where(is_crest, level, -1), axis=2, kind="stable")
    return [order[:, :, rank] for rank in range(min(REFINED_MAXIMA, order.shape[2]))]


def _first_of_largest(values: FloatArray) -> IntArray:
    """Index along an array's last axis of the first value that is the largest within rounding."""
    top, bottom = values.max(axis=-1, keepdims=True), values.min(axis=-1, keepdims=True)
    return np.asarray(np.argmax(values >= top - EQUAL_SHARE * (top - bottom), axis=-1))


def _followed(motions: Sequence[_Motion], lag: IntArray, step: float) -> _Found:
    """Largest range (max - min) of the sum of orders (SI) after Newton's method, with start angles (rad) and signs."""
    found = [one.at(lag) for one in motions]
    amplitudes = [one.with_signs(signs) for one, (_, signs) in zip(motions, found, strict=True)]
    starts: list[FloatArray] = [np.asarray(step * start) for start, _ in found]
    tau: FloatArray = step * lag.astype(float)
    size = _range(motions, amplitudes, starts, tau)
    best, top = [*starts], size
    for _ in range(NEWTON_STEPS):
        starts, tau = _newton(motions, amplitudes, starts, tau, step)
        size = _range(motions, amplitudes, starts, tau)
        better = size > top * (1 + EQUAL_SHARE)
        best = [np.where(better, new, old) for new, old in zip(starts, best, strict=True)]
        top = np.maximum(size, top)
    return _Found(top, tuple(best), tuple(signs for _, signs in found))


def _range(
    motions: Sequence[_Motion], amplitudes: Sequence[ComplexArray], starts: Sequence[FloatArray], tau: FloatArray
) -> FloatArray:
    total = np.zeros_like(tau)
    for one, own, start in zip(motions, amplitudes, starts, strict=True):
        total += _derivative(one.rates, own, start + tau, 0) - _derivative(one.rates, own, start, 0)
    return total


def _newton(
    motions: Sequence[_Motion],
    amplitudes: Sequence[ComplexArray],
    starts: Sequence[FloatArray],
    tau: FloatArray,
    step: float,
) -> tuple[list[FloatArray], FloatArray]:
    """Start angles by engine, and angle tau from the lowest to the highest instant, in rad after one Newton step.

    The Hessian couples the start angles only through tau.
    """
    slope, curvature = np.zeros_like(tau), np.zeros_like(tau)
    each = []
    for one, own, start in zip(motions, amplitudes, starts, strict=True):
        first, second = (_derivative(one.rates, own, start + tau, order) for order in (1, 2))
        gradient = first - _derivative(one.rates, own, start, 1)
        bend = second - _derivative(one.rates, own, start, 2)
        is_top = bend < 0
        inverse = np.divide(1.0, bend, out=np.zeros_like(bend), where=is_top)
        each.append((gradient, second, inverse))
        slope += first - second * gradient * inverse
        curvature += second - second**2 * inverse
    change = np.divide(-slope, curvature, out=np.zeros_like(slope), where=curvature < 0)
    change = np.clip(change, -step, step)
    moved = [
        start + np.clip(-(gradient + second * change) * inverse, -step, step)
        for start, (gradient, second, inverse) in zip(starts, each, strict=True)
    ]
    return moved, tau + change


def _derivative(rates: FloatArray, amplitudes: ComplexArray, angle: FloatArray, order: int) -> FloatArray:
    """Derivative (n_speeds, n_out) of given order of Re sum X exp(j r angle) by the angle in rad, in the unit of X."""
    terms = amplitudes * (1j * rates[:, None]) ** order * np.exp(1j * rates[:, None] * angle[:, None, :])
    return np.asarray(terms.real.sum(axis=1))

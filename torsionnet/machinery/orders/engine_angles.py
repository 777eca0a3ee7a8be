"""Order amplitudes with engines on unconnected crankshafts at angles of largest or smallest half range of their sum.

Search of the angles between engines of unknown phase that give the largest half range of the sum of orders. Between two
instants tau apart each engine rises as it would alone, and as the angles are free, it may be at any of its own
instants. So the largest range is the maximum over tau of the sum of the largest rises of all engines within tau: one
search, however many engines there are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.order_line import (
    BlockGrid,
    EngineBlock,
    OrderLine,
    blocks_by_speed,
    engine_blocks,
    greatest_common_divisor,
)

# Search of the angles between engines of unknown phase that give the largest half range of the sum of orders.

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
    # max over angles of (max - min) = max over tau of sum_b max over a_b of x_b(a_b + tau) - x_b(a_b): every engine
    # may begin its rise where it likes, so that only tau is common.
    rises = sum(np.tile(motion.rises, grid.points // motion.rises.shape[2]) for motion in motions)
    best: _Found | None = None
    for lag in highest_maxima(np.asarray(rises)):
        refined = _refined_ranges(motions, lag, 2 * np.pi * float(grid.cycle) / grid.points)
        best = refined if best is None else best.or_if_larger(refined)
    assert best is not None
    signs: list[NDArray[np.int8]] = [np.zeros(0, dtype=np.int8)] * len(shares)
    for motion, own in zip(motions, best.signs, strict=True):
        first = 0
        for place in motion.of_shares:
            count = len(shares[place][1])
            signs[place] = own[:, :, first : first + count]
            first += count
    # Engine b begins to rise at its own angle a_b; delayed by a_0 - a_b it does so together with the first.
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
        # x(phi) = Re sum_l X_l exp(j r_l phi) over the period of the block, and the same of every share.
        wave = np.einsum("slo,lm->som", amplitudes, basis).real
        waves = np.einsum("kslo,lm->ksom", free, basis).real
        return cls(amplitudes, free, rates, wave, waves, _rises(wave, waves), of_shares)

    def at(self, lag: IntArray) -> tuple[IntArray, NDArray[np.int8]]:
        """Index (n_speeds, n_out) of the grid step where the largest rise over ``lag`` steps begins, and signs."""
        period = self.wave.shape[2]
        later = (np.arange(period) + lag[..., None]) % period
        # Each share takes the sign that adds to this rise: its part is |change|.
        changes = [np.take_along_axis(wave, later, axis=2) - wave for wave in self.waves]
        rise = np.take_along_axis(self.wave, later, axis=2) - self.wave + sum(map(np.abs, changes))
        start = _first_of_largest(rise)
        signs = [np.take_along_axis(change, start[..., None], axis=2)[..., 0] >= 0 for change in changes]
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
    rises = np.empty_like(wave)
    # Two periods in a row, so that a lag is a slice of them.
    twice = np.concatenate([wave, wave], axis=2)
    others = np.concatenate([waves, waves], axis=3)
    for lag in range(period // 2 + 1):
        rise = twice[:, :, lag : lag + period] - wave
        up, down = rise, rise
        for own, doubled in zip(waves, others, strict=True):
            change = np.abs(doubled[:, :, lag : lag + period] - own)
            up, down = up + change, down - change
        rises[:, :, lag] = up.max(axis=2)
        # A fall over a lag is a rise over the rest of the period.
        rises[:, :, -lag % period] = -down.min(axis=2)
    return rises


def highest_maxima(rises: FloatArray) -> list[IntArray]:
    """List of the grid steps (n_speeds, n_out) of highest local maxima of rises along the last axis, highest first."""
    top = rises.max(axis=2, keepdims=True)
    # In steps of EQUAL_SHARE, so that among equal maxima the first is taken and rounding does not choose.
    level = np.round(rises / np.where(top > 0, top, 1) / EQUAL_SHARE) * EQUAL_SHARE
    is_crest = (level >= np.roll(level, 1, axis=2)) & (level >= np.roll(level, -1, axis=2))
    order = np.argsort(-np.where(is_crest, level, -1), axis=2, kind="stable")
    return [order[:, :, rank] for rank in range(min(REFINED_MAXIMA, order.shape[2]))]


def _first_of_largest(values: FloatArray) -> IntArray:
    """Index along an array's last axis of the first value that is the largest within rounding."""
    top, bottom = values.max(axis=-1, keepdims=True), values.min(axis=-1, keepdims=True)
    return np.asarray(np.argmax(values >= top - EQUAL_SHARE * (top - bottom), axis=-1))


def _refined_ranges(motions: Sequence[_Motion], lag: IntArray, step: float) -> _Found:
    """Largest range (max - min) of the sum of orders (SI) after Newton's method, with start angles (rad) and signs."""
    rising = [motion.at(lag) for motion in motions]
    amplitudes = [motion.with_signs(signs) for motion, (_, signs) in zip(motions, rising, strict=True)]
    starts: list[FloatArray] = [np.asarray(step * start) for start, _ in rising]
    tau: FloatArray = step * lag.astype(float)
    ends = _ends(motions, amplitudes, starts, tau)
    best, top = [*starts], _range(ends)
    for _ in range(NEWTON_STEPS):
        starts, tau = _newton(ends, starts, tau, step)
        ends = _ends(motions, amplitudes, starts, tau)
        size = _range(ends)
        # A step of Newton may overshoot: the best of all iterates counts.
        better = size > top * (1 + EQUAL_SHARE)
        best = [np.where(better, new, old) for new, old in zip(starts, best, strict=True)]
        top = np.maximum(size, top)
    return _Found(top, tuple(best), tuple(signs for _, signs in rising))


Sum: TypeAlias = tuple[FloatArray, FloatArray, FloatArray]
"""Sum of an engine's orders at an angle, in SI, with its first and second derivative to the angle in rad."""


def _ends(
    motions: Sequence[_Motion], amplitudes: Sequence[ComplexArray], starts: Sequence[FloatArray], tau: FloatArray
) -> list[tuple[Sum, Sum]]:
    """Sums of orders at the highest and at the lowest instant, by engine."""
    return [
        (_summed(motion.rates, own, start + tau), _summed(motion.rates, own, start))
        for motion, own, start in zip(motions, amplitudes, starts, strict=True)
    ]


def _range(ends: Sequence[tuple[Sum, Sum]]) -> FloatArray:
    return np.asarray(sum(high[0] - low[0] for high, low in ends))


def _newton(
    ends: Sequence[tuple[Sum, Sum]], starts: Sequence[FloatArray], tau: FloatArray, step: float
) -> tuple[list[FloatArray], FloatArray]:
    """Start angles by engine, and angle tau from the lowest to the highest instant, in rad after one Newton step.

    The Hessian couples the start angles only through tau.
    """
    slope, curvature = np.zeros_like(tau), np.zeros_like(tau)
    each = []
    # R = sum_b x_b(a_b + tau) - x_b(a_b), with the gradients x_b'(a_b + tau) - x_b'(a_b) to a_b
    # and sum_b x_b'(a_b + tau) to tau.
    for (_, first, second), (_, slope_below, bend_below) in ends:
        gradient, bend = first - slope_below, second - bend_below
        is_top = bend < 0
        inverse = np.divide(1.0, bend, out=np.zeros_like(bend), where=is_top)
        each.append((gradient, second, inverse))
        # Schur complement: the a_b are eliminated one by one, as they meet each other only through tau.
        slope += first - second * gradient * inverse
        curvature += second - second**2 * inverse
    change = np.divide(-slope, curvature, out=np.zeros_like(slope), where=curvature < 0)
    # No further than a step of the grid, or the search would leave its maximum.
    change = np.clip(change, -step, step)
    moved = [
        start + np.clip(-(gradient + second * change) * inverse, -step, step)
        for start, (gradient, second, inverse) in zip(starts, each, strict=True)
    ]
    return moved, tau + change


def _summed(rates: FloatArray, amplitudes: ComplexArray, angle: FloatArray) -> Sum:
    """Re sum X exp(j r angle) with its derivatives to the angle in rad, each (n_speeds, n_out), in the unit of X."""
    rate = rates[:, None]
    # X exp(j r phi) = (a + j b)(cos + j sin); each derivative brings j r.
    turned = rate * angle[:, None, :]
    cosine, sine = np.cos(turned), np.sin(turned)
    real = amplitudes.real * cosine - amplitudes.imag * sine
    imaginary = amplitudes.real * sine + amplitudes.imag * cosine
    return real.sum(axis=1), -(rate * imaginary).sum(axis=1), -(rate**2 * real).sum(axis=1)


SPEEDS_PER_SEARCH = 50
"""Number of speeds that are searched for engine angles together, which limits the memory."""
EQUAL_ANGLE = 1e-5
"""Angle difference in rad, and as a share of a period, below which angles between engines count as equal: at an
extremum the half range varies too little to determine the angle any better."""
NEGLIGIBLE_AMPLITUDE = 1e-6
"""Share of an engine's largest amplitude below which an order does not count for the period of the engine angle."""


@dataclass(frozen=True, eq=False)
class EngineAngle:
    """Crank angle in rad by which an engine fires later than another one, by speed and output.

    Attributes
    ----------
    engine, after : str
    angle : (n_speeds, n_out) array
        Angle of the engine's crankshaft in rad, from 0 to less than ``period``.
    period : (n_speeds, n_out) array
        Angle of the engine's crankshaft in rad after which the sum of both repeats: its cycle or, with equal cylinders
        on one throw, a part of it.
    """

    engine: str
    after: str
    angle: FloatArray
    period: FloatArray

    @property
    def degrees(self) -> FloatArray:
        """Crank angle in degrees by which an engine fires later than another one, shape (n_speeds, n_out)."""
        return np.degrees(self.angle)

    def at(self, speed: int, output: int) -> str:
        """Sentence on an engine's angle at a speed and an output, by index, 'port fires 30 deg after starboard'."""
        period = round(math.degrees(self.period[speed, output]), 1)
        degrees = round(float(self.degrees[speed, output]), 1) % period
        return f"{self.engine} fires {degrees:g} deg after {self.after}"

    def part(self, speeds: Sequence[int], outputs: Sequence[int]) -> EngineAngle:
        """Engine angle in rad at some speeds and outputs only, given by their indices."""
        angle, period = (of[list(speeds)][:, list(outputs)] for of in (self.angle, self.period))
        return replace(self, angle=angle, period=period)

    def joined(self, others: Sequence[EngineAngle], order: NDArray[np.intp]) -> EngineAngle:
        """Engine angle in rad at all speeds, joined from parts at some speeds and sorted by the indices ``order``."""
        angles, periods = ([getattr(angle, name) for angle in (self, *others)] for name in ("angle", "period"))
        return replace(self, angle=np.concatenate(angles)[order], period=np.concatenate(periods)[order])


@dataclass(frozen=True, eq=False)
class AmplitudesAtAngles:
    """Complex order amplitudes (SI) by speed, order line and output, with all engine angles decided.

    Attributes
    ----------
    values : (n_speeds, n_lines, n_out) complex array
    lines : tuple of OrderLine
        Lines as before, with engines of one speed marked as one engine.
    angles : tuple of EngineAngle
    signs : tuple of (n_speeds, n_out, n_shares) arrays of int
        Signs chosen for each set of shares.
    """

    values: ComplexArray
    lines: tuple[OrderLine, ...]
    angles: tuple[EngineAngle, ...]
    signs: tuple[NDArray[np.int8], ...]


def at_worst_angles(values: ComplexArray, lines: Sequence[OrderLine], shares: Shares = ()) -> AmplitudesAtAngles:
    """Order amplitudes (SI) at engine angles and signs of contributions that give their sum the largest half range."""
    signs = [np.ones((len(values), values.shape[2], len(own)), dtype=np.int8) for _, own in shares]
    delays: dict[EngineBlock, FloatArray] = {}
    for blocks in blocks_by_speed(lines):
        grid = BlockGrid.of(lines, blocks)
        searched = [at for at, (own, _) in enumerate(shares) if any(own.start in places for places in grid.places)]
        if len(blocks) == 1 and not searched:
            continue
        for start in range(0, len(values), SPEEDS_PER_SEARCH):
            part = slice(start, start + SPEEDS_PER_SEARCH)
            worst = worst_angles(
                values[part], lines, grid, [(shares[at][0], shares[at][1][:, part]) for at in searched]
            )
            for at, own in zip(searched, worst.signs, strict=True):
                signs[at][part] = own
            for block, delay in zip(blocks[1:], worst.delays[1:], strict=True):
                delays.setdefault(block, np.zeros((len(values), values.shape[2])))[part] = delay
    together = values.copy()
    for (own_lines, contributions), own in zip(shares, signs, strict=True):
        # Contributions with their signs belong to an engine and are turned with it below.
        together[:, own_lines] += np.einsum("kslo,sok->slo", contributions, own)
    return at_engine_angles(together, lines, delays, tuple(signs))


def at_engine_angles(
    values: ComplexArray,
    lines: Sequence[OrderLine],
    delays: Mapping[EngineBlock, FloatArray],
    signs: tuple[NDArray[np.int8], ...] = (),
) -> AmplitudesAtAngles:
    """Order amplitudes (SI) with engines delayed by given angles in rad of the reference shaft."""
    angles = []
    for blocks in blocks_by_speed(lines):
        for block in blocks[1:]:
            period = _period(values, lines, [blocks[0], block] if len(blocks) == 2 else [block])
            delay = delays[block] % period
            # A delay of a whole period is none.
            delay[np.isclose(delay, period, rtol=EQUAL_ANGLE, atol=EQUAL_ANGLE)] = 0.0
            # An angle of the reference shaft times the ratio is one of the engine's crankshaft.
            ratio = _ratio(lines, block)
            angles.append(EngineAngle(block.engine, blocks[0].engine, delay * ratio, period * ratio))
    return AmplitudesAtAngles(with_engines_delayed(values, lines, angles), engines_as_one(lines), tuple(angles), signs)


def _period(values: ComplexArray, lines: Sequence[OrderLine], blocks: Sequence[EngineBlock]) -> FloatArray:
    """Period in rad of the reference shaft after which an angle between engines repeats, shape (n_speeds, n_out).

    It is the largest angle of which the periods of both are multiples; orders of negligible amplitude are ignored.
    """
    moving = [[at for at in block.places if lines[at].relative] for block in blocks]
    whole = greatest_common_divisor(lines[at].relative for places in moving for at in places)
    # A shift by the own period of either engine changes nothing: the angle repeats with the lcm of their symmetries.
    repeats = np.ones((len(values), values.shape[2]), dtype=np.int64)
    for places in moving:
        counts = np.array([int(lines[at].relative / whole) for at in places])
        sizes = np.abs(values[:, places])
        acts = sizes > NEGLIGIBLE_AMPLITUDE * sizes.max(axis=1, keepdims=True)
        repeats = np.lcm(repeats, np.gcd.reduce(np.where(acts, counts[:, None], 0), axis=1).clip(min=1))
    return np.asarray(2 * np.pi / float(whole) / repeats)


def _ratio(lines: Sequence[OrderLine], block: EngineBlock) -> float:
    """Revolutions of an engine per revolution of the reference shaft."""
    return next(float(lines[at].ratio) for at in block.places if lines[at].engine == block.engine)


def with_engines_delayed(
    values: ComplexArray, lines: Sequence[OrderLine], angles: Sequence[EngineAngle], sense: float = 1.0
) -> ComplexArray:
    """Order amplitudes (n_speeds, n_lines, n_out), SI, engines delayed by angles (rad) or advanced (``sense=-1``)."""
    delayed = values.copy()
    known = {angle.engine: angle.angle for angle in angles}
    for block in engine_blocks(lines):
        if block.engine in known:
            rates = np.array([float(lines[at].relative) for at in block.places]) / _ratio(lines, block)
            # T(phi - alpha): a delay by the crank angle alpha turns order h of the engine by -h alpha.
            delayed[:, block.places] *= np.exp(-1j * sense * rates[:, None] * known[block.engine][:, None, :])
    return delayed


def engines_as_one(lines: Sequence[OrderLine]) -> tuple[OrderLine, ...]:
    """Order lines in which all engines of one speed have the name of the first, as their angles are decided."""
    first = {block.engine: blocks[0].engine for blocks in blocks_by_speed(lines) for block in blocks}
    return tuple(replace(line, engine=first[line.engine]) if line.engine else line for line in lines)

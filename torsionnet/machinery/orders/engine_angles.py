"""Order amplitudes with engines on unconnected crankshafts at angles of largest or smallest half range of their sum."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.engine_blocks import (
    BlockGrid,
    EngineBlock,
    blocks_by_speed,
    engine_blocks,
    greatest_common_divisor,
)
from torsionnet.machinery.orders.order_line import OrderLine
from torsionnet.machinery.orders.worst_angle import Shares, worst_angles

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
        angles, periods = ([getattr(one, name) for one in (self, *others)] for name in ("angle", "period"))
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
            found = worst_angles(
                values[part], lines, grid, [(shares[at][0], shares[at][1][:, part]) for at in searched]
            )
            for at, own in zip(searched, found.signs, strict=True):
                signs[at][part] = own
            for block, delay in zip(blocks[1:], found.delays[1:], strict=True):
                delays.setdefault(block, np.zeros((len(values), values.shape[2])))[part] = delay
    together = values.copy()
    for (own_lines, contributions), own in zip(shares, signs, strict=True):
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
            delay[np.isclose(delay, period, rtol=EQUAL_ANGLE, atol=EQUAL_ANGLE)] = 0.0
            ratio = _ratio(lines, block)
            angles.append(EngineAngle(block.engine, blocks[0].engine, delay * ratio, period * ratio))
    return AmplitudesAtAngles(with_engines_delayed(values, lines, angles), engines_as_one(lines), tuple(angles), signs)


def _period(values: ComplexArray, lines: Sequence[OrderLine], blocks: Sequence[EngineBlock]) -> FloatArray:
    """Period in rad of the reference shaft after which an angle between engines repeats, shape (n_speeds, n_out).

    It is the largest angle of which the periods of both are multiples; orders of negligible amplitude are ignored.
    """
    moving = [[at for at in block.places if lines[at].relative] for block in blocks]
    whole = greatest_common_divisor(lines[at].relative for places in moving for at in places)
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
    found = values.copy()
    known = {one.engine: one.angle for one in angles}
    for block in engine_blocks(lines):
        if block.engine in known:
            rates = np.array([float(lines[at].relative) for at in block.places]) / _ratio(lines, block)
            found[:, block.places] *= np.exp(-1j * sense * rates[:, None] * known[block.engine][:, None, :])
    return found


def engines_as_one(lines: Sequence[OrderLine]) -> tuple[OrderLine, ...]:
    """Order lines in which all engines of one speed have the name of the first, as their angles are decided."""
    first = {block.engine: blocks[0].engine for blocks in blocks_by_speed(lines) for block in blocks}
    return tuple(replace(line, engine=first[line.engine]) if line.engine else line for line in lines)

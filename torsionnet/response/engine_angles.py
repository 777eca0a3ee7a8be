"""Amplitudes with engines that are not fixed to each other at the angle that makes the most, or the least, of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.engine_blocks import BlockGrid, EngineBlock, common_factor, engine_blocks, equally_fast
from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.order_line import OrderLine
from torsionnet.response.worst_angle import Shares, worst_angles

TOGETHER = 50
"""Speeds that are searched together, which bounds the memory."""
FLAT = 1e-5
"""rad, or share of a period: a largest or smallest value does not say where it is more closely."""
NOTHING = 1e-6
"""Share of the largest amplitude of an engine below which an order makes no difference between angles."""


@dataclass(frozen=True, eq=False)
class EngineAngle:
    """How much later an engine fires than another one.

    Attributes
    ----------
    engine, after : str
    angle : (n_speeds, n_out) array
        rad of the engine's crankshaft, from 0 to less than ``period``.
    period : (n_speeds, n_out) array
        rad of the engine's crankshaft after which the sum of both is the same: its cycle or, as of equal cylinders on
        one throw, a part of it.
    """

    engine: str
    after: str
    angle: FloatArray
    period: FloatArray

    @property
    def degrees(self) -> FloatArray:
        """The angle in degrees."""
        return np.degrees(self.angle)

    def at(self, speed: int, output: int) -> str:
        """In words, at places among the speeds and outputs."""
        period = round(math.degrees(self.period[speed, output]), 1)
        degrees = round(float(self.degrees[speed, output]), 1) % period
        return f"{self.engine} fires {degrees:g} deg after {self.after}"

    def part(self, speeds: Sequence[int], outputs: Sequence[int]) -> EngineAngle:
        """At some speeds, of some outputs."""
        angle, period = (of[list(speeds)][:, list(outputs)] for of in (self.angle, self.period))
        return replace(self, angle=angle, period=period)

    def joined(self, others: Sequence[EngineAngle], order: NDArray[np.intp]) -> EngineAngle:
        """With those at other speeds."""
        angles, periods = ([getattr(one, name) for one in (self, *others)] for name in ("angle", "period"))
        return replace(self, angle=np.concatenate(angles)[order], period=np.concatenate(periods)[order])


@dataclass(frozen=True, eq=False)
class Settled:
    """Amplitudes at an angle by speed and output.

    Attributes
    ----------
    values : (n_speeds, n_lines, n_out) complex array
    lines : tuple of OrderLine
        The same ones; engines of one speed are one engine now.
    angles : tuple of EngineAngle
    signs : tuple of (n_speeds, n_out, n_shares) arrays of int
        By shares.
    """

    values: ComplexArray
    lines: tuple[OrderLine, ...]
    angles: tuple[EngineAngle, ...]
    signs: tuple[NDArray[np.int8], ...]


def settled(values: ComplexArray, lines: Sequence[OrderLine], shares: Shares = ()) -> Settled:
    """At every speed the angles, and the signs of what is up or down, with which an output swings most."""
    signs = [np.ones((len(values), values.shape[2], len(own)), dtype=np.int8) for _, own in shares]
    delays: dict[EngineBlock, FloatArray] = {}
    for blocks in equally_fast(lines):
        grid = BlockGrid.of(lines, blocks)
        searched = [at for at, (own, _) in enumerate(shares) if any(own.start in places for places in grid.places)]
        if len(blocks) == 1 and not searched:
            continue
        for start in range(0, len(values), TOGETHER):
            part = slice(start, start + TOGETHER)
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
    return standing(together, lines, delays, tuple(signs))


def standing(
    values: ComplexArray,
    lines: Sequence[OrderLine],
    delays: Mapping[EngineBlock, FloatArray],
    signs: tuple[NDArray[np.int8], ...] = (),
) -> Settled:
    """Amplitudes with engines later by angles (n_speeds, n_out) in rad of the reference shaft."""
    angles = []
    for blocks in equally_fast(lines):
        for block in blocks[1:]:
            period = _period(values, lines, [blocks[0], block] if len(blocks) == 2 else [block])
            delay = delays[block] % period
            delay[np.isclose(delay, period, rtol=FLAT, atol=FLAT)] = 0.0
            ratio = _ratio(lines, block)
            angles.append(EngineAngle(block.engine, blocks[0].engine, delay * ratio, period * ratio))
    return Settled(turned(values, lines, angles), as_one(lines), tuple(angles), signs)


def _period(values: ComplexArray, lines: Sequence[OrderLine], blocks: Sequence[EngineBlock]) -> FloatArray:
    """Rad of the reference shaft (n_speeds, n_out) after which the sum of one engine and another is the same again.

    That is the largest angle of which the periods of both are multiples; orders that do next to nothing do not count.
    """
    moving = [[at for at in block.places if lines[at].relative] for block in blocks]
    whole = common_factor(lines[at].relative for places in moving for at in places)
    repeats = np.ones((len(values), values.shape[2]), dtype=np.int64)
    for places in moving:
        counts = np.array([int(lines[at].relative / whole) for at in places])
        sizes = np.abs(values[:, places])
        acts = sizes > NOTHING * sizes.max(axis=1, keepdims=True)
        repeats = np.lcm(repeats, np.gcd.reduce(np.where(acts, counts[:, None], 0), axis=1).clip(min=1))
    return np.asarray(2 * np.pi / float(whole) / repeats)


def _ratio(lines: Sequence[OrderLine], block: EngineBlock) -> float:
    """Revolutions of an engine for one of the reference shaft."""
    return next(float(lines[at].ratio) for at in block.places if lines[at].engine == block.engine)


def turned(
    values: ComplexArray, lines: Sequence[OrderLine], angles: Sequence[EngineAngle], sense: float = 1.0
) -> ComplexArray:
    """Amplitudes with some engines later by angles, or with ``sense=-1`` earlier."""
    found = values.copy()
    known = {one.engine: one.angle for one in angles}
    for block in engine_blocks(lines):
        if block.engine in known:
            rates = np.array([float(lines[at].relative) for at in block.places]) / _ratio(lines, block)
            found[:, block.places] *= np.exp(-1j * sense * rates[:, None] * known[block.engine][:, None, :])
    return found


def as_one(lines: Sequence[OrderLine]) -> tuple[OrderLine, ...]:
    """The lines with engines of one speed as one engine."""
    first = {block.engine: blocks[0].engine for blocks in equally_fast(lines) for block in blocks}
    return tuple(replace(line, engine=first[line.engine]) if line.engine else line for line in lines)

"""The angle between engines that are not fixed to each other with which a sum of orders swings least."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from torsionnet.response.engine_angles import Settled, as_one, standing
from torsionnet.response.engine_blocks import BlockGrid, EngineBlock, equally_fast
from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.order_response import OrderResponse
from torsionnet.response.synthesis import extremes
from torsionnet.response.worst_angle import LIKE, highest_maxima

CANDIDATES = {2: 3, 3: 1}
"""Smallest minima on the grid that are followed, of two engines and of more."""
SWEEPS, STARTS = 2, 5
"""Over more than two engines, and places they begin from."""
ROUNDS, FINER = 4, 4
"""Of ever finer steps, and how much finer each is."""


def at_least(case: OrderResponse) -> Settled:
    """The amplitudes of one case at the angles with the smallest half range by speed and output.

    Of two engines it is the smallest of all angles; of more of them the smallest found.
    """
    delays: dict[EngineBlock, FloatArray] = {}
    for blocks in equally_fast(case.lines):
        if len(blocks) == 2:
            delays |= _swept(case, blocks, {}, 1)
        elif len(blocks) > 2:
            delays |= _from_several(case, blocks)
    return standing(case.values, case.lines, delays)


Delays: TypeAlias = dict[EngineBlock, FloatArray]


def _from_several(case: OrderResponse, blocks: Sequence[EngineBlock]) -> Delays:
    """The best delays that sweeps over the engines come to from several places."""
    turn = 2 * np.pi * float(BlockGrid.of(case.lines, blocks).cycle)
    found = []
    for number in range(STARTS):
        start = {
            block: np.full((len(case.speeds), len(case.outputs)), turn * ((number * place / STARTS + place / 3) % 1))
            for place, block in enumerate(blocks[1:], 1)
        }
        found.append(_swept(case, blocks, start, SWEEPS))
    best = np.argmin([_half_range(case, one) for one in found], axis=0)
    return {block: np.choose(best, [one[block] for one in found]) for block in blocks[1:]}


def _swept(case: OrderResponse, blocks: Sequence[EngineBlock], start: Delays, sweeps: int) -> Delays:
    """Each engine in turn where the sum is least while the others stay."""
    delays, grid = {**start}, BlockGrid.of(case.lines, blocks)
    still = np.zeros((len(case.speeds), len(case.outputs)))
    for _ in range(sweeps):
        for number, block in enumerate(blocks[1:], 1):
            delays[block] = _least(case, {block: still, **delays}, block, grid, number)
    return delays


def _half_range(case: OrderResponse, delays: Mapping[EngineBlock, FloatArray]) -> FloatArray:
    return replace(case, values=_later(case, delays), lines=as_one(case.lines)).half_range


def _least(
    case: OrderResponse, delays: Mapping[EngineBlock, FloatArray], block: EngineBlock, grid: BlockGrid, number: int
) -> FloatArray:
    """The delay of one block at which the half range is least while the others stay."""
    step = 2 * np.pi * float(grid.cycle) / grid.points
    values = _later(case, {**delays, block: np.zeros_like(delays[block])})
    waves = [_wave(case, values, places, np.asarray(step * np.arange(grid.points))) for places in grid.places]
    others = np.sum([wave for at, wave in enumerate(waves) if at != number], axis=0)
    moved = (others + np.roll(waves[number], steps, axis=2) for steps in range(grid.periods[number]))
    ranges = np.stack([np.subtract(*extremes(wave)) for wave in moved], axis=2)
    best, size = delays[block], np.full(delays[block].shape, np.inf)
    for steps in highest_maxima(ranges.max(axis=2, keepdims=True) - ranges)[: CANDIDATES[min(len(waves), 3)]]:
        found, own = _refined(case, delays, block, np.asarray(step * steps), step)
        best, size = np.where(own < size * (1 - LIKE), found, best), np.minimum(size, own)
    return best


def _later(case: OrderResponse, delays: Mapping[EngineBlock, FloatArray]) -> ComplexArray:
    """Amplitudes with blocks later by angles (n_speeds, n_out) of the reference shaft."""
    found = case.values.copy()
    for block, delay in delays.items():
        rates = np.array([float(case.lines[at].relative) for at in block.places])
        found[:, block.places] *= np.exp(-1j * rates[:, None] * delay[:, None, :])
    return found


def _wave(case: OrderResponse, values: ComplexArray, places: Sequence[int], angles: FloatArray) -> FloatArray:
    """Sum of some lines (n_speeds, n_out, n) at angles of the reference shaft."""
    rates = np.array([float(case.lines[at].relative) for at in places])
    return np.asarray(np.einsum("slo,lm->som", values[:, list(places)], np.exp(1j * np.outer(rates, angles))).real)


def _refined(
    case: OrderResponse, delays: Mapping[EngineBlock, FloatArray], block: EngineBlock, start: FloatArray, step: float
) -> tuple[FloatArray, FloatArray]:
    """The best delay near one and the half range there, summed finely."""
    best, size = start, np.full(start.shape, np.inf)
    for _ in range(ROUNDS):
        for place in range(-FINER, FINER + 1):
            one = start + step * place / FINER
            own = _half_range(case, {**delays, block: one})
            best, size = np.where(own < size * (1 - LIKE), one, best), np.minimum(size, own)
        start, step = best, step / FINER
    return best, size

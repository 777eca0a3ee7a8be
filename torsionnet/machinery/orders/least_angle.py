"""Search of the angles between engines of unknown phase that give the smallest half range of the sum of orders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.engine_angles import AmplitudesAtAngles, at_engine_angles, engines_as_one
from torsionnet.machinery.orders.engine_blocks import BlockGrid, EngineBlock, blocks_by_speed
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.synthesis import extremes
from torsionnet.machinery.orders.worst_angle import EQUAL_SHARE, highest_maxima

REFINED_MINIMA = {2: 3, 3: 1}
"""Number of smallest minima of the half range on the grid of engine angles that are refined, by number of engines, 3
for three or more."""
ENGINE_SWEEPS, START_POSITIONS = 2, 5
"""Number of sweeps in which more than two engines are moved in turn, and number of positions from which sweeps start;
more find the smallest minimum more surely."""
STEP_REFINEMENTS, STEP_DIVISOR = 4, 4
"""Number of refinements of the engine angle step, and the factor by which each divides the step."""


def at_least_range_angles(case: OrderResponse) -> AmplitudesAtAngles:
    """Order amplitudes (SI) of one firing condition at engine angles that give their sum the smallest half range.

    For two engines it is the global minimum; for more the smallest that the search finds.
    """
    delays: dict[EngineBlock, FloatArray] = {}
    for blocks in blocks_by_speed(case.lines):
        if len(blocks) == 2:
            delays |= _swept(case, blocks, {}, 1)
        elif len(blocks) > 2:
            delays |= _from_several(case, blocks)
    return at_engine_angles(case.values, case.lines, delays)


Delays: TypeAlias = dict[EngineBlock, FloatArray]
"""Mapping of engine block to its delay in rad of the reference shaft, shape (n_speeds, n_out)."""


def _from_several(case: OrderResponse, blocks: Sequence[EngineBlock]) -> Delays:
    """Delays in rad by engine with the smallest half range of the sum of orders, of sweeps from several positions."""
    turn = 2 * np.pi * float(BlockGrid.of(case.lines, blocks).cycle)
    found = []
    for number in range(START_POSITIONS):
        start = {
            block: np.full(
                (len(case.speeds), len(case.outputs)), turn * ((number * place / START_POSITIONS + place / 3) % 1)
            )
            for place, block in enumerate(blocks[1:], 1)
        }
        found.append(_swept(case, blocks, start, ENGINE_SWEEPS))
    best = np.argmin([_half_range(case, one) for one in found], axis=0)
    return {block: np.choose(best, [one[block] for one in found]) for block in blocks[1:]}


def _swept(case: OrderResponse, blocks: Sequence[EngineBlock], start: Delays, sweeps: int) -> Delays:
    """Delays in rad by engine after sweeps that give each in turn the smallest half range of the sum of orders."""
    delays, grid = {**start}, BlockGrid.of(case.lines, blocks)
    still = np.zeros((len(case.speeds), len(case.outputs)))
    for _ in range(sweeps):
        for number, block in enumerate(blocks[1:], 1):
            delays[block] = _least(case, {block: still, **delays}, block, grid, number)
    return delays


def _half_range(case: OrderResponse, delays: Mapping[EngineBlock, FloatArray]) -> FloatArray:
    return replace(case, values=_later(case, delays), lines=engines_as_one(case.lines)).half_range


def _least(
    case: OrderResponse, delays: Mapping[EngineBlock, FloatArray], block: EngineBlock, grid: BlockGrid, number: int
) -> FloatArray:
    """Delay (n_speeds, n_out) in rad of one engine, others fixed, with the smallest half range of the sum of orders."""
    step = 2 * np.pi * float(grid.cycle) / grid.points
    values = _later(case, {**delays, block: np.zeros_like(delays[block])})
    waves = [_wave(case, values, places, np.asarray(step * np.arange(grid.points))) for places in grid.places]
    others = np.sum([wave for at, wave in enumerate(waves) if at != number], axis=0)
    moved = (others + np.roll(waves[number], steps, axis=2) for steps in range(grid.periods[number]))
    ranges = np.stack([np.subtract(*extremes(wave)) for wave in moved], axis=2)
    best, size = delays[block], np.full(delays[block].shape, np.inf)
    for steps in highest_maxima(ranges.max(axis=2, keepdims=True) - ranges)[: REFINED_MINIMA[min(len(waves), 3)]]:
        found, own = _refined(case, delays, block, np.asarray(step * steps), step)
        best, size = np.where(own < size * (1 - EQUAL_SHARE), found, best), np.minimum(size, own)
    return best


def _later(case: OrderResponse, delays: Mapping[EngineBlock, FloatArray]) -> ComplexArray:
    """Order amplitudes (n_speeds, n_lines, n_out) in SI with engines delayed by angles of the reference shaft (rad)."""
    found = case.values.copy()
    for block, delay in delays.items():
        rates = np.array([float(case.lines[at].relative) for at in block.places])
        found[:, block.places] *= np.exp(-1j * rates[:, None] * delay[:, None, :])
    return found


def _wave(case: OrderResponse, values: ComplexArray, places: Sequence[int], angles: FloatArray) -> FloatArray:
    """Sum of some order lines at angles (n,) in rad of the reference shaft, in SI units, shape (n_speeds, n_out, n)."""
    rates = np.array([float(case.lines[at].relative) for at in places])
    return np.asarray(np.einsum("slo,lm->som", values[:, list(places)], np.exp(1j * np.outer(rates, angles))).real)


def _refined(
    case: OrderResponse, delays: Mapping[EngineBlock, FloatArray], block: EngineBlock, start: FloatArray, step: float
) -> tuple[FloatArray, FloatArray]:
    """Delay (rad) near a start, and with it the least half range of the sum of orders (SI), both (n_speeds, n_out)."""
    best, size = start, np.full(start.shape, np.inf)
    for _ in range(STEP_REFINEMENTS):
        for place in range(-STEP_DIVISOR, STEP_DIVISOR + 1):
            one = start + step * place / STEP_DIVISOR
            own = _half_range(case, {**delays, block: one})
            best, size = np.where(own < size * (1 - EQUAL_SHARE), one, best), np.minimum(size, own)
        start, step = best, step / STEP_DIVISOR
    return best, size

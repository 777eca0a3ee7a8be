"""Order response of several cases (firing conditions), for every speed and output that of the worst case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.phrases import joined
from torsionnet.base.table import Column, Table
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.engine_angles import (
    EQUAL_SHARE,
    AmplitudesAtAngles,
    EngineAngle,
    at_engine_angles,
    engines_as_one,
    highest_maxima,
    with_engines_delayed,
)
from torsionnet.machinery.orders.order_line import BlockGrid, EngineBlock, blocks_by_speed
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.synthesis import extremes

# Search of the angles between engines of unknown phase that give the smallest half range of the sum of orders.

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
    minima = []
    for number in range(START_POSITIONS):
        # Starts spread over the cycle, shifted by a third from engine to engine so that they do not all begin in
        # step.
        start = {
            block: np.full(
                (len(case.speeds), len(case.outputs)), turn * ((number * place / START_POSITIONS + place / 3) % 1)
            )
            for place, block in enumerate(blocks[1:], 1)
        }
        minima.append(_swept(case, blocks, start, ENGINE_SWEEPS))
    best = np.argmin([_half_range(case, delays) for delays in minima], axis=0)
    return {block: np.choose(best, [delays[block] for delays in minima]) for block in blocks[1:]}


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
    # Range (max - min) of the others and this engine moved by every number of steps of its own period.
    ranges = np.stack([np.subtract(*extremes(wave)) for wave in moved], axis=2)
    best, size = delays[block], np.full(delays[block].shape, np.inf)
    for steps in highest_maxima(ranges.max(axis=2, keepdims=True) - ranges)[: REFINED_MINIMA[min(len(waves), 3)]]:
        delay, own = _refined(case, delays, block, np.asarray(step * steps), step)
        best, size = np.where(own < size * (1 - EQUAL_SHARE), delay, best), np.minimum(size, own)
    return best


def _later(case: OrderResponse, delays: Mapping[EngineBlock, FloatArray]) -> ComplexArray:
    """Order amplitudes (n_speeds, n_lines, n_out) in SI with engines delayed by angles of the reference shaft (rad)."""
    delayed = case.values.copy()
    for block, delay in delays.items():
        rates = np.array([float(case.lines[at].relative) for at in block.places])
        # T(phi - delta): a delay by delta of the reference shaft turns a line of relative order r by -r delta.
        delayed[:, block.places] *= np.exp(-1j * rates[:, None] * delay[:, None, :])
    return delayed


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
            delay = start + step * place / STEP_DIVISOR
            own = _half_range(case, {**delays, block: delay})
            best, size = np.where(own < size * (1 - EQUAL_SHARE), delay, best), np.minimum(size, own)
        start, step = best, step / STEP_DIVISOR
    return best, size


ALL_CASES_EQUAL = "all cases alike"
"""Text in place of the worst case's name where all cases have the same half range."""
EQUAL_HALF_RANGE = 1e-9
"""Relative difference up to which half ranges of cases are equal."""
EQUAL_SEARCHED_HALF_RANGE = 1e-5
"""Relative difference up to which half ranges of cases are equal if angles between engines were searched."""


@dataclass(frozen=True, eq=False, repr=False)
class WorstResponse(OrderResponse):
    """Order response (SI) of several cases, for each output and speed the amplitudes of the case of largest half range.

    Attributes
    ----------
    labels : tuple of str
        Names of the cases, such as ``misfire of cylinder 4``.
    chosen : (n_speeds, n_out) array of int
        Index of the case that the amplitudes are of.
    alternatives : mapping
        By label, response of that case without scatter; a single case has no label.
    each : tuple of OrderResponse
        Response of each case with its worst combination of scattered values, by output and speed.
    scattered : tuple of str
        Values that scatter about their rated value, up or down.
    signs : (n_speeds, n_out, n_scattered) array of int
        1 where a value is up in the worst combination, -1 where it is down.
    largest : (n_speeds, n_lines, n_out) array
        Largest amplitude of each order in any case and combination, not only in the one chosen.
    angles : tuple of EngineAngle
        Angles of engines of unknown phase after the first one; the amplitudes are those at these angles.
    """

    labels: tuple[str, ...] = ()
    chosen: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 0), dtype=np.int64))
    alternatives: Mapping[str, OrderResponse] = field(default_factory=dict)
    each: tuple[OrderResponse, ...] = ()
    scattered: tuple[str, ...] = ()
    signs: NDArray[np.int8] = field(default_factory=lambda: np.zeros((0, 0, 0), dtype=np.int8))
    largest: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    angles: tuple[EngineAngle, ...] = ()

    @property
    def sizes(self) -> FloatArray:
        return self.largest

    @property
    def case_responses(self) -> tuple[OrderResponse, ...]:
        return tuple(self.alternatives.values())

    @property
    def case_values(self) -> tuple[ComplexArray, ...]:
        return tuple(case.values for case in self.each)

    @cached_property
    def least(self) -> WorstResponse:
        """Order response of the same cases with engines at the angles of smallest half range, by output and speed.

        This response itself if all angles between engines are known, or there is one engine.
        """
        if not self.angles:
            return self
        lines = next(iter(self.alternatives.values())).lines
        values = with_engines_delayed(self.values, lines, self.angles, sense=-1)
        least = at_least_range_angles(
            OrderResponse(self.speeds, self.reference, lines, values, self.outputs, self.title)
        )
        return replace(self, values=least.values, angles=least.angles)

    def least_at(self, speed: int, output: str | None = None) -> WorstResponse:
        """Order response at the engine angles of smallest half range, for one output and a speed given by its index."""
        at, out = [speed], [self.output(output)]
        single = replace(
            self,
            speeds=self.speeds[at],
            values=self.values[at][:, :, out],
            outputs=tuple(self.outputs[place] for place in out),
            chosen=self.chosen[at][:, out],
            signs=self.signs[at][:, out],
            largest=self.largest[at][:, :, out],
            angles=tuple(angle.part(at, out) for angle in self.angles),
        )
        return single.least

    @property
    def engine_notes(self) -> tuple[str, ...]:
        pairs = " and ".join(f"{angle.engine} and {angle.after}" for angle in self.angles)
        text = f"no phase is given between {pairs}: for every output and speed the worst angle counts"
        return (*((text,) if pairs else ()), *super().engine_notes)

    def angle_range(self, speed: int, output: str | None = None) -> str:
        """Sentence on the engine angles with the largest and the smallest half range, at a speed given by its index."""
        place = self.output(output)
        words = ", ".join(angle.at(speed, place) for angle in self.angles)
        least = self.least_at(speed, output)
        fewest = ", ".join(angle.at(0, 0) for angle in least.angles)
        share = least.half_range[0, 0] / (self.half_range[speed, place] or 1.0)
        return f"largest where {words}; smallest, {share:.3g} of that, where {fewest}"

    def cases(self, output: str | None = None) -> tuple[str, ...]:
        """Names of the cases (firing conditions) with the largest half range of an output, one for each speed."""
        place = self.output(output)
        sizes = self._sizes(slice(None), place)
        return tuple(self._case(at, place, sizes[:, at]) for at in range(len(self.speeds)))

    def case_at(self, speed: int, output: str | None = None) -> str:
        """Name of the case (firing condition) with the largest half range of an output, at a speed by its index."""
        place, at = self.output(output), range(len(self.speeds))[speed]
        return self._case(at, place, self._sizes(slice(at, at + 1), place)[:, 0])

    def _sizes(self, speeds: slice, place: int) -> FloatArray:
        """Half ranges (n_cases, n_speeds) in SI of one output in every case without scatter, at some speeds alone."""
        cases = [] if self.scattered else list(self.alternatives.values())
        part = slice(place, place + 1)
        single = (
            replace(case, speeds=case.speeds[speeds], values=case.values[speeds, :, part], outputs=case.outputs[part])
            for case in cases
        )
        return np.array([run.half_range[:, 0] for run in single]).reshape(len(cases), len(self.speeds[speeds]))

    def _case(self, at: int, place: int, sizes: FloatArray) -> str:
        parts = [self._alike(at, place, sizes)] if self.labels else []
        if self.scattered:
            high = [name for name, sign in zip(self.scattered, self.signs[at, place], strict=True) if sign > 0]
            parts.append(f"{', '.join(high)} up, the others down" if high else "all down")
        parts += [angle.at(at, place) for angle in self.angles]
        return joined("; ", parts)

    def _alike(self, at: int, place: int, sizes: FloatArray) -> str:
        """Names of the cases with the largest half range within rounding as a text, ALL_CASES_EQUAL if all have it."""
        chosen = int(self.chosen[at, place])
        if self.scattered:
            return self.labels[chosen]
        rounding = EQUAL_SEARCHED_HALF_RANGE if self.angles else EQUAL_HALF_RANGE
        pairs = zip(self.labels, sizes.tolist(), strict=True)
        same = [label for label, size in pairs if size >= (1 - rounding) * sizes[chosen]]
        return ALL_CASES_EQUAL if 1 < len(same) == len(self.labels) else joined(" or ", same)

    def table(self, output: str | None = None, conventions: Conventions = SI, most: int = 6) -> Table:
        """Table of an output's largest half range and orders, with their speeds in rpm, and the worst case in notes."""
        table = super().table(output, conventions, most)
        worst = int(np.argmax(self.half_range[:, self.output(output)]))
        count = f" of {len(self.labels)} cases" if self.labels else ""
        note = f"at every speed the worst{count}; at {self.rpm[worst]:.6g} rpm: {self.case_at(worst, output)}"
        angles = [f"at {self.rpm[worst]:.6g} rpm {self.angle_range(worst, output)}"] if self.angles else []
        return replace(table, notes=(*table.notes, note, *self.engine_notes, *angles))

    def long_table(self) -> Table:
        """Table of all order amplitudes in SI, a row per speed in rpm and order line, with each output's worst case."""
        table = super().long_table()
        names = [channel.name for channel in self.outputs]
        by_output = [self.cases(name) for name in names]
        each = len(table.rows) // len(self.speeds)
        rows = tuple((*row, *(cases[number // each] for cases in by_output)) for number, row in enumerate(table.rows))
        columns = (*table.columns, *(Column(f"{name} case") for name in names))
        return replace(table, columns=columns, rows=rows)


def join_responses(
    parts: Sequence[tuple[OrderResponse, NDArray[np.intp]]], speeds: FloatArray, title: str
) -> OrderResponse:
    """Order response at all speeds in rad/s, joined from responses at some of the speeds, given with their indices."""
    # Parts come by their indices among all speeds: sorting these puts values in place.
    order = np.argsort(np.concatenate([places for _, places in parts]))
    responses = [part for part, _ in parts]
    whole = replace(
        responses[0], speeds=speeds, values=np.concatenate([part.values for part in responses])[order], title=title
    )
    worst = [part for part in responses if isinstance(part, WorstResponse)]
    if not isinstance(whole, WorstResponse):
        return _bounded(whole, responses, order)
    places = [those for _, those in parts]
    complete = replace(
        whole,
        chosen=np.concatenate([part.chosen for part in worst])[order],
        alternatives={
            label: join_responses(
                [(part.alternatives[label], those) for part, those in zip(worst, places, strict=True)], speeds, title
            )
            for label in whole.alternatives
        },
        each=tuple(
            join_responses(
                [(part.each[number], those) for part, those in zip(worst, places, strict=True)], speeds, title
            )
            for number in range(len(whole.each))
        ),
        signs=np.concatenate([part.signs for part in worst])[order],
        largest=np.concatenate([part.largest for part in worst])[order],
        angles=tuple(
            first.joined(others, order) for first, *others in zip(*(part.angles for part in worst), strict=True)
        ),
    )
    return _bounded(complete, responses, order)


def _bounded(whole: OrderResponse, parts: Sequence[OrderResponse], order: NDArray[np.intp]) -> OrderResponse:
    """Order response with the largest and smallest sums over a cycle that its parts have cached, if all parts have."""
    known = [vars(part)["bounds"] for part in parts if "bounds" in vars(part)]
    if len(known) == len(parts):
        vars(whole)["bounds"] = np.concatenate(known, axis=1)[:, order]
    return whole

"""Order response of several cases (firing conditions), for every speed and output that of the worst case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.table import Column, Table
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.engine_angles import EngineAngle, with_engines_delayed
from torsionnet.machinery.orders.least_angle import at_least_range_angles
from torsionnet.machinery.orders.order_response import OrderResponse

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
        found = at_least_range_angles(
            OrderResponse(self.speeds, self.reference, lines, values, self.outputs, self.title)
        )
        return replace(self, values=found.values, angles=found.angles)

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
            angles=tuple(one.part(at, out) for one in self.angles),
        )
        return single.least

    @property
    def engine_notes(self) -> tuple[str, ...]:
        pairs = " and ".join(f"{one.engine} and {one.after}" for one in self.angles)
        text = f"no phase is given between {pairs}: for every output and speed the worst angle counts"
        return (*((text,) if pairs else ()), *super().engine_notes)

    def angle_range(self, speed: int, output: str | None = None) -> str:
        """Sentence on the engine angles with the largest and the smallest half range, at a speed given by its index."""
        place = self.output(output)
        words = ", ".join(one.at(speed, place) for one in self.angles)
        least = self.least_at(speed, output)
        fewest = ", ".join(one.at(0, 0) for one in least.angles)
        share = least.half_range[0, 0] / (self.half_range[speed, place] or 1.0)
        return f"largest where {words}; smallest, {share:.3g} of that, where {fewest}"

    def cases(self, output: str | None = None) -> tuple[str, ...]:
        """Names of the cases (firing conditions) with the largest half range of an output, one for each speed."""
        place = self.output(output)
        return tuple(self._case(at, place) for at in range(len(self.speeds)))

    def case_at(self, speed: int, output: str | None = None) -> str:
        """Name of the case (firing condition) with the largest half range of an output, at a speed by its index."""
        return self._case(speed, self.output(output))

    def _case(self, at: int, place: int) -> str:
        parts = [self._alike(at, place)] if self.labels else []
        if self.scattered:
            high = [name for name, sign in zip(self.scattered, self.signs[at, place], strict=True) if sign > 0]
            parts.append(f"{', '.join(high)} up, the others down" if high else "all down")
        parts += [one.at(at, place) for one in self.angles]
        return "; ".join(parts)

    def _alike(self, at: int, place: int) -> str:
        """Names of the cases with the largest half range within rounding as a text, ALL_CASES_EQUAL if all have it."""
        chosen = self.labels[int(self.chosen[at, place])]
        if self.scattered:
            return chosen
        sizes = {label: float(one.half_range[at, place]) for label, one in self.alternatives.items()}
        rounding = EQUAL_SEARCHED_HALF_RANGE if self.angles else EQUAL_HALF_RANGE
        same = [label for label in self.labels if sizes[label] >= (1 - rounding) * sizes[chosen]]
        return ALL_CASES_EQUAL if 1 < len(same) == len(self.labels) else " or ".join(same)

    def table(self, output: str | None = None, conventions: Conventions = SI, most: int = 6) -> Table:
        """Table of an output's largest half range and orders, with their speeds in rpm, and the worst case in notes."""
        found = super().table(output, conventions, most)
        worst = int(np.argmax(self.half_range[:, self.output(output)]))
        count = f" of {len(self.labels)} cases" if self.labels else ""
        note = f"at every speed the worst{count}; at {self.rpm[worst]:.6g} rpm: {self.case_at(worst, output)}"
        angles = [f"at {self.rpm[worst]:.6g} rpm {self.angle_range(worst, output)}"] if self.angles else []
        return replace(found, notes=(*found.notes, note, *self.engine_notes, *angles))

    def long_table(self) -> Table:
        """Table of all order amplitudes in SI, a row per speed in rpm and order line, with each output's worst case."""
        found = super().long_table()
        names = [channel.name for channel in self.outputs]
        by_output = [self.cases(name) for name in names]
        each = len(found.rows) // len(self.speeds)
        rows = tuple((*row, *(cases[number // each] for cases in by_output)) for number, row in enumerate(found.rows))
        columns = (*found.columns, *(Column(f"{name} case") for name in names))
        return replace(found, columns=columns, rows=rows)


def join_responses(
    parts: Sequence[tuple[OrderResponse, NDArray[np.intp]]], speeds: FloatArray, title: str
) -> OrderResponse:
    """Order response at all speeds in rad/s, joined from responses at some of the speeds, given with their indices."""
    order = np.argsort(np.concatenate([places for _, places in parts]))
    found = [part for part, _ in parts]
    whole = replace(found[0], speeds=speeds, values=np.concatenate([part.values for part in found])[order], title=title)
    worst = [part for part in found if isinstance(part, WorstResponse)]
    if not isinstance(whole, WorstResponse):
        return _bounded(whole, found, order)
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
    return _bounded(complete, found, order)


def _bounded(whole: OrderResponse, parts: Sequence[OrderResponse], order: NDArray[np.intp]) -> OrderResponse:
    """Order response with the largest and smallest sums over a cycle that its parts have cached, if all parts have."""
    known = [vars(part)["bounds"] for part in parts if "bounds" in vars(part)]
    if len(known) == len(parts):
        vars(whole)["bounds"] = np.concatenate(known, axis=1)[:, order]
    return whole

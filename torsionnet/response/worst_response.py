"""An order response of which several cases were calculated: each output has that of its worst at every speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.engine_angles import EngineAngle, turned
from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.least_angle import at_least
from torsionnet.response.order_response import OrderResponse
from torsionnet.response.table import Column, Table

ALIKE = "all cases alike"
ROUNDING = 1e-9
"""Share by which half ranges differ that are the same."""
SEARCHED = 1e-5
"""The same where angles between engines were searched."""


@dataclass(frozen=True, eq=False)
class WorstResponse(OrderResponse):
    """The largest half range of several cases: by output and speed the amplitudes of the case that has it.

    Attributes
    ----------
    labels : tuple of str
        The cases, as ``misfire of cylinder 4``.
    chosen : (n_speeds, n_out) array of int
        Which case the amplitudes are of.
    alternatives : mapping
        Label -> response of that case alone, nothing scattered; a single case has no label.
    each : tuple of OrderResponse
        The response of every case alone, by output and speed with its worst combination of what is scattered.
    scattered : tuple of str
        What differs from its rated value, up or down.
    signs : (n_speeds, n_out, n_scattered) array of int
        1 where that is up in the worst combination, -1 where it is down.
    largest : (n_speeds, n_lines, n_out) array
        Largest amplitude that each order has in any case and combination, which may be another than the one chosen.
    angles : tuple of EngineAngle
        Where engines stand that are not fixed to the first one; their amplitudes are those at these angles.
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
    def coherent(self) -> tuple[OrderResponse, ...]:
        return tuple(self.alternatives.values())

    @property
    def single_cases(self) -> tuple[ComplexArray, ...]:
        return tuple(case.values for case in self.each)

    @cached_property
    def least(self) -> WorstResponse:
        """The cases chosen with engines at the angles that make the smallest half range by output and speed.

        Where all angles between engines are known, or there is one engine, that is this response itself.
        """
        if not self.angles:
            return self
        lines = next(iter(self.alternatives.values())).lines
        values = turned(self.values, lines, self.angles, sense=-1)
        found = at_least(OrderResponse(self.speeds, self.reference, lines, values, self.outputs, self.title))
        return replace(self, values=found.values, angles=found.angles)

    def least_at(self, speed: int, output: str | None = None) -> WorstResponse:
        """``least`` at one speed, by its place, and of one output alone."""
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
        """Angles of engines with the largest and the smallest half range, by the place of a speed; in words."""
        place = self.output(output)
        words = ", ".join(one.at(speed, place) for one in self.angles)
        least = self.least_at(speed, output)
        fewest = ", ".join(one.at(0, 0) for one in least.angles)
        share = least.half_range[0, 0] / (self.half_range[speed, place] or 1.0)
        return f"largest where {words}; smallest, {share:.3g} of that, where {fewest}"

    def cases(self, output: str | None = None) -> tuple[str, ...]:
        """What is worst for an output at each speed."""
        place = self.output(output)
        return tuple(self._case(at, place) for at in range(len(self.speeds)))

    def case_at(self, speed: int, output: str | None = None) -> str:
        """As ``cases``, at one speed by its place."""
        return self._case(speed, self.output(output))

    def _case(self, at: int, place: int) -> str:
        parts = [self._alike(at, place)] if self.labels else []
        if self.scattered:
            high = [name for name, sign in zip(self.scattered, self.signs[at, place], strict=True) if sign > 0]
            parts.append(f"{', '.join(high)} up, the others down" if high else "all down")
        parts += [one.at(at, place) for one in self.angles]
        return "; ".join(parts)

    def _alike(self, at: int, place: int) -> str:
        """The case chosen, and those that are as bad as it but for rounding: among them it is no choice."""
        chosen = self.labels[int(self.chosen[at, place])]
        if self.scattered:
            return chosen
        sizes = {label: float(one.half_range[at, place]) for label, one in self.alternatives.items()}
        rounding = SEARCHED if self.angles else ROUNDING
        same = [label for label in self.labels if sizes[label] >= (1 - rounding) * sizes[chosen]]
        return ALIKE if 1 < len(same) == len(self.labels) else " or ".join(same)

    def table(self, output: str | None = None, conventions: Conventions = SI, most: int = 6) -> Table:
        """As of any order response, with the case that is worst at the worst speed."""
        found = super().table(output, conventions, most)
        worst = int(np.argmax(self.half_range[:, self.output(output)]))
        count = f" of {len(self.labels)} cases" if self.labels else ""
        note = f"at every speed the worst{count}; at {self.rpm[worst]:.6g} rpm: {self.case_at(worst, output)}"
        angles = [f"at {self.rpm[worst]:.6g} rpm {self.angle_range(worst, output)}"] if self.angles else []
        return replace(found, notes=(*found.notes, note, *self.engine_notes, *angles))

    def long_table(self) -> Table:
        """As of any order response, with the case of each output."""
        found = super().long_table()
        names = [channel.name for channel in self.outputs]
        by_output = [self.cases(name) for name in names]
        each = len(found.rows) // len(self.speeds)
        rows = tuple((*row, *(cases[number // each] for cases in by_output)) for number, row in enumerate(found.rows))
        columns = (*found.columns, *(Column(f"{name} case") for name in names))
        return replace(found, columns=columns, rows=rows)


def joined(parts: Sequence[tuple[OrderResponse, NDArray[np.intp]]], speeds: FloatArray, title: str) -> OrderResponse:
    """One response out of those at parts of the speeds, each with the places of its own among them."""
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
            label: joined(
                [(part.alternatives[label], those) for part, those in zip(worst, places, strict=True)], speeds, title
            )
            for label in whole.alternatives
        },
        each=tuple(
            joined([(part.each[number], those) for part, those in zip(worst, places, strict=True)], speeds, title)
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
    """The response with its bounds, which every speed has for itself, where they are known of all parts."""
    known = [vars(part)["bounds"] for part in parts if "bounds" in vars(part)]
    if len(known) == len(parts):
        vars(whole)["bounds"] = np.concatenate(known, axis=1)[:, order]
    return whole

"""An elimination plan as one list of simple operations on registers, for a compiled loop to walk along.

A register holds one complex number for every lane. Operations either set their target or add to it:

    LAW       target (+)= factor * kappa[a]
    SUM       target (+)= factor * register a
    PRODUCT   target (+)= factor * register a * register b
    LOAD      target   = load on the coordinate in place a, excitation b
    INVERSE   target   = 1 / register a
    WATCH     the lane is doubtful where register a is large
    OUTPUT    output number target of excitation b = factor * register a
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from torsionnet.solve.graph_plan import Plan, Step

SET_LAW, ADD_LAW, SET_SUM, ADD_SUM, SET_PRODUCT, ADD_PRODUCT, LOAD, INVERSE, WATCH, OUTPUT, ZERO = range(11)


@dataclass(frozen=True, eq=False)
class Tape:
    """Operations (operation, target, a, b) with their factors, and the number of registers they need."""

    operations: NDArray[np.int64]
    factors: NDArray[np.float64]
    n_registers: int


def make_tape(plan: Plan, support: Sequence[int], n_exc: int) -> Tape:
    """The tape of a plan for loads on the coordinates of ``support`` under ``n_exc`` excitations.

    Examples
    --------
    >>> from torsionnet.solve.graph_plan import make_plan
    >>> tape = make_tape(make_plan([{0: 1.0}, {0: 1.0, 1: -1.0}], [{1: 1.0}], [1], 1), [1], 1)
    >>> len(tape.operations), tape.n_registers
    (13, 11)
    """
    writer = _Writer(plan.n_slots)
    for slot, source in enumerate(plan.sources):
        for law, factor in source:
            writer.add(SET_LAW, slot, law, factor=factor)
    loads = [{j: writer.load(place, e) for place, j in enumerate(support)} for e in range(n_exc)]
    back = [_eliminate(step, writer, loads) for step in plan.steps]
    for e in range(n_exc):
        _walk_back(
            plan,
            [(step, shares, quotients[e]) for step, (shares, quotients) in zip(plan.steps, back, strict=True)],
            e,
            writer,
        )
    return Tape(
        np.array(writer.operations, dtype=np.int64).reshape(-1, 4), np.array(writer.factors), writer.n_registers
    )


@dataclass
class _Writer:
    n_registers: int
    operations: list[tuple[int, int, int, int]] = field(default_factory=list)
    factors: list[float] = field(default_factory=list)
    filled: set[int] = field(default_factory=set)

    def register(self) -> int:
        self.n_registers += 1
        return self.n_registers - 1

    def write(self, operation: int, target: int, a: int = 0, b: int = 0, factor: float = 1.0) -> None:
        self.operations.append((operation, target, a, b))
        self.factors.append(factor)

    def add(self, operation: int, target: int, a: int, b: int = 0, factor: float = 1.0) -> None:
        """Add to the target, or set it if nothing is there yet: each SET is followed by its ADD in the list."""
        self.write(operation + (target in self.filled), target, a, b, factor)
        self.filled.add(target)

    def load(self, place: int, excitation: int) -> int:
        target = self.register()
        self.write(LOAD, target, place, excitation)
        self.filled.add(target)
        return target

    def product(self, a: int, b: int) -> int:
        target = self.register()
        self.add(SET_PRODUCT, target, a, b)
        return target


def _eliminate(step: Step, writer: _Writer, loads: list[dict[int, int]]) -> tuple[dict[int, int], list[int | None]]:
    """Registers of the shares kappa_i / S, and of the load over S under each excitation."""
    for slot, parts in step.splits:
        for target, weight in parts:
            writer.add(SET_SUM, target, slot, factor=weight)
    inverse = _inverse_of_pivot(step, writer)
    slots = [slot for slot, _ in step.terms]
    shares = {i: writer.product(slots[i], inverse) for i in step.shared}
    for i, j, factor, target in step.pairs:
        writer.add(SET_PRODUCT, target, shares[i], slots[j], factor)
    if step.closes_loop:
        for share in shares.values():
            writer.write(WATCH, 0, share)
    return shares, [_pass_load(step, writer, here, shares, inverse) for here in loads]


def _inverse_of_pivot(step: Step, writer: _Writer) -> int:
    pivot, inverse = writer.register(), writer.register()
    if not step.terms:
        writer.write(ZERO, pivot)
    for slot, square in step.terms:
        writer.add(SET_SUM, pivot, slot, factor=square)
    writer.write(INVERSE, inverse, pivot)
    return inverse


def _pass_load(step: Step, writer: _Writer, loads: dict[int, int], shares: dict[int, int], inverse: int) -> int | None:
    load = loads.pop(step.coordinate, None)
    if load is None:
        return None
    for i, j, factor in step.loads:
        if j not in loads:
            loads[j] = writer.register()
        writer.add(SET_PRODUCT, loads[j], load, shares[i], factor)
    return writer.product(load, inverse)


def _walk_back(
    plan: Plan, back: Sequence[tuple[Step, dict[int, int], int | None]], excitation: int, writer: _Writer
) -> None:
    values: dict[int, int] = {}
    for step, shares, quotient in reversed(back):
        for motion in step.motions:
            parts = [(shares[i], factor, values[source]) for i, factor, source in motion.parts if source in values]
            if not parts and (quotient is None or not motion.load):
                continue
            target = values[motion.slot] = writer.register()
            if quotient is not None and motion.load:
                writer.add(SET_SUM, target, quotient, factor=motion.load)
            for share, factor, value in parts:
                writer.add(SET_PRODUCT, target, share, value, factor)
    for number, (slot, factor) in enumerate(plan.outputs):
        if slot in values:
            writer.write(OUTPUT, number, values[slot], excitation, factor)

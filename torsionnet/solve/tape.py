"""An elimination plan as one list of simple operations on registers, for a compiled loop to walk along.

A register holds one complex number for every lane. Operations either set their target or add to it:

    LAW       target (+)= factor * kappa[a]
    SUM       target (+)= factor * register a
    PRODUCT   target (+)= factor * register a * register b
    CONSTANT  target   = factor
    INVERSE   target   = 1 / register a
    OUTPUT    output number target of excitation b = factor * register a

A lane in which a watched sum comes out much smaller than before it was added to is in doubt.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from torsionnet.solve.plan import Plan, Step

SET_LAW, ADD_LAW, WATCHED_LAW, SET_SUM, ADD_SUM, WATCHED_SUM, SET_PRODUCT, ADD_PRODUCT, WATCHED_PRODUCT = range(9)
CONSTANT, INVERSE, OUTPUT = range(9, 12)


@dataclass(frozen=True, eq=False)
class Tape:
    """Operations (operation, target, a, b) with their factors, and the number of registers they need.

    ``of_stiffness`` marks those on dynamic stiffnesses, which are watched only where a sum of them might vanish.
    """

    operations: NDArray[np.int64]
    factors: NDArray[np.float64]
    of_stiffness: NDArray[np.bool_]
    n_registers: int
    n_excitations: int


def make_tape(plan: Plan) -> Tape:
    """The tape of a plan.

    Examples
    --------
    >>> from torsionnet.solve.graph_plan import make_plan
    >>> tape = make_tape(make_plan([{0: 1.0}, {0: 1.0, 1: -1.0}], 2, [{1: 1.0}], [{}], [{1: 1.0}], ()))
    >>> len(tape.operations), tape.n_registers
    (14, 12)
    """
    writer = _Writer(plan.n_slots)
    for slot, source in enumerate(plan.sources):
        for law, factor in source:
            writer.add(SET_LAW, slot, law, factor=factor, of_stiffness=True)
    weights = [_weights(plan, excitation, writer) for excitation in range(plan.n_excitations)]
    back = [_eliminate(step, writer, weights) for step in plan.steps]
    for excitation in range(plan.n_excitations):
        loads = [(shares, quotients[excitation]) for shares, quotients in back]
        _read(plan, _walk_back(plan, loads, excitation, writer), weights[excitation], excitation, writer)
    operations = np.array(writer.operations, dtype=np.int64).reshape(-1, 4)
    factors, of_stiffness = np.array(writer.factors), np.array(writer.of_stiffness, dtype=bool)
    return Tape(operations, factors, of_stiffness, writer.n_registers, plan.n_excitations)


@dataclass
class _Writer:
    n_registers: int
    operations: list[tuple[int, int, int, int]] = field(default_factory=list)
    factors: list[float] = field(default_factory=list)
    of_stiffness: list[bool] = field(default_factory=list)
    filled: set[int] = field(default_factory=set)

    def register(self) -> int:
        self.n_registers += 1
        return self.n_registers - 1

    def write(
        self, operation: int, target: int, a: int = 0, b: int = 0, factor: float = 1.0, *, of_stiffness: bool = False
    ) -> None:
        self.operations.append((operation, target, a, b))
        self.factors.append(factor)
        self.of_stiffness.append(of_stiffness)

    def add(
        self, operation: int, target: int, a: int, b: int = 0, factor: float = 1.0, *, of_stiffness: bool = False
    ) -> None:
        """Add to the target, or set it if nothing is there yet: ADD and WATCHED stand one and two after their SET."""
        self.write(operation + 2 * (target in self.filled), target, a, b, factor, of_stiffness=of_stiffness)
        self.filled.add(target)

    def constant(self, value: float) -> int:
        target = self.register()
        self.write(CONSTANT, target, factor=value)
        self.filled.add(target)
        return target

    def product(self, a: int, b: int) -> int:
        target = self.register()
        self.add(SET_PRODUCT, target, a, b)
        return target


def _weights(plan: Plan, excitation: int, writer: _Writer) -> dict[int, int]:
    """Registers of the loads to begin with."""
    sizes: dict[int, float] = {}
    for slot, number, factor in plan.weights:
        if number == excitation:
            sizes[slot] = sizes.get(slot, 0.0) + factor
    return {slot: writer.constant(size) for slot, size in sizes.items()}


def _eliminate(step: Step, writer: _Writer, weights: list[dict[int, int]]) -> tuple[dict[int, int], list[int | None]]:
    """Registers of the shares kappa_i / S, and of the load over S under each excitation."""
    for slot, parts in step.handed_on:
        for target, weight in parts:
            writer.add(SET_SUM, target, slot, factor=weight, of_stiffness=True)
    if not step.shared and not step.loads:
        return {}, [None] * len(weights)
    inverse = _inverse_of_pivot(step, writer)
    slots = [slot for slot, _ in step.terms]
    shares = {i: writer.product(slots[i], inverse) for i in step.shared}
    for i, j, factor, target in step.pairs:
        writer.add(SET_PRODUCT, target, shares[i], slots[j], factor, of_stiffness=True)
    return shares, [_pass_loads(step, writer, here, shares, inverse) for here in weights]


def _inverse_of_pivot(step: Step, writer: _Writer) -> int:
    pivot, inverse = writer.register(), writer.register()
    if not step.terms:
        writer.write(CONSTANT, pivot, factor=0.0)
    for slot, square in step.terms:
        writer.add(SET_SUM, pivot, slot, factor=square, of_stiffness=True)
    writer.write(INVERSE, inverse, pivot)
    return inverse


def _pass_loads(
    step: Step, writer: _Writer, weights: dict[int, int], shares: dict[int, int], inverse: int
) -> int | None:
    for slot, i, factor, target in step.passed:
        if slot in weights:
            register = weights.setdefault(target, writer.n_registers)
            if register == writer.n_registers:
                writer.register()
            writer.add(SET_PRODUCT, register, weights[slot], shares[i], factor)
    present = [(weights[slot], factor) for slot, factor in step.loads if slot in weights]
    if not present:
        return None
    load = writer.register()
    for register, factor in present:
        writer.add(SET_SUM, load, register, factor=factor)
    return writer.product(load, inverse)


def _walk_back(
    plan: Plan, back: list[tuple[dict[int, int], int | None]], excitation: int, writer: _Writer
) -> dict[int, int]:
    """Registers of the motions of rows."""
    values = {slot: writer.constant(motions[excitation]) for slot, motions in plan.given if motions[excitation]}
    for step, (shares, quotient) in zip(reversed(plan.steps), reversed(back), strict=True):
        for motion in step.motions:
            parts = [(shares[i], factor, values[source]) for i, factor, source in motion.parts if source in values]
            if not parts and (quotient is None or not motion.load):
                continue
            target = values[motion.slot] = writer.register()
            if quotient is not None and motion.load:
                writer.add(SET_SUM, target, quotient, factor=motion.load)
            for share, factor, value in parts:
                writer.add(SET_PRODUCT, target, share, value, factor)
    return values


def _read(plan: Plan, values: dict[int, int], weights: dict[int, int], excitation: int, writer: _Writer) -> None:
    for number, (slot, factor) in enumerate(plan.outputs):
        if slot in values:
            writer.write(OUTPUT, number, values[slot], excitation, factor)
    for number, reaction in enumerate(plan.reactions, len(plan.outputs)):
        torque = writer.register()
        for slot, factor, motion in reaction.laws:
            if motion in values:
                writer.add(SET_PRODUCT, torque, slot, values[motion], factor)
        for slot, factor in reaction.loads:
            if slot in weights:
                writer.add(SET_SUM, torque, weights[slot], factor=factor)
        if torque in writer.filled:
            writer.write(OUTPUT, number, torque, excitation)

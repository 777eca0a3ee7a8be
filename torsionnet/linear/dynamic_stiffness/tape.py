"""Operation tapes: simple operations on registers that carry out an elimination plan, in numpy or in a compiled loop.

A register holds one number for every point. What an operation does with its target t, from registers a and b and the
dynamic stiffness kappa of a slot:

    LAW       t = kappa
    LAW_SUM   t = kappa + factor r_a r_b, where another row hands on its share
    LAW_SHARE t = kappa / (r_a + factor kappa)
    CONSTANT  t = factor
    SUM       t = r_a + factor r_b
    PRODUCT   t = r_a r_b
    QUOTIENT  t = r_a / (r_b + factor r_a), a share of two stiffnesses, or with factor 0 a mere quotient
    INVERSE   t = 1 / r_a
    OUTPUT    value number t = factor r_a

Only what an output needs is on the tape, and a register is used again as soon as what it holds is needed no more: the
numbers of a walk stay in the cache however large the drivetrain is. In numpy every operation works on a vector of
frequency points at once.

Weights of loads go forward with the elimination. What is read either comes back along the way, all motions from one
solution, or goes forward like a load: the dynamic stiffness is symmetric, and with r D^-1 l built up on the way nothing
has to be kept for a way back. That is the better way for few readings.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.graph_plan import EliminationPlan, EliminationStep

LAW, LAW_SUM, LAW_SHARE, CONSTANT, SUM, PRODUCT, QUOTIENT, INVERSE, OUTPUT = range(9)
"""Codes of the operations on an elimination's tape, each with the meaning listed at the head of the module."""
_READS = {LAW_SUM: 2, LAW_SHARE: 1, SUM: 2, PRODUCT: 2, QUOTIENT: 2, INVERSE: 1, OUTPUT: 1}
"""Number of registers that an operation reads, by its code, where operations not listed read none."""


class Operation(NamedTuple):
    """Operation of an elimination, as code, target, two sources, slot of a law and a factor."""

    code: int
    t: int
    a: int = 0
    b: int = 0
    slot: int = 0
    factor: float = 1.0

    @property
    def read(self) -> tuple[int, ...]:
        return (self.a, self.b)[: _READS.get(self.code, 0)]


@dataclass(frozen=True, eq=False)
class Tape:
    """Operations (n, 5) of an elimination with factors (n,), and the numbers of registers and output values."""

    operations: NDArray[np.int64]
    factors: NDArray[np.float64]
    n_registers: int
    n_values: int

    @cached_property
    def steps(self) -> list[tuple[int, int, int, int, int, float]]:
        """Operations as plain numbers: code, target, sources, slot and factor."""
        return list(zip(*self.operations.T.tolist(), self.factors.tolist(), strict=True))


class TapeQuantity(NamedTuple):
    """Quantity in an elimination, ``factor`` times the result of operation ``name``, or ``factor`` if ``name`` < 0."""

    name: int
    factor: float


@dataclass
class Writer:
    """Operations of an elimination as they are written down.

    Scalar factors are carried along until an operation needs them.
    """

    operations: list[Operation] = field(default_factory=list)
    n_names: int = 0

    def new(self, code: int, a: int = 0, b: int = 0, slot: int = 0, factor: float = 1.0) -> int:
        """Append an operation of an elimination and return the number by which its result is named."""
        self.operations.append(Operation(code, self.n_names, a, b, slot, factor))
        self.n_names += 1
        return self.n_names - 1

    def name(self, quantity: TapeQuantity) -> int:
        """Name of a quantity, for which a mere factor becomes a constant."""
        return quantity.name if quantity.name >= 0 else self.new(CONSTANT)

    def plus(self, known: TapeQuantity | None, term: TapeQuantity) -> TapeQuantity:
        """Sum of two quantities of an elimination, or ``term`` itself where ``known`` is None."""
        if known is None or not known.factor:
            return term
        if known.name < 0 and term.name < 0:
            return TapeQuantity(-1, known.factor + term.factor)
        first, second = self.name(known), self.name(term)
        return TapeQuantity(self.new(SUM, first, second, factor=term.factor / known.factor), known.factor)

    def times(self, first: TapeQuantity, second: TapeQuantity) -> TapeQuantity:
        factor = first.factor * second.factor
        if first.name < 0 or second.name < 0:
            return TapeQuantity(max(first.name, second.name), factor)
        return TapeQuantity(self.new(PRODUCT, first.name, second.name), factor)

    def over(self, above: TapeQuantity, below: TapeQuantity) -> TapeQuantity:
        factor = above.factor / below.factor
        if above.name < 0:
            return TapeQuantity(self.new(INVERSE, self.name(below)), factor)
        part, whole = self.operations[above.name], self.operations[self.name(below)]
        if whole.code != SUM or above.name not in whole.read:
            return TapeQuantity(self.new(QUOTIENT, above.name, whole.t, factor=0.0), factor)
        # Share of a sum x + f y = f (y + x/f), which then need not be kept, nor a law that is its part.
        if above.name == whole.b:
            rest, share = whole.a, whole.factor
        else:
            rest, share, factor = whole.b, 1 / whole.factor, factor / whole.factor
        if part.code == LAW:
            return TapeQuantity(self.new(LAW_SHARE, rest, slot=part.slot, factor=share), factor)
        return TapeQuantity(self.new(QUOTIENT, above.name, rest, factor=share), factor)

    def tape(self, n_values: int) -> Tape:
        """Tape of the operations that the outputs of an elimination depend on, with registers for their results."""
        # Backwards: an operation is needed if an output or another needed one reads what it sets.
        used: set[int] = set()
        needed = []
        for operation in reversed(self.operations):
            if operation.code == OUTPUT or operation.t in used:
                used.update(operation.read)
                needed.append(operation)
        needed.reverse()
        # Forwards: every result gets a register, which is free again after the last operation that reads it.
        last = {name: place for place, operation in enumerate(needed) for name in operation.read}
        home: dict[int, int] = {}
        free: list[int] = []
        placed, n_registers = [], 0
        for place, operation in enumerate(needed):
            sources = [home[name] for name in operation.read]
            target = operation.t
            # Never the place of a source: compilers make vector instructions only of what does not overlap.
            if operation.code != OUTPUT:
                if not free:
                    free.append(n_registers)
                    n_registers += 1
                target = home[operation.t] = free.pop()
            free += [home.pop(name) for name in dict.fromkeys(operation.read) if last[name] == place]
            placed.append((operation.code, target, *(*sources, 0, 0)[:2], operation.slot))
        operations = np.array(placed, dtype=np.int64).reshape(-1, 5)
        return Tape(operations, np.array([operation.factor for operation in needed]), n_registers, n_values)


Array: TypeAlias = NDArray[Any]
"""Real array for systems without damping, else complex, of stiffnesses or motions with frequency points on the last
axis."""

ONE = TapeQuantity(-1, 1.0)
"""Quantity 1, for which no operation is written."""


MOST_FORWARD_READINGS = 2
"""Largest number of readings that are carried forward with the loads, as that takes fewer operations than
back-substitution for so few."""
Key = TypeVar("Key")
"""Key of a quantity in a table, the number of a slot or of a reading, or of a reading and an excitation."""


def make_tape(plan: EliminationPlan) -> Tape:
    """Operation tape of an elimination plan, whose value n_excitations * reading + excitation is that reading.

    Examples
    --------
    >>> from torsionnet.linear.dynamic_stiffness.graph_plan import make_plan
    >>> tape = make_tape(make_plan([{0: 1.0}, {0: 1.0, 1: -1.0}], 2, [{1: 1.0}], [{}], [{1: 1.0}], ()))
    >>> len(tape.operations), tape.n_registers
    (5, 3)
    """
    n_read = len(plan.outputs) + len(plan.reactions)
    taping = (_Forward if n_read <= MOST_FORWARD_READINGS else _Back)(plan)
    for (reading, excitation), value in taping.read().items():
        number, name = reading * plan.n_excitations + excitation, taping.writer.name(value)
        taping.writer.operations.append(Operation(OUTPUT, number, name, factor=value.factor))
    return taping.writer.tape(n_read * plan.n_excitations)


@dataclass(frozen=True)
class _Eliminated:
    """Elimination step with the shares kappa_i / S of its rows, and the motion f_v / S in rad by excitation."""

    step: EliminationStep
    shares: dict[int, TapeQuantity]
    loads: dict[int, TapeQuantity]


class _Taping:
    """Writer of the part of a tape that both kinds have in common, the elimination of laws and loads.

    ``read`` of either kind gives the values of what is read, by the numbers of reading and excitation.
    """

    def __init__(self, plan: EliminationPlan) -> None:
        self.plan, self.writer = plan, Writer()
        self.links: dict[int, TapeQuantity] = {}
        self.fresh = set(range(len(plan.sources)))
        self.weights: list[dict[int, TapeQuantity]] = [{} for _ in range(plan.n_excitations)]
        for slot, excitation, factor in plan.weights:
            self._add(self.weights[excitation], slot, TapeQuantity(-1, factor))

    def _add(self, table: dict[Key, TapeQuantity], key: Key, term: TapeQuantity) -> None:
        table[key] = self.writer.plus(table.get(key), term)

    def _link(self, slot: int, added: TapeQuantity | None = None) -> TapeQuantity:
        """Dynamic stiffness in N m/rad of a row slot, with a term ``added``, as a quantity of the tape.

        That of laws is not worked out before use.
        """
        if slot in self.fresh:
            self.fresh.discard(slot)
            if added is not None and (made := self.writer.operations[added.name]).code == PRODUCT:
                name = self.writer.new(LAW_SUM, made.a, made.b, slot, added.factor)
                self.links[slot] = TapeQuantity(name, 1.0)
                return self.links[slot]
            self.links[slot] = TapeQuantity(self.writer.new(LAW, slot=slot), 1.0)
        if added is not None:
            self.links[slot] = self.writer.plus(self.links.get(slot), added)
        return self.links[slot]

    def _eliminated(self) -> Iterable[_Eliminated]:
        """Write the elimination of one coordinate after the other, and yield its shares and the motions of loads."""
        writer = self.writer
        for step in self.plan.steps:
            for slot, parts in step.handed_on:
                for target, weight in parts:
                    self._link(target, added=writer.times(self._link(slot), TapeQuantity(-1, weight)))
            if not (step.shared or step.loads):
                yield _Eliminated(step, {}, {})
                continue
            terms = [self._link(slot) for slot, _ in step.terms]
            # Pivot S = sum kappa_e a_ev^2 in N m/rad, the total stiffness on the coordinate.
            pivot = None
            for term, (_, square) in zip(terms, step.terms, strict=True):
                pivot = writer.plus(pivot, writer.times(term, TapeQuantity(-1, square)))
            S = pivot or TapeQuantity(writer.new(CONSTANT, factor=0.0), 1.0)
            # Shares s_i = kappa_i/S; several of them by one reciprocal, as a product takes less than a quotient.
            if len(step.shared) > 1:
                inverse = writer.over(ONE, S)
                shares = {i: writer.times(terms[i], inverse) for i in step.shared}
            else:
                shares = {i: writer.over(terms[i], S) for i in step.shared}
            # D' = sum_{i<j} factor s_i kappa_j b b^T.
            for i, j, factor, target in step.pairs:
                pair = writer.times(writer.times(shares[i], terms[j]), TapeQuantity(-1, factor))
                self._link(target, added=pair)
            loads = {}
            for excitation, weights in enumerate(self.weights):
                # w[target] += factor s_i w[slot]: loads on the coordinate pass on to other rows ...
                for slot, i, factor, target in step.passed:
                    if slot in weights:
                        passed = writer.times(writer.times(weights[slot], shares[i]), TapeQuantity(-1, factor))
                        self._add(weights, target, passed)
                # ... and their sum over S is the motion that they cause on the spot.
                load = None
                for slot, factor in step.loads:
                    if slot in weights:
                        load = writer.plus(load, writer.times(weights[slot], TapeQuantity(-1, factor)))
                if load is not None:
                    loads[excitation] = writer.over(load, S)
            yield _Eliminated(step, shares, loads)


class _Back(_Taping):
    """Writer of a tape with back-substitution, which gives all motions under one excitation after another."""

    def read(self) -> dict[tuple[int, int], TapeQuantity]:
        way = list(self._eliminated())
        values: dict[tuple[int, int], TapeQuantity] = {}
        for excitation in range(self.plan.n_excitations):
            motions = self._motions(way, excitation)
            for reading, value in self._read(motions, excitation):
                values[reading, excitation] = value
        return values

    def _motions(self, way: Sequence[_Eliminated], excitation: int) -> dict[int, TapeQuantity]:
        writer = self.writer
        motions = {slot: TapeQuantity(-1, given[excitation]) for slot, given in self.plan.given if given[excitation]}
        # Back along the way: r q = r_v f_v/S + sum_e (kappa_e a_ev/S) b_e q, equation (3.5).
        for eliminated in reversed(way):
            for motion in eliminated.step.motions:
                total = None
                if motion.load and excitation in eliminated.loads:
                    total = writer.times(eliminated.loads[excitation], TapeQuantity(-1, motion.load))
                for i, factor, source in motion.terms:
                    if source in motions:
                        part = writer.times(eliminated.shares[i], motions[source])
                        part = writer.times(part, TapeQuantity(-1, factor))
                        total = writer.plus(total, part)
                if total is not None:
                    motions[motion.slot] = total
        return motions

    def _read(self, motions: dict[int, TapeQuantity], excitation: int) -> Iterable[tuple[int, TapeQuantity]]:
        writer = self.writer
        for number, (slot, factor) in enumerate(self.plan.outputs):
            if slot in motions:
                yield number, writer.times(motions[slot], TapeQuantity(-1, factor))
        for number, reaction in enumerate(self.plan.reactions, len(self.plan.outputs)):
            total = None
            # Reaction of a given column, sum_l w_l l_g - sum_e kappa_e a_eg (a_e q).
            for slot, factor, motion in reaction.laws:
                if motion in motions:
                    torque = writer.times(writer.times(self._link(slot), motions[motion]), TapeQuantity(-1, factor))
                    total = writer.plus(total, torque)
            for slot, factor in reaction.loads:
                if slot in self.weights[excitation]:
                    weight = self.weights[excitation][slot]
                    total = writer.plus(total, writer.times(weight, TapeQuantity(-1, factor)))
            if total is not None:
                yield number, total


class _Forward(_Taping):
    """Writer of a tape with readings carried forward as weights, which the loads meet on the way."""

    def read(self) -> dict[tuple[int, int], TapeQuantity]:
        writer = self.writer
        self.carried: dict[int, dict[int, TapeQuantity]] = defaultdict(dict)
        values: dict[tuple[int, int], TapeQuantity] = {}
        for number, (slot, factor) in enumerate(self.plan.outputs):
            self._add(self.carried[slot], number, TapeQuantity(-1, factor))
        for eliminated in self._eliminated():
            for motion in eliminated.step.motions:
                for reading, weight in self._weights_on(motion.slot):
                    # r q = sum factor s_i (b q): the weight of the motion passes on to those it is made of ...
                    for i, factor, source in motion.terms:
                        part = writer.times(weight, eliminated.shares[i])
                        self._add(self.carried[source], reading, writer.times(part, TapeQuantity(-1, factor)))
                    # ... and meets f_v / S, what loads do on the spot.
                    if motion.load:
                        own = writer.times(weight, TapeQuantity(-1, motion.load))
                        for e, met in [(e, writer.times(own, load)) for e, load in eliminated.loads.items()]:
                            self._add(values, (reading, e), met)
        for slot, given in self.plan.given:
            for reading, weight in self._weights_on(slot):
                angles = [(e, TapeQuantity(-1, angle)) for e, angle in enumerate(given) if angle]
                for e, met in [(e, writer.times(weight, angle)) for e, angle in angles]:
                    self._add(values, (reading, e), met)
        for number, reaction in enumerate(self.plan.reactions, len(self.plan.outputs)):
            for slot, factor in reaction.loads:
                for excitation, weights in enumerate(self.weights):
                    if slot in weights:
                        held = writer.times(weights[slot], TapeQuantity(-1, factor))
                        self._add(values, (number, excitation), held)
        return values

    def _weights_on(self, slot: int) -> list[tuple[int, TapeQuantity]]:
        """Weights by reading with which the motion of this number counts, reactions that depend on it included."""
        for number, reaction in enumerate(self.plan.reactions, len(self.plan.outputs)):
            for law, factor, motion in reaction.laws:
                if motion == slot:
                    weight = self.writer.times(self._link(law), TapeQuantity(-1, factor))
                    self._add(self.carried[slot], number, weight)
        return list(self.carried.pop(slot, {}).items())


BLOCK_BYTES = 16 * 2**20
"""Memory in bytes of the registers that numpy works on at once, since more would leave the processor's cache."""
FEWEST_POINTS, MOST_POINTS = 1024, 16384
"""Fewest and most frequency points that numpy works on at once, as fewer cost more in the interpreter than in
arithmetic and more leave the cache."""


CACHE_LINE = 64
"""Bytes of a line of the processor's cache. Sums of registers that begin with one take half the time."""


def sweep(tape: Tape, stiffness: LawStiffness) -> Array:
    """Output values (n_values, n_points) of a tape by numpy, from the stiffness of the slots of its plan."""
    # Without damping in any law all dynamic stiffnesses are real.
    is_damped = stiffness.damping.any() or any(values.imag.any() for _, values in stiffness.sampled)
    kind = np.result_type(stiffness.stiffness.dtype, np.complex64 if is_damped else np.float32)
    values, start = np.zeros((tape.n_values, stiffness.n_points), dtype=kind), 0
    in_cache = BLOCK_BYTES // (kind.itemsize * (tape.n_registers + 2))
    for part in stiffness.blocks(min(MOST_POINTS, max(FEWEST_POINTS, in_cache))):
        n_points, n_variants = part.n_points, len(part.stiffness)
        registers, outputs = in_cache_lines(tape.n_registers + 2, n_points, kind), values[:, start : start + n_points]
        start += n_points
        *r, total, spare = registers
        # Laws are written by variant and frequency, but for a single variant by frequency alone.
        laws, omega = part.polynomials(), part.omega.ravel() if n_variants == 1 else part.omega
        by_variant = registers if n_variants == 1 else registers.reshape(len(registers), n_variants, omega.shape[-1])
        slots, parts = [*by_variant], [*by_variant.view(omega.dtype)]
        powers = in_cache_lines(2, omega.size, kind).reshape(2, *omega.shape)
        np.multiply(omega, 1j if is_damped else 0.0, out=powers[0])
        np.multiply(omega, -omega, out=powers[1])
        s, squares = powers.view(omega.dtype)
        # Each operation as the head of the module says, r_t from r_a and r_b.
        for code, t, a, b, slot, factor in tape.steps:
            if code == PRODUCT:
                np.multiply(r[a], r[b], out=r[t])
            elif code == SUM:
                np.add(r[a], r[b] if factor == 1.0 else np.multiply(r[b], factor, out=spare), out=r[t])
            elif code == LAW:
                _write(laws[slot], omega, s, squares, slots[t], parts[t])
            elif code == LAW_SUM:
                _write(laws[slot], omega, s, squares, slots[t], parts[t])
                np.multiply(r[a], r[b], out=spare)
                np.add(r[t], spare if factor == 1.0 else np.multiply(spare, factor, out=spare), out=r[t])
            elif code in (LAW_SHARE, QUOTIENT):
                above, below = r[a], r[b]
                if code == LAW_SHARE:
                    _write(laws[slot], omega, s, squares, slots[t], parts[t])
                    above, below = r[t], r[a]
                if factor:
                    below = np.add(below, above if factor == 1.0 else np.multiply(above, factor, out=spare), out=total)
                if kind != np.complex64:
                    np.divide(above, below, out=r[t])
                else:
                    # a b* / |b|^2: numpy divides complex numbers one by one. Both parts of (1 + j) b* b are |b|^2.
                    np.conjugate(below, out=spare)
                    np.multiply(above, spare, out=r[t])
                    np.multiply(spare, np.complex64(1 + 1j), out=spare)
                    np.multiply(spare, below, out=spare)
                    np.divide(parts[t], parts[-1], out=parts[t])
            elif code == INVERSE:
                np.divide(1.0, r[a], out=r[t])
            elif code == CONSTANT:
                r[t].fill(factor)
            else:
                np.multiply(r[a], factor, out=outputs[t])
    return values


def _write(law: Any, omega: FloatArray, s: FloatArray, squares: FloatArray, out: Array, parts: FloatArray) -> None:
    """Write the dynamic stiffness J s^2 + c s + k + sample of a law in N m/rad into ``out`` (n_variants, n_f).

    ``s``, ``squares`` and ``parts``, which is ``out`` too, have an imaginary part after each real one.
    """
    # What a law has not is not multiplied by zero. Both parts at once take less time than one after the other.
    J, c, k, sample = law
    if J is not None:
        np.multiply(squares, J, out=parts)
        if c is not None:
            np.multiply(omega, c, out=out.imag)
        if k is not None:
            np.add(out.real, k, out=out.real)
    elif c is not None:
        np.multiply(s, c, out=parts)
        if k is not None:
            out.real[...] = k
    else:
        out[...] = 0.0 if k is None else k
    if sample is not None:
        np.add(out, sample if out.dtype.kind == "c" else sample.real, out=out)


def in_cache_lines(n: int, n_points: int, kind: np.dtype[Any]) -> Array:
    """Registers (n, n_points) that each begin with a line of the processor's cache."""
    line = CACHE_LINE // kind.itemsize
    width = -(-n_points // line) * line
    memory = np.empty(n * width + line, dtype=kind)
    first = -memory.ctypes.data % CACHE_LINE // kind.itemsize
    return memory[first : first + n * width].reshape(n, width)[:, :n_points]

"""List of simple operations on registers that carries out an elimination, in numpy or in a compiled loop.

A register holds one number for every point. What an operation does with its target t, from registers a and b:

    LAW       t = dynamic stiffness of slot a
    CONSTANT  t = factor
    SUM       t = r_a + factor r_b
    PRODUCT   t = r_a r_b
    QUOTIENT  t = r_a / r_b
    INVERSE   t = 1 / r_a
    OUTPUT    value number t = factor r_a

Others work on magnitudes, real numbers that say how many digits are lost:

    LEVEL     t = factor
    SIZE      t = |r_a|
    REST      t = |1 - factor r_a|
    TERMS     t = the larger of |r_a|, the dynamic stiffness of slot b, and the inertia term in it
    MORE      t = r_a + factor r_b
    TIMES     t = r_a r_b
    RATIO     t = r_a / r_b
    LARGER    t = the larger of r_a and factor r_b
    OPEN      t = |1 - factor r_a|, or |r_a| times the inertia term in slot p over |slot q| if that is larger and slot p
              has a stiffness too; p and q in one number, n p + q, of n slots
    PASSED    t = factor r_a r_b times |slot p| over |slot q|
    MARK      the point is uncertain unless factor r_a is at most MOST_LOST times r_b

Only what an output needs is on the tape, and a register is used again as soon as what it holds is needed no more: the
numbers of a walk stay in the cache however large the drivetrain is.

Bounds on the rounding errors of an elimination, which its tape works out beside the values.

A rounding changes a number by u = 1.1e-16 of itself at most. Every row stiffness kappa has a bound E, with an error of
about u E. Of a law E is the larger of its terms, of a sum the larger of both bounds. Elimination of a coordinate with
S = sum a_k^2 kappa_k and shares s_k = kappa_k/S leaves kappa' = f kappa_i kappa_j/S, so with k other than i and j

    d kappa' = f (s_j (1 - a_i^2 s_i) d kappa_i  +  s_i (1 - a_j^2 s_j) d kappa_j  -  s_i s_j sum a_k^2 d kappa_k)

On trees of springs a coordinate has two rows, of a law kappa_i and of what is left of all beyond it, kappa_j. With
z = |1 - a_i^2 s_i|, t = |a_i^2 s_i| and e = a_j^2 E_j/(a_i^2 |kappa_i|) the relative bound of its pivot is y, and that
of kappa' is worked out as a multiple of kappa_i, which takes fewer operations,

    y = max(z, t e),    E' = f |kappa_i|/a_j^2 max(z, t y)

What is lost at a small pivot multiplies what was lost before; a soft link in series with what has lost digits forgets
the loss. The largest term is taken instead of the sum, as signs of roundings fall by chance and would cancel. Loads and
motions are products of shares, and sums of these; a sum of the magnitudes of all products goes with them. The relative
error of an output is about

    u * (sum of magnitudes / |output|) * (largest relative bound of a share or pivot)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.dynamic_stiffness.graph_plan import EliminatedPair, EliminationStep

LAW, CONSTANT, SUM, PRODUCT, QUOTIENT, INVERSE, OUTPUT = range(7)
LEVEL, SIZE, REST, TERMS, MORE, TIMES, RATIO, LARGER, OPEN, PASSED, MARK = range(7, 18)
"""Codes of the operations on an elimination's tape, each with the meaning listed at the head of the module."""
_READS = {SUM: 2, PRODUCT: 2, QUOTIENT: 2, INVERSE: 1, OUTPUT: 1} | {
    **dict.fromkeys((SIZE, REST, TERMS, OPEN), 1),
    **dict.fromkeys((MORE, TIMES, RATIO, LARGER, PASSED, MARK), 2),
}
"""Number of registers that an operation reads, by its code, where operations not listed read none."""


class Operation(NamedTuple):
    """Operation of an elimination, as code, target, two sources, a factor, and two slots as one number."""

    code: int
    t: int
    a: int = 0
    b: int = 0
    factor: float = 1.0
    slots: int = 0

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

    def __len__(self) -> int:
        return len(self.operations)


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
    _sizes: dict[int, TapeQuantity] = field(default_factory=dict)
    _terms: dict[int, TapeQuantity] = field(default_factory=dict)

    def new(self, code: int, a: int = 0, b: int = 0, factor: float = 1.0, slots: int = 0) -> int:
        """Append an operation of an elimination and return the number by which its result is named."""
        self.operations.append(Operation(code, self.n_names, a, b, factor, slots))
        self.n_names += 1
        return self.n_names - 1

    def name(self, quantity: TapeQuantity, constant: int = CONSTANT) -> int:
        """Name of a quantity, for which a mere factor becomes a ``constant``: LEVEL among magnitudes."""
        return quantity.name if quantity.name >= 0 else self.new(constant)

    def plus(self, known: TapeQuantity | None, term: TapeQuantity, *, of_terms: bool = True) -> TapeQuantity:
        """Sum of two quantities of an elimination, or ``term`` itself where ``known`` is None.

        With ``of_terms`` the sum of the magnitudes of its terms is known too, where that is asked for.
        """
        if known is None or not known.factor:
            return term
        if known.name < 0 and term.name < 0:
            return TapeQuantity(-1, known.factor + term.factor)
        first, second = self.name(known), self.name(term)
        total = TapeQuantity(self.new(SUM, first, second, term.factor / known.factor), known.factor)
        if of_terms:
            size = self.more(self.terms(known), self.terms(term))
            self._terms[total.name] = TapeQuantity(size.name, size.factor / abs(known.factor))
        return total

    def times(self, first: TapeQuantity, second: TapeQuantity) -> TapeQuantity:
        factor = first.factor * second.factor
        if first.name < 0 or second.name < 0:
            return TapeQuantity(max(first.name, second.name), factor)
        return TapeQuantity(self._new_of(PRODUCT, first.name, second.name), factor)

    def over(self, above: TapeQuantity, below: TapeQuantity) -> TapeQuantity:
        factor = above.factor / below.factor
        if above.name < 0:
            return TapeQuantity(self.new(INVERSE, self.name(below)), factor)
        return TapeQuantity(self._new_of(QUOTIENT, above.name, self.name(below)), factor)

    def _new_of(self, code: int, a: int, b: int) -> int:
        """Append a product or quotient of two results of an elimination, of whose terms' magnitudes it has the same."""
        found = self.new(code, a, b)
        combine = self.product if code == PRODUCT else self.ratio
        if a in self._terms or b in self._terms:
            first, second = (self.terms(TapeQuantity(name, 1.0)) for name in (a, b))
            self._terms[found] = combine(first, second)
        elif a in self._sizes and b in self._sizes:
            self._sizes[found] = combine(self._sizes[a], self._sizes[b])
        return found

    # --- magnitudes -------------------------------------------------------------------------------------------------

    def size(self, quantity: TapeQuantity) -> TapeQuantity:
        """Magnitude of a quantity of an elimination."""
        if quantity.name < 0:
            return TapeQuantity(-1, abs(quantity.factor))
        if quantity.name not in self._sizes:
            self._sizes[quantity.name] = TapeQuantity(self.new(SIZE, quantity.name), 1.0)
        found = self._sizes[quantity.name]
        return TapeQuantity(found.name, found.factor * abs(quantity.factor))

    def terms(self, quantity: TapeQuantity) -> TapeQuantity:
        """Sum of the magnitudes of all the terms that a quantity of an elimination is a sum of, itself if of none."""
        found = self._terms.get(quantity.name)
        if found is None:
            return self.size(quantity)
        return TapeQuantity(found.name, found.factor * abs(quantity.factor))

    def more(self, first: TapeQuantity, second: TapeQuantity) -> TapeQuantity:
        """Sum of two magnitudes."""
        if first.name < 0 and second.name < 0:
            return TapeQuantity(-1, first.factor + second.factor)
        if not first.factor or not second.factor:
            return second if not first.factor else first
        names = self.name(first, LEVEL), self.name(second, LEVEL)
        return TapeQuantity(self.new(MORE, *names, second.factor / first.factor), first.factor)

    def larger(self, first: TapeQuantity | None, second: TapeQuantity) -> TapeQuantity:
        """The larger of two magnitudes, or the second where the first is None or no more than zero."""
        if first is None or not first.factor:
            return second
        if not second.factor or first == second:
            return first
        if first.name < 0 and second.name < 0:
            return TapeQuantity(-1, max(first.factor, second.factor))
        names = self.name(first, LEVEL), self.name(second, LEVEL)
        return TapeQuantity(self.new(LARGER, *names, second.factor / first.factor), first.factor)

    def product(self, first: TapeQuantity, second: TapeQuantity) -> TapeQuantity:
        """Product of two magnitudes."""
        factor = first.factor * second.factor
        if first.name < 0 or second.name < 0:
            return TapeQuantity(max(first.name, second.name), factor)
        return TapeQuantity(self.new(TIMES, first.name, second.name), factor)

    def ratio(self, above: TapeQuantity, below: TapeQuantity) -> TapeQuantity:
        """Ratio of two magnitudes."""
        if below.name < 0:
            return TapeQuantity(above.name, above.factor / below.factor)
        return TapeQuantity(self.new(RATIO, self.name(above, LEVEL), below.name), above.factor / below.factor)

    def rest(self, share: TapeQuantity) -> TapeQuantity:
        """Magnitude of 1 less a share."""
        if share.name < 0:
            return TapeQuantity(-1, abs(1.0 - share.factor))
        return TapeQuantity(self.new(REST, share.name, 0, share.factor), 1.0)

    def tape(self, n_values: int) -> Tape:
        """Tape of the operations that the outputs of an elimination depend on, with registers for their results."""
        # Backwards: an operation is needed if an output or another needed one reads what it sets.
        used: set[int] = set()
        needed = []
        for one in reversed(self.operations):
            if one.code in (OUTPUT, MARK) or one.t in used:
                used.update(one.read)
                needed.append(one)
        needed.reverse()
        # Forwards: every result gets a register, which is free again after the last operation that reads it.
        last = {name: place for place, one in enumerate(needed) for name in one.read}
        home: dict[int, int] = {}
        free: list[int] = []
        placed, n_registers = [], 0
        for place, one in enumerate(needed):
            sources = [home[name] for name in one.read]
            target = one.t
            # Never the place of a source: compilers make vector instructions only of what does not overlap.
            if one.code not in (MARK, OUTPUT):
                if not free:
                    free.append(n_registers)
                    n_registers += 1
                target = home[one.t] = free.pop()
            free += [home.pop(name) for name in dict.fromkeys(one.read) if last[name] == place]
            a, b = (*sources, one.a, one.b)[:2] if len(sources) != 1 else (sources[0], one.b)
            placed.append((one.code, target, a, b, one.slots))
        operations = np.array(placed, dtype=np.int64).reshape(-1, 5)
        return Tape(operations, np.array([one.factor for one in needed]), n_registers, n_values)


Array: TypeAlias = NDArray[Any]
"""Real array for systems without damping, else complex, of stiffnesses or motions with frequency points on the last
axis."""

LARGE_SHARE = 1e3
"""Ratio of a term to its sum or quotient above which a frequency point is uncertain where loops are closed and measured
inputs divided, lower than that of an elimination since the losses there come on top."""
MOST_LOST = 1e5
"""Bound on an error, in roundings of what it belongs to, above which a frequency point is uncertain. Five digits lost
of sixteen leave two to spare below the error of 1e-9 that responses promise."""
FEW_ROWS = 4
"""Most rows on a coordinate for which the bound of a pair leaves out what its own two rows have lost, as more would
take too many operations."""


ONE, NOTHING = TapeQuantity(-1, 1.0), TapeQuantity(-1, 0.0)
"""Quantities 1 and 0, for which no operation is written."""


class ErrorBound(NamedTuple):
    """Bound on the error of a row stiffness in N m/rad, or as a multiple of the law of a slot."""

    size: TapeQuantity
    law: int = -1


@dataclass
class Losses:
    """Writer of the bounds on rounding errors beside the elimination of laws and loads.

    Attributes
    ----------
    writer : Writer
    n_laws : int
    laws : dict
        Dynamic stiffness in N m/rad of every law that was used so far, by slot.
    own : set of int
        Slots of laws whose own bound, the larger of their dynamic stiffness and its inertia term, is not yet counted.
    terms, bounds : dict
        That larger one, and the bound in N m/rad of all that was counted, by slot.
    multiples : dict
        Bounds that are not yet counted, each a multiple of a law, by slot.
    worst : TapeQuantity
        Largest relative bound of any share or pivot.
    left : ErrorBound, optional
        Bound of what the latest step leaves, where that was a coordinate with two rows.
    """

    writer: Writer
    n_laws: int
    laws: dict[int, TapeQuantity] = field(default_factory=dict)
    terms: dict[int, TapeQuantity] = field(default_factory=dict)
    own: set[int] = field(default_factory=set)
    bounds: dict[int, TapeQuantity] = field(default_factory=dict)
    multiples: dict[int, list[ErrorBound]] = field(default_factory=dict)
    worst: TapeQuantity = ONE
    left: ErrorBound | None = None

    def add(self, slot: int, bound: ErrorBound) -> None:
        """Count the bound of what is added to a row stiffness."""
        if bound.law >= 0:
            self.multiples.setdefault(slot, []).append(bound)
        else:
            self.bounds[slot] = self.writer.larger(self.bounds.get(slot), bound.size)

    def handed_on(self, slot: int, weight: float) -> ErrorBound:
        """Bound in N m/rad of a row stiffness times a weight."""
        return ErrorBound(_times(self._bound(slot), abs(weight)))

    def _bound(self, slot: int) -> TapeQuantity:
        """Bound in N m/rad of all that has been added to a row stiffness."""
        if slot in self.own:
            self.own.discard(slot)
            self.add(slot, ErrorBound(self._terms(slot)))
        for multiple, law in self.multiples.pop(slot, []):
            self.add(slot, ErrorBound(self.writer.product(multiple, self._terms(law))))
        return self.bounds[slot]

    def _terms(self, law: int) -> TapeQuantity:
        if law not in self.terms:
            self.terms[law] = TapeQuantity(self.writer.new(TERMS, self.laws[law].name, law), 1.0)
        return self.terms[law]

    def _of_leaf(self, step: EliminationStep, share: TapeQuantity) -> None:
        """Count the losses at a coordinate with two rows, one of them a law, as multiples of that law.

        Inertia alone on the coordinate is left out: it is no larger than the rest of the pivot, or shows there.
        """
        writer, (i,) = self.writer, step.shared
        (law, square), (rest, square_rest) = step.terms[i], step.terms[1 - i]
        size, weight = _times(writer.size(share), square), square_rest / square
        if rest in self.own and rest not in self.bounds and share.factor == square == square_rest == 1.0:
            least = TapeQuantity(writer.new(OPEN, share.name, slots=rest * self.n_laws + law), 1.0)
        else:
            least = writer.rest(_times(share, square))
            if rest in self.own or rest in self.bounds:
                own = self._terms(rest) if rest in self.own else NOTHING
                own = writer.larger(own, self.bounds.get(rest, NOTHING))
                own = writer.product(size, writer.ratio(_times(own, weight), self._terms(law)))
                least = writer.larger(least, own)
        lost = least
        for multiple, before in self.multiples.get(rest, []):
            names, slots = (size.name, multiple.name), before * self.n_laws + law
            factor = size.factor * multiple.factor * weight
            lost = writer.larger(lost, TapeQuantity(writer.new(PASSED, *names, factor, slots), 1.0))
        self.worst = writer.larger(self.worst, lost)
        left = writer.larger(least, writer.product(size, lost))
        self.left = ErrorBound(_times(left, 1.0 / square_rest), law)

    def eliminate(
        self,
        step: EliminationStep,
        links: Sequence[TapeQuantity],
        shares: Mapping[int, TapeQuantity],
        pivot: TapeQuantity,
    ) -> None:
        """Count what the pivot and the shares of an elimination step have lost, for the pairs and outputs to come."""
        writer = self.writer
        self.left = None
        if len(step.terms) == 2 and len(step.shared) == 1:
            (i,) = step.shared
            slot = step.terms[i][0]
            if slot in self.own and slot not in self.bounds and slot not in self.multiples and shares[i].name >= 0:
                self._of_leaf(step, shares[i])
                return
        squares = [square for _, square in step.terms]
        # Relative bound of the pivot, the largest a_k^2 E_k over |S|.
        self.parts = [_times(self._bound(slot), square) for slot, square in step.terms]
        self.all, size = reduce(writer.larger, self.parts, NOTHING), writer.size(pivot)
        self.worst = writer.larger(self.worst, writer.ratio(self.all, size))
        if not step.shared:
            return
        self.shares = [
            writer.size(shares[i]) if i in shares else writer.ratio(writer.size(link), size)
            for i, link in enumerate(links)
        ]
        self.kept = []
        for i, (slot, square) in enumerate(step.terms):
            # 1 - a_i^2 s_i, which of two rows is the share of the other: nothing cancels.
            others = [_times(self.shares[k], squares[k]) for k in range(len(squares)) if k != i]
            if i in shares and len(others) > 1:
                rest = writer.rest(_times(shares[i], square))
            else:
                rest = reduce(writer.more, others, NOTHING)
            self.kept.append(writer.product(rest, self._bound(slot)))
        for i in shares:
            self.worst = writer.larger(self.worst, writer.ratio(self.kept[i], writer.size(links[i])))

    def of_pair(self, pair: EliminatedPair) -> ErrorBound:
        """Bound of the stiffness that an eliminated pair of rows leaves."""
        if self.left is not None:
            return ErrorBound(_times(self.left.size, pair.factor), self.left.law)
        writer, i, j = self.writer, pair.i, pair.j
        # s_j (1 - a_i^2 s_i) E_i and s_i (1 - a_j^2 s_j) E_j, then s_i s_j a_k^2 E_k of all other rows.
        kept = writer.product(self.shares[j], self.kept[i]), writer.product(self.shares[i], self.kept[j])
        bound = reduce(writer.larger, kept, NOTHING)
        others = [part for k, part in enumerate(self.parts) if k not in (i, j)]
        if others:
            worst = reduce(writer.larger, others, NOTHING) if len(self.parts) <= FEW_ROWS else self.all
            both = writer.product(self.shares[i], self.shares[j])
            bound = writer.larger(bound, writer.product(both, worst))
        return ErrorBound(_times(bound, pair.factor))

    def mark(self, output: TapeQuantity) -> None:
        """Mark points at which an output has lost more digits than it may: its error is above MOST_LOST of its size."""
        writer = self.writer
        terms, size = writer.terms(output), writer.size(output)
        if terms == size:
            terms = size = ONE
        error = writer.product(terms, self.worst)
        names = writer.name(error, LEVEL), writer.name(size, LEVEL)
        writer.operations.append(Operation(MARK, 0, *names, error.factor / size.factor))


def _times(quantity: TapeQuantity, factor: float) -> TapeQuantity:
    return TapeQuantity(quantity.name, quantity.factor * factor)

"""Bounds on the rounding errors of an elimination, which its tape works out beside the values.

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

from collections.abc import Iterable, Mapping, Sequence
from functools import reduce
from typing import Any, NamedTuple, TypeAlias

from numpy.typing import NDArray

from torsionnet.solve.dynamic_stiffness.elimination_plan import EliminatedPair, EliminationStep
from torsionnet.solve.dynamic_stiffness.tape import OPEN, PASSED, TERMS, TapeQuantity, Writer

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


class ErrorBound(NamedTuple):
    """Bound on the error of a row stiffness in N m/rad, or as a multiple of the law of a slot."""

    size: TapeQuantity
    law: int = -1


class Losses:
    """Writer of the bounds on rounding errors beside the elimination of laws and loads."""

    def __init__(self, writer: Writer, n_laws: int) -> None:
        self.writer, self.n_laws = writer, n_laws
        self.laws: dict[int, TapeQuantity] = {}
        self.terms: dict[int, TapeQuantity] = {}
        self.own: set[int] = set()
        self.bounds: dict[int, TapeQuantity] = {}
        self.multiples: dict[int, list[ErrorBound]] = {}
        self.worst = TapeQuantity(-1, 1.0)
        self.left: ErrorBound | None = None

    def of_law(self, slot: int, law: TapeQuantity) -> None:
        """Start with the bound of a law in N m/rad, the larger of its dynamic stiffness and its inertia term."""
        self.laws[slot] = law
        self.own.add(slot)

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
                own = self._terms(rest) if rest in self.own else TapeQuantity(-1, 0.0)
                own = writer.larger(own, self.bounds.get(rest, TapeQuantity(-1, 0.0)))
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
        self.parts = [_times(self._bound(slot), square) for slot, square in step.terms]
        self.all, size = self._largest(self.parts), writer.size(pivot)
        self.worst = writer.larger(self.worst, writer.ratio(self.all, size))
        if not step.shared:
            return
        self.shares = [
            writer.size(shares[i]) if i in shares else writer.ratio(writer.size(link), size)
            for i, link in enumerate(links)
        ]
        self.kept = []
        for i, (slot, square) in enumerate(step.terms):
            others = [_times(self.shares[k], squares[k]) for k in range(len(squares)) if k != i]
            if i in shares and len(others) > 1:
                rest = writer.rest(_times(shares[i], square))
            else:
                rest = reduce(writer.more, others, TapeQuantity(-1, 0.0))
            self.kept.append(writer.product(rest, self._bound(slot)))
        for i in shares:
            self.worst = writer.larger(self.worst, writer.ratio(self.kept[i], writer.size(links[i])))

    def of_pair(self, pair: EliminatedPair) -> ErrorBound:
        """Bound of the stiffness that an eliminated pair of rows leaves."""
        if self.left is not None:
            return ErrorBound(_times(self.left.size, pair.factor), self.left.law)
        writer, i, j = self.writer, pair.i, pair.j
        bound = self._largest(
            (writer.product(self.shares[j], self.kept[i]), writer.product(self.shares[i], self.kept[j]))
        )
        others = [part for k, part in enumerate(self.parts) if k not in (i, j)]
        if others:
            worst = self._largest(others) if len(self.parts) <= FEW_ROWS else self.all
            both = writer.product(self.shares[i], self.shares[j])
            bound = writer.larger(bound, writer.product(both, worst))
        return ErrorBound(_times(bound, pair.factor))

    def mark(self, output: TapeQuantity) -> None:
        """Mark points at which an output has lost more digits than it may."""
        terms, size = self.writer.terms(output), self.writer.size(output)
        if terms == size:
            terms = size = TapeQuantity(-1, 1.0)
        self.writer.mark(self.writer.product(terms, self.worst), size)

    def _largest(self, parts: Iterable[TapeQuantity]) -> TapeQuantity:
        return reduce(self.writer.larger, parts, TapeQuantity(-1, 0.0))


def _times(quantity: TapeQuantity, factor: float) -> TapeQuantity:
    return TapeQuantity(quantity.name, quantity.factor * factor)

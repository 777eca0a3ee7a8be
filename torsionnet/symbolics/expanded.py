"""Fully expanded numerator and denominator, in a polynomial ring."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyRing

from torsionnet.errors import UsageError
from torsionnet.symbolics.algebras import S, Terms
from torsionnet.symbolics.network import Stiffness

if TYPE_CHECKING:
    from torsionnet.symbolics.transfer_function import TransferFunction


@dataclass(frozen=True)
class Expanded:
    """Elements of a sympy polynomial ring; converting them to expressions takes far longer than making them.

    Attributes
    ----------
    numerator, denominator : PolyElement
    scale : Rational
        The transfer function is scale * numerator / denominator.
    """

    numerator: Any
    denominator: Any
    scale: Any

    @property
    def terms(self) -> int:
        """How many there are."""
        return len(self.numerator) + len(self.denominator)

    @property
    def expression(self) -> Any:
        """The quotient as a sympy expression."""
        return self.scale * self.numerator.as_expr() / self.denominator.as_expr()


def predicted_terms(function: TransferFunction) -> int:
    """Terms of numerator and denominator, at most; exact where every parameter appears once."""
    return int(sum(function.steps.run(Terms(), [function.numerator, function.denominator])))


def expanded(function: TransferFunction, cap: int) -> Expanded:
    """See :meth:`TransferFunction.expanded`."""
    predicted = predicted_terms(function)
    if predicted > cap:
        msg = (
            f"fully expanded, this transfer function has up to {predicted:,} terms, more than {cap:,}; "
            "use .mechanical or .program, keep(...) fewer parameters, or raise cap="
        )
        raise UsageError(msg)
    algebra = _ring_for(function)
    above, below = function.steps.run(algebra, [function.numerator, function.denominator])
    return Expanded(above, below, sympy.Integer(1))


@dataclass(frozen=True)
class InRing:
    """Elements of a ring with the parameters, s, and inverses and roots of parameters as generators."""

    ring: Any
    generators: Mapping[Any, Any]

    def leaf(self, payload: Any) -> Any:
        if isinstance(payload, Fraction):
            return self.ring(self.ring.domain(payload.numerator, payload.denominator))
        parts = payload.parts if isinstance(payload, Stiffness) else (payload,)
        total = self.ring.zero
        for power, part in enumerate(parts):
            for number, factors in _monomials(part):
                total += self._monomial(number, factors) * self.generators[S] ** power
        return total

    def _monomial(self, number: Any, factors: Mapping[Any, int]) -> Any:
        result = self.ring(self.ring.domain(number.p, number.q))
        for generator, power in factors.items():
            result *= self.generators[generator] ** power
        return result


def _ring_for(function: TransferFunction) -> InRing:
    program = function.steps
    unknowns: dict[Any, None] = {}
    for index in program.needed([function.numerator, function.denominator]):
        operation, *operands = program.steps[index]
        payload = operands[0] if operation == "leaf" else None
        for part in payload.parts if isinstance(payload, Stiffness) else (payload,):
            if isinstance(part, sympy.Basic):
                for _, factors in _monomials(part):
                    unknowns |= dict.fromkeys(factors)
    names = [S, *sorted(unknowns, key=str)]
    ring = PolyRing([sympy.Symbol(str(name)) for name in names], sympy.QQ, lex)
    symbols = dict(zip(ring.symbols, names, strict=True))
    ring = _with_expressions(ring, symbols)
    return InRing(ring, dict(zip(names, ring.gens, strict=True)))


def _with_expressions(ring: Any, symbols: Mapping[Any, Any]) -> Any:
    """The ring with its generators' own expressions as symbols, so that as_expr() gives those."""
    return PolyRing(tuple(symbols[symbol] for symbol in ring.symbols), ring.domain, ring.order)


def _monomials(expression: Any) -> list[tuple[Any, dict[Any, int]]]:
    """(number, {generator: power}) of every term; inverses and roots are generators of their own."""
    found = []
    for term in sympy.Add.make_args(sympy.expand(expression)):
        number, rest = term.as_coeff_Mul()
        if number == 0:
            continue
        factors: dict[Any, int] = {}
        for factor in sympy.Mul.make_args(rest):
            base, power = factor.as_base_exp()
            if factor == 1:
                continue
            if power.is_Integer:
                key, times = (base, int(power)) if power > 0 else (1 / base, -int(power))
            else:
                key, times = factor, 1
            factors[key] = factors.get(key, 0) + times
        found.append((number, factors))
    return found

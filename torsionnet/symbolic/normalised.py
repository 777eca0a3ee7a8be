"""Normalised form of a transfer function, gain and factors 1 + s/omega_n, 1 + 2 zeta s/omega_n + s^2/omega_n^2."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.base.errors import UsageError
from torsionnet.base.program import Program, ProgramNode
from torsionnet.symbolic.algebra.algebras import InPowersOfS, S, in_s, surely_zero
from torsionnet.symbolic.algebra.sparse import Monomials, Sparse, TermCounts, monomials_for
from torsionnet.symbolic.formula_text import for_display, latex, polynomial_text
from torsionnet.symbolic.rational import factor_if_short, to_expression

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_request import SymbolicFraction


MOST_TERMS = 30
"""Largest number of terms of a polynomial in s that is searched for further factors, as longer ones take too long."""

MOST_OPERATIONS, MOST_SYMBOLS = 100, 10
"""Largest numbers of operations and of symbols of a polynomial that sympy factors, as larger ones may take hours."""


@dataclass(frozen=True)
class Factor:
    """Factor of a normalised transfer function, a polynomial in s with constant term 1, raised to a power.

    Attributes
    ----------
    coefficients : tuple
        Of 1, s, s^2, ...; the first is 1.
    power : int
    """

    coefficients: tuple[Any, ...]
    power: int = 1

    @property
    def order(self) -> int:
        return len(self.coefficients) - 1

    @property
    def omega_n(self) -> Any:
        """Corner frequency (first order) or natural frequency (second order) of the factor in rad/s, else None."""
        if self.order == 1:
            return sympy.simplify(1 / self.coefficients[1])
        return sympy.sqrt(sympy.simplify(1 / self.coefficients[2])) if self.order == 2 else None

    @property
    def zeta(self) -> Any:
        """Damping ratio of a factor of second order as an expression, None for other orders."""
        if self.order != 2:
            return None
        # p_2 = 1 / omega_n^2 and p_1 = 2 zeta / omega_n; over their common denominator p_0 the root stays short.
        p_1, p_2 = (sympy.fraction(sympy.together(value)) for value in self.coefficients[1:])
        p_0 = sympy.lcm(p_1[1], p_2[1])
        if not _is_positive(p_0):
            return self.coefficients[1] * self.omega_n / 2
        first, second = (sympy.cancel(value * p_0) for value in self.coefficients[1:])
        return first / (2 * sympy.sqrt(p_0 * second))

    @property
    def expression(self) -> Any:
        return in_s(self.coefficients) ** self.power

    def text(self, values: Mapping[Any, Any]) -> str:
        """Text of the factor, with omega_n and zeta in symbols and, where known, in numbers."""
        power = f"({{}})**{self.power}" if self.power != 1 else "{}"
        if self.order == 1:
            return f"{power.format('1 + s/omega_n')} with omega_n = {_both(self.omega_n, values)} rad/s"
        if self.order == 2:
            form = power.format("1 + 2*zeta*s/omega_n + s**2/omega_n**2")
            return f"{form} with omega_n = {_both(self.omega_n, values)} rad/s, zeta = {_both(self.zeta, values)}"
        return power.format(
            polynomial_text(f"({for_display(value)})" if n else "1" for n, value in enumerate(self.coefficients))
        )


def _both(expression: Any, values: Mapping[Any, Any]) -> str:
    """Text of an expression in symbols, followed by its number where all symbols have values."""
    number = expression.xreplace(dict(values))
    in_figures = f"{float(number):.6g}" if number.is_real and not number.free_symbols else ""
    in_symbols = str(for_display(expression)) if expression.free_symbols or not in_figures else ""
    return " = ".join(part for part in (in_symbols, in_figures) if part)


def _is_positive(expression: Any) -> bool:
    """Whether a sympy expression is positive for all positive values of its symbols."""
    positive = {name: sympy.Dummy(positive=True) for name in expression.free_symbols}
    return bool(expression.xreplace(positive).is_positive)


@dataclass(frozen=True, repr=False)
class Normalised:
    """Normalised transfer function gain * s^power * product of numerator factors / product of denominator factors.

    Attributes
    ----------
    gain : expression
    power : int
    numerator, denominator : tuple of Factor
    values : dict
        Symbol -> value, for the numbers beside the symbols.

    Examples
    --------
    >>> import torsionnet as tn
    >>> H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").normalised
    >>> H.denominator[0].omega_n, H.denominator[0].zeta
    (sqrt(k_2/I_2), (c_2 + c_B)/(2*sqrt(I_2*k_2)))
    >>> print(H.denominator[1].text(H.values))
    1 + s/omega_n with omega_n = k_1/c_1 = 133000 rad/s
    """

    gain: Any
    power: int
    numerator: tuple[Factor, ...]
    denominator: tuple[Factor, ...]
    values: Mapping[Any, Any] = field(default_factory=dict)

    @property
    def expression(self) -> Any:
        """Normalised transfer function as a sympy expression."""
        above = sympy.Mul(*(factor.expression for factor in self.numerator))
        below = sympy.Mul(*(factor.expression for factor in self.denominator))
        return self.gain * S**self.power * above / below

    def __str__(self) -> str:
        lines = [f"gain {_both(self.gain, self.values)}"]
        lines += [f"s**{self.power}"] if self.power else []
        lines += [f"numerator: {factor.text(self.values)}" for factor in self.numerator]
        return "\n".join([*lines, *(f"denominator: {factor.text(self.values)}" for factor in self.denominator)])

    __repr__ = __str__

    def to_latex(self) -> str:
        """LaTeX of the normalised transfer function as one product."""
        return latex(self.expression)

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.to_latex()}$"


def normalised(function: SymbolicFraction) -> Normalised:
    """Normalised form of a transfer function, gain times factors in s that its program and sympy's factoring give."""
    above, below = (_factors(function, node) for node in function.outputs)
    gain, power = factor_if_short(above[0] / below[0]), above[1] - below[1]
    return Normalised(gain, power, above[2], below[2], function.values)


def _factors(function: SymbolicFraction, node: ProgramNode) -> tuple[Any, int, tuple[Factor, ...]]:
    """Gain, power of s, and remaining factors of a transfer function's numerator or denominator."""
    gain, power = sympy.Integer(1), 0
    factors: list[Factor] = []
    for index, times in function.steps.factors(node).items():
        for polynomial, more in _irreducible(function, index):
            lowest = next((i for i, value in enumerate(polynomial) if value != 0), None)
            if lowest is None:
                return sympy.Integer(0), 0, ()
            # p_m s^m (1 + ...): gain and power of s, and a factor that begins with 1.
            power += lowest * more * times
            gain *= polynomial[lowest] ** (more * times)
            if len(polynomial) > lowest + 1:
                scaled = tuple(value / polynomial[lowest] for value in polynomial[lowest:])
                factors.append(Factor(scaled, more * times))
    return gain, power, tuple(factors)


def _irreducible(function: SymbolicFraction, index: int) -> list[tuple[list[Any], int]]:
    """Irreducible factors of one program step, each as coefficients in ascending powers of s and a power."""
    (polynomial,) = function.steps.values_in(InPowersOfS(Program().leaf), [function.steps.at(index)])
    coefficients = [sympy.Integer(0) if surely_zero(value) else to_expression(value) for value in polynomial]
    (count,) = function.steps.values_in(TermCounts(), [function.steps.at(index)])
    whole = in_s(coefficients)
    if count > MOST_TERMS or len(coefficients) < 3 or whole.has(sympy.I):
        return [(coefficients, 1)]
    number, denominator = sympy.fraction(sympy.together(whole))
    if (
        sympy.count_ops(number) > MOST_OPERATIONS
        or len(number.free_symbols) > MOST_SYMBOLS
        or not _factors_at_random(number)
    ):
        return [(coefficients, 1)]
    content, factors = sympy.factor_list(number, S)
    return [([content / denominator], 1), *((_coefficients(factor), power) for factor, power in factors)]


def _factors_at_random(polynomial: Any) -> bool:
    """Whether a polynomial has factors with random numbers for its parameters, without which it is irreducible.

    sympy may take hours to find that out of a polynomial in many symbols.
    """
    symbols = sorted(polynomial.free_symbols - {S}, key=str)
    for seed in range(2):
        draw = random.Random(seed)
        chosen = {symbol: draw.randrange(10**3, 10**4) for symbol in symbols}
        _, factors = sympy.factor_list(polynomial.xreplace(chosen), S)
        # Factors in symbols remain factors with numbers, so that one draw without any decides.
        if sum(power for factor, power in factors if factor != S) < 2:
            return False
    return True


def _coefficients(polynomial: Any) -> list[Any]:
    return [sympy.collect(value, S) for value in sympy.Poly(polynomial, S).all_coeffs()[::-1]]


# Symbolic transfer function with numerator and denominator fully multiplied out.

MOST_PRINTED = 100
"""Largest number of terms of an expanded transfer function printed as text, as of longer ones the number of terms says
more."""


@dataclass(frozen=True, repr=False)
class Expanded:
    """Numerator and denominator of a transfer function multiplied out, as maps from packed monomials to integers.

    Attributes
    ----------
    numerator, denominator : Sparse
    algebra : Monomials
    """

    numerator: Sparse
    denominator: Sparse
    algebra: Monomials

    @property
    def terms(self) -> int:
        """Number of terms in numerator and denominator of the expanded transfer function together."""
        return sum(sum(map(bool, part.terms.values())) for part in (self.numerator, self.denominator))

    def __repr__(self) -> str:
        return f"<Expanded: {self.terms} terms>"

    def __str__(self) -> str:
        return str(for_display(self.expression)) if self.terms <= MOST_PRINTED else repr(self)

    @cached_property
    def expression(self) -> Any:
        """Expanded transfer function, a quotient of sums, as a sympy expression."""
        depth = max(self.numerator.depth, self.denominator.depth)
        above, below = (
            self.algebra.expression(part.at_depth(depth), part.scale**depth)
            for part in (self.numerator, self.denominator)
        )
        return above / below

    def to_ring(self) -> tuple[Any, Any]:
        """Numerator and denominator, multiplied out, as elements of a sympy polynomial ring over the rationals."""
        ring = sympy.polys.rings.PolyRing(self.algebra.generators, sympy.QQ, sympy.polys.orderings.lex)
        return ring(self.algebra.as_dict(self.numerator)), ring(self.algebra.as_dict(self.denominator))


def predicted_terms(function: SymbolicFraction) -> int:
    """Upper bound of the number of terms of a transfer function's numerator and denominator, multiplied out."""
    return int(sum(function.steps.values_in(TermCounts(), function.outputs)))


def expanded(function: SymbolicFraction, cap: int) -> Expanded:
    """Transfer function multiplied out, refused beyond ``cap`` terms; see :meth:`TransferFunction.expanded`."""
    predicted = predicted_terms(function)
    if predicted > cap:
        raise UsageError(
            f"fully expanded, this transfer function has up to {predicted:,} terms, more than {cap:,}; "
            "use .mechanical or .program, keep(...) fewer parameters, or raise cap=",
            kind="too-large",
        )
    program, outputs = function.steps, function.outputs
    algebra = monomials_for(program.payloads(outputs))
    above, below = program.values_in(algebra, outputs)
    return Expanded(above, below, algebra)

"""Polynomial form of a transfer function, numerator and denominator in s with named coefficients."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import sympy
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError, warn_user
from torsionnet.base.expressions import exact
from torsionnet.base.program import Program, ProgramNode
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness
from torsionnet.symbolic.algebra.algebras import (
    InPowersOfS,
    Lengths,
    S,
    SympyForm,
    exact_fraction,
    in_s,
    surely_zero,
)
from torsionnet.symbolic.algebra.delay import InPowersNearRest, RawExpressions, delays_of, refuse_delays
from torsionnet.symbolic.algebra.scaled import NumericValues, Scaled
from torsionnet.symbolic.algebra.sparse import Monomials, Sparse, TermCounts, monomials_for
from torsionnet.symbolic.formula_text import polynomial_latex, polynomial_text, where_text, with_where

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_request import SymbolicFraction


MOST_EXPANDED_COEFFICIENT_TERMS = 60
"""Largest number of terms of a coefficient that is written multiplied out, as longer ones are shorter when nested."""
MOST_TERMS_EXPANDED_WHOLE = 4000
"""Largest number of terms of a transfer function that is multiplied out as a whole first, as more take too long."""


class NamedCoefficients(Protocol):
    """Protocol of the coefficients in s of a transfer function, which can be written as sympy expressions."""

    def expressions(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """Coefficients of 1, s, s^2, ... of numerator and denominator as sympy expressions."""
        ...


@dataclass(frozen=True, repr=False)
class Rational(SympyForm):
    """Transfer function as a quotient of polynomials in s, (b_0 + b_1 s + ...) / (a_0 + a_1 s + ...).

    Attributes
    ----------
    coefficients : NamedCoefficients
        As calculated; expressions are made when first used.
    """

    coefficients: NamedCoefficients

    @cached_property
    def ascending(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """Coefficients of 1, s, s^2, ... in numerator and denominator, as sympy expressions."""
        above, below = (list(_trimmed(part)) for part in self.coefficients.expressions())
        # A drivetrain that turns freely has powers of s above and below.
        while min(len(above), len(below)) > 1 and above[0] == 0 and below[0] == 0:
            del above[0], below[0]
        return tuple(above), tuple(below)

    @property
    def numerator(self) -> tuple[Any, ...]:
        """Coefficients of the numerator as sympy expressions, the highest power of s first, as in python-control."""
        return self.ascending[0][::-1]

    @property
    def denominator(self) -> tuple[Any, ...]:
        """Coefficients of the denominator as sympy expressions, the highest power of s first, as in python-control."""
        return self.ascending[1][::-1]

    @property
    def expression(self) -> Any:
        """Transfer function as a sympy quotient of polynomials in s, with the coefficients written out."""
        above, below = map(in_s, self.ascending)
        return above / below

    def _sympy_(self) -> Any:
        return self.expression

    @cached_property
    def where(self) -> dict[Any, Any]:
        """Sympy expression of each named coefficient (a_i, b_i) that is not zero, by name."""
        named = dict(zip("ba", self.ascending, strict=True))
        return {
            sympy.Symbol(f"{letter}_{power}"): value
            for letter, coefficients in named.items()
            for power, value in enumerate(coefficients)
            if value != 0
        }

    @property
    def named(self) -> Any:
        """Transfer function as a sympy quotient of polynomials in s, in the names of the coefficients."""
        above, below = (in_s(names) for names in self._names)
        return above / below

    @property
    def _names(self) -> tuple[list[Any], list[Any]]:
        """Names of the coefficients of numerator and denominator as symbols, 0 for those that are zero."""
        above, below = (
            [sympy.Symbol(f"{letter}_{power}") if value != 0 else sympy.Integer(0) for power, value in enumerate(part)]
            for letter, part in zip("ba", self.ascending, strict=True)
        )
        return above, below

    def __str__(self) -> str:
        above, below = (polynomial_text(names) for names in self._names)
        return where_text(f"({above})/({below})", self.where)

    __repr__ = __str__

    def to_latex(self) -> str:
        """LaTeX of the transfer function in named coefficients, followed by their definitions."""
        above, below = (polynomial_latex(names) for names in self._names)
        return with_where(rf"\frac{{{above}}}{{{below}}}", self.where)

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.to_latex()}$"


def _trimmed(coefficients: Sequence[Any]) -> tuple[Any, ...]:
    result = list(coefficients) or [sympy.Integer(0)]
    while len(result) > 1 and result[-1] == 0:
        result.pop()
    return tuple(result)


def rational(function: SymbolicFraction) -> Rational:
    """Polynomial form of a transfer function, its coefficients multiplied out if short, else nested."""
    program, outputs = function.steps, function.outputs
    # Short ones are multiplied out as a whole, else only in powers of s, and each coefficient by itself.
    if sum(program.values_in(TermCounts(), outputs)) <= MOST_TERMS_EXPANDED_WHOLE or len(function.free_symbols) <= 6:
        algebra = monomials_for(program.payloads(outputs))
        above, below = program.values_in(algebra, outputs)
        return Rational(ExpandedCoefficients(above, below, algebra))
    return Rational(ProgramCoefficients(*program.values_in(InPowersOfS(Program().leaf), outputs)))


@dataclass(frozen=True)
class ExpandedCoefficients:
    """Coefficients of a transfer function in s, from numerator and denominator multiplied out."""

    above: Sparse
    below: Sparse
    algebra: Monomials

    def expressions(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        # Both over the same scale^depth.
        depth = max(self.above.depth, self.below.depth)
        above, below = (
            tuple(
                self.algebra.expression(terms, part.scale**depth)
                for terms in self.algebra.by_power(Sparse(part.at_depth(depth), depth, part.scale))
            )
            for part in (self.above, self.below)
        )
        return above, below


@dataclass(frozen=True)
class ProgramCoefficients:
    """Coefficients of a transfer function in s as results of a straight-line program."""

    above: Sequence[Any]
    below: Sequence[Any]

    def expressions(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        nodes = [value for value in (*self.above, *self.below) if isinstance(value, ProgramNode)]
        expression_of = dict(zip((node.index for node in nodes), to_expressions(nodes), strict=True))
        above, below = (
            tuple(expression_of[value.index] if isinstance(value, ProgramNode) else sympy.Integer(0) for value in part)
            for part in (self.above, self.below)
        )
        return above, below


def to_expression(node: Any) -> Any:
    """Sympy expression of a program's result, multiplied out if short, else nested."""
    return to_expressions([node])[0]


def to_expressions(nodes: Sequence[ProgramNode]) -> list[Any]:
    """Sympy expressions of several results of one program, each multiplied out if short, else nested."""
    program = nodes[0].program
    counts = program.values_in(TermCounts(), nodes)
    short = [node for node, terms in zip(nodes, counts, strict=True) if terms <= MOST_EXPANDED_COEFFICIENT_TERMS]
    long = [node for node, terms in zip(nodes, counts, strict=True) if terms > MOST_EXPANDED_COEFFICIENT_TERMS]
    algebra = monomials_for(program.payloads(short))
    written = {
        node.index: algebra.expression(part.terms, part.scale**part.depth)
        for node, part in zip(short, program.values_in(algebra, short), strict=True)
    }
    written |= zip((node.index for node in long), program.values_in(RawExpressions(), long), strict=True)
    return [written[node.index] for node in nodes]


def factor_if_short(expression: Any) -> Any:
    """Factored form of a short real expression, a longer or complex one unchanged, as sympy takes too long on it."""
    easy = not expression.has(sympy.I) and sympy.count_ops(expression) <= MOST_EXPANDED_COEFFICIENT_TERMS
    return sympy.factor(expression) if easy else expression


# Limits for the length of formulas, beyond which a form of a transfer function is refused.

MOST_WRITTEN = 20_000
"""Largest number of symbols and numbers, counted as often as they appear, in all coefficients together of a polynomial
form that is written out, as more fill pages and take minutes."""


def require_readable(function: SymbolicFraction) -> None:
    """Raise an error if the coefficients of a transfer function's polynomial form have too many symbols and numbers."""
    outputs = function.outputs
    if sum(function.steps.values_in(TermCounts(), outputs)) <= MOST_TERMS_EXPANDED_WHOLE:
        return
    polynomials = function.steps.values_in(InPowersOfS(Program().leaf), outputs)
    nodes = [value for polynomial in polynomials for value in polynomial if isinstance(value, ProgramNode)]
    leaves = sum(nodes[0].program.values_in(Lengths(), nodes)) if nodes else 0
    if leaves > MOST_WRITTEN:
        raise UsageError(
            f'the coefficients would be written with {leaves:,} elements and numbers; ask for "program"',
            kind="too-large",
        )


def require_short(function: SymbolicFraction, most: int) -> None:
    """Raise an error if a transfer function without continued fraction has over ``most`` leaves in its nested form."""
    leaves = function.nested_leaves if function.continued_fraction is None else 0
    if leaves > most:
        raise UsageError(
            f"with its closed loops written out, this transfer function is a fraction of {leaves:,} elements and "
            'numbers; ask for "program"',
            kind="too-large",
        )


# Numerical evaluation of symbolic transfer functions at frequencies and at rest (zero frequency).

ACCEPTED_RELATIVE_ERROR = 1e-10
"""Relative rounding error up to which a value in double precision is accepted, beyond which it is computed in more
digits."""
PRECISIONS = (40, 80, 160, 320)
"""Numbers of decimal digits that are tried one after the other, until doubling them no longer changes the value."""


def evaluate(function: SymbolicFraction, frequencies: ArrayLike, given: Mapping[Any, Any]) -> FrequencyResponse:
    """Frequency response, values (n_f, 1, 1) in SI, of a symbolic transfer function with numbers for its parameters."""
    f = np.atleast_1d(np.asarray(frequencies, dtype=float))
    if f.ndim != 1 or not np.isfinite(f).all() or (f < 0).any():
        raise UsageError("frequencies must be a list of finite numbers >= 0, in Hz", kind="not-finite")
    values = _complete(function, given)
    result = np.empty(f.shape, dtype=complex)
    moving = f > 0
    if moving.any():
        result[moving] = _values_at_frequencies(function, f[moving], values)
    # 0 Hz is a limit, in which numerator and denominator may both vanish.
    if not moving.all():
        result[~moving] = static_value(function, values)
    if not np.isfinite(result).all():
        warn_user(
            "the transfer function is infinite at some frequency, an undamped resonance; leave that frequency out"
        )
    above, below = function.channels
    return FrequencyResponse(
        f, result[:, None, None], (above,), (below,), function.title, notes=function.notes, model=function.model,
        configuration=function.configuration,
    )  # fmt: skip


def _complete(function: SymbolicFraction, given: Mapping[Any, Any]) -> dict[Any, Any]:
    values = {name: exact_fraction(value) for name, value in function.values.items()}
    values |= {name: exact(value) for name, value in given.items()}
    missing = sorted(str(name) for name in function.free_symbols - set(values))
    if missing:
        raise UsageError(f"give values for {', '.join(missing)}", kind="missing-entry")
    return values


def _tables_in_numbers(function: SymbolicFraction, values: Mapping[Any, Any]) -> dict[Any, DynamicStiffness]:
    """Frequency-dependent stiffnesses (by symbol) with numeric coefficients for given values of the parameters."""
    known = {name: sympy.Rational(value.numerator, value.denominator) for name, value in values.items()}

    def number(coefficient: Any) -> Fraction:
        value = coefficient.xreplace(known)
        return exact_fraction(value) if value.is_Rational else exact(float(value))

    return {
        name: table.with_coefficients(*map(number, table.coefficients)) for name, table in function.used_tables.items()
    }


def _values_at_frequencies(
    function: SymbolicFraction, frequencies: FloatArray, values: Mapping[Any, Any]
) -> ComplexArray:
    """Complex values of a transfer function at frequencies > 0 in Hz, SI, (n_f,), with more digits where needed."""
    omega = 2 * np.pi * frequencies
    known = {name: Scaled.rational(value) for name, value in values.items()}
    known |= {name: Scaled.of(table.kappa(omega)) for name, table in _tables_in_numbers(function, values).items()}
    known |= {sympy.I: Scaled.of(1j)}
    algebra = NumericValues(known, Scaled.rational, Scaled.of(1j * omega))
    above, below = function.steps.values_in(algebra, function.outputs)
    ratio = above / below
    response = np.array(np.broadcast_to(ratio.array(), frequencies.shape))
    # Where terms cancel the bound of rounding grows, and more digits are needed.
    for point in np.flatnonzero(~np.broadcast_to(ratio.relative_error() <= ACCEPTED_RELATIVE_ERROR, frequencies.shape)):
        response[point] = _in_many_digits(function, float(omega[point]), values)
    return response


def _in_many_digits(function: SymbolicFraction, omega: float, values: Mapping[Any, Any]) -> complex:
    """Complex value of a transfer function at one omega in rad/s, with so many digits that more change nothing."""
    import mpmath

    def number(value: Fraction) -> Any:
        return mpmath.mpf(value.numerator) / value.denominator

    tables = _tables_in_numbers(function, values)
    last: complex = complex("nan")
    for digits in PRECISIONS:
        with mpmath.workdps(digits):
            known = {name: number(value) for name, value in values.items()}
            known |= {name: table.in_many_digits(mpmath.mpc(0, omega)) for name, table in tables.items()}
            algebra = NumericValues(known | {sympy.I: mpmath.mpc(0, 1)}, number, mpmath.mpc(0, omega))
            above, below = function.steps.values_in(algebra, function.outputs)
            value = complex(above / below) if below else complex(np.inf)
        if abs(value - last) <= ACCEPTED_RELATIVE_ERROR * abs(value):
            return value
        last = value
    return last


def static_value(function: SymbolicFraction, values: Mapping[Any, Any]) -> complex:
    """Numeric limit of a transfer function at zero frequency, SI, from exact values; may be infinite."""
    known = dict(values)
    for name, table in _tables_in_numbers(function, values).items():
        known[name] = exact(complex(table.kappa(np.zeros(1))[0]).real)
    known = {name: sympy.Rational(value.numerator, value.denominator) for name, value in known.items()}

    def coefficient(payload: Any) -> Any:
        if isinstance(payload, Fraction):
            return sympy.Rational(payload.numerator, payload.denominator)
        return payload.xreplace(known)

    above, below = lowest_terms_in_s(function, coefficient, lambda value: sympy.expand(value) == 0)
    # b s^m / (a s^n) for s -> 0: the lower power decides.
    if above is None or above[0] > below[0]:
        return 0j
    return complex(np.inf) if above[0] < below[0] else complex(above[1] / below[1])


def lowest_terms_in_s(function: SymbolicFraction, coefficient: Any, vanishes: Any) -> tuple[Any, Any]:
    """Power and coefficient of the lowest terms in s of a transfer function's numerator and denominator."""
    limit = 4
    while True:
        algebra = InPowersNearRest(coefficient, limit, delays_of(function.used_tables))
        lowest = [
            first_term(polynomial, vanishes) for polynomial in function.steps.values_in(algebra, function.outputs)
        ]
        # A numerator that vanishes in more powers of s than the program has steps counts as zero.
        if lowest[1] is not None and (lowest[0] is not None or limit > len(function.steps.steps)):
            return lowest[0], lowest[1]
        if limit > 4 * len(function.steps.steps) + 4:
            raise UsageError(
                "numerator and denominator of the transfer function are both zero; choose another output or input",
                kind="zero-reading",
            )
        limit *= 4


def first_term(coefficients: Any, vanishes: Any) -> tuple[int, Any] | None:
    """Power and coefficient of the lowest term of a polynomial that does not vanish, or None if all terms vanish."""
    for power, value in enumerate(coefficients):
        if not vanishes(value):
            return power, value
    return None


# Static gain of a symbolic transfer function, and its leading terms at very low and very high frequency.


def static_gain(function: SymbolicFraction) -> Any:
    """Limit of a symbolic transfer function for s -> 0, a sympy expression, zero or infinity."""
    above, below = lowest_terms_in_s(function, Program().leaf, surely_zero)
    if above is None or above[0] > below[0]:
        return sympy.Integer(0)
    return sympy.oo if above[0] < below[0] else _quotient(above[1], below[1])


def low_frequency(function: SymbolicFraction) -> Any:
    """Leading term of a symbolic transfer function for s -> 0, gain * s^power, a sympy expression."""
    above, below = lowest_terms_in_s(function, Program().leaf, surely_zero)
    return sympy.Integer(0) if above is None else _quotient(above[1], below[1]) * S ** (above[0] - below[0])


def high_frequency(function: SymbolicFraction) -> Any:
    """Leading term of a symbolic transfer function for s -> oo, gain * s^power, a sympy expression."""
    refuse_delays(function.used_tables, "leading term at high frequency")
    algebra = InPowersOfS(Program().leaf)
    above, below = (
        (len(polynomial), first_term(polynomial[::-1], surely_zero))
        for polynomial in function.steps.values_in(algebra, function.outputs)
    )
    if above[1] is None or below[1] is None:
        return sympy.Integer(0)
    # Degrees, less leading coefficients that vanish for all values.
    power = (above[0] - above[1][0]) - (below[0] - below[1][0])
    return _quotient(above[1][1], below[1][1]) * S**power


def _quotient(above: Any, below: Any) -> Any:
    """Quotient of two program nodes as a sympy expression, without common factors."""
    program = (above if isinstance(above, ProgramNode) else below).program
    numerator, denominator = program.reduced(above, below)
    above, below = (to_expression(node) for node in (numerator, denominator))
    return factor_if_short(above / below)

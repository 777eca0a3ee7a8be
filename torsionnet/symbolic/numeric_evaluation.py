"""Numerical evaluation of symbolic transfer functions at frequencies and at rest (zero frequency)."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy
from numpy.typing import ArrayLike

from torsionnet.base.errors import TorsionnetWarning, UsageError
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness
from torsionnet.model.elimination import exact
from torsionnet.symbolic.algebra.algebras import NumericValues, exact_fraction
from torsionnet.symbolic.algebra.delay import InPowersNearRest, delays_of
from torsionnet.symbolic.algebra.scaled import Scaled

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_request import SymbolicFraction

ACCEPTED_RELATIVE_ERROR = 1e-10
"""Relative rounding error up to which a value in double precision is accepted, beyond which it is computed in more
digits."""
PRECISIONS = (40, 80, 160, 320)
"""Numbers of decimal digits that are tried one after the other, until doubling them no longer changes the value."""


def evaluate(function: SymbolicFraction, frequencies: ArrayLike, given: Mapping[Any, Any]) -> FrequencyResponse:
    """Frequency response, values (n_f, 1, 1) in SI, of a symbolic transfer function with numbers for its parameters."""
    f = np.atleast_1d(np.asarray(frequencies, dtype=float))
    if f.ndim != 1 or not np.isfinite(f).all() or (f < 0).any():
        raise UsageError("frequencies must be a list of finite numbers >= 0, in Hz")
    values = _complete(function, given)
    result = np.empty(f.shape, dtype=complex)
    moving = f > 0
    if moving.any():
        result[moving] = _at(function, f[moving], values)
    if not moving.all():
        result[~moving] = static_value(function, values)
    if not np.isfinite(result).all():
        warnings.warn(
            "the transfer function is infinite at some frequency, an undamped resonance; leave that frequency out",
            TorsionnetWarning,
            stacklevel=4,
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
        raise UsageError(f"give values for {', '.join(missing)}")
    return values


def _tables(function: SymbolicFraction, values: Mapping[Any, Any]) -> dict[Any, DynamicStiffness]:
    """Frequency-dependent stiffnesses (by symbol) with numeric coefficients for given values of the parameters."""
    known = {name: sympy.Rational(value.numerator, value.denominator) for name, value in values.items()}

    def number(coefficient: Any) -> Fraction:
        value = coefficient.xreplace(known)
        return exact_fraction(value) if value.is_Rational else exact(float(value))

    return {
        name: table.with_coefficients(*map(number, table.coefficients)) for name, table in function.used_tables.items()
    }


def _at(function: SymbolicFraction, frequencies: FloatArray, values: Mapping[Any, Any]) -> ComplexArray:
    """Complex values of a transfer function at frequencies > 0 in Hz, SI, (n_f,), with more digits where needed."""
    omega = 2 * np.pi * frequencies
    known = {name: Scaled.rational(value) for name, value in values.items()}
    known |= {name: Scaled.of(table.kappa(omega)) for name, table in _tables(function, values).items()}
    known |= {sympy.I: Scaled.of(1j)}
    algebra = NumericValues(known, Scaled.rational, Scaled.of(1j * omega))
    above, below = function.steps.run(algebra, [function.numerator, function.denominator])
    ratio = above / below
    found = np.array(np.broadcast_to(ratio.array(), frequencies.shape))
    for point in np.flatnonzero(~np.broadcast_to(ratio.relative_error() <= ACCEPTED_RELATIVE_ERROR, frequencies.shape)):
        found[point] = _in_many_digits(function, float(omega[point]), values)
    return found


def _in_many_digits(function: SymbolicFraction, omega: float, values: Mapping[Any, Any]) -> complex:
    """Complex value of a transfer function at one omega in rad/s, with so many digits that more change nothing."""
    import mpmath

    def number(value: Fraction) -> Any:
        return mpmath.mpf(value.numerator) / value.denominator

    tables = _tables(function, values)
    last: complex = complex("nan")
    for digits in PRECISIONS:
        with mpmath.workdps(digits):
            known = {name: number(value) for name, value in values.items()}
            known |= {name: table.in_many_digits(mpmath.mpc(0, omega)) for name, table in tables.items()}
            algebra = NumericValues(known | {sympy.I: mpmath.mpc(0, 1)}, number, mpmath.mpc(0, omega))
            above, below = function.steps.run(algebra, [function.numerator, function.denominator])
            value = complex(above / below) if below else complex(np.inf)
        if abs(value - last) <= ACCEPTED_RELATIVE_ERROR * abs(value):
            return value
        last = value
    return last


def static_value(function: SymbolicFraction, values: Mapping[Any, Any]) -> complex:
    """Numeric limit of a transfer function at zero frequency, SI, from exact values; may be infinite."""
    known = dict(values)
    for name, table in _tables(function, values).items():
        known[name] = exact(complex(table.kappa(np.zeros(1))[0]).real)
    known = {name: sympy.Rational(value.numerator, value.denominator) for name, value in known.items()}

    def coefficient(payload: Any) -> Any:
        if isinstance(payload, Fraction):
            return sympy.Rational(payload.numerator, payload.denominator)
        return payload.xreplace(known)

    above, below = lowest_terms_in_s(function, coefficient, lambda value: sympy.expand(value) == 0)
    if above is None or above[0] > below[0]:
        return 0j
    return complex(np.inf) if above[0] < below[0] else complex(above[1] / below[1])


def lowest_terms_in_s(function: SymbolicFraction, coefficient: Any, vanishes: Any) -> tuple[Any, Any]:
    """Power and coefficient of the lowest terms in s of a transfer function's numerator and denominator."""
    limit = 4
    while True:
        algebra = InPowersNearRest(coefficient, limit, delays_of(function.used_tables))
        found = [
            first_term(polynomial.coefficients, vanishes)
            for polynomial in function.steps.run(algebra, [function.numerator, function.denominator])
        ]
        if found[1] is not None and (found[0] is not None or limit > len(function.steps.steps)):
            return found[0], found[1]
        if limit > 4 * len(function.steps.steps) + 4:
            raise UsageError(
                "numerator and denominator of the transfer function are both zero; choose another output or input"
            )
        limit *= 4


def first_term(coefficients: Any, vanishes: Any) -> tuple[int, Any] | None:
    """Power and coefficient of the lowest term of a polynomial that does not vanish, or None if all terms vanish."""
    for power, value in enumerate(coefficients):
        if not vanishes(value):
            return power, value
    return None

"""Symbolic delays e^(-s tau), kept as functions of omega since they are no polynomials in s."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import sympy

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.symbolic import OMEGA
from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness
from torsionnet.symbolic.algebra.algebras import Expressions, InPowersOfS

if TYPE_CHECKING:
    from torsionnet.model.element_base.dynamic_stiffness import Complexes, Floats


@dataclass(frozen=True)
class Delay(DynamicStiffness):
    """Delay factor e^(-s time) of an action as a function of frequency, without unit, time in s.

    Examples
    --------
    >>> import numpy as np
    >>> Delay(0.5).kappa(np.array([np.pi])).round(12)
    array([0.-1.j])
    """

    time: Any

    @property
    def coefficients(self) -> tuple[Any, ...]:
        return (self.time,)

    def with_coefficients(self, *coefficients: Any) -> Self:
        return type(self)(*coefficients)

    def kappa(self, omega: Floats) -> Complexes:
        import numpy as np

        return np.asarray(np.exp(-1j * float(self.time) * omega), dtype=complex)

    def kappa_rate(self, omega: float) -> complex:
        import cmath

        time = float(self.time)
        return -1j * time * cmath.exp(-1j * time * omega)

    @property
    def is_passive(self) -> bool:
        return False

    @property
    def holds_at_rest(self) -> bool:
        return True

    def in_many_digits(self, s: Any) -> Any:
        import mpmath

        return mpmath.exp(-s * mpmath.mpf(self.time.numerator) / self.time.denominator)

    def formula(self, omega: Any) -> Any:
        return sympy.exp(-sympy.I * omega * self.time)


def delay_symbol(owner: str) -> Any:
    """Sympy function ``delay_NAME(omega)`` that stands for the delay of an element's action."""
    return sympy.Function(f"delay_{owner}")(OMEGA)


def delays_of(tables: Mapping[Any, DynamicStiffness]) -> dict[Any, Delay]:
    """Delays (:class:`Delay`) among the functions of frequency of a drivetrain, by the symbols that stand for them."""
    return {name: table for name, table in tables.items() if isinstance(table, Delay)}


def refuse_delays(tables: Mapping[Any, DynamicStiffness], what: str) -> None:
    """Raise an error where a form that only quotients of polynomials have is asked of a transfer function with delays.

    Raises
    ------
    UsageError
        There is a delay.
    """
    delays = delays_of(tables)
    if delays:
        names = ", ".join(name.func.__name__.removeprefix("delay_") for name in delays)
        text = f"the delay of {names} is no quotient of polynomials in s, so there is no {what}"
        raise UsageError(f"{text}; evaluate() and modes() have the delay in them", kind="unsupported-law")


@dataclass(frozen=True)
class InPowersNearRest(InPowersOfS):
    """Algebra of power series in s for slow motions, in which a delay tau is 1 - s tau + ..."""

    delays: Mapping[Any, Delay] | None = None

    def leaf(self, payload: Any) -> tuple[Any, ...]:
        delay = (self.delays or {}).get(payload) if isinstance(payload, sympy.Basic) else None
        if delay is None:
            return super().leaf(payload)
        # e^(-s tau) = sum of (-tau)^n s^n / n!
        terms = [(-delay.time) ** power / sympy.factorial(power) for power in range(self.limit or 1)]
        return tuple(self.coefficient(term) for term in terms)


class RawExpressions(Expressions):
    """Algebra of sympy expressions whose terms are not sorted, for results too long to be sorted."""

    def add(self, left: Any, right: Any) -> Any:
        return _joined(sympy.Add, left, right)

    def multiply(self, left: Any, right: Any) -> Any:
        return _joined(sympy.Mul, left, right)


def _joined(operation: Any, left: Any, right: Any) -> Any:
    if left.is_Number or right.is_Number:
        return operation(
            left, right, evaluate=bool(left.is_Number and right.is_Number) or _is_neutral(operation, left, right)
        )
    return operation._from_args([*operation.make_args(left), *operation.make_args(right)])  # noqa: SLF001


def _is_neutral(operation: Any, left: Any, right: Any) -> bool:
    return operation.identity in (left, right)

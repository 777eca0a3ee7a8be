"""Base class of entries with several quantities of different kinds."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from torsionnet.core.entries.spec import Spec, Stored_co
from torsionnet.core.errors import Path
from torsionnet.core.expressions import Expression, Number
from torsionnet.model.element_base.laws import Values


class QuantityGroup(Spec[Stored_co]):
    """Base class of entries with several quantities of different kinds, as the stages of a spring."""

    def quantities(self, value: Any) -> Iterator[tuple[Path, Spec[object], Expression, str]]:
        """Path, specification, expression and dimension name of every quantity in the stored value."""
        raise NotImplementedError

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
        return tuple((path, expression, dimension) for path, _, expression, dimension in self.quantities(value))


def exact_or_value(expression: Expression, value: Values) -> Any:
    """Value of a quantity: an exact fraction of a plain number, else a number of the algebra of ``value``."""
    return expression.value if isinstance(expression, Number) else value(expression)


def shown(expression: Expression | None, number: Any) -> str:
    """Text of a quantity for a message: as it is written, with the value of an expression behind it.

    >>> from torsionnet.core.expressions import Name
    >>> shown(Name("T_1"), Fraction(5, 2))
    'T_1 = 2.5'
    """
    plain = f"{float(number):g}" if isinstance(number, int | float | Fraction) else "one of several values"
    if expression is None:
        return plain
    return f"{expression} = {plain}" if expression.names else str(expression)

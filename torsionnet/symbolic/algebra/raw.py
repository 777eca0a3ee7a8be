"""Sympy expressions built without sorting their terms, for results too long to be sorted."""

from __future__ import annotations

from typing import Any

import sympy

from torsionnet.symbolic.algebra.algebras import Expressions


class Raw:
    """Sympy expression under construction, whose terms are not sorted."""

    __slots__ = ("expression",)

    def __init__(self, expression: Any) -> None:
        self.expression = expression

    def __add__(self, other: Raw) -> Raw:
        return Raw(_joined(sympy.Add, self.expression, other.expression))

    def __mul__(self, other: Raw) -> Raw:
        return Raw(_joined(sympy.Mul, self.expression, other.expression))


def _joined(operation: Any, left: Any, right: Any) -> Any:
    if left.is_Number or right.is_Number:
        return operation(
            left, right, evaluate=bool(left.is_Number and right.is_Number) or _is_neutral(operation, left, right)
        )
    return operation._from_args([*operation.make_args(left), *operation.make_args(right)])  # noqa: SLF001


def _is_neutral(operation: Any, left: Any, right: Any) -> bool:
    return operation.identity in (left, right)


class RawExpressions(Expressions):
    """Algebra of sympy expressions with unsorted terms; see :class:`Raw`."""

    def leaf(self, payload: Any) -> Raw:
        return Raw(super().leaf(payload))

"""Algebras that record a program anew: with its derivatives, or with other expressions for its symbols."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

import sympy

from torsionnet.base.program import Program, ProgramAlgebra, ProgramNode
from torsionnet.symbolic.algebra.network import Stiffness

NodePair: TypeAlias = tuple[ProgramNode, ProgramNode]
"""Result of a program step, and its derivative to one symbol."""


@dataclass(frozen=True)
class Derivatives(ProgramAlgebra):
    """Algebra that records a program's results together with their derivatives with respect to one symbol."""

    program: Program
    symbol: Any

    def leaf(self, payload: Any) -> NodePair:
        return self.program.leaf(payload), self.program.leaf(self._slope(payload))

    def add(self, left: NodePair, right: NodePair) -> NodePair:
        return left[0] + right[0], left[1] + right[1]

    def multiply(self, left: NodePair, right: NodePair) -> NodePair:
        # (a b)' = a' b + a b'
        return left[0] * right[0], left[1] * right[0] + left[0] * right[1]

    def _slope(self, payload: Any) -> Any:
        if isinstance(payload, Fraction):
            return 0
        if not isinstance(payload, Stiffness):
            return sympy.diff(payload, self.symbol)
        slopes = [sympy.diff(part, self.symbol) for part in payload.parts]
        return Stiffness(*slopes) if any(slopes) else 0


@dataclass(frozen=True)
class SubstitutedLeaves(ProgramAlgebra):
    """Algebra that copies a program and substitutes expressions for symbols in its inputs (leaves)."""

    program: Program
    change: Callable[[Any], Any]

    def leaf(self, payload: Any) -> ProgramNode:
        if isinstance(payload, Fraction):
            return self.program.leaf(payload)
        if isinstance(payload, Stiffness):
            parts = [self.change(part) for part in payload.parts]
            return self.program.leaf(Stiffness(*parts) if any(part != 0 for part in parts) else 0)
        return self.program.leaf(self.change(payload))

"""Transfer function of one output over one input in symbols, numerator and denominator as one program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy

from torsionnet.response import Channel
from torsionnet.symbolic.algebra.algebras import Expressions, Lengths
from torsionnet.symbolic.algebra.network import Stiffness
from torsionnet.symbolic.algebra.program import Program, ProgramNode
from torsionnet.symbolic.continued_fraction import continued_fraction_expression
from torsionnet.symbolic.symbolic_request import SymbolicRequest


@dataclass(frozen=True, eq=False)
class SymbolicFraction:
    """Numerator and denominator of a transfer function, exact, in the model's own symbols.

    Attributes
    ----------
    channels : tuple of Channel
        Output and input, with their units.
    numerator, denominator : ProgramNode
        Results of one program, common factors left out.
    values : dict
        Symbol -> exact rational value in the model.
    request : SymbolicRequest or None
        The mechanism behind, for the continued fraction.
    tables : dict
        What depends on frequency by the symbolic function that stands for it, kappa(omega).
    notes : tuple of str
    """

    channels: tuple[Channel, Channel]
    numerator: ProgramNode
    denominator: ProgramNode
    values: Mapping[Any, Any]
    request: SymbolicRequest | None = None
    tables: Mapping[Any, Any] = field(default_factory=dict)
    title: str = ""
    notes: tuple[str, ...] = ()
    conditions: tuple[Any, ...] = ()

    @property
    def steps(self) -> Program:
        """Straight-line program whose steps calculate numerator and denominator."""
        return self.numerator.program

    @cached_property
    def free_symbols(self) -> frozenset[Any]:
        """Parameters that appear in the transfer function, as sympy symbols."""
        found = {symbol for leaf in self._leaves for symbol in leaf.free_symbols} - {sympy.Symbol("omega")}
        coefficients = (one for table in self.used_tables.values() for one in table.coefficients)
        return frozenset(found.union(*(coefficient.free_symbols for coefficient in coefficients)))

    @cached_property
    def used_tables(self) -> Mapping[Any, Any]:
        """Frequency-dependent stiffnesses in the transfer function, by their symbol kappa(omega)."""
        found = {function for leaf in self._leaves for function in leaf.atoms(sympy.core.function.AppliedUndef)}
        return {name: table for name, table in self.tables.items() if name in found}

    @property
    def formulas(self) -> Mapping[Any, Any]:
        """Formula of each continuous shaft's kappa(omega) in omega and parameters, a sympy expression in N m/rad."""
        omega = sympy.Symbol("omega")
        found = {name: table.formula(omega) for name, table in self.used_tables.items()}
        return {name: formula for name, formula in found.items() if formula is not None}

    @cached_property
    def _leaves(self) -> tuple[Any, ...]:
        """Sympy expressions in the leaves of the transfer function's program."""
        needed = (self.steps.steps[index] for index in self.steps.needed([self.numerator, self.denominator]))
        payloads = [step[1] for step in needed if step[0] == "leaf"]
        parts = [part for one in payloads for part in (one.parts if isinstance(one, Stiffness) else (one,))]
        return tuple(dict.fromkeys(part for part in parts if isinstance(part, sympy.Basic)))

    @cached_property
    def nested(self) -> Any:
        """Transfer function as a nested sympy expression, numerator over denominator as calculated."""
        above, below = self.steps.run(Expressions(), [self.numerator, self.denominator])
        return above / below

    @cached_property
    def nested_leaves(self) -> int:
        """Number of leaves (stiffnesses, ratios, numbers) of the nested form, repeated ones counted again."""
        above, below = self.steps.run(Lengths(), [self.numerator, self.denominator])
        return int(above.leaves + below.leaves)

    @cached_property
    def continued_fraction(self) -> Any:
        """Transfer function as a continued fraction in sympy, or None where there are closed loops."""
        return None if self.request is None else continued_fraction_expression(self.request)

    @property
    def mechanical(self) -> Any:
        """Transfer function as a continued fraction in sympy, nested instead where there are closed loops."""
        return self.nested if self.continued_fraction is None else self.continued_fraction

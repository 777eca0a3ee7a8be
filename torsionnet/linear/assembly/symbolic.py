"""Equations of motion of a drivetrain as sympy matrices in the model's own symbols.

M, C, K come from the same elements and the same elimination as the numbers, recorded over the parameters. Terms are
collected by the ratios they are reflected with, so that ``k_1 + k_2/tau**2`` stays as an engineer writes it and
``I_MT + (I_1 - I_MT)`` collapses to ``I_1``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Name, exact
from torsionnet.base.program import ProgramAlgebra, ProgramNode, Record
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.model.elements import Action, Law, Row, Values
from torsionnet.model.kinematics import Kinematics, kinematics_on, solve_kinematics

if TYPE_CHECKING:
    from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness


@lru_cache(maxsize=1024)
def rational(number: Any) -> Any:
    """Sympy rational equal to a number, exact, never a sympy Float."""
    value = exact(number)
    return sympy.Rational(value.numerator, value.denominator)


class Symbols(ProgramAlgebra):
    """Algebra of sympy expressions in the symbols of the parameters, for recorded laws and rows."""

    def leaf(self, payload: Any) -> Any:
        if isinstance(payload, Fraction):
            return rational(payload)
        return sympy.Symbol(payload.name) if isinstance(payload, Name) else sympy.pi

    def root(self, argument: Any) -> Any:
        return sympy.sqrt(argument)


@dataclass(eq=False)
class SymbolRecord(Record):
    """Record whose numbers are decided upon by their exact values, and written in symbols.

    Examples
    --------
    >>> record = SymbolRecord()
    >>> k = record.parameter("k", 3)
    >>> symbol_of(1 / (2 * k - 1) ** 2), symbol_of(0.5)
    ((2*k - 1)**(-2), 1/2)
    """

    symbols: dict[int, Any] = field(default_factory=dict)

    def symbol(self, node: ProgramNode) -> Any:
        """Sympy expression of a recorded number."""
        return (
            self.symbols[node.index]
            if node.index in self.symbols
            else self.values_in(Symbols(), [node], self.symbols)[0]
        )


def symbol_of(number: Any) -> Any:
    """Sympy expression of a number on a :class:`SymbolRecord`, or of a plain number."""
    if not isinstance(number, ProgramNode):
        return rational(number)
    record: Any = number.program
    return record.symbol(number)


def symbolic_values(definitions: Mapping[str, Any], values: Mapping[str, Any]) -> Values:
    """Evaluator that records on a :class:`SymbolRecord`; a derived parameter has its expression in the basic ones."""
    record = SymbolRecord()
    algebra = record.algebra
    symbols: dict[str, Any] = {}
    for name in values:
        expression = definitions[name].value
        # A parameter that others define keeps their symbols; one with a number of its own becomes a symbol.
        derived = expression.names
        symbols[name] = expression.evaluate(symbols, algebra) if derived else record.parameter(name, values[name])
    return Values(symbols, record.algebra)


OMEGA = sympy.Symbol("omega")
"""Sympy symbol of the circular frequency in rad/s, on which tables and delays depend."""
MOST_TERMS = 1000
"""Largest number of terms up to which an entry of a matrix is multiplied out, as longer ones are not read term by
term."""


@dataclass(frozen=True, eq=False)
class SymbolicAction:
    """Law of an action in symbols, whose torque N(s)/E(s) e^(-s delay) (sensed q) drives a row; powers of s ascend."""

    owner: str
    row: tuple[Any, ...]
    sensed: tuple[Any, ...]
    numerator: tuple[Any, ...]
    denominator: tuple[Any, ...]
    delay: Any

    def law(self, s: Any) -> Any:
        """Transfer function torque / sensed angle of the action in N m/rad, a sympy expression of s."""
        above, below = (
            sum((value * s**power for power, value in enumerate(part)), start=sympy.Integer(0))
            for part in (self.numerator, self.denominator)
        )
        return above / below * sympy.exp(-s * self.delay)

    def equation(self, coordinates: Sequence[str]) -> str:
        """Equation of the action's torque over the angles of the coordinates, as text in sympy's notation."""
        terms = [_signed(value, f"theta_{name}") for value, name in zip(self.sensed, coordinates, strict=True) if value]
        return f"T_{self.owner} = {self.law(sympy.Symbol('s'))} ({_joined(terms)})"


@dataclass(frozen=True, eq=False)
class SymbolicMatrices:
    """Matrices of the equations of motion (M s^2 + C s + K + j H) q + kappa(omega) terms = B u in symbols.

    Attributes
    ----------
    M, C, K : (n_q, n_q) sympy matrices
        Inertia, viscous damping and stiffness.
    H : (n_q, n_q) sympy matrix
        Hysteretic damping k eta.
    tables : (n_q, n_q) sympy matrix
        Tabulated dynamic stiffness, as functions ``kappa_NAME(omega)``.
    coordinates, nodes, inputs : tuple of str
    T : (n_nodes, n_q) sympy matrix
        Angles of all nodes from the coordinates.
    B : (n_q, n_inputs) sympy matrix
        Generalised torques of unit torque inputs.
    values : dict
        Symbol -> exact rational value.
    conditions : tuple
        Expressions of symbols that are zero for the values and were taken to be zero always.
    actions : tuple of SymbolicAction
        Torques that follow the motion; no part of the matrices.
    """

    M: sympy.Matrix
    C: sympy.Matrix
    K: sympy.Matrix
    H: sympy.Matrix
    tables: sympy.Matrix
    coordinates: tuple[str, ...]
    nodes: tuple[str, ...]
    inputs: tuple[str, ...]
    T: sympy.Matrix
    B: sympy.Matrix
    values: dict[Any, Any]
    conditions: tuple[Any, ...] = field(default=())
    actions: tuple[SymbolicAction, ...] = field(default=())

    def dynamic_stiffness(self, s: Any) -> sympy.Matrix:
        """Symbolic dynamic stiffness M s^2 + C s + K + j H + tables, less the actions, (n_q, n_q), N m/rad."""
        passive = self.M * s**2 + self.C * s + self.K + sympy.I * self.H + self.tables
        for action in self.actions:
            # An action drives its row by (N/E) e^(-s delay) times the row it senses: a dyad that need not be symmetric.
            passive -= action.law(s) * sympy.Matrix(action.row) * sympy.Matrix([action.sensed])
        return passive

    def equations(self) -> tuple[str, ...]:
        """Equations of motion as text, one string for each coordinate, with ' for d/dt."""
        return tuple(self._equation(row) for row in range(len(self.coordinates)))

    def laws(self) -> tuple[str, ...]:
        """Equations of the torques of all actions as text, in the Laplace domain, one string for each action."""
        return tuple(action.equation(self.coordinates) for action in self.actions)

    def _equation(self, row: int) -> str:
        terms = []
        # One row of (M s^2 + C s + K + j H) q + kappa(omega) terms = B u, term by term.
        parts = ((self.M, "''"), (self.C, "'"), (self.K + sympy.I * self.H + self.tables, ""))
        for matrix, dashes in parts:
            for column, name in enumerate(self.coordinates):
                if matrix[row, column] != 0:
                    terms.append(_signed(matrix[row, column], f"theta_{name}{dashes}"))
        loads = [_signed(self.B[row, i], name) for i, name in enumerate(self.inputs) if self.B[row, i] != 0]
        loads += [_signed(action.row[row], f"T_{action.owner}") for action in self.actions if action.row[row] != 0]
        return f"{_joined(terms)} = {_joined(loads)}"


def _signed(coefficient: Any, name: str) -> str:
    negative = bool(coefficient.could_extract_minus_sign())
    shown = -coefficient if negative else coefficient
    text = str(shown)
    factor = "" if shown == 1 else f"({text}) " if shown.is_Add else f"{text} "
    return f"{'-' if negative else '+'} {factor}{name}"


def _joined(terms: list[str]) -> str:
    text = " ".join(terms)
    return text.removeprefix("+ ") or "0"


def symbolic_matrices(drivetrain: AssembledModel, referred_to: Sequence[str] = ()) -> SymbolicMatrices:
    """Matrices of the equations of motion of a drivetrain in symbols; see :meth:`torsionnet.Drivetrain.symbolic`.

    Raises
    ------
    UsageError
        ``referred_to`` names unknown nodes or nodes that cannot be coordinates together, or an input imposes an angle.
    """
    imposed = [name for name, channel in drivetrain.inputs.items() if channel.quantity == "angle"]
    if imposed:
        raise UsageError(
            f"equations with imposed angles are not written out; leave out the input(s) {', '.join(imposed)}",
            kind="unsupported-law",
        )
    definition = drivetrain.definition
    names = [referred_to] if isinstance(referred_to, str) else list(referred_to)
    values = symbolic_values(definition.parameters, drivetrain.exact_values)
    # The exact values choose pivots and coordinates; the symbols then take the same steps.
    kinematics = solve_kinematics(definition, Values(drivetrain.exact_values), names)
    ratios = _Ratios(kinematics, values, definition, names)
    laws = [(owner, law, ratios.reduced(law.row)) for owner, law in ratios.kinematics.laws if law.acts]
    coordinates = kinematics.coordinates
    sums = {key: _Sum(coordinates) for key in ("M", "C", "K", "H", "tables")}
    # M, C, K, H and tables are sums of coefficient times b b^T, where b is the row of a law over the coordinates.
    for owner, law, row in laws:
        for key, coefficient in _coefficients(owner, law).items():
            sums[key].add(coefficient, row)
    nodes = [ratios.reduced({node: 1}) for node in kinematics.nodes]
    present = set(kinematics.nodes)
    inputs = tuple(name for name, channel in drivetrain.inputs.items() if set(channel.nodes) <= present)
    loads = [ratios.reduced(drivetrain.inputs[name].row) for name in inputs]
    return SymbolicMatrices(
        **{key: total.matrix() for key, total in sums.items()},
        coordinates=coordinates,
        nodes=kinematics.nodes,
        inputs=inputs,
        T=_matrix(nodes, coordinates),
        B=_matrix(loads, coordinates).T,
        values={sympy.Symbol(name): rational(value) for name, value in drivetrain.exact_values.items()},
        conditions=ratios.conditions(),
        actions=tuple(
            _action(name, action, ratios, coordinates)
            for name, (_, action) in zip(_numbered(ratios.kinematics.actions), ratios.kinematics.actions, strict=True)
        ),
    )


def _numbered(actions: Sequence[tuple[str, Action]]) -> list[str]:
    """Names of the actions' torques, each that of its element, with a number where an element has several actions."""
    owners = [owner for owner, _ in actions]
    return [
        owner if owners.count(owner) == 1 else f"{owner}_{owners[: place + 1].count(owner)}"
        for place, owner in enumerate(owners)
    ]


def _action(owner: str, action: Action, ratios: _Ratios, coordinates: Sequence[str]) -> SymbolicAction:
    row, sensed = (_matrix([ratios.reduced(part)], coordinates) for part in (action.row, action.sensed))
    above, below = (tuple(map(symbol_of, part)) for part in (action.numerator, action.denominator))
    return SymbolicAction(owner, tuple(row), tuple(sensed), above, below, symbol_of(action.delay))


class _Ratios:
    """Kinematics of a drivetrain solved in symbols, with the pivots that the exact values choose."""

    def __init__(self, plain: Kinematics, values: Values, definition: Any, names: Sequence[str]) -> None:
        self.kinematics, self.number = kinematics_on(values, plain, definition, names), values.algebra.number

    def reduced(self, row: Row) -> Row:
        return self.kinematics.reduction.reduced({node: self.number(value) for node, value in row.items()})

    def conditions(self) -> tuple[Any, ...]:
        """Expressions that are zero for the parameter values but not as symbols, from constraints that dropped out."""
        left_over = []
        # A constraint that dropped out as a sum of others holds only if what is left of it vanishes.
        rows = [row for _, row in self.kinematics.constraints]
        for index in self.kinematics.reduction.redundant:
            for coefficient in _uncancelled(rows[index], self.kinematics.reduction.solved).values():
                expression = sympy.numer(sympy.together(sympy.expand(coefficient)))
                if expression != 0:
                    left_over.append(sympy.factor(expression))
        return tuple(left_over)


def _uncancelled(row: Row, solved: Mapping[Any, Row]) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for node, coefficient in row.items():
        for free, factor in solved.get(node, {node: 1}).items():
            result[free] = result.get(free, 0) + symbol_of(coefficient) * symbol_of(factor)
    return result


def law_parts(owner: str, law: Law) -> tuple[Any, Any, Any]:
    """Coefficients of 1, s and s^2 in a law's dynamic stiffness, in symbols; the first holds hysteresis and tables."""
    parts = {key: sympy.Integer(0) for key in ("K", "C", "M", "H", "tables")} | _coefficients(owner, law)
    return parts["K"] + sympy.I * parts["H"] + parts["tables"], parts["C"], parts["M"]


def _coefficients(owner: str, law: Law) -> dict[str, Any]:
    table = stiffness_symbol(owner, law.table) if law.table is not None else 0
    # kappa = J s^2 + c s + k (1 + j eta) + table(omega)
    hysteretic = law.stiffness * law.loss_factor
    given = {"M": law.inertia, "C": law.damping, "K": law.stiffness, "H": hysteretic}
    symbols = {key: symbol_of(value) for key, value in given.items()}
    return {key: value for key, value in (symbols | {"tables": table}).items() if value != 0}


def stiffness_symbol(owner: str, table: DynamicStiffness) -> Any:
    """Sympy function ``kappa_NAME(omega)`` that stands for a frequency-dependent stiffness."""
    return sympy.Function("_".join(["kappa", owner, *([table.label] if table.label else [])]))(OMEGA)


def with_symbols(table: DynamicStiffness) -> DynamicStiffness:
    """Copy of a frequency-dependent stiffness with sympy expressions for the values of its coefficients."""
    return table.with_coefficients(*map(symbol_of, table.coefficients))


class _Sum:
    """Symmetric matrix of inertias, dampings or stiffnesses in symbols, summed up law by law.

    Each entry is collected by the ratio that its terms are reflected with.
    """

    def __init__(self, coordinates: Sequence[str]) -> None:
        self.index = {name: number for number, name in enumerate(coordinates)}
        self.entries: dict[tuple[int, int], dict[Any, Any]] = {}

    def add(self, coefficient: Any, row: Row) -> None:
        used = [(self.index[name], symbol_of(factor)) for name, factor in row.items() if name in self.index]
        # The dyad b b^T, each entry b_i b_j sorted by its ratio of symbols.
        for i, left in used:
            for j, right in used:
                ratio, number = _ratio_and_number(left * right)
                groups = self.entries.setdefault((i, j), {})
                groups[ratio] = groups.get(ratio, 0) + number * coefficient

    def matrix(self) -> sympy.Matrix:
        size = len(self.index)
        result = sympy.zeros(size, size)
        for place, groups in self.entries.items():
            result[place] = collect_by_ratio(groups)
        return result


def collect_by_ratio(groups: Mapping[Any, Any]) -> Any:
    """Sympy sum of ratio * total over groups of terms, each total multiplied out by itself."""
    if not groups:
        return sympy.Integer(0)
    if list(groups) == [1]:
        return _expanded(groups[1])
    return sympy.Add(*(ratio * _expanded(total) for ratio, total in groups.items()))


def _expanded(total: Any) -> Any:
    """Sympy sum with its products multiplied out, unless that would take more terms than anyone reads."""
    return total if total.is_Atom or _terms(total) > MOST_TERMS else sympy.expand(total)


def _terms(expression: Any) -> int:
    """Upper bound of the number of terms of a sympy expression when multiplied out."""
    if expression.is_Add:
        return sum(map(_terms, expression.args))
    if expression.is_Mul:
        return math.prod(map(_terms, expression.args))
    if expression.is_Pow and expression.exp.is_Integer:
        power: int = _terms(expression.base) ** abs(int(expression.exp))
        return power
    return 1


def _ratio_and_number(product: Any) -> tuple[Any, Any]:
    number, ratio = product.as_coeff_Mul()
    return ratio, number


def _matrix(rows: Sequence[Row], coordinates: Sequence[str]) -> sympy.Matrix:
    return sympy.Matrix(
        len(rows),
        len(coordinates),
        [symbol_of(row[name]) if name in row else 0 for row in rows for name in coordinates],
    )

"""Equations of motion of a drivetrain before its constraints are solved, with derivatives to chosen parameters.

All node angles theta and the torques lambda of all rigid conditions are unknowns,

    [ D(s)  A^T ] [ theta  ]   [ B u ]
    [ A     0   ] [ lambda ] = [ x   ]        D(s) = sum_i kappa_i(s) a_i a_i^T

so a parameter may sit in a law, in a ratio, or in both, and its derivative stays a sum over laws and conditions.

Laws of a drivetrain at values of its unknowns, about the operating point that it has at these values. Torques,
stiffnesses and ratios move the states of laws of motion, and with these the slopes of smooth curves. The derivative of
a stiffness or damping there is the one along the solution of the balance: differences of balances give it, as that of a
straight piece, which does not move within the piece, is exact without them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.base.expressions import FLOAT, exact
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.sensitivity.unknowns import DUALS, Dual, Unknowns, gradient_of, value_of
from torsionnet.model.balanced_state import BalancedState
from torsionnet.model.definition import Definition, Tangents
from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness
from torsionnet.model.element_base.element import TangentLaws
from torsionnet.model.elements import Action, Element, Law, MotionLaw, Row, Values
from torsionnet.model.elimination import reduce_rows
from torsionnet.model.kinematics import OwnedPart, constraints_of, imposed_rows, owned_parts
from torsionnet.model.law_network import following_elements
from torsionnet.model.motion_laws.piece_curve import PieceCurve

# Laws of a drivetrain at values of its unknowns, about the operating point that it has at these values.

STEPS = (1e-3, 1e-4, 1e-5)
"""Shares of a parameter by which it is moved: the first has the least error, the others serve beside a corner."""
AGREEMENT = 1e-3
"""Share by which differences over one and over two steps may differ: far more than curvature, far less than a corner
between them makes."""
ROUNDING = 1e-9
"""Share of a coefficient, over the share of the step, that rounding in balances may leave in differences."""


def parts_at(unknowns: Unknowns, at: Sequence[float]) -> tuple[OwnedPart, ...]:
    """Laws, constraints and actions with derivatives to the unknowns, about the operating point at their values.

    Raises
    ------
    ModelError
        The torques are not in balance there.
    UsageError
        The slope of a curve has no derivative there, as at the breakdown torque of a motor.
    """
    values, definition = Values(unknowns.values(at), DUALS), unknowns.definition
    tangents = definition.tangents
    if tangents is None or not following_elements(definition):
        return owned_parts(definition, values)
    here = tangents.with_values(dict(zip(unknowns.parameters, at, strict=True)))
    definition = replace(definition, tangents=here)
    parts = owned_parts(definition, values)
    smooth = tuple(name for name, element in _about_states(definition) if _is_smooth(element, values))
    if not smooth:
        return parts
    slopes = _Slopes(tangents, unknowns, tuple(at), smooth, here.state)
    gradients = np.stack([slopes.along(p) for p in range(len(at))], axis=-1)
    numbers = iter(gradients.tolist())
    return tuple(
        replace(owned, part=_with_gradients(owned.part, next(numbers), next(numbers)))
        if owned.element in smooth and isinstance(owned.part, Law)
        else owned
        for owned in parts
    )


def _about_states(definition: Definition) -> list[tuple[str, Element]]:
    """Elements, by name, whose laws of motion are linear about states that follow from the operating point."""
    pairs = ((element.name, element.other_laws) for element in definition.active)
    return [(name, laws.element) for name, laws in pairs if isinstance(laws, TangentLaws)]


def _is_smooth(element: Element, values: Values) -> bool:
    laws = (part for part in element.whole_parts(values) if isinstance(part, MotionLaw))
    return any(not isinstance(law.curve, PieceCurve) for law in laws)


def _with_gradients(law: Law, damping: Sequence[float], stiffness: Sequence[float]) -> Law:
    return replace(
        law,
        damping=Dual(value_of(law.damping), np.array(damping)),
        stiffness=Dual(value_of(law.stiffness), np.array(stiffness)),
    )


@dataclass(frozen=True, eq=False)
class _Slopes:
    """Damping and stiffness of the laws of some elements along the unknowns, with the balance at each of their values.

    ``state`` is that of the operating point: of several balances at other values the one next to it counts.
    """

    tangents: Tangents
    unknowns: Unknowns
    at: tuple[float, ...]
    elements: tuple[str, ...]
    state: BalancedState

    def along(self, number: int) -> FloatArray:
        """Derivatives (2 n_laws,) of damping and stiffness of all laws to one unknown."""
        size, own = abs(self.at[number]) or 1.0, self._own
        for share in STEPS:
            step = share * size
            try:
                moved = [self._moved(number, count * step) for count in (1, -1, 2, -2)]
            except (ModelError, UsageError, ArithmeticError):
                continue
            # Central differences over one and over two steps; (4 once - twice) / 3 is without the error in step^2.
            once, twice = (moved[0] - moved[1]) / (2 * step), (moved[2] - moved[3]) / (4 * step)
            sizes = np.maximum(np.abs(once), np.abs(twice))
            # Both agree unless a corner of a curve lies between their points: then a shorter step is tried.
            if (np.abs(once - twice) <= AGREEMENT * sizes + ROUNDING * np.abs(own) / step).all():
                return np.asarray((4 * once - twice) / 3)
        raise UsageError(
            f"the slopes of {', '.join(self.elements)} at the operating point have no derivative to "
            f"{self.unknowns.names[number]} there: a curve ends or has a corner; take another operating point",
            kind="unsupported-law",
        )

    @cached_property
    def _own(self) -> FloatArray:
        return self._law_coefficients(self.at)

    def _moved(self, number: int, step: float) -> FloatArray:
        return self._law_coefficients([*self.at[:number], self.at[number] + step, *self.at[number + 1 :]])

    def _law_coefficients(self, at: Sequence[float]) -> FloatArray:
        """Damping and stiffness (2 n_laws,) of all laws of the elements at values of the unknowns."""
        numbers = dict(zip(self.unknowns.parameters, at, strict=True))
        moved = self.tangents.with_values(numbers)
        # Of several balances the one nearest to the operating point lies on its branch.
        state = self.state if tuple(at) == self.at else min(moved.states, key=self._distance)
        values = Values({name: float(number) for name, number in self.unknowns.values(at).items()}, FLOAT)
        coefficients: list[Any] = []
        for element in self.unknowns.definition.switched_on:
            if element.name in self.elements:
                parts = element.tangent_parts(values, state.states[element.name])
                coefficients += [part for law in parts if isinstance(law, Law) for part in (law.damping, law.stiffness)]
        return np.array(coefficients, dtype=float)

    def _distance(self, other: BalancedState) -> float:
        """Largest difference of twists and rates of two states, over the largest of both."""
        first, second = _numbers(self.state.states), _numbers(other.states)
        largest = max((max(abs(a), abs(b)) for a, b in zip(first, second, strict=True)), default=0.0)
        return max((abs(a - b) for a, b in zip(first, second, strict=True)), default=0.0) / (largest or 1.0)


def _numbers(states: Mapping[str, Sequence[Any]]) -> list[float]:
    return [number for some in states.values() for state in some for number in (state.twist, state.rate)]


@dataclass(frozen=True, eq=False)
class LawCoefficients:
    """Coefficient of every law in SI units, such as its inertia, as values (n_laws,) and derivatives (n_laws, n_p)."""

    values: FloatArray
    slopes: FloatArray


@dataclass(frozen=True, eq=False)
class Augmented:
    """Equations of motion with constraints for one set of parameter values, and derivatives of their entries.

    Coefficients and rows with their derivatives.

    Attributes
    ----------
    law_slopes, condition_slopes : (n_rows, n_nodes, n_p) arrays
        Derivatives of the rows.
    inertia, damping, stiffness, hysteretic : LawCoefficients
        J, c, k, and k eta of every law.
    tables : tuple of (law index, DynamicStiffness)
        What depends on frequency, its coefficients as duals.
    law_owners, condition_owners : tuple of str
        Elements; of a condition that imposes an angle ``input:NAME``.
    law_rows, condition_rows : tuple of dict
        The rows by node as they came from the elements; of a condition also over the angle ``input:NAME`` it imposes.
    """

    law_slopes: FloatArray
    condition_slopes: FloatArray
    inertia: LawCoefficients
    damping: LawCoefficients
    stiffness: LawCoefficients
    hysteretic: LawCoefficients
    tables: tuple[tuple[int, DynamicStiffness], ...]
    law_owners: tuple[str, ...]
    condition_owners: tuple[str, ...]
    law_rows: tuple[Row, ...]
    condition_rows: tuple[Row, ...]

    @cached_property
    def exact_laws(self) -> tuple[dict[str, Fraction], ...]:
        """Row of each law (spring, damper, inertia) as rational coefficients by node."""
        return tuple(map(_exact, self.law_rows))

    @cached_property
    def exact_conditions(self) -> tuple[dict[str, Fraction], ...]:
        """Row of each rigid condition as rational coefficients, by node and imposed angle."""
        return tuple(map(_exact, self.condition_rows))

    def kappa(self, s: ComplexArray, at: FloatArray) -> ComplexArray:
        """Dynamic stiffness (n_laws, n_points) of all laws in N m/rad, at s in rad/s.

        Parameters
        ----------
        s : (n_points,) array
            rad/s, anywhere.
        at : (n_points,) array
            Frequencies in rad/s at which tables are read; 0 where nothing vibrates and hysteresis does not damp.
        """
        J, c, k, loss = (part.values[:, None] for part in (self.inertia, self.damping, self.stiffness, self.hysteretic))
        # kappa(s) = k + j k eta + c s + J s^2, without j k eta where nothing vibrates.
        kappa = np.asarray(k + 1j * loss * (at > 0) + s * (c + s * J), dtype=complex)
        for law, table in self.tables:
            kappa[law] += table.at(s, at)
        return kappa

    def kappa_rates(self, s: ComplexArray, at: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Derivatives (n_laws, n_points) of all dynamic stiffnesses to s, and to the frequency in tables."""
        # d kappa / ds = c + 2 J s
        rates = np.asarray(self.damping.values[:, None] + 2 * s * self.inertia.values[:, None], dtype=complex)
        followed = np.zeros_like(rates)
        for law, table in self.tables:
            rate, followed[law] = table.rates(s, at)
            rates[law] += rate
        return rates, followed

    @cached_property
    def varied(self) -> tuple[int, ...]:
        """Numbers of the springs, dampers and inertias (laws) that depend on a varied parameter."""
        slopes = (self.inertia.slopes, self.damping.slopes, self.stiffness.slopes, self.hysteretic.slopes)
        moved = np.any([slope.any(axis=1) for slope in slopes], axis=0) | self.law_slopes.any(axis=(1, 2))
        moved[[law for law, gradients in self._gradients.items() if gradients.any()]] = True
        return tuple(int(law) for law in np.flatnonzero(moved))

    @cached_property
    def _gradients(self) -> dict[int, FloatArray]:
        """Derivatives (n_coefficients, n_p) of the coefficients of frequency-dependent stiffnesses, by law."""
        count = self.inertia.slopes.shape[1]
        return {
            law: np.array([gradient_of(coefficient, count) for coefficient in table.coefficients]).reshape(-1, count)
            for law, table in self.tables
        }

    def kappa_slopes(self, law: int, s: ComplexArray, at: FloatArray) -> Iterator[tuple[int, ComplexArray]]:
        """Yield number of a parameter, and derivative (n_points,) of a law's dynamic stiffness to it, if not zero."""
        J, c, k, loss = (part.slopes[law] for part in (self.inertia, self.damping, self.stiffness, self.hysteretic))
        table, gradients = dict(self.tables).get(law), self._gradients.get(law, np.zeros((0, len(J))))
        slopes = None if table is None else table.slopes(s, at)
        for p in np.flatnonzero(np.any([J, c, k, loss, *gradients], axis=0)):
            # At fixed s, d kappa = dk + j d(k eta) + s dc + s^2 dJ; of a table, over its coefficients.
            slope = np.asarray(k[p] + 1j * loss[p] * (at > 0) + s * (c[p] + s * J[p]), dtype=complex)
            yield int(p), slope if slopes is None else slope + gradients[:, p] @ slopes


def augmented(unknowns: Unknowns, at: Sequence[float], nodes: Sequence[str], redundant: Sequence[int]) -> Augmented:
    """Equations of motion with constraints at these parameter values, without conditions that follow from others."""
    parts = parts_at(unknowns, at)
    acting = ", ".join(dict.fromkeys(part.element for part in parts if isinstance(part.part, Action)))
    if acting:
        raise UsageError(
            f"derivatives are not worked out where a torque follows another motion; switch off {acting}",
            kind="unsupported-law",
        )
    count, place = len(unknowns.names), {node: index for index, node in enumerate(nodes)}
    owned = [(part.element, part.part) for part in parts if hasattr(part.part, "inertia")]
    laws: list[Any] = [law for _, law in owned]
    conditions, owners = _conditions(unknowns, parts, nodes)
    if unknowns.definition.tangents is not None and following_elements(unknowns.definition):
        driven = {name for name in owners if name not in place}  # at other values other steps of curves may stand still
        redundant = reduce_rows(map(_exact, conditions), place, driven).redundant
    kept = [index for index in range(len(conditions)) if index not in set(redundant)]
    _refuse_redundant([owners[i] for i in redundant], [conditions[i] for i in redundant], count)
    return Augmented(
        law_slopes=_slopes([law.row for law in laws], place, count),
        condition_slopes=_slopes([conditions[index] for index in kept], place, count),
        inertia=_law_coefficients([law.inertia for law in laws], count),
        damping=_law_coefficients([law.damping for law in laws], count),
        stiffness=_law_coefficients([law.stiffness for law in laws], count),
        hysteretic=_law_coefficients([law.stiffness * law.loss_factor for law in laws], count),
        tables=tuple((index, law.table) for index, law in enumerate(laws) if law.table is not None),
        law_owners=tuple(owner for owner, _ in owned),
        condition_owners=tuple(owners[index] for index in kept),
        law_rows=tuple(law.row for law in laws),
        condition_rows=tuple(conditions[index] for index in kept),
    )


def _exact(row: Row) -> dict[str, Fraction]:
    return {node: exact(value_of(coefficient)) for node, coefficient in row.items()}


def _conditions(unknowns: Unknowns, parts: Sequence[OwnedPart], nodes: Sequence[str]) -> tuple[list[Row], list[str]]:
    """Rows of rigid conditions by node and their owners, imposed angles first, then those of the elements."""
    imposed = imposed_rows(unknowns.definition, nodes)
    owned = constraints_of(parts)
    rows: list[Any] = [*imposed.values(), *(row for _, row in owned)]
    return rows, [*(f"input:{name}" for name in imposed), *(owner for owner, _ in owned)]


def _refuse_redundant(owners: Sequence[str], rows: Sequence[Mapping[str, Any]], count: int) -> None:
    for owner, row in zip(owners, rows, strict=True):
        if any(gradient_of(coefficient, count).any() for coefficient in row.values()):
            raise UsageError(
                f"the ratio of {owner} is fixed by the other ratios of its rigid loop and cannot be varied alone",
                kind="unsupported-law",
            )


def _slopes(rows: Sequence[Mapping[str, Any]], place: Mapping[str, int], count: int) -> FloatArray:
    slopes = np.zeros((len(rows), len(place), count))
    for index, row in enumerate(rows):
        for node, coefficient in row.items():
            if node in place:  # an imposed angle is no node
                slopes[index, place[node]] = gradient_of(coefficient, count)
    return slopes


def _law_coefficients(numbers: Sequence[Any], count: int) -> LawCoefficients:
    slopes = np.array([gradient_of(number, count) for number in numbers]).reshape(len(numbers), count)
    return LawCoefficients(np.array([float(number) for number in numbers]), slopes)

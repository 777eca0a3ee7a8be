"""Plan that turns arrays of parameters into arrays of coefficients, without a drivetrain for each variant.

What depends on the parameters is evaluated by the elements themselves, in numbers of all variants
(:mod:`torsionnet.linear.batch.variant_numbers`), and checked by the checks of single models.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import ModelError, TorsionnetError, UsageError
from torsionnet.base.expressions import LARGEST_SIZE, SMALLEST_SIZE, is_beyond_range
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.batch.batch import Batch, BatchedStiffness
from torsionnet.linear.batch.variant_numbers import (
    VARIANTS,
    Decisions,
    PlannedElement,
    VariantNumber,
    passes_over_variants,
    planned_elements,
    variant_column,
)
from torsionnet.model.checks.values import is_in_measure, negative_laws, wrong_size
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.curves import OnCurve
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness, DynamicStiffness
from torsionnet.model.element_base.round_section import section_modulus
from torsionnet.model.elements import Element, Law, Part, Values
from torsionnet.model.parameters import evaluation_order

# Coefficient arrays of a batch under construction, filled in by passes over the variants.


class BatchBuilder:
    """Batch under construction, with coefficient arrays in SI units and a state for every variant.

    The coefficients are at first those of the drivetrain.
    """

    def __init__(self, drivetrain: AssembledModel, values: Mapping[str, FloatArray]) -> None:
        self.drivetrain: AssembledModel = drivetrain
        self.values: Mapping[str, FloatArray] = values
        self.count: int = len(next(iter(values.values())))
        system = drivetrain.assembly.system
        self.inertia, self.damping, self.stiffness = (
            np.tile(part, (self.count, 1)) for part in (system.inertia, system.damping, system.stiffness)
        )
        self.dynamic: list[BatchedStiffness] = []
        self.moduli: dict[str, FloatArray] = {}
        # As `is_beyond_range` refuses the number of a single model.
        sizes = np.abs(np.array(list(values.values())))
        self.impossible = ~np.all((sizes == 0) | ((sizes > SMALLEST_SIZE) & (sizes < LARGEST_SIZE)), axis=0)
        self.separate, self.known = (np.zeros(self.count, dtype=bool) for _ in range(2))

    def followed(self, places: NDArray[np.intp], decisions: Decisions) -> FollowingPass:
        """Pass over a batch with the variants that have followed every decision of the first variant in it."""
        own = places[decisions.follows]
        self.known[own] = ~decisions.unsure[decisions.follows]
        return FollowingPass(self, own, decisions.follows)

    def settle(self) -> None:
        """Mark variants without certain coefficients as separate, and those that no model allows as impossible."""
        finite = np.ones(self.count, dtype=bool)
        for array in (self.inertia, self.damping, self.stiffness):
            finite &= np.isfinite(array).all(axis=1)
        for batched in self.dynamic:
            finite[batched.places] &= np.isfinite(batched.coefficients).all(axis=0)
        # Certain are finite coefficients of a pass in which no digits were lost.
        self.separate |= ~(self.known & finite)
        self.separate &= ~self.impossible
        # Whether a single model would be refused is found by making it.
        for index in np.flatnonzero(self.separate):
            try:
                self.drivetrain.configured(**{name: float(column[index]) for name, column in self.values.items()})
            except ModelError:
                self.impossible[index], self.separate[index] = True, False

    def batch(self) -> Batch:
        varied = {batched.law for batched in self.dynamic}
        same = (
            BatchedStiffness(law, np.arange(self.count), of_law, np.zeros((0, self.count)))
            for law, of_law in self.drivetrain.assembly.system.dynamic
            if law not in varied
        )
        coefficients = self.inertia, self.damping, self.stiffness, (*same, *self.dynamic)
        return Batch(self.drivetrain, self.values, *coefficients, self.impossible, self.separate, self.moduli)


@dataclass(frozen=True, eq=False)
class FollowingPass:
    """Variants ``own`` with valid numbers in one pass over a batch, and the mask ``follows`` that selects them."""

    filling: BatchBuilder
    own: NDArray[np.intp]
    follows: NDArray[np.bool_]

    def mark_separate(self) -> None:
        """Mark the variants of the pass as separate, since their rows differ from those of the drivetrain."""
        self.filling.separate[self.own] = True

    def _column(self, number: Any) -> FloatArray:
        return variant_column(number, len(self.follows))[self.follows]

    def take(self, law: Law, number: int | None) -> None:
        """Store a law's coefficients for the variants of the pass.

        The ``number`` is None where the law has no effect in the drivetrain.
        """
        filling, own = self.filling, self.own
        entries = law.inertia, law.damping, law.stiffness, law.loss_factor
        inertia, damping, stiffness, loss = map(self._column, entries)
        acts = (inertia != 0) | (damping != 0) | (stiffness != 0) | (law.table is not None)
        if number is None:
            # The law has no column in the arrays: variants in which it acts are other systems of equations.
            filling.separate[own[acts]] = True
            return
        known = filling.drivetrain.assembly.laws[number]
        hysteretic = bool(known.loss_factor != 0)
        # A spring or a loss that appears or vanishes makes another system of equations.
        same = acts & ((stiffness != 0) == bool(known.stiffness != 0)) & ((loss != 0) == hysteretic)
        filling.separate[own[~same]] = True
        filling.inertia[own, number], filling.damping[own, number] = inertia, damping
        # Of a hysteretic spring k and k eta both go into the dynamic part kappa = k + j k eta.
        filling.stiffness[own, number] = 0.0 if hysteretic else stiffness
        if hysteretic:
            self._dynamic(number, ComplexStiffness(0j), np.array([stiffness, stiffness * loss]))
        elif law.table is not None:
            coefficients = [self._column(coefficient) for coefficient in law.table.coefficients]
            self._dynamic(number, law.table, np.array(coefficients).reshape(-1, len(own)))

    def _dynamic(self, number: int, of: DynamicStiffness, coefficients: FloatArray) -> None:
        self.filling.dynamic.append(BatchedStiffness(number, self.own, of, coefficients))

    def take_modulus(self, name: str, modulus: Any) -> None:
        """Store the polar section modulus of a shaft in each variant, as a ratio to that in the drivetrain."""
        drivetrain = self.filling.drivetrain
        known = float(section_modulus(drivetrain.elements[name], Values(drivetrain.exact_values)))
        ratios = self.filling.moduli.setdefault(name, np.ones(self.filling.count))
        ratios[self.own] = self._column(modulus) / known


@dataclass(frozen=True, eq=False)
class BatchPlan:
    """Elements of a drivetrain that depend on some parameters, found once for any number of variants.

    Attributes
    ----------
    drivetrain : AssembledModel
    names : tuple of str
        The parameters.
    derived : tuple of str
        Parameters that follow them, each after those that it uses.
    elements : sequence of PlannedElement
    """

    drivetrain: AssembledModel
    names: tuple[str, ...]
    derived: tuple[str, ...]
    elements: list[PlannedElement]
    _fixed: Mapping[str, Any] = field(repr=False)

    def batch(self, values: Mapping[str, ArrayLike]) -> Batch:
        """Batch of variants with these parameter values (n,) in SI units.

        Parameters
        ----------
        values : mapping
            Parameter -> (n,) array in SI, of exactly the names of the plan.

        Raises
        ------
        UsageError
            Other names, or arrays of different lengths.
        """
        if set(values) != set(self.names):
            raise UsageError(
                f"this plan varies {', '.join(self.names)}; give values for these, not {', '.join(values) or 'none'}",
                kind="missing-entry",
            )
        columns = {name: np.array(values[name], dtype=float, ndmin=1) for name in self.names}
        if len({column.shape for column in columns.values()}) > 1:
            raise UsageError("give the same number of values for every parameter", kind="wrong-count")
        filling = BatchBuilder(self.drivetrain, columns)
        with np.errstate(all="ignore"):
            for places, decisions in passes_over_variants(filling.count):
                self._pass(filling, places, decisions)
        filling.settle()
        return filling.batch()

    def _pass(self, filling: BatchBuilder, places: NDArray[np.intp], decisions: Decisions) -> None:
        varied = {name: VariantNumber(column[places], decisions) for name, column in filling.values.items()}
        try:
            value = Values(numbers_of(self.drivetrain.definition, self.derived, self._fixed, varied), VARIANTS)
            evaluated = [(planned, _checked(planned, value)) for planned in self.elements]
        except (TorsionnetError, ArithmeticError):
            # With the first variant all that decide like it are impossible; lost digits are for single models.
            filling.impossible[places[decisions.follows & ~decisions.unsure]] = True
            return
        # Elements may choose other rows by a value: these are no coefficients of this batch.
        alike = all(planned.has_rows_of(parts) for planned, parts in evaluated if planned.is_on)
        moduli = {each.element.name: section_modulus(each.element, value) for each in self.elements if each.is_stressed}
        # Last of all, since each evaluation above may have parted some variants from the first.
        here = filling.followed(places, decisions)
        if not alike:
            here.mark_separate()
            return
        for planned, parts in evaluated:
            if planned.is_on:
                laws = (part for part in parts if isinstance(part, Law))
                for law, number in zip(laws, planned.laws, strict=True):
                    here.take(law, number)
        for name, modulus in moduli.items():
            here.take_modulus(name, modulus)


def _checked(planned: PlannedElement, value: Values) -> tuple[Part, ...]:
    parts = planned.element.parts(value)
    _require_possible(planned.element, parts, value, on=planned.is_on)
    return parts


def numbers_of(
    definition: Definition, derived: Iterable[str], fixed: Mapping[str, Any], varied: Mapping[str, VariantNumber]
) -> dict[str, Any]:
    """Values of all parameters by name, in SI units.

    A parameter that follows varied ones holds a value for each variant.
    """
    numbers = {**fixed, **varied}
    for name in derived:
        number = definition.parameters[name].value.evaluate(numbers, VARIANTS)
        # What overflows or divides by zero is left to a single model.
        number.decisions.unsure |= ~np.isfinite(number.values)
        numbers[name] = number
    return numbers


def batch_plan(drivetrain: AssembledModel, names: Iterable[str]) -> BatchPlan | None:
    """Plan for variants of some parameters, or None where variants differ in rows and each is solved by itself.

    Parameters
    ----------
    drivetrain : AssembledModel
        In one configuration; its own values should be usual ones: variants with other acting laws become separate.
    names : iterable of str
        Parameters.

    Raises
    ------
    UsageError
        No such parameter, or none at all.

    Examples
    --------
    >>> import torsionnet as tn
    >>> plan = batch_plan(tn.load("dmf_rig"), ["k_2"])
    >>> plan.batch({"k_2": [400.0, -1.0]}).impossible.tolist()
    [False, True]
    >>> batch_plan(tn.load("amt_rig"), ["tau"]) is None
    True
    """
    chosen = tuple(dict.fromkeys(names))
    if not chosen:
        raise UsageError("name at least one parameter to vary", kind="missing-entry")
    known, definition = drivetrain.parameters, drivetrain.definition
    try:
        drivetrain.configured(**{name: known.get(name, 0.0) for name in chosen})
    except ModelError:  # also as a plain number, which has no unit
        return None
    derived = tuple(_derived_from(definition, chosen, evaluation_order(definition.parameters)[0]))
    moved = frozenset((*chosen, *derived))
    # Another operating point moves the tangents of curves: every variant needs a balance of its own.
    if _operating_point_moves(definition, moved, chosen):
        return None
    fixed = {name: value for name, value in drivetrain.exact_values.items() if name not in moved}
    # One variant at the drivetrain's own values shows which elements use what is varied.
    decisions = Decisions(1)
    varied = {name: VariantNumber(np.array([known[name]]), decisions) for name in chosen}
    elements = planned_elements(drivetrain, numbers_of(definition, derived, fixed, varied), moved)
    return None if elements is None else BatchPlan(drivetrain, chosen, derived, elements, fixed)


def _derived_from(definition: Definition, names: Collection[str], order: Collection[str]) -> Iterator[str]:
    """Names of parameters that depend on the given ones, in the ``order`` of evaluation."""
    moved = set(names)
    for name in order:
        if name not in moved and definition.parameters[name].value.names & moved:
            moved.add(name)
            yield name


def _operating_point_moves(definition: Definition, moved: Collection[str], names: Collection[str]) -> bool:
    """Whether mean speeds and torques, tangents or values of curves there, depend on the varied parameters.

    ``moved`` are all parameters that do, ``names`` those of them that are varied themselves.
    """
    point, moving = definition.operating_point, frozenset(moved)
    if definition.tangents is not None and definition.tangents.depends_on(moving):
        return True
    if any(value.names & moving for table in (point.speed, point.torque) for value in table.values()):
        return True
    if definition.following.keys() <= set(names):
        return False
    return any(
        isinstance(spec, OnCurve) and expression.names & moving
        for element in definition.active
        for _, spec, expression, _ in element.expressions()
    )


def _require_possible(element: Element, parts: Iterable[Part], value: Values, *, on: bool) -> None:
    """Raise UsageError for impossible entries of an element, negative laws, and if ``on`` values beyond its curves.

    Raises
    ------
    UsageError
        As the first variant has it.
    """
    for path, spec, expression, wanted in element.expressions():
        number: Any = value(expression)
        if not isinstance(number, VariantNumber):
            continue
        wrong: Any = is_beyond_range(number) or wrong_size(
            spec, number, measure=is_in_measure(spec, path), wanted=wanted
        )
        if wrong or (on and isinstance(spec, OnCurve) and spec.curve_fault(number)):
            raise UsageError(
                f"{expression} is not possible for {element.name}; check the range of what is varied",
                kind="incalculable-value",
            )
    faults = element.value_faults(value)
    if faults:
        text = f"{element.name}: {faults[0].message}; check the range of what is varied"
        raise UsageError(text, kind=faults[0].kind)
    if negative_laws(element, [part for part in parts if isinstance(part, Law)]):
        raise UsageError(
            f"{element.name} has a stiffness, damping or inertia below zero; check the range of what is varied",
            kind="negative-law",
        )
